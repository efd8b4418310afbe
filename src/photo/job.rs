//! The photos job: a checked set and options in, maps out; the one entry that command line, pipelines and trade-offs
//! call.
//!
//! Photographs are worked on side by side, each once from file to sums, and forgotten: memory does not grow with their
//! number. What cannot be used is listed and left out; the rest is done. Results go into a [`Staging`] as they come.

use std::collections::BTreeMap;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;
use thiserror::Error;

use super::frame::NailFrame;
use super::maps::Sums;
use super::nail_row::NailRow;
use super::normalization::Normalization;
use super::normalize::{Normalized, normalize};
use super::outline::{Nail, OutlineOptions, Source, ToDraw};
use super::partial::Partials;
use super::read::{MOST_MEGAPIXELS, Photograph};
use super::results;
use super::set::{Photo, PhotoSet, SetFault};
use crate::files::{Staging, WriteError};
use crate::stages::Stages;
use crate::words::shown;

/// What to do with a set.
#[derive(Debug, Clone, Default)]
pub struct PhotosOptions {
    /// How normalized pictures are made.
    pub normalization: Normalization,
    /// Where outlines come from.
    pub outlines: OutlineOptions,
    /// Megapixels up to which a photograph is read; `None`: [`MOST_MEGAPIXELS`].
    pub max_megapixels: Option<u32>,
    /// Save detected outlines as LabelMe files.
    pub keep_detected: bool,
    /// Write sums (`partials/`) instead of maps and figures: those of many such parts are [gathered](fn@super::gather)
    /// later.
    pub parts: Option<PartOptions>,
}

/// What of a part is written besides its sums.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PartOptions {
    /// The normalized pictures.
    pub pictures: bool,
}

/// A detected outline to be kept for a person.
#[derive(Debug, Clone)]
pub struct DetectedOutline {
    /// Index of its photograph in the set.
    pub photo: usize,
    /// Width and height of the upright photograph, pixels.
    pub size: [u32; 2],
    /// Trusted and doubtful ones.
    pub nails: Vec<ToDraw>,
}

/// What a photograph gave.
#[derive(Debug)]
struct Done {
    rows: Vec<NailRow>,
    detected: Option<DetectedOutline>,
    grey: Option<bool>,
    /// The largest sample as stored, of 16 bits.
    largest: Option<u16>,
    fault: Option<SetFault>,
}

/// What was done, what was left out, and how long it took.
#[derive(Debug)]
pub struct PhotosResult {
    /// Every nail, used or not, in the set's order.
    pub rows: Vec<NailRow>,
    /// Photographs that gave nothing, and entries of the set that could not be used; sorted.
    pub failed: Vec<SetFault>,
    /// What a reader of the maps should know.
    pub warnings: Vec<String>,
    /// What the scene did not need, with counts.
    pub left_out: Vec<String>,
    /// Sums of each pose.
    pub partials: Partials,
    /// Detected outlines, where they were to be kept.
    pub detected: Vec<DetectedOutline>,
    /// Time by stage.
    pub stages: Stages,
}

/// Why nothing was done.
#[derive(Debug, Error)]
pub enum PhotosError {
    /// The results can't be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// Not one usable nail.
    #[error("not one nail could be used, so there are no results:{}", list(.failed))]
    NothingUsable {
        /// Why, by photograph.
        failed: Vec<SetFault>,
        /// What was detected but not trusted, where it was to be kept: a person may correct it.
        detected: Vec<DetectedOutline>,
    },
    /// Stopped from outside.
    #[error("interrupted; nothing was written")]
    Interrupted,
}

fn list(failed: &[SetFault]) -> String {
    failed.iter().map(|fault| format!("\n  {}: {}", shown(&fault.place), fault.what)).collect()
}

/// A caller's view of a running job.
pub struct Watch<'a> {
    /// Becomes true where the job is to stop.
    pub stop: &'a AtomicBool,
    /// Called after each photograph, from any thread.
    pub tick: &'a (dyn Fn() + Sync),
}

/// Runs the job; results are in `staging`, not yet in their place.
///
/// # Errors
/// [`PhotosError`] where there is no result.
pub fn run(
    set: &PhotoSet,
    options: &PhotosOptions,
    staging: &Staging,
    watch: &Watch,
) -> Result<PhotosResult, PhotosError> {
    let stages = Stages::default();
    let sums: BTreeMap<&str, Mutex<Sums>> =
        set.poses().into_iter().map(|pose| (pose, Mutex::new(Sums::new(options.normalization.size)))).collect();
    let work = Work { options, staging, stages: &stages, sums: &sums };
    let done: Vec<Done> = set
        .photos
        .par_iter()
        .enumerate()
        .with_max_len(1)
        .map(|(index, photo)| {
            if watch.stop.load(Ordering::Relaxed) {
                return Err(PhotosError::Interrupted);
            }
            let done = work.photograph(index, photo)?;
            (watch.tick)();
            Ok(done)
        })
        .collect::<Result<_, PhotosError>>()?;

    let mut result = PhotosResult {
        rows: Vec::new(),
        failed: set.faults.clone(),
        warnings: Vec::new(),
        left_out: left_out(set, options, &done),
        partials: Partials { normalization: options.normalization, poses: BTreeMap::new() },
        detected: Vec::new(),
        stages: Stages::default(),
    };
    result.warnings.extend(mixed_poses(set, &done));
    result.warnings.extend(few_bits(options.normalization.white, &done));
    for one in done {
        result.rows.extend(one.rows);
        result.detected.extend(one.detected);
        result.failed.extend(one.fault);
    }
    result.failed.sort();
    if result.rows.iter().all(|r| r.normalized.is_none()) {
        return Err(PhotosError::NothingUsable { failed: result.failed, detected: result.detected });
    }
    for (pose, sums) in sums {
        let sums = sums.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
        let subjects = sums.subjects().len();
        match subjects {
            0 => result.warnings.push(format!("pose `{pose}`: no nail could be used, so it has no maps")),
            _ => {
                if subjects == 1 && options.parts.is_none() {
                    result.warnings.push(one_subject(pose));
                }
                result.partials.poses.insert(pose.to_owned(), sums);
            }
        }
    }
    if options.parts.is_some() {
        results::write_parts(&result.partials, staging, &stages)?;
    } else {
        results::write_maps(&result.partials, true, staging, &stages)?;
    }
    if watch.stop.load(Ordering::Relaxed) {
        return Err(PhotosError::Interrupted);
    }
    result.stages = stages;
    Ok(result)
}

struct Work<'a> {
    options: &'a PhotosOptions,
    staging: &'a Staging,
    stages: &'a Stages,
    sums: &'a BTreeMap<&'a str, Mutex<Sums>>,
}

/// Share of a nail's box outside of the photograph above which it is left out (assumed): of a nail of which less than
/// half is seen, length and width are guessed, and the outline is rather another picture's. Below, what is not seen is
/// missing.
const MOST_OUTSIDE: f64 = 0.5;
/// Longest side of a thumbnail, pixels.
const THUMBNAIL_PX: usize = 100;

impl Work<'_> {
    /// Read, outline, normalize, add up: once down, never back.
    fn photograph(&self, index: usize, photo: &Photo) -> Result<Done, WriteError> {
        let fault = |what: String| Done {
            rows: Vec::new(),
            detected: None,
            grey: None,
            largest: None,
            fault: Some(SetFault { place: photo.file.clone(), what }),
        };
        let megapixels = self.options.max_megapixels.unwrap_or(MOST_MEGAPIXELS);
        let mut picture = match self.stages.time("read", || Photograph::read_up_to(&photo.path, megapixels)) {
            Ok(picture) => picture,
            Err(why) => return Ok(fault(why.to_string())),
        };
        let largest = picture.largest_of_16_bits();
        if let Some(Err(why)) = self.options.normalization.white.map(|white| picture.stretch_to(white)) {
            return Ok(fault(why.to_string()));
        }
        let nails = match self.stages.time("outline", || self.options.outlines.nails(photo, &picture)) {
            Ok(nails) => nails,
            Err(why) => return Ok(fault(why.to_string())),
        };
        let detected = self.options.keep_detected.then(|| kept(index, &picture, &nails)).flatten();
        let several = nails.len() > 1;
        let mut rows = Vec::new();
        let mut pictures = Vec::new();
        for (number, nail) in (1..).zip(nails) {
            let mut row = NailRow {
                photo: index,
                number,
                source: nail.source,
                confidence: nail.confidence,
                frame: None,
                axis: nail.axis,
                normalized: None,
                reason: String::new(),
                thumbnail: None,
            };
            match self.one_nail(&picture, nail, &mut row) {
                Ok(normalized) => {
                    row.reason = unseen(&normalized, self.options.normalization.margin);
                    let tail = if several { format!("-{number}") } else { String::new() };
                    let name = format!("normalized/{}/{}{tail}.png", photo.pose, photo.subject);
                    if self.options.parts.is_none_or(|parts| parts.pictures) {
                        self.stages.time("write pictures", || {
                            results::write_normalized(&normalized, picture.depth(), self.staging, &name)
                        })?;
                    }
                    row.normalized = Some(name);
                    // For the sheets of a report, which a part has none of.
                    let small = || results::thumbnail(&normalized, THUMBNAIL_PX);
                    row.thumbnail = self.options.parts.is_none().then(small);
                    pictures.push(normalized);
                }
                Err(reason) => row.reason = reason,
            }
            rows.push(row);
        }
        let fault = pictures.is_empty().then(|| SetFault {
            place: photo.file.clone(),
            what: match &rows[..] {
                [only] => only.reason.clone(),
                _ => format!("none of its {} nails could be used; the first: {}", rows.len(), rows[0].reason),
            },
        });
        if !pictures.is_empty() {
            self.stages.time("add up", || {
                let mut sums = self.sums[photo.pose.as_str()].lock().unwrap_or_else(std::sync::PoisonError::into_inner);
                sums.add(&photo.subject, &pictures).expect("a set lists a subject once a pose");
            });
        }
        Ok(Done { rows, detected, grey: Some(picture.is_grey()), largest, fault })
    }

    /// The normalized picture, or why there is none.
    fn one_nail(&self, picture: &Photograph, nail: Nail, row: &mut NailRow) -> Result<Normalized, String> {
        if !nail.reason.is_empty() {
            return Err(nail.reason);
        }
        let (Some(outline), Some(axis)) = (nail.outline, nail.axis) else {
            return Err("its outline or axis is not known".into());
        };
        let frame = NailFrame::new(&outline, axis).map_err(|fault| fault.to_string())?;
        row.frame = Some(frame);
        let size = [picture.image.width(), picture.image.height()];
        let outside = frame.share_outside(size);
        if outside > MOST_OUTSIDE {
            return Err(format!(
                "{:.0} % of its box lies outside of the photograph ({} x {} px), more than {:.0} %; is the outline \
                 another picture's?",
                100.0 * outside,
                size[0],
                size[1],
                100.0 * MOST_OUTSIDE
            ));
        }
        let normalized =
            self.stages.time("normalize", || normalize(&picture.image, &frame, &self.options.normalization));
        if normalized.count_seen() == 0 {
            return Err("the photograph shows nothing of it (transparent or outside)".into());
        }
        Ok(normalized)
    }
}

/// What share of the nail's box the photograph does not show, in words; empty where it shows all.
fn unseen(picture: &Normalized, margin: f64) -> String {
    let Some(seen) = &picture.seen else { return String::new() };
    let size = picture.size as f64;
    let edge = (size - size / margin) / 2.0;
    let in_box = |at: usize| (at as f64 + 0.5 - edge).clamp(0.0, size - 2.0 * edge) == at as f64 + 0.5 - edge;
    let rows = (0..picture.size).filter(|&r| in_box(r));
    let cells = rows.flat_map(|r| (0..picture.size).filter(|&c| in_box(c)).map(move |c| r * picture.size + c));
    let (all, missing) = cells.fold((0, 0), |(all, missing), at| (all + 1, missing + usize::from(!seen[at])));
    if missing == 0 {
        return String::new();
    }
    format!("used, but {:.1} % of its box lies outside of the photograph", 100.0 * missing as f64 / all as f64)
}

fn kept(index: usize, picture: &Photograph, nails: &[Nail]) -> Option<DetectedOutline> {
    let found: Vec<_> = nails
        .iter()
        .filter(|n| n.source == Source::Detected)
        .filter_map(|n| {
            let confidence = n.confidence.unwrap_or(0.0);
            Some(ToDraw { outline: n.outline.clone()?, axis: n.axis?, confidence, trusted: n.reason.is_empty() })
        })
        .collect();
    let size = [picture.image.width(), picture.image.height()];
    (!found.is_empty()).then_some(DetectedOutline { photo: index, size, nails: found })
}

pub(super) fn one_subject(pose: &str) -> String {
    format!("pose `{pose}`: one subject, so no standard deviation (it needs two)")
}

/// What the scene did not need.
fn left_out(set: &PhotoSet, options: &PhotosOptions, done: &[Done]) -> Vec<String> {
    let mut left_out = Vec::new();
    let grey = done.iter().filter(|d| d.grey == Some(true)).count();
    if grey > 0 {
        left_out.push(format!("channel: not taken from {grey} grey photograph(s)"));
    }
    let known = |source: Source| done.iter().filter(|d| d.rows.first().is_some_and(|r| r.source == source)).count();
    let drawn = known(Source::Annotated) + known(Source::Mask);
    if drawn > 0 {
        left_out.push(format!("detection: not run on {drawn} photograph(s) whose outlines are known"));
    }
    if options.outlines.distal.is_some() && drawn > 0 {
        left_out.push("search for axes: --distal settles them".into());
    }
    if !options.normalization.linear {
        left_out.push("sRGB curve: values are as the file encodes them".into());
    }
    if set.poses().len() == 1 && options.parts.is_none() {
        left_out.push("comparison between poses: there is one".into());
    }
    left_out
}

/// Grey values are comparable with a colour photograph's green channel only if a green filter was used.
fn mixed_poses(set: &PhotoSet, done: &[Done]) -> Vec<String> {
    let mut counts: BTreeMap<&str, [usize; 2]> = BTreeMap::new();
    for (photo, done) in set.photos.iter().zip(done) {
        if let Some(grey) = done.grey {
            counts.entry(&photo.pose).or_default()[usize::from(grey)] += 1;
        }
    }
    counts
        .into_iter()
        .filter(|(_, [colour, grey])| *colour > 0 && *grey > 0)
        .map(|(pose, [colour, grey])| {
            format!(
                "pose `{pose}` mixes {colour} colour and {grey} grey photograph(s): grey values equal the green \
                 channel only where a green filter was used; else make maps of each kind apart"
            )
        })
        .collect()
}

/// Bits that cameras of science keep in 16; a set whose largest sample has no more is noted.
const FEW_BITS: [u32; 4] = [8, 10, 12, 14];

/// Photographs of 16 bits, of which none uses more than a quarter of full scale: values are a fraction of what they
/// should be.
fn few_bits(white: Option<u16>, done: &[Done]) -> Option<String> {
    let largest = done.iter().filter_map(|done| done.largest);
    let (count, largest) = largest.fold((0, 0), |(count, most), largest| (count + 1, largest.max(most)));
    let white_of = |bits: u32| (1_u32 << bits) - 1;
    let bits = FEW_BITS.into_iter().find(|bits| u32::from(largest) <= white_of(*bits))?;
    (white.is_none() && largest > 0).then(|| {
        format!(
            "the largest sample of the {count} photograph(s) of 16 bits is {largest} of 65535, as of {bits} bits kept \
             in 16: if they are, --white {} makes that full scale",
            white_of(bits)
        )
    })
}
