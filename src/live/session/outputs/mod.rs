//! Where answers go: standard output, TCP clients, a stream of the Lab Streaming Layer, a recording, switches' events.
//!
//! One row for each sample; where a session has several fingers, its second column says whose it is.

pub(super) mod events;
pub(super) mod pipe;
pub(super) mod pointer;
pub(super) mod recording;
pub(super) mod samples;
pub(super) mod switch;

use std::net::{SocketAddr, TcpListener};
use std::os::fd::OwnedFd;
use std::path::PathBuf;

use events::EventsFile;
#[cfg(feature = "lsl")]
use lunula_live::source::LslOutlet;
use pipe::Pipe;
use recording::Recording;

use crate::live::error::LiveError;
use crate::live::view::{Seen, View};
use crate::table::push_number;

/// The column that says whose a row is.
pub(super) const FINGER: &str = "finger";
/// The column of switches.
const SWITCH: &str = "switch";

/// Where the rows of answers go.
#[derive(Default)]
pub(super) struct Outputs {
    readers: Vec<Pipe>,
    listener: Option<TcpListener>,
    pub(super) predicted: Option<Recording>,
    events_path: Option<PathBuf>,
    pub(super) events: Option<EventsFile>,
    outlet: Outlet,
    /// A page that shows the session.
    pub(super) view: Option<View>,
    pub(super) header: Vec<String>,
    has_switch: bool,
    begun: bool,
    line: String,
}

pub(super) struct AnswerRow<'a> {
    /// `time_s` and what is predicted, as text without an end.
    pub(super) text: &'a str,
    /// Whose it is, and its place among the fingers; none where there is one only.
    pub(super) finger: Option<(&'a str, usize)>,
    /// The same as numbers, and what was answered.
    pub(super) seen: Seen<'a>,
}

impl Outputs {
    /// With rows to `rows` and readers at `tcp`, a file of events at `events`.
    ///
    /// # Errors
    /// An address that can't be listened at.
    pub(super) fn new(
        rows: Option<OwnedFd>,
        waits: bool,
        tcp: Option<SocketAddr>,
        events: Option<PathBuf>,
        tell: &dyn Fn(&str),
    ) -> Result<Self, LiveError> {
        Ok(Self {
            readers: rows.into_iter().map(|rows| Pipe::new(rows, waits)).collect(),
            listener: tcp.map(|address| listen(address, tell)).transpose()?,
            events_path: events,
            ..Self::default()
        })
    }

    /// Names the columns of the rows: those that a sensor's answers have, a switch's behind them. `labels` are those of
    /// the predicted numbers, for the stream called `lsl`.
    ///
    /// # Errors
    /// A stream that can't be announced.
    pub(super) fn name(
        &mut self,
        answers: Vec<String>,
        labels: &[String],
        fingers: bool,
        has_switch: bool,
        lsl: Option<&str>,
    ) -> Result<(), LiveError> {
        self.header = answers;
        if fingers {
            self.header.insert(1, FINGER.to_owned());
        }
        self.header.extend(has_switch.then(|| SWITCH.to_owned()));
        self.has_switch = has_switch;
        if let Some(predicted) = &mut self.predicted {
            predicted.name(self.header.clone());
        }
        let Some(name) = lsl else { return Ok(()) };
        let mut labels = labels.to_vec();
        if fingers {
            labels.insert(0, FINGER.to_owned());
        }
        labels.extend(has_switch.then(|| SWITCH.to_owned()));
        self.outlet = Outlet::new(name, &labels).map_err(LiveError::Request)?;
        Ok(())
    }

    /// Rows are about to come: readers hear the names, events get their file.
    pub(super) fn begin(&mut self) -> Result<(), LiveError> {
        if std::mem::replace(&mut self.begun, true) {
            return Ok(());
        }
        self.events = EventsFile::create(self.events_path.as_deref())?;
        let names = self.names();
        self.readers.iter_mut().for_each(|reader| reader.push(&names));
        Ok(())
    }

    /// A row of answers.
    pub(super) fn row(&mut self, row: &AnswerRow<'_>) -> Result<(), LiveError> {
        if let Some(view) = &mut self.view {
            view.sample(row.finger.map_or(0, |(_, place)| place), &row.seen);
        }
        let line = &mut self.line;
        line.clear();
        match row.finger {
            None => line.push_str(row.text),
            Some((finger, _)) => {
                let (time, answers) = row.text.split_once(',').unwrap_or((row.text, ""));
                [time, ",", finger, ",", answers].into_iter().for_each(|part| line.push_str(part));
            }
        }
        if self.has_switch {
            line.push(',');
            if let Some(pressed) = row.seen.pressed {
                push_number(line, f64::from(u8::from(pressed)));
            }
        }
        line.push('\n');
        self.readers.iter_mut().for_each(|reader| reader.push(line));
        self.outlet.push(row, self.has_switch)?;
        self.predicted.as_mut().map_or(Ok(()), |predicted| predicted.push(line))
    }

    /// Lets readers in that knock.
    pub(super) fn let_in(&mut self, tell: &dyn Fn(&str)) {
        while let Some((reader, from)) = self.listener.as_ref().and_then(|listener| listener.accept().ok()) {
            let ready = reader.set_nonblocking(true).and_then(|()| reader.set_nodelay(true));
            if ready.is_ok() {
                tell(&format!("a reader came: {from}"));
                let mut reader = Pipe::new(reader.into(), false);
                if self.begun {
                    reader.push(&self.names());
                }
                self.readers.push(reader);
            }
        }
    }

    fn names(&self) -> String {
        self.header.join(",") + "\n"
    }

    /// Hands on what readers take now.
    pub(super) fn flush(&mut self) {
        self.readers.iter_mut().for_each(Pipe::flush);
    }

    /// Whether a reader has not taken all.
    pub(super) fn is_behind(&self) -> bool {
        self.readers.iter().any(Pipe::is_behind)
    }

    /// Whether there were readers, all have gone and none can come.
    pub(super) fn nobody_reads(&self) -> bool {
        let others = self.listener.is_some() || self.outlet.is_open();
        !others && !self.readers.is_empty() && self.readers.iter().all(|pipe| pipe.gone)
    }

    /// Gives readers a moment to take what is left; why one could not be written.
    pub(super) fn finish(&mut self) -> Option<LiveError> {
        self.readers.iter_mut().for_each(Pipe::finish);
        self.readers.iter().find_map(Pipe::failed).map(LiveError::Rows)
    }

    /// Rows that readers lost.
    pub(super) fn lost(&self) -> u64 {
        self.readers.iter().map(|pipe| pipe.lost).sum()
    }
}

fn listen(address: SocketAddr, tell: &dyn Fn(&str)) -> Result<TcpListener, LiveError> {
    let bound = TcpListener::bind(address).and_then(|one| one.set_nonblocking(true).map(|()| one));
    let bound = bound.map_err(|why| {
        LiveError::Request(format!("--tcp {address}: can't listen there ({why}); choose another port"))
    })?;
    if let Ok(at) = bound.local_addr() {
        tell(&format!("rows are at tcp:{at}"));
    }
    Ok(bound)
}

/// A stream of the Lab Streaming Layer, where there is one.
#[derive(Default)]
struct Outlet {
    #[cfg(feature = "lsl")]
    open: Option<LslOutlet>,
    #[cfg(feature = "lsl")]
    values: Vec<f64>,
}

#[cfg(feature = "lsl")]
impl Outlet {
    fn new(name: &str, labels: &[String]) -> Result<Self, String> {
        let outlet = LslOutlet::new(name, "Prediction", &format!("lunula-{name}"), labels, None)?;
        Ok(Self { open: Some(outlet), values: Vec::with_capacity(labels.len()) })
    }

    fn push(&mut self, row: &AnswerRow<'_>, has_switch: bool) -> Result<(), LiveError> {
        let Some(open) = &self.open else { return Ok(()) };
        self.values.clear();
        self.values.extend(row.finger.map(|(_, place)| place as f64));
        self.values.extend(row.seen.answers);
        if has_switch {
            self.values.push(row.seen.pressed.map_or(f64::NAN, |pressed| f64::from(u8::from(pressed))));
        }
        open.push(&self.values).map_err(LiveError::Request)
    }

    fn is_open(&self) -> bool {
        self.open.is_some()
    }
}

#[cfg(not(feature = "lsl"))]
impl Outlet {
    fn new(_: &str, _: &[String]) -> Result<Self, String> {
        let what = "streams of the Lab Streaming Layer are not built in; leave out --lsl, or build with the feature \
                    `lsl`";
        Err(what.to_owned())
    }

    #[allow(clippy::unused_self, clippy::unnecessary_wraps, reason = "as with the feature")]
    fn push(&mut self, _: &AnswerRow<'_>, _: bool) -> Result<(), LiveError> {
        Ok(())
    }

    #[allow(clippy::unused_self, reason = "as with the feature")]
    fn is_open(&self) -> bool {
        false
    }
}
