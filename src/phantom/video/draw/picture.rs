//! A frame's picture, and how a picture is made of its rows.

use rayon::prelude::*;

use crate::phantom::video::draw::paint::Exposure;
use crate::phantom::video::draw::row::Row;
use crate::phantom::video::draw::sensor::{Converter, Siting, add_noise};
use crate::phantom::video::scene::Scene;
use crate::video::{Format, Matrix, Picture, Turn};

/// A picture whose rows, with their noise, `draw` makes by their number: groups of them that share chroma samples side
/// by side.
pub(in crate::phantom) fn encoded(
    format: Format,
    matrix: &Matrix,
    siting: Siting,
    draw: impl Fn(usize, &mut Row) + Sync,
) -> Picture {
    let converter = Converter::new(format, matrix, siting);
    let mut picture = Picture::new(format);
    let bytes = format.sample_bytes();
    let down = format.subsampling.map_or(1, |(_, down)| down);
    let encode = |group: usize, rows: &mut [Row], luma: &mut [u8]| {
        for (k, (row, luma)) in rows.iter_mut().zip(luma.chunks_exact_mut(format.width * bytes)).enumerate() {
            draw(group * down + k, row);
            converter.encode(&mut row.rgb);
            converter.luma(&row.rgb, luma);
        }
    };
    let fresh = || vec![Row::new(format.width); down];
    let (luma, chroma) = picture.planes.split_at_mut(1);
    let groups = luma[0].par_chunks_mut(format.width * bytes * down).enumerate();
    if let ([cb, cr], Some((width, _))) = (chroma, format.chroma_size()) {
        let chroma = cb.par_chunks_mut(width * bytes).zip(cr.par_chunks_mut(width * bytes));
        groups.zip(chroma).for_each_init(fresh, |rows, ((group, luma), (cb, cr))| {
            encode(group, rows, luma);
            let rows: Vec<_> = rows.iter().map(|row| &row.rgb).collect();
            converter.chroma(1, &rows, cb);
            converter.chroma(2, &rows, cr);
        });
    } else {
        groups.for_each_init(fresh, |rows, (group, luma)| encode(group, rows, luma));
    }
    picture
}

/// Rows of a rolling shutter that are drawn as of one moment: at 16 ms for 720 rows 0.04 ms off at most, of a marker at
/// 300 pixels a second 0.013 px.
const BAND_ROWS: usize = 4;

impl Scene {
    /// A frame's picture, as the encoder gets it: stored, not shown.
    #[must_use]
    pub fn picture(&self, frame: usize) -> Picture {
        let options = &self.options;
        let format = options.format();
        // Of a rolling shutter a few rows at a time are taken together.
        let rolls = options.readout_s > 0.0;
        let band = if rolls { BAND_ROWS } else { format.height };
        let late_s = |first: usize| options.readout_s * first as f64 / (format.height - 1) as f64;
        let middle = |first: usize| first + usize::from(rolls) * BAND_ROWS / 2;
        let exposures: Vec<Exposure<'_>> =
            (0..format.height).step_by(band).map(|first| Exposure::new(self, frame, late_s(middle(first)))).collect();
        let turned =
            (options.turn != Turn::None).then(|| self.draw_turned(&exposures, band, (format.width, format.height)));
        let noise_sd = (options.noise_sd / 255.0) as f32;
        encoded(format, &options.matrix, options.siting, |y, row| {
            match &turned {
                None => exposures[y / band].draw(y, row),
                Some(turned) => row.rgb.clone_from(&turned[y]),
            }
            add_noise(&mut row.rgb, noise_sd, options.seed, frame, y);
        })
    }

    /// The rows of the stored picture of this size, drawn as it is shown and turned back; each of the exposures has
    /// `band` of them.
    fn draw_turned(&self, exposures: &[Exposure<'_>], band: usize, stored: (usize, usize)) -> Vec<[Vec<f32>; 3]> {
        let (width, height) = (self.options.width, self.options.height);
        let at = |x: usize, y: usize| {
            let [x, y] = self.options.turn.shown_from_stored([x as f64, y as f64], stored);
            (x as usize, y as usize)
        };
        let rows = |(k, exposure): (usize, &Exposure<'_>)| -> Vec<[Vec<f32>; 3]> {
            let draw = |y| {
                let mut row = Row::new(width);
                exposure.draw(y, &mut row);
                row.rgb
            };
            let shown: Vec<[Vec<f32>; 3]> = (0..height).into_par_iter().map(draw).collect();
            let row = |y| {
                std::array::from_fn(|channel| {
                    (0..stored.0).map(|x| at(x, y)).map(|(x, y)| shown[y][channel][x]).collect()
                })
            };
            (k * band..((k + 1) * band).min(stored.1)).into_par_iter().map(row).collect()
        };
        exposures.iter().enumerate().flat_map(rows).collect()
    }
}
