//! Channels that show nothing, or nothing for a while.
//!
//! Warned of, and not left out: a channel may be dead to the LED's light and still be wanted. Looked at are the lit
//! samples as they were recorded.

/// A channel with so few values is called dead; its samples have to be [`SAMPLES`] at least.
const VALUES: usize = 3;

/// A channel that has one value in so many of its samples is dead, too.
pub(super) const DEAD_SHARE: f64 = 0.9;

/// Below so many samples nothing is said.
const SAMPLES: usize = 50;

/// A channel is stuck where it keeps a value for so many samples, and for [`LONGER`] times as long as it usually does.
const STUCK: usize = 50;

/// See [`STUCK`].
const LONGER: f64 = 50.0;

/// Warns of what a channel's lit samples do not show.
pub(super) fn warn(name: &str, time_s: &[f64], values: &[f64], warnings: &mut Vec<String>) {
    let known: Vec<(f64, f64)> =
        time_s.iter().copied().zip(values.iter().copied()).filter(|(_, v)| !v.is_nan()).collect();
    if known.len() < SAMPLES {
        return;
    }
    let mut sorted: Vec<f64> = known.iter().map(|(_, v)| *v).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    let alike = || sorted.chunk_by(|a, b| a == b);
    let (value, most) = alike().fold((0.0, 0), |(v, n), run| if run.len() > n { (run[0], run.len()) } else { (v, n) });
    let share = most as f64 / known.len() as f64;
    match alike().take(VALUES + 1).count() {
        1 => return warnings.push(format!("{name} is {value} V in all lit samples: dead or not connected")),
        count @ 2..=VALUES => {
            return warnings
                .push(format!("{name} has only {count} different values in all lit samples: dead, or too weak"));
        }
        _ if share >= DEAD_SHARE => {
            let percent = 100.0 * share;
            return warnings.push(format!("{name} is {value} V in {percent:.1} % of the lit samples: dead, or loose"));
        }
        _ => {}
    }
    let runs: Vec<&[(f64, f64)]> = known.chunk_by(|a, b| a.1 == b.1).collect();
    let usual = known.len() as f64 / runs.len() as f64;
    let stuck: Vec<&&[(f64, f64)]> =
        runs.iter().filter(|run| run.len() >= STUCK && run.len() as f64 >= LONGER * usual).collect();
    // The first of equals.
    if let Some(longest) = stuck.iter().rev().max_by_key(|run| run.len()) {
        let (first, last) = (longest[0], longest[longest.len() - 1]);
        warnings.push(format!(
            "{name} does not move at all in {} stretch(es); the longest, from {:.3} to {:.3} s, at {} V",
            stuck.len(),
            first.0,
            last.0,
            first.1
        ));
    }
}
