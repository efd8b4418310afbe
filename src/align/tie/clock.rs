//! The tie by the clock in the picture.
//!
//! In: the table of angles with the clock's time in each frame, and the log's times. `lunula posture` has fitted the
//! clock over the whole video: its line, standard errors and bounds are taken as they are. Of a table that has only
//! `clock_s`, a line through it is taken, whatever made it.

use super::zero::zero_s;
use super::{Tie, TieMethod};
use crate::align::posture::{ClockColumns, Posture};
use crate::clock;
use crate::median::{SD_OF_MAD, ends, median_of};
use crate::timebase::Timebase;

const RESOLUTIONS_S: [f64; 5] = [1.0, 0.1, 0.01, 1e-3, 1e-4];
/// Readings are multiples of the resolution but for so many seconds.
const ROUNDED_S: f64 = 1e-6;
/// Ties by the clock in the picture. `log_time_s` are the log's times and `midnight_s` the log's time at its midnight,
/// where its stamps are times of day.
///
/// # Errors
/// No clock in the table, one that ties nothing, or that may be tied to none or several hours or days of the log: in
/// words, with what to do.
pub(crate) fn by_clock(
    posture: &Posture,
    log_time_s: &[f64],
    midnight_s: Option<f64>,
    clock_zero_s: Option<f64>,
) -> Result<Tie, String> {
    let mut tie = by_line(posture)?;
    if let Some(clock) = &posture.clock {
        as_fitted(posture, clock, &mut tie)?;
    } else {
        tie.warnings.push(ONLY_A_LINE.to_owned());
    }
    let known = |times: &[f64]| {
        let ends = ends(times.iter().copied().filter(|t| t.is_finite()));
        (ends[0] <= ends[1]).then_some(ends)
    };
    let video_s = known(&posture.time_s).ok_or("the table of angles has no row with a time")?;
    let log_s = known(log_time_s).ok_or("the log has no row with a time")?;
    let zero = match clock_zero_s {
        Some(zero_s) if !zero_s.is_finite() => {
            return Err(format!("the log's time when the clock shows zero is {zero_s} s; it must be a number"));
        }
        Some(zero_s) => zero_s,
        None => {
            let (zero, note) = zero_s(video_s.map(|t| tie.timebase.other_s(t)), log_s, midnight_s)?;
            tie.notes.extend(note);
            zero
        }
    };
    tie.timebase.at_reference_s += zero;
    tie.offset_interval_s = tie.offset_interval_s.map(|interval| interval.map(|end| end + zero));
    let [from_s, to_s] = video_s.map(|t| tie.timebase.other_s(t));
    if to_s < log_s[0] || from_s > log_s[1] {
        return Err(format!(
            "the video and the log do not overlap: on the log's clock the video goes from {from_s:.3} to {to_s:.3} s, \
             the log from {:.3} to {:.3} s; check the log's time when the clock shows zero",
            log_s[0], log_s[1]
        ));
    }
    Ok(tie)
}

/// The largest resolution of which all readings are multiples.
pub(in crate::align) fn resolution_s(read_s: &[f64]) -> Option<f64> {
    let multiple =
        |read: f64, of: f64| (read - (read / of).round() * of).abs() <= ROUNDED_S + 4.0 * f64::EPSILON * read.abs();
    let read = || read_s.iter().copied().filter(|read| read.is_finite());
    RESOLUTIONS_S.into_iter().find(|&of| read().all(|read| multiple(read, of)))
}

const ONLY_A_LINE: &str = "the table has the clock's line but not what was read (`clock_read_s`): the standard error \
                           is the line's \
                           scatter, missing where there is none, and does not count what the clock's digits leave open";

/// Times of a line that are further off it than this, seconds, or than so many standard errors, were changed since it
/// was fitted.
const CHANGED_S: f64 = 0.01;
const CHANGED_SDS: f64 = 3.0;

/// Puts the errors of the fit that made the table in the place of the line's scatter.
///
/// # Errors
/// Times that are on no line, in words: errors of a fit are none of theirs.
fn as_fitted(posture: &Posture, clock: &ClockColumns, tie: &mut Tie) -> Result<(), String> {
    let rows: Vec<usize> = (0..posture.time_s.len()).filter(|&row| clock.sd_s[row].is_finite()).collect();
    let [Some(&first), Some(&last)] = [rows.first(), rows.last()] else { return Ok(()) };
    let scatter_s = tie.timebase.at_reference_sd_s;
    if scatter_s > CHANGED_S.max(CHANGED_SDS * clock.sd_s[rows[rows.len() / 2]]) {
        return Err(format!(
            "`clock_s` scatters by {scatter_s:.3} s about a line, and `lunula posture` writes a line: was the table \
             rounded, sorted or put together by another program? Take the table that `lunula posture` wrote"
        ));
    }
    let errors = [first, rows[rows.len() / 2], last].map(|row| [posture.time_s[row], clock.sd_s[row]]);
    tie.timebase = tie.timebase.with_errors(errors);
    tie.offset_interval_s = (posture.time_s[first] == 0.0).then(|| [clock.low_s[first], clock.high_s[first]]);
    let step_s = resolution_s(&clock.read_s).unwrap_or(0.0);
    let read = |row: usize| clock.read_s[row].is_finite();
    let off = |row: usize| tie.timebase.other_s(posture.time_s[row]) - (clock.read_s[row] + 0.5 * step_s);
    let frames = posture.time_s.len();
    let residuals_s = (0..frames).filter(|&row| read(row)).map(|row| [posture.time_s[row], off(row)]).collect();
    tie.leave_over(residuals_s, frames);
    Ok(())
}

/// Times of a fitted line are off it by their last decimal, seconds.
const FITTED_S: f64 = 2e-6;
/// Points for the median slope.
const SLOPES: usize = 400;

/// The line through `clock_s` by the median of slopes (Theil and Sen) and of heights, with the scatter as its error.
fn by_line(posture: &Posture) -> Result<Tie, String> {
    let mut seen: Vec<[f64; 2]> = std::iter::zip(&posture.time_s, &posture.clock_s)
        .map(|(&time, &clock)| [time, clock - time])
        .filter(|p| p[0].is_finite() && p[1].is_finite())
        .collect();
    seen.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let [Some(first), Some(last)] = [seen.first(), seen.last()] else {
        return Err("no clock was read in the video (`clock_s` is empty); see its .run.json for why, or tie by an \
                    offset or by correlation instead"
            .to_owned());
    };
    let span_s = last[0] - first[0];
    if seen.len() < clock::FEWEST || span_s <= 0.0 {
        return Err(format!(
            "`clock_s` has {} rows with times apart; at least {} are needed",
            seen.len(),
            clock::FEWEST
        ));
    }
    let reference_s = 0.5 * (first[0] + last[0]);
    let base = first[1];
    let apart = seen.len() / 2;
    let pairs = (seen.len() - apart).min(SLOPES);
    let slopes = (0..pairs)
        .map(|k| k * (seen.len() - apart - 1) / (pairs - 1).max(1))
        .map(|k| (seen[k], seen[k + apart]))
        .filter(|(a, b)| b[0] > a[0])
        .map(|(a, b)| (b[1] - a[1]) / (b[0] - a[0]));
    let drift = median_of(slopes).ok_or_else(|| "`clock_s` stands at too few different times".to_owned())?;
    if drift.abs() > clock::MOST_DRIFT {
        return Err(format!(
            "by `clock_s` the clock runs {:.4} times as fast as the video; frame times and clock don't belong together",
            1.0 + drift
        ));
    }
    let rise = |p: &[f64; 2]| p[1] - base - drift * (p[0] - reference_s);
    let height = median_of(seen.iter().map(rise)).unwrap_or(0.0);
    let off: Vec<[f64; 2]> = seen.iter().map(|p| [p[0], height - rise(p)]).collect();
    // The median of what is off, as a standard deviation.
    let scatter_s = SD_OF_MAD * median_of(off.iter().map(|p| p[1].abs())).unwrap_or(0.0);
    // What lies on a line to the last decimal was fitted before, and how well is not known any more.
    let sd_s = if scatter_s > FITTED_S { scatter_s } else { f64::NAN };
    let timebase = Timebase {
        reference_s,
        at_reference_s: reference_s + base + height,
        at_reference_sd_s: sd_s,
        drift,
        drift_sd: sd_s / (0.5 * span_s),
    };
    let mut tie = Tie::of(TieMethod::Clock, timebase);
    tie.leave_over(off, posture.time_s.len());
    Ok(tie)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tenths clock that counts 65.03 s at the video's time 0, filmed at 30 frames a second for 20 s.
    fn table() -> Posture {
        let time_s: Vec<f64> = (0..600).map(|k| (k as f64 / 30.0 * 1e6).round() / 1e6).collect();
        let counts = |t: &f64| 65.03 + t;
        let of = |value: &dyn Fn(&f64) -> f64| -> Vec<f64> { time_s.iter().map(value).collect() };
        Posture {
            clock_s: of(&counts),
            clock: Some(ClockColumns {
                read_s: of(&|t| (counts(t) * 10.0).floor() / 10.0),
                sd_s: of(&|t| 4e-3_f64.hypot(2e-4 * (t - 8.0))),
                low_s: of(&|t| counts(t) - 0.01),
                high_s: of(&|t| counts(t) + 0.02),
            }),
            ..Posture::of(time_s, Vec::new(), 0.0)
        }
    }

    /// Columns are rounded.
    const ROUNDING: f64 = 1e-6;

    #[test]
    fn the_errors_are_those_of_the_fit_that_made_the_table() {
        let tie = by_clock(&table(), &[60.0, 100.0], None, None).unwrap();
        let line = tie.timebase;
        assert!((line.offset_s() - 65.03).abs() <= ROUNDING && line.drift.abs() <= ROUNDING);
        assert!((line.reference_s - 8.0).abs() <= ROUNDING && (line.at_reference_sd_s - 4e-3).abs() <= ROUNDING);
        assert!((line.drift_sd - 2e-4).abs() <= ROUNDING);
        let [low, high] = tie.offset_interval_s.unwrap();
        assert!((low - 65.02).abs() <= ROUNDING && (high - 65.05).abs() <= ROUNDING);
        assert_eq!((tie.frames_read, tie.frames_abstained, tie.warnings.len() + tie.notes.len()), (600, 0, 0));
        // Even steps of a third of a tenth about its middle.
        assert!(tie.residuals_s.iter().all(|p| p[1].abs() <= 0.05 + ROUNDING) && tie.residual_rms_s.unwrap() > 0.02);
    }

    #[test]
    fn times_that_were_rounded_since_the_fit_are_refused() {
        let mut table = table();
        table.clock_s.iter_mut().for_each(|clock_s| *clock_s = (100.0 * *clock_s).round() / 100.0);
        assert!(by_clock(&table, &[60.0, 100.0], None, None).is_ok(), "hundredths are within the errors");
        table.clock_s.iter_mut().for_each(|clock_s| *clock_s = clock_s.floor());
        let why = by_clock(&table, &[60.0, 100.0], None, None).unwrap_err();
        assert!(why.contains("`clock_s` scatters by 0.3") && why.contains("rounded"), "{why}");
    }

    #[test]
    fn a_clocks_zero_may_be_given() {
        let tie = by_clock(&table(), &[1060.0, 1100.0], None, Some(1000.0)).unwrap();
        assert!((tie.timebase.offset_s() - 1065.03).abs() <= ROUNDING);
        assert!((tie.offset_interval_s.unwrap()[0] - 1065.02).abs() <= ROUNDING);
        let why = by_clock(&table(), &[60.0, 100.0], None, Some(1000.0)).unwrap_err();
        assert!(why.contains("do not overlap"), "{why}");
    }

    #[test]
    fn without_readings_the_line_is_taken_and_said_so() {
        let mut table = table();
        table.clock = None;
        table.clock_s[7] = 4000.0;
        table.clock_s[9] = f64::NAN;
        let tie = by_clock(&table, &[60.0, 100.0], None, None).unwrap();
        assert!((tie.timebase.offset_s() - 65.03).abs() <= ROUNDING);
        assert!(tie.warnings[0].contains("clock_read_s") && tie.offset_interval_s.is_none());
        assert!(tie.timebase.at_reference_sd_s.is_nan(), "a line that was fitted before");
        let mut jittered = table.clone();
        jittered.clock_s.iter_mut().enumerate().for_each(|(k, clock)| *clock += 0.015 * ((k * k) as f64).sin());
        let sd_s = by_clock(&jittered, &[60.0, 100.0], None, None).unwrap().timebase.at_reference_sd_s;
        assert!((0.005..0.03).contains(&sd_s), "{sd_s}");
        table.clock_s.fill(f64::NAN);
        assert!(by_clock(&table, &[60.0, 100.0], None, None).unwrap_err().contains("no clock was read"));
    }

    #[test]
    fn the_resolution_is_that_of_the_readings() {
        assert_eq!(resolution_s(&[1.0, 2.0, f64::NAN]), Some(1.0));
        assert_eq!(resolution_s(&[1.0, 2.1]), Some(0.1));
        assert_eq!(resolution_s(&[1_700_000_000.25, 2.1]), Some(0.01));
        assert_eq!(resolution_s(&[0.123_456]), None);
    }
}
