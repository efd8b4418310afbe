//! Which course, and what is compared with what.

use clap::Args;
use lunula_live::performance::Course;

use crate::job::number;

/// Reads a number above zero.
fn positive(text: &str) -> Result<f64, String> {
    number(text).ok().filter(|number| *number > 0.0).ok_or_else(|| "write a number above 0".to_owned())
}

/// The course that operators drove, and what is compared.
#[derive(Debug, Clone, PartialEq, Args)]
pub struct PerformanceOptions {
    /// Length of the path, metres (thesis: 1.42)
    #[arg(long, value_name = "METRES", value_parser = positive, allow_negative_numbers = true)]
    pub path_m: f64,
    /// The machine's speed along the path, metres a second (thesis: 0.025)
    #[arg(long, value_name = "SPEED", value_parser = positive, allow_negative_numbers = true)]
    pub speed_mps: f64,
    /// Moves that an operator has to choose at least (thesis: 27)
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub decisions: u32,
    /// The method that the others are compared with [default: that of the table's first row]
    #[arg(long, value_name = "METHOD")]
    pub baseline: Option<String>,
}

impl PerformanceOptions {
    /// The course.
    #[must_use]
    pub fn course(&self) -> Course {
        Course { path_m: self.path_m, speed_mps: self.speed_mps, decisions: self.decisions }
    }
}
