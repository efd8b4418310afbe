//! Pictures of results: grey maps, sheets with captions and scales, charts, reports. It knows numbers and pictures, not
//! jobs.

mod chart;
mod grey;
mod html;
mod picture;
mod sheet;
mod text;
mod thin;

use std::io::Cursor;

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{DynamicImage, ImageEncoder, ImageError};

pub use chart::{
    Axis, Bar, Cell, Chart, Item, Mark, MarkShape, Point, draw_charts, draw_grid, draw_log_log, draw_panels,
};
pub use grey::{Stretch, grey_map};
pub use html::{Page, escape};
pub use sheet::{Scale, Sheet, Tile};
pub use thin::{Bin, MOST_BINS, Sample, Summary, Thinned};

/// How much of each pixel a text covers (0 to 255), `height_px` high: to draw on pictures that are not RGB.
#[must_use]
pub fn text_coverage(text: &str, height_px: f32) -> image::GrayImage {
    text::coverage(text, height_px)
}

/// A picture as a PNG file, encoded fast rather than small.
///
/// # Errors
/// A picture without pixels, or with samples that PNG does not hold.
pub fn png(picture: &DynamicImage) -> Result<Vec<u8>, ImageError> {
    let mut png = Vec::new();
    let encoder = PngEncoder::new_with_quality(Cursor::new(&mut png), CompressionType::Fast, FilterType::Up);
    encoder.write_image(picture.as_bytes(), picture.width(), picture.height(), picture.color().into())?;
    Ok(png)
}
