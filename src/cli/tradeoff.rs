//! `lunula tradeoff`: error against run time.

use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::{Args, Subcommand};
use lunula::phantom::log::{self, LogOptions, LogScene, Protocol};
use lunula::phantom::nail::Pose;
use lunula::phantom::photos::{PhotoOptions, write};
use lunula::phantom::screen::Clock;
use lunula::phantom::trajectory::Trajectory;
use lunula::phantom::video::{self, Scene, VideoOptions};
use lunula::tradeoff::Row;
use lunula::tradeoff::{
    align as align_jobs, hemodynamics as hemodynamics_jobs, photos as photo_jobs, posture as posture_jobs,
    predictor as predictor_jobs,
};

use super::phantom::SceneArg;
use super::{Common, Outcome, hand_over};

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
    Align(AlignArgs),
    Predictor(PredictorArgs),
    Hemodynamics(HemodynamicsArgs),
}

/// What every trade-off takes.
#[derive(Debug, Args)]
struct Measured {
    /// Folder for the results
    #[arg(long)]
    out: PathBuf,
    /// A folder to measure on, as `lunula phantom` writes it
    #[arg(long, requires = "truth")]
    input: Option<PathBuf>,
    /// Its truth/
    #[arg(long, requires = "input")]
    truth: Option<PathBuf>,
    /// Seed of the synthetic inputs
    #[arg(long, default_value_t = 1, conflicts_with = "input")]
    seed: u64,
    /// Runs of each setting; the median time counts
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u16).range(1..=1000))]
    repeats: u16,
    #[command(flatten)]
    common: Common,
}

impl Measured {
    /// The input and its truth; where none is given, `make` writes them into a folder that goes away with the second value.
    fn scenes(
        &self,
        make: impl FnOnce(&Path) -> anyhow::Result<PathBuf>,
    ) -> anyhow::Result<(PathBuf, PathBuf, Option<tempfile::TempDir>)> {
        if let Some((input, truth)) = self.input.clone().zip(self.truth.clone()) {
            return Ok((input, truth, None));
        }
        let folder = tempfile::tempdir()?;
        Ok((make(folder.path())?, folder.path().join("truth"), Some(folder)))
    }

    fn threads(&self) -> usize {
        self.common.threads.map_or(0, usize::from)
    }
}

/// Resampling against the exact normalized pictures, and detection against the exact outlines
///
/// On synthetic photographs of its own, or on --input (a set of photographs) with --truth.
#[derive(Debug, Args)]
struct PhotosArgs {
    /// Subjects of the synthetic photographs, in four poses
    #[arg(long, default_value_t = 16, conflicts_with = "input")]
    subjects: u32,
    #[command(flatten)]
    measured: Measured,
}

/// Joint angles against the exact ones: planes used, rounds of refinement, where markers are searched, and OpenCV's usual recipe
///
/// On a synthetic video of its own, or on --input (a folder with video.mp4 and markers.toml) with --truth.
#[derive(Debug, Args)]
struct PostureArgs {
    /// The synthetic video's scene, as of `lunula phantom video`
    #[arg(long, value_enum, default_value = "clean", conflicts_with = "input")]
    scene: SceneArg,
    #[command(flatten)]
    measured: Measured,
}

/// The log's time over the video against the exact one: in how many frames the clock is read, and no clock at all
///
/// On a synthetic video and log of its own (random movement, irregular frames), or on --input (a folder with video.mp4,
/// markers.toml with a [clock], and log.csv) with --truth.
#[derive(Debug, Args)]
struct AlignArgs {
    /// Their length
    #[arg(long, default_value_t = 60.0, conflicts_with = "input")]
    seconds: f64,
    #[command(flatten)]
    measured: Measured,
}

/// Forces against measured ones for all models and sizes, with the time of a fit and of a prediction; and solvers on ill-conditioned sets
///
/// On synthetic recordings of its own (two spirals to train on, random movement to tell the error on), or on --input (a folder of
/// recordings to train on) with --truth (a folder of recordings to tell the error on).
#[derive(Debug, Args)]
struct PredictorArgs {
    #[command(flatten)]
    measured: Measured,
}

/// Step responses of the hemodynamic model for every tolerance, order and mode, with stability maps (stability.csv, .png, .svg)
///
/// The error is the largest of any displacement over its nominal diameter; the reference is the full model at its tightest tolerance.
#[derive(Debug, Args)]
struct HemodynamicsArgs {
    /// Folder for the results
    #[arg(long)]
    out: PathBuf,
    /// Other solvers on the same responses: a table solver,rtol,error,microseconds[,evaluations], drawn beside (times on this machine only)
    #[arg(long, value_name = "FILE.csv")]
    peers: Option<PathBuf>,
    /// Runs of each setting; the median time counts
    #[arg(long, default_value_t = 9, value_parser = clap::value_parser!(u16).range(1..=1000))]
    repeats: u16,
    #[command(flatten)]
    common: Common,
}

const POSES: [Pose; 4] = [Pose::Nominal, Pose::Normal, Pose::LateralPositive, Pose::Extension];

pub(super) fn run<const VIDEO: bool>(args: &TradeoffArgs) -> anyhow::Result<Outcome> {
    match &args.job {
        Job::Photos(args) => photos(args),
        Job::Predictor(args) => predictor(args),
        Job::Hemodynamics(args) => hemodynamics(args),
        Job::Posture(args) if VIDEO => posture(args),
        Job::Align(args) if VIDEO => align(args),
        Job::Posture(_) | Job::Align(_) => hand_over(),
    }
}

fn photos(args: &PhotosArgs) -> anyhow::Result<Outcome> {
    let measured = &args.measured;
    measured.common.start()?;
    let (set, truth, _kept) = measured.scenes(|folder| {
        let options = PhotoOptions {
            seed: measured.seed,
            subjects: args.subjects,
            poses: POSES.to_vec(),
            ..PhotoOptions::default()
        };
        write(&options, folder)?;
        Ok(folder.join("photos"))
    })?;
    let settings = photo_jobs::Settings { set, truth, repeats: usize::from(measured.repeats) };
    finish("photos", &photo_jobs::measure(&settings)?, &[], measured)
}

fn posture(args: &PostureArgs) -> anyhow::Result<Outcome> {
    let measured = &args.measured;
    measured.common.start()?;
    let (input, truth, _kept) = measured.scenes(|folder| {
        let options = VideoOptions { seed: measured.seed, ..VideoOptions::new(args.scene.preset()) };
        video::write(&Scene::new(options)?, folder)?;
        Ok(folder.to_owned())
    })?;
    let settings = posture_jobs::Settings {
        video: input.join("video.mp4"),
        markers: input.join("markers.toml"),
        truth,
        repeats: usize::from(measured.repeats),
        threads: measured.threads(),
    };
    finish("posture", &posture_jobs::measure(&settings)?, &[], measured)
}

fn align(args: &AlignArgs) -> anyhow::Result<Outcome> {
    let measured = &args.measured;
    measured.common.start()?;
    let (input, truth, _kept) = measured.scenes(|folder| {
        let trajectory = Trajectory::Random { hz: 0.1, seed: measured.seed };
        let clock = Clock::default();
        let log = LogOptions {
            seed: measured.seed,
            seconds: args.seconds,
            trajectory: trajectory.clone(),
            clock_offset_s: clock.offset_s,
            ..LogOptions::default()
        };
        let video = VideoOptions {
            seed: measured.seed,
            seconds: args.seconds,
            trajectory,
            jitter: 0.4,
            clock: Some(clock),
            ..VideoOptions::sized(640, 360)
        };
        video::write(&Scene::new(video)?, folder)?;
        log::write(&LogScene::new(log)?, folder)?;
        Ok(folder.to_owned())
    })?;
    let settings = align_jobs::Settings {
        video: input.join("video.mp4"),
        markers: input.join("markers.toml"),
        log: input.join("log.csv"),
        truth,
        repeats: usize::from(measured.repeats),
        threads: measured.threads(),
    };
    let (rows, refused) = align_jobs::measure(&settings)?;
    finish("align", &rows, &refused, measured)
}

fn predictor(args: &PredictorArgs) -> anyhow::Result<Outcome> {
    let measured = &args.measured;
    measured.common.start()?;
    let (train, test, _kept) = measured.scenes(|folder| {
        let seed = 3 * measured.seed;
        let scenes = [("train/1", Protocol::Touch, seed), ("train/2", Protocol::Touch, seed + 1)];
        for (name, protocol, seed) in scenes.into_iter().chain([("truth/1", Protocol::TouchRandom, seed + 2)]) {
            log::write(&LogScene::new(LogOptions::of(protocol, seed))?, &folder.join(name))?;
        }
        Ok(folder.join("train"))
    })?;
    let settings = predictor_jobs::Settings {
        train: recordings(&train)?,
        test: recordings(&test)?,
        repeats: usize::from(measured.repeats),
    };
    let (rows, refused) = predictor_jobs::measure(&settings)?;
    finish("predictor", &rows, &refused, measured)
}

fn hemodynamics(args: &HemodynamicsArgs) -> anyhow::Result<Outcome> {
    args.common.start()?;
    let peers = args.peers.as_deref().map(hemodynamics_jobs::read_peers).transpose()?.unwrap_or_default();
    let settings = hemodynamics_jobs::Settings { repeats: usize::from(args.repeats) };
    let (rows, refused) = hemodynamics_jobs::measure(&settings)?;
    let maps = hemodynamics_jobs::stability()?;
    hemodynamics_jobs::write(&rows, &peers, &maps, &args.out)?;
    let all: Vec<Row> = rows.into_iter().chain(peers).collect();
    tell("hemodynamics", &all, &refused, &args.out, &args.common)
}

/// The tables and logs of a folder, and the logs of its folders, by name.
fn recordings(folder: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).with_context(|| folder.display().to_string())? {
        let path = entry?.path();
        let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
        if path.join("log.csv").is_file() {
            found.push(path.join("log.csv"));
        } else if path.is_file() && ["csv", "parquet", "gz"].contains(&ending) {
            found.push(path);
        }
    }
    found.sort();
    anyhow::ensure!(!found.is_empty(), "{}: holds no recordings (.csv, .parquet)", folder.display());
    Ok(found)
}

fn finish(job: &str, rows: &[Row], warnings: &[String], measured: &Measured) -> anyhow::Result<Outcome> {
    let Measured { out, common, .. } = measured;
    lunula::tradeoff::write(rows, &format!("lunula {job}"), out)?;
    tell(job, rows, warnings, out, common)
}

fn tell(job: &str, rows: &[Row], warnings: &[String], out: &Path, common: &Common) -> anyhow::Result<Outcome> {
    common.warn(warnings);
    common.print_json(&serde_json::json!({
        "job": format!("tradeoff {job}"),
        "version": env!("CARGO_PKG_VERSION"),
        "rows": rows,
        "warnings": warnings,
    }))?;
    for row in rows {
        let Row { setting, error, error_unit, run_s, .. } = row;
        let error = if *error < 1e-3 { format!("{error:>8.1e}") } else { format!("{error:>8.4}") };
        let run_s = if *run_s < 1e-4 { format!("{run_s:>8.1e}") } else { format!("{run_s:>8.5}") };
        common.say(&format!("{setting:<34} {error}  {run_s} s an input  {error_unit}"));
    }
    common.say(&format!("look at {}", out.join("tradeoff.png").display()));
    Ok(Outcome::Done)
}
