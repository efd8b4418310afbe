//! The markers that `[start]` gives a place: their spots in the first frame, and their colours as that frame has them.
//!
//! A place is believed: the spot of the marker's colour next to it is the marker, whatever the order along the finger
//! says.
//! Where the marker file's colour finds none there, any mark of about that hue will do, however pale or dark; a place
//! without one is an error that names the colour found.

use super::{SurveyError, Surveyor};
use crate::median::median_of;
use crate::posture::suggest::{hex, palette};
use crate::posture::survey::find::{Blob, Paint, distance};
use crate::video::Frame;

/// A spot further from its place than this many radii, or this share of the picture's diagonal, is not meant ...
const START_RADII: f64 = 3.0;
const START_SHARE: f64 = 0.02;
/// ... nor one further than this share of the distance to the next place.
const TO_THE_NEXT: f64 = 0.5;
/// A mark of another colour than the marker file's is taken where their hues differ by less than this.
const SAME_HUE_RAD: f64 = 0.7;
/// What differs by less from the marker file's colour, in each plane, is that colour, levels (assumed).
const SAME_LEVELS: f64 = 12.0;
/// Half the side of the square whose mean colour is said, luma samples.
const SAID_PX: usize = 2;

impl Surveyor<'_> {
    /// Gives the places of `[start]` their spots, the nearest pairs first, and paints the colours of these spots.
    pub(super) fn fix(&mut self, frame: &Frame<'_>) {
        let size = (self.info.format.width, self.info.format.height);
        let stored = |place: usize| {
            self.layout.start[self.chain.links[place].marker].map(|shown| self.info.turn.stored_from_shown(shown, size))
        };
        let starts: Vec<(usize, [f64; 2])> =
            (0..self.chain.links.len()).filter_map(|place| Some((place, stored(place)?))).collect();
        let reach = START_SHARE * (size.0 as f64).hypot(size.1 as f64);
        let next = |place: usize, at: [f64; 2]| {
            let others = starts.iter().filter(|other| other.0 != place).map(|other| distance(other.1, at));
            TO_THE_NEXT * others.fold(f64::INFINITY, f64::min)
        };
        let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
        for &(place, at) in &starts {
            for (number, spot) in self.spots.all.iter().enumerate() {
                let off = distance(spot.points[0].at_px, at);
                let near = reach.max(START_RADII * spot.points[0].radius_px).min(next(place, at));
                if spot.paints[self.paint(place)] && off <= near {
                    pairs.push((off, place, number));
                }
            }
        }
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)).then(a.2.cmp(&b.2)));
        for (_, place, spot) in pairs {
            if self.fixed[place].is_none() && !self.fixed.contains(&Some(spot)) {
                self.fixed[place] = Some(spot);
            }
        }
        let paints = palette(self.info);
        let mut strange = vec![Vec::new(); self.paints.len()];
        for &(place, at) in &starts {
            if self.fixed[place].is_none() {
                let reach = reach.min(next(place, at));
                let there = self.spots.outstanding(frame, at, reach, &paints);
                match there.filter(|blob| self.is_about(place, blob) && !self.is_taken(blob)) {
                    Some(blob) => {
                        let paint = self.paint(place);
                        self.fixed[place] = Some(self.spots.start(frame, &blob, paint, self.paints.len()));
                        strange[paint].push(blob.colour);
                    }
                    None => {
                        self.wrong.get_or_insert(self.wrong_start(frame, place, at, there));
                    }
                }
            }
        }
        for (paint, colours) in self.paints.iter_mut().zip(&strange) {
            if !colours.is_empty() {
                *paint = paint.seen_as(median(colours));
            }
        }
        let undecided = self.chain.undecided(&self.paint_of, &self.fixed);
        if undecided.iter().any(|&place| self.is_needed(place)) {
            let name = |&place: &usize| self.layout.markers[self.chain.links[place].marker].name.clone();
            self.wrong.get_or_insert(SurveyError::Branches { markers: undecided.iter().map(name).collect() });
        }
    }

    fn paint(&self, place: usize) -> usize {
        self.paint_of[self.chain.links[place].marker]
    }

    /// The paint of the marker file's colour.
    fn wanted(&self, place: usize) -> Paint {
        let colour = self.layout.markers[self.chain.links[place].marker].colour;
        Paint::new(colour, &self.info.matrix, self.info.grey)
    }

    /// Whether a mark may be the marker's, though its colour is not quite the marker file's.
    fn is_about(&self, place: usize, blob: &Blob) -> bool {
        let paint = self.wanted(place);
        paint.is_like(&paint.seen_as(blob.colour), SAME_HUE_RAD)
    }

    fn is_taken(&self, blob: &Blob) -> bool {
        let spots = self.fixed.iter().flatten().map(|&spot| &self.spots.all[spot].points[0]);
        spots.into_iter().any(|point| distance(point.at_px, blob.at_px) < point.radius_px)
    }

    fn wrong_start(&self, frame: &Frame<'_>, place: usize, at: [f64; 2], there: Option<Blob>) -> SurveyError {
        let size = (self.info.format.width, self.info.format.height);
        let marker = self.chain.links[place].marker;
        let of_colour = self.spots.all.iter().filter(|spot| spot.paints[self.paint(place)]);
        let nearest =
            of_colour.map(|spot| spot.points[0].at_px).min_by(|a, b| distance(*a, at).total_cmp(&distance(*b, at)));
        let shown = |at: [f64; 2]| self.info.turn.shown_from_stored(at, size);
        let colour = there.map_or_else(|| colour_at(frame, at), |blob| blob.colour);
        let wanted = self.wanted(place).colour;
        let is_there = there.is_none() && (0..3).all(|p| (wanted[p] - colour[p]).abs() <= SAME_LEVELS);
        SurveyError::WrongStart {
            marker: self.layout.markers[marker].name.clone(),
            colour: hex(self.layout.markers[marker].colour.map(|part| f64::from(part) / 255.0)),
            at_px: shown(at),
            there: hex(self.info.matrix.to_own_rgb(colour)),
            is_mark: there.is_some(),
            is_there,
            nearest_px: nearest.map(shown),
        }
    }
}

/// The mean Y', Cb and Cr about a place.
fn colour_at(frame: &Frame<'_>, at: [f64; 2]) -> [f64; 3] {
    let (across, down) = frame.subsampling();
    let span = |at: f64, size: usize| {
        let middle = at.round().clamp(0.0, size as f64 - 1.0) as usize;
        middle.saturating_sub(SAID_PX)..(middle + SAID_PX + 1).min(size)
    };
    let (mut sum, mut count) = ([0.0; 3], 0.0);
    for y in span(at[1], frame.luma.height) {
        for x in span(at[0], frame.luma.width) {
            let chroma = |k: usize| frame.chroma.map_or(128.0, |planes| planes[k].sample(x / across, y / down));
            let here = [frame.luma.sample(x, y), chroma(0), chroma(1)];
            (0..3).for_each(|p| sum[p] += f64::from(here[p]));
            count += 1.0;
        }
    }
    sum.map(|value| value / count)
}

fn median(colours: &[[f64; 3]]) -> [f64; 3] {
    [0, 1, 2].map(|p| median_of(colours.iter().map(|colour| colour[p])).unwrap_or(f64::NAN))
}
