//! The tables: `photodiodes`, `motion`, `cells`, `presses`.

use std::path::Path;

use super::super::affine::Affine;
use super::super::follow::{Lost, Place};
use super::super::press::{Row as PressRow, USE};
use super::super::sample::{Absent, Sampled, cell_name};
use crate::files::Staging;
use crate::nailvideo::error::NailVideoError;
use crate::nailvideo::options::{Light, Outputs};
use crate::photo::NailFrame;
use crate::table::{Column, TableWriter, Value};

const TIME_DECIMALS: usize = 6;
const PLACE_DECIMALS: usize = 4;

/// What a photodiode says in a frame.
pub(super) type Reading = Result<Sampled, Absent>;

/// A frame that is kept until all are read: its photodiodes' noise is known then.
#[derive(Debug)]
pub(super) struct Kept {
    pub(super) index: u64,
    pub(super) time_s: f64,
    /// Standard error of the nail's place, or why it is lost.
    pub(super) place: Result<f32, Lost>,
    pub(super) readings: Vec<Reading>,
    /// The skin's own colour.
    pub(super) skin: f64,
}

impl Kept {
    /// Of a frame without the nail.
    pub(super) fn lost(index: u64, time_s: f64, why: Lost) -> Self {
        Self { index, time_s, place: Err(why), readings: Vec::new(), skin: f64::NAN }
    }
}

fn decimals(light: Light) -> usize {
    if light == Light::None { 6 } else { 4 }
}

fn create(
    staging: &Staging,
    outputs: &Outputs,
    name: &str,
    columns: Vec<Column>,
    facts: &[(&str, String)],
) -> Result<TableWriter, NailVideoError> {
    let file = format!("{name}.{}", outputs.ending);
    let facts: Vec<(String, String)> = facts.iter().map(|(key, value)| ((*key).to_owned(), value.clone())).collect();
    let path: &Path = &outputs.table(name);
    Ok(TableWriter::create(&staging.place(&file)?, path, columns, &facts)?)
}

/// `motion.csv`: the nail's place in every frame.
#[derive(Debug)]
pub(super) struct MotionTable {
    pub(super) table: TableWriter,
    nail: NailFrame,
}

impl MotionTable {
    pub(super) fn create(staging: &Staging, outputs: &Outputs, nail: NailFrame) -> Result<Self, NailVideoError> {
        let place = |name: &str| Column::rounded(name, PLACE_DECIMALS);
        let mut columns = vec![Column::integer("frame"), Column::rounded("time_s", TIME_DECIMALS)];
        columns.extend(["center_x_px", "center_y_px", "length_px", "width_px", "axis_deg", "se_px"].map(place));
        columns.extend(["a", "b", "c", "d", "e", "f"].map(|name| Column::rounded(name, 7)));
        columns.extend([place("correlation"), place("inliers"), Column::text("status")]);
        let facts = [
            ("pixels", "the centre of the shown picture's top-left pixel is (0, 0), x right, y down".to_owned()),
            ("a..f", "(x, y) of the first good frame goes to (a x + b y + c, d x + e y + f)".to_owned()),
            ("axis_deg", "from proximal to distal, clockwise from up".to_owned()),
        ];
        Ok(Self { table: create(staging, outputs, "motion", columns, &facts)?, nail })
    }

    pub(super) fn add(&mut self, index: u64, time_s: f64, place: &Result<Place, Lost>) -> Result<(), NailVideoError> {
        let mut cells = vec![Value::Integer(index as i64), Value::Number(time_s)];
        match place {
            Ok(place) => {
                cells.extend(self.frame(&place.motion).map(Value::Number));
                cells.push(Value::Number(place.se_px));
                cells.extend(place.motion.0.map(Value::Number));
                cells.extend([Value::Number(place.ncc), Value::Number(place.inliers), Value::Text("ok")]);
            }
            Err(lost) => {
                cells.extend([Value::Missing; 14]);
                cells.push(Value::Text(lost.name()));
            }
        }
        Ok(self.table.write(&cells)?)
    }

    /// Centre, length, width and axis in a frame.
    fn frame(&self, motion: &Affine) -> [f64; 5] {
        let at = |across: f64, along: f64| motion.of(self.nail.photo_from_nail(across, along));
        let [x, y] = at(0.0, 0.0);
        let ([p, q], [r, s]) = (at(0.0, 0.5), at(0.0, -0.5));
        let ([t, u], [v, w]) = (at(0.5, 0.0), at(-0.5, 0.0));
        [x, y, (p - r).hypot(q - s), (t - v).hypot(u - w), (p - r).atan2(s - q).to_degrees()]
    }
}

/// `cells.csv`: the normalized nail in N x N averages.
#[derive(Debug)]
pub(super) struct CellTable {
    pub(super) table: TableWriter,
    /// The place of each cell among those that are read.
    read: Vec<Option<usize>>,
}

impl CellTable {
    pub(super) fn create(
        staging: &Staging,
        outputs: &Outputs,
        side: usize,
        read: Vec<Option<usize>>,
        light: Light,
    ) -> Result<Self, NailVideoError> {
        let mut columns = vec![Column::rounded("time_s", TIME_DECIMALS)];
        let names = (0..side * side).map(|k| cell_name(k / side, k % side));
        columns.extend(names.map(|name| Column::rounded(name, decimals(light))));
        let facts = [
            ("unit", light.unit().to_owned()),
            ("cells", format!("{side} x {side} of 125 % of the nail's box, row by row from the distal end")),
        ];
        Ok(Self { table: create(staging, outputs, "cells", columns, &facts)?, read })
    }

    /// A row; `readings` are those of the cells that are read.
    pub(super) fn add(&mut self, time_s: f64, readings: &[Reading]) -> Result<(), NailVideoError> {
        let value = |at: &Option<usize>| readings.get((*at)?)?.as_ref().ok().map(|one| one.value);
        let cells: Vec<Value<'_>> =
            std::iter::once(Value::Number(time_s)).chain(self.read.iter().map(|at| Value::from(value(at)))).collect();
        Ok(self.table.write(&cells)?)
    }
}

/// Writes `photodiodes.csv`; `sd` gives the standard error of a photodiode's reading in a row.
pub(super) fn photodiodes(
    staging: &Staging,
    outputs: &Outputs,
    names: &[String],
    light: Light,
    kept: &[Kept],
    sd: impl Fn(usize, usize, &Sampled, f32) -> Option<f64>,
) -> Result<(), NailVideoError> {
    let value = |name: String| Column::rounded(name, decimals(light));
    let mut columns = vec![Column::integer("frame"), Column::rounded("time_s", TIME_DECIMALS)];
    columns.extend(names.iter().map(|name| value(name.clone())));
    columns.extend(names.iter().map(|name| value(format!("{name}_sd"))));
    columns.push(Column::text("status"));
    columns.extend(names.iter().map(|name| Column::text(format!("{name}_status"))));
    let facts = [
        ("unit", light.unit().to_owned()),
        ("time_s", "presentation time from the first frame's, seconds".to_owned()),
        ("sd", "standard error of one sample".to_owned()),
    ];
    let mut table = create(staging, outputs, "photodiodes", columns, &facts)?;
    for (at, row) in kept.iter().enumerate() {
        let reading = |k: usize| row.place.ok().and_then(|se| Some((row.readings.get(k)?.as_ref().ok()?, se)));
        let mut cells = vec![Value::Integer(row.index as i64), Value::Number(row.time_s)];
        cells.extend((0..names.len()).map(|k| Value::from(reading(k).map(|(one, _)| one.value))));
        cells.extend((0..names.len()).map(|k| Value::from(reading(k).and_then(|(one, se)| sd(k, at, one, se)))));
        cells.push(Value::Text(row.place.as_ref().map_or_else(|lost| lost.name(), |_| "ok")));
        cells.extend((0..names.len()).map(|k| match (&row.place, row.readings.get(k)) {
            (Err(_), _) | (Ok(_), None) => Value::Text("lost"),
            (Ok(_), Some(Err(absent))) => Value::Text(absent.name()),
            (Ok(_), Some(Ok(_))) => Value::Text("ok"),
        }));
        table.write(&cells)?;
    }
    Ok(table.finish()?)
}

/// Writes `presses.csv`.
pub(super) fn presses(
    staging: &Staging,
    outputs: &Outputs,
    light: Light,
    rows: &[PressRow],
) -> Result<(), NailVideoError> {
    let time = |name: &str| Column::rounded(name, 4);
    let mut columns = vec![Column::integer("press"), Column::text("event"), Column::text("place")];
    for name in ["onset", "t50", "t90", "tau"] {
        columns.extend([time(&format!("{name}_s")), time(&format!("{name}_low_s")), time(&format!("{name}_high_s"))]);
    }
    let value = |name: &str| Column::rounded(name, decimals(light));
    columns.extend([time("pressed_s"), value("depth"), value("noise_sd"), time("snr")]);
    columns.extend(["model", "status", "use"].map(Column::text));
    let facts = [
        ("use", USE.to_owned()),
        ("low, high", "95 % interval: noise with its correlation, end level, model".to_owned()),
        ("t50, t90", "from the onset; tau: the time constant, of two exponentials the faster's".to_owned()),
        ("depth", format!("the step, as much as is seen of it: {}", light.unit())),
    ];
    let mut table = create(staging, outputs, "presses", columns, &facts)?;
    for row in rows {
        let status = row.status();
        let mut cells = vec![Value::Integer(row.press as i64), Value::Text(row.event.name()), Value::Text(&row.place)];
        for time in row.times_s() {
            cells.extend((0..3).map(|k| Value::from(time.map(|ends| ends[k]))));
        }
        let snr = row.depth().zip(row.noise_sd).map(|(depth, sd)| depth.abs() / sd);
        cells.extend([row.pressed_s, row.depth(), row.noise_sd, snr].map(Value::from));
        cells.extend([row.model().map_or(Value::Missing, Value::Text), Value::Text(&status), Value::Text(USE)]);
        table.write(&cells)?;
    }
    Ok(table.finish()?)
}
