//! HDR frames as an ordinary camera would have encoded them: BT.709's primaries and matrix, a power of light, limited
//! range; what is brighter than an ordinary camera's white is cut off where its samples end.
//!
//! Once a frame, before anything looks at it, so that no stage knows of HDR. Measured on phantoms with eight colours:
//! in the samples of hybrid log-gamma themselves `posture --suggest` found 4 to 6 of the markers, with the perceptual
//! quantizer `posture` could not tell them apart; in converted frames both find all.

use ffmpeg::frame;
use ffmpeg_next as ffmpeg;
use rayon::prelude::*;

use super::matrix::Matrix;
use super::transfer::{Transfer, USUAL_OF_WIDE, product};
use crate::video::{Format, Plane};

/// Steps of the tables for each 1 of what they are of: an eighth of a level of 10 bits.
const STEPS: f32 = 8192.0;
/// Up to 1.25, of parts of a video's own R'G'B', some of which chroma carries beyond 1, and of roots of light over
/// white's, where samples of limited range end earlier.
const ENTRIES: usize = 10_241;

/// Converts frames of one video.
pub(in crate::video) struct ToOrdinary {
    format: Format,
    /// A video's own R'G'B' of samples on the scale of 8 bits, and BT.709's samples of ordinary R'G'B'.
    own: Linear,
    samples: Linear,
    /// From BT.2020's primaries, where they are.
    usual: Option<Linear>,
    /// Light over white's by a part of R'G'B'; ordinary parts by the root of light, which they are nearly linear in.
    light: Table,
    of_root: Table,
    /// Where the columns and rows of luma lie between those of chroma, and the other way.
    of_chroma: [Vec<Between>; 2],
    of_luma: [Vec<Between>; 2],
}

/// An odd function by its values.
struct Table(Box<[f32; ENTRIES]>);

/// A linear map with what it gives for zeros.
struct Linear {
    zero: [f32; 3],
    rows: [[f32; 3]; 3],
}

/// A place between two samples in a row: their numbers and the second's share.
struct Between {
    from: [usize; 2],
    share: f32,
}

impl ToOrdinary {
    /// For frames of a format and a matrix; `None` where they are ordinary. `site`: where chroma lies in its block, in
    /// luma samples.
    pub(in crate::video) fn new(format: Format, matrix: &Matrix, site: Option<(f64, f64)>) -> Option<Self> {
        if matrix.transfer == Transfer::Power {
            return None;
        }
        let block = format.subsampling.unwrap_or((1, 1));
        // As most codecs have it that don't say: on the left, between the rows.
        let usual = (0.0, if block.1 > 1 { 0.5 } else { 0.0 });
        let (right, below) = site.filter(|_| block != (1, 1)).unwrap_or(usual);
        let (width, height) = format.chroma_size().unwrap_or((format.width, format.height));
        let between = |luma: usize, chroma: usize, block: usize, site: f64| {
            let block = block as f64;
            let on_chroma = (0..luma).map(|at| Between::new((at as f64 - site) / block, chroma)).collect();
            (on_chroma, (0..chroma).map(|at| Between::new(at as f64 * block + site, luma)).collect())
        };
        let (columns, chroma_columns) = between(format.width, width, block.0, right);
        let (rows, chroma_rows) = between(format.height, height, block.1, below);
        Some(Self {
            format,
            own: Linear::of(|samples| matrix.to_own_rgb(samples)),
            samples: Linear::of(|rgb| Matrix::BT709.from_own_rgb(rgb)),
            usual: matrix.is_wide().then(|| Linear::of(|light| product(&USUAL_OF_WIDE, light))),
            light: Table::of(|part| matrix.transfer.light(part)),
            of_root: Table::of(|root| Transfer::Power.encoded(root * root)),
            of_chroma: [columns, rows],
            of_luma: [chroma_columns, chroma_rows],
        })
    }

    /// The frame, in the same layout.
    pub(in crate::video) fn frame(&self, picture: &frame::Video) -> frame::Video {
        let Format { width, height, .. } = self.format;
        let (luma, chroma) = self.format.planes(|number, _| (picture.stride(number), picture.data(number)));
        let mut converted = frame::Video::new(picture.format(), picture.width(), picture.height());
        let (stride, [columns, rows]) = (converted.stride(0), &self.of_chroma);
        converted.data_mut(0).par_chunks_mut(stride).take(height).enumerate().for_each(|(y, bytes)| {
            let chroma = chroma.map(|planes| planes.map(|plane| mixed(columns, &rows[y].mix_rows(&plane))));
            let [cb, cr] = chroma.unwrap_or_else(|| [vec![128.0; width], vec![128.0; width]]);
            self.write(0, &self.ordinary([row_of(&luma, y), cb, cr]), bytes);
        });
        let Some(chroma) = chroma else { return converted };
        let [columns, rows] = &self.of_luma;
        let ordinary = (0..chroma[0].height).into_par_iter().map(|y| {
            let [cb, cr] = chroma.map(|plane| row_of(&plane, y));
            self.ordinary([mixed(columns, &rows[y].mix_rows(&luma)), cb, cr])
        });
        let ordinary: Vec<[Vec<f32>; 3]> = ordinary.collect();
        for part in [1, 2] {
            let stride = converted.stride(part);
            let lines = converted.data_mut(part).par_chunks_mut(stride).zip(&ordinary);
            lines.for_each(|(bytes, row)| self.write(part, row, bytes));
        }
        converted
    }

    /// Ordinary R'G'B' of a row of a video's own samples on the scale of 8 bits. Step by step over the row, of which
    /// only the look-ups are not several samples at once: three times as fast as sample by sample.
    fn ordinary(&self, mut row: [Vec<f32>; 3]) -> [Vec<f32>; 3] {
        self.own.map(&mut row);
        row.iter_mut().for_each(|channel| self.light.map(channel));
        if let Some(usual) = &self.usual {
            usual.map(&mut row);
        }
        for channel in &mut row {
            channel.iter_mut().for_each(|light| *light = light.abs().sqrt().copysign(*light));
            self.of_root.map(channel);
        }
        row
    }

    /// Luma (0), Cb or Cr as BT.709 has it of a row of ordinary R'G'B'.
    fn write(&self, part: usize, row: &[Vec<f32>; 3], bytes: &mut [u8]) {
        let (zero, [of_red, of_green, of_blue]) = (self.samples.zero[part], self.samples.rows[part]);
        let [red, green, blue] = row;
        let rgb = red.iter().zip(green).zip(blue);
        let samples = rgb.map(|((red, green), blue)| zero + of_red * red + of_green * green + of_blue * blue);
        let depth = self.format.depth;
        let (most, scale) = (((1_u32 << depth) - 1) as f32, (1_u32 << (depth - 8)) as f32);
        // Rounded when cut; `round` would be a library call a sample.
        let levels = samples.map(|sample| (sample * scale + 0.5).clamp(0.0, most) as u16);
        if depth > 8 {
            bytes.chunks_exact_mut(2).zip(levels).for_each(|(pair, level)| pair.copy_from_slice(&level.to_le_bytes()));
        } else {
            bytes.iter_mut().zip(levels).for_each(|(byte, level)| *byte = level as u8);
        }
    }
}

impl Table {
    fn of(function: impl Fn(f64) -> f64) -> Self {
        let values: Vec<f32> = (0..ENTRIES).map(|k| function(k as f64 / f64::from(STEPS)) as f32).collect();
        Self(values.try_into().expect("as many as entries"))
    }

    fn map(&self, parts: &mut [f32]) {
        for part in parts {
            let at = (part.abs() * STEPS + 0.5) as u32 as usize;
            *part = self.0[at.min(ENTRIES - 1)].copysign(*part);
        }
    }
}

impl Linear {
    fn of(map: impl Fn([f64; 3]) -> [f64; 3]) -> Self {
        let zero = map([0.0; 3]);
        let columns = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(map);
        let rows = std::array::from_fn(|row| std::array::from_fn(|k| (columns[k][row] - zero[row]) as f32));
        Self { zero: zero.map(|part| part as f32), rows }
    }

    fn map(&self, [a, b, c]: &mut [Vec<f32>; 3]) {
        for ((a, b), c) in a.iter_mut().zip(b).zip(c) {
            [*a, *b, *c] = std::array::from_fn(|k| {
                let [of_a, of_b, of_c] = self.rows[k];
                self.zero[k] + of_a * *a + of_b * *b + of_c * *c
            });
        }
    }
}

impl Between {
    /// Beyond the ends the nearest is taken.
    fn new(at: f64, count: usize) -> Self {
        let at = at.clamp(0.0, (count.max(1) - 1) as f64);
        let first = at.floor();
        Self { from: [first as usize, (first as usize + 1).min(count.max(1) - 1)], share: (at - first) as f32 }
    }

    #[inline]
    fn mix(&self, row: &[f32]) -> f32 {
        let [first, second] = self.from.map(|at| row[at]);
        first + self.share * (second - first)
    }

    fn mix_rows(&self, plane: &Plane<'_>) -> Vec<f32> {
        let mut mixed = row_of(plane, self.from[0]);
        if self.share > 0.0 {
            let second = row_of(plane, self.from[1]);
            mixed.iter_mut().zip(second).for_each(|(first, second)| *first += self.share * (second - *first));
        }
        mixed
    }
}

fn mixed(places: &[Between], row: &[f32]) -> Vec<f32> {
    places.iter().map(|place| place.mix(row)).collect()
}

fn row_of(plane: &Plane<'_>, y: usize) -> Vec<f32> {
    let mut row = vec![0.0; plane.width];
    plane.copy_row(y, 0, &mut row);
    row
}

#[cfg(test)]
mod tests {
    use ffmpeg::format::Pixel;

    use super::*;
    use crate::video::Picture;

    /// A picture of ordinary colours, as `matrix` has it, in 10 bits.
    fn encoded(format: Format, matrix: &Matrix, colour: impl Fn(usize, usize) -> [f64; 3]) -> Picture {
        let mut picture = Picture::new(format);
        let mut write = |plane: usize, at: usize, level: f64| {
            let bytes = ((4.0 * level).round() as u16).to_le_bytes();
            picture.planes[plane][2 * at..2 * at + 2].copy_from_slice(&bytes);
        };
        for (x, y) in (0..format.height).flat_map(|y| (0..format.width).map(move |x| (x, y))) {
            write(0, y * format.width + x, matrix.from_rgb(colour(x, y))[0]);
        }
        if let (Some((width, height)), Some((across, down))) = (format.chroma_size(), format.subsampling) {
            for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
                let samples = matrix.from_rgb(colour(across * x, down * y));
                (1..3).for_each(|plane| write(plane, y * width + x, samples[plane]));
            }
        }
        picture
    }

    /// Converted; how far off BT.709's own samples of the same colours, of 255.
    fn furthest_off(format: Format, matrix: &Matrix, colour: impl Fn(usize, usize) -> [f64; 3]) -> f32 {
        let pixel = if format.subsampling.is_some() { Pixel::YUV420P10LE } else { Pixel::GRAY10LE };
        let picture = encoded(format, matrix, &colour);
        let mut frame = frame::Video::new(pixel, format.width as u32, format.height as u32);
        for (number, plane) in picture.planes.iter().enumerate() {
            let stride = frame.stride(number);
            let row = 2 * if number == 0 { format.width } else { format.width.div_ceil(2) };
            let rows = frame.data_mut(number).chunks_mut(stride).zip(plane.chunks(row));
            rows.for_each(|(into, from)| into[..row].copy_from_slice(from));
        }
        let converted = ToOrdinary::new(format, matrix, None).expect("HDR").frame(&frame);
        let truth = encoded(format, &Matrix::BT709, &colour);
        let truth = truth.frame(0, 0.0);
        let mut most = 0.0_f32;
        for number in 0..picture.planes.len() {
            let truth = if number == 0 { truth.luma } else { truth.chroma.expect("colour")[number - 1] };
            let got = Plane { stride: converted.stride(number), data: converted.data(number), ..truth };
            for (x, y) in (0..truth.height).flat_map(|y| (0..truth.width).map(move |x| (x, y))) {
                most = most.max((got.sample(x, y) - truth.sample(x, y)).abs());
            }
        }
        most
    }

    #[test]
    fn colours_become_those_of_ordinary_video() {
        let format = Format { width: 5, height: 3, subsampling: Some((2, 2)), depth: 10 };
        let colours = [[0.78, 0.59, 0.51], [0.9, 0.3, 0.5], [0.1, 0.5, 0.3], [0.02, 0.02, 0.03], [1.0; 3], [0.0; 3]];
        for matrix in [Matrix::HLG, Matrix::PQ, Matrix { k_red: 0.2126, k_blue: 0.0722, ..Matrix::HLG }] {
            for colour in colours {
                // Black is where samples of HDR are coarsest; the perceptual quantizer's everywhere.
                let off = furthest_off(format, &matrix, |_, _| colour);
                assert!(off <= 2.0, "{matrix:?} {colour:?}: {off}");
            }
        }
        let grey = Format { subsampling: None, ..format };
        let off = furthest_off(grey, &Matrix::HLG, |x, y| [0.1 * (x + y) as f64 + 0.1; 3]);
        assert!(off <= 1.0, "{off}");
    }

    #[test]
    fn a_slope_of_colour_stays_a_slope() {
        let format = Format { width: 64, height: 4, subsampling: Some((2, 2)), depth: 10 };
        let slope = |x: usize, _: usize| {
            let share = x as f64 / 63.0;
            [0.78 - 0.2 * share, 0.59 - 0.3 * share, 0.51]
        };
        let off = furthest_off(format, &Matrix::HLG, slope);
        assert!(off <= 1.0, "{off}");
    }

    #[test]
    fn ordinary_video_is_left_as_it_is() {
        let format = Format { width: 5, height: 3, subsampling: None, depth: 8 };
        assert!(ToOrdinary::new(format, &Matrix::BT2020, None).is_none());
    }
}
