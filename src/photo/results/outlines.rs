//! What detection found, drawn over the photographs: confident, doubtful and left out in three colours, for a person to
//! see in one look what happened.

use image::RgbImage;
use rayon::prelude::*;

use super::draw::DrawnSheet;
use crate::figure::{Sheet, Tile, TilePicture};
use crate::files::{Staging, WriteError};
use crate::photo::outline::Nail;
use crate::photograph::Photograph;
use crate::vision::{VisionError, closed_line, resized};

/// Photographs of a set that are drawn, the first ones: memory doesn't grow with the set.
pub(in crate::photo) const MOST_DRAWN: usize = 240;
/// Longest side of a drawn photograph, pixels.
const LONGEST_PX: usize = 360;
const PER_SHEET: usize = 24;
const PER_ROW: usize = 6;
/// Of finds that are used, of those that a person should look at, of those that are left out for another reason.
const CONFIDENT: [u8; 3] = [0, 205, 60];
const DOUBTFUL: [u8; 3] = [255, 200, 0];
const LEFT_OUT: [u8; 3] = [235, 40, 40];

/// A photograph, small, with the outlines found on it.
///
/// # Errors
/// [`VisionError`].
pub(in crate::photo) fn drawn_outlines(picture: &Photograph, nails: &[Nail]) -> Result<RgbImage, VisionError> {
    let rgb = picture.image.to_rgb8();
    let from = [rgb.width() as usize, rgb.height() as usize];
    let scale = (LONGEST_PX as f64 / from[0].max(from[1]) as f64).min(1.0);
    let to = from.map(|n| ((n as f64 * scale).round() as usize).max(1));
    let mut small = resized(&rgb, from, to)?;
    let share = [0, 1].map(|k| to[k] as f64 / from[k] as f64);
    for nail in nails {
        let Some(outline) = &nail.outline else { continue };
        let colour = match nail.confidence {
            _ if nail.reason.is_empty() => CONFIDENT,
            Some(_) => DOUBTFUL,
            None => LEFT_OUT,
        };
        let place = |p: [f64; 2]| [0, 1].map(|k| (p[k] + 0.5) * share[k] - 0.5);
        let corners: Vec<[f64; 2]> = outline.points().into_iter().map(place).collect();
        closed_line(&mut small, to, &corners, colour, 2)?;
        if let Some(axis) = nail.axis {
            // From the middle to the distal end.
            let middle = corners.iter().fold([0.0; 2], |sum, c| [0, 1].map(|k| sum[k] + c[k] / corners.len() as f64));
            let way = axis.distal();
            let reach = corners.iter().map(|c| (c[0] - middle[0]) * way[0] + (c[1] - middle[1]) * way[1]);
            let reach = reach.fold(0.0, f64::max);
            let end = [0, 1].map(|k| middle[k] + reach * way[k]);
            closed_line(&mut small, to, &[middle, end], colour, 1)?;
        }
    }
    Ok(RgbImage::from_raw(to[0] as u32, to[1] as u32, small).expect("three samples a pixel"))
}

/// Draws the sheets of these photographs, each with its name, and writes them.
///
/// # Errors
/// [`WriteError`].
pub(in crate::photo) fn draw_outlines(
    photographs: Vec<(String, RgbImage)>,
    staging: &Staging,
) -> Result<Vec<DrawnSheet>, WriteError> {
    let mut sheets: Vec<Sheet> = Vec::new();
    for (caption, picture) in photographs {
        if sheets.last().is_none_or(|sheet| sheet.tiles.len() == PER_SHEET) {
            let title = format!(
                "Outlines found, sheet {}: green used, yellow doubtful, red left out; the line runs to the distal end",
                sheets.len() + 1
            );
            sheets.push(Sheet { title, tiles: Vec::new(), columns: PER_ROW, scale: None });
        }
        if let Some(sheet) = sheets.last_mut() {
            sheet.tiles.push(Tile { caption, picture: TilePicture::Colour(picture), png: None });
        }
    }
    let draw = |(at, sheet): (usize, &Sheet)| {
        let name = format!("figures/outlines-{}.png", at + 1);
        let png = sheet.png().map_err(|why| staging.refused(&name, why))?;
        staging.write(&name, &png)?;
        Ok(DrawnSheet { title: sheet.title.clone(), png })
    };
    sheets.par_iter().enumerate().map(draw).collect()
}
