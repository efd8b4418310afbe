//! Pictures of results: grey maps, sheets with captions and scales, charts, reports. It knows numbers and pictures, not
//! jobs.

mod chart;
#[cfg(test)]
pub(crate) mod drawn;
mod grey;
mod html;
mod letters;
mod picture;
mod sheet;
mod text;
mod thin;

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{DynamicImage, ExtendedColorType, GrayAlphaImage, GrayImage, ImageEncoder, ImageError};

pub use chart::{Bar, Cell, Chart, Item, Mark, MarkShape, Point, draw_charts, draw_grid, draw_log_log, draw_panels};
pub use grey::{Stretch, grey_map};
pub use html::{Page, escape};
pub use sheet::{Scale, Sheet, Tile, TilePicture};
pub use text::text_coverage;
pub use thin::{Bin, MOST_BINS, Sample, Summary, Thinned};

/// A picture as a PNG file, encoded fast rather than small.
///
/// # Errors
/// A picture without pixels, or with samples that PNG does not hold.
pub fn png(picture: &DynamicImage) -> Result<Vec<u8>, ImageError> {
    let mut png = Vec::new();
    let size = [picture.width(), picture.height()];
    encode_png(picture.as_bytes(), size, picture.color().into(), &mut png)?;
    Ok(png)
}

/// A grey picture as a PNG file; of one channel where nothing is transparent.
///
/// # Errors
/// As [`png()`].
pub fn png_of_grey(picture: &GrayAlphaImage) -> Result<Vec<u8>, ImageError> {
    let mut png = Vec::new();
    let size = [picture.width(), picture.height()];
    if picture.pixels().all(|pixel| pixel.0[1] == 255) {
        let levels: Vec<u8> = picture.chunks_exact(2).map(|pixel| pixel[0]).collect();
        encode_png(&levels, size, ExtendedColorType::L8, &mut png)?;
    } else {
        encode_png(picture, size, ExtendedColorType::La8, &mut png)?;
    }
    Ok(png)
}

/// Grey levels as a PNG file in which level 0 has a colour.
fn png_of_levels(levels: &GrayImage, first: [u8; 3]) -> Result<Vec<u8>, ImageError> {
    let mut png = Vec::new();
    let mut encoder = png::Encoder::new(&mut png, levels.width(), levels.height());
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_palette(std::iter::once(first).chain((1..=255).map(|level| [level; 3])).flatten().collect::<Vec<u8>>());
    encoder.set_compression(png::Compression::Fast);
    encoder.set_filter(png::Filter::Up);
    let written = encoder.write_header().and_then(|mut writer| {
        writer.write_image_data(levels)?;
        writer.finish()
    });
    written.map_err(|why| ImageError::IoError(why.into()))?;
    Ok(png)
}

/// Encodes samples, of 16 bits in the machine's order, at the end of `png`.
pub(crate) fn encode_png(
    samples: &[u8],
    [width, height]: [u32; 2],
    colour: ExtendedColorType,
    png: &mut Vec<u8>,
) -> Result<(), ImageError> {
    PngEncoder::new_with_quality(png, CompressionType::Fast, FilterType::Up).write_image(samples, width, height, colour)
}
