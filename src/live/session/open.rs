//! Opening a session's source; what is no bytes, Parquet tables and generated fingers, as rows.

use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

use lunula_live::source::{Address, Place, Rows, SourceFault, Stream, StreamOptions as WireOptions};
use lunula_live::wire::{Meaning, Naming, Use};
use toml::Table;

use crate::job::read;
use crate::live::error::LiveError;
use crate::live::options::StreamOptions;
use crate::log::{GROUPS, LogReading, recorded_stream};
use crate::phantom::log::{LiveLog, LogOptions, Prompting, Protocol};
use crate::phantom::request::LogRequest;
use crate::table;

/// Opens one of a session's sources at `now_ns` of its clock.
pub(super) fn open_stream(
    source: &Address,
    options: &StreamOptions,
    naming: Naming,
    now_ns: u64,
) -> Result<Stream, LiveError> {
    let mut source = source.clone();
    source.volts_per_count = options.volts_per_count.or(source.volts_per_count);
    let since_1970 = SystemTime::now().duration_since(UNIX_EPOCH).ok();
    let wire = WireOptions {
        columns: options.names.clone(),
        host_start_unix_s: since_1970.map(|since| since.as_secs_f64() - 1e-9 * now_ns as f64),
    };
    let named = |what: String| LiveError::Source { place: source.to_string(), what };
    let has_names = || match options.names {
        None => Ok(()),
        Some(_) => Err(named("its columns have names of their own; leave --names out".to_owned())),
    };
    match &source.place {
        Place::File { path, pace, looped } if is_parquet(path) || is_xdf(path) => {
            has_names()?;
            let rows = if is_xdf(path) { TableRows::of_xdf(path, &options.log)? } else { TableRows::read(path)? };
            let rows = Box::new(rows);
            let name = source.to_string();
            Ok(Stream::of_rows(name, rows, (*pace, *looped), source.volts_per_count, &wire, naming))
        }
        Place::Phantom { kind, settings, pace } => {
            has_names()?;
            let rows = Box::new(PhantomRows::new(kind, settings).map_err(named)?);
            Ok(Stream::of_rows(source.to_string(), rows, (*pace, false), source.volts_per_count, &wire, naming))
        }
        _ => Stream::open(&source, wire, naming, now_ns).map_err(|why| source_fault(&source, why)),
    }
}

fn ends_with(path: &Path, ending: &str) -> bool {
    path.to_string_lossy().to_ascii_lowercase().ends_with(ending)
}

fn is_parquet(path: &Path) -> bool {
    ends_with(path, ".parquet")
}

fn is_xdf(path: &Path) -> bool {
    ends_with(path, ".xdf") || ends_with(path, ".xdfz")
}

/// A table's columns: numbers, and texts of those that say what a row is.
struct TableRows {
    names: Vec<String>,
    numbers: Vec<Vec<f64>>,
    texts: Vec<Vec<String>>,
    /// Which texts a row gives.
    kept: Vec<usize>,
    row: usize,
    rows: usize,
}

impl TableRows {
    fn read(path: &Path) -> Result<Self, LiveError> {
        let table = table::Table::read(path)?;
        let mut rows = Self {
            names: table.names().to_vec(),
            numbers: Vec::new(),
            texts: Vec::new(),
            kept: Vec::new(),
            row: 0,
            rows: table.rows(),
        };
        for name in table.names() {
            let (mut numbers, mut texts) = (Vec::new(), Vec::new());
            if name == "sensor_status" || GROUPS.contains(&name.as_str()) {
                table.each_text(name, |_, text| texts.push(text.to_owned()))?;
            } else {
                numbers = table.values(name).unwrap_or_default();
            }
            rows.numbers.push(numbers);
            rows.texts.push(texts);
        }
        Ok(rows)
    }

    /// A recording of the Lab Streaming Layer.
    fn of_xdf(path: &Path, log: &LogReading) -> Result<Self, LiveError> {
        let (names, numbers) = recorded_stream(path, &log.columns)?;
        let rows = numbers.first().map_or(0, Vec::len);
        let texts = vec![Vec::new(); names.len()];
        Ok(Self { names, numbers, texts, kept: Vec::new(), row: 0, rows })
    }
}

impl Rows for TableRows {
    fn names(&self) -> &[String] {
        &self.names
    }

    fn keep(&mut self, meaning: &Meaning) {
        let texts = meaning.uses.iter().enumerate().filter(|(_, what)| matches!(what, Use::Text(_)));
        self.kept = texts.map(|(k, _)| k).collect();
    }

    fn next(&mut self, cells: &mut [f64], texts: &mut [Vec<u8>]) -> Result<bool, String> {
        if self.row == self.rows {
            return Ok(false);
        }
        for (cell, column) in cells.iter_mut().zip(&self.numbers) {
            // A column of text that a number is asked of has none.
            *cell = column.get(self.row).copied().unwrap_or(f64::NAN);
        }
        for (text, &column) in texts.iter_mut().zip(&self.kept) {
            text.clear();
            text.extend(self.texts[column].get(self.row).into_iter().flat_map(|text| text.bytes()));
        }
        self.row += 1;
        Ok(true)
    }

    fn rewind(&mut self) -> Result<(), String> {
        self.row = 0;
        Ok(())
    }
}

pub(super) fn named(source: &Address) -> String {
    match &source.place {
        Place::Stdin => "standard input".to_owned(),
        Place::File { path, .. } => path.display().to_string(),
        _ => source.to_string(),
    }
}

/// Why a source gives nothing.
pub(super) fn source_fault(source: &Address, why: SourceFault) -> LiveError {
    let what = match why {
        SourceFault::Open { what, .. } => what,
        SourceFault::Wire { fault, .. } => fault.to_string(),
        SourceFault::Read { why, .. } => format!("can't be read ({why})"),
        SourceFault::Address { what, .. } => what,
    };
    LiveError::Source { place: named(source), what }
}

/// The setting of a phantom's samples a second; `rate` is how fast it is played.
const HZ: &str = "hz";

/// A generated finger, without end unless its length is given.
pub(crate) struct PhantomRows {
    names: Vec<String>,
    log: LiveLog,
}

impl PhantomRows {
    /// `kind` is a protocol of `lunula phantom log`, the settings its options.
    fn new(kind: &str, settings: &[(String, String)]) -> Result<Self, String> {
        let (options, table) = log_options(Some(kind), settings)?;
        let endless = !table.contains_key("seconds");
        let log = LiveLog::new(&options, endless, None).map_err(|why| why.to_string())?;
        Ok(Self::of(log))
    }

    /// A finger that follows whoever prompts it, as people do unless `follow` is among the settings; its clock is the
    /// prompter's, and it has no end.
    ///
    /// # Errors
    /// Settings that a log does not have, in words.
    pub(crate) fn prompted_by(settings: &[(String, String)], prompting: Prompting) -> Result<Self, String> {
        let (mut options, table) = log_options(None, settings)?;
        if !table.contains_key("follow") {
            options.follow = LogOptions::of(Protocol::Touch, options.seed).follow;
        }
        (options.lead_s, options.clock_offset_s, options.clock_drift_ppm) = (0.0, 0.0, 0.0);
        let log = LiveLog::new(&options, true, Some(prompting)).map_err(|why| why.to_string())?;
        Ok(Self::of(log))
    }

    fn of(log: LiveLog) -> Self {
        Self { names: log.names().into_iter().map(str::to_owned).collect(), log }
    }
}

fn log_options(protocol: Option<&str>, settings: &[(String, String)]) -> Result<(LogOptions, Table), String> {
    let mut table = Table::new();
    table.extend(protocol.map(|kind| ("protocol".to_owned(), kind.into())));
    for (key, text) in settings {
        let key = if key == HZ { "rate" } else { key };
        let value = match text.parse::<f64>() {
            _ if text.is_empty() => true.into(),
            Ok(number) if number.fract() == 0.0 && number.abs() < 1e15 => (number as i64).into(),
            Ok(number) => number.into(),
            Err(_) => text.as_str().into(),
        };
        table.insert(key.replace('-', "_"), value);
    }
    let request = read::<LogRequest>(&table, "a phantom").map_err(|why| why.to_string())?.options;
    let options = request.options().map_err(|why| format!("{why:#}"))?;
    Ok((options, table))
}

impl Rows for PhantomRows {
    fn names(&self) -> &[String] {
        &self.names
    }

    fn next(&mut self, cells: &mut [f64], _: &mut [Vec<u8>]) -> Result<bool, String> {
        let Some(row) = self.log.next() else { return Ok(false) };
        cells.copy_from_slice(&row.values);
        Ok(true)
    }
}
