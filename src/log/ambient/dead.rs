//! Channels that show nothing, or nothing for a while.
//!
//! Warned of, and not left out: a channel may be dead to the LED's light and still be wanted. Looked at are the lit
//! samples as they were recorded: [`warn`] at those of a channel of a log, [`Standing`] at all channels of a sensor as
//! samples come.

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

/// A sensor's channels stand still where they do so for as long as this as well, seconds (assumed: each heartbeat moves
/// them).
const STILL_S: f64 = 1.0;

/// Samples that are the same in all of some channels, one after the other.
#[derive(Debug, Clone)]
pub(crate) struct Still {
    last: Vec<f64>,
    run: Stretch,
    /// Whether the run lasts too long.
    is_long: bool,
    /// Samples and runs before it that did not.
    usual: [u64; 2],
    /// Runs that did.
    stretches: u64,
    longest: Option<Stretch>,
}

/// A run of equal samples.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Stretch {
    samples: u64,
    first_s: f64,
    last_s: f64,
}

impl Still {
    pub(crate) fn new(channels: usize) -> Self {
        let (last, run) = (vec![f64::NAN; channels], Stretch::default());
        Self { last, run, is_long: false, usual: [0; 2], stretches: 0, longest: None }
    }

    /// A lit sample; whether the first stretch has just become one.
    pub(crate) fn push(&mut self, time_s: f64, values: impl Iterator<Item = f64>) -> bool {
        let mut same = true;
        for (last, value) in self.last.iter_mut().zip(values) {
            same &= std::mem::replace(last, value) == value;
        }
        if !same {
            if !std::mem::take(&mut self.is_long) && self.run.samples > 0 {
                self.usual = [self.usual[0] + self.run.samples, self.usual[1] + 1];
            }
            self.run = Stretch { samples: 1, first_s: time_s, last_s: time_s };
            return false;
        }
        (self.run.samples, self.run.last_s) = (self.run.samples + 1, time_s);
        let ([samples, runs], run) = (self.usual, self.run);
        let is_short = run.samples < STUCK as u64 || run.last_s - run.first_s < STILL_S;
        if is_short || LONGER * samples as f64 > (run.samples * runs) as f64 {
            return false;
        }
        if self.longest.is_none_or(|longest| self.run.samples >= longest.samples) {
            self.longest = Some(self.run);
        }
        let begins = !std::mem::replace(&mut self.is_long, true);
        self.stretches += u64::from(begins);
        begins && self.stretches == 1
    }

    /// What to say of them, which are called `what`.
    pub(crate) fn doubt(&self, what: &str) -> Option<String> {
        let Stretch { samples, first_s, last_s } = self.longest?;
        Some(format!(
            "{what} keep(s) all values in {} stretch(es), the longest {samples} samples from {first_s:.3} to \
             {last_s:.3} s: dead, or repeated by what logs them? All that follows from them there is of an old sample",
            self.stretches
        ))
    }
}

/// The channels of a sensor, of which one stands still, or all do at once.
#[derive(Debug, Clone)]
pub(crate) struct Standing {
    names: Vec<String>,
    all: Still,
    each: Vec<Still>,
}

/// What all channels together are called.
const ALL: &str = "all photodiodes that a model reads";

impl Standing {
    /// Of channels of these names.
    pub(crate) fn new(names: &[String]) -> Self {
        Self { names: names.to_vec(), all: Still::new(names.len()), each: vec![Still::new(1); names.len()] }
    }

    /// A lit sample; what has just been seen to stand still for the first time.
    pub(crate) fn push(&mut self, time_s: f64, values: &[f64]) -> Option<&str> {
        let all = self.all.push(time_s, values.iter().copied());
        let mut first = None;
        for ((name, still), value) in self.names.iter().zip(&mut self.each).zip(values) {
            if still.push(time_s, std::iter::once(*value)) {
                first.get_or_insert(name.as_str());
            }
        }
        if all { Some(ALL) } else { first.filter(|_| !self.all.is_long) }
    }

    /// What to say of them.
    pub(crate) fn doubts(&self) -> Vec<String> {
        let each = self.names.iter().zip(&self.each);
        let all = |still: &Still| self.all.longest.is_some() && still.longest == self.all.longest;
        let each = each.filter(|(_, still)| !all(still)).filter_map(|(name, still)| still.doubt(name));
        self.all.doubt(ALL).into_iter().chain(each).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::{ALL, Standing, Still};

    /// What is said of a stream at 25 Hz, and at which of its samples the first time.
    fn of(samples: usize, value: impl Fn(usize) -> f64) -> (Option<String>, Vec<usize>) {
        let mut still = Still::new(2);
        let began = (0..samples).filter(|&k| still.push(0.04 * k as f64, [value(k), 1.0].into_iter())).collect();
        (still.doubt("P1"), began)
    }

    #[test]
    fn a_sensor_that_stands_still_is_seen_at_once() {
        let alive = |k: usize| (k as f64).sin();
        assert_eq!(of(1000, alive), (None, Vec::new()));
        // What a faster clock writes down four times, and a photodiode of few bits, do not stand still.
        assert_eq!(of(1000, |k| alive(k / 4)), (None, Vec::new()));
        assert_eq!(of(1000, |k| (4.0 * alive(k / 10)).round()), (None, Vec::new()));
        // A missing value is no equal one.
        assert_eq!(of(1000, |k| if k < 500 { alive(k) } else { f64::NAN }), (None, Vec::new()));
        let (doubt, began) = of(1000, |k| alive(k.clamp(0, 400) + k.saturating_sub(700)));
        assert_eq!(began, [449]);
        assert!(doubt.unwrap().contains("in 1 stretch(es), the longest 301 samples from 16.000 to 28.000 s"));
        let (doubt, began) = of(1000, |_| 3.0);
        assert_eq!(began, [49]);
        assert!(doubt.unwrap().contains("the longest 1000 samples"));
        let (doubt, began) = of(1000, |k| if k % 300 < 200 { alive(k) } else { 3.0 });
        assert_eq!(began, [249]);
        assert!(doubt.unwrap().contains("in 3 stretch(es), the longest 100 samples from 32.000"));
    }

    #[test]
    fn a_channel_that_is_dead_is_named_and_all_at_once_are_one() {
        let names = ["P1", "P2", "P3"].map(str::to_owned);
        let of = |value: &dyn Fn(usize, usize) -> f64| {
            let mut standing = Standing::new(&names);
            let values = |k: usize| [0, 1, 2].map(|channel| value(channel, k));
            let began =
                (0..1000).filter_map(|k| standing.push(0.04 * k as f64, &values(k)).map(|what| (k, what.to_owned())));
            (began.collect::<Vec<_>>(), standing.doubts())
        };
        let alive = |channel: usize, k: usize| (k as f64 + 0.3 * channel as f64).sin();
        assert_eq!(of(&alive), (vec![], vec![]));
        let (began, doubts) = of(&|channel, k| if channel == 1 { 0.0 } else { alive(channel, k) });
        assert_eq!(began, [(49, "P2".to_owned())]);
        assert!(doubts.len() == 1 && doubts[0].starts_with("P2 keep(s) all values in 1 stretch(es), the longest 1000"));
        let (began, doubts) = of(&|channel, k| alive(channel, k.min(500)));
        assert_eq!(began, [(549, ALL.to_owned())]);
        assert!(doubts.len() == 1 && doubts[0].starts_with("all photodiodes that a model reads keep(s)"), "{doubts:?}");
    }
}
