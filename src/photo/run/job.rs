//! The photos job: a checked set and options in, results and report out; the one entry that command line, pipelines and
//! trade-offs call.
//!
//! Photographs are worked on side by side, each once from file to sums, and forgotten: memory does not grow with their
//! number. What cannot be used is listed and left out; the rest is done. Results are put in their places in one commit,
//! at the end.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use image::GrayAlphaImage;
use rayon::prelude::*;

use crate::files::{Places, Staging, WriteError};
use crate::job::Watch;
use crate::median::median_of;
use crate::photo::channels::{self, Cells, Compared, Sample};
use crate::photo::error::PhotosError;
use crate::photo::hues::Hues;
use crate::photo::normalize::{MOST_AT_FULL_SCALE, NailFrame, Normalized, Normalizer, detail, normalized_or_why};
use crate::photo::options::{OutlineHome, Outputs, PhotosOptions, Results};
use crate::photo::outline::{
    DetectedOutline, Listed, Nail, Outline, OutlinePlace, Refused, SavedOutlines, Source, SourceFault, keep_outlines,
    other_photograph, unlike,
};
use crate::photo::results::{self, DrawnPhotograph, DrawnPose, NailRow, NailTable, Scratch};
use crate::photo::run::plan::{Foreknown, left_out};
use crate::photo::run::report::{Findings, HTML, PhotosReport, PoseCount, of_photos};
use crate::photo::set::{Photo, PhotoSet, SetFault};
use crate::photo::sums::{Batch, Look, Member, Members, OF_A_PART};
use crate::photograph::{MOST_MEGAPIXELS, PhotoBuffer, Photograph, Profile};
use crate::stages::Stages;

/// Longest side of a thumbnail, pixels.
const THUMBNAIL_PX: usize = 100;
/// The lesser extent from which a found nail shows whether its photograph is sharp, pixels.
const LEAST_SHARP_PX: f64 = 25.0;

/// Runs the job and puts all its results in their places.
///
/// # Errors
/// [`PhotosError`] where there are no maps. What was found but is not used is reported all the same, and saved where
/// outlines are to be: it is what a person most needs to see.
pub fn run(
    set: &PhotoSet,
    options: &PhotosOptions,
    outputs: &Outputs,
    watch: &Watch<'_>,
) -> Result<PhotosReport, PhotosError> {
    let stages = Stages::default();
    let staging = Staging::new(&outputs.folder)?;
    let mut work =
        Work { options, outputs, staging: &staging, stages, poses: BTreeMap::new(), memory: Mutex::default() };
    for photo in &set.photos {
        let pose = work.poses.entry(&photo.pose).or_default();
        pose.get_mut().unwrap_or_else(PoisonError::into_inner).left += 1;
    }
    let finished = AtomicU64::new(0);
    let one = |(index, photo)| {
        watch.go_on()?;
        let done = work.photograph(index, photo)?;
        (watch.tick)(finished.fetch_add(1, Ordering::Relaxed) + 1, Some(set.photos.len() as u64));
        Ok(done)
    };
    let done: Vec<Done> =
        set.photos.par_iter().enumerate().with_max_len(1).map(one).collect::<Result<_, PhotosError>>()?;
    let stages = work.stages;

    let mut findings = Findings::new(set, options, outputs);
    let (mut detected, mut thumbnails, mut foreknown, mut drawn) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let mut samples = Vec::new();
    let (mut poses, mut without_maps, mut drawn_poses) = (Vec::new(), Vec::new(), Vec::new());
    let mut members = Members::new(options.normalization);
    for (photo, one) in set.photos.iter().zip(done) {
        findings.add(photo, one.grey, one.largest, one.profile.as_ref());
        findings.details.extend(one.detail.map(|detail| (photo, detail)));
        findings.looks.extend(one.look.map(|look| (photo, look)));
        findings.drawn_elsewhere.extend(one.drawn_on.map(|other| (photo, other)));
        findings.of_unknown_size.extend(one.size_unknown.map(|is_odd| (photo, is_odd)));
        if matches!(one.outlines, OutlinePlace::Detection | OutlinePlace::Nowhere) {
            findings.without_outline.push(photo);
        }
        foreknown.push(Foreknown { pose: photo.pose.clone(), grey: one.grey, outlines: one.outlines });
        for (row, thumbnail) in one.nails {
            findings.rows.push(row);
            thumbnails.push(thumbnail);
        }
        detected.extend(one.detected);
        samples.extend(one.cells.map(|cells| Sample { photo, cells }));
        drawn.extend(one.drawn.map(|picture| (photo.file.clone(), picture)));
        findings.failed.extend(one.fault);
        if let Some(PoseDone { subjects, drawn, member }) = one.pose {
            let pose = photo.pose.clone();
            drawn_poses.extend(drawn);
            member.into_iter().for_each(|member| members.add(&pose, member));
            if subjects > 0 { poses.push(PoseCount { pose, subjects }) } else { without_maps.push(pose) }
        }
    }
    findings.poses_without_maps(without_maps);
    findings.failed.sort();
    findings.left_out = left_out(&foreknown, options, outputs);
    findings.detects = foreknown.iter().any(|photo| photo.outlines == OutlinePlace::Detection);
    let mut places = Places::default();
    findings.outlines = save_outlines(&detected, set, outputs, &mut places)?;
    // A person needs to see what detection saw, then most of all; a request that is wrong changes nothing.
    let is_shown = !drawn.is_empty() && findings.detects;
    let nothing = findings.rows.iter().all(|row| row.normalized.is_none()).then(|| PhotosError::NothingUsable {
        report: is_shown.then(|| outputs.folder.join(HTML)),
        failed: findings.failed.clone(),
        outlines: findings.outlines.clone(),
    });
    let nothing = match nothing {
        Some(nothing) if !is_shown => {
            places.commit()?;
            return Err(nothing);
        }
        other => other,
    };

    let nails = NailTable::of(&findings.rows, thumbnails, set);
    let report = staging.sync_meanwhile(|| {
        let sheets = match outputs.results {
            Results::Sums { .. } => members.write(&staging, OF_A_PART).map(|()| None)?,
            Results::Maps => {
                let of_nails = || {
                    let mut sheets = results::draw_outlines(&drawn, &staging)?;
                    sheets.extend(nails.draw_sheets(&staging)?);
                    Ok::<_, WriteError>(sheets)
                };
                let (maps, of_nails) = rayon::join(
                    || stages.time("sheets", || results::draw_sheets(drawn_poses, &staging)),
                    || stages.time("sheets", of_nails),
                );
                Some((maps?, of_nails?))
            }
        };
        nails.write(&staging)?;
        let compared = compare_channels(&samples, options.normalization.linear, &staging, &stages)?;
        watch.go_on()?;
        let mut report = of_photos(findings, poses, watch).timed(&stages);
        if let Some(compared) = compared {
            report.notes.extend(compared.notes);
            report.warnings.extend(compared.warnings);
            report.channels = Some(compared.figures);
        }
        if let Some((maps, of_nails)) = sheets {
            report.write(&nails, &maps, &of_nails, &staging)?;
        }
        Ok::<_, PhotosError>(report)
    })?;
    staging.commit_with(places)?;
    nothing.map_or(Ok(report), Err)
}

/// Compares the channels of colour photographs, where that was requested and there are some.
fn compare_channels(
    samples: &[Sample<'_>],
    is_linear: bool,
    staging: &Staging,
    stages: &Stages,
) -> Result<Option<Compared>, WriteError> {
    if samples.is_empty() {
        return Ok(None);
    }
    stages.time("compare channels", || {
        let mut compared = channels::compare(samples, is_linear);
        channels::write(&mut compared.figures, staging)?;
        Ok(Some(compared))
    })
}

/// Saves detected outlines where they are to be saved, as far as `places`.
fn save_outlines(
    detected: &[DetectedOutline],
    set: &PhotoSet,
    outputs: &Outputs,
    places: &mut Places,
) -> Result<Option<SavedOutlines>, WriteError> {
    let folder = match &outputs.outlines {
        None => return Ok(None),
        Some(OutlineHome::BesidePhotographs) => None,
        Some(OutlineHome::Folder(folder)) => Some(folder.as_path()),
    };
    keep_outlines(detected, set, folder, places).map(Some)
}

/// What a photograph gave.
#[derive(Default)]
struct Done {
    nails: Vec<(NailRow, Option<GrayAlphaImage>)>,
    detected: Option<DetectedOutline>,
    /// With what was found, for the report.
    drawn: Option<DrawnPhotograph>,
    outlines: OutlinePlace,
    grey: Option<bool>,
    /// The largest sample as stored, of 16 bits.
    largest: Option<u16>,
    profile: Option<Profile>,
    /// Its nails in red, green and blue, where channels are compared and it has some.
    cells: Option<Cells>,
    fault: Option<SetFault>,
    /// How much fine detail the nails show that were found on it, the median.
    detail: Option<f64>,
    /// What it looks like, where a nail of it was used.
    look: Option<Look>,
    /// The photograph that its outlines say they were drawn on, where that is another.
    drawn_on: Option<PathBuf>,
    /// Where its LabelMe file doesn't say its picture's size: whether an outline seems to be of another.
    size_unknown: Option<bool>,
    /// Where it was the last of its pose.
    pose: Option<PoseDone>,
}

/// What a pose gave.
#[derive(Default)]
struct PoseDone {
    subjects: usize,
    drawn: Option<DrawnPose>,
    member: Option<Member>,
}

/// A pose while photographs are worked on.
#[derive(Default)]
struct Pose {
    /// From its first subject to its last photograph.
    batch: Option<Batch>,
    /// Photographs that are not done.
    left: usize,
}

/// Memory that goes from photograph to photograph.
#[derive(Default)]
struct Memory {
    photograph: PhotoBuffer,
    normalizer: Normalizer,
    pictures: Vec<Normalized>,
    scratch: Scratch,
}

/// What all photographs share.
struct Work<'a> {
    options: &'a PhotosOptions,
    outputs: &'a Outputs,
    staging: &'a Staging,
    stages: Stages,
    poses: BTreeMap<&'a str, Mutex<Pose>>,
    /// As many as there are threads at work at most; those that none uses.
    memory: Mutex<Vec<Memory>>,
}

impl Work<'_> {
    fn photograph(&self, index: usize, photo: &Photo) -> Result<Done, WriteError> {
        let mut memory = locked(&self.memory).pop().unwrap_or_default();
        let done = self.photograph_in(index, photo, &mut memory);
        locked(&self.memory).push(memory);
        Ok(Done { pose: self.end_of_pose(&photo.pose)?, ..done? })
    }

    /// Counts a photograph of the pose as done; with the last of them its maps are written and drawn, while its sums
    /// are at hand, and the next pose's take their memory.
    fn end_of_pose(&self, name: &str) -> Result<Option<PoseDone>, WriteError> {
        let mut pose = locked(&self.poses[name]);
        pose.left -= 1;
        if pose.left > 0 {
            return Ok(None);
        }
        let batch = pose.batch.take();
        drop(pose);
        let Some(sums) = batch.map(Batch::finish) else { return Ok(Some(PoseDone::default())) };
        let mut done = PoseDone { subjects: sums.subjects().len(), ..PoseDone::default() };
        let (with, staging, stages) = (&self.options.normalization, self.staging, &self.stages);
        match self.outputs.results {
            Results::Sums { .. } => done.member = Some(results::write_sums(name, &sums, with, staging, stages)?),
            Results::Maps => done.drawn = results::write_pose(name, &sums, with, true, staging, stages)?,
        }
        Ok(Some(done))
    }

    /// Read, outline, normalize, add up: once down, never back.
    fn photograph_in(&self, index: usize, photo: &Photo, memory: &mut Memory) -> Result<Done, WriteError> {
        let mut done = Done { outlines: self.options.outlines.locate(photo), ..Done::default() };
        let fault = |what: String| Some(SetFault { place: photo.file.clone(), what });
        let megapixels = self.options.max_megapixels.unwrap_or(MOST_MEGAPIXELS);
        let buffer = &mut memory.photograph;
        let mut picture = match self.stages.time("read", || Photograph::read_into(&photo.path, megapixels, buffer)) {
            Ok(picture) => picture,
            Err(why) => return Ok(Done { fault: fault(why.to_string()), ..done }),
        };
        let largest = picture.largest_of_16_bits();
        let with = &self.options.normalization;
        if let Some(Err(why)) = with.white.map(|white| picture.stretch_to(white)) {
            return Ok(Done { fault: fault(why.to_string()), ..done });
        }
        if let Some(Err(why)) = with.linear.then(|| picture.has_srgb_curve()) {
            return Ok(Done { fault: fault(why.to_string()), ..done });
        }
        let nails = self.stages.time("outline", || self.options.outlines.nails(&done.outlines, &picture));
        let may_draw = self.outputs.results == Results::Maps && index < results::MOST_DRAWN;
        let draw = |nails: &[Nail], refused: &[Refused]| {
            self.stages.time("outlines drawn", || results::drawn_outlines(&picture, nails, refused)).ok()
        };
        let Listed { nails, refused, image_path, of_unknown_size } = match nails {
            Ok(listed) => listed,
            Err(why) => {
                let refused = if let SourceFault::NotFound { refused, .. } = &why { Some(refused) } else { None };
                let drawn = refused.filter(|_| may_draw).and_then(|refused| draw(&[], refused));
                return Ok(Done { fault: fault(why.to_string()), drawn, ..done });
            }
        };
        if let (OutlinePlace::LabelMe(file), Some(image_path)) = (&done.outlines, &image_path) {
            done.drawn_on = other_photograph(file, image_path, &photo.path);
        }
        let size = [picture.image.width(), picture.image.height()];
        done.size_unknown = of_unknown_size.then(|| nails.iter().any(|nail| nail.may_be_scaled(size)));
        let mut found = if may_draw { nails.clone() } else { Vec::new() };
        done.detected = self.outputs.outlines.as_ref().and_then(|_| DetectedOutline::of(index, &picture, &nails));
        let several = nails.len() > 1;
        let is_checked = |nail: &Nail| self.options.check_outlines && nail.source != Source::Detected;
        let drawn: Vec<Option<&Outline>> =
            nails.iter().map(|nail| nail.outline.as_ref().filter(|_| is_checked(nail))).collect();
        let look = || unlike(&picture.image, &drawn);
        let timed = self.options.check_outlines;
        let unlike = match if timed { self.stages.time("check outlines", look) } else { look() } {
            Ok(unlike) => unlike,
            Err(why) => return Ok(Done { fault: fault(why.to_string()), ..done }),
        };
        let mut details = Vec::new();
        let Memory { normalizer, pictures, scratch, .. } = memory;
        for (number, (nail, seen)) in (1..).zip(nails.into_iter().zip(unlike)) {
            let mut row = NailRow::new(index, number, &nail);
            let mut thumbnail = None;
            match self.one_nail(&picture, nail, &mut row, normalizer) {
                Ok(normalized) => {
                    let margin = self.options.normalization.margin;
                    row.at_full_scale = normalized.at_full_scale(margin);
                    row.survey = Some(normalized.survey());
                    row.hues = row.frame.map(|frame| Hues::of(&picture.image, &frame)).unwrap_or_default();
                    row.instead = row.frame.zip(seen).map(|(frame, seen)| frame.instead(&seen));
                    row.reason = partly(&normalized, row.at_full_scale, margin);
                    let is_large = row.frame.is_some_and(|frame| frame.width_px.min(frame.length_px) >= LEAST_SHARP_PX);
                    if row.source == Source::Detected && is_large {
                        details.extend(detail(&normalized, margin));
                    }
                    let tail = if several { format!("-{number}") } else { String::new() };
                    let name = format!("normalized/{}/{}{tail}.png", photo.pose, photo.subject);
                    if self.outputs.has_pictures() {
                        self.stages.time("write pictures", || {
                            results::write_normalized(&normalized, picture.depth(), scratch, self.staging, &name)
                        })?;
                    }
                    row.normalized = Some(name);
                    // For the sheets of a report, which sums have none of.
                    let small = || results::thumbnail(&normalized, THUMBNAIL_PX);
                    thumbnail = (self.outputs.results == Results::Maps).then(small);
                    pictures.push(normalized);
                }
                Err(reason) => row.reason = reason,
            }
            if let Some(found) = found.get_mut(number - 1).filter(|_| row.normalized.is_none()) {
                // What detection trusted and the job does not is refused, not doubtful.
                found.confidence = found.confidence.filter(|_| !found.reason.is_empty());
                found.reason.clone_from(&row.reason);
            }
            done.nails.push((row, thumbnail));
        }
        done.detail = median_of(details);
        // Also of outlines that a person drew, where one of them is left out.
        if may_draw && (done.outlines == OutlinePlace::Detection || found.iter().any(|nail| !nail.reason.is_empty())) {
            done.drawn = draw(&found, &refused);
        }
        if pictures.is_empty() {
            done.fault = fault(match &done.nails[..] {
                [(only, _)] => only.reason.clone(),
                all => format!("none of its {} nails could be used; the first: {}", all.len(), all[0].0.reason),
            });
        } else {
            let look = self.stages.time("look", || Look::of(&picture.image));
            done.look = Some(look.clone());
            self.stages.time("add up", || {
                let mut pose = locked(&self.poses[photo.pose.as_str()]);
                let batch = pose.batch.get_or_insert_with(|| Batch::new(self.options.normalization.size));
                batch.describe(&photo.subject, picture.is_grey(), look);
                let added = batch.add(&photo.subject, pictures);
                added.expect("a set lists a subject once per pose");
            });
        }
        pictures.drain(..).for_each(|picture| normalizer.take_back(picture));
        (done.grey, done.largest) = (Some(picture.is_grey()), largest);
        done.profile = picture.profile.take();
        if self.outputs.compares_channels(self.options) && done.grey == Some(false) && done.fault.is_none() {
            let used = done.nails.iter().filter(|(row, _)| row.normalized.is_some());
            let frames: Vec<NailFrame> = used.filter_map(|(row, _)| row.frame).collect();
            let with = &self.options.normalization;
            done.cells = Some(self.stages.time("channels", || Cells::of(&picture.image, &frames, with, normalizer)));
        }
        buffer.take_back(picture);
        Ok(done)
    }

    /// The normalized picture, or why there is none.
    fn one_nail(
        &self,
        picture: &Photograph,
        nail: Nail,
        row: &mut NailRow,
        normalizer: &mut Normalizer,
    ) -> Result<Normalized, String> {
        if !nail.reason.is_empty() {
            return Err(nail.reason);
        }
        let (Some(outline), Some(axis)) = (nail.outline, nail.axis) else {
            return Err("its outline or axis is not known".into());
        };
        let frame = NailFrame::new(&outline, axis).map_err(|fault| fault.to_string())?;
        row.frame = Some(frame);
        let with = &self.options.normalization;
        self.stages.time("normalize", || normalized_or_why(&picture.image, (&outline, &frame), with, normalizer))
    }
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What share of the nail's box the photograph does not show, and what share of the nail is too bright, in words; empty
/// where it shows all.
fn partly(picture: &Normalized, at_full_scale: f64, margin: f64) -> String {
    let outside =
        outside(picture, margin).map(|share| format!("{share:.1} % of its box lies outside of the photograph"));
    let bright = (at_full_scale > MOST_AT_FULL_SCALE)
        .then(|| format!("{:.1} % of it is at full scale (overexposed)", 100.0 * at_full_scale));
    let all: Vec<String> = outside.into_iter().chain(bright).collect();
    if all.is_empty() { String::new() } else { format!("used, but {}", all.join("; ")) }
}

/// What share of the nail's box the photograph does not show, percent, if any.
fn outside(picture: &Normalized, margin: f64) -> Option<f64> {
    let seen = picture.seen.as_ref()?;
    let size = picture.size as f64;
    let edge = (size - size / margin) / 2.0;
    let in_box = |at: usize| (at as f64 + 0.5 - edge).clamp(0.0, size - 2.0 * edge) == at as f64 + 0.5 - edge;
    let rows = (0..picture.size).filter(|&r| in_box(r));
    let cells = rows.flat_map(|r| (0..picture.size).filter(|&c| in_box(c)).map(move |c| r * picture.size + c));
    let (all, missing) = cells.fold((0, 0), |(all, missing), at| (all + 1, missing + usize::from(!seen[at])));
    (missing > 0).then(|| 100.0 * missing as f64 / all as f64)
}
