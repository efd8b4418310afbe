//! `lunula posture`: video to joint angles.

use std::path::PathBuf;

use anyhow::Context;
use clap::Args;
use lunula::posture::{
    Layout, Outputs, PostureError, PostureOptions, PostureReport, Watch, plan, run as run_posture, suggest,
};

use super::{Common, Interrupted, Outcome, print_line};

/// Video of a finger with coloured markers to joint angles, each frame with its own time and standard error
///
/// MARKERS.toml names the markers and their colours, the segments (two markers each, proximal first) and the joints
/// (two segments each), and where a digital clock is in the picture; --suggest prints one to start from. A marker that
/// is not seen is lost, and no angle comes from it. Results: the table of angles, and beside it <joints>.run.json and
/// pictures of the angles over time and of the last joint against the one before.
#[derive(Debug, Args)]
pub(super) struct PostureArgs {
    /// The video, in any format that FFmpeg reads
    video: PathBuf,
    /// The marker file
    #[arg(long, value_name = "MARKERS.toml", required_unless_present = "suggest")]
    markers: Option<PathBuf>,
    /// Table of the angles: frame, time_s, clock_s, <joint>_deg, <joint>_sd_deg, status; with a [clock] in the marker
    /// file also clock_read_s, clock_sd_s, clock_low_s, clock_high_s (.csv or .parquet)
    #[arg(long, value_name = "JOINTS.csv", required_unless_present_any = ["suggest", "plan"])]
    out: Option<PathBuf>,
    /// Table of the markers as well: frame, time_s, marker, x_px, y_px, sd_px, status (.csv or .parquet)
    #[arg(long, value_name = "TRACKS.csv")]
    tracks: Option<PathBuf>,
    /// Video with what was tracked drawn on it
    #[arg(long, value_name = "FILE.mp4")]
    overlay: Option<PathBuf>,
    /// Only these joints of the marker file, with the markers that they need
    #[arg(long, value_name = "J1,J2", value_delimiter = ',')]
    joints: Vec<String>,
    /// Leave the clock in the picture alone
    #[arg(long)]
    no_clock: bool,
    /// Smooth the angles over time (forward and backward); what is missing stays missing
    #[arg(long)]
    smooth: bool,
    /// Draw no pictures
    #[arg(long)]
    no_figures: bool,
    /// Print a marker file to start from, told from a few frames, and do nothing else
    #[arg(
        long,
        conflicts_with_all = ["markers", "out", "tracks", "overlay", "joints", "smooth", "plan", "no_clock", "no_figures"]
    )]
    suggest: bool,
    /// Say what would be done and left out, and do nothing
    #[arg(long)]
    plan: bool,
    #[command(flatten)]
    common: Common,
}

pub(super) fn run(args: &PostureArgs) -> anyhow::Result<Outcome> {
    let stop = args.common.start()?;
    let threads = args.common.threads.map_or(0, usize::from);
    if args.suggest {
        let suggested = suggest(&args.video, threads)?;
        if args.common.json {
            args.common.print_json(
                &serde_json::json!({ "job": "posture --suggest", "markers_toml": suggested, "warnings": [] }),
            )?;
        } else {
            print_line(suggested.trim_end());
        }
        return Ok(Outcome::Done);
    }
    let markers = args.markers.as_ref().context("--markers is needed")?;
    let layout = Layout::read(markers)?.wanting(&args.joints)?;
    let options = PostureOptions {
        threads,
        smooth: args.smooth,
        clock_every: u64::from(!args.no_clock),
        ..PostureOptions::default()
    };
    let outputs = args.out.as_ref().map(|joints| Outputs {
        joints: joints.clone(),
        tracks: args.tracks.clone(),
        overlay: args.overlay.clone(),
        figures: !args.no_figures,
    });
    if args.plan {
        let steps = plan(&args.video, &layout, &options, outputs.as_ref())?;
        return args.common.show_plan("posture", &steps);
    }
    let outputs = outputs.context("--out is needed")?;
    let bar = args.common.progress(0, "frames");
    let watch = Watch {
        stop: &stop,
        tick: &|done, all| {
            bar.set_length(all.unwrap_or(done));
            bar.set_position(done);
        },
    };
    let report = run_posture(&args.video, &layout, &options, &outputs, &watch);
    bar.finish_and_clear();
    match report {
        Err(PostureError::Interrupted) => Err(Interrupted.into()),
        Err(error) => Err(error.into()),
        Ok(report) => finish(&args.common, &report, &outputs),
    }
}

fn finish(common: &Common, report: &PostureReport, outputs: &Outputs) -> anyhow::Result<Outcome> {
    common.warn(&report.warnings);
    for fault in &report.failed {
        eprintln!("failed: {fault}");
    }
    common.print_json(report)?;
    for joint in &report.joints {
        let known = |value: Option<f64>, digits| value.map_or("-".into(), |v| format!("{v:.digits$}"));
        common.say(&format!(
            "{:<8} {:>7} of {} frames, {} to {} degrees, standard error {}",
            joint.joint,
            joint.frames,
            report.frames.all,
            known(joint.min_deg, 1),
            known(joint.max_deg, 1),
            known(joint.sd_deg, 3)
        ));
    }
    for marker in report.markers.iter().filter(|m| m.seen < report.frames.all) {
        common.say(&format!(
            "{:<24} lost in {} frames{}",
            marker.marker,
            report.frames.all - marker.seen,
            marker.reasons()
        ));
    }
    if let Some(clock) = &report.clock {
        let tie = clock.tie.as_ref().map_or("it ties nothing".to_owned(), |tie| {
            format!(
                "at the first frame {:.4} ± {:.4} s, drift {:.0} ± {:.0} ppm",
                tie.offset_s, tie.offset_sd_s, tie.drift_ppm, tie.drift_sd_ppm
            )
        });
        common.say(&format!("clock    read in {} of {} frames, {tie}", clock.frames_read, report.frames.all));
    }
    if common.verbose {
        for stage in &report.stages {
            common.say(&format!("{:<28} {:>9.3} s, {} runs", stage.stage, stage.thread_s, stage.runs));
        }
        common.say_left_out(&report.left_out);
    }
    common.say(&format!(
        "{:.2} s, {:.0} % of it decoding; look at {}",
        report.wall_s,
        100.0 * report.decoding_share,
        report.pictures.first().unwrap_or(&outputs.joints).display()
    ));
    Ok(if report.failed.is_empty() { Outcome::Done } else { Outcome::SomeFailed })
}
