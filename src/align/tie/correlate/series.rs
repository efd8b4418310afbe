//! Signals over times of their own, made fit to be compared: sorted, without what is missing, each of mean 0 and mean
//! square 1.

use crate::median::median_of;

/// Columns over common times.
#[derive(Debug, Clone)]
pub(super) struct Series {
    /// Seconds, strictly ascending.
    pub(super) time_s: Vec<f64>,
    /// Each as long as the times.
    pub(super) columns: Vec<Vec<f64>>,
    /// The usual interval of the times, seconds.
    pub(super) interval_s: f64,
}

/// A column with fewer values than this share of the fullest is left out.
const FULL: f64 = 0.5;
/// Neighbours further apart than so many usual intervals have a gap between them.
const GAP: f64 = 3.5;
/// A column whose values vary by less than this share of their size is constant.
const CONSTANT: f64 = 1e-9;

impl Series {
    /// Reads columns over times; what is not finite is missing. `what` names them in errors.
    pub(super) fn new(time_s: &[f64], columns: &[&[f64]], what: &str) -> Result<Self, String> {
        let valid = |column: &[f64]| column.iter().zip(time_s).filter(|(v, t)| v.is_finite() && t.is_finite()).count();
        let fullest = columns.iter().map(|column| valid(column)).max().unwrap_or(0);
        let full: Vec<&[f64]> =
            columns.iter().copied().filter(|column| valid(column) as f64 > FULL * fullest as f64).collect();
        let mut rows: Vec<usize> = (0..time_s.len())
            .filter(|&row| {
                time_s[row].is_finite() && full.iter().all(|column| column.get(row).is_some_and(|v| v.is_finite()))
            })
            .collect();
        rows.sort_by(|&a, &b| time_s[a].total_cmp(&time_s[b]));
        rows.dedup_by(|later, earlier| time_s[*later] <= time_s[*earlier]);
        if rows.len() < 3 || full.is_empty() {
            return Err(format!("{what}: {} rows with a time and all values are too few to compare", rows.len()));
        }
        let time_s: Vec<f64> = rows.iter().map(|&row| time_s[row]).collect();
        let interval_s = median_of(time_s.windows(2).map(|pair| pair[1] - pair[0])).unwrap_or(f64::NAN);
        let columns: Vec<Vec<f64>> = full
            .iter()
            .map(|column| rows.iter().map(|&row| column[row]).collect::<Vec<f64>>())
            .filter_map(|column| standard(&column))
            .collect();
        if columns.is_empty() {
            return Err(format!("{what}: nothing changes in them, so nothing can be compared"));
        }
        Ok(Self { time_s, columns, interval_s })
    }

    pub(super) fn first_s(&self) -> f64 {
        self.time_s[0]
    }

    pub(super) fn last_s(&self) -> f64 {
        self.time_s[self.time_s.len() - 1]
    }

    /// From the first time to the last, seconds.
    pub(super) fn span_s(&self) -> f64 {
        self.last_s() - self.first_s()
    }

    /// The rows from one time to another.
    pub(super) fn between(&self, from_s: f64, to_s: f64) -> Self {
        let [from, to] = [from_s, to_s].map(|end_s| self.time_s.partition_point(|&t| t < end_s));
        Self {
            time_s: self.time_s[from..to].to_vec(),
            columns: self.columns.iter().map(|column| column[from..to].to_vec()).collect(),
            interval_s: self.interval_s,
        }
    }

    /// How far apart neighbours may be with nothing missing between them, seconds.
    fn gap_s(&self) -> f64 {
        GAP * self.interval_s
    }

    /// Its mean around each of the times `at_s` (ascending), over `width_s`; `None` in gaps and outside. The signal is
    /// taken to run straight between its values.
    pub(super) fn means(
        &self,
        at_s: impl Iterator<Item = f64>,
        width_s: f64,
        mut take: impl FnMut(usize, Option<&[f64]>),
    ) {
        let mut places = [0; 2];
        let mut row = vec![0.0; self.columns.len()];
        for (k, at_s) in at_s.enumerate() {
            let ends = [at_s - 0.5 * width_s, at_s + 0.5 * width_s];
            let inside = ends[0] >= self.first_s() && ends[1] <= self.last_s();
            if !inside {
                take(k, None);
                continue;
            }
            for (place, end) in places.iter_mut().zip(ends) {
                while *place + 2 < self.time_s.len() && self.time_s[*place + 1] <= end {
                    *place += 1;
                }
            }
            let [from, to] = places;
            if (from..=to).any(|i| self.time_s[i + 1] - self.time_s[i] > self.gap_s()) {
                take(k, None);
                continue;
            }
            for (mean, column) in row.iter_mut().zip(&self.columns) {
                let value = |place: usize, at: f64| {
                    let share = (at - self.time_s[place]) / (self.time_s[place + 1] - self.time_s[place]);
                    column[place] + share * (column[place + 1] - column[place])
                };
                if from == to {
                    *mean = value(from, at_s);
                    continue;
                }
                let (begin, end) = (value(from, ends[0]), value(to, ends[1]));
                let mut area = 0.5 * (begin + column[from + 1]) * (self.time_s[from + 1] - ends[0]);
                for i in from + 1..to {
                    area += 0.5 * (column[i] + column[i + 1]) * (self.time_s[i + 1] - self.time_s[i]);
                }
                area += 0.5 * (column[to] + end) * (ends[1] - self.time_s[to]);
                *mean = area / width_s;
            }
            take(k, Some(&row));
        }
    }

    /// The columns on a grid of `count` times from the first on, `step_s` apart, and whether each of its times has
    /// values; 0 where not.
    pub(super) fn on_grid(&self, step_s: f64, count: usize) -> (Vec<Vec<f64>>, Vec<bool>) {
        let mut columns = vec![vec![0.0; count]; self.columns.len()];
        let mut there = vec![false; count];
        // The outermost cells lie half outside.
        let at = (0..count).map(|k| self.first_s() + (k as f64 + 0.5) * step_s);
        self.means(at, if self.interval_s < 0.75 * step_s { step_s } else { 0.0 }, |k, row| {
            if let Some(row) = row {
                there[k] = true;
                for (column, value) in columns.iter_mut().zip(row) {
                    column[k] = *value;
                }
            }
        });
        (columns, there)
    }
}

/// A column of mean 0 and mean square 1; none if it is constant.
fn standard(column: &[f64]) -> Option<Vec<f64>> {
    let size = column.iter().fold(0.0, |size: f64, v| size.max(v.abs()));
    let mean = column.iter().sum::<f64>() / column.len() as f64;
    let square = column.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / column.len() as f64;
    let sd = square.sqrt();
    (sd > CONSTANT * size).then(|| column.iter().map(|v| (v - mean) / sd).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_missing_constant_or_double_is_left_out() {
        let time = [3.0, 1.0, 2.0, 2.0, f64::NAN, 4.0];
        let [a, b] = [[5.0, 1.0, 4.0, 9.0, 7.0, f64::NAN], [1.0; 6]];
        let series = Series::new(&time, &[&a, &b], "it").unwrap();
        assert_eq!((series.time_s.len(), series.columns.len()), (3, 1));
        assert!(Series::new(&time, &[&b], "it").unwrap_err().contains("nothing changes"));
        assert!(Series::new(&[], &[], "it").is_err());
    }

    #[test]
    fn means_are_those_of_straight_lines() {
        let time: Vec<f64> = (0..20).map(f64::from).collect();
        let series = Series { columns: vec![time.clone()], interval_s: 1.0, time_s: time };
        let mut got = Vec::new();
        series.means([0.5, 3.0, 18.9].into_iter(), 2.5, |_, row| got.push(row.map(|row| row[0])));
        assert_eq!(got[0], None);
        assert!((got[1].unwrap() - 3.0).abs() < 1e-12 && got[2].is_none());
    }
}
