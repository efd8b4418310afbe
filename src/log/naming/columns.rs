//! Which column of a file is time, LED, photodiode, force: as the user says, by the contract's names, by a guess.
//!
//! In: the names in the file's header and the user's mapping. Out: a [`Choice`]. A name that the user gives is looked
//! for as it is, then without regard to case; `#2` is the second column, whatever its name. Then come the contract's
//! own names; then, for what is still not found, [`guess`](crate::log::naming::guess), which only counts where a single
//! column answers to it and is reported.

use std::collections::{HashMap, HashSet};
use std::num::NonZeroUsize;

use crate::log::lines::stamps::TimeUnit;
use crate::log::naming::guess;
use crate::log::naming::role::Role;

/// All names of the contract, for messages.
const NAMES: &str = "time_s, led, P1, P2, .., VP1, VP2, .., Fx_N, Fy_N, Fz_N, pf1_Pa, pf2_Pa, ph_Pa, pl_Pa";

/// What the user says about a log's columns; the default says nothing and takes the contract's names.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Columns {
    named: Vec<(Role, String)>,
    /// The unit of time stamps that are numbers; none: as the column's name says, else seconds.
    pub time_unit: Option<TimeUnit>,
    /// Of a log whose clock was reset, which stretch to take, counted from 1; none: the log has to be in one piece.
    pub piece: Option<NonZeroUsize>,
    /// Of a recording with several streams, the name of the one to take.
    pub stream: Option<String>,
}

/// The columns chosen.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::log) struct Choice {
    /// What each column that is used is for, and where it stands; in the file's order.
    pub(in crate::log) columns: Vec<(Role, usize)>,
    /// The unit of time stamps that are numbers, if known.
    pub(in crate::log) time_unit: Option<TimeUnit>,
    /// What was guessed.
    pub(in crate::log) notes: Vec<String>,
}

impl Columns {
    /// Reads a mapping such as `P1=ch_3,P2=ch_4,time_s=timestamp,Fz_N=fz`: the contract's name, then the file's. The
    /// file's name may stand in double quotes, and `#2` means its second column.
    ///
    /// # Errors
    /// What is wrong and what to write instead.
    pub fn parse(text: &str) -> Result<Self, String> {
        const EXAMPLE: &str = "write it as time_s=timestamp,P1=ch_3,Fz_N=fz";
        let mut named: Vec<(Role, String)> = Vec::new();
        for pair in split_outside_quotes(text) {
            let Some((ours, theirs)) = pair.split_once('=') else {
                return Err(format!("`{}` has no `=`; {EXAMPLE}", pair.trim()));
            };
            let (ours, theirs) = (ours.trim(), theirs.trim());
            let theirs = theirs.strip_prefix('"').and_then(|t| t.strip_suffix('"')).unwrap_or(theirs);
            let Some(role) = Role::of(ours) else {
                return Err(format!("`{ours}` is none of {NAMES}; {EXAMPLE}"));
            };
            if theirs.is_empty() {
                return Err(format!("`{ours}=` names no column of the file; {EXAMPLE}"));
            }
            if named.iter().any(|(known, _)| *known == role) {
                return Err(format!("`{ours}` is given twice; {EXAMPLE}"));
            }
            if let Some((known, _)) = named.iter().find(|(_, name)| name == theirs) {
                return Err(format!("column `{theirs}` is given to both {} and {ours}; {EXAMPLE}", known.name()));
            }
            named.push((role, theirs.to_owned()));
        }
        Ok(Self { named, ..Self::default() })
    }

    /// Chooses among the columns of a file; `stamped` are those without a name whose first cell is a date.
    pub(in crate::log) fn choose(&self, names: &[String], stamped: &[usize]) -> Result<Choice, String> {
        let choice = self.found(names, stamped)?;
        let columns = &choice.columns;
        if !columns.iter().any(|(role, _)| *role == Role::Time) {
            return Err(format!(
                "no time column found; its columns are {}; say which is the time, as in --columns \"time_s={}\", \
                 and with --time-unit what it counts if not seconds",
                listed(names),
                shown(names.first().map_or("", String::as_str), 0)
            ));
        }
        // Pressures alone are a log as well: `lunula simulate --loads` needs no more.
        if !columns.iter().any(|(role, _)| role.is_light() || matches!(role, Role::Pressure(_))) {
            let places = Known::of(columns).places;
            let other = (0..names.len()).find(|k| !places.contains(k));
            let remedy = match other {
                Some(k) => format!("say which they are, in volts, as in --columns \"P1={}\"", shown(&names[k], k)),
                None => "record at least one".to_owned(),
            };
            return Err(format!("no photodiode found; its columns are {}; {remedy}", listed(names)));
        }
        Ok(choice)
    }

    /// What there is, be it enough or not.
    pub(in crate::log) fn found(&self, names: &[String], stamped: &[usize]) -> Result<Choice, String> {
        let mut columns: Vec<(Role, usize)> = Vec::new();
        let mut notes = Vec::new();
        for (role, name) in &self.named {
            let column = place_of(name, names)?;
            if let Some((known, _)) = columns.iter().find(|(_, at)| *at == column) {
                return Err(format!("column `{name}` is given to both {} and {}", known.name(), role.name()));
            }
            if matches!(role, Role::Force(_)) && guess::is_force_in_another_unit(&names[column]) {
                return Err(format!(
                    "column `{}` is given as {}, which is in newtons, and names another unit; write newtons (1 kgf is \
                     9.80665, 1 lbf 4.44822), or take the unit out of the name where it holds newtons",
                    names[column],
                    role.name()
                ));
            }
            columns.push((*role, column));
        }
        let mapped: HashSet<Role> = columns.iter().map(|(role, _)| *role).collect();
        let mut known = Known::of(&columns);
        for (k, name) in names.iter().enumerate() {
            let Some(role) = Role::of(name).filter(|role| *role != Role::Contact) else { continue };
            if known.places.contains(&k) {
                continue;
            }
            if mapped.contains(&role) {
                notes.push(format!("column `{name}` is not read: --columns takes {} from another", role.name()));
                continue;
            }
            if known.roles.contains(&role) {
                return Err(format!("two columns are named `{name}`; rename one"));
            }
            known.add(role, k);
            columns.push((role, k));
        }
        add_guesses(names, stamped, &mut known, &mut columns, &mut notes)?;
        for name in names.iter().filter(|name| guess::is_force_in_another_unit(name)) {
            notes.push(format!("column `{name}` is a force that is not in newtons, and is not read; write newtons"));
        }
        notes.extend(unread_photodiodes(names, &columns));
        let time = columns.iter().find(|(role, _)| *role == Role::Time).map(|&(_, at)| at);
        let time_unit = self.time_unit.or_else(|| guess::unit_of_name(&names[time?]));
        columns.sort_by_key(|&(_, at)| at);
        Ok(Choice { columns, time_unit, notes })
    }
}

/// What to say of columns that look like photodiodes and are not read, where others are.
fn unread_photodiodes(names: &[String], columns: &[(Role, usize)]) -> Vec<String> {
    let known = Known::of(columns);
    let unread = |(k, name): (usize, &String)| {
        let number = guess::photodiode_with_more(name).filter(|_| !known.places.contains(&k))?;
        (!known.roles.contains(&Role::Photodiode(number)))
            .then(|| format!("column `{name}` may be a photodiode, and is not read; call it P{number}, in volts"))
    };
    if !columns.iter().any(|(role, _)| matches!(role, Role::Photodiode(_))) {
        return Vec::new();
    }
    let zeroth = names.iter().find(|name| name.eq_ignore_ascii_case("P0")).map(|name| {
        format!("column `{name}` is not read, as photodiodes are counted from 1; where it is one, call them P1, P2, ..")
    });
    names.iter().enumerate().filter_map(unread).chain(zeroth).collect()
}

/// What to say of a table's columns that look like photodiodes and have no name of the contract, where others have.
pub(crate) fn photodiodes_not_read(names: &[String]) -> Vec<String> {
    let roles = names.iter().enumerate().filter_map(|(k, name)| Some((Role::of(name)?, k)));
    unread_photodiodes(names, &roles.collect::<Vec<_>>())
}

/// The roles and places that are taken.
struct Known {
    roles: HashSet<Role>,
    places: HashSet<usize>,
}

impl Known {
    fn of(columns: &[(Role, usize)]) -> Self {
        Self {
            roles: columns.iter().map(|(role, _)| *role).collect(),
            places: columns.iter().map(|(_, at)| *at).collect(),
        }
    }

    fn add(&mut self, role: Role, at: usize) {
        self.roles.insert(role);
        self.places.insert(at);
    }
}

fn add_guesses(
    names: &[String],
    stamped: &[usize],
    known: &mut Known,
    columns: &mut Vec<(Role, usize)>,
    notes: &mut Vec<String>,
) -> Result<(), String> {
    let mut guesses: Vec<(Role, usize)> = (0..names.len())
        .filter(|k| !known.places.contains(k))
        .filter_map(|k| Some((guess::role_of_name(&names[k])?, k)))
        .filter(|(role, _)| !known.roles.contains(role))
        .collect();
    let timed = known.roles.contains(&Role::Time) || guesses.iter().any(|(role, _)| *role == Role::Time);
    if !timed && let [only] = stamped.iter().filter(|k| !known.places.contains(k)).collect::<Vec<_>>()[..] {
        guesses.push((Role::Time, *only));
    }
    let mut rivals: HashMap<Role, Vec<usize>> = HashMap::new();
    for &(role, at) in &guesses {
        rivals.entry(role).or_default().push(at);
    }
    for &(role, at) in &guesses {
        if let [first, _, ..] = rivals[&role][..] {
            return Err(format!(
                "{} could be any of {}; say which, as in --columns \"{}={}\"",
                role.name(),
                rivals[&role].iter().map(|&k| format!("`{}`", names[k])).collect::<Vec<_>>().join(", "),
                role.name(),
                names[first]
            ));
        }
        notes.push(format!(
            "column `{}` is taken as {}; rename it where it is not",
            shown(&names[at], at),
            role.name()
        ));
        known.add(role, at);
        columns.push((role, at));
    }
    Ok(())
}

/// Whether a column of this name says when the LED was on.
pub(in crate::log) fn is_led(name: &str) -> bool {
    guess::role_of(name) == Some(Role::Led)
}

/// Where the column stands that the user calls `name`.
fn place_of(name: &str, names: &[String]) -> Result<usize, String> {
    let exact: Vec<usize> = (0..names.len()).filter(|&k| names[k] == name).collect();
    let alike = || (0..names.len()).filter(|&k| names[k].to_lowercase() == name.to_lowercase()).collect();
    let found: Vec<usize> = if exact.is_empty() { alike() } else { exact };
    match found[..] {
        [only] => return Ok(only),
        [] => {}
        _ => return Err(format!("two columns are named `{name}`; name it by its place, as in `#{}`", found[0] + 1)),
    }
    if let Some(place) = name.strip_prefix('#').and_then(|digits| digits.parse::<usize>().ok())
        && (1..=names.len()).contains(&place)
    {
        return Ok(place - 1);
    }
    let near =
        names.iter().map(|n| (strsim::normalized_damerau_levenshtein(&n.to_lowercase(), &name.to_lowercase()), n));
    let near = near.filter(|(alike, _)| *alike >= 0.6).max_by(|a, b| a.0.total_cmp(&b.0));
    let help = near.map(|(_, n)| format!("; is it `{n}`?")).unwrap_or_default();
    Err(format!("has no column `{name}`{help}; its columns are {}", listed(names)))
}

fn listed(names: &[String]) -> String {
    const MOST: usize = 40;
    let mut all: Vec<String> = names.iter().enumerate().take(MOST).map(|(k, name)| shown(name, k)).collect();
    if names.len() > MOST {
        all.push(format!(".. ({} in all)", names.len()));
    }
    all.join(", ")
}

/// A column's name as the user may write it.
fn shown(name: &str, at: usize) -> String {
    if name.is_empty() { format!("#{}", at + 1) } else { name.to_owned() }
}

/// The parts between commas that do not stand in double quotes; empty ones left out.
fn split_outside_quotes(text: &str) -> Vec<&str> {
    let mut quoted = false;
    let parts = text.split(|c: char| {
        quoted ^= c == '"';
        c == ',' && !quoted
    });
    parts.filter(|part| !part.trim().is_empty()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(text: &str) -> Vec<String> {
        text.split('|').map(str::to_owned).collect()
    }

    /// `role@place`, the notes.
    fn chosen(columns: &str, header: &str) -> Result<(String, usize), String> {
        let choice = Columns::parse(columns).unwrap().choose(&names(header), &[])?;
        let all: Vec<String> = choice.columns.iter().map(|(role, at)| format!("{}@{at}", role.name())).collect();
        Ok((all.join(" "), choice.notes.len()))
    }

    #[test]
    fn mappings_are_read_or_refused_in_words() {
        let read = Columns::parse(" time_s = timestamp , P12=\"a, b\",Fz_N=fz,").unwrap();
        let [time, photodiode, force] = &read.named[..] else { panic!("{read:?}") };
        assert_eq!((time.1.as_str(), &photodiode.1[..], force.1.as_str()), ("timestamp", "a, b", "fz"));
        assert_eq!((photodiode.0, force.0), (Role::Photodiode(12), Role::Force(2)));
        for (bad, words) in [
            ("P1", "no `=`"),
            ("P01=a", "`P01` is none of"),
            ("p1=a", "`p1` is none of"),
            ("P1=", "names no column"),
            ("P1=a,P1=b", "given twice"),
            ("P1=a,P2=a", "both P1 and P2"),
        ] {
            let error = Columns::parse(bad).unwrap_err();
            assert!(error.contains(words) && error.contains("P1=ch_3"), "{error}");
        }
        assert_eq!(Columns::parse("").unwrap(), Columns::default());
    }

    #[test]
    fn the_contracts_names_need_no_mapping_and_a_mapping_wins() {
        assert_eq!(chosen("", "time_s|led|P1|x|Fz_N").unwrap(), ("time_s@0 led@1 P1@2 Fz_N@4".to_owned(), 0));
        assert_eq!(chosen("P1=P2,P2=P1", "time_s|P1|P2").unwrap().0, "time_s@0 P2@1 P1@2");
        // The file's own P1 is not read, which is said.
        assert_eq!(chosen("P1=P3", "time_s|P1|P3").unwrap(), ("time_s@0 P1@2".to_owned(), 1));
        assert_eq!(chosen("time_s=#1,P1=B", "|b|c").unwrap(), ("time_s@0 P1@1".to_owned(), 0));
    }

    #[test]
    fn guesses_are_told_and_count_only_alone() {
        assert_eq!(
            chosen("", "Timestamp|LED|p1|PD 2|fx|note").unwrap(),
            ("time_s@0 led@1 P1@2 P2@3 Fx_N@4".to_owned(), 5)
        );
        let error = chosen("P1=v", "time|timestamp|v").unwrap_err();
        assert!(error.contains("`time`, `timestamp`") && error.contains("time_s=time"), "{error}");
        assert_eq!(chosen("P1=v,time_s=time", "time|timestamp|v").unwrap().0, "time_s@0 P1@2");
    }

    #[test]
    fn what_is_not_found_is_told_with_the_names_there_are() {
        let error = chosen("P1=chan3", "time_s|chan_3|x").unwrap_err();
        assert!(error.contains("is it `chan_3`?") && error.contains("time_s, chan_3, x"), "{error}");
        let error = chosen("", "hr|P1").unwrap_err();
        assert!(error.contains("no time column") && error.contains("--columns \"time_s=hr\""), "{error}");
        let error = chosen("", "time_s|hr").unwrap_err();
        assert!(error.contains("no photodiode") && error.contains("--columns \"P1=hr\""), "{error}");
        assert!(chosen("", "time_s|Fz_N").unwrap_err().ends_with("its columns are time_s, Fz_N; record at least one"));
        assert!(chosen("", "time_s|P1|P1").unwrap_err().contains("two columns are named `P1`"));
        assert!(chosen("P2=v", "time_s|P1|v|v").unwrap_err().contains("`#3`"));
    }

    #[test]
    fn a_force_in_another_unit_is_said() {
        for given in ["Fz_N=fz_kgf", "Fz_N=#3"] {
            let error = chosen(given, "time_s|P1|fz_kgf").unwrap_err();
            assert!(error.contains("column `fz_kgf` is given as Fz_N, which is in newtons"), "{error}");
        }
        let choice = Columns::default().choose(&names("time_s|P1|Fz (mN)|fy kgf|Fx_N"), &[]).unwrap();
        assert_eq!(choice.columns.len(), 3);
        let [one, other] = &choice.notes[..] else { panic!("{:?}", choice.notes) };
        assert!(one.contains("`Fz (mN)` is a force that is not in newtons") && other.contains("`fy kgf`"), "{one}");
    }

    #[test]
    fn a_nameless_column_of_dates_is_the_time() {
        let columns = Columns::parse("P1=a").unwrap();
        let choice = columns.choose(&names("|a|b"), &[0]).unwrap();
        assert_eq!((choice.columns[0], choice.notes.len()), ((Role::Time, 0), 1));
        assert!(columns.choose(&names("|a|b"), &[]).is_err());
    }
}
