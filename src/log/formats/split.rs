//! Text taken apart: lines, cells, names.

use lunula_live::wire::bare;

/// The line that begins at `at`, without its end, and where the next one begins.
pub(in crate::log) fn line_at(text: &[u8], at: usize) -> (&[u8], usize) {
    let end = text[at..].iter().position(|&b| b == b'\n').map_or(text.len(), |n| at + n);
    let row = text[at..end].strip_suffix(b"\r").unwrap_or(&text[at..end]);
    (row, (end + 1).min(text.len()))
}

/// A line that is neither empty nor a comment.
pub(in crate::log) struct Line<'a> {
    /// From 1.
    pub(in crate::log) number: u64,
    /// The byte at which it begins.
    pub(in crate::log) at: usize,
    /// Without its end.
    pub(in crate::log) bytes: &'a [u8],
}

/// The lines of a text that are neither empty nor comments.
pub(in crate::log) fn lines_in_use(text: &[u8]) -> impl Iterator<Item = Line<'_>> {
    let (mut next, mut number) = (0, 0);
    let line = move || {
        let at = next;
        let (bytes, after) = (at < text.len()).then(|| line_at(text, at))?;
        (next, number) = (after, number + 1);
        Some(Line { number, at, bytes })
    };
    std::iter::from_fn(line).filter(|line| !matches!(line.bytes.trim_ascii(), [] | [b'#', ..]))
}

/// The parts of a line between delimiters that do not stand in double quotes.
pub(in crate::log) fn split(row: &[u8], delimiter: u8) -> impl Iterator<Item = &[u8]> {
    let mut quoted = false;
    row.split(move |&b| {
        quoted ^= b == b'"';
        b == delimiter && !quoted
    })
}

/// The names in a line.
pub(in crate::log) fn cells_of(row: &[u8], delimiter: u8) -> Vec<String> {
    split(row, delimiter).map(|cell| String::from_utf8_lossy(bare(cell)).replace("\"\"", "\"")).collect()
}

/// Whether a cell behind a row's own is a comment, as LabChart writes it.
pub(in crate::log) fn is_comment(cell: &[u8]) -> bool {
    cell.starts_with(b"#")
}

/// Whether a column holds comments, as LabVIEW's last: rows without one leave it out.
pub(in crate::log) fn is_comments(name: &str) -> bool {
    name.eq_ignore_ascii_case("comment")
}
