//! Places on the nail over which a virtual photodiode, or a cell of a map, averages.
//!
//! A region is a set of points in half widths and half lengths about the nail's middle, in groups of half a millimetre:
//! of a group it is judged whether something lies over it.

use crate::nail::{Outline, Positions};
use crate::nailvideo::affine::Affine;

/// Points for a group's side: close enough that the mean is that over the area (measured: 0.01 of 255 on the phantom).
const POINTS: usize = 5;
/// Groups a millimetre.
const GROUPS_PER_MM: f64 = 2.0;
/// A side of the maps and cells, of the nail's box (section 4.2.2).
pub(in crate::nailvideo) const MARGIN: f64 = 1.25;

/// Points within so many half widths and half lengths of the nail's middle are near.
pub(super) const NEAR: f64 = 1.3;

/// Points that are judged together.
#[derive(Debug, Clone)]
pub(in crate::nailvideo) struct Group {
    /// In half widths and half lengths.
    pub(super) points: Vec<[f64; 2]>,
    /// Whether all of them are near.
    pub(super) is_near: bool,
}

impl Group {
    pub(super) fn new(points: Vec<[f64; 2]>) -> Self {
        let is_near = points.as_flattened().iter().all(|part| part.abs() <= NEAR);
        Self { points, is_near }
    }
}

/// A place that is averaged over.
#[derive(Debug, Clone)]
pub(in crate::nailvideo) struct Region {
    pub(in crate::nailvideo) groups: Vec<Group>,
}

impl Region {
    /// From its first point to its last, in half widths.
    pub(in crate::nailvideo) fn width(&self) -> f64 {
        let across = self.groups.iter().flat_map(|group| &group.points).map(|[u, _]| *u);
        across.clone().fold(f64::NEG_INFINITY, f64::max) - across.fold(f64::INFINITY, f64::min)
    }
}

/// The photodiodes' discs; `extent_px` are the nail's width and length.
pub(in crate::nailvideo) fn discs(positions: &Positions, extent_px: [f64; 2]) -> Vec<Region> {
    discs_at(positions, extent_px, positions.photodiodes.iter().map(|one| [one.u, one.v]))
}

/// The same discs at places that are spread evenly over the nail, its edge left out.
pub(in crate::nailvideo) fn spread_discs(positions: &Positions, extent_px: [f64; 2]) -> Vec<Region> {
    const SIDE: usize = 9;
    let place = |k: usize| [k % SIDE, k / SIDE].map(|n| 0.2 * (n as f64 - 4.0));
    let is_inside = |[u, v]: &[f64; 2]| u.abs().powi(3) + v.abs().powi(3) <= 0.65;
    discs_at(positions, extent_px, (0..SIDE * SIDE).map(place).filter(is_inside))
}

fn discs_at(positions: &Positions, [width, length]: [f64; 2], places: impl Iterator<Item = [f64; 2]>) -> Vec<Region> {
    let radius = positions.radius_widths();
    // In half widths across, half lengths along.
    let [ru, rv] = [2.0 * radius, 2.0 * radius * width / length];
    let sides = ((positions.diameter_mm * GROUPS_PER_MM).round() as usize).clamp(2, 16);
    let across = sides * POINTS;
    let disc = |at: [f64; 2]| {
        let mut groups = vec![Vec::new(); sides * sides];
        for k in 0..across * across {
            let [x, y] = [k % across, k / across];
            let [p, q] = [x, y].map(|n| (2 * n + 1) as f64 / across as f64 - 1.0);
            if p * p + q * q <= 1.0 {
                groups[y / POINTS * sides + x / POINTS].push([at[0] + ru * p, at[1] + rv * q]);
            }
        }
        groups.into_iter().filter(|points| !points.is_empty()).map(Group::new).collect()
    };
    places.map(|at| Region { groups: disc(at) }).collect()
}

/// N x N cells of the normalized nail, row by row from its distal end, those whose middle lies in the outline; the
/// others are `None`.
pub(in crate::nailvideo) fn cells(n: usize, outline: &Outline, frame_from_nail: &Affine) -> Vec<Option<Region>> {
    use geo::Contains;
    let side = 2.0 * MARGIN / n as f64;
    let cell = |k: usize| {
        let (row, column) = (k / n, k % n);
        let corner = [column as f64 * side - MARGIN, MARGIN - row as f64 * side];
        let [x, y] = frame_from_nail.of([corner[0] + 0.5 * side, corner[1] - 0.5 * side]);
        let points = (0..POINTS * POINTS).map(|p| {
            let [x, y] = [p % POINTS, p / POINTS].map(|part| (part as f64 + 0.5) / POINTS as f64 * side);
            [corner[0] + x, corner[1] - y]
        });
        let inside = outline.polygon().contains(&geo::Point::new(x, y));
        let groups = vec![Group::new(points.collect())];
        inside.then_some(Region { groups })
    };
    (0..n * n).map(cell).collect()
}

/// `C_03_11`: row from the distal end, column from the left with the tip up.
pub(in crate::nailvideo) fn cell_name(row: usize, column: usize) -> String {
    format!("C_{row:02}_{column:02}")
}

/// Cells of about a millimetre over the nail's box, which say how the light changed.
pub(in crate::nailvideo) fn light_cells() -> Vec<Group> {
    const SIDE: usize = 10;
    let place = |n: usize| (n as f64 + 0.5) / (0.5 * SIDE as f64) - 1.0;
    let point = |k: usize, p: usize| {
        let [x, y] = [k % SIDE, k / SIDE].map(place);
        [x + 0.1 * ((p % 2) as f64 - 0.5), y + 0.1 * ((p / 2) as f64 - 0.5)]
    };
    (0..SIDE * SIDE).map(|k| Group::new((0..4).map(|p| point(k, p)).collect())).collect()
}

/// Skin on both sides of the nail.
pub(in crate::nailvideo) fn skin() -> Group {
    let side = |u: f64| (0..24).map(move |k| [u, f64::from(k) / 15.0 - 0.8]);
    Group::new([-1.2, -1.15, 1.15, 1.2].into_iter().flat_map(side).collect())
}
