//! The trajectory job: options in, a table with its report and pictures out.

use std::path::{Path, PathBuf};

use super::check::faults;
use super::cone::cone_chart;
use super::motion::Motion;
use super::report::{ForceFigures, PostureFigures, TrajectoryFigures, TrajectoryReport};
use super::{Kind, TrajectoryOptions, figures};
use crate::figure::{Chart, draw_charts};
use crate::files::{Places, beside};
use crate::job::{Outputs, Report, Watch};
use crate::predictor::error::PredictorError;
use crate::stages::{Stages, Step, left_out};
use crate::table::{Column, TableFormat, TableWriter, Value};

/// Decimals of forces (a transducer's step is 0.0008 N) and of angles.
const FORCE_DECIMALS: usize = 6;
const ANGLE_DECIMALS: usize = 5;
/// Rows between two looks at whether to stop.
const AT_ONCE: usize = 1 << 20;

/// Plans a run; `outputs` may have no place yet.
///
/// # Errors
/// [`PredictorError::Request`].
pub fn plan(options: &TrajectoryOptions, outputs: &Outputs) -> Result<Vec<Step>, PredictorError> {
    let faults = faults(options);
    if !faults.is_empty() {
        return Err(PredictorError::Request(faults.join("; ")));
    }
    let force = options.is_force();
    let of_forces = |what: &str| if force { what.to_owned() } else { "only of forces".to_owned() };
    let columns = if force { "time_s, Fx_N, Fy_N, Fz_N" } else { "time_s, J2_deg" };
    let spiral = matches!(options.kind, Kind::Force { .. });
    let pictures = outputs.figures;
    Ok(vec![
        Step::new("table", true, format!("{} rows of {columns}", options.rows())),
        Step::new("rates", true, "how fast it is at most".to_owned()),
        Step::new("coverage of the cone of friction", force, of_forces("of its rows")),
        Step::new(
            "equations 24 to 26",
            spiral,
            if spiral { "as printed and with the true maximum" } else { "only of the spiral" }.to_owned(),
        ),
        Step::figures(pictures, "of its path, in its cone and over time"),
    ])
}

/// Runs the job; every result is in its place when it returns.
///
/// # Errors
/// [`PredictorError`] where there are no results.
pub fn run(
    options: &TrajectoryOptions,
    outputs: &Outputs,
    watch: &Watch<'_>,
) -> Result<TrajectoryReport, PredictorError> {
    let stages = Stages::default();
    let steps = plan(options, outputs)?;
    TableFormat::of(&outputs.out)?;
    let motion = Motion::new(options)?;
    let (force, posture) = stages.time("figures of merit", || match &motion {
        Motion::Force(motion) => (Some(ForceFigures::new(options, motion)), None),
        Motion::Posture { path, .. } => (None, Some(PostureFigures::new(options, path))),
    });
    watch.go_on()?;
    let mut places = Places::default();
    let rows = options.rows() as usize;
    stages.time("table", || write_table(options, &motion, rows, &outputs.out, &mut places, watch))?;
    let pictures = stages.time("pictures", || {
        if outputs.figures { draw(options, &motion, &outputs.out, &mut places) } else { Ok(Vec::new()) }
    })?;
    watch.go_on()?;
    let mut warnings = force.as_ref().map_or_else(Vec::new, |force| force.warnings(options));
    warnings.extend(between_rows(options, &motion, rows));
    let figures = TrajectoryFigures {
        trajectory: *options,
        table: outputs.out.clone(),
        rows: rows as u64,
        span_s: (rows - 1) as f64 * options.every_s,
        force,
        posture,
    };
    let left_out = left_out(steps);
    let report = Report { left_out, warnings, pictures, ..Report::new("trajectory", watch, figures) };
    let at = outputs.report.then(|| beside(&outputs.out, ".run.json"));
    Ok(report.timed(&stages).commit(places, at.as_deref())?)
}

/// Rows that are looked at for what they leave out.
const MOST_BETWEEN: usize = 20_000;
/// The share of a component's range that straight lines between rows may leave out (assumed: eight rows a turn leave
/// 0.04, four 0.15), but for the share of the rows in which a movement may begin at once.
const BETWEEN: f64 = 0.1;
const AT_ONCE_SHARE: f64 = 0.01;

/// What to say of rows between which the movement goes elsewhere.
fn between_rows(options: &TrajectoryOptions, motion: &Motion, rows: usize) -> Option<String> {
    let at = |rows: f64| motion.at(rows * options.every_s);
    let looked_at = (0..rows.saturating_sub(1)).step_by(rows.div_ceil(MOST_BETWEEN));
    let all: Vec<[[f64; 3]; 3]> = looked_at.map(|row| [0.0, 0.5, 1.0].map(|share| at(row as f64 + share))).collect();
    let worst = (0..3).filter_map(|k| {
        let values = || all.iter().flatten().map(|at| at[k]);
        let range = values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min);
        let mut left: Vec<f64> = all.iter().map(|[from, at, to]| (at[k] - (from[k] + to[k]) / 2.0).abs()).collect();
        left.sort_by(f64::total_cmp);
        let left = left.len().checked_sub(1 + (AT_ONCE_SHARE * left.len() as f64) as usize).map(|at| left[at])?;
        Some(if range > 0.0 { left / range } else { 0.0 })
    });
    let worst = worst.fold(0.0, f64::max);
    (worst > BETWEEN).then(|| {
        format!(
            "the rows are too far apart for this movement: between two of them it leaves the straight line by up to \
             {:.0} % of its range; choose a smaller --every than {} s, or lower rates",
            100.0 * worst,
            options.every_s
        )
    })
}

/// As many decimals as multiples of the step need; none where nine are not enough.
fn time_column(every_s: f64) -> Column {
    let whole = |decimals: &usize| {
        let steps = every_s * 10_f64.powi(*decimals as i32);
        steps >= 0.5 && (steps - steps.round()).abs() <= 1e-9 * steps
    };
    match (0..=9).find(whole) {
        Some(decimals) => Column::rounded("time_s", decimals),
        None => Column::number("time_s"),
    }
}

fn write_table(
    options: &TrajectoryOptions,
    motion: &Motion,
    rows: usize,
    path: &Path,
    places: &mut Places,
    watch: &Watch<'_>,
) -> Result<(), PredictorError> {
    let mut columns = vec![time_column(options.every_s)];
    match motion {
        Motion::Force(_) => columns.extend(["Fx_N", "Fy_N", "Fz_N"].map(|name| Column::rounded(name, FORCE_DECIMALS))),
        Motion::Posture { .. } => columns.push(Column::rounded("J2_deg", ANGLE_DECIMALS)),
    }
    let facts = [
        ("lunula", env!("CARGO_PKG_VERSION")),
        ("time_s", "seconds from the first row on"),
        ("forces", "newtons, of the finger on the surface: pressing down is negative Fz_N"),
        ("angles", "degrees, positive in flexion; J2 PIP"),
    ];
    let facts = facts.map(|(key, value)| (key.to_owned(), value.to_owned()));
    let at = places.place(path)?;
    let mut table = TableWriter::create(&at, path, columns, &facts)?;
    for from in (0..rows).step_by(AT_ONCE) {
        watch.go_on()?;
        table.write_rows(AT_ONCE.min(rows - from), &|row, write| {
            let time_s = (from + row) as f64 * options.every_s;
            let [first, second, third] = motion.at(time_s).map(Value::Number);
            match motion {
                Motion::Force(_) => write(&[Value::Number(time_s), first, second, third]),
                Motion::Posture { .. } => write(&[Value::Number(time_s), first]),
            }
        })?;
    }
    Ok(table.finish()?)
}

/// Draws the pictures beside the table; returns their places.
fn draw(
    options: &TrajectoryOptions,
    motion: &Motion,
    table: &Path,
    places: &mut Places,
) -> Result<Vec<PathBuf>, PredictorError> {
    let drawn = match motion {
        Motion::Force(motion) => vec![
            ("force", figures::force_charts(options, motion), figures::WIDTH),
            ("path", vec![figures::path_chart(options, motion)], figures::SPACE_WIDTH),
            ("cone", vec![cone_chart(options, motion)], figures::SPACE_WIDTH),
        ],
        Motion::Posture { path, .. } => {
            vec![("posture", vec![figures::posture_chart(options, path)], figures::WIDTH)]
        }
    };
    let place = |(kind, charts, width): (&str, Vec<Chart>, u32)| {
        Ok(places.draw(table, kind, |png, svg| draw_charts(&charts, width, png, svg))?)
    };
    drawn.into_iter().map(place).collect()
}
