//! What videos and logs take in words: choices, movements, spans, colours, panels, sizes.

use std::num::ParseFloatError;
use std::path::Path;

use crate::input;
use crate::nail::Positions;
use crate::phantom::motion::trajectory::Trajectory;
use crate::phantom::screen::Jump;
use crate::phantom::sensor::CHANNELS;
use crate::phantom::video::{Hide, Leave, Oblique};
use anyhow::Context;

/// A movement by its name or from a table, and how long a table goes on, seconds.
pub(super) fn trajectory(text: &str, hz: f64, seed: u64) -> anyhow::Result<(Trajectory, Option<f64>)> {
    Ok(match text {
        "eq27" => (Trajectory::Eq27 { hz }, None),
        "free" => (Trajectory::Free { hz }, None),
        "random" => (Trajectory::Random { hz, seed }, None),
        "even" => (Trajectory::Even { hz, seed }, None),
        "rest" => (Trajectory::Rest, None),
        "sway" => (Trajectory::Sway { seed }, None),
        file => {
            let given = Trajectory::read(Path::new(file));
            let (given, span_s) = given.context("--trajectory is eq27, free, random, even, rest, sway or a table")?;
            (given, Some(span_s))
        }
    })
}

/// Photodiodes' places from a file: TOML, or JSON where it ends in `.json`.
pub(in crate::phantom) fn positions(path: &Path) -> anyhow::Result<Positions> {
    let text = input::read_text(path)?;
    let json = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("json"));
    let read = if json { Positions::from_json(&text) } else { Positions::from_toml(&text) };
    read.with_context(|| path.display().to_string())
}

fn parse_span(text: &str) -> Option<(usize, usize)> {
    let (frame, frames) = text.split_once('+')?;
    Some((frame.parse().ok()?, frames.parse().ok()?))
}

pub(super) fn parse_hide(text: &str) -> Result<Hide, String> {
    let parts = text.split_once('@').and_then(|(name, span)| Some((name, parse_span(span)?)));
    let (marker, (frame, frames)) =
        parts.ok_or_else(|| format!("`{text}` is not NAME@FRAME+N, as middle_dist@120+12"))?;
    Ok(Hide { marker: marker.to_owned(), frame, frames })
}

pub(super) fn parse_leave(text: &str) -> Result<Leave, String> {
    parse_span_of_frames(text).map(|[frame, frames]| Leave { frame, frames })
}

pub(in crate::phantom) fn parse_span_of_frames(text: &str) -> Result<[usize; 2], String> {
    parse_span(text).map(|(frame, frames)| [frame, frames]).ok_or_else(|| format!("`{text}` is not FRAME+N, as 60+20"))
}

/// A number after the first sign that is not at the beginning, and the text before it.
fn parse_signed(text: &str) -> Option<(&str, f64)> {
    let at = text.char_indices().skip(1).find(|(_, c)| matches!(c, '+' | '-'))?.0;
    let by: f64 = text[at..].parse().ok()?;
    by.is_finite().then(|| (&text[..at], by))
}

pub(super) fn parse_jump(text: &str) -> Result<(usize, f64), String> {
    let parts = parse_signed(text).and_then(|(frame, by_s)| Some((frame.parse().ok()?, by_s)));
    parts.ok_or_else(|| format!("`{text}` is not FRAME+SECONDS, as 90+5 or 90-5"))
}

pub(in crate::phantom) fn parse_set_clock(text: &str) -> Result<Jump, String> {
    let parts = parse_signed(text).and_then(|(at_s, by_s)| Some(Jump { at_s: at_s.parse().ok()?, by_s }));
    parts.ok_or_else(|| format!("`{text}` is not TIME+SECONDS, as 5+3.5 or 5-3.5"))
}

pub(in crate::phantom) fn parse_gap(text: &str) -> Result<[f64; 2], String> {
    let parts = text.split_once('+').and_then(|(from, length)| Some([from.parse().ok()?, length.parse().ok()?]));
    parts.ok_or_else(|| format!("`{text}` is not FROM+LENGTH, as 4+1.5"))
}

/// A share, given as so many per cent.
pub(in crate::phantom) fn parse_percent(text: &str) -> Result<f64, ParseFloatError> {
    text.parse::<f64>().map(|percent| 0.01 * percent)
}

pub(super) fn parse_photodiode(text: &str) -> Result<usize, String> {
    let number = text.strip_prefix('P').and_then(|number| number.parse().ok());
    number
        .filter(|number| (1..=CHANNELS).contains(number))
        .ok_or_else(|| format!("`{text}` is no photodiode; there are P1 to P{CHANNELS}"))
}

pub(super) fn parse_colour(text: &str) -> Result<u32, String> {
    let digits = text.strip_prefix('#').filter(|digits| digits.len() == 6);
    digits
        .and_then(|digits| u32::from_str_radix(digits, 16).ok())
        .ok_or_else(|| format!("`{text}` is not a colour as #8a9299"))
}

pub(super) fn parse_roi(text: &str) -> Result<[usize; 4], String> {
    let sides: Option<Vec<usize>> = text.split(',').map(|side| side.trim().parse().ok()).collect();
    sides
        .and_then(|sides| sides.try_into().ok())
        .ok_or_else(|| format!("`{text}` is not X,Y,WIDTH,HEIGHT, as 900,40,300,70"))
}

/// A plane's tilt and the direction in which it recedes, degrees.
pub(in crate::phantom) fn parse_plane(text: &str) -> Result<Oblique, String> {
    let (tilt, towards) = text.split_once(',').unwrap_or((text, "0"));
    let parts = (tilt.trim().parse(), towards.trim().parse());
    let (Ok(tilt_deg), Ok(towards_deg)) = parts else {
        return Err(format!("`{text}` is not TILT or TILT,TOWARDS in degrees, as 30 or 30,90"));
    };
    Ok(Oblique { tilt_deg, towards_deg })
}

/// Columns and rows of a picture, `640x480`, as an option takes them.
///
/// # Errors
/// What else it is, in the command line's words.
pub fn parse_size(text: &str) -> Result<(u32, u32), String> {
    let sides = text.split_once('x').and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
    sides.ok_or_else(|| format!("`{text}` is not WIDTHxHEIGHT, as 640x480"))
}
