//! `lunula fit`: the model's free parameters to recorded responses.

use std::path::PathBuf;

use clap::Args;
use lunula::hemodynamics::{FitInputs, FitOptions, FitReport, fit, fit_plan};
use lunula::job::Given;
use lunula::words::fixed;

use crate::jobs::{self, ResultArgs};
use crate::{Common, Outcome};

const EXAMPLES: &str = "Examples:
Stiffness and damping of all walls, and the photodiodes:
  lunula fit step.csv --free k_C,b_C,k_V,b_V --out fit.json
Offset and scaling of the photodiodes alone, as Fig. 79 and 81:
  lunula fit static.csv --free none --out fit.json
Two people:
  lunula fit a.csv b.csv --subject anna,ben --free k_C,b_C --out fit.json
A log of forces, with photodiodes P3 and P1 above the proximal and the distal unit:
  lunula fit log.csv --force Fz_N --area-cm2 1 --load distal --photodiode P3=1 --photodiode P1=2 \\
    --free b_C --out fit.json
What the fitted model does:
  lunula simulate --params fit.toml --pf1 step:5000@0..2 --out t.csv

A recording is a table of pf1_Pa,pf2_Pa and VP1,VP2,... With time_s it is a response over time, which begins in the \
equilibrium of its first row's load (--unloaded-before: at rest); without time_s it holds equilibria in the order in \
which they were reached. lunula simulate --with-loads and --static write such tables; steps jump at their rows: read \
them with --between held --unloaded-before.

Of a log whose column led says when the LED was on, each lit row is taken, less the unlit light at its time, and the \
loads of all rows; rows in which the sensor had a fault (saturated, or without ambient light; in a table of lunula \
align: sensor_status) have no voltage.

Names: k_C means k_C1, k_C2, .. which move together, as in the thesis; k_C1 means one of them; whole names such as \
k_C1_N_per_m work too.";

/// Fit parameters of the hemodynamic model (4.3), and the photodiodes' offset and scaling, to recorded responses
///
/// All other parameters are held at --params and --set. The results are the values with standard errors and
/// correlations, what the recordings do not determine, and which bounds were met; the fitted parameters as <out>.toml
/// for `lunula simulate --params`; measured and fitted voltages as <out>-fitted.csv, and a picture of both (Fig. 79 to
/// 82). <out>.json itself is the same bytes from whatever folder; where results are and how long they took is in
/// <out>.run.json.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
#[command(mut_arg("out", |out| out
    .value_name("FIT.json")
    .help("The result; parameters, tables and picture go beside it, named after it")
))]
pub(crate) struct FitArgs {
    /// Recorded responses
    #[arg(required = true, value_name = "RECORDING")]
    recordings: Vec<PathBuf>,
    /// Whose finger each recording is, in the order of the recordings, such as anna,anna,ben [default: all of one
    /// person]
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    subject: Vec<String>,
    #[command(flatten)]
    given: Given<FitOptions>,
    /// Parameters to start from, under the thesis' symbols with their units, such as k_C1_N_per_m = 1e5 [default: the
    /// thesis' table]; `lunula simulate --print-params` writes a whole file to start from
    #[arg(long, value_name = "PARAMS.toml")]
    params: Option<PathBuf>,
    #[command(flatten)]
    results: ResultArgs,
}

pub(crate) fn run(args: &FitArgs) -> anyhow::Result<Outcome> {
    let FitArgs { given, results, .. } = args;
    let inputs = FitInputs {
        recordings: args.recordings.clone(),
        subjects: args.subject.clone(),
        names: Vec::new(),
        params: args.params.clone(),
    };
    jobs::run(
        &results.request("fit", "steps", &given.said),
        || Ok(fit_plan(&inputs, &given.options, &results.outputs())?),
        |watch| Ok(fit(&inputs, &given.options, &results.outputs(), watch)?),
        say,
    )
}

fn say(common: &Common, report: &FitReport) {
    let r2 = report.r2.map_or(String::new(), |r2| format!(", R2 {r2:.5}"));
    common
        .say(&format!("{} voltages, residuals {:.3e} V{r2}; {}", report.values, report.residual_sd_v, report.stopped));
    for group in &report.free {
        let error = |k: usize| match (&group.standard_errors, group.at_bound) {
            (Some(errors), _) => format!("+- {:.2e}", errors[k]),
            (None, Some(bound)) => format!("at its {} bound", bound.word()),
            (None, None) => "not determined".to_owned(),
        };
        let end = |k: usize, which: usize, open: &str| {
            group.interval[which].as_ref().map_or(open.to_owned(), |values| format!("{:.3e}", values[k]))
        };
        for (k, name) in group.symbols.iter().map(ToString::to_string).enumerate() {
            let interval = match (&group.interval[0], &group.interval[1]) {
                (None, None) => String::new(),
                _ => format!("two standard errors {} to {}; ", end(k, 0, "its bound"), end(k, 1, "its bound")),
            };
            common.say(&format!(
                "  {name:<20} {:>12.5e} {:<20} ({interval}start {:.3e})",
                group.values[k],
                error(k),
                group.start[k]
            ));
        }
    }
    for one in &report.alone {
        for group in &one.free {
            let error = group
                .standard_errors
                .as_ref()
                .map_or("not determined".to_owned(), |errors| format!("+- {:.2e}", errors[0]));
            common.say(&format!(
                "  {:<20} {:>12.5e} {error:<20} ({} alone)",
                group.symbols[0].to_string(),
                group.values[0],
                one.name
            ));
        }
    }
    // Of a photodiode that hardly sees the model a scaling has hundreds of digits.
    let volts = |value: f64| if value.abs() < 1e6 { fixed(value, 5) } else { format!("{value:.5e}") };
    for one in &report.photodiodes {
        let plus = |error: Option<f64>| error.map_or("not determined".to_owned(), |error| format!("+- {error:.4} V"));
        common.say(&format!(
            "  unit {}{}: offset {} V {}, scaling {} V {}; {}",
            one.unit,
            if one.subjects.is_empty() { String::new() } else { format!(" of {}", one.subjects.join(", ")) },
            volts(one.offset_v),
            plus(one.offset_standard_error_v),
            volts(one.scaling_v),
            plus(one.scaling_standard_error_v),
            one.recordings.join(", ")
        ));
    }
    for one in &report.recordings {
        let of = |((name, noise_v), noise): ((&String, &f64), &String)| format!("{name} {noise_v:.2e} V, {noise}");
        let noises: Vec<String> = one.photodiodes.iter().zip(&one.noise_v).zip(&one.noise).map(of).collect();
        common.say(&format!("  noise in {}: {}", one.file.display(), noises.join("; ")));
    }
}
