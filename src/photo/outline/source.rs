//! The nails of one photograph, from whichever source knows them.
//!
//! The first of: the manifest's outline, `<stem>.json` beside the photograph, a mask of the same stem, detection. Of
//! what is not needed nothing is done: an annotated photograph is not searched. A nail whose outline or axis is not
//! trusted is listed with the reason and left out, not guessed: so is one whose drawn axis, or `--distal`, the picture
//! surely contradicts, save where both say the same.

use std::path::{Path, PathBuf};

use thiserror::Error;

use super::annotated::{self, Annotated, AnnotationFault, Drawn};
use super::axis::{Verdict, agree, turned_since, verdict};
use super::{
    Axis, DetectOptions, Detected, FoundAxis, MaskFault, MaskValues, NothingFound, Outline, Refused, Side, detect,
    find_axes, find_axes_towards, outlines_from_mask, outlines_of_values,
};
use crate::input::encoded_otherwise;
use crate::photo::set::Photo;
use crate::photograph::{MOST_MEGAPIXELS, PICTURES, Photograph, ReadFault, is_picture};
use crate::vision::VisionError;

/// Which sources may be asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Sources {
    /// Drawn where there is one, else detected
    #[default]
    Auto,
    /// Only what is drawn: manifest, LabelMe, masks
    Annotated,
    /// Only detection, whatever is drawn
    Detect,
}

/// Where outlines come from.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct OutlineOptions {
    /// Where outlines may come from
    #[arg(long = "outline", value_enum, default_value = "auto")]
    pub sources: Sources,
    /// Only what the set lists: nothing is looked for beside photographs.
    #[arg(skip)]
    pub listed_only: bool,
    /// Masks named as the photographs: `<pose>/<stem>.*` or `<stem>.*`.
    #[arg(skip)]
    pub masks: Option<PathBuf>,
    /// Which values of masks are nail, as 255 or 250..255, in the mask's own units [default: a mask has two values]
    #[arg(long = "mask-value", value_name = "VALUES")]
    pub mask_values: Option<MaskValues>,
    /// Side of the picture that the distal ends point to, for outlines without an axis [default: found in each picture]
    #[arg(long, value_enum)]
    pub distal: Option<Side>,
    /// Whether annotations and masks were drawn on the upright or the stored picture, where EXIF turns it and its size
    /// doesn't show which
    #[arg(long = "annotations", value_enum, default_value = "auto")]
    pub drawn: Drawn,
    /// How nails are looked for where none is drawn.
    #[command(flatten)]
    pub detect: DetectOptions,
}

/// Where an outline came from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Source {
    /// A person, in LabelMe.
    Annotated,
    /// A region of a mask.
    Mask,
    /// The picture itself.
    Detected,
}

impl Source {
    /// As tables name it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Annotated => "annotated",
            Self::Mask => "mask",
            Self::Detected => "detected",
        }
    }
}

/// A hand draws so far beyond the edge of the photograph, pixels (assumed).
const BEYOND_PX: f64 = 2.0;

/// Regions of a mask touch where they are so many pixels, or this share of the smaller one's extent, from each other
/// (assumed: a line of three pixels divides them; nails of neighbouring fingers are a tenth of their width apart) ..
const GAP_PX: f64 = 3.5;
const GAP_SHARE: f64 = 0.06;
/// .. along this share of one's border (assumed: half a nail has a quarter to a third of its own where it was cut).
const TOUCHING_SHARE: f64 = 0.2;

/// A nail with all that the next step needs, or what is known of one that is left out.
#[derive(Debug, Clone)]
pub struct Nail {
    /// Where its outline came from.
    pub source: Source,
    /// Its outline, where there is one.
    pub outline: Option<Outline>,
    /// Its axis, where it is known.
    pub axis: Option<Axis>,
    /// 1 for what a person drew; else how sure outline and axis are, 0 to 1.
    pub confidence: Option<f64>,
    /// By how much the picture sees a drawn axis slant, degrees clockwise, where that is much.
    pub slants_deg: Option<f64>,
    /// The number, from 1, of an earlier nail of the photograph that is drawn around the same place.
    pub drawn_over: Option<usize>,
    /// The number, from 1, of an earlier region of its mask that it touches along a long border.
    pub touches: Option<usize>,
    /// Why it is left out; empty for one that is used.
    pub reason: String,
}

impl Nail {
    fn drawn(source: Source, outline: Outline, axis: Option<Axis>) -> Self {
        let confidence = Some(1.0);
        Self { outline: Some(outline), axis, confidence, ..Self::left_out(source, String::new()) }
    }

    /// Leaves it out.
    fn doubt(&mut self, reason: String) {
        (self.reason, self.confidence) = (reason, None);
    }

    /// Whether a drawn outline seems to be of a picture of another size: it reaches beyond the photograph, of `width`
    /// and `height`, or around it no finger is seen as it should be.
    pub(in crate::photo) fn may_be_scaled(&self, [width, height]: [u32; 2]) -> bool {
        let Some(outline) = &self.outline else { return false };
        let ends = |at: f64, side: u32| (-BEYOND_PX..f64::from(side) + BEYOND_PX).contains(&at);
        let is_within = |[x, y]: &[f64; 2]| ends(*x, width) && ends(*y, height);
        self.slants_deg.is_some() || !self.reason.is_empty() || !outline.points().iter().all(is_within)
    }

    fn left_out(source: Source, reason: String) -> Self {
        Self {
            source,
            outline: None,
            axis: None,
            confidence: None,
            slants_deg: None,
            drawn_over: None,
            touches: None,
            reason,
        }
    }

    /// As it was drawn in LabelMe; `file` begins what is said of its fault.
    pub(crate) fn annotated(Annotated { outline, axis }: Annotated, file: &str) -> Self {
        match outline {
            Ok(outline) => Self::drawn(Source::Annotated, outline, axis),
            Err(fault) => Self::left_out(Source::Annotated, format!("{file}{fault}")),
        }
    }
}

/// What a photograph gave.
#[derive(Debug, Clone)]
pub struct Listed {
    /// Its nails in the source's order; at least one, used or not.
    pub nails: Vec<Nail>,
    /// Places that detection refused.
    pub refused: Vec<Refused>,
    /// The picture that a LabelMe file says it was drawn on, relative to the file.
    pub image_path: Option<String>,
    /// Whether outlines may be of a picture of another size: a LabelMe file that doesn't say it.
    pub of_unknown_size: bool,
}

impl From<Vec<Nail>> for Listed {
    fn from(nails: Vec<Nail>) -> Self {
        Self { nails, refused: Vec::new(), image_path: None, of_unknown_size: false }
    }
}

/// Why a photograph has no nails to list.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum SourceFault {
    #[error(transparent)]
    Annotation(#[from] AnnotationFault),
    #[error("the mask {} {why}", .file.display())]
    MaskFile { file: PathBuf, why: ReadFault },
    #[error("the mask {}: {why}", .file.display())]
    Mask { file: PathBuf, why: MaskFault },
    #[error("the mask {} is all black; paint its nails white", .0.display())]
    EmptyMask(PathBuf),
    /// Annotated outlines only, and there is none.
    #[error("has no outline: no outline column, no LabelMe file beside it{}; draw one, or let --outline auto detect it",
        if *.masks { ", no mask" } else { "" })]
    NotAnnotated {
        /// Whether masks were looked for.
        masks: bool,
    },
    #[error(transparent)]
    Vision(#[from] VisionError),
    #[error("{why}; draw its outline in LabelMe, label it `nail` and save it beside the photograph")]
    NotFound {
        why: NothingFound,
        /// Places that detection refused.
        refused: Vec<Refused>,
    },
}

/// Where a photograph's outlines will come from, known without opening it.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum OutlinePlace {
    /// A LabelMe file.
    LabelMe(PathBuf),
    /// A mask.
    Mask(PathBuf),
    /// Nothing drawn: detection.
    Detection,
    /// Nothing drawn, and detection is not wanted.
    #[default]
    Nowhere,
}

impl OutlinePlace {
    /// A file of outlines: a picture is a mask.
    pub(crate) fn of_file(file: PathBuf) -> Self {
        if is_picture(&file) { Self::Mask(file) } else { Self::LabelMe(file) }
    }
}

impl OutlineOptions {
    /// The first source that has something for `photo`.
    pub fn locate(&self, photo: &Photo) -> OutlinePlace {
        if self.sources == Sources::Detect {
            return OutlinePlace::Detection;
        }
        if let Some(outline) = &photo.outline {
            return OutlinePlace::of_file(outline.clone());
        }
        let beside = photo.path.with_extension("json");
        if beside.is_file() && !self.listed_only {
            return OutlinePlace::LabelMe(beside);
        }
        if let Some(mask) = self.masks.as_ref().and_then(|folder| mask_of(folder, photo)) {
            return OutlinePlace::Mask(mask);
        }
        if self.sources == Sources::Annotated { OutlinePlace::Nowhere } else { OutlinePlace::Detection }
    }

    /// What would be the outline of `photo` if its accents were encoded as the photograph's are.
    pub(in crate::photo) fn encoded_otherwise(&self, photo: &Photo) -> Option<PathBuf> {
        if self.sources == Sources::Detect {
            return None;
        }
        let is_labelme = |other: &Path| other.extension().is_some_and(|ending| ending == "json");
        let beside = encoded_otherwise(&photo.path, is_labelme).filter(|_| !self.listed_only);
        let name = photo.path.file_name()?;
        let mask = |folder: &PathBuf| {
            let places = [folder.join(&photo.pose), folder.to_owned()];
            places.iter().find_map(|place| encoded_otherwise(&place.join(name), is_picture))
        };
        beside.or_else(|| self.masks.as_ref().and_then(mask))
    }

    /// The nails of an opened photograph whose outlines come from `place`.
    ///
    /// # Errors
    /// [`SourceFault`] where there is nothing to list.
    pub fn nails(&self, place: &OutlinePlace, picture: &Photograph) -> Result<Listed, SourceFault> {
        match place {
            OutlinePlace::LabelMe(file) => self.annotated_nails(file, picture),
            OutlinePlace::Mask(file) => self.mask_nails(file, picture).map(Listed::from),
            OutlinePlace::Detection => self.detected_nails(picture),
            OutlinePlace::Nowhere => Err(SourceFault::NotAnnotated { masks: self.masks.is_some() }),
        }
    }

    fn annotated_nails(&self, file: &Path, picture: &Photograph) -> Result<Listed, SourceFault> {
        let annotation = annotated::read(file, picture, self.drawn)?;
        // A row of the results does not depend on where the photographs are.
        let name = format!("{}: ", file.file_name().unwrap_or_default().to_string_lossy());
        let mut nails: Vec<Nail> = annotation.nails.into_iter().map(|one| Nail::annotated(one, &name)).collect();
        self.complete_axes(picture, &mut nails);
        find_drawn_over(&mut nails);
        let (image_path, of_unknown_size) = (Some(annotation.image_path), !annotation.has_size);
        Ok(Listed { image_path, of_unknown_size, ..nails.into() })
    }

    fn mask_nails(&self, file: &Path, picture: &Photograph) -> Result<Vec<Nail>, SourceFault> {
        // A mask is as large as its photograph, which was read already.
        let megapixels = (u64::from(picture.image.width()) * u64::from(picture.image.height())).div_ceil(1_000_000);
        let megapixels = u32::try_from(megapixels).unwrap_or(u32::MAX).max(MOST_MEGAPIXELS);
        let mut mask = Photograph::read_up_to(file, megapixels)
            .map_err(|why| SourceFault::MaskFile { file: file.to_owned(), why })?
            .image;
        let size = [mask.width(), mask.height()];
        if self.drawn.is_stored(Some(size), picture, &file.display().to_string())? {
            mask.apply_orientation(picture.orientation);
        }
        let regions = match self.mask_values {
            Some(values) => outlines_of_values(&mask, values),
            None => outlines_from_mask(&mask),
        }
        .map_err(|why| SourceFault::Mask { file: file.to_owned(), why })?;
        let too_large = regions.too_large(f64::from(mask.width()) * f64::from(mask.height()));
        let mut nails: Vec<Nail> =
            regions.nails.into_iter().map(|outline| Nail::drawn(Source::Mask, outline, None)).collect();
        find_touching(&mut nails);
        self.complete_axes(picture, &mut nails);
        for (nail, why) in nails.iter_mut().zip(too_large) {
            if let Some(why) = why {
                nail.doubt(format!("{why} Erase it from the mask where it is."));
            }
        }
        if nails.is_empty() && regions.dropped.is_empty() {
            return Err(SourceFault::EmptyMask(file.to_owned()));
        }
        nails.extend(regions.dropped.into_iter().map(|d| Nail::left_out(Source::Mask, d.to_string())));
        Ok(nails)
    }

    fn detected_nails(&self, picture: &Photograph) -> Result<Listed, SourceFault> {
        let found = detect(&picture.image, &self.detect)?;
        let refused = found.refused;
        if found.nails.is_empty() && found.doubtful.is_empty() {
            return Err(SourceFault::NotFound { why: found.note.unwrap_or(NothingFound::NoPlace), refused });
        }
        let used = found.nails.into_iter().map(|n| (n, String::new()));
        let doubtful = found.doubtful.into_iter().map(|n| {
            let reason = format!(
                "the outline found is not trusted (confidence {}, {} is needed); correct it with `lunula edit`, or in \
                 LabelMe (--write-outlines)",
                hundredths(n.confidence),
                found.needed
            );
            (n, reason)
        });
        let nail = |(n, reason): (Detected, String)| {
            let drawn = Nail::drawn(Source::Detected, n.outline, Some(n.axis));
            Nail { confidence: Some(n.confidence), reason, ..drawn }
        };
        let nails: Vec<Nail> = used.chain(doubtful).map(nail).collect();
        Ok(Listed { refused, ..nails.into() })
    }

    /// Looks for the axes that nobody drew, and doubts those that the picture surely contradicts.
    pub(crate) fn complete_axes(&self, picture: &Photograph, nails: &mut [Nail]) {
        self.doubt_drawn(picture, nails);
        let open: Vec<usize> =
            (0..nails.len()).filter(|&k| nails[k].outline.is_some() && nails[k].axis.is_none()).collect();
        let outlines: Vec<Outline> = open.iter().filter_map(|&k| nails[k].outline.clone()).collect();
        if let Some(side) = self.distal {
            for (&k, axis) in open.iter().zip(find_axes_towards(&picture.image, &outlines, side)) {
                nails[k].axis = Some(axis);
                let Some(outline) = &nails[k].outline else { continue };
                if let (Verdict::Contradicts(found), _) = verdict(&picture.image, outline, axis) {
                    nails[k].doubt(format!(
                        "by --distal its {}; draw its `axis` in LabelMe, and where both are given alike they are \
                         believed",
                        contradicted(axis, &found)
                    ));
                }
            }
        } else if !outlines.is_empty() {
            for (&k, found) in open.iter().zip(find_axes(&picture.image, &outlines)) {
                match found {
                    Ok(found) => {
                        nails[k].axis = Some(found.axis);
                        nails[k].confidence = Some(found.confidence);
                    }
                    Err(unknown) => nails[k].doubt(unknown.to_string()),
                }
            }
        }
    }
}

impl OutlineOptions {
    /// Doubts drawn axes that the picture surely contradicts, and all of an annotation that fits the turned picture
    /// better. Where `--distal` says the same as a drawn axis, that is believed.
    fn doubt_drawn(&self, picture: &Photograph, nails: &mut [Nail]) {
        let image = &picture.image;
        let mut drawn = Vec::new();
        let mut sure = true;
        for (k, nail) in nails.iter_mut().enumerate() {
            let (Some(outline), Some(axis)) = (&nail.outline, nail.axis) else { continue };
            if self.distal.is_some_and(|side| agree(side.axis(), axis)) {
                continue;
            }
            let (said, fit) = verdict(image, outline, axis);
            drawn.push((k, fit));
            match said {
                Verdict::Agrees => {}
                Verdict::Slants(by_deg) => nail.slants_deg = Some(by_deg),
                Verdict::Silent => sure = false,
                Verdict::Contradicts(found) => {
                    sure = false;
                    nail.doubt(format!(
                        "its drawn {}; correct the line, or, where it is right, say --distal as well",
                        contradicted(axis, &found)
                    ));
                }
            }
        }
        if sure {
            return;
        }
        let drawn_nail = |&(k, fit): &(usize, Option<f64>)| {
            let nail = &nails[k];
            Some((nail.outline.as_ref()?, nail.axis?, fit))
        };
        let all: Vec<_> = drawn.iter().filter_map(drawn_nail).collect();
        let Some(turned) = turned_since(image, &all) else { return };
        for (k, _) in drawn {
            let also = if nails[k].reason.is_empty() { "" } else { "; " };
            nails[k].reason += &format!(
                "{also}the annotation fits the picture better {turned}: was the picture turned after it was drawn? \
                 draw it again on the picture as it is, or, where it is right, say --distal as well"
            );
            nails[k].confidence = None;
        }
    }
}

/// Finds nails that are drawn more than once.
fn find_drawn_over(nails: &mut [Nail]) {
    for k in 1..nails.len() {
        let Some(outline) = &nails[k].outline else { continue };
        let is_one = |earlier: &Nail| earlier.outline.as_ref().is_some_and(|earlier| earlier.is_around(outline));
        nails[k].drawn_over = nails[..k].iter().position(is_one).map(|earlier| earlier + 1);
    }
}

/// Finds regions of a mask that are parts of one nail: they touch, or continue each other across a thin line.
fn find_touching(nails: &mut [Nail]) {
    for k in 1..nails.len() {
        let Some(outline) = &nails[k].outline else { continue };
        let is_beside = |earlier: &Nail| {
            let Some(earlier) = &earlier.outline else { return false };
            let extent_px = outline.area_px2().min(earlier.area_px2()).sqrt();
            let gap_px = GAP_PX.min(GAP_SHARE * extent_px);
            outline.share_beside(earlier, gap_px).max(earlier.share_beside(outline, gap_px)) >= TOUCHING_SHARE
        };
        nails[k].touches = nails[..k].iter().position(is_beside).map(|earlier| earlier + 1);
    }
}

/// A nail's axis and what the picture says of it, in words.
fn contradicted(axis: Axis, found: &FoundAxis) -> String {
    let [deg, found_deg] = [axis, found.axis].map(Axis::clockwise_deg);
    let sure = found.confidence;
    format!("axis is at {deg:.0} degrees, by the picture at {found_deg:.0} (confidence {sure:.2}; clockwise from up)")
}

/// A confidence in words, cut off rather than rounded: 0.499 is less than 0.5.
pub(crate) fn hundredths(confidence: f64) -> String {
    format!("{:.2}", (100.0 * confidence).floor() / 100.0)
}

fn mask_of(folder: &Path, photo: &Photo) -> Option<PathBuf> {
    let stem = photo.path.file_stem()?.to_string_lossy();
    [folder.join(&photo.pose), folder.to_owned()].iter().find_map(|place| {
        let named = |ending: String| Some(place.join(format!("{stem}.{ending}"))).filter(|path| path.is_file());
        PICTURES.iter().find_map(|ending| named((*ending).to_owned()).or_else(|| named(ending.to_uppercase())))
    })
}
