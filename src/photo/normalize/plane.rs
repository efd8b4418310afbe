//! One channel of a part of a photograph, as fractions of full scale.
//!
//! Only the rectangle that a nail needs is taken, and from a grey photograph no channel is chosen at all. A fully
//! transparent pixel was not photographed: its value is NaN, and so is everything interpolated from it.

use image::{DynamicImage, Primitive};

/// Which channel of a colour photograph is the value. The thesis finds the colour of the nail bed mainly in the green
/// one (section 4.2.2).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
#[allow(missing_docs, reason = "the names say it, also in the help")]
pub enum Channel {
    Red,
    #[default]
    Green,
    Blue,
}

impl Channel {
    /// Its name in tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Red => "red",
            Self::Green => "green",
            Self::Blue => "blue",
        }
    }
}

/// A rectangle of one channel. `values[(y - y0) * width + (x - x0)]` belongs to the photograph's pixel (x, y).
#[derive(Debug, Clone)]
pub(crate) struct Plane {
    pub(crate) x0: i64,
    pub(crate) y0: i64,
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) values: Vec<f32>,
}

/// How samples become values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Taking {
    pub(crate) channel: Channel,
    /// Undo the sRGB curve (IEC 61966-2-1): values are then proportional to light.
    pub(crate) linear: bool,
}

impl Plane {
    /// Takes columns `x0..x1` and rows `y0..y1`; places outside of the photograph repeat its border pixel, so that an
    /// interpolation at the border has all its neighbours. The values go into `memory`.
    pub(crate) fn take(image: &DynamicImage, taking: Taking, range: [[i64; 2]; 2], mut memory: Vec<f32>) -> Self {
        let [[x0, x1], [y0, y1]] = range;
        let (width, height) = ((x1 - x0).max(0) as usize, (y1 - y0).max(0) as usize);
        memory.clear();
        memory.reserve_exact(width * height);
        let mut plane = Self { x0, y0, width, height, values: memory };
        let index = taking.channel as usize;
        let size = [image.width() as usize, image.height() as usize];
        let layout = |channels| Samples {
            channels,
            index: if channels < 3 { 0 } else { index },
            alpha: (channels % 2 == 0).then_some(channels - 1),
        };
        match image {
            DynamicImage::ImageLuma8(p) => plane.fill(p, size, layout(1), taking.linear),
            DynamicImage::ImageLumaA8(p) => plane.fill(p, size, layout(2), taking.linear),
            DynamicImage::ImageRgb8(p) => plane.fill(p, size, layout(3), taking.linear),
            DynamicImage::ImageRgba8(p) => plane.fill(p, size, layout(4), taking.linear),
            DynamicImage::ImageLuma16(p) => plane.fill(p, size, layout(1), taking.linear),
            DynamicImage::ImageLumaA16(p) => plane.fill(p, size, layout(2), taking.linear),
            DynamicImage::ImageRgb16(p) => plane.fill(p, size, layout(3), taking.linear),
            DynamicImage::ImageRgba16(p) => plane.fill(p, size, layout(4), taking.linear),
            // Float pictures are refused when read; one that a caller made is taken by way of 16 bits.
            other => return Self::take(&other.to_rgba16().into(), taking, range, plane.values),
        }
        plane
    }

    fn fill<S: Primitive + Into<f32>>(
        &mut self,
        samples: &[S],
        [columns, rows]: [usize; 2],
        layout: Samples,
        linear: bool,
    ) {
        let Samples { channels, index, alpha } = layout;
        let value = |pixel: &[S]| {
            if alpha.is_some_and(|a| pixel[a] == S::DEFAULT_MIN_VALUE) {
                return f32::NAN;
            }
            let fraction = pixel[index].into() / S::DEFAULT_MAX_VALUE.into();
            if linear { linear_from_srgb(fraction) } else { fraction }
        };
        let inside = |at: i64, count: usize| at.clamp(0, count as i64 - 1) as usize;
        // Columns before the photograph's first, of it, and after its last.
        let x1 = self.x0 + self.width as i64;
        let before = (-self.x0).clamp(0, self.width as i64) as usize;
        let after = (x1 - columns as i64).clamp(0, self.width as i64) as usize;
        let within = self.width.saturating_sub(before + after);
        for y in 0..self.height {
            let row = &samples[inside(self.y0 + y as i64, rows) * columns * channels..][..columns * channels];
            let (first, last) = (value(&row[..channels]), value(&row[row.len() - channels..]));
            self.values.extend(std::iter::repeat_n(first, before));
            if within > 0 {
                let start = inside(self.x0, columns) * channels;
                let seen = &row[start..start + within * channels];
                match channels {
                    1 => self.values.extend(seen.chunks_exact(1).map(value)),
                    3 => self.values.extend(seen.chunks_exact(3).map(value)),
                    _ => self.values.extend(seen.chunks_exact(channels).map(value)),
                }
            }
            self.values.extend(std::iter::repeat_n(last, after));
        }
    }

    /// Means of `factor` x `factor` blocks, for shrinking by more than interpolation can do without aliasing. The block
    /// of column k covers columns `k * factor..(k + 1) * factor` of this plane.
    pub(crate) fn reduce(&self, factor: usize) -> Vec<f32> {
        let (width, height) = (self.width / factor, self.height / factor);
        let scale = 1.0 / (factor * factor) as f32;
        let mut out = Vec::with_capacity(width * height);
        let mut columns = vec![0.0_f32; width * factor];
        for y in 0..height {
            columns.fill(0.0);
            for line in self.values[y * factor * self.width..].chunks(self.width).take(factor) {
                for (sum, value) in columns.iter_mut().zip(line) {
                    *sum += value;
                }
            }
            out.extend(columns.chunks_exact(factor).map(|block| block.iter().sum::<f32>() * scale));
        }
        out
    }
}

/// Where the value is among a pixel's samples.
#[derive(Clone, Copy)]
struct Samples {
    channels: usize,
    index: usize,
    alpha: Option<usize>,
}

/// IEC 61966-2-1: light, as a fraction of white, from the encoded fraction.
pub(in crate::photo) fn linear_from_srgb(encoded: f32) -> f32 {
    if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{GrayImage, Luma, Rgb, RgbImage, Rgba, RgbaImage};

    const GREEN: Taking = Taking { channel: Channel::Green, linear: false };

    #[test]
    fn green_is_green_and_not_luma() {
        let image = DynamicImage::from(RgbImage::from_pixel(2, 2, Rgb([10, 51, 200])));
        assert_eq!(Plane::take(&image, GREEN, [[0, 2], [0, 2]], Vec::new()).values, [0.2; 4]);
        let blue = Taking { channel: Channel::Blue, linear: false };
        assert_eq!(Plane::take(&image, blue, [[0, 1], [0, 1]], Vec::new()).values, [200.0 / 255.0]);
    }

    #[test]
    fn beyond_the_border_the_border_is_repeated() {
        let image = DynamicImage::from(GrayImage::from_fn(2, 1, |x, _| Luma([if x == 0 { 0 } else { 255 }])));
        assert_eq!(Plane::take(&image, GREEN, [[-2, 4], [-1, 0]], Vec::new()).values, [0.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
    }

    #[test]
    fn transparent_is_missing() {
        let image = DynamicImage::from(RgbaImage::from_fn(2, 1, |x, _| Rgba([9, 9, 9, if x == 0 { 0 } else { 1 }])));
        let values = Plane::take(&image, GREEN, [[0, 2], [0, 1]], Vec::new()).values;
        assert!(values[0].is_nan() && values[1] == 9.0 / 255.0);
    }

    #[test]
    fn full_scale_white_of_16_bits_is_exactly_one_either_way() {
        let image = DynamicImage::from(image::ImageBuffer::from_pixel(1, 1, Luma([65535_u16])));
        for linear in [false, true] {
            let taking = Taking { channel: Channel::Green, linear };
            assert_eq!(Plane::take(&image, taking, [[0, 1], [0, 1]], Vec::new()).values, [1.0]);
        }
    }

    #[test]
    fn the_srgb_curve_at_its_knee_and_middle() {
        // 0.5 encoded is 0.21404114 of the light (IEC 61966-2-1).
        assert!((linear_from_srgb(0.5) - 0.214_041_14).abs() <= 1e-6);
        assert!((linear_from_srgb(0.040_45) - linear_from_srgb(0.040_451)).abs() <= 1e-6);
    }

    #[test]
    fn blocks_are_means_and_a_missing_pixel_makes_its_block_missing() {
        let plane =
            Plane { x0: 0, y0: 0, width: 5, height: 2, values: vec![0., 2., 1., f32::NAN, 9., 4., 6., 1., 1., 9.] };
        let reduced = plane.reduce(2);
        assert_eq!(reduced[0], 3.0);
        assert!(reduced[1].is_nan() && reduced.len() == 2);
    }
}
