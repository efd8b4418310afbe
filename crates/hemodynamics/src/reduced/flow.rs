//! The rates of the walls on the slow manifold, to the order asked for.
//!
//! The model is `l' = w`, `w' = a(l, u) - K(l) w` with `K^-1` proportional to the masses. The walls forget their rates within `1 / K`
//! (1e-7 to 6e-6 s); what is left is `w = h(l, t)` with `K h = a - dh/dt`, so in powers of the masses `h = v_0 + h_1 + ..`:
//!
//! `v_0 = K^-1 a`, `h_1 = -K^-1 dv_0/dt`, `dv_0/dt = K^-1 (J v_0 + a_u u')`, `J` the Jacobian of the accelerations by the lumens at the
//! rates `v_0`.

use super::drag::Drag;
use crate::load::{Inputs, Segment};
use crate::model::Model;

/// The reduced right-hand side with its memory.
#[derive(Clone, Debug)]
pub(super) struct Flow {
    corrected: bool,
    /// The network at the moment last asked for, and its Jacobian at that of [`Flow::correct`].
    pub(super) drag: Drag,
    /// The inputs of a segment in which they don't change.
    constant: Option<Inputs>,
    inputs: Inputs,
    venous_pa: f64,
    plain: Vec<f64>,
    /// `h_1` at the moment of [`Flow::correct`], 1/s.
    pub(super) first: Vec<f64>,
}

impl Flow {
    pub(super) fn new(model: &Model, corrected: bool) -> Flow {
        let zeros = vec![0.0; model.walls()];
        Flow {
            corrected,
            drag: Drag::new(model),
            constant: None,
            inputs: Inputs::default(),
            venous_pa: 0.0,
            plain: zeros.clone(),
            first: zeros,
        }
    }

    /// Begins a segment.
    pub(super) fn enter(&mut self, segment: &Segment) {
        self.constant = segment.is_constant().then(|| segment.at(segment.from_s));
    }

    /// `h` to the order asked for, 1/s, at a time of the segment last entered.
    pub(super) fn rates(&mut self, segment: &Segment, time_s: f64, lumens: &[f64], out: &mut [f64]) {
        self.inputs = self.constant.unwrap_or_else(|| segment.at(time_s));
        self.venous_pa = self.drag.rates(lumens, &self.inputs, &mut self.plain);
        if self.corrected {
            self.correct(segment, time_s, lumens);
            for (out, (plain, first)) in out.iter_mut().zip(self.plain.iter().zip(&self.first)) {
                *out = plain + first;
            }
        } else {
            out.copy_from_slice(&self.plain);
        }
    }

    /// `h_1` and the Jacobian, left in `first` and `drag`, at the moment that [`Flow::rates`] was last asked for. Where the order asked for has
    /// them, they are there already.
    pub(super) fn correct(&mut self, segment: &Segment, time_s: f64, lumens: &[f64]) {
        let Flow { drag, plain, first, .. } = self;
        drag.linearize(lumens, plain, self.venous_pa, &self.inputs);
        let mut source = 0.0;
        if self.constant.is_some() {
            first.fill(0.0);
        } else {
            source = drag.press(&segment.slope(time_s), first);
        }
        drag.add_by_lumens(plain, first);
        drag.respond(source, first);
        drag.respond(0.0, first);
        for value in first.iter_mut() {
            *value = -*value;
        }
    }
}
