//! `lunula tradeoff`: error against run time.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use clap::{Args, Subcommand};
use lunula::phantom::video::Preset;
use lunula::tradeoff::{self as curves, Effort, Plan, Row, Setting, Tradeoff, Verdict};

use super::{Common, Outcome};

/// Measure error against run time over the settings of a job, or of all: the knee of each curve, where the default
/// lies, other programs
///
/// Writes a table (tradeoff.csv) and a picture (tradeoff.png, .svg); `all` one page (index.html).
#[derive(Debug, Args)]
pub(super) struct TradeoffArgs {
    #[command(subcommand)]
    job: Job,
}

#[derive(Debug, Subcommand)]
enum Job {
    /// Every job's settings on synthetic scenes, on one page: DIR/index.html, DIR/tradeoff.csv, one picture per job
    All {
        /// Seed of the synthetic inputs
        #[arg(long, default_value_t = 1)]
        seed: u64,
        #[command(flatten)]
        measuring: Measuring,
    },
    /// Resampling against the exact normalized pictures, and detection against the exact outlines
    ///
    /// On synthetic photographs of its own, or on --input (a set of photographs) with --truth.
    Photos {
        /// Subjects of the synthetic photographs, in four poses [default: 16; --quick: 4]
        #[arg(long, value_name = "N", conflicts_with = "input")]
        subjects: Option<u32>,
        #[command(flatten)]
        measured: Measured,
    },
    /// Joint angles against the exact ones: planes used, rounds of refinement, where markers are searched
    ///
    /// On a synthetic video of its own, or on --input (a folder with video.mp4 and markers.toml) with --truth.
    Posture {
        /// The synthetic video's scene, as of `lunula phantom video`
        #[arg(long, value_enum, default_value = "clean", conflicts_with = "input")]
        scene: Preset,
        #[command(flatten)]
        measured: Measured,
    },
    /// The log's time over the video against the exact one: in how many frames the clock is read, and no clock at all;
    /// labels over gaps
    ///
    /// On a synthetic video and log of its own (random movement, irregular frames), or on --input (a folder with
    /// video.mp4, markers.toml with a [clock], and log.csv) with --truth.
    Align {
        /// Their length [default: 60; --quick: 20]
        #[arg(long, conflicts_with = "input")]
        seconds: Option<f64>,
        #[command(flatten)]
        measured: Measured,
    },
    /// Forces against measured ones for all models and sizes, with the time of a fit and of a prediction; and solvers
    /// on ill-conditioned sets
    ///
    /// On synthetic recordings of its own (two spirals to train on, random movement to tell the error on), or on
    /// --input (a folder of recordings to train on) with --truth (a folder of recordings to tell the error on).
    Predictor(Measured),
    /// Step responses of the hemodynamic model for every tolerance, order and mode
    ///
    /// The error is the largest of any displacement over its nominal diameter; the reference is the full model at its
    /// tightest tolerance.
    Hemodynamics(Measuring),
    /// What a press of the virtual switch loses by delay and misses for several models, and its delay against the rate
    /// of false switches
    ///
    /// On synthetic recordings of its own (presses and hours of rest), or on --input (a folder of recordings to train
    /// on, with forces and a column `contact` of 0 and 1) with --truth (a folder of others: the first half by name
    /// chooses thresholds, the second is judged).
    Switch(Measured),
}

/// What every trade-off takes.
#[derive(Debug, Args)]
struct Measuring {
    /// Folder for the results
    #[arg(long)]
    out: PathBuf,
    /// Runs of each setting; the median time counts [default: 3; hemodynamics: 9]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1000))]
    repeats: Option<u16>,
    /// Fewer settings on smaller scenes
    #[arg(long)]
    quick: bool,
    /// Figures of other programs on the same scenes, as `make peers` of the repository measures them: a table
    /// stage,choice,scene,setting,error,error_unit,run_s,run_low_s,run_high_s,repeats,work,machine,version,date; may be
    /// given again
    #[arg(long, value_name = "FILE")]
    peers: Vec<PathBuf>,
    #[command(flatten)]
    common: Common,
}

impl Measuring {
    fn plan(&self, repeats: usize, seed: u64, stop: Arc<AtomicBool>) -> Plan {
        let effort = Effort {
            repeats: self.repeats.map_or(repeats, usize::from),
            quick: self.quick,
            threads: self.common.threads(),
            stop,
        };
        Plan::new(seed, effort, self.peers.clone())
    }
}

/// What trade-offs on scenes take.
#[derive(Debug, Args)]
struct Measured {
    /// A folder to measure on, as `lunula phantom` writes it
    #[arg(long, requires = "truth")]
    input: Option<PathBuf>,
    /// Its truth/
    #[arg(long, requires = "input")]
    truth: Option<PathBuf>,
    /// Seed of the synthetic inputs
    #[arg(long, default_value_t = 1, conflicts_with = "input")]
    seed: u64,
    #[command(flatten)]
    measuring: Measuring,
}

impl Measured {
    fn run(&self, job: curves::Job, change: impl FnOnce(&mut Plan)) -> anyhow::Result<Outcome> {
        let stop = self.measuring.common.start()?;
        let mut plan = self.measuring.plan(REPEATS, self.seed, stop);
        plan.input = self.input.clone().zip(self.truth.clone());
        change(&mut plan);
        one(job, &plan, &self.measuring)
    }
}

/// Runs of each setting.
const REPEATS: usize = 3;
/// Of those that take a tenth of a millisecond.
const SHORT_REPEATS: usize = 9;

pub(super) fn run(args: &TradeoffArgs) -> anyhow::Result<Outcome> {
    match &args.job {
        Job::Photos { subjects, measured } => measured.run(curves::Job::Photos, |plan| {
            plan.subjects = subjects.unwrap_or(plan.subjects);
        }),
        Job::Predictor(measured) => measured.run(curves::Job::Predictor, |_| {}),
        Job::Switch(measured) => measured.run(curves::Job::Switch, |_| {}),
        Job::Hemodynamics(measuring) => {
            let stop = measuring.common.start()?;
            one(curves::Job::Hemodynamics, &measuring.plan(SHORT_REPEATS, 1, stop), measuring)
        }
        Job::Posture { scene, measured } => measured.run(curves::Job::Posture, |plan| plan.preset = *scene),
        Job::Align { seconds, measured } => measured.run(curves::Job::Align, |plan| {
            plan.seconds = seconds.unwrap_or(plan.seconds);
        }),
        Job::All { seed, measuring } => all(*seed, measuring),
    }
}

fn one(job: curves::Job, plan: &Plan, measuring: &Measuring) -> anyhow::Result<Outcome> {
    let Measuring { out, common, .. } = measuring;
    let found = plan.run(job, &plan.others()?)?;
    found.write(out)?;
    common.warn(&found.refused);
    common.print_json(&serde_json::json!({
        "job": format!("tradeoff {}", job.name()),
        "version": env!("CARGO_PKG_VERSION"),
        "rows": found.rows,
        "curves": found.curves,
        "peers": found.peers,
        "warnings": found.refused,
        "wall_s": found.wall_s,
    }))?;
    found.rows.iter().for_each(|row| common.say(&line(row)));
    say_curves(&found, common);
    common.say(&format!("look at {}", out.join("tradeoff.png").display()));
    Ok(Outcome::Done)
}

fn all(seed: u64, measuring: &Measuring) -> anyhow::Result<Outcome> {
    let Measuring { out, common, .. } = measuring;
    let plan = measuring.plan(REPEATS, seed, common.start()?);
    let progress = common.progress(curves::Job::ALL.len(), "jobs");
    let outcomes = curves::all(&plan, |job| {
        progress.set_message(job.name());
        progress.inc(1);
    })?;
    progress.finish_and_clear();
    let (mut done, mut failed): (Vec<Tradeoff>, Vec<(&str, String)>) = (Vec::new(), Vec::new());
    for (job, outcome) in outcomes {
        match outcome {
            Ok(found) => done.push(found),
            Err(why) => failed.push((job.name(), format!("{why:#}"))),
        }
    }
    anyhow::ensure!(
        !done.is_empty(),
        "no job could be measured: {}",
        failed.iter().map(|(_, why)| why.as_str()).collect::<Vec<_>>().join("; ")
    );
    let tables = plan.peers.iter().map(|path| path.display().to_string()).collect();
    curves::index(&done, &failed, &Setting { seed: plan.seed, effort: plan.effort.clone(), tables }, out)?;
    let warnings: Vec<String> = done.iter().flat_map(|job| &job.refused).cloned().collect();
    common.warn(&warnings);
    common.print_json(&serde_json::json!({
        "job": "tradeoff all",
        "version": env!("CARGO_PKG_VERSION"),
        "jobs": done,
        "failed": failed,
        "warnings": warnings,
    }))?;
    done.iter().for_each(|job| say_curves(job, common));
    failed.iter().for_each(|(job, why)| eprintln!("error: {job}: {why}"));
    common.say(&format!("look at {}", out.join("index.html").display()));
    Ok(if failed.is_empty() { Outcome::Done } else { Outcome::SomeFailed })
}

fn line(row: &Row) -> String {
    let Row { setting, error, error_unit, run_s, .. } = row;
    let error = if *error < 1e-3 { format!("{error:>8.1e}") } else { format!("{error:>8.4}") };
    let run_s = if *run_s < 1e-4 { format!("{run_s:>8.1e}") } else { format!("{run_s:>8.5}") };
    let marks = [(row.knee, " [knee]"), (row.default, " [default]")];
    let marks: String = marks.into_iter().filter_map(|(is, mark)| is.then_some(mark)).collect();
    format!("{setting:<34} {error}  {run_s} s an input  {error_unit}{marks}")
}

fn say_curves(found: &Tradeoff, common: &Common) {
    for Verdict { job, choice, error_unit, knee, default, default_is, default_why, decides, .. } in &found.curves {
        let setting =
            |what: &Option<curves::Figures>| what.as_ref().map_or("none".to_owned(), |row| row.setting.clone());
        common.say(&format!(
            "{job}, {choice} ({error_unit}): knee {}; default {}, {default_is}",
            setting(knee),
            setting(default)
        ));
        if *decides && default_is != "the knee" {
            common.say(&format!("  {default_why}"));
        }
    }
    for peer in found.peers.iter().filter(|peer| !peer.measured) {
        common.say(&format!("not on it: {}: {}", peer.peer, peer.what));
    }
}
