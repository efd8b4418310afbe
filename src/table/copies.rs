//! Recordings that are one under several names.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use sha2::{Digest, Sha256};

use super::{Cell, Table, TableError};
use crate::input;

/// What to say of tables and logs that are the same to the byte, or to the cell in files of different formats.
pub(crate) fn copies(inputs: Vec<(String, &Path)>) -> Vec<String> {
    let mut said = input::copies(inputs.clone());
    let ending = |path: &Path| path.extension().unwrap_or_default().to_ascii_lowercase();
    if inputs.iter().map(|(_, path)| ending(path)).collect::<BTreeSet<_>>().len() < 2 {
        return said;
    }
    let mut by_cells: BTreeMap<[u8; 32], Vec<&(String, &Path)>> = BTreeMap::new();
    for one in &inputs {
        // Of what is no table it is said elsewhere.
        if let Ok(digest) = digest(one.1) {
            by_cells.entry(digest).or_default().push(one);
        }
    }
    let several =
        |group: &&Vec<&(String, &Path)>| group.iter().map(|(_, path)| ending(path)).collect::<BTreeSet<_>>().len() > 1;
    said.extend(by_cells.values().filter(several).map(|group| {
        let names: Vec<&str> = group.iter().map(|(name, _)| name.as_str()).collect();
        format!("{}: the same rows in two formats, and counted {} times; keep one", names.join(", "), names.len())
    }));
    said.sort();
    said
}

/// Of the names and the cells, column by column.
fn digest(path: &Path) -> Result<[u8; 32], TableError> {
    let table = Table::read(path)?;
    let mut digest = Sha256::new();
    for name in table.names() {
        digest.update(name.as_bytes());
        table.each_cell(name, |_, cell| {
            match cell {
                Cell::Number(number) => digest.update(number.to_bits().to_le_bytes()),
                // In CSV a name that is a number is one.
                Cell::Text(text) => match text.parse::<f64>() {
                    Ok(number) => digest.update(number.to_bits().to_le_bytes()),
                    Err(_) => digest.update(text.as_bytes()),
                },
                Cell::Missing => {}
            }
            digest.update([0xff]);
            Ok(())
        })?;
    }
    Ok(digest.finalize().into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::{Column, TableWriter, Value};

    #[test]
    fn one_recording_in_two_formats_is_one() {
        let dir = tempfile::tempdir().unwrap();
        let write = |name: &str, last: f64| {
            let path = dir.path().join(name);
            let columns = vec![Column::number("time_s"), Column::text("subject")];
            let mut table = TableWriter::create(&path, &path, columns, &[]).unwrap();
            for value in [0.5, f64::NAN, last] {
                table.write(&[Value::Number(value), Value::Text("1")]).unwrap();
            }
            table.finish().unwrap();
            path
        };
        let [csv, parquet, other] = [write("a.csv", 0.1), write("b.parquet", 0.1), write("c.parquet", 0.2)];
        let said = |files: &[&Path]| {
            copies(files.iter().map(|file| (file.extension().unwrap().to_string_lossy().into_owned(), *file)).collect())
        };
        assert_eq!(
            said(&[&csv, &parquet, &other]),
            ["csv, parquet: the same rows in two formats, and counted 2 times; keep one"]
        );
        assert!(said(&[&parquet, &other]).is_empty() && said(&[&csv, &other]).is_empty());
        assert_eq!(said(&[&csv, &csv]), ["csv, csv: the same to the byte, and counted 2 times; keep one"]);
    }
}
