//! A picture file to upright pixels.
//!
//! In: the path of a PNG, JPEG, TIFF or BMP file; the *content* says which, not the name. Out: a [`Photograph`], its
//! EXIF orientation applied once, 8 or 16 bits a channel as in the file, grey or colour. A truncated JPEG decodes
//! "successfully", grey where the data ends, in most decoders: here its end-of-image marker is looked for first.

use std::io::Cursor;
use std::path::Path;

use image::metadata::Orientation;
use image::{ColorType, DynamicImage, ImageDecoder, ImageFormat, ImageReader};
use thiserror::Error;

/// Why a file is no photograph. `Display` says what to do; the caller adds which file.
#[derive(Debug, Error)]
pub enum ReadFault {
    /// The file can't be opened or read.
    #[error("cannot be read: {0}")]
    Io(#[from] std::io::Error),
    /// Neither PNG, JPEG, TIFF nor BMP by its first bytes.
    #[error("is not a PNG, JPEG, TIFF or BMP picture, whatever its name says; convert it to one of these")]
    NotAPicture,
    /// A JPEG without an end: the rest would be grey.
    #[error("is a truncated JPEG: its data end before the picture does; copy the file again from the camera")]
    Truncated,
    /// Sample formats other than 8 and 16 bit integers.
    #[error("has {0:?} samples; save it with 8 or 16 bits a channel, grey or RGB")]
    Samples(ColorType),
    /// The decoder's own complaint.
    #[error("cannot be decoded ({0}); it may be damaged: copy or export it again")]
    Decode(#[from] image::ImageError),
}

/// An upright photograph and what is known of its file.
#[derive(Debug, Clone)]
pub struct Photograph {
    /// Upright pixels: L, La, Rgb or Rgba of 8 or 16 bits.
    pub image: DynamicImage,
    /// What was done to the stored pixels to make them upright.
    pub orientation: Orientation,
}

/// Bits a channel of the source.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Depth {
    /// 0 to 255.
    Eight,
    /// 0 to 65535.
    Sixteen,
}

impl Photograph {
    /// Reads, decodes and turns upright.
    ///
    /// # Errors
    /// [`ReadFault`] where the file is missing, no picture, truncated, damaged or of another sample format.
    pub fn read(path: &Path) -> Result<Self, ReadFault> {
        let bytes = std::fs::read(path)?;
        let (mut decoder, format) = decoder_for(&bytes)?;
        if format == ImageFormat::Jpeg && !jpeg_is_complete(&bytes) {
            return Err(ReadFault::Truncated);
        }
        let orientation = decoder.orientation()?;
        let mut image = DynamicImage::from_decoder(decoder)?;
        if !is_supported(image.color()) {
            return Err(ReadFault::Samples(image.color()));
        }
        image.apply_orientation(orientation);
        Ok(Self { image, orientation })
    }

    /// Width and height of the stored (not yet upright) picture, pixels.
    pub fn stored_size(&self) -> [u32; 2] {
        let (width, height) = (self.image.width(), self.image.height());
        if swaps_sides(self.orientation) { [height, width] } else { [width, height] }
    }

    /// Bits a channel.
    pub fn depth(&self) -> Depth {
        match self.image.color().bytes_per_pixel() / self.image.color().channel_count() {
            1 => Depth::Eight,
            _ => Depth::Sixteen,
        }
    }

    /// Stored as grey, or as colour with three equal channels throughout (a camera's monochrome mode).
    pub fn is_grey(&self) -> bool {
        match &self.image {
            DynamicImage::ImageRgb8(p) => p.pixels().all(|p| p.0[0] == p.0[1] && p.0[1] == p.0[2]),
            DynamicImage::ImageRgba8(p) => p.pixels().all(|p| p.0[0] == p.0[1] && p.0[1] == p.0[2]),
            DynamicImage::ImageRgb16(p) => p.pixels().all(|p| p.0[0] == p.0[1] && p.0[1] == p.0[2]),
            DynamicImage::ImageRgba16(p) => p.pixels().all(|p| p.0[0] == p.0[1] && p.0[1] == p.0[2]),
            _ => true,
        }
    }
}

/// Whether a file's header says grey; no pixel is decoded. Used by plans.
///
/// # Errors
/// As [`Photograph::read`], but only what the header shows.
pub(super) fn header_is_grey(path: &Path) -> Result<bool, ReadFault> {
    let file = std::io::BufReader::new(std::fs::File::open(path)?);
    let reader = ImageReader::new(file).with_guessed_format()?;
    match reader.format() {
        Some(ImageFormat::Png | ImageFormat::Jpeg | ImageFormat::Tiff | ImageFormat::Bmp) => {}
        _ => return Err(ReadFault::NotAPicture),
    }
    Ok(!reader.into_decoder()?.color_type().has_color())
}

fn decoder_for(bytes: &[u8]) -> Result<(impl ImageDecoder + '_, ImageFormat), ReadFault> {
    let reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format()?;
    match reader.format() {
        Some(format @ (ImageFormat::Png | ImageFormat::Jpeg | ImageFormat::Tiff | ImageFormat::Bmp)) => {
            Ok((reader.into_decoder()?, format))
        }
        _ => Err(ReadFault::NotAPicture),
    }
}

fn is_supported(color: ColorType) -> bool {
    use ColorType::{L8, L16, La8, La16, Rgb8, Rgb16, Rgba8, Rgba16};
    matches!(color, L8 | L16 | La8 | La16 | Rgb8 | Rgb16 | Rgba8 | Rgba16)
}

fn swaps_sides(orientation: Orientation) -> bool {
    use Orientation::{Rotate90, Rotate90FlipH, Rotate270, Rotate270FlipH};
    matches!(orientation, Rotate90 | Rotate270 | Rotate90FlipH | Rotate270FlipH)
}

/// Walks a JPEG's segments (ITU-T T.81, annex B) up to the end-of-image marker. Thumbnails within application segments
/// have markers of their own, so the segments are skipped by their lengths, not searched.
fn jpeg_is_complete(bytes: &[u8]) -> bool {
    const START_OF_SCAN: u8 = 0xDA;
    const END_OF_IMAGE: u8 = 0xD9;
    let mut at = 2;
    loop {
        // Entropy-coded data, and fill bytes, run up to the next marker: 0xFF with neither 0x00, 0xFF nor a restart.
        let Some(skip) = bytes
            .get(at..)
            .and_then(|rest| rest.windows(2).position(|w| w[0] == 0xFF && !matches!(w[1], 0x00 | 0xFF | 0xD0..=0xD7)))
        else {
            return false;
        };
        at += skip;
        match bytes[at + 1] {
            END_OF_IMAGE => return true,
            marker => {
                let Some(length) = bytes.get(at + 2..at + 4).map(|l| usize::from(l[0]) << 8 | usize::from(l[1])) else {
                    return false;
                };
                if length < 2 || (marker != START_OF_SCAN && at + 2 + length > bytes.len()) {
                    return false;
                }
                at += 2 + length;
            }
        }
    }
}

/// A point of the stored picture on the upright one, both in *corner* coordinates (the picture's corner is (0, 0)).
pub(crate) fn upright_from_stored(orientation: Orientation, stored_size: [u32; 2], [x, y]: [f64; 2]) -> [f64; 2] {
    let (width, height) = (f64::from(stored_size[0]), f64::from(stored_size[1]));
    match orientation {
        Orientation::NoTransforms => [x, y],
        Orientation::Rotate90 => [height - y, x],
        Orientation::Rotate180 => [width - x, height - y],
        Orientation::Rotate270 => [y, width - x],
        Orientation::FlipHorizontal => [width - x, y],
        Orientation::FlipVertical => [x, height - y],
        Orientation::Rotate90FlipH => [y, x],
        Orientation::Rotate270FlipH => [height - y, width - x],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{GenericImageView, Luma};

    const ALL: [Orientation; 8] = [
        Orientation::NoTransforms,
        Orientation::Rotate90,
        Orientation::Rotate180,
        Orientation::Rotate270,
        Orientation::FlipHorizontal,
        Orientation::FlipVertical,
        Orientation::Rotate90FlipH,
        Orientation::Rotate270FlipH,
    ];

    #[test]
    fn points_turn_as_the_pixels_do() {
        for orientation in ALL {
            let stored = image::GrayImage::from_fn(5, 3, |x, y| Luma([(10 * y + x) as u8]));
            let mut upright = DynamicImage::ImageLuma8(stored.clone());
            upright.apply_orientation(orientation);
            for (x, y, value) in stored.enumerate_pixels() {
                let centre = [f64::from(x) + 0.5, f64::from(y) + 0.5];
                let [ux, uy] = upright_from_stored(orientation, [5, 3], centre);
                let there = upright.get_pixel((ux - 0.5) as u32, (uy - 0.5) as u32);
                assert_eq!(there.0[0], value.0[0], "{orientation:?} ({x}, {y})");
            }
        }
    }

    #[test]
    fn a_jpeg_is_complete_only_with_its_end() {
        let mut bytes = Vec::new();
        let picture = image::RgbImage::from_fn(64, 48, |x, y| image::Rgb([(x * 3) as u8, (y * 5) as u8, 77]));
        picture.write_to(&mut Cursor::new(&mut bytes), ImageFormat::Jpeg).expect("an encoder writes to memory");
        assert!(jpeg_is_complete(&bytes));
        for cut in [2, 3, 20, bytes.len() / 2, bytes.len() - 1] {
            assert!(!jpeg_is_complete(&bytes[..cut]), "cut at {cut} of {}", bytes.len());
        }
        // A thumbnail's end-of-image within an application segment is not the picture's.
        let mut with_thumbnail = vec![0xFF, 0xD8, 0xFF, 0xE1, 0x00, 0x06, 0xFF, 0xD8, 0xFF, 0xD9];
        with_thumbnail.extend_from_slice(&bytes[2..bytes.len() - 2]);
        assert!(!jpeg_is_complete(&with_thumbnail));
        bytes.extend_from_slice(b"maker's trailer");
        assert!(jpeg_is_complete(&bytes));
    }
}
