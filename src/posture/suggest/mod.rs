//! A marker file to start from, guessed from the video itself.
//!
//! A few frames go in; the text of a marker file comes out, which runs as it stands on a plain scene and says in comments
//! what was guessed. Markers are taken to be compact spots of about one size that stand out in some colour, frame after
//! frame, and lie in a row; the hand's end of the row is taken to be the one that moves less. Nothing tells a marker from
//! any other spot of that kind, so a person should look the file over.

mod order;
mod text;

use order::{path, row, total_turn};

use super::find::{Blob, Finder, Paint};
use crate::video::{Frame, Info};

/// Directions of colour that are looked in.
const HUES: usize = 12;
/// Distance from grey that spots are measured in, on the scale of 8 bits.
const DISTANCE: f64 = 40.0;
/// A spot stands out by this share of it, and by this share of the most outstanding one.
const LEAST_CONTRAST: f64 = 0.3;
const LEAST_OF_BEST: f64 = 0.3;
/// The shape of a marker, seen somewhat from the side or blurred.
const LONGEST: f64 = 1.7;
const LEAST_FILL: f64 = 0.85;
/// Radius in samples, and as a share of the picture's width.
const LEAST_RADIUS_PX: f64 = 2.0;
const LARGEST_RADIUS_SHARE: f64 = 0.07;
/// Sizes of the markers of one finger differ by less than this factor.
const SIZE_FACTOR: f64 = 1.5;
/// Colours are one if their directions differ by less than this and their distances from grey by less than this factor.
const SAME_HUE_RAD: f64 = 0.22;
const SAME_DISTANCE_FACTOR: f64 = 1.6;
/// A marker is there in this share of the frames with any.
const PERSISTENCE: f64 = 0.4;
/// Frames looked at, at most, and at first every how many.
const MOST_FRAMES: usize = 48;
const FIRST_STRIDE: u64 = 10;

/// Why nothing is suggested.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub(crate) enum SuggestError {
    /// No spots.
    #[error(
        "nothing in the {frames} frames looked at looks like a marker: compact, of one colour that stands out, there most of the time; \
         use stickers or paint of a colour that neither the skin nor the background has, or write the marker file by hand \
         (`[markers]`, `[segments]`, `[joints]`)"
    )]
    Nothing {
        /// Frames looked at.
        frames: usize,
    },
}

/// A spot and the colour that it was counted to.
#[derive(Debug, Clone, Copy)]
struct Mark {
    at_px: [f64; 2],
    radius_px: f64,
    colour: usize,
}

/// Looks at frames.
pub(crate) struct Suggester<'a> {
    info: &'a Info,
    finder: Finder,
    found: Vec<Blob>,
    /// For each frame looked at, its spots.
    frames: Vec<(u64, Vec<Blob>)>,
    stride: u64,
}

impl<'a> Suggester<'a> {
    pub(crate) fn new(info: &'a Info) -> Self {
        Self { info, finder: Finder::default(), found: Vec::new(), frames: Vec::new(), stride: FIRST_STRIDE }
    }

    /// Looks at a frame of the video, if it is one of those to be looked at; all frames are to be shown.
    pub(crate) fn look(&mut self, frame: &Frame<'_>) {
        if !frame.index.is_multiple_of(self.stride) {
            return;
        }
        let spots = self.spots(frame);
        self.frames.push((frame.index, spots));
        if self.frames.len() >= MOST_FRAMES {
            // Half as many, spread over twice the time; the first one stays.
            self.stride *= 2;
            let stride = self.stride;
            self.frames.retain(|(index, _)| index.is_multiple_of(stride));
        }
    }

    /// The text of the marker file.
    ///
    /// # Errors
    /// Where nothing looks like a marker.
    pub(crate) fn finish(self) -> Result<String, SuggestError> {
        let nothing = SuggestError::Nothing { frames: self.frames.len() };
        let (colours, frames) = self.colours();
        // The frame with the most markers of one size in a row; the first one, if it is as good as any.
        let rows: Vec<Vec<Mark>> = frames.iter().map(|marks| row(marks)).collect();
        let Some(best) = (0..rows.len()).rev().max_by_key(|&k| rows[k].len()).filter(|&k| !rows[k].is_empty()) else {
            return Err(nothing);
        };
        let mut marks = path(&rows[best]);
        let restless = |end: &Mark| -> f64 {
            let moves = frames.iter().filter_map(|marks| {
                let nearest = marks.iter().filter(|mark| mark.colour == end.colour);
                nearest.map(|mark| order::distance(mark.at_px, end.at_px)).min_by(f64::total_cmp)
            });
            moves.sum()
        };
        if marks.len() > 1 && restless(&marks[0]) > restless(&marks[marks.len() - 1]) {
            marks.reverse();
        }
        // How it bends: the greatest turn over all frames with as many markers.
        let hand = marks[0].at_px;
        let turns = rows.iter().filter(|row| row.len() == marks.len() && row.len() > 2).map(|row| {
            let mut other = path(row);
            if order::distance(other[0].at_px, hand) > order::distance(other[other.len() - 1].at_px, hand) {
                other.reverse();
            }
            total_turn(&other)
        });
        let turn = turns.max_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(0.0);
        let first = self.frames[best].0 == 0;
        Ok(text::marker_file(&marks, &colours, turn, first, self.info))
    }

    /// The spots of a frame that could be markers.
    fn spots(&mut self, frame: &Frame<'_>) -> Vec<Blob> {
        let mut spots: Vec<Blob> = Vec::new();
        self.finder.load(frame, None);
        let paints: Vec<Paint> = if frame.chroma.is_some() && !self.info.grey {
            let hue = |k: usize| std::f64::consts::TAU * k as f64 / HUES as f64;
            (0..HUES).map(|k| Paint::chromatic([DISTANCE * hue(k).cos(), DISTANCE * hue(k).sin()])).collect()
        } else {
            [[0; 3], [255; 3]].map(|colour| Paint::new(colour, &self.info.matrix, true)).to_vec()
        };
        let largest = LARGEST_RADIUS_SHARE * self.info.format.width as f64;
        for paint in &paints {
            self.finder.find(frame, paint, &mut self.found);
            for blob in &self.found {
                let radius = blob.radius_px();
                let is_marker = blob.contrast >= LEAST_CONTRAST
                    && !blob.at_the_border
                    && blob.elongation <= LONGEST
                    && blob.fill >= LEAST_FILL
                    && (LEAST_RADIUS_PX..=largest).contains(&radius);
                if !is_marker {
                    continue;
                }
                match spots
                    .iter_mut()
                    .find(|other| order::distance(other.at_px, blob.at_px) < 0.7 * other.radius_px().max(radius))
                {
                    Some(other) if other.contrast < blob.contrast => *other = *blob,
                    Some(_) => {}
                    None => spots.push(*blob),
                }
            }
        }
        let best = spots.iter().map(|blob| blob.contrast).fold(0.0, f64::max);
        spots.retain(|blob| blob.contrast >= LEAST_OF_BEST * best);
        spots
    }

    /// The colours of the spots that are there most of the time, and for each frame the spots of these colours.
    fn colours(&self) -> (Vec<[f64; 3]>, Vec<Vec<Mark>>) {
        let mut groups: Vec<(Vec<[f64; 3]>, Vec<bool>)> = Vec::new();
        let grey = self.info.grey;
        let mut belongs: Vec<Vec<usize>> = Vec::new();
        for (number, (_, spots)) in self.frames.iter().enumerate() {
            let mut of_frame = Vec::new();
            for spot in spots {
                let group = groups.iter().position(|(members, _)| is_same(&mean(members), &spot.colour, grey));
                let group = group.unwrap_or_else(|| {
                    groups.push((Vec::new(), vec![false; self.frames.len()]));
                    groups.len() - 1
                });
                groups[group].0.push(spot.colour);
                groups[group].1[number] = true;
                of_frame.push(group);
            }
            belongs.push(of_frame);
        }
        let with_any = self.frames.iter().filter(|(_, spots)| !spots.is_empty()).count();
        let stays = |group: usize| {
            let seen = groups[group].1.iter().filter(|&&seen| seen).count();
            seen as f64 >= PERSISTENCE * with_any as f64
        };
        let frames = (self.frames.iter().zip(&belongs))
            .map(|((_, spots), of_frame)| {
                (spots.iter().zip(of_frame))
                    .filter(|&(_, &group)| stays(group))
                    .map(|(spot, &colour)| Mark { at_px: spot.at_px, radius_px: spot.radius_px(), colour })
                    .collect()
            })
            .collect();
        (groups.iter().map(|(members, _)| mean(members)).collect(), frames)
    }
}

fn mean(members: &[[f64; 3]]) -> [f64; 3] {
    [0, 1, 2].map(|k| members.iter().map(|colour| colour[k]).sum::<f64>() / members.len().max(1) as f64)
}

fn is_same(a: &[f64; 3], b: &[f64; 3], grey: bool) -> bool {
    if grey {
        return (a[0] - b[0]).abs() < 40.0;
    }
    let [a, b] = [a, b].map(|colour| [colour[1] - 128.0, colour[2] - 128.0]);
    let turn = (a[0] * b[1] - a[1] * b[0]).atan2(a[0] * b[0] + a[1] * b[1]);
    let factor = (a[0].hypot(a[1]).max(1.0) / b[0].hypot(b[1]).max(1.0)).ln().abs();
    turn.abs() < SAME_HUE_RAD && factor < SAME_DISTANCE_FACTOR.ln()
}

#[cfg(test)]
mod tests;
