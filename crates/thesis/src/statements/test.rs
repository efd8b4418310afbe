//! What decides whether numbers agree with words: quantities by name, and relations between them.

use std::collections::BTreeMap;

use serde::Deserialize;

use crate::Numbers;

/// What a quantity is compared with.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(untagged)]
pub(super) enum Bound {
    Number(f64),
    Quantity(String),
    All(Vec<String>),
}

/// A relation and its threshold, as they are written.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Relation {
    Is(f64),
    /// A quarter more or less.
    About(f64),
    Within([f64; 2]),
    AtMost(f64),
    AtLeast(f64),
    Below(Bound),
    Above(Bound),
}

/// How far off "about" may be, as a share.
const ABOUT: f64 = 0.25;

impl Relation {
    fn holds(&self, value: f64, bound: Option<f64>) -> Option<bool> {
        Some(match *self {
            Self::Is(x) => value == x,
            Self::About(x) => (value - x).abs() <= ABOUT * x.abs(),
            Self::Within([low, high]) => (low..=high).contains(&value),
            Self::AtMost(x) => value <= x,
            Self::AtLeast(x) => value >= x,
            Self::Below(_) => value < bound?,
            Self::Above(_) => value > bound?,
        })
    }

    fn bound(&self) -> Option<&Bound> {
        if let Self::Below(bound) | Self::Above(bound) = self { Some(bound) } else { None }
    }

    /// In words, numbers followed by their unit.
    pub(super) fn words(&self, unit: &str) -> String {
        let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
        let bound = |bound: &Bound| match bound {
            Bound::Number(x) => format!("{}{unit}", rounded(*x)),
            Bound::Quantity(name) => name.clone(),
            Bound::All(names) => names.join(" and "),
        };
        match self {
            Self::Is(x) => format!("is {}{unit}", rounded(*x)),
            Self::About(x) => format!("about {}{unit}", rounded(*x)),
            Self::Within([low, high]) => format!("{} to {}{unit}", rounded(*low), rounded(*high)),
            Self::AtMost(x) => format!("at most {}{unit}", rounded(*x)),
            Self::AtLeast(x) => format!("at least {}{unit}", rounded(*x)),
            Self::Below(other) => format!("below {}", bound(other)),
            Self::Above(other) => format!("above {}", bound(other)),
        }
    }
}

/// A quantity, its size without the sign, or a quotient of two.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Operand {
    name: String,
    over: Option<String>,
    size: bool,
}

impl Operand {
    /// Reads `a`, `|a|`, `a / b` or `|a / b|`.
    pub(super) fn new(text: &str) -> Self {
        let inner = text.strip_prefix('|').and_then(|text| text.strip_suffix('|'));
        let (name, over) = match inner.unwrap_or(text).split_once(" / ") {
            Some((name, over)) => (name, Some(over.to_owned())),
            None => (inner.unwrap_or(text), None),
        };
        Self { name: name.to_owned(), over, size: inner.is_some() }
    }

    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        std::iter::once(self.name.as_str()).chain(self.over.as_deref())
    }

    fn value(&self, numbers: &Numbers) -> Option<f64> {
        let value = match &self.over {
            None => numbers.get(&self.name)?,
            Some(over) => numbers.get(&self.name)? / numbers.get(over)?,
        };
        Some(if self.size { value.abs() } else { value }).filter(|value| value.is_finite())
    }

    /// What is known of it, in words; of a quotient both quantities, too. Names are without the `part` before them.
    fn found(&self, numbers: &Numbers, part: &str) -> Option<String> {
        let known = |name: &str| {
            let value = rounded(numbers.get(name)?);
            Some(format!("{} {value}", name.strip_prefix(part).unwrap_or(name)))
        };
        let Some(over) = &self.over else { return known(&self.name) };
        match (known(&self.name), known(over), self.value(numbers)) {
            (Some(a), Some(b), Some(value)) => Some(format!("{a} / {b} = {}", rounded(value))),
            (Some(a), Some(b), None) => Some(format!("{a} / {b}")),
            (a, b, _) => a.or(b),
        }
    }
}

/// One relation that is to hold.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Condition {
    left: Operand,
    relation: Relation,
    /// Where the relation is to another quantity.
    right: Option<Operand>,
}

impl Condition {
    /// The conditions that a written one stands for: of each alternative, and of each quantity it is compared with.
    ///
    /// # Errors
    /// A `{}` that stands for nothing.
    pub(super) fn all(quantity: &str, relation: &Relation) -> Result<Vec<Self>, String> {
        let mut all = Vec::new();
        for (name, chosen) in expanded(quantity)? {
            let rights = match relation.bound() {
                None | Some(Bound::Number(_)) => vec![None],
                Some(Bound::Quantity(other)) => vec![Some(filled(other, &chosen)?)],
                Some(Bound::All(others)) => {
                    others.iter().map(|other| filled(other, &chosen).map(Some)).collect::<Result<_, _>>()?
                }
            };
            all.extend(rights.into_iter().map(|right| Self {
                left: Operand::new(&name),
                relation: relation.clone(),
                right: right.as_deref().map(Operand::new),
            }));
        }
        Ok(all)
    }

    /// The quantities that it depends on.
    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        self.left.names().chain(self.right.iter().flat_map(Operand::names))
    }

    /// What is known of both sides, in words.
    pub(super) fn found(&self, numbers: &Numbers, part: &str) -> Vec<String> {
        std::iter::once(&self.left).chain(&self.right).filter_map(|one| one.found(numbers, part)).collect()
    }

    /// The unit of its threshold: that of its quantity; a quotient has none.
    pub(super) fn unit<'a>(&self, units: &BTreeMap<&str, &'a str>) -> &'a str {
        if self.left.over.is_some() { "" } else { units.get(self.left.name.as_str()).copied().unwrap_or_default() }
    }

    /// Whether it holds; none where a number is missing, or a quotient is none.
    pub(super) fn holds(&self, numbers: &Numbers) -> Option<bool> {
        let bound = match (&self.right, self.relation.bound()) {
            (Some(right), _) => Some(right.value(numbers)?),
            (None, Some(Bound::Number(x))) => Some(*x),
            _ => None,
        };
        self.relation.holds(self.left.value(numbers)?, bound)
    }
}

/// What a pattern stands for, and which alternative was taken of each of its groups: `P{1,2}` is `P1` and `P2`.
///
/// # Errors
/// A `{}` without a group before it, a group that does not end.
pub(super) fn expanded(pattern: &str) -> Result<Vec<(String, Vec<String>)>, String> {
    let mut found = vec![(String::new(), Vec::new())];
    let mut rest = pattern;
    while let Some((before, group)) = rest.split_once('{') {
        let Some((group, after)) = group.split_once('}') else { return Err(format!("{pattern}: {{ without }}")) };
        // "{}" is left for `filled`.
        let own: Vec<&str> = if group.is_empty() { vec!["{}"] } else { group.split(',').collect() };
        found = found
            .iter()
            .flat_map(|(text, chosen)| own.iter().map(move |own| (format!("{text}{before}{own}"), chosen, *own)))
            .map(|(text, chosen, own)| {
                let more = (own != "{}").then(|| own.to_owned());
                (text, chosen.iter().cloned().chain(more).collect())
            })
            .collect();
        rest = after;
    }
    let whole = |(text, chosen): (String, Vec<String>)| Ok((filled(&format!("{text}{rest}"), &chosen)?, chosen));
    found.into_iter().map(whole).collect()
}

/// With what was chosen in place of each `{}`, in turn; the last one for all that follow.
fn filled(text: &str, chosen: &[String]) -> Result<String, String> {
    let (mut all, mut at) = (String::new(), 0);
    for (k, part) in text.split("{}").enumerate() {
        if k > 0 {
            let Some(own) = chosen.get(at).or(chosen.last()) else {
                return Err(format!("{text}: {{}} stands for nothing; the quantity has no alternatives"));
            };
            all.push_str(own);
            at += 1;
        }
        all.push_str(part);
    }
    Ok(all)
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

    fn holds(quantity: &str, relation: &Relation, values: &[(&str, f64)]) -> Vec<Option<bool>> {
        let mut numbers = Numbers::default();
        values.iter().for_each(|(name, value)| numbers.set(*name, *value));
        Condition::all(quantity, relation).unwrap().iter().map(|one| one.holds(&numbers)).collect()
    }

    #[test]
    fn relations_hold_up_to_their_ends() {
        let of = |relation: &Relation, value: f64| holds("a", relation, &[("a", value)])[0];
        for (relation, yes, no) in [
            (Relation::Is(5.0), [5.0, 5.0], [5.1, 4.9]),
            (Relation::About(-4.0), [-5.0, -3.0], [-5.1, -2.9]),
            (Relation::Within([1.0, 2.0]), [1.0, 2.0], [0.9, 2.1]),
            (Relation::AtMost(1.0), [1.0, -9.0], [1.1, 9.0]),
            (Relation::AtLeast(1.0), [1.0, 9.0], [0.9, -9.0]),
            (Relation::Below(Bound::Number(0.0)), [-0.1, -9.0], [0.0, 0.1]),
            (Relation::Above(Bound::Number(0.0)), [0.1, 9.0], [0.0, -0.1]),
        ] {
            assert_eq!(yes.map(|value| of(&relation, value)), [Some(true); 2], "{relation:?}");
            assert_eq!(no.map(|value| of(&relation, value)), [Some(false); 2], "{relation:?}");
        }
    }

    #[test]
    fn sizes_and_quotients_are_taken_and_what_is_no_number_is_not_judged() {
        let values = [("a", -2.0), ("b", 4.0), ("zero", 0.0)];
        assert_eq!(holds("|a|", &Relation::Is(2.0), &values), [Some(true)]);
        assert_eq!(holds("a / b", &Relation::Is(-0.5), &values), [Some(true)]);
        assert_eq!(holds("|a / b|", &Relation::Is(0.5), &values), [Some(true)]);
        assert_eq!(holds("a / zero", &Relation::AtMost(9.0), &values), [None]);
        assert_eq!(holds("c", &Relation::AtMost(9.0), &values), [None]);
        let below = |other: &str| Relation::Below(Bound::Quantity(other.to_owned()));
        assert_eq!(holds("a", &below("b / a"), &values), [Some(false)]);
        assert_eq!(holds("a", &below("c"), &values), [None]);
        let mut numbers = Numbers::default();
        values.iter().for_each(|(name, value)| numbers.set(format!("p.{name}"), *value));
        let found = |text: &str, part: &str| Operand::new(text).found(&numbers, part);
        assert_eq!(found("|p.a / p.b|", "p."), Some("a -2 / b 4 = 0.5".to_owned()));
        assert_eq!(found("p.a / p.zero", ""), Some("p.a -2 / p.zero 0".to_owned()));
        assert_eq!((found("p.c / p.b", ""), found("p.c", "")), (Some("p.b 4".to_owned()), None));
    }

    #[test]
    fn groups_stand_for_each_of_their_alternatives() {
        let below = Relation::Below(Bound::All(vec!["y.{}.{}".to_owned(), "z.{}".to_owned()]));
        let all = Condition::all("x.{1,2}.{a,b} / w.{}", &below).unwrap();
        let names: Vec<Vec<&str>> = all.iter().map(|one| one.names().collect()).collect();
        assert_eq!(names.len(), 8);
        assert_eq!((&names[0], &names[1]), (&vec!["x.1.a", "w.1", "y.1.a"], &vec!["x.1.a", "w.1", "z.1"]));
        assert_eq!(names[6], ["x.2.b", "w.2", "y.2.b"]);
        assert!(Condition::all("x", &below).unwrap_err().contains("y.{}.{}"));
        assert!(expanded("x.{1,2").is_err() && expanded("{}").is_err());
    }

    #[test]
    fn numbers_have_three_digits() {
        let texts = [0.0, 0.01234, -1.5, 12.345, 1234.5, 0.999_96, -0.25].map(rounded);
        assert_eq!(texts, ["0", "0.0123", "-1.5", "12.3", "1234", "1", "-0.25"].map(str::to_owned));
    }
}
