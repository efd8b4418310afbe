//! The grammar of sources, the same for every command.
//!
//! | written | is |
//! |---|---|
//! | `serial:/dev/ttyACM0?baud=115200` | a serial port; `serial:auto` the only one there is |
//! | `tcp:HOST:PORT` | connects, and again when it is lost; `?once` ends with the connection |
//! | `tcp-listen:ADDRESS:PORT` | waits for the device to connect |
//! | `udp:PORT`, `udp:ADDRESS:PORT` | datagrams of whole lines or frames |
//! | `-` | standard input |
//! | `FILE?rate=1` | a recording played back: `max` (as fast as possible), 1 (as it was), 2.5; `&loop` for ever |
//! | `phantom:KIND?seed=1&rate=1` | a generated finger with exact truth |
//!
//! Everywhere `form=lines` or `form=frames` ([`wire`](crate::wire)).

use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

/// Where samples come from, as written.
#[derive(Debug, Clone, PartialEq)]
pub struct Source {
    /// Where.
    pub place: Place,
    /// Lines or frames.
    pub form: Form,
    text: String,
}

/// Where samples come from.
#[derive(Debug, Clone, PartialEq)]
pub enum Place {
    /// A serial port; none: the only one there is.
    Serial {
        /// The device.
        path: Option<PathBuf>,
        /// Bits a second.
        baud: u32,
    },
    /// Connects to a host's port.
    Tcp {
        /// HOST:PORT.
        address: String,
        /// Ends with the connection.
        once: bool,
    },
    /// Waits for a connection.
    TcpListen {
        /// ADDRESS:PORT.
        address: String,
    },
    /// Datagrams.
    Udp {
        /// ADDRESS:PORT.
        address: String,
    },
    /// Standard input.
    Stdin,
    /// A recording.
    File {
        /// The file.
        path: PathBuf,
        /// How fast.
        rate: Rate,
        /// From the beginning again at its end.
        again: bool,
    },
    /// A generated finger.
    Phantom {
        /// What it does.
        kind: String,
        /// Its other settings, as written.
        settings: Vec<(String, String)>,
        /// How fast.
        rate: Rate,
    },
}

/// How fast a recording is played back.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Rate {
    /// As fast as possible.
    Max,
    /// So many times as fast as it was.
    Times(f64),
}

/// How rows are written on the wire.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// Text.
    Lines,
    /// Bytes.
    Frames,
}

/// Bits a second where none are said: what most boards' examples use.
const BAUD: u32 = 115_200;

impl fmt::Display for Source {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        to.write_str(&self.text)
    }
}

impl Source {
    /// As messages name it.
    #[must_use]
    pub fn named(&self) -> String {
        match &self.place {
            Place::Stdin => "standard input".to_owned(),
            Place::File { path, .. } => path.display().to_string(),
            _ => self.text.clone(),
        }
    }
}

impl FromStr for Source {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (base, query) = match text.rsplit_once('?') {
            Some((base, query)) => (base, query),
            None => (text, ""),
        };
        let mut settings = Settings::of(query)?;
        let form = match settings.take("form").as_deref() {
            None | Some("lines") => Form::Lines,
            Some("frames") => Form::Frames,
            Some(other) => return Err(format!("form={other}: write lines or frames")),
        };
        let place = match base.split_once(':') {
            Some(("serial", path)) => {
                let path = (path != "auto").then(|| PathBuf::from(path));
                if path.as_ref().is_some_and(|path| path.as_os_str().is_empty()) {
                    return Err(
                        "serial: names no port; write serial:/dev/ttyACM0?baud=115200 or serial:auto".to_owned()
                    );
                }
                let baud = settings.take("baud").map_or(Ok(BAUD), |baud| {
                    let known = baud.parse().ok().filter(|baud: &u32| (50..=20_000_000).contains(baud));
                    known.ok_or_else(|| format!("baud={baud}: write bits a second, as 115200"))
                })?;
                Place::Serial { path, baud }
            }
            Some(("tcp", address)) => {
                Place::Tcp { address: checked(address, "tcp:192.168.1.5:7777")?, once: settings.flag("once")? }
            }
            Some(("tcp-listen", address)) => {
                Place::TcpListen { address: checked(address, "tcp-listen:127.0.0.1:7777")? }
            }
            Some(("udp", address)) if !address.contains(':') => {
                Place::Udp { address: checked(&format!("0.0.0.0:{address}"), "udp:7777")? }
            }
            Some(("udp", address)) => Place::Udp { address: checked(address, "udp:0.0.0.0:7777")? },
            Some(("phantom", kind)) => {
                let rate = settings.rate(Rate::Times(1.0))?;
                Place::Phantom { kind: kind.to_owned(), settings: settings.rest(), rate }
            }
            Some(("lsl", _)) => {
                return Err(
                    "lsl: streams of the Lab Streaming Layer are not read live yet; record them with LabRecorder \
                            (.xdf is a FILE), or pipe them into `-` with pylsl"
                        .to_owned(),
                );
            }
            _ if base == "-" => Place::Stdin,
            _ if base.is_empty() => return Err(format!("`{text}` names no source; write {FORMS}")),
            _ => Place::File {
                path: PathBuf::from(base),
                rate: settings.rate(Rate::Max)?,
                again: settings.flag("loop")?,
            },
        };
        settings.all_taken(&place)?;
        Ok(Self { place, form, text: text.to_owned() })
    }
}

const FORMS: &str = "serial:/dev/ttyACM0?baud=115200, serial:auto, tcp:HOST:PORT, tcp-listen:ADDRESS:PORT, udp:PORT, -, \
                     FILE?rate=1 or phantom:contacts?seed=1";

fn checked(address: &str, example: &str) -> Result<String, String> {
    let port = address.rsplit_once(':').and_then(|(host, port)| Some((host, port.parse::<u16>().ok()?)));
    match port {
        Some((host, _)) if !host.is_empty() => Ok(address.to_owned()),
        _ => Err(format!("`{address}` is no address with a port; write {example}")),
    }
}

/// What follows the `?`.
struct Settings(Vec<(String, String)>);

impl Settings {
    fn of(query: &str) -> Result<Self, String> {
        let pairs = query.split('&').filter(|part| !part.is_empty()).map(|part| {
            let (key, value) = part.split_once('=').unwrap_or((part, ""));
            (key.to_owned(), value.to_owned())
        });
        let pairs: Vec<(String, String)> = pairs.collect();
        let twice = (1..pairs.len()).find(|&k| pairs[..k].iter().any(|(key, _)| *key == pairs[k].0));
        match twice {
            Some(k) => Err(format!("`{}` is given twice", pairs[k].0)),
            None => Ok(Self(pairs)),
        }
    }

    fn take(&mut self, key: &str) -> Option<String> {
        let at = self.0.iter().position(|(known, _)| known == key)?;
        Some(self.0.remove(at).1)
    }

    fn flag(&mut self, key: &str) -> Result<bool, String> {
        match self.take(key).as_deref() {
            None => Ok(false),
            Some("" | "1" | "true") => Ok(true),
            Some("0" | "false") => Ok(false),
            Some(other) => Err(format!("{key}={other}: write {key} alone, or leave it out")),
        }
    }

    fn rate(&mut self, default: Rate) -> Result<Rate, String> {
        let Some(text) = self.take("rate") else { return Ok(default) };
        if text == "max" {
            return Ok(Rate::Max);
        }
        let rate = text.parse().ok().filter(|rate: &f64| (1e-3..=1e6).contains(rate));
        rate.map(Rate::Times).ok_or_else(|| format!("rate={text}: write max, or how many times as fast, as 1 or 2.5"))
    }

    fn rest(&mut self) -> Vec<(String, String)> {
        std::mem::take(&mut self.0)
    }

    /// Refuses what nobody took.
    fn all_taken(&self, place: &Place) -> Result<(), String> {
        let Some((key, _)) = self.0.first() else { return Ok(()) };
        let known: &[&str] = match place {
            Place::Serial { .. } => &["baud", "form"],
            Place::Tcp { .. } => &["once", "form"],
            Place::File { .. } => &["rate", "loop", "form"],
            _ => &["form"],
        };
        let near = known.iter().map(|one| (strsim::normalized_damerau_levenshtein(one, key), one));
        let near = near.filter(|(alike, _)| *alike >= 0.5).max_by(|a, b| a.0.total_cmp(&b.0));
        let instead =
            near.map_or_else(|| format!("; it has {}", known.join(", ")), |(_, one)| format!("; is it `{one}`?"));
        Err(format!("this source has no setting `{key}`{instead}"))
    }
}
