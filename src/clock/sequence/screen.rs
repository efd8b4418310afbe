//! How late the screen shows what the clock counts.
//!
//! Readings that agree with no screen that shows at once need one that shows late. How late is seen where frames' times
//! are irregular:
//! the readings then fill nearly all of what the screen allows, and the screen is the fastest usual one that allows so
//! much. Frames in which the digits change are not read, which hides a part of the delay as long as the exposure: it is
//! estimated from how many such frames there are, and added. Where frames' and screen's rhythm are the same, or the
//! screen's and the digits', the delay can't be separated from the offset; then none is taken off, and interval and
//! standard error count a usual screen.

use super::consensus::{Agreed, Seen};
use super::{ScreenDelay, USUAL_SCREEN_S};
use crate::median::median_of;

/// Intervals of screens that there are, seconds; the last are clocks that a program draws.
const SCREENS_S: [f64; 8] =
    [1.0 / 144.0, 1.0 / 120.0, USUAL_SCREEN_S, 1.0 / 50.0, 1.0 / 30.0, 1.0 / 24.0, 1.0 / 20.0, 0.1];
/// Digits at which a late screen is late, at least.
const DIGITS: usize = 2;
/// A screen is known to a fiftieth: 59.94 is reported as 60.
const NEAR: f64 = 0.98;
/// What readings and frames not read must add up to before a screen is believed that the readings alone do not need,
/// seconds, and in standard errors.
const BELIEVED_S: f64 = 4e-3;
const BELIEVED_SDS: f64 = 2.5;

/// Readings are neighbours whose frames are no further apart than this share of the resolution: a clock that is drawn
/// more often than its digits change goes on by one of them at most.
const NEIGHBOURS: f64 = 0.75;
/// Digits are skipped by a clock that a program draws more rarely than they change: in this share of all changes, so
/// often, and not one and the same digit, which would be misread.
const SKIPPED: f64 = 0.05;
const SKIPS: usize = 3;
/// What a clock shows for longer than so many times as long as usual is a clock that stood still.
const LONGER: f64 = 2.0;

/// How often a program draws a clock whose digits are skipped: the longest that it shows the same, seconds.
pub(super) fn redrawn_s(seen: &[Seen], resolution_s: f64) -> Option<f64> {
    let near_s = NEIGHBOURS * resolution_s;
    let (mut changes, mut skips, mut digits) = (0, 0, [0_usize; 10]);
    let mut shown_for_s = Vec::new();
    let steps = |seen: &Seen| (seen.shown_s / resolution_s).round() as i64;
    let shown: Vec<&[Seen]> = seen.chunk_by(|a, b| steps(a) == steps(b)).collect();
    // A digit that is misread stands for a frame, not for several with the right ones before and after.
    for three in shown.windows(3).filter(|three| three.iter().all(|shown| shown.len() > 1)) {
        let [before, this, after] = [0, 1, 2].map(|k| three[k]);
        let near = |a: &[Seen], b: &[Seen]| b[0].time_s - a[a.len() - 1].time_s <= near_s;
        let (from, to) = (steps(&before[0]), steps(&this[0]));
        if near(before, this) && near(this, after) && from < to && to < steps(&after[0]) {
            shown_for_s.push(after[0].time_s - this[0].time_s);
            changes += 1;
            skips += usize::from(to - from > 1);
            (from + 1..to).take(digits.len()).for_each(|digit| digits[digit.rem_euclid(10) as usize] += 1);
        }
    }
    let different = digits.iter().filter(|&&count| count > 0).count();
    if skips < SKIPS || (skips as f64) < SKIPPED * f64::from(changes) || different < 2 {
        return None;
    }
    let usual_s = median_of(shown_for_s.iter().copied())?;
    shown_for_s.into_iter().filter(|shown_s| *shown_s <= LONGER * usual_s).max_by(f64::total_cmp)
}

/// Whether readings that disagree show what the one before or after shows, whatever the digit: a screen that shows
/// late, and no digit that is misread.
pub(super) fn is_late(seen: &[Seen], agreed: &Agreed, resolution_s: f64) -> bool {
    let (mut refused, mut held, mut digits) = (0, 0, [false; 10]);
    let steps = |seen: &Seen| (seen.shown_s / resolution_s).round() as i64;
    for (three, _) in seen.windows(3).zip(&agreed.turns_s[1..]).filter(|(_, turns_s)| turns_s.is_none()) {
        let [before, this, after] = [0, 1, 2].map(|k| steps(&three[k]));
        refused += 1;
        if before <= this && this <= after && before < after && (before == this || this == after) {
            held += 1;
            digits[this.rem_euclid(10) as usize] = true;
        }
    }
    10 * held >= 8 * refused && digits.iter().filter(|&&digit| digit).count() >= DIGITS
}

/// The screen's delay for estimate and interval.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Screen {
    pub(super) known: ScreenDelay,
    /// The longest delay that the estimate counts, seconds.
    pub(super) estimate_s: f64,
    /// The longest that the interval counts, seconds.
    pub(super) most_s: f64,
    /// Why the rate that was given is not believed.
    pub(super) doubt: Option<String>,
}

/// The delay, if readings agree with none below `least_s`, `dead_s` is from [`dead_s`], `given_s` what the user says
/// and `redrawn_s` from [`redrawn_s`].
pub(super) fn delay(least_s: f64, dead_s: [f64; 2], given_s: Option<f64>, redrawn_s: Option<f64>) -> Screen {
    if let Some(redrawn_s) = redrawn_s.filter(|redrawn_s| least_s.max(given_s.unwrap_or(0.0)) <= *redrawn_s) {
        let doubt = format!(
            "the clock in the picture is drawn only every {redrawn_s:.2} s or so, and skips digits: how late it shows \
             is uncertain by as much; let its program draw it more often"
        );
        return Screen { known: ScreenDelay::Found, estimate_s: redrawn_s, most_s: redrawn_s, doubt: Some(doubt) };
    }
    if let Some(given_s) = given_s.filter(|given_s| least_s <= *given_s) {
        return Screen { known: ScreenDelay::Given, estimate_s: given_s, most_s: given_s, doubt: None };
    }
    let screen = |late_s: f64| SCREENS_S.into_iter().find(|&screen| late_s <= screen / NEAR).unwrap_or(late_s);
    let most_s = screen(least_s.max(NEAR * USUAL_SCREEN_S)).max(least_s / NEAR);
    let doubt = given_s.map(|_| {
        format!(
            "the clock's digits change up to {:.1} ms later than `refresh_hz` explains, which is not believed: are \
             frames missing, or does the clock jump?",
            1e3 * least_s
        )
    });
    let [dead_s, dead_sd_s] = dead_s;
    let late_s = least_s + dead_s;
    if least_s <= 0.0 && late_s < BELIEVED_S.max(BELIEVED_SDS * dead_sd_s) {
        return Screen { known: ScreenDelay::Assumed, estimate_s: 0.0, most_s, doubt };
    }
    let estimate_s = screen(late_s).max(least_s / NEAR);
    Screen { known: ScreenDelay::Found, estimate_s, most_s: most_s.max(estimate_s), doubt }
}

/// Frames in a row that are not read because digits change in them: no more than this.
const CHANGING: usize = 2;

/// How long before and after a change of digits frames are not read, both together, and its standard error, seconds;
/// from frames not read between two readings one step apart, less as many as are not read between the same readings.
pub(super) fn dead_s(accepted_s: &[Option<f64>], resolution_s: f64, interval_s: f64) -> [f64; 2] {
    let (mut frames, mut changing, mut other) = (0, 0, 0);
    let mut last: Option<(usize, f64)> = None;
    for (k, read) in accepted_s.iter().enumerate() {
        let Some(read) = *read else { continue };
        if let Some((before, earlier)) = last
            && k - before <= CHANGING + 1
        {
            frames += k - before;
            match ((read - earlier) / resolution_s).round() {
                0.0 => other += k - before - 1,
                1.0 => changing += k - before - 1,
                _ => {}
            }
        }
        last = Some((k, read));
    }
    // A frame not read for another reason stands between two readings this often.
    let between = 2.0 * interval_s / resolution_s;
    if frames == 0 || between >= 1.0 {
        return [0.0, 0.0];
    }
    let expected = other as f64 * between / (1.0 - between);
    let a_frame_s = resolution_s / frames as f64;
    [a_frame_s * (changing as f64 - expected).max(0.0), a_frame_s * (changing as f64 + expected + 1.0).sqrt()]
}
