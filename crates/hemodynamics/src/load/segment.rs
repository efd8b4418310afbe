//! The four inputs together, cut at their breakpoints.

use std::f64::consts::PI;

use super::{Function, Load};
use crate::parameters::Parameters;

/// The inputs `u` of equation 2 at a moment, Pa.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Inputs {
    /// Upstream blood pressure `P_H` (gage).
    pub upstream_pa: f64,
    /// Downstream blood pressure `P_L` (gage).
    pub downstream_pa: f64,
    /// Pressure on the proximal palmar surface `P_F1`.
    pub proximal_pa: f64,
    /// Pressure on the distal palmar surface `P_F2`.
    pub distal_pa: f64,
}

impl Inputs {
    /// The parameters' blood pressures, and nothing presses.
    pub fn unloaded(parameters: &Parameters) -> Inputs {
        let (upstream_pa, downstream_pa) = (parameters.upstream_pa(), parameters.downstream_pa());
        Inputs { upstream_pa, downstream_pa, ..Inputs::default() }
    }

    /// Whether all are finite numbers; else the fault of the first that is not, of its thesis' symbol and its value.
    pub(crate) fn check<E>(&self, fault: impl FnOnce(&'static str, f64) -> E) -> Result<(), E> {
        let Inputs { upstream_pa, downstream_pa, proximal_pa, distal_pa } = *self;
        let named = [("P_H", upstream_pa), ("P_L", downstream_pa), ("P_F1", proximal_pa), ("P_F2", distal_pa)];
        match named.into_iter().find(|(_, value)| !value.is_finite()) {
            Some((symbol, value)) => Err(fault(symbol, value)),
            None => Ok(()),
        }
    }
}

/// The inputs over time.
#[derive(Clone, Debug)]
pub struct Loads {
    /// Upstream blood pressure `P_H`.
    pub upstream: Load,
    /// Downstream blood pressure `P_L`.
    pub downstream: Load,
    /// Pressure on the proximal palmar surface `P_F1`.
    pub proximal: Load,
    /// Pressure on the distal palmar surface `P_F2`.
    pub distal: Load,
}

/// The inputs between two of their breakpoints, where they are smooth.
#[derive(Clone)]
pub struct Segment {
    /// Where it begins, s.
    pub from_s: f64,
    /// Where it ends, s.
    pub to_s: f64,
    pieces: [Piece; 4],
}

#[derive(Clone)]
pub(super) enum Piece {
    Constant(f64),
    /// Straight from one time and value to another.
    Line {
        from: [f64; 2],
        to: [f64; 2],
    },
    Sine {
        mean: f64,
        amplitude: f64,
        angular: f64,
    },
    /// `until` is the breakpoint that ends it, where the function already belongs to the next piece.
    Function {
        function: Function,
        until: Option<f64>,
    },
}

impl Piece {
    pub(super) fn at(&self, time_s: f64) -> f64 {
        match self {
            Piece::Constant(value) => *value,
            // From the nearer end, so that both ends are exact.
            Piece::Line { from: [from_s, first], to: [to_s, last] } => {
                let part = (time_s - from_s) / (to_s - from_s);
                let rise = last - first;
                if part < 0.5 { first + part * rise } else { last - (to_s - time_s) / (to_s - from_s) * rise }
            }
            Piece::Sine { mean, amplitude, angular } => mean + amplitude * libm::sin(angular * time_s),
            Piece::Function { function, until } => match until {
                Some(until) if time_s >= *until => function(until.next_down()),
                _ => function(time_s),
            },
        }
    }

    /// At `offset_s` after `begin_s`.
    fn after(&self, begin_s: f64, offset_s: f64) -> f64 {
        match self {
            Piece::Line { from: [from_s, first], to: [to_s, last] } => {
                let (width, rise) = (to_s - from_s, last - first);
                let part = ((begin_s - from_s) + offset_s) / width;
                if part < 0.5 { first + part * rise } else { last - ((to_s - begin_s) - offset_s) / width * rise }
            }
            piece => piece.at(begin_s + offset_s),
        }
    }
}

impl Loads {
    /// Pressures on the fingertip over the constant blood pressures of the parameters.
    pub fn on(parameters: &Parameters, proximal: Load, distal: Load) -> Loads {
        let constant = |value| Load::constant(value).expect("checked parameters are finite");
        Loads {
            upstream: constant(parameters.upstream_pa()),
            downstream: constant(parameters.downstream_pa()),
            proximal,
            distal,
        }
    }

    /// The same over measured blood pressures, where there are any.
    pub fn with_blood(mut self, upstream: &Option<Load>, downstream: &Option<Load>) -> Loads {
        for (measured, used) in [(upstream, &mut self.upstream), (downstream, &mut self.downstream)] {
            if let Some(load) = measured {
                used.clone_from(load);
            }
        }
        self
    }

    /// The inputs at a time, s; at a breakpoint those of what begins there.
    pub fn at(&self, time_s: f64) -> Inputs {
        self.each(|load| load.at(time_s))
    }

    /// The inputs just before a time, s.
    pub fn before(&self, time_s: f64) -> Inputs {
        self.each(|load| load.before(time_s))
    }

    /// The smooth parts from `from_s` to `to_s`, in order, end on end.
    pub fn segments(&self, from_s: f64, to_s: f64) -> impl Iterator<Item = Segment> + '_ {
        let loads = [&self.upstream, &self.downstream, &self.proximal, &self.distal];
        let mut passed = loads.map(|load| load.breakpoints.partition_point(|&at| at <= from_s));
        let mut begin = from_s;
        std::iter::from_fn(move || {
            // Written so that a time that is not a number ends it.
            if !matches!(begin.partial_cmp(&to_s), Some(std::cmp::Ordering::Less)) {
                return None;
            }
            let next =
                |k: usize, passed: &[usize; 4]| loads[k].breakpoints.get(passed[k]).copied().unwrap_or(f64::INFINITY);
            let end = (0..4).map(|k| next(k, &passed)).fold(to_s, f64::min);
            let pieces = std::array::from_fn(|k| loads[k].piece(passed[k]));
            for k in 0..4 {
                if next(k, &passed) <= end {
                    passed[k] += 1;
                }
            }
            let segment = Segment { from_s: begin, to_s: end, pieces };
            begin = end;
            Some(segment)
        })
    }

    fn each(&self, value: impl Fn(&Load) -> f64) -> Inputs {
        Inputs {
            upstream_pa: value(&self.upstream),
            downstream_pa: value(&self.downstream),
            proximal_pa: value(&self.proximal),
            distal_pa: value(&self.distal),
        }
    }
}

impl Segment {
    /// The inputs at a time of the segment; at its end those that end there.
    pub fn at(&self, time_s: f64) -> Inputs {
        let [upstream_pa, downstream_pa, proximal_pa, distal_pa] = [0, 1, 2, 3].map(|k| self.pieces[k].at(time_s));
        Inputs { upstream_pa, downstream_pa, proximal_pa, distal_pa }
    }

    /// The inputs so long after the segment's start (s): straight pieces are exact however late by the clock that start
    /// is.
    pub(crate) fn after(&self, offset_s: f64) -> Inputs {
        let [upstream_pa, downstream_pa, proximal_pa, distal_pa] =
            [0, 1, 2, 3].map(|k| self.pieces[k].after(self.from_s, offset_s));
        Inputs { upstream_pa, downstream_pa, proximal_pa, distal_pa }
    }

    /// The longest step that does not pass over the changes in it, s: half the shortest period of a sine.
    pub(crate) fn longest_step_s(&self) -> f64 {
        self.pieces.iter().fold(f64::INFINITY, |least, piece| match piece {
            Piece::Sine { angular, .. } if *angular != 0.0 => least.min(PI / angular.abs()),
            _ => least,
        })
    }

    /// Whether nothing changes in it.
    pub fn is_constant(&self) -> bool {
        self.pieces.iter().all(|piece| matches!(piece, Piece::Constant(_)))
    }
}
