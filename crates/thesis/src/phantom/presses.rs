//! Slow and quick presses on a generated person's pulp, exactly as `lunula fit` reads them, with what is true of the
//! person (4.3.4, Fig. 79 to 82).
//!
//! In: [`PressOptions`]. Out, under one folder:
//! - `slow.csv`: `Fz_N,pf1_Pa,pf2_Pa` and the photodiode of the pressed place (`VP1` proximal, `VP2` distal), volts;
//!   equilibria, 0 to 2 N;
//! - `quick.csv`: `time_s` before these; pressed as quickly as one can, held, let go as quickly;
//! - `truth/parameters.toml`: the person's values as `lunula simulate --params` takes them;
//! - `truth/press.json`: the options.
//!
//! The force is the finger's on the surface, measured: pressing is a negative `Fz_N`. Pressures are that force on 1
//! cm2. Walls touch instead of closing: fit with `--collapse contact`.

use std::fs;
use std::path::Path;

use anyhow::Context as _;
use serde::Serialize;

use crate::section::people::{AREA_M2, Person, Recorded};
use lunula::hemodynamics::Pressed;
use lunula::phantom::{refused, staged, write_record};
use lunula::table::{Column, TableWriter, Value};

const RECORD: &str = "truth/press.json";
/// The files of a press. The record first: where it stands, what is of one run and what of another is made again.
pub(super) const RESULTS: [&str; 4] = [RECORD, "slow.csv", "quick.csv", "truth/parameters.toml"];

/// Presses to be made.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct PressOptions {
    /// What the person is called.
    pub name: String,
    /// Whose finger it is: everything random follows from it.
    pub seed: u64,
    /// Where it is pressed.
    pub site: Pressed,
}

/// Writes both presses under `out`; presses written there before are replaced.
///
/// # Errors
/// No such person, or a file that can't be written; what stood under `out` before is as it was.
pub(crate) fn write(options: &PressOptions, out: &Path) -> anyhow::Result<()> {
    let staging = staged(out, &RESULTS, RECORD, "a synthetic press's")?;
    let person = Person::middle().and_then(|middle| Person::about(&middle, &options.name, options.seed));
    let person = person.with_context(|| format!("no person of seed {}", options.seed))?;
    let recorded = [person.slowly(options.site)?, person.quickly(options.site)?];
    let [record, slow, quick, parameters] = RESULTS.map(|name| staging.path().join(name));
    for (recorded, path) in recorded.iter().zip([slow, quick]) {
        table(recorded, options.site, &path)?;
    }
    fs::write(&parameters, person.parameters.to_toml()).map_err(refused(&parameters))?;
    write_record(&record, &serde_json::json!({ "options": options }))?;
    Ok(staging.commit_exactly(&RESULTS)?)
}

fn table(recorded: &Recorded, site: Pressed, path: &Path) -> anyhow::Result<()> {
    let photodiode = if site == Pressed::Distal { "VP2" } else { "VP1" };
    let time = recorded.times_s.iter().map(|_| "time_s");
    let columns = time.chain(["Fz_N", "pf1_Pa", "pf2_Pa", photodiode]).map(Column::number).collect();
    let mut table = TableWriter::create(path, path, columns, &[])?;
    for (row, &force_n) in recorded.force_n.iter().enumerate() {
        let [proximal_pa, distal_pa] = site.of(force_n / AREA_M2);
        let volts = recorded.recording.photodiodes[0].voltages_v[row];
        let time = recorded.times_s.iter().map(|times_s| times_s[row]);
        let cells: Vec<Value<'_>> = time.chain([-force_n, proximal_pa, distal_pa, volts]).map(Value::Number).collect();
        table.write(&cells)?;
    }
    Ok(table.finish()?)
}
