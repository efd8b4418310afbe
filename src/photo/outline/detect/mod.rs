//! Finds the outlines of nails in photographs that nobody has annotated.
#![allow(missing_docs, unreachable_pub, dead_code)]
mod picture;
mod silhouette;
mod tips;
mod patch;
mod shape;
mod evidence;

use image::DynamicImage;

/// scratch
pub fn debug_tips(image: &DynamicImage, px: u32) -> Vec<([f64; 2], [f64; 2], f64, f64)> {
    let p = picture::Picture::whole(image, px);
    let all: Vec<_> = silhouette::silhouettes(&p).iter().flat_map(tips::tips).collect();
    let kept = tips::strongest(all, 40);
    kept.iter().map(|t| (p.to_source(t.apex), t.out, t.width * f64::from(p.step), t.fit)).collect()
}

/// scratch: training rows for a picture and mask: group, kind, iou, geometry(6), features
pub fn debug_rows(image: &DynamicImage, mask: &image::GrayImage, px: u32, out: &mut dyn FnMut(usize, f64, [f64; 6], &[f32])) {
    use rand::{Rng, RngExt, SeedableRng};
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(1);
    for (g, (apex, up, width, _)) in debug_tips(image, px).into_iter().enumerate() {
        let frame = patch::Frame { origin: apex, up, unit_px: width };
        let patch = patch::Patch::cut(image, frame, EXTENT);
        // mask in patch, only the component under the place where a nail would be
        let mut cells = Vec::new();
        for j in 0..patch.size[1] { for i in 0..patch.size[0] {
            let p = [EXTENT.x[0] + i as f64 / EXTENT.per_unit, EXTENT.y[1] - j as f64 / EXTENT.per_unit];
            let q = frame.to_source(p);
            let (x, y) = (q[0].round(), q[1].round());
            let m = x >= 0.0 && y >= 0.0 && (x as u32) < mask.width() && (y as u32) < mask.height() && mask.get_pixel(x as u32, y as u32)[0] > 0;
            cells.push((p, if m { mask.get_pixel(x as u32, y as u32)[0] } else { 0 }));
        } }
        let mut count = [0usize; 256];
        for (p, l) in &cells { if p[1] < 0.1 && p[1] > -1.0 && p[0].abs() < 0.3 { count[*l as usize] += 1; } }
        let label = (1..256).max_by_key(|&l| count[l]).filter(|&l| count[l] > 30).unwrap_or(999);
        let iou = |s: &shape::Shape| {
            let (mut both, mut any) = (0, 0);
            for (p, l) in &cells { let a = s.holds(*p); let b = usize::from(*l) == label; both += usize::from(a && b); any += usize::from(a || b); }
            if any == 0 { 0.0 } else { f64::from(both as u32) / f64::from(any as u32) }
        };
        let mean = shape::Shape { x: 0.0, y: -0.5, length: 0.75, width: 0.65, turn: 0.0, taper: 0.05 };
        let jit = |s: &shape::Shape, k: f64, rng: &mut rand_chacha::ChaCha8Rng| {
            let mut n = || { let v: f64 = (0..6).map(|_| rng.random::<f64>()).sum::<f64>() - 3.0; v * 1.4 * k };
            shape::Shape { x: s.x + 0.12 * n(), y: s.y + 0.15 * n(), length: (s.length * (0.25 * n()).exp()).clamp(0.35, 1.5), width: (s.width * (0.18 * n()).exp()).clamp(0.35, 1.1), turn: s.turn + 0.2 * n(), taper: (s.taper + 0.05 * n()).clamp(-0.1, 0.2) }
        };
        // best fit to mask by random descent
        let mut best = mean; let mut bi = iou(&best);
        if label != 999 { for t in 0..600 { let c = jit(&best, [1.0, 0.5, 0.2][t / 200], &mut rng); let v = iou(&c); if v > bi { best = c; bi = v; } } }
        let emit = |s: &shape::Shape, v: f64, out: &mut dyn FnMut(usize, f64, [f64; 6], &[f32])| {
            out(g, v, [s.x, s.y, s.length, s.width, s.turn, s.taper], &evidence::features(&patch, s));
        };
        emit(&best, bi, out);
        for t in 0..60 {
            let c = jit(if label != 999 && bi > 0.6 && t % 3 != 0 { &best } else { &mean }, [1.0, 0.5, 0.25, 0.7][t % 4], &mut rng);
            let v = iou(&c); emit(&c, v, out);
        }
    }
}
const EXTENT: patch::Extent = patch::Extent { x: [-0.8, 0.8], y: [-1.6, 0.35], per_unit: 48.0 };
