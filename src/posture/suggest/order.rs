//! Spots in a row: which belong to it, and in which order.

use super::{BLOT_SIZE_FACTOR, Mark, SIZE_FACTOR};
use crate::median::median_of;
use crate::posture::survey::find::distance;

/// Rows of more markers than this are ordered from one end by the nearest next one.
const MOST_EXACT: usize = 12;
/// A link longer than this many times the median one leads out of the row.
const LONGEST_LINK: f64 = 2.6;

/// The spots of about one size that lie near one another: the largest such group.
pub(super) fn row(marks: &[Mark]) -> Vec<Mark> {
    let mut best: Vec<Mark> = Vec::new();
    for seed in marks {
        let alike: Vec<Mark> = (marks.iter().copied())
            .filter(|mark| {
                let factor = if mark.colour == seed.colour { BLOT_SIZE_FACTOR } else { SIZE_FACTOR };
                (mark.radius_px / seed.radius_px).ln().abs() < factor.ln()
            })
            .collect();
        let group = largest_cluster(&alike);
        if group.len() > best.len() {
            best = group;
        }
    }
    best
}

/// Links the spots by a shortest tree, cuts its long links, and keeps the largest part.
fn largest_cluster(marks: &[Mark]) -> Vec<Mark> {
    if marks.len() < 3 {
        return marks.to_vec();
    }
    let mut inside = vec![0];
    let mut links: Vec<(usize, usize, f64)> = Vec::new();
    while inside.len() < marks.len() {
        let outside = (0..marks.len()).filter(|k| !inside.contains(k));
        let next = outside
            .flat_map(|k| inside.iter().map(move |&from| (from, k)))
            .map(|(from, k)| (from, k, distance(marks[from].at_px, marks[k].at_px)))
            .min_by(|a, b| a.2.total_cmp(&b.2));
        let Some(link) = next else { break };
        inside.push(link.1);
        links.push(link);
    }
    let longest = LONGEST_LINK * median_of(links.iter().map(|link| link.2)).unwrap_or(f64::NAN);
    let mut part: Vec<usize> = (0..marks.len()).collect();
    for &(a, b, length) in &links {
        if length <= longest {
            let (from, to) = (part[b], part[a]);
            part.iter_mut().filter(|number| **number == from).for_each(|number| *number = to);
        }
    }
    let size = |number: usize| part.iter().filter(|&&other| other == number).count();
    let largest = (0..marks.len()).max_by_key(|&k| (size(part[k]), std::cmp::Reverse(k))).map_or(0, |k| part[k]);
    (0..marks.len()).filter(|&k| part[k] == largest).map(|k| marks[k]).collect()
}

/// The spots in the order of the shortest way through all of them.
pub(super) fn path(marks: &[Mark]) -> Vec<Mark> {
    let count = marks.len();
    if count > MOST_EXACT {
        return nearest_next(marks);
    }
    if count < 2 {
        return marks.to_vec();
    }
    // Shortest way through a set of spots that ends at one of them, and the spot before (Held and Karp 1962).
    let mut best = vec![(f64::INFINITY, usize::MAX); count << count];
    for k in 0..count {
        best[((1 << k) * count) + k] = (0.0, usize::MAX);
    }
    for set in 1..1usize << count {
        for end in (0..count).filter(|&end| set >> end & 1 == 1) {
            let (length, _) = best[set * count + end];
            if length.is_infinite() {
                continue;
            }
            for next in (0..count).filter(|&next| set >> next & 1 == 0) {
                let longer = length + distance(marks[end].at_px, marks[next].at_px);
                let slot = &mut best[(set | 1 << next) * count + next];
                if longer < slot.0 {
                    *slot = (longer, end);
                }
            }
        }
    }
    let mut set = (1usize << count) - 1;
    let mut end = (0..count).min_by(|&a, &b| best[set * count + a].0.total_cmp(&best[set * count + b].0)).unwrap_or(0);
    let mut order = Vec::with_capacity(count);
    loop {
        order.push(marks[end]);
        let (_, before) = best[set * count + end];
        if before == usize::MAX {
            return order;
        }
        set &= !(1 << end);
        end = before;
    }
}

fn nearest_next(marks: &[Mark]) -> Vec<Mark> {
    let mut left = marks.to_vec();
    // The leftmost one is an end as often as not.
    let first = (0..left.len()).min_by(|&a, &b| left[a].at_px[0].total_cmp(&left[b].at_px[0])).unwrap_or(0);
    let mut order = vec![left.remove(first)];
    while !left.is_empty() {
        let here = order[order.len() - 1].at_px;
        let near = |k: &usize| distance(left[*k].at_px, here);
        let next = (0..left.len()).min_by(|a, b| near(a).total_cmp(&near(b))).unwrap_or(0);
        order.push(left.remove(next));
    }
    order
}

/// How far a row turns from its first link to its last, clockwise on the picture.
pub(super) fn total_turn(marks: &[Mark]) -> f64 {
    let link = |pair: &[Mark]| [pair[1].at_px[0] - pair[0].at_px[0], pair[1].at_px[1] - pair[0].at_px[1]];
    let turn = |three: &[Mark]| {
        let (a, b) = (link(&three[..2]), link(&three[1..]));
        (a[0] * b[1] - a[1] * b[0]).atan2(a[0] * b[0] + a[1] * b[1])
    };
    marks.windows(3).map(turn).sum()
}
