//! `lunula trajectory`: tables of forces or angles for a prompter to play.

use clap::{Args, Subcommand};
use lunula::job::Given;
use lunula::predictor::trajectory::{
    self, BendingOptions, ForceFigures, ForceOptions, KindOptions, PostureFigures, RandomOptions, TrajectoryReport,
};

use crate::jobs::{self, ResultArgs};
use crate::{Common, Outcome};

/// Write calibration trajectories (5.2.3) as tables that a prompter can play, with how fast they are and how evenly
/// they cover
///
/// Beside the table are <table>.run.json and pictures (Fig. 90-93).
#[derive(Debug, Args)]
pub(crate) struct TrajectoryArgs {
    #[command(subcommand)]
    kind: KindArg,
}

#[derive(Debug, Subcommand)]
enum KindArg {
    /// The spiral through the cone of friction (equations 21 to 23), with a soft start
    Force(KindArgs<ForceOptions>),
    /// Bending: J2 = 35 - 40 cos(2 pi f t) degrees (equation 27), or at random within that range
    Posture(KindArgs<BendingOptions>),
    /// Smooth random forces within the cone of friction, for tests (5.2.4, 5.3.1)
    Random(KindArgs<RandomOptions>),
}

#[derive(Debug, Args)]
#[command(mut_arg("out", |out| out
    .value_name("TABLE.csv")
    .help("The table: time_s and Fx_N, Fy_N, Fz_N (of the finger on the surface: pressing is negative Fz_N) or \
           J2_deg (.csv or .parquet)")
))]
struct KindArgs<K: KindOptions> {
    #[command(flatten)]
    given: Given<K>,
    #[command(flatten)]
    results: ResultArgs,
}

pub(crate) fn run(args: &TrajectoryArgs) -> anyhow::Result<Outcome> {
    match &args.kind {
        KindArg::Force(args) => write(args),
        KindArg::Posture(args) => write(args),
        KindArg::Random(args) => write(args),
    }
}

fn write<K: KindOptions>(KindArgs { given, results }: &KindArgs<K>) -> anyhow::Result<Outcome> {
    jobs::run(
        &results.request("trajectory", "steps", &given.said),
        || Ok(trajectory::plan(&given.options.options(), &results.outputs())?),
        |watch| Ok(trajectory::run(&given.options.options(), &results.outputs(), watch)?),
        say,
    )
}

fn say(common: &Common, report: &TrajectoryReport) {
    common
        .say(&format!("{} rows from 0 to {:.3} s, every {} s", report.rows, report.span_s, report.trajectory.every_s));
    if let Some(force) = &report.force {
        say_force(common, report, force);
    }
    if let Some(PostureFigures { lowest_deg, highest_deg, fastest_deg_per_s, behind_deg }) = report.posture {
        common.say(&format!(
            "J2 from {lowest_deg:.1} to {highest_deg:.1} degrees, at most {fastest_deg_per_s:.1} degrees a \
             second: a \
             sensor that lags by {} s is {behind_deg:.1} degrees behind",
            report.trajectory.tau_s
        ));
    }
}

fn say_force(common: &Common, report: &TrajectoryReport, force: &ForceFigures) {
    let options = &report.trajectory;
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
                Some(share) if force.keeps_limit && share > 0.0 => {
                    format!("kept but for {:.1} % of that time{always}", 100.0 * share)
                }
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
        let drift = if correlation.abs() > 0.9 {
            ": a drift of the sensor can't be distinguished from the pressing"
        } else {
            ""
        };
        common.say(&format!("correlation of time and pressing {correlation:.2}{drift}"));
    }
}
