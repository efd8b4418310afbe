//! One row in, everything that follows out: recording, answer, switch, rows to readers.
//!
//! The order: the raw row into the recording, then the models, the switch, the row of answers to every reader. Nothing
//! is allocated for a row once lines have their length.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::PathBuf;

use lunula_live::pointer;
use lunula_live::switch::{Reading, Reason, Switch, SwitchEvent, Turn};
use lunula_live::wire::Row;
use lunula_predictor::Contact;

use super::columns::StreamColumns;
use super::pipe::Pipe;
use super::pointer::PointerOutput;
use super::recording::Recording;
use super::report::SwitchCounts;
use super::sensor::Sensor;
use crate::live::error::LiveError;
use crate::table::push_number;

/// What is done with rows.
pub(crate) struct Decide {
    columns: StreamColumns,
    pub(crate) recording: Option<Recording>,
    pub(crate) answers: Option<Answers>,
    line: String,
    pub(crate) rows: u64,
    /// The time of the first row and of the last, seconds.
    pub(crate) span_s: Option<[f64; 2]>,
}

/// What is made of lit rows.
pub(crate) struct Answers {
    pub(crate) sensor: Sensor,
    pub(crate) switch: Option<SwitchOutput>,
    pub(crate) pointer: Option<PointerOutput>,
    pub(crate) recording: Option<Recording>,
    pub(crate) readers: Vec<Pipe>,
    pub(crate) touch: u64,
    pub(crate) bending: u64,
    line: String,
}

/// A switch and where its events go.
pub(crate) struct SwitchOutput {
    switch: Switch,
    /// Where in an answer the value is, and its sign.
    column: usize,
    sign: f64,
    events: Option<(PathBuf, BufWriter<File>)>,
    /// Where a tracker's place is in a row.
    place: Option<[usize; 2]>,
    /// The switch under the press.
    name: Option<String>,
    presses: u64,
    releases: u64,
    let_go: u64,
}

impl Decide {
    /// Of a stream's columns.
    pub(crate) fn new(columns: StreamColumns, mut recording: Option<Recording>, answers: Option<Answers>) -> Self {
        let mut names = vec!["time_s".to_owned()];
        names.extend(columns.led.then(|| "led".to_owned()));
        names.extend(columns.values.iter().cloned());
        if let Some(recording) = &mut recording {
            recording.name(names);
        }
        Self { columns, recording, answers, line: String::with_capacity(512), rows: 0, span_s: None }
    }

    /// A row has come.
    ///
    /// # Errors
    /// A recording or events that can't be written.
    pub(crate) fn row(&mut self, row: &Row<'_>) -> Result<(), LiveError> {
        self.rows += 1;
        if row.time_s.is_finite() {
            self.span_s = Some([self.span_s.map_or(row.time_s, |span| span[0]), row.time_s]);
        }
        if let Some(recording) = &mut self.recording {
            self.line.clear();
            push_number(&mut self.line, row.time_s);
            if self.columns.led {
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
            self.line.push('\n');
            recording.push(&self.line)?;
        }
        match &mut self.answers {
            Some(answers) => answers.row(row),
            None => Ok(()),
        }
    }

    /// Whether the photodiodes of a row are whole numbers, one of them beyond `volts`.
    pub(crate) fn looks_like_counts(&self, row: &Row<'_>, volts: f64) -> bool {
        let mut values = self.columns.photodiodes().map(|k| row.values[k]).filter(|value| !value.is_nan());
        let mut high = false;
        values.all(|value| {
            high |= value.abs() > volts;
            value.fract() == 0.0
        }) && high
    }

    /// Time has passed without a row.
    ///
    /// # Errors
    /// Events that can't be written.
    pub(crate) fn advance(&mut self, now_s: f64) -> Result<(), LiveError> {
        let Some(answers) = &mut self.answers else { return Ok(()) };
        if let Some(output) = &mut answers.switch {
            let event = output.switch.advance(now_s);
            output.hear(event)?;
        }
        answers.pointer.as_mut().map_or(Ok(()), |output| output.advance(now_s))
    }

    /// The source is lost, or the session ends.
    ///
    /// # Errors
    /// Events that can't be written.
    pub(crate) fn lose(&mut self, ends: bool) -> Result<(), LiveError> {
        let last_s = self.span_s.map_or(f64::NAN, |span| span[1]);
        self.answers.as_mut().map_or(Ok(()), |answers| answers.lose(last_s, ends))
    }

    /// When a watchdog lets go, of the stream's clock.
    pub(crate) fn due_s(&self) -> Option<f64> {
        let answers = self.answers.as_ref()?;
        let switch = answers.switch.as_ref().and_then(|output| output.switch.due_s());
        let pointer = answers.pointer.as_ref().and_then(PointerOutput::due_s);
        [switch, pointer].into_iter().flatten().reduce(f64::min)
    }
}

impl Answers {
    /// The names of a row of answers.
    pub(crate) fn header(sensor: &Sensor, has_switch: bool) -> Vec<String> {
        let mut names = sensor.answering().header();
        names.extend(has_switch.then(|| "switch".to_owned()));
        names
    }

    /// With where its rows go; readers hear the names of the columns first.
    pub(crate) fn new(
        sensor: Sensor,
        switch: Option<SwitchOutput>,
        pointer: Option<PointerOutput>,
        mut recording: Option<Recording>,
        mut readers: Vec<Pipe>,
    ) -> Self {
        let header = Self::header(&sensor, switch.is_some());
        let line = header.join(",") + "\n";
        readers.iter_mut().for_each(|reader| reader.push(&line));
        if let Some(recording) = &mut recording {
            recording.name(header);
        }
        Self { sensor, switch, pointer, recording, readers, touch: 0, bending: 0, line: String::with_capacity(512) }
    }

    /// Another reader: it hears the names first.
    pub(crate) fn join(&mut self, mut reader: Pipe) {
        reader.push(&(Self::header(&self.sensor, self.switch.is_some()).join(",") + "\n"));
        self.readers.push(reader);
    }

    fn lose(&mut self, t_s: f64, ends: bool) -> Result<(), LiveError> {
        if let Some(output) = &mut self.switch {
            let event = output.switch.lose(t_s, if ends { Reason::End } else { Reason::Lost });
            output.hear(event)?;
        }
        let reason = if ends { pointer::Reason::End } else { pointer::Reason::Lost };
        self.pointer.as_mut().map_or(Ok(()), |output| output.lose(t_s, reason))
    }

    fn row(&mut self, row: &Row<'_>) -> Result<(), LiveError> {
        if row.begins {
            self.lose(row.time_s, false)?;
        }
        let Some(answer) = self.sensor.row(row) else { return Ok(()) };
        self.touch += u64::from(answer.contact == Some(Contact::Touch));
        self.bending += u64::from(answer.contact == Some(Contact::Bending));
        if let Some(output) = &mut self.switch {
            let value = output.sign * self.sensor.answer()[output.column];
            output.find_place(row);
            let event = output.switch.sample(row.time_s, Reading { value, outside: answer.outside });
            output.hear(event)?;
        }
        if let Some(output) = &mut self.pointer {
            output.sample(row.time_s, self.sensor.answer(), answer.contact)?;
        }
        self.line.clear();
        self.sensor.answering().push_row(&mut self.line, row.time_s, self.sensor.answer(), answer.contact);
        if let Some(output) = &self.switch {
            self.line.push_str(if output.switch.is_pressed() { ",1" } else { ",0" });
        }
        self.line.push('\n');
        for reader in &mut self.readers {
            reader.push(&self.line);
        }
        match &mut self.recording {
            Some(recording) => recording.push(&self.line),
            None => Ok(()),
        }
    }
}

impl SwitchOutput {
    /// A switch of these answers.
    ///
    /// # Errors
    /// A column that the models do not predict.
    pub(crate) fn new(
        switch: Switch,
        predicted: &[String],
        columns: &StreamColumns,
        events: Option<(PathBuf, BufWriter<File>)>,
    ) -> Result<Self, String> {
        let (name, sign) = match &switch.config().column {
            Some(column) => (column.as_str(), 1.0),
            None => ("Fz_N", -1.0),
        };
        let column = predicted.iter().position(|one| one == name).ok_or_else(|| {
            format!("the switch compares {name}, and the models predict {}; name a model of it", predicted.join(", "))
        })?;
        let place = columns.place("x_m").zip(columns.place("y_m")).map(|(x, y)| [x, y]);
        if place.is_none() && !switch.config().places.is_empty() {
            return Err("the switch has places, and the stream has no x_m and y_m of a tracker".to_owned());
        }
        Ok(Self { switch, column, sign, events, place, name: None, presses: 0, releases: 0, let_go: 0 })
    }

    /// What it did.
    pub(crate) fn counts(&self) -> SwitchCounts {
        SwitchCounts { presses: self.presses, releases: self.releases, let_go: self.let_go }
    }

    /// Which switch is under the finger: while nothing is pressed it changes, so that the place where a press begins
    /// decides.
    fn find_place(&mut self, row: &Row<'_>) {
        let Some([x, y]) = self.place.filter(|_| !self.switch.is_pressed()) else { return };
        let found = self.switch.config().at(row.values[x], row.values[y]);
        if self.name.as_deref() != found {
            self.name = found.map(str::to_owned);
        }
    }

    fn hear(&mut self, event: Option<SwitchEvent>) -> Result<(), LiveError> {
        let Some(event) = event else { return Ok(()) };
        match event.turn {
            Turn::Press => self.presses += 1,
            Turn::Release => {
                self.releases += 1;
                self.let_go += u64::from(!matches!(event.reason, Reason::Value | Reason::Outside));
            }
        }
        let Some((path, to)) = &mut self.events else { return Ok(()) };
        let config = self.switch.config();
        let name = self.name.as_deref().or(config.name.as_deref());
        let key = if config.column.is_some() { "value" } else { "force_N" };
        let written = event.write_json(to, key, config.finger.as_deref(), name).and_then(|()| to.flush());
        written.map_err(|why| LiveError::Write { path: path.clone(), why })
    }
}
