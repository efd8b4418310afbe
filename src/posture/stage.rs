//! Small scenes for tests: coloured discs and blots on a ground, drawn into the planes of a frame.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::video::{Format, Info, Matrix, Picture};

/// A disc of a colour.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Disc {
    pub(crate) at: [f64; 2],
    pub(crate) radius: f64,
    pub(crate) colour: [u8; 3],
}

/// A blot of paint: an uneven outline, shine on it, stretched with the skin.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Blot {
    pub(crate) at: [f64; 2],
    pub(crate) radius: f64,
    pub(crate) colour: [u8; 3],
    /// Which outline.
    pub(crate) kind: u64,
    pub(crate) turn_rad: f64,
    /// Along and across.
    pub(crate) stretch: [f64; 2],
}

impl Blot {
    /// Its place on the unstretched skin, of a radius of 1.
    fn local(&self, x: f64, y: f64) -> [f64; 2] {
        let (sin, cos) = self.turn_rad.sin_cos();
        let (dx, dy) = (x - self.at[0], y - self.at[1]);
        [
            (cos * dx + sin * dy) / (self.radius * self.stretch[0]),
            (cos * dy - sin * dx) / (self.radius * self.stretch[1]),
        ]
    }

    /// How far within its outline a place on the unstretched skin is.
    fn within(&self, [u, v]: [f64; 2]) -> f64 {
        let mut random = ChaCha8Rng::seed_from_u64(self.kind);
        let angle = v.atan2(u);
        let bumps = (2..6).map(|k| {
            let (size, phase) = (random.random_range(0.05..0.25), random.random_range(0.0..std::f64::consts::TAU));
            size / (f64::from(k) - 0.8) * (f64::from(k) * angle + phase).cos()
        });
        1.0 + bumps.sum::<f64>() - u.hypot(v)
    }

    /// Where the centroid of its paint is.
    pub(crate) fn centroid(&self) -> [f64; 2] {
        let (mut area, mut sum) = (0.0, [0.0; 2]);
        for k in 0..160 * 160 {
            let at = [k % 160, k / 160].map(|part| f64::from(part) / 40.0 - 1.9875);
            if self.within(at) > 0.0 {
                area += 1.0;
                (sum[0], sum[1]) = (sum[0] + at[0], sum[1] + at[1]);
            }
        }
        let (sin, cos) = self.turn_rad.sin_cos();
        let [u, v] = [0, 1].map(|axis| sum[axis] / area * self.radius * self.stretch[axis]);
        [self.at[0] + cos * u - sin * v, self.at[1] + sin * u + cos * v]
    }
}

pub(crate) const PAINT: [u8; 3] = [0x2b, 0x4b, 0x10];
pub(crate) const PINK: [u8; 3] = [0xe9, 0x1e, 0x63];
pub(crate) const BLUE: [u8; 3] = [0x1e, 0x88, 0xe5];
pub(crate) const GREEN: [u8; 3] = [0x43, 0xa0, 0x47];
pub(crate) const YELLOW: [u8; 3] = [0xfd, 0xd8, 0x35];
pub(crate) const RED: [u8; 3] = [0xd3, 0x2f, 0x2f];
pub(crate) const BLACK: [u8; 3] = [0x10, 0x10, 0x10];
pub(crate) const SKIN: [u8; 3] = [0xd2, 0xa0, 0x82];
pub(crate) const WALL: [u8; 3] = [0xb0, 0xb4, 0xb0];

/// A scene: discs later in the list lie over earlier ones.
#[derive(Debug, Clone)]
pub(crate) struct Stage {
    pub(crate) format: Format,
    pub(crate) ground: [u8; 3],
    pub(crate) discs: Vec<Disc>,
    /// Over them.
    pub(crate) blots: Vec<Blot>,
    /// Standard deviation of the noise of 255.
    pub(crate) noise: f64,
    /// Light: factor on linear intensity.
    pub(crate) light: f64,
}

impl Stage {
    pub(crate) fn new(width: usize, height: usize, ground: [u8; 3]) -> Self {
        let format = Format { width, height, subsampling: Some((2, 2)), depth: 8 };
        Self { format, ground, discs: Vec::new(), blots: Vec::new(), noise: 2.0, light: 1.0 }
    }

    pub(crate) fn disc(&mut self, at: [f64; 2], radius: f64, colour: [u8; 3]) -> &mut Self {
        self.discs.push(Disc { at, radius, colour });
        self
    }

    pub(crate) fn info(&self) -> Info {
        Info::plain(self.format)
    }

    /// The scene as the planes of a BT.709 video.
    pub(crate) fn picture(&self, seed: u64) -> Picture {
        let Format { width, height, depth, .. } = self.format;
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let gain = self.light.powf(1.0 / 2.2);
        let lit =
            |colour: [u8; 3]| Matrix::BT709.from_rgb(colour.map(|part| (f64::from(part) / 255.0 * gain).min(1.0)));
        let mut full = vec![lit(self.ground); width * height];
        // Cover and colour about a place.
        let mut paint = |at: [f64; 2], reach: f64, of: &dyn Fn(f64, f64) -> (f64, [f64; 3])| {
            let span = |at: f64, size: usize| {
                ((at - reach).max(0.0) as usize).min(size)..((at + reach).max(-1.0) + 1.0).min(size as f64) as usize
            };
            for y in span(at[1], height) {
                for x in span(at[0], width) {
                    let (cover, colour) = of(x as f64, y as f64);
                    let pixel = &mut full[y * width + x];
                    pixel.iter_mut().zip(colour).for_each(|(value, part)| *value += cover * (part - *value));
                }
            }
        };
        for disc in &self.discs {
            let colour = lit(disc.colour);
            paint(disc.at, disc.radius + 1.0, &|x, y| {
                ((disc.radius + 0.5 - (x - disc.at[0]).hypot(y - disc.at[1])).clamp(0.0, 1.0), colour)
            });
        }
        for blot in &self.blots {
            let (colour, shine) = (lit(blot.colour), lit([0x80, 0x90, 0x70]));
            let reach = 1.8 * blot.radius * blot.stretch[0].max(blot.stretch[1]);
            paint(blot.at, reach, &|x, y| {
                let at = blot.local(x, y);
                let cover = (blot.radius * blot.within(at) + 0.5).clamp(0.0, 1.0);
                let bright = 0.5 * (-((at[0] - 0.3).powi(2) + (at[1] + 0.2).powi(2)) / 0.08).exp();
                (cover, std::array::from_fn(|plane| colour[plane] + bright * (shine[plane] - colour[plane])))
            });
        }
        let mut picture = Picture::new(self.format);
        let (across, down) = self.format.subsampling.unwrap_or((1, 1));
        for (number, plane) in picture.planes.iter_mut().enumerate() {
            let (across, down) = if number == 0 { (1, 1) } else { (across, down) };
            let (columns, rows) = (width.div_ceil(across), height.div_ceil(down));
            for y in 0..rows {
                for x in 0..columns {
                    let (mut sum, mut count) = (0.0, 0.0);
                    for line in (y * down..(y + 1) * down).filter(|&line| line < height) {
                        for column in (x * across..(x + 1) * across).filter(|&column| column < width) {
                            sum += full[line * width + column][number];
                            count += 1.0;
                        }
                    }
                    let noise: f64 = (0..4).map(|_| random.random::<f64>() - 0.5).sum::<f64>() * 1.732;
                    let share = if number == 0 { 1.0 } else { 0.5 };
                    let value = (sum / count + share * self.noise * noise).clamp(0.0, 255.0);
                    let index = y * columns + x;
                    if depth > 8 {
                        let deep = (value * f64::from(1u32 << (depth - 8))).round() as u16;
                        plane[2 * index..2 * index + 2].copy_from_slice(&deep.to_le_bytes());
                    } else {
                        plane[index] = value.round() as u8;
                    }
                }
            }
        }
        picture
    }
}
