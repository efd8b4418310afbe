//! Readings of a whole video to the clock's time in the video's, with an interval that holds the truth.
//!
//! In: each frame's presentation time and what the clock in it was read to show, or none. Out: a [`ClockFit`], or a
//! [`ClockFault`] in words.
//!
//! A clock of resolution `r` shows `R` at the video's time `t` if its count `c` at the screen's last refresh, at most
//! the screen's interval `T` before `t`, obeys `R <= c < R + r`. So `R <= c(t) < R + r + T`, whatever the phases. With
//! `c(t) = t + offset + drift t` every reading bounds offset and drift from two sides; all of them leave a convex
//! polygon, whose extent is the interval. The estimate is the mean over the polygon, and the standard errors are those
//! about it, with all offsets alike and drifts as those of quartz clocks ([`USUAL_DRIFT`]); the interval counts every
//! drift up to [`MOST_DRIFT`]. Readings that disagree with most others are refused before. How late the screen shows is
//! found where the readings tell (module `screen`). Where another rate than the video's explains clearly more readings,
//! or the same without a late screen, the frames' times are not those of the recording, and there is no line.
//!
//! Where the frames come in the rhythm of the digits, the estimate may lie anywhere in the interval, and 0.58 of all
//! lie within a standard error, as of a uniform distribution. A screen of exactly 60 refreshes shows every tenth
//! equally late: then its delay can't be separated from the offset, nor slow drift from none, by any number of frames.
//!
//! What is not determined: a lag that the whole display adds (a screen's processing, slow pixels; [`ClockFit::delayed`]
//! takes one that was measured), and where in the exposure the frame's time lies.

mod consensus;
mod diagnose;
mod fault;
mod polygon;
mod screen;
#[cfg(test)]
mod tests;

pub use fault::ClockFault;

use self::consensus::{Agreed, Seen};
use self::polygon::{Hulls, Moments, Point, moments};
use crate::median::ends;
use crate::timebase::Timebase;

/// A clock drifts no more than this: files whose frame times are those of 30 frames a second though 29.97 were taken
/// are a thousandth off.
pub const MOST_DRIFT: f64 = 2e-3;
/// Readings that must agree.
pub const FEWEST: usize = 3;
/// A screen of unknown rate may show what it shows up to this late, seconds: 60 refreshes a second, the slowest
/// that is usual.
pub const USUAL_SCREEN_S: f64 = 1.0 / 60.0;
/// Two clocks of quartz drift so much against each other: the scale of the distribution, Cauchy's, that the estimate
/// weighs drifts with.
pub const USUAL_DRIFT: f64 = 5e-5;
/// One reading in so many may disagree, or more in no more stretches than these.
const MISREAD: usize = 10;
const STRETCHES: usize = 2;
/// What changes its digits later than this is no running clock, seconds.
const SLOWEST_SCREEN_S: f64 = 0.1;

/// How late the screen shows what the clock counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ScreenDelay {
    /// From the rate that was given.
    Given,
    /// From the readings: the screen changes late now and then, by so much.
    Found,
    /// Unknown; none is subtracted, and the interval and the standard error count a usual screen.
    Assumed,
}

/// The clock's time in the video's.
#[derive(Debug, Clone, PartialEq)]
pub struct ClockFit {
    /// The clock's time in the video's.
    pub timebase: Timebase,
    /// The least and the greatest offset (the clock's time at the video's time 0) that agree with every accepted
    /// reading, seconds.
    pub offset_interval_s: [f64; 2],
    /// The least and the greatest drift.
    pub drift_interval: [f64; 2],
    /// For each frame what the clock was read to show, if the reading agrees with the rest; goes on where the clock
    /// begins again.
    pub accepted_s: Vec<Option<f64>>,
    /// Readings that disagree with the rest.
    pub refused: usize,
    /// For each accepted reading the frame's time and the line less the middle of what the reading allows, seconds.
    pub residuals_s: Vec<[f64; 2]>,
    /// Root mean square of the residuals, seconds; 0.29 of the resolution for a clock that is read without fault.
    pub residual_rms_s: f64,
    /// How the screen's delay is known.
    pub screen: ScreenDelay,
    /// The longest that the estimate takes the screen to wait before it shows the next reading, seconds; half of it is
    /// taken off.
    pub screen_delay_s: f64,
    /// The longest that the interval counts, seconds.
    pub screen_delay_most_s: f64,
    /// What whoever uses the fit should doubt.
    pub doubt: Option<String>,
    delay_s: [f64; 2],
    place: Place,
    corners: Vec<Point>,
}

/// Where the plane of lines lies: heights are the clock's less `shown_s` at the video's time `time_s`, and `end` is
/// reached `half_s` later.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Place {
    time_s: f64,
    shown_s: f64,
    half_s: f64,
}

impl Place {
    fn clock_s(&self, line: &Point, time_s: f64) -> f64 {
        let since_s = time_s - self.time_s;
        self.shown_s + (since_s + line[0] + line[1] * since_s / self.half_s)
    }
}

impl ClockFit {
    /// The least and the greatest that the clock may count at the video's time `time_s`, seconds.
    #[must_use]
    pub fn bounds_s(&self, time_s: f64) -> [f64; 2] {
        let shown_s = ends(self.corners.iter().map(|corner| self.place.clock_s(corner, time_s)));
        [shown_s[0] + self.delay_s[0], shown_s[1] + self.delay_s[1]]
    }

    /// The same of a display that shows everything at least and at most so many seconds late: the clock counts more
    /// than it shows, by the middle of the two, and what is between them is in interval and standard error (of a
    /// uniform distribution).
    #[must_use]
    pub fn delayed(mut self, delay_s: [f64; 2]) -> Self {
        let [least_s, most_s] = delay_s;
        self.delay_s = delay_s;
        self.timebase.at_reference_s += 0.5 * (least_s + most_s);
        self.timebase.at_reference_sd_s = self.timebase.at_reference_sd_s.hypot((most_s - least_s) / 12f64.sqrt());
        self.offset_interval_s = self.bounds_s(0.0);
        self
    }
}

/// Fits a clock of resolution `resolution_s` to what was read in frames at `times_s` (any order; frames without a
/// finite time or reading don't count): `shown_s` as the digits mean, not unwrapped; `wraps_s` what it may show before
/// it begins again, one of which is chosen; `refresh_hz` how often its screen changes a second, infinite where it shows
/// at once, none where that is not known.
///
/// # Errors
/// Why there is no such line, with the place.
pub fn fit(
    times_s: &[f64],
    shown_s: &[Option<f64>],
    resolution_s: f64,
    wraps_s: &[f64],
    refresh_hz: Option<f64>,
) -> Result<ClockFit, ClockFault> {
    if !(resolution_s > 0.0 && resolution_s.is_finite()) {
        return Err(ClockFault::Resolution { resolution_s });
    }
    let mut seen: Vec<Seen> = std::iter::zip(times_s, shown_s)
        .enumerate()
        .filter_map(|(index, (&time_s, &shown_s))| Some(Seen { index, time_s, shown_s: shown_s? }))
        .filter(|seen| seen.time_s.is_finite() && seen.shown_s.is_finite())
        .collect();
    seen.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
    let (read, frames) = (seen.len(), times_s.len());
    let too_few = |agree| ClockFault::TooFew { read, agree, frames, fewest: FEWEST };
    if seen.len() < FEWEST {
        return Err(too_few(seen.len()));
    }
    let (first, last) = (seen[0], seen[seen.len() - 1]);
    let half_s = (0.5 * (last.time_s - first.time_s)).max(resolution_s);
    let place = Place { time_s: 0.5 * (first.time_s + last.time_s), shown_s: first.shown_s, half_s };
    // Stamps in tables are rounded to microseconds, and large numbers as far as they must be.
    let slack_s = 1e-6 + 4.0 * f64::EPSILON * (place.shown_s.abs() + place.time_s.abs());
    for seen in &mut seen {
        seen.time_s -= place.time_s;
        seen.shown_s -= place.shown_s;
    }
    let redrawn_s = screen::redrawn_s(&seen, resolution_s);
    let given_s = refresh_hz.filter(|&hz| hz > 0.0).map(|hz| 1.0 / hz);
    let usual_s = given_s.unwrap_or(USUAL_SCREEN_S).max(redrawn_s.unwrap_or(0.0));
    let mut agreed = most_agreed(&seen, resolution_s, usual_s, wraps_s);
    match diagnose::diagnose(&seen, &agreed, resolution_s, resolution_s + usual_s, place.time_s, place.shown_s) {
        Ok(()) | Err(ClockFault::Contradictory { .. }) if agreed.count < FEWEST => return Err(too_few(agreed.count)),
        other => other?,
    }
    if let Some(rate) = diagnose::rate_for_refused(&seen, &agreed, resolution_s + usual_s, wraps_s) {
        return Err(ClockFault::Rate { rate });
    }
    let most_end_s = MOST_DRIFT * half_s;
    let (hulls, least_s) = loop {
        let hulls = Hulls::new(agreed_points(&seen, &agreed, slack_s), half_s);
        let late_s = hulls.least_room(most_end_s).0 - resolution_s - 2.0 * slack_s;
        if late_s <= SLOWEST_SCREEN_S.max(usual_s) {
            break (hulls, late_s);
        }
        refuse_worst(&seen, &mut agreed, &hulls, most_end_s);
        if 2 * agreed.count < seen.len() || agreed.count < FEWEST {
            return Err(diagnose::contradictory(&seen, &agreed, place.time_s));
        }
    };
    if is_misread(&agreed) {
        return Err(diagnose::contradictory(&seen, &agreed, place.time_s));
    }
    let points: Vec<Point> = agreed_points(&seen, &agreed, slack_s).collect();
    let room_s = resolution_s + 2.0 * slack_s + usual_s;
    if let Some(fault) = diagnose::late(&points, &hulls, room_s, least_s - usual_s, place.time_s) {
        return Err(fault);
    }
    let mut accepted_s = vec![None; times_s.len().min(shown_s.len())];
    for (seen, turns_s) in seen.iter().zip(&agreed.turns_s) {
        accepted_s[seen.index] = shown_s[seen.index].zip(*turns_s).map(|(shown, turns)| shown + turns);
    }
    let interval_s = (last.time_s - first.time_s) / accepted_s.len() as f64;
    let screen = screen::delay(least_s, screen::dead_s(&accepted_s, resolution_s, interval_s), given_s, redrawn_s);
    let polygon = |late_s: f64| hulls.polygon(resolution_s + late_s + 2.0 * slack_s, most_end_s);
    let corners = polygon(screen.most_s);
    let usual_end_s = USUAL_DRIFT * half_s;
    let of = |corners: &[Point]| moments(corners, usual_end_s).expect("a screen this late agrees with all");
    let mut moments = of(&polygon(screen.estimate_s));
    if screen.estimate_s < screen.most_s {
        // The delay may be anything that the screen allows, and another at the end than at the beginning.
        moments.widen(&of(&corners));
    }
    let extent = |of: &dyn Fn(&Point) -> f64| ends(corners.iter().map(of));
    let timebase = timebase(&moments, &place);
    let residual = |(&time_s, read_s): (&f64, &Option<f64>)| {
        let middle_s = (*read_s)? + 0.5 * (resolution_s + screen.estimate_s);
        Some([time_s, timebase.other_s(time_s) - middle_s])
    };
    let residuals_s: Vec<[f64; 2]> = times_s.iter().zip(&accepted_s).filter_map(residual).collect();
    let squares: f64 = residuals_s.iter().map(|r| r[1] * r[1]).sum();
    Ok(ClockFit {
        timebase,
        offset_interval_s: extent(&|corner| place.clock_s(corner, 0.0)),
        drift_interval: extent(&|corner| corner[1] / half_s),
        accepted_s,
        refused: seen.len() - agreed.count,
        residual_rms_s: (squares / residuals_s.len() as f64).sqrt(),
        residuals_s,
        screen: screen.known,
        screen_delay_s: screen.estimate_s,
        screen_delay_most_s: screen.most_s,
        doubt: screen.doubt.or_else(|| refused_at_an_end(&agreed)),
        delay_s: [0.0; 2],
        place,
        corners,
    })
}

/// The agreement of the most readings: with the screen that is given or usual or, where many more agree then, or those
/// that don't agree are shown late, a slower one; and with that of the clock's wraps with which most agree.
fn most_agreed(seen: &[Seen], resolution_s: f64, usual_s: f64, wraps_s: &[f64]) -> Agreed {
    let with = |late_s: f64| consensus::agree_with(seen, resolution_s + late_s, MOST_DRIFT, wraps_s);
    let usual = with(usual_s);
    let late = resolution_s <= SLOWEST_SCREEN_S && screen::is_late(seen, &usual, resolution_s);
    if 10 * usual.count >= 9 * seen.len() && !late {
        return usual;
    }
    let slow = with(SLOWEST_SCREEN_S);
    if late && slow.count > usual.count || 10 * slow.count > 10 * usual.count + seen.len() { slow } else { usual }
}

/// So many readings in a row at the beginning or the end that don't agree are no misread digit (measured: 0 in all
/// videos of clocks that run; 30 to 88 where a clock of whole seconds is set within 3 s of an end).
const AT_AN_END: usize = 5;

/// That the first or the last readings don't agree with the others: the clock may have been set there.
fn refused_at_an_end(agreed: &Agreed) -> Option<String> {
    let refused = |turns: &&Option<f64>| turns.is_none();
    let first = agreed.turns_s.iter().take_while(refused).count();
    let last = agreed.turns_s.iter().rev().take_while(refused).count();
    let (count, which) = if first >= last { (first, "first") } else { (last, "last") };
    (count >= AT_AN_END).then(|| {
        format!(
            "the {which} {count} readings of the clock agree with none of the others: was it set, or did it stop, \
             then? Their times are those of the others' clock; cut the video there"
        )
    })
}

/// Whether so many readings disagree, here and there, that a digit must be misread again and again: such a digit is
/// wrong where it seems to agree too, next to the digit that it is taken for, and would bend the line.
fn is_misread(agreed: &Agreed) -> bool {
    let refused = agreed.turns_s.len() - agreed.count;
    let runs = agreed.turns_s.chunk_by(|a, b| a.is_some() == b.is_some()).filter(|run| run[0].is_none()).count();
    MISREAD * refused > agreed.turns_s.len() && runs > STRETCHES
}

/// The readings that agree, as the polygon takes them: rounding may make each of them early by so much.
fn agreed_points<'a>(seen: &'a [Seen], agreed: &'a Agreed, slack_s: f64) -> impl Iterator<Item = Point> + Clone {
    seen.iter().zip(&agreed.turns_s).filter_map(move |(seen, turns_s)| {
        turns_s.map(|turns_s| [seen.time_s, seen.shown_s + turns_s - seen.time_s - slack_s])
    })
}

/// Takes the reading out that lies furthest from the middle of the others, on the narrowest band.
fn refuse_worst(seen: &[Seen], agreed: &mut Agreed, hulls: &Hulls, most_end_s: f64) {
    let end_s = hulls.least_room(most_end_s).1;
    let mut off: Vec<(f64, usize)> = seen
        .iter()
        .zip(&agreed.turns_s)
        .enumerate()
        .filter_map(|(k, (seen, turns_s))| {
            Some((seen.shown_s + (*turns_s)? - seen.time_s * (1.0 + end_s / hulls.half_s), k))
        })
        .collect();
    let middle = off.len() / 2;
    let (_, &mut (median, _), _) = off.select_nth_unstable_by(middle, |a, b| a.0.total_cmp(&b.0));
    let worst = off.iter().max_by(|a, b| (a.0 - median).abs().total_cmp(&(b.0 - median).abs()));
    if let Some(&(_, worst)) = worst {
        agreed.turns_s[worst] = None;
        agreed.count -= 1;
    }
}

/// The line of the means, held where height and slope err independently.
fn timebase(moments: &Moments, place: &Place) -> Timebase {
    let [height, both, end] = moments.spread;
    let share = if end > 0.0 { -both / end } else { 0.0 };
    let since_s = share * place.half_s;
    let variance = (height + 2.0 * both * share + end * share * share).max(0.0);
    Timebase {
        reference_s: place.time_s + since_s,
        at_reference_s: place.clock_s(&moments.mean, place.time_s + since_s),
        at_reference_sd_s: variance.sqrt(),
        drift: moments.mean[1] / place.half_s,
        drift_sd: end.sqrt() / place.half_s,
    }
}
