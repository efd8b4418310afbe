//! What a source is called: one grammar for every command.
//!
//! ```text
//! serial:/dev/ttyACM0?baud=921600     serial:auto          (the one port that there is)
//! tcp:HOST:PORT?once                  tcp-listen:127.0.0.1:PORT
//! udp:PORT                            udp:ADDRESS:PORT
//! lsl:name=NAME&type=TYPE&source_id=ID                     (any of them)
//! -                                                        (standard input)
//! FILE?rate=1|max|2.5&loop            phantom:KIND?seed=1&rate=max
//! ```
//!
//! and for all of them `form=lines|frames` and `volts-per-count=0.0049`.

mod finger;
mod parse;

use std::fmt;
use std::path::PathBuf;

use serde::Serialize;

pub use finger::OfFinger;

/// The baud rate of a serial port where none is given: what Arduino's examples use.
const BAUD: u32 = 115_200;

/// A source: where its rows come from, and in which form.
#[derive(Debug, Clone, PartialEq)]
pub struct Address {
    /// Where rows come from.
    pub place: Place,
    /// How they are written.
    pub form: Form,
    /// The volts of a count, where photodiodes come in counts.
    pub volts_per_count: Option<f64>,
}

/// Where rows come from.
#[derive(Debug, Clone, PartialEq)]
pub enum Place {
    /// A serial port.
    Serial {
        /// Its device; none for the only one that there is.
        path: Option<PathBuf>,
        /// Bits in a second; without meaning for boards whose USB is not a bridge.
        baud: u32,
    },
    /// A server to which we connect.
    Tcp {
        /// `HOST:PORT`.
        to: String,
        /// Whether the stream ends when the server closes it; otherwise it is connected to again.
        once: bool,
    },
    /// A client that connects to us.
    TcpListen {
        /// `ADDRESS:PORT`.
        at: String,
        /// Whether the stream ends with the first client.
        once: bool,
    },
    /// Datagrams that are sent to us.
    Udp {
        /// `ADDRESS:PORT`.
        at: String,
    },
    /// A stream of the Lab Streaming Layer.
    Lsl(LslQuery),
    /// Standard input.
    Stdin,
    /// A file, played back by its own clock.
    File {
        /// Its path.
        path: PathBuf,
        /// How fast.
        pace: Pace,
        /// Whether it begins again at its end.
        looped: bool,
    },
    /// A generated recording.
    Phantom {
        /// Which.
        kind: String,
        /// Its settings, as they were written.
        settings: Vec<(String, String)>,
        /// How fast.
        pace: Pace,
    },
}

/// What a stream of the Lab Streaming Layer is found by; all that are given have to be right.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct LslQuery {
    /// Its name.
    pub name: Option<String>,
    /// Its type, such as `EEG`.
    pub kind: Option<String>,
    /// Its source's identity, by which it is found again.
    pub source_id: Option<String>,
}

/// How rows are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Form {
    /// A line of text each.
    #[default]
    Lines,
    /// A frame of 27 bytes each.
    Frames,
}

/// How fast a recording is played.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Pace {
    /// As fast as it is read.
    #[default]
    Max,
    /// So many of its seconds in a second.
    Rate(f64),
}

impl fmt::Display for Form {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.serialize(out)
    }
}

impl fmt::Display for Pace {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Max => out.write_str("max"),
            Self::Rate(rate) => write!(out, "{rate}"),
        }
    }
}

impl fmt::Display for Address {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut keys: Vec<String> = Vec::new();
        let mut key = |given: bool, text: String| keys.extend(given.then_some(text));
        match &self.place {
            Place::Serial { path, baud } => {
                out.write_str("serial:")?;
                match path {
                    Some(path) => write!(out, "{}", path.display())?,
                    None => out.write_str("auto")?,
                }
                key(*baud != BAUD, format!("baud={baud}"));
            }
            Place::Tcp { to, once } => {
                write!(out, "tcp:{to}")?;
                key(*once, "once".to_owned());
            }
            Place::TcpListen { at, once } => {
                write!(out, "tcp-listen:{at}")?;
                key(*once, "once".to_owned());
            }
            Place::Udp { at } => write!(out, "udp:{at}")?,
            Place::Lsl(LslQuery { name, kind, source_id }) => {
                out.write_str("lsl:")?;
                let parts = [("name", name), ("type", kind), ("source_id", source_id)];
                let parts =
                    parts.iter().filter_map(|(key, value)| value.as_ref().map(|value| format!("{key}={value}")));
                out.write_str(&parts.collect::<Vec<_>>().join("&"))?;
            }
            Place::Stdin => out.write_str("-")?,
            Place::File { path, pace, looped } => {
                write!(out, "{}", path.display())?;
                key(*pace != Pace::Max, format!("rate={pace}"));
                key(*looped, "loop".to_owned());
            }
            Place::Phantom { kind, settings, pace } => {
                write!(out, "phantom:{kind}")?;
                settings.iter().for_each(|(name, value)| key(true, format!("{name}={value}")));
                key(*pace != Pace::Rate(1.0), format!("rate={pace}"));
            }
        }
        key(self.form != Form::Lines, format!("form={}", self.form));
        if let Some(volts) = self.volts_per_count {
            key(true, format!("volts-per-count={volts}"));
        }
        if keys.is_empty() { Ok(()) } else { write!(out, "?{}", keys.join("&")) }
    }
}
