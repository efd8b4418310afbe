//! The rows of a recording: time, and for each finger its force and what a gate says of it.
//!
//! In: a table with `time_s` and forces by the contract's names, or any lab's log. Out: [`Rows`].

use std::path::Path;

use crate::live::error::LiveError;
use crate::log::{Columns, Log, LogError};
use crate::table::{Table, TableError, column_names};

const TIME: &str = "time_s";
pub(super) const FORCE: &str = "Fz_N";
const CONTACT: &str = "contact";
/// Of a session of several fingers: whose a row is.
const FINGER: &str = "finger";
/// Which trial a row is of, and whose.
const TRIAL: &str = "trial";
const SUBJECT: &str = "subject";
/// More fingers are something else.
const MOST_FINGERS: usize = 20;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Gate {
    Touch,
    Bending,
    Unknown,
}

/// What is recorded of one finger.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Finger {
    pub(super) name: String,
    /// The force of the finger on the surface, newtons, pressing negative; NaN where it is not known.
    pub(super) fz_n: Vec<f64>,
    /// Empty where there is no gate.
    pub(super) gate: Vec<Gate>,
    /// Angles by their columns, degrees; NaN where not known. None are read without a gate.
    pub(super) angles: Vec<(String, Vec<f64>)>,
    /// Which rows are this finger's; all where a row has every finger's force.
    pub(super) own: Option<Vec<bool>>,
}

/// A recording.
#[derive(Debug, Clone, Default)]
pub(super) struct Rows {
    /// NaN where a row has no time.
    pub(super) time_s: Vec<f64>,
    pub(super) fingers: Vec<Finger>,
    /// The columns `trial` and `subject`, where they exist.
    pub(super) trial: Option<Vec<Option<String>>>,
    pub(super) subject: Option<Vec<Option<String>>>,
    /// Where rows are in the file; none of a log, whose time is checked.
    pub(super) table: Option<Table>,
    /// Whether there are angles that no gate says anything of.
    pub(super) angles_without_gate: bool,
    /// What is worth saying on the file.
    pub(super) notes: Vec<String>,
    /// Columns that are not read and whose names are near to those that are.
    pub(super) warnings: Vec<String>,
}

/// Reads a recording; `finger` is the name of a plain `Fz_N`.
pub(super) fn read(path: &Path, finger: &str) -> Result<Rows, LiveError> {
    match column_names(path) {
        Ok(names) if names.iter().any(|name| name == TIME) && names.iter().any(|name| is_force(name)) => {
            of_table(path, finger)
        }
        Ok(_) | Err(TableError::Extension(_)) => of_log(path, finger),
        Err(why) => Err(why.into()),
    }
}

/// Whether a column is a finger's normal force.
fn is_force(name: &str) -> bool {
    name == FORCE || finger_of(name, FORCE).is_some()
}

fn finger_of<'a>(name: &'a str, column: &str) -> Option<&'a str> {
    name.strip_suffix(column)?.strip_suffix('.').filter(|finger| !finger.is_empty())
}

fn of_log(path: &Path, finger: &str) -> Result<Rows, LiveError> {
    let log = Log::read(path, &Columns::default()).map_err(|why| match why {
        LogError::Columns { .. } => {
            let what = "is neither a table with time_s and Fz_N (or FINGER.Fz_N for each of several fingers) nor a log \
                        of photodiodes; name its columns so";
            LiveError::recording(path, what)
        }
        why => why.into(),
    })?;
    let Some(force) = log.forces.into_iter().find(|force| force.name == FORCE) else {
        let what = "has no normal force; name its column Fz_N, or FINGER.Fz_N for each of several fingers (pressing is \
                    negative)";
        return Err(LiveError::recording(path, what));
    };
    let one = Finger { name: finger.to_owned(), fz_n: force.values, gate: Vec::new(), angles: Vec::new(), own: None };
    Ok(Rows { time_s: log.time_s, fingers: vec![one], notes: log.notes, ..Rows::default() })
}

fn of_table(path: &Path, plain: &str) -> Result<Rows, LiveError> {
    let table = Table::read(path)?;
    let mut fingers: Vec<Finger> = Vec::new();
    let (mut angles_without_gate, mut notes) = (false, Vec::new());
    for column in table.names().iter().filter(|name| is_force(name)) {
        let own = finger_of(column, FORCE);
        let name = own.unwrap_or(plain).to_owned();
        if fingers.iter().any(|other| other.name == name) {
            let what = format!("two columns are the force of `{name}`; choose another --finger for {FORCE}");
            return Err(LiveError::recording(path, &what));
        }
        let dotted = |column: &str| own.map_or(column.to_owned(), |own| format!("{own}.{column}"));
        let gate = [dotted(CONTACT), CONTACT.to_owned()].into_iter().find(|name| table.has(name));
        let gate = match gate {
            Some(gate) if is_flag(&table, &gate)? => {
                notes.push(format!("column `{gate}` is 0 or 1, whether the finger touches, and is not read"));
                None
            }
            gate => gate.map(|gate| gates(&table, &gate)).transpose()?,
        };
        let angles = table.names().iter().filter(|name| is_angle(name, own));
        let angles = match gate {
            Some(_) => angles.map(|name| Ok((name.clone(), table.values(name)?))).collect::<Result<_, TableError>>()?,
            None => {
                angles_without_gate |= angles.count() > 0;
                Vec::new()
            }
        };
        let fz_n = table.values(column)?;
        fingers.push(Finger { name, fz_n, gate: gate.unwrap_or_default(), angles, own: None });
    }
    if table.has(FINGER) {
        fingers = by_row(path, fingers, &table.texts(FINGER)?)?;
    }
    if fingers.len() > MOST_FINGERS {
        let what = format!("has forces of {} fingers; {MOST_FINGERS} are the most", fingers.len());
        return Err(LiveError::recording(path, &what));
    }
    let texts = |name: &str| table.has(name).then(|| table.texts(name)).transpose();
    Ok(Rows {
        time_s: table.values(TIME)?,
        trial: texts(TRIAL)?,
        subject: texts(SUBJECT)?,
        fingers,
        angles_without_gate,
        warnings: not_read(table.names()),
        table: Some(table),
        notes,
    })
}

/// Columns that are not read and whose names are near to those that are, in words.
fn not_read(names: &[String]) -> Vec<String> {
    let near = |name: &String| {
        let known = [TRIAL, SUBJECT, FINGER, CONTACT].into_iter().find(|known| name.trim().eq_ignore_ascii_case(known));
        known.map(|known| (known.to_owned(), "")).or_else(|| Some((force_near(name)?, ", in newtons")))
    };
    let said = |name: &String| {
        let (near, unit) = near(name).filter(|(near, _)| !names.contains(near))?;
        Some(format!("`{name}` is not read; is it `{near}`{unit}?"))
    };
    names.iter().filter_map(said).collect()
}

/// What a column is called if it is a normal force: `middle.Fz_N` of `middle_FZ`.
fn force_near(name: &str) -> Option<String> {
    const UNITS: [&str; 6] = ["", "n", "mn", "newton", "newtons", "g"];
    let is_mark = |c: char| !c.is_alphanumeric();
    let lower = name.to_ascii_lowercase();
    let at = lower.rfind("fz")?;
    let (finger, unit) = (&name[..at], lower[at + 2..].trim_matches(is_mark));
    if !UNITS.contains(&unit) || !finger.is_empty() && !finger.ends_with(is_mark) {
        return None;
    }
    match finger.trim_end_matches(is_mark) {
        "" => Some(FORCE.to_owned()),
        finger => Some(format!("{finger}.{FORCE}")),
    }
}

/// The fingers of a table whose rows say whose they are, in the order in which they first appear.
fn by_row(path: &Path, fingers: Vec<Finger>, whose: &[Option<String>]) -> Result<Vec<Finger>, LiveError> {
    let Ok([plain]) = <[Finger; 1]>::try_from(fingers) else {
        let what = "says whose each row is (column `finger`) and has a force for each of several fingers; keep either";
        return Err(LiveError::recording(path, what));
    };
    let mut names: Vec<&String> = Vec::new();
    for name in whose.iter().flatten() {
        if !names.contains(&name) {
            if names.len() == MOST_FINGERS {
                let what = format!("column `finger`: names more than {MOST_FINGERS} fingers");
                return Err(LiveError::recording(path, &what));
            }
            names.push(name);
        }
    }
    let one = |name: &&String| {
        let own = whose.iter().map(|cell| cell.as_ref() == Some(*name)).collect();
        Finger { name: (*name).clone(), own: Some(own), ..plain.clone() }
    };
    Ok(names.iter().map(one).collect())
}

/// Whether a column is an angle of this finger.
fn is_angle(name: &str, finger: Option<&str>) -> bool {
    let own = match finger {
        Some(finger) => name.strip_prefix(finger).and_then(|rest| rest.strip_prefix('.')),
        None => Some(name).filter(|name| !name.contains('.')),
    };
    own.is_some_and(|own| own.ends_with("_deg") && !own.ends_with("_sd_deg"))
}

/// Whether a column says by 0 and 1 what is true of contact, and is no gate's.
fn is_flag(table: &Table, column: &str) -> Result<bool, TableError> {
    let is_flag = |cell: &String| cell.trim().parse().is_ok_and(|value: f64| value == 0.0 || value == 1.0);
    let mut known = false;
    let all = table.texts(column)?.iter().flatten().all(|cell| {
        known = true;
        is_flag(cell)
    });
    Ok(known && all)
}

fn gates(table: &Table, column: &str) -> Result<Vec<Gate>, TableError> {
    let cells = table.texts(column)?;
    let gate = |(row, cell): (usize, Option<String>)| match cell.as_deref() {
        Some("touch") => Ok(Gate::Touch),
        Some("bending") => Ok(Gate::Bending),
        Some("invalid") | None => Ok(Gate::Unknown),
        Some(other) => {
            let what = format!("`{other}` is no contact; write touch, bending or invalid, or leave it empty");
            Err(table.cell(row, column, what))
        }
    };
    cells.into_iter().enumerate().map(gate).collect()
}
