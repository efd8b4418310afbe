//! The Lab Streaming Layer: one stream in, and one out.
//!
//! A thread takes samples from the network and writes them, with their time on this machine's clock, as lines into a
//! socket pair that the loop reads like any other port. The layer finds a source that was lost again by itself.

use std::io::Write;
use std::os::unix::net::UnixStream;
use std::time::Duration;

use labstream::{Channel, Chunk, Format, Inlet, Outlet, Post, Query, StreamInfo, resolve_all};

use super::Port;
use crate::source::address::LslQuery;

/// The time in which streams in the network answer.
const ANSWER: Duration = Duration::from_secs(2);

/// The time after which the thread looks whether anyone reads.
const PATIENCE: Duration = Duration::from_millis(100);

/// The most samples that are taken together.
const SAMPLES: usize = 1024;

/// Opens the one stream that a query finds; with the names of its columns, of which the first is the time.
///
/// # Errors
/// There is none, there are several, or it can't be opened.
pub(in crate::source) fn open(query: &LslQuery) -> Result<(Port, Vec<String>), String> {
    let failed = |why: labstream::Error| format!("cannot be opened ({why})");
    let parts = [
        query.name.as_deref().map(Query::name),
        query.kind.as_deref().map(Query::stream_type),
        query.source_id.as_deref().map(Query::source_id),
    ];
    let query = parts.into_iter().flatten().reduce(Query::and).unwrap_or_else(Query::all);
    let found = resolve_all(&query, ANSWER).map_err(failed)?;
    let info = match &found[..] {
        [one] => one,
        [] => {
            let others = resolve_all(&Query::all(), ANSWER).map_err(failed)?;
            return Err(match &others[..] {
                [] => "is not found, nor any other stream; start it, in this network".to_owned(),
                others => format!("is not found; there are: {}", listed(others)),
            });
        }
        several => {
            let all = listed(several);
            return Err(format!("could be any of {}: {all}; write one's `source_id`", several.len()));
        }
    };
    let inlet = Inlet::builder(info).postprocess(Post::CLOCK_SYNC).open(ANSWER).map_err(failed)?;
    // Labels are in the long description only.
    let names = names(&info.fetch(ANSWER).map_err(failed)?);
    let (ours, theirs) = UnixStream::pair().map_err(|why| format!("cannot be read ({why})"))?;
    ours.set_nonblocking(true).map_err(|why| format!("cannot be read ({why})"))?;
    let thread = std::thread::Builder::new().name("lsl".to_owned());
    thread.spawn(move || pump(inlet, theirs)).map_err(|why| format!("cannot be read ({why})"))?;
    Ok((Port::Lsl(ours), names))
}

fn listed(streams: &[StreamInfo]) -> String {
    let one = |info: &StreamInfo| format!("`{}` ({}, source_id {})", info.name(), info.stream_type(), info.source_id());
    streams.iter().map(one).collect::<Vec<_>>().join(", ")
}

/// The time's name and those of the channels; nameless ones are P1, P2.
fn names(info: &StreamInfo) -> Vec<String> {
    let labels = info.channels();
    let label = |k: usize| {
        labels
            .get(k)
            .map(|channel| channel.label.clone())
            .filter(|label| !label.is_empty())
            .unwrap_or(format!("P{}", k + 1))
    };
    ["time_s".to_owned()].into_iter().chain((0..info.channel_count()).map(label)).collect()
}

/// Writes samples as lines until nobody reads them.
fn pump(mut inlet: Inlet, mut to: UnixStream) {
    let channels = inlet.info().channel_count();
    let mut chunk = Chunk::<f64>::new(channels, SAMPLES);
    let mut text = Vec::new();
    loop {
        chunk.clear();
        text.clear();
        if inlet.pull_chunk(&mut chunk, PATIENCE).is_err() || inlet.is_finished() {
            return;
        }
        for (time_s, sample) in chunk.iter() {
            // Into memory, which does not fail.
            let _ = write!(text, "{time_s}");
            sample.iter().for_each(|value| drop(write!(text, "\t{value}")));
            text.push(b'\n');
        }
        // An empty write would not notice that the other end is closed.
        if to.write_all(if text.is_empty() { b"\n" } else { &text }).is_err() {
            return;
        }
    }
}

/// A stream of rows that others in the network read.
pub struct LslOutlet(Outlet);

impl LslOutlet {
    /// Announces a stream of doubles, one for each label, at a rate in hertz; of an irregular one without.
    ///
    /// # Errors
    /// The network can't be used.
    pub fn new(
        name: &str,
        kind: &str,
        source_id: &str,
        labels: &[String],
        rate_hz: Option<f64>,
    ) -> Result<Self, String> {
        let channels = labels.iter().map(|label| Channel::new(label));
        let builder = StreamInfo::builder(name, kind, Format::Double64).source_id(source_id).channels(channels);
        let builder = match rate_hz {
            Some(rate_hz) => builder.rate(rate_hz),
            None => builder.irregular(),
        };
        let failed = |why: labstream::Error| format!("lsl: `{name}` cannot be announced ({why})");
        Ok(Self(Outlet::new(builder.build().map_err(failed)?).map_err(failed)?))
    }

    /// Sends a row, stamped with this machine's clock.
    ///
    /// # Errors
    /// It has another number of values than there are labels.
    pub fn push(&self, row: &[f64]) -> Result<(), String> {
        self.0.push(row).map_err(|why| format!("lsl: {why}"))
    }

    /// Whether anyone reads it.
    #[must_use]
    pub fn has_readers(&self) -> bool {
        self.0.has_consumers()
    }
}
