//! A frame as it is shown: turned upright, 8-bit 4:2:0 with even sides, whatever it was; to be drawn on and encoded.

use crate::video::{Format, Frame, Info, Picture, Plane, Turn};
use crate::vision::Samples;

/// Width and height of the shown picture.
pub(super) fn shown_size(info: &Info) -> (usize, usize) {
    info.turn.shown_size((info.format.width, info.format.height))
}

/// The shown picture's layout: its sides made even.
pub(super) fn shown_format(info: &Info) -> Format {
    let (width, height) = shown_size(info);
    let even = |side: usize| side.next_multiple_of(2);
    Format { width: even(width), height: even(height), subsampling: Some((2, 2)), depth: 8 }
}

/// Copies a frame upright into a picture of [`shown_format`]; the last column and row stand twice where a side was odd.
pub(super) fn copy(frame: &Frame<'_>, info: &Info, into: &mut Picture) {
    let Format { width, height, .. } = into.format;
    let copy = |plane: Plane<'_>, block: [usize; 2], into: &mut [u8], size: [usize; 2]| {
        let Plane { width, height, stride, depth, data } = plane;
        Samples { width, height, stride, depth, data, quarters: info.turn.quarters() }.shown(block, into, size);
    };
    let [luma, chroma @ ..] = &mut into.planes[..] else { return };
    copy(frame.luma, [1, 1], luma, [width, height]);
    let Some(planes) = frame.chroma else { return chroma.iter_mut().for_each(|plane| plane.fill(128)) };
    // Finer chroma: the mean of the block.
    let (across, down) = frame.subsampling();
    let block = match info.turn {
        Turn::None | Turn::Half => [2 / across, 2 / down],
        Turn::Quarter | Turn::ThreeQuarters => [2 / down, 2 / across],
    };
    planes.into_iter().zip(chroma).for_each(|(plane, into)| copy(plane, block, into, [width / 2, height / 2]));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::posture::draw::overlay::tests::info;

    #[test]
    fn samples_stand_where_the_turn_shows_them() {
        for turn in [Turn::None, Turn::Quarter, Turn::Half, Turn::ThreeQuarters] {
            for (subsampling, depth) in [(Some((2, 2)), 8), (Some((2, 1)), 8), (Some((1, 1)), 10), (None, 8)] {
                let format = Format { width: 9, height: 6, subsampling, depth };
                let info = info(format, turn);
                let mut picture = Picture::new(format);
                let bytes = format.sample_bytes();
                for (k, sample) in picture.planes[0].chunks_exact_mut(bytes).enumerate() {
                    let deep = (k as u16 * 4) << (depth - 8);
                    sample.copy_from_slice(&deep.to_le_bytes()[..bytes]);
                }
                for plane in picture.planes.iter_mut().skip(1) {
                    for sample in plane.chunks_exact_mut(bytes) {
                        sample.copy_from_slice(&(77u16 << (depth - 8)).to_le_bytes()[..bytes]);
                    }
                }
                let mut shown = Picture::new(shown_format(&info));
                copy(&picture.frame(0, 0.0), &info, &mut shown);
                for (x, y) in [(0, 0), (8, 0), (3, 5), (8, 5)] {
                    let [at_x, at_y] = turn.shown_from_stored([x as f64, y as f64], (9, 6));
                    let found = shown.planes[0][at_y as usize * shown.format.width + at_x as usize];
                    assert_eq!(usize::from(found), (y * 9 + x) * 4, "{turn:?} {x} {y}");
                }
                let colour = if subsampling.is_some() { 77 } else { 128 };
                assert!(shown.planes[1].iter().chain(&shown.planes[2]).all(|&value| value == colour));
            }
        }
    }
}
