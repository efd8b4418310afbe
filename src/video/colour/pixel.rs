//! FFmpeg's pixel formats and ours: planar Y'CbCr and grey are taken as they are, all others have a nearest of those.

use ffmpeg::format::Pixel;
use ffmpeg::util::chroma::Location;
use ffmpeg_next as ffmpeg;

use crate::video::Format;

/// FFmpeg's places of chroma samples, by its number and its name, and ours: in luma samples right of and below the
/// block's first luma sample.
pub(in crate::video) const CHROMA_SITES: [(Location, &str, (f64, f64)); 6] = [
    (Location::Left, "left", (0.0, 0.5)),
    (Location::Center, "center", (0.5, 0.5)),
    (Location::TopLeft, "topleft", (0.0, 0.0)),
    (Location::Top, "top", (0.5, 0.0)),
    (Location::BottomLeft, "bottomleft", (0.0, 1.0)),
    (Location::Bottom, "bottom", (0.5, 1.0)),
];

/// Subsampling (none for grey) and bits of a format whose planes can be read as they are.
pub(in crate::video) fn planar(pixel: Pixel) -> Option<(Option<(usize, usize)>, u32)> {
    let name = pixel.descriptor()?.name();
    if let Some(bits) = name.strip_prefix("gray") {
        return Some((None, depth(bits)?));
    }
    let rest = ["yuvj", "yuva", "yuv"].iter().find_map(|&prefix| name.strip_prefix(prefix))?;
    let (chroma, bits) = rest.split_once('p')?;
    let subsampling = match chroma {
        "420" => (2, 2),
        "422" => (2, 1),
        "440" => (1, 2),
        "444" => (1, 1),
        _ => return None,
    };
    Some((Some(subsampling), depth(bits)?))
}

/// Bits from the end of a format's name: nothing for 8, `10le` and so on.
fn depth(name: &str) -> Option<u32> {
    if name.is_empty() {
        return Some(8);
    }
    name.strip_suffix("le")?.parse().ok().filter(|bits| (9..=16).contains(bits))
}

/// Samples use all values by the format's very name.
pub(in crate::video) fn is_full_range(pixel: Pixel) -> bool {
    pixel.descriptor().is_some_and(|format| format.name().starts_with("yuvj"))
}

/// Samples are red, green and blue.
pub(in crate::video) fn is_rgb(pixel: Pixel) -> bool {
    pixel.descriptor().is_some_and(|format| {
        ["rgb", "bgr", "gbr", "pal8", "0rgb", "0bgr", "argb", "abgr", "xyz", "bayer"]
            .iter()
            .any(|start| format.name().starts_with(start))
    })
}

/// The planar format that a format is converted to: as fine in its chroma and at least as deep.
pub(in crate::video) fn nearest_planar(pixel: Pixel) -> Option<Pixel> {
    let format = pixel.descriptor()?;
    let components = u32::from(format.nb_components());
    let (across, down) = (1u32 << format.log2_chroma_w(), 1u32 << format.log2_chroma_h());
    let rgb = is_rgb(pixel);
    let colour = rgb || components >= 3;
    let samples = if colour { 1.0 + 2.0 / f64::from(across * down) } else { 1.0 };
    let extra = if components == 4 || components == 2 { 1.0 } else { 0.0 };
    let bits = (f64::from(format.bits_per_pixel().max(1)) / (samples + extra)).ceil();
    let bits =
        [(8.0, ""), (10.0, "10le"), (12.0, "12le")].iter().find(|(most, _)| bits <= *most).map_or("16le", |b| b.1);
    let name = match (colour, across, down) {
        (false, ..) => format!("gray{bits}"),
        (true, 2, 2) if !rgb => format!("yuv420p{bits}"),
        (true, 2, 1) if !rgb => format!("yuv422p{bits}"),
        _ => format!("yuv444p{bits}"),
    };
    name.parse().ok()
}

/// FFmpeg's format for samples of ours; none where there is none of that depth.
pub(in crate::video) fn of_format(format: &Format) -> Option<Pixel> {
    let bits = match format.depth {
        8 => String::new(),
        bits => format!("{bits}le"),
    };
    let name = match format.subsampling {
        None => format!("gray{bits}"),
        Some((2, 2)) => format!("yuv420p{bits}"),
        Some((2, 1)) => format!("yuv422p{bits}"),
        Some((1, 2)) => format!("yuv440p{bits}"),
        Some((1, 1)) => format!("yuv444p{bits}"),
        Some(_) => return None,
    };
    name.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planar_formats_are_known_by_their_names() {
        let cases = [
            (Pixel::YUV420P, Some((Some((2, 2)), 8))),
            (Pixel::YUVJ422P, Some((Some((2, 1)), 8))),
            (Pixel::YUV440P12LE, Some((Some((1, 2)), 12))),
            (Pixel::YUVA444P10LE, Some((Some((1, 1)), 10))),
            (Pixel::YUV420P9LE, Some((Some((2, 2)), 9))),
            (Pixel::GRAY8, Some((None, 8))),
            (Pixel::GRAY14LE, Some((None, 14))),
            (Pixel::GRAY16BE, None),
            (Pixel::YUV420P10BE, None),
            (Pixel::YUV411P, None),
            (Pixel::NV12, None),
            (Pixel::GBRP, None),
        ];
        for (pixel, expected) in cases {
            assert_eq!(planar(pixel), expected, "{pixel:?}");
        }
    }

    #[test]
    fn other_formats_have_a_planar_one_no_coarser() {
        let cases = [
            (Pixel::NV12, Pixel::YUV420P),
            (Pixel::P010LE, Pixel::YUV420P10LE),
            (Pixel::P016LE, Pixel::YUV420P16LE),
            (Pixel::NV16, Pixel::YUV422P),
            (Pixel::NV24, Pixel::YUV444P),
            (Pixel::YUYV422, Pixel::YUV422P),
            (Pixel::UYVY422, Pixel::YUV422P),
            (Pixel::YUV411P, Pixel::YUV444P),
            (Pixel::YUV410P, Pixel::YUV444P),
            (Pixel::YUV420P10BE, Pixel::YUV420P10LE),
            (Pixel::GBRP, Pixel::YUV444P),
            (Pixel::GBRP10LE, Pixel::YUV444P10LE),
            (Pixel::RGB24, Pixel::YUV444P),
            (Pixel::BGRA, Pixel::YUV444P),
            (Pixel::ZRGB, Pixel::YUV444P),
            (Pixel::RGB565LE, Pixel::YUV444P),
            (Pixel::RGB48LE, Pixel::YUV444P16LE),
            (Pixel::PAL8, Pixel::YUV444P),
            (Pixel::GRAY16BE, Pixel::GRAY16LE),
            (Pixel::YA8, Pixel::GRAY8),
            (Pixel::MonoBlack, Pixel::GRAY8),
        ];
        for (pixel, expected) in cases {
            assert_eq!(nearest_planar(pixel), Some(expected), "{pixel:?}");
            assert!(planar(expected).is_some(), "{expected:?}");
        }
    }

    #[test]
    fn formats_of_ours_go_there_and_back() {
        for subsampling in [None, Some((2, 2)), Some((2, 1)), Some((1, 1))] {
            for depth in [8, 10, 12, 16] {
                let format = Format { width: 4, height: 4, subsampling, depth };
                assert_eq!(planar(of_format(&format).unwrap()), Some((subsampling, depth)));
            }
        }
    }
}
