//! Whether the sizes that a Parquet file states of itself can be true, before anybody takes memory for them.
//!
//! The format's reader makes room for as many things as a header says. Here the headers are walked first, as Thrift's
//! compact protocol (<https://github.com/apache/thrift/blob/master/doc/specs/thrift-compact-protocol.md>) and nothing
//! more: no list may have more entries than bytes are left, no text more bytes, and no page may unpack to more than a
//! file of that size can, or hold more values than there are rows. What can't be walked is refused.

use std::fs::File;
use std::os::unix::fs::FileExt as _;

use parquet::file::metadata::ParquetMetaData;

use crate::input::{UNPACKED_BYTES, UNPACKED_TIMES};

/// How deep headers nest (the format's own go to 6).
const DEEPEST: usize = 32;
/// As much of a page as mostly holds its header; where the page's least and greatest text stand in it, more.
const PAGE_HEADS: [u64; 2] = [1 << 9, 1 << 16];
/// What a row's cell takes in memory.
const CELL_BYTES: u64 = 16;

/// A page's kind.
const DICTIONARY: i64 = 2;

const FALSE: &str = "is damaged: a header promises more than the file can hold; get it again, whole";

/// Why a walk ends.
enum Bad {
    /// The bytes end, or are nothing that can be walked.
    Unread,
    /// A size can't be true.
    False,
}

/// The file's last part, which says what is where.
pub(super) fn check_footer(file: &File) -> Result<(), String> {
    let Ok(size) = file.metadata().map(|about| about.len()) else { return Ok(()) };
    let mut end = [0; 8];
    if size < 12 || file.read_exact_at(&mut end, size - 8).is_err() || &end[4..] != b"PAR1" {
        return Ok(());
    }
    let length = u64::from(u32::from_le_bytes([end[0], end[1], end[2], end[3]]));
    if length > size - 8 {
        return Err(FALSE.to_owned());
    }
    let mut footer = vec![0; length as usize];
    if file.read_exact_at(&mut footer, size - 8 - length).is_err() {
        return Ok(());
    }
    // How many columns one of the schema holds.
    let mut fits = true;
    let mut walk = Thrift { rest: &footer, kinds: footer_kind, path: Vec::new(), deep: 0 };
    let walked =
        walk.fields(&mut |path, value| fits &= path != [2, 5] || u64::try_from(value).is_ok_and(|v| v <= size));
    // What can't be walked takes the format's reader up to 2^31 steps until it says so.
    if walked.is_ok() && fits { Ok(()) } else { Err(FALSE.to_owned()) }
}

/// The rows and the pages' sizes.
pub(super) fn check_pages(file: &File, metadata: &ParquetMetaData) -> Result<(), String> {
    let size = file.metadata().map_or(0, |about| about.len());
    let most = |packed: u64| UNPACKED_BYTES.max(packed.saturating_mul(UNPACKED_TIMES));
    let mut cells: u64 = 0;
    for group in metadata.row_groups() {
        let rows = u64::try_from(group.num_rows()).map_err(|_| FALSE.to_owned())?;
        cells = cells.saturating_add(rows.saturating_mul(group.num_columns() as u64));
        for column in group.columns() {
            let start = column.dictionary_page_offset().unwrap_or(column.data_page_offset());
            let (Ok(mut at), Ok(length)) = (u64::try_from(start), u64::try_from(column.compressed_size())) else {
                return Err(FALSE.to_owned());
            };
            let end = at.saturating_add(length).min(size);
            let mut left = rows;
            // Behind the last row nobody reads on.
            while at < end && left > 0 {
                let rooms = PAGE_HEADS.into_iter().filter(|&room| room < end - at).chain([end - at]);
                let mut page = Err(Bad::Unread);
                for room in rooms {
                    page = page_head(file, at, room as usize);
                    if page.is_ok() {
                        break;
                    }
                }
                let Ok(page) = page else { return Err(FALSE.to_owned()) };
                if page.packed > end - at || page.unpacked > most(page.packed) || page.values > left {
                    return Err(FALSE.to_owned());
                }
                at += page.head + page.packed;
                left -= if page.is_dictionary { 0 } else { page.values };
            }
        }
    }
    if cells.saturating_mul(CELL_BYTES) > most(size) { Err(FALSE.to_owned()) } else { Ok(()) }
}

struct PageHead {
    head: u64,
    packed: u64,
    unpacked: u64,
    /// Rows, or entries of a dictionary, for which the reader makes room.
    values: u64,
    is_dictionary: bool,
}

fn page_head(file: &File, at: u64, room: usize) -> Result<PageHead, Bad> {
    let mut bytes = vec![0; room];
    file.read_exact_at(&mut bytes, at).map_err(|_| Bad::Unread)?;
    let mut walk = Thrift { rest: &bytes, kinds: page_kind, path: Vec::new(), deep: 0 };
    let (mut kind, mut unpacked, mut packed, mut values) = (0, 0, 0, 0);
    walk.fields(&mut |path, value| match path {
        [1] => kind = value,
        [2] => unpacked = value,
        [3] => packed = value,
        // Of each kind of page the first.
        [5 | 7 | 8, 1] => values = value,
        _ => {}
    })?;
    let size = |value: i64| u64::try_from(value).map_err(|_| Bad::False);
    Ok(PageHead {
        head: (bytes.len() - walk.rest.len()) as u64,
        packed: size(packed)?,
        unpacked: size(unpacked)?,
        values: size(values)?,
        is_dictionary: kind == DICTIONARY,
    })
}

/// Kinds of the compact protocol.
const I16: u8 = 4;
const I32: u8 = 5;
const I64: u8 = 6;
const BINARY: u8 = 8;
const LIST: u8 = 9;
const STRUCT: u8 = 12;

/// A field's kind, and of a list that of its members.
type Kind = (u8, Option<u8>);

/// The kind that a field of the footer has, by the numbers of the fields that it is in (parquet-format's
/// `parquet.thrift`), and of a list that of its members; none: any. The reader takes the numbers' word for it: of
/// another kind, it would read other sizes than this walk does.
fn footer_kind(path: &[i64]) -> Option<Kind> {
    Some(match path {
        [1] | [2, 1..=3 | 5..=9] | [4, 1, 5 | 7] | [4, 1, 3, 1 | 4 | 15] => (I32, None),
        [3] | [4, 2 | 3 | 5 | 6] | [4, 1, 2 | 4 | 6] | [4, 1, 3, 5..=7 | 9..=11 | 14] => (I64, None),
        [4, 7] => (I16, None),
        [6 | 9] | [2, 4] | [4, 1, 1 | 9] => (BINARY, None),
        [8] | [2, 10] | [4, 1, 3 | 8] | [4, 1, 3, 12] => (STRUCT, None),
        [2 | 4 | 5 | 7] | [4, 1 | 4] | [4, 1, 3, 8 | 13] => (LIST, Some(STRUCT)),
        [4, 1, 3, 2] => (LIST, Some(I32)),
        [4, 1, 3, 3] => (LIST, Some(BINARY)),
        _ => return None,
    })
}

/// As [`footer_kind`], of a page's header.
fn page_kind(path: &[i64]) -> Option<Kind> {
    Some(match path {
        [1..=4] | [5, 1..=4] | [7, 1 | 2] | [8, 1..=6] => (I32, None),
        [5..=8] | [5, 5] | [8, 8] => (STRUCT, None),
        _ => return None,
    })
}

/// Bytes of the compact protocol.
struct Thrift<'a> {
    rest: &'a [u8],
    /// What kind a field has to have.
    kinds: fn(&[i64]) -> Option<Kind>,
    /// The numbers of the fields that the walk is in, and how many lists and structures.
    path: Vec<i64>,
    deep: usize,
}

impl Thrift<'_> {
    fn byte(&mut self) -> Result<u8, Bad> {
        let (&first, rest) = self.rest.split_first().ok_or(Bad::Unread)?;
        self.rest = rest;
        Ok(first)
    }

    fn varint(&mut self) -> Result<u64, Bad> {
        let mut value = 0;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            value |= u64::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                return Ok(value);
            }
        }
        Err(Bad::Unread)
    }

    fn signed(&mut self) -> Result<i64, Bad> {
        let value = self.varint()?;
        Ok((value >> 1) as i64 ^ -((value & 1) as i64))
    }

    /// A number of things of one byte at least.
    fn count(&mut self) -> Result<usize, Bad> {
        let count = self.varint()?;
        usize::try_from(count).ok().filter(|&count| count <= self.rest.len()).ok_or(Bad::False)
    }

    fn skip(&mut self, bytes: usize) -> Result<(), Bad> {
        self.rest = self.rest.get(bytes..).ok_or(Bad::Unread)?;
        Ok(())
    }

    /// A structure's fields; whole numbers among them, and among those of what they hold, are shown with the numbers of
    /// the fields that they are in.
    fn fields(&mut self, show: &mut dyn FnMut(&[i64], i64)) -> Result<(), Bad> {
        let mut id = 0;
        loop {
            let head = self.byte()?;
            if head == 0 {
                return Ok(());
            }
            id = if head >> 4 == 0 { self.signed()? } else { id + i64::from(head >> 4) };
            self.path.push(id);
            let (kind, known) = (head & 15, (self.kinds)(&self.path));
            if known.is_some_and(|(known, _)| known != kind) {
                return Err(Bad::False);
            }
            match kind {
                // A truth value is in the head itself.
                1 | 2 => {}
                I16..=I64 => {
                    let value = self.signed()?;
                    show(&self.path, value);
                }
                kind => self.value(kind, known.and_then(|(_, members)| members), show)?,
            }
            self.path.pop();
        }
    }

    fn value(&mut self, kind: u8, members: Option<u8>, show: &mut dyn FnMut(&[i64], i64)) -> Result<(), Bad> {
        if self.deep >= DEEPEST {
            return Err(Bad::Unread);
        }
        self.deep += 1;
        match kind {
            1..=3 => self.skip(1),
            I16..=I64 => self.varint().map(drop),
            7 => self.skip(8),
            BINARY => {
                let length = self.count()?;
                self.skip(length)
            }
            LIST | 10 => {
                let head = self.byte()?;
                let count = if head >> 4 == 15 { self.count()? } else { usize::from(head >> 4) };
                if count > 0 && members.is_some_and(|members| members != head & 15) {
                    return Err(Bad::False);
                }
                (0..count).try_for_each(|_| self.value(head & 15, None, show))
            }
            11 => {
                let count = self.count()?;
                let kinds = if count == 0 { 0 } else { self.byte()? };
                (0..count).try_for_each(|_| {
                    self.value(kinds >> 4, None, show)?;
                    self.value(kinds & 15, None, show)
                })
            }
            STRUCT => self.fields(show),
            13 => self.skip(16),
            _ => Err(Bad::Unread),
        }?;
        self.deep -= 1;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::super::{Column, Table, TableWriter, Value};

    fn written(path: &Path, rows: usize) -> Vec<u8> {
        let columns = vec![Column::number("time_s"), Column::text("status")];
        let mut table = TableWriter::create(path, path, columns, &[]).unwrap();
        for row in 0..rows {
            table.write(&[Value::Number(row as f64), Value::Text("ok")]).unwrap();
        }
        table.finish().unwrap();
        std::fs::read(path).unwrap()
    }

    /// The compact protocol's number of 2^31 - 1, as a size and as a signed value.
    const SIZE: [u8; 5] = [0xff, 0xff, 0xff, 0xff, 0x07];
    const SIGNED: [u8; 5] = [0xfe, 0xff, 0xff, 0xff, 0x0f];

    #[test]
    fn headers_that_promise_too_much_are_refused_before_memory_is_taken() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.parquet");
        let whole = written(&path, 100_000);
        assert_eq!(Table::read(&path).unwrap().rows(), 100_000);
        let refused = |bytes: &[u8]| {
            std::fs::write(&path, bytes).unwrap();
            Table::read(&path).unwrap_err().to_string()
        };
        // A page of the first column, right behind the first four bytes: kind, unpacked size, packed size.
        assert_eq!(whole[4], 0x15);
        let mut page = whole.clone();
        assert_eq!(page[6], 0x15);
        let end = page[7..].iter().position(|byte| byte & 0x80 == 0).unwrap() + 8;
        let old = end - 7;
        page.splice(7..end, SIGNED);
        // The page's header grew: what lies behind has moved, which nobody gets to see.
        assert!(old < 5 && refused(&page).contains("promises more"), "{}", refused(&page));
        // A list of 2^31 - 1 structures, a text of as many bytes, and a footer longer than the file.
        let footer = |body: &[u8]| {
            let mut bytes = b"PAR1".to_vec();
            bytes.extend(body);
            bytes.extend((body.len() as u32).to_le_bytes());
            bytes.extend(b"PAR1");
            bytes
        };
        let list = [&[0x15, 0x02, 0x19, 0xfc][..], &SIZE, &[0; 16]].concat();
        assert!(refused(&footer(&list)).contains("promises more"));
        let text = [&[0x15, 0x02, 0x19, 0x1c, 0x48][..], &SIZE, &[0; 16]].concat();
        assert!(refused(&footer(&text)).contains("promises more"));
        let mut long = footer(&[0]);
        let at = long.len() - 8;
        long.splice(at..at + 4, u32::MAX.to_le_bytes());
        assert!(refused(&long).contains("promises more"));
        assert!(refused(&whole[..whole.len() / 2]).contains("not a whole Parquet file"));
    }
}
