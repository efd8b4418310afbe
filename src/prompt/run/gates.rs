//! The checks of the set-up (5.2.4, 1b, 2a, 2b): what is looked at, when it holds, and what to do where it does not.
//!
//! In: samples and forces as they come. Out: for each [`Check`] whether it holds, in words.
//!
//! All thresholds are assumed, but for the end of a range (a thousandth, as in logs).

use crate::prompt::protocol::Check;

/// Samples are looked at over so long, seconds, and so many of them at least.
const WINDOW_S: f64 = 2.0;
const WINDOW_SAMPLES: u32 = 20;
/// How near to the end of a given range a sample is saturated, as a share of the range, and the share of samples there.
const NEAR: f64 = 1e-3;
const MUCH: f64 = 0.01;
/// Without a range: a channel that has its greatest value in more than this share of its samples is at its end.
const PILED: f64 = 0.5;
/// The force of a lifted finger: its mean and its range over so long, newtons and seconds.
const TARE_N: f64 = 0.1;
const STEADY_N: f64 = 0.2;
const TARE_S: f64 = 1.0;
/// Pressing for the sign: so hard, newtons, for so long, seconds.
const PRESS_N: f64 = 0.5;
const PRESS_S: f64 = 0.3;
/// A photodiode that changes by more than this between two samples has jumped: volts, and volts a second.
const JUMP_V: f64 = 0.15;
const JUMP_V_PER_S: f64 = 1.0;
/// Samples that are farther apart say nothing of a jump, seconds.
const APART_S: f64 = 0.3;

/// The checks.
#[derive(Debug, Clone)]
pub(crate) struct Gates {
    names: Vec<String>,
    full_scale_v: Option<[f64; 2]>,
    window: Window,
    photodiodes: Verdict,
    tare: Tare,
    sign: Sign,
    last: Option<(f64, Vec<f64>)>,
    jumps: Vec<String>,
}

/// What is known of a check.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Verdict {
    /// Whether it holds.
    pub(crate) passed: bool,
    /// What is seen, and what to do.
    pub(crate) says: String,
}

/// Samples of a window, of each photodiode.
#[derive(Debug, Clone)]
struct Window {
    from_s: f64,
    count: u32,
    channels: Vec<Channel>,
}

#[derive(Debug, Clone, Copy)]
struct Channel {
    low: f64,
    high: f64,
    at_high: u32,
    at_ends: u32,
    known: u32,
}

#[derive(Debug, Clone, Default)]
struct Tare {
    verdict: Verdict,
    from_s: f64,
    count: u32,
    sum: [f64; 3],
    low: [f64; 3],
    high: [f64; 3],
}

#[derive(Debug, Clone, Default)]
struct Sign {
    verdict: Verdict,
    /// Since when the finger presses with this sign.
    since: Option<(f64, bool)>,
}

const NO_SAMPLE: Channel = Channel { low: f64::INFINITY, high: f64::NEG_INFINITY, at_high: 0, at_ends: 0, known: 0 };

impl Gates {
    /// Of photodiodes of these names; `full_scale_v` where their range is known.
    #[must_use]
    pub(crate) fn new(names: Vec<String>, full_scale_v: Option<[f64; 2]>) -> Self {
        let channels = vec![NO_SAMPLE; names.len()];
        let says = |what: &str| Verdict { passed: false, says: what.to_owned() };
        Self {
            full_scale_v,
            window: Window { from_s: f64::NAN, count: 0, channels },
            photodiodes: says("looking"),
            tare: Tare { verdict: says("lift the finger"), from_s: f64::NAN, ..Tare::default() },
            sign: Sign { verdict: says("press into the ring"), since: None },
            last: None,
            jumps: Vec::new(),
            names,
        }
    }

    /// Begins again: nothing is known.
    pub(crate) fn reset(&mut self) {
        *self = Self::new(std::mem::take(&mut self.names), self.full_scale_v);
    }

    /// A sample with the LED on.
    pub(crate) fn sample(&mut self, time_s: f64, volts: &[f64]) {
        self.window(time_s, volts);
        if let Some((before_s, before)) = &mut self.last {
            let apart_s = time_s - *before_s;
            let most_v = JUMP_V + JUMP_V_PER_S * apart_s;
            if (0.0..=APART_S).contains(&apart_s) {
                for ((name, one), other) in self.names.iter().zip(volts).zip(before.iter()) {
                    if (one - other).abs() > most_v {
                        self.jumps.push(format!("{name} jumped by {:.2} V", (one - other).abs()));
                    }
                }
            }
            *before_s = time_s;
            before.clear();
            before.extend(volts);
        } else {
            self.last = Some((time_s, volts.to_vec()));
        }
    }

    fn window(&mut self, time_s: f64, volts: &[f64]) {
        let window = &mut self.window;
        if window.from_s.is_nan() {
            window.from_s = time_s;
        }
        window.count += 1;
        for (channel, &value) in window.channels.iter_mut().zip(volts).filter(|(_, value)| value.is_finite()) {
            channel.known += 1;
            if value > channel.high {
                (channel.high, channel.at_high) = (value, 0);
            }
            channel.low = channel.low.min(value);
            channel.at_high += u32::from(value == channel.high);
            let ends = |[low, high]: [f64; 2]| {
                let near = NEAR * (high - low);
                value <= low + near || value >= high - near
            };
            channel.at_ends += u32::from(self.full_scale_v.is_some_and(ends));
        }
        if time_s - window.from_s < WINDOW_S || window.count < WINDOW_SAMPLES {
            return;
        }
        let faults = self.names.iter().zip(&window.channels).filter_map(|(name, channel)| {
            let what = channel.fault(self.full_scale_v.is_some())?;
            Some(format!("{name} {what}"))
        });
        let faults: Vec<String> = faults.collect();
        let says = if faults.is_empty() { "all change, none is at an end".to_owned() } else { faults.join("; ") };
        self.photodiodes = Verdict { passed: faults.is_empty(), says };
        *window = Window { from_s: time_s, count: 0, channels: vec![NO_SAMPLE; window.channels.len()] };
    }

    /// A force, newtons.
    pub(crate) fn force(&mut self, time_s: f64, force_n: [f64; 3]) {
        if !self.tare.verdict.passed {
            self.tare.push(time_s, force_n);
        } else if !self.sign.verdict.passed {
            self.sign.push(time_s, force_n[2]);
        }
    }

    /// A movement begins: jumps from now on count.
    pub(crate) fn begin_movement(&mut self) {
        self.jumps.clear();
        self.last = None;
    }

    /// How a check stands.
    #[must_use]
    pub(crate) fn verdict(&self, check: Check) -> Verdict {
        match check {
            Check::Photodiodes => self.photodiodes.clone(),
            Check::Tare => self.tare.verdict.clone(),
            Check::Sign => self.sign.verdict.clone(),
            Check::Adhesion => match &self.jumps[..] {
                [] => Verdict { passed: true, says: "no photodiode has jumped".to_owned() },
                [first, ..] => Verdict {
                    passed: false,
                    says: format!("{first} ({} jumps); press the sensor on, and do it once more", self.jumps.len()),
                },
            },
        }
    }
}

impl Channel {
    /// What is wrong with it.
    fn fault(&self, ranged: bool) -> Option<String> {
        let share = |count: u32| f64::from(count) / f64::from(self.known);
        if self.known == 0 {
            Some("has no value: is it connected?".to_owned())
        } else if self.low == self.high {
            Some(format!("is {} V all the time: dead, or not connected", self.low))
        } else if share(self.at_ends) > MUCH || !ranged && share(self.at_high) > PILED {
            Some(format!("is at the end of its range ({} V): less light, or less gain", self.high))
        } else {
            None
        }
    }
}

impl Tare {
    fn push(&mut self, time_s: f64, force_n: [f64; 3]) {
        if self.from_s.is_nan() || self.count == 0 {
            (self.from_s, self.count, self.sum) = (time_s, 0, [0.0; 3]);
            (self.low, self.high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        }
        self.count += 1;
        for (k, &force) in force_n.iter().enumerate() {
            self.sum[k] += force;
            (self.low[k], self.high[k]) = (self.low[k].min(force), self.high[k].max(force));
        }
        if time_s - self.from_s < TARE_S {
            return;
        }
        let steady = (0..3).all(|k| self.high[k] - self.low[k] <= STEADY_N);
        let means = self.sum.map(|sum| sum / f64::from(self.count));
        let off = ["Fx", "Fy", "Fz"].into_iter().zip(means).find(|(_, mean)| mean.is_nan() || mean.abs() > TARE_N);
        self.verdict = match off {
            _ if !steady => Verdict { passed: false, says: "the force moves; lift the finger and wait".to_owned() },
            Some((name, mean)) => Verdict {
                passed: false,
                says: format!("{name} is {mean:.2} N; lift the finger, else set the transducer to zero (tare)"),
            },
            None => Verdict { passed: true, says: "zero while the finger is lifted".to_owned() },
        };
        self.count = 0;
    }
}

impl Sign {
    fn push(&mut self, time_s: f64, fz_n: f64) {
        let presses = (fz_n.abs() >= PRESS_N).then_some(fz_n < 0.0);
        self.since = match (presses, self.since) {
            (Some(now), Some((since_s, before))) if now == before => Some((since_s, now)),
            (Some(now), _) => Some((time_s, now)),
            (None, _) => None,
        };
        let Some((_, is_right)) = self.since.filter(|(since_s, _)| time_s - since_s >= PRESS_S) else { return };
        self.verdict = if is_right {
            Verdict { passed: true, says: "pressing is negative".to_owned() }
        } else {
            let says = format!("Fz is {fz_n:+.2} N: pressing has to be negative; turn the transducer's sign");
            Verdict { passed: false, says }
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gates() -> Gates {
        Gates::new(["P1", "P2", "P3"].map(str::to_owned).to_vec(), Some([0.0, 10.0]))
    }

    /// Three seconds of samples at 25 Hz.
    fn sampled(mut gates: Gates, volts: impl Fn(f64) -> [f64; 3]) -> Verdict {
        (0..75).for_each(|k| gates.sample(0.04 * f64::from(k), &volts(0.04 * f64::from(k))));
        gates.verdict(Check::Photodiodes)
    }

    #[test]
    fn a_dead_a_saturated_and_a_missing_photodiode_are_named() {
        let good = |t_s: f64| [2.5 + 0.01 * t_s.sin(), 2.6 + 0.01 * t_s.cos(), 3.0 + 0.001 * t_s];
        assert!(sampled(gates(), good).passed);
        let dead = sampled(gates(), |t_s| [good(t_s)[0], 0.0, good(t_s)[2]]);
        assert!(!dead.passed && dead.says.starts_with("P2 is 0 V all the time"), "{dead:?}");
        let full = sampled(gates(), |t_s| [good(t_s)[0], good(t_s)[1], 9.99 + 0.005 * t_s.sin().abs()]);
        assert!(!full.passed && full.says.starts_with("P3 is at the end of its range"), "{full:?}");
        let missing = sampled(gates(), |t_s| [f64::NAN, good(t_s)[1], good(t_s)[2]]);
        assert!(!missing.passed && missing.says.starts_with("P1 has no value"), "{missing:?}");
        // Without a range: piled up at its greatest value.
        let unknown = Gates::new(gates().names, None);
        let piled = sampled(unknown.clone(), |t_s| [good(t_s)[0], good(t_s)[1], (9.0 + 3.0 * t_s).min(9.5)]);
        assert!(!piled.passed && piled.says.contains("P3"), "{piled:?}");
        assert!(sampled(unknown, good).passed);
        let mut few = gates();
        few.sample(0.0, &[1.0, 2.0, 3.0]);
        assert!(!few.verdict(Check::Photodiodes).passed, "nothing is known yet");
    }

    fn forces(gates: &mut Gates, from_s: f64, seconds: f64, force_n: [f64; 3]) {
        (0..(seconds * 100.0) as u32).for_each(|k| gates.force(from_s + 0.01 * f64::from(k), force_n));
    }

    #[test]
    fn tare_comes_before_sign_and_both_say_what_to_do() {
        let mut gates = gates();
        forces(&mut gates, 0.0, 1.5, [0.0, 0.0, -0.8]);
        let tare = gates.verdict(Check::Tare);
        assert!(!tare.passed && tare.says.starts_with("Fz is -0.80 N"), "{tare:?}");
        assert!(!gates.verdict(Check::Sign).passed, "not before the tare");
        forces(&mut gates, 2.0, 2.5, [0.02, -0.05, 0.01]);
        assert!(gates.verdict(Check::Tare).passed && !gates.verdict(Check::Sign).passed);
        forces(&mut gates, 5.0, 0.5, [0.0, 0.0, 0.9]);
        let sign = gates.verdict(Check::Sign);
        assert!(!sign.passed && sign.says.contains("turn the transducer's sign"), "{sign:?}");
        forces(&mut gates, 6.0, 0.2, [0.0, 0.0, -0.9]);
        assert!(!gates.verdict(Check::Sign).passed, "too short");
        forces(&mut gates, 6.2, 0.3, [0.0, 0.0, -0.9]);
        assert!(gates.verdict(Check::Sign).passed);
        gates.reset();
        assert!(!gates.verdict(Check::Tare).passed);
    }

    #[test]
    fn a_force_that_moves_or_is_no_number_is_no_tare() {
        let mut gates = gates();
        (0..300).for_each(|k| gates.force(0.01 * f64::from(k), [0.0, 0.0, 0.3 * (0.1 * f64::from(k)).sin()]));
        assert!(!gates.verdict(Check::Tare).passed);
        forces(&mut gates, 4.0, 3.0, [f64::NAN, 0.0, 0.0]);
        assert!(!gates.verdict(Check::Tare).passed);
    }

    #[test]
    fn a_jump_while_bending_is_seen_and_a_gap_is_none() {
        let mut gates = gates();
        gates.begin_movement();
        let at = |gates: &mut Gates, t_s: f64, volts: f64| gates.sample(t_s, &[volts, 2.0, 2.0]);
        (0..50).for_each(|k| at(&mut gates, 0.08 * f64::from(k), 2.0 + 0.03 * f64::from(k)));
        assert!(gates.verdict(Check::Adhesion).passed);
        at(&mut gates, 9.0, 1.0);
        assert!(gates.verdict(Check::Adhesion).passed, "not across a gap");
        at(&mut gates, 9.04, 1.4);
        let verdict = gates.verdict(Check::Adhesion);
        assert!(!verdict.passed && verdict.says.starts_with("P1 jumped by 0.40 V"), "{verdict:?}");
        gates.begin_movement();
        assert!(gates.verdict(Check::Adhesion).passed);
    }
}
