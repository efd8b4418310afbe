//! A marker's looks in the video's own planes: colours, size, blur, noise.
//!
//! Learned where the marker is first seen ([`crate::posture::marker::looks::learn`]) and kept up to date from the fits
//! that follow. Samples are on the scale of 8 bits, in the order Y', Cb, Cr; without chroma the last two are zero.

use crate::posture::marker::blot::Blot;
use crate::posture::marker::fit::Fit;
use crate::posture::marker::sight::Centre;
use crate::posture::survey::find::Paint;

/// How much a fit counts against what was learned before.
const SHARE: f64 = 0.1;

/// How a marker looks in a video.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Look {
    /// Radius of a disc of its area.
    pub(crate) radius_px: f64,
    /// Y', Cb, Cr of the disc.
    pub(crate) marker: [f64; 3],
    /// Y', Cb, Cr around it.
    pub(crate) background: [f64; 3],
    /// Standard deviation of the Gaussian that luma's edge is seen through.
    pub(crate) blur_px: f64,
    /// What is usually left unexplained within the marker, over its contrast, both squared.
    pub(crate) misfit: f64,
    pub(crate) least_misfit: f64,
    /// Standard deviation of what is left unexplained in each plane.
    pub(crate) noise: [f64; 3],
    /// How many times larger the errors are than independent noise would make them
    /// ([`crate::posture::marker::inflation`]).
    pub(crate) inflation: f64,
    /// Variance of a disc's coordinates that stays, as its outline's centre shows, pixels squared.
    pub(crate) apart_px2: f64,
    /// How its outline is found; none for a disc.
    pub(crate) blot: Option<Blot>,
}

impl Look {
    /// Of these colours, with nothing known of blur, misfit and noise; of no outline.
    pub(crate) fn plain(radius_px: f64, marker: [f64; 3], background: [f64; 3]) -> Self {
        Self {
            radius_px,
            marker,
            background,
            blur_px: 0.0,
            misfit: 0.0,
            least_misfit: 0.0,
            noise: [1.0; 3],
            inflation: 1.0,
            apart_px2: 0.0,
            blot: None,
        }
    }

    /// A marker that looks so and was not fitted, as a fit with this centre.
    pub(crate) fn unfitted(&self, centre: Centre, white_px2: [f64; 3]) -> Fit {
        let Self { marker, background, blur_px, misfit, noise, .. } = *self;
        Fit {
            centre,
            white_px2,
            marker,
            background,
            blur_px,
            misfit,
            noise,
            chroma_shift_px: None,
            outline: None,
            is_held: false,
        }
    }

    /// Whether most are no discs.
    pub(crate) fn are_blots<'a>(looks: impl Iterator<Item = &'a Self>) -> bool {
        let more = |blot: &Self| if blot.blot.is_some() { 1 } else { -1 };
        looks.map(more).sum::<i32>() > 0
    }

    /// Its colour as last seen.
    pub(crate) fn paint(&self, of: &Paint) -> Paint {
        if self.blot.is_some() { of.seen_on(self.marker, self.background) } else { of.seen_as(self.marker) }
    }

    /// Keeps what was seen when it was first learnt, whatever light it is in now: the size of a blot, how far a disc's
    /// outline is off.
    pub(crate) fn keep_first(&mut self, before: &Self) {
        self.apart_px2 = before.apart_px2;
        if let (Some(blot), Some(before)) = (&mut self.blot, &before.blot) {
            blot.keep_size(before);
        }
    }

    /// Takes over what the marker looked like in another frame.
    pub(crate) fn update(&mut self, fit: &Fit) {
        let toward = |old: &mut f64, new: f64| *old += SHARE * (new - *old);
        toward(&mut self.radius_px, fit.centre.radius_px);
        toward(&mut self.blur_px, fit.blur_px);
        toward(&mut self.misfit, fit.misfit);
        self.least_misfit = self.least_misfit.min(self.misfit);
        for p in 0..3 {
            toward(&mut self.marker[p], fit.marker[p]);
            toward(&mut self.background[p], fit.background[p]);
            toward(&mut self.noise[p], fit.noise[p]);
        }
        if let (Some(blot), Some(outline)) = (&mut self.blot, &fit.outline) {
            blot.update(outline);
        }
    }
}
