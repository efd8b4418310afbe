//! One sensor's way from a row of the wire to an answer: ambient light, lags, models, gate.
//!
//! The same code that answers a recording answers here, row by row, so that a recording's answers are a stream's to the
//! bit: of a log with an LED, under the rule `preceding` ([`AmbientRule`](crate::log::AmbientRule)). Nothing is
//! allocated for a row.

use lunula_live::wire::Row;
use lunula_predictor::Contact;

use super::columns::StreamColumns;
use crate::log::{AmbientError, LogReading, Preceding, Standing, Statuses, Verdict};
use crate::predictor::Answering;

/// A sensor and its models.
#[derive(Debug)]
pub(crate) struct Sensor {
    /// Its models.
    pub(crate) answering: Answering,
    preceding: Option<Preceding>,
    /// Where each photodiode is in a row.
    places: Vec<usize>,
    /// What `sensor_status` says, and where it is.
    statuses: Option<(usize, Statuses)>,
    /// Where the texts are that say which recording it is, and the last row's.
    groups: Vec<(usize, Vec<u8>)>,
    last_s: f64,
    /// Rows so far: their time where the stream has none.
    rows: f64,
    timed: bool,
    /// A recording has begun, and no lit row of it has come yet.
    begins: bool,
    keep_faults: bool,
    /// The voltages that were answered last, as [`Answering::inputs`]; NaN where not known.
    pub(crate) volts: Vec<f64>,
    /// The last answer, as [`Answering::columns`]; NaN where not known.
    pub(crate) answer: Vec<f64>,
    /// Whether its photodiodes stand still.
    standing: Standing,
    /// Which were just seen to, for who looks after the session.
    pub(crate) stops: Option<String>,
    /// Lit rows, unlit ones, and those that do not say.
    pub(crate) lit: u64,
    pub(crate) unlit: u64,
    pub(crate) unknown: u64,
    pub(crate) not_known: u64,
    /// Lit rows of which nothing is known.
    pub(crate) without: u64,
}

/// What was made of a lit row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Answer {
    /// What the gate says, where there is one.
    pub(crate) contact: Option<Contact>,
    /// Whether the voltages lie beyond those that a model was trained on.
    pub(crate) outside: bool,
    /// So far that nothing is to be done by the answer.
    pub(crate) is_far_outside: bool,
}

impl Sensor {
    /// Of a stream's columns.
    ///
    /// # Errors
    /// A photodiode that a model reads and the stream lacks, a time that lags need; a range that is none.
    pub(crate) fn new(
        answering: Answering,
        columns: &StreamColumns,
        log: &LogReading,
        keep_faults: bool,
    ) -> Result<Self, String> {
        let inputs = answering.inputs().to_vec();
        columns.check(&inputs)?;
        let places = inputs.iter().filter_map(|name| columns.place(name)).collect();
        if answering.needs_time() && !columns.time {
            let what = "has no time_s, and a model reads voltages of the past (it was trained with --lags); give it \
                        the time in seconds";
            return Err(what.to_owned());
        }
        let preceding = columns.led.then(|| Preceding::new(inputs.len(), log.ambient.full_scale_v)).transpose();
        let preceding = preceding.map_err(|why: AmbientError| why.to_string())?;
        Ok(Self {
            volts: vec![f64::NAN; inputs.len()],
            answer: vec![f64::NAN; answering.columns().len()],
            standing: Standing::new(&inputs),
            stops: None,
            answering,
            preceding,
            places,
            statuses: columns.status.map(|at| (at, Statuses::new(&inputs))),
            groups: columns.groups.iter().map(|&at| (at, Vec::new())).collect(),
            last_s: f64::NAN,
            rows: 0.0,
            timed: columns.time,
            begins: true,
            keep_faults,
            lit: 0,
            unlit: 0,
            unknown: 0,
            not_known: 0,
            without: 0,
        })
    }

    /// What to say of its photodiodes.
    pub(crate) fn doubts(&self) -> Vec<String> {
        self.standing.doubts()
    }

    /// Whether its rows say whether the LED was on.
    pub(crate) fn has_led(&self) -> bool {
        self.preceding.is_some()
    }

    /// What its models make of a row; nothing of an unlit one.
    pub(crate) fn row(&mut self, row: &Row<'_>) -> Option<Answer> {
        let mut begins = row.begins || row.time_s < self.last_s;
        // As in a table, a new recording knows nothing of the times before.
        if !row.time_s.is_nan() || begins {
            self.last_s = row.time_s;
        }
        for (at, last) in &mut self.groups {
            if row.texts[*at] != *last {
                last.clone_from(&row.texts[*at]);
                begins = true;
            }
        }
        self.begins |= begins;
        for (volts, &place) in self.volts.iter_mut().zip(&self.places) {
            *volts = row.values[place];
        }
        let status = self.statuses.as_mut().map(|(at, statuses)| statuses.read_bytes(&row.texts[*at]));
        let mut faulty = status == Some(Verdict::Fault);
        if (self.preceding.is_none() || row.lit == Some(true))
            && let Some(what) = self.standing.push(row.time_s, &self.volts)
        {
            self.stops = Some(what.to_owned());
        }
        if let Some(preceding) = &mut self.preceding {
            if begins {
                preceding.forget();
            }
            self.rows += 1.0;
            let at = if self.timed { row.time_s } else { self.rows };
            match row.lit {
                Some(true) => faulty |= preceding.lit(at, &mut self.volts),
                Some(false) => {
                    preceding.unlit(at, &self.volts);
                    self.unlit += 1;
                    return None;
                }
                None => {
                    self.unknown += 1;
                    return None;
                }
            }
        }
        if faulty && !self.keep_faults {
            self.volts.fill(f64::NAN);
        }
        let before = self.answering.outside();
        let begins = std::mem::take(&mut self.begins);
        let contact = self.answering.answer(row.time_s, begins, &self.volts, &mut self.answer);
        self.lit += 1;
        self.not_known += u64::from(!self.answer.iter().all(|value| value.is_finite()));
        self.without += u64::from(!self.answer.iter().any(|value| value.is_finite()));
        let is_far_outside = self.answering.is_far_outside();
        Some(Answer { contact, outside: self.answering.outside() > before, is_far_outside })
    }
}
