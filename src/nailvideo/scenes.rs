//! Scenes for tests: a drawn nail with texture that moves by a known affine motion, blanches, is hidden by a rod, in
//! light that drifts.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::nailvideo::affine::Affine;
use crate::video::{Curve, Format, Lit, Matrix, Picture};

/// What one frame shows.
#[derive(Debug, Clone, Copy)]
pub(in crate::nailvideo) struct Shot {
    /// From the first frame's pixels to this one's.
    pub(in crate::nailvideo) motion: Affine,
    /// 0 to 1: green rises by 26 % in the white zone.
    pub(in crate::nailvideo) blanched: f64,
    /// A grey rod across the nail: its middle along the axis in half lengths, and half its width.
    pub(in crate::nailvideo) rod: Option<[f64; 2]>,
    /// Light: by what it is multiplied, and the slope of that across the picture's width.
    pub(in crate::nailvideo) light: [f64; 2],
    pub(in crate::nailvideo) nail: bool,
}

impl Shot {
    pub(in crate::nailvideo) const REST: Self =
        Self { motion: Affine::IDENTITY, blanched: 0.0, rod: None, light: [1.0, 0.0], nail: true };
}

/// A drawn finger with a nail.
#[derive(Debug, Clone)]
pub(in crate::nailvideo) struct Scene {
    pub(in crate::nailvideo) format: Format,
    /// From half widths and half lengths to the first frame's pixels.
    pub(in crate::nailvideo) frame_from_nail: Affine,
    /// SD of the noise, of 255.
    pub(in crate::nailvideo) noise: f64,
    waves: Vec<[f64; 4]>,
}

impl Scene {
    /// A nail so many pixels wide, pointing up, in 640 x 480.
    pub(in crate::nailvideo) fn new(width_px: f64, seed: u64) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        // Skin: waves of all directions, 1/40 to 1/6 of the nail's width long.
        let waves = (0..24).map(|_| {
            let length = width_px * random.random_range(0.035..0.16_f64);
            let (k, way) = (std::f64::consts::TAU / length, random.random_range(0.0..std::f64::consts::TAU));
            [k * way.cos(), k * way.sin(), random.random_range(0.0..std::f64::consts::TAU), 0.006]
        });
        Self {
            format: Format { width: 640, height: 480, subsampling: Some((2, 2)), depth: 8 },
            frame_from_nail: Affine([0.5 * width_px, 0.0, 318.0, 0.0, -0.6 * width_px, 241.0]),
            noise: 1.0,
            waves: waves.collect(),
        }
    }

    /// How much of the white zone's change a place has, 0 to 1.
    pub(in crate::nailvideo) fn zone([u, v]: [f64; 2]) -> f64 {
        let edge = |x: f64| 1.0 / (1.0 + (-14.0 * x).exp());
        edge(v + 0.05) * edge(0.85 - v) * edge(0.9 - u.abs())
    }

    /// Red, green and blue, 0 to 1, of a place of the first frame without light or rod.
    pub(in crate::nailvideo) fn colour(&self, at: [f64; 2], blanched: f64, nail: bool) -> [f64; 3] {
        let waves = self.waves(nail).map(|[a, b, c, size]| size * (a * at[0] + b * at[1] + c).sin());
        self.coloured(at, waves.sum(), blanched, nail)
    }

    /// Waves of the skin, or of another skin where the nail is not there: what their phases grow by along both axes,
    /// where they begin, and their size.
    fn waves(&self, nail: bool) -> impl Iterator<Item = [f64; 4]> {
        self.waves.iter().map(move |&[a, b, c, size]| if nail { [a, b, c, size] } else { [b, -a, 2.0 * c, size] })
    }

    /// The sum of the waves at each pixel of a picture, row by row: their phases grow evenly, so sines of the columns
    /// and of the rows are enough (sines at each pixel took half of the tests' time).
    fn texture(&self, back: &Affine, nail: bool) -> Vec<f64> {
        let [ax, bx, cx, ay, by, cy] = back.0;
        let Format { width, height, .. } = self.format;
        let of_wave = |[a, b, c, size]: [f64; 4]| {
            let (x, y, first) = (a * ax + b * ay, a * bx + b * by, a * cx + b * cy + c);
            let columns: Vec<(f64, f64)> = (0..width).map(|k| (x * k as f64).sin_cos()).collect();
            let rows = (0..height).map(move |k| (y * k as f64 + first).sin_cos());
            (columns, rows.map(|(sin, cos)| (size * sin, size * cos)).collect::<Vec<_>>())
        };
        let waves: Vec<_> = self.waves(nail).map(of_wave).collect();
        let mut texture = vec![0.0; width * height];
        for (y, row) in texture.chunks_exact_mut(width).enumerate() {
            for (columns, rows) in &waves {
                let (of_sin, of_cos) = rows[y];
                row.iter_mut().zip(columns).for_each(|(sum, (sin, cos))| *sum += sin * of_cos + cos * of_sin);
            }
        }
        texture
    }

    fn coloured(&self, at: [f64; 2], texture: f64, blanched: f64, nail: bool) -> [f64; 3] {
        let [u, v] = self.frame_from_nail.inverse().expect("a nail has an area").of(at);
        let edge = |x: f64| 1.0 / (1.0 + (-x).exp());
        let on_finger = edge(12.0 * (1.7 - u.abs()));
        if !nail {
            return [0.70, 0.52, 0.45].map(|c| (c + texture) * on_finger + 0.25 * (1.0 - on_finger));
        }
        let r = (u.powi(4) + v.powi(4)).powf(0.25);
        let inside = edge(30.0 * (1.0 - r));
        let fold = 0.12 * (-((r - 1.03) / 0.04).powi(2)).exp();
        let lunula = 0.06 * edge(20.0 * (-0.66 - v + 0.15 * u * u)) * inside;
        let tip = 0.10 * edge(30.0 * (v - 0.86)) * inside;
        let texture = texture * (1.0 - 0.75 * inside) + 0.006 * (34.0 * u).sin() * inside;
        let base = [0.72, 0.53, 0.46];
        let of_nail = [0.06, 0.02, 0.03];
        let rise = [0.02, 0.26, 0.10];
        let zone = blanched * Self::zone([u, v]) * (inside + 0.33 * (1.0 - inside));
        std::array::from_fn(|c| {
            let own = base[c] + of_nail[c] * inside + texture - fold + lunula + tip;
            (own * (1.0 + rise[c] * zone)) * on_finger + 0.25 * (1.0 - on_finger)
        })
    }

    /// A frame as the planes of a BT.709 video.
    pub(in crate::nailvideo) fn picture(&self, shot: &Shot, seed: u64) -> Picture {
        let Format { width, height, .. } = self.format;
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let back = shot.motion.inverse().expect("a motion");
        let nail = self.frame_from_nail.inverse().expect("a nail has an area");
        let texture = self.texture(&back, shot.nail);
        let [level, slope] = shot.light;
        let light = |x: usize| Curve::Bt709.times(level + slope * (x as f64 / width as f64 - 0.5));
        let light: Vec<Lit> = (0..width).map(light).collect();
        let mut full = Vec::with_capacity(width * height);
        for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
            let at = back.of([x as f64, y as f64]);
            let mut rgb = self.coloured(at, texture[full.len()], shot.blanched, shot.nail);
            if let Some([middle, half]) = shot.rod {
                let [u, v] = nail.of(at);
                let cover = 1.0 / (1.0 + (-60.0 * (half - (v - middle - 0.2 * u).abs())).exp());
                rgb = rgb.map(|c| c + cover * (0.35 - c));
            }
            full.push(Matrix::BT709.from_rgb(rgb.map(|c| light[x].of(c).clamp(0.0, 1.0))));
        }
        let mut picture = Picture::new(self.format);
        let normal = |random: &mut ChaCha8Rng| -> f64 { StandardNormal.sample(random) };
        let whole = 1 << (self.format.depth - 8);
        let set = |plane: &mut Vec<u8>, at: usize, value: f64| {
            let level = (value * f64::from(whole)).round().clamp(0.0, 256.0 * f64::from(whole) - 1.0) as u16;
            if whole == 1 {
                plane[at] = level as u8;
            } else {
                plane[2 * at..2 * at + 2].copy_from_slice(&level.to_le_bytes());
            }
        };
        for (at, pixel) in full.iter().enumerate() {
            set(&mut picture.planes[0], at, pixel[0] + self.noise * normal(&mut random));
        }
        let halves = [width / 2, height / 2];
        for c in (1..3).filter(|_| self.format.subsampling.is_some()) {
            for at in 0..halves[0] * halves[1] {
                let (x, y) = (2 * (at % halves[0]), 2 * (at / halves[0]));
                let mean = 0.25 * [0, 1, width, width + 1].map(|d| full[y * width + x + d][c]).iter().sum::<f64>();
                set(&mut picture.planes[c], at, mean + 0.5 * self.noise * normal(&mut random));
            }
        }
        picture
    }

    /// Root mean square of what two motions differ by over the nail, pixels.
    pub(in crate::nailvideo) fn apart(&self, one: &Affine, other: &Affine) -> f64 {
        let grid = (0..49).map(|k| [k % 7, k / 7].map(|n| f64::from(n) / 3.0 - 1.0));
        let squares = grid.map(|at| {
            let at = self.frame_from_nail.of(at);
            let ([x, y], [p, q]) = (one.of(at), other.of(at));
            (x - p).powi(2) + (y - q).powi(2)
        });
        (squares.sum::<f64>() / 49.0).sqrt()
    }
}
