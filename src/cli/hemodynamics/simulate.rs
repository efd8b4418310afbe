//! `lunula simulate`: the hemodynamic model under loads, over time or at rest.

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

use anyhow::Context;
use clap::Args;
use lunula::hemodynamics::model::{Collapse, Load};
use lunula::hemodynamics::{
    CurveOptions, CurveOutputs, CurveReport, GivenLoads, LoadRange, OpticsChoice, Pressed, SimulateOptions,
    SimulateOutputs, SimulateReport, Start, curve, curve_plan, simulate, simulate_plan,
};

use super::{Common, NailArgs, Outcome, ended, one_of, print_line};

const EXAMPLES: &str = "Examples:
5000 Pa on the proximal pulp for two seconds (Fig. 76), and on both places (Fig. 77):
  lunula simulate --pf1 step:5000@0..2 --out trajectory.csv
  lunula simulate --pf1 step:5000@0..2 --pf2 step:5000@0..2 --out both.csv
A recorded load, straight between its rows:
  lunula simulate --loads loads.csv --until 30 --out trajectory.csv
On from the last row, with walls that touch:
  lunula simulate --pf1 2e4 --from trajectory.csv --collapse contact --out on.csv
Equilibria for every load (Fig. 78):
  lunula simulate --static 0..12000/100 --load distal --out static.csv
All parameters, to be edited and given with --params:
  lunula simulate --print-params > params.toml

Loads, in pascals, seconds and hertz (1 N/cm2 is 1e4 Pa):
  5000                 at all times
  step:5000@0..2       from 0 s until just before 2 s, 0 before and after
  ramp:0..10000@0..5   straight from 0 Pa at 0 s to 10000 Pa at 5 s, held after
  sine:5000+1000@0.05  5000 + 1000 sin(2 pi 0.05 t)

Exit status: 0 all done; 1 a vessel closed and --keep-partial wrote what is before it; 2 nothing done; 130 interrupted.";

/// The hemodynamic model of a pressed fingertip (4.3): vessels and photodiodes over time, or in equilibrium with
/// --static
///
/// The table has time_s, displacements of the walls (xC1_m, xC2_m, xV_m), their velocities (vC1_mps, ..) and
/// photodiodes (VP1, VP2); a run begins in the equilibrium of the loads just before t = 0. Beside it stand
/// <table>.run.json (how sure it is, what the solver did, all parameters) and a picture. A vessel that closes ends the
/// model: the error names it and when.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct SimulateArgs {
    /// P_F1, on the proximal palmar surface: it presses on the vein [default: nothing]
    #[arg(long, value_name = "LOAD", allow_hyphen_values = true)]
    pf1: Option<Load>,
    /// P_F2, on the distal palmar surface: it presses on the distal capillaries [default: nothing]
    #[arg(long, value_name = "LOAD", allow_hyphen_values = true)]
    pf2: Option<Load>,
    /// A table time_s,pf1_Pa,pf2_Pa instead (and ph_Pa, pl_Pa where they change), straight between rows, held before
    /// and after
    #[arg(long, value_name = "FILE.csv", conflicts_with_all = ["pf1", "pf2"])]
    loads: Option<PathBuf>,
    /// P_H, upstream blood pressure, as sine:10000+2000@1.2 for a pulse [default: the parameters' constant]
    #[arg(long, value_name = "LOAD", allow_hyphen_values = true)]
    ph: Option<Load>,
    /// P_L, downstream blood pressure [default: the parameters' constant]
    #[arg(long, value_name = "LOAD", allow_hyphen_values = true)]
    pl: Option<Load>,
    /// Another state to start from: zero (no displacement, no velocity), or the last row of a trajectory's table; time
    /// begins at 0 again
    #[arg(long, value_name = "zero|FILE")]
    from: Option<PathBuf>,
    /// Where a vessel closes: error, or contact (opposite walls push each other apart below a twentieth of the nominal
    /// diameter)
    #[arg(long, value_parser = one_of::<Collapse>(), default_value = "error")]
    collapse: Collapse,
    /// The last row's time; the first is 0
    #[arg(long, value_name = "SECONDS", default_value_t = 4.0, allow_negative_numbers = true)]
    until: f64,
    /// Between two rows
    #[arg(long, value_name = "SECONDS", default_value_t = 0.01, allow_negative_numbers = true)]
    every: f64,
    /// Every lumen's error over its nominal diameter is at most this
    #[arg(long, value_name = "ERROR", default_value = "1e-8", allow_negative_numbers = true)]
    rtol: f64,
    /// How light depends on the capillaries
    #[arg(long, value_parser = one_of::<OpticsChoice>(), default_value = "beer-lambert")]
    optics: OpticsChoice,
    /// The loads' columns stand in the table as well, as `lunula fit` reads them
    #[arg(long, conflicts_with = "static_")]
    with_loads: bool,
    /// Where a vessel closes, write what is before it (exit status 1) [default: nothing is written]
    #[arg(long, conflicts_with = "static_")]
    keep_partial: bool,
    /// Equilibria instead of a run: for these loads, in pascals
    #[arg(
        long = "static",
        id = "static_",
        value_name = "FROM..TO/STEP",
        allow_hyphen_values = true,
        conflicts_with_all = ["pf1", "pf2", "loads", "from", "until", "every", "rtol"]
    )]
    static_: Option<LoadRange>,
    /// What the loads of --static press on [default: both]
    #[arg(long, value_parser = one_of::<Pressed>())]
    load: Option<Pressed>,
    #[command(flatten)]
    nail: NailArgs,
    /// Print all parameters as a file for --params, and do nothing else
    #[arg(long)]
    print_params: bool,
    /// The table (.csv or .parquet)
    #[arg(long, value_name = "TABLE.csv", required_unless_present_any = ["plan", "print_params"])]
    out: Option<PathBuf>,
    /// Draw no picture
    #[arg(long)]
    no_figures: bool,
    /// Say what would be done and left out, and do nothing
    #[arg(long)]
    plan: bool,
    #[command(flatten)]
    common: Common,
}

impl SimulateArgs {
    fn options(&self) -> SimulateOptions {
        SimulateOptions {
            parameters: self.nail.given(),
            loads: GivenLoads {
                proximal: self.pf1.clone(),
                distal: self.pf2.clone(),
                upstream: self.ph.clone(),
                downstream: self.pl.clone(),
                file: self.loads.clone(),
            },
            start: match &self.from {
                None => Start::Equilibrium,
                Some(path) if path.as_os_str() == "zero" => Start::Zero,
                Some(path) => Start::File(path.clone()),
            },
            collapse: self.collapse,
            optics: self.optics,
            until_s: self.until,
            every_s: self.every,
            rtol: self.rtol,
            keep_partial: self.keep_partial,
            with_loads: self.with_loads,
        }
    }

    fn curve_options(&self, range: LoadRange) -> CurveOptions {
        CurveOptions {
            parameters: self.nail.given(),
            upstream: self.ph.clone(),
            downstream: self.pl.clone(),
            pressed: self.load.unwrap_or_default(),
            range,
            collapse: self.collapse,
            optics: self.optics,
        }
    }
}

pub(crate) fn run(args: &SimulateArgs) -> anyhow::Result<Outcome> {
    if args.print_params {
        let parameters = args.nail.given().read()?;
        print_line(parameters.to_toml().trim_end());
        return Ok(Outcome::Done);
    }
    let common = &args.common;
    let stop = common.start()?;
    anyhow::ensure!(
        args.load.is_none() || args.static_.is_some(),
        "--load says what the loads of --static press on; over time, --pf1 presses proximally and --pf2 distally"
    );
    match args.static_ {
        Some(range) => equilibria(args, &args.curve_options(range), &stop),
        None => over_time(args, &args.options(), &stop),
    }
}

fn over_time(args: &SimulateArgs, options: &SimulateOptions, stop: &AtomicBool) -> anyhow::Result<Outcome> {
    let outputs = args.out.as_ref().map(|table| SimulateOutputs { table: table.clone(), figures: !args.no_figures });
    if args.plan {
        return args.common.show_plan("simulate", &simulate_plan(options, outputs.as_ref()).map_err(ended)?);
    }
    let report = simulate(options, &outputs.context("--out is needed")?, stop).map_err(ended)?;
    finish(&args.common, &report)
}

fn finish(common: &Common, report: &SimulateReport) -> anyhow::Result<Outcome> {
    common.warn(&report.warnings);
    report.failed.iter().for_each(|what| eprintln!("error: {what}"));
    common.print_json(report)?;
    let last_s =
        report.last_s.map_or("no rows".to_owned(), |last_s| format!("{} rows from 0 to {last_s} s", report.rows));
    common.say(&format!("{last_s}; the error of every lumen is at most {:e} of its nominal diameter", report.rtol));
    let work = &report.work;
    common.say(&format!(
        "{} steps ({} more rejected), {} evaluations, {} factorizations; {}",
        work.steps, work.rejected, work.evaluations, work.factorizations, report.stopped
    ));
    common.say_done(&report.stages, &report.left_out, report.wall_s, report.pictures.first().unwrap_or(&report.table));
    Ok(if report.failed.is_empty() { Outcome::Done } else { Outcome::SomeFailed })
}

fn equilibria(args: &SimulateArgs, options: &CurveOptions, stop: &AtomicBool) -> anyhow::Result<Outcome> {
    let common = &args.common;
    let outputs = args.out.as_ref().map(|table| CurveOutputs { table: table.clone(), figures: !args.no_figures });
    if args.plan {
        return common.show_plan("simulate --static", &curve_plan(options, outputs.as_ref()).map_err(ended)?);
    }
    let report = curve(options, &outputs.context("--out is needed")?, stop).map_err(ended)?;
    say_curve(common, &report)
}

fn say_curve(common: &Common, report: &CurveReport) -> anyhow::Result<Outcome> {
    common.warn(&report.warnings);
    common.print_json(report)?;
    common.say(&format!(
        "{} loads: {} with one equilibrium, {} with several, {} with none that is open",
        report.loads, report.with_one, report.with_several, report.with_none
    ));
    for fold in &report.folds {
        common.say(&format!("{} at {:.6} Pa", fold.what, fold.load_pa));
    }
    for [from, to] in &report.bistable_pa {
        common.say(&format!(
            "several stable states from {from:.6} to {to:.6} Pa: which one is reached depends on the path"
        ));
    }
    for [from, to] in &report.closed_pa {
        common.say(&format!("no equilibrium with open vessels from {from:.6} to {to:.6} Pa"));
    }
    common.say_done(&report.stages, &report.left_out, report.wall_s, report.pictures.first().unwrap_or(&report.table));
    Ok(Outcome::Done)
}
