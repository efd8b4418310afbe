//! Frames of a video file, in the order of presentation.
//!
//! In: a file of any container and codec that FFmpeg reads. Out: each frame with its index, its time from the first
//! shown frame's (the container's ticks, exactly: variable rate, edit lists, reordered frames), its planes as they were
//! decoded; and, in their places, the frames that could not be decoded, so that the index stays right.
//!
//! A frame counts as not decodable ([`Item::Missing`]) when its packet is damaged, and also when it may be predicted
//! from a damaged one: all frames decoded after it up to the next key frame, as it can't be known how far the damage
//! reaches. A flipped bit that still decodes without a contradiction can't be noticed: videos carry no checksums. Nor
//! can a packet whose very header in the container is damaged (Matroska, transport streams): later times stay right,
//! the index lacks it. The result does not depend on the number of threads (but where HEVC is damaged without FFmpeg's
//! noticing); after the first damage a file is read with one, and H.264 always.

use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::time::Duration;

use ffmpeg::frame;
use ffmpeg::frame::side_data::Type;
use ffmpeg_next as ffmpeg;

use crate::video::colour::convert;
use crate::video::colour::hdr::ToOrdinary;
use crate::video::info::{info, is_grey};
use crate::video::quantizer;
use crate::video::read::ahead::{Events, Told, most_waiting};
use crate::video::read::reader::{Alarm, Event, Reader};
use crate::video::read::source::Care;
use crate::video::{Format, Frame, Info, Matrix, VideoError};

/// What comes next of a video.
#[derive(Debug)]
pub enum Item<'a> {
    /// A frame.
    Frame(Frame<'a>),
    /// A frame of the container that could not be decoded.
    Missing {
        /// Its place in the order of presentation.
        index: u64,
        /// Its presentation time from the first frame's.
        time_s: f64,
    },
}

/// How a video ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum End {
    /// There may be more frames.
    NotReached,
    /// Nothing speaks for more frames than were given.
    Whole,
    /// The file ends before its video does; why, in words for the user.
    Early(String),
}

/// An open video file.
///
/// ```
/// use std::path::Path;
///
/// use lunula::video::{Item, Video};
///
/// let mut video = Video::open(Path::new("fixtures/finger/video.mp4"), 1)?;
/// let (mut frames, mut last_s) = (0, 0.0);
/// while let Some(item) = video.next_item()? {
///     if let Item::Frame(frame) = item {
///         (frames, last_s) = (frames + 1, frame.time_s);
///     }
/// }
/// assert_eq!((frames, format!("{last_s:.3}")), (60, "1.967".to_owned()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Video {
    pub(in crate::video) path: PathBuf,
    threads: usize,
    /// None while it is handed over.
    events: Option<Events>,
    /// How many frames ahead another thread decodes, and how long decoding took.
    frames_ahead: usize,
    decoding: Duration,
    /// Events read ahead, to know the first frame.
    ahead: VecDeque<Event>,
    /// Events to pass over, after a second start.
    known: u64,
    first_ticks: Option<i64>,
    next_index: u64,
    /// The first frame's width, height and layout.
    layout: (u32, u32, ffmpeg::format::Pixel),
    /// Of HDR.
    ordinary: Option<ToOrdinary>,
    /// See [`Frame::quantizer`].
    quantizer: Option<f64>,
    /// The frame handed out last.
    pub(in crate::video) picture: frame::Video,
    info: Info,
    end: End,
    /// Frames that could not be decoded, and number and time of the first.
    missing: u64,
    first_missing: Option<(u64, f64)>,
}

impl Video {
    /// Opens `path`, to be decoded with `threads` threads (0: all cores).
    ///
    /// # Errors
    /// When there is no such file, or no video in it of which a frame can be decoded.
    pub fn open(path: &Path, threads: usize) -> Result<Self, VideoError> {
        Self::open_with(path, threads, Care::Fast)
    }

    fn open_with(path: &Path, threads: usize, care: Care) -> Result<Self, VideoError> {
        let failed = |what: String| VideoError::open(path, what);
        let mut reader = Reader::open(path, threads, care)?;
        let mut ahead = VecDeque::new();
        let first = loop {
            match reader.next_event() {
                Ok(Some(event)) => {
                    ahead.push_back(event);
                    if let Some(Event { picture: Some(first), .. }) = ahead.back() {
                        break first;
                    }
                }
                Ok(None) => return Err(failed(nothing_decoded(&reader, ahead.len()))),
                Err(Alarm) => return Self::open_with(path, threads, Care::Exact),
            }
        };
        let layout = (first.width(), first.height(), first.format());
        let planes = convert::planes(first).map_err(failed)?;
        let mut info = info(
            &reader.source,
            first,
            planes.as_ref().unwrap_or(first),
            reader.rate_without_times_hz(),
            reader.tick_s(),
        )
        .map_err(failed)?;
        if info.grey && info.format.subsampling.is_some() {
            info.grey = begins_grey(path, threads, &info.format)?;
        }
        let ordinary = ToOrdinary::new(info.format, &info.matrix, info.chroma_site);
        if ordinary.is_some() {
            info.matrix = Matrix::BT709;
        }
        Ok(Self {
            path: path.to_owned(),
            threads,
            events: Some(Events::of(Box::new(reader), 0)),
            frames_ahead: 0,
            decoding: Duration::ZERO,
            ahead,
            known: 0,
            first_ticks: None,
            next_index: 0,
            layout,
            ordinary,
            quantizer: None,
            picture: frame::Video::empty(),
            info,
            end: End::NotReached,
            missing: 0,
            first_missing: None,
        })
    }

    /// From here on a thread of its own decodes some frames ahead; what comes out is the same.
    pub fn decode_ahead(&mut self) {
        if let Some(Events::Here(reader)) = self.events.take_if(|events| matches!(events, Events::Here(_))) {
            let (width, height, _) = self.layout;
            self.frames_ahead = most_waiting(width as usize * height as usize);
            self.events = Some(Events::of(reader, self.frames_ahead));
        }
    }

    /// How long decoding took so far, whoever decoded.
    #[must_use]
    pub fn decoding(&self) -> Duration {
        self.decoding
    }

    /// What is known of the video.
    #[must_use]
    pub fn info(&self) -> &Info {
        &self.info
    }

    /// How the video ended, once [`Self::next_item`] has given none.
    #[must_use]
    pub fn end(&self) -> &End {
        &self.end
    }

    /// What of the video could not be read, once it was read: each with what to do.
    #[must_use]
    pub fn damage(&self) -> Vec<String> {
        let path = self.path.display();
        let undecoded = self.first_missing.map(|(index, time_s)| {
            format!(
                "{path}: {} of {} frames could not be decoded, the first of them frame {index} at {time_s:.3} s; their \
                 rows are empty; copy the file again if its original is whole",
                self.missing, self.next_index
            )
        });
        let early = if let End::Early(why) = &self.end { Some(format!("{path}: {why}")) } else { None };
        undecoded.into_iter().chain(early).collect()
    }

    /// The next frame; none at the end.
    ///
    /// # Errors
    /// When the picture's size or layout changes.
    pub fn next_item(&mut self) -> Result<Option<Item<'_>>, VideoError> {
        let Some(event) = self.next_event()? else { return Ok(None) };
        let index = self.next_index;
        self.next_index += 1;
        let first = *self.first_ticks.get_or_insert(event.ticks);
        let (over, under) = self.info.tick_s;
        let time_s = ((event.ticks - first) as f64 * over as f64) / under as f64;
        let Some(picture) = event.picture else {
            self.missing += 1;
            self.first_missing.get_or_insert((index, time_s));
            return Ok(Some(Item::Missing { index, time_s }));
        };
        self.take(picture, index)?;
        Ok(Some(Item::Frame(self.borrow(index, time_s))))
    }

    /// Decodes all frames that are left and looks at none: what any use of them takes at least.
    ///
    /// # Errors
    /// As [`Self::next_item`].
    pub fn count_rest(&mut self) -> Result<u64, VideoError> {
        let mut frames = 0;
        while let Some(item) = self.next_item()? {
            frames += u64::from(matches!(item, Item::Frame(_)));
        }
        Ok(frames)
    }

    fn next_event(&mut self) -> Result<Option<Event>, VideoError> {
        loop {
            let told = match (self.ahead.pop_front(), &mut self.events) {
                (Some(event), _) => Told { event: Ok(Some(event)), cut: None, took: Duration::ZERO },
                (None, Some(events)) => events.next(),
                (None, None) => return Ok(None),
            };
            self.decoding += told.took;
            match told.event {
                Ok(Some(_)) if self.known > 0 => self.known -= 1,
                Ok(Some(event)) => return Ok(Some(event)),
                Ok(None) => {
                    self.end = told.cut.map_or(End::Whole, End::Early);
                    return Ok(None);
                }
                Err(Alarm) => {
                    let reader = Reader::open(&self.path, self.threads, Care::Exact)?;
                    self.events = Some(Events::of(Box::new(reader), self.frames_ahead));
                    self.known = self.next_index;
                }
            }
        }
    }

    /// The picture as planes that can be borrowed.
    fn take(&mut self, picture: frame::Video, index: u64) -> Result<(), VideoError> {
        let layout = (picture.width(), picture.height(), picture.format());
        let changed = |what: String| VideoError::Changed { path: self.path.clone(), what };
        if layout != self.layout {
            let words = |(width, height, pixel): (u32, u32, ffmpeg::format::Pixel)| {
                format!("{width}x{height} {}", pixel.descriptor().map_or("?", |known| known.name()))
            };
            return Err(changed(format!(
                "the picture changes from {} to {} at frame {index}; split the video there",
                words(self.layout),
                words(layout)
            )));
        }
        let converted = convert::planes(&picture).map_err(|words| changed(format!("frame {index}: {words}")))?;
        self.quantizer = quantizer_of(&picture, self.info.format.depth);
        let picture = converted.unwrap_or(picture);
        self.picture = self.ordinary.as_ref().map(|ordinary| ordinary.frame(&picture)).unwrap_or(picture);
        Ok(())
    }

    fn borrow(&self, index: u64, time_s: f64) -> Frame<'_> {
        let planes = |number: usize, _| (self.picture.stride(number), self.picture.data(number));
        let (luma, chroma) = self.info.format.planes(planes);
        Frame { index, time_s, luma, chroma, quantizer: self.quantizer }
    }
}

/// So many frames may a film begin with that are grey (assumed: five seconds of black, a title, a fade).
const LEAD_FRAMES: u32 = 150;

/// Whether the first frames of a film are all grey: it may begin in black, with a title, or fade in.
fn begins_grey(path: &Path, threads: usize, format: &Format) -> Result<bool, VideoError> {
    let mut reader = Reader::open(path, threads, Care::Fast)?;
    for _ in 0..LEAD_FRAMES {
        // What can't be decoded is said by whoever reads the film.
        let Ok(Some(event)) = reader.next_event() else { break };
        let Some(picture) = event.picture else { continue };
        let planes = convert::planes(&picture).unwrap_or_default();
        if !is_grey(planes.as_ref().unwrap_or(&picture), format) {
            return Ok(false);
        }
    }
    Ok(true)
}

fn nothing_decoded(reader: &Reader, missing: usize) -> String {
    if reader.packets == 0 {
        "holds a video without frames; record or copy it again".into()
    } else {
        format!(
            "none of its {} frames can be decoded; it is damaged or its codec ({}) is not the one that it names",
            missing.max(reader.packets as usize),
            reader.source.codec.name()
        )
    }
}

fn quantizer_of(picture: &frame::Video, depth: u32) -> Option<f64> {
    let parameter = quantizer::mean(picture.side_data(Type::VIDEO_ENC_PARAMS)?.data())?;
    Some(parameter - quantizer::A_BIT * f64::from(depth.saturating_sub(8)))
}
