//! Peers' figures, as their own bench wrote them.

use std::path::Path;

use anyhow::Context;

use super::{ERROR, SOLVING};
use crate::tradeoff::measure::rows::Row;
use crate::tradeoff::measure::timing::Timing;

/// A row of a peer's table: `solver,rtol,error,microseconds,evaluations`; lines that begin with `#` say how it was
/// made.
#[derive(Debug, serde::Deserialize)]
struct Measured {
    solver: String,
    rtol: f64,
    error: f64,
    #[serde(alias = "us_per_response")]
    microseconds: f64,
    evaluations: Option<u64>,
}

/// Reads a table of peers.
///
/// # Errors
/// A file that can't be read, or a row that is none, with its place.
pub fn read_peers(path: &Path) -> anyhow::Result<Vec<Row>> {
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_path(path)
        .with_context(|| path.display().to_string())?;
    let mut rows = Vec::new();
    for row in reader.deserialize() {
        let row: Measured =
            row.with_context(|| format!("{}: write solver,rtol,error,microseconds[,evaluations]", path.display()))?;
        let usable = row.error >= 0.0 && row.microseconds > 0.0 && row.rtol > 0.0;
        anyhow::ensure!(
            usable && row.error.is_finite() && row.microseconds.is_finite(),
            "{}: {} at {:e}: error and microseconds have to be positive numbers",
            path.display(),
            row.solver,
            row.rtol
        );
        if row.solver.starts_with("lunula") {
            continue; // Our own rows of the bench are measured here again.
        }
        // Where tolerances of the rates are loosened, the series is the same solver's.
        let setting = match row.solver.strip_suffix(" loose rates") {
            Some(solver) => format!("{solver}, {:.0e} (loose)", row.rtol),
            None => format!("{}, {:.0e}", row.solver, row.rtol),
        };
        let time = Timing::of(vec![1e-6 * row.microseconds]);
        let own = Row::own(SOLVING, &setting, (row.error, ERROR), time, row.evaluations.unwrap_or(0)).peer();
        rows.push(Row { repeats: 0, ..own });
    }
    anyhow::ensure!(!rows.is_empty(), "{}: has no rows of peers", path.display());
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_peers_table_is_read_with_its_comments_left_out() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("peers.csv");
        std::fs::write(
            &path,
            "# how\nsolver,rtol,error,microseconds,evaluations\nA (C),1e-03,2e-3,100,5\nA (C) loose \
                               rates,1e-06,1e-5,200,\n",
        )
        .unwrap();
        let rows = read_peers(&path).unwrap();
        let settings: Vec<&str> = rows.iter().map(|row| row.setting.as_str()).collect();
        assert_eq!(settings, ["A (C), 1e-3", "A (C), 1e-6 (loose)"]);
        assert!((rows[1].run_s - 2e-4).abs() <= 1e-18 && rows[1].work == 0);
        std::fs::write(&path, "solver,rtol,error,microseconds\nA,1e-3,nan,100\n").unwrap();
        assert!(read_peers(&path).unwrap_err().to_string().contains("A at 1e-3"));
        std::fs::write(&path, "solver,error\nA,1\n").unwrap();
        assert!(format!("{:#}", read_peers(&path).unwrap_err()).contains("solver,rtol,error"));
    }
}
