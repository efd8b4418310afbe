//! The component tree of a grid of levels, and the spots in it.
//!
//! OpenCV has such a tree within `MSER` alone, which gives the regions whose area changes least from level to level,
//! not the levels of a spot's core and ground that are compared here; it was not measured.

use crate::posture::survey::find::grid::{Grid, Spot};

/// A spot has at most this many, chosen by contrast.
const MOST_SPOTS: usize = 48;
/// Grid samples that a spot has at least.
const LEAST_AREA: u32 = 3;
/// A spot covers at most this share of the picture's grid, or this many samples in a small picture.
const LARGEST_SHARE: f64 = 0.04;
const LEAST_LARGEST: f64 = 300.0;
/// The core of a spot is where it has a quarter of its area, its ground where it has four times its area.
const SPREAD: f64 = 4.0;
/// ... and, for small spots, where its radius has shrunk or grown by this many samples: smoothing spreads that far.
const SPREAD_RADIUS: f64 = 2.5;
/// Shapes further from a disc than these are no spots.
const LONGEST: f64 = 4.0;
const LEAST_FILL: f64 = 0.6;

const NONE: u32 = u32::MAX;

/// A connected component as it stands at the present level.
#[derive(Debug, Clone, Copy)]
struct Component {
    sums: Sums,
    /// The newest of its snapshots.
    last: u32,
    /// The level of the first sample.
    top: u8,
    /// The level of the last snapshot's end: sums are those at this level.
    level: u8,
}

#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    area: u32,
    touches: [bool; 4],
    x: f64,
    y: f64,
    xx: f64,
    xy: f64,
    yy: f64,
}

impl Sums {
    fn add(&mut self, other: &Self) {
        self.area += other.area;
        for (mine, theirs) in self.touches.iter_mut().zip(other.touches) {
            *mine |= theirs;
        }
        self.x += other.x;
        self.y += other.y;
        self.xx += other.xx;
        self.xy += other.xy;
        self.yy += other.yy;
    }
}

/// A component at the end of one level.
#[derive(Debug, Clone, Copy)]
struct Snapshot {
    sums: Sums,
    level: u8,
    before: u32,
}

/// A node of a branch that was picked: its area, and the levels of its core and its ground.
#[derive(Debug, Clone, Copy)]
struct Chosen {
    area: f64,
    high: u8,
    low: u8,
}

impl Chosen {
    /// Of quite another size, and not of the same rise of levels.
    fn is_another(&self, other: &Self) -> bool {
        let common = f32::from(self.high.min(other.high).saturating_sub(self.low.max(other.low)));
        let shorter = f32::from((self.high - self.low).min(other.high - other.low));
        (other.area > self.area * SPREAD || other.area * SPREAD < self.area) && common < 0.5 * shorter
    }
}

/// Working memory of the search.
#[derive(Debug, Default)]
pub(super) struct Tree {
    /// The spots found, the most outstanding first.
    pub(super) found: Vec<Spot>,
    order: Vec<u32>,
    parent: Vec<u32>,
    component: Vec<u32>,
    components: Vec<Component>,
    snapshots: Vec<Snapshot>,
    branch: Vec<Snapshot>,
    largest: u32,
    least_contrast: f32,
}

impl Tree {
    /// Finds the spots of `grid.levels` that stand out by `least_contrast` levels.
    pub(super) fn spots(&mut self, grid: &Grid, least_contrast: f32) {
        let (width, height) = (grid.width, grid.height);
        let levels = &grid.levels;
        self.least_contrast = least_contrast;
        self.largest = (grid.samples_of_picture as f64 * LARGEST_SHARE).max(LEAST_LARGEST) as u32;
        self.found.clear();
        self.components.clear();
        self.snapshots.clear();
        self.sort(levels);
        self.parent.clear();
        self.parent.resize(levels.len(), NONE);
        self.component.resize(levels.len(), NONE);
        for place in 0..self.order.len() {
            let index = self.order[place];
            let level = levels[index as usize];
            let (x, y) = (index as usize % width, index as usize / width);
            self.parent[index as usize] = index;
            let mut root = NONE;
            let steps = [
                (x > 0, index.wrapping_sub(1)),
                (x + 1 < width, index + 1),
                (y > 0, index.wrapping_sub(width as u32)),
                (y + 1 < height, index + width as u32),
            ];
            for (inside, neighbour) in steps {
                if inside && self.parent[neighbour as usize] != NONE {
                    let other = self.root(neighbour);
                    root = if root == NONE { other } else { self.join(root, other, level) };
                }
            }
            let (fx, fy) = (x as f64, y as f64);
            let touches = [x == 0, y == 0, x + 1 == width, y + 1 == height];
            let sums = Sums { area: 1, touches, x: fx, y: fy, xx: fx * fx, xy: fx * fy, yy: fy * fy };
            if root == NONE {
                self.component[index as usize] = self.components.len() as u32;
                self.components.push(Component { sums, last: NONE, top: level, level });
            } else {
                self.parent[index as usize] = root;
                let number = self.component[root as usize];
                self.close_level(number, level);
                self.components[number as usize].sums.add(&sums);
            }
        }
        for number in 0..self.components.len() as u32 {
            // Those that were joined to another have no samples left.
            if self.components[number as usize].sums.area > 0 {
                self.end_branch(number, 0);
            }
        }
        self.found.sort_by(|a, b| b.contrast.total_cmp(&a.contrast).then(a.at[0].total_cmp(&b.at[0])));
        self.found.truncate(MOST_SPOTS);
    }

    /// Samples with a level, the highest first.
    fn sort(&mut self, levels: &[u8]) {
        let mut counts = [0u32; 128];
        levels.iter().for_each(|&level| counts[level as usize] += 1);
        let mut starts = [0u32; 128];
        let mut sum = 0;
        for level in (1..128).rev() {
            starts[level] = sum;
            sum += counts[level];
        }
        self.order.resize(sum as usize, 0);
        for (index, &level) in levels.iter().enumerate() {
            if level > 0 {
                self.order[starts[level as usize] as usize] = index as u32;
                starts[level as usize] += 1;
            }
        }
    }

    fn root(&mut self, mut index: u32) -> u32 {
        while self.parent[index as usize] != index {
            let above = self.parent[self.parent[index as usize] as usize];
            self.parent[index as usize] = above;
            index = above;
        }
        index
    }

    /// Joins two components at `level`; the larger goes on, the smaller one's branch ends.
    fn join(&mut self, a: u32, b: u32, level: u8) -> u32 {
        if a == b {
            return a;
        }
        let numbers = [a, b].map(|root| self.component[root as usize]);
        let areas = numbers.map(|number| self.components[number as usize].sums.area);
        let ((kept, kept_number), (ended, ended_number)) =
            if areas[0] >= areas[1] { ((a, numbers[0]), (b, numbers[1])) } else { ((b, numbers[1]), (a, numbers[0])) };
        self.end_branch(ended_number, level);
        self.close_level(kept_number, level);
        let sums = self.components[ended_number as usize].sums;
        self.components[kept_number as usize].sums.add(&sums);
        self.components[ended_number as usize].sums.area = 0;
        self.parent[ended as usize] = kept;
        kept
    }

    /// Keeps how a component stood at its level before it grows at a lower one.
    fn close_level(&mut self, number: u32, level: u8) {
        let component = &mut self.components[number as usize];
        if component.level == level {
            return;
        }
        // Four times the largest spot: its ground must be seen.
        if component.sums.area <= 4 * self.largest {
            self.snapshots.push(Snapshot { sums: component.sums, level: component.level, before: component.last });
            component.last = self.snapshots.len() as u32 - 1;
        }
        component.level = level;
    }

    fn end_branch(&mut self, number: u32, end: u8) {
        let component = self.components[number as usize];
        if component.sums.area < LEAST_AREA || f32::from(component.top - end.min(component.top)) < self.least_contrast {
            return;
        }
        self.branch.clear();
        if component.sums.area <= 4 * self.largest && component.level > end {
            self.branch.push(Snapshot { sums: component.sums, level: component.level, before: NONE });
        }
        let mut at = component.last;
        while at != NONE {
            let snapshot = self.snapshots[at as usize];
            self.branch.push(snapshot);
            at = snapshot.before;
        }
        self.branch.reverse();
        let end = if component.sums.area > 4 * self.largest {
            self.branch.last().map_or(end, |last| last.level.saturating_sub(1))
        } else {
            end
        };
        self.best_of_branch(component.top, end);
    }

    /// Picks the most outstanding node of a branch, and others of quite another area that stand out too.
    fn best_of_branch(&mut self, top: u8, end: u8) {
        let branch = &self.branch;
        let mut chosen: [Option<Chosen>; 3] = [None; 3];
        for slot in 0..chosen.len() {
            // Score, node, what it spans.
            let mut best: Option<(f32, usize, Chosen)> = None;
            let (mut core, mut ground) = (0, 0);
            for (k, node) in branch.iter().enumerate() {
                let area = f64::from(node.sums.area);
                // Two cursors: the first node with a quarter of the area, and the first with four times the area.
                let least = core_area(area);
                while f64::from(branch[core].sums.area) < least {
                    core += 1;
                }
                let spread = ground_area(area);
                while ground < branch.len() && f64::from(branch[ground].sums.area) < spread {
                    ground += 1;
                }
                let high = if core == 0 { top } else { branch[core].level };
                let low = branch.get(ground).map_or(end, |node| node.level);
                let low = low.min(high);
                let contrast = f32::from(high - low);
                let node_spans = Chosen { area, high, low };
                let apart = chosen.iter().flatten().all(|other| other.is_another(&node_spans));
                if node.sums.area < LEAST_AREA
                    || node.sums.area > self.largest
                    || !apart
                    || contrast < self.least_contrast
                {
                    continue;
                }
                // A spot's edge lies halfway from core to ground.
                let off = (f32::from(node.level) - 0.5 * (f32::from(high) + f32::from(low))) / (0.5 * contrast);
                let score = contrast * (1.0 - off * off);
                if best.is_none_or(|(other, ..)| score > other) {
                    best = Some((score, k, node_spans));
                }
            }
            let Some((_, k, spans)) = best else { break };
            chosen[slot] = Some(spans);
            if let Some(spot) = spot(&branch[k].sums, f32::from(spans.high - spans.low)) {
                self.found.push(spot);
            }
        }
    }
}

/// The area of a spot's ground.
fn ground_area(area: f64) -> f64 {
    let radius = (area / std::f64::consts::PI).sqrt() + SPREAD_RADIUS;
    (SPREAD * area).max(std::f64::consts::PI * radius * radius)
}

/// The area of a spot's core.
fn core_area(area: f64) -> f64 {
    let radius = ((area / std::f64::consts::PI).sqrt() - SPREAD_RADIUS).max(0.0);
    (area / SPREAD).min(std::f64::consts::PI * radius * radius)
}

fn spot(sums: &Sums, contrast: f32) -> Option<Spot> {
    let area = f64::from(sums.area);
    let at = [sums.x / area, sums.y / area];
    // A sample is a square of side 1: its own second moment is 1/12.
    let moments = [
        sums.xx / area - at[0] * at[0] + 1.0 / 12.0,
        sums.xy / area - at[0] * at[1],
        sums.yy / area - at[1] * at[1] + 1.0 / 12.0,
    ];
    let (mean, spread) =
        (0.5 * (moments[0] + moments[2]), (0.25 * (moments[0] - moments[2]).powi(2) + moments[1] * moments[1]).sqrt());
    let (long, short) = (mean + spread, mean - spread);
    if short <= 0.0 || long > LONGEST * LONGEST * short {
        return None;
    }
    let fill = area / (4.0 * std::f64::consts::PI * (long * short).sqrt());
    (fill >= LEAST_FILL).then_some(Spot { at, area, moments, contrast, touches: sums.touches })
}
