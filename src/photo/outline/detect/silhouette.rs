//! Silhouettes that may be fingers or hands: masks of a working picture by several plain rules.
//!
//! No single rule finds the skin in every light, so several are tried and whatever they yield is only a place to look:
//! colour (redder than green, greener than blue), colour and brightness, brightness alone, and colour cut along strong
//! edges, which parts fingers that lie on skin.

use image::GrayImage;
use imageproc::contrast::otsu_level;
use imageproc::distance_transform::Norm;
use imageproc::morphology::open;

use super::picture::{Picture, Plane};

/// ln(R/G) of skin in any common light.
const RED: std::ops::Range<f32> = 0.08..1.1;
/// ln(G/B) of skin in any common light.
const YELLOW: std::ops::Range<f32> = -0.25..0.9;
/// Darkest ln(green) of skin that is looked at.
const DARK: f32 = -2.7;
/// How much darker, in ln(green), the skin's shaded parts may be than its median.
const SHADE: f32 = 0.7;
/// Relative step a pixel that parts two fingers.
const CUT: f32 = 0.09;

/// Masks (255 inside), the likeliest rule first.
pub(super) fn silhouettes(picture: &Picture) -> Vec<GrayImage> {
    let tone = &picture.tone;
    let size = (tone.width(), tone.height());
    let mut masks = Vec::new();
    if let Some([red, yellow]) = &picture.chroma {
        let skin: Vec<bool> = (0..tone.as_raw().len())
            .map(|i| {
                RED.contains(&red.as_raw()[i]) && YELLOW.contains(&yellow.as_raw()[i]) && tone.as_raw()[i] > DARK
            })
            .collect();
        let of = |plane: &Plane| -> Vec<f32> {
            plane.as_raw().iter().zip(&skin).filter(|(_, s)| **s).map(|(v, _)| *v).collect()
        };
        masks.push(mask(size, |i| skin[i]));
        if let Some(median) = median(of(tone)) {
            masks.push(mask(size, |i| skin[i] && tone.as_raw()[i] > median - SHADE));
        }
        if let Some(level) = otsu(red.as_raw()) {
            masks.push(mask(size, |i| skin[i] && red.as_raw()[i] > level));
        }
        let steep = steepness(tone);
        masks.push(mask(size, |i| skin[i] && steep[i] < CUT));
    } else {
        let steep = steepness(tone);
        masks.push(mask(size, |i| tone.as_raw()[i] > DARK && steep[i] < CUT));
    }
    if let Some(level) = otsu(tone.as_raw()) {
        masks.push(mask(size, |i| tone.as_raw()[i] > level));
        if picture.chroma.is_none() {
            masks.push(mask(size, |i| tone.as_raw()[i] <= level));
        }
    }
    masks
}

fn mask(size: (u32, u32), inside: impl Fn(usize) -> bool) -> GrayImage {
    let raw = (0..(size.0 * size.1) as usize).map(|i| if inside(i) { 255 } else { 0 }).collect();
    let mask = GrayImage::from_raw(size.0, size.1, raw).expect("one value a pixel");
    open(&mask, Norm::L1, 1)
}

fn median(mut values: Vec<f32>) -> Option<f32> {
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f32::total_cmp).1)
}

/// Otsu's threshold of `values`; `None` where they are all alike.
fn otsu(values: &[f32]) -> Option<f32> {
    let (low, high) = values.iter().fold((f32::INFINITY, f32::NEG_INFINITY), |(l, h), &v| (l.min(v), h.max(v)));
    let range = high - low;
    if !(range > 1e-3) {
        return None;
    }
    let bytes: Vec<u8> = values.iter().map(|v| ((v - low) / range * 255.0) as u8).collect();
    let level = otsu_level(&GrayImage::from_raw(bytes.len() as u32, 1, bytes)?);
    Some(low + range * f32::from(level) / 255.0)
}

/// Largest absolute central difference at each pixel.
fn steepness(plane: &Plane) -> Vec<f32> {
    let (w, h) = (plane.width() as usize, plane.height() as usize);
    let v = plane.as_raw();
    let mut out = Vec::with_capacity(w * h);
    for y in 0..h {
        let (up, down) = (y.saturating_sub(1) * w, (y + 1).min(h - 1) * w);
        for x in 0..w {
            let dx = v[y * w + (x + 1).min(w - 1)] - v[y * w + x.saturating_sub(1)];
            let dy = v[down + x] - v[up + x];
            out.push(0.5 * dx.abs().max(dy.abs()));
        }
    }
    out
}
