//! Photographs at hand, and what is shown of them: the part around a nail, and the nail as it would come out.

use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use image::codecs::jpeg::JpegEncoder;
use image::{DynamicImage, ExtendedColorType, RgbImage};

use super::shape::NailShape;
use crate::photo::{
    Depth, MOST_MEGAPIXELS, NailFrame, Normalization, Normalizer, Photograph, Scratch, normalized_or_why,
};
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
/// Nails that are shorter or narrower on the part that is shown are normalized from the photograph itself: there they
/// would be blurred, or less than a nail (assumed).
const ROUGH_PX: f64 = 100.0;

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

/// A part of a photograph, no larger than a screen.
#[derive(Debug)]
pub(super) struct Shown {
    photo: usize,
    view: View,
    small: DynamicImage,
    pub(super) jpeg: Vec<u8>,
}

impl Shown {
    fn of(number: usize, photo: &Photograph, view: View) -> Result<Self, String> {
        let View { x, y, width, height } = view;
        let part = match &photo.image {
            // Without a copy in between of what may be large.
            DynamicImage::ImageRgb8(rgb) => image::imageops::crop_imm(rgb, x, y, width, height).to_image(),
            other => other.crop_imm(x, y, width, height).to_rgb8(),
        };
        let scale = (f64::from(SHOWN_PX) / f64::from(width.max(height))).min(1.0);
        let size = [width, height].map(|side| ((f64::from(side) * scale).round() as u32).max(1));
        let small = if size == [width, height] {
            part
        } else {
            let [from, to] = [[width, height], size].map(|sides| sides.map(|side| side as usize));
            let small = resized(&part, from, to).map_err(|why| why.to_string())?;
            RgbImage::from_raw(size[0], size[1], small).ok_or("a part of another size")?
        };
        let mut jpeg = Vec::new();
        JpegEncoder::new_with_quality(&mut jpeg, QUALITY)
            .encode(&small, size[0], size[1], ExtendedColorType::Rgb8)
            .map_err(|why| why.to_string())?;
        Ok(Self { photo: number, view, small: small.into(), jpeg })
    }

    /// A place of the photograph on it.
    fn place(&self, [x, y]: [f64; 2], [across, down]: [f64; 2]) -> [f64; 2] {
        let at = |value: f64, from: u32, scale: f64| (value + 0.5 - f64::from(from)) * scale - 0.5;
        [at(x, self.view.x, across), at(y, self.view.y, down)]
    }

    /// About what [`normalized_png`] makes, in a tenth of the time where the nail is large: for a look between two
    /// keys. `None` where the whole photograph is as quick, or shows more.
    pub(super) fn normalized(&self, photo: &Photograph, shape: &NailShape, with: &Normalization) -> Option<Png> {
        let scale = [
            f64::from(self.small.width()) / f64::from(self.view.width),
            f64::from(self.small.height()) / f64::from(self.view.height),
        ];
        let NailFrame { length_px, width_px, .. } = shape.frame();
        let is_small = length_px.min(width_px) * scale[0] < ROUGH_PX;
        if scale[0] == 1.0 || is_small || photo.image.color().has_alpha() {
            return None;
        }
        let points = shape.points.iter().map(|point| self.place(*point, scale)).collect();
        let shape = NailShape { points, axis: shape.axis };
        Some(png_of(&self.small, Depth::Eight, &shape, with))
    }
}

/// Parts that were shown, and the one that comes next.
#[derive(Debug, Default)]
pub(super) struct Parts(Mutex<Vec<Arc<Shown>>>);

impl Parts {
    pub(super) fn get(&self, number: usize, photo: &Photograph, view: View) -> Result<Arc<Shown>, String> {
        let is = |one: &Arc<Shown>| one.photo == number && one.view == view;
        let known = locked(&self.0).iter().find(|one| is(one)).cloned();
        if let Some(known) = known {
            return Ok(known);
        }
        let shown = Arc::new(Shown::of(number, photo, view)?);
        let mut kept = locked(&self.0);
        kept.truncate(KEPT - 1);
        kept.insert(0, Arc::clone(&shown));
        Ok(shown)
    }
}

/// A picture's bytes, or why a run would leave the nail out.
pub(super) type Png = Result<Vec<u8>, String>;

/// The nail as `lunula photos` would make it.
pub(super) fn normalized_png(photo: &Photograph, shape: &NailShape, with: &Normalization) -> Png {
    png_of(&photo.image, photo.depth(), shape, with)
}

fn png_of(image: &DynamicImage, depth: Depth, shape: &NailShape, with: &Normalization) -> Png {
    let outline = shape.outline().map_err(|fault| fault.to_string())?;
    let frame = NailFrame::new(&outline, shape.axis).map_err(|fault| fault.to_string())?;
    let normalized = normalized_or_why(image, (&outline, &frame), with, &mut Normalizer::default())?;
    let mut scratch = Scratch::default();
    scratch.png_of(&normalized, depth).map(<[u8]>::to_vec).map_err(|why| why.to_string())
}
