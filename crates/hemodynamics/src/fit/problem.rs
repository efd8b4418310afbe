//! Recordings, free parameters and the model as one problem of least squares.

use std::ops::Range;

use super::FitFault;
use super::free::{Coordinate, Free};
use super::noise::{Noise, Slow};
use super::options::{Calibration, FitOptions};
use super::recording::{Course, Recording};
use super::response::{NoResponse, Responder, Response};
use crate::fit::algebra::calibrate::{Fitted, calibrate};
use crate::fit::algebra::levenberg::Point;
use crate::fit::algebra::qr;
use crate::model::{Model, Tangent};
use crate::optics::Photodiodes;
use crate::parameters::{Parameters, Site, Symbol};

/// The values of one photodiode in one recording that are not missing.
pub(super) struct Channel {
    pub(super) recording: usize,
    /// Its place in the recording.
    pub(super) trace: usize,
    pub(super) unit: usize,
    pub(super) samples: Vec<usize>,
    weight: f64,
    key: Key,
    /// Its run of rows.
    pub(super) rows: Range<usize>,
    /// The slow noise that was found; `None` where it was not looked for.
    pub(super) slow: Option<Slow>,
    /// What makes its rows white; `None` where they are taken as they are.
    pub(super) whitening: Option<Whitening>,
}

/// What makes a channel's rows white, and as large as before.
pub(super) struct Whitening {
    pub(super) noise: Noise,
    /// What its rows are divided by.
    pub(super) size: f64,
    /// By how much the variance of its rows was overstated in that: its recording's channels share their slow noise,
    /// which is of another shape than those that are known.
    pub(super) shared: f64,
}

/// Channels of the same unit with the same key have the same offset and scaling.
#[derive(Clone, Debug, PartialEq)]
enum Key {
    All,
    Subject(String),
    Recording(usize),
}

/// A unit's photodiode with offset and scaling of its own: a run of rows.
pub(super) struct Diode {
    pub(super) unit: usize,
    pub(super) recordings: Vec<usize>,
    pub(super) rows: Range<usize>,
}

pub(super) struct Problem<'a> {
    recordings: &'a [Recording],
    pub(super) start: &'a Parameters,
    pub(super) coordinates: Vec<Coordinate>,
    pub(super) options: &'a FitOptions,
    pub(super) channels: Vec<Channel>,
    pub(super) diodes: Vec<Diode>,
    /// Weights and weighted voltages of all rows.
    pub(super) weights: Vec<f64>,
    pub(super) target: Vec<f64>,
    pub(super) responder: Responder,
    pub(super) points: u64,
    pub(super) refused: u64,
}

/// The problem at a point.
pub(super) struct Evaluation {
    at: Vec<f64>,
    /// Whitened, as the columns are.
    residuals: Vec<f64>,
    /// Residuals (weighted) and signals as they are.
    pub(super) misses: Vec<f64>,
    pub(super) signals: Vec<f64>,
    columns: Vec<Vec<f64>>,
    /// Largest norm of a column before offsets and scalings follow.
    pub(super) raw: f64,
    pub(super) parameters: Parameters,
    /// Of each diode; empty where calibration is fixed.
    pub(super) fitted: Vec<Fitted>,
}

impl Point for Evaluation {
    fn at(&self) -> &[f64] {
        &self.at
    }
    fn residuals(&self) -> &[f64] {
        &self.residuals
    }
    fn columns(&self) -> &[Vec<f64>] {
        &self.columns
    }
}

impl<'a> Problem<'a> {
    pub(super) fn new(
        recordings: &'a [Recording],
        start: &'a Parameters,
        free: &[Free],
        options: &'a FitOptions,
    ) -> Result<Problem<'a>, FitFault> {
        options.check()?;
        if recordings.is_empty() {
            return Err(FitFault::NoRecordings);
        }
        Photodiodes::new(start, &options.optics)?;
        let calibrated = options.calibration != Calibration::Fixed;
        if free.is_empty() && !calibrated {
            return Err(FitFault::NothingFree);
        }
        let mut seen: Vec<Symbol> = vec![];
        for &symbol in free.iter().flat_map(|group| &group.symbols) {
            if seen.contains(&symbol) {
                return Err(FitFault::Twice { symbol });
            }
            if calibrated && matches!(symbol, Symbol::Offset(_) | Symbol::Scaling(_)) {
                return Err(FitFault::Calibrated { symbol });
            }
            seen.push(symbol);
        }
        for (k, recording) in recordings.iter().enumerate() {
            recording.check(k, start.units().len())?;
        }
        let mut channels = channels(recordings, options.calibration);
        let (diodes, weights, target) = rows(recordings, &mut channels);
        let volts = channels.iter().flat_map(|channel| voltages(recordings, channel));
        let [least, most] = volts.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(v), b.max(v)]);
        let range_v = if most > least { most - least } else { 1.0 };
        let coordinates: Vec<Coordinate> =
            free.iter().map(|group| Coordinate::new(group, start, range_v)).collect::<Result<_, _>>()?;
        let unknowns = coordinates.len() + if calibrated { 2 * diodes.len() } else { 0 };
        if target.len() <= unknowns {
            return Err(FitFault::TooFew { values: target.len(), unknowns });
        }
        Ok(Problem {
            recordings,
            start,
            coordinates,
            options,
            channels,
            diodes,
            weights,
            target,
            responder: Responder::new(options.rtol),
            points: 0,
            refused: 0,
        })
    }

    /// The parameters at a point, or `None` where there are none.
    fn parameters(&self, at: &[f64]) -> Option<Parameters> {
        let mut parameters = self.start.clone();
        for (coordinate, &at) in self.coordinates.iter().zip(at) {
            for (&symbol, value) in coordinate.symbols.iter().zip(coordinate.values(at)) {
                parameters = parameters.set(symbol, value).ok()?;
            }
        }
        Some(parameters)
    }

    /// Residuals and their derivatives at a point. An error says in which recording (from 0) the model has no response,
    /// and why.
    pub(super) fn evaluate(&mut self, at: &[f64]) -> Result<Evaluation, (usize, String)> {
        self.points += 1;
        self.respond(at).inspect_err(|_| self.refused += 1)
    }

    fn respond(&mut self, at: &[f64]) -> Result<Evaluation, (usize, String)> {
        let parameters = self.parameters(at).ok_or((0, "a parameter grows out of all numbers".to_owned()))?;
        let model = Model::new(&parameters, self.options.collapse);
        let optics = Photodiodes::new(&parameters, &self.options.optics).map_err(|fault| (0, fault.to_string()))?;
        let speeds: Vec<Vec<(Symbol, f64)>> = self
            .coordinates
            .iter()
            .zip(at)
            .map(|(coordinate, &at)| coordinate.symbols.iter().copied().zip(coordinate.speeds(at)).collect())
            .collect();
        let tangents: Vec<Tangent> = speeds.iter().map(|speeds| Tangent::new(&parameters, speeds)).collect();
        let mut responses: Vec<Option<Response>> = self.recordings.iter().map(|_| None).collect();
        let mut signals = Vec::with_capacity(self.target.len());
        let mut columns = vec![Vec::with_capacity(self.target.len()); at.len()];
        for channel in &self.channels {
            let k = channel.recording;
            let response = match &mut responses[k] {
                Some(response) => response,
                none => {
                    let response = self.responder.respond(&parameters, &model, &tangents, &self.recordings[k]);
                    none.insert(response.map_err(|why: NoResponse| (k, why.to_string()))?)
                }
            };
            let unit = channel.unit;
            for &sample in &channel.samples {
                signals.push(optics.signal(unit, response.lumen(sample, unit)));
            }
            for (q, (column, speeds)) in columns.iter_mut().zip(&speeds).enumerate() {
                let absorbance: f64 =
                    speeds.iter().map(|(symbol, speed)| speed * by_symbol(&parameters, *symbol, unit)).sum();
                for &sample in &channel.samples {
                    let lumen = response.lumen(sample, unit);
                    let slope = optics.signal_slope(unit, lumen) * response.derivative(sample, q, unit);
                    let direct =
                        if absorbance == 0.0 { 0.0 } else { absorbance * optics.signal_by_absorbance(unit, lumen) };
                    column.push(channel.weight * (slope + direct));
                }
            }
        }
        if signals.iter().chain(columns.iter().flatten()).any(|value| !value.is_finite()) {
            return Err((0, "a photodiode's signal is not a finite number".to_owned()));
        }
        let found = self.assemble(at, parameters, signals, columns, &speeds);
        let calibrated = found.fitted.iter().flat_map(|one| [one.offset_v, one.scaling_v]);
        let mut numbers = found.residuals.iter().chain(found.columns.iter().flatten()).copied().chain(calibrated);
        if numbers.any(|value| !value.is_finite()) {
            return Err((0, "a photodiode hardly changes, so that its scaling grows out of all numbers".to_owned()));
        }
        Ok(found)
    }

    /// Times of a channel's samples, s; `None` in equilibrium.
    pub(super) fn times_s(&self, channel: &Channel) -> Option<Vec<f64>> {
        match &self.recordings[channel.recording].course {
            Course::Transient { times_s, .. } => Some(channel.samples.iter().map(|&sample| times_s[sample]).collect()),
            Course::Static { .. } => None,
        }
    }

    /// The mean of both loads at a channel's samples, Pa.
    pub(super) fn loads_pa(&self, channel: &Channel) -> Vec<f64> {
        let of = |sample: usize| match &self.recordings[channel.recording].course {
            Course::Transient { times_s, proximal, distal, .. } => {
                0.5 * (proximal.at(times_s[sample]) + distal.at(times_s[sample]))
            }
            Course::Static { proximal_pa, distal_pa } => 0.5 * (proximal_pa[sample] + distal_pa[sample]),
        };
        channel.samples.iter().map(|&sample| of(sample)).collect()
    }

    /// The slow noise of each photodiode of each recording.
    pub(super) fn noises(&self) -> Vec<Vec<Option<Slow>>> {
        let mut noises: Vec<_> = self.recordings.iter().map(|one| vec![None; one.photodiodes.len()]).collect();
        self.channels.iter().for_each(|channel| noises[channel.recording][channel.trace] = channel.slow);
        noises
    }

    /// Makes the noise of all rows white.
    fn whiten(&self, rows: &mut [f64]) {
        for channel in &self.channels {
            if let Some(by) = &channel.whitening {
                let rows = &mut rows[channel.rows.clone()];
                by.noise.whiten(rows);
                rows.iter_mut().for_each(|value| *value /= by.size);
            }
        }
    }

    /// The variance of the noise about a point, in which whitened rows are equal.
    pub(super) fn variance(&self, of: &Evaluation, freedom: usize) -> f64 {
        let squares = |channel: &Channel| {
            let residuals = &of.residuals[channel.rows.clone()];
            channel.whitening.as_ref().map_or(1.0, |by| by.shared) * qr::dot(residuals, residuals)
        };
        self.channels.iter().map(squares).sum::<f64>() / freedom as f64
    }

    pub(super) fn recordings(&self) -> usize {
        self.recordings.len()
    }

    /// Derivatives of the signals (weighted) about a point as columns like its own.
    pub(super) fn as_columns(&self, about: &Evaluation, derivatives: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
        let moved = vec![Vec::new(); derivatives.len()];
        let (parameters, signals) = (about.parameters.clone(), about.signals.clone());
        self.assemble(&about.at, parameters, signals, derivatives, &moved).columns
    }

    /// From signals and their derivatives (weighted) to residuals and the derivatives of the fitted voltages.
    fn assemble(
        &self,
        at: &[f64],
        parameters: Parameters,
        signals: Vec<f64>,
        mut columns: Vec<Vec<f64>>,
        speeds: &[Vec<(Symbol, f64)>],
    ) -> Evaluation {
        let weighted: Vec<f64> = self.weights.iter().zip(&signals).map(|(w, f)| w * f).collect();
        let (mut residuals, mut ones, mut white) = (self.target.clone(), self.weights.clone(), weighted.clone());
        [&mut residuals, &mut ones, &mut white].into_iter().chain(&mut columns).for_each(|rows| self.whiten(rows));
        let mut misses = self.target.clone();
        let mut raw = vec![0.0; columns.len()];
        let mut fitted = vec![];
        for diode in &self.diodes {
            let rows = diode.rows.clone();
            let (ones, white) = (&ones[rows.clone()], &white[rows.clone()]);
            let target = &mut residuals[rows.clone()];
            let unit = &parameters.units()[diode.unit];
            let squares: Vec<f64> = columns.iter().map(|column| qr::norm(&column[rows.clone()])).collect();
            let mut parts: Vec<&mut [f64]> = columns.iter_mut().map(|column| &mut column[rows.clone()]).collect();
            let [offset, scaling] = if self.options.calibration == Calibration::Fixed {
                minus(target, [unit.offset_v, unit.scaling_v], ones, white);
                let columns = parts.iter_mut().zip(speeds);
                columns.for_each(|(column, speeds)| held(column, diode.unit, unit.scaling_v, speeds, [ones, white]));
                [unit.offset_v, unit.scaling_v]
            } else {
                let found = calibrate(ones, white, target, &mut parts, unit.scaling_v);
                let both = [found.offset_v, found.scaling_v];
                fitted.push(found);
                both
            };
            minus(&mut misses[rows.clone()], [offset, scaling], &self.weights[rows.clone()], &weighted[rows]);
            for (raw, square) in raw.iter_mut().zip(squares) {
                *raw = (*raw * *raw + (square * scaling) * (square * scaling)).sqrt();
            }
        }
        let raw = raw.into_iter().fold(0.0, f64::max);
        Evaluation { at: at.to_vec(), residuals, misses, signals, columns, raw, parameters, fitted }
    }
}

/// Takes what an offset and a scaling make out of a run of rows.
fn minus(rows: &mut [f64], [offset, scaling]: [f64; 2], ones: &[f64], signals: &[f64]) {
    for ((value, one), signal) in rows.iter_mut().zip(ones).zip(signals) {
        *value -= offset * one + scaling * signal;
    }
}

/// From the derivative of a unit's signal to that of its voltage, where offset and scaling do not follow.
fn held(column: &mut [f64], unit: usize, scaling_v: f64, speeds: &[(Symbol, f64)], [ones, signals]: [&[f64]; 2]) {
    column.iter_mut().for_each(|value| *value *= scaling_v);
    for &(symbol, speed) in speeds {
        if symbol == Symbol::Offset(unit) {
            minus(column, [-speed, 0.0], ones, signals);
        } else if symbol == Symbol::Scaling(unit) {
            minus(column, [0.0, -speed], ones, signals);
        }
    }
}

/// The logarithmic derivative of a unit's absorbance `alpha D^2` (equation 7) by a parameter.
fn by_symbol(parameters: &Parameters, symbol: Symbol, unit: usize) -> f64 {
    let of = parameters.units()[unit];
    let here = Site::Capillary(unit);
    match symbol {
        Symbol::Diameter(site) if site == here => 2.0 / of.capillary.diameter_m,
        Symbol::Count(site) if site == here => 1.0 / of.capillary.count,
        Symbol::Length(site) if site == here => 1.0 / of.capillary.length_m,
        Symbol::Path(i) if i == unit => 1.0 / of.path_m,
        Symbol::Tissue(i) if i == unit => -1.0 / of.tissue_m3,
        Symbol::Absorption => 1.0 / parameters.absorption_per_m(),
        _ => 0.0,
    }
}

/// The photodiodes of all recordings, those with the same offset and scaling next to each other, in the order of their
/// first.
fn channels(recordings: &[Recording], calibration: Calibration) -> Vec<Channel> {
    let mut channels: Vec<Channel> = vec![];
    let noises = recordings.iter().flat_map(|recording| &recording.photodiodes).map(|trace| trace.noise_v);
    let quietest = noises.fold(f64::INFINITY, f64::min);
    for (k, recording) in recordings.iter().enumerate() {
        let key = match (calibration, &recording.subject) {
            (Calibration::PerSubject, Some(subject)) => Key::Subject(subject.clone()),
            (Calibration::PerSubject, None) | (Calibration::PerRecording, _) => Key::Recording(k),
            (Calibration::Fixed | Calibration::Shared, _) => Key::All,
        };
        for (place, trace) in recording.photodiodes.iter().enumerate() {
            let samples = (0..trace.voltages_v.len()).filter(|&row| !trace.voltages_v[row].is_nan()).collect();
            let (unit, weight) = (trace.unit, quietest / trace.noise_v);
            let channel = Channel {
                recording: k,
                trace: place,
                unit,
                samples,
                weight,
                key: key.clone(),
                rows: 0..0,
                slow: None,
                whitening: None,
            };
            let like = channels.iter().rposition(|other| other.unit == unit && other.key == channel.key);
            channels.insert(like.map_or(channels.len(), |at| at + 1), channel);
        }
    }
    channels
}

/// The voltages of a channel; where a recording has a unit's photodiode twice, both count.
fn voltages<'a>(recordings: &'a [Recording], channel: &'a Channel) -> impl Iterator<Item = f64> + 'a {
    let trace = &recordings[channel.recording].photodiodes[channel.trace];
    channel.samples.iter().map(|&row| trace.voltages_v[row])
}

fn rows(recordings: &[Recording], channels: &mut [Channel]) -> (Vec<Diode>, Vec<f64>, Vec<f64>) {
    let (mut diodes, mut weights, mut target): (Vec<Diode>, Vec<f64>, Vec<f64>) = Default::default();
    for k in 0..channels.len() {
        let channel = &channels[k];
        let begin = target.len();
        target.extend(voltages(recordings, channel).map(|volts| channel.weight * volts));
        weights.resize(target.len(), channel.weight);
        let like = k > 0 && channels[k - 1].unit == channel.unit && channels[k - 1].key == channel.key;
        match diodes.last_mut().filter(|_| like) {
            Some(diode) => {
                diode.rows.end = target.len();
                if !diode.recordings.contains(&channel.recording) {
                    diode.recordings.push(channel.recording);
                }
            }
            None => diodes.push(Diode {
                unit: channel.unit,
                recordings: vec![channel.recording],
                rows: begin..target.len(),
            }),
        }
        channels[k].rows = begin..target.len();
    }
    (diodes, weights, target)
}
