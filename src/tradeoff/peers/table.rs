//! The table of other programs' figures, written by `bench/peers` and read by `--peers`.

use std::path::Path;

use anyhow::{Context, ensure};
use jiff::civil::Date;

use crate::table::{Table, TableError};
use crate::tradeoff::choices::{Job, choices};
use crate::words::instead;

/// A figure of another program: a row of the table.
#[derive(Debug, Clone, PartialEq)]
pub struct PeerRow {
    /// Of which job.
    pub stage: Job,
    /// What is chosen there: the name of a [`Choice`](crate::tradeoff::Choice).
    pub choice: String,
    /// What it was measured on, as [`Plan::scene`](crate::tradeoff::Plan::scene) says.
    pub scene: String,
    /// The program, and after a comma or colon which setting of it.
    pub setting: String,
    /// How wrong.
    pub error: f64,
    /// What the error is, and its unit: that of the curve it belongs to.
    pub error_unit: String,
    /// Seconds on one thread per input; the median over repeats.
    pub run_s: f64,
    /// The lower quartile of the seconds.
    pub run_low_s: f64,
    /// The upper quartile of the seconds.
    pub run_high_s: f64,
    /// How often it ran; 0: not known.
    pub repeats: u64,
    /// What was done per input; 0: not known.
    pub work: u64,
    /// On which machine.
    pub machine: String,
    /// Versions of the program and what it stands on.
    pub version: String,
    /// When, as 2026-11-22.
    pub date: String,
}

/// The columns; cells of `run_low_s`, `run_high_s`, `repeats` and `work` may be empty.
const COLUMNS: [&str; 14] = [
    "stage",
    "choice",
    "scene",
    "setting",
    "error",
    "error_unit",
    "run_s",
    "run_low_s",
    "run_high_s",
    "repeats",
    "work",
    "machine",
    "version",
    "date",
];

/// Writes a table (CSV).
///
/// # Errors
/// A file that can't be written.
pub fn write_peers(rows: &[PeerRow], path: &Path) -> anyhow::Result<()> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(COLUMNS)?;
    for row in rows {
        let [error, run_s, low_s, high_s] =
            [row.error, row.run_s, row.run_low_s, row.run_high_s].map(|number| number.to_string());
        let [repeats, work] = [row.repeats, row.work].map(|count| count.to_string());
        let text = [row.stage.name(), &row.choice, &row.scene, &row.setting];
        let numbers = [&error, row.error_unit.as_str(), &run_s, &low_s, &high_s, &repeats, &work];
        writer.write_record(text.into_iter().chain(numbers).chain([&*row.machine, &*row.version, &*row.date]))?;
    }
    let bytes = writer.into_inner().context("the table")?;
    std::fs::write(path, bytes).with_context(|| path.display().to_string())
}

/// Reads a table (CSV or Parquet).
///
/// # Errors
/// A file that can't be read, or a cell that is wrong, with file, line and column.
pub fn read_peers(path: &Path) -> anyhow::Result<Vec<PeerRow>> {
    let table = Table::read(path)?;
    for name in table.names() {
        let known = COLUMNS.contains(&name.as_str());
        ensure!(known, "{}: `{name}` is not a column of other programs; {}", path.display(), instead(name, &COLUMNS));
    }
    let text = |name: &str| each(&table, name, table.texts(name)?, Some);
    let positive = |name: &str, least: f64| {
        each(&table, name, table.numbers(name)?, move |number: f64| {
            (number >= least && number >= 0.0).then_some(number)
        })
    };
    let [stages, named, scenes, settings] = ["stage", "choice", "scene", "setting"].map(text);
    let (mut stages, named, scenes, settings) = (stages?.into_iter(), named?, scenes?, settings?);
    let [units, machines, versions, dates] = ["error_unit", "machine", "version", "date"].map(text);
    let (units, machines, versions, dates) = (units?, machines?, versions?, dates?);
    let (errors, run_s) = (positive("error", 0.0)?, positive("run_s", f64::MIN_POSITIVE)?);
    let [low_s, high_s] = ["run_low_s", "run_high_s"].map(|name| table.numbers(name));
    let (low_s, high_s) = (low_s?, high_s?);
    let [repeats, work] = ["repeats", "work"].map(|name| table.integers(name));
    let (repeats, work) = (repeats?, work?);
    let count = |cell: Option<i64>| cell.and_then(|number| u64::try_from(number).ok()).unwrap_or(0);
    let known = choices();
    (0..table.rows())
        .map(|row| {
            let wrong = |name: &str, what: String| table.cell(row, name, what);
            let stage = stages.next().unwrap_or_default();
            let stage = Job::named(&stage).map_err(|what| wrong("stage", what))?;
            let own: Vec<&str> = known.iter().filter(|one| one.job == stage.name()).map(|one| one.name).collect();
            let choice = named[row].clone();
            if !own.contains(&choice.as_str()) {
                let what =
                    format!("nothing called `{choice}` is chosen in {}; {}", stage.name(), instead(&choice, &own));
                return Err(wrong("choice", what).into());
            }
            let date = dates[row].clone();
            date.parse::<Date>().map_err(|_| wrong("date", format!("`{date}` is not a date such as 2026-11-22")))?;
            Ok(PeerRow {
                stage,
                choice,
                scene: scenes[row].clone(),
                setting: settings[row].clone(),
                error: errors[row],
                error_unit: units[row].clone(),
                run_s: run_s[row],
                run_low_s: low_s[row].unwrap_or(run_s[row]),
                run_high_s: high_s[row].unwrap_or(run_s[row]),
                repeats: count(repeats[row]),
                work: count(work[row]),
                machine: machines[row].clone(),
                version: versions[row].clone(),
                date,
            })
        })
        .collect()
}

/// A column without empty cells; `usable` gives what a cell is worth.
fn each<T, V>(
    table: &Table,
    name: &str,
    cells: Vec<Option<T>>,
    usable: impl Fn(T) -> Option<V>,
) -> Result<Vec<V>, TableError> {
    let cells = cells.into_iter().enumerate();
    cells.map(|(row, cell)| cell.and_then(&usable).ok_or_else(|| table.cell(row, name, WANTED.to_owned()))).collect()
}

/// What is said of a cell that is empty or, of a number, not positive.
const WANTED: &str = "is empty or not positive; write what was measured";

#[cfg(test)]
pub(in crate::tradeoff) mod tests {
    use super::*;
    use crate::tradeoff::photos::OUTLINE_ERROR;
    use crate::trial::Folder;

    pub(in crate::tradeoff) fn other(setting: &str, error: f64, run_s: f64) -> PeerRow {
        PeerRow {
            stage: Job::Photos,
            choice: "detection".to_owned(),
            scene: "seed 1".to_owned(),
            setting: setting.to_owned(),
            error,
            error_unit: OUTLINE_ERROR.to_owned(),
            run_s,
            run_low_s: run_s,
            run_high_s: run_s,
            repeats: 3,
            work: 0,
            machine: "a laptop, 4 cores".to_owned(),
            version: "Other 2.1".to_owned(),
            date: "2026-11-22".to_owned(),
        }
    }

    fn text(rows: &[PeerRow]) -> String {
        let folder = Folder::new();
        write_peers(rows, &folder.path("peers.csv")).unwrap();
        std::fs::read_to_string(folder.path("peers.csv")).unwrap()
    }

    fn read(text: &str) -> anyhow::Result<Vec<PeerRow>> {
        read_peers(&Folder::new().file("peers.csv", text))
    }

    #[test]
    fn what_is_written_is_read() {
        let rows = vec![other("Other, fast", 0.2, 3.5), other("Other: \"best\"", 0.0, 1e-9)];
        assert_eq!(read(&text(&rows)).unwrap(), rows);
        let short = text(&rows[..1]).replace(",3.5,3.5,3.5,3,0,", ",3.5,,,,,");
        assert_eq!(read(&short).unwrap(), [PeerRow { repeats: 0, ..rows[0].clone() }]);
    }

    #[test]
    fn a_wrong_cell_is_named_by_line_and_column() {
        let good = text(&[other("Other", 0.25, 3.5)]);
        let error = |from: &str, to: &str| {
            assert!(good.contains(from), "{good}");
            format!("{:#}", read(&good.replacen(from, to, 1)).unwrap_err())
        };
        for (from, to, column, what) in [
            ("\nphotos", "\nphoto", "stage", "did you mean `photos`?"),
            ("\nphotos", "\nmovies", "stage", "known: photos, posture"),
            (",detection,", ",detecting,", "choice", "did you mean `detection`?"),
            (",0.25,", ",-1,", "error", "not positive"),
            (",0.25,", ",wrong,", "error", "`wrong`"),
            (",3.5,3.5,3.5,", ",,3.5,3.5,", "run_s", "is empty"),
            (",Other 2.1,", ",,", "version", "is empty"),
            ("2026-11-22", "yesterday", "date", "`yesterday` is not a date"),
        ] {
            let why = error(from, to);
            assert!(why.contains(&format!("peers.csv:2: column `{column}`")) && why.contains(what), "{why}");
        }
        assert!(error("run_low_s", "run_lows").contains("did you mean `run_low_s`?"));
    }
}
