//! Where the weights come from: phantoms of every tone and light, pictures without nails, and photographs of hands.
//!
//! `LUNULA_TRAIN=1 cargo test --release --lib detect::training -- --ignored` rewrites `weights/*.txt`. The photographs are
//! those of even index in sorted order of the folder named by `LUNULA_HANDS` (`images/`, `masks/`); without it the
//! weights come from phantoms alone.

use image::{DynamicImage, GrayImage, Luma, Rgb, RgbImage};
use rand::{RngExt, SeedableRng, seq::SliceRandom};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::path::Path;

use super::net::{Net, softsign};
use super::patch::{Frame, Patch};
use super::picture::Levels;
use super::search::{FINGER, NAIL};
use super::shape::Shape;
use super::{evidence, refine};
use crate::phantom::nail::{Background, Camera, Depth, Light, NailScene, Pose, RenderOptions, Subject};
use crate::photo::outline::Outline;

/// A nail of a scene.
pub(super) struct Truth {
    pub(super) outline: Outline,
    /// Distal direction, where known.
    pub(super) up: Option<[f64; 2]>,
}

pub(super) struct Scene {
    pub(super) image: DynamicImage,
    pub(super) truths: Vec<Truth>,
    pub(super) real: bool,
}

fn bell(rng: &mut ChaCha8Rng) -> f64 {
    ((0..6).map(|_| rng.random::<f64>()).sum::<f64>() - 3.0) * 1.414
}

/// Phantom `k`: any tone, light, pose, turn up to 30 degrees, colour or grey.
pub(super) fn phantom(seed: u64, k: u32) -> Scene {
    let mut rng = ChaCha8Rng::seed_from_u64(seed ^ (u64::from(k) << 20));
    let subject = Subject::random(seed, k);
    let pose = Pose::ALL[rng.random_range(0..8)];
    let chamber = rng.random_bool(0.25);
    let light = if chamber { Light::random_chamber(&mut rng) } else { Light::random(&mut rng) };
    let size = *[[320, 240], [480, 360], [240, 320], [640, 480]].get(rng.random_range(0..4)).unwrap();
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
    let truth = Truth { outline: scene.outline().unwrap(), up };
    Scene { image: scene.render(&options).unwrap(), truths: vec![truth], real: false }
}

/// Pictures without nails.
pub(super) fn empty(seed: u64, k: u32) -> Scene {
    let mut rng = ChaCha8Rng::seed_from_u64(seed ^ 0xE ^ (u64::from(k) << 20));
    let (w, h) = (320u32, 240u32);
    let mut image = RgbImage::new(w, h);
    let back: [f64; 3] = std::array::from_fn(|_| rng.random_range(20.0..230.0));
    let skin = crate::phantom::nail::Tone::new(rng.random()).skin().map(|c| 255.0 * c * rng.random_range(0.55..1.0));
    let kind = k % 6;
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
            1 => {
                // Blobs of two colours.
                if wave(fx, fy) > 0.1 { other } else { back }
            }
            2 | 3 => {
                // One object, on a surface or on skin.
                let ground = if kind == 2 { back } else { skin.map(|c| c * (1.0 + 0.05 * wave(fx, fy))) };
                if (u / a).abs().powf(n) + (v / b).abs().powf(n) < 1.0 { other.map(|c| c * (1.0 + 0.1 * v / b)) } else { ground }
            }
            _ => {
                // A finger's pad (4) or an unbroken finger across the picture (5).
                let end = if kind == 4 { -pad * 0.8 } else { -1e3 };
                let begin = end + pad * 1.2;
                let y0 = ((begin - v) / (begin - end)).max(0.0);
                let r = (u / pad).abs().powf(2.4) + y0 * y0;
                if r < 1.0 { skin.map(|c| c * (1.0 - 0.35 * r * r) * (1.0 + 0.04 * wave(2.0 * fx, 2.0 * fy))) } else { back }
            }
        };
        *p = Rgb(c.map(|c| (c + noise * bell(&mut rng)).clamp(0.0, 255.0) as u8));
    }
    let image = image::imageops::blur(&image, rng.random_range(0.5..1.5));
    let image = DynamicImage::ImageRgb8(image);
    let image = if rng.random_bool(0.4) { image.grayscale() } else { image };
    Scene { image, truths: vec![], real: false }
}

/// Annotated photographs of hands; `odd` picks every other one.
pub(super) fn hands(folder: &Path, odd: usize, grey: bool) -> Vec<Scene> {
    let mut files: Vec<_> = std::fs::read_dir(folder.join("images")).unwrap().map(|e| e.unwrap().path()).collect();
    files.sort();
    files
        .into_iter()
        .skip(odd)
        .step_by(2)
        .map(|file| {
            let image = image::open(&file).unwrap();
            let image = if grey {
                let rgb = image.to_rgb8();
                DynamicImage::ImageLuma8(GrayImage::from_fn(rgb.width(), rgb.height(), |x, y| Luma([rgb.get_pixel(x, y)[1]])))
            } else {
                image
            };
            let mask = image::open(folder.join("masks").join(file.file_name().unwrap())).unwrap().to_luma8();
            let padded = GrayImage::from_fn(mask.width() + 2, mask.height() + 2, |x, y| {
                let inside = x > 0 && y > 0 && x <= mask.width() && y <= mask.height();
                Luma([if inside && mask.get_pixel(x - 1, y - 1)[0] > 127 { 255 } else { 0 }])
            });
            let truths = imageproc::contours::find_contours::<i32>(&padded)
                .into_iter()
                .filter(|c| c.border_type == imageproc::contours::BorderType::Outer && c.points.len() > 30)
                .filter_map(|c| {
                    let points: Vec<[f64; 2]> =
                        c.points.iter().map(|p| [f64::from(p.x) - 1.0, f64::from(p.y) - 1.0]).collect();
                    Outline::new(&points).ok().filter(|o| o.area_px2() > 60.0).map(|outline| Truth { outline, up: None })
                })
                .collect();
            Scene { image, truths, real: true }
        })
        .collect()
}

/// Is the point within the polygon?
fn within(points: &[[f64; 2]], p: [f64; 2]) -> bool {
    let mut inside = false;
    for (i, a) in points.iter().enumerate() {
        let b = points[(i + 1) % points.len()];
        if (a[1] > p[1]) != (b[1] > p[1]) && p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]) {
            inside = !inside;
        }
    }
    inside
}

/// Cells of a frame with whether the truth holds them.
struct Cells(Vec<([f64; 2], bool)>);

impl Cells {
    fn of(extent: super::patch::Extent, truth: Option<&[[f64; 2]]>) -> Self {
        let mut cells = Vec::new();
        let n = 44;
        for j in 0..n {
            for i in 0..n {
                let at = |e: [f64; 2], k: usize| e[0] + (e[1] - e[0]) * (k as f64 + 0.5) / n as f64;
                let p = [at(extent.x, i), at(extent.y, j)];
                cells.push((p, truth.is_some_and(|t| within(t, p))));
            }
        }
        Self(cells)
    }

    fn iou(&self, shape: &Shape) -> f64 {
        let (mut both, mut any) = (0u32, 0u32);
        for (p, truth) in &self.0 {
            let own = shape.holds(*p);
            both += u32::from(own && *truth);
            any += u32::from(own || *truth);
        }
        f64::from(both) / f64::from(any.max(1))
    }
}

fn jitter(s: &Shape, k: f64, rng: &mut ChaCha8Rng) -> Shape {
    let size = 0.5 * (s.length + s.width);
    Shape {
        x: s.x + 0.15 * k * size * bell(rng),
        y: s.y + 0.2 * k * size * bell(rng),
        length: s.length * (0.22 * k * bell(rng)).exp(),
        width: s.width * (0.18 * k * bell(rng)).exp(),
        turn: s.turn + 0.22 * k * bell(rng),
        taper: (s.taper + 0.05 * k * bell(rng)).clamp(-0.1, 0.2),
    }
}

/// The template nearest to a polygon of a frame whose distal direction is `turn` clockwise from the frame's +y.
fn nearest(points: &[[f64; 2]], turn: f64, cells: &Cells, rng: &mut ChaCha8Rng) -> (Shape, f64) {
    let (sin, cos) = turn.sin_cos();
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for p in points {
        let q = [p[0] * cos - p[1] * sin, p[0] * sin + p[1] * cos];
        for i in 0..2 {
            low[i] = low[i].min(q[i]);
            high[i] = high[i].max(q[i]);
        }
    }
    let m = [0, 1].map(|i| (low[i] + high[i]) / 2.0);
    let mut best = Shape {
        x: m[0] * cos + m[1] * sin,
        y: -m[0] * sin + m[1] * cos,
        length: high[1] - low[1],
        width: high[0] - low[0],
        turn,
        taper: 0.03,
    };
    let mut value: f64 = cells.iou(&best);
    for i in 0..120 {
        let next = jitter(&best, if i < 60 { 0.4 } else { 0.15 }, rng);
        let v = cells.iou(&next);
        if v > value {
            (best, value) = (next, v);
        }
    }
    (best, value)
}

/// Rows of a network's training set.
#[derive(Default)]
pub(super) struct Rows {
    pub(super) x: Vec<Vec<f32>>,
    pub(super) y: Vec<f32>,
}

impl Rows {
    /// Rows of every scene, each with its own random numbers.
    fn gather(scenes: &[Scene], seed: u64, rows: impl Fn(&Scene, &mut ChaCha8Rng, &mut Self) + Sync) -> Self {
        let parts: Vec<Self> = scenes
            .par_iter()
            .enumerate()
            .map(|(k, scene)| {
                let mut rng = ChaCha8Rng::seed_from_u64(seed + 1000 * k as u64);
                let mut part = Self::default();
                rows(scene, &mut rng, &mut part);
                part
            })
            .collect();
        let mut all = Self::default();
        for part in parts {
            all.x.extend(part.x);
            all.y.extend(part.y);
        }
        all
    }

    fn push(&mut self, x: &[f32], y: f64) {
        self.x.push(x.to_vec());
        self.y.push(y as f32);
    }
}

/// Adam on squared error (`logistic` false) or on the logistic loss.
pub(super) fn fit(rows: &Rows, hidden: usize, epochs: usize, logistic: bool, decay: f32, seed: u64) -> Net {
    let n = rows.x[0].len();
    let count = rows.x.len();
    let norm: Vec<[f32; 2]> = (0..n)
        .map(|i| {
            let mean = rows.x.iter().map(|r| f64::from(r[i])).sum::<f64>() / count as f64;
            let var = rows.x.iter().map(|r| (f64::from(r[i]) - mean).powi(2)).sum::<f64>() / count as f64;
            [mean as f32, (1.0 / (var.sqrt() + 1e-3)) as f32]
        })
        .collect();
    let z: Vec<Vec<f32>> =
        rows.x.iter().map(|r| r.iter().zip(&norm).map(|(v, m)| (v - m[0]) * m[1]).collect()).collect();
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut w: Vec<f32> = (0..(n + 1) * hidden).map(|_| (bell(&mut rng) / (n as f64).sqrt()) as f32).collect();
    w.extend((0..hidden).map(|_| (bell(&mut rng) / (hidden as f64).sqrt()) as f32));
    w.push(0.0);
    let (mut m, mut v) = (vec![0.0f32; w.len()], vec![0.0f32; w.len()]);
    let mut order: Vec<usize> = (0..count).collect();
    let batch = 64;
    let mut t = 0;
    let split = (n + 1) * hidden;
    for epoch in 0..epochs {
        order.shuffle(&mut rng);
        let rate = 3e-3 * (1.0 - epoch as f32 / epochs as f32) + 5e-5;
        for part in order.chunks(batch) {
            let mut g: Vec<f32> =
                w.iter().enumerate().map(|(i, w)| if i < split { decay * w } else { 0.0 }).collect();
            let scale = 1.0 / part.len() as f32;
            for &i in part {
                let x = &z[i];
                let pre: Vec<f32> = w[..split]
                    .chunks_exact(n + 1)
                    .map(|u| u[n] + u[..n].iter().zip(x).map(|(a, b)| a * b).sum::<f32>())
                    .collect();
                let out = w[split + hidden]
                    + pre.iter().zip(&w[split..]).map(|(p, w)| softsign(*p) * w).sum::<f32>();
                let e = scale * if logistic { 1.0 / (1.0 + (-out).exp()) - rows.y[i] } else { out - rows.y[i] };
                g[split + hidden] += e;
                for k in 0..hidden {
                    g[split + k] += e * softsign(pre[k]);
                    let d = e * w[split + k] / (1.0 + pre[k].abs()).powi(2);
                    let unit = &mut g[k * (n + 1)..(k + 1) * (n + 1)];
                    unit[n] += d;
                    for (g, x) in unit[..n].iter_mut().zip(x) {
                        *g += d * x;
                    }
                }
            }
            t += 1;
            let (c1, c2) = (1.0 - 0.9f32.powi(t), 1.0 - 0.999f32.powi(t));
            for i in 0..w.len() {
                m[i] = 0.9 * m[i] + 0.1 * g[i];
                v[i] = 0.999 * v[i] + 0.001 * g[i] * g[i];
                w[i] -= rate * (m[i] / c1) / ((v[i] / c2).sqrt() + 1e-8);
            }
        }
    }
    Net { inputs: n, hidden, norm, first: w[..split].to_vec(), second: w[split..].to_vec() }
}

fn rms(net: &Net, rows: &Rows) -> f32 {
    (rows.x.iter().zip(&rows.y).map(|(x, y)| (net.answer(x) - y).powi(2)).sum::<f32>() / rows.y.len() as f32).sqrt()
}

fn text(net: &Net) -> String {
    let mut out = format!("{} {}\n", net.inputs, net.hidden);
    for [a, b] in &net.norm {
        out += &format!("{a} {b}\n");
    }
    for w in net.first.iter().chain(&net.second) {
        out += &format!("{w}\n");
    }
    out
}

fn save(name: &str, net: &Net) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/photo/outline/detect/weights");
    std::fs::write(folder.join(name), text(net)).unwrap();
}

pub(super) fn scenes(count: u32, seed: u64, odd: usize) -> Vec<Scene> {
    let mut all: Vec<Scene> = (0..count).into_par_iter().map(|k| phantom(seed, k)).collect();
    all.par_extend((0..count / 2).into_par_iter().map(|k| empty(seed, k)));
    if let Ok(folder) = std::env::var("LUNULA_HANDS") {
        all.extend(hands(Path::new(&folder), odd, false));
        all.extend(hands(Path::new(&folder), odd, true));
    }
    all
}

fn ends(scene: &Scene, most: usize) -> Vec<(Frame, f64)> {
    super::ends(&levels(scene), most)
}

fn levels(scene: &Scene) -> Levels {
    Levels::of(&scene.image, super::DetectOptions::default().working_size_px)
}

fn turn_between(frame_up: [f64; 2], up: [f64; 2]) -> f64 {
    // Clockwise on the picture from frame_up to up.
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
                let c = f.from_source(centre);
                let s = size / f.unit_px;
                c[0].abs() < 0.25 && (c[1] + 0.5).abs() < 0.3 && (0.45..1.0).contains(&s)
            })
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(f, _)| f.up);
    }
}

fn scorer_rows(scene: &Scene, rng: &mut ChaCha8Rng, rows: &mut Rows) {
    let real = scene.real;
    let levels = levels(scene);
    // In fingers' frames.
    for (frame, _) in ends(scene, if real { 40 } else { 6 }) {
        let patch = Patch::cut(&levels, frame, FINGER);
        let truth = scene
            .truths
            .iter()
            .map(|t| (t, t.outline.points().iter().map(|p| frame.from_source(*p)).collect::<Vec<_>>()))
            .map(|(t, points)| {
                let cells = Cells::of(FINGER, Some(&points));
                let under = cells.0.iter().filter(|(p, t)| *t && p[0].abs() < 0.4 && (-1.1..0.1).contains(&p[1])).count();
                (t, points, cells, under)
            })
            .max_by_key(|t| t.3)
            .filter(|t| t.3 > 25);
        let mean = Shape { x: 0.0, y: -0.5, length: 0.75, width: 0.65, turn: 0.0, taper: 0.04 };
        match truth {
            Some((t, points, cells, _)) => {
                let turn = t.up.map_or(0.0, |up| turn_between(frame.up, up));
                let (best, _) = nearest(&points, turn, &cells, rng);
                let count = if real { 40 } else { 16 };
                for i in 0..count {
                    let from = if i % 3 == 0 { mean } else { best };
                    let s = jitter(&from, [0.15, 0.35, 0.7, 1.2][i % 4], rng);
                    let off = (s.turn - turn).cos();
                    let worth = if off > 0.3 { 1.0 } else { 0.5 };
                    rows.push(&evidence::inputs(&patch, &s, true), cells.iou(&s) * worth);
                }
            }
            None => {
                for i in 0..if real { 12 } else { 8 } {
                    let s = jitter(&mean, [0.5, 1.0][i % 2], rng);
                    rows.push(&evidence::inputs(&patch, &s, true), 0.0);
                }
            }
        }
    }
    // In nails' frames, either way up.
    for t in &scene.truths {
        let Some(up) = t.up else { continue };
        let points = t.outline.points();
        let n = points.len() as f64;
        let centre = [0, 1].map(|i| points.iter().map(|p| p[i]).sum::<f64>() / n);
        let size = t.outline.area_px2().sqrt() * 1.1;
        for _ in 0..3 {
            let angle = 0.3 * bell(rng) + if rng.random_bool(0.3) { std::f64::consts::PI } else { 0.0 };
            let (s, c) = angle.sin_cos();
            let frame = Frame {
                origin: [centre[0] + 0.1 * size * bell(rng), centre[1] + 0.1 * size * bell(rng)],
                up: [up[0] * c - up[1] * s, up[0] * s + up[1] * c],
                unit_px: size * (0.15 * bell(rng)).exp(),
            };
            let patch = Patch::cut(&levels, frame, NAIL);
            let own: Vec<_> = points.iter().map(|p| frame.from_source(*p)).collect();
            let cells = Cells::of(NAIL, Some(&own));
            let turn = turn_between(frame.up, up);
            let (best, _) = nearest(&own, turn, &cells, rng);
            for i in 0..if real { 14 } else { 12 } {
                let mut shape = jitter(&best, [0.12, 0.3, 0.6, 1.2][i % 4], rng);
                let mut worth = 1.0;
                if i % 3 == 2 {
                    shape.turn += std::f64::consts::PI;
                    shape.taper = -shape.taper;
                    worth = 0.6;
                }
                rows.push(&evidence::inputs(&patch, &shape, false), worth * cells.iou(&shape));
            }
        }
    }
    // Anywhere, where there is nothing.
    if scene.truths.is_empty() {
        let (w, h) = (f64::from(scene.image.width()), f64::from(scene.image.height()));
        let mut places: Vec<Frame> = (0..4)
            .map(|_| Frame {
                origin: [w * rng.random_range(0.2..0.8), h * rng.random_range(0.2..0.8)],
                up: [0.0, -1.0],
                unit_px: h * rng.random_range(0.25..0.8),
            })
            .collect();
        let (patch, found) = super::search::anywhere(&levels, 6);
        places.extend(found.iter().map(|(s, _)| Frame {
            origin: patch.frame.to_source([s.x, s.y]),
            up: { let (sin, cos) = s.turn.sin_cos(); [sin, -cos] },
            unit_px: s.length * patch.frame.unit_px,
        }));
        for frame in places {
            let patch = Patch::cut(&levels, frame, NAIL);
            for i in 0..6 {
                let base = Shape { x: 0.0, y: 0.0, length: 1.0, width: 0.85, turn: 0.0, taper: 0.03 };
                let s = jitter(&base, [0.2, 0.8][i % 2], rng);
                rows.push(&evidence::inputs(&patch, &s, false), 0.0);
            }
        }
    }
}

/// What the search with the present weights takes for nails, rightly or not.
fn found_rows(scene: &Scene, rng: &mut ChaCha8Rng, rows: &mut Rows) {
    let levels = levels(scene);
    let truths = |frame: &Frame| -> Vec<(Vec<[f64; 2]>, f64)> {
        scene
            .truths
            .iter()
            .map(|t| {
                let points = t.outline.points().iter().map(|p| frame.from_source(*p)).collect();
                (points, t.up.map_or(f64::NAN, |up| turn_between(frame.up, up)))
            })
            .collect()
    };
    let take = |patch: &Patch, shape: &Shape, tip: bool, rows: &mut Rows| {
        let worth = truths(&patch.frame)
            .iter()
            .map(|(points, turn)| {
                let iou = Cells::of(patch.extent, Some(points)).iou(shape);
                // Unknown directions count as the finger's.
                if turn.is_nan() || (shape.turn - turn).cos() > 0.3 { iou } else { 0.5 * iou }
            })
            .fold(0.0, f64::max);
        rows.push(&evidence::inputs(patch, shape, tip), worth);
    };
    for (frame, _) in ends(scene, 12) {
        let patch = Patch::cut(&levels, frame, FINGER);
        let coarse = super::search::on_finger(&patch, 3);
        coarse.iter().for_each(|(s, _)| take(&patch, s, true, rows));
        for (shape, _) in coarse.into_iter().map(|s| super::search::polish(&patch, s, true)) {
            for k in [0.0, 0.15, 0.3] {
                take(&patch, &jitter(&shape, k, rng), true, rows);
            }
        }
    }
    if scene.real {
        return;
    }
    let (coarse, found) = super::search::anywhere(&levels, 10);
    for (shape, _) in found {
        take(&coarse, &shape, false, rows);
        let (nail, template) = super::candidate::own_frame(coarse.frame, &shape);
        let patch = Patch::cut(&levels, nail, NAIL);
        let (better, _) = super::search::polish(&patch, (template, evidence::score(&patch, &template, false)), false);
        for k in [0.0, 0.15, 0.3] {
            take(&patch, &jitter(&better, k, rng), false, rows);
        }
    }
}

fn border_rows(scene: &Scene, rng: &mut ChaCha8Rng, rows: &mut Rows) {
    let levels = levels(scene);
    for t in &scene.truths {
        let Some(up) = t.up else { continue };
        let points = t.outline.points();
        let n = points.len() as f64;
        let centre = [0, 1].map(|i| points.iter().map(|p| p[i]).sum::<f64>() / n);
        let size = t.outline.area_px2().sqrt() * 1.1;
        let angle = 0.12 * bell(rng);
        let (s, c) = angle.sin_cos();
        let frame = Frame { origin: centre, up: [up[0] * c - up[1] * s, up[0] * s + up[1] * c], unit_px: size };
        let own: Vec<_> = points.iter().map(|p| frame.from_source(*p)).collect();
        let cells = Cells::of(NAIL, Some(&own));
        let (best, v) = nearest(&own, turn_between(frame.up, up), &cells, rng);
        if v < 0.75 {
            continue;
        }
        let sd = if scene.real { 2.2 } else { 1.0 };
        for _ in 0..2 {
            let base = jitter(&best, 0.35, rng);
            let band = refine::Band::around(&levels, &frame, &base);
            for k in (rng.random_range(0..3)..refine::RAYS).step_by(if scene.real { 2 } else { 4 }) {
                let (p, nrm) = band.rays[k];
                let at = |m: f64| {
                    let d = (m - refine::SIDE as f64) * refine::STEP * band.half;
                    within(&own, [p[0] + d * nrm[0], p[1] + d * nrm[1]])
                };
                let places = 2 * refine::SIDE;
                let Some(cross) = (0..places).find(|&m| at(m as f64) && !at(m as f64 + 1.0)) else { continue };
                let exact = (0..10).map(|i| cross as f64 + f64::from(i) / 10.0).take_while(|m| at(*m)).last().unwrap_or(cross as f64);
                for i in 0..7 {
                    let m = match i {
                        0 | 1 => exact.round() as i64,
                        2 => exact.round() as i64 + rng.random_range(-2..=2),
                        3 => exact.round() as i64 + rng.random_range(-6..=6),
                        _ => rng.random_range(0..=places as i64),
                    };
                    let m = m.clamp(0, places as i64) as usize;
                    let off = (m as f64 - exact) / sd;
                    rows.push(&band.inputs(k, m), (-off * off / 2.0).exp());
                }
            }
        }
    }
}

#[test]
#[ignore = "rewrites the weights; takes minutes"]
fn train() {
    let stage = std::env::var("LUNULA_TRAIN").unwrap_or_default();
    let count = std::env::var("LUNULA_COUNT").ok().and_then(|c| c.parse().ok()).unwrap_or(400);
    let mut all = scenes(count, 1000, 0);
    all.par_iter_mut().for_each(direct);
    let known: usize = all.iter().filter(|s| s.real).flat_map(|s| &s.truths).filter(|t| t.up.is_some()).count();
    eprintln!("{} scenes, {known} real nails with a direction", all.len());
    if stage.contains("scorer") || stage.contains("border") {
        rayon::join(
            || {
                if stage.contains("scorer") {
                    let rows = Rows::gather(&all, 1, |s, rng, rows| {
                        scorer_rows(s, rng, rows);
                        if !stage.contains("first") {
                            found_rows(s, rng, rows);
                        }
                    });
                    let net = fit(&rows, 20, 20, false, 1e-5, 1);
                    eprintln!("scorer: {} rows, RMS {}", rows.x.len(), rms(&net, &rows));
                    save("scorer.txt", &net);
                }
            },
            || {
                if stage.contains("border") {
                    let rows = Rows::gather(&all, 2, border_rows);
                    let net = fit(&rows, 14, 14, true, 1e-5, 2);
                    eprintln!("border: {} rows", rows.x.len());
                    save("border.txt", &net);
                }
            },
        );
    }
    if stage.contains("judge") {
        // Other phantoms than the other two networks have seen.
        let mut fresh = scenes(count, 2000, 0);
        fresh.par_iter_mut().for_each(direct);
        let rows = Rows::gather(&fresh, 3, |s, _, rows| {
            for c in super::follow_all(&levels(s), super::leads(&levels(s)), 16) {
                let worth = s
                    .truths
                    .iter()
                    .map(|t| {
                        let d = c.axis.distal();
                        let right = t.up.is_none_or(|up| d[0] * up[0] + d[1] * up[1] > 0.6);
                        if right { t.outline.iou(&c.outline) } else { 0.0 }
                    })
                    .fold(0.0, f64::max);
                let (at, soft) = if s.real { (0.75, 0.04) } else { (0.82, 0.02) };
                for _ in 0..if s.real { 2 } else { 1 } {
                    rows.push(&c.figures, 1.0 / (1.0 + (-(worth - at) / soft).exp()));
                }
            }
        });
        eprintln!("{} rows", rows.x.len());
        let net = fit(&rows, 10, 60, true, 1e-4, 3);
        save("judge.txt", &net);
    }
}
