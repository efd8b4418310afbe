use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::*;

/// Random motion without steps: a sum of so many sines of random periods between 0.8 and 8 s.
fn motion(rng: &mut ChaCha8Rng, waves: usize) -> impl Fn(f64) -> f64 + use<> {
    let waves: Vec<[f64; 3]> = (0..waves)
        .map(|_| {
            let period = rng.random_range(0.8f64.ln()..8f64.ln()).exp();
            [rng.random_range(0.3..1.0), std::f64::consts::TAU / period, rng.random_range(0.0..std::f64::consts::TAU)]
        })
        .collect();
    move |t| waves.iter().map(|[a, w, p]| a * (w * t + p).sin()).sum()
}

/// Log time less video time, seconds.
const OFFSET_S: f64 = 1234.567;

/// A video's angle and a log's channels.
struct Both {
    video_s: Vec<f64>,
    angle: Vec<f64>,
    log_s: Vec<f64>,
    channels: Vec<Vec<f64>>,
}

impl Both {
    /// `seconds` of video and log; the log begins `starts_s` after the video and follows `of_log`.
    fn new(
        seed: u64,
        [angle, of_log]: [&dyn Fn(f64) -> f64; 2],
        seconds: [f64; 2],
        log_hz: f64,
        starts_s: f64,
    ) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let times = |hz: f64, from: f64, seconds: f64, rng: &mut ChaCha8Rng| {
            (0..(seconds * hz) as usize)
                .map(|k| from + (k as f64 + rng.random_range(-0.2..0.2)) / hz)
                .collect::<Vec<f64>>()
        };
        let video_s = times(30.0, 0.0, seconds[0], &mut rng);
        let log_s = times(log_hz, OFFSET_S + starts_s, seconds[1], &mut rng);
        let mut noise = |sd: f64| sd * (0..12).map(|_| rng.random_range(-0.5..0.5)).sum::<f64>();
        let angle_deg = video_s.iter().map(|&t| 20.0 * angle(t) + noise(0.3)).collect();
        let channels = (0..8)
            .map(|k| {
                let (slope, bend) = (0.1 * (f64::from(k) - 3.5), 0.01 * (f64::from(k) - 2.0));
                log_s
                    .iter()
                    .map(|&t| {
                        let a = of_log(t - OFFSET_S);
                        2.0 + slope * a + bend * a * a + 1e-3 * (t - OFFSET_S) + noise(0.2)
                    })
                    .collect()
            })
            .collect();
        Self { video_s, angle: angle_deg, log_s, channels }
    }

    fn correlate(&self, search: LagSearch) -> Result<Correlated, String> {
        let channels: Vec<&[f64]> = self.channels.iter().map(Vec::as_slice).collect();
        correlate(
            Recording { time_s: &self.video_s, columns: &[&self.angle] },
            Recording { time_s: &self.log_s, columns: &channels },
            search,
        )
    }
}

/// Measured over ten seeds: at most 3.8 ms.
const FOUND_S: f64 = 0.01;

#[test]
fn the_lag_of_related_signals_is_found() {
    let mut within = 0;
    for seed in 0..10 {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let angle = motion(&mut rng, 30);
        // The log begins before the video and ends after it, or the other way round.
        let (seconds, starts_s) = if seed % 2 == 0 { ([30.0, 60.0], -10.0) } else { ([60.0, 40.0], 15.0) };
        let mut both = Both::new(seed, [&angle, &angle], seconds, 25.0, starts_s);
        // The marker is lost for two seconds, the log has a gap of one.
        for (t, angle) in both.video_s.iter().zip(&mut both.angle) {
            if (20.0..22.0).contains(t) {
                *angle = f64::NAN;
            }
        }
        let gap = |t: &f64| (OFFSET_S + 24.0..OFFSET_S + 25.0).contains(t);
        for channel in &mut both.channels {
            let mut times = both.log_s.iter();
            channel.retain(|_| !times.next().is_some_and(gap));
        }
        both.log_s.retain(|t| !gap(t));
        let found = both.correlate(LagSearch::default()).unwrap();
        let error = (found.offset_s - OFFSET_S).abs();
        assert!(error <= FOUND_S && found.confidence >= VOTES && found.explained > 0.9, "{seed} {found:?}");
        within += u32::from(error <= 2.0 * found.offset_sd_s);
    }
    assert!(within >= 8, "{within}");
}

/// A smooth signal of one of five kinds at `hz`: few waves, many waves, noise that is forgotten quickly or slowly,
/// steps that are followed.
fn smooth(rng: &mut ChaCha8Rng, kind: usize, hz: f64, seconds: f64) -> Vec<f64> {
    let count = (hz * seconds) as usize;
    if kind < 2 {
        let at = motion(rng, [3, 30][kind]);
        return (0..count).map(|k| at(k as f64 / hz)).collect();
    }
    let (mut drive, mut value, mut next_s) = (0.0, 0.0, 0.0);
    let keep = (-1.0 / (hz * [0.5, 4.0][kind % 2])).exp();
    (0..count)
        .map(|k| {
            if kind < 4 {
                drive = keep * drive + rng.random_range(-1.0..1.0) * (1.0 - keep * keep).sqrt();
            } else if k as f64 / hz >= next_s {
                drive = rng.random_range(0.0..1.0);
                next_s += rng.random_range(0.5..6.0);
            }
            value += (drive - value) / (0.2 * hz);
            value
        })
        .collect()
}

/// Pairs that have nothing to do with each other and are tied all the same.
fn tied_of_unrelated(pairs: std::ops::Range<u64>) -> Vec<(u64, Correlated)> {
    let accepted = |pair: u64| {
        let mut rng = ChaCha8Rng::seed_from_u64(500 + pair);
        let kind = (pair % 5) as usize;
        let angles: Vec<Vec<f64>> = (0..3).map(|_| smooth(&mut rng, kind, 30.0, 20.0)).collect();
        let [base, other] = [0, 1].map(|_| smooth(&mut rng, kind, 12.5, 30.0));
        let channel = |k: usize| -> Vec<f64> {
            let of_other = if pair.is_multiple_of(2) { 0.1 * k as f64 } else { 0.0 };
            let both = base.iter().zip(&other).map(|(a, b)| a + of_other * b);
            both.map(|v| v + 0.1 * k as f64 * v * v + 0.01 * rng.random_range(-1.0..1.0)).collect()
        };
        let channels: Vec<Vec<f64>> = (0..8).map(channel).collect();
        let times = |hz: f64, count: usize| (0..count).map(|k| k as f64 / hz).collect::<Vec<f64>>();
        let (video_s, log_s) = (times(30.0, angles[0].len()), times(12.5, base.len()));
        let found = correlate(
            Recording { time_s: &video_s, columns: &slices(&angles) },
            Recording { time_s: &log_s, columns: &slices(&channels) },
            LagSearch { seed: pair, ..LagSearch::default() },
        );
        found.ok().map(|found| (pair, found))
    };
    pairs.into_par_iter().filter_map(accepted).collect()
}

#[test]
fn none_of_sixty_unrelated_pairs_is_tied() {
    let tied = tied_of_unrelated(0..60);
    assert!(tied.is_empty(), "{tied:?}");
}

/// `cargo test --release --lib unrelated -- --ignored`
#[test]
#[ignore = "a minute"]
fn none_of_four_hundred_unrelated_pairs_is_tied() {
    let tied = tied_of_unrelated(60..460);
    assert!(tied.is_empty(), "{tied:?}");
}

#[test]
fn a_motion_that_repeats_itself_is_refused_unless_the_lag_is_nearly_known() {
    let sine = |t: f64| (1.5 * t).sin();
    let both = Both::new(5, [&sine, &sine], [30.0, 60.0], 25.0, -10.0);
    let why = both.correlate(LagSearch::default()).unwrap_err();
    assert!(why.contains("repeats itself") && why.matches(" s (").count() >= 2, "{why}");
    let near = LagSearch { about_s: Some(OFFSET_S + 0.4), most_s: Some(1.0), seed: 0 };
    let found = both.correlate(near).unwrap();
    assert!((found.offset_s - OFFSET_S).abs() <= 3.0 * found.offset_sd_s, "{found:?}");
}

#[test]
fn what_is_too_short_or_constant_or_apart_is_refused() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let angle = motion(&mut rng, 30);
    let short = Both::new(1, [&angle, &angle], [4.0, 60.0], 25.0, -10.0);
    assert!(short.correlate(LagSearch::default()).unwrap_err().contains("too short"));
    let mut constant = Both::new(1, [&angle, &angle], [30.0, 60.0], 25.0, -10.0);
    let far = LagSearch { about_s: Some(0.0), most_s: Some(5.0), seed: 0 };
    assert!(constant.correlate(far).unwrap_err().contains("overlap"));
    constant.angle.fill(12.0);
    assert!(constant.correlate(LagSearch::default()).unwrap_err().contains("nothing changes"));
    constant.angle.fill(f64::NAN);
    assert!(constant.correlate(LagSearch::default()).unwrap_err().contains("too few"));
}

#[test]
fn the_same_numbers_give_the_same_lag_whatever_the_threads() {
    let mut rng = ChaCha8Rng::seed_from_u64(8);
    let angle = motion(&mut rng, 30);
    let both = Both::new(8, [&angle, &angle], [30.0, 60.0], 25.0, -10.0);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| both.correlate(LagSearch::default())).unwrap()
    };
    assert_eq!(with(1), with(3));
}

/// Measured: 0.4 ms.
const LONG_S: f64 = 2e-3;

#[test]
fn an_hour_of_log_is_searched_with_few_rows() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let angle = motion(&mut rng, 30);
    let both = Both::new(3, [&angle, &angle], [300.0, 3600.0], 25.0, -1500.0);
    let found = both.correlate(LagSearch::default()).unwrap();
    assert!((found.offset_s - OFFSET_S).abs() <= LONG_S, "{found:?}");
}

fn slices(columns: &[Vec<f64>]) -> Vec<&[f64]> {
    columns.iter().map(Vec::as_slice).collect()
}

mod real_data {
    use super::*;
    use crate::real_data::real_data;

    /// Cells of a table of comma-separated values, behind gzip if its name says so.
    fn signals(name: &str) -> Vec<Vec<String>> {
        use std::io::Read as _;
        let mut text = String::new();
        let mut file = std::fs::File::open(real_data(&format!("signals/{name}"))).unwrap();
        if name.ends_with(".gz") {
            flate2::read::GzDecoder::new(file).read_to_string(&mut text).unwrap();
        } else {
            file.read_to_string(&mut text).unwrap();
        }
        text.lines().skip(1).map(|line| line.split(',').map(str::to_owned).collect()).collect()
    }

    /// Seconds of the day of `2021-10-21 09:20:58.216642589+00:00`.
    fn second_of_day(stamp: &str) -> f64 {
        let time = stamp.split(' ').nth(1).unwrap().trim_end_matches("+00:00");
        time.split(':').fold(0.0, |sum, part| sum * 60.0 + part.parse::<f64>().unwrap())
    }

    /// Times and columns.
    type Axes = (Vec<f64>, Vec<Vec<f64>>);

    fn accelerations(name: &str) -> Axes {
        let rows = signals(name);
        let time: Vec<f64> = rows.iter().map(|row| second_of_day(&row[0])).collect();
        let time = time.iter().map(|t| t - time[0]).collect();
        let axes = (1..4).map(|axis| rows.iter().map(|row| row[axis].parse().unwrap()).collect()).collect();
        (time, axes)
    }

    fn size(axes: &[Vec<f64>]) -> Vec<f64> {
        (0..axes[0].len()).map(|k| axes.iter().map(|axis| axis[k] * axis[k]).sum::<f64>().sqrt()).collect()
    }

    /// The phone's and the other clock's accelerations.
    fn sevivi() -> [Axes; 2] {
        ["sevivi/camera_imu.csv.gz", "sevivi/LF.csv.gz"].map(accelerations)
    }

    /// The published optimum, and how far from it the lag may be, seconds. Measured: 4 ms.
    const SEVIVI_S: f64 = 3.43;
    const NEAR_SEVIVI_S: f64 = 0.02;

    #[test]
    #[ignore = "needs real recordings: LUNULA_REAL_DATA"]
    fn two_inertial_logs_of_one_shaking_are_tied() {
        let [(phone_s, phone), (other_s, other)] = sevivi();
        let sizes = [vec![size(&phone)], vec![size(&other)]];
        let of = |a: (&[f64], &[Vec<f64>]), b: (&[f64], &[Vec<f64>])| {
            let (video, log) = (slices(a.1), slices(b.1));
            let recordings = [(a.0, &video), (b.0, &log)].map(|(time_s, columns)| Recording { time_s, columns });
            correlate(recordings[0], recordings[1], LagSearch::default()).unwrap()
        };
        let found = [
            of((&phone_s, &sizes[0]), (&other_s, &sizes[1])).offset_s,
            of((&phone_s, &phone), (&other_s, &other)).offset_s,
            -of((&other_s, &sizes[1]), (&phone_s, &sizes[0])).offset_s,
        ];
        assert!(found.iter().all(|found| (found - SEVIVI_S).abs() <= NEAR_SEVIVI_S), "{found:?}");
    }

    #[test]
    #[ignore = "needs real recordings: LUNULA_REAL_DATA"]
    fn a_pulse_is_not_tied_to_a_shaking() {
        let [(phone_s, phone), (other_s, other)] = sevivi();
        let mut pairs = 0;
        let mut refused = |video: Recording<'_>, log: Recording<'_>| {
            assert!(correlate(video, log, LagSearch::default()).is_err());
            pairs += 1;
        };
        let backwards: Vec<Vec<f64>> = phone.iter().map(|axis| axis.iter().rev().copied().collect()).collect();
        let shakings = [(&phone_s, &phone), (&other_s, &other)].map(|(time, axes)| (time, vec![size(axes)], axes));
        for subject in 1..=3_usize {
            let rows = signals(&format!("welltory/subject_0{subject}/PPG.csv"));
            let time: Vec<f64> = rows.iter().map(|row| 1e-3 * row[0].parse::<f64>().unwrap()).collect();
            let red: Vec<f64> = rows.iter().map(|row| row[1].parse().unwrap()).collect();
            let pulse = Recording { time_s: &time, columns: &[&red] };
            for (k, (time_s, size, axes)) in shakings.iter().enumerate() {
                // Each subject with both shakings, each shaking in all three ways.
                match (subject + k) % 3 {
                    0 => refused(pulse, Recording { time_s, columns: &slices(size) }),
                    1 => refused(pulse, Recording { time_s, columns: &slices(axes) }),
                    _ => refused(Recording { time_s, columns: &slices(axes) }, pulse),
                }
            }
        }
        let other = Recording { time_s: &other_s, columns: &slices(&shakings[1].1) };
        refused(Recording { time_s: &phone_s, columns: &[&size(&backwards)] }, other);
        assert_eq!(pairs, 7);
    }
}
