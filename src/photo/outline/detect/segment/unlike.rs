//! Whether the network sees a nail where somebody has drawn one.
//!
//! In: a photograph and outlines. Out: of each, whether the network surely sees another one there, or none. An outline
//! that was drawn on another frame of a film, or on a photograph that was replaced, gives results of skin; a person's
//! usual inaccuracy must not be doubted.

use image::DynamicImage;

use super::component::log_odds;
use super::{NailNet, overlapping};
use crate::photo::outline::{Moments, Outline};
use crate::photograph::as_rgb8;
use crate::vision::VisionError;

/// What the network sees instead of the outline that is drawn.
#[derive(Debug, Clone, PartialEq)]
pub enum Unlike {
    /// No nail.
    Nothing,
    /// A nail with this outline.
    Elsewhere(Outline),
}

/// IoU with the drawn outline below which another one is seen.
const AGREES: f64 = 0.7;
/// Least IoU of something that may be the nail which is drawn.
const NEAR: f64 = 0.08;
/// Mean probability of its cells from which a nail is seen surely, ..
const SURELY: f64 = 0.9;
/// .. and IoU with it of what is seen in a second window, around it.
const STAYS: f64 = 0.85;
/// Side of the square of a nail's area, pixels, from which a nail that isn't seen is none: of 127 drawn on real
/// photographs the network misses seven smaller ones.
const LARGE_PX: f64 = 30.0;

impl NailNet {
    /// What is seen instead of each outline on an upright photograph; `None` where nothing speaks against it, or there
    /// is none.
    pub fn unlike(
        &self,
        image: &DynamicImage,
        outlines: &[Option<&Outline>],
    ) -> Result<Vec<Option<Unlike>>, VisionError> {
        let rgb = &*as_rgb8(image);
        let look = |outline: &Outline| {
            let moments = Moments::of(outline);
            Ok::<_, VisionError>(overlapping(outline, self.look_at(rgb, moments.centroid_px, moments.major_px)?))
        };
        let one = |outline: &Option<&Outline>| {
            let Some(outline) = outline else { return Ok(None) };
            let Some((iou, seen)) = look(outline)?.filter(|(iou, _)| *iou >= NEAR) else {
                return Ok((outline.area_px2().sqrt() >= LARGE_PX).then_some(Unlike::Nothing));
            };
            if iou >= AGREES || seen.nail < log_odds(SURELY) {
                return Ok(None);
            }
            let stays = look(&seen.outline)?.is_some_and(|(iou, _)| iou >= STAYS);
            Ok(stays.then_some(Unlike::Elsewhere(seen.outline)))
        };
        outlines.iter().map(one).collect()
    }
}
