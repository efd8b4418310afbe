//! A table of trials, row by row.

use std::collections::BTreeMap;
use std::path::Path;

use lunula_live::performance::Course;

use crate::live::error::LiveError;
use crate::table::Table;

/// More rows than anybody's trials.
const MOST_ROWS: usize = 1_000_000;
/// Numbers of trials above this are something else.
const MOST_TRIALS: i64 = 10_000;
/// More methods or operators are something else: a column was mistaken.
const MOST_METHODS: usize = 20;
const MOST_OPERATORS: usize = 10_000;
/// So many faults are named.
const MOST_NAMED: usize = 10;

/// One operator's trial.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Row {
    /// Which of [`Trials::operators`].
    pub(super) operator: usize,
    /// Which of [`Trials::methods`].
    pub(super) method: usize,
    pub(super) trial: u32,
    pub(super) time_s: f64,
    pub(super) decision_s: f64,
}

/// All that can be used.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Trials {
    /// In the order in which they first appear.
    pub(super) operators: Vec<String>,
    pub(super) methods: Vec<String>,
    pub(super) rows: Vec<Row>,
    /// Rows without a time.
    pub(super) missing: usize,
    /// Rows whose time can't be, each with its place.
    pub(super) impossible: Vec<String>,
}

/// The place of a name in a list, which it is added to.
fn place(of: &str, names: &mut Vec<String>, places: &mut BTreeMap<String, usize>) -> usize {
    *places.entry(of.to_owned()).or_insert_with(|| {
        names.push(of.to_owned());
        names.len() - 1
    })
}

/// Reads `operator,method,trial,time_s`; `path` is called `name` in what is reported.
///
/// # Errors
/// A table that can't be read, a cell that is wrong, two rows of one operator, method and trial, or no row to use.
pub(super) fn read(path: &Path, name: &str, course: &Course) -> Result<Trials, LiveError> {
    let whole = |what: String| LiveError::Faults(vec![format!("{name}: {what}")]);
    let table = Table::read(path)?;
    if table.rows() > MOST_ROWS {
        return Err(whole(format!("has {} rows; trials are at most {MOST_ROWS}", table.rows())));
    }
    let [operators, methods] = [table.texts("operator")?, table.texts("method")?];
    let (numbers, times_s) = (table.integers("trial")?, table.numbers_or_nan("time_s")?);
    let mut trials = Trials::default();
    let (mut operator_places, mut method_places) = (BTreeMap::new(), BTreeMap::new());
    let mut seen: BTreeMap<(usize, usize, u32), usize> = BTreeMap::new();
    let mut twice = Vec::new();
    for row in 0..table.rows() {
        let known = |cell: &Option<String>, column: &str| {
            let text = cell.as_deref().map(str::trim).filter(|text| !text.is_empty()).map(str::to_owned);
            text.ok_or_else(|| table.cell(row, column, "is empty; write a name".to_owned()))
        };
        let operator = known(&operators[row], "operator")?;
        let method = known(&methods[row], "method")?;
        let trial = numbers[row].filter(|trial| (1..=MOST_TRIALS).contains(trial)).ok_or_else(|| {
            table.cell(row, "trial", format!("write the number of the trial, from 1 to {MOST_TRIALS}"))
        })? as u32;
        let Some(time_s) = times_s[row].filter(|time_s| time_s.is_finite()) else {
            trials.missing += 1;
            continue;
        };
        let key = (
            place(&operator, &mut trials.operators, &mut operator_places),
            place(&method, &mut trials.methods, &mut method_places),
            trial,
        );
        if let Some(first) = seen.insert(key, row) {
            twice.push(format!(
                "{name}: {} and {}: both are operator {operator}, method {method}, trial {trial}; keep one, or number \
                 the trials on",
                table.row_place(first),
                table.row_place(row)
            ));
            continue;
        }
        match course.per_decision_s(time_s) {
            Some(decision_s) => {
                trials.rows.push(Row { operator: key.0, method: key.1, trial, time_s, decision_s });
            }
            None => trials.impossible.push(format!(
                "{name}: {}: {time_s} s are less than the {:.6} s of driving alone; correct the time, or --path-m and \
                 --speed-mps",
                table.row_place(row),
                course.shortest_s()
            )),
        }
    }
    if !twice.is_empty() {
        return Err(LiveError::Faults(shortened(twice)));
    }
    for (many, most, column) in
        [(trials.methods.len(), MOST_METHODS, "method"), (trials.operators.len(), MOST_OPERATORS, "operator")]
    {
        if many > most {
            return Err(whole(format!("column `{column}`: has {many} different names, more than {most}")));
        }
    }
    if trials.rows.is_empty() {
        let mut faults = vec![format!("{name}: has no trial to use; write operator, method, trial, time_s")];
        faults.extend(shortened(std::mem::take(&mut trials.impossible)));
        return Err(LiveError::Faults(faults));
    }
    trials.impossible = shortened(trials.impossible);
    Ok(trials)
}

/// The first of many, and how many more there are.
fn shortened(mut faults: Vec<String>) -> Vec<String> {
    let more = faults.len().saturating_sub(MOST_NAMED);
    faults.truncate(MOST_NAMED);
    faults.extend((more > 0).then(|| format!("and {more} more")));
    faults
}
