//! How far the reduced model strays: the first neglected term, accumulated along the path.
//!
//! The distance `e` from the full model follows `e' = (dv_0/dl) e + g`, with `dv_0/dl = K^-1 J` and `g` the first term left out of `h`, and
//! jumps by the first term left out of the layer's integral. It is carried along by the trapezoidal rule on the solver's own steps.

use super::flow::Flow;

/// The distance with its largest value so far.
#[derive(Clone, Debug)]
pub(super) struct Neglected {
    distance: Vec<f64>,
    /// `K^-1 J e` at the last step's end.
    drift: Vec<f64>,
    /// The term left out at the last step's end (inertia dropped) or the first-order term there (corrected).
    term: Vec<f64>,
    work: Vec<f64>,
    worst: f64,
}

impl Neglected {
    pub(super) fn new(walls: usize) -> Neglected {
        let zeros = vec![0.0; walls];
        Neglected { distance: zeros.clone(), drift: zeros.clone(), term: zeros.clone(), work: zeros, worst: 0.0 }
    }

    /// The largest distance so far, in nominal diameters; infinite where it could not be told.
    pub(super) fn worst(&self) -> f64 {
        self.worst
    }

    /// Begins a segment with a jump of the distance; `flow` holds network, Jacobian and `h_1` at the segment's start.
    pub(super) fn begin(&mut self, flow: &Flow, jump: Option<&[f64]>) {
        if let Some(jump) = jump {
            for (distance, jump) in self.distance.iter_mut().zip(jump) {
                *distance += jump;
            }
            self.note();
        }
        self.term.copy_from_slice(&flow.first);
        self.drift.fill(0.0);
        flow.drag.add_by_lumens(&self.distance, &mut self.drift);
        flow.drag.respond(0.0, &mut self.drift);
    }

    /// A step, with network, Jacobian and `h_1` of `flow` at its end. `corrected` tells whether `h_1` is left out, or what follows it.
    pub(super) fn step(&mut self, flow: &Flow, step_s: f64, corrected: bool) {
        let Neglected { distance, drift, term, work, .. } = self;
        let first = &flow.first;
        if corrected {
            // h_2 = -K^-1 (dh_1/dt + K^-1 J h_1).
            work.fill(0.0);
            flow.drag.add_by_lumens(first, work);
            flow.drag.respond(0.0, work);
            for (work, (first, before)) in work.iter_mut().zip(first.iter().zip(term.iter())) {
                *work += (first - before) / step_s;
            }
            flow.drag.respond(0.0, work);
            for work in work.iter_mut() {
                *work = -*work;
            }
        } else {
            for (work, (first, before)) in work.iter_mut().zip(first.iter().zip(term.iter())) {
                *work = 0.5 * (first + before);
            }
        }
        // (K - h/2 J) e = K (e_0 + h/2 drift_0 + h g).
        for (distance, (drift, work)) in distance.iter_mut().zip(drift.iter().zip(work.iter())) {
            *distance += step_s * (0.5 * drift + work);
        }
        flow.drag.step_implicitly(0.5 * step_s, distance, work);
        term.copy_from_slice(first);
        drift.fill(0.0);
        flow.drag.add_by_lumens(distance, drift);
        flow.drag.respond(0.0, drift);
        self.note();
    }

    fn note(&mut self) {
        for distance in &self.distance {
            // A distance that is no number is one that can't be told.
            self.worst = if distance.is_nan() { f64::INFINITY } else { self.worst.max(distance.abs()) };
        }
    }
}
