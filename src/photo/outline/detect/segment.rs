//! Where a small network sees nails: any number, any direction, on any photograph.
//!
//! In: a photograph. Out: its nails' outlines as the network draws them, each with a calibrated probability. The whole
//! photograph is looked at in several sizes; the network (EfficientNet-Lite0 to stride 16 and a small decoder, by
//! OpenCV's `dnn`) gives each 2 x 2 pixels of such a size the probabilities of *nail* and of *a nail's core*, which
//! neighbours don't share. Cores are the components that grow into the nail around them; of those of several sizes that
//! overlap, the most probable stays. `crates/training/nail-net` makes the weights and the calibration, and
//! `find.py` there is this file's twin.
//!
//! Not determined: which end is distal.

use std::sync::LazyLock;

use image::{DynamicImage, RgbImage};

use super::candidate::shared;
use crate::photo::outline::Outline;
use crate::photo::outline::mask::{Region, largest_outline};
use crate::vision::{Network, Planes, VisionError, components, resized};

/// Long sides that a photograph is looked at in, pixels.
const SIDES: [usize; 3] = [128, 256, 512];
/// A larger photograph is reduced to this before it is reduced further, once for all.
const FIRST_SIDE: usize = 1024;
/// The network's planes are whole numbers of these, pixels; beyond the photograph they are black.
const WHOLE: usize = 32;
/// Pixels a cell of the answer.
const CELL: usize = 2;
/// Probability from which a cell is nail, or core.
const THRESHOLD: f32 = 0.5;
/// Cells that a component has at least.
const LEAST_CELLS: usize = 4;
/// Part of the smaller of two finds from which they are of one nail.
const SAME: f64 = 0.3;

/// The network that finds nails, and how probable its finds are.
pub struct NailNet {
    network: Network,
    /// Coefficients of the features, the constant first.
    calibration: [f64; FEATURES + 1],
}

const FEATURES: usize = 7;

/// What was found.
#[derive(Debug, Clone)]
pub struct Segment {
    /// As the network draws it, photograph pixels.
    pub outline: Outline,
    /// About the probability that a nail lies there whose IoU with the outline is at least 0.5.
    pub confidence: f64,
}

/// A component at one size.
struct Component {
    side: usize,
    outline: Outline,
    /// All of them but for the agreement with other sizes.
    features: [f64; FEATURES],
}

/// The place of the agreement among the features.
const AGREEMENT: usize = 4;

impl NailNet {
    /// The committed one; it is read when it is first needed.
    ///
    /// # Errors
    /// [`VisionError`] where OpenCV can't read it.
    pub fn committed() -> Result<&'static Self, VisionError> {
        static NET: LazyLock<Result<NailNet, VisionError>> = LazyLock::new(|| {
            NailNet::parse(include_bytes!("weights/nail-net.f16"), include_str!("weights/nail-net-calibration.txt"))
        });
        NET.as_ref().map_err(Clone::clone)
    }

    /// From a file of packed weights and one of `name value` lines.
    ///
    /// # Errors
    /// [`VisionError`] where either is none.
    pub fn parse(weights: &[u8], calibration: &str) -> Result<Self, VisionError> {
        let mut values = calibration.lines().filter_map(|line| line.split_once(' ')?.1.parse().ok());
        let mut next = || values.next().ok_or_else(|| VisionError::lacking("calibration", "fewer than 8 numbers"));
        let mut calibration = [0.0; FEATURES + 1];
        for value in &mut calibration {
            *value = next()?;
        }
        Ok(Self { network: Network::of_packed(weights)?, calibration })
    }

    /// The nails of an upright photograph, none over another, the most probable first.
    ///
    /// # Errors
    /// [`VisionError`].
    pub fn segments(&self, image: &DynamicImage) -> Result<Vec<Segment>, VisionError> {
        let converted: RgbImage;
        let rgb = match image {
            DynamicImage::ImageRgb8(rgb) => rgb,
            other => {
                converted = other.to_rgb8();
                &converted
            }
        };
        let size = [rgb.width() as usize, rgb.height() as usize];
        let (first, first_size);
        let (samples, samples_size) = if size[0].max(size[1]) > FIRST_SIDE {
            first_size = sides(size, FIRST_SIDE);
            first = resized(rgb, size, first_size)?;
            (&first[..], first_size)
        } else {
            (&rgb.as_raw()[..], size)
        };
        let mut all = Vec::new();
        for side in SIDES {
            let small_size = sides(size, side);
            let small = resized(samples, samples_size, small_size)?;
            let answer = self.network.answer(&padded(&small, small_size))?;
            all.extend(found(&answer, side, small_size, size)?);
        }
        Ok(self.merged(all))
    }

    /// Of components that overlap, the most probable.
    fn merged(&self, mut all: Vec<Component>) -> Vec<Segment> {
        for k in 0..all.len() {
            let others = all.iter().filter(|other| other.side != all[k].side);
            let agreement = others.map(|other| all[k].outline.iou(&other.outline)).fold(0.0, f64::max);
            all[k].features[AGREEMENT] = agreement;
        }
        let sure = |one: Component| Segment { confidence: self.confidence(&one.features), outline: one.outline };
        let mut segments: Vec<Segment> = all.into_iter().map(sure).collect();
        segments.sort_by(|a, b| b.confidence.total_cmp(&a.confidence));
        let mut kept: Vec<Segment> = Vec::new();
        for segment in segments {
            if kept.iter().all(|other| shared(&other.outline, &segment.outline) <= SAME) {
                kept.push(segment);
            }
        }
        kept
    }

    fn confidence(&self, features: &[f64; FEATURES]) -> f64 {
        let [constant, weights @ ..] = &self.calibration;
        let sum: f64 = weights.iter().zip(features).map(|(weight, feature)| weight * feature).sum();
        1.0 / (1.0 + (-(constant + sum)).exp())
    }
}

/// Width and height of a picture brought to this long side.
fn sides([width, height]: [usize; 2], side: usize) -> [usize; 2] {
    let scale = side as f64 / width.max(height) as f64;
    [width, height].map(|n| ((n as f64 * scale).round_ties_even() as usize).max(1))
}

/// The network's input: red, green, blue from 0 to 1, black right of and below the picture.
fn padded(rgb: &[u8], [width, height]: [usize; 2]) -> Planes {
    let [rows, columns] = [height, width].map(|n| n.next_multiple_of(WHOLE));
    let mut values = vec![0.0; 3 * rows * columns];
    for (c, plane) in values.chunks_exact_mut(rows * columns).enumerate() {
        for (to, from) in plane.chunks_exact_mut(columns).zip(rgb.chunks_exact(3 * width)) {
            for (to, pixel) in to.iter_mut().zip(from.as_chunks::<3>().0) {
                *to = f32::from(pixel[c]) / 255.0;
            }
        }
    }
    Planes { size: [3, rows, columns], values }
}

/// The components of one size, on the photograph of `size`.
fn found(answer: &Planes, side: usize, small: [usize; 2], size: [usize; 2]) -> Result<Vec<Component>, VisionError> {
    let [channels, rows, columns] = answer.size;
    if channels != 2 {
        return Err(VisionError::lacking("Net::forward", format!("{channels} planes where there should be 2")));
    }
    let (nail, core) = answer.values.split_at(rows * columns);
    let seeds = nail.iter().zip(core).map(|(n, c)| u8::from(*n > THRESHOLD && *c > THRESHOLD)).collect::<Vec<u8>>();
    let cores = components(&seeds, [columns, rows])?;
    let labels = grown(cores.clone(), nail, columns);
    let count = cores.iter().copied().max().unwrap_or(0);
    let mut members = vec![Vec::new(); count as usize];
    for (at, &label) in labels.iter().enumerate().filter(|(_, label)| **label > 0) {
        members[label as usize - 1].push(at);
    }
    let component = |(label, cells): (u32, Vec<usize>)| {
        if cells.len() < LEAST_CELLS {
            return None;
        }
        let ends = |of: fn(usize, usize) -> usize| {
            let all = cells.iter().map(|&at| of(at, columns) as u32);
            all.fold([u32::MAX, 0], |[low, high], v| [low.min(v), high.max(v)])
        };
        let region = Region {
            x: ends(|at, columns| at % columns),
            y: ends(|at, columns| at / columns),
            size: [columns as u32, rows as u32],
        };
        let value = |x: u32, y: u32| {
            let at = y as usize * columns + x as usize;
            if labels[at] == label || (labels[at] == 0 && nail[at] <= THRESHOLD) { f64::from(nail[at]) } else { 0.0 }
        };
        let place = |k: usize, cell: f64| ((cell + 0.5) * CELL as f64) * size[k] as f64 / small[k] as f64 - 0.5;
        let outline = largest_outline(region.rings(value), |[x, y]| [place(0, x), place(1, y)])?;
        let core = cells.iter().filter(|at| cores[**at] == label).map(|at| core[*at]);
        let features = features(&cells, columns, nail, &core.collect::<Vec<f32>>());
        Some(Component { side, outline, features })
    };
    Ok((1..).zip(members).filter_map(component).collect())
}

/// Components grown into cells of nail, a ring of neighbours at a time; where two meet, the first one takes the cell.
fn grown(mut labels: Vec<u32>, nail: &[f32], columns: usize) -> Vec<u32> {
    let beside = |at: usize| {
        let x = at % columns;
        let ways = [
            (x > 0).then(|| at - 1),
            (x + 1 < columns).then_some(at + 1),
            at.checked_sub(columns),
            (at + columns < nail.len()).then_some(at + columns),
        ];
        ways.into_iter().flatten()
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

/// What the confidence is made of, each about -2 to 2: log odds of nail and core, size and its square, agreement with
/// other sizes (later), how solid, how long for its width.
fn features(cells: &[usize], columns: usize, nail: &[f32], core: &[f32]) -> [f64; FEATURES] {
    let count = cells.len() as f64;
    let mean = |value: &dyn Fn(usize) -> f64| cells.iter().map(|&at| value(at)).sum::<f64>() / count;
    let (x, y) = (|at: usize| (at % columns) as f64, |at: usize| (at / columns) as f64);
    let [mx, my] = [mean(&x), mean(&y)];
    let part = count / (count - 1.0);
    let xx = part * mean(&|at| (x(at) - mx).powi(2)) + 1.0 / 12.0;
    let yy = part * mean(&|at| (y(at) - my).powi(2)) + 1.0 / 12.0;
    let xy = part * mean(&|at| (x(at) - mx) * (y(at) - my));
    let (middle, half) = (0.5 * (xx + yy), (0.5 * (xx - yy)).hypot(xy));
    let [small, large] = [middle - half, middle + half].map(|variance| variance.max(1.0 / 12.0).sqrt());
    // Four standard deviations are an ellipse's axis.
    let [width, length] = [small, large].map(|sd| 4.0 * CELL as f64 * sd);
    let size = (length.max(1.0) / 28.0).ln();
    let solid = count / (4.0 * std::f64::consts::PI * small * large);
    let core = core.iter().map(|&p| f64::from(p)).sum::<f64>() / core.len().max(1) as f64;
    [
        log_odds(mean(&|at| f64::from(nail[at]))) - 2.0,
        log_odds(core) - 2.0,
        size,
        size * size,
        0.0,
        solid.min(1.2) - 0.95,
        (length / width).ln() - 0.35,
    ]
}

/// Bounded, that no feature decides alone.
fn log_odds(probability: f64) -> f64 {
    let p = probability.clamp(0.01, 0.99);
    (p / (1.0 - p)).ln()
}
