//! What of the nail is covered in a frame in which the rim of something lies over it.
//!
//! A finger has the colour of a finger: what lies over the nail is known by its rim, which does not fit the nail's
//! texture, or by its colour, and the nail is what is connected beside it. Until this was so, most values of
//! photodiodes under another finger of the same hand were given as the nail's (`lunula phantom nailvideo --finger`, 24
//! persons: 663 of 1075), off by up to 35 of 100 ln(green/red).

use super::region::Group;
use super::{Limits, Logs};
use crate::median::median_of;
use crate::nailvideo::follow::{CELLS, Covered, Rim, cell_at, cell_middle, covered};

/// Where something is known to lie over the nail, colours count as another thing's from so far on: of red, of grey
/// luma, and of blue from the line of blood, natural logarithms (measured on the phantom: from 0.07 to 0.14 and from
/// 0.06 to 0.12 all of 301 covered photodiodes are known, with 0.2 and 0.15 all but one).
const TIGHT: Limits = Limits { red: 0.14, blue: 0.12, ..Limits::USUAL };
/// Points of a cell for its colour, across and down.
const POINTS: usize = 2;

/// The cells of the nail's box.
pub(super) fn box_cells() -> Vec<Group> {
    let side = cell_middle(1)[0] - cell_middle(0)[0];
    let point = |cell: usize, k: usize| {
        let [u, v] = cell_middle(cell);
        let [x, y] = [k % POINTS, k / POINTS].map(|n| side * ((2 * n + 1) as f64 / (2 * POINTS) as f64 - 0.5));
        [u + x, v + y]
    };
    (0..CELLS * CELLS).map(|cell| Group::new((0..POINTS * POINTS).map(|k| point(cell, k)).collect())).collect()
}

/// What is covered by something that has this rim; `changes` are those of the box' cells.
pub(super) fn covered_by<'a>(
    rim: &Rim,
    changes: impl Iterator<Item = (&'a Group, Option<Logs>)>,
    is_grey: bool,
) -> Covered {
    let changes: Vec<Option<[f64; 3]>> = changes.map(|(_, change)| Some(change?.colour)).collect();
    let fits = |cell: usize| if rim.has(cell) { None } else { changes[cell] };
    let light_of = |k: usize| median_of((0..CELLS * CELLS).filter_map(fits).map(|c| c[k])).unwrap_or(f64::NAN);
    let light = std::array::from_fn(light_of);
    covered(|cell| fits(cell).is_some_and(|change| !TIGHT.is_strange(change, light, is_grey)))
}

pub(super) fn points_covered(covered: &Covered, group: &Group) -> usize {
    group.points.iter().filter(|&&point| covered[cell_at(point)]).count()
}
