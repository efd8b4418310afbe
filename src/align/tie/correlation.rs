//! The tie by the lag at which the joints' angles best explain the photodiodes, for when there is no clock.

use clap::Args;

use super::correlate::{Correlated, LagSearch, Recording, correlate};
use super::{Tie, TieMethod};
use crate::align::Posture;
use crate::clock::USUAL_DRIFT;
use crate::job::number;
use crate::log::Samples;
use crate::median::ends;
use crate::timebase::Timebase;

/// How far the sensor's lag differs with the motion, seconds: hysteresis lasts longer the slower the finger moves.
/// Measured over phantoms in random motion: 4 ms.
const LAG_SD_S: f64 = 0.005;

/// Once the drift is known the lag is looked for again so near, seconds.
const AGAIN_S: f64 = 1.0;
/// The lag changes by more than this many of its standard errors: the clocks run at different rates.
const DRIFTS_SDS: f64 = 3.0;

/// Where the lag is looked for, and the sensor's own.
#[derive(Debug, Clone, Copy, Default, PartialEq, Args)]
pub struct LagTie {
    /// Where to look.
    #[command(flatten)]
    pub search: LagSearch,
    /// With correlate: how long after the finger the photodiodes answer, which is subtracted from the lag found
    #[arg(long = "sensor-lag", value_name = "SECONDS", value_parser = number, allow_negative_numbers = true)]
    pub sensor_lag_s: Option<f64>,
}

/// Ties by correlation. The offset is what [`correlate`] finds less the sensor's lag; where that is not known it is in
/// the offset, and a warning says so. Drift is taken to be 0, with the standard error of clocks of quartz, unless the
/// lag clearly changes from the first half to the second: then it is measured, and a warning says so.
///
/// # Errors
/// No angles, no photodiodes, or no lag that is sure: in words, with what to do.
pub(crate) fn by_correlation(posture: &Posture, samples: &Samples, options: LagTie) -> Result<Tie, String> {
    if let Some(lag_s) = options.sensor_lag_s.filter(|lag_s| !lag_s.is_finite()) {
        return Err(format!("the sensor's lag is {lag_s} s; it must be a number of seconds"));
    }
    let angles: Vec<&[f64]> = posture.angles_deg.iter().map(Vec::as_slice).collect();
    let channels: Vec<&[f64]> = samples.photodiodes.iter().map(|channel| channel.values.as_slice()).collect();
    if angles.is_empty() {
        return Err("the table has no angles to compare the photodiodes with".to_owned());
    }
    if channels.is_empty() {
        return Err("the log has no photodiodes to compare the angles with".to_owned());
    }
    let video = Recording { time_s: &posture.time_s, columns: &angles };
    let plain = correlate(video, Recording { time_s: &samples.time_s, columns: &channels }, options.search)?;
    let reference_s = middle_of_overlap(&posture.time_s, &samples.time_s, plain.offset_s);
    let pivot_s = reference_s + plain.offset_s;
    let (mut warnings, mut notes) = (Vec::new(), Vec::new());
    // Log time less video time at the reference is the offset at any rate that turns about it.
    let (found, drift, drift_sd) = match drift_of(&plain) {
        None => {
            notes.push(format!("drift is taken to be 0, with a standard error of {:.0} ppm", 1e6 * USUAL_DRIFT));
            (plain, 0.0, USUAL_DRIFT)
        }
        Some([drift, _]) => {
            let time_s: Vec<f64> = samples.time_s.iter().map(|t| pivot_s + (t - pivot_s) / (1.0 + drift)).collect();
            let search = LagSearch { about_s: Some(plain.offset_s), most_s: Some(AGAIN_S), ..options.search };
            let again = correlate(video, Recording { time_s: &time_s, columns: &channels }, search)?;
            let [more, sd] = drift_by(&again).ok_or("once the drift is taken off, no half says what is left of it")?;
            let drift = (1.0 + drift) * (1.0 + more) - 1.0;
            warnings.push(format!(
                "the lag changes over the recording as if the log's clock ran {:.5} +- {:.5} times as fast as the \
                 video's, which no two clocks of quartz do; it is taken so: is the video's rate of frames, or the \
                 log's of samples, the one that was recorded?",
                1.0 + drift,
                sd
            ));
            (again, drift, sd)
        }
    };
    let lag_s = options.sensor_lag_s.unwrap_or(0.0);
    let offset_s = found.offset_s - lag_s;
    match options.sensor_lag_s {
        Some(lag_s) => notes.push(format!("the sensor's lag of {lag_s} s, as given, is taken off the offset")),
        None => warnings.push(
            "photodiodes change after the finger does, some 0.05 s in bending and 0.1 to 0.4 s in pressing: that \
                 lag can't be separated from the offset and is part of it, but not of its standard error (which has \
                 how it differs with the motion); labels are early by it unless the sensor's lag is given"
                .to_owned(),
        ),
    }
    notes.push(format!(
        "the angles explain {:.1} % of the variance of the photodiodes' best combination at this lag",
        100.0 * found.explained
    ));
    if let Some(other) = found.others.first() {
        notes.push(format!("the next best lag is {:.3} s, with {:.1} %", other.offset_s, 100.0 * other.explained));
    }
    let timebase = Timebase {
        reference_s,
        at_reference_s: reference_s + offset_s,
        at_reference_sd_s: found.offset_sd_s.hypot(LAG_SD_S),
        drift,
        drift_sd,
    };
    Ok(Tie { confidence: Some(found.confidence), warnings, notes, ..Tie::of(TieMethod::Correlate, timebase) })
}

/// How much faster the log's clock runs by the lags of both halves, and its standard error.
pub(super) fn drift_by(found: &Correlated) -> Option<[f64; 2]> {
    let [first, second] = found.halves?;
    let apart_s = second.middle_s - first.middle_s;
    let sd_s = first.offset_sd_s.hypot(second.offset_sd_s).hypot(LAG_SD_S);
    Some([(second.offset_s - first.offset_s) / apart_s, sd_s / apart_s])
}

/// [`drift_by`], where it is more than clocks of quartz have.
fn drift_of(found: &Correlated) -> Option<[f64; 2]> {
    drift_by(found).filter(|[drift, sd]| drift.abs() > DRIFTS_SDS * sd.hypot(USUAL_DRIFT))
}

/// The video's time in the middle of where both have rows.
fn middle_of_overlap(video_s: &[f64], log_s: &[f64], offset_s: f64) -> f64 {
    let finite = |times: &[f64]| ends(times.iter().copied().filter(|t| t.is_finite()));
    let (video, log) = (finite(video_s), finite(log_s));
    0.5 * (video[0].max(log[0] - offset_s) + video[1].min(log[1] - offset_s))
}

#[cfg(test)]
pub(super) mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::log::Channel;
    use crate::phantom::force::ForceTrajectory;
    use crate::phantom::log::{LogOptions, LogScene};
    use crate::phantom::trajectory::Trajectory;

    /// A finger that moves as no clock does, and photodiodes that follow it `lag_s` later, on a log 100 s ahead.
    fn recordings(lag_s: f64) -> (Posture, Samples) {
        let angle = |t: f64| 40.0 + 20.0 * (1.3 * t + 0.05 * t * t).sin() + 9.0 * (2.9 * t).cos();
        let time_s: Vec<f64> = (0..900).map(|k| f64::from(k) / 30.0).collect();
        let log_s: Vec<f64> = (0..500).map(|k| 95.0 + f64::from(k) / 12.5).collect();
        let channel = |k: usize| Channel {
            name: format!("P{k}"),
            values: log_s.iter().map(|t| 0.02 * k as f64 * angle(t - 100.0 - lag_s) + 1.0).collect(),
        };
        let angles_deg = vec![time_s.iter().map(|&t| angle(t)).collect()];
        let photodiodes = (1..4).map(channel).collect();
        let faults = vec![String::new(); log_s.len()];
        let samples = Samples { time_s: log_s, photodiodes, faults, ..Samples::default() };
        (Posture::of(time_s, angles_deg, 0.05), samples)
    }

    /// Measured: 0.1 ms.
    const FOUND_S: f64 = 2e-3;

    #[test]
    fn the_sensors_lag_is_stated_or_taken_off() {
        let (posture, samples) = recordings(0.2);
        let tie = by_correlation(&posture, &samples, LagTie::default()).unwrap();
        assert!((tie.timebase.offset_s() - 100.2).abs() <= FOUND_S, "{}", tie.timebase.offset_s());
        assert!(tie.warnings[0].contains("can't be separated") && tie.confidence.unwrap() > 0.95);
        let options = LagTie { sensor_lag_s: Some(0.2), ..LagTie::default() };
        let tie = by_correlation(&posture, &samples, options).unwrap();
        assert!((tie.timebase.offset_s() - 100.0).abs() <= FOUND_S);
    }

    /// A phantom's angles with an error of 0.05 degrees, and its log with all ambient light left in; the log's clock is
    /// 60 s ahead.
    pub(in crate::align::tie) fn phantom(
        seed: u64,
        trajectory: Trajectory,
        force: ForceTrajectory,
    ) -> (Posture, Samples) {
        let time_s: Vec<f64> = (0..1800).map(|k| f64::from(k) / 30.0).collect();
        let options = LogOptions {
            seed,
            trajectory: trajectory.clone(),
            force,
            seconds: 60.0,
            clock_offset_s: 60.0,
            clock_drift_ppm: 0.0,
            led: false,
            ..LogOptions::default()
        };
        let scene = LogScene::new(options).unwrap();
        let rows = scene.rows();
        let channel =
            |k: usize| Channel { name: format!("P{k}"), values: rows.iter().map(|row| row.read_v[k]).collect() };
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut error = || 0.05 * (0..12).map(|_| rng.random_range(-0.5..0.5)).sum::<f64>();
        let mut angle = |joint: usize| -> Vec<f64> {
            time_s.iter().map(|&t| trajectory.angles_rad(t)[joint].to_degrees() + error()).collect()
        };
        let angles_deg = (0..3).map(&mut angle).collect();
        let posture = Posture::of(time_s, angles_deg, 0.05);
        let (log_s, faults) = (rows.iter().map(|row| row.stamp_s).collect(), vec![String::new(); rows.len()]);
        let photodiodes = (0..8).map(channel).collect();
        let force = |axis: usize| Channel {
            name: ["Fx_N", "Fy_N", "Fz_N"][axis].to_owned(),
            values: rows.iter().map(|row| row.forces_read_n[axis]).collect(),
        };
        let forces = (0..3).map(force).collect();
        (posture, Samples { time_s: log_s, photodiodes, forces, faults, ..Samples::default() })
    }

    /// The photodiodes' lag in bending: 0.04 s of the first order, and half of half a degree's play. Measured over 20
    /// seeds: 0.044 to 0.058 s.
    const LAG_S: f64 = 0.05;
    const NEAR_S: f64 = 0.012;

    #[test]
    fn a_saturating_sensor_is_tied_to_the_angles() {
        for seed in 3..9 {
            let (posture, samples) = phantom(seed, Trajectory::Random { hz: 0.1, seed }, ForceTrajectory::None);
            let tie = by_correlation(&posture, &samples, LagTie::default()).unwrap();
            let late_s = tie.timebase.offset_s() - 60.0;
            assert!((late_s - LAG_S).abs() <= NEAR_S, "{seed} {late_s} {:?}", tie.notes);
        }
    }

    #[test]
    fn a_video_of_another_rate_is_measured_and_warned_of() {
        for (seed, rate) in [(3, 1.003), (4, 0.996), (5, 1.0)] {
            let (mut posture, samples) = phantom(seed, Trajectory::Random { hz: 0.1, seed }, ForceTrajectory::None);
            posture.time_s.iter_mut().for_each(|t| *t /= rate);
            let tie = by_correlation(&posture, &samples, LagTie::default()).unwrap();
            let warned = tie.warnings.iter().any(|warning| warning.contains("the lag changes"));
            assert_eq!(warned, rate != 1.0, "{:?}", tie.warnings);
            let off_s = |true_s: f64| tie.timebase.other_s(true_s / rate) - (60.0 + true_s + LAG_S);
            let most_s = [0.0, 30.0, 60.0].into_iter().map(|t| off_s(t).abs()).fold(0.0, f64::max);
            assert!(most_s <= OVER_ALL_S, "{seed} {most_s} {:?}", tie.timebase);
            if rate != 1.0 {
                let off = (tie.timebase.drift - (rate - 1.0)).abs();
                assert!(off <= 3.0 * tie.timebase.drift_sd, "{off} {:?}", tie.timebase);
            }
        }
    }

    /// Measured: see the test; of a drift of 0.3 %, which is 0.18 s over the recording.
    const OVER_ALL_S: f64 = 0.03;

    #[test]
    fn a_periodic_bending_and_forces_alone_are_refused() {
        let (posture, samples) = phantom(1, Trajectory::Eq27 { hz: 0.1 }, ForceTrajectory::None);
        let why = by_correlation(&posture, &samples, LagTie::default()).unwrap_err();
        assert!(why.contains("several lags"), "{why}");
        let force = ForceTrajectory::Random { hz: 0.1, seed: 1 };
        let (posture, samples) = phantom(1, Trajectory::Rest, force);
        let why = by_correlation(&posture, &samples, LagTie::default()).unwrap_err();
        assert!(why.contains("do not explain"), "{why}");
    }

    #[test]
    fn without_angles_or_photodiodes_there_is_nothing_to_compare() {
        let (mut posture, mut samples) = recordings(0.0);
        samples.photodiodes.clear();
        assert!(by_correlation(&posture, &samples, LagTie::default()).unwrap_err().contains("no photodiodes"));
        posture.angles_deg.clear();
        assert!(by_correlation(&posture, &samples, LagTie::default()).unwrap_err().contains("no angles"));
    }
}
