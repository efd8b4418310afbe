//! The working picture: reduced planes that do not depend on how bright the light is.
//!
//! In: a photograph of any sample type. Out: `tone`, the logarithm of the green value (so that a step is a *relative*
//! contrast, the same in dim light), and for colour `red`, ln(R/G), and `yellow`, ln(G/B), both unmoved by shading.
//! Working pixels are means over `step x step` source pixels; [`Picture::to_source`] leads back.

use image::{DynamicImage, ImageBuffer, Luma};

/// One channel of a working picture.
pub(super) type Plane = ImageBuffer<Luma<f32>, Vec<f32>>;

/// Darkest value that counts, as a fraction of full scale: keeps logarithms finite and noise in the dark small.
const FLOOR: f32 = 0.02;
/// Mean |ln(R/G)| and |ln(G/B)| under which a picture counts as grey.
const GREY: f32 = 0.01;

/// A part of a photograph at reduced size.
#[derive(Debug, Clone)]
pub(super) struct Picture {
    /// ln(green + floor).
    pub(super) tone: Plane,
    /// ln(R/G) and ln(G/B); `None` for a grey photograph.
    pub(super) chroma: Option<[Plane; 2]>,
    /// Source pixels a working pixel.
    pub(super) step: u32,
    /// Source pixel of the working picture's top-left corner.
    origin: [u32; 2],
}

/// A rectangle of source pixels: left, top, width, height.
pub(super) type Region = [u32; 4];

impl Picture {
    /// The whole photograph with its longest side reduced by a whole factor to at most `longest_px`.
    pub(super) fn whole(image: &DynamicImage, longest_px: u32) -> Self {
        let longest = image.width().max(image.height());
        Self::part(image, [0, 0, image.width(), image.height()], longest.div_ceil(longest_px.max(1)).max(1))
    }

    /// `region` of the photograph (clipped to it), each working pixel the mean of `step x step`.
    pub(super) fn part(image: &DynamicImage, region: Region, step: u32) -> Self {
        let x0 = region[0].min(image.width().saturating_sub(1));
        let y0 = region[1].min(image.height().saturating_sub(1));
        let width = (region[2].min(image.width() - x0) / step).max(1);
        let height = (region[3].min(image.height() - y0) / step).max(1);
        let window = Window { x0, y0, width, height, step };
        let sums = match image {
            DynamicImage::ImageLuma8(p) => window.grey(p.as_raw(), p.width(), 1, 255.0),
            DynamicImage::ImageLumaA8(p) => window.grey(p.as_raw(), p.width(), 2, 255.0),
            DynamicImage::ImageLuma16(p) => window.grey(p.as_raw(), p.width(), 1, 65535.0),
            DynamicImage::ImageLumaA16(p) => window.grey(p.as_raw(), p.width(), 2, 65535.0),
            DynamicImage::ImageRgb8(p) => window.colour(p.as_raw(), p.width(), 3, 255.0),
            DynamicImage::ImageRgba8(p) => window.colour(p.as_raw(), p.width(), 4, 255.0),
            DynamicImage::ImageRgb16(p) => window.colour(p.as_raw(), p.width(), 3, 65535.0),
            DynamicImage::ImageRgba16(p) => window.colour(p.as_raw(), p.width(), 4, 65535.0),
            other => {
                let p = other.to_rgb16();
                window.colour(p.as_raw(), p.width(), 3, 65535.0)
            }
        };
        let log = |plane: Vec<f32>| plane.into_iter().map(|v| (v + FLOOR).ln()).collect::<Vec<f32>>();
        let plane = |data: Vec<f32>| Plane::from_raw(width, height, data).expect("one value a pixel");
        match sums {
            Sums::Grey(green) => {
                Self { tone: plane(log(green)), chroma: None, step, origin: [x0, y0] }
            }
            Sums::Colour(red, green, blue) => {
                let (red, green, blue) = (log(red), log(green), log(blue));
                let ratio = |a: &[f32], b: &[f32]| a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<f32>>();
                let (rg, gb) = (ratio(&red, &green), ratio(&green, &blue));
                let mean = |v: &[f32]| v.iter().map(|x| x.abs()).sum::<f32>() / v.len() as f32;
                let chroma = (mean(&rg) > GREY || mean(&gb) > GREY).then(|| [plane(rg), plane(gb)]);
                Self { tone: plane(green), chroma, step, origin: [x0, y0] }
            }
        }
    }

    /// Working to source pixels.
    pub(super) fn to_source(&self, p: [f64; 2]) -> [f64; 2] {
        let s = f64::from(self.step);
        [0, 1].map(|i| (p[i] + 0.5) * s - 0.5 + f64::from(self.origin[i]))
    }

    /// Source to working pixels.
    pub(super) fn from_source(&self, p: [f64; 2]) -> [f64; 2] {
        let s = f64::from(self.step);
        [0, 1].map(|i| (p[i] + 0.5 - f64::from(self.origin[i])) / s - 0.5)
    }
}

enum Sums {
    Grey(Vec<f32>),
    Colour(Vec<f32>, Vec<f32>, Vec<f32>),
}

struct Window {
    x0: u32,
    y0: u32,
    width: u32,
    height: u32,
    step: u32,
}

impl Window {
    fn grey<T: Copy + Into<f32>>(&self, raw: &[T], stride: u32, samples: usize, full: f32) -> Sums {
        Sums::Grey(self.mean(raw, stride, samples, 0, full))
    }

    fn colour<T: Copy + Into<f32>>(&self, raw: &[T], stride: u32, samples: usize, full: f32) -> Sums {
        let [r, g, b] = [0, 1, 2].map(|c| self.mean(raw, stride, samples, c, full));
        Sums::Colour(r, g, b)
    }

    /// Box means of sample `c` as fractions of `full`.
    fn mean<T: Copy + Into<f32>>(&self, raw: &[T], stride: u32, samples: usize, c: usize, full: f32) -> Vec<f32> {
        let (w, h, step) = (self.width as usize, self.height as usize, self.step as usize);
        let scale = 1.0 / (full * (step * step) as f32);
        let mut out = vec![0.0f32; w * h];
        for (y, row) in out.chunks_exact_mut(w).enumerate() {
            for sub in 0..step {
                let line = (self.y0 as usize + y * step + sub) * stride as usize + self.x0 as usize;
                let from = &raw[line * samples..(line + w * step) * samples];
                for (cell, block) in row.iter_mut().zip(from.chunks_exact(step * samples)) {
                    *cell += block.iter().skip(c).step_by(samples).map(|&v| v.into()).sum::<f32>();
                }
            }
            for cell in row.iter_mut() {
                *cell *= scale;
            }
        }
        out
    }
}

/// Value at a point between pixels, linearly; beyond the border the border's value.
pub(super) fn sample(plane: &Plane, x: f64, y: f64) -> f32 {
    let (w, h) = (plane.width() as usize, plane.height() as usize);
    let x = x.clamp(0.0, (w - 1) as f64);
    let y = y.clamp(0.0, (h - 1) as f64);
    let (i, j) = (x as usize, y as usize);
    let (fx, fy) = ((x - i as f64) as f32, (y - j as f64) as f32);
    let (i1, j1) = ((i + 1).min(w - 1), (j + 1).min(h - 1));
    let raw = plane.as_raw();
    let top = raw[j * w + i] * (1.0 - fx) + raw[j * w + i1] * fx;
    let low = raw[j1 * w + i] * (1.0 - fx) + raw[j1 * w + i1] * fx;
    top * (1.0 - fy) + low * fy
}
