//! Which fit is wanted.

use std::path::PathBuf;

use lunula_hemodynamics::{Bounds, Calibration, Collapse, Free, Parameters};

use super::RecordingColumns;
use super::names::{no_such, symbols_of};
use crate::hemodynamics::HemodynamicsError;
use crate::hemodynamics::choices::OpticsChoice;
use crate::hemodynamics::given::GivenParameters;

/// From how many points a fit is begun.
pub const STARTS: u16 = 4;

/// A fit to be made.
#[derive(Debug, Clone)]
pub struct FitOptions {
    /// Recorded responses.
    pub recordings: Vec<PathBuf>,
    /// How they are read.
    pub columns: RecordingColumns,
    /// Whose finger each recording is; none: all are one's.
    pub subjects: Vec<String>,
    /// What tables and pictures call each recording, in the order of the recordings; none: its file's name.
    pub names: Vec<String>,
    /// Names of what is free; none: the photodiodes alone.
    pub free: Vec<String>,
    /// Bounds of some of these names.
    pub bounds: Vec<(String, Bounds)>,
    /// Noise of photodiodes by their columns, V; those that are not named are estimated.
    pub noise: Vec<(String, f64)>,
    /// Offset and scaling of the photodiodes.
    pub calibration: Calibration,
    /// From how many points the fit is begun.
    pub starts: usize,
    /// The parameters to start from.
    pub parameters: GivenParameters,
    /// What happens where a vessel closes.
    pub collapse: Collapse,
    /// How light depends on the capillaries.
    pub optics: OpticsChoice,
}

impl FitOptions {
    /// The groups that are free.
    ///
    /// # Errors
    /// Names that stand for nothing, and bounds of what is not free; all of them.
    pub(super) fn groups(&self, parameters: &Parameters) -> Result<Vec<Free>, HemodynamicsError> {
        let mut faults = Vec::new();
        let mut groups = Vec::new();
        let mut unknown: Vec<&str> = Vec::new();
        for name in &self.free {
            match symbols_of(name, parameters) {
                None => unknown.push(name),
                Some(symbols) => {
                    let bounds = self.bounds.iter().find(|(own, _)| own == name).map_or(Bounds::Default, |own| own.1);
                    groups.push(Free::tied(&symbols).within(bounds));
                }
            }
        }
        if !unknown.is_empty() {
            faults.push(no_such(&unknown, parameters));
        }
        for (name, _) in &self.bounds {
            if !self.free.contains(name) {
                faults.push(format!("--bounds {name}: is not free; --free {} makes it so", self.free_and(name)));
            }
        }
        let (subjects, recordings) = (self.subjects.len(), self.recordings.len());
        if subjects != 0 && subjects != recordings {
            faults.push(format!(
                "--subject: {subjects} names for {recordings} recordings; write one for each, in their order"
            ));
        }
        if faults.is_empty() { Ok(groups) } else { Err(HemodynamicsError::Options(faults)) }
    }

    fn free_and(&self, name: &str) -> String {
        self.free.iter().map(String::as_str).chain([name]).collect::<Vec<_>>().join(",")
    }

    /// Whose finger a recording is.
    pub(super) fn subject(&self, recording: usize) -> &str {
        self.subjects.get(recording).map_or("1", String::as_str)
    }
}
