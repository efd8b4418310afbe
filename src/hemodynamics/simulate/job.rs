//! The run: options in, a table with its report and picture out; the one entry that command line and pipelines call.

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use lunula_hemodynamics::Parameters;

use super::report::{Collapsed, LoadsReport, SimulateReport};
use super::{SimulateOptions, table};
use crate::files::{Places, beside, pictures_beside};
use crate::hemodynamics::error::go_on;
use crate::hemodynamics::figures::draw_response;
use crate::hemodynamics::given::{ReadLoads, Start, keep_inputs};
use crate::hemodynamics::solve::{Run, RunSettings, respond, start_state};
use crate::hemodynamics::{HemodynamicsError, named};
use crate::stages::{Stages, Step, left_out};
use crate::table::TableFormat;

/// The picture's name, after the table's.
const PICTURE: &str = "response";

/// Where results go.
#[derive(Debug, Clone)]
pub struct SimulateOutputs {
    /// The table; report and picture stand beside it, named after it.
    pub table: PathBuf,
    /// Whether a picture is drawn.
    pub figures: bool,
}

/// What a run needs, read and checked.
struct Ready {
    parameters: Parameters,
    loads: ReadLoads,
}

/// Plans a run; `outputs` may be open yet.
///
/// # Errors
/// What is wrong with the options or the files that they name.
pub fn plan(options: &SimulateOptions, outputs: Option<&SimulateOutputs>) -> Result<Vec<Step>, HemodynamicsError> {
    let ready = ready(options)?;
    Ok(steps(options, outputs, Some(ready.parameters.units().len())))
}

/// Plans a run whose files do not stand yet: what hangs on them is left open.
#[must_use]
pub fn outline(options: &SimulateOptions, outputs: Option<&SimulateOutputs>) -> Vec<Step> {
    steps(options, outputs, options.parameters.units)
}

fn ready(options: &SimulateOptions) -> Result<Ready, HemodynamicsError> {
    let parameters = options.parameters.read()?;
    let faults = options.faults(parameters.units().len());
    if !faults.is_empty() {
        return Err(HemodynamicsError::Options(faults));
    }
    let loads = options.loads.read(&parameters)?;
    Ok(Ready { parameters, loads })
}

fn steps(options: &SimulateOptions, outputs: Option<&SimulateOutputs>, units: Option<usize>) -> Vec<Step> {
    let units = units.map_or(String::new(), |units| format!("{units} units, "));
    let equilibrium = options.start == Start::Equilibrium;
    let start = match &options.start {
        Start::Equilibrium => "of the loads just before t = 0".to_owned(),
        Start::Zero => "--from zero: no displacement, no velocity".to_owned(),
        Start::File(path) => format!("--from: the last row of {}", path.display()),
    };
    let pictures = outputs.is_none_or(|outputs| outputs.figures);
    vec![
        Step::new("equilibrium to start from", equilibrium, start),
        Step::new("run", true, format!("{units}{} rows, rtol {:e}", options.rows(), options.rtol)),
        Step::new(
            "loads in the table",
            options.with_loads,
            if options.with_loads { "--with-loads" } else { "without --with-loads" }.to_owned(),
        ),
        Step::new("figures", pictures, if pictures { "the response over time" } else { "--no-figures" }.to_owned()),
    ]
}

/// Runs the job; every result is in its place when it returns.
///
/// # Errors
/// [`HemodynamicsError`] where there are no results; a vessel that closes is one, unless the part before it is to be
/// kept.
pub fn simulate(
    options: &SimulateOptions,
    outputs: &SimulateOutputs,
    stop: &AtomicBool,
) -> Result<SimulateReport, HemodynamicsError> {
    let begin = Instant::now();
    let stages = Stages::default();
    TableFormat::of(&outputs.table)?;
    let Ready { parameters, loads } = stages.time("read", || ready(options))?;
    is_no_input(options, outputs)?;
    let warnings = warnings(options, &loads);
    let optics = options.optics.optics(&parameters)?;
    let settings = RunSettings { collapse: options.collapse, rtol: options.rtol, optics, from_s: 0.0 };
    let start = stages.time("start", || start_state(&options.start, &parameters, &loads.loads, options.collapse))?;
    go_on(stop)?;
    let times_s = options.times_s();
    let solved = stages.time("run", || respond(&parameters, &loads.loads, &start, &times_s, &settings))?;
    let Run { response, work, collapsed } = solved;
    let mut failed = Vec::new();
    if let Some(collapsed) = &collapsed {
        let what = collapsed.words();
        if !options.keep_partial {
            return Err(HemodynamicsError::Model(format!(
                "{what}; the thesis' model ends there and nothing was written: --collapse contact lets the walls \
                 touch, --keep-partial writes what is before it"
            )));
        }
        failed.push(format!("{what}; the table ends before it"));
    }
    go_on(stop)?;
    let mut places = Places::default();
    let shown = options.with_loads.then_some(&loads.loads);
    let at = places.place(&outputs.table)?;
    stages.time("table", || table::write(&parameters, &response, shown, &at, &outputs.table))?;
    let mut pictures = Vec::new();
    if outputs.figures {
        pictures.push(places.draw(&outputs.table, PICTURE, |png, svg| {
            stages.time("figures", || draw_response(&parameters, &loads.loads, &response, png, svg))
        })?);
    }
    go_on(stop)?;
    let left_out = left_out(steps(options, Some(outputs), Some(parameters.units().len())));
    let report = SimulateReport {
        job: "simulate",
        version: env!("CARGO_PKG_VERSION"),
        table: outputs.table.clone(),
        rows: response.rows() as u64,
        last_s: response.times_s.last().copied(),
        units: parameters.units().len(),
        loads: LoadsReport::of(&loads.loads, options.loads.file.clone()),
        parameters_file: options.parameters.file.clone(),
        from: match &options.start {
            Start::Equilibrium => "equilibrium".to_owned(),
            Start::Zero => "zero".to_owned(),
            Start::File(path) => path.display().to_string(),
        },
        optics: options.optics,
        collapse: options.collapse.name(),
        until_s: options.until_s,
        every_s: options.every_s,
        rtol: options.rtol,
        stopped: collapsed.as_ref().map_or("the last row was reached".to_owned(), Collapsed::words),
        collapsed,
        work,
        parameters: named(&parameters),
        left_out,
        warnings,
        failed,
        pictures,
        stages: stages.list(),
        wall_s: begin.elapsed().as_secs_f64(),
    };
    let text = serde_json::to_string_pretty(&report).expect("plain data") + "\n";
    places.write(&beside(&outputs.table, ".run.json"), &text)?;
    places.commit()?;
    Ok(report)
}

/// Refuses to write over an input.
fn is_no_input(options: &SimulateOptions, outputs: &SimulateOutputs) -> Result<(), HemodynamicsError> {
    let start = if let Start::File(path) = &options.start { Some(path) } else { None };
    let inputs = [options.parameters.file.as_ref(), options.loads.file.as_ref(), start];
    let figures = outputs.figures.then(|| pictures_beside(&outputs.table, PICTURE)).into_iter().flatten();
    let own = [outputs.table.clone(), beside(&outputs.table, ".run.json")].into_iter().chain(figures);
    keep_inputs(inputs.into_iter().flatten(), &own.collect::<Vec<_>>())
}

fn warnings(options: &SimulateOptions, loads: &ReadLoads) -> Vec<String> {
    let mut warnings = loads.notes.clone();
    if options.loads.is_none() {
        warnings.push("nothing presses: --pf1, --pf2 or --loads say what does".to_owned());
    }
    let last_s = options.last_s();
    if last_s < options.until_s * (1.0 - 1e-9) {
        let (until_s, every_s) = (options.until_s, options.every_s);
        warnings
            .push(format!("--until {until_s} is no multiple of --every {every_s}: the last row stands at {last_s} s"));
    }
    if let (Some([first, last]), Some(path)) = (loads.known_s, &options.loads.file) {
        let path = path.display();
        if first > options.until_s || last < 0.0 {
            warnings.push(format!(
                "{path}: knows the loads from {first} to {last} s, the run goes from 0 to {} s; it sees a constant \
                 load only",
                options.until_s
            ));
        } else if last > options.until_s {
            warnings.push(format!(
                "{path}: goes on to {last} s, the run ends at {} s; --until {last} takes it all",
                options.until_s
            ));
        }
    }
    warnings
}
