//! A video of a finger with coloured markers to joint angles:
//! `cargo run --example posture -- fixtures/finger/video.mp4 fixtures/finger/markers.toml joints.csv`.

use std::path::Path;

use anyhow::Context;
use lunula::job::Watch;
use lunula::posture::{Layout, Outputs, PostureOptions, run};

fn main() -> anyhow::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [video, markers, joints] = &arguments[..] else { anyhow::bail!("name a video, a marker file and a table") };
    let layout = Layout::read(Path::new(markers))?;
    let outputs = Outputs { joints: joints.into(), tracks: None, overlay: None, figures: true, report: true };
    let report = run(Path::new(video), &layout, &PostureOptions::default(), &outputs, &Watch::nobody())?;
    for joint in &report.figures.joints {
        println!("{}: {} of {} frames", joint.joint, joint.frames, report.figures.frames.all);
    }
    let clock = report.figures.clock.context("the marker file names no clock")?;
    println!("the clock was read in {} frames", clock.frames_read);
    Ok(())
}
