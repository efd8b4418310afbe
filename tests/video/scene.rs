//! Small videos to read, and surgery on them.

use std::path::Path;

use lunula::video::{Encoder, Encoding, Format, Item, Picture, Video};

pub const SMALL: Format = Format { width: 64, height: 48, subsampling: Some((2, 2)), depth: 8 };

/// Times that no constant rate has, in ticks.
pub fn uneven(k: u64) -> i64 {
    33 * k as i64 + [0, 5, 11, 2][k as usize % 4]
}

/// A picture by whose luma its number can be read: a grey level below row 24 and noise that moves above it.
pub fn numbered(format: Format, k: u64) -> Picture {
    let mut picture = Picture::new(format);
    let bytes = if format.depth > 8 { 2 } else { 1 };
    let shift = format.depth - 8;
    let write = |plane: &mut Vec<u8>, at: usize, value: u8| {
        let deep = u16::from(value) << shift;
        plane[at * bytes..(at + 1) * bytes].copy_from_slice(&deep.to_le_bytes()[..bytes]);
    };
    for y in 0..format.height {
        for x in 0..format.width {
            let noise = ((x as u64 + k) * 7919 + y as u64 * 104_729 + (x as u64 * y as u64) * (1 + k % 5)) % 60;
            let value = if y < format.height / 2 { 90 + noise as u8 } else { level(k) };
            write(&mut picture.planes[0], y * format.width + x, value);
        }
    }
    for plane in 1..picture.planes.len() {
        for at in 0..picture.planes[plane].len() / bytes {
            write(&mut picture.planes[plane], at, 128);
        }
    }
    picture
}

/// The grey level of picture `k`.
pub fn level(k: u64) -> u8 {
    (40 + 7 * (k % 25)) as u8
}

/// A file of `count` numbered pictures at `times`.
pub fn write(path: &Path, encoding: &Encoding, count: u64, times: impl Fn(u64) -> i64) {
    let mut encoder = Encoder::create(path, encoding).unwrap();
    for k in 0..count {
        encoder.push(&numbered(encoding.format, k), times(k)).unwrap();
    }
    encoder.finish().unwrap();
}

/// What came of a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Seen {
    pub index: u64,
    pub time_s: f64,
    /// The grey level below the middle; none where the frame is missing.
    pub level: Option<f32>,
}

/// All that a file gives: the same where another thread decodes ahead.
pub fn read(path: &Path, threads: usize) -> Vec<Seen> {
    let mut video = Video::open(path, threads).unwrap();
    let all = read_on(&mut video);
    let mut ahead = Video::open(path, threads).unwrap();
    ahead.decode_ahead();
    assert_eq!(read_on(&mut ahead), all, "{}", path.display());
    // Also when it is asked again.
    assert!(ahead.next_item().unwrap().is_none() && ahead.end() == video.end());
    all
}

pub fn read_on(video: &mut Video) -> Vec<Seen> {
    let mut all = Vec::new();
    while let Some(item) = video.next_item().unwrap() {
        all.push(match item {
            Item::Frame(frame) => {
                let (x, y) = (frame.luma.width / 2, frame.luma.height * 3 / 4);
                Seen { index: frame.index, time_s: frame.time_s, level: Some(frame.luma.sample(x, y)) }
            }
            Item::Missing { index, time_s } => Seen { index, time_s, level: None },
        });
    }
    all
}

/// Where a box's content lies, along a path of kinds; the first of each kind.
pub fn find(bytes: &[u8], path: &[&[u8; 4]]) -> std::ops::Range<usize> {
    let mut within = 0..bytes.len();
    for kind in path {
        let mut at = within.start;
        within = loop {
            assert!(at + 8 <= within.end, "no box {:?}", String::from_utf8_lossy(&kind[..]));
            let size = u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
            if &bytes[at + 4..at + 8] == *kind {
                break at + 8..at + size;
            }
            at += size;
        };
    }
    within
}

/// A file's last name changed by `change` to its bytes.
pub fn patched(from: &Path, name: &str, change: impl FnOnce(&mut Vec<u8>)) -> std::path::PathBuf {
    let mut bytes = std::fs::read(from).unwrap();
    change(&mut bytes);
    let path = from.with_file_name(name);
    std::fs::write(&path, bytes).unwrap();
    path
}
