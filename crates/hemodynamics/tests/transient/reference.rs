//! The reference tables, read.

use std::collections::BTreeMap;

/// A row of the reference: time (s) and displacements over nominal diameters.
pub(crate) type Row = (f64, [f64; 3]);

/// The responses of a table by their load, Pa.
pub(crate) fn responses(table: &str) -> Vec<(f64, Vec<Row>)> {
    let mut cases: BTreeMap<u64, (f64, Vec<Row>)> = BTreeMap::new();
    for row in rows(table) {
        let case = cases.entry((row[0] * 1e6) as u64).or_insert_with(|| (row[0], Vec::new()));
        case.1.push((row[1], [row[2], row[3], row[4]]));
    }
    cases.into_values().collect()
}

/// The numbers of a table without its comments and head.
pub(crate) fn rows(table: &str) -> Vec<Vec<f64>> {
    let lines = table.lines().filter(|line| !line.starts_with('#')).skip(1);
    lines.map(|line| line.split(',').map(|field| field.parse().expect(field)).collect()).collect()
}
