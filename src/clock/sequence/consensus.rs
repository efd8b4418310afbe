//! Which readings most others agree with, and how often the clock began again.
//!
//! What a clock shows less the video's time is nearly constant: within its resolution and the screen's delay of a line
//! whose slope is the drift. The line (drift and height, the height on the circle of what the clock shows before it
//! begins again) with the most readings in such a band is looked for on a grid that gets finer. Of the readings in the
//! band those are kept with which time only goes forward: the longest sequence that never falls.

use super::polygon::Point;

/// A reading.
#[derive(Debug, Clone, Copy)]
pub(super) struct Seen {
    /// The frame's place in what was given.
    pub(super) index: usize,
    /// The frame's time from the middle of all readings' times, seconds.
    pub(super) time_s: f64,
    /// What the clock shows less what the first reading shows, seconds.
    pub(super) shown_s: f64,
}

/// Readings that agree.
#[derive(Debug, Clone)]
pub(super) struct Agreed {
    /// For each reading that agrees what the clock's beginnings again add to what it shows, seconds: 0 for the first of
    /// them.
    pub(super) turns_s: Vec<Option<f64>>,
    /// How many agree.
    pub(super) count: usize,
    /// The line: slope and the lowest and highest of its band at the middle.
    pub(super) drift: f64,
    /// See `drift`; seconds.
    pub(super) band_s: [f64; 2],
}

/// Readings that the line is looked for with; the others are judged by it.
const LOOK: usize = 800;
/// Times that the grid gets finer by a quarter.
const FINER: usize = 4;

/// The largest set of readings within `room_s` of a line of at most `most_drift`; `wrap_s` is what the clock shows
/// before it begins again. `seen` is sorted by time and not empty.
pub(super) fn agree(seen: &[Seen], room_s: f64, most_drift: f64, wrap_s: Option<f64>) -> Agreed {
    let count = seen.len().min(LOOK);
    let look: Vec<Point> = (0..count)
        .map(|k| {
            // One of each part, not the same of each: at an even step all might show one phase of the last digit.
            let [from, to] = [k, k + 1].map(|k| k * seen.len() / count);
            let last = k + 1 == count;
            &seen[if last { seen.len() - 1 } else { from + k * 618 % 1000 * (to - from) / 1000 }]
        })
        .map(|seen| [seen.time_s, seen.shown_s - seen.time_s])
        .collect();
    let half_s = seen.iter().map(|seen| seen.time_s.abs()).fold(0.0, f64::max);
    let mut best = Band { count: 0, drift: 0.0, from_s: 0.0, to_s: 0.0 };
    let mut heights = Vec::with_capacity(look.len());
    let mut try_drift = |drift: f64, room_s: f64, best: &mut Band| {
        heights.clear();
        heights.extend(look.iter().map(|p| p[1] - drift * p[0]));
        let band = fullest(&mut heights, room_s, wrap_s);
        let narrower = band.1[1] - band.1[0] < best.to_s - best.from_s;
        if band.0 > best.count || (band.0 == best.count && narrower) {
            *best = Band { count: band.0, drift, from_s: band.1[0], to_s: band.1[1] };
        }
    };
    // From the middle outwards: of drifts that are as good the least is taken.
    let mut step = room_s / half_s.max(room_s);
    let steps = (most_drift / step).ceil() as i64;
    for k in (0..=2 * steps).map(|k| if k % 2 == 0 { k / 2 } else { -(k + 1) / 2 }) {
        try_drift((step * k as f64).clamp(-most_drift, most_drift), room_s + 0.5 * step * half_s, &mut best);
    }
    for _ in 0..FINER {
        step *= 0.25;
        let middle = best.drift;
        best.count = 0;
        for k in [0, 1, -1, 2, -2, 3, -3] {
            let drift = (middle + step * f64::from(k)).clamp(-most_drift, most_drift);
            try_drift(drift, room_s + 0.5 * step * half_s, &mut best);
        }
    }
    let slack_s = 0.5 * step * half_s + if count < seen.len() { room_s / 16.0 } else { 1e-9 };
    if count < seen.len() {
        // The band of all readings, not only of those looked at.
        let mut heights: Vec<f64> = seen.iter().map(|seen| seen.shown_s - (1.0 + best.drift) * seen.time_s).collect();
        let (count, [from_s, to_s]) = fullest(&mut heights, room_s + 0.5 * step * half_s, wrap_s);
        best = Band { count, drift: best.drift, from_s, to_s };
    }
    keep(seen, &best, slack_s, wrap_s)
}

/// The same with that of the clock's wraps with which most agree.
pub(super) fn agree_with(seen: &[Seen], room_s: f64, most_drift: f64, wraps_s: &[f64]) -> Agreed {
    let of = |wrap_s: Option<f64>| agree(seen, room_s, most_drift, wrap_s);
    // The first of equals.
    let best = wraps_s.iter().rev().map(|wrap_s| of(Some(*wrap_s))).max_by_key(|agreed| agreed.count);
    best.unwrap_or_else(|| of(None))
}

struct Band {
    count: usize,
    drift: f64,
    from_s: f64,
    to_s: f64,
}

/// The interval of `room_s` with the most of `heights` in it, on a circle if they wrap: how many, and the least and the
/// greatest of them.
fn fullest(heights: &mut Vec<f64>, room_s: f64, wrap_s: Option<f64>) -> (usize, [f64; 2]) {
    if let Some(wrap_s) = wrap_s {
        heights.iter_mut().for_each(|height| *height = height.rem_euclid(wrap_s));
    }
    heights.sort_by(f64::total_cmp);
    let once = heights.len();
    if let Some(wrap_s) = wrap_s {
        let again = heights.iter().take_while(|&&height| height <= room_s).count();
        heights.extend_from_within(..again);
        heights[once..].iter_mut().for_each(|height| *height += wrap_s);
    }
    let mut from = 0;
    let mut best = (0, [0.0; 2]);
    for to in 0..heights.len() {
        while heights[to] - heights[from] > room_s || to - from >= once {
            from += 1;
        }
        let (count, ends) = (to - from + 1, [heights[from], heights[to]]);
        if count > best.0 || (count == best.0 && ends[1] - ends[0] < best.1[1] - best.1[0]) {
            best = (count, ends);
        }
    }
    best
}

/// All readings judged by a band.
fn keep(seen: &[Seen], band: &Band, slack_s: f64, wrap_s: Option<f64>) -> Agreed {
    let middle_s = 0.5 * (band.from_s + band.to_s);
    let half_s = 0.5 * (band.to_s - band.from_s) + slack_s;
    let mut shown_s: Vec<Option<f64>> = seen
        .iter()
        .map(|seen| {
            let off = seen.shown_s - seen.time_s - band.drift * seen.time_s - middle_s;
            let turns = wrap_s.map_or(0.0, |wrap_s| (off / wrap_s).round() * wrap_s);
            ((off - turns).abs() <= half_s).then_some(seen.shown_s - turns)
        })
        .collect();
    forward_only(&mut shown_s);
    let turns = |(seen, shown): (&Seen, &Option<f64>)| {
        shown.map(|shown| wrap_s.map_or(0.0, |wrap_s| ((shown - seen.shown_s) / wrap_s).round() * wrap_s))
    };
    let mut turns_s: Vec<Option<f64>> = seen.iter().zip(&shown_s).map(turns).collect();
    let first_s = turns_s.iter().flatten().next().copied().unwrap_or(0.0);
    turns_s.iter_mut().flatten().for_each(|turns_s| *turns_s -= first_s);
    Agreed {
        count: turns_s.iter().flatten().count(),
        turns_s,
        drift: band.drift,
        band_s: [band.from_s - first_s, band.to_s - first_s],
    }
}

/// Keeps the longest sequence that never falls.
fn forward_only(shown_s: &mut [Option<f64>]) {
    // For each length the place of the least last reading of a sequence that long, and each reading's predecessor.
    let mut ends: Vec<usize> = Vec::new();
    let mut before = vec![usize::MAX; shown_s.len()];
    for k in 0..shown_s.len() {
        let Some(this) = shown_s[k] else { continue };
        let length = ends.partition_point(|&end| shown_s[end].is_some_and(|other| other <= this));
        if length > 0 {
            before[k] = ends[length - 1];
        }
        match ends.get_mut(length) {
            Some(end) => *end = k,
            None => ends.push(k),
        }
    }
    let mut keep = vec![false; shown_s.len()];
    let mut place = ends.last().copied().unwrap_or(usize::MAX);
    while let Some(kept) = keep.get_mut(place) {
        *kept = true;
        place = before[place];
    }
    for (shown, keep) in shown_s.iter_mut().zip(keep) {
        if !keep {
            *shown = None;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_readings_of_a_long_video_agree() {
        // Tenths of a second at 30 frames a second: every third frame shows the same part of a tenth.
        for frames in [900_usize, 1200, 1600, 2397, 2400, 5000, 54_000] {
            for (drift, wrap_s) in [(0.0, None), (3e-4, Some(3600.0)), (-1.5e-3, None)] {
                let middle_s = (frames - 1) as f64 / 60.0;
                let seen = |index: usize| {
                    let time_s = index as f64 / 30.0;
                    let shown_s = ((10.0 * (1.0 + drift) * time_s + 0.01).floor() / 10.0).max(0.0);
                    Seen { index, time_s: time_s - middle_s, shown_s }
                };
                let seen: Vec<Seen> = (0..frames).map(seen).collect();
                let agreed = agree(&seen, 0.1 + 1.0 / 60.0, 2e-3, wrap_s);
                assert_eq!(agreed.count, frames, "{frames} frames, drift {drift}");
            }
        }
    }

    #[test]
    fn time_only_goes_forward() {
        let mut shown = [1.0, 1.0, 5.0, 1.1, 1.2, 0.9, 1.2, 1.3].map(Some);
        forward_only(&mut shown);
        assert_eq!(shown, [Some(1.0), Some(1.0), None, Some(1.1), Some(1.2), None, Some(1.2), Some(1.3)]);
    }

    #[test]
    fn the_fullest_interval_may_lie_over_the_seam() {
        let (count, ends) = fullest(&mut vec![0.05, 9.95, 9.98, 0.01, 5.0, 5.05], 0.2, Some(10.0));
        assert_eq!(count, 4);
        assert!((ends[0] - 9.95).abs() < 1e-12 && (ends[1] - 10.05).abs() < 1e-12);
    }
}
