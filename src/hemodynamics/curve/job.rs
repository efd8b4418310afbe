//! The equilibria of a range of loads: options in, a table with its report and picture out.

use std::path::Path;

use lunula_hemodynamics::{Load, Parameters};

use super::{CurveFigures, CurveOptions, CurveReport, figure, table};
use crate::files::{Places, beside};
use crate::hemodynamics::given::{SUCTION, hardly_flows, hardly_pressed};
use crate::hemodynamics::solve::{Curve, along};
use crate::hemodynamics::{HemodynamicsError, named};
use crate::job::{Outputs, Report, Watch};
use crate::stages::{Stages, Step, left_out};
use crate::table::TableFormat;
use crate::words::Words;

/// The picture's name, after the table's.
const PICTURE: &str = "static";

/// Plans a run; `outputs` may have no place yet.
///
/// # Errors
/// What is wrong with the options or the file of parameters.
pub fn plan(params: Option<&Path>, options: &CurveOptions, outputs: &Outputs) -> Result<Vec<Step>, HemodynamicsError> {
    let parameters = options.model.parameters(params)?;
    blood(options, &parameters)?;
    Ok(steps(options, outputs, Some(parameters.units().len())))
}

/// The one table of steps; `units` are known once the parameters are.
pub(super) fn steps(options: &CurveOptions, outputs: &Outputs, units: Option<usize>) -> Vec<Step> {
    let pictures = outputs.figures;
    let loads = options.range.loads.loads_pa().len();
    let units = units.map_or(String::new(), |units| format!("{units} units, "));
    vec![
        Step::new("equilibria", true, format!("{units}{loads} loads, {}", options.range.pressed.word())),
        Step::new("run over time", false, "--static".to_owned()),
        Step::figures(pictures, "photodiodes over the load"),
    ]
}

/// `[P_H, P_L]`, which have to be constants here.
fn blood(options: &CurveOptions, parameters: &Parameters) -> Result<[f64; 2], HemodynamicsError> {
    let constant = |load: &Option<Load>, default_pa: f64, name: &str| match load {
        None => Ok(default_pa),
        // A load that is not constant has different pressures at some of these times.
        Some(load) => {
            let value = load.at(0.0);
            let same = load.breakpoints().iter().chain(&[0.1, 0.237, 1.618]).all(|&time_s| load.at(time_s) == value);
            let what =
                || format!("{name}: an equilibrium is that of a constant pressure; write a number, as {name} 10000");
            if same { Ok(value) } else { Err(HemodynamicsError::Options(vec![what()])) }
        }
    };
    Ok([
        constant(&options.blood.ph, parameters.upstream_pa(), "--ph")?,
        constant(&options.blood.pl, parameters.downstream_pa(), "--pl")?,
    ])
}

/// Runs the job; every result is in its place when it returns.
///
/// # Errors
/// [`HemodynamicsError`] where there are no results.
pub fn curve(
    params: Option<&Path>,
    options: &CurveOptions,
    outputs: &Outputs,
    watch: &Watch<'_>,
) -> Result<CurveReport, HemodynamicsError> {
    let stages = Stages::default();
    TableFormat::of(&outputs.out)?;
    let report_at = outputs.report.then(|| beside(&outputs.out, ".run.json"));
    let mut places = Places::not_over(params);
    places.check([Some(&outputs.out), report_at.as_ref()].into_iter().flatten())?;
    let CurveOptions { range, model, .. } = options;
    let parameters = model.parameters(params)?;
    let units = parameters.units().len();
    let blood_pa = blood(options, &parameters)?;
    let optics = model.optics.optics(&parameters)?;
    let loads_pa = range.loads.loads_pa();
    let Curve { points, folds, bistable_pa, closed_pa } = stages
        .time("equilibria", || along(&parameters, model.collapse, &optics, range.pressed, &loads_pa, blood_pa))?;
    watch.go_on()?;
    let at = places.place(&outputs.out)?;
    stages.time("table", || table::write(&parameters, range.pressed, &points, &at, &outputs.out))?;
    let mut pictures = Vec::new();
    let nothing_open = points.iter().all(|point| point.lumens.is_none());
    if outputs.figures && !nothing_open {
        let title = format!("Equilibria under {} load", range.pressed.word());
        pictures.push(places.draw(&outputs.out, PICTURE, |png, svg| {
            stages.time("figures", || figure::draw_curve(&title, &points, &folds, &bistable_pa, png, svg))
        })?);
    }
    watch.go_on()?;
    // Points follow the loads.
    let by_load = points.chunk_by(|a, b| a.load_pa == b.load_pa);
    let counts: Vec<usize> = by_load.map(|own| own.iter().filter(|point| point.lumens.is_some()).count()).collect();
    let with = |is_so: fn(usize) -> bool| counts.iter().filter(|&&count| is_so(count)).count();
    let figures = CurveFigures {
        table: outputs.out.clone(),
        rows: points.len() as u64,
        units,
        load: range.pressed,
        range: range.loads,
        collapse: model.collapse.word(),
        optics: model.optics,
        loads: loads_pa.len(),
        with_one: with(|count| count == 1),
        with_several: with(|count| count > 1),
        with_none: with(|count| count == 0),
        folds,
        bistable_pa,
        closed_pa,
        parameters: named(&parameters),
    };
    let left_out = left_out(steps(options, outputs, Some(units)));
    let mut report = Report { left_out, pictures, ..Report::new("simulate --static", watch, figures) };
    if range.loads.from_pa < 0.0 {
        report.notes.push(format!("--static: loads begin at {} Pa: {SUCTION}", range.loads.from_pa));
    }
    report.warnings.extend(hardly_pressed(&[("--static", &loads_pa)]).into_iter().chain(hardly_flows(blood_pa)));
    if nothing_open {
        report.warnings.push("no load has an equilibrium with open vessels: nothing is drawn".to_owned());
    }
    Ok(report.timed(&stages).commit(places, report_at.as_deref())?)
}
