//! `nailvideo` in a pipeline: a video of a nail to virtual photodiodes.

use std::path::Path;

use clap::Args;

use crate::job::{Demand, Foreseen, Job, Kind, Made, Order, Part, Quality, Role, Tables, Takes, Work};
use crate::nailvideo::options::{Inputs, NailVideoOptions, Outputs};
use crate::nailvideo::run::job::run;
use crate::nailvideo::run::plan::{plan, steps};
use crate::stages::Step;

const FRAMES: &str = "frames";
const REPORT: &str = "report";

/// A stage of a pipeline.
#[derive(Debug, Clone, Args)]
pub struct NailVideoJob {
    #[command(flatten)]
    options: NailVideoOptions,
    #[command(flatten)]
    tables: Tables,
}

impl NailVideoJob {
    fn outputs(&self, folder: &Path, demand: &Demand) -> Outputs {
        Outputs {
            folder: folder.to_owned(),
            frames: demand.wants(FRAMES),
            figures: demand.wants(REPORT),
            report: false,
            ending: self.tables.named("csv", "parquet"),
        }
    }
}

impl Job for NailVideoJob {
    const KIND: Kind = Kind::of::<Self>(
        "nailvideo",
        &[
            Role::new("video", Takes::One, "the video of a nail"),
            Role::new("outline", Takes::Optional, "the nail in its first frame: LabelMe file or mask"),
            Role::new("positions", Takes::Optional, "where the photodiodes are (positions.toml)"),
        ],
        &[
            Part::new("photodiodes", "photodiodes.csv"),
            Part::new("motion", "motion.csv"),
            Part::new("presses", "presses.csv"),
            Part::new("cells", "cells.csv"),
            Part::new("maps", "maps"),
            Part::if_wanted(FRAMES, "frames"),
            Part::if_wanted(REPORT, "report.html"),
        ],
    )
    .revision(28);

    fn steps(&self, inputs: &[Foreseen], demand: &Demand) -> Result<Vec<Step>, String> {
        let outputs = self.outputs(Path::new(""), demand);
        let at = |role: &str| Foreseen::of(inputs, role).map(|input| input.path.clone());
        let video = Foreseen::of(inputs, "video").filter(|video| video.exists);
        let Some(video) = video else {
            return Ok(steps(None, at("outline").is_some(), &self.options, &outputs));
        };
        let inputs = Inputs { video: video.path.clone(), outline: at("outline"), positions: at("positions") };
        plan(&inputs, &self.options, &outputs).map_err(|why| why.to_string())
    }

    fn cost(&self, inputs: &[Foreseen]) -> (u64, f64) {
        let (frames, pixels) = Foreseen::of_video(inputs, "video");
        ((BYTES_A_PIXEL * pixels) as u64 + BYTES_AT_LEAST, frames * (S_A_FRAME + S_A_PIXEL * pixels))
    }

    fn file(&self, part: &Part) -> &'static str {
        let named = |csv: &'static str, parquet: &'static str| self.tables.named(csv, parquet);
        match part.name {
            "photodiodes" => named("photodiodes.csv", "photodiodes.parquet"),
            "motion" => named("motion.csv", "motion.parquet"),
            "presses" => named("presses.csv", "presses.parquet"),
            "cells" => named("cells.csv", "cells.parquet"),
            _ => part.file,
        }
    }

    fn run(&self, order: &Order<'_>, work: &Work<'_>) -> anyhow::Result<Made> {
        let inputs = Inputs {
            video: work.needed("video")?.path.clone(),
            outline: work.one("outline").map(|input| input.path.clone()),
            positions: work.one("positions").map(|input| input.path.clone()),
        };
        let options = NailVideoOptions { threads: work.threads, ..self.options.clone() };
        let outputs = self.outputs(work.folder, order.demand);
        let report = work.run(order.said, |watch| run(&inputs, &options, &outputs, watch))?;
        let share = report.frames.followed as f64 / report.frames.all.max(1) as f64;
        let mut quality = vec![Quality::stated("nail followed", 100.0 * share, "per cent of the frames")];
        quality
            .extend(report.se_px.map(|se| Quality::stated("place of the nail", se, "pixels, standard error, median")));
        Ok(report.made(quality))
    }
}

/// Memory and time (assumed, from videos of 640 x 480).
const BYTES_A_PIXEL: f64 = 60.0;
const BYTES_AT_LEAST: u64 = 96 << 20;
const S_A_FRAME: f64 = 0.003;
const S_A_PIXEL: f64 = 9e-9;
