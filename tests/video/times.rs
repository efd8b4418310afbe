//! Each frame's own time, exact to the container's ticks.

use std::path::Path;

use ffmpeg::{Dictionary, Packet};
use ffmpeg_next as ffmpeg;
use lunula::video::{Encoding, Video};

use super::scene::{SMALL, Seen, find, level, patched, read, uneven, write};

/// Times are quotients of whole numbers in both; nothing is lost but the last bit.
const SAME_TIME_S: f64 = 1e-12;
/// x264 at crf 12 leaves a flat area within this many levels (2 measured).
const SAME_LEVEL: f32 = 3.0;

fn encoding() -> Encoding {
    Encoding { crf: 12, b_frames: Some(3), key_every: Some(12), ..Encoding::new(SMALL) }
}

/// Frames `from..to` of the numbered ones at uneven times, nothing else.
#[track_caller]
fn assert_are(seen: &[Seen], from: u64, to: u64, tick_s: f64) {
    assert_eq!(seen.len() as u64, to - from);
    for (k, frame) in seen.iter().enumerate() {
        let number = from + k as u64;
        assert_eq!(frame.index, k as u64);
        let time_s = (uneven(number) - uneven(from)) as f64 / 1000.0;
        assert!((frame.time_s - time_s).abs() <= SAME_TIME_S + 0.5 * tick_s, "{} is not {time_s}", frame.time_s);
        let level = f32::from(level(number));
        assert!((frame.level.unwrap() - level).abs() <= SAME_LEVEL, "frame {number}");
    }
}

#[test]
fn uneven_times_with_reordered_frames_come_back() {
    let folder = tempfile::tempdir().unwrap();
    for (name, tick_s) in [("a.mp4", 0.0), ("a.mov", 0.0), ("a.mkv", 0.0), ("a.ts", 1.0 / 90_000.0)] {
        let path = folder.path().join(name);
        write(&path, &encoding(), 50, uneven);
        for threads in [1, 3] {
            assert_are(&read(&path, threads), 0, 50, tick_s);
        }
    }
}

#[test]
fn a_constant_rate_in_avi_comes_back_from_decoding_times() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.avi");
    let encoding = Encoding { ticks_per_s: 25, ticks_a_picture: 1, ..encoding() };
    write(&path, &encoding, 40, |k| k as i64);
    let seen = read(&path, 2);
    assert_eq!(seen.len(), 40);
    for (k, frame) in seen.iter().enumerate() {
        assert!((frame.time_s - k as f64 / 25.0).abs() <= SAME_TIME_S);
        assert!((frame.level.unwrap() - f32::from(level(k as u64))).abs() <= SAME_LEVEL);
    }
}

#[test]
fn without_times_frames_are_counted_and_that_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.h264");
    write(&path, &encoding(), 30, uneven);
    let video = Video::open(&path, 2).unwrap();
    let rate = video.info().rate_without_times_hz.unwrap();
    assert!(video.info().warnings.iter().any(|words| words.contains("no times")), "{:?}", video.info().warnings);
    let seen = read(&path, 2);
    assert_eq!(seen.len(), 30);
    for (k, frame) in seen.iter().enumerate() {
        assert!((frame.time_s - k as f64 / rate).abs() <= SAME_TIME_S);
        assert!((frame.level.unwrap() - f32::from(level(k as u64))).abs() <= SAME_LEVEL);
    }
}

/// Writes the packets of a film again, as one that a phone took at `taken_hz`.
fn taken_at(from: &Path, to: &Path, taken_hz: &str) {
    let mut input = ffmpeg::format::input(&from).unwrap();
    let mut output = ffmpeg::format::output(&to).unwrap();
    output.add_stream(None::<ffmpeg::Codec>).unwrap().set_parameters(input.stream(0).unwrap().parameters());
    let mut about = Dictionary::new();
    about.set("com.android.capture.fps", taken_hz);
    output.set_metadata(about);
    let mut how = Dictionary::new();
    how.set("movflags", "use_metadata_tags");
    output.write_header_with(how).unwrap();
    let from_base = input.stream(0).unwrap().time_base();
    let to_base = output.stream(0).unwrap().time_base();
    let mut packet = Packet::empty();
    while packet.read(&mut input).is_ok() {
        packet.rescale_ts(from_base, to_base);
        packet.set_position(-1);
        packet.write_interleaved(&mut output).unwrap();
    }
    output.write_trailer().unwrap();
}

#[test]
fn slow_motion_that_the_camera_wrote_down_is_warned_of() {
    let folder = tempfile::tempdir().unwrap();
    let (path, taken) = (folder.path().join("a.mp4"), folder.path().join("b.mp4"));
    write(&path, &Encoding { ticks_per_s: 30, ticks_a_picture: 1, ..encoding() }, 40, |k| k as i64);
    let said = |hz: &str| {
        taken_at(&path, &taken, hz);
        let video = Video::open(&taken, 1).unwrap();
        video.info().warnings.iter().find(|words| words.contains("the camera wrote down")).cloned()
    };
    for (hz, words) in
        [("240", "slow motion? Then all times here are 8 "), ("1", "lapse? Then all times here are 0.0333 ")]
    {
        assert!(said(hz).is_some_and(|warning| warning.contains(words)), "{hz}: {:?}", said(hz));
    }
    for hz in ["30", "24.5", "0", "-1", "nan", "fast"] {
        assert_eq!(said(hz), None, "{hz}");
    }
}

fn number(bytes: &[u8], at: usize) -> u32 {
    u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap())
}

fn set(bytes: &mut [u8], at: usize, value: u32) {
    bytes[at..at + 4].copy_from_slice(&value.to_be_bytes());
}

/// The media's ticks a millisecond.
fn ticks_a_ms(bytes: &[u8]) -> u32 {
    let mdhd = find(bytes, &[b"moov", b"trak", b"mdia", b"mdhd"]);
    number(bytes, mdhd.start + 12) / 1000
}

#[test]
fn an_edit_list_that_skips_the_first_frames_is_followed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mp4");
    write(&path, &encoding(), 50, uneven);
    // Within the first group, right on its second key frame, behind that.
    for first in [1u64, 7, 12, 17] {
        let cut = patched(&path, "cut.mp4", |bytes| {
            let scale = ticks_a_ms(bytes);
            let elst = find(bytes, &[b"moov", b"trak", b"edts", b"elst"]).start;
            assert_eq!(number(bytes, elst + 4), 1, "one edit");
            let (duration, start) = (number(bytes, elst + 8), number(bytes, elst + 12));
            set(bytes, elst + 8, duration - uneven(first) as u32);
            set(bytes, elst + 12, start + uneven(first) as u32 * scale);
        });
        for threads in [1, 4] {
            assert_are(&read(&cut, threads), first, 50, 0.0);
        }
    }
}

#[test]
fn an_edit_list_that_delays_the_start_moves_no_frame() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mp4");
    write(&path, &encoding(), 50, uneven);
    let late = patched(&path, "late.mp4", |bytes| {
        let elst = find(bytes, &[b"moov", b"trak", b"edts", b"elst"]).start;
        let stco = find(bytes, &[b"moov", b"trak", b"mdia", b"minf", b"stbl", b"stco"]).start;
        for chunk in 0..number(bytes, stco + 4) as usize {
            let at = stco + 8 + 4 * chunk;
            let place = number(bytes, at);
            set(bytes, at, place + 12);
        }
        for path in [&[b"moov"] as &[&[u8; 4]], &[b"moov", b"trak"], &[b"moov", b"trak", b"edts"]] {
            let at = find(bytes, path).start - 8;
            let size = number(bytes, at);
            set(bytes, at, size + 12);
        }
        let size = number(bytes, elst - 8);
        set(bytes, elst - 8, size + 12);
        set(bytes, elst + 4, 2);
        // Half a second of nothing first.
        let mut pause = Vec::new();
        for value in [500u32, u32::MAX, 0x1_0000] {
            pause.extend_from_slice(&value.to_be_bytes());
        }
        bytes.splice(elst + 8..elst + 8, pause);
    });
    assert_are(&read(&late, 2), 0, 50, 0.0);
}

#[test]
fn one_frame_is_a_video() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mp4");
    write(&path, &encoding(), 1, uneven);
    for threads in [1, 4] {
        assert_are(&read(&path, threads), 0, 1, 0.0);
    }
}
