//! A recording read row by row as a session would, as fast as possible.

use std::ops::ControlFlow;
use std::path::Path;

use lunula_live::source::{Address, Event, Form, HostClock, OfFinger, Pace, Place};
use lunula_live::wire::Row;

use super::columns::StreamColumns;
use super::feed::{Feed, spoilt_words};
use super::open::source_fault;
use crate::job::Watch;
use crate::live::error::LiveError;
use crate::live::options::StreamOptions;
use crate::log::{LogReading, PRECEDING_RULE};

/// `columns` hears what the recording holds, `row` each row. Returns what is worth saying.
///
/// # Errors
/// A file that can't be read, or what `columns` or `row` refuse.
pub(crate) fn each_row(
    path: &Path,
    log: &LogReading,
    extra: &[String],
    mut columns: impl FnMut(&StreamColumns) -> Result<(), String>,
    mut row: impl FnMut(&Row<'_>) -> Result<(), String>,
    watch: &Watch<'_>,
) -> Result<Vec<String>, LiveError> {
    let place = path.display().to_string();
    let refused = |what: String| LiveError::Source { place: place.clone(), what };
    let source = Address {
        place: Place::File { path: path.to_owned(), pace: Pace::Max, looped: false },
        form: Form::Lines,
        volts_per_count: None,
    };
    let options = StreamOptions {
        source: vec![OfFinger::any(source.clone())],
        keep: extra.to_vec(),
        log: log.clone(),
        ..StreamOptions::default()
    };
    let clock = HostClock::start();
    let mut feed = Feed::open(&source, &options, &[], &clock)?;
    let mut known = StreamColumns::default();
    let (mut fault, mut rows) = (None, 0u64);
    while !feed.stream.ended() && fault.is_none() {
        watch.go_on()?;
        let mut on = |event: Event<'_>| {
            match event {
                Event::Columns(_) => {
                    known = feed.recognizer.take();
                    fault = columns(&known).err();
                }
                Event::Row(one) => {
                    rows += 1;
                    fault = row(one).err();
                }
                _ => {}
            }
            if fault.is_none() { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        };
        feed.stream.poll(clock.now_ns(), &mut on).map_err(|why| source_fault(&source, why))?;
    }
    if let Some(what) = fault {
        return Err(refused(what));
    }
    let spoilt = feed.stream.certificate().spoilt;
    let spoilt = || spoilt.iter().map(|rows| format!("left out: {}", spoilt_words(rows)));
    if rows == 0 {
        let why = spoilt().next().map_or(String::new(), |rows| format!("; {rows}"));
        return Err(refused(format!("no row came{why}")));
    }
    let mut notes = known.notes;
    notes.extend(known.led.then(|| PRECEDING_RULE.to_owned()));
    notes.extend(spoilt());
    Ok(notes)
}
