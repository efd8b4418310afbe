//! Finds the one digit on a picture that holds nothing else, and reads it.
//!
//! In: a plane, such as a crop of one place of a display, 16 samples a side at least. Out: the digit and how probable
//! it is, or none:
//! blank, unsure, or ways of cutting it out that tell different digits.
//!
//! [`grey`]: the background is what remains when everything narrower than a third of the picture is filled up from
//! around it (a morphological closing), so slow changes of light are taken away; so are shadows across the picture.
//! [`boxes`]: connected ink at several thresholds is gathered to boxes: all of it but the display's frame along the
//! border, or what hangs together. Of dark and light, ink is what is narrow.

mod boxes;
mod grey;

use super::patch::{Levels, Patch};
use super::recognise;
use super::scores::SURE;
use crate::video::Plane;
use grey::{FULL, Grey};

/// A settled picture shows no blends: *other* counts for so much of what it does in a video.
const OTHER: f64 = 0.1;
/// Another digit that is so probable, cut out another way, makes a reading doubtful.
const DOUBT: f64 = 0.25;

/// Reads the one digit of a picture: which, and how probable it is; none where that is not sure.
#[must_use]
pub fn read_crop(plane: &Plane<'_>) -> Option<(u8, f64)> {
    let finds: Vec<(u8, f64)> =
        candidates(plane).iter().map(|patch| recognise(patch).with_other_rarer(OTHER).likeliest()).collect();
    let best = *finds.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let doubtful = finds.iter().any(|(digit, probability)| *digit != best.0 && *probability >= DOUBT);
    (best.1 >= SURE && !doubtful).then_some(best)
}

/// What may be the digit.
fn candidates(plane: &Plane<'_>) -> Vec<Patch> {
    let Some(grey) = Grey::reduced(plane) else { return vec![] };
    let Some(flat) = grey.flattened(grey.is_dark_on_light()) else { return vec![] };
    let data: Vec<u8> = flat.values.iter().map(|v| v.round().clamp(0.0, 255.0) as u8).collect();
    let plane = Plane { width: flat.width, height: flat.height, stride: flat.width, depth: 8, data: &data };
    let cut = |extent: [usize; 4]| {
        let [x0, y0, x1, y1] = extent.map(|v| v as f64);
        Patch::cut(&plane, [x0 - 0.5, y0 - 0.5, x1 + 0.5, y1 + 0.5], Levels { background: 0.0, ink: FULL })
    };
    flat.boxes().into_iter().filter(|extent| !grey.is_edge(extent)).map(cut).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bars (left, top, right, bottom) of `ink` on a ground that gets lighter to the right, 96 x 96.
    fn picture(bars: &[[usize; 4]], ink: i32, ground: i32) -> Vec<u8> {
        let sample = |k: usize| {
            let (x, y) = (k % 96, k / 96);
            let inked = bars.iter().any(|&[x0, y0, x1, y1]| (x0..x1).contains(&x) && (y0..y1).contains(&y));
            (if inked { ink } else { ground } + x as i32 / 4) as u8
        };
        (0..96 * 96).map(sample).collect()
    }

    fn read(data: &[u8]) -> Option<u8> {
        read_crop(&Plane { width: 96, height: 96, stride: 96, depth: 8, data }).map(|(digit, _)| digit)
    }

    /// Segments b, c, f, g of a display.
    const FOUR: [[usize; 4]; 4] = [[56, 14, 66, 44], [56, 50, 66, 80], [30, 14, 40, 44], [39, 43, 57, 52]];
    /// A display's frame along the right side.
    const FRAME: [usize; 4] = [90, 0, 94, 96];

    #[test]
    fn a_digit_is_read_in_either_polarity_beside_a_frame() {
        for (ink, ground) in [(30, 180), (190, 40)] {
            assert_eq!(read(&picture(&FOUR, ink, ground)), Some(4));
            let framed: Vec<_> = FOUR.into_iter().chain([FRAME]).collect();
            assert_eq!(read(&picture(&framed, ink, ground)), Some(4));
        }
    }

    #[test]
    fn what_holds_no_digit_is_not_read() {
        assert_eq!(read(&picture(&[], 0, 180)), None);
        assert_eq!(read(&picture(&[FRAME], 30, 180)), None);
        assert_eq!(read(&picture(&[[0, 0, 96, 96]], 30, 180)), None);
    }

    #[test]
    fn a_segment_between_lit_and_dark_is_not_guessed() {
        // Segments a to g.
        let all = [
            [34, 10, 62, 19],
            [60, 16, 70, 46],
            [60, 50, 70, 80],
            [34, 77, 62, 86],
            [26, 50, 36, 80],
            [26, 16, 36, 46],
            [35, 43, 61, 52],
        ];
        let lit = |names: &str| -> Vec<[usize; 4]> {
            ('a'..='g').zip(all).filter(|(name, _)| names.contains(*name)).map(|(_, bar)| bar).collect()
        };
        for (full, less, digits) in [
            ("abcdefg", "abcdef", [8, 0]),
            ("abcdefg", "acdefg", [8, 6]),
            ("abcdefg", "abcdfg", [8, 9]),
            ("abcdfg", "abcdg", [9, 3]),
            ("abcdfg", "acdfg", [9, 5]),
            ("abcdfg", "bcfg", [9, 4]),
            ("acdefg", "acdfg", [6, 5]),
        ] {
            let [with, without] = [full, less].map(|names| picture(&lit(names), 30, 180));
            assert_eq!([read(&with), read(&without)], digits.map(Some));
            let half: Vec<u8> =
                with.iter().zip(&without).map(|(a, b)| ((u16::from(*a) + u16::from(*b)) / 2) as u8).collect();
            assert_eq!(read(&half), None, "between {digits:?}");
        }
    }

    #[test]
    fn small_and_broad_pictures_have_an_answer() {
        for (width, height) in [(0, 0), (1, 40), (15, 15), (16, 16), (16, 300), (300, 16)] {
            let data: Vec<u8> = (0..width * height).map(|k| (k * 37 % 251) as u8).collect();
            let answer = read_crop(&Plane { width, height, stride: width, depth: 8, data: &data });
            assert!(answer.is_none(), "{width} x {height}: {answer:?}");
        }
    }
}
