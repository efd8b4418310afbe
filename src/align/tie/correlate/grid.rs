//! Two recordings on a common grid, and what each model explains of the channels at every lag of it.

use super::basis::Model;
use super::coarse::Coarse;
use super::drift::Drift;
use super::memory::Judge;
use super::series::Series;
use super::{LagSearch, Recording, channels, memory};

const MOST_ROWS: f64 = 16_384.0;
/// The grid is no finer than this, seconds.
const FINEST_S: f64 = 0.005;
/// Recordings shorter than this are not compared, seconds.
const SHORTEST_S: f64 = 5.0;
/// At least this share of the shorter recording overlaps.
const OVERLAP: f64 = 0.5;
/// Independent samples for each free number of a model, and how many free numbers there are.
const SAMPLES_EACH: f64 = 3.0;
const FREE: [f64; 2] = [2.0, 6.0];

/// A lag of the grid, the model that gains most there, and what it gains.
#[derive(Debug, Clone, Copy)]
pub(in crate::align::tie) struct Candidate {
    pub(in crate::align::tie) lag: i64,
    pub(super) model: usize,
    pub(in crate::align::tie) gain: f64,
    pub(in crate::align::tie) left: f64,
    /// Independent samples beyond the free numbers.
    pub(in crate::align::tie) samples: f64,
}

/// What is compared.
pub(in crate::align::tie) struct Grid {
    pub(super) video: Series,
    /// Principal components of the log's columns.
    pub(super) log: Series,
    /// The components on the grid, without drift, with straight lines over what is missing.
    pub(in crate::align::tie) channels: Vec<Vec<f64>>,
    pub(super) step_s: f64,
    /// The first and the last lag that are looked at.
    pub(super) lags: [i64; 2],
    pub(super) models: Vec<Model>,
    prepared: Vec<(Judge, Coarse)>,
}

impl Grid {
    /// # Errors
    /// Too little to compare, in words.
    pub(in crate::align::tie) fn new(
        video: Recording<'_>,
        log: Recording<'_>,
        search: &LagSearch,
    ) -> Result<Self, String> {
        let video = Series::new(video.time_s, video.columns, "the angles")?;
        let log = Series::new(log.time_s, log.columns, "the photodiodes")?;
        let shorter_s = video.span_s().min(log.span_s());
        if shorter_s < SHORTEST_S {
            return Err(format!(
                "{shorter_s:.1} s are too short to find a lag in; at least {SHORTEST_S} s in which the finger moves \
                 are needed"
            ));
        }
        let (log, weights) = channels::components(&log);
        let longer_s = video.span_s().max(log.span_s());
        let step_s = video.interval_s.max(log.interval_s).max(longer_s / MOST_ROWS).max(FINEST_S);
        let rows = |series: &Series| (series.span_s() / step_s) as usize;
        let (signals, video_there) = video.on_grid(step_s, rows(&video));
        let (mut channels, log_there) = log.on_grid(step_s, rows(&log));
        without_drift(&mut channels, &log_there, step_s);
        let channels = filled(channels, &log_there);
        let together_s = log.first_s() - video.first_s();
        let lags = lags(search, together_s, step_s, [rows(&video) as i64, rows(&log) as i64]);
        let seen = |there: &[bool]| there.iter().filter(|there| **there).count() as f64;
        let least_rows = (OVERLAP * seen(&video_there).min(seen(&log_there))).max(SHORTEST_S / step_s);
        let of_channels = memory::own(&channels, &weights);
        let judge = |regressors: &[Vec<f64>]| {
            let even = vec![1.0 / regressors.len() as f64; regressors.len()];
            let each_s = step_s * memory::rows_each(&memory::own(regressors, &even), &of_channels);
            Judge { each_s, free: (regressors.len() + channels.len() - 1) as f64 }
        };
        let mut straight = signals.clone();
        without_drift(&mut straight, &video_there, step_s);
        let samples = shorter_s / judge(&straight).each_s;
        let models = Model::all(&video.columns, (samples / SAMPLES_EACH).clamp(FREE[0], FREE[1]) as usize);
        let prepared: Vec<(Judge, Coarse)> = models
            .iter()
            .map(|model| {
                let regressors = regressors(model, &signals, &video_there, step_s);
                (judge(&regressors), Coarse::new(&regressors, &video_there, &log_there, lags, least_rows))
            })
            .collect();
        Ok(Self { video, log, channels, step_s, lags, models, prepared })
    }

    /// The offset of a lag: log time less video time, seconds.
    pub(in crate::align::tie) fn at_s(&self, lag: i64) -> f64 {
        self.log.first_s() - self.video.first_s() + lag as f64 * self.step_s
    }

    pub(super) fn judge(&self, model: usize) -> Judge {
        self.prepared[model].0
    }

    /// At each lag with enough overlap the model that gains most of `channels`.
    pub(in crate::align::tie) fn curve(&self, channels: &[Vec<f64>]) -> Vec<Candidate> {
        let mut best: Vec<Candidate> = Vec::new();
        for (model, (judge, coarse)) in self.prepared.iter().enumerate() {
            for at in coarse.explain(channels) {
                let overlap_s = at.rows * self.step_s;
                let (gain, samples) = (judge.gain(overlap_s, at.left), judge.samples(overlap_s));
                best.push(Candidate { lag: at.lag, model, gain, left: at.left, samples });
            }
        }
        best.sort_by(|a, b| a.lag.cmp(&b.lag).then(b.gain.total_cmp(&a.gain)).then(a.model.cmp(&b.model)));
        best.dedup_by_key(|at| at.lag);
        best
    }
}

/// The regressors of a model on the grid, without drift; 0 where there are none.
fn regressors(model: &Model, signals: &[Vec<f64>], there: &[bool], step_s: f64) -> Vec<Vec<f64>> {
    let mut columns = vec![vec![0.0; there.len()]; model.columns()];
    let (mut row, mut values) = (Vec::new(), Vec::new());
    for k in (0..there.len()).filter(|&k| there[k]) {
        row.clear();
        row.extend(signals.iter().map(|signal| signal[k]));
        values.clear();
        model.row(&row, &mut values);
        columns.iter_mut().zip(&values).for_each(|(column, v)| column[k] = *v);
    }
    without_drift(&mut columns, there, step_s);
    columns
}

/// Takes drift off columns on the grid where they have values.
fn without_drift(columns: &mut [Vec<f64>], there: &[bool], step_s: f64) {
    let rows: Vec<usize> = (0..there.len()).filter(|&k| there[k]).collect();
    let drift = Drift::new(&rows.iter().map(|&k| k as f64 * step_s).collect::<Vec<f64>>());
    for column in columns {
        let mut values: Vec<f64> = rows.iter().map(|&k| column[k]).collect();
        drift.take_off(&mut values);
        rows.iter().zip(values).for_each(|(&k, v)| column[k] = v);
    }
}

/// The lags to look at, in steps of the grid.
fn lags(search: &LagSearch, together_s: f64, step_s: f64, rows: [i64; 2]) -> [i64; 2] {
    let all = [-rows[0], rows[1]];
    let middle = search.about_s.map_or(0.0, |about_s| (about_s - together_s) / step_s);
    match search.most_s {
        Some(most_s) => {
            let ends = [middle - most_s / step_s, middle + most_s / step_s];
            [all[0].max(ends[0].floor() as i64), all[1].min(ends[1].ceil() as i64)]
        }
        None => all,
    }
}

/// Signals with straight lines over what is missing, for what needs whole sequences.
fn filled(mut signals: Vec<Vec<f64>>, there: &[bool]) -> Vec<Vec<f64>> {
    for signal in &mut signals {
        let mut last: Option<usize> = None;
        for k in (0..signal.len()).filter(|&k| there[k]) {
            if let Some(last) = last.filter(|&last| last + 1 < k) {
                let (from, to) = (signal[last], signal[k]);
                for (i, v) in signal[last + 1..k].iter_mut().enumerate() {
                    *v = from + (to - from) * (i + 1) as f64 / (k - last) as f64;
                }
            }
            last = Some(k);
        }
    }
    signals
}
