//! What FFmpeg 5.1 writes into an MP4 or MOV only from data that its Rust interface can't hand over, written into the
//! finished file: how a picture is to be turned, the display matrix of its tracks (ISO/IEC 14496-12, `tkhd`); and the
//! name of HEVC's samples that all players take (14496-15, `hvc1`: the parameter sets are in the index alone).

use std::fs::OpenOptions;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::Path;

use crate::video::Turn;

/// Turns all tracks of the file, whose stored picture is `width` x `height`.
pub(in crate::video) fn turn_file(path: &Path, turn: Turn, (width, height): (usize, usize)) -> io::Result<()> {
    // Shown = (a x + c y + e, b x + d y + f), of the picture's corners.
    let (width, height) = (width as i32, height as i32);
    let (a, b, c, d, e, f) = match turn {
        Turn::None => return Ok(()),
        Turn::Quarter => (0, 1, -1, 0, height, 0),
        Turn::Half => (-1, 0, 0, -1, width, height),
        Turn::ThreeQuarters => (0, -1, 1, 0, 0, width),
    };
    let matrix = [a << 16, b << 16, 0, c << 16, d << 16, 0, e << 16, f << 16, 1 << 30];
    let bytes: Vec<u8> = matrix.iter().flat_map(|value: &i32| value.to_be_bytes()).collect();
    let mut file = OpenOptions::new().read(true).write(true).open(path)?;
    let length = file.seek(SeekFrom::End(0))?;
    for (moov, moov_end) in boxes(&mut file, 0, length, b"moov")? {
        for (trak, trak_end) in boxes(&mut file, moov, moov_end, b"trak")? {
            for (tkhd, _) in boxes(&mut file, trak, trak_end, b"tkhd")? {
                let mut version = [0];
                file.seek(SeekFrom::Start(tkhd))?;
                file.read_exact(&mut version)?;
                file.seek(SeekFrom::Start(tkhd + if version == [0] { 40 } else { 52 }))?;
                file.write_all(&bytes)?;
            }
        }
    }
    file.flush()
}

/// Names HEVC's samples `hvc1` instead of FFmpeg's `hev1`, which Apple's players refuse.
pub(in crate::video) fn tag_hevc(path: &Path) -> io::Result<()> {
    let mut file = OpenOptions::new().read(true).write(true).open(path)?;
    let mut within = vec![(0, file.seek(SeekFrom::End(0))?)];
    for kind in [b"moov", b"trak", b"mdia", b"minf", b"stbl", b"stsd"] {
        let mut inner = Vec::new();
        for (begin, end) in within {
            inner.extend(boxes(&mut file, begin, end, kind)?);
        }
        within = inner;
    }
    for (stsd, end) in within {
        // After version, flags and the number of entries.
        for (entry, _) in boxes(&mut file, stsd + 8, end, b"hev1")? {
            file.seek(SeekFrom::Start(entry - 4))?;
            file.write_all(b"hvc1")?;
        }
    }
    file.flush()
}

/// Where the contents of the boxes of a kind lie between two places.
fn boxes(file: &mut (impl Read + Seek), mut at: u64, end: u64, kind: &[u8; 4]) -> io::Result<Vec<(u64, u64)>> {
    let mut found = Vec::new();
    while at + 8 <= end {
        let mut head = [0; 8];
        file.seek(SeekFrom::Start(at))?;
        file.read_exact(&mut head)?;
        let (mut size, mut content) = (u64::from(u32::from_be_bytes([head[0], head[1], head[2], head[3]])), at + 8);
        if size == 1 {
            let mut long = [0; 8];
            file.read_exact(&mut long)?;
            (size, content) = (u64::from_be_bytes(long), at + 16);
        }
        if &head[4..] == kind {
            found.push((content, at + size));
        }
        at += size.max(8);
    }
    Ok(found)
}
