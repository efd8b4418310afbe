//! What counts as a contact, and what trials are compared with.

use clap::Args;
use lunula_live::skill::Thresholds;

use crate::job::not_negative;
use crate::predictor::DataFile;

/// What counts as a contact, and what trials are compared with.
#[derive(Debug, Clone, PartialEq, Args)]
pub struct SkillOptions {
    /// A contact begins at this pressing force, newtons
    #[arg(
        long = "touch", value_name = "NEWTONS", default_value_t = 0.2, value_parser = not_negative,
        allow_negative_numbers = true
    )]
    pub touch_n: f64,
    /// It ends below this pressing force, newtons; not above --touch
    #[arg(
        long = "release", value_name = "NEWTONS", default_value_t = 0.1, value_parser = not_negative,
        allow_negative_numbers = true
    )]
    pub release_n: f64,
    /// Contacts and breaks that are shorter are none
    #[arg(
        long = "hold", value_name = "SECONDS", default_value_t = 0.05, value_parser = not_negative,
        allow_negative_numbers = true
    )]
    pub hold_s: f64,
    /// What the finger of a plain column Fz_N is called
    #[arg(long, value_name = "NAME", default_value = "finger")]
    pub finger: String,
    /// The trial that the others are compared with, as TRIAL or SUBJECT/TRIAL
    #[arg(long, value_name = "TRIAL")]
    pub reference_trial: Option<String>,
    /// How far time may be warped in the comparison, per cent of the longer trial
    #[arg(
        long = "band", value_name = "PERCENT", default_value_t = 10.0, value_parser = not_negative,
        allow_negative_numbers = true
    )]
    pub band_percent: f64,
}

impl SkillOptions {
    /// What counts as a contact.
    #[must_use]
    pub fn thresholds(&self) -> Thresholds {
        Thresholds { touch_n: self.touch_n, release_n: self.release_n, hold_s: self.hold_s }
    }

    /// All that is wrong; nothing where they can be used.
    pub(super) fn faults(&self) -> Vec<String> {
        let mut faults = Vec::new();
        if self.touch_n == 0.0 {
            faults.push("--touch 0: every finger touches; choose more, as 0.2".to_owned());
        }
        if self.release_n > self.touch_n {
            faults.push(format!("--release {}: is above --touch {}; choose less", self.release_n, self.touch_n));
        }
        if self.band_percent > 100.0 {
            faults.push(format!("--band {}: choose 0 to 100 per cent", self.band_percent));
        }
        if self.finger.trim().is_empty() {
            faults.push("--finger: write a name".to_owned());
        }
        faults
    }
}

/// What is looked at.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SkillInputs {
    /// Recordings of trials; without a column `trial`, the session is one, else the file.
    pub recordings: Vec<DataFile>,
    /// A recording of one trial that the others are compared with.
    pub reference: Option<DataFile>,
}
