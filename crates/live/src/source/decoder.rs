//! Whatever makes rows: lines, frames, or a program.

use crate::wire::{Decoded, Frames, Lines, Meaning, Naming, Sample, Spoil, Step, Use, WireFault, led_of};

/// Rows that a program makes or reads: a phantom, a table in another format.
pub trait Rows: Send {
    /// The columns' names.
    fn names(&self) -> &[String];

    /// What the columns mean, once that is known: which are texts.
    fn keep(&mut self, meaning: &Meaning) {
        let _ = meaning;
    }

    /// Writes the next row into `cells`, one for each column and NaN where missing, and its `texts`; false after the
    /// last.
    fn next(&mut self, cells: &mut [f64], texts: &mut [Vec<u8>]) -> Result<bool, String>;

    /// Begins again, or says that it can't.
    fn rewind(&mut self) -> Result<(), String> {
        Err("it can be played once only; leave out `loop`".to_owned())
    }
}

/// Decodes what comes.
pub(in crate::source) enum Decoder {
    Lines(Box<Lines>),
    Frames(Box<Frames>),
    Table(Box<Table>),
}

/// Rows of numbers.
pub(in crate::source) struct Table {
    pub(in crate::source) rows: Box<dyn Rows>,
    naming: Option<Naming>,
    volts_per_count: Option<f64>,
    decoded: Decoded,
    cells: Vec<f64>,
    row: u64,
}

impl Table {
    pub(in crate::source) fn new(rows: Box<dyn Rows>, naming: Naming, volts_per_count: Option<f64>) -> Self {
        let names = rows.names().to_vec();
        Self {
            cells: vec![f64::NAN; names.len()],
            rows,
            naming: Some(naming),
            volts_per_count,
            decoded: Decoded { names, ..Decoded::default() },
            row: 0,
        }
    }

    /// The next step; none after the last row.
    pub(in crate::source) fn next(&mut self) -> Result<Option<Step>, String> {
        if let Some(mut naming) = self.naming.take() {
            self.decoded.name(&mut naming).map_err(|why| why.to_string())?;
            self.rows.keep(&self.decoded.meaning);
            return Ok(Some(Step::Columns { again: false }));
        }
        self.cells.fill(f64::NAN);
        if !self.rows.next(&mut self.cells, &mut self.decoded.texts)? {
            return Ok(None);
        }
        self.row += 1;
        let step = match self.sample() {
            Some(sample) => Step::Sample(sample),
            None => {
                let cells = &self.cells;
                self.decoded.tally.add(Spoil::Unreadable, self.row, || format!("{cells:?}").chars().take(40).collect());
                Step::Spoilt(Spoil::Unreadable)
            }
        };
        Ok(Some(step))
    }

    fn sample(&mut self) -> Option<Sample> {
        let mut sample = Sample { time: f64::NAN, counter: None, lit: None };
        for (&number, purpose) in self.cells.iter().zip(&self.decoded.meaning.uses) {
            if number.is_infinite() && *purpose != Use::None {
                return None;
            }
            match *purpose {
                Use::Time { .. } => sample.time = number,
                Use::Counter if number.is_nan() => {}
                Use::Counter if number >= 0.0 && number.fract() == 0.0 => sample.counter = Some(number as u64),
                Use::Counter => return None,
                Use::Led => sample.lit = led_of(number).ok()?,
                Use::Value { at, scaled } => {
                    let scale = self.volts_per_count.filter(|_| scaled);
                    self.decoded.values[at] = scale.map_or(number, |volts| number * volts);
                }
                // Texts are the rows' own.
                Use::Text(_) | Use::None => {}
            }
        }
        Some(sample)
    }
}

impl Decoder {
    /// Decodes up to the next step; none where nothing more is whole.
    pub(in crate::source) fn next(&mut self, bytes: &mut &[u8], host_ns: u64) -> Result<Option<Step>, WireFault> {
        match self {
            Self::Lines(lines) => lines.next(bytes, host_ns),
            Self::Frames(frames) => frames.next(bytes),
            Self::Table(_) => Ok(None),
        }
    }

    /// What is left at the end of the stream.
    pub(in crate::source) fn finish(&mut self, host_ns: u64) -> Result<Option<Step>, WireFault> {
        match self {
            Self::Lines(lines) => lines.finish(host_ns),
            Self::Frames(frames) => frames.finish().map(|()| None),
            Self::Table(_) => Ok(None),
        }
    }

    /// Forgets half a row; what comes next may begin `within` one.
    pub(in crate::source) fn cut(&mut self, within: bool) {
        match self {
            Self::Lines(lines) => lines.cut(within),
            Self::Frames(frames) => frames.cut(),
            Self::Table(_) => {}
        }
    }

    pub(in crate::source) fn garbled(&self) -> Option<WireFault> {
        if let Self::Lines(lines) = self { lines.garbled() } else { None }
    }

    /// Whether rows carry checksums: a device makes them, for a link that may damage rows.
    pub(in crate::source) fn is_sealed(&self) -> bool {
        match self {
            Self::Lines(lines) => lines.checksum.is_some(),
            Self::Frames(_) => true,
            Self::Table(_) => false,
        }
    }

    pub(in crate::source) fn decoded(&self) -> &Decoded {
        match self {
            Self::Lines(lines) => lines.decoded(),
            Self::Frames(frames) => frames.decoded(),
            Self::Table(table) => &table.decoded,
        }
    }

    pub(in crate::source) fn decoded_mut(&mut self) -> &mut Decoded {
        match self {
            Self::Lines(lines) => &mut lines.decoded,
            Self::Frames(frames) => &mut frames.decoded,
            Self::Table(table) => &mut table.decoded,
        }
    }
}
