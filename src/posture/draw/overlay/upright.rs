//! A frame as it is shown: turned upright, 8-bit 4:2:0 with even sides, whatever it was; to be drawn on and encoded.

use crate::video::{Format, Frame, Info, Picture, Plane, Turn};

/// Width and height of the shown picture.
pub(super) fn shown_size(info: &Info) -> (usize, usize) {
    let (width, height) = (info.format.width, info.format.height);
    match info.turn {
        Turn::None | Turn::Half => (width, height),
        Turn::Quarter | Turn::ThreeQuarters => (height, width),
    }
}

/// The shown picture's layout: its sides made even.
pub(super) fn shown_format(info: &Info) -> Format {
    let (width, height) = shown_size(info);
    let even = |side: usize| side.next_multiple_of(2);
    Format { width: even(width), height: even(height), subsampling: Some((2, 2)), depth: 8 }
}

/// Copies a frame upright into a picture of [`shown_format`]; the last column and row stand twice where a side was odd.
pub(super) fn copy(frame: &Frame<'_>, info: &Info, into: &mut Picture) {
    let (width, height) = shown_size(info);
    let size = (info.format.width, info.format.height);
    let stored = |x: usize, y: usize| {
        let [x, y] = info.turn.stored_from_shown([x.min(width - 1) as f64, y.min(height - 1) as f64], size);
        (x as usize, y as usize)
    };
    let columns = into.format.width;
    let [luma, cb, cr] = &mut into.planes[..] else { unreachable!("4:2:0 has three planes") };
    for (y, row) in luma.chunks_exact_mut(columns).enumerate() {
        fill(row, frame.luma, |x| stored(x, y));
    }
    let Some(chroma) = frame.chroma else {
        cb.fill(128);
        cr.fill(128);
        return;
    };
    let (across, down) = frame.subsampling();
    if (across, down) == (2, 2) {
        for (plane, into) in chroma.into_iter().zip([cb, cr]) {
            for (y, row) in into.chunks_exact_mut(columns / 2).enumerate() {
                fill(row, plane, |x| {
                    let (x, y) = stored(2 * x, 2 * y);
                    (x / 2, y / 2)
                });
            }
        }
        return;
    }
    // Finer chroma: the mean of the block.
    for (plane, into) in chroma.into_iter().zip([cb, cr]) {
        for (y, row) in into.chunks_exact_mut(columns / 2).enumerate() {
            for (x, value) in row.iter_mut().enumerate() {
                let block = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(dx, dy)| {
                    let (x, y) = stored(2 * x + dx, 2 * y + dy);
                    plane.sample(x / across, y / down)
                });
                *value = (block.iter().sum::<f32>() / 4.0).round() as u8;
            }
        }
    }
}

/// Fills a row with samples from places that lie on a straight line.
fn fill(row: &mut [u8], plane: Plane<'_>, place: impl Fn(usize) -> (usize, usize)) {
    let last = row.len() - 1;
    let ((x0, y0), (x1, y1)) = (place(0), place(last));
    if y0 == y1 && x1 == x0 + last && plane.depth == 8 {
        row.copy_from_slice(&plane.data[y0 * plane.stride + x0..][..=last]);
        return;
    }
    for (x, value) in row.iter_mut().enumerate() {
        let (x, y) = place(x);
        *value = plane.sample(x, y).round() as u8;
    }
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
                let bytes = if depth > 8 { 2 } else { 1 };
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
