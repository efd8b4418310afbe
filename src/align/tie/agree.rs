//! Whether the photodiodes follow the angles at a tie that was made without them: by the clock in the picture, or by an
//! offset. Either may be right to a millisecond for another recording.
//!
//! In: angles, photodiodes and forces, the tie. Out: what share of the photodiodes' best combination the angles explain
//! there, and a warning where they explain clearly more at another lag or rate of the log, where photodiodes surely
//! answer too early or late or their lag changes, or where angles explain no more than at any lag ([`compare`]). What
//! the forces explain is taken off the photodiodes first.
//!
//! Limits are from 105 phantoms of 15 kinds of motion (20 to 900 s), as they are, with the log of another seed, a
//! second late, and at 25/24 of its rate; a test counts on others (`how_many_pairs_are_warned_of`).

use lunula_predictor::{Deficient, LeastSquaresOptions, least_squares};
use ndarray::{Array2, ArrayView1};
use rayon::prelude::*;

use super::Tie;
use super::correlate::{Candidate, Correlated, Grid, LagSearch, Recording, correlate, explained};
use super::correlation::drift_by;
use crate::align::posture::Posture;
use crate::log::{Channel, Samples};

/// Photodiodes follow the finger by so much, seconds: some 0.05 s in bending, 0.1 to 0.4 s in pressing.
const LAGS_S: [f64; 2] = [-0.3, 0.45];
/// Where they seem to answer so long before it, seconds, the tie is doubtful even so (measured at right ties of seven
/// phantoms: -0.10 at least).
const EARLY_S: f64 = -0.2;
/// Photodiodes follow a force by a lag of so many seconds, of first order; a force that varies by less (standard
/// deviation, newtons) is of a finger that does not press. Of lags of 0 to 0.5 s and their products this one left most
/// ties that are off to be seen (`how_many_pairs_are_warned_of`).
const FORCE_TAU_S: f64 = 0.3;
const PRESSES_N: f64 = 0.02;
/// The lag is looked for so far away, seconds; it is off, or changes, where it does by so many standard errors. A
/// change of less over what is compared does not matter, seconds. Measured of 84 phantoms of 60 s at their own ties:
/// lags of -0.03 to 0.12 s, which change by at most 2.6 standard errors.
const AWAY_S: f64 = 1.5;
const SURE_SDS: f64 = 3.0;
const DRIFTS_S: f64 = 0.1;
/// An angle that varies by less than this (standard deviation) is of a still finger, degrees.
const BENDS_DEG: f64 = 3.0;
/// So much more is gained elsewhere (twice the logarithm of a likelihood), and so much explained there at least.
const MORE: f64 = 12.0;
const WELL: f64 = 0.65;
/// Where so much is explained, no rate of the log is looked for.
const ALL: f64 = 0.97;
/// Of longer videos so much is compared, seconds: the part in which the finger moves most.
const MOST_S: f64 = 300.0;
/// Where angles explain less than the first share nothing is said, nor less than the second where so many of the other
/// lags explain as much, nor where more of them do.
const LITTLE: [f64; 2] = [0.25, 0.45];
const OTHERS: [f64; 2] = [0.003, 0.04];
/// Rates of the log are tried that make so many seconds over the video, none further off than the last; and these.
const LONGER_S: [f64; 12] = [-3.0, -2.5, -2.0, -1.5, -1.0, -0.5, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0];
const MOST_RATE: f64 = 0.1;
const USUAL_RATES: [f64; 2] = [24.0 / 25.0, 25.0 / 24.0];

/// What the comparison says.
#[derive(Debug, Clone, Default, PartialEq)]
pub(in crate::align) struct Agreement {
    pub(in crate::align) warnings: Vec<String>,
    pub(in crate::align) notes: Vec<String>,
}

/// Compares them; where that is not possible a note says why.
pub(in crate::align) fn compare(posture: &Posture, samples: &Samples, tie: &Tie) -> Agreement {
    let mut said = Agreement::default();
    match agreement(posture, samples, tie) {
        Ok(Ok(note)) => said.notes.push(note),
        Ok(Err(warning)) => said.warnings.push(warning),
        Err(why) => said.notes.push(format!("the photodiodes can't say whether the tie is right: {why}")),
    }
    said
}

/// What speaks for the tie, or against it; or why nothing does.
fn agreement(posture: &Posture, samples: &Samples, tie: &Tie) -> Result<Result<String, String>, String> {
    let angles: Vec<&[f64]> =
        posture.angles_deg.iter().map(Vec::as_slice).filter(|angle| sd(angle) >= BENDS_DEG).collect();
    if angles.is_empty() {
        return Err(format!("no angle varies by {BENDS_DEG} degrees"));
    }
    if samples.photodiodes.is_empty() {
        return Err("the log has none".to_owned());
    }
    let rows = liveliest(&posture.time_s, &angles);
    let angles: Vec<&[f64]> = angles.iter().map(|angle| &angle[rows.clone()]).collect();
    let video = Recording { time_s: &posture.time_s[rows], columns: &angles };
    let near = Near::new(video.time_s, samples, tie);
    let curve = near.curve(video, 1.0, LagSearch::default())?;
    let is_answer = |(lag_s, _): &(f64, Candidate)| (LAGS_S[0]..=LAGS_S[1]).contains(lag_s);
    let (answers, others): (Curve, Curve) = curve.into_iter().partition(is_answer);
    let Some((lag_s, here)) = top(&answers) else { return Err("too little of video and log overlaps".to_owned()) };
    let share = 100.0 * explained(here.left);
    let clearly = |found: &(f64, Candidate)| clearly_more(&found.1, &here);
    let lag = top(&others).filter(|(_, there)| there.gain > here.gain);
    let rated = if share < 100.0 * ALL { near.best_rate(video).filter(clearly) } else { None };
    // A rate has a lag of its own: where a lag alone does about as well, it is that.
    let (later, rated) = match (lag, rated) {
        (Some(lag), Some(rated)) if !clearly_more(&rated.1, &lag.1) => (Some(lag), None),
        (lag, rated) => (lag.filter(clearly), rated),
    };
    if let Some((rate, there)) = rated {
        return Ok(Err(format!(
            "the photodiodes would follow the angles far better if the log's clock ran {rate:.3} times as fast: the \
             angles explain {:.0} % of their best combination then, {share:.0} % now; are the log's times counted at \
             the right rate?",
            100.0 * explained(there.left)
        )));
    }
    if let Some((lag_s, there)) = later {
        return Ok(Err(format!(
            "photodiodes answer within {} s, but by this tie they follow the angles best {:.2} s {}: the angles \
             explain {:.0} % of their best combination there, {share:.0} % here; are both files of one recording, and \
             is the log's clock what ties them?",
            LAGS_S[1],
            lag_s.abs(),
            if lag_s > 0.0 { "later" } else { "before them" },
            100.0 * explained(there.left)
        )));
    }
    let columns: Vec<&[f64]> = near.channels.iter().map(Vec::as_slice).collect();
    let search = LagSearch { about_s: Some(0.0), most_s: Some(AWAY_S), ..LagSearch::default() };
    if let Ok(found) = correlate(video, Recording { time_s: &near.time_s, columns: &columns }, search)
        && let Some(against) = drifts(&found, near.span_s).or_else(|| is_off(&found))
    {
        return Ok(Err(against));
    }
    let as_much = others.iter().filter(|(_, there)| there.gain >= here.gain).count() as f64;
    let as_much = as_much / others.len().max(1) as f64;
    if as_much > OTHERS[1] || share < 100.0 * LITTLE[1] && as_much > OTHERS[0] || share < 100.0 * LITTLE[0] {
        return Ok(Err(format!(
            "at this tie the angles explain {share:.0} % of the photodiodes' best combination, and as much at {:.1} % \
             of all other lags: nothing in them says that both files are of one recording",
            100.0 * as_much
        )));
    }
    let hardly = if lag_s < EARLY_S {
        "; but photodiodes do not answer so long before a finger moves: is the tie off by so much?"
    } else {
        ""
    };
    Ok(Ok(format!(
        "the photodiodes agree with the tie: the angles explain {share:.0} % of their best combination, {:.2} s {} \
         them{hardly}",
        lag_s.abs(),
        if lag_s < 0.0 { "after" } else { "before" }
    )))
}

/// What the lags of both halves say of the rate at which the log's clock runs.
fn drifts(found: &Correlated, span_s: f64) -> Option<String> {
    let ([first, second], [drift, sd]) = (found.halves?, drift_by(found)?);
    (drift.abs() > SURE_SDS * sd && drift.abs() * span_s > DRIFTS_S).then(|| {
        format!(
            "photodiodes answer {:.2} s after the finger in the first half of what is compared and {:.2} s in the \
             second, as if the log's clock ran {:.4} +- {sd:.4} times as fast as this tie has it; are the video's \
             frames and the log's samples counted at the rates at which they were recorded?",
            first.offset_s,
            second.offset_s,
            1.0 + drift
        )
    })
}

/// Whether photodiodes surely answer earlier or later than they can.
fn is_off(found: &Correlated) -> Option<String> {
    let reach_s = SURE_SDS * found.offset_sd_s;
    let (early, late) = (found.offset_s + reach_s < EARLY_S, found.offset_s - reach_s > LAGS_S[1]);
    (early || late).then(|| {
        format!(
            "by this tie photodiodes answer {:.2} +- {:.2} s {} the finger moves, and they answer within {} s after \
             it: is the tie off by so much?",
            found.offset_s.abs(),
            found.offset_sd_s,
            if late { "after" } else { "before" },
            LAGS_S[1]
        )
    })
}

/// The rows in which the angles change most, of a video that is too long to be compared as a whole.
fn liveliest(time_s: &[f64], angles: &[&[f64]]) -> std::ops::Range<usize> {
    let [Some(first_s), Some(last_s)] = [time_s.first(), time_s.last()] else { return 0..0 };
    let rows = |from_s: f64| time_s.partition_point(|&t| t < from_s)..time_s.partition_point(|&t| t <= from_s + MOST_S);
    let moved = |rows: &std::ops::Range<usize>| {
        let steps =
            angles.iter().flat_map(|angle| angle[rows.clone()].windows(2)).map(|pair| (pair[1] - pair[0]).abs());
        steps.filter(|step| step.is_finite()).sum::<f64>()
    };
    let parts = ((last_s - first_s) / (0.25 * MOST_S)).ceil().max(4.0) as usize - 3;
    let parts = (0..parts).map(|part| rows(first_s + 0.25 * MOST_S * part as f64)).map(|rows| (moved(&rows), rows));
    parts.reduce(|most, part| if part.0 > most.0 { part } else { most }).map_or(0..0, |(_, rows)| rows)
}

/// Lags or rates, and what is explained there.
type Curve = Vec<(f64, Candidate)>;

fn top(curve: &Curve) -> Option<(f64, Candidate)> {
    curve.iter().copied().reduce(|best, at| if at.1.gain > best.1.gain { at } else { best })
}

fn clearly_more(there: &Candidate, here: &Candidate) -> bool {
    let by_left = there.samples.min(here.samples) * (here.left - there.left);
    by_left.min(there.gain - here.gain) > MORE && explained(there.left) >= WELL
}

/// The log's rows about the video, on the video's time by the tie.
struct Near {
    time_s: Vec<f64>,
    channels: Vec<Vec<f64>>,
    middle_s: f64,
    span_s: f64,
}

impl Near {
    /// Rows within half of the video's length before and after it: no other lags are needed.
    fn new(angle_s: &[f64], samples: &Samples, tie: &Tie) -> Self {
        let [first_s, last_s] = [angle_s[0], angle_s[angle_s.len() - 1]];
        let span_s = last_s - first_s;
        let video_s = |&row: &usize| tie.timebase.own_s(samples.time_s[row]);
        let about = first_s - 0.5 * span_s..=last_s + 0.5 * span_s;
        let rows: Vec<usize> = (0..samples.time_s.len()).filter(|row| about.contains(&video_s(row))).collect();
        let of = |channel: &Channel| rows.iter().map(|&row| channel.values[row]).collect::<Vec<f64>>();
        let mut channels: Vec<Vec<f64>> = samples.photodiodes.iter().map(of).collect();
        let time_s: Vec<f64> = rows.iter().map(video_s).collect();
        without_forces(&time_s, &mut channels, &samples.forces.iter().map(of).collect::<Vec<_>>());
        Self { time_s, channels, middle_s: 0.5 * (first_s + last_s), span_s }
    }

    /// What is explained at each lag if the log's clock runs `rate` times as fast, as by the tie in the middle of the
    /// video.
    fn curve(&self, video: Recording<'_>, rate: f64, search: LagSearch) -> Result<Curve, String> {
        let time_s: Vec<f64> = self.time_s.iter().map(|t| self.middle_s + (t - self.middle_s) * rate).collect();
        let columns: Vec<&[f64]> = self.channels.iter().map(Vec::as_slice).collect();
        let grid = Grid::new(video, Recording { time_s: &time_s, columns: &columns }, &search)?;
        Ok(grid.curve(&grid.channels).into_iter().map(|at| (grid.at_s(at.lag), at)).collect())
    }

    /// The rate, other than the log's own, by which most is explained.
    fn best_rate(&self, video: Recording<'_>) -> Option<(f64, Candidate)> {
        let longer = LONGER_S.map(|longer_s| 1.0 + longer_s / self.span_s);
        let rates: Vec<f64> =
            longer.into_iter().filter(|rate| (rate - 1.0).abs() <= MOST_RATE).chain(USUAL_RATES).collect();
        let at = |&rate: &f64| {
            // Wherever in the video the log's clock was right.
            let most_s = LAGS_S[1] + 0.5 * (rate - 1.0).abs() * self.span_s;
            let about = LagSearch { about_s: Some(0.0), most_s: Some(most_s), ..LagSearch::default() };
            Some((rate, top(&self.curve(video, rate, about).ok()?)?.1))
        };
        top(&rates.par_iter().filter_map(at).collect())
    }
}

/// Takes off the channels what the forces explain: a polynomial of them, of first and third powers and products of two,
/// and what they were a little before.
fn without_forces(time_s: &[f64], channels: &mut [Vec<f64>], forces: &[Vec<f64>]) {
    let rows = forces.first().map_or(0, Vec::len);
    let known: Vec<usize> =
        (0..rows).filter(|&row| forces.iter().chain(channels.iter()).all(|column| column[row].is_finite())).collect();
    let forces: Vec<&Vec<f64>> = forces.iter().filter(|force| sd(force) >= PRESSES_N).collect();
    let behind: Vec<Vec<f64>> = forces.iter().map(|force| late(time_s, force)).collect();
    let terms = |row: &usize| {
        let f: Vec<f64> = forces.iter().map(|force| force[*row]).collect();
        let products = (0..f.len()).flat_map(|i| (0..=i).map(move |j| (i, j))).map(|(i, j)| f[i] * f[j]);
        let cubes = f.iter().map(|f| f.powi(3));
        f.iter()
            .copied()
            .chain(products)
            .chain(cubes)
            .chain(behind.iter().map(|force| force[*row]))
            .collect::<Vec<f64>>()
    };
    let width = forces.len() * (forces.len() + 7) / 2;
    let design = Array2::from_shape_vec((known.len(), width), known.iter().flat_map(terms).collect());
    let design = design.expect("every row has as many terms");
    let measured = Array2::from_shape_fn((known.len(), channels.len()), |(k, channel)| channels[channel][known[k]]);
    // What never changes, as a force that is 0, explains nothing.
    let options = LeastSquaresOptions { deficient: Deficient::MinimumNorm, ..LeastSquaresOptions::default() };
    let Ok(fit) = least_squares(design.view(), measured.view(), &options) else { return };
    let explained = (design - ArrayView1::from(&fit.centre)).dot(&fit.coefficients.t());
    for (channel, (values, centre)) in channels.iter_mut().zip(&fit.target_centre).enumerate() {
        known.iter().zip(explained.column(channel)).for_each(|(&row, explained)| values[row] -= centre + explained);
    }
}

/// A force as it was a little before; where it is missing, as before.
fn late(time_s: &[f64], force: &[f64]) -> Vec<f64> {
    let first = force.iter().copied().find(|value| value.is_finite()).unwrap_or(f64::NAN);
    let mut last = (time_s.first().copied().unwrap_or_default(), first);
    let follow = |(&at_s, &value): (&f64, &f64)| {
        let share = 1.0 - ((last.0 - at_s) / FORCE_TAU_S).exp();
        last.1 += if value.is_finite() { share * (value - last.1) } else { 0.0 };
        last.0 = at_s;
        last.1
    };
    time_s.iter().zip(force).map(follow).collect()
}

/// The standard deviation of what is known.
fn sd(column: &[f64]) -> f64 {
    let known = || column.iter().filter(|v| v.is_finite());
    let count = known().count().max(1) as f64;
    let mean = known().sum::<f64>() / count;
    (known().map(|v| (v - mean).powi(2)).sum::<f64>() / count).sqrt()
}

#[cfg(test)]
mod tests {
    use super::super::correlation::tests::phantom;
    use super::super::{TieMethod, by_offset};
    use super::*;
    use crate::phantom::force::ForceTrajectory;
    use crate::phantom::trajectory::Trajectory;

    /// A log whose clock counts at `rate` from 60 s on.
    fn at_rate(log: &Samples, rate: f64) -> Samples {
        Samples { time_s: log.time_s.iter().map(|t| 60.0 + (t - 60.0) * rate).collect(), ..log.clone() }
    }

    /// What is said of the angles of one phantom of 60 s and the photodiodes of another, whose clock is ahead by
    /// `offset_s` and counts at `rate`.
    fn said(seeds: [u64; 2], offset_s: f64, rate: f64) -> Agreement {
        let recordings = seeds.map(|seed| phantom(seed, Trajectory::Random { hz: 0.1, seed }, ForceTrajectory::None));
        let [(posture, _), (_, samples)] = recordings;
        let tie = by_offset(offset_s, None).unwrap();
        assert_eq!(tie.method, TieMethod::Offset);
        compare(&posture, &at_rate(&samples, rate), &tie)
    }

    #[test]
    fn photodiodes_speak_for_the_tie_of_their_own_recording_only() {
        for seed in 3..7 {
            let own = said([seed, seed], 60.0, 1.0);
            assert!(own.warnings.is_empty() && own.notes[0].contains("agree with the tie"), "{own:?}");
            let later = said([seed, seed], 59.0, 1.0).warnings.concat();
            assert!(later.contains("follow the angles best 1.0") && later.contains(" s later"), "{later}");
            let earlier = said([seed, seed], 62.0, 1.0).warnings.concat();
            assert!(earlier.contains("follow the angles best 1.9") && earlier.contains("before them"), "{earlier}");
            let other = said([seed, seed + 1], 60.0, 1.0).warnings.concat();
            assert!(other.contains("of one recording"), "{other}");
        }
    }

    #[test]
    fn a_second_is_no_rate_and_half_a_second_no_agreement_without_a_word() {
        for seed in [5, 6] {
            let pressing = ForceTrajectory::Random { hz: 0.1, seed: seed + 100 };
            let (posture, samples) = phantom(seed, Trajectory::Random { hz: 0.1, seed }, pressing);
            let at = |offset_s: f64| compare(&posture, &samples, &by_offset(offset_s, None).unwrap());
            for offset_s in [59.0, 61.0] {
                let said = at(offset_s).warnings.concat();
                assert!(!said.contains("times as fast"), "{said}");
            }
            let early = at(60.5);
            assert!(!early.warnings.is_empty() || early.notes[0].contains("is the tie off by so much"), "{early:?}");
            assert!(!at(60.0).notes[0].contains("is the tie off by so much"), "{:?}", at(60.0));
        }
    }

    #[test]
    fn half_a_second_and_half_a_percent_are_warned_of_where_the_finger_moves_fast() {
        for seed in 3..7 {
            let pressing = ForceTrajectory::Random { hz: 0.3, seed: seed + 100 };
            let (posture, own) = phantom(seed, Trajectory::Random { hz: 0.3, seed }, pressing);
            let at = |offset_s: f64| compare(&posture, &own, &by_offset(offset_s, None).unwrap()).warnings.concat();
            let [late, own_tie, early] = [59.5, 60.0, 60.5].map(at);
            assert!(own_tie.is_empty() && !late.is_empty() && !early.is_empty(), "{late}; {own_tie}; {early}");
            assert!(late.contains(" 0.5") && !early.contains("after the finger"), "{late}; {early}");
            let (posture, own) = phantom(seed, Trajectory::Random { hz: 0.3, seed }, ForceTrajectory::None);
            let tie = by_offset(60.0, None).unwrap();
            let rated = |rate: f64| compare(&posture, &at_rate(&own, rate), &tie).warnings.concat();
            let [right, percent, half, third] = [1.0, 1.01, 0.995, 1.003].map(rated);
            assert!(right.is_empty(), "{right}");
            assert!([&percent, &half].iter().all(|said| said.contains("times as fast")), "{percent}; {half}");
            assert!(third.contains("as if the log's clock ran 1.00") && third.contains("in the second"), "{third}");
        }
    }

    #[test]
    fn a_log_that_is_counted_at_a_wrong_rate_is_seen() {
        for seed in 3..7 {
            let rated = said([seed, seed], 60.0, 25.0 / 24.0).warnings.concat();
            assert!(rated.contains("ran 0.960 times as fast"), "{rated}");
        }
    }

    /// How many of how many pairs are warned of: 60 s of random bending, of bending evenly over the range, slower and
    /// faster, and with random forces; with the own log, that of another finger, a second and half a second late and
    /// early, and at 25/24, 1.01 and 0.995 of the rate; and of how many a wrong rate is said.
    ///
    /// `cargo test --release --lib how_many_pairs -- --ignored --nocapture`
    #[test]
    #[ignore = "minutes, and prints figures"]
    fn how_many_pairs_are_warned_of() {
        const SEEDS: u64 = 20;
        let random = |hz: f64, seed: u64| Trajectory::Random { hz, seed };
        let pressing = |hz: f64, seed: u64| ForceTrajectory::Random { hz, seed: seed + 100 };
        let kinds = |seed: u64| {
            [
                ("random", random(0.1, seed), ForceTrajectory::None),
                ("even", Trajectory::Even { hz: 0.1, seed }, ForceTrajectory::None),
                ("slow", random(0.05, seed), ForceTrajectory::None),
                ("fast", random(0.3, seed), ForceTrajectory::None),
                ("random, pressing", random(0.1, seed), pressing(0.1, seed)),
                ("even, pressing", Trajectory::Even { hz: 0.1, seed }, pressing(0.1, seed)),
                ("fast, pressing", random(0.3, seed), pressing(0.3, seed)),
            ]
        };
        for kind in 0..kinds(0).len() {
            let of = |seed: u64| {
                let (_, trajectory, force) = kinds(seed)[kind].clone();
                phantom(seed, trajectory, force)
            };
            let warned = |seed: u64| {
                let (posture, own) = of(seed);
                let (_, other) = of(seed + 1);
                let ties = [
                    (&own, 60.0, 1.0),
                    (&other, 60.0, 1.0),
                    (&own, 59.0, 1.0),
                    (&own, 61.0, 1.0),
                    (&own, 59.5, 1.0),
                    (&own, 60.5, 1.0),
                    (&own, 60.0, 25.0 / 24.0),
                    (&own, 60.0, 1.01),
                    (&own, 60.0, 0.995),
                ];
                ties.map(|(log, offset_s, rate)| {
                    let tie = by_offset(offset_s, None).unwrap();
                    let said = compare(&posture, &at_rate(log, rate), &tie).warnings.concat();
                    [!said.is_empty(), said.contains("times as fast")].map(u64::from)
                })
            };
            let all: Vec<[[u64; 2]; 9]> = (0..SEEDS).into_par_iter().map(warned).collect();
            let sum = |k: usize, what: usize| all.iter().map(|warned| warned[k][what]).sum::<u64>();
            let [counts, rates] = [0, 1].map(|what| [0, 1, 2, 3, 4, 5, 6, 7, 8].map(|k| sum(k, what)));
            let name = kinds(0)[kind].0;
            println!(
                "{name}: of {SEEDS} own, others, 1 s late, early, 0.5 s late, early, 1.042, 1.01, 0.995 times as fast: \
                 {counts:?}, a rate: {rates:?}"
            );
            assert!(counts[0] <= 4 && counts[1..4].iter().all(|count| 4 * count >= 3 * SEEDS), "{name} {counts:?}");
        }
    }

    #[test]
    fn a_still_finger_and_a_log_without_photodiodes_say_nothing() {
        let (posture, mut samples) = phantom(3, Trajectory::Rest, ForceTrajectory::None);
        let tie = by_offset(60.0, None).unwrap();
        let still = compare(&posture, &samples, &tie);
        assert!(still.warnings.is_empty() && still.notes[0].contains("no angle varies by 3 degrees"), "{still:?}");
        let (posture, _) = phantom(3, Trajectory::Random { hz: 0.1, seed: 3 }, ForceTrajectory::None);
        samples.photodiodes.clear();
        assert!(compare(&posture, &samples, &tie).notes[0].contains("the log has none"));
    }

    #[test]
    fn what_forces_explain_is_taken_off() {
        let force = |k: usize| ((k * k) as f64 * 0.01).sin();
        let bends = |k: usize| (0.37 * k as f64).cos();
        let mut channels = vec![(0..500).map(|k| 2.0 + force(k) - 0.5 * force(k).powi(2) + bends(k)).collect()];
        let time_s: Vec<f64> = (0..500).map(|k| 0.1 * k as f64).collect();
        without_forces(&time_s, &mut channels, &[(0..500).map(force).collect(), vec![0.0; 500]]);
        let off: f64 = (0..500).map(|k| (channels[0][k] - bends(k)).powi(2)).sum::<f64>() / 500.0;
        assert!(off < 0.02, "{off}");
        let mut alone = vec![vec![1.0, f64::NAN, 3.0]];
        without_forces(&[0.0, 1.0, 2.0], &mut alone, &[]);
        assert_eq!((alone[0][0], alone[0][2]), (1.0, 3.0));
    }
}
