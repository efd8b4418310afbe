//! A picture file to upright pixels.
//!
//! In: the path of a PNG, JPEG, TIFF or BMP file; the *content* says which, not the name. Out: a [`Photograph`], its
//! EXIF orientation applied once, 8 or 16 bits a channel as in the file, grey or colour. A truncated JPEG decodes
//! "successfully", grey where the data ends, in most decoders: here its end-of-image marker is looked for first.

mod profile;

use std::borrow::Cow;
use std::fs::File;
use std::io::{Cursor, Read};
use std::path::Path;

use image::metadata::Orientation;
use image::{ColorType, DynamicImage, ImageBuffer, ImageDecoder, ImageFormat, ImageReader, Limits, Pixel, RgbImage};
use thiserror::Error;

use crate::input::in_words;

pub use profile::Profile;

/// Endings of the files that are taken as photographs.
pub(crate) const PICTURES: [&str; 6] = ["png", "jpg", "jpeg", "tif", "tiff", "bmp"];

/// Whether a file's name is that of a picture that lunula reads.
pub(crate) fn is_picture(path: &Path) -> bool {
    extension(path).is_some_and(|ending| PICTURES.contains(&ending.as_str()))
}

/// A file's ending in small letters.
pub(crate) fn extension(path: &Path) -> Option<String> {
    path.extension().map(|ending| ending.to_string_lossy().to_lowercase())
}

/// Why a file is not a photograph. `Display` says what to do; the caller adds which file.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum ReadFault {
    #[error("{0}")]
    Io(#[from] std::io::Error),
    /// Neither PNG, JPEG, TIFF nor BMP by its first bytes.
    #[error("is not a PNG, JPEG, TIFF or BMP picture, whatever its name says; convert it to one of these")]
    NotAPicture,
    #[error(
        "has {width} x {height} px, {:.1} megapixels, more than the {megapixels} that are read; make it smaller, or \
         allow more with --max-megapixels", (f64::from(*width) * f64::from(*height) / 1e6)
    )]
    TooLarge { width: u32, height: u32, megapixels: u32 },
    #[error(
        "is longer than a picture of {megapixels} megapixels can be; make it smaller, or allow more with \
         --max-megapixels"
    )]
    TooLong { megapixels: u32 },
    /// A JPEG without an end: the rest would be grey.
    #[error("is a truncated JPEG: its data end before the picture does; copy the file again from the camera")]
    Truncated,
    /// Sample formats other than 8 and 16 bit integers.
    #[error("has {0:?} samples; save it with 8 or 16 bits a channel, grey or RGB")]
    Samples(ColorType),
    #[error("has 8 bits a channel, whose white is 255; --white is for 16 bits: run such photographs apart, without it")]
    WhiteOfEight,
    #[error("has a sample of {largest}, above --white {white}; give the sensor's largest value (4095 of 12 bits)")]
    AboveWhite { largest: u16, white: u16 },
    /// sRGB's curve is to be undone where it was not used.
    #[error(
        "has the colour profile `{0}`, whose curve is not sRGB's, which --linear undoes; export it as sRGB, or leave \
         out --linear"
    )]
    OtherCurve(String),
    /// A kind of TIFF or the like that the decoder does not know: CIELab, YCbCr, floating point.
    #[error("cannot be decoded ({0}); export it with 8 or 16 bits, in grey or RGB, as PNG, TIFF, BMP or JPEG")]
    Unsupported(image::ImageError),
    #[error("cannot be decoded ({}); it may be damaged: copy or export it again", .0.to_string().trim_end())]
    Decode(image::ImageError),
}

impl From<image::ImageError> for ReadFault {
    fn from(why: image::ImageError) -> Self {
        if matches!(why, image::ImageError::Unsupported(_)) { Self::Unsupported(why) } else { Self::Decode(why) }
    }
}

/// An upright photograph and what is known of its file.
///
/// ```
/// use std::path::Path;
///
/// use lunula::photo::{Depth, Photograph};
///
/// let photograph = Photograph::read(Path::new("fixtures/photos/extension/s01.png"))?;
/// assert_eq!((photograph.image.width(), photograph.image.height()), (320, 240));
/// assert_eq!(photograph.depth(), Depth::Eight);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Photograph {
    /// Upright pixels: L, La, Rgb or Rgba of 8 or 16 bits.
    pub image: DynamicImage,
    /// What was done to the stored pixels to make them upright.
    pub orientation: Orientation,
    /// Whose colours the samples are, where they are not sRGB's. Samples are as the file encodes them all the same.
    pub profile: Option<Profile>,
}

/// Memory that goes from photograph to photograph, so that it is not taken from the system, and cleared by it, each
/// time.
#[derive(Debug, Default)]
pub(crate) struct PhotoBuffer {
    file: Vec<u8>,
    /// Of 8 bits.
    samples: Vec<u8>,
}

impl PhotoBuffer {
    /// Takes back the memory of a photograph that is done with.
    pub(crate) fn take_back(&mut self, photograph: Photograph) {
        self.samples = match photograph.image {
            DynamicImage::ImageLuma8(p) => p.into_raw(),
            DynamicImage::ImageLumaA8(p) => p.into_raw(),
            DynamicImage::ImageRgb8(p) => p.into_raw(),
            DynamicImage::ImageRgba8(p) => p.into_raw(),
            _ => return,
        };
    }
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

/// Megapixels of a photograph that are read unless more are allowed: the largest phones make 201, a scanned A4 page at
/// 1200 dots an inch has 140.
pub const MOST_MEGAPIXELS: u32 = 250;
/// Bytes of a file beside its pixels: profiles, previews, notes.
const METADATA_BYTES: u64 = 64 << 20;
/// Bytes that say what a file is.
const FIRST_BYTES: u64 = 64;

impl Photograph {
    /// Reads, decodes and turns upright; as [`Photograph::read_up_to`] with [`MOST_MEGAPIXELS`].
    pub fn read(path: &Path) -> Result<Self, ReadFault> {
        Self::read_up_to(path, MOST_MEGAPIXELS)
    }

    /// Reads, decodes and turns upright a picture of up to so many megapixels; its size is known from its header,
    /// before memory is taken for it.
    ///
    /// # Errors
    /// [`ReadFault`] where the file is missing, no picture, too large, truncated, damaged or of another sample format.
    pub fn read_up_to(path: &Path, megapixels: u32) -> Result<Self, ReadFault> {
        Self::read_into(path, megapixels, &mut PhotoBuffer::default())
    }

    /// As [`Photograph::read_up_to`], in memory that a photograph before this one left.
    pub(crate) fn read_into(path: &Path, megapixels: u32, buffer: &mut PhotoBuffer) -> Result<Self, ReadFault> {
        let PhotoBuffer { file: bytes, samples } = buffer;
        read_bytes(path, megapixels, bytes)?;
        let (mut decoder, format) = decoder_for(bytes)?;
        let (width, height) = decoder.dimensions();
        if u64::from(width) * u64::from(height) > pixels(megapixels) {
            return Err(ReadFault::TooLarge { width, height, megapixels });
        }
        // What a decoder takes besides follows from the picture, not from what its header says of tiles and strips.
        let mut limits = Limits::no_limits();
        limits.max_alloc = Some(2 * decoder.total_bytes() + METADATA_BYTES);
        decoder.set_limits(limits)?;
        if format == ImageFormat::Jpeg && !jpeg_is_complete(bytes) {
            return Err(ReadFault::Truncated);
        }
        let orientation = decoder.orientation()?;
        let by_gamma = || (format == ImageFormat::Png).then(|| Profile::of_png_gamma(bytes)).flatten();
        let profile = Profile::of(&mut decoder).or_else(by_gamma);
        if !is_supported(decoder.color_type()) {
            return Err(ReadFault::Samples(decoder.color_type()));
        }
        let mut image = match decoder.color_type() {
            ColorType::L8 => eight_bits(decoder, samples)?.map(DynamicImage::ImageLuma8),
            ColorType::La8 => eight_bits(decoder, samples)?.map(DynamicImage::ImageLumaA8),
            ColorType::Rgb8 => eight_bits(decoder, samples)?.map(DynamicImage::ImageRgb8),
            ColorType::Rgba8 => eight_bits(decoder, samples)?.map(DynamicImage::ImageRgba8),
            _ => Some(DynamicImage::from_decoder(decoder)?),
        }
        .expect("as many samples as the decoder says");
        image.apply_orientation(orientation);
        Ok(Self { image, orientation, profile })
    }

    /// The largest sample of a photograph of 16 bits, opacity apart; `None` of 8 bits.
    pub fn largest_of_16_bits(&self) -> Option<u16> {
        let most = |samples: &[u16], channels: usize, taken: usize| {
            samples.chunks_exact(channels).flat_map(|pixel| &pixel[..taken]).copied().max().unwrap_or(0)
        };
        match &self.image {
            DynamicImage::ImageLuma16(p) => Some(most(p, 1, 1)),
            DynamicImage::ImageLumaA16(p) => Some(most(p, 2, 1)),
            DynamicImage::ImageRgb16(p) => Some(most(p, 3, 3)),
            DynamicImage::ImageRgba16(p) => Some(most(p, 4, 3)),
            _ => None,
        }
    }

    /// Makes `white` full scale: of 12 bits kept in 16, the largest value is 4095. Opacity stays.
    ///
    /// # Errors
    /// [`ReadFault::WhiteOfEight`] and [`ReadFault::AboveWhite`].
    pub fn stretch_to(&mut self, white: u16) -> Result<(), ReadFault> {
        let largest = self.largest_of_16_bits().ok_or(ReadFault::WhiteOfEight)?;
        if largest > white {
            return Err(ReadFault::AboveWhite { largest, white });
        }
        let full = u32::from(u16::MAX);
        let stretched = |sample: &mut u16| {
            // At most white: the quotient is at most full scale, and the product fits.
            *sample = ((u32::from(*sample) * full + u32::from(white) / 2) / u32::from(white)) as u16;
        };
        let all = |samples: &mut [u16], channels: usize, taken: usize| {
            samples.chunks_exact_mut(channels).flat_map(|pixel| &mut pixel[..taken]).for_each(stretched);
        };
        match &mut self.image {
            DynamicImage::ImageLuma16(p) => all(p, 1, 1),
            DynamicImage::ImageLumaA16(p) => all(p, 2, 1),
            DynamicImage::ImageRgb16(p) => all(p, 3, 3),
            DynamicImage::ImageRgba16(p) => all(p, 4, 3),
            _ => {}
        }
        Ok(())
    }

    /// Whether sRGB's curve may be undone.
    ///
    /// # Errors
    /// [`ReadFault::OtherCurve`].
    pub fn has_srgb_curve(&self) -> Result<(), ReadFault> {
        match self.profile.as_ref().filter(|profile| profile.has_other_curve()) {
            Some(profile) => Err(ReadFault::OtherCurve(profile.name.clone())),
            None => Ok(()),
        }
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
        is_grey(&self.image)
    }
}

/// Red, green and blue of 8 bits; without a copy where they are so already.
pub(crate) fn as_rgb8(image: &DynamicImage) -> Cow<'_, RgbImage> {
    match image {
        DynamicImage::ImageRgb8(rgb) => Cow::Borrowed(rgb),
        other => Cow::Owned(other.to_rgb8()),
    }
}

pub(crate) fn is_grey(image: &DynamicImage) -> bool {
    match image {
        DynamicImage::ImageRgb8(p) => p.pixels().all(|p| p.0[0] == p.0[1] && p.0[1] == p.0[2]),
        DynamicImage::ImageRgba8(p) => p.pixels().all(|p| p.0[0] == p.0[1] && p.0[1] == p.0[2]),
        DynamicImage::ImageRgb16(p) => p.pixels().all(|p| p.0[0] == p.0[1] && p.0[1] == p.0[2]),
        DynamicImage::ImageRgba16(p) => p.pixels().all(|p| p.0[0] == p.0[1] && p.0[1] == p.0[2]),
        _ => true,
    }
}

/// Whether a file's header says grey; no pixel is decoded. Used by plans.
///
/// # Errors
/// As [`Photograph::read`], but only what the header shows.
pub(crate) fn header_is_grey(path: &Path) -> Result<bool, ReadFault> {
    let file = std::io::BufReader::new(opened(path)?);
    let reader = ImageReader::new(file).with_guessed_format()?;
    known(reader.format())?;
    Ok(!reader.into_decoder()?.color_type().has_color())
}

fn pixels(megapixels: u32) -> u64 {
    u64::from(megapixels) * 1_000_000
}

/// A picture may come through a pipe, which is read once.
fn opened(path: &Path) -> std::io::Result<File> {
    File::open(path).map_err(|why| in_words(path, why))
}

/// Reads a picture file's bytes. What is not a picture is not read to its end, which some devices don't have.
fn read_bytes(path: &Path, megapixels: u32, bytes: &mut Vec<u8>) -> Result<(), ReadFault> {
    // 16 bits of four channels, as they are.
    let most = 8 * pixels(megapixels) + METADATA_BYTES;
    let mut file = opened(path)?;
    let length = file.metadata()?.len();
    bytes.clear();
    file.by_ref().take(FIRST_BYTES).read_to_end(bytes)?;
    known(image::guess_format(bytes).ok())?;
    if length <= most {
        bytes.reserve_exact(length as usize);
        file.take(most - bytes.len() as u64 + 1).read_to_end(bytes)?;
    }
    if length.max(bytes.len() as u64) > most { Err(ReadFault::TooLong { megapixels }) } else { Ok(()) }
}

fn decoder_for(bytes: &[u8]) -> Result<(impl ImageDecoder + '_, ImageFormat), ReadFault> {
    let reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format()?;
    let format = known(reader.format())?;
    Ok((reader.into_decoder()?, format))
}

fn known(format: Option<ImageFormat>) -> Result<ImageFormat, ReadFault> {
    use ImageFormat::{Bmp, Jpeg, Png, Tiff};
    format.filter(|format| matches!(format, Png | Jpeg | Tiff | Bmp)).ok_or(ReadFault::NotAPicture)
}

/// Decodes samples of 8 bits in `memory`; what no decoder writes is 0, whatever was there before.
fn eight_bits<P>(decoder: impl ImageDecoder, memory: &mut Vec<u8>) -> Result<Option<ImageBuffer<P, Vec<u8>>>, ReadFault>
where
    P: Pixel<Subpixel = u8>,
{
    let (width, height) = decoder.dimensions();
    let bytes = usize::try_from(decoder.total_bytes()).unwrap_or(usize::MAX);
    memory.clear();
    memory.try_reserve_exact(bytes).map_err(image::ImageError::from)?;
    memory.resize(bytes, 0);
    decoder.read_image(memory)?;
    Ok(ImageBuffer::from_raw(width, height, std::mem::take(memory)))
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

/// A point of the upright picture on the stored one: the inverse of [`upright_from_stored`].
pub(crate) fn stored_from_upright(orientation: Orientation, stored_size: [u32; 2], point: [f64; 2]) -> [f64; 2] {
    let [width, height] = stored_size;
    let upright_size = if swaps_sides(orientation) { [height, width] } else { stored_size };
    let back = match orientation {
        Orientation::Rotate90 => Orientation::Rotate270,
        Orientation::Rotate270 => Orientation::Rotate90,
        itself => itself,
    };
    upright_from_stored(back, upright_size, point)
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
                assert_eq!(stored_from_upright(orientation, [5, 3], [ux, uy]), centre, "{orientation:?}");
                let there = upright.get_pixel((ux - 0.5) as u32, (uy - 0.5) as u32);
                assert_eq!(there.0[0], value.0[0], "{orientation:?} ({x}, {y})");
            }
        }
    }

    #[test]
    fn a_giant_header_costs_nothing() {
        let dir = tempfile::tempdir().expect("a folder");
        // PNG: signature, the header's chunk with its checksum, and data that end at once.
        let mut header = b"IHDR".to_vec();
        header.extend(65_535_u32.to_be_bytes());
        header.extend(30_000_u32.to_be_bytes());
        header.extend([8, 2, 0, 0, 0]);
        let mut crc = flate2::Crc::new();
        crc.update(&header);
        let mut png = b"\x89PNG\r\n\x1a\n\0\0\0\x0d".to_vec();
        png.extend(&header);
        png.extend(crc.sum().to_be_bytes());
        png.extend(b"\0\0\0\0IDAT\x35\xaf\x06\x1e\0\0\0\0IEND\xae\x42\x60\x82");
        // BMP: file header and BITMAPINFOHEADER.
        let mut bmp = b"BM".to_vec();
        bmp.extend([0, 0, 0, 0, 0, 0, 0, 0, 54, 0, 0, 0, 40, 0, 0, 0]);
        bmp.extend(60_000_u32.to_le_bytes());
        bmp.extend(60_000_u32.to_le_bytes());
        bmp.extend([1, 0, 24, 0]);
        bmp.extend([0; 24]);
        // JPEG: the start of frame says how large, 65500 x 65500 of one component.
        let mut jpeg = vec![0xFF, 0xD8, 0xFF, 0xC0, 0, 11, 8, 0xFF, 0xDC, 0xFF, 0xDC, 1, 1, 0x11, 0];
        jpeg.extend([0xFF, 0xDA, 0, 8, 1, 1, 0, 0, 63, 0, 0xFF, 0xD9]);
        for (name, bytes) in [("a.png", png), ("a.bmp", bmp), ("a.jpg", jpeg)] {
            let path = dir.path().join(name);
            std::fs::write(&path, bytes).expect("a file");
            let fault = Photograph::read(&path).expect_err("too large");
            assert!(matches!(fault, ReadFault::TooLarge { megapixels: MOST_MEGAPIXELS, .. }), "{name}: {fault}");
        }
        let path = dir.path().join("small.png");
        image::GrayImage::new(1001, 1000).save(&path).expect("a picture");
        assert!(matches!(Photograph::read_up_to(&path, 1), Err(ReadFault::TooLarge { width: 1001, .. })));
        assert!(Photograph::read_up_to(&path, 2).is_ok());
        // A file with a hole of 3 GB.
        let path = dir.path().join("long.bmp");
        let file = File::create(&path).expect("a file");
        std::io::Write::write_all(&mut &file, b"BM").expect("written");
        file.set_len(3 << 30).expect("a hole");
        assert!(matches!(Photograph::read(&path), Err(ReadFault::TooLong { .. })));
        if cfg!(target_os = "linux") {
            assert!(matches!(Photograph::read(Path::new("/dev/zero")), Err(ReadFault::NotAPicture)));
        }
    }

    #[test]
    fn twelve_bits_are_stretched_to_sixteen() {
        let pixels = image::ImageBuffer::from_vec(2, 1, vec![4095_u16, 0, 2048, 9, 7, 6, 1, 65_535]);
        let image = DynamicImage::ImageRgba16(pixels.expect("eight samples"));
        let mut photograph = Photograph { image, orientation: Orientation::NoTransforms, profile: None };
        assert_eq!(photograph.largest_of_16_bits(), Some(4095));
        assert!(matches!(photograph.stretch_to(4094), Err(ReadFault::AboveWhite { largest: 4095, white: 4094 })));
        photograph.stretch_to(4095).expect("within");
        let samples = photograph.image.as_rgba16().expect("as before").as_raw();
        assert_eq!(samples[..], [65_535, 0, 32_776, 9, 112, 96, 16, 65_535]);
        let image = image::GrayImage::new(1, 1).into();
        let mut eight = Photograph { image, orientation: Orientation::NoTransforms, profile: None };
        assert!(matches!(eight.stretch_to(255), Err(ReadFault::WhiteOfEight)));
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
