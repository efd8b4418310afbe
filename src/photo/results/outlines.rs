//! What was found, drawn over the photographs: used, doubtful and refused in three colours, for a person to see in one
//! look what happened.

use image::RgbImage;
use rayon::prelude::*;

use super::draw::DrawnSheet;
use crate::figure::{Sheet, Tile, TilePicture, text_coverage};
use crate::files::{Staging, WriteError};
use crate::nail::{Axis, Outline};
use crate::photo::outline::{Nail, Refusal, Refused, hundredths};
use crate::photograph::{Photograph, as_rgb8};
use crate::vision::{VisionError, closed_line, resized};

/// Photographs of a set that are drawn, the first ones: memory doesn't grow with the set.
pub(in crate::photo) const MOST_DRAWN: usize = 240;
/// Longest side of a drawn photograph, pixels.
const LONGEST_PX: usize = 360;
/// Photographs of a sheet; its first tile is the legend.
const PER_SHEET: usize = 23;
const PER_ROW: usize = 6;
/// Height of words on a photograph and of the legend's, pixels.
const WORD_PX: f32 = 13.0;
const LEGEND_PX: f32 = 16.0;
const INK: [u8; 3] = [34; 3];

/// What became of an outline.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Fate {
    Used,
    Doubtful,
    Refused,
}

impl Fate {
    fn of(nail: &Nail) -> Self {
        match nail.confidence {
            _ if nail.reason.is_empty() => Self::Used,
            Some(_) => Self::Doubtful,
            None => Self::Refused,
        }
    }

    fn colour(self) -> [u8; 3] {
        match self {
            Self::Used => [0, 205, 60],
            Self::Doubtful => [255, 200, 0],
            Self::Refused => [255, 70, 60],
        }
    }

    /// Of its line, pixels.
    fn thickness(self) -> u8 {
        if self == Self::Refused { 1 } else { 2 }
    }
}

/// A photograph, small, with the outlines found on it.
#[derive(Debug)]
pub(in crate::photo) struct DrawnPhotograph {
    picture: RgbImage,
    /// How many were used, doubtful, refused.
    counts: [usize; 3],
}

struct Mark<'a> {
    outline: &'a Outline,
    axis: Option<Axis>,
    fate: Fate,
    /// Beside it, what the legend explains.
    word: String,
}

impl<'a> Mark<'a> {
    fn of_refused(Refused { outline, why }: &'a Refused) -> Self {
        let word = match why {
            Refusal::Unsure(confidence) => format!("{confidence:.3}"),
            Refusal::Overlapped(_) => "over".to_owned(),
            Refusal::NotSeenAgain(_) => "1x".to_owned(),
        };
        Self { outline, axis: None, fate: Fate::Refused, word }
    }

    fn of_nail(number: usize, nail: &'a Nail) -> Option<Self> {
        let fate = Fate::of(nail);
        let word = match nail.confidence {
            _ if fate == Fate::Used => String::new(),
            Some(confidence) => hundredths(confidence),
            None => format!("nail {number}"),
        };
        Some(Self { outline: nail.outline.as_ref()?, axis: nail.axis, fate, word })
    }
}

/// A photograph with its nails, `reason` of those that are not used being set, and the places that were refused.
pub(in crate::photo) fn drawn_outlines(
    picture: &Photograph,
    nails: &[Nail],
    refused: &[Refused],
) -> Result<DrawnPhotograph, VisionError> {
    let rgb = &*as_rgb8(&picture.image);
    let from = [rgb.width() as usize, rgb.height() as usize];
    let scale = (LONGEST_PX as f64 / from[0].max(from[1]) as f64).min(1.0);
    let size = from.map(|n| ((n as f64 * scale).round() as usize).max(1));
    let mut small = resized(rgb, from, size)?;
    let place = |p: [f64; 2]| [0, 1].map(|k| (p[k] + 0.5) * size[k] as f64 / from[k] as f64 - 0.5);
    let corners = |mark: &Mark<'_>| -> Vec<[f64; 2]> { mark.outline.points().into_iter().map(place).collect() };
    let nails = (1..).zip(nails).filter_map(|(number, nail)| Mark::of_nail(number, nail));
    let marks: Vec<Mark<'_>> = refused.iter().map(Mark::of_refused).chain(nails).collect();
    // No word hides an outline.
    for mark in &marks {
        let corners = corners(mark);
        let right = corners.iter().map(|c| c[0]).fold(0.0, f64::max);
        let top = corners.iter().map(|c| c[1]).fold(f64::INFINITY, f64::min);
        let pale = mark.fate.colour().map(|sample| sample.max(PALE));
        write_word(&mut small, size, &mark.word, [right + 3.0, top - 5.0], WORD_PX, pale, BEHIND_WORDS);
    }
    let mut counts = [0; 3];
    for mark in &marks {
        counts[mark.fate as usize] += 1;
        let (corners, colour) = (corners(mark), mark.fate.colour());
        closed_line(&mut small, size, &corners, colour, mark.fate.thickness())?;
        if let Some(axis) = mark.axis {
            // From the middle to the distal end.
            let middle = corners.iter().fold([0.0; 2], |sum, c| [0, 1].map(|k| sum[k] + c[k] / corners.len() as f64));
            let way = axis.distal();
            let reach = corners.iter().map(|c| (c[0] - middle[0]) * way[0] + (c[1] - middle[1]) * way[1]);
            let reach = reach.fold(0.0, f64::max);
            let end = [0, 1].map(|k| middle[k] + reach * way[k]);
            closed_line(&mut small, size, &[middle, end], colour, 1)?;
        }
    }
    let picture = RgbImage::from_raw(size[0] as u32, size[1] as u32, small).expect("three samples a pixel");
    Ok(DrawnPhotograph { picture, counts })
}

/// How much a photograph is darkened behind its words, and the least sample of their colour, to be read there.
const BEHIND_WORDS: f64 = 0.6;
const PALE: u8 = 130;

/// Writes `word` from its top left corner, moved so that all of it is seen; nothing where the picture is too small.
fn write_word(
    rgb: &mut [u8],
    size: [usize; 2],
    word: &str,
    corner: [f64; 2],
    height: f32,
    colour: [u8; 3],
    darker: f64,
) {
    let covered = text_coverage(word, height);
    let word_size = [covered.width() as usize, covered.height() as usize];
    if word.is_empty() || (0..2).any(|k| word_size[k] > size[k]) {
        return;
    }
    let [x0, y0] = [0, 1].map(|k| (corner[k].max(0.0) as usize).min(size[k] - word_size[k]));
    for (x, y, level) in covered.enumerate_pixels() {
        let at = 3 * ((y0 + y as usize) * size[0] + x0 + x as usize);
        let part = f64::from(level.0[0]) / 255.0;
        for (sample, ink) in rgb[at..at + 3].iter_mut().zip(colour) {
            *sample = (f64::from(*sample) * (1.0 - darker) * (1.0 - part) + f64::from(ink) * part).round() as u8;
        }
    }
}

/// What the colours and words of a sheet mean, and how many there are of each.
fn legend([used, doubtful, refused]: [usize; 3]) -> Result<RgbImage, VisionError> {
    let lines = [
        (Some(Fate::Used), format!("{used} used")),
        (Some(Fate::Doubtful), format!("{doubtful} doubtful, not used: its confidence")),
        (Some(Fate::Refused), format!("{refused} refused:")),
        (None, "nail 2: see the reason in the table of nails".to_owned()),
        (None, "0.012: its confidence, too low to be doubtful".to_owned()),
        (None, "1x: seen on one look, not on the closer one".to_owned()),
        (None, "over: a surer find lies over it".to_owned()),
        (None, String::new()),
        (None, "A line runs to the distal end.".to_owned()),
        (None, "Without an outline: nothing was found.".to_owned()),
    ];
    const LINE_PX: usize = 23;
    let size = [LONGEST_PX, LINE_PX * lines.len() + 10];
    let mut rgb = vec![255; 3 * size[0] * size[1]];
    for (line, (fate, words)) in lines.iter().enumerate() {
        let y = (LINE_PX * line + 5) as f64;
        if let Some(fate) = fate {
            let middle = y + 10.0;
            closed_line(&mut rgb, size, &[[4.0, middle], [30.0, middle]], fate.colour(), 2 * fate.thickness())?;
        }
        write_word(&mut rgb, size, words, [40.0, y], LEGEND_PX, INK, 0.0);
    }
    Ok(RgbImage::from_raw(size[0] as u32, size[1] as u32, rgb).expect("three samples a pixel"))
}

/// Draws the sheets of these photographs, each with its name, and writes them.
pub(in crate::photo) fn draw_outlines(
    photographs: &[(String, DrawnPhotograph)],
    staging: &Staging,
) -> Result<Vec<DrawnSheet>, WriteError> {
    let tile = |caption: &str, picture: RgbImage| {
        let picture = TilePicture::Colour(picture);
        Tile { caption: caption.to_owned(), picture, png: None }
    };
    let draw = |(at, photographs): (usize, &[(String, DrawnPhotograph)])| {
        let name = format!("figures/outlines-{}.png", at + 1);
        let counts = photographs.iter().fold([0; 3], |sum, (_, drawn)| [0, 1, 2].map(|k| sum[k] + drawn.counts[k]));
        let legend = legend(counts).map_err(|why| staging.refused(&name, why))?;
        let others = photographs.iter().map(|(caption, drawn)| tile(caption, drawn.picture.clone()));
        let tiles = std::iter::once(tile("", legend)).chain(others).collect();
        let title = format!("Outlines found, sheet {}", at + 1);
        let sheet = Sheet { title, tiles, columns: PER_ROW, scale: None };
        DrawnSheet::new(&sheet, &name, staging)
    };
    photographs.par_chunks(PER_SHEET).enumerate().map(draw).collect()
}
