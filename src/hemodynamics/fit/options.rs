//! Which fit: the options of `lunula fit` and of a pipeline's stage, the recordings, where results go.

use std::path::PathBuf;

use clap::Args;
use lunula_hemodynamics::{Bounds, Calibration, Free, Parameters};

use super::RecordingColumns;
use super::names::{no_such, symbols_of};
use crate::hemodynamics::HemodynamicsError;
use crate::hemodynamics::given::ModelOptions;
use crate::job::one_of;

/// What a fit reads.
#[derive(Debug, Clone, Default)]
pub struct FitInputs {
    /// Recorded responses.
    pub recordings: Vec<PathBuf>,
    /// Whose finger each recording is; none: all are one's.
    pub subjects: Vec<String>,
    /// What tables and pictures call each recording, in the order of the recordings; none: its file's name.
    pub names: Vec<String>,
    /// The parameters to start from.
    pub params: Option<PathBuf>,
}

impl FitInputs {
    /// Whose finger a recording is.
    pub(super) fn subject(&self, recording: usize) -> &str {
        self.subjects.get(recording).map_or("1", String::as_str)
    }
}

/// How to fit: the options of `lunula fit` and of a pipeline's stage.
#[derive(Debug, Clone, Args)]
pub struct FitOptions {
    /// Parameters to fit, such as k_C,b_C,k_V; none: only offset and scaling of the photodiodes
    #[arg(long, value_name = "NAMES", value_delimiter = ',', required = true)]
    pub free: Vec<String>,
    /// The bounds of a free parameter, such as k_C=0.1x..10x (of its start) or k_V=200..5000 (in its unit); may be
    /// given more than once [default: a tenth to ten times its start, as the thesis tunes]
    #[arg(long, value_name = "NAME=LOW..HIGH", value_parser = bounds)]
    pub bounds: Vec<(String, Bounds)>,
    /// Start from this many points within the bounds and keep the best fit
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u16).range(1..=1000))]
    pub starts: u16,
    /// Offset and scaling of the photodiodes: subject (one of each for every subject), recording (for every recording),
    /// shared, or held
    #[arg(long, value_parser = one_of::<Calibration>(), default_value = "subject")]
    pub calibrate: Calibration,
    /// The standard deviation of photodiodes' noise in volts, such as VP1=5e-5,VP2=6e-4 [default: estimated for each
    /// photodiode and subject]
    #[arg(long, value_name = "COLUMN=V", value_parser = noise, value_delimiter = ',')]
    pub noise: Vec<(String, f64)>,
    /// How recordings are read.
    #[command(flatten)]
    pub columns: RecordingColumns,
    /// The model.
    #[command(flatten)]
    pub model: ModelOptions,
}

fn bounds(text: &str) -> Result<(String, Bounds), String> {
    let (name, range) = text.split_once('=').ok_or_else(|| format!("{text:?}: write NAME=LOW..HIGH"))?;
    Ok((name.trim().to_owned(), range.parse()?))
}

fn noise(text: &str) -> Result<(String, f64), String> {
    let wrong = || format!("{text:?}: write COLUMN=VOLTS, greater than 0, such as VP1=5e-5");
    let (name, volts) = text.split_once('=').ok_or_else(wrong)?;
    let volts = volts.trim().parse::<f64>().ok().filter(|volts| volts.is_finite() && *volts > 0.0).ok_or_else(wrong)?;
    Ok((name.trim().to_owned(), volts))
}

impl FitOptions {
    /// Names of what is free; none: the photodiodes alone.
    pub(super) fn free(&self) -> &[String] {
        if self.free == ["none"] { &[] } else { &self.free }
    }

    /// The groups that are free.
    ///
    /// # Errors
    /// Names that stand for nothing, and bounds of what is not free; all of them.
    pub(super) fn groups(&self, inputs: &FitInputs, parameters: &Parameters) -> Result<Vec<Free>, HemodynamicsError> {
        let mut faults = Vec::new();
        let mut groups = Vec::new();
        let mut unknown: Vec<&str> = Vec::new();
        for name in self.free() {
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
            if !self.free().contains(name) {
                faults.push(format!("--bounds {name}: is not free; --free {} makes it so", self.free_and(name)));
            }
        }
        let (subjects, recordings) = (inputs.subjects.len(), inputs.recordings.len());
        if subjects != 0 && subjects != recordings {
            faults.push(format!(
                "--subject: {subjects} names for {recordings} recordings; write one for each, in their order"
            ));
        }
        if faults.is_empty() { Ok(groups) } else { Err(HemodynamicsError::Options(faults)) }
    }

    fn free_and(&self, name: &str) -> String {
        self.free().iter().map(String::as_str).chain([name]).collect::<Vec<_>>().join(",")
    }
}
