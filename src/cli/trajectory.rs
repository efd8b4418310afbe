//! `lunula trajectory`: tables of forces or angles for a prompter to play.

use std::path::PathBuf;

use anyhow::Context;
use clap::{Args, Subcommand};
use lunula::predictor::trajectory::{
    ForceFigures, Kind, PostureFigures, TrajectoryError, TrajectoryOptions, TrajectoryOutputs, TrajectoryReport, plan,
    run as run_trajectory,
};

use super::{Common, Interrupted, Outcome};

/// Calibration trajectories (5.2.3) as tables that a prompter can play, with how fast they are and how evenly they
/// cover
///
/// Beside the table stand <table>.run.json and pictures (Fig. 90-93).
#[derive(Debug, Args)]
pub(super) struct TrajectoryArgs {
    #[command(subcommand)]
    kind: KindArg,
}

#[derive(Debug, Subcommand)]
enum KindArg {
    Force(ForceArgs),
    Posture(PostureArgs),
    Random(RandomArgs),
}

/// What every trajectory takes.
#[derive(Debug, Args)]
struct Planned {
    /// The table: time_s and Fx_N, Fy_N, Fz_N (of the finger on the surface: pressing is negative Fz_N) or J2_deg (.csv
    /// or .parquet)
    #[arg(long, value_name = "TABLE.csv", required_unless_present = "plan")]
    out: Option<PathBuf>,
    /// Between two rows
    #[arg(long, value_name = "SECONDS", default_value_t = 0.04, allow_negative_numbers = true)]
    every: f64,
    /// At rest before it begins
    #[arg(long, value_name = "SECONDS", default_value_t = 0.0, allow_negative_numbers = true)]
    lead: f64,
    /// It goes on so long after its end: the finger lets go within 2 s, or stays where it bent to
    #[arg(long, value_name = "SECONDS", default_value_t = 0.0, allow_negative_numbers = true)]
    trail: f64,
    /// The sensor's slowest time constant, for equation 19
    #[arg(long, value_name = "SECONDS", default_value_t = 0.1, allow_negative_numbers = true)]
    tau: f64,
    /// Draw no pictures
    #[arg(long)]
    no_figures: bool,
    /// Say what would be done and left out, and do nothing
    #[arg(long)]
    plan: bool,
    #[command(flatten)]
    common: Common,
}

/// The cone of the forces that can be, and how it is entered.
#[derive(Debug, Args)]
struct Cone {
    /// The largest pressing
    #[arg(long, value_name = "NEWTONS", default_value_t = 3.0, allow_negative_numbers = true)]
    fz_max: f64,
    /// The coefficient of friction
    #[arg(long, default_value_t = 0.75, allow_negative_numbers = true)]
    mu: f64,
    /// Forces come out of rest within so long; 0: at once, as equation 21 is printed, which begins infinitely fast
    /// [default: 2, random forces 5]
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    soft_start: Option<f64>,
    /// The error that equation 19 may come to
    #[arg(long, value_name = "PERCENT", default_value_t = 10.0, allow_negative_numbers = true)]
    error: f64,
}

/// The spiral through the cone of friction (equations 21 to 23), with a soft start
#[derive(Debug, Args)]
struct ForceArgs {
    /// T, how long it takes
    #[arg(long, default_value_t = 180.0, allow_negative_numbers = true)]
    seconds: f64,
    /// f_s: how often it goes in and out, cycles a newton
    #[arg(long, value_name = "CYCLES", default_value_t = 1.0, allow_negative_numbers = true)]
    fs: f64,
    /// f_c: how often it circles
    #[arg(long, value_name = "HZ", default_value_t = 0.15, allow_negative_numbers = true)]
    fc: f64,
    #[command(flatten)]
    cone: Cone,
    #[command(flatten)]
    planned: Planned,
}

/// Bending: J2 = 35 - 40 cos(2 pi f t) degrees (equation 27), or at random within that range
#[derive(Debug, Args)]
struct PostureArgs {
    /// How long it takes
    #[arg(long, default_value_t = 60.0, allow_negative_numbers = true)]
    seconds: f64,
    /// f_b, the rate of bending; random bending has rates of 0.4 to 4 times it
    #[arg(long, default_value_t = 0.1, allow_negative_numbers = true)]
    hz: f64,
    /// Smooth random bending, for tests
    #[arg(long)]
    random: bool,
    /// Random bending follows from it
    #[arg(long, default_value_t = 1, requires = "random")]
    seed: u64,
    /// Random bending comes out of rest within so long
    #[arg(long, value_name = "SECONDS", default_value_t = 2.0, allow_negative_numbers = true)]
    soft_start: f64,
    #[command(flatten)]
    planned: Planned,
}

/// Smooth random forces within the cone of friction, for tests (5.2.4, 5.3.1)
#[derive(Debug, Args)]
struct RandomArgs {
    /// How long it takes
    #[arg(long, default_value_t = 100.0, allow_negative_numbers = true)]
    seconds: f64,
    /// Rates lie between 0.4 and 4 times it; at 0.03, equation 19's usual limit is kept
    #[arg(long, default_value_t = 0.03, allow_negative_numbers = true)]
    hz: f64,
    /// Everything random follows from it
    #[arg(long, default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    cone: Cone,
    #[command(flatten)]
    planned: Planned,
}

impl KindArg {
    fn options(&self) -> (TrajectoryOptions, &Planned) {
        let usual = |kind: Kind, seconds: f64, planned: &Planned| TrajectoryOptions {
            seconds,
            every_s: planned.every,
            lead_s: planned.lead,
            trail_s: planned.trail,
            tau_s: planned.tau,
            ..TrajectoryOptions::of(kind)
        };
        let in_cone = |options: TrajectoryOptions, cone: &Cone| TrajectoryOptions {
            fz_max_n: cone.fz_max,
            mu: cone.mu,
            soft_s: cone.soft_start.unwrap_or(options.soft_s),
            error: 0.01 * cone.error,
            ..options
        };
        match self {
            Self::Force(args) => {
                let kind = Kind::Force { fs_per_n: args.fs, fc_hz: args.fc };
                (in_cone(usual(kind, args.seconds, &args.planned), &args.cone), &args.planned)
            }
            Self::Random(args) => {
                let kind = Kind::Random { hz: args.hz, seed: args.seed };
                (in_cone(usual(kind, args.seconds, &args.planned), &args.cone), &args.planned)
            }
            Self::Posture(args) => {
                let kind = Kind::Posture { hz: args.hz, seed: args.random.then_some(args.seed) };
                let options = usual(kind, args.seconds, &args.planned);
                let soft_s = if args.random { args.soft_start } else { options.soft_s };
                (TrajectoryOptions { soft_s, ..options }, &args.planned)
            }
        }
    }
}

pub(super) fn run(args: &TrajectoryArgs) -> anyhow::Result<Outcome> {
    let (options, planned) = args.kind.options();
    let outputs =
        planned.out.as_ref().map(|table| TrajectoryOutputs { table: table.clone(), figures: !planned.no_figures });
    let common = &planned.common;
    let stop = common.start()?;
    if planned.plan {
        let steps = plan(&options, outputs.as_ref())?;
        return common.show_plan("trajectory", &steps);
    }
    let outputs = outputs.context("--out is needed")?;
    match run_trajectory(&options, &outputs, &stop) {
        Err(TrajectoryError::Interrupted) => Err(Interrupted.into()),
        Err(error) => Err(error.into()),
        Ok(report) => finish(common, &report),
    }
}

fn finish(common: &Common, report: &TrajectoryReport) -> anyhow::Result<Outcome> {
    common.warn(&report.warnings);
    common.print_json(report)?;
    common.say(&format!("{} rows from 0 to {:.3} s, every {} s", report.rows, report.span_s, report.options.every_s));
    if let Some(force) = &report.force {
        say_force(common, report, force);
    }
    if let Some(PostureFigures { lowest_deg, highest_deg, fastest_deg_per_s, behind_deg }) = report.posture {
        common.say(&format!(
            "J2 from {lowest_deg:.1} to {highest_deg:.1} degrees, at most {fastest_deg_per_s:.1} degrees a second: a \
             sensor that lags by {} s is {behind_deg:.1} degrees behind",
            report.options.tau_s
        ));
    }
    common.say_done(&report.stages, &report.left_out, report.wall_s, report.pictures.first().unwrap_or(&report.table));
    Ok(Outcome::Done)
}

fn say_force(common: &Common, report: &TrajectoryReport, force: &ForceFigures) {
    let options = &report.options;
    if let Some(rates) = &force.rates {
        let [x, y, z] = rates.components_n_per_s;
        common.say(&format!(
            "at most {x:.2}, {y:.2}, {z:.2} N/s in Fx, Fy, Fz, {:.2} N/s together (at {:.1} s)",
            rates.vector_n_per_s, rates.vector_at_s
        ));
        let relative = rates.relative_per_s.map_or("-".to_owned(), |relative| format!("{relative:.2}"));
        let always = match rates.kept_from_s {
            Some(from_s) => format!("; whatever the force, from {from_s:.1} s on"),
            None => String::new(),
        };
        common.say(&format!(
            "relative rate (eq. 19) at most {relative} a second where the force is {:.2} N or more; {:.0} % at {} s \
             allow {:.2}: {}",
            force.floor_n,
            100.0 * options.error,
            options.tau_s,
            force.limit_per_s,
            match rates.over_share {
                _ if force.keeps_limit => format!("kept{always}"),
                Some(share) => format!("not kept in {:.0} % of that time", 100.0 * share),
                None => "there is no such force".to_owned(),
            }
        ));
    }
    if let Some(spiral) = &force.spiral {
        common.say(&format!(
            "circling (eq. 24) below {:.3} Hz; radial rate at most {:.3} N/s with the soft start, {:.3} without (eq. \
             25 prints {:.3}); eq. 26 asks for {:.0} s as \
             printed, {:.0} s with the true rate, {:.0} s with the soft start",
            spiral.circling_limit_hz,
            spiral.radial_rate_max_n_per_s,
            spiral.radial_rate_true_n_per_s,
            spiral.radial_rate_printed_n_per_s,
            spiral.shortest_printed_s,
            spiral.shortest_true_s,
            spiral.shortest_s
        ));
    }
    let covered = &force.coverage;
    let known = |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{value:.3}"));
    for (name, even) in [("cylindrical", &covered.cylindrical), ("Cartesian", &covered.cartesian)] {
        let [up, out, turn] = even.of_each.map_or([None; 3], |each| each.map(Some)).map(known);
        common.say(&format!(
            "coverage, {name}: {:.0} % of {} cells, evenness {} (pressing {up}, shear {out}, direction {turn}; 1 is \
             even)",
            100.0 * even.visited,
            even.cells,
            known(even.entropy)
        ));
    }
    if let Some(hole) = &covered.hole {
        let [x, y, z] = hole.middle_n;
        common.say(&format!("largest hole: {:.2} N about ({x:.2}, {y:.2}, {z:.2}) N", hole.radius_n));
    }
    if let Some(correlation) = force.time_pressing_correlation {
        let drift =
            if correlation.abs() > 0.9 { ": a drift of the sensor can't be told from the pressing" } else { "" };
        common.say(&format!("correlation of time and pressing {correlation:.2}{drift}"));
    }
}
