//! `lunula tradeoff`: error against run time.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use lunula::phantom::nail::Pose;
use lunula::phantom::photos::{PhotoOptions, write};
use lunula::tradeoff::Row;
use lunula::tradeoff::photos::{Settings, measure};

use super::{Common, Outcome};

/// Error against run time, over the settings of a job: table (tradeoff.csv) and picture (tradeoff.png, .svg)
#[derive(Debug, Args)]
pub(super) struct TradeoffArgs {
    #[command(subcommand)]
    job: Job,
}

#[derive(Debug, Subcommand)]
enum Job {
    Photos(PhotosArgs),
}

/// Resampling against the exact normalized pictures, and detection against the exact outlines
///
/// On synthetic photographs of its own, or on --input with --truth, laid out as `lunula phantom photos` writes them.
#[derive(Debug, Args)]
struct PhotosArgs {
    /// Folder for the results
    #[arg(long)]
    out: PathBuf,
    /// A set of photographs
    #[arg(long, requires = "truth")]
    input: Option<PathBuf>,
    /// Its truth/
    #[arg(long, requires = "input")]
    truth: Option<PathBuf>,
    /// Seed of the synthetic photographs
    #[arg(long, default_value_t = 1, conflicts_with = "input")]
    seed: u64,
    /// Subjects of the synthetic photographs, in four poses
    #[arg(long, default_value_t = 16, conflicts_with = "input")]
    subjects: u32,
    /// Runs of each setting; the median time counts
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u16).range(1..=1000))]
    repeats: u16,
    #[command(flatten)]
    common: Common,
}

const POSES: [Pose; 4] = [Pose::Nominal, Pose::Normal, Pose::LateralPositive, Pose::Extension];

pub(super) fn run(args: &TradeoffArgs) -> anyhow::Result<Outcome> {
    let Job::Photos(args) = &args.job;
    args.common.start()?;
    let scenes = tempfile::tempdir()?;
    let (set, truth) = match args.input.clone().zip(args.truth.clone()) {
        Some(given) => given,
        None => {
            let options = PhotoOptions {
                seed: args.seed,
                subjects: args.subjects,
                poses: POSES.to_vec(),
                ..PhotoOptions::default()
            };
            write(&options, scenes.path())?;
            (scenes.path().join("photos"), scenes.path().join("truth"))
        }
    };
    let rows = measure(&Settings { set, truth, repeats: usize::from(args.repeats) })?;
    lunula::tradeoff::write(&rows, "lunula photos", &args.out)?;
    args.common.print_json(&serde_json::json!({
        "job": "tradeoff photos",
        "version": env!("CARGO_PKG_VERSION"),
        "rows": rows,
        "warnings": [],
    }))?;
    for row in &rows {
        let Row { setting, error, error_unit, run_s, .. } = row;
        args.common.say(&format!("{setting:<18} {error:>8.4}  {run_s:>8.5} s an input  {error_unit}"));
    }
    args.common.say(&format!("look at {}", args.out.join("tradeoff.png").display()));
    Ok(Outcome::Done)
}
