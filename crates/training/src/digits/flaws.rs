//! What a camera and a codec do to a drawn character.

use rand::{Rng, RngExt};

/// A picture of floating-point samples.
pub(super) struct Canvas {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) samples: Vec<f32>,
}

/// About a normal distribution of mean 0 and standard deviation 1.
pub(super) fn bell(rng: &mut impl Rng) -> f32 {
    (0..3).map(|_| rng.random_range(-1.0f32..1.0)).sum()
}

type Square = [[f32; 8]; 8];

/// The transpose of a block's rows, each times `weights`' rows: twice is a transform of both axes.
fn times(block: &Square, weights: &Square) -> Square {
    std::array::from_fn(|k| std::array::from_fn(|y| (0..8).map(|x| block[y][x] * weights[k][x]).sum()))
}

impl Canvas {
    /// Blurs along rows and columns by standard deviations in samples.
    pub(super) fn blur(&mut self, sd: [f32; 2]) {
        for (axis, sd) in sd.into_iter().enumerate().filter(|(_, sd)| *sd > 0.15) {
            let reach = (2.5 * sd).ceil() as i64;
            let weights: Vec<f32> = (-reach..=reach).map(|k| (-0.5 * (k as f32 / sd).powi(2)).exp()).collect();
            let total: f32 = weights.iter().sum();
            let (count, step, lines, next) = if axis == 0 {
                (self.width, 1, self.height, self.width)
            } else {
                (self.height, self.width, self.width, 1)
            };
            let mut line = vec![0.0; count];
            for k in 0..lines {
                for (i, value) in line.iter_mut().enumerate() {
                    *value = self.samples[k * next + i * step];
                }
                for i in 0..count {
                    let at = |d: i64| line[(i as i64 + d).clamp(0, count as i64 - 1) as usize];
                    let sum: f32 = weights.iter().zip(-reach..).map(|(w, d)| w * at(d)).sum();
                    self.samples[k * next + i * step] = sum / total;
                }
            }
        }
    }

    pub(super) fn noise(&mut self, sd: f32, rng: &mut impl Rng) {
        if sd > 0.0 {
            self.samples.iter_mut().for_each(|s| *s += sd * bell(rng));
        }
    }

    /// Blocks of 8 x 8, their cosines rounded to steps that grow with frequency, as JPEG and video codecs do.
    pub(super) fn code(&mut self, step: f32, phase: [usize; 2]) {
        let cosine: Square = std::array::from_fn(|k| {
            let scale = if k == 0 { 0.125f32.sqrt() } else { 0.5 };
            std::array::from_fn(|n| scale * ((n as f32 + 0.5) * k as f32 * std::f32::consts::PI / 8.0).cos())
        });
        let mut top = 0;
        while top < self.height + phase[1] {
            let mut left = 0;
            while left < self.width + phase[0] {
                self.code_block(step, &cosine, [left as i64 - phase[0] as i64, top as i64 - phase[1] as i64]);
                left += 8;
            }
            top += 8;
        }
    }

    fn code_block(&mut self, step: f32, cosine: &Square, [left, top]: [i64; 2]) {
        let (right, bottom) = (self.width as i64 - 1, self.height as i64 - 1);
        let mut block: Square = std::array::from_fn(|y| {
            std::array::from_fn(|x| {
                let (x, y) = ((left + x as i64).clamp(0, right), (top + y as i64).clamp(0, bottom));
                self.samples[y as usize * self.width + x as usize]
            })
        });
        block = times(&times(&block, cosine), cosine);
        let turned: Square = std::array::from_fn(|x| std::array::from_fn(|k| cosine[k][x]));
        for (v, row) in block.iter_mut().enumerate() {
            for (u, value) in row.iter_mut().enumerate() {
                let size = step * (1.0 + 0.35 * (u + v) as f32);
                *value = (*value / size).round() * size;
            }
        }
        block = times(&times(&block, &turned), &turned);
        for (y, row) in block.iter().enumerate() {
            for (x, value) in row.iter().enumerate() {
                let (x, y) = (left + x as i64, top + y as i64);
                if (0..=right).contains(&x) && (0..=bottom).contains(&y) {
                    self.samples[y as usize * self.width + x as usize] = *value;
                }
            }
        }
    }

    /// As a plane's bytes.
    pub(super) fn bytes(&self) -> Vec<u8> {
        self.samples.iter().map(|s| s.round().clamp(0.0, 255.0) as u8).collect()
    }
}
