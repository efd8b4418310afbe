//! A log as a recording of the Lab Streaming Layer (XDF, <https://github.com/sccn/xdf/wiki/Specifications>).
//!
//! [`chunks`] takes the file apart into streams, [`sync`] brings a stream's stamps to the recorder's clock. One stream
//! of numbers is read: the one that the user names (or `#2`, the second of the file), or the only one. Its columns are
//! called as its channels are labelled, else `ch1`, `ch2`, ..; the stamps are `time_s`, in seconds of the recorder's
//! own clock, which has no midnight.

mod chunks;
mod sync;
#[cfg(test)]
mod tests;

use std::path::Path;

use crate::log::LogError;
use crate::log::formats::raw::{Raw, RowWord, place};
use crate::log::formats::text;
use crate::log::lines::cell;
use crate::log::naming::columns::Columns;
use crate::log::naming::role::Role;
use chunks::Stream;

/// The one stream that is asked for, on the recorder's clock, the names of its columns (the time's first), and what is
/// worth saying.
pub(in crate::log) fn stream(path: &Path, columns: &Columns) -> Result<(Stream, Vec<String>, Vec<String>), LogError> {
    let failed = |what: String| LogError::File { path: path.to_owned(), what };
    let wrong = |what: String| LogError::Columns { path: path.to_owned(), what };
    let bytes = text::unpacked(path)?;
    let (streams, mut notes) = chunks::streams(&bytes).map_err(failed)?;
    let mut stream = chosen(streams, columns.stream.as_deref()).map_err(wrong)?;
    sync::to_recorder(&mut stream, &mut notes);
    sync::smooth(&mut stream, &mut notes);
    let names = std::iter::once("time_s".to_owned()).chain(stream.labels.iter().cloned()).collect();
    Ok((stream, names, notes))
}

pub(in crate::log) fn read(path: &Path, columns: &Columns) -> Result<Raw, LogError> {
    let wrong = |what: String| LogError::Columns { path: path.to_owned(), what };
    let (stream, names, notes) = stream(path, columns)?;
    let choice = columns.choose(&names, &[]).map_err(wrong)?;
    let mut raw = Raw::new(path.to_owned(), RowWord::Sample, &choice);
    raw.notes.splice(0..0, notes);
    raw.places = (1..=stream.time_s.len() as u64).collect();
    for &(role, column) in &choice.columns {
        let values = if column == 0 { &stream.time_s } else { &stream.channels[column - 1] };
        let error = |row: usize, what: String| LogError::Cell {
            place: format!("{}, channel `{}`", place(path, RowWord::Sample, row as u64 + 1), names[column]),
            what,
        };
        if let Some(row) = values.iter().position(|v| v.is_infinite()) {
            return Err(error(row, "is infinite; correct it or leave it out".to_owned()));
        }
        match role {
            Role::Time => raw.time_s.clone_from(values),
            Role::Led => {
                let states = values
                    .iter()
                    .enumerate()
                    .map(|(row, value)| cell::led(value.to_string().as_bytes()).map_err(|what| error(row, what)));
                raw.led = Some(states.collect::<Result<_, _>>()?);
            }
            Role::Photodiode(_) | Role::Output(_) | Role::Force(_) | Role::Pressure(_) | Role::Contact => {
                if let Some(channel) = raw.channel(role) {
                    channel.clone_from(values);
                }
            }
        }
    }
    Ok(raw)
}

/// The stream that is asked for, or the only one with numbers.
fn chosen(streams: Vec<Stream>, name: Option<&str>) -> Result<Stream, String> {
    let usable = |stream: &Stream| stream.numeric && !stream.time_s.is_empty();
    let listed: Vec<String> = streams
        .iter()
        .enumerate()
        .map(|(k, s)| format!("`{}` (#{}, {}, {} samples)", s.name, k + 1, s.format, s.time_s.len()))
        .collect();
    let listed = listed.join(", ");
    let found: Vec<usize> = match name {
        Some(name) => {
            let named: Vec<usize> = (0..streams.len()).filter(|&k| streams[k].name == name).collect();
            let place = name.strip_prefix('#').and_then(|digits| digits.parse::<usize>().ok());
            let placed = place.filter(|&place| named.is_empty() && (1..=streams.len()).contains(&place));
            placed.map_or(named, |place| vec![place - 1])
        }
        None => (0..streams.len()).filter(|&k| usable(&streams[k])).collect(),
    };
    match (found[..].len(), name) {
        (1, _) => {}
        (0, Some(name)) => return Err(format!("has no stream `{name}`; its streams are {listed}")),
        (0, None) => return Err(format!("has no stream with numbers; its streams are {listed}")),
        _ => {
            return Err(format!(
                "more than one stream could be meant; say which, as in --stream \"#1\"; its streams are {listed}"
            ));
        }
    }
    let stream = streams.into_iter().nth(found[0]).filter(usable);
    stream.ok_or_else(|| format!("the stream has no numbers; its streams are {listed}"))
}
