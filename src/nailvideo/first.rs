//! The first good frame: the nail's outline on it, drawn, from a mask or detected, by `photo`'s own means.

use std::path::{Path, PathBuf};

use image::metadata::Orientation;
use image::{DynamicImage, RgbImage};

use super::affine::Affine;
use super::grid::{Part, samples};
use super::options::NailVideoOptions;
use super::sample::{Colours, Planes};
use crate::labelme::LabelMe;
use crate::nail::Outline;
use crate::photo::outline::{Nail, OutlineOptions, OutlinePlace, Source, ToDraw, to_draw, to_file, unlike};
use crate::photo::{Hues, Mistaken, NailFrame, Photograph};
use crate::photograph::PICTURES;
use crate::video::{Frame, Info};

/// A nail narrower than this is refused: a photodiode's disc has under 5 pixels (assumed; nails of 40 px are followed
/// to 0.25 px).
pub(in crate::nailvideo) const LEAST_WIDTH_PX: f64 = 30.0;
/// Detection looks at one of so many frames, and so often.
const EVERY: u64 = 10;
const TRIES: u64 = 15;

/// The nail in the first good frame.
#[derive(Debug, Clone)]
pub(in crate::nailvideo) struct FirstNail {
    pub(in crate::nailvideo) outline: Outline,
    pub(in crate::nailvideo) frame: NailFrame,
    pub(in crate::nailvideo) source: Source,
    pub(in crate::nailvideo) confidence: Option<f64>,
    /// What its channels, and those of the skin below it, seem to be.
    pub(in crate::nailvideo) mistaken: Option<Mistaken>,
    /// What the network sees instead of a drawn outline, in words.
    pub(in crate::nailvideo) instead: Option<String>,
}

impl FirstNail {
    /// From half widths and half lengths (distal positive) to the shown picture's pixels.
    pub(in crate::nailvideo) fn frame_from_nail(&self) -> Affine {
        let NailFrame { center_px: [x, y], length_px, width_px, axis } = self.frame;
        let (right, distal) = (axis.right().map(|r| 0.5 * width_px * r), axis.distal().map(|d| 0.5 * length_px * d));
        Affine([right[0], distal[0], x, right[1], distal[1], y])
    }

    /// For a person to correct.
    pub(in crate::nailvideo) fn to_draw(&self) -> ToDraw {
        let confidence = self.confidence.unwrap_or(1.0);
        ToDraw { outline: self.outline.clone(), axis: self.frame.axis, confidence, trusted: true }
    }
}

/// A key of LabelMe files that are written here: the frame that they are drawn on, where that is not the first one.
pub(in crate::nailvideo) const DRAWN_ON: &str = "lunulaFrame";

/// Nails as a LabelMe file of a frame's picture beside it.
pub(in crate::nailvideo) fn labelme(nails: &[ToDraw], name: &str, picture: &Photograph, frame: u64) -> LabelMe {
    let mut file = to_file(name, picture, nails);
    if frame > 0 {
        file.other.insert(DRAWN_ON.to_owned(), frame.into());
    }
    file
}

/// Why a frame shows no nail to follow, in words for the user, and what was seen on it.
pub(in crate::nailvideo) struct NotOne {
    pub(in crate::nailvideo) why: String,
    pub(in crate::nailvideo) seen: Vec<ToDraw>,
}

/// Where the outline comes from.
#[derive(Debug, Clone)]
pub(in crate::nailvideo) struct Finder {
    place: OutlinePlace,
    options: OutlineOptions,
    /// The frame that the outline was drawn on.
    drawn_on: u64,
}

impl Finder {
    pub(in crate::nailvideo) fn new(outline: Option<&Path>, options: &NailVideoOptions) -> Self {
        let place = outline.map_or(OutlinePlace::Detection, |file| OutlinePlace::of_file(file.to_owned()));
        let drawn_on = match &place {
            // What is wrong with a file that can't be read is said where its nail is looked for.
            OutlinePlace::LabelMe(file) => {
                LabelMe::read(file).ok().and_then(|file| file.other.get(DRAWN_ON)?.as_u64()).unwrap_or(0)
            }
            _ => 0,
        };
        Self { place, options: OutlineOptions { distal: options.distal, ..OutlineOptions::default() }, drawn_on }
    }

    /// Whether a frame is looked at: for what was drawn the one that it was drawn on, for detection some of the first.
    pub(in crate::nailvideo) fn looks_at(&self, index: u64) -> bool {
        match self.place {
            OutlinePlace::Detection => index.is_multiple_of(EVERY) && index < EVERY * TRIES,
            _ => index == self.drawn_on,
        }
    }

    /// Whether later frames may show the nail.
    pub(in crate::nailvideo) fn may_look_on(&self, index: u64) -> bool {
        let last = if self.place == OutlinePlace::Detection { EVERY * (TRIES - 1) } else { self.drawn_on };
        index < last
    }

    /// Why there is no nail where no frame of `video` was looked at.
    pub(in crate::nailvideo) fn nowhere(&self, video: &Path) -> String {
        if self.place == OutlinePlace::Detection {
            return "no frame could be decoded".to_owned();
        }
        format!(
            "is drawn on frame {} of {} (counted from 0), which the video does not have, or which can't be decoded: \
             draw the nail on another frame in LabelMe and add that frame's number to the file, as \"{DRAWN_ON}\": 30, \
             or give no outline, and the nail is looked for",
            self.drawn_on,
            video.display()
        )
    }

    /// The nail on an upright frame.
    pub(in crate::nailvideo) fn find(&self, picture: &Photograph) -> Result<FirstNail, NotOne> {
        let listed = match (self.options.nails(&self.place, picture), &self.place) {
            (Ok(listed), _) => listed,
            (Err(_), OutlinePlace::Detection) => {
                return Err(NotOne { why: "no nail was found".to_owned(), seen: Vec::new() });
            }
            (Err(why), place) => {
                let why = why.to_string();
                // Who shows it names the file.
                let named = match place {
                    OutlinePlace::LabelMe(file) => format!("{}: ", file.display()),
                    _ => String::new(),
                };
                return Err(NotOne { why: why.strip_prefix(&named).unwrap_or(&why).to_owned(), seen: Vec::new() });
            }
        };
        let seen = to_draw(&listed.nails);
        let found = one_of(listed.nails, [picture.image.width(), picture.image.height()]);
        let nail = found.map_err(|why| NotOne { why, seen })?;
        let is_drawn = nail.source != Source::Detected;
        let seen = unlike(&picture.image, &[is_drawn.then_some(&nail.outline)]);
        let seen = seen.map_err(|why| NotOne { why: why.to_string(), seen: Vec::new() })?.pop().flatten();
        let instead = seen.map(|seen| nail.frame.instead(&seen));
        Ok(FirstNail { mistaken: Hues::of(&picture.image, &nail.frame).mistaken, instead, ..nail })
    }
}

/// The one nail that can be followed; the error is words for the user.
fn one_of(nails: Vec<Nail>, size: [u32; 2]) -> Result<FirstNail, String> {
    let width_px = |nail: &Nail| Some(NailFrame::new(nail.outline.as_ref()?, nail.axis?).ok()?.width_px);
    if let Some(widest) = nails.iter().filter_map(width_px).reduce(f64::max).filter(|widest| *widest < LEAST_WIDTH_PX) {
        return Err(narrow(if nails.len() > 1 { "the widest nail that is seen" } else { "the nail" }, widest));
    }
    let (used, refused): (Vec<Nail>, Vec<Nail>) = nails.into_iter().partition(|nail| nail.reason.is_empty());
    let mut whole = used.into_iter().filter_map(|nail| Some((nail.outline?, nail.axis?, nail.source, nail.confidence)));
    let (Some((outline, axis, source, confidence)), others) = (whole.next(), whole.count()) else {
        let doubtful = |nail: Nail| match nail.source {
            Source::Detected => "a nail was found without enough confidence".to_owned(),
            _ => nail.reason,
        };
        return Err(refused.into_iter().next().map_or_else(|| "no nail was found".to_owned(), doubtful));
    };
    if others > 0 {
        return Err(format!("{} nails are seen, and one is followed: draw that one alone", others + 1));
    }
    let frame = NailFrame::new(&outline, axis).map_err(|why| why.to_string())?;
    if frame.width_px < LEAST_WIDTH_PX {
        return Err(narrow("the only nail without doubt", frame.width_px));
    }
    if let Some(doubt) = frame.doubt(&outline, size) {
        return Err(format!("of the nail: {doubt}"));
    }
    Ok(FirstNail { outline, frame, source, confidence, mistaken: None, instead: None })
}

fn narrow(nail: &str, width_px: f64) -> String {
    format!("{nail} is {width_px:.0} px wide; {LEAST_WIDTH_PX} are the fewest: film it nearer or with more pixels")
}

/// A frame as it is shown, in red, green and blue.
pub(in crate::nailvideo) fn upright(frame: &Frame<'_>, info: &Info) -> Photograph {
    let part = Part::whole(&samples(frame.luma, info.turn.quarters()));
    let colours = Colours::of_part(frame, Planes::of(info), part);
    let picture = RgbImage::from_fn(part.size[0] as u32, part.size[1] as u32, |x, y| {
        image::Rgb(colours.at([f64::from(x), f64::from(y)]).map(|part| (255.0 * part).round().clamp(0.0, 255.0) as u8))
    });
    Photograph { image: DynamicImage::ImageRgb8(picture), orientation: Orientation::NoTransforms, profile: None }
}

/// The mask named as the video in a folder.
#[must_use]
pub fn mask_of(folder: &Path, video: &Path) -> Option<PathBuf> {
    let stem = video.file_stem()?.to_string_lossy();
    PICTURES.iter().map(|ending| folder.join(format!("{stem}.{ending}"))).find(|path| path.is_file())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_that_cannot_be_decoded_is_named_with_its_film() {
        let dir = tempfile::tempdir().expect("a folder");
        let outline = dir.path().join("outline.json");
        let mut file = LabelMe::new("first.png", 64, 48, Vec::new());
        let said = |file: &LabelMe| {
            file.write(&outline).expect("written");
            Finder::new(Some(&outline), &NailVideoOptions::default()).nowhere(Path::new("nv/film.mp4"))
        };
        let first = said(&file);
        assert!(first.starts_with("is drawn on frame 0 of nv/film.mp4 (counted from 0), which"), "{first}");
        assert!(first.contains("\"lunulaFrame\": 30"), "{first}");
        file.other.insert(DRAWN_ON.to_owned(), 7.into());
        assert!(said(&file).starts_with("is drawn on frame 7 of nv/film.mp4"), "{}", said(&file));
    }
}
