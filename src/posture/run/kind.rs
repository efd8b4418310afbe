//! `posture` in a pipeline: a video of a finger with coloured markers to joint angles (3.2.3, 3.3.5).
//!
//! Only the joints that somebody needs are measured, with the markers that they need; the clock in the picture is read
//! only where somebody needs its time. The angles of a joint depend on its own markers only, so a table with fewer
//! joints holds the same numbers.

use std::collections::BTreeSet;
use std::path::Path;

use clap::Args;
use serde_json::json;

use crate::job::{
    Demand, Facts, Foreseen, Job, Kind, Made, Order, Part, Quality, Role, Said, Tables, Takes, Work, against,
};
use crate::posture::layout::{Layout, LayoutError};
use crate::posture::options::{Outputs, PostureOptions};
use crate::posture::run::job::run;
use crate::posture::run::plan::{Known, plan, steps};
use crate::posture::run::report::{JointReport, PostureReport};
use crate::stages::Step;

const TRACKS: &str = "tracks";
const OVERLAY: &str = "overlay";

/// A stage of a pipeline.
#[derive(Debug, Clone, Args)]
pub(crate) struct PostureJob {
    #[command(flatten)]
    options: PostureOptions,
    #[command(flatten)]
    tables: Tables,
}

impl PostureJob {
    /// The joints that are measured; empty: all of the marker file. Markers and overlay show what the stage itself
    /// names.
    fn joints(&self, demand: &Demand) -> Vec<String> {
        let own: BTreeSet<String> = self.options.joints.iter().cloned().collect();
        let wanted = demand.joints.as_ref().filter(|_| !demand.wants(TRACKS) && !demand.wants(OVERLAY));
        let joints = match wanted {
            Some(wanted) if own.is_empty() => wanted.clone(),
            Some(wanted) => {
                let both: BTreeSet<String> = own.intersection(wanted).cloned().collect();
                // Whoever misses what the stage does not name reports it.
                if both.is_empty() { own } else { both }
            }
            None => own,
        };
        joints.into_iter().collect()
    }

    fn options(&self, demand: &Demand, threads: usize) -> PostureOptions {
        let own = &self.options;
        let no_clock = own.no_clock || !demand.clock;
        PostureOptions { joints: self.joints(demand), no_clock, threads, ..own.clone() }
    }

    fn outputs(&self, demand: &Demand, folder: &Path) -> Outputs {
        let tables = self.tables;
        Outputs {
            joints: folder.join(tables.named("joints.csv", "joints.parquet")),
            tracks: demand.wants(TRACKS).then(|| folder.join(tables.named("tracks.csv", "tracks.parquet"))),
            overlay: demand.wants(OVERLAY).then(|| folder.join("overlay.mp4")),
            figures: demand.draws(),
            report: false,
        }
    }

    fn layout(&self, markers: &Path, demand: &Demand) -> Result<Layout, LayoutError> {
        Layout::read(markers)?.wanting(&self.joints(demand))
    }
}

impl Job for PostureJob {
    const KIND: Kind = Kind::of::<Self>(
        "posture",
        &[
            Role::new("video", Takes::One, "the video"),
            Role::new("markers", Takes::One, "the marker file: colours, segments, joints, clock, lens"),
            Role::new("truth", Takes::Optional, "the true angles: frame, <joint>_deg"),
        ],
        &[
            Part::new("joints", "joints.csv"),
            Part::if_wanted(TRACKS, "tracks.csv"),
            Part::if_wanted(OVERLAY, "overlay.mp4"),
            Part::pictures("joints-angles.png"),
        ],
    )
    .revision(12);

    fn depends_on(&self, _said: &Said, demand: &Demand) -> serde_json::Value {
        let made: Vec<&str> = [TRACKS, OVERLAY, Part::PICTURES].into_iter().filter(|part| demand.wants(part)).collect();
        let options = self.options(demand, 1);
        json!({
            "joints": options.joints,
            "clock": options.reads_clock(),
            "smooth": options.smooth,
            "format": self.tables.named("csv", "parquet"),
            "made": made,
        })
    }

    fn steps(&self, inputs: &[Foreseen], demand: &Demand) -> Result<Vec<Step>, String> {
        let (video, markers) = (Foreseen::of(inputs, "video"), Foreseen::of(inputs, "markers"));
        let (options, outputs) = (self.options(demand, 1), self.outputs(demand, Path::new("")));
        if let (Some(video), Some(markers)) = (video, markers)
            && video.exists
            && markers.exists
        {
            let layout = self.layout(&markers.path, demand).map_err(|why| why.to_string())?;
            return plan(&video.path, &layout, &options, &outputs).map_err(|why| why.to_string());
        }
        let facts = |of: Option<&Foreseen>| of.map(|input| input.facts).unwrap_or_default();
        let (video, markers) = (facts(video), facts(markers));
        let distorted = video.distorted.or(markers.distorted);
        let known = Known { distorted, clock: video.clock.or(markers.clock), ..Known::default() };
        Ok(steps(&known, &options, &outputs))
    }

    fn facts(&self, inputs: &[Foreseen], demand: &Demand) -> Facts {
        let existing = || {
            let markers = Foreseen::of(inputs, "markers").filter(|markers| markers.exists)?;
            Some(Layout::read(&markers.path).ok()?.clock.is_some())
        };
        let reads = self.options(demand, 1).reads_clock();
        let clock =
            if reads { inputs.iter().find_map(|input| input.facts.clock).or_else(existing) } else { Some(false) };
        Facts { clock, ..Facts::default() }
    }

    fn cost(&self, inputs: &[Foreseen]) -> (u64, f64) {
        let (frames, pixels) = Foreseen::of_video(inputs, "video");
        ((BYTES_A_PIXEL * pixels) as u64 + BYTES_AT_LEAST, frames * (S_A_FRAME + S_A_PIXEL * pixels))
    }

    fn file(&self, part: &Part) -> &'static str {
        match part.name {
            "joints" => self.tables.named("joints.csv", "joints.parquet"),
            TRACKS => self.tables.named("tracks.csv", "tracks.parquet"),
            _ => part.file,
        }
    }

    fn run(&self, order: &Order<'_>, work: &Work<'_>) -> anyhow::Result<Made> {
        let (video, markers) = (work.needed("video")?, work.needed("markers")?);
        let layout = self.layout(&markers.path, order.demand)?;
        let options = self.options(order.demand, work.threads);
        let outputs = self.outputs(order.demand, work.folder);
        let report = work.run(order.said, |watch| run(&video.path, &layout, &options, &outputs, watch))?;
        let quality = match work.one("truth") {
            Some(truth) => against(&truth.path, "frame", &outputs.joints, "frame", 0.5)?,
            None => stated(&report),
        };
        Ok(report.made(quality))
    }
}

/// Memory and time, measured with H.264 of 1280 x 720 and 3840 x 2160 on one core of 2.5 GHz.
const BYTES_A_PIXEL: f64 = 30.0;
const BYTES_AT_LEAST: u64 = 64 << 20;
const S_A_FRAME: f64 = 0.001;
const S_A_PIXEL: f64 = 9e-9;

/// The standard errors that the angles come with.
fn stated(report: &PostureReport) -> Vec<Quality> {
    let quality = |joint: &JointReport| {
        Some(Quality::stated(&joint.joint, joint.sd_deg?, "degrees, standard error, RMS over frames"))
    };
    report.joints.iter().filter_map(quality).collect()
}
