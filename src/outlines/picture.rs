//! Photographs at hand, and what is shown of them: the part around a nail, and the nail as it would come out.

use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use image::codecs::jpeg::JpegEncoder;
use image::{DynamicImage, ExtendedColorType};

use super::shape::NailShape;
use crate::photo::{MOST_MEGAPIXELS, NailFrame, Normalization, Normalizer, Photograph, Scratch, normalized_or_why};
use crate::vision::resized;

/// Photographs that are kept: the one that is seen, the one before it, the next.
const KEPT: usize = 3;
/// Larger ones are kept one at a time, megapixels.
const LARGE: f64 = 60.0;
/// Longest side of a part that is shown, pixels: a screen's height.
const SHOWN_PX: u32 = 1000;
/// Half the part around a nail, in its longer sides.
const AROUND: f64 = 1.1;
const QUALITY: u8 = 92;

/// A part of a photograph, whole pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub(super) struct View {
    pub(super) x: u32,
    pub(super) y: u32,
    pub(super) width: u32,
    pub(super) height: u32,
}

impl View {
    pub(super) fn whole([width, height]: [u32; 2]) -> Self {
        Self { x: 0, y: 0, width, height }
    }

    /// Around a nail, as far as the photograph goes.
    pub(super) fn around(shape: &NailShape, size: [u32; 2]) -> Self {
        let NailFrame { center_px, length_px, width_px, .. } = shape.frame();
        let reach = AROUND * length_px.max(width_px).max(8.0);
        let range = |k: usize| {
            let last = f64::from(size[k]);
            let low = (center_px[k] - reach).floor().clamp(0.0, last - 1.0);
            let high = (center_px[k] + reach).ceil().clamp(low + 1.0, last);
            (low as u32, (high - low) as u32)
        };
        let ((x, width), (y, height)) = (range(0), range(1));
        Self { x, y, width, height }
    }

    /// Whether the nail is still seen well in it.
    pub(super) fn serves(&self, shape: &NailShape, size: [u32; 2]) -> bool {
        let ideal = Self::around(shape, size);
        let inside = |at: f64, low: u32, length: u32, last: u32| {
            let [from, to] = [f64::from(low), f64::from(low + length)];
            let edge = 0.03 * f64::from(length);
            (at >= from + edge || low == 0) && (at <= to - edge || low + length == last)
        };
        let seen =
            |[x, y]: &[f64; 2]| inside(*x, self.x, self.width, size[0]) && inside(*y, self.y, self.height, size[1]);
        let larger = f64::from(self.width.max(self.height)) / f64::from(ideal.width.max(ideal.height));
        shape.points.iter().all(seen) && larger <= 2.0
    }
}

/// Photographs that were read.
#[derive(Debug)]
pub(super) struct Pictures {
    most_megapixels: u32,
    white: Option<u16>,
    kept: Mutex<Vec<(usize, Arc<Photograph>)>>,
    /// One is read at a time: the one that is needed does not take its memory twice.
    reading: Mutex<()>,
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Pictures {
    pub(super) fn new(max_megapixels: Option<u32>, white: Option<u16>) -> Self {
        let most_megapixels = max_megapixels.unwrap_or(MOST_MEGAPIXELS);
        Self { most_megapixels, white, kept: Mutex::default(), reading: Mutex::default() }
    }

    /// The photograph `number`, from memory or from its file.
    pub(super) fn get(&self, number: usize, path: &Path) -> Result<Arc<Photograph>, String> {
        if let Some(known) = self.known(number) {
            return Ok(known);
        }
        let _one_at_a_time = locked(&self.reading);
        if let Some(known) = self.known(number) {
            return Ok(known);
        }
        let picture = Arc::new(self.read(path)?);
        let mut kept = locked(&self.kept);
        let is_large = |one: &Photograph| f64::from(one.image.width()) * f64::from(one.image.height()) > LARGE * 1e6;
        if is_large(&picture) {
            kept.clear();
        }
        kept.truncate(KEPT - 1);
        kept.insert(0, (number, Arc::clone(&picture)));
        Ok(picture)
    }

    /// A photograph that is not kept.
    pub(super) fn read(&self, path: &Path) -> Result<Photograph, String> {
        let mut picture = Photograph::read_up_to(path, self.most_megapixels).map_err(|why| why.to_string())?;
        if let Some(white) = self.white {
            picture.stretch_to(white).map_err(|why| why.to_string())?;
        }
        Ok(picture)
    }

    fn known(&self, number: usize) -> Option<Arc<Photograph>> {
        let mut kept = locked(&self.kept);
        let at = kept.iter().position(|(one, _)| *one == number)?;
        kept[..=at].rotate_right(1);
        Some(Arc::clone(&kept[0].1))
    }
}

/// A part of a photograph as a JPEG, no larger than a screen.
pub(super) fn jpeg_of(picture: &Photograph, view: View) -> Result<Vec<u8>, String> {
    let View { x, y, width, height } = view;
    let part = match &picture.image {
        // Without a copy in between of what may be large.
        DynamicImage::ImageRgb8(rgb) => image::imageops::crop_imm(rgb, x, y, width, height).to_image(),
        other => other.crop_imm(x, y, width, height).to_rgb8(),
    };
    let scale = (f64::from(SHOWN_PX) / f64::from(width.max(height))).min(1.0);
    let size = [width, height].map(|side| ((f64::from(side) * scale).round() as usize).max(1));
    let from = [width as usize, height as usize];
    let part =
        if size == from { part.into_raw() } else { resized(&part, from, size).map_err(|why| why.to_string())? };
    let mut jpeg = Vec::new();
    JpegEncoder::new_with_quality(&mut jpeg, QUALITY)
        .encode(&part, size[0] as u32, size[1] as u32, ExtendedColorType::Rgb8)
        .map_err(|why| why.to_string())?;
    Ok(jpeg)
}

/// The nail as `lunula photos` would make it, as a PNG; `Err` is why it would be left out.
pub(super) fn normalized_png(picture: &Photograph, shape: &NailShape, with: &Normalization) -> Result<Vec<u8>, String> {
    let outline = shape.outline().map_err(|fault| fault.to_string())?;
    let frame = NailFrame::new(&outline, shape.axis).map_err(|fault| fault.to_string())?;
    let normalized = normalized_or_why(&picture.image, &frame, with, &mut Normalizer::default())?;
    let mut scratch = Scratch::default();
    scratch.png_of(&normalized, picture.depth()).map(<[u8]>::to_vec).map_err(|why| why.to_string())
}
