//! Logs and tables that a pipeline foresees: whether their ambient light will be subtracted, and what reading costs.

use std::path::Path;

use super::LogReading;
use crate::job::Foreseen;
use crate::stages::Step;

/// A file that does not exist yet is taken to be so long: ten minutes of eight photodiodes and three forces at 25 Hz.
const TYPICAL_BYTES: u64 = 2_000_000;
/// Memory of a program that does nothing, and of the pictures.
const BASE_BYTES: u64 = 48_000_000;
/// A byte of text is a tenth of a number, which is held some times over.
const BYTES_A_BYTE: u64 = 5;
/// Reading a byte takes so long, seconds (12 000 rows of 1.4 MB in 15 ms).
const READ_S: f64 = 1.1e-8;
const BYTES_A_ROW: f64 = 110.0;

/// Whether ambient light will be subtracted: only from raw logs whose LED goes on and off.
pub fn ambient_step(inputs: &[Foreseen], roles: &[&str], log: &LogReading) -> Step {
    let of_roles = inputs.iter().filter(|input| roles.contains(&input.role));
    step(of_roles.map(|input| has_led(input, log)).collect())
}

/// The same of files that exist.
pub fn ambient_step_of<'a>(files: impl IntoIterator<Item = &'a Path>, log: &LogReading) -> Step {
    step(files.into_iter().map(|file| log.led_of(file)).collect())
}

/// By whether each file's LED goes on and off.
fn step(led: Vec<Option<bool>>) -> Step {
    let count = |value: Option<bool>| led.iter().filter(|one| **one == value).count();
    let (lit, not, all) = (count(Some(true)), count(Some(false)), led.len());
    let reason = match (lit, all - lit - not) {
        (0, 0) => "no file has a column `led`".to_owned(),
        (_, 0) => format!("{lit} of {all} files have a column `led`"),
        (0, open) => format!("{open} of {all} files may have a column `led`"),
        (_, open) => format!("{lit} of {all} files have a column `led`, {open} more may"),
    };
    Step::new("ambient light", lit > 0 || not < all, reason)
}

fn has_led(input: &Foreseen, log: &LogReading) -> Option<bool> {
    input.exists.then(|| log.led_of(&input.path)).flatten().or(input.facts.led)
}

/// About how many bytes these are.
pub fn foreseen_bytes<'a>(inputs: impl IntoIterator<Item = &'a Foreseen>) -> u64 {
    inputs.into_iter().map(|input| input.bytes(TYPICAL_BYTES)).sum()
}

/// What reading files costs.
#[derive(Debug, Clone, Copy)]
pub struct ReadingCost {
    /// Memory, bytes.
    pub memory: u64,
    /// Time on one thread, seconds.
    pub seconds: f64,
    /// About how many rows they have.
    pub rows: f64,
}

impl ReadingCost {
    /// Of these files.
    #[must_use]
    pub fn of(inputs: &[Foreseen]) -> Self {
        let bytes = foreseen_bytes(inputs);
        Self {
            memory: BASE_BYTES + BYTES_A_BYTE * bytes,
            seconds: 0.005 + READ_S * bytes as f64,
            rows: bytes as f64 / BYTES_A_ROW,
        }
    }
}
