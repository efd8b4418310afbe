//! The sensor: noise on R'G'B', then rows of R'G'B' to rows of Y'CbCr samples.
//!
//! Noise is Gaussian and independent from pixel to pixel, channel to channel, frame to frame. A pixel's value is looked
//! up in a table of 16 384 quantiles of the normal distribution (scaled to unit variance; the furthest at 4 standard
//! deviations) at bits of a hash (the finalizer of splitmix64) of seed, frame, row and column: no state, so threads
//! don't show.

use std::sync::LazyLock;

use serde::Serialize;

use crate::video::{Format, Matrix, Transfer};

/// Where chroma samples lie in their block of luma samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Siting {
    /// On its left edge's luma samples, between the two rows: most camera files.
    Left,
    /// In its middle: files that swscale converted from RGB, and the prototype's scenes.
    Centre,
}

impl Siting {
    /// The place of a 4:2:0 chroma sample in luma samples right of and below its block's first luma sample.
    #[must_use]
    pub fn place(self) -> (f64, f64) {
        match self {
            Self::Left => (0.0, 0.5),
            Self::Centre => (0.5, 0.5),
        }
    }
}

const TABLE: usize = 1 << 14;

static NORMAL: LazyLock<Vec<f32>> = LazyLock::new(|| {
    // The distribution function, summed in small steps; a quantile is where it passes.
    const STEP: f64 = 1e-4;
    let (mut x, mut below) = (-6.0, 0.0);
    let mut quantiles: Vec<f64> = Vec::with_capacity(TABLE);
    while quantiles.len() < TABLE / 2 {
        let middle: f64 = x + 0.5 * STEP;
        let step = STEP * (-0.5 * middle * middle).exp() / std::f64::consts::TAU.sqrt();
        let goal = (quantiles.len() as f64 + 0.5) / TABLE as f64;
        if below + step >= goal {
            quantiles.push(x + STEP * (goal - below) / step);
        } else {
            below += step;
            x += STEP;
        }
    }
    let variance = 2.0 * quantiles.iter().map(|q| q * q).sum::<f64>() / TABLE as f64;
    let half: Vec<f32> = quantiles.into_iter().map(|q| (q / variance.sqrt()) as f32).collect();
    half.iter().copied().chain(half.iter().rev().map(|q| -q)).collect()
});

fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// Adds noise of standard deviation `sd` (1 is full scale) to row `row` of frame `frame`.
pub(in crate::phantom) fn add_noise(rgb: &mut [Vec<f32>; 3], sd: f32, seed: u64, frame: usize, row: usize) {
    const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;
    if sd <= 0.0 {
        return;
    }
    let table: &[f32; TABLE] = NORMAL.as_slice().try_into().expect("the table has its length");
    let start = mix(mix(mix(seed).wrapping_add(frame as u64).wrapping_mul(GOLDEN)).wrapping_add(row as u64));
    let [red, green, blue] = rgb;
    let mut counter = start;
    for ((red, green), blue) in red.iter_mut().zip(green).zip(blue) {
        counter = counter.wrapping_add(GOLDEN);
        let hash = mix(counter);
        let normal = |shift: u32| table[(hash >> shift) as usize % TABLE];
        *red += sd * normal(0);
        *green += sd * normal(20);
        *blue += sd * normal(40);
    }
}

/// Turns rows of R'G'B' into samples of one row of luma and, for each group of rows, one of chroma.
pub(in crate::phantom::video) struct Converter {
    to_ycc: [[f32; 4]; 3],
    matrix: Matrix,
    format: Format,
    siting: Siting,
    depth_scale: f32,
    top: f32,
}

impl Converter {
    pub(in crate::phantom::video) fn new(format: Format, matrix: &Matrix, siting: Siting) -> Self {
        let zero = matrix.from_own_rgb([0.0; 3]);
        let columns = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|unit| matrix.from_own_rgb(unit));
        let to_ycc = std::array::from_fn(|c| {
            let share = |k: usize| (columns[k][c] - zero[c]) as f32;
            [share(0), share(1), share(2), zero[c] as f32]
        });
        let depth_scale = (1u32 << (format.depth - 8)) as f32;
        Self { to_ycc, matrix: *matrix, format, siting, depth_scale, top: ((1u32 << format.depth) - 1) as f32 }
    }

    /// A row's ordinary R'G'B', cut to 0..1, as HDR has them; ordinary video leaves them as they are.
    pub(in crate::phantom::video) fn encode(&self, [red, green, blue]: &mut [Vec<f32>; 3]) {
        if self.matrix.transfer == Transfer::Power {
            return;
        }
        for ((red, green), blue) in red.iter_mut().zip(green).zip(blue) {
            let own = self.matrix.own_rgb([*red, *green, *blue].map(|part| f64::from(part.clamp(0.0, 1.0))));
            [*red, *green, *blue] = own.map(|part| part as f32);
        }
    }

    /// One component of a row, on the scale of 8 bits; R'G'B' is cut to 0..1 first.
    fn component(&self, which: usize, rgb: &[Vec<f32>; 3], into: &mut [f32]) {
        let [r, g, b, zero] = self.to_ycc[which];
        for (((value, &red), &green), &blue) in into.iter_mut().zip(&rgb[0]).zip(&rgb[1]).zip(&rgb[2]) {
            *value = zero + r * red.clamp(0.0, 1.0) + g * green.clamp(0.0, 1.0) + b * blue.clamp(0.0, 1.0);
        }
    }

    fn store(&self, values: &[f32], into: &mut [u8]) {
        let sample = |value: f32| (value * self.depth_scale + 0.5).clamp(0.0, self.top);
        if self.format.depth <= 8 {
            into.iter_mut().zip(values).for_each(|(into, &value)| *into = sample(value) as u8);
        } else {
            for (into, &value) in into.chunks_exact_mut(2).zip(values) {
                into.copy_from_slice(&(sample(value) as u16).to_le_bytes());
            }
        }
    }

    /// The luma samples of a row.
    pub(in crate::phantom::video) fn luma(&self, rgb: &[Vec<f32>; 3], into: &mut [u8]) {
        let mut values = vec![0.0; self.format.width];
        self.component(0, rgb, &mut values);
        self.store(&values, into);
    }

    /// The samples of a row of Cb (`which` 1) or Cr (2) that covers these rows.
    pub(in crate::phantom::video) fn chroma(&self, which: usize, rows: &[&[Vec<f32>; 3]], into: &mut [u8]) {
        let width = self.format.width;
        let mut sum = vec![0.0; width];
        let mut one = vec![0.0; width];
        for rgb in rows {
            self.component(which, rgb, &mut one);
            sum.iter_mut().zip(&one).for_each(|(sum, one)| *sum += one);
        }
        let share = 1.0 / rows.len() as f32;
        let across = self.format.subsampling.map_or(1, |(across, _)| across);
        let values: Vec<f32> = (0..width.div_ceil(across))
            .map(|k| {
                let at = |column: usize| sum[column.min(width - 1)];
                let here = across * k;
                share
                    * match (across, self.siting) {
                        (1, _) => at(here),
                        (_, Siting::Left) => 0.25 * at(here.saturating_sub(1)) + 0.5 * at(here) + 0.25 * at(here + 1),
                        (_, Siting::Centre) => 0.5 * (at(here) + at(here + 1)),
                    }
            })
            .collect();
        self.store(&values, into);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_normal_and_independent() {
        let mut rgb = [vec![0.0; 200_000], vec![0.0; 200_000], vec![0.0; 200_000]];
        add_noise(&mut rgb, 1.0, 7, 3, 5);
        let mean = |values: &dyn Fn(usize) -> f64| (0..200_000).map(values).sum::<f64>() / 200_000.0;
        let at = |channel: usize, k: usize| f64::from(rgb[channel][k]);
        for c in 0..3 {
            // Standard errors of the mean, the variance, the kurtosis and a correlation: 0.0022, 0.0032, 0.011, 0.0022.
            assert!(mean(&|k| at(c, k)).abs() <= 0.009);
            assert!((mean(&|k| at(c, k).powi(2)) - 1.0).abs() <= 0.013);
            assert!((mean(&|k| at(c, k).powi(4)) - 3.0).abs() <= 0.06);
            assert!(mean(&|k| at(c, k) * at((c + 1) % 3, k)).abs() <= 0.009);
            assert!(mean(&|k| at(c, k) * at(c, (k + 1) % 200_000)).abs() <= 0.009);
        }
        let mut other = [vec![0.0; 200_000], vec![0.0; 200_000], vec![0.0; 200_000]];
        add_noise(&mut other, 1.0, 7, 3, 6);
        assert!(mean(&|k| at(0, k) * f64::from(other[0][k])).abs() <= 0.009);
    }

    #[test]
    fn chroma_lies_where_the_siting_says() {
        // Cb and Cr that rise by the column: a sample's value gives its place.
        let width = 64;
        let ramp: Vec<f32> = (0..width).map(|x| x as f32 / 100.0).collect();
        let row = [ramp, vec![0.0; width], vec![0.0; width]];
        let rows = [&row, &row];
        let format = Format { width, height: 2, subsampling: Some((2, 2)), depth: 10 };
        for (siting, place) in [(Siting::Left, 0.0), (Siting::Centre, 0.5)] {
            let converter = Converter::new(format, &Matrix::BT709, siting);
            let mut samples = vec![0; width];
            converter.chroma(2, &rows, &mut samples);
            let at = |k: usize| f64::from(u16::from_le_bytes([samples[2 * k], samples[2 * k + 1]])) / 4.0;
            for k in [5, 17, 30] {
                let expected = Matrix::BT709.from_rgb([(2.0 * k as f64 + place) / 100.0, 0.0, 0.0])[2];
                assert!((at(k) - expected).abs() <= 0.13, "rounding to a quarter");
            }
        }
    }
}
