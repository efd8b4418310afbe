//! What the kinds on recordings have in common: which file is called how, which columns they need, what they cost.

use std::collections::BTreeSet;

use crate::log::LogReading;
use crate::pipeline::kind::{Demand, Foreseen};
use crate::pipeline::task::{At, Quality, Work};
use crate::predictor::{DataFile, Merit, Target};
use crate::stages::Step;

/// A file that does not stand yet is taken to be so long: ten minutes of eight photodiodes and three forces at 25 Hz.
const USUAL_BYTES: u64 = 2_000_000;
/// Memory of a program that does nothing, and of the pictures.
const BASE_BYTES: u64 = 48_000_000;
/// A byte of text is a tenth of a number, which is held some times over.
const BYTES_A_BYTE: u64 = 5;
/// Reading a byte takes so long, seconds (12 000 rows of 1.4 MB in 15 ms).
const READ_S: f64 = 1.1e-8;
/// Bytes of a row.
const BYTES_A_ROW: f64 = 110.0;

/// A recording as results call it: by the pipeline's name for it, its subject and session by its keys.
pub(super) fn data_file(at: &At) -> DataFile {
    let own = |key: &str| at.keys.get(key).map(str::to_owned);
    DataFile { path: at.path.clone(), name: at.name.clone(), session: own("session"), subject: own("subject") }
}

/// The recordings of a role.
pub(super) fn data_files(work: &Work, role: &str) -> Vec<DataFile> {
    work.of(role).map(data_file).collect()
}

/// Foreseen recordings of a role.
pub(super) fn foreseen(inputs: &[Foreseen], role: &str) -> Vec<DataFile> {
    inputs.iter().filter(|input| input.role == role).map(|input| DataFile::from(input.path.clone())).collect()
}

/// The joints among columns: `J2` of `J2_deg`.
pub(super) fn joints(target: &Target) -> BTreeSet<String> {
    target.columns().iter().filter_map(|column| column.strip_suffix("_deg")).map(str::to_owned).collect()
}

/// What recordings have to hold for a target: its joints and no others; the clock in the picture where it is needed of
/// these results.
pub(super) fn only_joints(joints: BTreeSet<String>, own: &Demand) -> Demand {
    Demand { parts: BTreeSet::new(), joints: Some(joints), clock: own.clock }
}

/// Whether ambient light will be taken away: only of raw logs whose LED goes on and off.
pub(super) fn ambient_step(inputs: &[Foreseen], roles: &[&str], log: &LogReading) -> Step {
    let of_roles = inputs.iter().filter(|input| roles.contains(&input.role));
    let led: Vec<Option<bool>> = of_roles.map(|input| has_led(input, log)).collect();
    let (lit, not, all) = (count(&led, Some(true)), count(&led, Some(false)), led.len());
    let reason = match (lit, all - lit - not) {
        (0, 0) => "no file has a column `led`".to_owned(),
        (_, 0) => format!("{lit} of {all} files have a column `led`"),
        (0, open) => format!("{open} of {all} files may have a column `led`"),
        (_, open) => format!("{lit} of {all} files have a column `led`, {open} more may"),
    };
    Step::new("ambient light", lit > 0 || not < all, reason)
}

fn count(all: &[Option<bool>], value: Option<bool>) -> usize {
    all.iter().filter(|one| **one == value).count()
}

fn has_led(input: &Foreseen, log: &LogReading) -> Option<bool> {
    input.stands.then(|| log.led_of(&input.path)).flatten().or(input.facts.led)
}

/// About how many bytes these are.
pub(super) fn bytes<'a>(inputs: impl IntoIterator<Item = &'a Foreseen>) -> u64 {
    let of = |input: &Foreseen| std::fs::metadata(&input.path).map_or(USUAL_BYTES, |found| found.len());
    inputs.into_iter().map(of).sum()
}

/// Memory and time of reading these, and about how many rows they have.
pub(super) fn reading(inputs: &[Foreseen]) -> (u64, f64, f64) {
    let bytes = bytes(inputs);
    (BASE_BYTES + BYTES_A_BYTE * bytes, 0.005 + READ_S * bytes as f64, bytes as f64 / BYTES_A_ROW)
}

/// The RMSE of each target against what was measured; `on` which rows, where that has to be said.
pub(super) fn measured(merit: &Merit, on: &str) -> Vec<Quality> {
    let one = |(column, rmse): &(String, f64)| Quality {
        what: format!("{column}{on}"),
        value: *rmse,
        unit: match column.rsplit_once('_') {
            Some((_, "N")) => "N RMS",
            Some((_, "deg")) => "degrees RMS",
            _ => "RMS",
        }
        .to_owned(),
        against_truth: true,
    };
    merit.rmse.0.iter().filter(|(_, rmse)| rmse.is_finite()).map(one).collect()
}
