//! What a stage's other programs gave.

use lunula::tradeoff::Timing;
use lunula::tradeoff::peers::PeerRow;

/// Rows, without scene, machine and date, and what could not be measured.
#[derive(Debug, Default)]
pub(crate) struct Found {
    pub(crate) rows: Vec<PeerRow>,
    pub(crate) left_out: Vec<String>,
}

impl Found {
    /// Adds a program's setting on a curve.
    pub(crate) fn add(
        &mut self,
        choice: (lunula::tradeoff::Job, &str),
        setting: &str,
        error: (f64, &str),
        time: Timing,
        work: u64,
        version: &str,
    ) {
        self.rows.push(PeerRow {
            stage: choice.0,
            choice: choice.1.to_owned(),
            scene: String::new(),
            setting: setting.to_owned(),
            error: error.0,
            error_unit: error.1.to_owned(),
            run_s: time.median_s,
            run_low_s: time.low_s,
            run_high_s: time.high_s,
            repeats: time.repeats as u64,
            work,
            machine: String::new(),
            version: version.to_owned(),
            date: String::new(),
        });
    }

    /// Adds what `measure` gives, or says why it gives nothing: one program that fails leaves the others.
    pub(crate) fn try_program(&mut self, name: &str, measure: impl FnOnce(&mut Self) -> anyhow::Result<()>) {
        let before = self.rows.len();
        if let Err(why) = measure(self) {
            self.rows.truncate(before);
            self.left_out.push(format!("{name}: {why:#}"));
        }
    }
}
