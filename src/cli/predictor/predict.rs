//! `lunula predict`: voltages to forces and angle.

use std::io::{BufReader, stdin};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use anyhow::Context;
use clap::Args;
use lunula::log::LogReading;
use lunula::predictor::models::Gate;
use lunula::predictor::{F_MIN_N, PredictOptions, predict as run_predict, predict_stream};

use super::{Common, Outcome, ended, say_notes};
use crate::cli::out::Stream;

/// Forces and angle from photodiodes, by models that `lunula train` wrote
///
/// With a model of force and one of posture the two are gated (equations 9, 16): while the finger presses with --f-min
/// or more (-Fz_N) it touches, and the angle is --theta-touch; else the posture model speaks. A row that lacks a
/// voltage has no prediction. DATA may be `-`: rows of CSV on standard input, the first names the columns; each is
/// answered as soon as its line is complete. Of a log with a column `led`, each lit row is answered: less the unlit
/// light at its time, or, of a stream, less the unlit row before it.
#[derive(Debug, Args)]
pub(crate) struct PredictArgs {
    /// Model files, then the recording: a table, a log, or `-` for a stream of CSV rows
    #[arg(required = true, num_args = 2.., value_name = "MODEL... DATA")]
    paths: Vec<PathBuf>,
    /// time_s, Fx_N, Fy_N, Fz_N and/or J2_deg, contact (.csv or .parquet) [default for a stream: standard output]
    #[arg(long, value_name = "PREDICTED.csv")]
    out: Option<PathBuf>,
    /// The pressing from which on the finger touches
    #[arg(long, value_name = "NEWTONS", default_value_t = F_MIN_N)]
    f_min: f64,
    /// The angle while it touches
    #[arg(long, value_name = "DEGREES", default_value_t = 0.0, allow_negative_numbers = true)]
    theta_touch: f64,
    /// The finger stops to touch only so far below --f-min
    #[arg(long, value_name = "NEWTONS", default_value_t = 0.0)]
    hysteresis: f64,
    /// Each prediction's interval as well, as <target>_low, <target>_high (the models need to be trained with
    /// --validate)
    #[arg(long)]
    intervals: bool,
    /// A cell that is no finite number counts as missing [default: it is an error]
    #[arg(long)]
    drop_invalid: bool,
    /// Rows in which `lunula align` found a photodiode saturated or without ambient light are answered too
    #[arg(long)]
    keep_faults: bool,
    #[command(flatten)]
    log: LogReading,
    #[command(flatten)]
    common: Common,
}

pub(crate) fn run(args: &PredictArgs) -> anyhow::Result<Outcome> {
    let (data, models) = args.paths.split_last().context("name a model and a recording")?;
    let options = PredictOptions {
        gate: Gate::new(args.f_min, args.theta_touch, args.hysteresis)?,
        intervals: args.intervals,
        drop_invalid: args.drop_invalid,
        keep_faults: args.keep_faults,
        log: args.log.clone(),
    };
    let common = &args.common;
    if data == Path::new("-") {
        anyhow::ensure!(
            args.out.is_none(),
            "a stream is answered on standard output; leave --out away and redirect it"
        );
        anyhow::ensure!(
            !common.json,
            "a stream is answered on standard output, where --json would stand; leave one of them away"
        );
        let tell = |note: &str| say_notes(common, &[note.to_owned()]);
        // No row may come for long: whoever interrupts a stream ends it at once, as there is nothing to put in order.
        let stop = AtomicBool::new(false);
        predict_stream(models, BufReader::new(stdin().lock()), &options, Stream, tell, &stop).map_err(ended)?;
        return Ok(Outcome::Done);
    }
    let stop = common.start()?;
    let out = args.out.as_ref().context("--out is needed: the table of predictions")?;
    let report = run_predict(models, data, &options, out, &stop).map_err(ended)?;
    say_notes(common, &report.warnings);
    common.print_json(&report)?;
    common.say(&format!(
        "{} rows, {} of them not known, {} outside of what was trained on",
        report.rows, report.rows_not_known, report.rows_outside
    ));
    if report.touch + report.bending > 0 {
        common.say(&format!("touch in {} rows, bending in {}", report.touch, report.bending));
    }
    if common.verbose {
        report.notes.iter().for_each(|note| common.say(note));
    }
    common.say(&format!("{:.2} s; {}", report.wall_s, out.display()));
    Ok(Outcome::Done)
}
