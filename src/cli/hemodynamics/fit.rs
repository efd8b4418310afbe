//! `lunula fit`: the model's free parameters to recorded responses.

use std::path::PathBuf;

use anyhow::Context;
use clap::Args;
use lunula::hemodynamics::model::{Bounds, Calibration, Collapse};
use lunula::hemodynamics::{
    Between, FitOptions, FitOutputs, FitReport, ForceColumn, OpticsChoice, PhotodiodeColumn, Pressed, RecordingColumns,
    STARTS, fit, fit_plan,
};
use lunula::log::LogReading;

use super::{Common, NailArgs, Outcome, ended, one_of};

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

A recording is a table of pf1_Pa,pf2_Pa and VP1,VP2,... With time_s it is a response over time, which begins in the equilibrium of \
its first row's load (--unloaded-before: at rest); without time_s it holds equilibria in the order in which they were \
reached. \
lunula simulate --with-loads and --static write such tables; steps jump at their rows: read them with --between held \
--unloaded-before.

Of a log whose column led says when the LED was on, each lit row is taken, less the unlit light at its time, and the loads of all \
rows; rows in which the sensor had a fault (saturated, or without ambient light; in a table of lunula align: sensor_status) have no voltage.

Names: k_C stands for k_C1, k_C2, .. that move together, as in the thesis; k_C1 for one of them; whole names as k_C1_N_per_m will do.";

/// Fits free parameters of the hemodynamic model (4.3), and the photodiodes' offset and scaling, to recorded responses
///
/// All other parameters are held at --params and --set. Out come the values with standard errors and correlations, what
/// the recordings do not determine, and which bounds were met; the fitted parameters as <out>.toml for
/// `lunula simulate --params`; measured and fitted voltages as <out>-fitted.csv, and a picture of both (Fig. 79 to 82).
/// <out>.json itself is the same bytes from whatever folder; where results are and how long they took is in
/// <out>.run.json.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct FitArgs {
    /// Recorded responses
    #[arg(required = true, value_name = "RECORDING")]
    recordings: Vec<PathBuf>,
    /// Parameters to be fitted, as k_C,b_C,k_V; none: offset and scaling of the photodiodes alone
    #[arg(long, value_name = "NAMES", value_delimiter = ',', required = true)]
    free: Vec<String>,
    /// Where a free parameter may go, as k_C=0.1x..10x (of its start) or k_V=200..5000 (in its unit) [default: a tenth
    /// to ten times its start, as the thesis tunes]
    #[arg(long, value_name = "NAME=LOW..HIGH", value_parser = parse_bounds)]
    bounds: Vec<(String, Bounds)>,
    /// Begin the fit from so many points within the bounds; the best counts
    #[arg(long, value_name = "N", default_value_t = STARTS, value_parser = clap::value_parser!(u16).range(1..=1000))]
    starts: u16,
    /// Offset and scaling of the photodiodes: subject (one of each for every subject), recording (for every recording),
    /// shared, or held
    #[arg(long, value_parser = one_of::<Calibration>(), default_value = "subject")]
    calibrate: Calibration,
    /// Whose finger each recording is, in the order of the recordings, as anna,anna,ben [default: all one's]
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    subject: Vec<String>,
    /// SD of photodiodes' noise in volts, as VP1=5e-5,VP2=6e-4 [default: estimated for each photodiode and subject]
    #[arg(long, value_name = "COLUMN=V", value_parser = parse_noise, value_delimiter = ',')]
    noise: Vec<(String, f64)>,
    /// A photodiode's column and the unit that it stands above, counted from the proximal end, as P3=1 [default: VP1=1,
    /// VP2=2, ..]
    #[arg(long, value_name = "COLUMN=UNIT", value_parser = parse_photodiode)]
    photodiode: Vec<PhotodiodeColumn>,
    /// A force's column instead of pf1_Pa, pf2_Pa: of the finger on the surface in newtons, negative where it presses,
    /// as Fz_N
    #[arg(long, value_name = "COLUMN", requires = "area_cm2")]
    force: Option<String>,
    /// The area that the force presses on
    #[arg(long, value_name = "CM2", requires = "force", value_parser = parse_area, allow_negative_numbers = true)]
    area_cm2: Option<f64>,
    /// Where the force presses
    #[arg(long, value_parser = one_of::<Pressed>(), default_value = "both", requires = "force")]
    load: Pressed,
    /// What loads do from row to row: straight lines, or held until the next row, where they jump
    #[arg(long, value_parser = one_of::<Between>(), default_value = "straight")]
    between: Between,
    /// Nothing pressed before the first row [default: the first row's load did, for long]
    #[arg(long)]
    unloaded_before: bool,
    /// Where a vessel closes: error, or contact
    #[arg(long, value_parser = one_of::<Collapse>(), default_value = "error")]
    collapse: Collapse,
    /// How light depends on the capillaries
    #[arg(long, value_parser = one_of::<OpticsChoice>(), default_value = "beer-lambert")]
    optics: OpticsChoice,
    #[command(flatten)]
    log: LogReading,
    #[command(flatten)]
    nail: NailArgs,
    /// The result; parameters, table and picture stand beside it, named after it
    #[arg(long, value_name = "FIT.json", required_unless_present = "plan")]
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

fn parse_bounds(text: &str) -> Result<(String, Bounds), String> {
    let (name, range) = text.split_once('=').ok_or_else(|| format!("{text:?}: write NAME=LOW..HIGH"))?;
    Ok((name.trim().to_owned(), range.parse()?))
}

fn parse_photodiode(text: &str) -> Result<PhotodiodeColumn, String> {
    let wrong = || format!("{text:?}: write COLUMN=UNIT, as P3=1; units are counted from 1 at the proximal end");
    let (name, unit) = text.split_once('=').ok_or_else(wrong)?;
    PhotodiodeColumn::above(name.trim(), unit.trim().parse().map_err(|_| wrong())?)
}

fn parse_noise(text: &str) -> Result<(String, f64), String> {
    let wrong = || format!("{text:?}: write COLUMN=VOLTS, greater than 0, as VP1=5e-5");
    let (name, volts) = text.split_once('=').ok_or_else(wrong)?;
    let volts = volts.trim().parse::<f64>().ok().filter(|volts| volts.is_finite() && *volts > 0.0).ok_or_else(wrong)?;
    Ok((name.trim().to_owned(), volts))
}

fn parse_area(text: &str) -> Result<f64, String> {
    let area_cm2 = text.parse().map_err(|_| format!("{text:?}: is no number"))?;
    let usable = f64::is_finite(area_cm2) && area_cm2 > 0.0;
    if usable { Ok(area_cm2) } else { Err(format!("{text}: an area is greater than 0, as 1")) }
}

impl FitArgs {
    fn options(&self) -> FitOptions {
        let force = self.force.clone().zip(self.area_cm2);
        FitOptions {
            recordings: self.recordings.clone(),
            columns: RecordingColumns {
                between: self.between,
                unloaded_before: self.unloaded_before,
                force: force.map(|(name, area_cm2)| ForceColumn { name, area_m2: 1e-4 * area_cm2, pressed: self.load }),
                photodiodes: self.photodiode.clone(),
                log: self.log.clone(),
            },
            subjects: self.subject.clone(),
            names: Vec::new(),
            free: if self.free == ["none"] { Vec::new() } else { self.free.clone() },
            bounds: self.bounds.clone(),
            noise: self.noise.clone(),
            calibration: self.calibrate,
            starts: usize::from(self.starts),
            parameters: self.nail.given(),
            collapse: self.collapse,
            optics: self.optics,
        }
    }
}

pub(crate) fn run(args: &FitArgs) -> anyhow::Result<Outcome> {
    let stop = args.common.start()?;
    let options = args.options();
    let outputs = args.out.as_ref().map(|result| FitOutputs { result: result.clone(), figures: !args.no_figures });
    if args.plan {
        return args.common.show_plan("fit", &fit_plan(&options, outputs.as_ref()).map_err(ended)?);
    }
    let report = fit(&options, &outputs.context("--out is needed")?, &stop).map_err(ended)?;
    finish(&args.common, &report)
}

fn finish(common: &Common, report: &FitReport) -> anyhow::Result<Outcome> {
    common.warn(&report.warnings);
    common.print_json(report)?;
    let r2 = report.r2.map_or(String::new(), |r2| format!(", R2 {r2:.5}"));
    common
        .say(&format!("{} voltages, residuals {:.3e} V{r2}; {}", report.values, report.residual_sd_v, report.stopped));
    for group in &report.free {
        let error = |k: usize| match (&group.standard_errors, group.at_bound) {
            (Some(errors), _) => format!("+- {:.2e}", errors[k]),
            (None, Some(bound)) => format!("at its {bound} bound"),
            (None, None) => "not determined".to_owned(),
        };
        let end = |k: usize, which: usize, open: &str| {
            group.interval[which].as_ref().map_or(open.to_owned(), |values| format!("{:.3e}", values[k]))
        };
        for (k, name) in group.names.iter().enumerate() {
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
    for one in &report.photodiodes {
        let plus = |error: Option<f64>| error.map_or("not determined".to_owned(), |error| format!("+- {error:.4} V"));
        common.say(&format!(
            "  unit {}{}: offset {:.5} V {}, scaling {:.5} V {}; {}",
            one.unit,
            if one.subjects.is_empty() { String::new() } else { format!(" of {}", one.subjects.join(", ")) },
            one.offset_v,
            plus(one.offset_standard_error_v),
            one.scaling_v,
            plus(one.scaling_standard_error_v),
            one.recordings.join(", ")
        ));
    }
    for one in &report.recordings {
        let of = |(name, noise_v): (&String, &f64)| format!("{name} {noise_v:.2e} V");
        let noises: Vec<String> = one.photodiodes.iter().zip(&one.noise_v).map(of).collect();
        common.say(&format!("  noise in {}: {}", one.file.display(), noises.join(", ")));
    }
    common.say_done(&report.stages, &report.left_out, report.wall_s, report.pictures.first().unwrap_or(&report.table));
    Ok(Outcome::Done)
}
