//! Arrays of NumPy, read without belief in what their headers say of their size.
//!
//! In: the bytes of an `.npy` file, or of an array in an archive of such (`photo::npz`). Out: the array, in whichever
//! order and of whichever byte order it was written. A header may promise anything: no memory is taken for more
//! elements than the bytes hold, and what is no header of a plain array is not parsed.

use std::path::Path;

use ndarray::{Array, Array2, Dimension};
use ndarray_npy::npy::header::Header;
use ndarray_npy::{ReadNpyExt as _, ReadableElement};

use crate::input;

/// Bytes of a header: NumPy's own limit (`max_header_size`); its headers have 128.
const MOST_HEADER: usize = 10_000;
/// Opening brackets in a header: a plain array's has two. Parsing recurses at each.
const MOST_BRACKETS: usize = 8;

/// Reads an `.npy` file of two dimensions.
///
/// # Errors
/// What is wrong with it, without its name.
pub fn read<T: ReadableElement>(path: &Path) -> Result<Array2<T>, String> {
    let bytes = input::read(path).map_err(|why| why.to_string())?;
    parse(&bytes)
}

/// The array in the bytes of an `.npy` file.
///
/// # Errors
/// What is wrong with it, also where it has another type or another number of dimensions.
pub(crate) fn parse<T: ReadableElement, D: Dimension>(bytes: &[u8]) -> Result<Array<T, D>, String> {
    check(bytes)?;
    Array::read_npy(bytes).map_err(|why| why.to_string())
}

/// Whether the header and what it promises fit into the bytes that there are.
fn check(bytes: &[u8]) -> Result<(), String> {
    let cut = || "is cut off: its header promises more than there is; get it again, whole".to_owned();
    let rest = bytes.strip_prefix(b"\x93NUMPY").ok_or("is no array of NumPy (.npy)")?;
    let (length, at) = match rest {
        [1, _, a, b, ..] => (usize::from(u16::from_le_bytes([*a, *b])), 4),
        [_, _, a, b, c, d, ..] => (u32::from_le_bytes([*a, *b, *c, *d]) as usize, 6),
        _ => return Err(cut()),
    };
    let text = rest.get(at..).and_then(|rest| rest.get(..length)).ok_or_else(cut)?;
    if length > MOST_HEADER || text.iter().filter(|byte| b"([{".contains(byte)).count() > MOST_BRACKETS {
        return Err("is no plain array: its header is too long, or of several fields".to_owned());
    }
    // The reader's own view of it, for numbers and names can be written in many ways.
    let header = Header::from_reader(&mut &bytes[..]).map_err(|why| why.to_string())?;
    let kind = header.type_descriptor.as_string().map_or("", String::as_str);
    let count = header.shape.into_iter().chain([element_bytes(kind)]).try_fold(1_usize, usize::checked_mul);
    if count.is_some_and(|count| count <= rest.len() - at - length) { Ok(()) } else { Err(cut()) }
}

/// The bytes of an element: 4 of `<f4`. At least one, where that is no plain type, which the reader refuses.
fn element_bytes(kind: &str) -> usize {
    let letters = kind.trim_end_matches(|letter: char| letter.is_ascii_digit());
    kind[letters.len()..].parse().unwrap_or(1).max(1)
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
        // As many elements as there are bytes of them; sizes and a name written otherwise.
        for shape in [
            "(2147483648, 2147483648)",
            "(4294967296, 4294967296, 4294967296)",
            "(2147483648, 1)",
            "(6, 8)",
            "(0xffff_ffff_fff, 1)",
            "(3, 4), 'sh\\x61pe': (8_000_000_000_000, 1)",
        ] {
            let mut large = bytes.clone();
            // The padding behind makes room.
            let grown = shape.len() - text.len();
            large.splice(at..at + text.len(), shape.bytes());
            let pad = large[at..].iter().position(|&b| b == b'}').unwrap() + at + 1;
            large.drain(pad..pad + grown);
            std::fs::write(&path, &large).unwrap();
            let refused = read::<f32>(&path).unwrap_err();
            assert!(refused.contains("cut off"), "{shape}: {refused}");
        }
        let mut nested = b"\x93NUMPY\x02\x00\xff\xff\x00\x00".to_vec();
        nested.resize(12 + 0xffff, b'(');
        for broken in [&nested[..], &b"\x93NUMPY\x02\x00\xff\xff\xff\x7f{"[..], b"\x93NUMPY\x01", b"PK", b""] {
            std::fs::write(&path, broken).unwrap();
            assert!(read::<f32>(&path).is_err());
        }
    }

    #[test]
    fn arrays_of_other_types_and_dimensions_are_refused_and_other_orders_read() {
        let whole = Array2::from_shape_fn((3, 4), |(row, column)| (10 * row + column) as f32);
        let mut bytes = Vec::new();
        whole.write_npy(&mut bytes).unwrap();
        assert!(parse::<f64, ndarray::Ix2>(&bytes).is_err() && parse::<f32, ndarray::Ix1>(&bytes).is_err());
        let mut columns_first = Vec::new();
        whole.t().write_npy(&mut columns_first).unwrap();
        assert_eq!(parse::<f32, ndarray::Ix2>(&columns_first).unwrap(), whole.t());
        // The other byte order.
        let data = bytes.len() - 4 * whole.len();
        bytes[data..].chunks_exact_mut(4).for_each(|element| element.reverse());
        let order = bytes.iter().position(|&byte| byte == b'<').unwrap();
        bytes[order] = b'>';
        assert_eq!(parse::<f32, ndarray::Ix2>(&bytes).unwrap(), whole);
    }
}
