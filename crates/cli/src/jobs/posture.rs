//! `lunula posture`: video to joint angles.

use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Args;
use lunula::job::Given;
use lunula::posture::{self, Layout, Outputs, PostureOptions, PostureReport, suggest};

use crate::jobs::{self, ResultArgs};
use crate::{Common, Outcome, print_line};

/// Measure joint angles in a video of a finger with coloured markers, each frame with its time and standard error
///
/// MARKERS.toml names the markers and their colours, the segments (two markers each, proximal first) and the joints
/// (two segments each), and where a digital clock is in the picture; --suggest prints one to start from. A marker that
/// is not seen is lost, and no angle comes from it. Results: the table of angles, and beside it <joints>.run.json and
/// pictures of the angles over time and of the last joint against the one before.
#[derive(Debug, Args)]
#[command(mut_arg("out", |out| out
    .value_name("JOINTS.csv")
    .help("Table of the angles: frame, time_s, clock_s, <joint>_deg, <joint>_sd_deg, status; with a [clock] in \
           the marker file also clock_read_s, clock_sd_s, clock_low_s, clock_high_s (.csv or .parquet)")
    .required_unless_present("suggest")
))]
pub(crate) struct PostureArgs {
    /// The video, in any format that FFmpeg reads
    video: PathBuf,
    /// The marker file
    #[arg(long, value_name = "MARKERS.toml", required_unless_present = "suggest")]
    markers: Option<PathBuf>,
    /// Table of the markers as well: frame, time_s, marker, x_px, y_px, sd_px, status (.csv or .parquet)
    #[arg(long, value_name = "TRACKS.csv")]
    tracks: Option<PathBuf>,
    /// Video with what was tracked drawn on it
    #[arg(long, value_name = "FILE.mp4")]
    overlay: Option<PathBuf>,
    #[command(flatten)]
    given: Given<PostureOptions>,
    /// Print a marker file to start from, guessed from a few frames, and do nothing else
    #[arg(
        long,
        conflicts_with_all = [
            "markers", "out", "tracks", "overlay", "joints", "smooth", "plan", "no_clock", "no_figures",
        ]
    )]
    suggest: bool,
    #[command(flatten)]
    results: ResultArgs,
}

impl PostureArgs {
    fn layout(&self) -> anyhow::Result<Layout> {
        let markers = self.markers.as_ref().context("--markers is needed")?;
        Ok(Layout::read(markers)?.wanting(&self.given.options.joints)?)
    }

    fn outputs(&self) -> Outputs {
        Outputs {
            joints: self.results.place(),
            tracks: self.tracks.clone(),
            overlay: self.overlay.clone(),
            figures: !self.results.no_figures,
            report: true,
        }
    }
}

/// `--suggest`, or the job.
pub(crate) fn run(args: &PostureArgs) -> anyhow::Result<Outcome> {
    let PostureArgs { video, given, results, .. } = args;
    let common = &results.job.common;
    if args.suggest {
        return print_suggested(video, common);
    }
    let options = PostureOptions { threads: common.threads(), ..given.options.clone() };
    jobs::run(
        &results.request("posture", "frames", &given.said),
        || Ok(posture::plan(video, &args.layout()?, &options, &args.outputs())?),
        |watch| Ok(posture::run(video, &args.layout()?, &options, &args.outputs(), watch)?),
        say,
    )
}

fn print_suggested(video: &Path, common: &Common) -> anyhow::Result<Outcome> {
    common.start()?;
    let suggested = suggest(video, common.threads())?;
    if common.json {
        common.print_json(
            &serde_json::json!({ "job": "posture --suggest", "markers_toml": suggested, "warnings": [] }),
        )?;
    } else {
        print_line(suggested.trim_end());
    }
    Ok(Outcome::Done)
}

fn say(common: &Common, report: &PostureReport) {
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
    common.say(&format!("{:.0} % of the time went into decoding", 100.0 * report.decoding_share));
}
