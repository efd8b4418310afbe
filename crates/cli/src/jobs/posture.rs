//! `lunula posture`: video to joint angles.

use std::path::PathBuf;

use anyhow::Context;
use clap::Args;
use lunula::job::{Given, Watch};
use lunula::posture::{Layout, Outputs, PostureFigures, PostureOptions, PostureReport, plan, run, suggest};

use crate::jobs::{Command, Plan, Request, ResultArgs, needed};
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

/// `--suggest`, or the job.
pub(crate) fn run_or_suggest(args: &PostureArgs) -> anyhow::Result<Outcome> {
    if !args.suggest {
        return crate::jobs::run(args);
    }
    let common = &args.results.job.common;
    common.start()?;
    let suggested = suggest(&args.video, common.threads())?;
    if common.json {
        common.print_json(
            &serde_json::json!({ "job": "posture --suggest", "markers_toml": suggested, "warnings": [] }),
        )?;
    } else {
        print_line(suggested.trim_end());
    }
    Ok(Outcome::Done)
}

impl PostureArgs {
    fn layout(&self) -> anyhow::Result<Layout> {
        let markers = self.markers.as_ref().context("--markers is needed")?;
        Ok(Layout::read(markers)?.wanting(&self.given.options.joints)?)
    }

    fn options(&self) -> PostureOptions {
        PostureOptions { threads: self.results.job.common.threads(), ..self.given.options.clone() }
    }

    fn outputs(&self) -> Option<Outputs> {
        Some(Outputs {
            joints: self.results.out.clone()?,
            tracks: self.tracks.clone(),
            overlay: self.overlay.clone(),
            figures: !self.results.no_figures,
            report: true,
        })
    }
}

impl Command for PostureArgs {
    type Figures = PostureFigures;

    const UNIT: &'static str = "frames";

    const NAME: &'static str = "posture";

    fn given(&self) -> Request<'_> {
        self.results.given(&self.given.said)
    }

    fn plan(&self) -> anyhow::Result<Plan> {
        Ok(plan(&self.video, &self.layout()?, &self.options(), self.outputs().as_ref())?.into())
    }

    fn run(&self, watch: &Watch<'_>) -> anyhow::Result<PostureReport> {
        Ok(run(&self.video, &self.layout()?, &self.options(), &needed(self.outputs())?, watch)?)
    }

    fn say(&self, common: &Common, report: &PostureReport) {
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
}
