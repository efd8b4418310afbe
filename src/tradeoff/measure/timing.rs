//! Times of settings, measured in turns: what else the machine does meanwhile slows all of them alike.
//!
//! In: settings and what to time. Out: for each the median over the repeats, with the quartiles as its spread.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::job::Interrupted;

/// How much is measured.
#[derive(Debug, Clone, Default)]
pub struct Effort {
    /// Runs of each setting; the median time counts.
    pub repeats: usize,
    /// Fewer settings and smaller scenes.
    pub quick: bool,
    /// Threads that decode video (0: all cores); all else is measured on one.
    pub threads: usize,
    /// Set from outside to stop.
    pub stop: Arc<AtomicBool>,
}

impl Effort {
    /// Fails once it was stopped from outside.
    pub(crate) fn check(&self) -> Result<(), Interrupted> {
        if self.stop.load(Ordering::Relaxed) { Err(Interrupted) } else { Ok(()) }
    }
}

/// Seconds over the repeats; NaN where there are none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Timing {
    /// The middle one.
    pub median_s: f64,
    /// The lower quartile.
    pub low_s: f64,
    /// The upper quartile.
    pub high_s: f64,
    /// How many.
    pub repeats: usize,
}

impl Timing {
    /// Of several, in any order.
    #[must_use]
    pub fn of(mut seconds: Vec<f64>) -> Self {
        seconds.sort_by(f64::total_cmp);
        let [low_s, median_s, high_s] = [0.25, 0.5, 0.75].map(|share| quantile(&seconds, share));
        Self { median_s, low_s, high_s, repeats: seconds.len() }
    }
}

/// Straight between the neighbours in order (type 7 of Hyndman and Fan 1996, doi:10.1080/00031305.1996.10473566).
fn quantile(sorted: &[f64], share: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let at = share * last as f64;
    let (below, part) = (at.floor() as usize, at.fract());
    sorted[below] + part * (sorted[(below + 1).min(last)] - sorted[below])
}

/// What one run of a setting gives: its seconds, and in the first round its result.
pub(in crate::tradeoff) type Run<T> = anyhow::Result<(f64, Option<T>)>;

/// Runs every setting as often as `effort` says, all of them once, then all again. `run` gets whether it is the
/// setting's first run, and has to give its result then. A setting that fails runs no more.
pub(in crate::tradeoff) fn in_turns<S, T>(
    settings: &[S],
    effort: &Effort,
    mut run: impl FnMut(&S, bool) -> Run<T>,
) -> Result<Vec<anyhow::Result<(Timing, T)>>, Interrupted> {
    let mut seconds = vec![Vec::new(); settings.len()];
    let mut results: Vec<Option<anyhow::Result<T>>> = settings.iter().map(|_| None).collect();
    for round in 0..effort.repeats.max(1) {
        for (k, setting) in settings.iter().enumerate() {
            if matches!(results[k], Some(Err(_))) {
                continue;
            }
            effort.check()?;
            match run(setting, round == 0) {
                Ok((took, first)) => {
                    seconds[k].push(took);
                    if let Some(first) = first {
                        results[k] = Some(Ok(first));
                    }
                }
                Err(why) => results[k] = Some(Err(why)),
            }
        }
    }
    effort.check()?;
    let each = results.into_iter().zip(seconds);
    Ok(each
        .map(|(results, seconds)| {
            Ok((Timing::of(seconds), results.unwrap_or_else(|| Err(anyhow::anyhow!("nothing came out")))?))
        })
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_spread_is_the_quartiles() {
        let timing = Timing::of(vec![5.0, 1.0, 3.0, 2.0, 4.0]);
        assert_eq!(timing, Timing { median_s: 3.0, low_s: 2.0, high_s: 4.0, repeats: 5 });
        assert_eq!(Timing::of(vec![7.0]), Timing { median_s: 7.0, low_s: 7.0, high_s: 7.0, repeats: 1 });
        assert_eq!(Timing::of(vec![1.0, 2.0]).median_s, 1.5);
        assert!(Timing::of(Vec::new()).median_s.is_nan());
    }

    #[test]
    fn settings_take_turns_and_one_that_fails_runs_no_more() {
        let effort = Effort { repeats: 3, ..Effort::default() };
        let mut order = Vec::new();
        let found = in_turns(&["a", "bad", "c"], &effort, |&setting, first| {
            order.push(setting);
            anyhow::ensure!(setting != "bad", "it is bad");
            Ok((order.len() as f64, first.then_some(setting)))
        })
        .unwrap();
        assert_eq!(order, ["a", "bad", "c", "a", "c", "a", "c"]);
        let (timing, results) = found[0].as_ref().unwrap();
        assert_eq!((timing.median_s, timing.repeats, *results), (4.0, 3, "a"));
        assert_eq!(found[1].as_ref().unwrap_err().to_string(), "it is bad");
    }

    #[test]
    fn it_stops_on_request() {
        let effort = Effort { repeats: 2, ..Effort::default() };
        let mut runs = 0;
        let stopped = in_turns(&[(); 5], &effort, |(), _| {
            runs += 1;
            effort.stop.store(true, Ordering::Relaxed);
            Ok((1.0, Some(())))
        });
        assert!(stopped.is_err() && runs == 1);
    }
}
