//! Layouts of samples, turns, colours, and what the header says of them.

use std::path::Path;

use ffmpeg::format::Pixel;
use ffmpeg::{Dictionary, Packet, Rational, codec, color, frame, software::scaling};
use ffmpeg_next as ffmpeg;
use lunula::video::{Encoder, Encoding, Format, Frame, Item, Matrix, Turn, Video, VideoError};

use super::scene::{SMALL, find, numbered, patched, uneven, write};

fn format(width: usize, height: usize, subsampling: Option<(usize, usize)>, depth: u32) -> Format {
    Format { width, height, subsampling, depth }
}

/// Levels that x264 loses at crf 0: none of 8 bits; of 10 bits it is not lossless (2.5 measured).
fn lost_at_crf_0(depth: u32) -> f32 {
    if depth == 8 { 0.0 } else { 3.0 }
}

/// The greatest difference of a sample of two frames of one size.
fn furthest(one: &Frame<'_>, other: &Frame<'_>) -> f32 {
    let planes = |frame: &Frame<'_>| {
        let chroma = frame.chroma.into_iter().flatten();
        let samples = std::iter::once(frame.luma).chain(chroma).flat_map(|plane| {
            (0..plane.height).flat_map(move |y| (0..plane.width).map(move |x| plane.sample(x, y))).collect::<Vec<f32>>()
        });
        samples.collect::<Vec<f32>>()
    };
    let (one, other) = (planes(one), planes(other));
    assert_eq!(one.len(), other.len());
    one.iter().zip(&other).fold(0.0, |most, (a, b)| most.max((a - b).abs()))
}

#[test]
fn all_chroma_of_8_and_10_bits_come_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mp4");
    for depth in [8, 10] {
        for (subsampling, size) in [(Some((2, 2)), (62, 46)), (Some((2, 1)), (62, 47)), (Some((1, 1)), (63, 47))] {
            let format = format(size.0, size.1, subsampling, depth);
            write(&path, &Encoding { crf: 0, ..Encoding::new(format) }, 3, uneven);
            let mut video = Video::open(&path, 2).unwrap();
            let info = video.info().clone();
            assert_eq!((info.format, info.converted), (format, None));
            assert!(info.grey, "numbered pictures have no colour");
            for k in 0..3 {
                let Some(Item::Frame(frame)) = video.next_item().unwrap() else { panic!("frame {k} of {format:?}") };
                let picture = numbered(format, k);
                let expected = picture.frame(k, 0.0);
                assert_eq!(frame.subsampling(), subsampling.unwrap_or((1, 1)));
                let furthest = furthest(&frame, &expected);
                assert!(furthest <= lost_at_crf_0(depth), "frame {k} of {format:?}: {furthest}");
            }
        }
    }
}

#[test]
fn grey_comes_back_as_grey_though_with_chroma() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mp4");
    for depth in [8, 10] {
        let encoding = Encoding { crf: 0, ..Encoding::new(format(63, 47, None, depth)) };
        write(&path, &encoding, 2, uneven);
        let mut video = Video::open(&path, 2).unwrap();
        assert!(video.info().grey, "{:?}", video.info());
        let Some(Item::Frame(frame)) = video.next_item().unwrap() else { panic!("no frame") };
        let picture = numbered(encoding.format, 0);
        let expected = picture.frame(0, 0.0);
        let luma = Frame { chroma: None, ..frame };
        assert!(furthest(&luma, &expected) <= lost_at_crf_0(depth), "{depth} bits");
    }
}

#[test]
fn a_film_that_begins_in_black_and_has_colour_behind_is_not_grey() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mp4");
    for (lead, colour, grey) in [(1, 128, true), (1, 160, false), (40, 160, false), (140, 100, false)] {
        let mut encoder = Encoder::create(&path, &Encoding { crf: 0, ..Encoding::new(SMALL) }).unwrap();
        for k in 0..lead + 5 {
            let mut picture = numbered(SMALL, k);
            if k >= lead {
                picture.planes[1][40..80].fill(colour);
            }
            encoder.push(&picture, uneven(k)).unwrap();
        }
        encoder.finish().unwrap();
        let mut video = Video::open(&path, 1).unwrap();
        assert_eq!((video.info().grey, video.count_rest().unwrap()), (grey, lead + 5), "{lead} {colour}");
    }
}

#[test]
fn colour_aspect_siting_and_turn_come_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mp4");
    for turn in [Turn::None, Turn::Quarter, Turn::Half, Turn::ThreeQuarters] {
        for site in [(0.0, 0.5), (0.5, 0.5), (0.0, 0.0), (0.5, 0.0), (0.0, 1.0), (0.5, 1.0)] {
            let matrix = Matrix { full_range: turn == Turn::Half, ..Matrix::BT601 };
            let encoding =
                Encoding { turn, matrix, chroma_site: Some(site), pixel_aspect: (4, 3), ..Encoding::new(SMALL) };
            write(&path, &encoding, 2, uneven);
            let video = Video::open(&path, 1).unwrap();
            let info = video.info();
            assert_eq!((info.turn, info.matrix, info.chroma_site), (turn, matrix, Some(site)));
            assert!((info.pixel_aspect - 4.0 / 3.0).abs() < 1e-12);
            assert!(!info.matrix_assumed && info.warnings.is_empty(), "{info:?}");
            assert_eq!(info.declared_frames, Some(2));
        }
    }
}

#[test]
fn a_mirrored_or_slanted_picture_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mp4");
    write(&path, &Encoding::new(SMALL), 2, uneven);
    for (matrix, words) in
        [([-0x1_0000i32, 0, 0, 0x1_0000], "mirrored"), ([0xb504, 0xb504, -0xb504, 0xb504], "no multiple of 90")]
    {
        let odd = patched(&path, "b.mp4", |bytes| {
            let at = find(bytes, &[b"moov", b"trak", b"tkhd"]).start + 40;
            for (place, value) in [0, 4, 12, 16].iter().zip(matrix) {
                bytes[at + place..at + place + 4].copy_from_slice(&value.to_be_bytes());
            }
        });
        let video = Video::open(&odd, 1).unwrap();
        assert_eq!(video.info().turn, Turn::None);
        assert!(video.info().warnings.iter().any(|warning| warning.contains(words)), "{:?}", video.info().warnings);
    }
}

#[test]
fn a_picture_that_changes_its_size_is_refused_where_it_does() {
    let folder = tempfile::tempdir().unwrap();
    let (one, other) = (folder.path().join("a.h264"), folder.path().join("b.h264"));
    write(&one, &Encoding::new(SMALL), 7, uneven);
    write(&other, &Encoding::new(format(80, 48, Some((2, 2)), 8)), 5, uneven);
    let both = [std::fs::read(&one).unwrap(), std::fs::read(&other).unwrap()].concat();
    std::fs::write(&one, both).unwrap();
    for threads in [1, 3] {
        let mut video = Video::open(&one, threads).unwrap();
        let mut count = 0;
        let error = loop {
            match video.next_item() {
                Ok(Some(_)) => count += 1,
                Ok(None) => panic!("no error"),
                Err(error) => break error,
            }
        };
        assert!(matches!(error, VideoError::Changed { .. }));
        assert!(error.to_string().contains("from 64x48 yuv420p to 80x48 yuv420p at frame 7"), "{error}");
        assert_eq!(count, 7);
    }
}

/// A picture of red, green and blue ramps in any layout, uncompressed.
fn write_raw(path: &Path, pixel: Pixel, width: u32, height: u32, space: color::Space) {
    let mut ramps = frame::Video::new(Pixel::YUV444P16LE, width, height);
    for plane in 0..3 {
        let stride = ramps.stride(plane);
        for (y, row) in ramps.data_mut(plane).chunks_mut(stride).enumerate() {
            for x in 0..width as usize {
                row[2 * x..2 * x + 2].copy_from_slice(&((ramp(plane, x, y) * 256.0) as u16).to_le_bytes());
            }
        }
    }
    let flags = scaling::Flags::BICUBIC | scaling::Flags::ACCURATE_RND;
    let mut context = scaling::Context::get(ramps.format(), width, height, pixel, width, height, flags).unwrap();
    let mut picture = frame::Video::empty();
    context.run(&ramps, &mut picture).unwrap();
    picture.set_pts(Some(0));
    let mut output = ffmpeg::format::output_as(path, "nut").unwrap();
    let raw = codec::encoder::find(codec::Id::RAWVIDEO).unwrap();
    let mut setup = codec::Context::new_with_codec(raw).encoder().video().unwrap();
    setup.set_width(width);
    setup.set_height(height);
    setup.set_format(pixel);
    setup.set_time_base(Rational(1, 25));
    setup.set_colorspace(space);
    let mut encoder = setup.open_with(Dictionary::new()).unwrap();
    output.add_stream(raw).unwrap().set_parameters(&encoder);
    output.write_header().unwrap();
    encoder.send_frame(&picture).unwrap();
    encoder.send_eof().unwrap();
    let mut packet = Packet::empty();
    while encoder.receive_packet(&mut packet).is_ok() {
        packet.set_stream(0);
        packet.write_interleaved(&mut output).unwrap();
    }
    output.write_trailer().unwrap();
}

/// Y', Cb, Cr of the ramps, on the scale of 8 bits; in range for red, green and blue.
fn ramp(plane: usize, x: usize, y: usize) -> f32 {
    match plane {
        0 => 90.0 + x as f32,
        1 => 110.0 + y as f32,
        _ => 140.0 - 0.5 * x as f32,
    }
}

#[test]
fn other_layouts_are_converted_and_reported() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.nut");
    // Rounding to 5 or 6 bits in rgb565 is the most; else 1.5 levels (1.2 measured, at 8-bit red, green and blue).
    let cases = [
        (Pixel::NV12, Some((2, 2)), 8, 1.5),
        (Pixel::NV21, Some((2, 2)), 8, 1.5),
        (Pixel::YUYV422, Some((2, 1)), 8, 1.5),
        (Pixel::UYVY422, Some((2, 1)), 8, 1.5),
        (Pixel::YUV411P, Some((1, 1)), 8, 1.5),
        (Pixel::YUV422P10BE, Some((2, 1)), 10, 1.5),
        (Pixel::RGB24, Some((1, 1)), 8, 2.0),
        (Pixel::BGRA, Some((1, 1)), 8, 2.0),
        (Pixel::GBRP, Some((1, 1)), 8, 2.0),
        (Pixel::GBRP10LE, Some((1, 1)), 10, 1.5),
        (Pixel::RGB48LE, Some((1, 1)), 16, 1.5),
        (Pixel::RGB565LE, Some((1, 1)), 8, 9.0),
        (Pixel::GRAY16BE, None, 16, 1.5),
    ];
    for (pixel, subsampling, depth, most) in cases {
        write_raw(&path, pixel, 40, 30, color::Space::SMPTE170M);
        let mut video = Video::open(&path, 1).unwrap();
        let info = video.info().clone();
        assert_eq!(info.format, format(40, 30, subsampling, depth), "{pixel:?}");
        assert_eq!(info.converted.as_deref(), Some(pixel.descriptor().unwrap().name()));
        assert!(info.warnings.iter().any(|words| words.contains("converted")), "{:?}", info.warnings);
        assert_eq!(info.matrix, Matrix::BT601, "{pixel:?}");
        let Some(Item::Frame(frame)) = video.next_item().unwrap() else { panic!("{pixel:?}") };
        for (x, y) in [(3, 2), (20, 15), (36, 27)] {
            let found = frame.luma.sample(x, y);
            // FFmpeg takes grey for full range.
            let expected = if subsampling.is_none() { (ramp(0, x, y) - 16.0) * 255.0 / 219.0 } else { ramp(0, x, y) };
            assert!((found - expected).abs() <= most, "{pixel:?} at {x}, {y}: {found}");
            let Some(chroma) = frame.chroma else { continue };
            let (across, down) = frame.subsampling();
            for (k, plane) in chroma.iter().enumerate() {
                let found = plane.sample(x / across, y / down);
                // A chroma sample stands for a block of up to 4 columns.
                let expected = ramp(k + 1, x / across * across, y / down * down);
                assert!((found - expected).abs() <= most + 1.0, "{pixel:?} chroma {k} at {x}, {y}: {found} {expected}");
            }
        }
    }
}

#[test]
fn planar_layouts_of_any_depth_are_taken_as_they_are() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.nut");
    let cases = [
        (Pixel::YUV420P, Some((2, 2)), 8),
        (Pixel::YUV440P, Some((1, 2)), 8),
        (Pixel::YUV420P12LE, Some((2, 2)), 12),
        (Pixel::YUV422P16LE, Some((2, 1)), 16),
        (Pixel::YUV444P14LE, Some((1, 1)), 14),
        (Pixel::GRAY8, None, 8),
        (Pixel::GRAY16LE, None, 16),
    ];
    for (pixel, subsampling, depth) in cases {
        // Odd: the last chroma sample stands for less than a block.
        write_raw(&path, pixel, 41, 31, color::Space::SMPTE170M);
        let mut video = Video::open(&path, 1).unwrap();
        assert_eq!(video.info().format, format(41, 31, subsampling, depth), "{pixel:?}");
        assert_eq!(video.info().converted, None);
        let Some(Item::Frame(frame)) = video.next_item().unwrap() else { panic!("{pixel:?}") };
        let stored = ramp(0, 40, 30);
        let expected = if subsampling.is_none() { (stored - 16.0) * 255.0 / 219.0 } else { stored };
        assert!((frame.luma.sample(40, 30) - expected).abs() <= 1.0, "{pixel:?}");
        assert_eq!(frame.subsampling(), subsampling.unwrap_or((1, 1)));
    }
}

#[test]
fn an_unstated_matrix_is_assumed_by_size_and_reported() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.nut");
    for (height, matrix) in [(480, Matrix::BT601), (720, Matrix::BT709)] {
        write_raw(&path, Pixel::YUV420P, 16, height, color::Space::Unspecified);
        let video = Video::open(&path, 1).unwrap();
        assert_eq!(video.info().matrix, matrix);
        assert!(video.info().matrix_assumed);
    }
}
