//! The virtual switch over its models and over rates of false switches (6.1, Fig. 84): what a press loses against the
//! time of an answer, and false switches against the delay of a press.
//!
//! Models are fitted to one set of recordings, thresholds are chosen on a second, errors are those on a third.

use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::Context;
use lunula_live::switch::{Evaluation, Fate, Goal, SwitchConfig, Trace, matches, tune};
use lunula_predictor::{Kind, Predictor, Recipe};

use crate::job::Watch;
use crate::live::{ContactOptions, FALSE_PER_HOUR, SwitchInputs, Traces, TrueContact, read_traces};
use crate::log::{Columns, LogReading};
use crate::predictor::{DataFile, RowOptions, Target, Wanted, read_data};
use crate::tradeoff::measure::rows::{Measured, Row};
use crate::tradeoff::measure::timing::{Effort, Timing, in_turns};

/// What is measured, and how often.
#[derive(Debug, Clone)]
pub struct Settings {
    /// Recordings to train models on, with forces and a column `contact` of 0 and 1.
    pub train: Vec<PathBuf>,
    /// Others that thresholds are chosen on.
    pub choose: Vec<PathBuf>,
    /// Others that errors are of.
    pub judge: Vec<PathBuf>,
    /// How much.
    pub effort: Effort,
}

/// What the switch compares: job and choice.
pub(in crate::tradeoff) const MODEL: (&str, &str) = ("switch", "model");
/// How many false switches are allowed: job and choice.
pub(in crate::tradeoff) const RATE: (&str, &str) = ("switch", "--false-per-hour");
/// What a press loses; decides between models.
pub(in crate::tradeoff) const LOST: &str =
    "lost by a press, mean, s (its delay; of a missed one all of it); answers of one row";
/// Its false switches.
const FALSE_OF_MODEL: &str = "false switches per hour, at most (95 %); answers of one row";
/// What a rate stands for.
pub(in crate::tradeoff) const FALSE: &str = "false switches per hour, at most (95 %); delay of a press";

const CONTACT: &str = "contact";
/// Rates of false switches per hour.
const RATES: [f64; 6] = [0.3, 1.0, 3.0, 10.0, 30.0, 100.0];
/// Lags, seconds: two of the sensor's periods with the LED on.
const LAGS_S: [f64; 2] = [0.08, 0.16];
/// So many presses may be missed, so that weak models are seen as well.
const MISSED: f64 = 0.5;

/// What a switch compares.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Model {
    /// Contact itself, not the normal force.
    contact: bool,
    quadratic: bool,
    lags: bool,
}

const MODELS: [Model; 6] = [
    Model { contact: false, quadratic: false, lags: false },
    Model { contact: false, quadratic: true, lags: false },
    Model { contact: false, quadratic: false, lags: true },
    Model { contact: true, quadratic: false, lags: false },
    Model { contact: true, quadratic: true, lags: false },
    Model { contact: true, quadratic: false, lags: true },
];
/// The one that rates are measured with.
const DISCRIMINATOR: Model = MODELS[5];

impl Model {
    fn name(self) -> String {
        let target = if self.contact { "contact" } else { "force" };
        let kind = if self.quadratic { "quadratic" } else { "linear" };
        let lags = if self.lags { ", lags 0.08, 0.16" } else { "" };
        format!("{target}, {kind}{lags}")
    }

    fn column(self) -> Option<String> {
        self.contact.then(|| CONTACT.to_owned())
    }

    /// Fits it, and writes its file.
    fn fit(self, train: &[PathBuf], folder: &Path) -> anyhow::Result<PathBuf> {
        let target = Target::parse(if self.contact { CONTACT } else { "Fz_N" }).map_err(anyhow::Error::msg)?;
        let rows = RowOptions { log: reading()?, ..RowOptions::default() };
        let wanted = Wanted { targets: target.columns().to_vec(), rows, ..Wanted::default() };
        let kind = if self.quadratic { Kind::Quadratic } else { Kind::Linear };
        let lags_s = if self.lags { LAGS_S.to_vec() } else { Vec::new() };
        let recipe = Recipe { lags_s, ..Recipe::new(kind) };
        let fitted = Predictor::fit(&read_data(train, &wanted)?.data, None, &recipe)?;
        let at = folder.join(format!("{}.json", self.name()));
        std::fs::write(&at, fitted.to_json()).with_context(|| at.display().to_string())?;
        Ok(at)
    }
}

/// What the book's session trains.
pub(in crate::tradeoff) fn model_default() -> String {
    DISCRIMINATOR.name()
}

/// What `lunula switch tune` allows.
pub(in crate::tradeoff) fn rate_default() -> String {
    rate(FALSE_PER_HOUR)
}

fn rate(per_hour: f64) -> String {
    format!("{per_hour} per hour")
}

/// The column `contact` is a number like others.
fn reading() -> anyhow::Result<LogReading> {
    let columns = Columns::parse("contact=contact").map_err(anyhow::Error::msg)?;
    Ok(LogReading { columns, ..LogReading::default() })
}

/// Measures every setting.
///
/// # Errors
/// Recordings that can't be read or lack forces or contact, with their file;
/// [`Interrupted`](crate::job::Interrupted).
pub fn measure(settings: &Settings) -> anyhow::Result<Measured> {
    let effort = &settings.effort;
    let folder = tempfile::tempdir()?;
    let mut measured = Measured::default();
    let options = ContactOptions {
        contact: CONTACT.parse::<TrueContact>().map_err(anyhow::Error::msg)?,
        keep_faults: false,
        log: reading()?,
    };
    let traces = |model: Model, at: &Path, recordings: &[PathBuf]| -> anyhow::Result<Vec<Trace>> {
        let inputs = SwitchInputs { recordings: DataFile::of(recordings), models: vec![at.to_owned()] };
        let Traces { traces, failed, .. } =
            read_traces(&inputs, model.column().as_deref(), &options, &Watch::stopped_by(&effort.stop))?;
        anyhow::ensure!(failed.is_empty(), "{}", failed.join("; "));
        Ok(traces)
    };
    let models: Vec<(Model, PathBuf)> = MODELS
        .into_iter()
        .map(|model| anyhow::Ok((model, model.fit(&settings.train, folder.path())?)))
        .collect::<anyhow::Result<_>>()?;
    let judged = in_turns(&models, effort, |(model, at), _| {
        let start = Instant::now();
        let traces = traces(*model, at, &settings.judge)?;
        let rows: usize = traces.iter().map(|trace| trace.time_s.len()).sum();
        Ok((start.elapsed().as_secs_f64() / rows as f64, Some(traces)))
    })?;
    for ((model, at), judged) in models.into_iter().zip(judged) {
        let name = model.name();
        let (time, judged) = judged.with_context(|| name.clone())?;
        let chosen = traces(model, &at, &settings.choose)?;
        effort.check()?;
        match choose(&chosen, FALSE_PER_HOUR) {
            Ok(config) => {
                measured.rows.push(Row::own(MODEL, &name, (lost_s(&config, &judged), LOST), time, 1));
                let error = Evaluation::of(&config, &judged).rate.map_or(f64::NAN, |rate| rate.false_per_hour_high);
                measured.rows.push(Row::own(MODEL, &name, (error, FALSE_OF_MODEL), time, 1));
            }
            Err(why) => measured.refused.push(format!("{name}: {why:#}")),
        }
        if model != DISCRIMINATOR {
            continue;
        }
        for per_hour in RATES {
            effort.check()?;
            let found = choose(&chosen, per_hour).and_then(|config| cost(&config, &judged));
            measured.add(RATE, &rate(per_hour), FALSE, found);
        }
    }
    Ok(measured)
}

fn choose(traces: &[Trace], false_per_hour: f64) -> anyhow::Result<SwitchConfig> {
    let goal = Goal { false_per_hour, missed_share: MISSED, watchdog_s: 0.5, outside: None };
    Ok(tune(traces, &goal)?.chosen.config)
}

/// The mean over all contacts.
fn lost_s(config: &SwitchConfig, traces: &[Trace]) -> f64 {
    let (mut lost, mut contacts) = (0.0, 0);
    for one in traces.iter().flat_map(|trace| matches(config, trace)) {
        let Some(contact) = one.contact else { continue };
        lost += match one.fate {
            Fate::True => one.press_s - contact.start_s,
            Fate::Missed => contact.end_s - contact.start_s,
            Fate::False | Fate::Repeated => continue,
        };
        contacts += 1;
    }
    lost / f64::from(contacts)
}

/// How the delays are spread, and the false switches per hour, at most, with one answer as the work.
fn cost(config: &SwitchConfig, traces: &[Trace]) -> anyhow::Result<(Timing, (f64, u64))> {
    let found = Evaluation::of(config, traces);
    let (rate, delay) = found.rate.zip(found.delay_on_s).context("it never pressed")?;
    let time = Timing { median_s: delay.median, low_s: delay.low, high_s: delay.high, repeats: delay.count };
    Ok((time, (rate.false_per_hour_high, 1)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missed_press_loses_all_of_itself() {
        // Contacts of 1 s at 1 and 4 s; the value is up in the first, 0.2 s late.
        let mut trace = Trace::default();
        for k in 0..60 {
            let t = 0.1 * f64::from(k);
            trace.contacts.push(t, Some((1.0..2.0).contains(&t) || (4.0..5.0).contains(&t)), false);
            trace.time_s.push(t);
            trace.value.push(if (1.2..2.0).contains(&t) { 1.0 } else { 0.0 });
            trace.outside.push(false);
        }
        let lost = lost_s(&SwitchConfig::of(0.5, 0.5), std::slice::from_ref(&trace));
        assert!((lost - 0.6).abs() < 0.06, "{lost}");
    }
}
