//! One row of a finger in, everything that follows out: recording, answer, switch, pointer, row of answers.
//!
//! The order: the raw row into the recording, then the models, the switch, the row of answers to every reader. Nothing
//! is allocated for a row once lines have their length.

use lunula_live::pointer;
use lunula_live::switch::{Reason, Switch};
use lunula_live::wire::Row;
use lunula_predictor::Contact;

use super::columns::StreamColumns;
use super::outputs::pointer::PointerOutput;
use super::outputs::recording::Recording;
use super::outputs::samples::Samples;
use super::outputs::switch::SwitchOutput;
use super::outputs::{AnswerRow, Outputs};
use super::sensor::Sensor;
use crate::live::error::LiveError;
use crate::live::options::MouseFiles;
use crate::live::view::{Seen, View};
use crate::log::{LogReading, PRECEDING_RULE};
use crate::predictor::Answering;

/// Whole numbers beyond this are no volts (assumed: no photodiode's amplifier reaches it).
const COUNT_V: f64 = 30.0;

/// What to say of them.
pub(super) const COUNTS: &str = "the photodiodes are whole numbers beyond 30: they look like a converter's counts, and \
                                 models read volts; say what a step is, as --volts-per-count 10/65536";

/// A finger, before the columns of its stream are known.
#[derive(Default)]
pub(super) struct Plan {
    /// Its name and its place, where there are several.
    pub(super) finger: Option<(String, usize)>,
    pub(super) recording: Option<Recording>,
    pub(super) answering: Option<Answering>,
    pub(super) keep_faults: bool,
    pub(super) switch: Option<Switch>,
    pub(super) mouse: Option<(pointer::Config, MouseFiles)>,
    /// Whether a second device gives forces.
    pub(super) joins_forces: bool,
}

/// What is done with a finger's rows.
pub(super) struct Decide {
    finger: Option<(String, usize)>,
    pub(super) columns: StreamColumns,
    pub(super) samples: Option<Samples>,
    pub(super) answers: Option<Answers>,
    pub(super) rows: u64,
    /// Whether the photodiodes look like a converter's counts, which models read as volts.
    pub(super) are_counts: bool,
    /// The time of the first row and of the last, of the stream's clock, seconds.
    pub(super) span_s: Option<[f64; 2]>,
    /// The recorded clock less the stream's, seconds.
    ahead_s: f64,
    /// Photodiodes of the row that a page sees, where no model asks for them.
    volts: Vec<f64>,
}

/// Whether a row is recorded.
#[derive(Debug, Clone, Copy)]
pub(super) enum Kept<'a> {
    /// Where there is a recording.
    Usual,
    /// At a time, with further cells.
    At(f64, &'a str),
    Not,
}

/// What is made of lit rows.
pub(super) struct Answers {
    pub(super) sensor: Sensor,
    pub(super) switch: Option<SwitchOutput>,
    pub(super) pointer: Option<PointerOutput>,
    pub(super) touch: u64,
    pub(super) bending: u64,
    text: String,
}

impl Decide {
    /// Of a stream's columns; notes go to `notes`.
    ///
    /// # Errors
    /// Columns that the models or the switch lack.
    pub(super) fn new(
        plan: Plan,
        columns: StreamColumns,
        log: &LogReading,
        notes: &mut Vec<String>,
    ) -> Result<Self, LiveError> {
        let Plan { finger, recording, answering, keep_faults, switch, mouse, joins_forces } = plan;
        notes.extend(columns.notes.iter().cloned());
        if recording.is_some() && !columns.passed_over.is_empty() {
            let others = columns.passed_over.join(", ");
            notes.push(format!("columns that are not recorded: {others}; --keep NAME keeps one of numbers"));
        }
        let answers = match answering {
            None => None,
            Some(answering) => {
                notes.extend(columns.led.then(|| PRECEDING_RULE.to_owned()));
                let predicts = answering.columns().to_vec();
                let sensor = Sensor::new(answering, &columns, log, keep_faults).map_err(LiveError::Request)?;
                let name = finger.as_ref().map(|(name, _)| name.clone());
                let switch = switch.map(|switch| SwitchOutput::new(switch, name, &predicts, &columns)).transpose()?;
                let pointer = mouse.map(|(config, files)| PointerOutput::new(config, &files, &predicts)).transpose()?;
                Some(Answers { sensor, switch, pointer, touch: 0, bending: 0, text: String::with_capacity(512) })
            }
        };
        let samples = recording.map(|recording| Samples::new(recording, &columns, joins_forces));
        let (rows, span_s, are_counts) = (0, None, false);
        Ok(Self { finger, columns, samples, answers, rows, are_counts, span_s, ahead_s: 0.0, volts: Vec::new() })
    }

    /// A row has come, at `common_s` of the clock that all sources are on.
    ///
    /// # Errors
    /// Photodiodes that are counts; a recording or events that can't be written.
    pub(super) fn row(
        &mut self,
        row: &Row<'_>,
        common_s: f64,
        kept: Kept<'_>,
        outputs: &mut Outputs,
    ) -> Result<(), LiveError> {
        if self.rows == 0 && self.looks_like_counts(row) {
            match &self.answers {
                None => self.are_counts = true,
                // Models that were trained on counts.
                Some(answers) if answers.sensor.answering.greatest_input() > COUNT_V => {}
                Some(_) => return Err(LiveError::Request(COUNTS.to_owned())),
            }
        }
        self.rows += 1;
        if row.time_s.is_finite() {
            self.span_s = Some([self.span_s.map_or(row.time_s, |span| span[0]), row.time_s]);
        }
        // Of one finger the sensor's own clock is kept, of several the one that they share.
        let time_s = if self.finger.is_some() { common_s } else { row.time_s };
        if time_s.is_finite() && row.time_s.is_finite() {
            self.ahead_s = time_s - row.time_s;
        }
        if let Some(samples) = &mut self.samples {
            match kept {
                Kept::Usual => samples.row(row, time_s, common_s, "")?,
                Kept::At(time_s, cells) => samples.row(row, time_s, common_s, cells)?,
                Kept::Not => {}
            }
        }
        let finger = self.finger.as_ref().map(|(name, place)| (name.as_str(), *place));
        match &mut self.answers {
            Some(answers) => answers.row(row, time_s, self.ahead_s, finger, outputs),
            None => {
                // Lit and unlit ones in turn would be no trace.
                if let Some(view) = outputs.view.as_mut().filter(|_| row.lit != Some(false)) {
                    self.volts.clear();
                    self.volts.extend(self.columns.photodiodes().map(|k| row.values[k]));
                    let seen = Seen { time_s, volts: &self.volts, answers: &[], contact: None, pressed: None };
                    view.sample(self.place().1, &seen);
                }
                Ok(())
            }
        }
    }

    /// The finger's name, and which it is.
    fn place(&self) -> (Option<&str>, usize) {
        self.finger.as_ref().map_or((None, 0), |(name, place)| (Some(name.as_str()), *place))
    }

    /// Tells a page what there is to show.
    pub(super) fn show(&self, view: &mut View) {
        let (name, place) = self.place();
        let Some(answers) = &self.answers else {
            let names: Vec<String> = self.columns.photodiodes().map(|k| self.columns.values[k].clone()).collect();
            return view.finger(place, name, [&names, &[]], false);
        };
        let answering = &answers.sensor.answering;
        view.finger(place, name, [answering.inputs(), answering.columns()], answers.switch.is_some());
    }

    /// Whether the photodiodes of a row are whole numbers, one of them beyond what volts are.
    fn looks_like_counts(&self, row: &Row<'_>) -> bool {
        let mut values = self.columns.photodiodes().map(|k| row.values[k]).filter(|value| !value.is_nan());
        let mut high = false;
        values.all(|value| {
            high |= value.abs() > COUNT_V;
            value.fract() == 0.0
        }) && high
    }

    /// It is `now_s` of the stream's clock, and no row has come.
    pub(super) fn advance(&mut self, now_s: f64, outputs: &mut Outputs) -> Result<(), LiveError> {
        let Some(answers) = &mut self.answers else { return Ok(()) };
        if let Some(switch) = &mut answers.switch {
            switch.advance(now_s, self.ahead_s, outputs.events.as_mut())?;
        }
        answers.pointer.as_mut().map_or(Ok(()), |pointer| pointer.advance(now_s))
    }

    /// The source is lost, or the session ends.
    pub(super) fn lose(&mut self, ends: bool, outputs: &mut Outputs) -> Result<(), LiveError> {
        let last_s = self.span_s.map_or(f64::NAN, |span| span[1]);
        let ahead_s = self.ahead_s;
        self.answers.as_mut().map_or(Ok(()), |answers| answers.lose(last_s, ends, ahead_s, outputs))
    }

    /// When a watchdog lets go, of the stream's clock.
    pub(super) fn due_s(&self) -> Option<f64> {
        let answers = self.answers.as_ref()?;
        let switch = answers.switch.as_ref().and_then(SwitchOutput::due_s);
        let pointer = answers.pointer.as_ref().and_then(PointerOutput::due_s);
        [switch, pointer].into_iter().flatten().reduce(f64::min)
    }
}

impl Answers {
    fn lose(&mut self, t_s: f64, ends: bool, ahead_s: f64, outputs: &mut Outputs) -> Result<(), LiveError> {
        if let Some(switch) = &mut self.switch {
            let reason = if ends { Reason::End } else { Reason::Lost };
            switch.lose(t_s, reason, ahead_s, outputs.events.as_mut())?;
        }
        let reason = if ends { pointer::Reason::End } else { pointer::Reason::Lost };
        self.pointer.as_mut().map_or(Ok(()), |pointer| pointer.lose(t_s, reason))
    }

    fn row(
        &mut self,
        row: &Row<'_>,
        time_s: f64,
        ahead_s: f64,
        finger: Option<(&str, usize)>,
        outputs: &mut Outputs,
    ) -> Result<(), LiveError> {
        if row.begins {
            self.lose(row.time_s, false, ahead_s, outputs)?;
        }
        let Some(answer) = self.sensor.row(row) else { return Ok(()) };
        self.touch += u64::from(answer.contact == Some(Contact::Touch));
        self.bending += u64::from(answer.contact == Some(Contact::Bending));
        let values = &self.sensor.answer;
        if let Some(switch) = &mut self.switch {
            switch.sample(row, values, answer.outside, ahead_s, outputs.events.as_mut())?;
        }
        if let Some(pointer) = &mut self.pointer {
            pointer.sample(row.time_s, values, answer)?;
        }
        self.text.clear();
        self.sensor.answering.push_row(&mut self.text, time_s, values, answer.contact);
        let pressed = self.switch.as_ref().map(SwitchOutput::is_pressed);
        let seen = Seen { time_s, volts: &self.sensor.volts, answers: values, contact: answer.contact, pressed };
        outputs.row(&AnswerRow { text: &self.text, finger, seen })
    }
}
