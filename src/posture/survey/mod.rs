//! The first look at a video: which markers are there, where, and how they look.
//!
//! Frames from the video's start go in, one after another, until every needed marker has its name; where each was first
//! seen, its look and the chroma's siting come out. Spots of the markers' colours are followed over these frames
//! without names, so that what a later frame shows (a finger that was straight bends) names them back to the first one.
//!
//! A name is given by colour, by the order along the finger, by which way flexion turns, by lengths that must not
//! change, and by `[start]`, which goes before all. It is given only where the best naming is better by far than any
//! other.

mod begin;
pub(in crate::posture) mod find;
mod judge;
pub(in crate::posture) mod naming;
mod shapes;
mod spots;

use judge::Hypothesis;
use shapes::agree_on_shapes;
use spots::Spots;

use super::layout::Layout;
use super::marker::blot::Blot;
use crate::posture::marker::looks::look::Look;
use crate::posture::marker::looks::siting::Siting;
use crate::video::{Frame, Info};
use find::Paint;
use naming::{Chain, MISSING, Naming, Point, lone};

/// Frames that are looked at before names are given.
const LEAST_FRAMES: usize = 3;
/// Whole frames are searched one after another for this long while a needed marker is not seen, then every few.
const EAGER_FRAMES: usize = 60;
const PATIENT_REST: usize = 8;
/// Frames with spots in them that are looked at, at most.
const MOST_FRAMES: usize = 300;
/// Namings kept.
const MOST_NAMINGS: usize = 200;

/// The cosine between what parts a mark from its surround and what would part the marker file's colour from it
/// (assumed).
const LEAST_ALIKE: f64 = 0.6;

/// Where a marker was first seen.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Start {
    pub(crate) frame: u64,
    /// Its place there, to about a pixel.
    pub(crate) at_px: [f64; 2],
    /// How far it moved to the next frame.
    pub(crate) velocity_px: [f64; 2],
    pub(crate) look: Look,
    /// How it looks as a blot, where it was taken for a disc.
    pub(crate) as_blot: Option<Look>,
}

/// What the first frames showed.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Survey {
    /// For each marker of the layout; none for those not needed and those never seen.
    pub(crate) starts: Vec<Option<Start>>,
    /// For each segment, how far its markers are apart, where both were seen.
    pub(crate) lengths_px: Vec<Option<f64>>,
    /// Where chroma samples lie.
    pub(crate) siting: Siting,
    /// Frames looked at.
    pub(crate) frames: usize,
    /// Needed markers that were not seen in them.
    pub(crate) unseen: Vec<usize>,
    /// What speaks against the names.
    pub(crate) doubts: Vec<String>,
}

/// Why markers have no names.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub(crate) enum SurveyError {
    #[error(
        "none of the markers is seen in the {frames} frames looked at ({}); are their colours in the marker file those \
         of the video? `lunula posture VIDEO --suggest` measures them",
        markers.join(", ")
    )]
    NoneSeen { markers: Vec<String>, frames: usize },
    #[error(
        "can't tell which is which of the markers {} in the {frames} frames looked at; give their places in the first \
         frame under [start]{}; `lunula posture VIDEO --suggest` shows what has such colours",
        markers.join(", "),
        if *straight { ", or check `flexion`: the finger hardly bends" } else { "" }
    )]
    Ambiguous { markers: Vec<String>, frames: usize, straight: bool },
    #[error(
        "can't tell on which finger the markers {} are: fingers that share a mark or lie apart have the same colours; \
         give their places in the first frame under [start], one on each finger at least",
        markers.join(", ")
    )]
    Branches { markers: Vec<String> },
    #[error(
        "[start] has {marker} at ({:.0}, {:.0}), where the first frame has {} and no mark of {colour}{}; {}",
        at_px[0], at_px[1],
        if *is_mark { format!("a mark of {there}") } else { there.clone() },
        nearest_px.map_or(", nor is there one anywhere".to_owned(), |[x, y]| format!(" (the nearest is at ({x:.0}, \
            {y:.0}))")),
        if *is_there {
            "the colour is there, and no other hue than what lies around it: use paint of another hue"
        } else {
            "correct the place, or the colour under [markers]"
        }
    )]
    WrongStart {
        marker: String,
        colour: String,
        /// Its place, on the shown picture.
        at_px: [f64; 2],
        /// The colour that is there.
        there: String,
        /// That colour stands out from its surroundings.
        is_mark: bool,
        /// It is the wanted colour, and does not stand out.
        is_there: bool,
        /// The nearest spot of its colour, on the shown picture.
        nearest_px: Option<[f64; 2]>,
    },
}

/// Whether another frame is wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Progress {
    /// Yes.
    More,
    /// All is known that can be.
    Enough,
}

/// Looks at the first frames.
pub(crate) struct Surveyor<'a> {
    layout: &'a Layout,
    info: &'a Info,
    needed: Vec<bool>,
    chain: Chain,
    /// The different colours, and for each marker which of them it has.
    paints: Vec<Paint>,
    paint_of: Vec<usize>,
    /// Paints of markers that are on no segment: these may be no discs.
    loose: Vec<bool>,
    spots: Spots,
    /// Frames with spots in them.
    looked: Vec<u64>,
    frames: usize,
    since_whole: usize,
    /// For each place of the chain the spot that `[start]` gives it.
    fixed: Vec<Option<usize>>,
    hypotheses: Vec<Hypothesis>,
    /// For each place of the chain: no length known yet, and the cost of not being seen.
    unknown: Vec<Option<f64>>,
    missing: Vec<f64>,
    wrong: Option<SurveyError>,
}

impl<'a> Surveyor<'a> {
    pub(crate) fn new(layout: &'a Layout, info: &'a Info) -> Self {
        let grey = info.grey;
        let mut colours: Vec<[u8; 3]> = Vec::new();
        let chain = Chain::new(layout);
        let paint_of: Vec<usize> = (layout.markers.iter())
            .map(|marker| {
                colours.iter().position(|&colour| colour == marker.colour).unwrap_or_else(|| {
                    colours.push(marker.colour);
                    colours.len() - 1
                })
            })
            .collect();
        let lone = lone(layout);
        let is_loose = |paint| (0..lone.len()).any(|marker| lone[marker] && paint_of[marker] == paint);
        Self {
            layout,
            info,
            loose: (0..colours.len()).map(is_loose).collect(),
            needed: layout.needed(),
            fixed: vec![None; chain.links.len()],
            unknown: vec![None; chain.links.len()],
            missing: vec![MISSING; chain.links.len()],
            chain,
            paints: colours.iter().map(|&colour| Paint::new(colour, &info.matrix, grey)).collect(),
            paint_of,
            spots: Spots::new(layout.shape),
            looked: Vec::new(),
            frames: 0,
            since_whole: 0,
            hypotheses: Vec::new(),
            wrong: None,
        }
    }

    pub(crate) fn look(&mut self, frame: &Frame<'_>) -> Progress {
        let first = self.frames == 0;
        self.frames += 1;
        self.since_whole += 1;
        let rest = if self.frames <= EAGER_FRAMES && !self.all_named() { 1 } else { PATIENT_REST };
        let whole = self.frames <= LEAST_FRAMES || self.since_whole >= rest;
        if whole {
            self.since_whole = 0;
        }
        if first {
            self.learn_colours(frame);
        }
        self.spots.look(frame, &self.paints, whole, &self.loose);
        if first {
            self.fix(frame);
        }
        let points: Vec<Option<Point>> = self.spots.all.iter().map(|spot| spot.at(frame.index).copied()).collect();
        if points.iter().all(Option::is_none) {
            return self.progress();
        }
        self.looked.push(frame.index);
        let choices = self.choices();
        for (missing, fixed) in self.missing.iter_mut().zip(&self.fixed) {
            // What `[start]` names is there, unless it has gone since.
            *missing = if fixed.is_some_and(|spot| points[spot].is_some()) { f64::INFINITY } else { MISSING };
        }
        if whole {
            for (mut naming, _) in self.scene(&points, &choices).namings() {
                naming.iter_mut().zip(&self.fixed).for_each(|(spot, fixed)| *spot = fixed.or(*spot));
                if self.hypotheses.iter().all(|other| other.naming != naming) {
                    self.add(naming, &choices, frame.index);
                }
            }
        }
        self.judge(&points, &choices);
        let mut hypotheses = std::mem::take(&mut self.hypotheses);
        hypotheses.sort_by(|a, b| self.cost(a).total_cmp(&self.cost(b)));
        hypotheses.truncate(MOST_NAMINGS);
        self.hypotheses = hypotheses;
        self.progress()
    }

    /// What the frames showed.
    ///
    /// # Errors
    /// Where markers have no names.
    pub(crate) fn finish(self) -> Result<Survey, SurveyError> {
        if let Some(wrong) = self.wrong {
            return Err(wrong);
        }
        let name = |marker: usize| self.layout.markers[marker].name.clone();
        let seen = self.hypotheses.first().is_some_and(|best| {
            (0..self.chain.links.len()).any(|place| best.naming[place].is_some() && self.is_needed(place))
        });
        if !seen {
            let markers = (0..self.needed.len()).filter(|&marker| self.needed[marker]).map(name).collect();
            return Err(SurveyError::NoneSeen { markers, frames: self.frames });
        }
        let best = &self.hypotheses[0];
        let unsure = self.unsure();
        if !unsure.is_empty() {
            let markers = unsure.iter().map(|&place| name(self.chain.links[place].marker)).collect();
            let straight = unsure.len() > 2 && unsure.len() == self.chain.links.len();
            return Err(SurveyError::Ambiguous { markers, frames: self.frames, straight });
        }
        let mut starts = vec![None; self.layout.markers.len()];
        for (link, spot) in self.chain.links.iter().zip(&best.naming) {
            let Some(spot) = spot.filter(|_| self.needed[link.marker]) else { continue };
            let spot = &self.spots.all[spot];
            if let Some((_, look)) = &spot.look {
                let point = &spot.points[0];
                let next = spot.points.get(1).filter(|next| next.frame == point.frame + 1).unwrap_or(point);
                starts[link.marker] = Some(Start {
                    frame: point.frame,
                    at_px: point.at_px,
                    velocity_px: [0, 1].map(|axis| next.at_px[axis] - point.at_px[axis]),
                    look: look.clone(),
                    as_blot: spot.as_blot.clone(),
                });
            }
        }
        agree_on_shapes(&self.paint_of, &mut starts);
        let mut doubts = self.passed_over(best);
        doubts.extend(self.unclear(&mut starts));
        let unseen = (0..starts.len()).filter(|&marker| self.needed[marker] && starts[marker].is_none()).collect();
        Ok(Survey {
            lengths_px: self.lengths(best),
            doubts,
            starts,
            siting: self.spots.siting(self.info.chroma_site.map(|(dx_px, dy_px)| Siting { dx_px, dy_px })),
            frames: self.frames,
            unseen,
        })
    }

    /// Takes the colours over that the first frame shows at the places of `[start]`, where they are much like the
    /// file's: light, camera and codec turn a colour, and what a person picks by eye is no measurement.
    fn learn_colours(&mut self, frame: &Frame<'_>) {
        let size = (self.info.format.width, self.info.format.height);
        for (number, paint) in self.paints.iter_mut().enumerate() {
            let places = self.layout.start.iter().zip(&self.paint_of).filter(|(_, of)| **of == number);
            let seen: Vec<[[f64; 3]; 2]> = places
                .filter_map(|(place, _)| {
                    let at_px = self.info.turn.stored_from_shown((*place)?, size);
                    let mark = Blot::at(frame, Siting::usual(frame), at_px)?;
                    let alike = paint.parts(mark.marker, mark.background) >= LEAST_ALIKE;
                    alike.then_some([mark.marker, mark.background])
                })
                .collect();
            if !seen.is_empty() {
                let mean = |which: usize| {
                    std::array::from_fn(|p| seen.iter().map(|both| both[which][p]).sum::<f64>() / seen.len() as f64)
                };
                *paint = paint.seen_on(mean(0), mean(1));
            }
        }
    }

    fn is_needed(&self, place: usize) -> bool {
        self.needed[self.chain.links[place].marker]
    }

    fn all_named(&self) -> bool {
        let complete = |naming: &Naming| {
            (0..naming.len()).all(|place| {
                !self.is_needed(place) || naming[place].is_some_and(|spot| self.spots.all[spot].look.is_some())
            })
        };
        self.hypotheses.first().is_some_and(|best| complete(&best.naming))
    }

    fn progress(&self) -> Progress {
        let sure = self.looked.len() >= LEAST_FRAMES && self.all_named() && self.unsure().is_empty();
        if sure || self.wrong.is_some() || self.looked.len() >= MOST_FRAMES { Progress::Enough } else { Progress::More }
    }

    /// How long segments are in a naming: the mean of the shortest and longest seen.
    fn lengths(&self, best: &Hypothesis) -> Vec<Option<f64>> {
        (self.layout.segments.iter())
            .map(|segment| {
                let place = self.chain.place_of(segment.markers[1])?;
                let link = self.chain.links[place];
                let (shortest, longest) = best.spans[place];
                let before = link.before.map(|before| self.chain.links[before].marker);
                (link.rigid && before == Some(segment.markers[0]) && longest > 0.0)
                    .then_some(0.5 * (shortest + longest))
            })
            .collect()
    }
}

#[cfg(test)]
mod tests;
