//! The equilibria of a range of loads: options in, a table with its report and picture out.

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use lunula_hemodynamics::{Load, Parameters};

use super::{CurveOptions, CurveReport, figure, table};
use crate::files::{Places, beside, pictures_beside};
use crate::hemodynamics::error::go_on;
use crate::hemodynamics::given::keep_inputs;
use crate::hemodynamics::solve::{Curve, along};
use crate::hemodynamics::{HemodynamicsError, named};
use crate::stages::{Stages, Step, left_out};
use crate::table::TableFormat;
use crate::words::Words;

/// The picture's name, after the table's.
const PICTURE: &str = "static";

/// Where results go.
#[derive(Debug, Clone)]
pub struct CurveOutputs {
    /// The table; report and picture stand beside it, named after it.
    pub table: PathBuf,
    /// Whether a picture is drawn.
    pub figures: bool,
}

/// Plans a run; `outputs` may be open yet.
///
/// # Errors
/// What is wrong with the options or the files that they name.
pub fn plan(options: &CurveOptions, outputs: Option<&CurveOutputs>) -> Result<Vec<Step>, HemodynamicsError> {
    let parameters = options.parameters.read()?;
    blood(options, &parameters)?;
    Ok(steps(options, outputs, Some(parameters.units().len())))
}

/// Plans a curve whose parameters do not stand yet.
#[must_use]
pub fn outline(options: &CurveOptions, outputs: Option<&CurveOutputs>) -> Vec<Step> {
    steps(options, outputs, options.parameters.units)
}

fn steps(options: &CurveOptions, outputs: Option<&CurveOutputs>, units: Option<usize>) -> Vec<Step> {
    let pictures = outputs.is_none_or(|outputs| outputs.figures);
    let loads = options.range.loads_pa().len();
    let units = units.map_or(String::new(), |units| format!("{units} units, "));
    vec![
        Step::new("equilibria", true, format!("{units}{loads} loads, {}", options.pressed.word())),
        Step::new("run over time", false, "--static".to_owned()),
        Step::new("figures", pictures, if pictures { "photodiodes over the load" } else { "--no-figures" }.to_owned()),
    ]
}

/// `[P_H, P_L]`, which have to be constants here.
fn blood(options: &CurveOptions, parameters: &Parameters) -> Result<[f64; 2], HemodynamicsError> {
    let constant = |load: &Option<Load>, usual: f64, name: &str| match load {
        None => Ok(usual),
        // A load that is not constant tells different pressures at some of these times.
        Some(load) => {
            let value = load.at(0.0);
            let same = load.breakpoints().iter().chain(&[0.1, 0.237, 1.618]).all(|&time_s| load.at(time_s) == value);
            let what =
                || format!("{name}: an equilibrium is that of a constant pressure; write a number, as {name} 10000");
            if same { Ok(value) } else { Err(HemodynamicsError::Options(vec![what()])) }
        }
    };
    Ok([
        constant(&options.upstream, parameters.upstream_pa(), "--ph")?,
        constant(&options.downstream, parameters.downstream_pa(), "--pl")?,
    ])
}

/// Runs the job; every result is in its place when it returns.
///
/// # Errors
/// [`HemodynamicsError`] where there are no results.
pub fn curve(
    options: &CurveOptions,
    outputs: &CurveOutputs,
    stop: &AtomicBool,
) -> Result<CurveReport, HemodynamicsError> {
    let begin = Instant::now();
    let stages = Stages::default();
    TableFormat::of(&outputs.table)?;
    let parameters = options.parameters.read()?;
    let figures = outputs.figures.then(|| pictures_beside(&outputs.table, PICTURE)).into_iter().flatten();
    let own = [outputs.table.clone(), beside(&outputs.table, ".run.json")].into_iter().chain(figures);
    keep_inputs(options.parameters.file.iter(), &own.collect::<Vec<_>>())?;
    let blood_pa = blood(options, &parameters)?;
    let optics = options.optics.optics(&parameters)?;
    let loads_pa = options.range.loads_pa();
    let found = stages
        .time("equilibria", || along(&parameters, options.collapse, &optics, options.pressed, &loads_pa, blood_pa))?;
    let Curve { points, folds, bistable_pa, closed_pa } = found;
    go_on(stop)?;
    let mut places = Places::default();
    let at = places.place(&outputs.table)?;
    stages.time("table", || table::write(&parameters, options.pressed, &points, &at, &outputs.table))?;
    let mut pictures = Vec::new();
    let nothing_open = points.iter().all(|point| point.lumens.is_none());
    if outputs.figures && !nothing_open {
        let title = format!("Equilibria under {} load", options.pressed.word());
        pictures.push(places.draw(&outputs.table, PICTURE, |png, svg| {
            stages.time("figures", || figure::draw_curve(&title, &points, &folds, &bistable_pa, png, svg))
        })?);
    }
    go_on(stop)?;
    // Points follow the loads.
    let by_load = points.chunk_by(|a, b| a.load_pa == b.load_pa);
    let counts: Vec<usize> = by_load.map(|own| own.iter().filter(|point| point.lumens.is_some()).count()).collect();
    let with = |wanted: fn(usize) -> bool| counts.iter().filter(|&&count| wanted(count)).count();
    let report = CurveReport {
        job: "simulate --static",
        version: env!("CARGO_PKG_VERSION"),
        table: outputs.table.clone(),
        rows: points.len() as u64,
        units: parameters.units().len(),
        load: options.pressed,
        range: options.range,
        collapse: options.collapse.name(),
        optics: options.optics,
        loads: loads_pa.len(),
        with_one: with(|count| count == 1),
        with_several: with(|count| count > 1),
        with_none: with(|count| count == 0),
        folds,
        bistable_pa,
        closed_pa,
        parameters: named(&parameters),
        left_out: left_out(steps(options, Some(outputs), Some(parameters.units().len()))),
        warnings: if nothing_open {
            vec!["no load has an equilibrium with open vessels: nothing is drawn".to_owned()]
        } else {
            vec![]
        },
        failed: Vec::new(),
        pictures,
        stages: stages.list(),
        wall_s: begin.elapsed().as_secs_f64(),
    };
    let text = serde_json::to_string_pretty(&report).expect("plain data") + "\n";
    places.write(&beside(&outputs.table, ".run.json"), &text)?;
    places.commit()?;
    Ok(report)
}
