//! The chunks of an XDF file, put together to streams.
//!
//! A file is `XDF:` and chunks: a length (1, 4 or 8 bytes, as the byte before says), a tag of two bytes, the content.
//! Used are stream headers (2), samples (3) and clock offsets (4); all numbers are little-endian. A sample without a
//! stamp of its own comes one nominal interval after the one before. A file that ends within a chunk (the recorder was
//! stopped) is read up to there.

use std::collections::BTreeMap;

use roxmltree::{Document, Node};

/// A stream as it was recorded.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::log) struct Stream {
    pub(super) name: String,
    /// As the header says: `float32`, `string`, ..
    pub(super) format: String,
    /// Whether its values are numbers.
    pub(super) numeric: bool,
    /// Samples a second; 0 where they come when they come.
    pub(super) rate_hz: f64,
    /// Whether the source says that samples may be lost.
    pub(super) drops: bool,
    /// The channels' names.
    pub(super) labels: Vec<String>,
    /// The stamps, on the source's clock, seconds.
    pub(in crate::log) time_s: Vec<f64>,
    /// For each channel a value a sample; none of a stream of text.
    pub(in crate::log) channels: Vec<Vec<f64>>,
    /// Measurements of the clocks: the source's time, and what has to be added to it, seconds.
    pub(super) offsets_s: Vec<[f64; 2]>,
}

/// Channels of a stream, and of all in a file (assumed: the largest arrays of electrodes have some thousands). What
/// says more is damaged.
const MOST_CHANNELS: usize = 65_536;

/// Why reading stops.
enum Stop {
    /// The bytes end.
    End,
    /// They are not what they should be.
    Fault(String),
}

/// The bytes from a place on.
struct Bytes<'a>(&'a [u8]);

impl<'a> Bytes<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], Stop> {
        let (taken, rest) = self.0.split_at_checked(count).ok_or(Stop::End)?;
        self.0 = rest;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], Stop> {
        let (taken, rest) = self.0.split_first_chunk().ok_or(Stop::End)?;
        self.0 = rest;
        Ok(*taken)
    }

    fn f64(&mut self) -> Result<f64, Stop> {
        Ok(f64::from_le_bytes(self.array()?))
    }

    /// A length of 1, 4 or 8 bytes, as the byte before it says.
    fn length(&mut self) -> Result<usize, Stop> {
        match self.array()? {
            [1] => Ok(usize::from(self.array::<1>()?[0])),
            [4] => Ok(u32::from_le_bytes(self.array()?) as usize),
            [8] => usize::try_from(u64::from_le_bytes(self.array()?)).map_err(|_| Stop::End),
            [other] => Err(Stop::Fault(format!("a length of {other} bytes"))),
        }
    }
}

/// The streams of a file, in the order of their headers, and notes.
pub(super) fn streams(file: &[u8]) -> Result<(Vec<Stream>, Vec<String>), String> {
    let rest = file.strip_prefix(b"XDF:").ok_or("is no XDF file: it does not begin with `XDF:`")?;
    let mut bytes = Bytes(rest);
    let mut streams: Vec<Stream> = Vec::new();
    let mut places: BTreeMap<[u8; 4], usize> = BTreeMap::new();
    let mut notes = Vec::new();
    while !bytes.0.is_empty() {
        let at = file.len() - bytes.0.len();
        let content = match bytes.length().and_then(|length| bytes.take(length)) {
            Ok(content) => content,
            Err(Stop::End) => {
                notes.push(format!("the file ends within the chunk at byte {at}; what stands before it is read"));
                break;
            }
            Err(Stop::Fault(what)) => return Err(format!("the chunk at byte {at} can't be read ({what})")),
        };
        add(content, &mut streams, &mut places).map_err(|stop| match stop {
            Stop::End => format!("the chunk at byte {at} is shorter than what it should hold"),
            Stop::Fault(what) => format!("the chunk at byte {at} can't be read ({what})"),
        })?;
    }
    Ok((streams, notes))
}

fn add(content: &[u8], streams: &mut Vec<Stream>, places: &mut BTreeMap<[u8; 4], usize>) -> Result<(), Stop> {
    let mut content = Bytes(content);
    let tag = u16::from_le_bytes(content.array()?);
    if !matches!(tag, 2..=4) {
        return Ok(());
    }
    let id: [u8; 4] = content.array()?;
    if tag == 2 {
        places.insert(id, streams.len());
        streams.push(header(content.0).map_err(Stop::Fault)?);
        let channels: usize = streams.iter().map(|stream| stream.labels.len()).sum();
        if channels > MOST_CHANNELS {
            return Err(Stop::Fault(format!("{channels} channels; no file has more than {MOST_CHANNELS}")));
        }
        return Ok(());
    }
    let place = *places.get(&id).ok_or_else(|| Stop::Fault("a stream without a header".to_owned()))?;
    let stream = &mut streams[place];
    if tag == 4 {
        stream.offsets_s.push([content.f64()?, content.f64()?]);
        return Ok(());
    }
    samples(&mut content, stream)
}

fn samples(content: &mut Bytes<'_>, stream: &mut Stream) -> Result<(), Stop> {
    let interval_s = if stream.rate_hz > 0.0 { 1.0 / stream.rate_hz } else { 0.0 };
    for _ in 0..content.length()? {
        let time_s = match content.array()? {
            [0] => stream.time_s.last().copied().unwrap_or(0.0) + interval_s,
            [8] => content.f64()?,
            [other] => return Err(Stop::Fault(format!("a time stamp of {other} bytes"))),
        };
        if !stream.numeric {
            for _ in 0..stream.labels.len() {
                let length = content.length()?;
                content.take(length)?;
            }
        }
        for channel in &mut stream.channels {
            let value = match &stream.format[..] {
                "int8" => f64::from(i8::from_le_bytes(content.array()?)),
                "int16" => f64::from(i16::from_le_bytes(content.array()?)),
                "int32" => f64::from(i32::from_le_bytes(content.array()?)),
                "int64" => i64::from_le_bytes(content.array()?) as f64,
                "float32" => f64::from(f32::from_le_bytes(content.array()?)),
                _ => content.f64()?,
            };
            channel.push(value);
        }
        stream.time_s.push(time_s);
    }
    Ok(())
}

fn header(xml: &[u8]) -> Result<Stream, String> {
    let text = String::from_utf8_lossy(xml);
    let document = Document::parse(text.trim()).map_err(|why| format!("the stream's header: {why}"))?;
    let info = document.root_element();
    let said = |name: &str| child(info, name).and_then(|n| n.text()).unwrap_or("").trim();
    let count: usize = said("channel_count").parse().map_err(|_| "the header has no channel_count".to_owned())?;
    if count > MOST_CHANNELS {
        return Err(format!("the header says {count} channels; no stream has more than {MOST_CHANNELS}"));
    }
    let format = said("channel_format").to_owned();
    let numeric = ["int8", "int16", "int32", "int64", "float32", "double64"].contains(&&format[..]);
    if !numeric && format != "string" {
        return Err(format!("the channel format `{format}`"));
    }
    let described = child(info, "desc");
    let channels = described.and_then(|d| child(d, "channels"));
    let labelled = channels.into_iter().flat_map(|c| c.children()).filter(|n| n.has_tag_name("channel"));
    let mut labels: Vec<String> = labelled
        .map(|c| child(c, "label").and_then(|l| l.text()).unwrap_or("").trim().to_owned())
        .take(count)
        .collect();
    (labels.len()..count).for_each(|_| labels.push(String::new()));
    for (k, label) in labels.iter_mut().enumerate() {
        if label.is_empty() {
            *label = format!("ch{}", k + 1);
        }
    }
    let drops = described.and_then(|d| child(d, "synchronization")).and_then(|s| child(s, "can_drop_samples"));
    Ok(Stream {
        name: said("name").to_owned(),
        numeric,
        rate_hz: said("nominal_srate").parse().ok().filter(|rate: &f64| *rate > 0.0 && rate.is_finite()).unwrap_or(0.0),
        drops: drops.and_then(|n| n.text()).is_some_and(|text| text.trim().eq_ignore_ascii_case("true")),
        labels,
        time_s: Vec::new(),
        channels: vec![Vec::new(); if numeric { count } else { 0 }],
        offsets_s: Vec::new(),
        format,
    })
}

fn child<'a>(node: Node<'a, 'a>, name: &str) -> Option<Node<'a, 'a>> {
    node.children().find(|n| n.has_tag_name(name))
}
