//! The arrays of an NPZ archive, read without trusting what it says of their sizes.
//!
//! In: a ZIP file (PKWARE's APPNOTE 6.3.10, without ZIP64) of NPY arrays, stored. Out: an entry's bytes, never more
//! than the caller expects of it, with their checksum verified, and the array in them ([`npy`]).

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

use ndarray::{Ix1, Ix2};
use ndarray_npy::ReadableElement;

use crate::{input, npy};

/// Bytes of an archive's directory that are read: a partial map's has a few hundred.
const MOST_DIRECTORY: u64 = 1 << 20;
/// Bytes of an array's header: NumPy's have 128.
const MOST_HEADER: u64 = 4096;
/// The end of the central directory and the longest comment after it.
const LONGEST_END: u64 = 22 + 65_535;

/// An opened archive.
pub(super) struct Npz {
    file: File,
    entries: BTreeMap<String, Entry>,
}

#[derive(Debug, Clone, Copy)]
struct Entry {
    method: u16,
    checksum: u32,
    packed: u64,
    at: u64,
}

fn u16_at(bytes: &[u8], at: usize) -> Option<u16> {
    Some(u16::from_le_bytes(bytes.get(at..at + 2)?.try_into().ok()?))
}

fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?))
}

impl Npz {
    /// Reads the directory.
    pub(super) fn open(path: &Path) -> Result<Self, String> {
        let read = |why: std::io::Error| why.to_string();
        let mut file = input::open_regular(path).map_err(read)?;
        let length = file.metadata().map_err(read)?.len();
        let mut tail = Vec::new();
        file.seek(SeekFrom::Start(length.saturating_sub(LONGEST_END))).map_err(read)?;
        file.by_ref().take(LONGEST_END).read_to_end(&mut tail).map_err(read)?;
        let no_zip = || "no ZIP archive, or a truncated one".to_owned();
        let end = tail.windows(4).rposition(|bytes| bytes == b"PK\x05\x06").ok_or_else(no_zip)?;
        let (size, start) = u32_at(&tail, end + 12).zip(u32_at(&tail, end + 16)).ok_or_else(no_zip)?;
        if u64::from(size) > MOST_DIRECTORY {
            return Err(format!("its directory says that it has {size} bytes"));
        }
        let mut directory = Vec::new();
        file.seek(SeekFrom::Start(u64::from(start))).map_err(read)?;
        file.by_ref().take(u64::from(size)).read_to_end(&mut directory).map_err(read)?;
        let mut entries = BTreeMap::new();
        let mut rest = &directory[..];
        while rest.starts_with(b"PK\x01\x02") {
            let next = entry_of(rest).ok_or_else(|| "its directory is damaged".to_owned())?;
            rest = &rest[next.2.min(rest.len())..];
            entries.insert(next.0, next.1);
        }
        Ok(Self { file, entries })
    }

    /// Whether there is an array of that name.
    pub(super) fn has(&self, name: &str) -> bool {
        self.entries.contains_key(name)
    }

    /// A one-dimensional array of bytes, of at most `most`.
    pub(super) fn text(&mut self, name: &str, most: u64) -> Result<Vec<u8>, String> {
        let bytes = self.bytes(name, most)?;
        let text = npy::parse::<u8, Ix1>(&bytes).map_err(|why| format!("`{name}`: {why}"))?;
        Ok(text.into_raw_vec_and_offset().0)
    }

    /// A square array of `size` rows.
    ///
    /// # Errors
    /// In words, also where it has another size.
    pub(super) fn square<T: ReadableElement + Copy>(&mut self, name: &str, size: usize) -> Result<Vec<T>, String> {
        let bytes = self.bytes(name, (size * size * size_of::<T>()) as u64)?;
        let array = npy::parse::<T, Ix2>(&bytes).map_err(|why| format!("`{name}`: {why}"))?;
        match array.dim() {
            (rows, columns) if (rows, columns) == (size, size) => {
                Ok(array.as_standard_layout().into_owned().into_raw_vec_and_offset().0)
            }
            (rows, columns) => Err(format!("an array of {rows} x {columns}, not {size} x {size}")),
        }
    }

    /// An array's bytes with its header, of which `most` are its elements'.
    fn bytes(&mut self, name: &str, most: u64) -> Result<Vec<u8>, String> {
        let entry = *self.entries.get(name).ok_or_else(|| format!("there is no `{name}` in it"))?;
        let wrong = |why: std::io::Error| format!("`{name}`: {why}");
        let mut local = [0; 30];
        self.file.seek(SeekFrom::Start(entry.at)).map_err(wrong)?;
        self.file.read_exact(&mut local).map_err(wrong)?;
        let names = u16_at(&local, 26).zip(u16_at(&local, 28)).filter(|_| local.starts_with(b"PK\x03\x04"));
        let (name_bytes, extra_bytes) = names.ok_or_else(|| format!("`{name}` is not where the directory says"))?;
        self.file.seek_relative(i64::from(name_bytes) + i64::from(extra_bytes)).map_err(wrong)?;
        if entry.method != 0 {
            return Err(format!("`{name}` is packed by method {}; write it as it is (numpy.savez)", entry.method));
        }
        let mut bytes = Vec::new();
        let most = most + MOST_HEADER;
        self.file.by_ref().take(entry.packed.min(most + 1)).read_to_end(&mut bytes).map_err(wrong)?;
        if bytes.len() as u64 > most {
            return Err(format!("`{name}` is larger than the pictures it says it is made of"));
        }
        let mut checksum = flate2::Crc::new();
        checksum.update(&bytes);
        if checksum.sum() == entry.checksum { Ok(bytes) } else { Err(format!("`{name}` is damaged (checksum)")) }
    }
}

/// An array's name, its entry, and the entry's length in the directory.
fn entry_of(bytes: &[u8]) -> Option<(String, Entry, usize)> {
    let [name, extra, comment] = [u16_at(bytes, 28)?, u16_at(bytes, 30)?, u16_at(bytes, 32)?].map(usize::from);
    let entry = Entry {
        method: u16_at(bytes, 10)?,
        checksum: u32_at(bytes, 16)?,
        packed: u64::from(u32_at(bytes, 20)?),
        at: u64::from(u32_at(bytes, 42)?),
    };
    let text = String::from_utf8_lossy(bytes.get(46..46 + name)?);
    Some((text.strip_suffix(".npy").unwrap_or(&text).to_owned(), entry, 46 + name + extra + comment))
}

#[cfg(test)]
mod tests {
    use ndarray::Array2;
    use ndarray_npy::NpzWriter;

    use super::*;

    fn archive(path: &Path, array: &Array2<u64>) {
        let mut npz = NpzWriter::new(File::create(path).expect("a file"));
        npz.add_array("sum", array).expect("written");
        npz.finish().expect("written");
    }

    fn sums(path: &Path, size: usize) -> Result<Vec<u64>, String> {
        Npz::open(path)?.square("sum", size)
    }

    #[test]
    fn stored_arrays_are_read_and_damage_is_seen() {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join("a.npz");
        let array = Array2::from_shape_fn((9, 9), |(row, column)| (row * 1000 + column) as u64);
        archive(&path, &array);
        // Dated by the format's first day, not by the clock.
        let directory = std::fs::read(&path).expect("a file");
        let at = directory.windows(4).position(|w| w == b"PK\x01\x02").expect("a directory");
        assert_eq!((u16_at(&directory, at + 12), u16_at(&directory, at + 14)), (Some(0), Some(0x21)));
        let mut npz = Npz::open(&path).expect("an archive");
        assert!(npz.has("sum") && !npz.has("count") && npz.square::<u64>("count", 9).is_err());
        assert!(npz.square::<u32>("sum", 9).is_err());
        assert_eq!(sums(&path, 9).as_deref(), Ok(array.as_slice().expect("rows")));
        assert!(sums(&path, 10).is_err_and(|why| why.contains("9 x 9, not 10 x 10")));
        // More than 4 kB of headers too much.
        archive(&path, &Array2::zeros((40, 40)));
        assert!(sums(&path, 8).is_err_and(|why| why.contains("larger than the pictures")));
        let whole = std::fs::read(&path).expect("a file");
        for at in (0..whole.len()).step_by(97) {
            std::fs::write(&path, &whole[..at]).expect("a file");
            assert!(sums(&path, 40).is_err(), "cut at {at}");
        }
        let mut damaged = whole;
        damaged[5000] ^= 1;
        std::fs::write(&path, &damaged).expect("a file");
        assert!(sums(&path, 40).is_err_and(|why| why.contains("damaged")));
    }

    #[test]
    fn what_a_header_claims_takes_no_memory() {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join("a.npz");
        archive(&path, &Array2::zeros((9, 9)));
        // The shape (9, 9), and as many bytes of padding, say 2^31 x 2^31.
        let mut bytes = std::fs::read(&path).expect("a file");
        let claim = b"(2147483648, 2147483648), }";
        let at = bytes.windows(6).position(|w| w == b"(9, 9)").expect("a shape");
        bytes[at..at + claim.len()].copy_from_slice(claim);
        let data = bytes.windows(6).position(|w| w == b"\x93NUMPY").expect("an array");
        let mut checksum = flate2::Crc::new();
        let directory = bytes.windows(4).position(|w| w == b"PK\x01\x02").expect("a directory");
        let packed = u32_at(&bytes, directory + 20).expect("a length") as usize;
        checksum.update(&bytes[data..data + packed]);
        bytes[directory + 16..directory + 20].copy_from_slice(&checksum.sum().to_le_bytes());
        std::fs::write(&path, &bytes).expect("a file");
        let fault = sums(&path, 9).expect_err("no such array");
        assert!(fault.contains("`sum`") && !fault.contains("checksum"), "{fault}");
    }
}
