//! The posture job: a video, a checked layout and options in, tables of angles and tracks out; the one entry that
//! command line, pipelines and trade-offs call.
//!
//! A frame is decoded, its planes are looked at where the last frame says, centres get names, names get angles, the
//! row is written, the frame forgotten: memory does not grow with the video's length, unless angles are to be smoothed.

use std::path::Path;

use crate::job::{Report, Watch};
use crate::posture::angle::joints::Angles;
use crate::posture::angle::readout::{Readout, Rolling, Rows};
use crate::posture::angle::view::View;
use crate::posture::error::PostureError;
use crate::posture::layout::{Joint, Layout, MarkerShape};
use crate::posture::marker::looks::siting::Siting;
use crate::posture::options::{Outputs, PostureOptions};
use crate::posture::run::filmed_clock::FilmedClock;
use crate::posture::run::plan::{Known, OUTLINES, WHOLE_FRAMES, steps};
use crate::posture::run::report::{JointReport, MarkerSums, PostureFigures, PostureReport, SearchReport, VideoReport};
use crate::posture::run::results::{Results, Row};
use crate::posture::suggest::Suggester;
use crate::posture::survey::{Progress, Survey, Surveyor};
use crate::posture::track::Tracker;
use crate::stages::{self, Stages};
use crate::table::TableFormat;
use crate::video::{Info, Item, Video};

/// Runs the job; every result is in its place when it returns.
///
/// # Errors
/// [`PostureError`] where there are no results.
pub fn run(
    path: &Path,
    layout: &Layout,
    options: &PostureOptions,
    outputs: &Outputs,
    watch: &Watch<'_>,
) -> Result<PostureReport, PostureError> {
    let stages = Stages::default();
    // A name that no table can have is refused before the work begins.
    for table in std::iter::once(&outputs.joints).chain(&outputs.tracks) {
        TableFormat::of(table)?;
    }
    let (survey, info) = look_first(path, layout, options, &stages, watch)?;
    let mut video = Video::open(path, options.threads)?;
    let clock = layout.clock.as_ref().filter(|_| options.reads_clock());
    let rows = Rows::new(layout.readout_s, info.format.height);
    let clock = clock.map(|clock| FilmedClock::new(clock, &info, options.clock_every)).transpose();
    let mut clock = clock.map_err(|why| PostureError::Clock { path: path.to_owned(), why })?;
    let mut tracker = Tracker::new(layout, &survey, &info, options.method);
    let mut readout = rows.map(Readout::new);
    let mut rolling = Rolling::new(layout, &info);
    let mut angles = Angles::new(layout, &info);
    let mut results = Results::start(path, layout, &info, options, outputs)?;
    let mut span = Span::default();
    loop {
        watch.go_on()?;
        let Some(item) = stages.time("decode", || video.next_item())? else { break };
        let (index, time_s, frame) = match &item {
            Item::Frame(frame) => (frame.index, frame.time_s, Some(frame)),
            Item::Missing { index, time_s } => (*index, *time_s, None),
        };
        let sights = match frame {
            Some(frame) => stages.time("track", || tracker.step(frame)),
            None => tracker.skip(),
        };
        let joints = stages.time("angles", || {
            let moved = readout.as_mut().map(|readout| readout.step(time_s, sights));
            let sights = moved.as_deref().unwrap_or(sights);
            rolling.add(time_s, sights);
            angles.step(sights)
        });
        if let Some(clock) = &mut clock {
            stages.time("clock", || clock.look(index, time_s, frame));
        }
        let row = Row { index, time_s, frame, sights, joints };
        if outputs.overlay.is_some() {
            stages.time("overlay", || results.draw(&row))?;
        }
        stages.time("write", || results.add(row))?;
        span.add(time_s);
        (watch.tick)(index + 1, info.declared_frames);
    }
    let clock = clock.map(|clock| stages.time("clock", || clock.finish(rows, &info)));
    let unsmoothed = stages.time("smooth", || results.smooth());
    results.write_held(clock.as_ref().and_then(|clock| clock.fit.as_ref().ok()))?;
    let pictures = stages.time("figures", || results.draw_pictures())?;
    let search = tracker.effort();
    let mut failed = video.damage();
    if let Some(why) = clock.as_ref().and_then(|clock| clock.fit.as_ref().err()) {
        failed.push(format!("{}: the clock in the picture: {why}; clock_s is empty", path.display()));
    }
    let clock_doubt = clock.as_ref().and_then(|clock| clock.fit.as_ref().ok()?.doubt.clone());
    // What makes all angles wrong comes first.
    let mut warnings: Vec<String> = results.plausibility.warning(Some(layout.flexion)).into_iter().collect();
    warnings.extend(layout.warnings.iter().chain(&survey.doubts).cloned());
    warnings.extend(angles.doubts());
    warnings.extend(rolling.doubt());
    warnings.extend(unsmoothed);
    warnings.extend(clock_doubt);
    warnings.extend(span.slow_readout(layout.readout_s));
    warnings.extend(View::doubt(layout, &info).unwrap_or_default());
    warnings.extend(info.warnings.iter().cloned());
    let joints = results.joint_reports();
    warnings.extend(late(layout, &survey, &results.markers, &joints));
    let figures = PostureFigures {
        video: video_report(path, &info, survey.siting, &span),
        frames: results.frames,
        markers: results.marker_reports(|marker| tracker.shape(marker)),
        joints,
        coupling: results.coupling(),
        clock: clock.map(|clock| clock.report),
        readout_ms: rolling.readout_ms(),
        searches: SearchReport {
            surveyed_frames: survey.frames as u64,
            neighbourhoods: search.near_searches,
            wider: search.wide_searches,
            whole_frames: search.whole_searches,
            share_of_samples: search.share_searched,
        },
        threads: threads(options),
        decoding_share: 0.0,
    };
    let left_out = left_out(layout, &info, options, outputs, &tracker);
    let report = Report {
        left_out,
        warnings,
        notes: info.hdr_note().into_iter().chain(layout.notes.iter().cloned()).collect(),
        failed,
        pictures,
        ..Report::new("posture", watch, figures)
    };
    results.finish(report, &stages, outputs.report)
}

/// The markers that no frame shows, or only frames after those that names were given by; and joints that no frame
/// shows though it shows each of their markers.
fn late(layout: &Layout, survey: &Survey, markers: &[MarkerSums], joints: &[JointReport]) -> Vec<String> {
    let needed = layout.needed();
    let of = |marker: usize| {
        let name = &layout.markers[marker].name;
        match markers[marker].first_frame {
            None => Some(format!("{name} is seen in no frame; --overlay shows what was tracked")),
            Some(frame) if survey.unseen.contains(&marker) && frame >= survey.frames as u64 => {
                Some(format!("{name} is not seen before frame {frame}"))
            }
            Some(_) => None,
        }
    };
    let mut said: Vec<String> = (0..markers.len()).filter(|&marker| needed[marker]).filter_map(of).collect();
    let of = |(joint, report): (&Joint, &JointReport)| {
        let mut markers_of = joint.segments.iter().flat_map(|&segment| layout.segments[segment].markers);
        (report.frames == 0 && markers_of.all(|marker| markers[marker].first_frame.is_some()))
            .then(|| format!("{} is known in no frame: none shows all of its markers", joint.name))
    };
    said.extend(layout.joints.iter().zip(joints).filter_map(of));
    said
}

/// Threads that decode.
fn threads(options: &PostureOptions) -> usize {
    match options.threads {
        0 => std::thread::available_parallelism().map_or(1, usize::from),
        asked => asked,
    }
}

/// Looks at a few frames of a video and returns a marker file to start from.
///
/// # Errors
/// [`PostureError`] where the video can't be read or shows no markers.
pub fn suggest(path: &Path, threads: usize) -> Result<String, PostureError> {
    let mut video = Video::open(path, threads)?;
    let info = video.info().clone();
    let mut suggester = Suggester::new(&info);
    while let Some(item) = video.next_item()? {
        if let Item::Frame(frame) = item {
            suggester.look(&frame);
        }
    }
    let suggested = suggester.finish();
    let text = suggested.map_err(|why| PostureError::Markers { path: path.to_owned(), why: why.to_string() })?;
    // What it says is tried, as a run would.
    let tried = match Layout::parse(&text, Path::new("the suggestion")) {
        Err(why) => Err(why.to_string()),
        Ok(layout) => {
            let options = PostureOptions { threads, ..PostureOptions::default() };
            let first = look_first(path, &layout, &options, &Stages::default(), &Watch::nobody());
            first.map(|_| ()).map_err(|why| match why {
                PostureError::Markers { why, .. } => why,
                other => other.to_string(),
            })
        }
    };
    match tried {
        Ok(()) => Ok(text),
        // Spots that can't be found again where they were found are no markers.
        Err(why) if text.contains("[start]") => Err(PostureError::Markers {
            path: path.to_owned(),
            why: format!("nothing looks like a marker: what stands out most can't be followed ({why})"),
        }),
        Err(why) => Ok(format!("# It does not run as it is: {}\n{text}", why.replace('\n', "\n# "))),
    }
}

/// Reads the first frames until every marker has its name.
fn look_first(
    path: &Path,
    layout: &Layout,
    options: &PostureOptions,
    stages: &Stages,
    watch: &Watch<'_>,
) -> Result<(Survey, Info), PostureError> {
    let mut video = Video::open(path, options.threads)?;
    let info = video.info().clone();
    View::doubt(layout, &info).map_err(|why| PostureError::Camera { path: path.to_owned(), why })?;
    let mut surveyor = Surveyor::new(layout, &info);
    while let Some(item) = stages.time("decode", || video.next_item())? {
        watch.go_on()?;
        let Item::Frame(frame) = item else { continue };
        if stages.time("survey", || surveyor.look(&frame)) == Progress::Enough {
            break;
        }
    }
    let survey =
        surveyor.finish().map_err(|why| PostureError::Markers { path: path.to_owned(), why: why.to_string() })?;
    Ok((survey, info))
}

/// A read-out time is longer than the interval between frames beyond this share of it: 33.4 ms at 30 frames a second
/// are not (assumed).
const SLOW_READOUT: f64 = 1.02;

/// From when to when, and how evenly.
#[derive(Default)]
struct Span {
    steps: u64,
    last_s: Option<f64>,
    interval_s: Option<[f64; 2]>,
}

impl Span {
    fn add(&mut self, time_s: f64) {
        if let Some(last) = self.last_s {
            let step = time_s - last;
            self.steps += 1;
            let [least, most] = self.interval_s.unwrap_or([step, step]);
            self.interval_s = Some([least.min(step), most.max(step)]);
        }
        self.last_s = Some(time_s);
    }

    /// That a read-out time can't be this camera's, if so: it takes no frame before it has read the last one.
    fn slow_readout(&self, readout_s: f64) -> Option<String> {
        let interval_s = self.last_s? / self.steps.max(1) as f64;
        (self.steps > 0 && readout_s > SLOW_READOUT * interval_s).then(|| {
            format!(
                "readout_ms = {:.1} of the marker file is longer than the {:.1} ms from frame to frame, which no \
                 camera takes; measure it again",
                1e3 * readout_s,
                1e3 * interval_s
            )
        })
    }
}

fn video_report(path: &Path, info: &Info, siting: Siting, span: &Span) -> VideoReport {
    VideoReport {
        file: path.to_owned(),
        shown_px: info.turn.shown_size((info.format.width, info.format.height)).into(),
        codec: info.codec.clone(),
        depth: info.format.depth,
        subsampling: info.format.subsampling.map(|(across, down)| [across, down]),
        chroma_site_px: info.format.subsampling.map(|_| [siting.dx_px, siting.dy_px]),
        duration_s: span.last_s.unwrap_or(0.0),
        interval_s: span.interval_s,
    }
}

/// What the scene did not need.
fn left_out(
    layout: &Layout,
    info: &Info,
    options: &PostureOptions,
    outputs: &Outputs,
    tracker: &Tracker,
) -> Vec<String> {
    let (steps, search) = (steps(&Known::of(layout, info), options, outputs), tracker.effort());
    let mut left_out = stages::left_out(steps.into_iter().filter(|step| step.stage != WHOLE_FRAMES));
    left_out.push(format!(
        "{WHOLE_FRAMES}: in all but {} of {} frames only where the last one says, {:.2} % of the samples",
        search.whole_searches,
        search.frames,
        100.0 * search.share_searched
    ));
    let mut shapes = (0..layout.markers.len()).filter_map(|marker| tracker.shape(marker));
    if layout.shape.is_none() && shapes.all(|shape| shape == MarkerShape::Disc) {
        left_out.push(format!("{OUTLINES}: a disc fits every marker"));
    }
    left_out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::posture::marker::sight::{Centre, Sight};

    #[test]
    fn a_marker_found_while_names_were_sought_is_not_called_unseen() {
        let text = "[markers]\na = '#2b4b10'\nb = '#2b4b10'\nc = '#2b4b10'\n";
        let layout = Layout::parse(text, Path::new("m.toml")).expect("a sound marker file");
        let siting = Siting { dx_px: 0.0, dy_px: 0.0 };
        let survey = Survey {
            starts: vec![None; 3],
            lengths_px: Vec::new(),
            siting,
            frames: 296,
            unseen: vec![0, 1, 2],
            doubts: Vec::new(),
        };
        let centre =
            Centre { at_px: [9.0; 2], covariance_px2: [0.01, 0.0, 0.01], lasting_px2: [0.0; 3], radius_px: 5.0 };
        let mut markers = vec![MarkerSums::default(); 3];
        markers[0].add(42, &Sight::Seen(centre));
        markers[1].add(300, &Sight::Seen(centre));
        let late = late(&layout, &survey, &markers, &[]);
        assert_eq!(late.len(), 2, "{late:?}");
        assert!(late[0].starts_with("b ") && late[0].contains("300") && late[1].starts_with("c "), "{late:?}");
    }
}
