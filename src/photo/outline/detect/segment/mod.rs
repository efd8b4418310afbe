//! Where a small network sees nails: any number, any direction, on any photograph.
//!
//! In: a photograph. Out: its nails' outlines as the network draws them, each with a calibrated probability. The
//! network (EfficientNet-Lite0 to stride 16 and a small decoder, by OpenCV's `dnn`) gives each 2 x 2 pixels the
//! probabilities of *nail* and of *a nail's core*, which neighbours don't share; cores are the components that grow
//! into the nail around them.
//!
//! - *First look*: the whole photograph in several sizes; of components that overlap, the best one stays.
//! - *Second look*: a window around each, in which it is 40 pixels long. Both together give the probability.
//!   Outlines that a person drew are looked at so as well, where that is requested ([`unlike`]).
//!
//! `crates/training/nail-net` makes weights and calibration, and its `find.py` is this file's twin. Not determined:
//! which end is distal.

mod component;
mod unlike;

use std::sync::LazyLock;

use image::{DynamicImage, RgbImage};

use super::candidate::shared;
use crate::photo::outline::{Outline, Refusal, Refused};
use crate::photograph::as_rgb8;
use crate::vision::{Network, VisionError, part_resized, resized};
use component::{Component, View};

pub use unlike::Unlike;

/// Long sides that a photograph is looked at in, pixels.
const SIDES: [usize; 3] = [128, 256, 512];
/// Another one, where nothing sure and long enough is seen in the largest of them.
const FAR_SIDE: usize = 1024;
/// Long side from which a photograph may show nails too small for the usual ones; ..
const FAR_FROM: usize = 600;
/// .. the length of a nail that is not, pixels of the largest look, ..
const FAR_LENGTH: f64 = 20.0;
/// .. and the log odds from which it is sure: 0.8.
const SURE: f64 = 1.386_294_361_119_890_6;
/// A larger photograph is reduced to this before it is reduced further, once for all.
const FIRST_SIDE: usize = 1024;
/// Part of the smaller of two components from which they are of one nail.
const SAME: f64 = 0.3;
/// The middle of the lengths that training shows, pixels.
const BEST_LENGTH: f64 = 28.0;
/// Side of the second look's window and the nail's length there, pixels.
const WINDOW: f64 = 160.0;
const SECOND_LENGTH: f64 = 40.0;
/// A window's side of so many pixels and more is a whole number of these: it may be halved on its way to [`WINDOW`],
/// and half of an odd side is rounded.
const EVEN_FROM: usize = 1000;
const EVEN: usize = 8;
/// Second looks at most: a group's photograph has fewer nails, a texture may have thousands of spots.
const MOST: usize = 64;
/// Components of all looks that are compared, the best ones.
const MOST_COMPARED: usize = 400;
const FEATURES: usize = 9;

/// The network that finds nails, and how probable its finds are.
pub struct NailNet {
    network: Network,
    /// Coefficients of the features, the constant first.
    calibration: [f64; FEATURES + 1],
    /// The probability from which finds were right in 95 of 100 photographs that chose nothing.
    pub(super) confident: f64,
}

/// What was found.
#[derive(Debug, Clone)]
pub struct Segment {
    /// As the network draws it, photograph pixels.
    pub outline: Outline,
    /// About the probability that a nail lies there whose IoU with the outline is at least 0.5.
    pub confidence: f64,
}

/// A component of the first look.
struct Candidate {
    side: usize,
    component: Component,
    /// Best IoU with a component of another size.
    agreement: f64,
}

impl Candidate {
    /// Which of two looks at one nail is the better one.
    fn quality(&self) -> f64 {
        let Component { nail, core, length, .. } = &self.component;
        nail + core - 2.0 * (length / BEST_LENGTH).ln().abs()
    }
}

impl NailNet {
    /// The committed one; it is read when it is first needed.
    ///
    /// # Errors
    /// [`VisionError`] where OpenCV can't read it.
    pub fn committed() -> Result<&'static Self, VisionError> {
        static NET: LazyLock<Result<NailNet, VisionError>> = LazyLock::new(|| {
            NailNet::parse(
                include_bytes!("../weights/nail-net.f16"),
                include_str!("../weights/nail-net-calibration.txt"),
            )
        });
        NET.as_ref().map_err(Clone::clone)
    }

    /// From a file of packed weights and one of lines `name value`: the constant, the features, `confident`.
    ///
    /// # Errors
    /// [`VisionError`] where either is none.
    pub fn parse(weights: &[u8], calibration: &str) -> Result<Self, VisionError> {
        let values: Option<Vec<f64>> =
            calibration.lines().map(|line| line.split_once(' ').and_then(|(_, value)| value.parse().ok())).collect();
        match values.as_deref() {
            Some([coefficients @ .., confident]) if coefficients.len() == FEATURES + 1 => {
                let calibration = std::array::from_fn(|k| coefficients[k]);
                Ok(Self { network: Network::of_packed(weights)?, calibration, confident: *confident })
            }
            _ => Err(VisionError::lacking("calibration", format!("not {} lines `name value`", FEATURES + 2))),
        }
    }

    /// The nails of an upright photograph, none over another, the most probable first; and what isn't one after all.
    pub fn segments(&self, image: &DynamicImage) -> Result<(Vec<Segment>, Vec<Refused>), VisionError> {
        let rgb = &*as_rgb8(image);
        let (mut found, mut refused) = (Vec::new(), Vec::new());
        for first in self.candidates(rgb)? {
            match self.look_again(rgb, &first)? {
                Some(segment) => found.push(segment),
                None => {
                    let why = Refusal::NotSeenAgain(probability(first.component.nail.min(first.component.core)));
                    refused.push(Refused { outline: first.component.outline, why });
                }
            }
        }
        let (found, overlapped) = one_each(found, SAME, |segment| segment.confidence, |segment| &segment.outline);
        let overlapped = overlapped.into_iter();
        refused.extend(overlapped.map(|s| Refused { outline: s.outline, why: Refusal::Overlapped(s.confidence) }));
        Ok((found, refused))
    }

    /// The first look.
    fn candidates(&self, rgb: &RgbImage) -> Result<Vec<Candidate>, VisionError> {
        let part = [rgb.width() as usize, rgb.height() as usize];
        let longest = part[0].max(part[1]);
        let reduced = sides(part, FIRST_SIDE);
        let first = if longest > FIRST_SIDE { Some(resized(rgb, part, reduced)?) } else { None };
        let (samples, samples_size) = first.as_deref().map_or((rgb.as_raw().as_slice(), part), |s| (s, reduced));
        let look = |side: usize| -> Result<Vec<Candidate>, VisionError> {
            let size = sides(part, side);
            let view = View { rgb: resized(samples, samples_size, size)?, size, corner: [0, 0], part };
            let found = view.components(&self.network.answer(&view.planes())?)?;
            Ok(found.into_iter().map(|component| Candidate { side, component, agreement: 0.0 }).collect())
        };
        let mut all = Vec::new();
        for side in SIDES {
            all.extend(look(side)?);
        }
        let near = |Candidate { side, component: c, .. }: &Candidate| {
            *side == SIDES[SIDES.len() - 1] && c.nail > SURE && c.core > SURE && c.length >= FAR_LENGTH
        };
        if longest >= FAR_FROM && !all.iter().any(near) {
            all.extend(look(FAR_SIDE)?);
        }
        all.sort_by(|a, b| b.quality().total_cmp(&a.quality()));
        all.truncate(MOST_COMPARED);
        for k in 0..all.len() {
            let others = all.iter().filter(|other| other.side != all[k].side);
            let overlap = others.map(|other| all[k].component.outline.iou(&other.component.outline));
            all[k].agreement = overlap.fold(0.0, f64::max);
        }
        let (mut best, _) = one_each(all, SAME, Candidate::quality, |candidate| &candidate.component.outline);
        best.truncate(MOST);
        Ok(best)
    }

    /// The second look; `None` where the nail isn't seen again.
    fn look_again(&self, rgb: &RgbImage, first: &Candidate) -> Result<Option<Segment>, VisionError> {
        let one = &first.component;
        let seen = self.look_at(rgb, one.centre, one.length / one.scale)?;
        let best = overlapping(&one.outline, seen).filter(|(iou, _)| *iou > 0.0);
        Ok(best
            .map(|(iou, second)| Segment { confidence: self.confidence(first, &second, iou), outline: second.outline }))
    }

    /// What is seen in a window in which what is so long, photograph pixels, has [`SECOND_LENGTH`].
    fn look_at(&self, rgb: &RgbImage, centre: [f64; 2], length_px: f64) -> Result<Vec<Component>, VisionError> {
        let scale = SECOND_LENGTH / length_px;
        let half = 0.5 * WINDOW / scale;
        let [low, high] = [-half, half].map(|reach| centre.map(|c| (c + reach).round_ties_even().max(0.0) as u32));
        let end = [rgb.width(), rgb.height()];
        let high = [0, 1].map(|k| high[k].max(low[k] + 1).min(end[k]));
        let part = [0, 1].map(|k| high[k].saturating_sub(low[k]));
        if part.contains(&0) {
            return Ok(Vec::new());
        }
        let [corner, part, whole] = [low, part, end].map(|sides| sides.map(|n| n as usize));
        let part = part.map(|n| if n >= EVEN_FROM { n / EVEN * EVEN } else { n });
        let size = part.map(|n| ((n as f64 * scale).round_ties_even() as usize).max(1));
        let view = View { rgb: part_resized(rgb, whole, [corner, part], size)?, size, corner, part };
        view.components(&self.network.answer(&view.planes())?)
    }

    fn confidence(&self, first: &Candidate, second: &Component, stayed: f64) -> f64 {
        let one = &first.component;
        let features: [f64; FEATURES] = [
            one.nail - 2.0,
            one.core - 2.0,
            first.agreement,
            (one.length / BEST_LENGTH).ln(),
            second.nail - 2.0,
            second.core - 2.0,
            stayed,
            (second.length / SECOND_LENGTH).ln(),
            second.solid.min(1.2) - 0.95,
        ];
        let [constant, weights @ ..] = &self.calibration;
        let sum: f64 = weights.iter().zip(features).map(|(weight, feature)| weight * feature).sum();
        probability(constant + sum)
    }
}

/// The component that overlaps an outline most, and its IoU.
fn overlapping(outline: &Outline, seen: Vec<Component>) -> Option<(f64, Component)> {
    seen.into_iter().map(|one| (outline.iou(&one.outline), one)).max_by(|a, b| a.0.total_cmp(&b.0))
}

fn probability(log_odds: f64) -> f64 {
    1.0 / (1.0 + (-log_odds).exp())
}

/// Of those that share more than `most_shared` of the smaller one, the best one; the best first. And the others.
pub(super) fn one_each<T>(
    mut all: Vec<T>,
    most_shared: f64,
    quality: impl Fn(&T) -> f64,
    outline: impl Fn(&T) -> &Outline,
) -> (Vec<T>, Vec<T>) {
    all.sort_by(|a, b| quality(b).total_cmp(&quality(a)));
    let (mut kept, mut others): (Vec<T>, Vec<T>) = (Vec::new(), Vec::new());
    for one in all {
        let stays = kept.iter().all(|other| shared(outline(other), outline(&one)) <= most_shared);
        if stays { &mut kept } else { &mut others }.push(one);
    }
    (kept, others)
}

/// Width and height of a picture brought to this long side.
fn sides([width, height]: [usize; 2], side: usize) -> [usize; 2] {
    let scale = side as f64 / width.max(height) as f64;
    [width, height].map(|n| ((n as f64 * scale).round_ties_even() as usize).max(1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vision::Planes;

    /// A picture's sample of channel `c` at (x, y).
    type Formula = fn(usize, f32, f32) -> f32;

    fn stripes(c: usize, x: f32, y: f32) -> f32 {
        (7.0 * x + 13.0 * y + 29.0 * c as f32) % 256.0 / 255.0
    }

    fn finger(c: usize, x: f32, y: f32) -> f32 {
        let [across, along] = [(x - 48.0) / 14.0, (y - 27.5) / 17.5];
        let away = (x - 48.0).powi(2) + (y - 28.0).min(0.0).powi(2);
        if across * across + along * along < 1.0 {
            [230.0, 170.0, 165.0][c] / 255.0 * (1.0 - ((x - 48.0) / 28.0).powi(2))
        } else if away < 400.0 {
            [204.0, 153.0, 128.0][c] / 255.0 * (1.0 - away / 800.0)
        } else {
            [51.0, 64.0, 77.0][c] / 255.0
        }
    }

    /// The network's answer to a formula is the one that another runtime gave.
    #[test]
    fn the_network_answers_as_onnxruntime_does() {
        let net = NailNet::committed().expect("the committed network");
        let golden: [(Formula, &str); 2] = [
            (stripes, include_str!("../weights/nail-net-golden.txt")),
            (finger, include_str!("../weights/nail-net-golden-finger.txt")),
        ];
        let (rows, columns) = (64, 96);
        for (formula, text) in golden {
            let at = |k: usize| {
                let (c, y, x) = (k / (rows * columns), k / columns % rows, k % columns);
                formula(c, x as f32, y as f32)
            };
            let planes = Planes { size: [3, rows, columns], values: (0..3 * rows * columns).map(at).collect() };
            let answer = net.network.answer(&planes).expect("an answer");
            assert_eq!(answer.size, [2, rows / 2, columns / 2]);
            let mut compared = 0;
            for line in text.lines().filter(|line| !line.starts_with('#')) {
                let numbers: Vec<f64> = line.split(' ').map(|n| n.parse().expect("a number")).collect();
                let [channel, y, x, expected] = numbers[..] else { panic!("{line}") };
                let plane = &answer.values[channel as usize * rows * columns / 4..][..rows * columns / 4];
                let own = if y < 0.0 {
                    plane.iter().map(|&p| f64::from(p)).sum::<f64>() / plane.len() as f64
                } else {
                    f64::from(plane[y as usize * columns / 2 + x as usize])
                };
                assert!((own - expected).abs() <= 1e-5, "{line}: {own}");
                compared += 1;
            }
            assert!(compared >= 20, "{compared} places");
        }
    }

    #[test]
    fn a_calibration_of_other_features_is_refused() {
        let weights = include_bytes!("../weights/nail-net.f16");
        assert!(NailNet::parse(weights, "constant 1\nnail 2\n").is_err());
        assert!(NailNet::parse(&weights[..1000], include_str!("../weights/nail-net-calibration.txt")).is_err());
    }
}
