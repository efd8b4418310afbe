//! `lunula simulate`: the hemodynamic model under loads, over time or at rest.

use clap::error::ErrorKind;
use clap::parser::ValueSource;
use clap::{ArgMatches, Args, FromArgMatches};
use lunula::hemodynamics::{
    CurveOptions, CurveRange, CurveReport, SimulateInputs, SimulateOptions, SimulateReport, curve, curve_plan,
    simulate, simulate_plan,
};
use lunula::job::Given;

use crate::jobs::{self, ResultArgs};
use crate::{Common, Outcome, print_line};

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
All parameters, to edit and use with --params:
  lunula simulate --print-params > params.toml

Loads, in pascals, seconds and hertz (1 N/cm2 is 1e4 Pa):
  5000                 at all times
  step:5000@0..2       from 0 s until just before 2 s, 0 before and after
  ramp:0..10000@0..5   straight from 0 Pa at 0 s to 10000 Pa at 5 s, held after
  sine:5000+1000@0.05  5000 + 1000 sin(2 pi 0.05 t)

Exit status: 0 all done; 1 a vessel closed and --keep-partial wrote the rows before it; 2 nothing done; \
130 interrupted.";

/// Simulate blood flow in a pressed fingertip (4.3): vessels and photodiodes over time, or in equilibrium with
/// --static
///
/// The table has time_s, displacements of the walls (xC1_m, xC2_m, xV_m), their velocities (vC1_mps, ..) and
/// photodiodes (VP1, VP2); a run begins in the equilibrium of the loads just before t = 0. Beside it are
/// <table>.run.json (how sure it is, what the solver did, all parameters) and a picture. A vessel that closes ends the
/// model: the error names it and when.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
#[command(mut_arg("out", |out| out
    .value_name("TABLE.csv")
    .help("The table (.csv or .parquet)")
    .required_unless_present("print_params")
))]
pub(crate) struct SimulateArgs {
    #[command(flatten)]
    way: Way,
    #[command(flatten)]
    inputs: SimulateInputs,
    /// Print all parameters as a file for --params, and do nothing else
    #[arg(long)]
    print_params: bool,
    #[command(flatten)]
    results: ResultArgs,
}

/// The two jobs of the command, and the options of the one that --static chooses.
#[derive(Debug)]
enum Way {
    OverTime(Box<Given<SimulateOptions>>),
    Static(Box<Given<CurveOptions>>),
}

/// What only runs over time have.
const OVER_TIME: [&str; 9] =
    ["pf1", "pf2", "loads", "start", "until_s", "every_s", "rtol", "with_loads", "keep_partial"];

impl FromArgMatches for Way {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        if matches.contains_id("static") {
            return Ok(Self::Static(Box::new(Given::from_arg_matches(matches)?)));
        }
        // `requires` is not enough: clap does not ask for what another argument excludes, as --pf1 does --static.
        if matches.value_source("pressed") == Some(ValueSource::CommandLine) {
            let what = "--load says what the loads of --static press on; over time, --pf1 presses proximally and --pf2 \
                        distally\n";
            return Err(clap::Error::raw(ErrorKind::ArgumentConflict, what));
        }
        Ok(Self::OverTime(Box::new(Given::from_arg_matches(matches)?)))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

impl Args for Way {
    fn augment_args(command: clap::Command) -> clap::Command {
        let both = CurveRange::augment_args(SimulateOptions::augment_args(command));
        both.mut_arg("static", |arg| arg.required(false).conflicts_with_all(OVER_TIME))
    }

    fn augment_args_for_update(command: clap::Command) -> clap::Command {
        Self::augment_args(command)
    }
}

/// Prints the parameters, or runs one of the jobs.
pub(crate) fn run(args: &SimulateArgs) -> anyhow::Result<Outcome> {
    if args.print_params {
        let model = match &args.way {
            Way::OverTime(given) => &given.options.model,
            Way::Static(given) => &given.options.model,
        };
        print_line(model.parameters(args.inputs.params.as_deref())?.to_toml().trim_end());
        return Ok(Outcome::Done);
    }
    let SimulateArgs { inputs, results, .. } = args;
    match &args.way {
        Way::OverTime(given) => jobs::run(
            &results.request("simulate", "steps", &given.said),
            || Ok(simulate_plan(inputs, &given.options, &results.outputs())?),
            |watch| Ok(simulate(inputs, &given.options, &results.outputs(), watch)?),
            say_over_time,
        ),
        Way::Static(given) => jobs::run(
            &results.request("simulate --static", "steps", &given.said),
            || Ok(curve_plan(inputs.params.as_deref(), &given.options, &results.outputs())?),
            |watch| Ok(curve(inputs.params.as_deref(), &given.options, &results.outputs(), watch)?),
            say_static,
        ),
    }
}

fn say_over_time(common: &Common, report: &SimulateReport) {
    let last_s =
        report.last_s.map_or("no rows".to_owned(), |last_s| format!("{} rows from 0 to {last_s} s", report.rows));
    common.say(&format!("{last_s}; the error of every lumen is at most {:e} of its nominal diameter", report.rtol));
    let work = &report.work;
    common.say(&format!(
        "{} steps ({} more rejected), {} evaluations, {} factorizations; {}",
        work.steps, work.rejected, work.evaluations, work.factorizations, report.stopped
    ));
}

fn say_static(common: &Common, report: &CurveReport) {
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
}
