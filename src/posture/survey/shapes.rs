//! Which markers are discs and which are blots, and which may be neither.

use super::spots::SMALL_RADIUS_PX;
use super::{Start, Surveyor};

/// The outline of a disc has its radius but for this factor (measured: of phantoms, 4 to 11 px, 0.96 to 1.07; of
/// stickers put onto photographs of real hands 0.97 to 1.06; of thin paint or beside a fold, 1.35 to 2.0).
const OUTLINE_FACTOR: f64 = 1.2;
/// The standard error of a coordinate of a disc without any, in radii (measured on one of the skin's hue on such a
/// photograph: 0.20; said 0.03 until then).
const NO_OUTLINE: f64 = 0.25;
/// Where one in so many of the markers of a colour is a blot, the others are paint too, which a disc fits by chance
/// (measured on 20 films of yellow and white paint on pictures of skin, angles known: 0.45 degrees RMS, and 0.85 off in
/// the worst median; 0.54 and 2.2 where half of them have to be).
const OF_A_PAINT: usize = 4;

impl Start {
    /// By how much a coordinate of a disc may be off that has no outline, or a larger one.
    fn unclear_px(&self) -> Option<f64> {
        let radius_px = self.look.radius_px;
        let least = NO_OUTLINE * radius_px;
        match &self.as_blot {
            _ if self.look.blot.is_some() => None,
            None => (radius_px > SMALL_RADIUS_PX).then_some(least),
            Some(outline) if outline.radius_px > OUTLINE_FACTOR * radius_px => {
                Some((outline.radius_px - radius_px).max(least))
            }
            Some(_) => None,
        }
    }
}

impl Surveyor<'_> {
    /// What to say of discs that no outline parts from what is around, and their errors; stickers are believed.
    pub(super) fn unclear(&self, starts: &mut [Option<Start>]) -> Option<String> {
        let mut names = Vec::new();
        for (marker, start) in starts.iter_mut().enumerate() {
            let is_lone = self.loose[self.paint_of[marker]];
            let Some(start) = start.as_mut().filter(|_| self.layout.shape.is_none() && !is_lone) else { continue };
            if let Some(sd_px) = start.unclear_px() {
                start.look.apart_px2 = start.look.apart_px2.max(sd_px * sd_px);
                names.push(self.layout.markers[marker].name.as_str());
            }
        }
        (!names.is_empty()).then(|| {
            format!(
                "no outline of their size parts {} from what is around: thin paint, a fold or a shadow draws a centre \
                 aside, and the standard errors allow for that; paint evenly, in a hue that skin has not, and see \
                 --overlay",
                names.join(", ")
            )
        })
    }
}

/// Where a quarter of the markers of a colour are blots, those that a disc fits by chance are blots too.
pub(super) fn agree_on_shapes(paint_of: &[usize], starts: &mut [Option<Start>]) {
    for paint in 0..paint_of.len() {
        let mut alike: Vec<&mut Start> = paint_of
            .iter()
            .zip(starts.iter_mut())
            .filter(|(of, _)| **of == paint)
            .filter_map(|(_, s)| s.as_mut())
            .collect();
        let blots = alike.iter().filter(|start| start.look.blot.is_some()).count();
        if blots > 0 && OF_A_PAINT * blots >= alike.len() {
            for start in &mut alike {
                start.look = start.as_blot.take().unwrap_or_else(|| start.look.clone());
            }
        }
    }
}
