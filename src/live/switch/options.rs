//! How a switch is chosen and judged: the options of `lunula switch tune` and `lunula switch evaluate`.

use clap::Args;
use lunula_live::switch::Outside;

use super::truth::TrueContact;
use crate::job::{not_negative, number, one_of};
use crate::log::LogReading;
use crate::words::Words;

/// False switches an hour that are allowed where nobody says.
pub(crate) const FALSE_PER_HOUR: f64 = 1.0;

/// How recordings are read, and what of them is true.
#[derive(Debug, Clone, Args)]
pub struct ContactOptions {
    /// What is true contact: a column of 0 and 1, or a measured force with its threshold, as Fz_N<-0.2
    #[arg(long, value_name = "COLUMN", value_parser = str::parse::<TrueContact>)]
    pub contact: TrueContact,
    /// Rows with a saturated photodiode count too
    #[arg(long)]
    pub keep_faults: bool,
    /// How the columns are read.
    #[command(flatten)]
    pub log: LogReading,
}

/// The options of `lunula switch tune`.
#[derive(Debug, Clone, Args)]
pub struct TuneOptions {
    /// How many false switches an hour are allowed
    #[arg(long, value_name = "RATE", default_value_t = FALSE_PER_HOUR, value_parser = above_zero)]
    pub false_per_hour: f64,
    /// The share of presses that may be missed
    #[arg(long, value_name = "SHARE", default_value_t = 0.01, value_parser = part)]
    pub missed: f64,
    /// Without a valid sample for so long the switch lets go; 0: never
    #[arg(long, value_name = "SECONDS", default_value_t = 0.5, value_parser = not_negative)]
    pub watchdog: f64,
    /// What predictions beyond the trained voltages do
    #[arg(long, value_parser = one_of::<OutsideChoice>(), default_value = "release")]
    pub outside: OutsideChoice,
    /// The predicted column that is compared [default: pressing, -Fz_N]
    #[arg(long, value_name = "COLUMN")]
    pub column: Option<String>,
    /// What is true.
    #[command(flatten)]
    pub truth: ContactOptions,
}

/// What predictions beyond the trained voltages do.
pub type OutsideChoice = Option<Outside>;

impl Words for OutsideChoice {
    const WORDS: &'static [(Self, &'static str, &'static str)] = &[
        (Some(Outside::Release), "release", "they let go"),
        (Some(Outside::Ignore), "ignore", "they are passed over, and the watchdog runs"),
        (None, "count", "they count as any other"),
    ];
}

fn part(text: &str) -> Result<f64, String> {
    number(text).ok().filter(|share| (0.0..1.0).contains(share)).ok_or_else(|| "write a share, as 0.01".to_owned())
}

fn above_zero(text: &str) -> Result<f64, String> {
    number(text).ok().filter(|value| *value > 0.0).ok_or_else(|| "write a number above 0, as 1".to_owned())
}
