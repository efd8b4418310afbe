//! Thresholds and holds from recordings: the fastest switch within a rate of false ones.
//!
//! In: traces of held-out recordings (of none of which the model was trained), and a [`Goal`]. Out: a configuration,
//! how it did, how it does on recordings that did not choose it (each is evaluated by what the others choose), and the
//! curve of delay against false rate.
//!
//! Every combination of thresholds, holds and ratios of `off_N` to `on_N` runs over all traces. Good are those with at
//! most the goal's rate and misses, also at the next lower threshold. A choice at the edge of the noise does not last:
//! another day's sensor drifts further. So of those that are at most a quarter slower than the fastest (in the mean: a
//! median has the steps of the sampling period) and miss half of what they may, the one with the highest threshold is
//! taken; of equals the fastest, then the one that releases soonest. *Measured* on 20 splits of twelve phantom
//! recordings: the fastest alone made up to 19 false switches an hour on the other half (`docs/src/jobs/live.md`).

use rayon::prelude::*;
use serde::Serialize;

use super::config::{Outside, SwitchConfig};
use super::evaluate::{Evaluation, Tally, Trace};
use super::rice::NoiseRate;

/// Thresholds that are tried: evenly spaced logarithms from the noise to the presses.
const LEVELS: usize = 48;
/// `off_N` over `on_N`.
const RATIOS: [f64; 4] = [0.3, 0.5, 0.7, 0.9];
/// `hold_on_s` and `hold_off_s`, in periods of the samples.
const HOLDS_ON: [f64; 5] = [0.0, 1.0, 2.0, 3.0, 5.0];
const HOLDS_OFF: [f64; 2] = [0.0, 2.0];

/// How much slower than the fastest, as a share, and what share of the allowed misses a safer threshold may cost.
const MARGIN_DELAY: f64 = 0.25;
const MARGIN_MISSED: f64 = 0.5;

/// What is to be reached.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Goal {
    /// False switches an hour, at most.
    pub false_per_hour: f64,
    /// The share of contacts that may be missed.
    pub missed_share: f64,
    /// The watchdog of all candidates, seconds; 0: none.
    pub watchdog_s: f64,
    /// What predictions beyond the trained voltages do.
    pub outside: Option<Outside>,
}

/// A combination that was tried.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Candidate {
    /// Thresholds and times.
    pub config: SwitchConfig,
    /// How it did on all recordings.
    pub evaluation: Evaluation,
}

/// What was found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Tuned {
    /// The choice.
    pub chosen: Candidate,
    /// Each recording evaluated by what the others choose: how it does where it did not choose; none where the others
    /// choose nothing, or of one recording.
    pub held_out: Option<Evaluation>,
    /// The fastest for each false rate, from the lowest rate on: no other is as fast with as few false switches.
    pub curve: Vec<Candidate>,
    /// The value while nothing touches.
    pub noise: Option<NoiseRate>,
    /// How many combinations were tried.
    pub tried: usize,
}

/// Why there is no choice.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum TuneFault {
    #[error(
        "no recording has a contact whose beginning and end are known; record presses, or name the column of contact"
    )]
    NoContacts,
    #[error("no predicted value is known while the finger touches; does the model fit these recordings?")]
    NoValues,
    #[error(
        "no thresholds and holds keep false switches at {goal} an hour, also at the next lower threshold, with \
         {misses:.1} % of presses missed at most; nearest: {false_switches} in {hours:.2} h with {missed} of {presses} \
         presses missed at on_N = {on_n}; raise the goal, or train a better model"
    )]
    Unreachable { goal: f64, misses: f64, false_switches: u64, hours: f64, missed: usize, presses: usize, on_n: f64 },
}

/// Chooses thresholds and holds.
pub fn tune(traces: &[Trace], goal: &Goal) -> Result<Tuned, TuneFault> {
    let levels = levels(traces)?;
    let configs = configs(&levels, period_s(traces), goal);
    let tallies: Vec<Vec<Tally>> =
        configs.par_iter().map(|config| traces.iter().map(|trace| Tally::of(config, trace)).collect()).collect();
    let all: Vec<usize> = (0..traces.len()).collect();
    let summed = |of: &[usize]| -> Vec<Scored> { tallies.iter().map(|each| Scored::of(each, of)).collect() };
    let whole = summed(&all);
    let Some(best) = choose(&whole, goal) else { return Err(unreachable(&configs, &whole, goal)) };
    let candidate = |k: usize| Candidate { config: configs[k].clone(), evaluation: whole[k].tally.evaluation() };
    let held_out = (traces.len() > 1)
        .then(|| {
            let mut out = Tally::default();
            for &left_out in &all {
                let others: Vec<usize> = all.iter().copied().filter(|&k| k != left_out).collect();
                out.add(&tallies[choose(&summed(&others), goal)?][left_out]);
            }
            Some(out.evaluation())
        })
        .flatten();
    Ok(Tuned {
        chosen: candidate(best),
        held_out,
        curve: fastest(&whole).into_iter().map(candidate).collect(),
        noise: noise(traces),
        tried: configs.len(),
    })
}

/// A combination over some recordings.
struct Scored {
    tally: Tally,
    /// Mean delays of presses and of releases, seconds.
    delay_s: f64,
    off_s: f64,
}

impl Scored {
    fn of(each: &[Tally], of: &[usize]) -> Self {
        let mut tally = Tally::default();
        of.iter().for_each(|&k| tally.add(&each[k]));
        Self { delay_s: mean(&tally.delays_on_s), off_s: mean(&tally.delays_off_s), tally }
    }

    fn keeps_rate(&self, goal: &Goal) -> bool {
        self.tally.false_switches as f64 <= goal.false_per_hour * self.tally.hours()
    }

    fn keeps(&self, goal: &Goal) -> bool {
        self.keeps_rate(goal) && self.tally.missed as f64 <= goal.missed_share * self.tally.presses as f64
    }

    fn missed_share(&self) -> f64 {
        self.tally.missed as f64 / (self.tally.presses as f64).max(1.0)
    }
}

/// The median time between samples.
fn period_s(traces: &[Trace]) -> f64 {
    let mut steps: Vec<f64> = traces
        .iter()
        .flat_map(|trace| trace.time_s.windows(2).map(|pair| pair[1] - pair[0]))
        .filter(|step| *step > 0.0)
        .collect();
    steps.sort_by(f64::total_cmp);
    steps.get(steps.len() / 2).copied().unwrap_or(0.0)
}

/// The values of rows while the finger is known to touch, or not to, away from contacts' ends.
fn values(traces: &[Trace], touching: bool) -> Vec<f64> {
    let mut found = Vec::new();
    for trace in traces {
        let mut contacts = trace.contacts.contacts.iter().peekable();
        for (&t_s, &value) in trace.time_s.iter().zip(&trace.value).filter(|(_, value)| value.is_finite()) {
            while contacts.next_if(|one| one.end_s + 1.0 < t_s).is_some() {}
            let at = contacts.peek().map(|one| (t_s - one.start_s, t_s - one.end_s));
            let touches = at.is_some_and(|(since_s, after_s)| since_s >= 0.0 && after_s < 0.0);
            let near = at.is_some_and(|(since_s, after_s)| since_s > -0.2 && after_s < 1.0);
            if if touching { touches } else { !near && trace.contacts.knows(t_s) } {
                found.push(value);
            }
        }
    }
    found
}

fn noise(traces: &[Trace]) -> Option<NoiseRate> {
    let rest = values(traces, false);
    NoiseRate::of(&rest, rest.len() as f64 * period_s(traces))
}

/// Whether there is a contact to judge a switch on.
///
/// # Errors
/// [`TuneFault::NoContacts`].
pub fn any_contact(traces: &[Trace]) -> Result<(), TuneFault> {
    let whole = |trace: &Trace| trace.contacts.contacts.iter().any(|one| one.start_known && one.end_known);
    if traces.iter().any(whole) { Ok(()) } else { Err(TuneFault::NoContacts) }
}

/// The thresholds to try, ascending.
fn levels(traces: &[Trace]) -> Result<Vec<f64>, TuneFault> {
    any_contact(traces)?;
    let mut touching = values(traces, true);
    touching.sort_by(f64::total_cmp);
    let high = touching.get(touching.len() * 9 / 10).copied().filter(|high| *high > 0.0).ok_or(TuneFault::NoValues)?;
    let low = noise(traces).map_or(0.0, |noise| noise.sd_n).clamp(high / 200.0, high / 4.0);
    let step = (high / low).powf(1.0 / (LEVELS - 1) as f64);
    let mut levels: Vec<f64> = (0..LEVELS).map(|k| rounded(low * step.powi(k as i32))).collect();
    levels.dedup();
    Ok(levels)
}

/// To three digits, as a person would write it.
fn rounded(value: f64) -> f64 {
    let digit = 10f64.powf(value.log10().floor() - 2.0);
    // Through text: the nearest number to what is written.
    format!("{:.6}", (value / digit).round() * digit).parse().unwrap_or(value)
}

/// All combinations; each threshold's come in the same order, the thresholds ascending.
fn configs(levels: &[f64], period_s: f64, goal: &Goal) -> Vec<SwitchConfig> {
    let mut configs = Vec::new();
    for &on_n in levels {
        for ratio in RATIOS {
            for on in HOLDS_ON {
                for off in HOLDS_OFF {
                    configs.push(SwitchConfig {
                        hold_on_s: rounded_s(on * period_s),
                        hold_off_s: rounded_s(off * period_s),
                        watchdog_s: goal.watchdog_s,
                        outside: goal.outside,
                        rearm: true,
                        ..SwitchConfig::of(on_n, rounded(ratio * on_n))
                    });
                }
            }
        }
    }
    configs
}

/// To a tenth of a millisecond, downwards: a hold of so many periods shall not take one more.
fn rounded_s(seconds: f64) -> f64 {
    (seconds * 1e4).floor() / 1e4
}

/// How many combinations a threshold has.
const EACH: usize = RATIOS.len() * HOLDS_ON.len() * HOLDS_OFF.len();

/// The mean; infinite of none.
fn mean(values: &[f64]) -> f64 {
    if values.is_empty() { f64::INFINITY } else { values.iter().sum::<f64>() / values.len() as f64 }
}

/// A delay in tenths of a millisecond: what is less is no difference.
fn nearly(delay_s: f64) -> i64 {
    (delay_s * 1e4).round() as i64
}

fn choose(all: &[Scored], goal: &Goal) -> Option<usize> {
    let good = || (EACH..all.len()).filter(|&k| all[k].keeps(goal) && all[k - EACH].keeps_rate(goal));
    let fastest_s = good().map(|k| all[k].delay_s).min_by(f64::total_cmp)?;
    let allowed_s = (1.0 + MARGIN_DELAY) * fastest_s;
    let half = Goal { missed_share: MARGIN_MISSED * goal.missed_share, ..*goal };
    let near = |k: &usize| all[*k].delay_s <= allowed_s + 1e-9;
    let safe = good().filter(near).filter(|&k| all[k].keeps(&half)).max_by(|&a, &b| {
        let levels = (a / EACH).cmp(&(b / EACH));
        let delays = nearly(all[b].delay_s).cmp(&nearly(all[a].delay_s));
        levels.then(delays).then(nearly(all[b].off_s).cmp(&nearly(all[a].off_s))).then(b.cmp(&a))
    });
    safe.or_else(|| good().min_by(|&a, &b| all[a].delay_s.total_cmp(&all[b].delay_s).then(b.cmp(&a))))
}

/// The candidates that no other betters in both delay and rate, from the fewest false switches on; those that miss more
/// than half of the presses are none.
fn fastest(all: &[Scored]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..all.len()).filter(|&k| all[k].missed_share() < 0.5).collect();
    order.sort_by(|&a, &b| {
        let rates = all[a].tally.false_switches.cmp(&all[b].tally.false_switches);
        rates.then(all[a].delay_s.total_cmp(&all[b].delay_s))
    });
    let mut least_s = f64::INFINITY;
    order.retain(|&k| {
        let faster = all[k].delay_s < least_s;
        least_s = least_s.min(all[k].delay_s);
        faster
    });
    order
}

fn unreachable(configs: &[SwitchConfig], all: &[Scored], goal: &Goal) -> TuneFault {
    let over = |one: &Scored| {
        let rate = one.tally.false_switches as f64 / one.tally.hours();
        (rate / goal.false_per_hour.max(1e-9)).max(1.0) * (one.missed_share() / goal.missed_share.max(1e-3)).max(1.0)
    };
    let nearest = (0..all.len()).min_by(|&a, &b| over(&all[a]).total_cmp(&over(&all[b]))).unwrap_or_default();
    TuneFault::Unreachable {
        goal: goal.false_per_hour,
        misses: 100.0 * goal.missed_share,
        false_switches: all[nearest].tally.false_switches,
        hours: all[nearest].tally.hours(),
        missed: all[nearest].tally.missed,
        presses: all[nearest].tally.presses,
        on_n: configs[nearest].on_n,
    }
}
