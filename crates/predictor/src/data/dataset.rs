//! Rows of voltages with the targets measured at the same time, and which recording, session and subject each comes
//! from.

use std::collections::HashSet;
use std::iter;
use std::ops::Range;

use ndarray::{Array2, Axis};
use thiserror::Error;

/// Rows that follow each other in time: one trajectory.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Recording {
    /// Its name, usually the file's.
    pub name: String,
    /// Of which session: between two, the sensor was taken off.
    pub session: String,
    /// Of whom.
    pub subject: String,
    /// Which rows of the [`Dataset`].
    pub rows: Range<usize>,
}

impl Recording {
    /// Of no session and nobody that are known.
    pub(crate) fn of(name: impl Into<String>, rows: Range<usize>) -> Self {
        Self { name: name.into(), session: String::new(), subject: String::new(), rows }
    }
}

/// Voltages and targets. Every value is finite (but for cells that are hidden, [`Dataset::with_hidden`]), every row
/// belongs to one recording, recordings follow each other. Moments whose targets are not known are no rows, but may be
/// a row's past ([`Dataset::with_past`]).
#[derive(Debug, Clone, PartialEq)]
pub struct Dataset {
    inputs: Vec<String>,
    targets: Vec<String>,
    time_s: Vec<f64>,
    x: Array2<f64>,
    y: Array2<f64>,
    recordings: Vec<Recording>,
    past: Past,
}

/// Voltages of moments without targets, before rows of a [`Dataset`].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Past {
    /// Right before which row each comes, in whose recording; none before the one before it.
    pub before: Vec<usize>,
    /// Seconds, on the recording's clock.
    pub time_s: Vec<f64>,
    /// Voltages, one moment after the other.
    pub x: Vec<f64>,
}

/// Why rows are no [`Dataset`].
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum DatasetFault {
    #[error("{what}: {found} where {wanted} are needed")]
    Shape { what: &'static str, found: usize, wanted: usize },
    #[error("{name} of row {row} is not finite; leave the row out")]
    NotFinite {
        name: String,
        /// The row, from 0.
        row: usize,
    },
    #[error("two columns are named {0}")]
    Twice(String),
    #[error("recording {0} does not begin where the one before ends")]
    Order(String),
    #[error("moments of the past do not ascend, or are of no row")]
    Past,
}

impl Dataset {
    /// Checks and takes rows: `x` rows x inputs, `y` rows x targets, the time of each row within its recording in
    /// seconds (it may be NaN where it is not known).
    pub fn new(
        inputs: Vec<String>,
        targets: Vec<String>,
        time_s: Vec<f64>,
        x: Array2<f64>,
        y: Array2<f64>,
        recordings: Vec<Recording>,
    ) -> Result<Self, DatasetFault> {
        if let Some(((row, column), _)) =
            x.indexed_iter().find(|(_, v)| v.is_nan()).filter(|_| x.ncols() == inputs.len())
        {
            return Err(DatasetFault::NotFinite { name: inputs[column].clone(), row });
        }
        Self::with_hidden(inputs, targets, time_s, x, y, recordings)
    }

    /// The same of rows some of whose inputs are not known: NaN, cells of a nail that are hidden. Only
    /// [`Kind::Eigennails`](crate::Kind::Eigennails) is fitted to such rows.
    pub fn with_hidden(
        inputs: Vec<String>,
        targets: Vec<String>,
        time_s: Vec<f64>,
        x: Array2<f64>,
        y: Array2<f64>,
        recordings: Vec<Recording>,
    ) -> Result<Self, DatasetFault> {
        let n = x.nrows();
        shape("columns of voltages", x.ncols(), inputs.len())?;
        shape("columns of targets", y.ncols(), targets.len())?;
        shape("rows of targets", y.nrows(), n)?;
        shape("times", time_s.len(), n)?;
        let mut names = HashSet::new();
        if let Some(name) = inputs.iter().chain(&targets).find(|name| !names.insert(name.as_str())) {
            return Err(DatasetFault::Twice(name.clone()));
        }
        for (values, names, hidden) in [(&x, &inputs, true), (&y, &targets, false)] {
            let wrong = |v: &f64| !(v.is_finite() || hidden && v.is_nan());
            if let Some(((row, column), _)) = values.indexed_iter().find(|(_, v)| wrong(v)) {
                return Err(DatasetFault::NotFinite { name: names[column].clone(), row });
            }
        }
        let mut next = 0;
        for recording in &recordings {
            if recording.rows.start != next || recording.rows.end < next {
                return Err(DatasetFault::Order(recording.name.clone()));
            }
            next = recording.rows.end;
        }
        shape("rows of all recordings", next, n)?;
        // Rows lie one after the other in memory: kernels read them as slices.
        let (x, y) = (x.as_standard_layout().into_owned(), y.as_standard_layout().into_owned());
        Ok(Self { inputs, targets, time_s, x, y, recordings, past: Past::default() })
    }

    /// The same with moments whose targets are not known, from which [`Lags`](crate::Lags) read the past as well. Those
    /// of which a voltage is not finite are passed over there.
    pub fn with_past(self, past: Past) -> Result<Self, DatasetFault> {
        shape("times of the past", past.time_s.len(), past.before.len())?;
        shape("voltages of the past", past.x.len(), past.before.len() * self.inputs.len())?;
        let ascend = past.before.windows(2).all(|pair| pair[0] <= pair[1]);
        if !ascend || past.before.last().is_some_and(|&last| last >= self.rows()) {
            return Err(DatasetFault::Past);
        }
        Ok(Self { past, ..self })
    }

    /// One recording without a name, evenly sampled from time 0.
    pub fn plain(
        inputs: Vec<String>,
        targets: Vec<String>,
        x: Array2<f64>,
        y: Array2<f64>,
        step_s: f64,
    ) -> Result<Self, DatasetFault> {
        let n = x.nrows();
        let time_s = (0..n).map(|k| k as f64 * step_s).collect();
        Self::new(inputs, targets, time_s, x, y, vec![Recording::of("", 0..n)])
    }

    /// How many rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.x.nrows()
    }

    /// Names of the photodiodes, column by column.
    #[must_use]
    pub fn inputs(&self) -> &[String] {
        &self.inputs
    }

    /// Names of the targets, column by column.
    #[must_use]
    pub fn targets(&self) -> &[String] {
        &self.targets
    }

    /// Seconds, row by row; NaN where not known.
    #[must_use]
    pub fn time_s(&self) -> &[f64] {
        &self.time_s
    }

    /// Voltages, rows x inputs, in standard layout.
    #[must_use]
    pub fn x(&self) -> &Array2<f64> {
        &self.x
    }

    /// Targets, rows x targets, in standard layout.
    #[must_use]
    pub fn y(&self) -> &Array2<f64> {
        &self.y
    }

    /// The recordings, in order.
    #[must_use]
    pub fn recordings(&self) -> &[Recording] {
        &self.recordings
    }

    /// A recording's rows, in order, and before each the moments of its past: which row, seconds, voltages.
    pub(crate) fn moments<'a>(
        &'a self,
        one: &Recording,
    ) -> impl Iterator<Item = (Option<usize>, f64, &'a [f64])> + use<'a> {
        one.rows.clone().flat_map(move |row| {
            let past = self.past_of(row).map(|k| (None, self.past.time_s[k], self.past_x(k)));
            let x = self.x.row(row).to_slice().expect("a set's rows are in standard layout");
            past.chain(iter::once((Some(row), self.time_s[row], x)))
        })
    }

    fn past_of(&self, row: usize) -> Range<usize> {
        let before = &self.past.before;
        let from = before.partition_point(|&before| before < row);
        from..from + before[from..].partition_point(|&before| before == row)
    }

    fn past_x(&self, k: usize) -> &[f64] {
        let width = self.inputs.len();
        &self.past.x[k * width..(k + 1) * width]
    }

    /// Only the rows of some recordings, by their place in [`recordings`](Self::recordings), in the order given.
    #[must_use]
    pub fn only(&self, recordings: &[usize]) -> Self {
        let mut rows = Vec::new();
        let mut kept = Vec::new();
        for &k in recordings {
            let one = &self.recordings[k];
            let start = rows.len();
            rows.extend(one.rows.clone());
            kept.push(Recording { rows: start..rows.len(), ..one.clone() });
        }
        self.take(&rows, kept)
    }

    /// Only some rows, ascending; recordings keep their names and lose rows.
    #[must_use]
    pub fn only_rows(&self, rows: &[usize]) -> Self {
        debug_assert!(rows.windows(2).all(|pair| pair[0] < pair[1]), "rows ascend");
        let mut kept = Vec::new();
        let mut start = 0;
        for one in &self.recordings {
            let end = start + rows[start..].partition_point(|&row| row < one.rows.end);
            kept.push(Recording { rows: start..end, ..one.clone() });
            start = end;
        }
        kept.retain(|one| !one.rows.is_empty());
        self.take(rows, kept)
    }

    /// Only some photodiodes, by column.
    #[must_use]
    pub fn only_inputs(&self, columns: &[usize]) -> Self {
        let inputs = columns.iter().map(|&k| self.inputs[k].clone()).collect();
        let past_x =
            (0..self.past.before.len()).flat_map(|k| columns.iter().map(move |&column| self.past_x(k)[column]));
        let past = Past { x: past_x.collect(), ..self.past.clone() };
        // `select` puts columns one after the other.
        Self { inputs, x: self.x.select(Axis(1), columns).as_standard_layout().into_owned(), past, ..self.clone() }
    }

    fn take(&self, rows: &[usize], recordings: Vec<Recording>) -> Self {
        let mut past = Past::default();
        for (place, &row) in rows.iter().enumerate() {
            for k in self.past_of(row) {
                past.before.push(place);
                past.time_s.push(self.past.time_s[k]);
                past.x.extend(self.past_x(k));
            }
        }
        Self {
            inputs: self.inputs.clone(),
            targets: self.targets.clone(),
            time_s: rows.iter().map(|&row| self.time_s[row]).collect(),
            x: self.x.select(Axis(0), rows),
            y: self.y.select(Axis(0), rows),
            recordings,
            past,
        }
    }
}

fn shape(what: &'static str, found: usize, wanted: usize) -> Result<(), DatasetFault> {
    if found == wanted { Ok(()) } else { Err(DatasetFault::Shape { what, found, wanted }) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::array;

    fn two() -> Dataset {
        let recording =
            |name: &str, rows| Recording { name: name.into(), session: "1".into(), subject: "a".into(), rows };
        Dataset::new(
            vec!["P1".into(), "P2".into()],
            vec!["J2_deg".into()],
            vec![0.0, 1.0, 0.0],
            array![[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]],
            array![[0.1], [0.2], [0.3]],
            vec![recording("one", 0..2), recording("two", 2..3)],
        )
        .unwrap()
    }

    #[test]
    fn parts_keep_their_recordings() {
        let data = two();
        let second = data.only(&[1]);
        assert_eq!((second.rows(), second.recordings()[0].name.as_str()), (1, "two"));
        assert_eq!(data.only(&[1, 0]).y(), &array![[0.3], [0.1], [0.2]]);
        let some = data.only_rows(&[1, 2]);
        assert_eq!(some.recordings().iter().map(|one| one.rows.clone()).collect::<Vec<_>>(), [0..1, 1..2]);
        assert_eq!(data.only_inputs(&[1]).x(), &array![[2.0], [4.0], [6.0]]);
        let turned = data.only_inputs(&[1, 0]);
        assert_eq!(turned.x().as_slice().map(|rows| rows[0]), Some(2.0), "rows one after the other");
    }

    #[test]
    fn a_rows_past_goes_where_it_goes() {
        let past = |before: &[usize], time_s: &[f64], x: &[f64]| Past {
            before: before.to_vec(),
            time_s: time_s.to_vec(),
            x: x.to_vec(),
        };
        let data = two().with_past(past(&[1, 1, 2], &[0.3, 0.6, -1.0], &[1.5, 2.5, 2.0, 3.0, 4.5, 5.5])).unwrap();
        let of = |data: &Dataset| -> Vec<(Option<usize>, f64, Vec<f64>)> {
            let moments = data.recordings().iter().flat_map(|one| data.moments(one));
            moments.map(|(row, time_s, x)| (row, time_s, x.to_vec())).collect()
        };
        let all = of(&data);
        assert_eq!(all.iter().map(|one| one.0).collect::<Vec<_>>(), [Some(0), None, None, Some(1), None, Some(2)]);
        assert_eq!((all[2].1, &all[2].2[..]), (0.6, &[2.0, 3.0][..]));
        assert_eq!(of(&data.only(&[1])), [(None, -1.0, vec![4.5, 5.5]), (Some(0), 0.0, vec![5.0, 6.0])]);
        assert_eq!(of(&data.only_rows(&[0, 2]))[1].1, -1.0, "without its row it is nobody's");
        assert_eq!(of(&data.only_inputs(&[1, 0]))[2].2, [3.0, 2.0]);
        for wrong in [past(&[3], &[0.0], &[1.0; 2]), past(&[1, 0], &[0.0; 2], &[1.0; 4])] {
            assert_eq!(two().with_past(wrong), Err(DatasetFault::Past));
        }
        assert!(two().with_past(past(&[1], &[0.0], &[1.0])).is_err());
    }

    #[test]
    fn what_is_no_dataset_is_refused() {
        let names = || (vec!["P1".to_owned()], vec!["J2_deg".to_owned()]);
        let (inputs, targets) = names();
        let fault = Dataset::plain(inputs, targets, array![[1.0], [f64::NAN]], array![[1.0], [2.0]], 0.04);
        assert_eq!(fault, Err(DatasetFault::NotFinite { name: "P1".into(), row: 1 }));
        let (inputs, targets) = names();
        assert!(Dataset::plain(inputs, targets, array![[1.0]], array![[1.0], [2.0]], 0.04).is_err());
        assert!(Dataset::plain(vec!["P1".into()], vec!["P1".into()], array![[1.0]], array![[1.0]], 0.04).is_err());
    }
}
