//! How a fit is done.

use super::FitFault;
use crate::model::Collapse;
use crate::optics::Optics;

/// What becomes of the photodiodes' offsets `V_0` and scalings `V_1`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Calibration {
    /// They are those of the parameters.
    Fixed,
    /// Each photodiode has its own, the same in all recordings.
    Shared,
    /// Each photodiode has its own for every subject (the thesis, section 4.3.4); a recording without a subject is one
    /// of its own.
    #[default]
    PerSubject,
    /// Each photodiode has its own in every recording.
    PerRecording,
}

/// How a fit is done.
#[derive(Clone, Debug, PartialEq)]
pub struct FitOptions {
    /// How voltages depend on lumens.
    pub optics: Optics,
    /// What becomes of offsets and scalings.
    pub calibration: Calibration,
    /// What happens where a vessel closes. Under [`Collapse::Error`] parameters at which one does are refused.
    pub collapse: Collapse,
    /// Tolerance of the transients, 1e-13 to 1e-1.
    pub rtol: f64,
    /// The fit has converged where no parameter would move by more than this part of its standard error; 1e-12 to 0.1.
    pub tolerance: f64,
    /// The fit gives up after so many points in the space of parameters, from each start.
    pub most_points: usize,
    /// From how many points the fit is begun: the given start, and others spread over the bounds (Halton's sequence;
    /// where a bound is infinite, at the start's value). The best minimum counts: the model is far from linear, and one
    /// start may end in a wrong one.
    pub starts: usize,
    /// Whether [`Group::interval`](super::Group::interval) is asked for; it takes a third to one and a half times as
    /// long again.
    pub intervals: bool,
}

impl Default for FitOptions {
    fn default() -> Self {
        FitOptions {
            optics: Optics::default(),
            calibration: Calibration::default(),
            collapse: Collapse::default(),
            rtol: 1e-6,
            tolerance: 1e-3,
            most_points: 200,
            starts: 4,
            intervals: false,
        }
    }
}

impl FitOptions {
    pub(super) fn check(&self) -> Result<(), FitFault> {
        let within = |what: &'static str, value: f64, [least, most]: [f64; 2], wanted: &'static str| {
            if value >= least && value <= most { Ok(()) } else { Err(FitFault::Option { what, value, wanted }) }
        };
        within("the tolerance of the transients", self.rtol, [1e-13, 1e-1], "from 1e-13 to 1e-1")?;
        within("the fit's tolerance", self.tolerance, [1e-12, 0.1], "from 1e-12 to 0.1")?;
        within("the number of points", self.most_points as f64, [1.0, f64::MAX], "at least 1")?;
        within("the number of starts", self.starts as f64, [1.0, f64::MAX], "at least 1")
    }
}
