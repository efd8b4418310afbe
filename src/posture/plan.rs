//! What a run would do and leave out, told from the marker file and the video's header.

use std::path::Path;

use super::error::PostureError;
use super::layout::{Layout, MarkerShape};
use super::options::{Outputs, PostureOptions};
use crate::clock::ClockRoi;
use crate::stages::Step;
use crate::video::{Info, Video};

/// Plans a run; `outputs` may be open yet.
///
/// # Errors
/// [`PostureError::Video`] where the video can't be read.
pub fn plan(
    video: &Path,
    layout: &Layout,
    options: &PostureOptions,
    outputs: Option<&Outputs>,
) -> Result<Vec<Step>, PostureError> {
    let info = Video::open(video, options.threads)?.info().clone();
    Ok(steps(layout, &info, options, outputs))
}

pub(super) fn steps(layout: &Layout, info: &Info, options: &PostureOptions, outputs: Option<&Outputs>) -> Vec<Step> {
    let needed = layout.needed();
    let names = |wanted: bool| -> Vec<&str> {
        let all = layout.markers.iter().zip(&needed);
        all.filter(|(_, needed)| **needed == wanted).map(|(marker, _)| marker.name.as_str()).collect()
    };
    let (tracked, idle) = (names(true), names(false));
    let frames = info.declared_frames.map_or("all frames".to_owned(), |frames| format!("{frames} frames"));
    let (width, height) = (info.format.width, info.format.height);
    let depth = info.format.depth;
    let grey = info.grey;
    let asked = |what: Option<bool>, option: &str| match what {
        Some(true) => (true, option.to_owned()),
        _ => (false, "not asked for".to_owned()),
    };
    let (tracks, tracks_why) = asked(outputs.map(|o| o.tracks.is_some()), "--tracks");
    let (overlay, overlay_why) = asked(outputs.map(|o| o.overlay.is_some()), "--overlay");
    let (smooth, smooth_why) = asked(Some(options.smooth), "--smooth");
    let figures = outputs.is_none_or(|o| o.figures);
    let zeros = layout.joints.iter().any(|joint| joint.zero_rad != 0.0);
    vec![
        Step::new("decoding", true, format!("{frames}, {width} x {height}, {} of {depth} bits", info.codec)),
        Step::new("markers tracked", true, tracked.join(", ")),
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
            "after the first ones only where the last one tells; again where markers stay away".into(),
        ),
        Step::new(
            OUTLINES,
            layout.shape != Some(MarkerShape::Disc),
            match layout.shape {
                None => "where a marker is no disc".into(),
                Some(shape) => format!("shape = \"{}\"", shape.name()),
            },
        ),
        Step::new(
            "chroma planes",
            !grey,
            if grey { "the video is grey".into() } else { "as decoded, about the markers".into() },
        ),
        Step::new(
            "colours of whole frames converted",
            info.converted.is_some(),
            match &info.converted {
                Some(from) => format!("the samples ({from}) are no planes of Y', Cb and Cr"),
                None => "the video's own planes are used".into(),
            },
        ),
        Step::new("pictures undistorted", false, "points are, where there is a lens".into()),
        Step::new(
            "lens correction",
            layout.camera.is_some(),
            if layout.camera.is_some() { "[camera], of the centres".into() } else { "no [camera]".into() },
        ),
        Step::new(
            "pictures turned upright",
            overlay && info.turn != crate::video::Turn::None,
            "coordinates are; pictures only for an overlay".into(),
        ),
        Step::new("zero angles", zeros, if zeros { "[zero]".into() } else { "no [zero], or of 0 degrees".into() }),
        Step::new("clock", layout.clock.is_some() && options.clock_every > 0, clock(layout, options)),
        Step::new("smoothing", smooth, smooth_why),
        Step::new("table of markers", tracks, tracks_why),
        Step::new("overlay", overlay, overlay_why),
        Step::new(
            "figures",
            figures && !layout.joints.is_empty(),
            if figures { "of the angles".into() } else { "not asked for".into() },
        ),
    ]
}

/// The step that is needed where a marker is no disc.
pub(super) const OUTLINES: &str = "outlines of blots";
/// The stage of which a run's report tells the share.
pub(super) const WHOLE_FRAMES: &str = "search of whole frames";

fn clock(layout: &Layout, options: &PostureOptions) -> String {
    let Some(clock) = &layout.clock else { return "no [clock]".to_owned() };
    let place = match clock.roi {
        ClockRoi::Auto => "looked for in the first frames".to_owned(),
        ClockRoi::Box([x, y, width, height]) => format!("luma of {width} x {height} pixels at {x}, {y}"),
    };
    match options.clock_every {
        0 => "not asked for".to_owned(),
        1 => format!("{}, {place}, in the frames decoded for the markers", clock.format.text()),
        every => format!("{}, {place}, in one of {every} frames", clock.format.text()),
    }
}
