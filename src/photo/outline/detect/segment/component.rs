//! From the network's planes to components: one nail each, as one look shows it.

use crate::photo::outline::Outline;
use crate::photo::outline::mask::{Region, largest_outline};
use crate::vision::{Neighbours, Planes, VisionError, parts};

/// The network's planes are whole numbers of these, pixels; beyond the picture they are black.
const WHOLE: usize = 32;
/// Pixels a cell of the answer.
const CELL: usize = 2;
/// Probability from which a cell is nail, or core.
const THRESHOLD: f32 = 0.5;
const LEAST_CELLS: usize = 4;

/// A part of a photograph as the network gets it.
pub(super) struct View {
    /// Red, green, blue, row by row.
    pub(super) rgb: Vec<u8>,
    /// Columns and rows.
    pub(super) size: [usize; 2],
    /// Its corner on the photograph, pixels.
    pub(super) corner: [usize; 2],
    /// The size of the part on the photograph, pixels.
    pub(super) part: [usize; 2],
}

/// A nail as one look shows it.
#[derive(Debug, Clone)]
pub(super) struct Component {
    /// Photograph pixels.
    pub(super) outline: Outline,
    /// Mean place of its cells, photograph pixels.
    pub(super) centre: [f64; 2],
    /// Four standard deviations along its principal axis, pixels of the look.
    pub(super) length: f64,
    /// Pixels of the look a pixel of the photograph.
    pub(super) scale: f64,
    /// Log odds of the mean probability that its cells are nail, and those of its core are core; bounded.
    pub(super) nail: f64,
    pub(super) core: f64,
    /// Area over that of the ellipse of the same second moments.
    pub(super) solid: f64,
}

impl View {
    /// The network's input: red, green, blue from 0 to 1, black right of and below the picture.
    pub(super) fn planes(&self) -> Planes {
        let [width, height] = self.size;
        let [rows, columns] = [height, width].map(|n| n.next_multiple_of(WHOLE));
        let mut values = vec![0.0; 3 * rows * columns];
        for (c, plane) in values.chunks_exact_mut(rows * columns).enumerate() {
            for (to, from) in plane.chunks_exact_mut(columns).zip(self.rgb.chunks_exact(3 * width)) {
                for (to, pixel) in to.iter_mut().zip(from.as_chunks::<3>().0) {
                    *to = f32::from(pixel[c]) / 255.0;
                }
            }
        }
        Planes { size: [3, rows, columns], values }
    }

    fn place(&self, cell: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|k| {
            let share = (cell[k] + 0.5) * CELL as f64 / self.size[k] as f64;
            self.corner[k] as f64 + share * self.part[k] as f64 - 0.5
        })
    }

    /// The components that the network's `answer` shows.
    pub(super) fn components(&self, answer: &Planes) -> Result<Vec<Component>, VisionError> {
        let [channels, rows, columns] = answer.size;
        if channels != 2 {
            return Err(VisionError::lacking("Net::forward", format!("{channels} planes where there should be 2")));
        }
        let (nail, core) = answer.values.split_at(rows * columns);
        let seeds: Vec<u8> = nail.iter().zip(core).map(|(n, c)| u8::from(*n > THRESHOLD && *c > THRESHOLD)).collect();
        let cores: Vec<u32> =
            parts(&seeds, [columns, rows], Neighbours::Four).labels.into_iter().map(i32::cast_unsigned).collect();
        let labels = grown(cores.clone(), nail, columns);
        let mut members = vec![Vec::new(); cores.iter().copied().max().unwrap_or(0) as usize];
        for (at, &label) in labels.iter().enumerate().filter(|(_, label)| **label > 0) {
            members[label as usize - 1].push(at);
        }
        let all = (1_u32..).zip(members).filter(|(_, cells)| cells.len() >= LEAST_CELLS);
        let one = |(label, cells): (u32, Vec<usize>)| {
            // Cells of nobody that the level line runs through.
            let value = |at: usize| match labels[at] {
                own if own == label => nail[at],
                0 => nail[at].min(THRESHOLD),
                _ => 0.0,
            };
            let ends = |of: fn(usize, usize) -> usize| {
                let all = cells.iter().map(|&at| of(at, columns) as u32);
                all.fold([u32::MAX, 0], |[low, high], v| [low.min(v), high.max(v)])
            };
            let (x, y) = (ends(|at, columns| at % columns), ends(|at, columns| at / columns));
            let region = Region { x, y, size: [columns as u32, rows as u32] };
            let rings = region.rings(|x, y| f64::from(value(y as usize * columns + x as usize)));
            let outline = largest_outline(rings, |cell| self.place(cell))?;
            let core = cells.iter().filter(|at| cores[**at] == label).map(|&at| core[at]);
            Some(self.component(outline, &Cells::of(&cells, columns), cells.iter().map(|&at| nail[at]), core))
        };
        Ok(all.filter_map(one).collect())
    }

    fn component(
        &self,
        outline: Outline,
        cells: &Cells,
        nail: impl Iterator<Item = f32>,
        core: impl Iterator<Item = f32>,
    ) -> Component {
        Component {
            outline,
            centre: self.place(cells.centre),
            length: 4.0 * CELL as f64 * cells.sd[0],
            scale: self.size[0] as f64 / self.part[0] as f64,
            nail: log_odds(mean(nail)),
            core: log_odds(mean(core)),
            solid: cells.count / (4.0 * std::f64::consts::PI * cells.sd[0] * cells.sd[1]),
        }
    }
}

/// Moments of cells: how many, their mean place, standard deviations along and across.
struct Cells {
    count: f64,
    centre: [f64; 2],
    sd: [f64; 2],
}

impl Cells {
    fn of(cells: &[usize], columns: usize) -> Self {
        let count = cells.len() as f64;
        let mean = |value: &dyn Fn(usize) -> f64| cells.iter().map(|&at| value(at)).sum::<f64>() / count;
        let (x, y) = (|at: usize| (at % columns) as f64, |at: usize| (at / columns) as f64);
        let [mx, my] = [mean(&x), mean(&y)];
        // Of a sample, and of squares rather than points.
        let part = count / (count - 1.0);
        let xx = part * mean(&|at| (x(at) - mx).powi(2)) + 1.0 / 12.0;
        let yy = part * mean(&|at| (y(at) - my).powi(2)) + 1.0 / 12.0;
        let xy = part * mean(&|at| (x(at) - mx) * (y(at) - my));
        let (middle, half) = (0.5 * (xx + yy), (0.5 * (xx - yy)).hypot(xy));
        let sd = [middle + half, middle - half].map(|variance| variance.max(1.0 / 12.0).sqrt());
        Self { count, centre: [mx, my], sd }
    }
}

fn mean(values: impl Iterator<Item = f32>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0_f64), |(sum, count), value| (sum + f64::from(value), count + 1.0));
    sum / count.max(1.0)
}

/// Bounded, that no probability decides alone.
pub(super) fn log_odds(probability: f64) -> f64 {
    let p = probability.clamp(0.01, 0.99);
    (p / (1.0 - p)).ln()
}

/// Components grown into cells of nail, a ring of neighbours at a time; where two meet, the first one takes the cell.
fn grown(mut labels: Vec<u32>, nail: &[f32], columns: usize) -> Vec<u32> {
    let beside = |at: usize| {
        let x = at % columns;
        let left = (x > 0).then(|| at - 1);
        let right = (x + 1 < columns).then_some(at + 1);
        let below = (at + columns < nail.len()).then_some(at + columns);
        [left, right, at.checked_sub(columns), below].into_iter().flatten()
    };
    let mut ring: Vec<usize> = (0..labels.len()).filter(|&at| labels[at] > 0).collect();
    while !ring.is_empty() {
        let mut taken: Vec<(usize, u32)> = ring
            .iter()
            .flat_map(|&at| beside(at).map(move |other| (other, at)))
            .filter(|&(other, _)| labels[other] == 0 && nail[other] > THRESHOLD)
            .map(|(other, at)| (other, labels[at]))
            .collect();
        taken.sort_unstable();
        taken.dedup_by_key(|(other, _)| *other);
        for &(other, label) in &taken {
            labels[other] = label;
        }
        ring = taken.into_iter().map(|(other, _)| other).collect();
    }
    labels
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Planes of two touching squares with a core each, and a core that is too small.
    fn planes() -> Planes {
        let (rows, columns) = (16, 32);
        let mut values = vec![0.02; 2 * rows * columns];
        for y in 4..12 {
            for x in 4..20 {
                values[y * columns + x] = 0.9;
            }
        }
        for (x0, x1) in [(6, 10), (14, 18)] {
            for y in 6..10 {
                values[(rows + y) * columns + x0..(rows + y) * columns + x1].fill(0.8);
            }
        }
        values[columns + 30] = 0.9;
        values[(rows + 1) * columns + 30] = 0.9;
        Planes { size: [2, rows, columns], values }
    }

    #[test]
    fn neighbours_part_between_their_cores() {
        let view = View { rgb: vec![], size: [64, 32], corner: [100, 50], part: [128, 64] };
        let found = view.components(&planes()).expect("components");
        assert_eq!(found.len(), 2);
        for (one, x) in found.iter().zip([131.5, 163.5]) {
            assert!((one.centre[0] - x).abs() <= 1e-9 && (one.centre[1] - 81.5).abs() <= 1e-9, "{:?}", one.centre);
            // 8 x 8 cells of 4 photograph pixels; the level lies a little outside of the last cell's centre.
            assert!((one.outline.area_px2() / 1024.0 - 1.0).abs() <= 0.15, "{}", one.outline.area_px2());
            assert!((one.solid - 0.95).abs() <= 0.05 && one.scale == 0.5);
        }
        assert!(found[0].outline.iou(&found[1].outline) <= 0.05);
    }

    #[test]
    fn an_answer_of_one_plane_is_an_error() {
        let view = View { rgb: vec![], size: [4, 4], corner: [0, 0], part: [4, 4] };
        assert!(view.components(&Planes { size: [1, 2, 2], values: vec![0.0; 4] }).is_err());
        let none = view.components(&Planes { size: [2, 2, 2], values: vec![0.0; 8] }).expect("no component");
        assert!(none.is_empty());
    }
}
