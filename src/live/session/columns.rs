//! What the columns of a stream are for: a log's own rules, for names that come down a wire.
//!
//! In: the names. Out: which column is the time, the counter, the LED, and which numbers are kept, under the contract's
//! names: photodiodes, forces, pressures, a tracker's `x_m`, `y_m`, `z_m`, and what is asked for by name.

use std::sync::{Arc, Mutex, PoisonError};

use lunula_live::wire::{Meaning, Naming, Use};

use crate::live::options::StreamOptions;
use crate::log::{GROUPS, LogReading};
use crate::predictor::missing;

/// Names of counters.
const COUNTERS: [&str; 4] = ["n", "counter", "seq", "sequence"];
/// A tracker's, beside the columns of logs.
const TRACKER: [&str; 3] = ["x_m", "y_m", "z_m"];

#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct StreamColumns {
    /// What the wire is to do with each.
    pub(crate) meaning: Meaning,
    /// The names of a row's values.
    pub(crate) values: Vec<String>,
    /// Whether there is a time, and an LED.
    pub(crate) time: bool,
    pub(crate) led: bool,
    /// Where `sensor_status` is among a row's texts, and where the columns are that say which recording it is.
    pub(crate) status: Option<usize>,
    pub(crate) groups: Vec<usize>,
    /// What was guessed.
    pub(crate) notes: Vec<String>,
    /// Columns that are not kept.
    pub(crate) passed_over: Vec<String>,
    /// All, as the device calls them.
    names: Vec<String>,
}

impl StreamColumns {
    /// Of these names; `extra` are kept by name.
    ///
    /// # Errors
    /// Columns that could be several, or of one name, in words.
    pub(crate) fn of(names: &[String], log: &LogReading, extra: &[String]) -> Result<Self, String> {
        let found = log.renamed(names)?;
        let mut columns = Self { notes: found.notes, names: names.to_vec(), ..Self::default() };
        for (k, name) in found.names.iter().enumerate() {
            let of_log = found.known[k];
            let kept = extra.contains(name) || TRACKER.contains(&name.as_str());
            let what = match name.as_str() {
                "time_s" => {
                    columns.time = true;
                    Use::Time { per_second: found.per_second }
                }
                "led" if of_log => {
                    columns.led = true;
                    Use::Led
                }
                "sensor_status" => {
                    columns.status = Some(columns.meaning.texts);
                    columns.text()
                }
                name if GROUPS.contains(&name) => {
                    columns.groups.push(columns.meaning.texts);
                    columns.text()
                }
                name if COUNTERS.contains(&name) && !kept => Use::Counter,
                _ if of_log || kept => {
                    if columns.values.contains(name) {
                        return Err(format!("two columns are named `{name}`; rename one"));
                    }
                    columns.values.push(name.clone());
                    let at = columns.meaning.values;
                    columns.meaning.values += 1;
                    // Counts are those of a converter: photodiodes.
                    Use::Value { at, scaled: of_log && is_photodiode(name) }
                }
                _ => {
                    columns.passed_over.push(name.clone());
                    Use::None
                }
            };
            columns.meaning.uses.push(what);
        }
        if !columns.time && !columns.passed_over.is_empty() {
            columns.notes.push(format!(
                "no column is read as the time, and rows have that of their arrival; where one of {} is the time, name \
                 it with --columns time_s=NAME, and its unit with --time-unit",
                columns.passed_over.join(", ")
            ));
        }
        Ok(columns)
    }

    /// Where the photodiodes are in a row.
    pub(crate) fn photodiodes(&self) -> impl Iterator<Item = usize> {
        (0..self.values.len()).filter(|&k| is_photodiode(&self.values[k]))
    }

    /// That a column is there and read by another name.
    fn read_as(&self, name: &str) -> Option<String> {
        let at = self.names.iter().position(|own| own == name)?;
        let Use::Value { at, .. } = self.meaning.uses[at] else { return None };
        Some(format!("column `{name}` is read as `{0}`: write `{0}`", self.values[at]))
    }

    fn text(&mut self) -> Use {
        self.meaning.texts += 1;
        Use::Text(self.meaning.texts - 1)
    }

    /// Whether these photodiodes are there.
    ///
    /// # Errors
    /// The first that is not, in words.
    pub(crate) fn check(&self, needs: &[String]) -> Result<(), String> {
        let Some(lacking) = needs.iter().find(|name| self.place(name).is_none()) else { return Ok(()) };
        Err(format!("{}; say what it is called, as in --columns {lacking}=ch_1", missing(lacking, &self.names)))
    }

    /// Where a value is in a row.
    pub(crate) fn place(&self, name: &str) -> Option<usize> {
        self.values.iter().position(|value| value == name)
    }
}

/// Recognizes the columns of a stream when it names them, and hands them to whoever works with them.
#[derive(Clone, Default)]
pub(super) struct Recognizer(Arc<Mutex<Option<StreamColumns>>>);

impl Recognizer {
    /// What a stream asks for the meaning of its columns; `needs` have to be among them, and what is to be kept where
    /// it is the only one.
    pub(super) fn naming(&self, options: &StreamOptions, needs: &[String]) -> Naming {
        let is_alone = options.source.len() + options.force.len() == 1;
        let (recognizer, log, keep) = (self.clone(), options.log.clone(), options.keep.clone());
        let needs = needs.to_vec();
        Box::new(move |names| {
            let columns = StreamColumns::of(names, &log, &keep)?;
            if let Some(lacking) = keep.iter().find(|name| is_alone && !columns.values.contains(name)) {
                return Err(columns.read_as(lacking).unwrap_or_else(|| missing(lacking, names)));
            }
            if columns.values.is_empty() {
                return Err(format!(
                    "no column is a photodiode or a force; its columns are {}; say which are, as --columns P1=NAME \
                     (volts) or Fz_N=NAME (newtons)",
                    names.join(", ")
                ));
            }
            columns.check(&needs)?;
            let meaning = columns.meaning.clone();
            recognizer.0.lock().unwrap_or_else(PoisonError::into_inner).replace(columns);
            Ok(meaning)
        })
    }

    /// The columns, once.
    pub(super) fn take(&self) -> StreamColumns {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).take().unwrap_or_default()
    }
}

/// Whether a name is a photodiode's: `P1`, `VP1`.
pub(super) fn is_photodiode(name: &str) -> bool {
    let number = name.strip_prefix("VP").or_else(|| name.strip_prefix('P'));
    number.is_some_and(|number| !number.is_empty() && number.bytes().all(|b| b.is_ascii_digit()))
}
