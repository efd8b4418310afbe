//! What was measured: loads on a fingertip, and the voltages of photodiodes on its nail.

use super::FitFault;
use crate::load::Load;

/// Photodiodes' voltages under known loads.
#[derive(Clone, Debug)]
pub struct Recording {
    /// The loads.
    pub course: Course,
    /// The photodiodes; each has a voltage for every sample.
    pub photodiodes: Vec<Trace>,
    /// Whose fingertip it is; recordings with the same label share offsets and scalings under
    /// [`super::Calibration::PerSubject`].
    pub subject: Option<String>,
}

/// The loads of a recording.
#[derive(Clone, Debug)]
pub enum Course {
    /// Over time (Fig. 80, 82). It starts in the equilibrium of the loads just before the first sample.
    Transient {
        /// Times of the samples, s, growing.
        times_s: Vec<f64>,
        /// `P_F1`; a measured force is a [`Load::table`].
        proximal: Load,
        /// `P_F2`.
        distal: Load,
        /// `P_H` where it was measured, otherwise that of the parameters.
        upstream: Option<Load>,
        /// `P_L` where it was measured, otherwise that of the parameters.
        downstream: Option<Load>,
    },
    /// In equilibrium at every sample (Fig. 79, 81). Where there are several equilibria, each is reached from the
    /// sample before it, the first one from the unloaded fingertip, so the order of the samples is that in which they
    /// were taken.
    Static {
        /// `P_F1` of every sample, Pa.
        proximal_pa: Vec<f64>,
        /// `P_F2` of every sample, Pa.
        distal_pa: Vec<f64>,
    },
}

/// A photodiode's voltages.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// The capillary unit below it, from 0 at the proximal end.
    pub unit: usize,
    /// A voltage for each sample, V; NaN where it is missing.
    pub voltages_v: Vec<f64>,
    /// SD of its noise (slow noise and a pulse included), V, in proportion to that of the others: what is noisier
    /// counts less. Only the ratios matter.
    pub noise_v: f64,
}

impl Trace {
    /// Voltages of the photodiode above a unit, with noise as all others have.
    pub fn new(unit: usize, voltages_v: Vec<f64>) -> Trace {
        Trace { unit, voltages_v, noise_v: 1.0 }
    }
}

impl Recording {
    /// Samples over time under loads on the fingertip.
    pub fn transient(times_s: Vec<f64>, proximal: Load, distal: Load, photodiodes: Vec<Trace>) -> Recording {
        let course = Course::Transient { times_s, proximal, distal, upstream: None, downstream: None };
        Recording { course, photodiodes, subject: None }
    }

    /// Samples in equilibrium under pressures on the fingertip, Pa.
    pub fn steady(proximal_pa: Vec<f64>, distal_pa: Vec<f64>, photodiodes: Vec<Trace>) -> Recording {
        Recording { course: Course::Static { proximal_pa, distal_pa }, photodiodes, subject: None }
    }

    /// The same of a named subject.
    pub fn of(self, subject: &str) -> Recording {
        Recording { subject: Some(subject.to_owned()), ..self }
    }

    /// The number of samples.
    pub fn samples(&self) -> usize {
        match &self.course {
            Course::Transient { times_s, .. } => times_s.len(),
            Course::Static { proximal_pa, .. } => proximal_pa.len(),
        }
    }

    /// The first fault; `recording` is its number from 0.
    pub(super) fn check(&self, recording: usize, units: usize) -> Result<(), FitFault> {
        let fault = |what: String| FitFault::Recording { recording: recording + 1, what };
        let samples = self.samples();
        match &self.course {
            Course::Transient { times_s, .. } => {
                for (row, &time) in times_s.iter().enumerate() {
                    if !time.is_finite() {
                        return Err(fault(format!("the time of sample {} is {time}", row + 1)));
                    }
                    if row > 0 && time <= times_s[row - 1] {
                        return Err(fault(format!(
                            "times have to grow: sample {} ({time} s) comes after {} s",
                            row + 1,
                            times_s[row - 1]
                        )));
                    }
                }
            }
            Course::Static { proximal_pa, distal_pa } => {
                if proximal_pa.len() != distal_pa.len() {
                    let (first, second) = (proximal_pa.len(), distal_pa.len());
                    return Err(fault(format!("it has {first} proximal pressures and {second} distal ones")));
                }
                for (name, values) in [("proximal", proximal_pa), ("distal", distal_pa)] {
                    if let Some(row) = values.iter().position(|value| !value.is_finite()) {
                        return Err(fault(format!("the {name} pressure of sample {} is {}", row + 1, values[row])));
                    }
                }
            }
        }
        if samples == 0 || self.photodiodes.is_empty() {
            return Err(fault("there is nothing in it; a fit needs samples of at least one photodiode".into()));
        }
        for (k, trace) in self.photodiodes.iter().enumerate() {
            let of = |what: String| fault(format!("photodiode {} (unit {}): {what}", k + 1, trace.unit + 1));
            if trace.unit >= units {
                return Err(of(format!("the model has {units} units")));
            }
            if trace.voltages_v.len() != samples {
                return Err(of(format!("{} voltages for {samples} samples", trace.voltages_v.len())));
            }
            if let Some(row) = trace.voltages_v.iter().position(|value| value.is_infinite()) {
                return Err(of(format!("the voltage of sample {} is infinite; what is missing is NaN", row + 1)));
            }
            if trace.voltages_v.iter().all(|value| value.is_nan()) {
                return Err(of("all of its voltages are missing; leave it out".into()));
            }
            if !(trace.noise_v > 0.0 && trace.noise_v.is_finite()) {
                return Err(of(format!("its noise is {} V; it has to be greater than 0", trace.noise_v)));
            }
        }
        Ok(())
    }
}
