//! What a column may be that is not called as the contract calls it: `Timestamp`, `time (ms)`, `LED`, `PD 1`, `fz`.
//!
//! A name is taken apart into words and numbers, case and marks apart; the words have to be all of them known.

use crate::log::lines::stamps::TimeUnit;
use crate::log::naming::role::Role;

/// What may stand for the time, without its unit and with nothing between the words.
const TIMES: [&str; 23] = [
    "t",
    "ts",
    "time",
    "times",
    "timer",
    "timestamp",
    "timestamps",
    "datetime",
    "walltime",
    "walltimestamp",
    "systemtime",
    "unix",
    "unixtime",
    "unixtimestamp",
    "epoch",
    "epochtime",
    "elapsed",
    "elapsedtime",
    "lsltimestamp",
    "hosttime",
    "hosttimestamp",
    "utc",
    "xvalue",
];

/// What forces along x, y and z are called, without their unit.
const AXES: [[&str; 2]; 3] = [["fx", "forcex"], ["fy", "forcey"], ["fz", "forcez"]];

/// The role of a name, the contract's or one like it.
pub(in crate::log) fn role_of(name: &str) -> Option<Role> {
    Role::of(name).or_else(|| role_of_name(name))
}

pub(in crate::log) fn role_of_name(name: &str) -> Option<Role> {
    let words = words(name);
    let all: Vec<&str> = words.iter().map(String::as_str).collect();
    let (unit, base) = match all.split_last() {
        Some((last, rest)) => (TimeUnit::of_word(last), rest.concat()),
        None => return None,
    };
    let alone = base.is_empty() && all[0].len() > 2;
    if unit.is_some() && (alone || TIMES.contains(&&base[..])) || TIMES.contains(&&all.concat()[..]) {
        return Some(Role::Time);
    }
    if ["led", "ledon", "ledstate", "ledstatus"].contains(&&all.concat()[..]) {
        return Some(Role::Led);
    }
    if let ["p" | "pd" | "photodiode" | "diode", number] = without(&all, &["v", "volt", "volts"]) {
        return number.parse().ok().filter(|&n| n > 0).map(Role::Photodiode);
    }
    let force = without(&all, &["n", "newton", "newtons"]).concat();
    (0..3).find(|&axis| AXES[axis].contains(&&force[..])).map(|axis| Role::Force(axis as u8))
}

/// The photodiode that a name is of with more words behind it, as `P1_mV`, `P3_new`, `P3.1`.
pub(in crate::log) fn photodiode_with_more(name: &str) -> Option<u32> {
    match &words(name)[..] {
        [first, number, _, ..] if ["p", "pd", "photodiode", "diode"].contains(&first.as_str()) => {
            number.parse().ok().filter(|&number| number > 0)
        }
        _ => None,
    }
}

/// Whether a name is a force's in a unit that is not newtons.
pub(crate) fn is_force_in_another_unit(name: &str) -> bool {
    const UNITS: [&str; 11] = ["mn", "cn", "dn", "kn", "un", "g", "kg", "gf", "kgf", "lb", "lbf"];
    let whole = words(name).concat();
    let unit = AXES.iter().flatten().find_map(|force| whole.strip_prefix(force));
    unit.is_some_and(|unit| UNITS.contains(&unit))
}

/// The unit that the name of a time column ends in.
pub(in crate::log) fn unit_of_name(name: &str) -> Option<TimeUnit> {
    let words = words(name);
    let unit = TimeUnit::of_word(words.last()?)?;
    // A single letter alone is no unit: `s` may be anything.
    (words.len() > 1 || words[0].len() > 2).then_some(unit)
}

fn without<'a>(words: &'a [&'a str], units: &[&str]) -> &'a [&'a str] {
    match words.split_last() {
        Some((last, rest)) if units.contains(last) => rest,
        _ => words,
    }
}

/// The words and numbers of a name, in small letters; a capital after a small letter begins a word.
fn words(name: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    let mut before = ' ';
    for c in name.chars() {
        let kind = |c: char| (c.is_alphabetic(), c.is_numeric());
        let begins = kind(c) != kind(before) || before.is_lowercase() && c.is_uppercase();
        if c.is_alphanumeric() {
            let small = c.to_lowercase().map(|c| if c == 'µ' || c == 'μ' { 'u' } else { c });
            match words.last_mut() {
                Some(word) if !begins => word.extend(small),
                _ => words.push(small.collect()),
            }
        }
        before = c;
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn usual_names_are_known_and_others_are_not() {
        for (name, role) in [
            ("Time", Role::Time),
            ("time (ms)", Role::Time),
            ("Time[s]", Role::Time),
            ("timestamp_us", Role::Time),
            ("wallTimestamp", Role::Time),
            ("t", Role::Time),
            ("t_ns", Role::Time),
            ("Seconds", Role::Time),
            ("LED", Role::Led),
            ("led on", Role::Led),
            ("p3", Role::Photodiode(3)),
            ("PD_12", Role::Photodiode(12)),
            ("P1 (V)", Role::Photodiode(1)),
            ("photodiode 8", Role::Photodiode(8)),
            ("fz", Role::Force(2)),
            ("Force X [N]", Role::Force(0)),
            ("FY_N", Role::Force(1)),
        ] {
            assert_eq!(role_of_name(name), Some(role), "{name}");
        }
        for name in ["", "s", "ms", "time of day", "P1_mV", "P", "P0", "3", "pressure", "force", "timeout", "f", "µ"] {
            assert_eq!(role_of_name(name), None, "{name}");
        }
    }

    #[test]
    fn units_are_read_from_names() {
        for (name, unit) in [
            ("time_s", Some(TimeUnit::Seconds)),
            ("time (ms)", Some(TimeUnit::Milliseconds)),
            ("timeMs", Some(TimeUnit::Milliseconds)),
            ("t [µs]", Some(TimeUnit::Microseconds)),
            ("timestamp_ns", Some(TimeUnit::Nanoseconds)),
            ("milliseconds", Some(TimeUnit::Milliseconds)),
            ("time", None),
            ("s", None),
        ] {
            assert_eq!(unit_of_name(name), unit, "{name}");
        }
    }
}
