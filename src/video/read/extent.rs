//! Whether all of a file is there: what its container says of its own length against the bytes that are there.
//!
//! Boxes of ISO files (MP4, MOV), the segment of Matroska and WebM, the RIFF chunks of AVI, whole packets of MPEG
//! transport streams. Of other files nothing is known. FFmpeg itself takes a cut for the end.

use std::io::{self, Read, Seek, SeekFrom};

/// What is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(in crate::video) struct Extent {
    /// Bytes that the container speaks of and that are not there.
    pub(in crate::video) lacking: Option<u64>,
    /// An ISO file without its index (`moov`).
    pub(in crate::video) no_index: bool,
}

/// Looks at a file's structure, not at its samples.
pub(in crate::video) fn look(file: &mut (impl Read + Seek)) -> io::Result<Extent> {
    let length = file.seek(SeekFrom::End(0))?;
    let mut head = [0; 16];
    if read_at(file, 0, &mut head)? < 12 {
        return Ok(Extent::default());
    }
    match head {
        _ if is_iso(&head[4..8]) => iso(file, length),
        [0x1a, 0x45, 0xdf, 0xa3, ..] => matroska(file, length),
        [b'R', b'I', b'F', b'F', _, _, _, _, b'A', b'V', b'I', ..] => avi(file, length),
        [0x47, ..] => transport(file, length),
        _ => Ok(Extent::default()),
    }
}

fn is_iso(kind: &[u8]) -> bool {
    [b"ftyp", b"moov", b"mdat", b"wide", b"free", b"skip", b"pnot"].iter().any(|known| &known[..] == kind)
}

fn read_at(file: &mut (impl Read + Seek), at: u64, into: &mut [u8]) -> io::Result<usize> {
    file.seek(SeekFrom::Start(at))?;
    let mut filled = 0;
    while filled < into.len() {
        match file.read(&mut into[filled..])? {
            0 => break,
            count => filled += count,
        }
    }
    Ok(filled)
}

fn lacking(end: u64, length: u64) -> Option<u64> {
    Some(end.saturating_sub(length)).filter(|&bytes| bytes > 0)
}

fn iso(file: &mut (impl Read + Seek), length: u64) -> io::Result<Extent> {
    let (mut at, mut index) = (0u64, false);
    while at < length {
        let mut head = [0; 16];
        let there = read_at(file, at, &mut head)?;
        if there < 8 {
            return Ok(Extent { lacking: Some(8 - there as u64), no_index: !index });
        }
        let size = match u32::from_be_bytes([head[0], head[1], head[2], head[3]]) {
            0 => length - at,
            1 if there == 16 => {
                u64::from_be_bytes([head[8], head[9], head[10], head[11], head[12], head[13], head[14], head[15]])
            }
            size => u64::from(size),
        };
        let end = at.saturating_add(size.max(8));
        index |= &head[4..8] == b"moov" && end <= length;
        at = end;
    }
    Ok(Extent { lacking: lacking(at, length), no_index: !index })
}

/// A number of EBML: its value and its length in bytes; all ones mean that it is not known.
fn ebml(bytes: &[u8]) -> Option<(Option<u64>, usize)> {
    let first = *bytes.first()?;
    let count = first.leading_zeros() as usize + 1;
    let bytes = bytes.get(..count).filter(|_| count <= 8)?;
    let ones = (1u64 << (7 * count)) - 1;
    let value = bytes.iter().fold(0u64, |value, &byte| value << 8 | u64::from(byte)) & ones;
    Some((Some(value).filter(|&value| value != ones), count))
}

fn matroska(file: &mut (impl Read + Seek), length: u64) -> io::Result<Extent> {
    let mut head = [0; 12];
    let there = read_at(file, 4, &mut head)?;
    let Some((Some(size), count)) = ebml(&head[..there]) else { return Ok(Extent::default()) };
    let segment = 4 + count as u64 + size;
    let there = read_at(file, segment, &mut head)?;
    if !head[..there].starts_with(&[0x18, 0x53, 0x80, 0x67]) {
        return Ok(Extent::default());
    }
    let Some((Some(size), count)) = ebml(&head[4..there]) else { return Ok(Extent::default()) };
    Ok(Extent { lacking: lacking((segment + 4 + count as u64).saturating_add(size), length), no_index: false })
}

fn avi(file: &mut (impl Read + Seek), length: u64) -> io::Result<Extent> {
    let mut at = 0u64;
    while at < length {
        let mut head = [0; 8];
        if read_at(file, at, &mut head)? < 8 || &head[..4] != b"RIFF" {
            break;
        }
        at += 8 + u64::from(u32::from_le_bytes([head[4], head[5], head[6], head[7]]));
    }
    // A recorder that was stopped leaves a size of nothing.
    Ok(Extent { lacking: if at == 8 { Some(1) } else { lacking(at, length) }, no_index: false })
}

fn transport(file: &mut (impl Read + Seek), length: u64) -> io::Result<Extent> {
    const PACKET: u64 = 188;
    let mut sync = [0];
    for at in [PACKET, 2 * PACKET] {
        if read_at(file, at, &mut sync)? == 1 && sync != [0x47] {
            return Ok(Extent::default());
        }
    }
    let beyond = length % PACKET;
    Ok(Extent { lacking: Some(PACKET - beyond).filter(|_| beyond > 0), no_index: false })
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::*;

    fn extent(bytes: Vec<u8>) -> Extent {
        look(&mut Cursor::new(bytes)).unwrap()
    }

    fn a_box(kind: &[u8; 4], size: u32, there: usize) -> Vec<u8> {
        let mut bytes = size.to_be_bytes().to_vec();
        bytes.extend_from_slice(kind);
        bytes.resize(there, 0);
        bytes
    }

    #[test]
    fn boxes_are_followed_to_the_end() {
        let whole = [a_box(b"ftyp", 24, 24), a_box(b"moov", 100, 100), a_box(b"mdat", 50, 50)].concat();
        assert_eq!(extent(whole.clone()), Extent::default());
        assert_eq!(extent(whole[..160].to_vec()), Extent { lacking: Some(14), no_index: false });
        assert_eq!(extent(whole[..100].to_vec()), Extent { lacking: Some(24), no_index: true });
        assert_eq!(extent(whole[..127].to_vec()), Extent { lacking: Some(5), no_index: false });
        let to_the_end = [a_box(b"ftyp", 24, 24), a_box(b"moov", 100, 100), a_box(b"mdat", 0, 50)].concat();
        assert_eq!(extent(to_the_end), Extent::default());
        let mut long = a_box(b"mdat", 1, 40);
        long[15] = 60;
        assert_eq!(extent([a_box(b"ftyp", 24, 24), long].concat()), Extent { lacking: Some(20), no_index: true });
    }

    #[test]
    fn segments_chunks_and_packets_tell_too() {
        let mut mkv = vec![0x1a, 0x45, 0xdf, 0xa3, 0x84, 0, 0, 0, 0, 0x18, 0x53, 0x80, 0x67, 0x40, 100];
        mkv.resize(115, 0);
        assert_eq!(extent(mkv.clone()), Extent::default());
        mkv.pop();
        assert_eq!(extent(mkv.clone()).lacking, Some(1));
        mkv[13] = 0x7f;
        mkv[14] = 0xff;
        assert_eq!(extent(mkv), Extent::default());

        let mut avi = b"RIFF\x20\0\0\0AVI ".to_vec();
        avi.resize(40, 0);
        assert_eq!(extent(avi.clone()), Extent::default());
        assert_eq!(extent(avi[..30].to_vec()).lacking, Some(10));
        avi[4] = 0;
        assert!(extent(avi).lacking.is_some());

        let mut ts = vec![0; 188 * 4];
        ts.iter_mut().step_by(188).for_each(|byte| *byte = 0x47);
        assert_eq!(extent(ts.clone()), Extent::default());
        assert_eq!(extent(ts[..188 * 3 + 100].to_vec()).lacking, Some(88));
        assert_eq!(extent(b"some text, no video".to_vec()), Extent::default());
    }
}
