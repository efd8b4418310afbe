//! Long series of the same rows thinned for a picture: bins of equal numbers of rows that keep the extremes, at most
//! [`MOST_BINS`] of them.
//!
//! Rows are fed one after the other, a value a series or none. When the bins are full, neighbours are joined and a bin
//! holds twice the rows; so memory does not grow with the series, and no peak is lost.

/// More bins than a picture has columns.
pub const MOST_BINS: usize = 2048;

/// A row's value with its time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Along the horizontal axis, seconds.
    pub time_s: f64,
    /// In the series' unit.
    pub value: f64,
    /// Its standard error; NaN where it is not known.
    pub sd: f64,
}

/// What the rows of a bin hold of one series.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Summary {
    /// The lowest value.
    pub lowest: Sample,
    /// The highest value.
    pub highest: Sample,
    /// The ends of the bands of plus or minus a standard error; NaN where none is known.
    pub band: [f64; 2],
    /// The largest standard error; NaN where none is known.
    pub largest_sd: f64,
}

impl Summary {
    fn of(sample: Sample) -> Self {
        let band = [sample.value - sample.sd, sample.value + sample.sd];
        Self { lowest: sample, highest: sample, band, largest_sd: sample.sd }
    }

    fn joined(self, other: Self) -> Self {
        Self {
            lowest: if other.lowest.value < self.lowest.value { other.lowest } else { self.lowest },
            highest: if other.highest.value > self.highest.value { other.highest } else { self.highest },
            band: [self.band[0].min(other.band[0]), self.band[1].max(other.band[1])],
            largest_sd: self.largest_sd.max(other.largest_sd),
        }
    }
}

/// Neighbouring rows.
#[derive(Debug, Clone, PartialEq)]
pub struct Bin {
    /// The first row's time, seconds.
    pub from_s: f64,
    /// The last row's time, seconds.
    pub to_s: f64,
    rows: usize,
    /// Rows in which a value is missing.
    pub lacking: usize,
    /// Each series; none where all rows lack it.
    pub series: Vec<Option<Summary>>,
}

impl Bin {
    /// Takes the rows after its own; those of a bin without a time of its own are counted to it.
    fn join(&mut self, next: Self) {
        self.to_s = next.to_s;
        self.rows += next.rows;
        self.lacking += next.lacking;
        for (own, next) in self.series.iter_mut().zip(next.series) {
            *own = match (*own, next) {
                (Some(a), Some(b)) => Some(a.joined(b)),
                (a, b) => a.or(b),
            };
        }
    }
}

/// The bins of all series.
#[derive(Debug, Clone)]
pub struct Thinned {
    bins: Vec<Bin>,
    rows_a_bin: usize,
    most: usize,
}

impl Default for Thinned {
    fn default() -> Self {
        Self::of_at_most(MOST_BINS)
    }
}

impl Thinned {
    /// At most `most` bins, and at least two.
    #[must_use]
    pub fn of_at_most(most: usize) -> Self {
        Self { bins: Vec::new(), rows_a_bin: 1, most: most.max(2) }
    }

    /// Takes a row: of each series the value and its standard error. Times ascend.
    pub fn push(&mut self, time_s: f64, values: impl Iterator<Item = Option<[f64; 2]>>) {
        let series: Vec<Option<Summary>> =
            values.map(|known| known.map(|[value, sd]| Summary::of(Sample { time_s, value, sd }))).collect();
        let bin = Bin {
            from_s: time_s,
            to_s: time_s,
            rows: 1,
            lacking: usize::from(series.iter().any(Option::is_none)),
            series,
        };
        self.append(bin);
        if self.bins.len() > self.most {
            self.rows_a_bin *= 2;
            std::mem::take(&mut self.bins).into_iter().for_each(|bin| self.append(bin));
        }
    }

    /// Takes the rows of a bin, into the last one where they have room there.
    fn append(&mut self, bin: Bin) {
        match self.bins.last_mut() {
            Some(last) if last.rows + bin.rows <= self.rows_a_bin => last.join(bin),
            _ => self.bins.push(bin),
        }
    }

    /// Bins after each other in which the series is known.
    fn runs(&self, series: usize) -> impl Iterator<Item = &[Bin]> {
        self.bins.split(move |b| b.series[series].is_none()).filter(|run| !run.is_empty())
    }

    /// The curve of a series: of each bin the lowest and the highest value in the order of time. A new piece after
    /// every gap.
    #[must_use]
    pub fn curve(&self, series: usize) -> Vec<Vec<[f64; 2]>> {
        self.runs(series).map(|run| run.iter().flat_map(|bin| extremes(bin, series)).collect()).collect()
    }

    /// The band of plus or minus a standard error: pieces of time, low, high.
    #[must_use]
    pub fn band(&self, series: usize) -> Vec<Vec<[f64; 3]>> {
        self.pieces(series, |s| (s.band[0] <= s.band[1]).then_some(s.band))
            .map(|piece| piece.into_iter().map(|(time_s, [low, high])| [time_s, low, high]).collect())
            .collect()
    }

    /// The largest standard error: pieces of time and error.
    #[must_use]
    pub fn largest_sd(&self, series: usize) -> Vec<Vec<[f64; 2]>> {
        let known = |s: &Summary| Some(s.largest_sd).filter(|sd| sd.is_finite());
        self.pieces(series, known).map(|piece| piece.into_iter().map(|(t, sd)| [t, sd]).collect()).collect()
    }

    /// Something of the bins' middles, in pieces.
    fn pieces<V>(&self, series: usize, of: impl Fn(&Summary) -> Option<V>) -> impl Iterator<Item = Vec<(f64, V)>> {
        let at = move |b: &Bin| Some((0.5 * (b.from_s + b.to_s), of(b.series[series].as_ref()?)?));
        let mut pieces = vec![Vec::new()];
        for bin in &self.bins {
            match (at(bin), pieces.last_mut()) {
                (Some(point), Some(piece)) => piece.push(point),
                (Some(point), None) => pieces.push(vec![point]),
                (None, _) => pieces.push(Vec::new()),
            }
        }
        pieces.into_iter().filter(|piece| !piece.is_empty())
    }

    /// Where a value is missing, from half way to the row before to half way to the row after.
    #[must_use]
    pub fn lacking(&self) -> Vec<[f64; 2]> {
        let bins = &self.bins;
        let mut spans: Vec<[f64; 2]> = Vec::new();
        for (k, bin) in bins.iter().enumerate().filter(|(_, b)| b.lacking > 0) {
            let from = if k > 0 { 0.5 * (bins[k - 1].to_s + bin.from_s) } else { bin.from_s };
            let to = bins.get(k + 1).map_or(bin.to_s, |next| 0.5 * (bin.to_s + next.from_s));
            match spans.last_mut() {
                Some(last) if last[1] >= from => last[1] = to,
                _ => spans.push([from, to]),
            }
        }
        spans
    }
}

/// The lowest and the highest value of a bin in the order of time; one point where they are one.
fn extremes(bin: &Bin, series: usize) -> Vec<[f64; 2]> {
    let Some(summary) = bin.series[series] else { return Vec::new() };
    let (mut first, mut second) = (summary.lowest, summary.highest);
    if second.time_s < first.time_s {
        std::mem::swap(&mut first, &mut second);
    }
    let mut points = vec![[first.time_s, first.value]];
    if second.time_s != first.time_s || second.value != first.value {
        points.push([second.time_s, second.value]);
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    fn known(value: f64) -> Option<[f64; 2]> {
        Some([value, 0.1])
    }

    #[test]
    fn a_short_series_is_kept_row_by_row() {
        let mut thinned = Thinned::default();
        for k in 0..MOST_BINS {
            thinned.push(k as f64, [if k == 5 { None } else { known(k as f64) }].into_iter());
        }
        assert_eq!(thinned.bins.len(), MOST_BINS);
        assert_eq!((thinned.bins[5].series[0], thinned.bins[5].lacking), (None, 1));
        assert!((thinned.bins[7].series[0].unwrap().highest.value - 7.0).abs() < 1e-12);
    }

    #[test]
    fn a_long_series_keeps_its_extremes_in_few_bins() {
        let mut thinned = Thinned::default();
        let rows = 100_003;
        for k in 0..rows {
            let deg = match k {
                3 => -400.0,
                77_777 => 500.0,
                _ => (k % 100) as f64,
            };
            thinned.push(k as f64, [known(deg), if k % 1000 == 0 { None } else { known(1.0) }].into_iter());
        }
        let bins = &thinned.bins;
        assert!(bins.len() <= MOST_BINS && bins.len() > MOST_BINS / 2 - 2, "{}", bins.len());
        let highest = bins.iter().filter_map(|b| b.series[0]).map(|s| s.highest.value).fold(f64::MIN, f64::max);
        let lowest = bins.iter().filter_map(|b| b.series[0]).map(|s| s.lowest.value).fold(f64::MAX, f64::min);
        assert!((highest - 500.0).abs() < 1e-9 && (lowest + 400.0).abs() < 1e-9);
        assert_eq!(bins.iter().map(|b| b.rows).sum::<usize>(), rows);
        assert_eq!(bins.iter().map(|b| b.lacking).sum::<usize>(), 101);
        assert!(bins.windows(2).all(|w| w[0].to_s < w[1].from_s));
    }

    #[test]
    fn a_piece_ends_where_nothing_is_known_and_an_error_may_be_unknown() {
        let mut thinned = Thinned::default();
        for k in 0..9 {
            let value = [Some([1.0, 0.1]), Some([2.0, f64::NAN]), None][k % 9 / 3];
            thinned.push(k as f64, [value].into_iter());
        }
        assert_eq!(thinned.curve(0), [[[0.0, 1.0], [1.0, 1.0], [2.0, 1.0], [3.0, 2.0], [4.0, 2.0], [5.0, 2.0]]]);
        assert_eq!(thinned.band(0), [[0.0, 1.0, 2.0].map(|t| [t, 0.9, 1.1])]);
        assert_eq!(thinned.largest_sd(0), [[0.0, 1.0, 2.0].map(|t| [t, 0.1])]);
        assert_eq!(thinned.lacking(), [[5.5, 8.0]]);
        assert!(Thinned::default().lacking().is_empty());
    }
}
