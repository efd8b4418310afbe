//! What is wrong with a clock whose readings don't agree.

use super::consensus::{Agreed, Seen, agree, agree_with};
use super::polygon::{Hulls, Point};
use super::{ClockFault, FEWEST, MOST_DRIFT, SLOWEST_SCREEN_S};
use crate::median::median_of;

/// Readings that make a second clock, not a misread digit.
const SECOND: usize = 5;
/// A clock that shows the same for so much longer than its resolution stands still, seconds.
const STILL_S: f64 = 0.5;

/// Says what is wrong, if anything: the clock stands still at the beginning or the end or in the midst, jumps, or runs
/// at another rate; or most readings do not agree. `room_s` is that of the clock and its usual screen; `middle_s` and
/// `first_s` are taken off the readings' times and what they show.
pub(super) fn diagnose(
    seen: &[Seen],
    agreed: &Agreed,
    resolution_s: f64,
    room_s: f64,
    middle_s: f64,
    first_s: f64,
) -> Result<(), ClockFault> {
    let most = 2 * agreed.count > seen.len();
    if agreed.count == seen.len() {
        return Ok(());
    }
    let refused: Vec<Seen> =
        seen.iter().zip(&agreed.turns_s).filter(|(_, turns)| turns.is_none()).map(|(seen, _)| *seen).collect();
    let taken = || seen.iter().zip(&agreed.turns_s).filter(|(_, turns)| turns.is_some()).map(|(seen, _)| seen.time_s);
    let (begin_s, end_s) = (taken().fold(f64::INFINITY, f64::min), taken().fold(f64::NEG_INFINITY, f64::max));
    // Outside of what agrees, or anywhere if little does.
    let outside = |from_s: f64, to_s: f64| !most || to_s < begin_s + resolution_s || from_s > end_s - resolution_s;
    if let Some([from, to]) = longest_still(seen)
        && to.time_s - from.time_s > resolution_s + SLOWEST_SCREEN_S + STILL_S
    {
        let goes_on = second(&refused, agreed, resolution_s).is_some_and(|(other, _)| apart(&other, begin_s, end_s));
        if outside(from.time_s, to.time_s) || goes_on {
            let (from_s, to_s) = (from.time_s + middle_s, to.time_s + middle_s);
            return Err(ClockFault::Stops { from_s, to_s, shown_s: from.shown_s + first_s });
        }
    }
    if let Some(jump) = parted(seen, agreed, room_s, middle_s) {
        return Err(jump);
    }
    if let Some(rate) = other_rate(seen, resolution_s)
        && !most
    {
        return Err(ClockFault::Rate { rate });
    }
    if let Some((other, by_s)) = second(&refused, agreed, resolution_s)
        && apart(&other, begin_s, end_s)
    {
        let later = other[0] > end_s;
        let at_s = if later { 0.5 * (end_s + other[0]) } else { 0.5 * (other[1] + begin_s) };
        return Err(ClockFault::Jumps { at_s: at_s + middle_s, by_s: if later { by_s } else { -by_s } });
    }
    if most { Ok(()) } else { Err(contradictory(seen, agreed, middle_s)) }
}

/// The fault of readings of which too few agree.
pub(super) fn contradictory(seen: &[Seen], agreed: &Agreed, middle_s: f64) -> ClockFault {
    let first =
        seen.iter().zip(&agreed.turns_s).find(|(_, turns)| turns.is_none()).map_or(seen[0].time_s, |(s, _)| s.time_s);
    ClockFault::Contradictory { agree: agreed.count, read: seen.len(), at_s: first + middle_s }
}

/// The readings between which the clock shows the same for the longest.
fn longest_still(seen: &[Seen]) -> Option<[Seen; 2]> {
    let runs = seen.chunk_by(|a, b| a.shown_s == b.shown_s).filter_map(|run| Some([*run.first()?, *run.last()?]));
    runs.max_by(|a, b| (a[1].time_s - a[0].time_s).total_cmp(&(b[1].time_s - b[0].time_s)))
}

/// Whether a second clock's readings lie before or after all of the first's.
fn apart(other: &[f64; 2], begin_s: f64, end_s: f64) -> bool {
    other[0] > end_s || other[1] < begin_s
}

/// A second clock among what the first refused: between which times, and by how much it shows more.
fn second(refused: &[Seen], first: &Agreed, resolution_s: f64) -> Option<([f64; 2], f64)> {
    if refused.len() < SECOND {
        return None;
    }
    let other = agree(refused, resolution_s + SLOWEST_SCREEN_S, MOST_DRIFT, None);
    let mut taken = refused.iter().zip(&other.turns_s).filter(|(_, turns)| turns.is_some()).map(|(seen, _)| seen);
    let from_s = taken.clone().next()?.time_s;
    let to_s = taken.next_back()?.time_s;
    let long = to_s - from_s >= (3.0 * resolution_s).max(STILL_S);
    let middle_s = 0.5 * (from_s + to_s);
    let height = |agreed: &Agreed| 0.5 * (agreed.band_s[0] + agreed.band_s[1]) + agreed.drift * middle_s;
    (other.count >= SECOND.max(FEWEST) && long).then(|| ([from_s, to_s], height(&other) - height(first)))
}

/// Screens that seem later than is usual by less than this are no reason to doubt, seconds.
const LATE_S: f64 = 4e-3;
/// What explains it better than a slow screen leaves this share of it at most (a jump could be anywhere, so that
/// misread digits are parted by one), and by chance, were the digits' changes late at random, no more often than this
/// (assumed).
const LEFT_BY_RATE: f64 = 0.5;
const LEFT_BY_JUMP: f64 = 0.2;
const CHANCE: f64 = 1e-3;
/// Another rate than the video's that is looked for; of a larger one too few readings agree.
const LARGEST_DRIFT: f64 = 0.1;
/// A jump that a screen's delay, late now more and now less in a slow rhythm, can't be taken for, seconds.
const JUMP_S: f64 = 0.04;
/// Drifts with which a jump is looked for: none, and of 29.97 frames a second taken for 30 or the other way round.
const JUMP_DRIFTS: [f64; 3] = [0.0, -1e-3, 1e-3];

/// Why readings, as the polygon takes them, come `late_s` later than from a usual screen, where another rate than the
/// video's or a jump explains it better than a slow screen: that would be late now more, now less, and neither the
/// longer the video runs nor from a moment on. Frames that are said to be evenly spaced, and were not taken so or lost,
/// look like this. `room_s` is that of the clock and its usual screen; times are about `middle_s`.
pub(super) fn late(points: &[Point], hulls: &Hulls, room_s: f64, late_s: f64, middle_s: f64) -> Option<ClockFault> {
    if late_s < LATE_S {
        return None;
    }
    let (room, end_s) = hulls.least_room(LARGEST_DRIFT * hulls.half_s);
    let drift = end_s / hulls.half_s;
    let rate =
        (drift.abs() > MOST_DRIFT).then_some((room - room_s, LEFT_BY_RATE, ClockFault::Rate { rate: 1.0 + drift }));
    let long = |k: usize| [&points[..k], &points[k..]].into_iter().all(|side| changes(side) >= SECOND);
    let jumps = jumps(points).filter(|&(_, k, by_s)| by_s.abs() >= JUMP_S && long(k));
    let jumps = jumps.map(|(width_s, k, by_s)| {
        let at_s = 0.5 * (points[k - 1][0] + points[k][0]) + middle_s;
        (width_s - room_s, LEFT_BY_JUMP, ClockFault::Jumps { at_s, by_s })
    });
    let power = changes(points) as i32 - 4;
    let explains = |(left_s, most, _): &(f64, f64, ClockFault)| {
        *left_s <= LATE_S.max(most * late_s) && (left_s.max(LATE_S) / late_s).powi(power) < CHANCE
    };
    let best = rate.into_iter().chain(jumps).filter(explains).min_by(|a, b| a.0.total_cmp(&b.0));
    best.map(|(.., fault)| fault)
}

/// How often the digits change.
fn changes(points: &[Point]) -> usize {
    let shown = |point: &Point| point[0] + point[1];
    points.windows(2).filter(|pair| (shown(&pair[1]) - shown(&pair[0])).abs() > 1e-4).count()
}

/// A jump that explains every reading that is refused, and that others between them agree with: of the digits on the
/// other side of a jump by about the clock's resolution those near their change lie in the first clock's band too, and
/// a tilted band holds the more of them. Refused ones that are the first or the last of all are no such readings.
fn parted(seen: &[Seen], agreed: &Agreed, room_s: f64, middle_s: f64) -> Option<ClockFault> {
    let refused = || agreed.turns_s.iter().enumerate().filter(|(_, turns)| turns.is_none()).map(|(k, _)| k);
    let (first, last) = (refused().next()?, refused().next_back()?);
    let whole = last - first + 1 == refused().count() && (first == 0 || last + 1 == seen.len());
    if whole && 2 * agreed.count > seen.len() || refused().count() < SECOND {
        return None;
    }
    let turned = |turns_s: &mut f64, (seen, own_s): (&Seen, &Option<f64>)| {
        *turns_s = own_s.unwrap_or(*turns_s);
        Some([seen.time_s, seen.shown_s + *turns_s - seen.time_s])
    };
    let points: Vec<Point> = seen.iter().zip(&agreed.turns_s).scan(0.0, turned).collect();
    let explains = |&(width_s, _, by_s): &(f64, usize, f64)| width_s <= room_s + LATE_S && by_s.abs() >= JUMP_S;
    let (_, k, by_s) = jumps(&points).filter(explains).min_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(ClockFault::Jumps { at_s: 0.5 * (points[k - 1][0] + points[k][0]) + middle_s, by_s })
}

/// The best jump at each of the drifts that one is looked for with.
fn jumps(points: &[Point]) -> impl Iterator<Item = (f64, usize, f64)> {
    JUMP_DRIFTS.into_iter().filter_map(|drift| jump(points, drift))
}

/// Where readings of a clock of this drift are parted so that those before and those after lie the closest: how close,
/// which is the first after, and by how much these show more.
fn jump(points: &[Point], drift: f64) -> Option<(f64, usize, f64)> {
    let ends = |points: &mut dyn Iterator<Item = &Point>| -> Vec<[f64; 2]> {
        let widen = |ends: &mut [f64; 2], point: &Point| {
            let at = point[1] - drift * point[0];
            *ends = [ends[0].min(at), ends[1].max(at)];
            Some(*ends)
        };
        points.scan([f64::INFINITY, f64::NEG_INFINITY], widen).collect()
    };
    let (before, after) = (ends(&mut points.iter()), ends(&mut points.iter().rev()));
    let at = |k: usize| [before[k - 1], after[points.len() - 1 - k]];
    let wider = |k: usize| at(k).map(|[low, high]| high - low).into_iter().fold(0.0, f64::max);
    let k = (1..points.len()).min_by(|a, b| wider(*a).total_cmp(&wider(*b)))?;
    let sides = [&points[..k], &points[k..]];
    // Not the middles: of digits that are misread now and then, those that are left may differ.
    let [before, after] = sides.map(|side| median_of(side.iter().map(|point| point[1] - drift * point[0])));
    Some((wider(k), k, after? - before?))
}

/// The clock's rate where at another one most of the readings agree that are refused; `room_s`: of the clock and its
/// usual screen.
pub(super) fn rate_for_refused(seen: &[Seen], agreed: &Agreed, room_s: f64, wraps_s: &[f64]) -> Option<f64> {
    let refused = seen.len() - agreed.count;
    if refused < SECOND {
        return None;
    }
    // At a rate that differs more, most would be refused.
    let half_s = seen.iter().map(|seen| seen.time_s.abs()).fold(0.0, f64::max);
    let free = agree_with(seen, room_s, MOST_DRIFT + 2.0 * room_s / half_s.max(room_s), wraps_s);
    let explains = 4 * (seen.len() - free.count) <= refused;
    (explains && free.drift.abs() > MOST_DRIFT).then_some(1.0 + free.drift)
}

/// The clock's rate where it clearly is another than the video's.
fn other_rate(seen: &[Seen], resolution_s: f64) -> Option<f64> {
    let apart = seen.len() / 2;
    let pairs = seen[..seen.len() - apart].iter().zip(&seen[apart..]);
    let mut rates: Vec<f64> = pairs
        .filter(|(a, b)| b.time_s > a.time_s)
        .map(|(a, b)| (b.shown_s - a.shown_s) / (b.time_s - a.time_s))
        .collect();
    if rates.len() < SECOND {
        return None;
    }
    rates.sort_by(f64::total_cmp);
    let [low, rate, high] = [1, 2, 3].map(|k| rates[k * (rates.len() - 1) / 4]);
    let long_s = seen[seen.len() - 1].time_s - seen[0].time_s;
    let sure = high - low <= 0.02 * rate.abs() + 8.0 * (resolution_s + SLOWEST_SCREEN_S) / long_s;
    (sure && (rate - 1.0).abs() > MOST_DRIFT).then_some(rate)
}
