//! What a row of a stream is, and what its columns mean.

use crate::wire::fault::WireFault;
use crate::wire::spoilt::{Spoil, Tally};

/// What a column is for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Use {
    /// The device's time; so many of its units make a second.
    Time {
        /// Units in a second.
        per_second: f64,
    },
    /// A counter that grows by one with each row.
    Counter,
    /// Whether the LED was on.
    Led,
    /// A number that is read.
    Value {
        /// Its place among [`Row::values`].
        at: usize,
        /// Whether it is in counts where the source says how many volts a count is.
        scaled: bool,
    },
    /// Text that is kept as it is, and its place among [`Row::texts`].
    Text(usize),
    /// Passed over unread.
    None,
}

/// What the columns of a stream mean: made once, from their names.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Meaning {
    /// Of each column, in order.
    pub uses: Vec<Use>,
    /// How many values a row has.
    pub values: usize,
    /// How many texts.
    pub texts: usize,
}

impl Meaning {
    /// What columns of these names, which stand in `line`, mean.
    ///
    /// # Errors
    /// They mean nothing, or what they mean has another number of columns, or values without a place.
    pub(crate) fn of(names: &[String], line: u64, naming: &mut Naming) -> Result<Self, WireFault> {
        let meaning = naming(names).and_then(|meaning| {
            let placed = |one: &Use| match *one {
                Use::Value { at, .. } => at < meaning.values,
                Use::Text(at) => at < meaning.texts,
                _ => true,
            };
            if meaning.uses.len() == names.len() && meaning.uses.iter().all(placed) {
                return Ok(meaning);
            }
            Err(format!("{} columns were given {} uses", names.len(), meaning.uses.len()))
        });
        meaning.map_err(|why| WireFault::Naming { line, names: names.join(","), why })
    }
}

/// Gives the columns of these names a meaning, or says why it can't.
pub type Naming = Box<dyn FnMut(&[String]) -> Result<Meaning, String> + Send>;

/// What a decoder found next; the numbers are its `values()`, the names its `names()`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Step {
    /// The columns' names.
    Columns {
        /// They came before: the device begins again.
        again: bool,
    },
    /// A row.
    Sample(Sample),
    /// A row that is spoilt, or a message between rows.
    Spoilt(Spoil),
}

/// What a decoder knows of its rows: the columns, the last row, and what was spoilt.
#[derive(Debug, Default)]
pub struct Decoded {
    /// The columns' names; empty until they are known.
    pub names: Vec<String>,
    /// What the columns mean.
    pub meaning: Meaning,
    /// The numbers of the last row.
    pub values: Vec<f64>,
    /// The texts of the last row.
    pub texts: Vec<Vec<u8>>,
    /// Rows that are spoilt.
    pub tally: Tally,
}

impl Decoded {
    /// Learns what its names mean.
    pub(crate) fn name(&mut self, naming: &mut Naming) -> Result<(), WireFault> {
        let names = std::mem::take(&mut self.names);
        let meaning = Meaning::of(&names, 0, naming)?;
        self.begin(names, meaning);
        Ok(())
    }

    /// Begins with these columns.
    pub(crate) fn begin(&mut self, names: Vec<String>, meaning: Meaning) {
        self.values = vec![f64::NAN; meaning.values];
        self.texts = vec![Vec::new(); meaning.texts];
        (self.names, self.meaning) = (names, meaning);
    }
}

/// A row as its device numbers it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// The device's time in its own unit, as it was written; NaN where the row has none.
    pub time: f64,
    /// The device's counter, as it was written.
    pub counter: Option<u64>,
    /// Whether the LED was on; none where the row does not say.
    pub lit: Option<bool>,
}

/// A row of a stream.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row<'a> {
    /// When its last byte came, nanoseconds of the host's monotonic clock since the session began.
    pub host_ns: u64,
    /// The device's time, unwrapped, seconds; that of arrival where the device has none. NaN where the row lacks it.
    pub time_s: f64,
    /// Whether the LED was on; none where the row does not say.
    pub lit: Option<bool>,
    /// Rows that were lost just before it, by the counter.
    pub lost: u64,
    /// Whether a recording begins with it: the first row, or the first after the source was lost or its clock set back.
    pub begins: bool,
    /// The numbers that are read, NaN where missing.
    pub values: &'a [f64],
    /// The texts that are kept, without space and quotes around them.
    pub texts: &'a [Vec<u8>],
}
