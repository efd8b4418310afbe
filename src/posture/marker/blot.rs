//! The centre of a mark of any outline, such as a blot of paint: the centroid of its outline.
//!
//! In: a frame, where its chroma lies, and a place in the mark; out: an [`Outline`], or why there is none. A sample's
//! share of the mark is its place on the line from the surround's colour to the mark's, along the direction that parts
//! the two best (Fisher 1936, DOI 10.1111/j.1469-1809.1936.tb02137.x): what varies within either, as luma does where
//! paint shines, counts less. The surround has a gradient; both levels are those of the frame at hand, so that light
//! may change. Inside of the outline all counts alike, whatever shines there, and on its edge as much as its share.
//!
//! The standard error has two parts: that of noise on the edge, and that of the outline itself, which stays for many
//! frames: what is within it is a matter of opinion, the more so where paint covers a part of the mark thinly.

use nalgebra::{Matrix3, Vector3};

use super::sight::Loss;
use crate::median::median;
use crate::posture::marker::looks::siting::Siting;
use crate::video::Frame;
use crate::vision::{Neighbours, Part, Parts, parts, steps_out};

/// Share from which a sample is within the outline.
const EDGE: f32 = 0.5;
/// Levels at which the outline is drawn as well, to see how much the centre depends on it.
const LOW_EDGE: f32 = 0.35;
const HIGH_EDGE: f32 = 0.65;
/// Samples nearer to the edge than this are neither clearly within nor clearly without: blur and chroma's pitch.
const EDGE_PX: usize = 2;
/// How far around the outline the surround is looked at.
const SURROUND_PX: usize = 7;
/// The variance of the centre, as a share of the square of its shift between these two levels, and how much skin bends
/// along a mark, radians a radius: calibrated together on eight videos of paint by [`crate::phantom`] (1280x720, H.264,
/// four marks in a row on index finger or thumb, 6 s), where about 72 % of the errors of places and angles are within
/// one standard error.
const LEVELS_SHARE: f64 = 0.23;
const BEND: f64 = 0.018;
/// Share from which a sample about the outline is thin paint of the same mark.
const THIN: f32 = 0.2;
/// The centre is up to so far from that of all paint where there is no thin one (measured: whole marks of phantoms at
/// most 0.25); what is beyond is the standard error of both coordinates. Of two films of marks painted unevenly onto
/// photographs of real hands, radii of 5 to 9 pixels, 187 of 530 angles were more than a degree and three standard
/// errors off without it, none with it.
const THIN_PX: f64 = 0.2;
/// Areas differ by this (logarithm) from codec and stretch; beyond, a part may be hidden, and the centre off by up to
/// so many radii times the rest (a segment cut off a disc: 0.8 to 1 times its share of the area).
const AREA_FREE: f64 = 0.08;
const CUT_RADII: f64 = 1.0;
/// Smaller things are no marks, samples.
const LEAST_AREA_PX: usize = 9;
/// Rounds of levels and outline.
const ROUNDS: usize = 3;
/// A plane's standard deviation within mark or surround is taken as at least this, on the scale of 8 bits.
const LEAST_SD: f64 = 2.0;
/// Mark and surround are this many of their standard deviations apart at least (assumed).
const LEAST_APART: f64 = 2.5;
/// ... and so many levels, in all planes together.
const LEAST_CONTRAST: f64 = 8.0;
/// Area of an outline over what is expected: as it was lately, and as found by the search.
const AREA_RANGE: (f64, f64) = (0.75, 1.35);
const FOUND_AREA_RANGE: (f64, f64) = (0.35, 5.0);
/// Radii of marks, as shares of the picture's width.
const SIZES: [f64; 4] = [0.005, 0.008, 0.013, 0.02];
/// A mark is no longer than this many of its widths.
const LONGEST: f64 = 5.0;
/// The contrast over the learnt one.
const LEVEL_RANGE: (f64, f64) = (0.5, 2.0);
/// How much a frame counts against what was learned before.
const SHARE: f64 = 0.1;

/// What was learnt of a mark.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Blot {
    /// The share of a sample is this times its difference from the surround.
    toward: [f64; 3],
    /// As it was lately, and as first learnt.
    area_px2: f64,
    learnt_px2: f64,
    /// Half axes of the ellipse of its second moments, squared, over four: the larger, the smaller.
    spread_px2: [f64; 2],
}

/// A mark as a frame shows it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Outline {
    /// Its centroid.
    pub(crate) at_px: [f64; 2],
    /// Covariance of the errors that independent noise makes.
    pub(crate) white_px2: [f64; 3],
    /// Covariance of the errors that stay: what is within the outline is a matter of opinion.
    pub(crate) lasting_px2: [f64; 3],
    pub(crate) area_px2: f64,
    /// Central second moments: xx, xy, yy.
    pub(crate) moments_px2: [f64; 3],
    /// Y', Cb, Cr within and around.
    pub(crate) marker: [f64; 3],
    pub(crate) background: [f64; 3],
    /// Standard deviation of the samples around in each plane.
    pub(crate) noise: [f64; 3],
}

impl Outline {
    pub(crate) fn radius_px(&self) -> f64 {
        (self.area_px2 / std::f64::consts::PI).sqrt()
    }

    /// Levels between its colour and its surround's.
    fn contrast(&self) -> f64 {
        (0..3).map(|p| (self.marker[p] - self.background[p]).powi(2)).sum::<f64>().sqrt()
    }

    fn spread_px2(&self) -> [f64; 2] {
        let [xx, xy, yy] = self.moments_px2;
        let (mean, half) = (0.5 * (xx + yy), (0.25 * (xx - yy) * (xx - yy) + xy * xy).sqrt());
        [mean + half, (mean - half).max(1e-3)]
    }
}

impl Blot {
    /// Learns the mark of about `radius_px` (of a disc of its area) at about `at_px`; none where nothing compact stands
    /// out.
    pub(crate) fn learn(frame: &Frame<'_>, siting: Siting, at_px: [f64; 2], radius_px: f64) -> Option<(Self, Outline)> {
        let window = Window::new(frame, siting, at_px, 2.6 * radius_px + 10.0)?;
        // What is in the middle against what is around, at first.
        let class = |from: f64, to: f64| {
            window.gather(|k| {
                let [x, y] = window.place(k);
                let distance = (x - at_px[0]).hypot(y - at_px[1]);
                distance >= from && distance <= to
            })
        };
        let (mut inside, mut around) =
            (class(0.0, 0.5 * radius_px + 0.7), class(1.5 * radius_px + 2.0, 2.2 * radius_px + 6.0));
        let mut known = Self { toward: [0.0; 3], area_px2: 0.0, learnt_px2: 0.0, spread_px2: [0.0; 2] };
        let mut found = None;
        for _ in 0..ROUNDS {
            known.toward = toward(&inside?, &around?)?;
            let drawn = window.draw(&known.toward, at_px, radius_px)?;
            inside = window.gather(|k| drawn.depth[k] > EDGE_PX as i8).or(inside);
            around = window.gather(|k| drawn.is_around(k)).or(around);
            found = Some(drawn);
        }
        let outline = window.outline(&found?, &inside?, &around?, &known.toward);
        let expected = std::f64::consts::PI * radius_px * radius_px;
        let [long, short] = outline.spread_px2();
        let fits = in_range(outline.area_px2 / expected, FOUND_AREA_RANGE) && long <= LONGEST * LONGEST * short;
        (known.area_px2, known.spread_px2) = (outline.area_px2, [long, short]);
        known.learnt_px2 = outline.area_px2;
        fits.then_some((known, outline))
    }

    /// What is seen of the mark at `at_px`, of any size that markers have, the one furthest from its surround's colour;
    /// none where nothing stands out.
    pub(crate) fn at(frame: &Frame<'_>, siting: Siting, at_px: [f64; 2]) -> Option<Outline> {
        let of_radius = |share: f64| Self::learn(frame, siting, at_px, share * frame.luma.width as f64);
        let found = SIZES.into_iter().filter_map(of_radius).map(|(_, outline)| outline);
        found
            .filter(|outline| {
                let off = (outline.at_px[0] - at_px[0]).hypot(outline.at_px[1] - at_px[1]);
                off < 1.2 * outline.radius_px() + 2.0
            })
            .max_by(|a, b| a.contrast().total_cmp(&b.contrast()))
    }

    /// The outline of the mark about `near_px`.
    pub(crate) fn outline(&self, frame: &Frame<'_>, siting: Siting, near_px: [f64; 2]) -> Result<Outline, Loss> {
        let radius_px = (self.area_px2 / std::f64::consts::PI).sqrt();
        let reach_px = 2.0 * self.spread_px2[0].sqrt() + SURROUND_PX as f64 + 5.0;
        let mut at_px = near_px;
        let mut last = Err(Loss::NotFound);
        for _ in 0..ROUNDS {
            let window = Window::new(frame, siting, at_px, reach_px).ok_or(Loss::NotFound)?;
            let Some(drawn) = window.draw(&self.toward, at_px, radius_px) else { return last };
            let classes = (window.gather(|k| drawn.depth[k] > 0), window.gather(|k| drawn.is_around(k)));
            let (Some(inside), Some(around)) = classes else { return last };
            if drawn.at_the_border {
                return Err(Loss::AtTheBorder);
            }
            let outline = window.outline(&drawn, &inside, &around, &self.toward);
            let moved = (outline.at_px[0] - at_px[0]).hypot(outline.at_px[1] - at_px[1]);
            at_px = outline.at_px;
            last = if drawn.is_cut { Err(Loss::Hidden) } else { Ok(outline) };
            if moved < 0.25 * radius_px && !drawn.is_cut {
                break;
            }
        }
        let mut outline = last?;
        let level: f64 = (0..3).map(|p| self.toward[p] * (outline.marker[p] - outline.background[p])).sum();
        let whole = in_range(outline.area_px2 / self.area_px2, AREA_RANGE)
            && in_range(level, LEVEL_RANGE)
            && outline.spread_px2()[0] <= 1.6 * self.spread_px2[0];
        let cut = cut_px((outline.area_px2 / self.area_px2).ln().abs() - AREA_FREE, radius_px);
        outline.lasting_px2[0] += cut * cut;
        outline.lasting_px2[2] += cut * cut;
        if whole { Ok(outline) } else { Err(Loss::Hidden) }
    }

    /// The longer over the shorter half axis of the ellipse with its second moments.
    pub(crate) fn elongation(&self) -> f64 {
        (self.spread_px2[0] / self.spread_px2[1]).sqrt()
    }

    /// How much larger an outline is than the first one, as the logarithm of its area.
    pub(crate) fn growth(&self, outline: &Outline) -> f64 {
        (outline.area_px2 / self.learnt_px2).ln()
    }

    /// Keeps the size that was first learnt of the same mark.
    pub(crate) fn keep_size(&mut self, before: &Self) {
        self.learnt_px2 = before.learnt_px2;
    }

    /// Takes over what the mark looked like in another frame.
    pub(crate) fn update(&mut self, outline: &Outline) {
        let toward = |old: &mut f64, new: f64| *old += SHARE * (new - *old);
        toward(&mut self.area_px2, outline.area_px2);
        let spread = outline.spread_px2();
        (0..2).for_each(|k| toward(&mut self.spread_px2[k], spread[k]));
    }
}

/// How far the centre may be off where the area of a mark of such a radius differs by so much (logarithm) more than
/// that of a whole one does.
pub(crate) fn cut_px(change: f64, radius_px: f64) -> f64 {
    change.max(0.0) * CUT_RADII * radius_px
}

fn in_range(value: f64, (least, most): (f64, f64)) -> bool {
    value >= least && value <= most
}

/// Samples of one kind: their mean and covariance.
#[derive(Debug, Clone, Copy)]
struct Class {
    mean: Vector3<f64>,
    covariance: Matrix3<f64>,
}

/// The direction in which two kinds of samples are furthest apart, by what they vary; none where they are not apart.
fn toward(inside: &Class, around: &Class) -> Option<[f64; 3]> {
    let apart = inside.mean - around.mean;
    let spread = 0.5 * (inside.covariance + around.covariance) + Matrix3::identity() * LEAST_SD * LEAST_SD;
    let direction = spread.cholesky()?.solve(&apart);
    let distance2 = direction.dot(&apart);
    let sure = distance2 >= LEAST_APART * LEAST_APART && apart.norm() >= LEAST_CONTRAST;
    sure.then(|| (direction / distance2).into())
}

/// A part of a frame, all its planes at luma's places.
struct Window {
    left: usize,
    top: usize,
    width: usize,
    height: usize,
    samples: Vec<[f32; 3]>,
    /// Which sides are the picture's: left, top, right, bottom.
    borders: [bool; 4],
    /// Luma samples for one of chroma.
    chroma_area: f64,
}

/// An outline on a window.
struct Drawn {
    /// Steps inward from the edge: 1 for the outermost samples within, 0 and less without.
    depth: Vec<i8>,
    /// Share of the mark, 0 around it and 1 in its middle.
    share: Vec<f32>,
    /// It reaches the window's border, or the picture's.
    is_cut: bool,
    at_the_border: bool,
}

impl Drawn {
    fn is_around(&self, k: usize) -> bool {
        (-((SURROUND_PX + EDGE_PX) as i8)..-(EDGE_PX as i8)).contains(&self.depth[k])
    }

    /// The weight of a sample when the edge is drawn at `edge`.
    fn weight(&self, k: usize, edge: f32) -> f64 {
        let depth = self.depth[k];
        if depth > EDGE_PX as i8 {
            1.0
        } else if depth < -(EDGE_PX as i8) {
            0.0
        } else {
            f64::from((2.0 * (self.share[k] - edge) + 0.5).clamp(0.0, 1.0))
        }
    }
}

impl Window {
    fn new(frame: &Frame<'_>, siting: Siting, [x, y]: [f64; 2], reach_px: f64) -> Option<Self> {
        let range = |at: f64, size: usize| {
            let (from, to) = (at - reach_px, at + reach_px + 1.0);
            (from < size as f64 && to > 0.0).then(|| (from.max(0.0) as usize, (to as usize).min(size)))
        };
        let ((left, right), (top, bottom)) = (range(x, frame.luma.width)?, range(y, frame.luma.height)?);
        let (across, down) = frame.subsampling();
        let (width, height) = (right - left, bottom - top);
        let mut samples = Vec::with_capacity(width * height);
        let between = |at: usize, offset: f64, pitch: usize, size: usize| {
            let place = ((at as f64 - offset) / pitch as f64).clamp(0.0, (size - 1) as f64);
            let first = (place as usize).min(size.saturating_sub(2));
            (first, (first + 1).min(size - 1), (place - first as f64) as f32)
        };
        for y in top..bottom {
            for x in left..right {
                let chroma = frame.chroma.map_or([0.0; 2], |planes| {
                    planes.map(|plane| {
                        let (x0, x1, u) = between(x, siting.dx_px, across, plane.width);
                        let (y0, y1, v) = between(y, siting.dy_px, down, plane.height);
                        let row = |y: usize| (1.0 - u) * plane.sample(x0, y) + u * plane.sample(x1, y);
                        (1.0 - v) * row(y0) + v * row(y1)
                    })
                });
                samples.push([frame.luma.sample(x, y), chroma[0], chroma[1]]);
            }
        }
        let borders = [left == 0, top == 0, right == frame.luma.width, bottom == frame.luma.height];
        let chroma_area = (across * down) as f64;
        (width > 4 && height > 4).then_some(Self { left, top, width, height, samples, borders, chroma_area })
    }

    fn place(&self, k: usize) -> [f64; 2] {
        [(self.left + k % self.width) as f64, (self.top + k / self.width) as f64]
    }

    /// The samples that `belong`; none if there are too few.
    fn gather(&self, belong: impl Fn(usize) -> bool) -> Option<Class> {
        let (mut count, mut sum, mut products) = (0.0, Vector3::zeros(), Matrix3::zeros());
        for (_, sample) in self.samples.iter().enumerate().filter(|(k, _)| belong(*k)) {
            let sample = Vector3::from(sample.map(f64::from));
            count += 1.0;
            sum += sample;
            products += sample * sample.transpose();
        }
        let mean = sum / count;
        (count >= 9.0).then(|| Class { mean, covariance: products / count - mean * mean.transpose() })
    }

    /// The outline of the compact thing nearest to `near_px`, of about this radius.
    fn draw(&self, toward: &[f64; 3], near_px: [f64; 2], radius_px: f64) -> Option<Drawn> {
        let toward = toward.map(|part| part as f32);
        let along: Vec<f32> = self.samples.iter().map(|s| (0..3).map(|p| toward[p] * s[p]).sum()).collect();
        // The surround's level at first: the median far from the middle.
        let mut far: Vec<f32> = (0..along.len())
            .filter(|&k| {
                let [x, y] = self.place(k);
                (x - near_px[0]).hypot(y - near_px[1]) > 1.5 * radius_px + 2.0
            })
            .map(|k| along[k])
            .collect();
        let (mut ground, mut level) = ([median(&mut far)?, 0.0, 0.0], 1.0);
        let mut drawn: Option<Drawn> = None;
        for _ in 0..ROUNDS {
            let share: Vec<f32> = (0..along.len()).map(|k| self.above(&ground, &along, k) / level).collect();
            let inside = self.component(&share, near_px, radius_px)?;
            let depth = self.depth(&inside);
            let at = |side: usize, k: usize| match side {
                0 => k.is_multiple_of(self.width),
                1 => k < self.width,
                2 => (k + 1).is_multiple_of(self.width),
                _ => k >= self.width * (self.height - 1),
            };
            let cut = |picture: bool| {
                (0..4).any(|side| {
                    self.borders[side] == picture && inside.iter().enumerate().any(|(k, &is)| is > 0 && at(side, k))
                })
            };
            let one = Drawn { is_cut: cut(false), at_the_border: cut(true), depth, share };
            if let Some(plane) = self.ground(&along, &one) {
                ground = plane;
            }
            let rest = |k: usize| self.above(&ground, &along, k);
            let deepest = one.depth.iter().copied().max()?.min(EDGE_PX as i8 + 1);
            let mut core: Vec<f32> = (0..along.len()).filter(|&k| one.depth[k] >= deepest).map(rest).collect();
            level = median(&mut core).filter(|&level| level > 0.1)?;
            drawn = Some(one);
        }
        drawn
    }

    /// How far sample `k` is above the ground of this level and these slopes along x and y.
    fn above(&self, ground: &[f32; 3], along: &[f32], k: usize) -> f32 {
        along[k] - ground[0] - ground[1] * (k % self.width) as f32 - ground[2] * (k / self.width) as f32
    }

    /// The surround's level and slopes along x and y, outliers (other skin, what lies behind) left out.
    fn ground(&self, along: &[f32], drawn: &Drawn) -> Option<[f32; 3]> {
        let around: Vec<usize> = (0..along.len()).filter(|&k| drawn.is_around(k)).collect();
        let mut values: Vec<f32> = around.iter().map(|&k| along[k]).collect();
        let mut plane = [median(&mut values)?, 0.0, 0.0];
        let scale = 1.0 / self.width.max(self.height) as f64;
        for _ in 0..ROUNDS {
            let off = |k: usize| self.above(&plane, along, k);
            let mut offs: Vec<f32> = around.iter().map(|&k| off(k).abs()).collect();
            let wide = (3.0 * median(&mut offs)?).max(0.05);
            // A weak prior holds the slopes: a surround seen on one side only has none to speak of.
            let mut normal = Matrix3::from_diagonal(&Vector3::new(0.0, 0.5, 0.5));
            let mut pull = Vector3::zeros();
            for &k in around.iter().filter(|&&k| off(k).abs() <= wide) {
                let (x, y) = ((k % self.width) as f64 * scale, (k / self.width) as f64 * scale);
                let row = Vector3::new(1.0, x, y);
                normal += row * row.transpose();
                pull += row * f64::from(along[k]);
            }
            let solved = normal.cholesky()?.solve(&pull);
            plane = [solved[0] as f32, (solved[1] * scale) as f32, (solved[2] * scale) as f32];
        }
        Some(plane)
    }

    /// The connected samples of a share above the edge's that are nearest for their size, holes filled; 1 for each.
    fn component(&self, share: &[f32], near_px: [f64; 2], radius_px: f64) -> Option<Vec<u8>> {
        let size = [self.width, self.height];
        let set: Vec<u8> = share.iter().map(|&share| u8::from(share >= EDGE)).collect();
        let Parts { all, labels } = parts(&set, size, Neighbours::Four);
        let mut best: Option<(f64, i32)> = None;
        for (part, label) in all.iter().zip(1..).filter(|(part, _)| part.area >= LEAST_AREA_PX) {
            let [x, y] = part.centroid;
            let off = [self.left as f64 + x - near_px[0], self.top as f64 + y - near_px[1]];
            let off = off[0].hypot(off[1]) / radius_px;
            let score = (part.area as f64).min(std::f64::consts::PI * radius_px * radius_px) / (1.0 + off * off);
            if best.is_none_or(|(most, _)| score > most) {
                best = Some((score, label));
            }
        }
        let chosen = best?.1;
        // Holes: what else does not reach the border.
        let rest: Vec<u8> = labels.iter().map(|&label| u8::from(label != chosen)).collect();
        let Parts { all, labels } = parts(&rest, size, Neighbours::Four);
        let is_hole =
            |part: &Part| part.left > 0 && part.top > 0 && part.right + 1 < self.width && part.bottom + 1 < self.height;
        // What is chosen has no label there.
        let is_inside: Vec<bool> = std::iter::once(true).chain(all.iter().map(is_hole)).collect();
        Some(labels.iter().map(|&label| u8::from(is_inside[label as usize])).collect())
    }

    /// Steps from the edge of what is `inside`: 1, 2, .. within, 0, -1, .. without.
    fn depth(&self, inside: &[u8]) -> Vec<i8> {
        let size = [self.width, self.height];
        let outside: Vec<u8> = inside.iter().map(|is| 1 - is).collect();
        let at_most = |step: u8| step.min(i8::MAX as u8) as i8;
        let steps = steps_out(inside, size).into_iter().zip(steps_out(&outside, size));
        steps.map(|(within, without)| if within > 0 { at_most(within) } else { 1 - at_most(without) }).collect()
    }

    /// Area and centroid of what is drawn with the edge at `edge`.
    fn centroid(&self, drawn: &Drawn, edge: f32) -> (f64, [f64; 2]) {
        let (mut area, mut sum) = (0.0, [0.0; 2]);
        for k in 0..self.samples.len() {
            let weight = drawn.weight(k, edge);
            let [x, y] = self.place(k);
            area += weight;
            (sum[0], sum[1]) = (sum[0] + weight * x, sum[1] + weight * y);
        }
        (area, [sum[0] / area, sum[1] / area])
    }

    fn outline(&self, drawn: &Drawn, inside: &Class, around: &Class, toward: &[f64; 3]) -> Outline {
        let (area_px2, at_px) = self.centroid(drawn, EDGE);
        let level: f64 = (0..3).map(|p| toward[p] * (inside.mean[p] - around.mean[p])).sum();
        let noise: [f64; 3] = std::array::from_fn(|p| around.covariance[(p, p)].max(0.0).sqrt());
        // Chroma's samples are interpolated: what is wrong of one is so of all luma's places about it.
        let wrong: f64 =
            (0..3).map(|p| (toward[p] * noise[p] / level).powi(2) * if p == 0 { 1.0 } else { self.chroma_area }).sum();
        let (mut moments, mut white) = ([0.0; 3], [0.0; 3]);
        for k in 0..self.samples.len() {
            let weight = drawn.weight(k, EDGE);
            let [x, y] = self.place(k);
            let (dx, dy) = (x - at_px[0], y - at_px[1]);
            for (part, product) in [dx * dx, dx * dy, dy * dy].into_iter().enumerate() {
                moments[part] += weight * product / area_px2;
                if weight > 0.0 && weight < 1.0 {
                    white[part] += 4.0 * wrong * product / (area_px2 * area_px2);
                }
            }
        }
        let [low, high] = [LOW_EDGE, HIGH_EDGE].map(|edge| self.centroid(drawn, edge).1);
        let shift = [low[0] - high[0], low[1] - high[1]];
        let mut outline = Outline {
            at_px,
            white_px2: white,
            lasting_px2: [0.0; 3],
            area_px2,
            moments_px2: moments,
            marker: inside.mean.into(),
            background: around.mean.into(),
            noise,
        };
        // Skin that bends along the mark moves its centroid by its curvature times its second moment.
        let bent = (BEND * outline.spread_px2()[0]).powi(2) / (area_px2 / std::f64::consts::PI);
        let with_thin = self.with_thin(drawn);
        let thin = (0..2).map(|axis| (with_thin[axis] - at_px[axis]).powi(2)).sum::<f64>() - THIN_PX * THIN_PX;
        let either = bent + thin.max(0.0);
        outline.lasting_px2 = [
            LEVELS_SHARE * shift[0] * shift[0] + either,
            LEVELS_SHARE * shift[0] * shift[1],
            LEVELS_SHARE * shift[1] * shift[1] + either,
        ];
        outline
    }

    /// The centroid with what hangs together with the mark around it and is painted thinly.
    fn with_thin(&self, drawn: &Drawn) -> [f64; 2] {
        let near = -((SURROUND_PX + EDGE_PX) as i8);
        let set: Vec<u8> = (0..self.samples.len())
            .map(|k| u8::from(drawn.depth[k] > 0 || (drawn.share[k] >= THIN && drawn.depth[k] >= near)))
            .collect();
        let Parts { all, labels } = parts(&set, [self.width, self.height], Neighbours::Four);
        let deepest = (0..labels.len()).max_by_key(|&k| drawn.depth[k]).unwrap_or_default();
        let [x, y] = all[(labels[deepest] - 1) as usize].centroid;
        [self.left as f64 + x, self.top as f64 + y]
    }
}

#[cfg(test)]
mod tests;
