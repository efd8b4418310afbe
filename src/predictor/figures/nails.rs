//! Eigennails as pictures: the mean of the cells and each mode, distal up.
//!
//! The mean is grey, dark for low values. Modes are white at 0, red where the cell rises with the score, blue where it
//! falls, each as strong as its largest component; cells outside of the nail are pale blue-grey.

use std::path::Path;

use image::{Rgb, RgbImage};
use lunula_predictor::Eigennails;

use crate::figure::{Sheet, Tile, TilePicture};
use crate::median::ends;
use crate::predictor::data::cell;

/// Side of a picture, pixels, about.
const SIDE_PX: usize = 192;
/// Pictures beside each other.
const COLUMNS: usize = 5;
/// Cells that are not there: the colour of unknown pixels on sheets.
const UNKNOWN: Rgb<u8> = Rgb([205, 216, 240]);
const RED: [f64; 3] = [178.0, 24.0, 43.0];
const BLUE: [f64; 3] = [33.0, 102.0, 172.0];

/// Draws the mean and all modes; `names`: of the model's cells.
///
/// # Errors
/// A file that can't be written, or inputs that are no cells.
pub(in crate::predictor) fn draw_nails(
    model: &Eigennails,
    names: &[String],
    png: &Path,
    svg: &Path,
) -> anyhow::Result<()> {
    let places: Option<Vec<[usize; 2]>> = names.iter().map(|name| cell(name)).collect();
    let Some(places) = places else { anyhow::bail!("the model reads columns that are no cells, such as C_00_00") };
    let basis = model.basis();
    let [low, high] = ends(basis.mean().iter().copied());
    let grey = |value: f64| {
        let share = if high > low { (value - low) / (high - low) } else { 0.5 };
        Rgb([(255.0 * share + 0.5) as u8; 3])
    };
    let mut tiles = vec![tile(format!("mean, {low:.4} to {high:.4}"), &places, basis.mean().iter().map(|&v| grey(v)))];
    for (k, (mode, spread)) in basis.modes().rows().into_iter().zip(basis.spread()).enumerate() {
        let most = mode.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        let caption = format!("mode {}, SD {}", k + 1, super::three_digits(*spread));
        tiles.push(tile(caption, &places, mode.iter().map(|value| signed(value / most))));
    }
    let title = "Eigennails: red rises with the score, blue falls".to_owned();
    let sheet = Sheet { title, tiles, columns: COLUMNS, scale: None };
    std::fs::write(png, sheet.png()?)?;
    std::fs::write(svg, sheet.svg()?)?;
    Ok(())
}

/// White at 0, red at 1, blue at -1.
fn signed(value: f64) -> Rgb<u8> {
    let end = if value < 0.0 { BLUE } else { RED };
    Rgb(end.map(|end| (255.0 + (end - 255.0) * value.abs().min(1.0) + 0.5) as u8))
}

fn tile(caption: String, places: &[[usize; 2]], colours: impl Iterator<Item = Rgb<u8>>) -> Tile {
    let cells = places.iter().flatten().max().map_or(1, |most| most + 1);
    let block = (SIDE_PX / cells).max(1);
    let side = (cells * block) as u32;
    let mut picture = RgbImage::from_pixel(side, side, UNKNOWN);
    for ([row, column], colour) in places.iter().zip(colours) {
        for y in row * block..(row + 1) * block {
            for x in column * block..(column + 1) * block {
                picture.put_pixel(x as u32, y as u32, colour);
            }
        }
    }
    Tile { caption, picture: TilePicture::Colour(picture), png: None }
}
