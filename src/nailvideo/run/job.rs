//! The job: a video and options in, tables, maps and pictures out; the one entry that command line and pipelines call.
//!
//! A frame is decoded, the nail found in it by the motion since the first good frame, its photodiodes read, and the
//! frame forgotten. Of each frame a row of numbers is kept (some 32 bytes for each photodiode) until all are read: the
//! noise, and with it the standard errors, is known then.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use rayon::Scope;

use super::draw::{Thumbnails, draw};
use super::plan::{light_of, steps};
use super::report::{FrameCounts, MapFigures, NailFigures, NailVideoFigures, NailVideoReport, PhotodiodeFigures};
use super::results::{CellTable, Kept, MotionTable, Reading, photodiodes, presses};
use super::tint::tinted;
use super::traces::{ends, leaps, middle, repeated, traces};
use crate::figure::{encode_png, png};
use crate::files::Staging;
use crate::job::{Report, Watch};
use crate::nail::Positions;
use crate::nailvideo::affine::Affine;
use crate::nailvideo::error::NailVideoError;
use crate::nailvideo::first::{DRAWN_ON, Finder, FirstNail, NotOne, labelme, upright};
use crate::nailvideo::follow::{Follower, Lost, beyond_fine};
use crate::nailvideo::normal::{SIDE, WindowSums, green};
use crate::nailvideo::options::{Inputs, Light, NailVideoOptions, Outputs};
use crate::nailvideo::press::{Recording, USE, noise_sd, reversed, rows};
use crate::nailvideo::sample::{Colours, Planes, Region, Sampled, Sampler, cells, discs};
use crate::photo::outline::{Source, ToDraw};
use crate::photo::{Mistaken, write_npy};
use crate::photograph::Photograph;
use crate::stages::{Stages, left_out};
use crate::video::{Frame, Info, Item, Video};

/// What a run with other options may write, ..
const OF_OTHERS: [&str; 10] = [
    "photodiodes.csv",
    "photodiodes.parquet",
    "motion.csv",
    "motion.parquet",
    "presses.csv",
    "presses.parquet",
    "cells.csv",
    "cells.parquet",
    "frames",
    "maps",
];
/// .. and what it draws.
const DRAWN: [&str; 5] = ["report.html", "sheet.png", "sheet.svg", "traces.png", "traces.svg"];

/// The first good frame, for LabelMe.
const PICTURE: &str = "nail.png";
const OUTLINE: &str = "nail.json";

/// Reads where the photodiodes are; without a file the thesis' eight.
pub(in crate::nailvideo) fn positions(path: Option<&Path>) -> Result<Positions, NailVideoError> {
    let Some(path) = path else { return Ok(Positions::thesis()) };
    let refused = |why: String| NailVideoError::Positions { path: path.to_owned(), why };
    let text = crate::input::read(path).map_err(|why| refused(why.to_string()))?;
    let text = String::from_utf8(text).map_err(|_| refused("is no UTF-8 text; write positions as TOML".to_owned()))?;
    let json = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("json"));
    let read = if json { Positions::from_json(&text) } else { Positions::from_toml(&text) };
    read.map_err(|why| refused(why.to_string()))
}

/// Runs the job; every result is in its place when it returns.
///
/// # Errors
/// [`NailVideoError`] where there are no results.
pub fn run(
    inputs: &Inputs,
    options: &NailVideoOptions,
    outputs: &Outputs,
    watch: &Watch<'_>,
) -> Result<NailVideoReport, NailVideoError> {
    let stages = Stages::default();
    let positions = positions(inputs.positions.as_deref())?;
    let mut video = Video::open(&inputs.video, options.threads)?;
    let info = video.info().clone();
    if options.threads != 1 {
        video.decode_ahead();
    }
    let light = light_of(info.grey, options);
    if info.grey && light != Light::None {
        let why = "is grey: only --light none can be had of it".to_owned();
        return Err(NailVideoError::Option { path: inputs.video.clone(), why });
    }
    let staging = Staging::new(&outputs.folder)?;
    let finder = Finder::new(inputs.outline.as_deref(), options);
    let job = Job {
        inputs,
        options,
        outputs,
        info: &info,
        light,
        staging: &staging,
        stages: &stages,
        frames: Frames::default(),
    };
    let mut counts = FrameCounts::default();
    let mut kept: Vec<Kept> = Vec::new();
    let mut at_work: Option<AtWork> = None;
    let mut why_not = finder.nowhere(&inputs.video);
    // What a person may correct.
    let mut suggested: Option<Suggestion> = None;
    rayon::in_place_scope(|scope| -> Result<(), NailVideoError> {
        loop {
            watch.go_on()?;
            job.frames.checked()?;
            let Some(item) = video.next_item()? else { break };
            let (index, time_s, frame) = match &item {
                Item::Frame(frame) => (frame.index, frame.time_s, Some(frame)),
                Item::Missing { index, time_s } => (*index, *time_s, None),
            };
            counts.all += 1;
            let place = match (&mut at_work, frame) {
                (Some(work), frame) => job.step(scope, work, index, time_s, frame)?,
                (None, None) => Kept::lost(index, time_s, Lost::Undecoded),
                (None, Some(frame)) => {
                    if finder.looks_at(index) {
                        let picture = upright(frame, &info);
                        match stages.time("find the nail", || finder.find(&picture)) {
                            Ok(nail) => {
                                counts.first = index;
                                job.suggest(&Suggestion { index, picture, seen: vec![nail.to_draw()] })?;
                                at_work = Some(job.begin(nail, frame, &positions, &kept)?);
                            }
                            Err(NotOne { why, seen }) => {
                                if suggested.as_ref().is_none_or(|one| one.seen.is_empty() && !seen.is_empty()) {
                                    why_not = why;
                                    suggested = Some(Suggestion { index, picture, seen });
                                }
                            }
                        }
                    }
                    match &mut at_work {
                        Some(work) => job.step(scope, work, index, time_s, Some(frame))?,
                        None if !finder.may_look_on(index) => break,
                        None => Kept::lost(index, time_s, Lost::NotYet),
                    }
                }
            };
            match &place.place {
                Ok(_) => counts.followed += 1,
                Err(lost) => *counts.lost.entry(lost.name().to_owned()).or_default() += 1,
            }
            kept.push(place);
            (watch.tick)(counts.all, info.declared_frames);
        }
        Ok(())
    })?;
    job.frames.checked()?;
    stages.add("decode", video.decoding(), counts.all);
    let Some(work) = at_work else {
        if let Some(outline) = &inputs.outline {
            return Err(NailVideoError::Nail { path: outline.clone(), why: why_not });
        }
        let [picture, outline] = [PICTURE, OUTLINE].map(|name| outputs.folder.join(name));
        let there: Vec<String> = [&picture, &outline]
            .into_iter()
            .filter(|path| path.exists())
            .map(|path| path.display().to_string())
            .collect();
        let [picture, outline] = [picture, outline].map(|path| path.display().to_string());
        let remedy = match suggested.filter(|_| outputs.report) {
            // A person may have corrected it.
            Some(suggestion) if !there.is_empty() => format!(
                "what was seen on frame {} isn't saved, for there is {} already, from an earlier run, perhaps \
                 of another video: where it shows this one, correct it in LabelMe or with `lunula edit {}` until one \
                 polygon is labelled `nail`, and give {outline} as --outline; else remove it or give another --out",
                suggestion.index,
                there.join(" and "),
                outputs.folder.display()
            ),
            Some(suggestion) => {
                job.suggest(&suggestion)?;
                staging.commit()?;
                format!(
                    "frame {} is saved as {picture}, and what was seen on it as {outline}: correct that in LabelMe or \
                     with `lunula edit {}` until one polygon is labelled `nail`, and give it as --outline",
                    suggestion.index,
                    outputs.folder.display()
                )
            }
            None => {
                "draw the nail of the first frame in LabelMe, label it `nail`, and give the file as --outline".into()
            }
        };
        return Err(NailVideoError::Nail { path: inputs.video.clone(), why: format!("{why_not}; {remedy}") });
    };
    let mut report = job.finish(work, counts, &kept, &positions, watch)?;
    report.failed.extend(video.damage());
    report.warnings.extend(info.warnings.iter().map(|why| format!("{}: {why}", inputs.video.display())));
    let mut report = report.timed(&stages);
    let decoding: f64 = report.stages.iter().filter(|s| s.stage == "decode").map(|s| s.thread_s).sum();
    report.decoding_share = decoding / report.wall_s;
    if outputs.report {
        report.warn_of_replaced(&outputs.folder.join("run.json"));
        staging.write("run.json", report.text().as_bytes())?;
    }
    staging.commit()?;
    Ok(report)
}

/// What does not change over the video.
struct Job<'a> {
    inputs: &'a Inputs,
    options: &'a NailVideoOptions,
    outputs: &'a Outputs,
    info: &'a Info,
    light: Light,
    staging: &'a Staging,
    stages: &'a Stages,
    frames: Frames,
}

/// Normalized frames that are made and written beside the work on the next ones.
#[derive(Default)]
struct Frames {
    waiting: AtomicUsize,
    /// The first that could not be written.
    failed: Mutex<Option<(u64, NailVideoError)>>,
}

/// So many wait at most; then one is made and written at once.
const MOST_WAITING: usize = 4;

impl Frames {
    /// Whether all could be written so far.
    fn checked(&self) -> Result<(), NailVideoError> {
        let failed = self.failed.lock().unwrap_or_else(PoisonError::into_inner).take();
        failed.map_or(Ok(()), |(_, why)| Err(why))
    }

    fn fail(&self, index: u64, why: NailVideoError) {
        let mut failed = self.failed.lock().unwrap_or_else(PoisonError::into_inner);
        if failed.as_ref().is_none_or(|(first, _)| index < *first) {
            *failed = Some((index, why));
        }
    }
}

/// A nail that is followed.
struct AtWork {
    nail: FirstNail,
    follower: Follower,
    sampler: Sampler,
    /// The first of the sampler's regions are the photodiodes.
    photodiodes: usize,
    readings: Vec<Reading>,
    motion: MotionTable,
    cells: Option<CellTable>,
    windows: Vec<WindowSums>,
    thumbnails: Option<Thumbnails>,
    se_px: Vec<f64>,
    ncc: Vec<f64>,
    quantizer: Vec<f64>,
}

/// A frame and what was seen on it, for a person to correct.
struct Suggestion {
    index: u64,
    picture: Photograph,
    seen: Vec<ToDraw>,
}

impl Job<'_> {
    /// Writes the first frame that is of use, and its outlines.
    fn suggest(&self, Suggestion { index, picture, seen }: &Suggestion) -> Result<(), NailVideoError> {
        let shown = png(&picture.image).map_err(|why| self.staging.refused(PICTURE, why))?;
        self.staging.write(PICTURE, &shown)?;
        let outlines = labelme(seen, PICTURE, picture, *index).to_text();
        Ok(self.staging.write(OUTLINE, &outlines.map_err(|why| self.staging.refused(OUTLINE, why))?)?)
    }

    /// Begins with the nail of the first good frame; `kept` are the frames before it.
    fn begin(
        &self,
        nail: FirstNail,
        frame: &Frame<'_>,
        positions: &Positions,
        kept: &[Kept],
    ) -> Result<AtWork, NailVideoError> {
        let frame_from_nail = nail.frame_from_nail();
        let off = || NailVideoError::Nail {
            path: self.inputs.video.clone(),
            why: "the nail lies beyond the picture; draw its outline on the video's first frame".to_owned(),
        };
        let first = Colours::new(frame, Planes::of(self.info), &frame_from_nail).ok_or_else(off)?;
        let mut regions: Vec<Region> = discs(positions, [nail.frame.width_px, nail.frame.length_px]);
        let photodiodes = regions.len();
        let side = self.options.cells.map(usize::from);
        let mut read = Vec::new();
        for cell in side.map_or_else(Vec::new, |side| cells(side, &nail.outline, &frame_from_nail)) {
            read.push(cell.is_some().then(|| regions.len() - photodiodes));
            regions.extend(cell);
        }
        let extent_px = [nail.frame.width_px, nail.frame.length_px];
        let sampler = Sampler::new(regions, positions, extent_px, self.light, self.info.grey, &first, &frame_from_nail);
        let mut motion = MotionTable::create(self.staging, self.outputs, nail.frame)?;
        let cells = side.map(|side| CellTable::create(self.staging, self.outputs, side, read, self.light));
        let mut cells = cells.transpose()?;
        for row in kept {
            motion.add(row.index, row.time_s, &Err(row.place.err().unwrap_or(Lost::NotYet)))?;
            if let Some(cells) = &mut cells {
                cells.add(row.time_s, &[])?;
            }
        }
        Ok(AtWork {
            follower: Follower::new(frame, self.info.turn.quarters(), frame_from_nail),
            sampler,
            photodiodes,
            readings: Vec::new(),
            motion,
            cells,
            windows: self.options.maps.iter().copied().map(WindowSums::new).collect(),
            thumbnails: self.outputs.figures.then(Thumbnails::default),
            se_px: Vec::new(),
            ncc: Vec::new(),
            quantizer: Vec::new(),
            nail,
        })
    }

    /// Makes a normalized frame and writes it, on another thread where few others wait.
    fn write_frame<'s>(&'s self, scope: &Scope<'s>, index: u64, colours: Colours, frame_from_nail: Affine) {
        let write = move || {
            let name = format!("frames/{index:06}.png");
            let written = self.stages.time("normalized frames", || -> Result<(), NailVideoError> {
                let mut bytes = Vec::new();
                let picture = green(&colours, &frame_from_nail);
                encode_png(&picture, [SIDE as u32; 2], image::ExtendedColorType::L8, &mut bytes)
                    .map_err(|why| self.staging.refused(&name, why))?;
                Ok(self.staging.write(&name, &bytes)?)
            });
            written.unwrap_or_else(|why| self.frames.fail(index, why));
            self.frames.waiting.fetch_sub(1, Ordering::Relaxed);
        };
        let waiting = self.frames.waiting.fetch_add(1, Ordering::Relaxed);
        if waiting < MOST_WAITING && self.options.threads != 1 {
            scope.spawn(move |_| write());
        } else {
            write();
        }
    }

    /// A frame.
    fn step<'s>(
        &'s self,
        scope: &Scope<'s>,
        work: &mut AtWork,
        index: u64,
        time_s: f64,
        frame: Option<&Frame<'_>>,
    ) -> Result<Kept, NailVideoError> {
        let place = match frame {
            Some(frame) => self.stages.time("follow", || work.follower.step(frame)),
            None => Err(Lost::Undecoded),
        };
        work.motion.add(index, time_s, &place)?;
        let seen = frame.zip(place.as_ref().ok()).and_then(|(frame, place)| {
            let frame_from_nail = place.motion.after(&work.nail.frame_from_nail());
            Some((Colours::new(frame, Planes::of(self.info), &frame_from_nail)?, frame_from_nail, place))
        });
        let Some((colours, frame_from_nail, place)) = seen else {
            if let Some(cells) = &mut work.cells {
                cells.add(time_s, &[])?;
            }
            return Ok(Kept::lost(index, time_s, place.err().unwrap_or(Lost::Outside)));
        };
        self.stages.time("photodiodes", || {
            work.sampler.sample(&colours, &frame_from_nail, place.rim.as_ref(), &mut work.readings);
        });
        if let Some(cells) = &mut work.cells {
            self.stages.time("cells", || cells.add(time_s, &work.readings[work.photodiodes..]))?;
        }
        self.stages.time("maps", || {
            let covered = work.sampler.covered.as_ref();
            work.windows.iter_mut().for_each(|window| window.add(time_s, &colours, &frame_from_nail, covered));
        });
        if let Some(thumbnails) = &mut work.thumbnails {
            self.stages.time("figures", || thumbnails.offer(time_s, &colours, &frame_from_nail));
        }
        work.se_px.push(place.se_px);
        work.ncc.push(place.ncc);
        work.quantizer.extend(frame.and_then(|frame| frame.quantizer));
        let skin = work.sampler.skin(&colours, &frame_from_nail);
        if self.outputs.frames {
            self.write_frame(scope, index, colours, frame_from_nail);
        }
        let readings = work.readings[..work.photodiodes].to_vec();
        Ok(Kept { index, time_s, place: Ok(place.se_px as f32), readings, skin })
    }

    /// Writes what needs the whole video.
    fn finish(
        &self,
        work: AtWork,
        counts: FrameCounts,
        kept: &[Kept],
        positions: &Positions,
        watch: &Watch<'_>,
    ) -> Result<NailVideoReport, NailVideoError> {
        let AtWork { nail, motion, cells, windows, thumbnails, se_px, ncc, quantizer, sampler, .. } = work;
        motion.table.finish()?;
        if let Some(cells) = cells {
            cells.table.finish()?;
        }
        let names: Vec<String> = positions.photodiodes.iter().map(|one| one.name.clone()).collect();
        let time_s: Vec<f64> = kept.iter().map(|row| row.time_s).collect();
        let quantizer = middle(quantizer.iter().copied());
        let enlarged = (beyond_fine(quantizer) / DOUBLED_BY).exp2();
        let (traces, whole) = traces(&names, kept, self.light, enlarged);
        let noise: Vec<Option<f64>> = traces.iter().map(|trace| noise_sd(&trace.values)).collect();
        let lasting = sampler.noise_sd().unwrap_or(0.0);
        // What a photodiode's values err by where the nail rests.
        let least_sd: Vec<Option<f64>> =
            noise.iter().map(|noise| noise.map(|noise| enlarged * noise.max(lasting))).collect();
        let sd = |k: usize, row: usize, one: &Sampled, se_px: f32| {
            // The place's error has two axes, the slope is along the steeper.
            let moved = f64::from(one.slope_per_px * se_px) / 2.0_f64.sqrt();
            let tint = traces[k].tint[row];
            least_sd[k].map(|least_sd| least_sd.hypot(one.steady_sd.into()).hypot(moved).hypot(tint))
        };
        self.stages.time("write", || photodiodes(self.staging, self.outputs, &names, self.light, kept, sd))?;
        let skin: Vec<f64> = kept.iter().map(|row| row.skin).collect();
        let ends = ends(positions, &traces);
        let recording = Recording { time_s: &time_s, traces: &traces, sd: &least_sd, ends: &ends, skin: &skin, whole };
        let pressed = self.stages.time("presses", || rows(&recording));
        presses(self.staging, self.outputs, self.light, &pressed)?;
        for sums in &windows {
            let [mean, sd] = sums.maps();
            for (map, what) in [(mean, "mean"), (sd, "sd")] {
                let name = format!("maps/{}-{}-{what}.npy", sums.window.from_s, sums.window.to_s);
                write_npy(&map, self.staging, &name)?;
            }
        }
        let mut courses = BTreeMap::new();
        pressed.iter().for_each(|row| *courses.entry(row.status()).or_default() += 1);
        let figures = NailVideoFigures {
            nail: NailFigures {
                outline: nail.source.name(),
                width_px: nail.frame.width_px,
                length_px: nail.frame.length_px,
                axis_deg: nail.frame.axis.clockwise_deg(),
            },
            light: self.light,
            unit: self.light.unit(),
            positions: positions.name.clone(),
            photodiodes: (0..names.len()).map(|k| photodiode(&names[k], k, kept, noise[k])).collect(),
            // The frame that it is learned from fits itself.
            se_px: middle(se_px.iter().copied()).filter(|se_px| *se_px > 0.0),
            correlation: middle(ncc.iter().copied()),
            quantizer,
            presses: pressed.iter().map(|row| row.press).max().unwrap_or(0),
            courses,
            presses_are_for: USE,
            maps: windows.iter().map(|sums| MapFigures { window: sums.window, frames: sums.frames }).collect(),
            frames: counts,
            decoding_share: 0.0,
        };
        let mut report = Report {
            left_out: left_out(steps(Some(self.info), self.inputs.outline.is_some(), self.options, self.outputs)),
            ..Report::new("nailvideo", watch, figures)
        };
        report.notes.push(format!("presses.csv: {USE}"));
        report.notes.extend(self.info.hdr_note());
        if self.info.grey && self.options.light.is_none() {
            report.warnings.push("the video is grey: light is not taken off (--light none)".to_owned());
        }
        report.warnings.extend(repeated(&traces, &noise, |row| kept[row].index));
        report.warnings.extend(leaps(&traces, &least_sd, |row| kept[row].index));
        report.warnings.extend(reversed(&pressed));
        let tints = traces.iter().map(|trace| (trace.name.as_str(), trace.tint.as_slice()));
        report.warnings.extend(tinted(tints, self.light));
        if noise.iter().all(Option::is_none) {
            report.warnings.push("too few frames to know the photodiodes' noise: no standard errors".to_owned());
        }
        if report.frames.first > 0 {
            let first = report.frames.first;
            let why = match nail.source {
                Source::Detected => "no nail was found before",
                Source::Annotated | Source::Mask => "the outline is drawn on",
            };
            report.notes.push(format!("{why} frame {first}; the nail is followed from there on"));
        }
        match quantizer {
            Some(parameter) if parameter >= STRONG => report.warnings.push(format!(
                "the video is strongly compressed (its quantization parameter is {parameter:.0}): places and values \
                 err by several times what they do in a good one, as their standard errors say; film with a higher \
                 bit rate"
            )),
            Some(_) => {}
            None => report.notes.push(format!(
                "{} does not tell how strongly it is compressed: standard errors hold light compression",
                self.info.codec
            )),
        }
        if let Some([looks, done]) = nail.mistaken.map(Mistaken::words) {
            let first = report.frames.first;
            report.warnings.push(format!("{looks} on frame {first}: {done} Light is taken off by red"));
        }
        if let (Some(instead), Some(outline)) = (&nail.instead, &self.inputs.outline) {
            let (path, first) = (outline.display(), report.frames.first);
            report.warnings.push(format!(
                "{path}: {instead} on frame {first}, by the network that finds nails: was it drawn on another frame \
                 ({DRAWN_ON}) or another video? Photodiodes may lie on skin"
            ));
        }
        report.warnings.extend(positions.in_one_quarter());
        for names in positions.at_one_place() {
            report.warnings.push(format!("{} lie at one place: they repeat one measurement", names.join(", ")));
        }
        let lost = report.frames.all - report.frames.followed;
        if lost * 4 > report.frames.all {
            let (all, reasons) = (report.frames.all, &report.frames.lost);
            let reasons: Vec<String> = reasons.iter().map(|(why, count)| format!("{count} {why}")).collect();
            let text = format!("the nail is followed in {} of {all} frames only ({})", all - lost, reasons.join(", "));
            report.warnings.push(text);
        }
        for sums in windows.iter().filter(|sums| sums.frames == 0) {
            report.warnings.push(format!("--maps {}: the nail is followed in none of its frames", sums.window));
        }
        // This run's own pictures are drawn below.
        let drawn: &[&str] = if thumbnails.is_some() { &[] } else { &DRAWN };
        report.warn_of_left(&self.staging.left_from_earlier(&[&OF_OTHERS, drawn].concat()));
        if let Some(thumbnails) = thumbnails {
            self.stages.time("figures", || draw(self.staging, &mut report, &recording, &pressed, &thumbnails))?;
        }
        Ok(report)
    }
}

/// A photodiode's error is larger than its noise, twice as much for each so many more of a coarse quantization
/// parameter: encoders leave out small changes, for as long as they stay small (measured on the phantom under pressing:
/// errors are 0.9 to 1.1 times what noise alone says at 12 to 19, 1.6 times at 26, twice at 32).
const DOUBLED_BY: f64 = 10.0;

/// From here on a person should know (between 19, where errors are those of 14, and 26, where a photodiode's are three
/// times those).
const STRONG: f64 = 24.0;

fn photodiode(name: &str, k: usize, kept: &[Kept], noise_sd: Option<f64>) -> PhotodiodeFigures {
    let mut absent: BTreeMap<String, u64> = BTreeMap::new();
    let mut frames = 0;
    for reading in kept.iter().filter_map(|row| row.readings.get(k)) {
        match reading {
            Ok(_) => frames += 1,
            Err(why) => *absent.entry(why.name().to_owned()).or_default() += 1,
        }
    }
    PhotodiodeFigures { name: name.to_owned(), frames, absent, noise_sd }
}
