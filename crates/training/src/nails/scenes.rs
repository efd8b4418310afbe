//! The scenes that train: phantoms, pictures without nails, and photographs of hands.

use std::path::{Path, PathBuf};

use anyhow::Context;
use image::{DynamicImage, GrayImage, Luma, Rgb, RgbImage};
use lunula::phantom::nail::{Background, Camera, Depth, Light, NailScene, Pose, RenderOptions, Subject, Tone};
use lunula::photo::outline::training::{Frame, Levels, ends as finger_ends};
use lunula::photo::outline::{DetectOptions, Outline};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

/// A nail of a scene.
pub(super) struct Truth {
    pub(super) outline: Outline,
    /// Distal direction, where known.
    pub(super) up: Option<[f64; 2]>,
}

/// A picture and the nails on it.
pub(super) struct Scene {
    pub(super) image: DynamicImage,
    pub(super) truths: Vec<Truth>,
    pub(super) real: bool,
}

/// Phantom `k`: any tone, light, pose, turn up to 30 degrees, colour or grey.
pub(super) fn phantom(seed: u64, k: u32) -> anyhow::Result<Scene> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed ^ (u64::from(k) << 20));
    let subject = Subject::random(seed, k);
    let pose = Pose::ALL[rng.random_range(0..8)];
    let chamber = rng.random_bool(0.25);
    let light = if chamber { Light::random_chamber(&mut rng) } else { Light::random(&mut rng) };
    let size = [[320, 240], [480, 360], [240, 320], [640, 480]][rng.random_range(0..4)];
    let filling = rng.random_range(0.3..0.8);
    let mut camera = Camera::close_up(&mut rng, size, subject.nail.aspect, filling, 30.0);
    if !chamber {
        camera.background = Background::random(&mut rng);
    }
    let scene = NailScene { subject, pose, light, camera };
    let options = RenderOptions {
        depth: Depth::Eight,
        grey: rng.random_bool(0.4),
        noise_sd: rng.random_range(0.3..3.0),
        noise_seed: u64::from(k),
    };
    let up = Some(scene.axis().distal());
    let truth = Truth { outline: scene.outline()?, up };
    Ok(Scene { image: scene.render(&options)?, truths: vec![truth], real: false })
}

/// Pictures without nails.
pub(super) fn empty(seed: u64, k: u32) -> anyhow::Result<Scene> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed ^ 0xE ^ (u64::from(k) << 20));
    let (w, h) = (320u32, 240u32);
    let mut image = RgbImage::new(w, h);
    let back: [f64; 3] = std::array::from_fn(|_| rng.random_range(20.0..230.0));
    let skin = Tone::new(rng.random()).skin().map(|c| 255.0 * c * rng.random_range(0.55..1.0));
    let kind = k % 8;
    if kind == 7 {
        return skin_only(seed, k);
    }
    let ink = rng.random_range(8.0..30.0);
    let noise = rng.random_range(1.0..12.0);
    let (cx, cy) = (rng.random_range(90.0..230.0), rng.random_range(70.0..170.0));
    let (a, b, n) = (rng.random_range(25.0..100.0), rng.random_range(25.0..100.0), rng.random_range(1.6..5.0));
    let turn: f64 = rng.random_range(-1.0..1.0);
    let other: [f64; 3] = std::array::from_fn(|_| rng.random_range(20.0..240.0));
    let pad = rng.random_range(45.0..90.0);
    let waves: Vec<[f64; 3]> = (0..6)
        .map(|_| [rng.random_range(-0.15..0.15), rng.random_range(-0.15..0.15), rng.random_range(0.0..6.0)])
        .collect();
    let wave = |x: f64, y: f64| waves.iter().map(|w| (w[0] * x + w[1] * y + w[2]).sin()).sum::<f64>() / 6.0;
    for (x, y, p) in image.enumerate_pixels_mut() {
        let (fx, fy) = (f64::from(x), f64::from(y));
        let (dx, dy) = (fx - cx, fy - cy);
        let (u, v) = (dx * turn.cos() + dy * turn.sin(), dy * turn.cos() - dx * turn.sin());
        let c = match kind {
            0 => back.map(|c| c * (1.0 + 0.1 * wave(fx, fy))),
            6 => {
                // A page of text: words of strokes on lines.
                let (line, along) = ((v / ink).floor(), u / (0.35 * ink));
                let stroke = ((along + 3.0 * line).sin() + (2.3 * along + line).sin()) * (0.9 * along - line).cos();
                let on_line = (v / ink - line - 0.5).abs() < 0.25;
                if on_line && stroke > 0.35 { back.map(|c| c * 0.25) } else { [225.0; 3] }
            }
            1 => {
                // Blobs of two colours.
                if wave(fx, fy) > 0.1 { other } else { back }
            }
            2 | 3 => {
                // One object, on a surface or on skin.
                let ground = if kind == 2 { back } else { skin.map(|c| c * (1.0 + 0.05 * wave(fx, fy))) };
                if (u / a).abs().powf(n) + (v / b).abs().powf(n) < 1.0 {
                    other.map(|c| c * (1.0 + 0.1 * v / b))
                } else {
                    ground
                }
            }
            _ => {
                // A finger's pad (4) or an unbroken finger across the picture (5).
                let end = if kind == 4 { -pad * 0.8 } else { -1e3 };
                let begin = end + pad * 1.2;
                let y0 = ((begin - v) / (begin - end)).max(0.0);
                let r = (u / pad).abs().powf(2.4) + y0 * y0;
                if r < 1.0 {
                    skin.map(|c| c * (1.0 - 0.35 * r * r) * (1.0 + 0.04 * wave(2.0 * fx, 2.0 * fy)))
                } else {
                    back
                }
            }
        };
        *p = Rgb(c.map(|c| (c + noise * bell(&mut rng)).clamp(0.0, 255.0) as u8));
    }
    let image = image::imageops::blur(&image, rng.random_range(0.5..1.5));
    let image = DynamicImage::ImageRgb8(image);
    let image = if rng.random_bool(0.4) { image.grayscale() } else { image };
    Ok(Scene { image, truths: vec![], real: false })
}

/// A finger as on a phantom, photographed behind the nail.
fn skin_only(seed: u64, k: u32) -> anyhow::Result<Scene> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed ^ 0x5 ^ (u64::from(k) << 20));
    let subject = Subject::random(seed ^ 9, k);
    let mut camera = Camera::close_up(&mut rng, [320, 240], subject.nail.aspect, 0.6, 30.0);
    let distal = camera.axis.distal();
    let far = camera.nail_width_px * subject.nail.aspect * rng.random_range(1.6..2.5);
    camera.centre_px = [0, 1].map(|i| camera.centre_px[i] + far * distal[i]);
    camera.background = Background::random(&mut rng);
    let light = Light::random(&mut rng);
    let scene = NailScene { subject, pose: Pose::Nominal, light, camera };
    let options =
        RenderOptions { depth: Depth::Eight, grey: rng.random_bool(0.5), noise_sd: 1.5, noise_seed: u64::from(k) };
    Ok(Scene { image: scene.render(&options)?, truths: vec![], real: false })
}

/// A photograph of hands as it is or otherwise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Look {
    Plain,
    Mirrored,
    /// A quarter turn, at three quarters of the size.
    Turned,
    /// The green channel.
    Grey,
}

impl Look {
    fn of(self, image: &DynamicImage) -> DynamicImage {
        match self {
            Self::Plain => image.clone(),
            Self::Mirrored => image.fliph(),
            Self::Turned => {
                let turned = image.rotate90();
                let [w, h] = [turned.width(), turned.height()].map(|s| s * 3 / 4);
                turned.resize_exact(w, h, image::imageops::FilterType::Triangle)
            }
            Self::Grey => {
                let rgb = image.to_rgb8();
                let green = |x, y| Luma([rgb.get_pixel(x, y)[1]]);
                DynamicImage::ImageLuma8(GrayImage::from_fn(rgb.width(), rgb.height(), green))
            }
        }
    }
}

/// Annotated photographs of hands (`images/` and, of the same names, `masks/`), every other one from the first (`odd`
/// 0) or the second (1) on.
pub(super) fn hands(folder: &Path, odd: usize, look: Look) -> anyhow::Result<Vec<Scene>> {
    let named = |path: &Path| path.display().to_string();
    let pictures = folder.join("images");
    let entries = std::fs::read_dir(&pictures).with_context(|| named(&pictures))?;
    let mut files = entries.map(|entry| Ok(entry?.path())).collect::<anyhow::Result<Vec<_>>>()?;
    files.sort();
    let scene = |file: PathBuf| {
        let open = |file: &Path| image::open(file).with_context(|| named(file));
        let image = look.of(&open(&file)?);
        let mask = open(&folder.join("masks").join(file.file_name().unwrap_or_default()))?.to_luma8();
        // JPEG leaves values between: the threshold comes before any resampling does more of it.
        let mask = imageproc::contrast::threshold(&mask, 127, imageproc::contrast::ThresholdType::Binary);
        let mask = if look == Look::Grey { mask } else { look.of(&mask.into()).to_luma8() };
        let truths = outlines(&mask).into_iter().map(|outline| Truth { outline, up: None }).collect();
        Ok(Scene { image, truths, real: true })
    };
    files.into_iter().skip(odd).step_by(2).map(scene).collect()
}

/// Outlines of a mask's regions, along the edges of its pixels to a quarter of a pixel.
fn outlines(mask: &GrayImage) -> Vec<Outline> {
    const FINE: u32 = 4;
    let large = GrayImage::from_fn((mask.width() + 2) * FINE, (mask.height() + 2) * FINE, |x, y| {
        let (x, y) = ((x / FINE).wrapping_sub(1), (y / FINE).wrapping_sub(1));
        Luma([if x < mask.width() && y < mask.height() && mask.get_pixel(x, y)[0] > 127 { 255 } else { 0 }])
    });
    let back = |v: i32| (f64::from(v) + 0.5) / f64::from(FINE) - 1.5;
    imageproc::contours::find_contours::<i32>(&large)
        .into_iter()
        .filter(|c| c.border_type == imageproc::contours::BorderType::Outer)
        .filter_map(|c| Outline::new(&c.points.iter().map(|p| [back(p.x), back(p.y)]).collect::<Vec<_>>()).ok())
        .filter(|outline| outline.area_px2() > 60.0)
        .collect()
}

/// About a normal number of SD 1.
pub(super) fn bell(rng: &mut ChaCha8Rng) -> f64 {
    ((0..6).map(|_| rng.random::<f64>()).sum::<f64>() - 3.0) * 1.414
}

/// Phantoms, three quarters as many pictures without nails, and hands where there are any.
pub(super) fn scenes(count: u32, seed: u64, folder: Option<&Path>, looks: &[Look]) -> anyhow::Result<Vec<Scene>> {
    let mut all = (0..count).into_par_iter().map(|k| phantom(seed, k)).collect::<anyhow::Result<Vec<_>>>()?;
    let empty = (0..count * 3 / 4).into_par_iter().map(|k| empty(seed, k));
    all.extend(empty.collect::<anyhow::Result<Vec<_>>>()?);
    for look in looks {
        all.extend(folder.map(|folder| hands(folder, 0, *look)).transpose()?.unwrap_or_default());
    }
    Ok(all)
}

pub(super) fn ends(scene: &Scene, most: usize) -> Vec<(Frame, f64)> {
    finger_ends(&levels(scene), most)
}

/// The working picture of a scene.
pub(super) fn levels(scene: &Scene) -> Levels {
    Levels::of(&scene.image, DetectOptions::default().working_size_px)
}

/// Clockwise angle on the picture from one direction to another.
pub(super) fn turn_between(frame_up: [f64; 2], up: [f64; 2]) -> f64 {
    let cross = frame_up[0] * up[1] - frame_up[1] * up[0];
    let dot = frame_up[0] * up[0] + frame_up[1] * up[1];
    cross.atan2(dot)
}

/// Truth directions of real nails: the finger end around them.
pub(super) fn direct(scene: &mut Scene) {
    let tips = ends(scene, 40);
    for truth in &mut scene.truths {
        if truth.up.is_some() {
            continue;
        }
        let points = truth.outline.points();
        let n = points.len() as f64;
        let centre = [0, 1].map(|i| points.iter().map(|p| p[i]).sum::<f64>() / n);
        let size = truth.outline.area_px2().sqrt();
        truth.up = tips
            .iter()
            .filter(|(f, _)| {
                let c = f.source_to_own(centre);
                let s = size / f.unit_px;
                c[0].abs() < 0.25 && (c[1] + 0.5).abs() < 0.3 && (0.45..1.0).contains(&s)
            })
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(f, _)| f.up);
    }
}
