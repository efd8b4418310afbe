//! What decides whether numbers agree with words.

use super::Verdict;
use crate::Numbers;

/// A relation of numbers by name.
#[derive(Debug, Clone, Copy)]
pub enum Test {
    /// A number between two ends.
    Between(&'static str, f64, f64),
    /// A number, or its size with the sign left off, up to a limit.
    SizeAtMost(&'static str, f64),
    /// A number of at least this size, its sign left off.
    SizeAtLeast(&'static str, f64),
    /// A number up to a limit.
    AtMost(&'static str, f64),
    /// A number from a limit on.
    AtLeast(&'static str, f64),
    /// A number below another, or below that times a factor.
    Below(&'static str, &'static str, f64),
    /// A number over another is between two ends.
    Ratio(&'static str, &'static str, f64, f64),
    /// All of them.
    All(&'static [Test]),
}

impl Test {
    /// The numbers that it depends on.
    #[must_use]
    pub fn names(&self) -> Vec<&'static str> {
        match *self {
            Self::Between(name, ..)
            | Self::SizeAtMost(name, _)
            | Self::SizeAtLeast(name, _)
            | Self::AtMost(name, _)
            | Self::AtLeast(name, _) => vec![name],
            Self::Below(name, other, _) | Self::Ratio(name, other, ..) => vec![name, other],
            Self::All(tests) => {
                let mut names = Vec::new();
                tests.iter().flat_map(Self::names).for_each(|name| {
                    if !names.contains(&name) {
                        names.push(name);
                    }
                });
                names
            }
        }
    }

    /// Whether it holds; none where a number is missing.
    fn holds(&self, numbers: &Numbers) -> Option<bool> {
        let get = |name: &str| numbers.get(name);
        Some(match *self {
            Self::Between(name, low, high) => (low..=high).contains(&get(name)?),
            Self::SizeAtMost(name, most) => get(name)?.abs() <= most,
            Self::SizeAtLeast(name, least) => get(name)?.abs() >= least,
            Self::AtMost(name, most) => get(name)? <= most,
            Self::AtLeast(name, least) => get(name)? >= least,
            Self::Below(name, other, factor) => get(name)? < factor * get(other)?,
            Self::Ratio(name, other, low, high) => (low..=high).contains(&(get(name)? / get(other)?)),
            Self::All(tests) => {
                let held: Vec<Option<bool>> = tests.iter().map(|test| test.holds(numbers)).collect();
                // One that fails is enough, whatever is missing of the others.
                if held.contains(&Some(false)) {
                    return Some(false);
                }
                held.into_iter().collect::<Option<Vec<_>>>().map(|_| true)?
            }
        })
    }

    /// Whether the numbers agree.
    #[must_use]
    pub fn verdict(&self, numbers: &Numbers) -> Verdict {
        match self.holds(numbers) {
            Some(true) => Verdict::Agrees,
            Some(false) => Verdict::DoesNot,
            None => Verdict::CannotTell(self.lacking(numbers)),
        }
    }

    /// What is missing, in words.
    fn lacking(&self, numbers: &Numbers) -> String {
        let lacking: Vec<&str> = self.names().into_iter().filter(|name| numbers.get(name).is_none()).collect();
        let stage = |name: &str| name.split('.').next().unwrap_or_default().to_owned();
        let Some(first) = lacking.first().map(|name| stage(name)) else { return String::new() };
        let of_stage = format!("{first}.");
        if numbers.0.keys().any(|name| name.starts_with(&of_stage)) {
            let named: Vec<String> = lacking.iter().map(|name| name.replacen('.', ": ", 1)).collect();
            format!("not found: {}", named.join(", "))
        } else {
            format!("there are no results of \"{first}\"")
        }
    }

    /// What came out, in words: every number that is known.
    #[must_use]
    pub fn found(&self, numbers: &Numbers) -> String {
        let known = self.names().into_iter().filter_map(|name| Some((name, numbers.get(name)?)));
        let all: Vec<String> = known.map(|(name, value)| format!("{} {}", called(name), rounded(value))).collect();
        all.join("; ")
    }

    /// What is taken for agreeing, in words.
    #[must_use]
    pub fn words(&self) -> String {
        match *self {
            Self::Between(name, low, high) if low == high => format!("{} is {}", called(name), rounded(low)),
            Self::Between(name, low, high) => format!("{} {} to {}", called(name), rounded(low), rounded(high)),
            Self::SizeAtMost(name, most) => format!("{} within {} of 0", called(name), rounded(most)),
            Self::SizeAtLeast(name, least) => format!("{} {} or more from 0", called(name), rounded(least)),
            Self::AtMost(name, most) => format!("{} up to {}", called(name), rounded(most)),
            Self::AtLeast(name, least) => format!("{} from {} on", called(name), rounded(least)),
            Self::Below(name, other, 1.0) => format!("{} below {}", called(name), called(other)),
            Self::Below(name, other, factor) => {
                format!("{} below {} x {}", called(name), rounded(factor), called(other))
            }
            Self::Ratio(name, other, low, high) => {
                format!("{} over {} {} to {}", called(name), called(other), rounded(low), rounded(high))
            }
            Self::All(tests) => tests.iter().map(Self::words).collect::<Vec<_>>().join("; "),
        }
    }

    /// Makes numbers with which it holds, or does not.
    #[cfg(test)]
    pub(super) fn make(&self, holds: bool, numbers: &mut Numbers) {
        let aside = |low: f64, high: f64| if holds { 0.5 * (low + high) } else { high + 1.0 + (high - low) };
        match *self {
            Self::Between(name, low, high) => numbers.set(name, aside(low, high)),
            Self::SizeAtMost(name, most) => numbers.set(name, if holds { -0.5 * most } else { -1.5 * most - 1.0 }),
            Self::SizeAtLeast(name, least) => numbers.set(name, if holds { -least } else { -0.5 * least }),
            Self::AtMost(name, most) => numbers.set(name, if holds { most - 1e-6 } else { most + 1.0 }),
            Self::AtLeast(name, least) => numbers.set(name, if holds { least + 1e-6 } else { least - 1.0 }),
            Self::Below(name, other, factor) => {
                let bound = factor * numbers.get(other).unwrap_or(1.0);
                numbers.set(other, bound / factor);
                // What another test of the same statement asks of it stands where it suits.
                if numbers.get(name).is_none_or(|own| (own < bound) != holds) {
                    numbers.set(name, if holds { bound - 0.5 * bound.abs() } else { bound + 0.5 * bound.abs() });
                }
            }
            Self::Ratio(name, other, low, high) => {
                let base = numbers.get(other).unwrap_or(1.0);
                numbers.set(other, base);
                numbers.set(name, base * aside(low, high));
            }
            Self::All(tests) => {
                // Twice: a later one may have moved what an earlier one stands on.
                for test in tests.iter().rev().chain(tests.iter().rev()) {
                    test.make(true, numbers);
                }
                if !holds {
                    tests[0].make(false, numbers);
                }
            }
        }
    }
}

/// A number's name in words: without the stage that it is of.
fn called(name: &str) -> String {
    let own = name.split_once('.').map_or(name, |(_, own)| own);
    own.replace(['.', '_'], " ")
}

/// Three digits.
fn rounded(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let decimals = (2 - value.abs().log10().floor() as i32).clamp(0, 9) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits() {
        let texts = [0.0, 0.01234, -1.5, 12.345, 1234.5, 0.999_96, -0.25].map(rounded);
        assert_eq!(texts, ["0", "0.0123", "-1.5", "12.3", "1234", "1", "-0.25"].map(str::to_owned));
    }

    #[test]
    fn what_fails_fails_whatever_is_missing_of_the_rest() {
        const BOTH: Test = Test::All(&[Test::AtMost("a.x", 1.0), Test::AtMost("b.y", 1.0)]);
        let mut numbers = Numbers::default();
        numbers.set("a.x", 2.0);
        assert_eq!(BOTH.verdict(&numbers), Verdict::DoesNot);
        numbers.set("a.x", 1.0);
        assert_eq!(BOTH.verdict(&numbers), Verdict::CannotTell("there are no results of \"b\"".to_owned()));
        numbers.set("b.z", 1.0);
        assert_eq!(BOTH.verdict(&numbers), Verdict::CannotTell("not found: b: y".to_owned()));
        assert_eq!(BOTH.found(&numbers), "x 1");
    }
}
