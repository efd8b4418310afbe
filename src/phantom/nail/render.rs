//! The photograph of a scene: its field at the pixel centres, with the sensor's noise, rounded.

use image::{DynamicImage, GrayImage, ImageBuffer, Luma, Rgb, RgbImage};
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;

use super::{NailScene, subject::numbers};

/// Levels of the photograph.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Depth {
    /// 0 to 255.
    Eight,
    /// 0 to 65535.
    Sixteen,
}

/// How a scene is photographed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RenderOptions {
    /// Levels of a channel.
    pub depth: Depth,
    /// One channel, the green (as through a green filter), in place of three.
    pub grey: bool,
    /// Standard deviation of the sensor's noise, in 255ths of full scale whatever the depth.
    pub noise_sd: f64,
    /// Seed of the noise.
    pub noise_seed: u64,
}

const KIND_NOISE: u32 = 2;

/// Rows in parallel; each has its own random numbers, so the threads don't show. `level` rounds a value of 0 to 1.
fn levels<L>(scene: &NailScene, options: &RenderOptions, level: impl Fn(f64) -> L + Sync) -> Vec<L>
where
    L: Copy + Default + Send,
{
    let field = scene.field();
    let channels = if options.grey { 1..2 } else { 0..3 };
    let width = scene.camera.width as usize;
    let row_length = width * channels.len();
    let mut out = vec![L::default(); row_length * scene.camera.height as usize];
    let noise_sd = options.noise_sd / 255.0;
    out.par_chunks_mut(row_length).enumerate().for_each(|(row, levels)| {
        let mut rng = numbers(options.noise_seed, KIND_NOISE, row as u32);
        for (column, pixel) in levels.chunks_exact_mut(channels.len()).enumerate() {
            let colour = field.colour(column as f64, row as f64);
            for (into, value) in pixel.iter_mut().zip(&colour[channels.clone()]) {
                let noise: f64 = if noise_sd > 0.0 { StandardNormal.sample(&mut rng) } else { 0.0 };
                *into = level((value + noise_sd * noise).clamp(0.0, 1.0));
            }
        }
    });
    out
}

pub(super) fn render(scene: &NailScene, options: &RenderOptions) -> DynamicImage {
    const FITS: &str = "as many levels as the picture has";
    let (width, height) = (scene.camera.width, scene.camera.height);
    let eight = || levels(scene, options, |value| (value * 255.0 + 0.5) as u8);
    let sixteen = || levels(scene, options, |value| (value * 65535.0 + 0.5) as u16);
    match (options.depth, options.grey) {
        (Depth::Eight, true) => GrayImage::from_raw(width, height, eight()).expect(FITS).into(),
        (Depth::Eight, false) => RgbImage::from_raw(width, height, eight()).expect(FITS).into(),
        (Depth::Sixteen, true) => ImageBuffer::<Luma<u16>, _>::from_raw(width, height, sixteen()).expect(FITS).into(),
        (Depth::Sixteen, false) => ImageBuffer::<Rgb<u16>, _>::from_raw(width, height, sixteen()).expect(FITS).into(),
    }
}
