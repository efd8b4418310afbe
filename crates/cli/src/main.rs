//! The command line of lunula: one file a command. Arguments in, one job called, tables and pictures out; no thinking
//! here.
//!
//! Exit status: 0 all done; 1 done, but some inputs failed, or what was to be said or written after the results could
//! not be (each is named on standard error); 2 nothing done, nothing changed; 130 interrupted.

mod absent;
mod doctor;
mod jobs;
mod misused;
mod out;
mod runs;
mod shell;
mod tradeoff;
mod ui;

use std::io::IsTerminal;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use clap::{Args, CommandFactory, FromArgMatches, Parser, Subcommand};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use lunula::files::results_stand;
use lunula::input;
use lunula::job::Interrupted;
use lunula::stages::Stage;
use lunula::words::shown_lines;
use out::print_line;

/// Photographs come and go by the megabyte: this allocator keeps their pages, the system's returns them each time.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// Ground truth for fingernail sensing: nail photographs to coloration maps, videos to joint angles,
/// angles and photodiode logs to labelled training sets, those to models of force and posture.
#[derive(Debug, Parser)]
#[command(
    name = "lunula",
    version,
    after_help = AFTER_HELP,
    max_term_width = 110
)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

const AFTER_HELP: &str = "lunula COMMAND --help explains each command.

Exit status: 0 all done; 1 done, but some inputs failed (each is named on standard error, the others are done), \
or results exist and what \
comes after them, as a report or words on standard output, could not be written; 2 nothing done, nothing changed; 130 \
interrupted. Results \
appear whole or not at all; what existed before a failed run is as it was.";

#[derive(Debug, Subcommand)]
enum Command {
    Photos(jobs::photos::PhotosArgs),
    Edit(Box<jobs::photos::edit::EditArgs>),
    Posture(jobs::posture::PostureArgs),
    Nailvideo(Box<jobs::nailvideo::NailVideoArgs>),
    Camera(jobs::camera::CameraArgs),
    Align(Box<jobs::align::AlignArgs>),
    Train(Box<jobs::predictor::train::TrainArgs>),
    Evaluate(jobs::predictor::evaluate::EvaluateArgs),
    Predict(jobs::predictor::predict::PredictArgs),
    Analyse(jobs::predictor::analyse::AnalyseArgs),
    Prune(jobs::predictor::prune::PruneArgs),
    Layout(Box<jobs::layout::LayoutArgs>),
    Live(Box<jobs::live::session::LiveArgs>),
    Record(Box<jobs::live::session::RecordArgs>),
    Prompt(Box<jobs::live::prompt::PromptArgs>),
    Switch(jobs::live::switch::SwitchArgs),
    Mouse(Box<jobs::live::session::MouseArgs>),
    Simulate(Box<jobs::hemodynamics::simulate::SimulateArgs>),
    Fit(Box<jobs::hemodynamics::fit::FitArgs>),
    Skill(Box<jobs::live::skill::SkillArgs>),
    Performance(jobs::live::performance::PerformanceArgs),
    Merge(runs::merge::MergeArgs),
    Phantom(jobs::phantom::PhantomArgs),
    Tradeoff(tradeoff::TradeoffArgs),
    Trajectory(Box<jobs::trajectory::TrajectoryArgs>),
    Run(runs::run::RunArgs),
    Init(runs::init::InitArgs),
    Ui(ui::UiArgs),
    Doctor(doctor::DoctorArgs),
    Completions(shell::completions::CompletionsArgs),
    Man(shell::man::ManArgs),
}

/// What every job takes.
#[derive(Debug, Clone, Args)]
struct Common {
    /// Print one JSON object on standard output: options, figures, warnings, notes, times
    #[arg(long, global = true)]
    json: bool,
    /// Threads to use [default: all cores]; results are the same bytes whatever their number
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Print errors only
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    quiet: bool,
    /// Print every stage's time and what was left out
    #[arg(short, long, global = true)]
    verbose: bool,
}

/// How a job ended well.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Outcome {
    Done,
    SomeFailed,
}

/// A run of many tasks was stopped from outside.
#[derive(Debug, thiserror::Error)]
#[error("interrupted; what was done is kept, and the same command goes on from there")]
struct Stopped;

/// Parses and runs the command.
fn main() -> ExitCode {
    let said = Cli::command().try_get_matches();
    let parsed = said.and_then(|said| {
        let cli = Cli::from_arg_matches(&said).map_err(|wrong| wrong.format(&mut Cli::command()))?;
        Ok((cli, absent::inputs(&said)))
    });
    let cli = match parsed {
        Ok((cli, absent)) if absent.is_empty() => cli,
        Ok((_, absent)) => {
            let all: Vec<String> =
                absent.iter().map(|path| format!("{}: {}", path.display(), input::missing(path))).collect();
            return ended_with(Err(anyhow::anyhow!(all.join("\n"))));
        }
        // Help and version.
        Err(shown) if !shown.use_stderr() => {
            out::note(shown.print());
            return ended_with(Ok(Outcome::Done));
        }
        Err(wrong) => misused::with_tip(wrong, std::env::args_os()).exit(),
    };
    ended_with(match cli.command {
        Command::Photos(args) => jobs::photos::run(&args),
        Command::Edit(args) => jobs::photos::edit::run(&args),
        Command::Align(args) => jobs::align::run(&args),
        Command::Camera(args) => jobs::camera::run(&args),
        Command::Nailvideo(args) => jobs::nailvideo::run(&args),
        Command::Train(args) => jobs::predictor::train::run(&args),
        Command::Evaluate(args) => jobs::predictor::evaluate::run(&args),
        Command::Predict(args) => jobs::predictor::predict::run(&args),
        Command::Analyse(args) => jobs::predictor::analyse::run(&args),
        Command::Prune(args) => jobs::predictor::prune::run(&args),
        Command::Layout(args) => jobs::layout::run(&args),
        Command::Live(args) => jobs::live::session::run_live(&args),
        Command::Record(args) => jobs::live::session::run_record(&args),
        Command::Prompt(args) => jobs::live::prompt::run(&args),
        Command::Mouse(args) => jobs::live::session::run_mouse(&args),
        Command::Switch(args) => jobs::live::switch::run(&args),
        Command::Simulate(args) => jobs::hemodynamics::simulate::run(&args),
        Command::Fit(args) => jobs::hemodynamics::fit::run(&args),
        Command::Skill(args) => jobs::live::skill::run(&args),
        Command::Performance(args) => jobs::live::performance::run(&args),
        Command::Posture(args) => jobs::posture::run(&args),
        Command::Merge(args) => runs::merge::run(&args),
        Command::Phantom(args) => jobs::phantom::run(&args),
        Command::Tradeoff(args) => tradeoff::run(&args),
        Command::Trajectory(args) => jobs::trajectory::run(&args),
        Command::Run(args) => runs::run::run(&args),
        Command::Init(args) => runs::init::run(&args),
        Command::Ui(args) => ui::run(&args),
        Command::Doctor(args) => doctor::run(&args),
        Command::Completions(args) => shell::completions::run(&args),
        Command::Man(args) => shell::man::run(&args),
    })
}

/// Says what is to be said at the end; the exit status.
fn ended_with(outcome: anyhow::Result<Outcome>) -> ExitCode {
    let failed = || if results_stand() { 1 } else { 2 };
    let status = match outcome {
        Ok(Outcome::Done) => 0,
        Ok(Outcome::SomeFailed) => 1,
        Err(_) if input::was_cut() => {
            eprintln!("error: {Interrupted}");
            130
        }
        Err(error) => {
            let stopped = error.chain().find(|one| one.is::<Interrupted>() || one.is::<Stopped>());
            match stopped {
                Some(stopped) => eprintln!("error: {stopped}"),
                None => eprintln!("error: {}", shown_lines(&format!("{error:#}"))),
            }
            if stopped.is_some() { 130 } else { failed() }
        }
    };
    match out::finish() {
        Err(why) => {
            eprintln!("error: standard output: cannot be written ({why}); make room, or send it elsewhere");
            ExitCode::from(if status == 130 { 130 } else { failed() })
        }
        Ok(()) => ExitCode::from(status),
    }
}

impl Common {
    /// Threads to work with; 0: all cores.
    fn threads(&self) -> usize {
        self.threads.map_or(0, usize::from)
    }

    /// Sets the threads up; a job's first step.
    fn start(&self) -> anyhow::Result<Arc<AtomicBool>> {
        rayon::ThreadPoolBuilder::new().num_threads(self.threads()).build_global()?;
        let stop = Arc::new(AtomicBool::new(false));
        let flag = Arc::clone(&stop);
        ctrlc::set_handler(move || {
            input::interrupt();
            if flag.swap(true, Ordering::Relaxed) {
                // Asked twice: what was held back is a hidden folder, nothing of the results is touched.
                std::process::exit(130);
            }
        })?;
        Ok(stop)
    }

    /// A bar on standard error, where that is a terminal and somebody looks.
    fn progress(&self, steps: usize, unit: &str) -> ProgressBar {
        let seen = std::io::stderr().is_terminal() && !self.quiet;
        let target = if seen { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let bar = ProgressBar::with_draw_target(Some(steps as u64), target);
        let style = ProgressStyle::with_template(&format!("{{wide_bar}} {{pos}}/{{len}} {unit}, {{eta}} left"));
        style.map_or(bar.clone(), |style| bar.with_style(style))
    }

    /// Plain words on standard output, unless quiet or JSON is wanted.
    fn say(&self, text: &str) {
        if !self.json && !self.quiet {
            print_line(&shown_lines(text));
        }
    }

    /// Each stage's time, a line each.
    fn say_stages(&self, stages: &[Stage]) {
        stages.iter().for_each(|stage| self.say(&format!("{:<28} {:>9.3} s", stage.stage, stage.thread_s)));
    }

    fn warn(&self, warnings: &[String]) {
        if !self.quiet {
            for warning in warnings {
                eprintln!("warning: {}", shown_lines(warning));
            }
        }
    }

    /// What was chosen, guessed or counted on the way.
    fn note(&self, notes: &[String]) {
        if !self.quiet {
            notes.iter().for_each(|note| eprintln!("note: {}", shown_lines(note)));
        }
    }

    fn print_json(&self, report: &impl serde::Serialize) -> anyhow::Result<()> {
        if self.json {
            print_line(&serde_json::to_string(report)?);
        }
        Ok(())
    }
}
