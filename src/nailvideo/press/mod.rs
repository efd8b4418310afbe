//! How the nail's colour follows a press and a release (section 4.3's time constants; the time to refill).
//!
//! In: the traces of all photodiodes. Out: for each press and release, each photodiode and both ends of the nail,
//! onset, times to 50 and 90 %, and time constant with 95 % intervals, or why there are none. Nothing here is judged
//! normal or not: the pressure is not controlled, and the nail is not where clinics press.

mod find;
mod fit;
#[cfg(test)]
mod tests;

use std::iter::repeat;

use rayon::prelude::*;

use crate::median::{ends, median_of};
pub(in crate::nailvideo) use find::noise_sd;
use find::presses;
use fit::{Course, LEAST_SEEN, fit};

/// Written into every row.
pub(in crate::nailvideo) const USE: &str = "research use; not a diagnostic";
/// Before an event, seconds that show the level there; after it at most this long.
const BEFORE_S: f64 = 2.0;
const AFTER_S: f64 = 30.0;
/// A step, of the noise's SD in one sample (section 6 of the design).
const LEAST_SDS: f64 = 8.0;
/// And of a value's standard error, which holds what lasts for many frames: moving glare made a course of 5.6; of 416
/// courses of phantoms, down to 0.3 N and crf 30, the least has 8.5.
const LEAST_ERRORS: f64 = 6.0;
/// Share of the samples about an event that may be missing (section 6 of the design).
const MOST_MISSING: f64 = 0.10;
/// The residuals against the step and the noise: above both it is not a first-order response (12 % as pyCRT refuses).
const MOST_RESIDUAL: f64 = 0.12;
const MOST_RESIDUAL_SDS: f64 = 3.0;
/// A change of the skin's own colour, or of the place's red beyond the light's, of the step, from which on it is light
/// or glare (assumed; blood moves red by at most a quarter of what it moves green over red).
const MOST_OF_LIGHT: f64 = 0.5;
/// Fewer samples determine no course.
const FEWEST: usize = 12;

/// One place's values over the video; NaN where missing.
#[derive(Debug, Clone)]
pub(in crate::nailvideo) struct Trace {
    /// `P1`, or the end of the nail.
    pub(in crate::nailvideo) name: String,
    pub(in crate::nailvideo) values: Vec<f64>,
    /// Red at the same place, less the light's, in the values' unit; NaN in a grey video.
    pub(in crate::nailvideo) red: Vec<f64>,
    /// By how much glare or coloured light may take the values along; 0 where that is not seen.
    pub(in crate::nailvideo) tint: Vec<f64>,
}

/// A press or a release.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::nailvideo) enum Event {
    Press,
    Release,
}

impl Event {
    pub(in crate::nailvideo) fn name(self) -> &'static str {
        match self {
            Self::Press => "press",
            Self::Release => "release",
        }
    }
}

/// One row of `presses.csv`.
#[derive(Debug, Clone)]
pub(in crate::nailvideo) struct Row {
    /// Counted from 1.
    pub(in crate::nailvideo) press: usize,
    pub(in crate::nailvideo) event: Event,
    pub(in crate::nailvideo) place: String,
    /// When the press began and, where it is known, ended, as it was found: to some frames.
    pub(in crate::nailvideo) found_s: (f64, Option<f64>),
    /// How long the press lasted, where both ends are known.
    pub(in crate::nailvideo) pressed_s: Option<f64>,
    pub(in crate::nailvideo) noise_sd: Option<f64>,
    /// The course, or why it is refused; with the step where that is known.
    course: Result<Course, Refused>,
}

impl Row {
    /// Onset, t50, t90, tau, each with the ends of its interval; nothing where they are refused.
    pub(in crate::nailvideo) fn times_s(&self) -> [Option<[f64; 3]>; 4] {
        let of = |one: fit::Interval| Some([one.value, one.low, one.high]);
        self.course.as_ref().map_or([None; 4], |c| [of(c.onset_s), of(c.t50_s), of(c.t90_s), of(c.tau_s)])
    }

    /// From the press to the release.
    pub(in crate::nailvideo) fn span_s(&self) -> Option<(f64, f64)> {
        Some((self.found_s.0, self.found_s.1?))
    }

    /// The step, as much as is seen of it.
    pub(in crate::nailvideo) fn depth(&self) -> Option<f64> {
        match &self.course {
            Ok(course) => Some(course.depth),
            Err(refused) => refused.depth,
        }
    }

    /// `ok`, or `refused: ` and why.
    pub(in crate::nailvideo) fn status(&self) -> String {
        self.course.as_ref().map_or_else(|refused| format!("refused: {}", refused.why), |_| "ok".to_owned())
    }

    /// Whether it has no course.
    pub(in crate::nailvideo) fn is_refused(&self) -> bool {
        self.course.is_err()
    }

    /// What the course is like.
    pub(in crate::nailvideo) fn model(&self) -> Option<&'static str> {
        self.course.as_ref().ok().map(|course| course.model.name())
    }
}

/// Why a course is refused.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::nailvideo) struct Refused {
    pub(in crate::nailvideo) why: &'static str,
    /// The step, as much as is seen of it.
    pub(in crate::nailvideo) depth: Option<f64>,
}

/// What presses are looked for in.
#[derive(Debug)]
pub(in crate::nailvideo) struct Recording<'a> {
    /// Ascending, seconds.
    pub(in crate::nailvideo) time_s: &'a [f64],
    /// Of the photodiodes.
    pub(in crate::nailvideo) traces: &'a [Trace],
    /// Their standard errors where the nail rests; none where they are not known.
    pub(in crate::nailvideo) sd: &'a [Option<f64>],
    /// Means over the photodiodes of each end.
    pub(in crate::nailvideo) ends: &'a [Trace],
    /// The skin's own colour about the nail, in the traces' unit.
    pub(in crate::nailvideo) skin: &'a [f64],
    /// What a change of all light is in the traces' unit: 100 of percent.
    pub(in crate::nailvideo) whole: f64,
}

/// What to say where every press looks like a release: pressing makes the nail darker in green towards its proximal end
/// and lighter towards its distal one (4.2). Shear may turn some of them: 6 of 10 of random forces on a phantom. Of
/// half of the presses both ends have to be known: of 37 of random forces 7 had both, and looked so.
pub(in crate::nailvideo) fn reversed(rows: &[Row]) -> Option<String> {
    let depth = |press: usize, place: &str| {
        rows.iter().find(|row| row.press == press && row.event == Event::Press && row.place == place)?.depth()
    };
    let count = rows.iter().map(|row| row.press).max()?;
    let presses = 1..=count;
    let ends: Vec<[f64; 2]> =
        presses.filter_map(|press| Some([depth(press, "proximal")?, depth(press, "distal")?])).collect();
    let are_reversed = ends.iter().all(|[proximal, distal]| *proximal > 0.0 && *distal < 0.0);
    (are_reversed && 2 * ends.len() >= count).then(|| {
        format!(
            "each of {} press(es) looks like a release: green goes up towards the proximal end and down towards the \
             distal one. Does the video begin while the finger presses? The first change is taken for a press: let the \
             video begin with a second of rest",
            ends.len()
        )
    })
}

/// The rows of all presses.
pub(in crate::nailvideo) fn rows(of: &Recording<'_>) -> Vec<Row> {
    let found = presses(of.time_s, of.traces, of.sd, of.whole);
    let sds = of.sd.iter().copied().chain(repeat(None));
    let traces = of.traces.iter().chain(of.ends).zip(sds).map(|(trace, sd)| (trace, [noise_sd(&trace.values), sd]));
    let traces: Vec<(&Trace, [Option<f64>; 2])> = traces.collect();
    let mut rows = Vec::new();
    for (k, press) in found.iter().enumerate() {
        let next_s = found.get(k + 1).map_or(f64::INFINITY, |next| next.press_s);
        let before_s = k.checked_sub(1).and_then(|k| found[k].release_s).unwrap_or(f64::NEG_INFINITY);
        let end_s = press.release_s.unwrap_or(f64::INFINITY);
        let events = [
            Some((Event::Press, press.press_s, before_s, end_s.min(next_s))),
            press.release_s.map(|at| (Event::Release, at, press.press_s, next_s)),
        ];
        // By trace, then by event, as each is fitted by itself.
        let of_trace = |(trace, sds): &(&Trace, [Option<f64>; 2])| {
            let row = |(event, at_s, from_s, to_s)| {
                // The level of the rest before the press, which a release may return to.
                let rest = (event == Event::Release).then(|| level(of.time_s, &trace.values, press.press_s)).flatten();
                Row {
                    press: k + 1,
                    event,
                    place: trace.name.clone(),
                    found_s: (press.press_s, press.release_s),
                    pressed_s: press.release_s.map(|end| end - press.press_s),
                    noise_sd: sds[0],
                    course: course(of, trace, *sds, Window { at_s, from_s, to_s }, rest),
                }
            };
            events.into_iter().flatten().map(row).collect::<Vec<Row>>()
        };
        rows.par_extend(traces.par_iter().flat_map_iter(of_trace));
        // How long it lasted is known to the frame where the courses are.
        let onset = |event: Event, rows: &[Row]| {
            let of = |row: &&Row| row.press == k + 1 && row.event == event;
            median_of(rows.iter().filter(of).filter_map(|r| Some(r.course.as_ref().ok()?.onset_s.value)))
        };
        if let (Some(from), Some(to)) = (onset(Event::Press, &rows), onset(Event::Release, &rows)) {
            rows.iter_mut().filter(|row| row.press == k + 1).for_each(|row| row.pressed_s = Some(to - from));
        }
    }
    rows
}

#[derive(Debug, Clone, Copy)]
struct Window {
    at_s: f64,
    /// The events before and after.
    from_s: f64,
    to_s: f64,
}

/// The level in the two seconds before a press.
fn level(time_s: &[f64], values: &[f64], at_s: f64) -> Option<f64> {
    let [from, to] = [at_s - BEFORE_S, at_s - 0.3].map(|end_s| time_s.partition_point(|&t| t < end_s));
    let known: Vec<f64> = values[from..to].iter().copied().filter(|v| v.is_finite()).collect();
    (known.len() >= 6).then(|| known.iter().sum::<f64>() / known.len() as f64)
}

fn course(
    of: &Recording<'_>,
    trace: &Trace,
    [noise_sd, sd]: [Option<f64>; 2],
    window: Window,
    rest: Option<f64>,
) -> Result<Course, Refused> {
    let refused = |why: &'static str, depth: Option<f64>| Err(Refused { why, depth });
    let Window { at_s, from_s, to_s } = window;
    // The course after the event before this one has ended by half of the way, or is refused by its residuals.
    let from_s = (at_s - BEFORE_S).max(if from_s.is_finite() { from_s + 0.5 * (at_s - from_s) } else { from_s });
    // The next event's onset lies somewhat before its steepest place.
    let to_s = (at_s + AFTER_S).min(to_s - 0.3);
    let from = of.time_s.partition_point(|&t| t < from_s);
    let to = of.time_s.partition_point(|&t| t < to_s).max(from);
    let known: Vec<usize> = (from..to).filter(|&k| trace.values[k].is_finite()).collect();
    let missing = (to - from - known.len()) as f64;
    if missing > MOST_MISSING * (to - from) as f64 {
        return refused("more than 10 % of its samples are missing", None);
    }
    if known.len() < FEWEST {
        return refused("too few samples between the events before and after", None);
    }
    let time_s: Vec<f64> = known.iter().map(|&k| of.time_s[k] - at_s).collect();
    let values: Vec<f64> = known.iter().map(|&k| trace.values[k]).collect();
    let Some(noise) = noise_sd else { return refused("too few samples to know the noise", None) };
    let Some(mut course) = fit(&time_s, &values, 0.0, rest) else { return refused("no exponential course fits", None) };
    let depth = Some(course.depth);
    let is_deep = course.depth.abs() >= LEAST_SDS * noise.max(1e-9);
    if !is_deep {
        return refused("the step is below 8 SDs of the noise", depth);
    }
    if sd.is_some_and(|sd| course.depth.abs() < LEAST_ERRORS * sd) {
        return refused("the step is below 6 standard errors of a value", depth);
    }
    let is_seen = course.seen >= LEAST_SEEN;
    if !is_seen {
        // What a course would come to beyond what is seen of it is not known.
        return refused(
            "its end is not seen before the next event or the video's end",
            Some(course.depth * course.seen),
        );
    }
    if course.sd > MOST_RESIDUAL * course.depth.abs() && course.sd > MOST_RESIDUAL_SDS * noise {
        return refused("its course is not exponential", depth);
    }
    let after_s = course.onset_s.value + course.t50_s.value;
    let change = |of_light: &[f64]| {
        let middle = |from_s: f64, to_s: f64| {
            let at = |k: &&usize| of.time_s[**k] - at_s >= from_s && of.time_s[**k] - at_s < to_s;
            median_of(known.iter().filter(at).map(|&k| of_light[k]).filter(|v| v.is_finite()))
        };
        Some((middle(after_s, after_s + BEFORE_S)? - middle(-BEFORE_S, course.onset_s.value)?).abs())
    };
    let is_light = |of_light: &[f64]| change(of_light).is_some_and(|by| by > MOST_OF_LIGHT * course.depth.abs());
    if is_light(of.skin) || is_light(&trace.red) {
        return refused("the light changed with it", depth);
    }
    let [low, high] = ends(known.iter().map(|&k| trace.tint[k]));
    if high - low > MOST_RESIDUAL * course.depth.abs() {
        return refused("glare or coloured light changed with it", depth);
    }
    for end in [&mut course.onset_s.value, &mut course.onset_s.low, &mut course.onset_s.high] {
        *end += at_s;
    }
    Ok(course)
}
