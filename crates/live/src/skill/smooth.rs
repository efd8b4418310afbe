//! How smooth a movement is: its spectral arc length.
//!
//! In: a speed (of a force: the size of its rate) at even times. Out: minus the length of the arc that its normalized
//! spectrum draws up to a cut-off: -1.41 for a single smooth stroke, less the more it stutters, whatever its size.
//! Balasubramanian, Melendez-Calderon and Burdet 2012 (DOI 10.1109/TBME.2011.2179545): padding to 16 times the length
//! and 10 Hz are theirs; the adaptive end of the arc, where the spectrum falls below 0.05 for good, is that of the same
//! authors' 2015 revision, SPARC (DOI 10.1186/s12984-015-0090-9).

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
    fn what_has_no_shape_has_no_smoothness() {
        assert_eq!(spectral_arc_length(&[1.0; 7], 100.0), None);
        assert_eq!(spectral_arc_length(&[0.0; 50], 100.0), None);
        assert_eq!(spectral_arc_length(&[f64::NAN; 50], 100.0), None);
        assert_eq!(spectral_arc_length(&vec![1.0; MOST_SAMPLES + 1], 100.0), None);
        assert_eq!(spectral_arc_length(&stroke(100.0), f64::NAN), None);
    }
}
