//! `lunula tradeoff`: error against run time.

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use lunula::phantom::nail::Pose;
use lunula::phantom::photos::{PhotoOptions, write};
use lunula::phantom::video::{self, Scene, VideoOptions};
use lunula::tradeoff::Row;
use lunula::tradeoff::{photos as photo_jobs, posture as posture_jobs};

use super::phantom::SceneArg;
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
    Posture(PostureArgs),
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

/// Joint angles against the exact ones: planes used, rounds of refinement, where markers are searched, and OpenCV's usual recipe
///
/// On a synthetic video of its own, or on --input with --truth, as `lunula phantom video` writes them.
#[derive(Debug, Args)]
struct PostureArgs {
    /// Folder for the results
    #[arg(long)]
    out: PathBuf,
    /// Folder with video.mp4 and markers.toml
    #[arg(long, requires = "truth")]
    input: Option<PathBuf>,
    /// Its truth/
    #[arg(long, requires = "input")]
    truth: Option<PathBuf>,
    /// Seed of the synthetic video
    #[arg(long, default_value_t = 1, conflicts_with = "input")]
    seed: u64,
    /// The synthetic video's scene, as of `lunula phantom video`
    #[arg(long, value_enum, default_value = "clean", conflicts_with = "input")]
    scene: SceneArg,
    /// Runs of each setting; the median time counts
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u16).range(1..=1000))]
    repeats: u16,
    #[command(flatten)]
    common: Common,
}

const POSES: [Pose; 4] = [Pose::Nominal, Pose::Normal, Pose::LateralPositive, Pose::Extension];

pub(super) fn run(args: &TradeoffArgs) -> anyhow::Result<Outcome> {
    match &args.job {
        Job::Photos(args) => photos(args),
        Job::Posture(args) => posture(args),
    }
}

fn photos(args: &PhotosArgs) -> anyhow::Result<Outcome> {
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
    let settings = photo_jobs::Settings { set, truth, repeats: usize::from(args.repeats) };
    finish("photos", &photo_jobs::measure(&settings)?, &args.out, &args.common)
}

fn posture(args: &PostureArgs) -> anyhow::Result<Outcome> {
    args.common.start()?;
    let scenes = tempfile::tempdir()?;
    let (input, truth) = match args.input.clone().zip(args.truth.clone()) {
        Some(given) => given,
        None => {
            let options = VideoOptions { seed: args.seed, ..VideoOptions::new(args.scene.preset()) };
            video::write(&Scene::new(options)?, scenes.path())?;
            (scenes.path().to_owned(), scenes.path().join("truth"))
        }
    };
    let settings = posture_jobs::Settings {
        video: input.join("video.mp4"),
        markers: input.join("markers.toml"),
        truth,
        repeats: usize::from(args.repeats),
        threads: args.common.threads.map_or(0, usize::from),
    };
    finish("posture", &posture_jobs::measure(&settings)?, &args.out, &args.common)
}

fn finish(job: &str, rows: &[Row], out: &Path, common: &Common) -> anyhow::Result<Outcome> {
    lunula::tradeoff::write(rows, &format!("lunula {job}"), out)?;
    common.print_json(&serde_json::json!({
        "job": format!("tradeoff {job}"),
        "version": env!("CARGO_PKG_VERSION"),
        "rows": rows,
        "warnings": [],
    }))?;
    for row in rows {
        let Row { setting, error, error_unit, run_s, .. } = row;
        common.say(&format!("{setting:<34} {error:>8.4}  {run_s:>8.5} s an input  {error_unit}"));
    }
    common.say(&format!("look at {}", out.join("tradeoff.png").display()));
    Ok(Outcome::Done)
}
