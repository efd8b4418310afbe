//! Figures of other programs that were measured elsewhere: a `tradeoff.csv` of another run, or the table of the
//! hemodynamics bench.

use std::path::Path;

use anyhow::{Context, bail, ensure};
use serde::Deserialize;

use crate::tradeoff::Row;
use crate::tradeoff::all::Job;
use crate::tradeoff::hemodynamics;

/// A row of `tradeoff.csv`; lines that begin with `#` say how it was made.
#[derive(Debug, Deserialize)]
struct Measured {
    job: String,
    setting: String,
    error: Option<f64>,
    error_unit: String,
    run_s: Option<f64>,
    work: Option<u64>,
    run_low_s: Option<f64>,
    run_high_s: Option<f64>,
    repeats: Option<u64>,
    peer: Option<bool>,
}

/// Reads a table of other programs' figures: `job,setting,error,error_unit,run_s[,work,..]` as this program writes it,
/// of which only rows with `peer` true are taken where there is such a column; or
/// `solver,rtol,error,microseconds[,evaluations]` for hemodynamics.
///
/// # Errors
/// A file that can't be read, or a row that is none, with its place.
pub fn read_peers(path: &Path) -> anyhow::Result<Vec<Row>> {
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_path(path)
        .with_context(|| path.display().to_string())?;
    let header = reader.headers().with_context(|| path.display().to_string())?;
    if header.iter().any(|name| name == "solver") {
        return hemodynamics::read_peers(path);
    }
    let mut rows = Vec::new();
    for row in reader.deserialize() {
        let row: Measured = row.with_context(|| {
            format!("{}: write job,setting,error,error_unit,run_s or solver,rtol,error,microseconds", path.display())
        })?;
        if row.peer == Some(false) {
            continue;
        }
        let place = || format!("{}: {}", path.display(), row.setting);
        let job = Job::ALL.into_iter().find(|job| job.name() == row.job);
        let names = || Job::ALL.map(Job::name).join(", ");
        let job = job.with_context(|| format!("{}: `{}` is no job; one of {}", place(), row.job, names()))?;
        let (Some(error), Some(run_s)) = (row.error, row.run_s) else {
            bail!("{}: error and run_s have to be there", place())
        };
        let usable = error >= 0.0 && error.is_finite() && run_s > 0.0 && run_s.is_finite();
        ensure!(usable, "{}: error and run_s have to be positive numbers", place());
        rows.push(Row {
            job: job.name(),
            setting: row.setting,
            error,
            error_unit: row.error_unit,
            run_s,
            work: row.work.unwrap_or(0),
            // Known once it stands beside the curve's own settings.
            choice: "",
            run_low_s: row.run_low_s.unwrap_or(run_s),
            run_high_s: row.run_high_s.unwrap_or(run_s),
            repeats: row.repeats.unwrap_or(0),
            knee: false,
            default: false,
            peer: true,
        });
    }
    ensure!(!rows.is_empty(), "{}: has no rows of other programs", path.display());
    Ok(rows)
}

/// Puts rows of tables beside those measured here, by what their error is. What was measured here is not doubled.
///
/// # Errors
/// A row whose error is none of the curves'.
pub(in crate::tradeoff) fn join<'a>(rows: &mut Vec<Row>, others: impl Iterator<Item = &'a Row>) -> anyhow::Result<()> {
    for other in others {
        let curve = rows.iter().find(|row| row.error_unit == other.error_unit).map(|row| row.choice);
        let units = || {
            let mut units: Vec<&str> = rows.iter().map(|row| row.error_unit.as_str()).collect();
            units.dedup();
            units.sort_unstable();
            units.dedup();
            units.join("`, `")
        };
        let choice = curve.with_context(|| {
            format!(
                "{}: no curve of {} has the error `{}`; one of `{}`",
                other.setting,
                other.job,
                other.error_unit,
                units()
            )
        })?;
        if !rows.iter().any(|row| row.peer && row.setting == other.setting && row.error_unit == other.error_unit) {
            rows.push(Row { choice, ..other.clone() });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tradeoff::judge::tests::{judged, row};
    use crate::tradeoff::photos::OUTLINE_ERROR;

    fn written(text: &str) -> anyhow::Result<Vec<Row>> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("peers.csv");
        std::fs::write(&path, text).unwrap();
        read_peers(&path)
    }

    #[test]
    fn rows_of_another_run_come_onto_the_curve() {
        let text = format!(
            "# another machine\njob,setting,error,error_unit,run_s,work,peer\n\
             photos,Other,0.2,\"{OUTLINE_ERROR}\",3.5,,true\n\
             photos,ours,0.1,\"{OUTLINE_ERROR}\",1,5,false\n"
        );
        let others = written(&text).unwrap();
        assert_eq!(others.len(), 1);
        let found = judged(vec![row("a", 1.0, 0.1)], &others).unwrap();
        let peer = found.rows.iter().find(|row| row.peer).unwrap();
        assert_eq!((peer.setting.as_str(), peer.run_s, peer.choice), ("Other", 3.5, "detection"));
        assert_eq!(found.curves[0].peer.as_ref().unwrap().setting, "Other");
    }

    #[test]
    fn bad_tables_say_where_and_what() {
        let error = |text: &str| format!("{:#}", written(text).unwrap_err());
        assert!(
            error("job,setting,error,error_unit,run_s\nphoto,A,1,u,1\n").contains("`photo` is no job; one of photos")
        );
        assert!(error("job,setting,error,error_unit,run_s\nphotos,A,,u,1\n").contains("have to be there"));
        assert!(error("job,setting,error,error_unit,run_s\nphotos,A,-1,u,1\n").contains("positive numbers"));
        assert!(error("a,b\n1,2\n").contains("solver,rtol,error"));
        assert!(error("job,setting,error,error_unit,run_s\n").contains("no rows"));
        let others = written("job,setting,error,error_unit,run_s\nphotos,A,1,metres,1\n").unwrap();
        let why = judged(vec![row("a", 1.0, 0.1)], &others).unwrap_err().to_string();
        assert!(why.contains("`metres`") && why.contains(OUTLINE_ERROR), "{why}");
    }
}
