//! What stands beside a clock's digits: whether its format fits, and AM or PM.
//!
//! In: a crop, the clock's cells in it, and its format. Out: the characters that follow the cells on either side at the
//! pitch of the digits and on their line, as high as they are: digits for the network, colons, and dots that digits
//! follow; and AM or PM. A screen's frame, lines of text above and below, other words and icons are none of these. What
//! a region's edge cuts off counts as a digit where it stands as one.

mod scene;

use crate::clock::cell::cells::Cells;
use crate::clock::cell::half::Word;
use crate::clock::cell::look::Cut;
use crate::clock::format::{Cell, ClockFormat, Half};
use crate::clock::ink::crop::Gray;

use scene::Scene;

/// A clock shows more than its format has.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Misfit {
    /// The format that would fit, where there is one.
    pub fitting: Option<String>,
}

/// So many frames of another format say that the clock is; and one of so many within the stretch that was read.
const FEWEST: usize = 3;
const STRAY: usize = 10;

impl Misfit {
    /// Whether the whole clock is of another format: frames whose digits stand beside more than the format has
    /// (`other`) are not strays between those that were read, nor lie before or after them as where a clock becomes
    /// wider. Both are the frames' places in order.
    #[must_use]
    pub fn is_of_all(read: &[usize], other: &[usize]) -> bool {
        let Some((first, last)) = read.first().zip(read.last()) else { return other.len() >= FEWEST };
        let within = other.iter().filter(|&place| (first..=last).contains(&place)).count();
        within >= FEWEST && STRAY * within > read.len() || other.len() >= read.len().max(FEWEST)
    }

    /// What is wrong with this format and what to write instead.
    #[must_use]
    pub fn says(&self, format: &ClockFormat, frames: usize) -> String {
        let help = match &self.fitting {
            Some(fitting) => format!("write format = \"{fitting}\""),
            None => "write all of its characters into the format, or a roi that holds no more than the format has"
                .to_owned(),
        };
        format!(
            "beside the digits of its format \"{}\" there is more of the clock in {frames} frame(s): a further digit, \
             a colon, or AM or PM; {help}",
            format.text()
        )
    }
}

/// What stands on either side, the nearest first: `d` for a digit, marks as they are.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
struct Side {
    characters: Vec<char>,
    word: Option<Word>,
}

/// What stands beside the digits.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::clock) struct Beside {
    /// On the left and on the right.
    sides: [Side; 2],
}

impl Beside {
    pub(in crate::clock) fn look(gray: &Gray, cells: &Cells, [first, last]: [Cut; 2]) -> Self {
        let scene = Scene::new(gray, cells);
        Self { sides: [scene.side(first, true), scene.side(last, false)] }
    }

    /// AM or PM on the format's side.
    pub(in crate::clock) fn half(&self, format: &ClockFormat) -> Option<Half> {
        let side = usize::from(!format.half_leads());
        let Side { characters, word } = &self.sides[side];
        match word {
            Some(Word::Half(half)) if format.has_half() && characters.is_empty() => Some(*half),
            _ => None,
        }
    }

    /// What the format lacks, if anything.
    pub(in crate::clock) fn misfit(&self, format: &ClockFormat) -> Option<Misfit> {
        let [left, right] = &self.sides;
        let half = |leads: bool, side: &Side| {
            side.word.is_some() && !(format.has_half() && format.half_leads() == leads && side.characters.is_empty())
        };
        let more = self.sides.iter().any(|side| !side.characters.is_empty());
        (more || half(true, left) || half(false, right)).then(|| Misfit { fitting: self.fitting(format) })
    }

    fn fitting(&self, format: &ClockFormat) -> Option<String> {
        let [left, right] = &self.sides;
        let own = format.cells().iter().filter_map(|cell| match cell {
            Cell::Digit { .. } => Some('d'),
            Cell::Mark(mark) => Some(*mark),
            Cell::Half => None,
        });
        let own: String = own.collect();
        let all: Vec<char> = left
            .characters
            .iter()
            .rev()
            .copied()
            .chain(own.trim().chars())
            .chain(right.characters.iter().copied())
            .collect();
        // A colon that nothing follows is none of the format's.
        let begin = left.characters.last().map_or(0, |&c| usize::from(c != 'd'));
        let end = all.len() - right.characters.last().map_or(0, |&c| usize::from(c != 'd'));
        let all = &all[begin..end];
        let groups: Vec<usize> = all.split(|&c| c != 'd').map(<[char]>::len).filter(|&count| count > 0).collect();
        let fraction = format.decimals() > 0 && !right.characters.contains(&':')
            || all.iter().rev().find(|&&c| c != 'd').is_some_and(|c| matches!(c, '.' | ','));
        let units = match (groups.len() - usize::from(fraction), fraction) {
            (3, _) => "hms",
            (2, false) if format.text().contains('h') => "hm",
            (2, _) => "ms",
            (1, _) => "s",
            _ => return None,
        };
        let mut units = units.chars().chain(fraction.then_some('t'));
        let mut unit = units.next();
        let mut text = String::new();
        for (k, &c) in all.iter().enumerate() {
            if c == 'd' {
                text.push(unit?);
            } else {
                text.push(c);
                if k > 0 && all[k - 1] == 'd' {
                    unit = units.next();
                }
            }
        }
        if left.word.is_some() || format.half_leads() {
            text = format!("a {text}");
        } else if right.word.is_some() || format.has_half() {
            text += " a";
        }
        ClockFormat::parse(&text).ok().map(|_| text).filter(|text| text != format.text())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strays_and_a_clock_that_becomes_wider_are_no_other_format() {
        let read: Vec<usize> = (0..100).collect();
        assert!(!Misfit::is_of_all(&read, &[40, 41, 42, 43, 44]));
        assert!(!Misfit::is_of_all(&read, &(100..190).collect::<Vec<_>>()));
        assert!(Misfit::is_of_all(&read, &(40..60).collect::<Vec<_>>()));
        assert!(Misfit::is_of_all(&[], &[3, 4, 5]) && !Misfit::is_of_all(&[], &[3]));
        assert!(Misfit::is_of_all(&[50], &(0..40).collect::<Vec<_>>()));
    }

    #[test]
    fn the_format_that_fits_has_what_stands_beside() {
        let fitting = |format: &str, left: &str, right: &str, half: [bool; 2]| {
            let side = |characters: &str, half: bool| Side {
                characters: characters.chars().collect(),
                word: half.then_some(Word::Half(Half::Am)),
            };
            let beside = Beside { sides: [side(left, half[0]), side(right, half[1])] };
            beside.fitting(&ClockFormat::parse(format).unwrap())
        };
        let none = [false, false];
        assert_eq!(fitting("h:mm", "d", "", none).as_deref(), Some("hh:mm"));
        assert_eq!(fitting("h:mm", "d", ":dd", none).as_deref(), Some("hh:mm:ss"));
        assert_eq!(fitting("h:mm", "d:dd", "", none).as_deref(), Some("hh:mm:ss"));
        assert_eq!(fitting("mm:ss", "", ".d", none).as_deref(), Some("mm:ss.t"));
        assert_eq!(fitting("ss.t", ":dd", "d", none).as_deref(), Some("mm:ss.tt"));
        assert_eq!(fitting("hh:mm", "", "", [false, true]).as_deref(), Some("hh:mm a"));
        assert_eq!(fitting("h:mm a", "d", ":dd", [false, true]).as_deref(), Some("hh:mm:ss a"));
        assert_eq!(fitting("mm:ss", ":dd:dd", "", none), None);
    }
}
