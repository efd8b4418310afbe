//! The text of a suggested marker file.

use std::fmt::Write;

use super::Mark;
use crate::posture::survey::find::distance;
use crate::video::Info;

/// The finger bends enough to tell which way.
const LEAST_TURN_RAD: f64 = 0.25;
/// Where segments' links are longer than those between them by this factor, two markers lie on each.
const PAIR_FACTOR: f64 = 1.25;

/// The text for markers in their order along the finger, the hand's first.
pub(super) fn marker_file(marks: &[Mark], colours: &[[f64; 3]], turn: f64, first_frame: bool, info: &Info) -> String {
    let hex = |mark: &Mark| hex(info.matrix.to_own_rgb(colours[mark.colour]));
    let names = names(marks, colours, info);
    let segments = segments(marks);
    let mut text =
        String::from("# Suggested from the video: look it over before use. What was guessed is said beside it.\n\n");
    if segments.len() > 1 {
        let way = if turn >= 0.0 { "clockwise" } else { "counterclockwise" };
        let why = if turn.abs() >= LEAST_TURN_RAD {
            "guessed: the greatest bend seen turns so, if the first marker is the hand's"
        } else {
            "a bare guess: the finger hardly bends in the frames looked at"
        };
        _ = writeln!(text, "flexion = \"{way}\"  # {why}\n");
    }
    text.push_str(
        "[markers]  # colours as measured; in order along the finger, the hand's first (guessed: it moves least)\n",
    );
    for (name, mark) in names.iter().zip(marks) {
        _ = writeln!(text, "{name} = \"{}\"", hex(mark));
    }
    if !segments.is_empty() {
        let how = if segments.iter().zip(&segments[1..]).any(|(a, b)| a[1] == b[0]) {
            "guessed: a mark on each joint, shared by the segments that meet there"
        } else {
            "guessed: two markers on each segment"
        };
        _ = writeln!(text, "\n[segments]  # {how}");
        let titles = titles(segments.len());
        for (title, [a, b]) in titles.iter().zip(&segments) {
            _ = writeln!(text, "{title} = [\"{}\", \"{}\"]", names[*a], names[*b]);
        }
        if segments.len() > 1 {
            text.push_str("\n[joints]\n");
            for (k, pair) in titles.windows(2).enumerate() {
                // A finger's joints; of a longer row nothing is known.
                let name = match segments.len() {
                    2 | 3 => format!("J{}", 2 + k),
                    4 => format!("J{}", 1 + k),
                    _ => format!("joint_{}", 1 + k),
                };
                _ = writeln!(text, "{name} = [\"{}\", \"{}\"]", pair[0], pair[1]);
            }
        }
    }
    if first_frame {
        text.push_str("\n[start]  # where they are in the first frame\n");
        for (name, mark) in names.iter().zip(marks) {
            let [x, y] = info.turn.shown_from_stored(mark.at_px, (info.format.width, info.format.height));
            _ = writeln!(text, "{name} = [{x:.1}, {y:.1}]");
        }
    }
    text
}

/// Which markers lie on which segment.
fn segments(marks: &[Mark]) -> Vec<[usize; 2]> {
    let count = marks.len();
    let links: Vec<f64> = marks.windows(2).map(|pair| distance(pair[0].at_px, pair[1].at_px)).collect();
    let mean = |odd: usize| {
        let some: Vec<f64> = links.iter().copied().skip(odd).step_by(2).collect();
        some.iter().sum::<f64>() / some.len().max(1) as f64
    };
    let by_colour = || {
        let pairs = marks.chunks_exact(2).all(|pair| pair[0].colour == pair[1].colour);
        pairs && marks.windows(2).any(|pair| pair[0].colour != pair[1].colour)
    };
    let in_pairs = count >= 4 && count.is_multiple_of(2) && (by_colour() || mean(0) > PAIR_FACTOR * mean(1));
    if in_pairs {
        (0..count / 2).map(|k| [2 * k, 2 * k + 1]).collect()
    } else {
        (1..count).map(|k| [k - 1, k]).collect()
    }
}

fn titles(count: usize) -> Vec<String> {
    match count {
        4 => ["hand", "proximal", "middle", "distal"].map(String::from).to_vec(),
        3 => ["proximal", "middle", "distal"].map(String::from).to_vec(),
        2 => ["proximal", "middle"].map(String::from).to_vec(),
        _ => (1..=count).map(|k| format!("segment_{k}")).collect(),
    }
}

/// A colour's word and a number for each marker.
fn names(marks: &[Mark], colours: &[[f64; 3]], info: &Info) -> Vec<String> {
    let words: Vec<&str> = marks.iter().map(|mark| word(info.matrix.to_own_rgb(colours[mark.colour]))).collect();
    let before = |k: usize| words[..k].iter().filter(|&&other| other == words[k]).count();
    (0..words.len()).map(|k| format!("{}_{}", words[k], before(k) + 1)).collect()
}

/// An sRGB colour as marker files have it.
pub(in crate::posture) fn hex(rgb: [f64; 3]) -> String {
    let [red, green, blue] = rgb.map(|part| (255.0 * part).round().clamp(0.0, 255.0) as u8);
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// The word for a colour.
fn word(rgb: [f64; 3]) -> &'static str {
    let [red, green, blue] = rgb.map(|part| part.clamp(0.0, 1.0));
    let (high, low) = (red.max(green).max(blue), red.min(green).min(blue));
    let spread = high - low;
    if spread < 0.12 {
        return if high < 0.35 {
            "black"
        } else if high > 0.8 {
            "white"
        } else {
            "grey"
        };
    }
    let sixth = if high == red {
        ((green - blue) / spread).rem_euclid(6.0)
    } else if high == green {
        (blue - red) / spread + 2.0
    } else {
        (red - green) / spread + 4.0
    };
    match (60.0 * sixth) as u32 {
        0..15 | 350.. => "red",
        15..42 => "orange",
        42..68 => "yellow",
        68..165 => "green",
        165..195 => "cyan",
        195..255 => "blue",
        255..300 => "purple",
        _ => "pink",
    }
}
