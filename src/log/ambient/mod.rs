//! A modulated log to rows of the LED's own light: each lit sample less the unlit light at its time (thesis section
//! 3.1.2c).
//!
//! In: a [`Log`]. Out: [`Samples`], one row for each lit row of the log, with what is wrong with each row and what is
//! worth saying on the whole. Where the log does not say when the LED was on, every row is lit and nothing is taken
//! away.
//!
//! Departure from the thesis, which takes the sample before: that one is half a period of the LED late. [`unlit`]
//! interpolates the ambient light at the lit sample's own time. Of a stream, whose samples after are not known yet,
//! [`preceding`] takes the sample before. [`rails`] finds samples at the end of the recorded range, in lit samples and
//! in the unlit ones that went into a row; [`dead`] channels that show nothing; [`edges`] rows beside a switch of the
//! LED that are not what `led` says.
//!
//! Forces are not modulated and are taken as they stand in lit rows.

mod dead;
mod edges;
mod preceding;
mod rails;
#[cfg(test)]
mod tests;
mod unlit;

use super::{Channel, Log, doubts};
use crate::words::Words;
pub(crate) use dead::{Standing, Still};
pub(crate) use preceding::{Preceding, RULE as PRECEDING_RULE};
pub(crate) use rails::piles;

use rails::Rails;
use unlit::{Share, Unlit};

/// Rows to be labelled: one for each lit row of the log.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Samples {
    /// The log's time, seconds, ascending.
    pub time_s: Vec<f64>,
    /// Photodiodes without the ambient light, volts; NaN where missing.
    pub photodiodes: Vec<Channel>,
    /// Forces, newtons; NaN where missing.
    pub forces: Vec<Channel>,
    /// For each row, what is wrong with it, as `saturated: P3` or `no ambient`, several joined by `; `; empty where
    /// nothing is.
    pub faults: Vec<String>,
    /// What has to be known before they are used: dead channels, much saturation, an LED that was never off.
    pub warnings: Vec<String>,
    /// What needs no action: little saturation, how much ambient light there was.
    pub notes: Vec<String>,
}

/// What the user says about the photodiodes.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct AmbientOptions {
    /// The lowest and the highest voltage that can be recorded; none: found where samples pile up at an extreme.
    pub full_scale_v: Option<[f64; 2]>,
    /// Which unlit samples are taken away.
    pub rule: AmbientRule,
}

/// Which unlit light is taken away from a lit sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum AmbientRule {
    /// At the lit sample's own time, interpolated between the unlit ones around it.
    #[default]
    Interpolated,
    /// The unlit sample before it, as in the thesis: what `lunula live` does. Saturation is then seen only where the
    /// range that can be recorded is given.
    Preceding,
}

impl AmbientOptions {
    /// Reads the range that can be recorded, volts: `0,10`.
    ///
    /// # Errors
    /// What to write instead.
    pub fn parse_full_scale(text: &str) -> Result<[f64; 2], String> {
        let ends =
            text.split_once(',').and_then(|(low, high)| Some([low.trim().parse().ok()?, high.trim().parse().ok()?]));
        ends.ok_or_else(|| "write the lowest voltage, a comma, the highest, as 0,10".to_owned())
    }
}

impl Words for AmbientRule {
    const WORDS: &'static [(Self, &'static str, &'static str)] = &[
        (Self::Interpolated, "interpolated", "at its own time, between the unlit rows around"),
        (Self::Preceding, "preceding", "the unlit row before it, as live"),
    ];
}

/// Why a log gives no samples.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum AmbientError {
    #[error(
        "{path}: the LED is never on (`led` is 0 in all {rows} rows), so there is nothing to label; is 1 the unlit \
         state here?"
    )]
    NeverOn { path: String, rows: usize },
    #[error("--full-scale {low},{high}: the lower end of the recorded range comes first, then the higher, both finite")]
    FullScale {
        /// As given, volts.
        low: f64,
        /// As given, volts.
        high: f64,
    },
}

/// Takes the ambient light away.
pub fn samples(log: &Log, options: &AmbientOptions) -> Result<Samples, AmbientError> {
    if let Some(ends) = options.full_scale_v {
        check_full_scale(ends)?;
    }
    let rows = log.time_s.len();
    let lit: Vec<usize> = (0..rows).filter(|&row| log.led.as_ref().is_none_or(|led| led[row])).collect();
    if lit.is_empty() {
        return Err(AmbientError::NeverOn { path: log.path.display().to_string(), rows });
    }
    let dark: Vec<usize> = (0..rows).filter(|&row| log.led.as_ref().is_some_and(|led| !led[row])).collect();
    let time_s: Vec<f64> = lit.iter().map(|&row| log.time_s[row]).collect();
    let mut found = Subtraction { faults: vec![Faults::default(); lit.len()], warnings: Vec::new(), notes: Vec::new() };
    let empty = log.photodiodes.iter().chain(&log.forces).filter(|one| one.values.iter().all(|value| value.is_nan()));
    found.warnings.extend(empty.map(|one| format!("{} has no value at all", one.name)));
    if log.led.is_some() && dark.is_empty() {
        found.warnings.push("the LED was never off: the photodiodes hold the ambient light too".to_owned());
    }
    let preceding = options.rule == AmbientRule::Preceding;
    let unlit = (!dark.is_empty() && !preceding).then(|| Unlit::new(&log.time_s, &lit, &dark));
    if preceding && !dark.is_empty() {
        found.notes.push(PRECEDING_RULE.to_owned());
    }
    let mut shares = Vec::new();
    let mut without = Vec::new();
    let photodiodes = log.photodiodes.iter().map(|channel| {
        let taken = |rows: &[usize]| -> Vec<f64> { rows.iter().map(|&row| channel.values[row]).collect() };
        let (raw, raw_dark) = (taken(&lit), taken(&dark));
        dead::warn(&channel.name, &time_s, &raw, &mut found.warnings);
        without.push(Channel { name: format!("{} unlit", channel.name), values: raw_dark.clone() });
        if preceding && !dark.is_empty() {
            let values = found.less_preceding(channel, log, options.full_scale_v);
            return Channel { name: channel.name.clone(), values };
        }
        let rails = Rails::of(&raw, &raw_dark, options.full_scale_v);
        let saturation = if rails.is_much_of(raw.len()) { &mut found.warnings } else { &mut found.notes };
        saturation.extend(rails.note(&channel.name));
        let values = match &unlit {
            Some(unlit) => found.less_ambient(&channel.name, &raw, &raw_dark, unlit, &rails, &mut shares),
            None => {
                found.mark_saturated(&channel.name, |k| rails.reached(raw[k]));
                raw
            }
        };
        Channel { name: channel.name.clone(), values }
    });
    let photodiodes: Vec<Channel> = photodiodes.collect();
    found.notes.extend(unlit.iter().filter_map(|unlit| unlit.note(&shares)));
    if !dark.is_empty() {
        found.warnings.extend(dimmed(&photodiodes));
    }
    let forces = log.forces.iter().map(|channel| {
        let values = lit.iter().map(|&row| channel.values[row]).collect();
        Channel { name: channel.name.clone(), values }
    });
    let forces: Vec<Channel> = forces.collect();
    // Dates have their unit.
    let time = if log.midnight_s.is_none() { doubts::time } else { doubts::blocks };
    found.warnings.extend(time(&log.time_s));
    match &log.led {
        Some(led) => found.warnings.extend(edges::unsettled(led, &log.photodiodes)),
        None => found.warnings.extend(doubts::alternating(named(&photodiodes))),
    }
    found.warnings.extend(doubts::forces(named(&forces)));
    found.warnings.extend(doubts::glitches(named(&photodiodes).chain(named(&without)).chain(named(&forces))));
    let faults = found.faults.iter().map(|faults| faults.words(photodiodes.len())).collect();
    Ok(Samples { time_s, photodiodes, forces, faults, warnings: found.warnings, notes: found.notes })
}

fn named(channels: &[Channel]) -> impl Iterator<Item = (&str, &[f64])> {
    channels.iter().map(|one| (one.name.as_str(), &one.values[..]))
}

/// Photodiodes that the LED makes darker.
fn dimmed(photodiodes: &[Channel]) -> Option<String> {
    /// Of the samples that are known, so many are below those without the LED: light that hardly reaches a photodiode
    /// has about half of them below.
    const NEARLY_ALL: f64 = 0.95;
    let is_dimmed = |channel: &&Channel| {
        let known = channel.values.iter().filter(|value| !value.is_nan()).count();
        let below = channel.values.iter().filter(|value| **value < 0.0).count();
        known > 0 && below as f64 >= NEARLY_ALL * known as f64
    };
    let names: Vec<&str> = photodiodes.iter().filter(is_dimmed).map(|channel| channel.name.as_str()).collect();
    (!names.is_empty()).then(|| {
        format!(
            "{} read less lit than unlit, so what is left of them is negative: `led` is 1 while the LED is on; is it \
             the other way round here, or does light lower the voltage?",
            names.join(", ")
        )
    })
}

/// Whether a range is one.
fn check_full_scale([low, high]: [f64; 2]) -> Result<(), AmbientError> {
    let is_one = low < high && low.is_finite() && high.is_finite();
    if is_one { Ok(()) } else { Err(AmbientError::FullScale { low, high }) }
}

/// Differences are counted in such steps: anything finer is the arithmetic's own rounding.
const GRAINS_A_VOLT: f64 = 1e12;

/// A difference without the arithmetic's own rounding; one that is too large to have any of it as it is.
fn in_grains(difference: f64) -> f64 {
    let grains = (difference * GRAINS_A_VOLT).round();
    if grains.is_finite() { grains / GRAINS_A_VOLT } else { difference }
}

/// What is wrong with a row.
#[derive(Debug, Clone, Default)]
struct Faults {
    saturated: Vec<String>,
    no_ambient: Vec<String>,
}

impl Faults {
    fn words(&self, channels: usize) -> String {
        let mut words = Vec::new();
        if !self.saturated.is_empty() {
            words.push(format!("saturated: {}", self.saturated.join(", ")));
        }
        match self.no_ambient.len() {
            0 => {}
            all if all == channels => words.push("no ambient".to_owned()),
            _ => words.push(format!("no ambient: {}", self.no_ambient.join(", "))),
        }
        words.join("; ")
    }
}

/// The photodiodes less the ambient light, as it grows channel by channel.
struct Subtraction {
    faults: Vec<Faults>,
    warnings: Vec<String>,
    notes: Vec<String>,
}

impl Subtraction {
    /// A channel's lit samples less the ambient light; adds to `shares` what part of the light that was.
    fn less_ambient(
        &mut self,
        name: &str,
        raw: &[f64],
        raw_dark: &[f64],
        unlit: &Unlit,
        rails: &Rails,
        shares: &mut Vec<Share>,
    ) -> Vec<f64> {
        let ambient = unlit.at_lit(raw_dark, |v| rails.reached(v));
        self.mark_saturated(name, |k| rails.reached(raw[k]) || ambient[k].saturated);
        let (mut sum_lit, mut sum_ambient) = (0.0, 0.0);
        let less = raw.iter().zip(&ambient).zip(&mut self.faults).map(|((&raw, ambient), faults)| {
            if raw.is_nan() {
                return f64::NAN;
            }
            if ambient.level.is_nan() {
                faults.no_ambient.push(name.to_owned());
            } else {
                sum_lit += raw;
                sum_ambient += ambient.level;
            }
            in_grains(raw - ambient.level)
        });
        let less = less.collect();
        let known = ambient.iter().zip(raw).filter(|(a, raw)| !a.level.is_nan() && !raw.is_nan()).count() as f64;
        let led = (sum_lit - sum_ambient).abs() / known;
        shares.push(Share { ambient: sum_ambient / sum_lit, rough: unlit::roughness(raw_dark) / led });
        less
    }

    /// A channel's lit samples less the unlit ones before them.
    fn less_preceding(&mut self, channel: &Channel, log: &Log, full_scale_v: Option<[f64; 2]>) -> Vec<f64> {
        let mut preceding = Preceding::of(full_scale_v.map(Rails::given), 1);
        let mut values = Vec::new();
        for (row, (&at, &value)) in log.time_s.iter().zip(&channel.values).enumerate() {
            if log.led.as_ref().is_some_and(|led| !led[row]) {
                preceding.unlit(at, &[value]);
                continue;
            }
            let mut less = [value];
            let saturated = preceding.lit(at, &mut less);
            let faults = &mut self.faults[values.len()];
            if saturated {
                faults.saturated.push(channel.name.clone());
            }
            if less[0].is_nan() && !value.is_nan() {
                faults.no_ambient.push(channel.name.clone());
            }
            values.push(less[0]);
        }
        values
    }

    fn mark_saturated(&mut self, name: &str, reached: impl Fn(usize) -> bool) {
        for (k, faults) in self.faults.iter_mut().enumerate() {
            if reached(k) {
                faults.saturated.push(name.to_owned());
            }
        }
    }
}
