//! `lunula predict`: voltages to forces and angle.

use std::path::{Path, PathBuf};

use anyhow::{bail, ensure};
use clap::Args;
use lunula::job::Given;
use lunula::predictor::{DataFile, PredictChoices, PredictReport, predict, predict_plan};

use crate::jobs::{self, JobArgs, Request, needed};
use crate::{Common, Outcome};

/// Predict forces and angle from photodiodes, with models that `lunula train` wrote
///
/// With a model of force and one of posture the two are gated (equations 9, 16): while the finger presses with --f-min
/// or more (-Fz_N) it touches, and the angle is --theta-touch; else the posture model predicts the angle. A row that
/// lacks a voltage has no prediction. DATA may be `-`: rows of CSV on standard input, the first names the columns; each
/// is answered as soon as its line is complete, as `lunula live --source -` does. Of a log with a column `led`, each
/// lit row is answered: less the unlit light at its time, or, of a stream, less the unlit row before it.
#[derive(Debug, Args)]
pub(crate) struct PredictArgs {
    /// Model files, then the recording: a table, a log, or `-` for a stream of CSV rows
    #[arg(required = true, value_name = "MODEL... DATA")]
    paths: Vec<PathBuf>,
    /// time_s, Fx_N, Fy_N, Fz_N and/or J2_deg, contact (.csv or .parquet) [default for a stream: standard output]
    #[arg(long, value_name = "PREDICTED.csv")]
    out: Option<PathBuf>,
    #[command(flatten)]
    given: Given<PredictChoices>,
    #[command(flatten)]
    job: JobArgs,
}

impl PredictArgs {
    fn parts(&self) -> anyhow::Result<(&Path, &[PathBuf])> {
        match &self.paths[..] {
            [models @ .., data] if !models.is_empty() => Ok((data, models)),
            _ => bail!("name a model, or several, and then the recording: only one file is named"),
        }
    }
}

/// The stream on standard input, or the job.
pub(crate) fn run(args: &PredictArgs) -> anyhow::Result<Outcome> {
    let (data, models) = args.parts()?;
    let PredictArgs { out, given, job, .. } = args;
    if data == Path::new("-") {
        ensure!(out.is_none(), "a stream is answered on standard output; leave --out away and redirect it");
        ensure!(
            !job.common.json,
            "a stream is answered on standard output, where --json would print; leave one of them away"
        );
        ensure!(!job.plan, "a stream has no plan; `lunula live --plan` shows that of a session");
        return jobs::live::session::run_stream(&job.common, given, models);
    }
    jobs::run(
        &Request { name: "predict", unit: "steps", job, said: &given.said, result: out.clone() },
        || {
            let options = given.options.options()?;
            let ambient = DataFile::ambient_step([&DataFile::from(data.to_owned())], &options.rows);
            Ok(predict_plan(models.len(), ambient, &options))
        },
        |watch| {
            let out = needed(out.as_ref())?;
            Ok(predict(models, data, &given.options.options()?, out, watch)?)
        },
        say,
    )
}

fn say(common: &Common, report: &PredictReport) {
    common.say(&format!(
        "{} rows, {} of them not known, {} outside of what was trained on",
        report.rows, report.rows_not_known, report.rows_outside
    ));
    if report.touch + report.bending > 0 {
        common.say(&format!("touch in {} rows, bending in {}", report.touch, report.bending));
    }
}
