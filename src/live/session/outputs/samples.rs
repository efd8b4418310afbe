//! A finger's samples as they are recorded: its own columns, and the forces of a second device at each sample's time.
//!
//! In: rows of the wire, and forces on the common clock. Out: rows of a [`Recording`]. With a second device a row waits
//! until the force behind it is known, a second at most; where it is not known its cells are empty.

use std::collections::VecDeque;
use std::{array, mem};

use lunula_live::companion::{Companion, Known};
use lunula_live::wire::Row;
use lunula_predictor::FORCES;

use super::recording::Recording;
use crate::live::error::LiveError;
use crate::live::session::columns::{StreamColumns, is_photodiode};
use crate::log::doubts;
use crate::table::push_number;

/// A row waits so long for the force behind it, seconds (*assumed*: chunks of a slow bridge or network are shorter),
/// and so long for a device that has not named its columns yet.
const PATIENCE_S: f64 = 1.0;
const NAMES_S: f64 = 10.0;

/// The samples of a finger.
pub(crate) struct Samples {
    recording: Recording,
    led: bool,
    names: Vec<String>,
    line: String,
    /// Columns of further cells, behind all others.
    more: Vec<String>,
    forces: Option<Forces>,
    heard: Heard,
}

/// The forces of rows that were recorded: for whoever looks on, and so many of them at most to be doubted in the end.
#[derive(Default)]
struct Heard {
    /// Where Fx, Fy, Fz are among the values that have them.
    places: [Option<usize>; 3],
    is_attended: bool,
    rows: Vec<[f64; 3]>,
    some: Vec<[f64; 3]>,
    /// One in two to the power of this was kept.
    halved: u32,
    count: u64,
}

const MOST_DOUBTED: usize = 1 << 15;

impl Heard {
    fn look(&mut self, names: &[String]) {
        self.places = FORCES.map(|force| names.iter().position(|name| name == force));
    }

    fn push(&mut self, values: &[f64]) {
        let force = |place: Option<usize>| place.and_then(|at| values.get(at).copied()).unwrap_or(f64::NAN);
        let force_n = self.places.map(force);
        if self.is_attended {
            self.rows.push(if self.places.contains(&None) { [f64::NAN; 3] } else { force_n });
        }
        if self.some.len() == MOST_DOUBTED {
            self.some = mem::take(&mut self.some).into_iter().step_by(2).collect();
            self.halved += 1;
        }
        if self.count.is_multiple_of(1 << self.halved) {
            self.some.push(force_n);
        }
        self.count += 1;
    }
}

/// The forces of a second device.
#[derive(Default)]
struct Forces {
    /// None until the device has named its columns.
    companion: Option<Companion>,
    values: Vec<f64>,
    /// Rows that wait, and lines whose memory is used again.
    waiting: VecDeque<Waiting>,
    spare: Vec<String>,
    without: u64,
}

/// A row that waits for its force.
struct Waiting {
    common_s: f64,
    line: String,
    /// Further cells.
    cells: String,
}

impl Samples {
    /// Of these columns; `joins_forces` where a second device gives some too.
    pub(crate) fn new(mut recording: Recording, columns: &StreamColumns, joins_forces: bool) -> Self {
        let mut names = vec!["time_s".to_owned()];
        names.extend(columns.led.then(|| "led".to_owned()));
        names.extend(columns.values.iter().cloned());
        recording.name(names.clone());
        let forces = joins_forces.then(Forces::default);
        let line = String::with_capacity(512);
        let mut heard = Heard::default();
        heard.look(&columns.values);
        Self { recording, led: columns.led, names, line, more: Vec::new(), forces, heard }
    }

    /// Columns of further cells, and somebody who hears the forces of recorded rows.
    pub(crate) fn attended(&mut self, columns: &[&str]) {
        self.more = columns.iter().map(|column| (*column).to_owned()).collect();
        self.heard.is_attended = true;
        self.name(&[]);
    }

    fn name(&mut self, forces: &[String]) {
        self.recording.name(self.names.iter().chain(forces).chain(&self.more).cloned().collect());
    }

    /// Whether a second device gives forces.
    pub(crate) fn joins_forces(&self) -> bool {
        self.forces.is_some()
    }

    /// The forces of rows that were recorded since it was asked last.
    pub(crate) fn heard(&mut self) -> std::vec::Drain<'_, [f64; 3]> {
        self.heard.rows.drain(..)
    }

    /// What to say of the forces that were recorded.
    pub(crate) fn doubts(&self) -> Vec<String> {
        let forces: [Vec<f64>; 3] = array::from_fn(|k| self.heard.some.iter().map(|force_n| force_n[k]).collect());
        doubts::forces(FORCES.into_iter().zip(forces.iter().map(Vec::as_slice)))
    }

    /// The second device gives these columns.
    ///
    /// # Errors
    /// A column that the sensor gives itself, or that no transducer has, in words.
    pub(crate) fn join(&mut self, names: &[String]) -> Result<(), String> {
        if let Some(twice) = names.iter().find(|name| self.names.contains(name)) {
            return Err(format!("column `{twice}` comes from the sensor too; leave out --force, or rename one"));
        }
        if let Some(name) = names.iter().find(|name| is_photodiode(name) || *name == "led") {
            return Err(format!(
                "column `{name}` of --force is a sensor's: were --source and --force exchanged? What --force gives is \
                 interpolated, over lit and unlit rows alike"
            ));
        }
        self.name(names);
        self.heard.look(names);
        if let Some(forces) = &mut self.forces {
            forces.companion = Some(Companion::new(names.len()));
            forces.values = vec![f64::NAN; names.len()];
        }
        Ok(())
    }

    /// A row, recorded at `time_s`; at `common_s` of the clock that both devices are on. Further cells are each behind
    /// a comma.
    pub(crate) fn row(&mut self, row: &Row<'_>, time_s: f64, common_s: f64, cells: &str) -> Result<(), LiveError> {
        self.line.clear();
        push_number(&mut self.line, time_s);
        if self.led {
            self.line.push_str(match row.lit {
                Some(true) => ",1",
                Some(false) => ",0",
                None => ",",
            });
        }
        for value in row.values {
            self.line.push(',');
            push_number(&mut self.line, *value);
        }
        let Some(forces) = &mut self.forces else {
            self.line.push_str(cells);
            self.line.push('\n');
            self.heard.push(row.values);
            return self.recording.push(&self.line);
        };
        let mut line = forces.spare.pop().unwrap_or_default();
        mem::swap(&mut line, &mut self.line);
        forces.waiting.push_back(Waiting { common_s, line, cells: cells.to_owned() });
        self.settle(common_s)
    }

    /// A sample of the second device, at `common_s`.
    pub(crate) fn force(&mut self, common_s: f64, values: &[f64], begins: bool) -> Result<(), LiveError> {
        let Some(forces) = &mut self.forces else { return Ok(()) };
        if let Some(companion) = &mut forces.companion {
            companion.push(common_s, values, begins);
        }
        self.settle(f64::NAN)
    }

    /// Records what waits and is known, or has waited long enough at `now_s` of the common clock.
    pub(crate) fn settle(&mut self, now_s: f64) -> Result<(), LiveError> {
        let Some(forces) = &mut self.forces else { return Ok(()) };
        while let Some(Waiting { common_s, line, cells }) = forces.waiting.front_mut() {
            let waited_s = now_s - *common_s;
            let Some(companion) = &mut forces.companion else {
                let what = "the source of --force has not named its columns for 10 s; look whether it sends";
                let late = waited_s > NAMES_S;
                return if late { Err(LiveError::Request(what.to_owned())) } else { Ok(()) };
            };
            let known = companion.at(*common_s, &mut forces.values);
            if known == Known::NotYet && (waited_s.is_nan() || waited_s <= PATIENCE_S) {
                return Ok(());
            }
            forces.without += u64::from(forces.values.iter().any(|value| value.is_nan()));
            for value in &forces.values {
                line.push(',');
                push_number(line, *value);
            }
            line.push_str(cells);
            line.push('\n');
            self.heard.push(&forces.values);
            self.recording.push(line)?;
            if let Some(Waiting { mut line, .. }) = forces.waiting.pop_front() {
                line.clear();
                forces.spare.push(line);
            }
        }
        Ok(())
    }

    /// Whether a row is recorded, or will be when its force is known.
    pub(crate) fn is_recorded(&self) -> bool {
        self.recording.is_begun() || self.is_waiting()
    }

    /// Whether a row waits for a force.
    pub(crate) fn is_waiting(&self) -> bool {
        self.forces.as_ref().is_some_and(|forces| !forces.waiting.is_empty())
    }

    /// The second device gives nothing more.
    pub(crate) fn end_forces(&mut self) -> Result<(), LiveError> {
        if let Some(forces) = &mut self.forces {
            // A device that never named columns gives none.
            forces.companion.get_or_insert_with(|| Companion::new(0)).end();
        }
        self.settle(f64::NAN)
    }

    /// Rows of which a force is not known; none without a second device.
    pub(crate) fn without_force(&self) -> Option<u64> {
        self.forces.as_ref().map(|forces| forces.without)
    }

    /// Ends the file that grows.
    ///
    /// # Errors
    /// What could not be written; the rows before it stay.
    pub(crate) fn close(&mut self) -> Result<(), LiveError> {
        self.end_forces()?;
        self.recording.close()
    }

    /// Rows that the file lacks, as the disk was too slow or full; once it is closed.
    pub(crate) fn lost(&self) -> u64 {
        self.recording.lost
    }

    /// Ends it: all rows are on disk.
    ///
    /// # Errors
    /// What could not be written; what was written before stays.
    pub(crate) fn finish(self) -> Result<bool, LiveError> {
        self.recording.finish()
    }
}
