//! What is measured: the rows of `tradeoff.csv`.

use anyhow::Context;

use crate::files::Staging;
use crate::tradeoff::measure::timing::Timing;

/// One measured setting: a row of `tradeoff.csv`.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Row {
    /// Its name, such as `posture`.
    pub job: &'static str,
    /// Which setting of it.
    pub setting: String,
    /// How wrong.
    pub error: f64,
    /// What the error is, and its unit.
    pub error_unit: String,
    /// Seconds on one thread per input, of the stage that the setting changes; the median over repeats. Of a switch's
    /// rates the delay of a press, the median over presses.
    pub run_s: f64,
    /// What was done per input, a count that no clock disturbs.
    pub work: u64,
    /// What is chosen: the name of a [`Choice`](crate::tradeoff::Choice).
    pub choice: &'static str,
    /// The lower quartile of the seconds.
    pub run_low_s: f64,
    /// The upper quartile of the seconds.
    pub run_high_s: f64,
    /// How often it ran; 0: not known.
    pub repeats: u64,
    /// Whether it is the knee of its curve.
    pub knee: bool,
    /// Whether it is the job's default.
    pub default: bool,
    /// Whether it is another program's.
    pub peer: bool,
}

impl Row {
    /// Whether it has a place on logarithmic axes.
    pub(in crate::tradeoff) fn has_place(&self) -> bool {
        [self.error, self.run_s].iter().all(|value| value.is_finite() && *value > 0.0)
    }

    /// A setting of lunula's.
    pub(in crate::tradeoff) fn own(
        choice: (&'static str, &'static str),
        setting: &str,
        error: (f64, &str),
        time: Timing,
        work: u64,
    ) -> Self {
        Self {
            job: choice.0,
            setting: setting.to_owned(),
            error: error.0,
            error_unit: error.1.to_owned(),
            run_s: time.median_s,
            work,
            choice: choice.1,
            run_low_s: time.low_s,
            run_high_s: time.high_s,
            repeats: time.repeats as u64,
            knee: false,
            default: false,
            peer: false,
        }
    }
}

/// What a job's settings gave.
#[derive(Debug, Clone, Default)]
pub struct Measured {
    /// In the order of the table.
    pub rows: Vec<Row>,
    /// Settings that have no answer, and why.
    pub refused: Vec<String>,
}

impl Measured {
    /// A setting's row (time, error and work), else why it has none.
    pub(in crate::tradeoff) fn add(
        &mut self,
        choice: (&'static str, &'static str),
        setting: &str,
        error_unit: &str,
        found: anyhow::Result<(Timing, (f64, u64))>,
    ) {
        match found {
            Ok((time, (error, work))) => self.rows.push(Row::own(choice, setting, (error, error_unit), time, work)),
            Err(why) => self.refused.push(format!("{setting}: {why:#}")),
        }
    }
}

/// Writes `tradeoff.csv`. What is no number is empty.
pub(in crate::tradeoff) fn write_table(rows: &[&Row], staging: &Staging) -> anyhow::Result<()> {
    let header = "job,setting,error,error_unit,run_s,work,choice,run_low_s,run_high_s,repeats,knee,default,peer";
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(header.split(','))?;
    let number = |value: f64| if value.is_finite() { value.to_string() } else { String::new() };
    for row in rows {
        let [error, run_s, low_s, high_s] = [row.error, row.run_s, row.run_low_s, row.run_high_s].map(number);
        let [work, repeats] = [row.work, row.repeats].map(|count| count.to_string());
        let [knee, default, peer] = [row.knee, row.default, row.peer].map(|is| is.to_string());
        let first = [row.job, &row.setting, &error, &row.error_unit, &run_s, &work, row.choice];
        let last = [&low_s, &high_s, &repeats, &knee, &default, &peer];
        writer.write_record(first.into_iter().chain(last.map(String::as_str)))?;
    }
    let bytes = writer.into_inner().context("tradeoff.csv")?;
    let place = staging.place("tradeoff.csv")?;
    std::fs::write(&place, bytes).with_context(|| place.display().to_string())
}
