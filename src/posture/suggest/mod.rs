//! A marker file to start from, guessed from the video itself.
//!
//! A few frames go in; the text of a marker file comes out, which says in comments what was guessed. Markers are
//! taken to be
//! compact spots of about one size that stand out in some colour other than skin's, frame after frame in about the
//! same number,
//! and lie in a row on skin, or move; the hand's end of the row is taken to be the one that moves less. Nothing
//! distinguishes a marker from any other spot of that kind, so a person should look the file over.

mod order;
mod text;

pub(super) use text::hex;

use order::{path, row, total_turn};

use super::marker::blot::Blot;
use super::track::loose_look;
use crate::posture::marker::looks::siting::Siting;
use crate::posture::survey::find::{Blob, Finder, Paint, distance};
use crate::posture::survey::naming::Point;
use crate::video::{Frame, Info};

/// Directions of colour that are looked in.
const HUES: usize = 12;
/// Distance from grey that spots are looked for in, on the scale of 8 bits, and the share of it that they stand out by.
const DISTANCE: f64 = 40.0;
const LEAST_SHARE: f64 = 0.2;
/// Levels by which a marker differs from what surrounds it (assumed; dark green paint on skin differs by 20 to 40),
/// and the
/// share of the most outstanding one's.
const LEAST_CONTRAST: f64 = 14.0;
const LEAST_OF_BEST: f64 = 0.3;
/// The shape of a marker: a disc seen somewhat from the side or blurred, or a blot of paint.
const LONGEST: f64 = 2.6;
const LEAST_FILL: f64 = 0.8;
/// An outline's radius over that of the spot it is of, at least.
const LEAST_OF_BLOB: f64 = 0.7;
/// Radius in samples, and as a share of the picture's width.
const LEAST_RADIUS_PX: f64 = 2.0;
const LARGEST_RADIUS_SHARE: f64 = 0.07;
/// Radii of the markers of one finger differ from one another's by less than this factor where colours do, and by
/// less than
/// the other where they do not: blots of paint do.
const SIZE_FACTOR: f64 = 1.35;
const BLOT_SIZE_FACTOR: f64 = 1.9;
/// Colours are one if their directions differ by less than this and their distances from grey by less than this factor.
/// Near to grey, noise turns a colour's direction: by this over its distance.
const SAME_HUE_RAD: f64 = 0.22;
const HUE_NOISE: f64 = 8.0;
const SAME_DISTANCE_FACTOR: f64 = 1.6;
/// A marker is there in this share of the frames with any.
const PERSISTENCE: f64 = 0.4;
/// As many markers, or one more or less, are there in this share of all frames.
const STEADY: f64 = 0.5;
/// ... once there are so many frames.
const FEW_FRAMES: usize = 5;
/// Frames looked at, at most, and at first every how many.
const MOST_FRAMES: usize = 48;
const FIRST_STRIDE: u64 = 6;
/// Skin's Cb and Cr less 128, of all complexions: Chai and Ngan 1999 (DOI 10.1109/76.767122), Cb 77 to 127, Cr 133 to
/// 173; and its
/// distance from grey at most (assumed: stickers of skin's hue are more colourful than skin).
const SKIN_CB: (f64, f64) = (-51.0, 1.0);
const SKIN_CR: (f64, f64) = (5.0, 45.0);
const SKIN_DISTANCE: f64 = 45.0;

/// Why nothing is suggested.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub(crate) enum SuggestError {
    #[error(
        "nothing in the {frames} frames looked at looks like a marker: compact, of one colour that stands out and is \
         not skin's, there most of the time, on skin or moving; use stickers or paint of a colour that neither the \
         skin nor the background has, or write the marker file by hand (`[markers]`, `[segments]`, `[joints]`)"
    )]
    Nothing { frames: usize },
}

/// A spot and the colour that it was counted to.
#[derive(Debug, Clone, Copy)]
struct Mark {
    at_px: [f64; 2],
    radius_px: f64,
    colour: usize,
    on_skin: bool,
}

/// A spot that could be a marker.
#[derive(Debug, Clone, Copy)]
struct Candidate {
    at_px: [f64; 2],
    radius_px: f64,
    colour: [f64; 3],
    /// Levels of chroma (in grey video, of luma) between it and what surrounds it.
    contrast: f64,
    /// What surrounds it has skin's colour.
    on_skin: bool,
}

/// Looks at frames.
pub(crate) struct Suggester<'a> {
    info: &'a Info,
    finder: Finder,
    found: Vec<Blob>,
    /// For each frame looked at, its spots.
    frames: Vec<(u64, Vec<Candidate>)>,
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
        let rows: Vec<Vec<Mark>> = frames.iter().map(|marks| row(marks)).collect();
        let Some(best) = self.best(&rows) else { return Err(nothing) };
        let mut marks = path(&rows[best]);
        let restless = |end: &Mark| -> f64 {
            let moves = frames.iter().filter_map(|marks| {
                let nearest = marks.iter().filter(|mark| mark.colour == end.colour);
                nearest.map(|mark| distance(mark.at_px, end.at_px)).min_by(f64::total_cmp)
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
            if distance(other[0].at_px, hand) > distance(other[other.len() - 1].at_px, hand) {
                other.reverse();
            }
            total_turn(&other)
        });
        let turn = turns.max_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(0.0);
        let first = self.frames[best].0 == 0;
        Ok(text::marker_file(&marks, &colours, turn, first, self.info))
    }

    /// The frame to start from: the first one, if its row is about as long as most; none where no row is a marker's.
    fn best(&self, rows: &[Vec<Mark>]) -> Option<usize> {
        let mut counts: Vec<usize> = rows.iter().map(Vec::len).filter(|&count| count > 0).collect();
        counts.sort_unstable_by(|a, b| b.cmp(a));
        let usual = *counts.get((PERSISTENCE * counts.len() as f64) as usize)?;
        let alike = |row: &Vec<Mark>| !row.is_empty() && row.len().abs_diff(usual) <= usize::from(usual > 1);
        let few = rows.len() < FEW_FRAMES;
        let steady = rows.iter().filter(|row| alike(row)).count() as f64 >= STEADY * rows.len() as f64;
        let best = if alike(&rows[0]) { 0 } else { rows.iter().position(|row| row.len() == usual)? };
        let all = || rows.iter().filter(|row| alike(row)).flatten();
        let on_skin = 2 * all().filter(|mark| mark.on_skin).count() > all().count();
        // From its place in that frame, the nearest of its colour in the others.
        let moves = rows[best].iter().any(|mark| {
            let others = rows.iter().filter(|row| row.len() == rows[best].len()).filter_map(|row| {
                let of_colour = row.iter().filter(|other| other.colour == mark.colour);
                of_colour.map(|other| distance(other.at_px, mark.at_px)).min_by(f64::total_cmp)
            });
            others.fold(0.0, f64::max) > mark.radius_px
        });
        // A thing by itself may lie before any ground, and many things lie about on one.
        let as_many = rows.iter().filter(|row| row.len() == usual).count() as f64 >= STEADY * rows.len() as f64;
        let likely = if usual > 1 { on_skin || (moves && as_many) } else { moves };
        (few || (steady && likely)).then_some(best)
    }

    /// The spots of a frame that could be markers.
    fn spots(&mut self, frame: &Frame<'_>) -> Vec<Candidate> {
        let mut spots: Vec<Candidate> = Vec::new();
        self.finder.load(frame, None);
        let paints = palette(self.info);
        let largest = LARGEST_RADIUS_SHARE * self.info.format.width as f64;
        for paint in &paints {
            self.finder.find(frame, paint, &mut self.found);
            for blob in &self.found {
                let Some(one) = candidate(frame, self.info.grey, blob) else { continue };
                if !(LEAST_RADIUS_PX..=largest).contains(&one.radius_px) {
                    continue;
                }
                let same = |other: &&mut Candidate| {
                    distance(other.at_px, one.at_px) < 0.7 * other.radius_px.max(one.radius_px)
                };
                match spots.iter_mut().find(same) {
                    Some(other) if other.contrast < one.contrast => *other = one,
                    Some(_) => {}
                    None => spots.push(one),
                }
            }
        }
        let best = spots.iter().map(|spot| spot.contrast).fold(0.0, f64::max);
        spots.retain(|spot| spot.contrast >= LEAST_OF_BEST * best);
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
                let colour = spot.colour;
                let group = groups.iter().position(|(members, _)| is_same(&mean(members), &colour, grey));
                let group = group.unwrap_or_else(|| {
                    groups.push((Vec::new(), vec![false; self.frames.len()]));
                    groups.len() - 1
                });
                groups[group].0.push(colour);
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
                    .map(|(spot, &colour)| Mark {
                        at_px: spot.at_px,
                        radius_px: spot.radius_px,
                        colour,
                        on_skin: spot.on_skin,
                    })
                    .collect()
            })
            .collect();
        (groups.iter().map(|(members, _)| mean(members)).collect(), frames)
    }
}

/// Paints of all hues; black and white in grey video.
pub(super) fn palette(info: &Info) -> Vec<Paint> {
    if info.grey {
        return [[0; 3], [255; 3]].map(|colour| Paint::new(colour, &info.matrix, true)).to_vec();
    }
    let hue = |k: usize| std::f64::consts::TAU * k as f64 / HUES as f64;
    (0..HUES).map(|k| Paint::chromatic([DISTANCE * hue(k).cos(), DISTANCE * hue(k).sin()])).collect()
}

fn mean(members: &[[f64; 3]]) -> [f64; 3] {
    [0, 1, 2].map(|k| members.iter().map(|colour| colour[k]).sum::<f64>() / members.len().max(1) as f64)
}

/// A spot as a marker, by its outline where it has one; none where it is skin, or stands out too little.
fn candidate(frame: &Frame<'_>, grey: bool, blob: &Blob) -> Option<Candidate> {
    let is_skin = |colour: [f64; 3]| !grey && is_skin(colour);
    if blob.contrast < LEAST_SHARE || blob.at_the_border || is_skin(blob.colour) {
        return None;
    }
    // What is larger than marks of paint are shows some spot of its own.
    let outline = Blot::at(frame, Siting::usual(frame), blob.at_px);
    let outline = outline.filter(|outline| outline.radius_px() >= LEAST_OF_BLOB * blob.radius_px());
    let (at_px, radius_px, colour, around) = match outline {
        Some(outline) => (outline.at_px, outline.radius_px(), outline.marker, outline.background),
        None if blob.elongation <= LONGEST && blob.fill >= LEAST_FILL => {
            let around = loose_look(frame, &Point::new(frame.index, blob)).background;
            (blob.at_px, blob.radius_px(), blob.colour, around)
        }
        None => return None,
    };
    let [luma, cb, cr] = [0, 1, 2].map(|p| colour[p] - around[p]);
    let contrast = if grey { luma.abs() } else { cb.hypot(cr) };
    let stands_out = contrast >= LEAST_CONTRAST && !is_skin(colour);
    stands_out.then_some(Candidate { at_px, radius_px, colour, contrast, on_skin: grey || self::is_skin(around) })
}

/// Whether a colour may be skin's.
fn is_skin(colour: [f64; 3]) -> bool {
    let [cb, cr] = [colour[1] - 128.0, colour[2] - 128.0];
    (SKIN_CB.0..=SKIN_CB.1).contains(&cb) && (SKIN_CR.0..=SKIN_CR.1).contains(&cr) && cb.hypot(cr) <= SKIN_DISTANCE
}

fn is_same(a: &[f64; 3], b: &[f64; 3], grey: bool) -> bool {
    if grey {
        return (a[0] - b[0]).abs() < 40.0;
    }
    let [a, b] = [a, b].map(|colour| [colour[1] - 128.0, colour[2] - 128.0]);
    let turn = (a[0] * b[1] - a[1] * b[0]).atan2(a[0] * b[0] + a[1] * b[1]);
    let factor = (a[0].hypot(a[1]).max(1.0) / b[0].hypot(b[1]).max(1.0)).ln().abs();
    let turned = SAME_HUE_RAD.max(HUE_NOISE / a[0].hypot(a[1]).min(b[0].hypot(b[1])).max(1.0));
    turn.abs() < turned && factor < SAME_DISTANCE_FACTOR.ln()
}

#[cfg(test)]
mod tests;
