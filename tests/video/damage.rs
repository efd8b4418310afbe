//! Damaged and cut files: what is missing is reported, what is given is right, whatever the number of threads.

use std::path::{Path, PathBuf};

use ffmpeg_next as ffmpeg;
use lunula::video::{Encoding, End, Video};

use super::scene::{SMALL, Seen, level, patched, read, read_on, uneven, write};

const SAME_TIME_S: f64 = 1e-12;
/// x264 at crf 12 leaves a flat area within this many levels (2 measured); pictures differ by 7.
const SAME_LEVEL: f32 = 3.0;

const FRAMES: u64 = 48;
const KEY_EVERY: u64 = 12;

fn encoding() -> Encoding {
    Encoding { crf: 12, b_frames: Some(3), key_every: Some(KEY_EVERY as u32), ..Encoding::new(SMALL) }
}

fn video(folder: &tempfile::TempDir, name: &str) -> PathBuf {
    let path = folder.path().join(name);
    write(&path, &encoding(), FRAMES, uneven);
    path
}

/// A packet.
struct Sent {
    /// Where its bytes lie.
    place: std::ops::Range<usize>,
    /// The number of its frame.
    number: u64,
    /// Key frames up to it.
    group: usize,
}

/// Packets in the file's order.
fn packets(path: &Path) -> Vec<Sent> {
    let mut input = ffmpeg::format::input(path).unwrap();
    let base = f64::from(input.stream(0).unwrap().time_base());
    let (mut group, mut first) = (0, None);
    let packets = input.packets().map(|(_, packet)| {
        group += usize::from(packet.is_key());
        let start = packet.position() as usize;
        let pts = packet.pts().unwrap();
        let time_ms = ((pts - *first.get_or_insert(pts)) as f64 * base * 1000.0).round() as i64;
        let number = (0..FRAMES).find(|&k| uneven(k) == time_ms).unwrap();
        Sent { place: start..start + packet.size(), number, group }
    });
    packets.collect()
}

/// Every frame of the first `count` is there or reported as missing, and what is there is right. Gives the missing
/// ones.
#[track_caller]
fn missing(seen: &[Seen], count: u64) -> Vec<u64> {
    assert_eq!(seen.len() as u64, count);
    for (k, frame) in seen.iter().enumerate() {
        assert_eq!(frame.index, k as u64);
        assert!((frame.time_s - uneven(frame.index) as f64 / 1000.0).abs() <= SAME_TIME_S, "frame {k}");
        if let Some(found) = frame.level {
            assert!((found - f32::from(level(frame.index))).abs() <= SAME_LEVEL, "frame {k} shows {found}");
        }
    }
    seen.iter().filter(|frame| frame.level.is_none()).map(|frame| frame.index).collect()
}

#[test]
fn flipped_bytes_cost_no_more_than_their_group_and_never_the_index() {
    let folder = tempfile::tempdir().unwrap();
    let whole = video(&folder, "a.mp4");
    let packets = packets(&whole);
    assert_eq!(packets.len() as u64, FRAMES);
    let mut noticed = 0;
    for (order, packet) in packets.iter().enumerate().skip(1) {
        let path = patched(&whole, "flipped.mp4", |bytes| {
            // The NAL's length and header are left alone: this is the slice's data.
            for at in (packet.place.start + 8..packet.place.end).step_by(5).skip(1) {
                bytes[at] ^= 0x5a;
            }
        });
        let one = read(&path, 1);
        let lost = missing_or_noticed(&one, packet.number);
        if !lost.is_empty() {
            noticed += 1;
            assert_eq!(lost, after(&packets, order), "packet {order}");
        }
        for threads in [2, 4, 0] {
            let many = read(&path, threads);
            assert!(many == one, "packet {order}, {threads} threads");
        }
    }
    // Videos have no checksums: a few of these damages decode without a contradiction.
    assert!(noticed >= 40, "{noticed} of 47");
}

/// The frames of a packet and of those after it up to the next key frame.
fn after(packets: &[Sent], order: usize) -> Vec<u64> {
    let group = packets[order].group;
    let same = packets[order..].iter().filter(|packet| packet.group == group);
    let mut numbers: Vec<u64> = same.map(|packet| packet.number).collect();
    numbers.sort_unstable();
    numbers
}

/// As [`missing`], for a damage of frame `number`, which may go unnoticed.
#[track_caller]
fn missing_or_noticed(seen: &[Seen], number: u64) -> Vec<u64> {
    let lost: Vec<u64> = seen.iter().filter(|frame| frame.level.is_none()).map(|frame| frame.index).collect();
    if lost.contains(&number) { missing(seen, FRAMES) } else { lost }
}

#[test]
fn a_packet_of_nothing_but_zeros_is_missing_with_what_is_predicted_from_it() {
    let folder = tempfile::tempdir().unwrap();
    let whole = video(&folder, "a.mp4");
    let packets = packets(&whole);
    for order in [12, 13, 14, 15, 23] {
        let path = patched(&whole, "zeros.mp4", |bytes| bytes[packets[order].place.clone()].fill(0));
        for threads in [1, 4] {
            let lost = missing(&read(&path, threads), FRAMES);
            assert_eq!(lost, after(&packets, order), "packet {order}, {threads} threads");
        }
    }
}

#[test]
fn a_damaged_first_key_frame_is_missing_and_time_starts_with_it() {
    let folder = tempfile::tempdir().unwrap();
    let whole = video(&folder, "a.mp4");
    let packets = packets(&whole);
    let path = patched(&whole, "first.mp4", |bytes| bytes[packets[0].place.clone()].fill(0));
    assert_eq!(missing(&read(&path, 2), FRAMES), after(&packets, 0));
}

#[test]
fn a_file_cut_off_gives_its_frames_up_to_there() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.mp4", "a.mkv", "a.ts"] {
        let whole = video(&folder, name);
        let mut video = Video::open(&whole, 2).unwrap();
        assert_eq!(video.end(), &End::NotReached);
        assert_eq!(missing(&read_on(&mut video), FRAMES), [] as [u64; 0]);
        assert_eq!(video.end(), &End::Whole, "{name}");
        let packets = packets(&whole);
        // In the middle of the packet with this number in the file's order.
        let order = 30;
        let cut = patched(&whole, &format!("cut-{name}"), |bytes| {
            let place = &packets[order].place;
            bytes.truncate(if name == "a.ts" { place.start + 100 } else { (place.start + place.end) / 2 });
        });
        let mut results = Vec::new();
        for threads in [1, 2, 4] {
            let mut video = Video::open(&cut, threads).unwrap();
            let seen = read_on(&mut video);
            let End::Early(words) = video.end() else { panic!("{name}: {:?}", video.end()) };
            assert!(words.contains("cut off"), "{words}");
            results.push(seen);
        }
        assert!(results.iter().all(|result| *result == results[0]), "{name}");
        let seen = &results[0];
        let lost = missing(seen, seen.len() as u64);
        let there = |k: u64| packets[..order].iter().any(|packet| packet.number == k);
        // All that is reported is right, and everything shown before the first lost frame is reported.
        assert!(lost.iter().all(|&k| !there(k)), "{name}: {lost:?}");
        let certain = (0..FRAMES).take_while(|&k| there(k)).count();
        assert!(seen.len() + 3 >= certain, "{name}: {} of {certain}", seen.len());
    }
}

#[test]
fn an_avi_cut_off_gives_its_frames_up_to_there() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.avi");
    let encoding = Encoding { ticks_per_s: 25, ticks_a_picture: 1, ..encoding() };
    write(&path, &encoding, FRAMES, |k| k as i64);
    let cut = patched(&path, "cut.avi", |bytes| bytes.truncate(bytes.len() * 2 / 3));
    let mut video = Video::open(&cut, 2).unwrap();
    let seen = read_on(&mut video);
    assert!(matches!(video.end(), End::Early(_)), "{:?}", video.end());
    assert!(seen.len() > 10 && seen.len() < 45, "{}", seen.len());
    for frame in seen.iter().filter(|frame| frame.level.is_some()) {
        assert!((frame.time_s - frame.index as f64 / 25.0).abs() <= SAME_TIME_S);
    }
    assert_eq!(read(&cut, 1), seen);
}
