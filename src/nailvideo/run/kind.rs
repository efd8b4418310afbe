//! `nailvideo` in a pipeline: a video of a nail to virtual photodiodes.

use std::path::Path;

use clap::Args;

use crate::job::{Demand, Foreseen, Job, Kind, Made, OptionFault, Order, Part, Quality, Role, Tables, Takes, Work};
use crate::nailvideo::options::{Inputs, NailVideoOptions, Outputs};
use crate::nailvideo::run::job::run;
use crate::nailvideo::run::plan::{plan, steps};
use crate::stages::Step;
use crate::table::TableFormat;
use crate::video::Header;

const FRAMES: &str = "frames";
const REPORT: &str = "report";

/// The options of a stage.
#[derive(Debug, Clone, Args)]
pub struct NailVideoKeys {
    #[command(flatten)]
    options: NailVideoOptions,
    #[command(flatten)]
    tables: Tables,
}

/// A stage of a pipeline.
#[derive(Debug, Clone)]
pub struct NailVideoJob(NailVideoKeys);

impl NailVideoJob {
    fn outputs(&self, folder: &Path, demand: &Demand) -> Outputs {
        Outputs {
            folder: folder.to_owned(),
            frames: demand.wants(FRAMES),
            figures: demand.wants(REPORT),
            report: false,
            ending: ending(self.0.tables.format()),
        }
    }
}

fn ending(format: TableFormat) -> &'static str {
    match format {
        TableFormat::Csv => "csv",
        TableFormat::Parquet => "parquet",
    }
}

impl Job for NailVideoJob {
    const KIND: Kind = Kind::of::<Self>(
        "nailvideo",
        &[
            Role { name: "video", takes: Takes::One, about: "the video of a nail" },
            Role {
                name: "outline",
                takes: Takes::Optional,
                about: "the nail in its first frame: LabelMe file or mask",
            },
            Role { name: "positions", takes: Takes::Optional, about: "where the photodiodes are (positions.toml)" },
        ],
        &[
            Part { name: "photodiodes", file: "photodiodes.csv", only_if_wanted: false },
            Part { name: "motion", file: "motion.csv", only_if_wanted: false },
            Part { name: "presses", file: "presses.csv", only_if_wanted: false },
            Part { name: "cells", file: "cells.csv", only_if_wanted: false },
            Part { name: "maps", file: "maps", only_if_wanted: false },
            Part { name: FRAMES, file: "frames", only_if_wanted: true },
            Part { name: REPORT, file: "report.html", only_if_wanted: true },
        ],
    );

    type Options = NailVideoKeys;

    fn new(options: NailVideoKeys) -> Result<Self, OptionFault> {
        Ok(Self(options))
    }

    fn steps(&self, inputs: &[Foreseen], demand: &Demand) -> Result<Vec<Step>, String> {
        let outputs = self.outputs(Path::new(""), demand);
        let at = |role: &str| Foreseen::of(inputs, role).map(|input| input.path.clone());
        let video = Foreseen::of(inputs, "video").filter(|video| video.exists);
        let Some(video) = video else {
            return Ok(steps(None, at("outline").is_some(), &self.0.options, Some(&outputs)));
        };
        let inputs = Inputs { video: video.path.clone(), outline: at("outline"), positions: at("positions") };
        plan(&inputs, &self.0.options, Some(&outputs)).map_err(|why| why.to_string())
    }

    fn cost(&self, inputs: &[Foreseen]) -> (u64, f64) {
        let known = Foreseen::of(inputs, "video").filter(|video| video.exists);
        let (width, height, frames) = match known.and_then(|video| Header::read(&video.path).ok()) {
            Some(header) => (header.width, header.height, header.declared_frames.unwrap_or(TYPICAL_FRAMES)),
            None => (1280, 720, TYPICAL_FRAMES),
        };
        let pixels = (width * height) as f64;
        ((BYTES_A_PIXEL * pixels) as u64 + BYTES_AT_LEAST, frames as f64 * (S_A_FRAME + S_A_PIXEL * pixels))
    }

    fn file(&self, part: &Part) -> &'static str {
        let named = |csv: &'static str, parquet: &'static str| self.0.tables.named(csv, parquet);
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
        let options = NailVideoOptions { threads: work.threads, ..self.0.options.clone() };
        let outputs = self.outputs(work.folder, order.demand);
        let report = work.run(order.said, |watch| run(&inputs, &options, &outputs, watch))?;
        let share = report.frames.followed as f64 / report.frames.all.max(1) as f64;
        let mut quality = vec![Quality::stated("nail followed", 100.0 * share, "per cent of the frames")];
        quality
            .extend(report.se_px.map(|se| Quality::stated("place of the nail", se, "pixels, standard error, median")));
        Ok(report.made(quality))
    }
}

/// Frames of a video whose header does not say how many it has.
const TYPICAL_FRAMES: u64 = 1800;
/// Memory and time (assumed, from videos of 640 x 480).
const BYTES_A_PIXEL: f64 = 60.0;
const BYTES_AT_LEAST: u64 = 96 << 20;
const S_A_FRAME: f64 = 0.003;
const S_A_PIXEL: f64 = 9e-9;
