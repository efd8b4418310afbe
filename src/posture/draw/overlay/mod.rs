//! What was tracked, drawn on a copy of each frame and written as a video with the same times.
//!
//! In: each frame, what it shows of each marker, the segments between markers, texts of the angles. Out: an H.264 file,
//! upright, 8-bit 4:2:0. A marker that is seen has a circle of its radius, a cross at its centre and its name; one that
//! is lost, its name with the reason in a corner. Nothing is converted to red, green and blue: the drawing is done in
//! the video's own planes.

mod canvas;
mod labels;
mod upright;

use std::path::Path;

use self::canvas::{Canvas, Text};
use crate::posture::marker::sight::{Centre, Sight};
use crate::posture::run::report::in_words;
use crate::video::{Encoder, Encoding, Frame, Info, Picture, Turn, VideoError};

/// Ticks a second, where those of the video do not fit.
const TICKS_PER_S: i32 = 90_000;
/// Most ticks a second that are kept from the video.
const MOST_TICKS_PER_S: i64 = 10_000_000;
/// Height of a text, of the picture's.
const TEXT_HEIGHT: f64 = 1.0 / 42.0;
/// Least height of a text, pixels.
const LEAST_TEXT_PX: f64 = 11.0;
/// Arms of the cross at a centre, of the marker's radius.
const ARM: f64 = 0.35;

/// A marker to draw.
pub(crate) struct Mark<'a> {
    pub(crate) name: &'a str,
    /// What the frame shows of it, in coordinates of the stored picture.
    pub(crate) sight: Sight,
}

impl Mark<'_> {
    fn seen(&self) -> Option<(&str, Centre)> {
        match self.sight {
            Sight::Seen(centre) => Some((self.name, centre)),
            Sight::Lost(_) => None,
        }
    }

    fn lost(&self) -> Option<String> {
        match self.sight {
            Sight::Seen(_) => None,
            Sight::Lost(why) => Some(format!("{} lost: {}", self.name, in_words(why))),
        }
    }
}

/// What to draw on a frame.
#[derive(Default)]
pub(crate) struct Drawing<'a> {
    /// The markers.
    pub(crate) marks: Vec<Mark<'a>>,
    /// Segments, by their markers' places in `marks`; drawn where both are seen.
    pub(crate) segments: Vec<[usize; 2]>,
    /// Lines of text: the angles.
    pub(crate) texts: Vec<String>,
}

/// A video being drawn.
pub(crate) struct Overlay {
    encoder: Encoder,
    info: Info,
    ticks_per_s: i32,
    picture: Picture,
}

impl Overlay {
    /// Starts the file `path` for a video of `info`.
    pub(crate) fn create(path: &Path, info: &Info) -> Result<Self, VideoError> {
        let format = upright::shown_format(info);
        // Every time is a whole number of ticks, so also one of their denominator's parts of a second.
        let parts = info.tick_s.1;
        let ticks_per_s =
            i32::try_from(parts).ok().filter(|_| (1..=MOST_TICKS_PER_S).contains(&parts)).unwrap_or(TICKS_PER_S);
        let aspect = match info.turn {
            Turn::None | Turn::Half => info.pixel_aspect,
            Turn::Quarter | Turn::ThreeQuarters => info.pixel_aspect.recip(),
        };
        let encoding = Encoding {
            matrix: info.matrix,
            chroma_site: info.chroma_site.filter(|_| info.turn == Turn::None),
            pixel_aspect: ((aspect * 10_000.0).round() as i32, 10_000),
            crf: 20,
            preset: "veryfast",
            ticks_per_s,
            ticks_a_picture: i64::from(ticks_per_s) / 30,
            ..Encoding::new(format)
        };
        let encoder = Encoder::create(path, &encoding)?;
        Ok(Self { encoder, info: info.clone(), ticks_per_s, picture: Picture::new(format) })
    }

    pub(crate) fn add(&mut self, frame: &Frame<'_>, drawing: &Drawing<'_>) -> Result<(), VideoError> {
        upright::copy(frame, &self.info, &mut self.picture);
        self.draw(frame.index, frame.time_s, drawing);
        self.push(frame.time_s)
    }

    /// Adds an empty picture for a frame that could not be decoded.
    pub(crate) fn add_missing(&mut self, index: u64, time_s: f64) -> Result<(), VideoError> {
        for plane in &mut self.picture.planes {
            plane.fill(128);
        }
        let missing = Drawing { texts: vec!["not decoded".into()], ..Drawing::default() };
        self.draw(index, time_s, &missing);
        self.push(time_s)
    }

    /// Ends the file.
    pub(crate) fn finish(self) -> Result<(), VideoError> {
        self.encoder.finish()
    }

    fn push(&mut self, time_s: f64) -> Result<(), VideoError> {
        self.encoder.push(&self.picture, (time_s * f64::from(self.ticks_per_s)).round() as i64)
    }

    fn draw(&mut self, index: u64, time_s: f64, drawing: &Drawing<'_>) {
        let size = (self.info.format.width, self.info.format.height);
        let (width, height) = upright::shown_size(&self.info);
        let turn = self.info.turn;
        let shown = |at: [f64; 2]| turn.shown_from_stored(at, size);
        let matrix = &self.info.matrix;
        let mut canvas = Canvas {
            white: matrix.from_rgb([1.0; 3])[0] as u8,
            black: matrix.from_rgb([0.0; 3])[0] as u8,
            line_px: (height as f64 / 720.0).round().clamp(1.0, 200.0) as u8,
            picture: &mut self.picture,
        };
        let text_px = (TEXT_HEIGHT * height as f64).max(LEAST_TEXT_PX);
        let step = 1.25 * text_px;

        for segment in &drawing.segments {
            if let [Some((_, one)), Some((_, other))] = segment.map(|mark| drawing.marks[mark].seen()) {
                canvas.line(shown(one.at_px), shown(other.at_px));
            }
        }
        let mut lines = vec![format!("frame {index}   {time_s:.3} s")];
        lines.extend(drawing.texts.iter().cloned());
        let mut taken = Vec::new();
        for (k, line) in lines.iter().enumerate() {
            let (at, text) = ([0.5 * text_px, 0.4 * text_px + step * k as f64], Text::new(line, text_px));
            taken.push(boxed(at, text.size()));
            canvas.text(&text, at);
        }
        let lost: Vec<String> = drawing.marks.iter().filter_map(Mark::lost).collect();
        let top = height as f64 - step * lost.len() as f64 - 0.4 * text_px;
        for (k, line) in lost.iter().enumerate() {
            canvas.text(&Text::new(line, text_px), [0.5 * text_px, top + step * k as f64]);
        }

        let seen: Vec<_> =
            drawing.marks.iter().filter_map(Mark::seen).map(|(n, c)| (n, shown(c.at_px), c.radius_px)).collect();
        taken.extend(seen.iter().map(|&(_, [x, y], r)| [x - r, y - r, x + r, y + r]));
        for &(name, at, radius) in &seen {
            let text = Text::new(name, text_px);
            let label = labels::place(at, radius, text.size(), (width as f64, height as f64), &taken);
            taken.push(label);
            canvas.text(&text, [label[0], label[1]]);
            // To the name's nearest corner, from the circle on.
            let corner = [at[0].clamp(label[0], label[2]), at[1].clamp(label[1], label[3])];
            let away = (corner[0] - at[0]).hypot(corner[1] - at[1]);
            if away > radius {
                let out = [0, 1].map(|k| at[k] + (corner[k] - at[k]) * radius / away);
                canvas.line(out, corner);
            }
        }
        for &(_, at, radius) in &seen {
            canvas.circle(at, radius);
            canvas.plus(at, (ARM * radius).max(2.0));
        }
    }
}

fn boxed([x, y]: [f64; 2], (width, height): (f64, f64)) -> labels::Box4 {
    [x, y, x + width, y + height]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::posture::marker::sight::Loss;
    use crate::video::{Format, Item, Video};

    pub(in crate::posture) fn info(format: Format, turn: Turn) -> Info {
        Info { turn, ..Info::plain(format) }
    }

    const SIZE: Format = Format { width: 160, height: 121, subsampling: Some((2, 2)), depth: 8 };

    fn mark(name: &str, at_px: [f64; 2]) -> Mark<'_> {
        let centre = Centre { at_px, covariance_px2: [0.01, 0.0, 0.01], lasting_px2: [0.0; 3], radius_px: 9.0 };
        Mark { name, sight: Sight::Seen(centre) }
    }

    fn grey() -> Picture {
        let mut picture = Picture::new(SIZE);
        picture.planes.iter_mut().for_each(|plane| plane.fill(110));
        picture
    }

    #[test]
    fn frames_keep_their_times_and_stand_upright() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("overlay.mp4");
        let times = [0.0, 0.033, 0.07, 0.101, 0.137];
        for turn in [Turn::None, Turn::Quarter] {
            let mut overlay = Overlay::create(&path, &info(SIZE, turn)).unwrap();
            for (index, time_s) in times.into_iter().enumerate() {
                let drawing = Drawing { marks: vec![mark("tip", [80.0, 60.0])], ..Drawing::default() };
                if index == 3 {
                    overlay.add_missing(3, time_s).unwrap();
                } else {
                    overlay.add(&grey().frame(index as u64, time_s), &drawing).unwrap();
                }
            }
            overlay.finish().unwrap();
            let mut video = Video::open(&path, 1).unwrap();
            let (width, height) = (video.info().format.width, video.info().format.height);
            assert_eq!((width, height), if turn == Turn::None { (160, 122) } else { (122, 160) });
            assert_eq!(video.info().turn, Turn::None);
            for time_s in times {
                let Some(Item::Frame(frame)) = video.next_item().unwrap() else { panic!("a frame at {time_s}") };
                assert!((frame.time_s - time_s).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn a_seen_marker_has_its_circle_where_it_is_shown() {
        let turn = Turn::ThreeQuarters;
        let info = info(SIZE, turn);
        let picture = grey();
        let mut shown = Picture::new(upright::shown_format(&info));
        upright::copy(&picture.frame(0, 0.0), &info, &mut shown);
        let folder = tempfile::tempdir().unwrap();
        let mut overlay = Overlay::create(&folder.path().join("a.mp4"), &info).unwrap();
        let at = [100.0, 70.0];
        let lost = Mark { name: "x", sight: Sight::Lost(Loss::Hidden) };
        overlay.picture = shown;
        let drawing = Drawing {
            marks: vec![mark("", at), lost, mark("", [100.0, 30.0])],
            segments: vec![[0, 2], [0, 1]],
            ..Drawing::default()
        };
        overlay.draw(0, 0.0, &drawing);
        let luma = |place: [f64; 2]| {
            let [x, y] = turn.shown_from_stored(place, (160, 121));
            overlay.picture.planes[0][y as usize * overlay.picture.format.width + x as usize]
        };
        assert!(luma([109.0, 70.0]) > 180 && luma([100.0, 79.0]) > 180, "the circle");
        assert!(luma(at) > 180, "the cross");
        assert!(luma([100.0, 50.0]) > 180, "the segment");
        assert_eq!(luma([65.0, 50.0]), 110, "no segment to a lost marker");
        assert_eq!(luma([104.0, 74.0]), 110, "the marker itself");
    }
}
