//! Silhouettes that may be fingers or hands: masks of a working picture by several plain rules.
//!
//! No single rule finds the skin in every light, so several are tried and whatever they yield is only a place to look:
//! colour (redder than green, greener than blue), colour and brightness, brightness alone, and colour cut along strong
//! edges, which parts fingers that lie on skin.

use image::GrayImage;

use super::super::picture::{self, Picture, TONE, YELLOW};
use crate::median::median_of;
use crate::vision::{Cell, opened, otsu_level};

/// ln(R/G) of skin in any common light.
const RED: std::ops::Range<f32> = 0.08..1.1;
/// ln(G/B) of skin in any common light.
const YELLOWS: std::ops::Range<f32> = -0.25..0.9;
/// Darkest ln(green) of skin that is looked at.
const DARK: f32 = -2.7;
/// How much darker, in ln(green), the skin's shaded parts may be than its median.
const SHADE: f32 = 0.7;
/// Relative step a pixel that parts two fingers.
const CUT: f32 = 0.09;

/// Masks (255 inside), the likeliest rule first.
pub(in super::super) fn silhouettes(picture: &Picture) -> Vec<GrayImage> {
    let cells = &picture.cells;
    let tone: Vec<f32> = cells.iter().map(|c| c[TONE]).collect();
    let steep = steepness(&tone, picture.size);
    let mut masks = Vec::new();
    let mut add = |inside: &dyn Fn(usize) -> bool| masks.push(mask(picture.size, inside));
    if picture.colour {
        let is_skin = |c: &Cell| RED.contains(&c[picture::RED]) && YELLOWS.contains(&c[YELLOW]) && c[TONE] > DARK;
        let skin: Vec<bool> = cells.iter().map(is_skin).collect();
        add(&|i| skin[i]);
        if let Some(median) = median_of(cells.iter().filter(|c| is_skin(c)).map(|c| c[TONE])) {
            add(&|i| skin[i] && tone[i] > median - SHADE);
        }
        let red: Vec<f32> = cells.iter().map(|c| c[picture::RED]).collect();
        if let Some(level) = otsu(&red) {
            add(&|i| skin[i] && red[i] > level);
        }
        add(&|i| skin[i] && steep[i] < CUT);
    } else {
        add(&|i| tone[i] > DARK && steep[i] < CUT);
    }
    if let Some(level) = otsu(&tone) {
        add(&|i| tone[i] > level);
        if !picture.colour {
            add(&|i| tone[i] <= level);
        }
    }
    masks
}

fn mask(size: [usize; 2], inside: &dyn Fn(usize) -> bool) -> GrayImage {
    let mask: Vec<u8> = (0..size[0] * size[1]).map(|i| if inside(i) { 255 } else { 0 }).collect();
    let mask = opened(&mask, size, 1);
    GrayImage::from_raw(size[0] as u32, size[1] as u32, mask).expect("one value a pixel")
}

/// Otsu's threshold of `values`; `None` where they are all alike.
fn otsu(values: &[f32]) -> Option<f32> {
    let (low, high) = values.iter().fold((f32::INFINITY, f32::NEG_INFINITY), |(l, h), &v| (l.min(v), h.max(v)));
    let range = high - low;
    if range.is_nan() || range <= 1e-3 {
        return None;
    }
    let bytes: Vec<u8> = values.iter().map(|v| ((v - low) / range * 255.0) as u8).collect();
    let level = otsu_level(&bytes);
    Some(low + range * f32::from(level) / 255.0)
}

/// Largest absolute central difference at each pixel.
fn steepness(v: &[f32], [w, h]: [usize; 2]) -> Vec<f32> {
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
