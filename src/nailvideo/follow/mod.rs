//! The nail followed through a video: where it is in each frame, or why that is not known.
//!
//! In: frames in order, and the nail in the first good one. Out: for each a [`Place`]: the affine motion of the shown
//! picture's pixels from the first good frame, with its standard error, or [`Lost`]. A frame is fitted from where the
//! motion of the two before leads (`register`); where that fails, coarser first; what is doubtful is lost (`judge`). A
//! lost nail is looked for over the whole picture (`search`) and counts again once three frames running confirm it.

mod cover;
mod judge;
mod register;
mod search;
mod sight;
mod template;
#[cfg(test)]
mod tests;

pub(in crate::nailvideo) use cover::{Covered, Rim, covered};
pub(in crate::nailvideo) use judge::{Lost, Place, beyond_fine};
pub(in crate::nailvideo) use template::{CELLS, cell_at, cell_middle};

use judge::{After, Usual, judge};
use register::{Fit, Scratch, register, register_fine};
use search::Search;
use sight::{Sight, blur_px};
use template::{BOX, Template};

use super::affine::Affine;
use super::grid::{Part, samples, shown_size};
use crate::video::Frame;

/// Frames that have to confirm a nail that was found again, itself among them.
const TRIAL: usize = 3;
/// Coarser steps before the fine one, where the fine one alone fails.
const COARSER: [usize; 2] = [4, 2];
/// A correlation this far below the video's own is looked at again from coarser pictures.
const DOUBT_NCC_SHARE: f64 = 0.9;

/// A fit that did not come to rest is believed where coarser pictures lead to the same place, and the best place about
/// it is no other. Else it is fitted from more starts and looked at once more over the whole picture: where a fit this
/// far away correlates by so much more, the nail has jumped. Measured on nails of 26 real photographs that move up to
/// 18 and 24 px a frame: with no look 4 of 78 and 10 of 78 recordings have RMS errors of 0.9 to 9.1 px, so none has
/// over 0.5. With the whole picture for every such fit they were as far off, and a nail that blanches, which keeps fits
/// from coming to rest, was followed in twice the time (`cargo bench -p lunula-cli --bench nailvideo`).
const SAME_PX: f64 = 0.5;
const ELSEWHERE_PX: f64 = 3.0;
const ELSEWHERE_NCC: f64 = 0.005;

/// Follows one nail.
#[derive(Debug)]
pub(in crate::nailvideo) struct Follower {
    frame_from_nail: Affine,
    quarters: usize,
    width_px: f64,
    /// Pixels of a block of the fine template: 1, or more of a nail so large that blocks are as fine.
    step: usize,
    fine: Template,
    coarse: Vec<(usize, Template)>,
    search: Search,
    usual: Usual,
    scratch: Scratch,
    state: State,
    /// The last motion that was accepted.
    last: Affine,
}

#[derive(Debug, Clone, Copy)]
struct At {
    time_s: f64,
    motion: Affine,
}

#[derive(Debug, Clone, Copy)]
enum State {
    /// The last frame, and the one before where that is known.
    Followed(At, Option<At>),
    /// For so many frames.
    Lost(usize),
    /// Found again, and confirmed so many times.
    Trial(At, usize),
}

impl Follower {
    /// Of a nail in a frame: `frame_from_nail` leads from half widths and half lengths about its middle to the shown
    /// picture's pixels; `quarters` is how the frame is turned to be shown.
    pub(in crate::nailvideo) fn new(frame: &Frame<'_>, quarters: usize, frame_from_nail: Affine) -> Self {
        let samples = samples(frame.luma, quarters);
        let [a, b, _, d, e, _] = frame_from_nail.0;
        let extent_px = [2.0 * a.hypot(d), 2.0 * b.hypot(e)];
        let blur_px = blur_px(extent_px[0]);
        let looked_at = |step: usize| {
            let sight = Sight::new(&samples, Part::whole(&samples), step, blur_px);
            (Template::new(&sight, &frame_from_nail, step), sight)
        };
        let mut step = ((extent_px[0] / LARGEST_FINE_PX) as usize).max(1);
        let coarsest = (extent_px[0] / LEAST_FINE_PX) as usize;
        let (mut fine, mut sight) = looked_at(step);
        while step < coarsest && fine.noise_of_slopes(&sight, step) > MOST_NOISE {
            step += 1;
            (fine, sight) = looked_at(step);
        }
        let coarse = COARSER.iter().map(|by| by * step).filter(|by| extent_px[0] / *by as f64 >= LEAST_COARSE_PX);
        let coarse = coarse.map(|step| (step, looked_at(step).0)).collect();
        let search = Search::new(&samples, fine.middle, extent_px, blur_px);
        let first = At { time_s: frame.time_s, motion: Affine::IDENTITY };
        Self {
            frame_from_nail,
            quarters,
            width_px: extent_px[0],
            step,
            fine,
            coarse,
            search,
            usual: Usual::default(),
            scratch: Scratch::default(),
            state: State::Followed(first, None),
            last: Affine::IDENTITY,
        }
    }

    /// Where the nail is in the next frame.
    pub(in crate::nailvideo) fn step(&mut self, frame: &Frame<'_>) -> Result<Place, Lost> {
        let time_s = frame.time_s;
        match self.state {
            State::Followed(at, before) => {
                let expected = predicted(&at, before.as_ref(), time_s);
                let found = self.near(frame, After::Frame, &expected, &at.motion);
                match found {
                    Ok((place, fit)) => {
                        self.usual.learn(&fit);
                        self.last = place.motion;
                        self.state = State::Followed(At { time_s, motion: place.motion }, Some(at));
                        Ok(place)
                    }
                    Err(lost) => self.lose(frame, lost),
                }
            }
            State::Trial(at, count) => {
                // Nothing is known of its speed: it is expected where it was.
                match self.near(frame, After::Loss, &at.motion, &at.motion) {
                    Ok((place, _)) => {
                        let here = At { time_s, motion: place.motion };
                        if count + 1 < TRIAL {
                            self.state = State::Trial(here, count + 1);
                            return Err(Lost::Trial);
                        }
                        self.last = place.motion;
                        self.state = State::Followed(here, Some(at));
                        Ok(place)
                    }
                    Err(lost) => self.lose(frame, lost),
                }
            }
            State::Lost(frames) => {
                self.state = State::Lost(frames + 1);
                self.again(frame, frames).map_or_else(Err, |()| Err(Lost::Trial))
            }
        }
    }

    /// It is lost, and looked for at once.
    fn lose(&mut self, frame: &Frame<'_>, lost: Lost) -> Result<Place, Lost> {
        self.state = State::Lost(1);
        let _on_trial = self.again(frame, 0);
        Err(lost)
    }

    /// Near where it is expected, by the fine template alone where that comes to rest.
    fn near(
        &mut self,
        frame: &Frame<'_>,
        after: After,
        expected: &Affine,
        last: &Affine,
    ) -> Result<(Place, Fit), Lost> {
        let least = self.usual.ncc().unwrap_or(0.0) * DOUBT_NCC_SHARE;
        let mut best = self.fine(frame, *expected, after, Some(expected));
        for start in [expected, last] {
            let likely = best.as_ref().ok().filter(|(place, _)| place.ncc >= least);
            if likely.is_some_and(|(_, fit)| fit.is_at_rest()) {
                return best;
            }
            let likely = likely.map(|(place, _)| place.motion);
            let Some(start) = self.coarse(frame, *start) else { continue };
            if likely.is_some_and(|likely| self.is_agreed(frame, &likely, &start)) {
                return best;
            }
            let other = self.fine(frame, start, after, Some(expected));
            best = match (best, other) {
                (Ok(a), Ok(b)) if !b.1.is_better(&a.1) => Ok(a),
                (_, b @ Ok(_)) => b,
                (a, _) => a,
            };
        }
        let place = best.as_ref().ok().filter(|(_, fit)| !fit.is_at_rest()).map(|(place, _)| *place);
        if place.is_some_and(|place| self.fits_elsewhere(frame, &place)) { Err(Lost::Jumped) } else { best }
    }

    /// Whether coarser pictures, and the best place about it, say the same as a fit that did not come to rest.
    fn is_agreed(&self, frame: &Frame<'_>, fitted: &Affine, coarse: &Affine) -> bool {
        let about = || self.search.about(&samples(frame.luma, self.quarters), fitted);
        self.apart_px(fitted, coarse) <= SAME_PX
            && about().is_some_and(|about| self.apart_px(fitted, &about) <= ELSEWHERE_PX)
    }

    /// How far apart two motions are at the nail's middle.
    fn apart_px(&self, one: &Affine, other: &Affine) -> f64 {
        let [[x, y], [p, q]] = [one, other].map(|motion| motion.of(self.fine.middle));
        (x - p).hypot(y - q)
    }

    /// Whether the nail fits another place better.
    fn fits_elsewhere(&mut self, frame: &Frame<'_>, place: &Place) -> bool {
        let places = self.search.places(&samples(frame.luma, self.quarters), &self.last);
        places.into_iter().any(|start| {
            let start = self.coarse(frame, start);
            let other = start.and_then(|start| self.fine(frame, start, After::Loss, None).ok());
            other.is_some_and(|(other, _)| {
                other.ncc > place.ncc + ELSEWHERE_NCC && self.apart_px(&place.motion, &other.motion) > ELSEWHERE_PX
            })
        })
    }

    /// Looks for a nail that is lost for so many frames where it was last, and, in one of some, everywhere; what is
    /// found is on trial.
    fn again(&mut self, frame: &Frame<'_>, frames: usize) -> Result<(), Lost> {
        let samples = samples(frame.luma, self.quarters);
        let mut why = Lost::Unlike;
        let everywhere = frames.is_multiple_of(self.search.every(&samples));
        let places = if everywhere { self.search.places(&samples, &self.last) } else { Vec::new() };
        for start in std::iter::once(self.last).chain(places) {
            let Some(start) = self.coarse(frame, start) else { continue };
            match self.fine(frame, start, After::Loss, None) {
                Ok((place, _)) => {
                    self.state = State::Trial(At { time_s: frame.time_s, motion: place.motion }, 1);
                    return Ok(());
                }
                Err(lost) => why = lost,
            }
        }
        Err(why)
    }

    fn fine(
        &mut self,
        frame: &Frame<'_>,
        start: Affine,
        after: After,
        expected: Option<&Affine>,
    ) -> Result<(Place, Fit), Lost> {
        let sight = self.sight(frame, &start, self.step).ok_or(Lost::Outside)?;
        // Another's nail is as like by what of it is alike: a nail is found again by all of it.
        let by_bare = matches!(after, After::Frame);
        let fit = register_fine(&self.fine, &sight, start, by_bare, &mut self.scratch).ok_or(Lost::Unlike)?;
        judge(&fit, &self.fine, frame.quantizer, &self.usual, after, expected, self.width_px).map(|place| (place, fit))
    }

    /// A better start, from coarser pictures.
    fn coarse(&mut self, frame: &Frame<'_>, mut start: Affine) -> Option<Affine> {
        for k in 0..self.coarse.len() {
            let sight = self.sight(frame, &start, self.coarse[k].0)?;
            start = register(&self.coarse[k].1, &sight, start, &mut self.scratch)?.motion;
        }
        Some(start)
    }

    /// The part of a frame in which the nail is looked for.
    fn sight(&self, frame: &Frame<'_>, motion: &Affine, step: usize) -> Option<Sight> {
        let samples = samples(frame.luma, self.quarters);
        let corners = [[-BOX, -BOX], [BOX, -BOX], [BOX, BOX], [-BOX, BOX]];
        let corners = corners.map(|corner| motion.of(self.frame_from_nail.of(corner)));
        let blur_px = blur_px(self.width_px);
        let reach = 2.0 * blur_px + 0.06 * self.width_px + 2.0 * step as f64;
        let part = Part::about(&corners, reach, shown_size(&samples))?;
        Some(Sight::new(&samples, part, step, blur_px))
    }
}

/// A nail wider than this is looked at in blocks: as fine, of its width, as one of 200 to 400 pixels.
const LARGEST_FINE_PX: f64 = 400.0;
/// The fine template is made of larger blocks where more than this share of its slopes' energy is noise, down to so
/// many of them across the nail (measured on nails of 24 real photographs, enlarged to 120 px, moved and pressed, with
/// noise of 3 levels: of pixels alone 909 of 1440 frames were followed, so all of them, and with 0.3 to 0.098 px in
/// place of 0.081).
const MOST_NOISE: f64 = 0.15;
const LEAST_FINE_PX: f64 = 15.0;
/// Coarse templates of nails narrower than this hold nothing (assumed).
const LEAST_COARSE_PX: f64 = 16.0;

/// Where the motion of the last two frames leads.
fn predicted(at: &At, before: Option<&At>, time_s: f64) -> Affine {
    let Some(before) = before else { return at.motion };
    let ratio = (time_s - at.time_s) / (at.time_s - before.time_s);
    // Over a gap the motion need not go on.
    if !(0.0..=2.5).contains(&ratio) {
        return at.motion;
    }
    Affine(std::array::from_fn(|k| at.motion.0[k] + ratio * (at.motion.0[k] - before.motion.0[k])))
}
