//! Decoding in the order of presentation, with the frames that are missing.
//!
//! What comes out does not depend on the number of threads: with several, the first fault ends the fast reading
//! ([`Alarm`]), and whoever reads starts again with [`Care::Exact`], where each fault is known with its packet. Up to
//! the alarm both give the same: a packet's fault is reported before anything of that packet comes out.

use std::collections::VecDeque;

use ffmpeg::codec::Id;
use ffmpeg::frame;
use ffmpeg_next as ffmpeg;

use crate::video::VideoError;
use crate::video::read::order::{Order, Sent};
use crate::video::read::source::{Care, Piece, Source};

/// A fault was met in fast reading.
pub(in crate::video) struct Alarm;

/// A frame or its lack.
pub(in crate::video) struct Event {
    /// None where it is missing.
    pub(in crate::video) picture: Option<frame::Video>,
    /// When it is shown, in ticks of [`Reader::tick_s`].
    pub(in crate::video) ticks: i64,
    /// What the order goes by: the presentation time or, without one, the packet's number.
    key: i64,
}

/// What ticks are.
enum Times {
    /// The packets' own presentation times.
    Presentation,
    /// Without those, the packets' decoding times in their order, as far as no frame has taken them.
    Decoding(VecDeque<i64>),
    /// Without any, a count.
    Counted(i64),
}

/// Reads a stream.
pub(in crate::video) struct Reader {
    pub(in crate::video) source: Source,
    care: Care,
    order: Order,
    ready: VecDeque<(Sent, Event)>,
    times: Option<Times>,
    number: u64,
    group: u64,
    /// Presentation time of the group's key frame.
    key_pts: i64,
    last_pts: i64,
    drained: bool,
    /// Packets seen.
    pub(in crate::video) packets: u64,
    /// The last packet was not all there.
    pub(in crate::video) last_is_partial: bool,
    /// Why reading stopped before the end.
    stopped_by: Option<ffmpeg::Error>,
    /// The file ended early, in words.
    pub(in crate::video) cut: Option<String>,
    /// Of frames up to this key it is certain that none lacks before them. A frame to come is decoded after all that
    /// are there, and none is shown before it is decoded: that is the last packet's decoding time.
    certain_to: i64,
}

/// How far frames may stand from their packets' order.
fn may_be_reordered(codec: Id) -> i64 {
    if matches!(codec, Id::H264 | Id::HEVC) { 16 } else { 2 }
}

/// Frames held until it is certain that none lacks before them, at most.
const MOST_HELD: usize = 32;

impl Reader {
    pub(in crate::video) fn open(path: &std::path::Path, threads: usize, care: Care) -> Result<Self, VideoError> {
        let source = Source::open(path, threads, care)?;
        let mut order = Order::default();
        order.only_damaged = source.codec == Id::VP8;
        Ok(Self {
            source,
            care,
            order,
            ready: VecDeque::new(),
            times: None,
            number: 0,
            group: 0,
            key_pts: i64::MIN,
            last_pts: i64::MIN,
            drained: false,
            packets: 0,
            last_is_partial: false,
            stopped_by: None,
            cut: None,
            certain_to: i64::MIN,
        })
    }

    /// Seconds a tick as a fraction.
    pub(in crate::video) fn tick_s(&self) -> (i64, i64) {
        match (&self.times, self.source.stream()) {
            (Some(Times::Counted(_)), _) => {
                let rate = self.rate();
                (i64::from(rate.1), i64::from(rate.0))
            }
            (_, Some(stream)) => (i64::from(stream.time_base().0), i64::from(stream.time_base().1)),
            (_, None) => (1, 1),
        }
    }

    /// Frames a second, where no frame has a time.
    pub(in crate::video) fn rate_without_times_hz(&self) -> Option<f64> {
        matches!(self.times, Some(Times::Counted(_))).then(|| f64::from(self.rate()))
    }

    fn rate(&self) -> ffmpeg::Rational {
        let known = |rate: ffmpeg::Rational| Some(rate).filter(|rate| rate.0 > 0 && rate.1 > 0);
        let stream = self.source.stream();
        stream
            .and_then(|stream| known(stream.avg_frame_rate()).or_else(|| known(stream.rate())))
            .unwrap_or(ffmpeg::Rational(25, 1))
    }

    /// The next frame or its lack; none at the end.
    pub(in crate::video) fn next_event(&mut self) -> Result<Option<Event>, Alarm> {
        loop {
            if let Some(event) = self.hand_out() {
                return Ok(Some(event));
            }
            let mut picture = frame::Video::empty();
            match self.source.decoder.receive_frame(&mut picture) {
                Ok(()) => self.came_out(picture)?,
                Err(ffmpeg::Error::Eof) if self.ready.is_empty() => return Ok(None),
                Err(ffmpeg::Error::Eof) => {}
                Err(error) if self.care == Care::Fast && !is_again(&error) => return Err(Alarm),
                Err(_) if self.drained => {}
                Err(_) => self.feed()?,
            }
        }
    }

    /// The first that is ready, once nothing new can be heard of it: frames may be predicted from one that is shown
    /// after them and turns out to be damaged, and the file may end before one that is shown before them.
    fn hand_out(&mut self) -> Option<Event> {
        loop {
            let (sent, event) = self.ready.front()?;
            if self.order.awaits_before(sent.number) && self.ready.len() <= MOST_HELD {
                return None;
            }
            if event.key > self.certain_to {
                if self.drained {
                    self.ready.clear();
                    return None;
                }
                if self.ready.len() <= MOST_HELD {
                    return None;
                }
            }
            let (sent, mut event) = self.ready.pop_front()?;
            if self.order.is_damaged(&sent) {
                event.picture = None;
            }
            if event.picture.is_some() || !sent.prelude {
                return Some(event);
            }
        }
    }

    fn came_out(&mut self, picture: frame::Video) -> Result<(), Alarm> {
        self.order.only_damaged |= picture.is_interlaced();
        let Some(key) = picture.pts() else { return Ok(()) };
        let (missing, sent) = self.order.came_out(key);
        self.alarm_if_unexplained(&missing)?;
        for (key, sent) in missing {
            self.push(key, sent, None);
        }
        let Some(sent) = sent else { return Ok(()) };
        if sent.prelude {
            if sent.group > 0 {
                return Ok(());
            }
            if self.care == Care::Fast {
                return Err(Alarm);
            }
        }
        if picture.is_corrupt() || picture.has_decode_errors() {
            if self.care == Care::Fast {
                return Err(Alarm);
            }
            self.order.damage(sent.number, sent.group);
        }
        self.push(key, sent, Some(picture));
        Ok(())
    }

    /// In fast reading, only packets that were not all there may make no frame.
    fn alarm_if_unexplained(&self, missing: &[(i64, Sent)]) -> Result<(), Alarm> {
        let unexplained = missing.iter().any(|(_, sent)| !self.order.is_damaged(sent));
        if self.care == Care::Fast && unexplained { Err(Alarm) } else { Ok(()) }
    }

    fn push(&mut self, key: i64, sent: Sent, picture: Option<frame::Video>) {
        let ticks = match &mut self.times {
            Some(Times::Decoding(times)) => times.pop_front().unwrap_or(key),
            Some(Times::Counted(count)) => {
                *count += 1;
                *count - 1
            }
            Some(Times::Presentation) | None => key,
        };
        self.ready.push_back((sent, Event { picture, ticks, key }));
    }

    fn feed(&mut self) -> Result<(), Alarm> {
        match self.source.next_piece() {
            Ok(Some(piece)) => self.send(piece),
            end => {
                self.stopped_by = end.err();
                self.drained = true;
                self.look_for_a_cut();
                match self.source.decoder.send_eof() {
                    // Threads may meet a fault only now.
                    Err(_) if self.care == Care::Fast => Err(Alarm),
                    _ => self.drain(),
                }
            }
        }
    }

    /// At the end of the file: whether it is the video's.
    fn look_for_a_cut(&mut self) {
        let declared = self.source.declared_frames();
        let so_far = match declared {
            Some(declared) => format!("it has data of {} of {declared} frames", self.packets),
            None => format!("it has data of {} frames", self.packets),
        };
        let all_there = declared.is_some_and(|declared| self.packets >= declared) && !self.last_is_partial;
        self.cut = if let Some(error) = &self.stopped_by {
            Some(format!("the file can't be read on ({error}): {so_far}"))
        } else if let (Some(bytes), false) = (self.source.extent.lacking, all_there) {
            Some(format!("the file is cut off, at least {bytes} bytes are lacking: {so_far}"))
        } else if self.last_is_partial {
            Some(format!("the file is cut off within a frame: {so_far}"))
        } else {
            self.certain_to = i64::MAX;
            None
        };
    }

    fn drain(&mut self) -> Result<(), Alarm> {
        loop {
            let mut picture = frame::Video::empty();
            match self.source.decoder.receive_frame(&mut picture) {
                Ok(()) => self.came_out(picture)?,
                Err(ffmpeg::Error::Eof) => break,
                Err(_) if self.care == Care::Fast => return Err(Alarm),
                Err(error) if is_again(&error) => break,
                Err(_) => {}
            }
        }
        let missing = self.order.end();
        self.alarm_if_unexplained(&missing)?;
        for (key, sent) in missing {
            self.push(key, sent, None);
        }
        Ok(())
    }

    fn send(&mut self, Piece { mut packet, hidden }: Piece) -> Result<(), Alarm> {
        self.packets += 1;
        self.number += 1;
        let times = self.times.get_or_insert_with(|| match (packet.pts(), packet.dts()) {
            (Some(_), _) => Times::Presentation,
            (None, Some(_)) => Times::Decoding(VecDeque::new()),
            (None, None) => Times::Counted(0),
        });
        let key = match times {
            Times::Presentation => packet.pts().unwrap_or(self.last_pts + packet.duration().max(1)),
            Times::Decoding(_) | Times::Counted(_) => self.number as i64,
        };
        if let Times::Decoding(times) = times
            && !hidden
        {
            let next = times.back().map_or(0, |last| last + 1);
            times.push_back(packet.dts().unwrap_or(next));
        }
        let in_order = !matches!(times, Times::Presentation);
        self.order.keys_are_numbers = in_order;
        self.order.only_damaged |= in_order;
        self.last_pts = key;
        self.certain_to = match packet.dts() {
            _ if !self.source.decoder.has_b_frames() => key,
            _ if in_order => key - may_be_reordered(self.source.codec),
            Some(dts) => dts,
            None => self.certain_to,
        };
        packet.set_pts(Some(key));
        if packet.is_key() {
            self.group += 1;
            self.key_pts = key;
        }
        let leading = key < self.key_pts;
        let sent = Sent {
            number: self.number,
            group: self.group,
            leading,
            prelude: self.group == 0 && self.source.may_start_anywhere || self.group == 1 && leading,
        };
        if !hidden && let Some((key, lost)) = self.order.sent(key, sent) {
            self.push(key, lost, None);
        }
        self.last_is_partial = packet.is_corrupt();
        if self.last_is_partial {
            self.order.damage(sent.number, sent.group);
            return Ok(());
        }
        match self.source.decoder.send_packet(&packet) {
            Ok(()) => Ok(()),
            Err(_) if self.care == Care::Fast => Err(Alarm),
            Err(_) => {
                self.order.damage(sent.number, sent.group);
                Ok(())
            }
        }
    }
}

fn is_again(error: &ffmpeg::Error) -> bool {
    *error == ffmpeg::Error::Other { errno: ffmpeg::error::EAGAIN }
}
