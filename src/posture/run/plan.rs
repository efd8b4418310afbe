//! What a run would do and leave out, by the marker file and the video's header.

use std::path::Path;

use crate::clock::ClockRoi;
use crate::posture::error::PostureError;
use crate::posture::layout::{Layout, MarkerShape};
use crate::posture::options::{Outputs, PostureOptions};
use crate::stages::Step;
use crate::video::{Info, Video};

/// Plans a run; `outputs` may have no place yet.
///
/// # Errors
/// [`PostureError::Video`] where the video can't be read.
pub fn plan(
    video: &Path,
    layout: &Layout,
    options: &PostureOptions,
    outputs: &Outputs,
) -> Result<Vec<Step>, PostureError> {
    let info = Video::open(video, options.threads)?.info().clone();
    Ok(steps(&Known::of(layout, &info), options, outputs))
}

/// What is known of a scene before its video is decoded.
#[derive(Clone, Copy, Default)]
pub(in crate::posture) struct Known<'a> {
    pub(in crate::posture) layout: Option<&'a Layout>,
    pub(in crate::posture) info: Option<&'a Info>,
    /// Whether the lens bends lines; `None`: unknown.
    pub(in crate::posture) distorted: Option<bool>,
    /// Whether a clock is in the picture; `None`: unknown.
    pub(in crate::posture) clock: Option<bool>,
}

impl<'a> Known<'a> {
    pub(in crate::posture) fn of(layout: &'a Layout, info: &'a Info) -> Self {
        let (distorted, clock) = (Some(layout.camera.is_some()), Some(layout.clock.is_some()));
        Self { layout: Some(layout), info: Some(info), distorted, clock }
    }
}

/// The one table of steps: the plan shows them, a run's report lists those that are left out.
pub(in crate::posture) fn steps(known: &Known<'_>, options: &PostureOptions, outputs: &Outputs) -> Vec<Step> {
    let asked = |stage: &'static str, wanted: bool, option: &str| {
        Step::new(stage, wanted, if wanted { option } else { "not asked for" }.to_owned())
    };
    // What a marker file that does not exist yet will say.
    let said = |fact: Option<bool>, yes: &str, no: &str| match fact {
        Some(true) => yes.to_owned(),
        Some(false) => no.to_owned(),
        None => "as the marker file says".to_owned(),
    };
    let figures = outputs.figures;
    let mut steps = vec![
        Step::new("decoding", true, known.info.map_or("all frames".to_owned(), Info::in_words)),
        Step::new("markers tracked", true, tracked(known.layout, options)),
    ];
    steps.extend(known.layout.into_iter().flat_map(of_layout));
    steps.extend(known.info.into_iter().flat_map(|info| of_video(info, outputs)));
    steps.extend([
        Step::new(
            "lens correction",
            known.distorted != Some(false),
            said(known.distorted, "[camera], of the centres", "no [camera]"),
        ),
        Step::new(
            "oblique plane",
            known.layout.is_none_or(has_plane) && known.distorted != Some(false),
            said(known.layout.map(has_plane), "[camera.plane], of the centres", "no [camera.plane]"),
        ),
        Step::new(
            "rolling shutter",
            known.layout.is_none_or(|layout| layout.readout_s > 0.0),
            match known.layout {
                Some(layout) if layout.readout_s > 0.0 => "readout_ms, of the centres and the clock".to_owned(),
                Some(_) => "no readout_ms".to_owned(),
                None => "as the marker file says".to_owned(),
            },
        ),
        Step::new("clock", options.reads_clock() && known.clock != Some(false), clock(known, options)),
        asked("smoothing", options.smooth, "--smooth"),
        asked("table of markers", outputs.tracks.is_some(), "--tracks"),
        asked("overlay", outputs.overlay.is_some(), "--overlay"),
        asked("figures", figures && known.layout.is_none_or(|layout| !layout.joints.is_empty()), "of the angles"),
    ]);
    steps
}

fn has_plane(layout: &Layout) -> bool {
    layout.camera.as_ref().is_some_and(|camera| camera.plane.is_some())
}

/// The names of the markers that the joints need, or do not.
fn markers(layout: &Layout, wanted: bool) -> Vec<&str> {
    let needed = layout.needed();
    let all = layout.markers.iter().zip(&needed);
    all.filter(|(_, needed)| **needed == wanted).map(|(marker, _)| marker.name.as_str()).collect()
}

fn tracked(layout: Option<&Layout>, options: &PostureOptions) -> String {
    match layout {
        Some(layout) => markers(layout, true).join(", "),
        None if options.joints.is_empty() => "of all joints of the marker file".to_owned(),
        None => format!("of {}", options.joints.join(", ")),
    }
}

fn of_layout(layout: &Layout) -> [Step; 4] {
    let idle = markers(layout, false);
    let zeros = layout.joints.iter().any(|joint| joint.zero_rad != 0.0);
    [
        Step::new(
            "other markers",
            false,
            if idle.is_empty() {
                "there are none".into()
            } else {
                format!("no wanted joint needs {}", idle.join(", "))
            },
        ),
        Step::new(
            WHOLE_FRAMES,
            false,
            "after the first frames only where the last one shows a marker; again where markers stay away".into(),
        ),
        Step::new(
            OUTLINES,
            layout.shape != Some(MarkerShape::Disc),
            match layout.shape {
                None => "where a marker is not a disc".into(),
                Some(shape) => format!("shape = \"{}\"", shape.name()),
            },
        ),
        Step::new("zero angles", zeros, if zeros { "[zero]".into() } else { "no [zero], or of 0 degrees".into() }),
    ]
}

fn of_video(info: &Info, outputs: &Outputs) -> [Step; 4] {
    let overlay = outputs.overlay.is_some();
    [
        Step::new(
            "chroma planes",
            !info.grey,
            if info.grey { "the video is grey".into() } else { "as decoded, about the markers".into() },
        ),
        Step::new(
            "colours of whole frames converted",
            info.converted.is_some(),
            match &info.converted {
                Some(from) => format!("the samples ({from}) are not planes of Y', Cb and Cr"),
                None => "the video's own planes are used".into(),
            },
        ),
        Step::new("pictures undistorted", false, "points are, where there is a lens".into()),
        Step::new(
            "pictures turned upright",
            overlay && info.turn != crate::video::Turn::None,
            "coordinates are; pictures only for an overlay".into(),
        ),
    ]
}

/// The step that is needed where a marker is no disc.
pub(in crate::posture) const OUTLINES: &str = "outlines of blots";
/// The stage of which a run's report gives the share.
pub(in crate::posture) const WHOLE_FRAMES: &str = "search of whole frames";

fn clock(known: &Known<'_>, options: &PostureOptions) -> String {
    if !options.reads_clock() {
        return "nothing needs its time".to_owned();
    }
    let Some(clock) = known.layout.and_then(|layout| layout.clock.as_ref()) else {
        return match known.clock {
            Some(false) => "no [clock]",
            Some(true) => "[clock]",
            None => "as the marker file says",
        }
        .to_owned();
    };
    let place = match clock.roi {
        ClockRoi::Auto => "looked for in the first frames".to_owned(),
        ClockRoi::Box([x, y, width, height]) => format!("luma of {width} x {height} pixels at {x}, {y}"),
    };
    match options.clock_every {
        1 => format!("{}, {place}, in the frames decoded for the markers", clock.format.text()),
        every => format!("{}, {place}, in one of {every} frames", clock.format.text()),
    }
}
