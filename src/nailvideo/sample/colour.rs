//! Colours of a frame about the nail, read through its motion.

use pulp::{Arch, NullaryFnOnce};

use super::region::{Group, NEAR};
use crate::nailvideo::affine::{Affine, moved};
use crate::nailvideo::grid::{Grid, LANES, Part, samples, shown_size};
use crate::video::{Curve, Frame, Info, Matrix, Turn};

/// Where a file that does not say so has its chroma samples: on the left, as H.264 and HEVC say.
const SITE: (f64, f64) = (0.0, 0.5);

/// How a video's samples are to be read.
#[derive(Debug, Clone, Copy)]
pub(in crate::nailvideo) struct Planes {
    pub(in crate::nailvideo) turn: Turn,
    pub(in crate::nailvideo) matrix: Matrix,
    pub(in crate::nailvideo) curve: Curve,
    /// Where chroma samples lie, in luma samples right of and below the block's first.
    pub(in crate::nailvideo) site: (f64, f64),
}

impl Planes {
    pub(in crate::nailvideo) fn of(info: &Info) -> Self {
        let site = info.chroma_site.unwrap_or(SITE);
        Self { turn: info.turn, matrix: info.matrix, curve: info.curve, site }
    }
}

/// Luma and chroma about the nail.
#[derive(Debug)]
pub(in crate::nailvideo) struct Colours {
    luma: Grid,
    chroma: Option<[Grid; 2]>,
    matrix: Matrix,
    curve: Curve,
    /// Whether [`Grid::many`] may be asked for all points that are near.
    holds_near: bool,
}

/// A channel of a frame, where it is linear in the samples.
pub(in crate::nailvideo) struct Channel<'a> {
    /// With its weight.
    luma: (f32, &'a Grid),
    /// What chroma adds, or, in a grey video, what it adds everywhere.
    chroma: Result<Grid, f32>,
    added: f32,
}

impl Channel<'_> {
    /// Of points of which [`Grid::many`] may be asked: one of [`Colours::at`].
    #[inline(always)]
    pub(in crate::nailvideo) fn many<const N: usize>(&self, x: &[f32; N], y: &[f32; N]) -> [f32; N] {
        let of_chroma = match &self.chroma {
            Ok(grid) => grid.many(x, y),
            Err(everywhere) => [*everywhere; N],
        };
        let luma = self.luma.1.many(x, y);
        std::array::from_fn(|k| self.luma.0 * luma[k] + of_chroma[k] + self.added)
    }
}

impl Colours {
    /// Of the part of a frame in which the nail's box, and a quarter more, lies; `None` where that is off the picture.
    pub(in crate::nailvideo) fn new(frame: &Frame<'_>, planes: Planes, frame_from_nail: &Affine) -> Option<Self> {
        let luma = samples(frame.luma, planes.turn.quarters());
        let corners = [[-NEAR, -NEAR], [NEAR, -NEAR], [NEAR, NEAR], [-NEAR, NEAR]];
        let corners = corners.map(|corner| frame_from_nail.of(corner));
        let part = Part::about(&corners, 2.0, shown_size(&luma))?;
        // Chroma blocks begin on even pixels.
        let from = part.from.map(|at| at & !3);
        let size = std::array::from_fn(|k| part.size[k] + part.from[k] - from[k]);
        let colours = Self::of_part(frame, planes, Part { from, size });
        Some(Self { holds_near: colours.holds(corners), ..colours })
    }

    pub(in crate::nailvideo) fn of_part(frame: &Frame<'_>, planes: Planes, part: Part) -> Self {
        let Planes { turn, matrix, curve, site } = planes;
        let luma = Grid::of_luma(&samples(frame.luma, turn.quarters()), part, 1);
        Self { luma, chroma: Grid::of_chroma(frame, turn, site, part), matrix, curve, holds_near: false }
    }

    /// Whether [`Grid::many`] may be asked for all points between these corners.
    fn holds(&self, corners: [[f64; 2]; 4]) -> bool {
        let corners = corners.map(|corner| corner.map(|at| at as f32));
        self.luma.holds(&corners) && self.chroma.iter().flatten().all(|grid| grid.holds(&corners))
    }

    /// Red, green and blue of a point, fraction of ordinary video's full scale; all luma in a grey video; NaN off the
    /// picture.
    pub(in crate::nailvideo) fn at(&self, [x, y]: [f64; 2]) -> [f64; 3] {
        self.rgb(self.samples([x as f32, y as f32]).map(f64::from))
    }

    /// Red, green or blue alone, for points between these corners; `None` where some lie too near the picture's border.
    pub(in crate::nailvideo) fn channel(&self, channel: usize, corners: [[f64; 2]; 4]) -> Option<Channel<'_>> {
        let of = |samples: [f64; 3]| self.rgb(samples)[channel];
        let none = of([0.0; 3]);
        let [luma, cb, cr] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|one| (of(one) - none) as f32);
        let added = none as f32;
        self.holds(corners).then(|| Channel {
            luma: (luma, &self.luma),
            chroma: match &self.chroma {
                Some([of_cb, of_cr]) => Ok(of_cb.combined([cb, cr], of_cr)),
                None => Err(128.0 * (cb + cr)),
            },
            added,
        })
    }

    /// By how much a level of 255 of Cb and of Cr changes red, green and blue; nothing in a grey video.
    pub(in crate::nailvideo) fn of_chroma_levels(&self) -> [[f64; 3]; 2] {
        let none = self.rgb([128.0; 3]);
        [[128.0, 129.0, 128.0], [128.0, 128.0, 129.0]].map(|samples| {
            let rgb = self.rgb(samples);
            std::array::from_fn(|c| if self.chroma.is_some() { rgb[c] - none[c] } else { 0.0 })
        })
    }

    /// Light of red, green and blue as encoded, fractions of that of full scale.
    pub(in crate::nailvideo) fn light_of(&self, rgb: [f64; 3]) -> [f64; 3] {
        rgb.map(|part| self.curve.light(part))
    }

    /// The mean over a group's points.
    pub(in crate::nailvideo) fn mean(&self, group: &Group, frame_from_nail: &Affine) -> [f64; 3] {
        let (points, motion) = (&group.points[..], frame_from_nail.0.map(|part| part as f32));
        let sum = if self.holds_near && group.is_near {
            Arch::new().dispatch(Sum { colours: self, points, motion })
        } else {
            let mut sum = [0.0_f32; 3];
            for &[u, v] in points {
                let one = self.samples(moved(motion, [u as f32, v as f32]));
                sum.iter_mut().zip(one).for_each(|(sum, part)| *sum += part);
            }
            sum
        };
        self.rgb(sum.map(|sum| f64::from(sum) / points.len() as f64))
    }

    #[inline]
    fn samples(&self, [x, y]: [f32; 2]) -> [f32; 3] {
        let luma = self.luma.at(x, y);
        match &self.chroma {
            Some([cb, cr]) => [luma, cb.at(x, y), cr.at(x, y)],
            None => [luma, 128.0, 128.0],
        }
    }

    /// Linear in the samples, so that the mean's colour is the colours' mean.
    fn rgb(&self, samples: [f64; 3]) -> [f64; 3] {
        self.matrix.to_own_rgb(samples)
    }
}

/// The sum of luma, Cb and Cr over points for which [`Grid::many`] may be asked.
struct Sum<'a> {
    colours: &'a Colours,
    points: &'a [[f64; 2]],
    motion: [f32; 6],
}

impl NullaryFnOnce for Sum<'_> {
    type Output = [f32; 3];

    #[inline(always)]
    fn call(self) -> [f32; 3] {
        let Self { colours, points, motion } = self;
        let [mut luma, mut cb, mut cr] = [[0.0; LANES]; 3];
        for points in points.chunks(LANES) {
            // The last ones may be fewer: the first of them is there as often as one is missing.
            let (mut x, mut y) = ([0.0; LANES], [0.0; LANES]);
            for k in 0..LANES {
                let [u, v] = points[if k < points.len() { k } else { 0 }];
                [x[k], y[k]] = moved(motion, [u as f32, v as f32]);
            }
            let add = |sum: &mut [f32; LANES], values: [f32; LANES]| {
                for k in 0..LANES {
                    sum[k] += if k < points.len() { values[k] } else { 0.0 };
                }
            };
            add(&mut luma, colours.luma.many(&x, &y));
            match &colours.chroma {
                Some(grids) => {
                    add(&mut cb, grids[0].many(&x, &y));
                    add(&mut cr, grids[1].many(&x, &y));
                }
                None => [&mut cb, &mut cr].into_iter().for_each(|sum| add(sum, [128.0; LANES])),
            }
        }
        [luma, cb, cr].map(|lanes| lanes.iter().sum())
    }
}
