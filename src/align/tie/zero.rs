//! What the log's time is when the clock in the picture shows zero.
//!
//! The log may count seconds of the epoch, or of a day, where the clock shows the time of day, or minutes and seconds
//! only. Of the times that the clock's zero may then stand for, that is taken which lays the video over the log, if
//! there is just one.

const HOUR_S: f64 = 3600.0;
const DAY_S: f64 = 86_400.0;
/// Times of day differ by multiples of this between the world's time zones: whole hours, or one of these either way.
const ZONE_S: f64 = 900.0;
const PARTS_OF_HOURS: [f64; 11] = [2.5, 3.5, 4.5, 5.5, 5.75, 6.5, 8.75, 9.5, 10.5, 12.75, 13.75];
/// A clock that shows less may show minutes and seconds only.
const MINUTES_ONLY_S: f64 = 6000.0;
/// Stamps above this are seconds of the epoch, not of a recording: 1973.
const EPOCH_S: f64 = 1e8;
/// More possible zeros than this are not listed.
const LISTED: usize = 4;

/// The log's time when the clock shows zero, and what is worth saying of it; `clock_s` and `log_s` are the least and
/// the greatest time of the video, on the clock, and of the log. `midnight_s` is the log's time at its midnight, where
/// its stamps are times of day.
pub(super) fn zero_s(
    clock_s: [f64; 2],
    log_s: [f64; 2],
    midnight_s: Option<f64>,
) -> Result<(f64, Option<String>), String> {
    let by_day = midnight_s.is_some() || log_s[0] >= EPOCH_S;
    let every_s = if clock_s[1] < MINUTES_ONLY_S { HOUR_S } else { DAY_S };
    let base_s = midnight_s.unwrap_or(0.0);
    if let Some(zero) = the_one(&over(clock_s, log_s, base_s, every_s))? {
        let note = (zero != 0.0)
            .then(|| format!("the clock's zero is taken to be {zero} s of the log, where video and log overlap"));
        return Ok((zero, note));
    }
    if by_day
        && every_s == DAY_S
        && let zones =
            over(clock_s, log_s, base_s, ZONE_S).into_iter().filter(|(zero, _)| is_zone(ahead_h(base_s - zero)))
        && let Some(zero) = the_one(&zones.collect::<Vec<_>>())?
    {
        let hours = ahead_h(base_s - zero);
        return Ok((
            zero,
            Some(format!(
                "the clock is taken to show a time zone {hours:+} h from the log's: only so video and log overlap"
            )),
        ));
    }
    Err(format!(
        "the video and the log do not overlap: the clock in the picture shows {} to {} s, the log's time goes from {} \
         to {} s; give the log's time when the clock shows zero, or another log",
        seconds(clock_s[0]),
        seconds(clock_s[1]),
        seconds(log_s[0]),
        seconds(log_s[1])
    ))
}

/// By how many hours a zone is ahead: from 12 behind to 14 ahead.
fn ahead_h(seconds: f64) -> f64 {
    let hours = seconds.rem_euclid(DAY_S) / HOUR_S;
    if hours > 14.0 { hours - 24.0 } else { hours }
}

fn is_zone(hours: f64) -> bool {
    hours.fract() == 0.0 || PARTS_OF_HOURS.contains(&hours.abs())
}

fn seconds(seconds: f64) -> String {
    format!("{seconds:.3}")
}

/// Zeros `base_s + k every_s` with which clock and log overlap, and by how many seconds.
fn over(clock_s: [f64; 2], log_s: [f64; 2], base_s: f64, every_s: f64) -> Vec<(f64, f64)> {
    let first = ((log_s[0] - clock_s[1] - base_s) / every_s).ceil();
    let last = ((log_s[1] - clock_s[0] - base_s) / every_s).floor();
    // One row has no length but may be overlapped all the same.
    let many = ((last - first).clamp(-1.0, 1e4) + 1.0) as usize;
    (0..many)
        .map(|k| {
            let zero = base_s + (first + k as f64) * every_s;
            (zero, (clock_s[1] + zero).min(log_s[1]) - (clock_s[0] + zero).max(log_s[0]))
        })
        .map(|(zero, overlap)| {
            (zero, overlap / (clock_s[1] - clock_s[0]).min(log_s[1] - log_s[0]).max(f64::MIN_POSITIVE))
        })
        .collect()
}

/// The one zero with which at least half of the shorter overlaps or, if there is none such, the one with which anything
/// does.
fn the_one(zeros: &[(f64, f64)]) -> Result<Option<f64>, String> {
    let half: Vec<f64> = zeros.iter().filter(|(_, share)| *share >= 0.5).map(|(zero, _)| *zero).collect();
    let all: Vec<f64> = zeros.iter().map(|(zero, _)| *zero).collect();
    match (&half[..], &all[..]) {
        ([one], _) | ([], [one]) => Ok(Some(*one)),
        ([], []) => Ok(None),
        ([], several) | (several, _) => {
            let mut listed: Vec<String> = several.iter().take(LISTED).map(|zero| format!("{zero} s")).collect();
            if several.len() > LISTED {
                listed.push(format!("{} more", several.len() - LISTED));
            }
            Err(format!(
                "the clock in the picture doesn't tell which hour or day of the log it shows: its zero may be {} of \
                 the log's time; say the log's time when the clock shows zero with --clock-zero, or, of a log in \
                 milliseconds, --time-unit ms",
                listed.join(" or ")
            ))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_zero_is_where_video_and_log_overlap() {
        // The log's clock itself.
        assert_eq!(zero_s([60.0, 80.0], [50.0, 100.0], None), Ok((0.0, None)));
        // Minutes and seconds in the third hour of the log.
        assert_eq!(zero_s([60.0, 80.0], [7200.0, 7300.0], None).unwrap().0, 7200.0);
        // Time of day and stamps of the epoch: 2021-10-21 is day 18 921.
        let midnight = 18_921.0 * DAY_S;
        let log = [midnight + 33_000.0, midnight + 34_000.0];
        assert_eq!(zero_s([33_100.0, 33_160.0], log, Some(midnight)).unwrap().0, midnight);
        assert_eq!(zero_s([33_100.0, 33_160.0], log, None).unwrap().0, midnight);
        // The same two hours ahead.
        let (zero, note) = zero_s([40_300.0, 40_360.0], log, None).unwrap();
        assert_eq!(zero, midnight - 7200.0);
        assert!(note.unwrap().contains("+2 h"));
        // As in Nepal; no place is an hour and three quarters behind another.
        assert_eq!(zero_s([53_800.0, 53_860.0], log, None).unwrap().0, midnight - 20_700.0);
        assert!(zero_s([27_000.0, 27_060.0], log, None).unwrap_err().contains("do not overlap"));
        // Over midnight the clock was unwrapped.
        let late = [midnight + 86_300.0, midnight + 86_500.0];
        assert_eq!(zero_s([86_390.0, 86_410.0], late, Some(midnight)).unwrap().0, midnight);
    }

    #[test]
    fn none_and_several_are_refused() {
        let none = zero_s([7000.0, 7010.0], [50.0, 100.0], None).unwrap_err();
        assert!(none.contains("do not overlap"), "{none}");
        let several = zero_s([60.0, 80.0], [0.0, 20_000.0], None).unwrap_err();
        assert!(several.contains("0 s or 3600 s or 7200 s or 10800 s or 2 more"), "{several}");
    }

    #[test]
    fn a_log_of_one_row_may_overlap() {
        assert_eq!(zero_s([60.0, 80.0], [70.0, 70.0], None).unwrap().0, 0.0);
    }
}
