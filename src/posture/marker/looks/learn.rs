//! How a marker looks, learned where it is first seen.

use crate::posture::marker::blot::Blot;
use crate::posture::marker::centre::{Scratch, fit};
use crate::posture::marker::fit::Fit;
use crate::posture::marker::looks::look::Look;
use crate::posture::marker::looks::siting::Siting;
use crate::video::Frame;

/// Blurs to start from, pixels.
const BLURS_PX: [f64; 4] = [0.6, 1.0, 1.8, 3.2];

impl Look {
    /// The looks of the marker of about `radius_px` (within a quarter) at about `at_px`; none where there is no such
    /// disc.
    pub(crate) fn learn(
        frame: &Frame<'_>,
        siting: Siting,
        at_px: [f64; 2],
        radius_px: f64,
        scratch: &mut Scratch,
    ) -> Option<Self> {
        let (marker, background) = colours(frame, siting, at_px, radius_px)?;
        let start = Self::plain(radius_px, marker, background);
        let mut best: Option<(f64, Fit)> = None;
        for blur_px in BLURS_PX.into_iter().filter(|&blur| blur <= BLURS_PX[0].max(0.4 * radius_px)) {
            let mut look = Self { blur_px, ..start.clone() };
            // What was found is what the next fit starts from: radius and blur are held near it.
            let mut found = None;
            for _ in 0..4 {
                let Ok(one) = fit(frame, siting, &look, at_px, scratch) else { break };
                look.radius_px = one.centre.radius_px;
                look.blur_px = one.blur_px;
                found = Some(one);
            }
            let Some(one) = found else { continue };
            if best.as_ref().is_none_or(|(least, _)| one.misfit < *least) {
                best = Some((one.misfit, one));
            }
        }
        let (misfit, one) = best?;
        let right = (one.centre.radius_px / radius_px).ln().abs() <= 0.4 && misfit <= 0.1;
        right.then_some(Self {
            radius_px: one.centre.radius_px,
            marker: one.marker,
            background: one.background,
            blur_px: one.blur_px,
            misfit,
            least_misfit: misfit,
            noise: one.noise,
            ..start
        })
    }

    /// The looks of the marker of any outline of about `radius_px` at about `at_px`; none where nothing compact stands
    /// out.
    pub(crate) fn learn_blot(frame: &Frame<'_>, siting: Siting, at_px: [f64; 2], radius_px: f64) -> Option<Self> {
        let (blot, outline) = Blot::learn(frame, siting, at_px, radius_px)?;
        // Nothing is fitted with a disc's blur and misfit.
        let plain = Self::plain(outline.radius_px(), outline.marker, outline.background);
        Some(Self { noise: outline.noise, blot: Some(blot), ..plain })
    }
}

/// The mean colours in the middle of a disc and around it.
fn colours(frame: &Frame<'_>, siting: Siting, at_px: [f64; 2], radius_px: f64) -> Option<([f64; 3], [f64; 3])> {
    let (mut marker, mut background) = ([0.0; 3], [0.0; 3]);
    let planes = [Some(frame.luma), frame.chroma.map(|c| c[0]), frame.chroma.map(|c| c[1])];
    let (across, down) = frame.subsampling();
    for (p, plane) in planes.iter().enumerate() {
        let Some(plane) = plane else { continue };
        let (pitch, origin) =
            if p == 0 { ([1.0; 2], [0.0; 2]) } else { ([across as f64, down as f64], [siting.dx_px, siting.dy_px]) };
        let reach = 1.7 * radius_px + 2.0;
        let range = |axis: usize, size: usize| {
            let from = ((at_px[axis] - reach - origin[axis]) / pitch[axis]).max(0.0) as usize;
            let to = ((at_px[axis] + reach - origin[axis]) / pitch[axis]).max(-1.0) + 1.0;
            from..(to as usize).min(size)
        };
        let (mut inside, mut around) = ([0.0; 2], [0.0; 2]);
        for y in range(1, plane.height) {
            let dy = y as f64 * pitch[1] + origin[1] - at_px[1];
            for x in range(0, plane.width) {
                let dx = x as f64 * pitch[0] + origin[0] - at_px[0];
                let distance = dx.hypot(dy);
                let value = f64::from(plane.sample(x, y));
                if distance <= 0.5 * radius_px + 0.25 * pitch[0] {
                    inside[0] += value;
                    inside[1] += 1.0;
                } else if distance > 1.2 * radius_px + 1.0 && distance < reach {
                    around[0] += value;
                    around[1] += 1.0;
                }
            }
        }
        marker[p] = inside[0] / inside[1];
        background[p] = around[0] / around[1];
    }
    marker.iter().chain(&background).all(|v| v.is_finite()).then_some((marker, background))
}
