//! The reduced model from breakpoint to breakpoint by an explicit method with steps chosen by the tolerance.

use super::Inertia;
use super::flow::Flow;
use super::layer::Layer;
use super::neglected::Neglected;
use super::pair::{A, C, Curve, ERROR, STAGES};
use crate::load::{Loads, Segment};
use crate::model::Model;
use crate::radau::root;
use crate::state::State;
use crate::transient::Statistics;

/// A step's error estimate is kept below this part of the tolerance where that is [`COARSE`], and below less of it where it is finer, by the
/// sixth root: there are more steps then, whose errors add up. Measured over the reference cases: 0.3 to 0.9 of the tolerance.
const SHARE: f64 = 0.15;
const COARSE: f64 = 1e-3;

/// Steps below this (s) in which a vessel closes find the moment of closing.
const CLOSING_S: f64 = 1e-10;

/// Steps times the largest eigenvalue above which stability rules them; the method is stable up to 3.3.
const STABLE: f64 = 2.0;

/// Of the step that would just hold the tolerance.
const SAFETY: f64 = 0.9;

/// Where and why a run ended early.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Halt {
    /// Wall, time.
    Closed(usize, f64),
    /// Time; the steps are short for stability, not for accuracy.
    Work(f64, bool),
    /// Time, step.
    Stuck(f64, f64),
    /// As [`crate::SolveFault::Load`].
    Load { load: &'static str, time_s: f64, value: f64 },
    /// The layer's integral closes a wall: wall, time.
    Layer(usize, f64),
}

/// What a run is bounded by.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    pub(super) rtol: f64,
    pub(super) most_evaluations: u64,
    pub(super) longest_step_s: f64,
}

impl Bounds {
    /// What a step's error estimate is kept below.
    fn step(&self) -> f64 {
        SHARE * self.rtol * root((self.rtol / COARSE).min(1.0), 6)
    }
}

/// A run with its memory.
pub(super) struct Run<'a> {
    model: &'a Model,
    flow: Flow,
    corrected: bool,
    bounds: Bounds,
    lumens: Vec<f64>,
    next: Vec<f64>,
    /// The rates of the stage just made.
    stage: Vec<f64>,
    /// The lumens of the last stage but one.
    before: Vec<f64>,
    /// The rates of each wall at all stages.
    rates: Vec<[f64; STAGES]>,
    /// The rates that the walls come to a breakpoint with.
    came: Vec<f64>,
    curves: Vec<Curve>,
    layers: Vec<Layer>,
    neglected: Neglected,
    pub(super) statistics: Statistics,
    /// The longest step in this segment, s.
    longest_step_s: f64,
    /// The next step's size, s; 0 where nothing is known of it.
    step_s: f64,
    /// What a step's error estimate is kept below.
    tolerance: f64,
    /// The largest eigenvalue at the last step's end, 1/s.
    fastest: f64,
}

impl<'a> Run<'a> {
    pub(super) fn new(model: &'a Model, inertia: Inertia, bounds: Bounds) -> Run<'a> {
        let walls = model.walls();
        let zeros = || vec![0.0; walls];
        Run {
            model,
            flow: Flow::new(model, inertia == Inertia::Corrected),
            corrected: inertia == Inertia::Corrected,
            bounds,
            lumens: zeros(),
            next: zeros(),
            stage: zeros(),
            before: zeros(),
            rates: vec![[0.0; STAGES]; walls],
            came: zeros(),
            curves: vec![Curve::default(); walls],
            layers: vec![],
            neglected: Neglected::new(walls),
            statistics: Statistics { smallest_step_s: f64::INFINITY, ..Statistics::default() },
            longest_step_s: f64::INFINITY,
            step_s: 0.0,
            tolerance: bounds.step(),
            fastest: 0.0,
        }
    }

    /// The model's error so far, in nominal diameters.
    pub(super) fn model_error(&self) -> f64 {
        self.neglected.worst()
    }

    /// From `start` at `from_s` over all times (growing, none before `from_s`), each handed to `sample` with lumens and rates.
    pub(super) fn over(
        &mut self,
        loads: &Loads,
        start: &State,
        from_s: f64,
        times_s: &[f64],
        mut sample: impl FnMut(f64, &[f64], &[f64]),
    ) -> Result<(), Halt> {
        let Some(&to_s) = times_s.last() else { return Ok(()) };
        self.lumens.copy_from_slice(&start.lumens);
        self.came.copy_from_slice(&start.rates);
        let mut left = times_s.iter().copied().take_while(|&time| time <= from_s).count();
        for &time in &times_s[..left] {
            sample(time, &start.lumens, &start.rates);
        }
        let mut inputs = None;
        for segment in loads.segments(from_s, to_s) {
            let begins = segment.at(segment.from_s);
            self.begin(&segment, inputs != Some(begins))?;
            let mut time_s = segment.from_s;
            while time_s < segment.to_s {
                let step_s = self.step(&segment, time_s)?;
                let end_s = if step_s >= segment.to_s - time_s { segment.to_s } else { time_s + step_s };
                while left < times_s.len() && times_s[left] <= end_s {
                    self.interpolate(times_s[left], time_s, end_s - time_s);
                    if let Some(wall) = self.next.iter().position(|lumen| *lumen <= 0.0) {
                        return Err(Halt::Closed(wall, times_s[left]));
                    }
                    sample(times_s[left], &self.next, &self.stage);
                    left += 1;
                }
                time_s = end_s;
            }
            inputs = Some(segment.at(segment.to_s));
            for (came, rates) in self.came.iter_mut().zip(&self.rates) {
                *came = rates[STAGES - 1];
            }
        }
        Ok(())
    }

    /// Begins a segment: the layer, the first stage, the first step's size.
    fn begin(&mut self, segment: &Segment, jumps: bool) -> Result<(), Halt> {
        let time_s = segment.from_s;
        if let Some((load, value)) = segment.at(time_s).not_finite() {
            return Err(Halt::Load { load, time_s, value });
        }
        self.layers.retain(|layer| layer.until_s > time_s);
        self.flow.enter(segment);
        self.flow.rates(segment, time_s, &self.lumens, &mut self.stage);
        let mut jump = None;
        if jumps {
            let excess =
                |slow: &[f64], came: &[f64]| -> Vec<f64> { came.iter().zip(slow).map(|(a, b)| a - b).collect() };
            let mut moved = excess(&self.stage, &self.came);
            if self.corrected {
                self.layers.push(Layer::new(self.model, &self.flow.drag, time_s, &moved));
            }
            self.flow.drag.respond(0.0, &mut moved);
            if self.corrected {
                for (lumen, moved) in self.lumens.iter_mut().zip(&moved) {
                    *lumen += moved;
                }
                if let Some(wall) = self.lumens.iter().position(|lumen| lumen.is_nan() || *lumen <= 0.0) {
                    return Err(Halt::Layer(wall, time_s));
                }
                // The second order of the layer's integral is as large as what the first order changes at the layer's other end.
                self.flow.rates(segment, time_s, &self.lumens, &mut self.stage);
                let mut again = excess(&self.stage, &self.came);
                self.flow.drag.respond(0.0, &mut again);
                for (moved, again) in moved.iter_mut().zip(again) {
                    *moved = again - *moved;
                }
            }
            jump = Some(moved);
        }
        self.put(0);
        self.flow.correct(segment, time_s, &self.lumens);
        self.neglected.begin(&self.flow, jump.as_deref());
        self.statistics.evaluations += 1;
        self.longest_step_s = self.bounds.longest_step_s.min(segment.longest_step_s());
        if jumps || self.step_s == 0.0 {
            self.first_step(segment);
        }
        Ok(())
    }

    /// Takes what stands in `stage` as the rates of a stage.
    fn put(&mut self, stage: usize) {
        for (rates, value) in self.rates.iter_mut().zip(&self.stage) {
            rates[stage] = *value;
        }
    }

    /// The size of a first step: one that an Euler step tells (Hairer, Norsett, Wanner, section II.4).
    fn first_step(&mut self, segment: &Segment) {
        let length = segment.to_s - segment.from_s;
        let speed = self.rates.iter().fold(0.0, |most: f64, rates| most.max(rates[0].abs()));
        // A thousandth of a diameter.
        let trial = (1e-3 / speed).min(length);
        for (next, (lumen, rates)) in self.next.iter_mut().zip(self.lumens.iter().zip(&self.rates)) {
            *next = lumen + trial * rates[0];
        }
        self.step_s = trial;
        if self.next.iter().all(|lumen| *lumen > 0.0) {
            self.flow.rates(segment, segment.from_s + trial, &self.next, &mut self.stage);
            self.statistics.evaluations += 1;
            let bend = self.rates.iter().zip(&self.stage).fold(0.0, |most: f64, (a, b)| most.max((a[0] - b).abs()));
            let fastest = speed.max(bend / trial) / self.tolerance;
            let step = root(0.01 / fastest, 5).min(100.0 * trial);
            self.step_s = if step > 0.0 { step.min(length) } else { trial };
        }
    }

    /// One accepted step, its size; what is needed between its ends is left in `curves`.
    fn step(&mut self, segment: &Segment, time_s: f64) -> Result<f64, Halt> {
        let tolerance = self.tolerance;
        let mut rejected = false;
        loop {
            let rest = segment.to_s - time_s;
            let wanted = self.step_s.min(self.longest_step_s);
            // The last two steps are made alike rather than leaving a rest.
            let step = if wanted >= rest || time_s + 0.5 * rest <= time_s {
                rest
            } else if wanted * 2.0 > rest {
                0.5 * rest
            } else {
                wanted
            };
            if self.statistics.evaluations >= self.bounds.most_evaluations {
                return Err(Halt::Work(time_s, step * self.fastest > STABLE));
            }
            if time_s + step <= time_s {
                return Err(Halt::Stuck(time_s, step));
            }
            let closing = self.stages(segment, time_s, step);
            if let Some(wall) = closing {
                if step <= CLOSING_S.max(4.0 * (time_s.next_up() - time_s)) {
                    let at = (self.lumens[wall] / self.rates[wall][0].abs()).min(step);
                    return Err(Halt::Closed(wall, time_s + at));
                }
                self.statistics.rejected += 1;
                self.step_s = 0.25 * step;
                rejected = true;
                continue;
            }
            let mut error = 0.0_f64;
            for rates in &self.rates {
                let mut sum = 0.0;
                for (weight, rate) in ERROR.iter().zip(rates) {
                    sum += weight * rate;
                }
                let own = (step * sum).abs() / tolerance;
                error = if own.is_finite() { error.max(own) } else { f64::INFINITY };
            }
            if error == f64::INFINITY {
                for c in C {
                    let time_s = time_s + c * step;
                    if let Some((load, value)) = segment.at(time_s).not_finite() {
                        return Err(Halt::Load { load, time_s, value });
                    }
                }
            }
            if error <= 1.0 {
                let growth = SAFETY / root(error.max(1e-10), 5);
                let most = if rejected { 1.0 } else { 10.0 };
                self.accept(segment, time_s, step);
                // A step cut by the segment's end says nothing against the size that was wanted.
                let next = step * growth.clamp(0.2, most);
                self.step_s = if step < wanted { next.max(wanted) } else { next };
                return Ok(step);
            }
            self.statistics.rejected += 1;
            rejected = true;
            let shrink = if error.is_finite() { SAFETY / root(error, 5) } else { 0.1 };
            self.step_s = step * shrink.clamp(0.1, 0.9);
        }
    }

    /// All stages of a step; the wall that closes in one of them, if any does.
    fn stages(&mut self, segment: &Segment, time_s: f64, step: f64) -> Option<usize> {
        let end_s = if time_s + step >= segment.to_s { segment.to_s } else { time_s + step };
        let closes = None
            .or_else(|| self.stage::<1>(segment, time_s + C[1] * step, step))
            .or_else(|| self.stage::<2>(segment, time_s + C[2] * step, step))
            .or_else(|| self.stage::<3>(segment, time_s + C[3] * step, step))
            .or_else(|| self.stage::<4>(segment, time_s + C[4] * step, step))
            .or_else(|| self.stage::<5>(segment, end_s, step));
        if closes.is_some() {
            return closes;
        }
        self.before.copy_from_slice(&self.next);
        self.stage::<6>(segment, end_s, step)
    }

    /// Stage `K`, the lumens of which are left in `next`; the wall that closes in it, if any does.
    fn stage<const K: usize>(&mut self, segment: &Segment, time_s: f64, step: f64) -> Option<usize> {
        let mut least = f64::INFINITY;
        for (next, (lumen, rates)) in self.next.iter_mut().zip(self.lumens.iter().zip(&self.rates)) {
            let mut sum = 0.0;
            for k in 0..K {
                sum += A[K][k] * rates[k];
            }
            *next = lumen + step * sum;
            least = least.min(*next);
        }
        if least <= 0.0 {
            return self.next.iter().position(|lumen| *lumen <= 0.0);
        }
        self.flow.rates(segment, time_s, &self.next, &mut self.stage);
        self.statistics.evaluations += 1;
        self.put(K);
        None
    }

    /// Takes the step whose stages were just made.
    fn accept(&mut self, segment: &Segment, time_s: f64, step: f64) {
        self.fastest = self.eigenvalue();
        for (curve, (rates, ends)) in
            self.curves.iter_mut().zip(self.rates.iter_mut().zip(self.lumens.iter().zip(&self.next)))
        {
            *curve = Curve::new(*ends.0, *ends.1, step, rates);
            rates[0] = rates[STAGES - 1];
        }
        std::mem::swap(&mut self.lumens, &mut self.next);
        if !self.corrected {
            let end_s = if time_s + step >= segment.to_s { segment.to_s } else { time_s + step };
            self.flow.correct(segment, end_s, &self.lumens);
        }
        // Where it is corrected, the last stage has left network, Jacobian and term.
        self.neglected.step(&self.flow, step, self.corrected);
        self.statistics.steps += 1;
        self.statistics.smallest_step_s = self.statistics.smallest_step_s.min(step);
        self.statistics.largest_step_s = self.statistics.largest_step_s.max(step);
    }

    /// The largest eigenvalue as the last two stages, both at the step's end, tell it (Hairer, Wanner, section IV.2).
    fn eigenvalue(&self) -> f64 {
        let rates = self.rates.iter().fold(0.0, |most: f64, r| most.max((r[STAGES - 1] - r[STAGES - 2]).abs()));
        let lumens = self.next.iter().zip(&self.before).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
        rates / lumens
    }

    /// Lumens and rates at a time of the last step, left in `next` and `stage`.
    fn interpolate(&mut self, time_s: f64, from_s: f64, step: f64) {
        let part = (time_s - from_s) / step;
        for (j, curve) in self.curves.iter().enumerate() {
            self.next[j] = curve.at(part);
            self.stage[j] = curve.slope(part) / step;
        }
        for layer in &self.layers {
            if time_s < layer.until_s {
                layer.add(time_s, &mut self.next, &mut self.stage);
            }
        }
    }
}
