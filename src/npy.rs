//! Arrays of NumPy, read without belief in what their headers say of their size.

use std::path::Path;

use ndarray::Array2;
use ndarray_npy::{ReadNpyExt as _, ReadableElement};

use crate::input;

/// Reads an `.npy` file of two dimensions.
///
/// # Errors
/// What is wrong with it, without its name.
pub(crate) fn read<T: ReadableElement>(path: &Path) -> Result<Array2<T>, String> {
    let bytes = input::read(path).map_err(|why| format!("cannot be read ({why})"))?;
    check(&bytes)?;
    Array2::read_npy(&bytes[..]).map_err(|why| why.to_string())
}

/// Whether the header and what it promises fit into the bytes that there are, of one byte an element at least.
fn check(bytes: &[u8]) -> Result<(), String> {
    let cut = || "is cut off: its header promises more than there is; get it again, whole".to_owned();
    let rest = bytes.strip_prefix(b"\x93NUMPY").ok_or("is no array of NumPy (.npy)")?;
    let (length, at) = match rest {
        [1, _, a, b, ..] => (usize::from(u16::from_le_bytes([*a, *b])), 4),
        [_, _, a, b, c, d, ..] => (u32::from_le_bytes([*a, *b, *c, *d]) as usize, 6),
        _ => return Err(cut()),
    };
    let header = rest.get(at..).and_then(|rest| rest.get(..length)).ok_or_else(cut)?;
    let header = String::from_utf8_lossy(header);
    let shape = header.split_once("'shape'").and_then(|(_, rest)| rest.split_once('(')?.1.split_once(')'));
    let Some((shape, _)) = shape else { return Err("has no shape in its header".to_owned()) };
    let sides = shape.split(',').map(str::trim).filter(|side| !side.is_empty());
    let room = rest.len() - at - length;
    // A size that is no number is the reader's business.
    let count = sides.map(|side| side.trim_end_matches('L').parse().unwrap_or(1)).try_fold(1_usize, usize::checked_mul);
    if count.is_some_and(|count| count <= room) { Ok(()) } else { Err(cut()) }
}

#[cfg(test)]
mod tests {
    use ndarray_npy::WriteNpyExt as _;

    use super::*;

    #[test]
    fn a_header_that_promises_too_much_is_refused_before_memory_is_taken() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.npy");
        let whole = Array2::from_shape_fn((3, 4), |(row, column)| (10 * row + column) as f32);
        let mut bytes = Vec::new();
        whole.write_npy(&mut bytes).unwrap();
        std::fs::write(&path, &bytes).unwrap();
        assert_eq!(read::<f32>(&path).unwrap(), whole);
        let text = "(3, 4)";
        let at = bytes.windows(text.len()).position(|window| window == text.as_bytes()).unwrap();
        for shape in ["(2147483648, 2147483648)", "(4294967296, 4294967296, 4294967296)", "(2147483648, 1)"] {
            let mut large = bytes.clone();
            // The padding behind makes room.
            let grown = shape.len() - text.len();
            large.splice(at..at + text.len(), shape.bytes());
            let pad = large[at..].iter().position(|&b| b == b'}').unwrap() + at + 1;
            large.drain(pad..pad + grown.min(16));
            std::fs::write(&path, &large).unwrap();
            let refused = read::<f32>(&path).unwrap_err();
            assert!(refused.contains("cut off"), "{shape}: {refused}");
        }
        for broken in [&b"\x93NUMPY\x02\x00\xff\xff\xff\x7f{"[..], b"\x93NUMPY\x01", b"PK", b""] {
            std::fs::write(&path, broken).unwrap();
            assert!(read::<f32>(&path).is_err());
        }
    }
}
