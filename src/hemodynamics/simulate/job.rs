//! The run: options in, a table with its report and picture out.

use lunula_hemodynamics::{Load, Parameters};

use super::report::{Collapsed, LoadsReport, SimulateFigures, SimulateReport};
use super::{SimulateInputs, SimulateOptions, table};
use crate::files::{Places, beside};
use crate::hemodynamics::figures::draw_response;
use crate::hemodynamics::given::{LoadOptions, ReadLoads, SUCTION, Start};
use crate::hemodynamics::solve::{Run, RunSettings, respond, start_state};
use crate::hemodynamics::{HemodynamicsError, Response, named};
use crate::job::{Outputs, Report, Watch};
use crate::stages::{Stages, Step, left_out};
use crate::table::TableFormat;
use crate::words::Words;

/// The picture's name, after the table's.
const PICTURE: &str = "response";

/// What a run needs, read and checked.
struct Ready {
    parameters: Parameters,
    loads: ReadLoads,
}

/// Plans a run; `outputs` may have no place yet.
///
/// # Errors
/// What is wrong with the options or the files.
pub fn plan(
    inputs: &SimulateInputs,
    options: &SimulateOptions,
    outputs: &Outputs,
) -> Result<Vec<Step>, HemodynamicsError> {
    let ready = ready(inputs, options)?;
    Ok(steps(options, outputs, Some(ready.parameters.units().len())))
}

fn ready(inputs: &SimulateInputs, options: &SimulateOptions) -> Result<Ready, HemodynamicsError> {
    let parameters = options.model.parameters(inputs.params.as_deref())?;
    let faults = options.faults(parameters.units().len());
    if !faults.is_empty() {
        return Err(HemodynamicsError::Options(faults));
    }
    let loads = options.loads.read(inputs.loads.as_deref(), &parameters)?;
    Ok(Ready { parameters, loads })
}

/// The one table of steps; `units` are known once the parameters are.
pub(super) fn steps(options: &SimulateOptions, outputs: &Outputs, units: Option<usize>) -> Vec<Step> {
    let units = units.map_or(String::new(), |units| format!("{units} units, "));
    let start = match &options.start {
        None => "of the loads just before t = 0".to_owned(),
        Some(Start::Zero) => "--from zero: no displacement, no velocity".to_owned(),
        Some(Start::File(path)) => format!("--from: the last row of {}", path.display()),
    };
    let pictures = outputs.figures;
    vec![
        Step::new("equilibrium to start from", options.start.is_none(), start),
        Step::new("run", true, format!("{units}{} rows, rtol {:e}", options.rows(), options.rtol)),
        Step::new(
            "loads in the table",
            options.with_loads,
            if options.with_loads { "--with-loads" } else { "without --with-loads" }.to_owned(),
        ),
        Step::figures(pictures, "the response over time"),
    ]
}

/// Runs the job; every result is in its place when it returns.
///
/// # Errors
/// [`HemodynamicsError`] where there are no results; a vessel that closes is one, unless the part before it is to be
/// kept.
pub fn simulate(
    inputs: &SimulateInputs,
    options: &SimulateOptions,
    outputs: &Outputs,
    watch: &Watch<'_>,
) -> Result<SimulateReport, HemodynamicsError> {
    let stages = Stages::default();
    TableFormat::of(&outputs.out)?;
    let report_at = outputs.report.then(|| beside(&outputs.out, ".run.json"));
    let from = if let Some(Start::File(path)) = &options.start { Some(path) } else { None };
    let mut places = Places::not_over([inputs.params.as_ref(), inputs.loads.as_ref(), from].into_iter().flatten());
    places.check([Some(&outputs.out), report_at.as_ref()].into_iter().flatten())?;
    let Ready { parameters, loads } = stages.time("read", || ready(inputs, options))?;
    let model = &options.model;
    let optics = model.optics.optics(&parameters)?;
    let settings = RunSettings { collapse: model.collapse, rtol: options.rtol, optics, from_s: 0.0 };
    let start =
        stages.time("start", || start_state(options.start.as_ref(), &parameters, &loads.loads, model.collapse))?;
    watch.go_on()?;
    let times_s = options.times_s();
    let solved = stages.time("run", || respond(&parameters, &loads.loads, &start, &times_s, &settings))?;
    let Run { response, work, collapsed } = solved;
    let mut failed = Vec::new();
    if let Some(collapsed) = &collapsed {
        let what = collapsed.words();
        if !options.keep_partial {
            return Err(HemodynamicsError::Model(format!(
                "{what}; the thesis' model ends there and nothing was written: --collapse contact lets the walls \
                 touch, --keep-partial writes the rows before it"
            )));
        }
        failed.push(format!("{what}; the table ends before it"));
    }
    watch.go_on()?;
    let shown = options.with_loads.then_some(&loads.loads);
    let at = places.place(&outputs.out)?;
    stages.time("table", || table::write(&parameters, &response, shown, &at, &outputs.out))?;
    let mut pictures = Vec::new();
    if outputs.figures {
        pictures.push(places.draw(&outputs.out, PICTURE, |png, svg| {
            stages.time("figures", || draw_response(&parameters, &loads.loads, &response, png, svg))
        })?);
    }
    watch.go_on()?;
    let left_out = left_out(steps(options, outputs, Some(parameters.units().len())));
    let figures = SimulateFigures {
        table: outputs.out.clone(),
        rows: response.rows() as u64,
        last_s: response.times_s.last().copied(),
        units: parameters.units().len(),
        loads: LoadsReport::of(&loads.loads, inputs.loads.clone()),
        parameters_file: inputs.params.clone(),
        from: match &options.start {
            None => "equilibrium".to_owned(),
            Some(Start::Zero) => "zero".to_owned(),
            Some(Start::File(path)) => path.display().to_string(),
        },
        optics: model.optics,
        collapse: model.collapse.word(),
        until_s: options.until_s,
        every_s: options.every_s,
        rtol: options.rtol,
        stopped: collapsed.as_ref().map_or("the last row was reached".to_owned(), Collapsed::words),
        collapsed,
        work,
        parameters: named(&parameters),
    };
    let mut report = Report { left_out, failed, pictures, ..Report::new("simulate", watch, figures) };
    remarks(&mut report, inputs, options, &loads);
    report.warnings.extend(wide(&response));
    Ok(report.timed(&stages).commit(places, report_at.as_deref())?)
}

/// Fewer rows a period don't show what repeats.
const ROWS_A_PERIOD: f64 = 5.0;

/// What to say of a load that rows so far apart don't show.
fn too_few_rows(of: &str, load: &Load, every_s: f64) -> Option<String> {
    if let Some(hz) = load.frequency_hz().map(f64::abs).filter(|hz| hz * every_s * ROWS_A_PERIOD > 1.0) {
        return Some(format!(
            "{of}: repeats every {:.4} s, and rows are {every_s} s apart, too few to show it; choose a smaller --every",
            hz.recip()
        ));
    }
    let [.., before_s, after_s] = *load.breakpoints() else { return None };
    let is_between = (before_s / every_s).ceil() * every_s >= after_s;
    let comes_back = load.before(before_s) == load.at(after_s) && load.at(before_s) != load.at(after_s);
    (is_between && comes_back).then(|| {
        format!("{of}: begins and ends between two rows, which are {every_s} s apart; choose a smaller --every")
    })
}

/// What a person has to know of the loads, and what was chosen.
fn remarks(report: &mut SimulateReport, inputs: &SimulateInputs, options: &SimulateOptions, loads: &ReadLoads) {
    report.warnings.clone_from(&loads.warnings);
    report.notes.clone_from(&loads.notes);
    let LoadOptions { pf1, pf2, blood } = &options.loads;
    if pf1.is_none() && pf2.is_none() && inputs.loads.is_none() {
        report.warnings.push("nothing presses: give --pf1, --pf2 or --loads".to_owned());
    }
    let (last_s, until_s) = (options.last_s(), options.until_s);
    if last_s < until_s * (1.0 - 1e-9) {
        report.notes.push(format!(
            "--until {until_s} is not a multiple of --every {}: the last row is at {last_s} s",
            options.every_s
        ));
    }
    for (option, load) in [("--pf1", pf1), ("--pf2", pf2), ("--ph", &blood.ph), ("--pl", &blood.pl)] {
        let Some(load) = load else { continue };
        report.warnings.extend(too_few_rows(&format!("{option} {load}"), load, options.every_s));
        if let (Some(&first), Some(&last)) = (load.breakpoints().first(), load.breakpoints().last()) {
            report.warnings.extend(constant(&format!("{option} {load}"), [first, last], until_s));
        }
    }
    for (option, load) in [("--ph", &blood.ph), ("--pl", &blood.pl)] {
        let Some((load, hz)) = load.as_ref().and_then(|load| Some((load, load.frequency_hz()?))) else { continue };
        if hz.abs() > FAST_HZ {
            report.warnings.push(format!(
                "{option} {load}: repeats {hz} times a second, and no heart beats so fast: are these beats a minute? \
                 They are @{:.3}",
                hz / 60.0
            ));
        }
    }
    if let (Some(known_s), Some(path)) = (loads.known_s, &inputs.loads) {
        let (path, [_, last]) = (path.display(), known_s);
        if let Some(said) = constant(&path.to_string(), known_s, until_s) {
            report.warnings.push(said);
        } else if last > until_s {
            report
                .notes
                .push(format!("{path}: goes on to {last} s, the run ends at {until_s} s; --until {last} takes it all"));
        }
        let ends_pa = [&loads.loads.proximal, &loads.loads.distal].map(|load| load.at(last));
        if last < until_s && ends_pa != [0.0; 2] {
            report.notes.push(format!(
                "{path}: ends at {last} s with {} and {} Pa, which press on to the end of the run",
                ends_pa[0], ends_pa[1]
            ));
        }
    }
    for (name, load) in [("pf1", &loads.loads.proximal), ("pf2", &loads.loads.distal)] {
        if least_pa(load, &options.times_s()) < -ROUNDING_PA {
            let what = match &inputs.loads {
                Some(path) => format!("{}: {name}_Pa", path.display()),
                None => format!("--{name} {load}"),
            };
            report.notes.push(format!("{what} goes below 0: {SUCTION}"));
        }
    }
}

/// Blood's pressure repeats less often, 1/s (assumed: 300 beats a minute).
const FAST_HZ: f64 = 5.0;
/// A lumen of more nominal diameters is no vessel's (measured: 2.1 at most with the thesis' parameters, 8 with extreme
/// ones that may be, 11 and more where a parameter was in another unit).
const WIDE: f64 = 10.0;

/// What to say of vessels that grow beyond anything.
fn wide(response: &Response) -> Option<String> {
    let widest = response.lumens.iter().copied().fold(0.0, f64::max);
    (widest > WIDE).then(|| {
        format!(
            "a vessel opens to {widest:.0} times its nominal diameter: is a stiffness, an area or a pressure in \
             another unit? Stiffnesses are in N/m"
        )
    })
}

/// That a load is constant during a run until `until_s`, where it changes only before or after it.
fn constant(what: &str, [first, last]: [f64; 2], until_s: f64) -> Option<String> {
    // At the end of a run, a change comes too late; at 0, it is what the run begins with.
    let comes_after = first > until_s || (first == until_s && until_s > 0.0);
    (comes_after || last < 0.0).then(|| {
        format!(
            "{what}: has loads from {first} to {last} s, and the run goes from 0 to {until_s} s: the load is constant \
             all the time"
        )
    })
}

/// Pressures this little below 0 are rounding, Pa (assumed).
const ROUNDING_PA: f64 = 1e-6;

/// The least pressure of a load at these rows, at its breakpoints between them, and just before the first.
fn least_pa(load: &Load, times_s: &[f64]) -> f64 {
    let last_s = times_s.last().copied().unwrap_or(0.0);
    let corners = load.breakpoints().iter().filter(|at| (0.0..=last_s).contains(*at));
    let at_corners = corners.flat_map(|&at| [load.before(at), load.at(at)]);
    let at_rows = times_s.iter().map(|&at| load.at(at));
    at_rows.chain(at_corners).chain([load.before(0.0)]).fold(f64::INFINITY, f64::min)
}
