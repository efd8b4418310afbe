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

impl Scene {
    /// A frame's picture, as the encoder gets it: stored, not shown.
    #[must_use]
    pub fn picture(&self, frame: usize) -> Picture {
        let options = &self.options;
        let format = options.format();
        let exposure = Exposure::new(self, frame);
        let turned = (options.turn != Turn::None).then(|| self.draw_turned(&exposure, format.width));
        let noise_sd = (options.noise_sd / 255.0) as f32;
        encoded(format, &options.matrix, options.siting, |y, row| {
            match &turned {
                None => exposure.draw(y, row),
                Some(turned) => row.rgb.clone_from(&turned[y]),
            }
            add_noise(&mut row.rgb, noise_sd, options.seed, frame, y);
        })
    }

    /// The rows of the stored picture, drawn as it is shown and turned back.
    fn draw_turned(&self, exposure: &Exposure<'_>, stored_width: usize) -> Vec<[Vec<f32>; 3]> {
        let (width, height) = (self.options.width, self.options.height);
        let draw = |y| {
            let mut row = Row::new(width);
            exposure.draw(y, &mut row);
            row.rgb
        };
        let shown: Vec<[Vec<f32>; 3]> = (0..height).into_par_iter().map(draw).collect();
        let stored = (stored_width, width * height / stored_width);
        let at = |x: usize, y: usize| {
            let [x, y] = self.options.turn.shown_from_stored([x as f64, y as f64], stored);
            (x as usize, y as usize)
        };
        let row = |y| {
            std::array::from_fn(|channel| (0..stored.0).map(|x| at(x, y)).map(|(x, y)| shown[y][channel][x]).collect())
        };
        (0..stored.1).into_par_iter().map(row).collect()
    }
}
