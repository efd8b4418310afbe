//! How smooth a movement is: its spectral arc length.
//!
//! In: a speed (of a force: the size of its rate) at even times. Out: minus the length of the arc that its normalized
//! spectrum draws up to a cut-off: -1.41 for a single smooth stroke, less the more it stutters, whatever its size
//! (where all of it is given: what a threshold cuts off is a larger share of a small one).
//! Balasubramanian, Melendez-Calderon and Burdet 2012 (DOI 10.1109/TBME.2011.2179545): padding to 16 times the length
//! and 10 Hz are theirs; the adaptive end of the arc, where the spectrum falls below 0.05 for good, is that of the same
//! authors' 2015 revision, SPARC (DOI 10.1186/s12984-015-0090-9), and so is a low pass before it: the size of a rate is
//! folded, and with it noise of all frequencies comes below the cut-off.

use rustfft::FftPlanner;
use rustfft::num_complex::Complex;

/// The arc ends at this frequency at the latest, hertz.
const CUT_OFF_HZ: f64 = 10.0;
/// It ends where the spectrum is below this share of its largest for good.
const FAINT: f64 = 0.05;
/// The speed is padded to so many times its length: the arc is drawn through so many more points.
const PADDING: usize = 16;
/// Longer speeds are not looked at: their padded spectrum takes 16 MiB.
pub const MOST_SAMPLES: usize = 1 << 16;
/// Shorter ones have no shape (assumed).
const FEWEST_SAMPLES: usize = 8;

/// Faster changes of a rate are taken for noise, hertz: half as much again as the arc looks at. Measured on presses of
/// 2 N that stutter in steps of 0.12 s: of 1000 rows a second without noise the arc is -5.67, with 0.01 N of white
/// noise -5.63, of 100 with that -5.50; at 20 Hz -5.75, -5.67 and -5.46.
const LOW_PASS_HZ: f64 = 15.0;
/// A Butterworth filter of the fourth order that is run forth and back leaves 1 / (1 + (f / cut-off)^8).
const ORDER: i32 = 8;
/// A rate is mirrored at its ends for so long: three periods of the cut-off.
const MIRRORED_S: f64 = 0.2;

/// A rate at even times, less its noise, without a delay.
pub(super) fn low_passed(rate: &[f64], rate_hz: f64) -> Vec<f64> {
    let beyond = (MIRRORED_S * rate_hz).ceil() as usize;
    let mirrored = beyond.min(rate.len().saturating_sub(1));
    let before = rate.iter().skip(1).take(mirrored).rev();
    let after = rate.iter().rev().skip(1).take(mirrored);
    let all = before.chain(rate).chain(after).map(|&value| Complex::new(value, 0.0));
    let mut spectrum: Vec<Complex<f64>> = all.collect();
    let length = (spectrum.len() + beyond).next_power_of_two();
    spectrum.resize(length, Complex::default());
    let mut planner = FftPlanner::new();
    planner.plan_fft_forward(length).process(&mut spectrum);
    for (k, value) in spectrum.iter_mut().enumerate() {
        let hz = k.min(length - k) as f64 * rate_hz / length as f64;
        *value /= (1.0 + (hz / LOW_PASS_HZ).powi(ORDER)) * length as f64;
    }
    planner.plan_fft_inverse(length).process(&mut spectrum);
    spectrum[mirrored..mirrored + rate.len()].iter().map(|value| value.re).collect()
}

/// The standard deviation that white noise of `sd` in each of `rate_hz` values a second leaves in their rate after the
/// low pass, a second.
#[must_use]
pub fn noise_of_white(sd: f64, rate_hz: f64) -> f64 {
    let band_hz = LOW_PASS_HZ.min(0.5 * rate_hz);
    sd * std::f64::consts::TAU * band_hz / 3f64.sqrt() * (2.0 * band_hz / rate_hz).sqrt()
}

/// The spectral arc length of a speed at `rate_hz` samples a second; none where it is too short or too long to tell, is
/// not known throughout, or never moves.
#[must_use]
pub fn spectral_arc_length(speed: &[f64], rate_hz: f64) -> Option<f64> {
    if !(FEWEST_SAMPLES..=MOST_SAMPLES).contains(&speed.len()) || !speed.iter().all(|value| value.is_finite()) {
        return None;
    }
    let length = PADDING * speed.len().next_power_of_two();
    let mut spectrum: Vec<Complex<f64>> = speed.iter().map(|&value| Complex::new(value, 0.0)).collect();
    spectrum.resize(length, Complex::default());
    FftPlanner::new().plan_fft_forward(length).process(&mut spectrum);
    let half = &spectrum[..=length / 2];
    let largest = half.iter().map(|value| value.norm()).fold(0.0, f64::max);
    let step_hz = rate_hz / length as f64;
    let share = |k: usize| half[k].norm() / largest;
    let last = ((CUT_OFF_HZ / step_hz) as usize).min(half.len() - 1);
    let end = (0..=last).rev().find(|&k| share(k) >= FAINT)?;
    let begin = (0..=last).find(|&k| share(k) >= FAINT)?;
    let across = 1.0 / (end - begin) as f64;
    let arc = (begin..end).map(|k| across.hypot(share(k + 1) - share(k))).sum::<f64>();
    (end > begin && arc.is_finite()).then_some(-arc)
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    /// exp(-5 t^2) from -1 to 1 s.
    fn stroke(rate_hz: f64) -> Vec<f64> {
        (0..(2.0 * rate_hz) as usize).map(|k| -1.0 + k as f64 / rate_hz).map(|t| (-5.0 * t * t).exp()).collect()
    }

    #[test]
    fn a_stroke_is_as_smooth_as_its_authors_say() {
        // The example of the authors' own `sparc`: -1.41403.
        let length = spectral_arc_length(&stroke(100.0), 100.0).unwrap();
        assert!((length + 1.414_03).abs() <= 5e-6, "{length}");
    }

    #[test]
    fn size_does_not_matter_and_stuttering_does() {
        let once = spectral_arc_length(&stroke(100.0), 100.0).unwrap();
        let larger: Vec<f64> = stroke(100.0).iter().map(|v| 1e3 * v).collect();
        assert!((spectral_arc_length(&larger, 100.0).unwrap() - once).abs() <= 1e-12);
        let twice = spectral_arc_length(&[stroke(100.0), stroke(100.0)].concat(), 100.0).unwrap();
        let thrice = spectral_arc_length(&[stroke(100.0), stroke(100.0), stroke(100.0)].concat(), 100.0).unwrap();
        assert!(thrice < twice - 0.5 && twice < once - 0.5, "{once} {twice} {thrice}");
        // Sampled twice as fast it is the same stroke; the spectrum is drawn as finely.
        assert!((spectral_arc_length(&stroke(200.0), 200.0).unwrap() - once).abs() <= 0.01);
    }

    #[test]
    fn a_low_pass_keeps_what_is_slow_and_leaves_little_noise() {
        let slow: Vec<f64> = (0..400).map(|k| (std::f64::consts::TAU * 3.0 * f64::from(k) / 200.0).sin()).collect();
        let kept = low_passed(&slow, 200.0);
        assert_eq!(kept.len(), slow.len());
        // Ends are mirrored, which a sine that crosses zero there isn't.
        let off = (60..340).map(|k| (kept[k] - slow[k]).abs()).fold(0.0, f64::max);
        assert!(off <= 1e-3, "{off}");
        for rate_hz in [20.0, 100.0, 1000.0] {
            let mut random = ChaCha8Rng::seed_from_u64(1);
            let noise: Vec<f64> = (0..20_000).map(|_| StandardNormal.sample(&mut random)).collect();
            let rate: Vec<f64> = noise.windows(2).map(|pair| (pair[1] - pair[0]) * rate_hz).collect();
            let left = low_passed(&rate, rate_hz);
            let sd = (left.iter().map(|value| value * value).sum::<f64>() / left.len() as f64).sqrt();
            let share = sd / noise_of_white(1.0, rate_hz);
            println!("{rate_hz}: {share:.3}");
            assert!((0.7..=1.1).contains(&share), "{rate_hz}: {share}");
        }
        assert!(low_passed(&[], 100.0).is_empty() && low_passed(&[2.0], 100.0).len() == 1);
    }

    #[test]
    fn what_has_no_shape_has_no_smoothness() {
        assert_eq!(spectral_arc_length(&[1.0; 7], 100.0), None);
        assert_eq!(spectral_arc_length(&[0.0; 50], 100.0), None);
        assert_eq!(spectral_arc_length(&[f64::NAN; 50], 100.0), None);
        assert_eq!(spectral_arc_length(&vec![1.0; MOST_SAMPLES + 1], 100.0), None);
        assert_eq!(spectral_arc_length(&stroke(100.0), f64::NAN), None);
    }
}
