//! `posture`: a video of a finger with coloured markers to joint angles (3.2.3, 3.3.5).
//!
//! Only the joints that somebody needs are measured, with the markers that they need; the clock in the picture is read
//! only where somebody needs its time. The angles of a joint hang on its own markers' places, so a table with fewer
//! joints holds the same numbers.

use std::collections::BTreeSet;
use std::sync::Arc;

use serde_json::json;

use super::format::{FORMAT, format, named};
use super::given::Given;
use super::truth::against;
use crate::pipeline::{
    Demand, Facts, Foreseen, Job, KeyFault, Keys, Kind, Made, Part, Prepared, Quality, Role, Takes, Work,
};
use crate::posture::{Layout, LayoutError, Outputs, PostureOptions, PostureReport, Watch, plan, run};
use crate::stages::Step;
use crate::table::TableFormat;
use crate::video::Header;

/// The kind.
pub(super) static POSTURE: Kind = Kind {
    name: "posture",
    about: "a video of a finger with coloured markers to joint angles, each frame with its time and standard error",
    roles: &[
        Role { name: "video", takes: Takes::One, about: "the video" },
        Role { name: "markers", takes: Takes::One, about: "the marker file: colours, segments, joints, clock, lens" },
        Role { name: "truth", takes: Takes::Optional, about: "the true angles: frame, <joint>_deg" },
    ],
    parts: &[
        Part { name: "joints", file: "joints.csv", only_if_wanted: false, about: "the table of angles" },
        Part { name: TRACKS, file: "tracks.csv", only_if_wanted: true, about: "the table of markers" },
        Part { name: OVERLAY, file: "overlay.mp4", only_if_wanted: true, about: "the video with what was tracked" },
        Part {
            name: PICTURES,
            file: "joints-angles.png",
            only_if_wanted: true,
            about: "pictures of the angles, and of the last joint against the one before",
        },
    ],
    revision: 1,
    keys: KEYS,
    prepare: |keys| Ok(Arc::new(Posture::prepare(keys)?)),
};

const TRACKS: &str = "tracks";
const OVERLAY: &str = "overlay";
const PICTURES: &str = "pictures";
const KEYS: &[&str] = &["joints", "no_clock", "smooth", FORMAT];

#[derive(Debug, Clone)]
struct Posture {
    joints: BTreeSet<String>,
    no_clock: bool,
    smooth: bool,
    format: TableFormat,
}

impl Posture {
    fn prepare(keys: toml::Table) -> Result<Self, KeyFault> {
        let mut given = Given::new(keys, KEYS)?;
        Ok(Self {
            joints: given.names("joints")?.into_iter().collect(),
            no_clock: given.flag("no_clock")?,
            smooth: given.flag("smooth")?,
            format: format(&mut given)?,
        })
    }

    /// The joints that are measured; empty: all of the marker file. Markers and overlay show what the stage itself
    /// names.
    fn joints(&self, demand: &Demand) -> BTreeSet<String> {
        let wanted =
            demand.joints.as_ref().filter(|_| !demand.parts.contains(TRACKS) && !demand.parts.contains(OVERLAY));
        match wanted {
            Some(wanted) if self.joints.is_empty() => wanted.clone(),
            // What the stage does not name is told by whoever misses it.
            Some(wanted) => {
                let both: BTreeSet<String> = self.joints.intersection(wanted).cloned().collect();
                if both.is_empty() { self.joints.clone() } else { both }
            }
            None => self.joints.clone(),
        }
    }

    fn reads_clock(&self, demand: &Demand) -> bool {
        demand.clock && !self.no_clock
    }

    fn posture_options(&self, demand: &Demand, threads: usize) -> PostureOptions {
        let clock_every = u64::from(self.reads_clock(demand));
        PostureOptions { threads, smooth: self.smooth, clock_every, ..PostureOptions::default() }
    }

    fn outputs(&self, demand: &Demand, folder: &std::path::Path) -> Outputs {
        let wanted = |part: &str| demand.parts.contains(part);
        Outputs {
            joints: folder.join(named(self.format, "joints.csv", "joints.parquet")),
            tracks: wanted(TRACKS).then(|| folder.join(named(self.format, "tracks.csv", "tracks.parquet"))),
            overlay: wanted(OVERLAY).then(|| folder.join("overlay.mp4")),
            figures: wanted(PICTURES),
        }
    }

    fn layout(&self, markers: &std::path::Path, demand: &Demand) -> Result<Layout, LayoutError> {
        Layout::read(markers)?.wanting(&self.joints(demand).into_iter().collect::<Vec<_>>())
    }
}

fn input<'a>(inputs: &'a [Foreseen], role: &str) -> Option<&'a Foreseen> {
    inputs.iter().find(|input| input.role == role)
}

impl Prepared for Posture {
    fn demand(&self, _role: &str, _own: &Demand) -> Demand {
        Demand::default()
    }

    fn options(&self, demand: &Demand) -> serde_json::Value {
        let made: Vec<&str> =
            [TRACKS, OVERLAY, PICTURES].into_iter().filter(|part| demand.parts.contains(part)).collect();
        json!({
            "joints": self.joints(demand),
            "clock": self.reads_clock(demand),
            "smooth": self.smooth,
            "format": named(self.format, "csv", "parquet"),
            "made": made,
        })
    }

    fn job(&self, _keys: &Keys, demand: &Demand) -> Arc<dyn Job> {
        Arc::new(PostureJob { stage: self.clone(), demand: demand.clone() })
    }

    fn steps(&self, inputs: &[Foreseen], demand: &Demand) -> Result<Vec<Step>, String> {
        let (video, markers) = (input(inputs, "video"), input(inputs, "markers"));
        if let (Some(video), Some(markers)) = (video, markers)
            && video.stands
            && markers.stands
        {
            let layout = self.layout(&markers.path, demand).map_err(|why| why.to_string())?;
            let outputs = self.outputs(demand, std::path::Path::new(""));
            let steps = plan(&video.path, &layout, &self.posture_options(demand, 1), Some(&outputs));
            return steps.map_err(|why| why.to_string());
        }
        let facts = |of: Option<&Foreseen>| of.map(|input| input.facts).unwrap_or_default();
        let (video, markers) = (facts(video), facts(markers));
        Ok(self.foreseen_steps(demand, video.distorted.or(markers.distorted), video.clock.or(markers.clock)))
    }

    fn facts(&self, inputs: &[Foreseen], demand: &Demand) -> Facts {
        let told = |of: fn(&Facts) -> Option<bool>| inputs.iter().find_map(|input| of(&input.facts));
        let standing = || {
            let markers = input(inputs, "markers").filter(|markers| markers.stands)?;
            Some(Layout::read(&markers.path).ok()?.clock.is_some())
        };
        let clock = if self.reads_clock(demand) { told(|facts| facts.clock).or_else(standing) } else { Some(false) };
        Facts { clock, ..Facts::default() }
    }

    fn cost(&self, inputs: &[Foreseen]) -> (u64, f64) {
        let known =
            input(inputs, "video").filter(|video| video.stands).and_then(|video| Header::read(&video.path).ok());
        let (width, height, frames) = match &known {
            Some(header) => (header.width, header.height, header.declared_frames.unwrap_or(USUAL_FRAMES)),
            None => (1280, 720, USUAL_FRAMES),
        };
        let pixels = (width * height) as f64;
        ((BYTES_A_PIXEL * pixels) as u64 + BYTES_AT_LEAST, frames as f64 * (S_A_FRAME + S_A_PIXEL * pixels))
    }

    fn file(&self, part: &Part) -> &'static str {
        match part.name {
            "joints" => named(self.format, "joints.csv", "joints.parquet"),
            TRACKS => named(self.format, "tracks.csv", "tracks.parquet"),
            _ => part.file,
        }
    }
}

impl Posture {
    /// The plan of a video that is still to be made.
    fn foreseen_steps(&self, demand: &Demand, distorted: Option<bool>, clock: Option<bool>) -> Vec<Step> {
        let joints = self.joints(demand);
        let tracked = if joints.is_empty() {
            "of all joints of the marker file".to_owned()
        } else {
            format!("of {}", joints.into_iter().collect::<Vec<_>>().join(", "))
        };
        let asked = |part: &str| if demand.parts.contains(part) { "asked for" } else { "not asked for" }.to_owned();
        let of_marker_file = |fact: Option<bool>, yes: &str, no: &str| match fact {
            Some(true) => yes.to_owned(),
            Some(false) => no.to_owned(),
            None => "as the marker file says".to_owned(),
        };
        let reads_clock = self.reads_clock(demand);
        let why_clock = if reads_clock {
            of_marker_file(clock, "[clock]", "no [clock]")
        } else {
            "nothing needs its time".to_owned()
        };
        vec![
            Step::new("decoding", true, "all frames".into()),
            Step::new("markers tracked", true, tracked),
            Step::new(
                "lens correction",
                distorted != Some(false),
                of_marker_file(distorted, "[camera], of the centres", "no [camera]"),
            ),
            Step::new("clock", reads_clock && clock != Some(false), why_clock),
            Step::new("smoothing", self.smooth, if self.smooth { "smooth".into() } else { "not asked for".into() }),
            Step::new("table of markers", demand.parts.contains(TRACKS), asked(TRACKS)),
            Step::new("overlay", demand.parts.contains(OVERLAY), asked(OVERLAY)),
            Step::new("figures", demand.parts.contains(PICTURES), asked(PICTURES)),
        ]
    }
}

/// Frames of a video whose header does not tell.
const USUAL_FRAMES: u64 = 1800;
/// Memory and time, measured with H.264 of 1280 x 720 and 3840 x 2160 on one core of 2.5 GHz.
const BYTES_A_PIXEL: f64 = 30.0;
const BYTES_AT_LEAST: u64 = 64 << 20;
const S_A_FRAME: f64 = 0.001;
const S_A_PIXEL: f64 = 9e-9;

struct PostureJob {
    stage: Posture,
    demand: Demand,
}

impl Job for PostureJob {
    fn run(&self, work: &Work) -> anyhow::Result<Made> {
        let given = |role: &str| work.one(role).ok_or_else(|| anyhow::anyhow!("no {role} is given"));
        let (video, markers) = (given("video")?, given("markers")?);
        let layout = self.stage.layout(&markers.path, &self.demand)?;
        let options = self.stage.posture_options(&self.demand, work.threads);
        let outputs = self.stage.outputs(&self.demand, work.folder);
        let watch = Watch { stop: work.stop, tick: &|_, _| {} };
        let report = run(&video.path, &layout, &options, &outputs, &watch)?;
        std::fs::remove_file(crate::files::beside(&outputs.joints, ".run.json"))?;
        let quality = match work.one("truth") {
            Some(truth) => against(&truth.path, "frame", &outputs.joints, "frame", 0.5)?,
            None => stated(&report),
        };
        Ok(Made {
            left_out: report.left_out.clone(),
            warnings: report.warnings.clone(),
            failed: report.failed.clone(),
            stages: report.stages.clone(),
            quality,
            report: serde_json::to_value(report)?,
        })
    }
}

/// The standard errors that the angles come with.
fn stated(report: &PostureReport) -> Vec<Quality> {
    let quality = |joint: &crate::posture::JointReport| {
        let unit = "degrees, standard error, RMS over frames".to_owned();
        Some(Quality { what: joint.joint.clone(), value: joint.sd_deg?, unit, against_truth: false })
    };
    report.joints.iter().filter_map(quality).collect()
}
