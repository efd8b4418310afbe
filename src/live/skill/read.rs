//! A recording's trials: whose they are, and each finger's force within them.

use lunula_live::skill::Force;
use lunula_live::spread::Spread;

use super::rows::{self, FORCE, Finger, Gate, Rows};
use crate::live::error::LiveError;
use crate::log::{Still, doubts};
use crate::median::ends;
use crate::predictor::DataFile;

/// More trials of a recording are something else: a column was mistaken.
const MOST_TRIALS: usize = 10_000;

/// The person, if known, and the trial.
type Whose = (Option<String>, String);

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Trial {
    pub(super) subject: Option<String>,
    pub(super) trial: String,
    pub(super) fingers: Vec<FingerTrial>,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct FingerTrial {
    pub(super) name: String,
    pub(super) force: Force,
    /// What makes it doubtful that these are a finger's forces.
    pub(super) doubts: Vec<String>,
    /// Each angle in rows in bending: name, mean and SD over rows, and its ends.
    pub(super) angles: Vec<(String, Spread, [f64; 2])>,
}

/// What a recording holds.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Recording {
    pub(super) trials: Vec<Trial>,
    pub(super) gated: bool,
    pub(super) angles_without_gate: bool,
    pub(super) without_time: usize,
    /// Rows of no trial.
    pub(super) without_trial: usize,
    pub(super) notes: Vec<String>,
    pub(super) warnings: Vec<String>,
}

/// Reads a recording; `finger` is the name of a plain `Fz_N`.
pub(super) fn read(recording: &DataFile, finger: &str) -> Result<Recording, LiveError> {
    let path = &recording.path;
    let rows = rows::read(path, finger)?;
    let own_trial = recording
        .session
        .clone()
        .unwrap_or_else(|| path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned()));
    // Rows of each trial, in the order in which trials first appear.
    let mut trials: Vec<(Whose, Vec<usize>)> = Vec::new();
    let mut places = std::collections::BTreeMap::new();
    let (mut without_time, mut without_trial) = (0, 0);
    for row in 0..rows.time_s.len() {
        let cell = |column: &Option<Vec<Option<String>>>| column.as_ref().map(|cells| cells[row].clone());
        let trial = match cell(&rows.trial) {
            None => own_trial.clone(),
            Some(Some(trial)) => trial,
            Some(None) => {
                without_trial += 1;
                continue;
            }
        };
        if !rows.time_s[row].is_finite() {
            without_time += 1;
            continue;
        }
        let subject = cell(&rows.subject).flatten().or_else(|| recording.subject.clone());
        let key = (subject, trial);
        let place = *places.entry(key.clone()).or_insert(trials.len());
        if place == trials.len() {
            if place == MOST_TRIALS {
                let what = format!("column `trial`: has more than {MOST_TRIALS} trials; is it the number of the row?");
                return Err(LiveError::recording(path, &what));
            }
            trials.push((key, Vec::new()));
        }
        trials[place].1.push(row);
    }
    if trials.is_empty() {
        return Err(LiveError::recording(path, "has no row with a time and a trial; record it again"));
    }
    let other_subject = recording.subject.as_ref().and_then(|given| {
        let other = rows.subject.iter().flatten().flatten().find(|own| *own != given)?;
        Some(format!(
            "column `subject` says whose its rows are (`{other}`), and --subject {given} is not used for them"
        ))
    });
    let one = |((subject, trial), own): (Whose, Vec<usize>)| {
        let fingers = rows.fingers.iter().map(|finger| {
            let is_own = |row: &&usize| finger.own.as_ref().is_none_or(|own| own[**row]);
            let own: Vec<usize> = own.iter().filter(is_own).copied().collect();
            in_order(&rows, &own, recording)?;
            Ok(of_finger(&rows, finger, &own))
        });
        let mut fingers = fingers.collect::<Result<Vec<FingerTrial>, LiveError>>()?;
        copies(&mut fingers);
        Ok(Trial { subject, trial, fingers })
    };
    Ok(Recording {
        trials: trials.into_iter().map(one).collect::<Result<_, LiveError>>()?,
        gated: rows.fingers.iter().any(|finger| !finger.gate.is_empty()),
        angles_without_gate: rows.angles_without_gate,
        without_time,
        without_trial,
        warnings: rows.warnings.into_iter().chain(other_subject).collect(),
        notes: rows.notes,
    })
}

/// Stamps are coarser than rows where more than this share of them is that of the row before (assumed).
const COARSE: f64 = 0.1;

/// A finger's time has to go forward within a trial: how fast a force rises is not known of rows at one time.
fn in_order(rows: &Rows, own: &[usize], recording: &DataFile) -> Result<(), LiveError> {
    let still = own.windows(2).filter(|pair| rows.time_s[pair[1]] == rows.time_s[pair[0]]).count();
    if still as f64 > COARSE * own.len() as f64 {
        let what = format!(
            "{still} of {} rows of a trial have the time of the row before: its stamps are coarser than its rows; give \
             each row its own time",
            own.len()
        );
        return Err(LiveError::recording(&recording.path, &what));
    }
    let back = own.windows(2).find(|pair| rows.time_s[pair[1]] < rows.time_s[pair[0]]);
    let Some((pair, table)) = back.zip(rows.table.as_ref()) else { return Ok(()) };
    let what = format!(
        "{}: time_s falls from {} to {} within a trial; sort the rows, or number the trials in a column `trial`",
        table.row_place(pair[1]),
        rows.time_s[pair[0]],
        rows.time_s[pair[1]]
    );
    Err(LiveError::recording(&recording.path, &what))
}

/// Where a finger presses with less than this nothing is said of a force that stands still, newtons (assumed).
const PRESSES_N: f64 = 0.1;

/// Fingers whose forces are another's to the bit.
fn copies(fingers: &mut [FingerTrial]) {
    for k in 1..fingers.len() {
        let (before, [finger, ..]) = fingers.split_at_mut(k) else { return };
        let own = &finger.force.force_n;
        let same = |other: &&FingerTrial| {
            let other = &other.force.force_n;
            own.len() == other.len() && own.iter().zip(other).all(|(a, b)| a.to_bits() == b.to_bits())
        };
        if own.iter().any(|force_n| *force_n > PRESSES_N)
            && let Some(other) = before.iter().find(same)
        {
            finger.doubts.push(format!("{FORCE} is that of {} in every row: is it a copy of its column?", other.name));
        }
    }
}

/// So many rows of one value are no chance.
const UNMOVED: usize = 50;

/// What to say of a force that keeps its value while a finger presses, or in all rows.
fn stands(time_s: &[f64], force_n: &[f64]) -> Option<String> {
    if force_n.len() >= UNMOVED && force_n.iter().all(|value| *value == force_n[0]) {
        return Some(format!("{FORCE} is the same to the last digit in all {} rows: not connected?", force_n.len()));
    }
    let mut still = Still::new(1);
    for (time_s, force_n) in time_s.iter().zip(force_n).filter(|(_, force_n)| **force_n > PRESSES_N) {
        still.push(*time_s, std::iter::once(*force_n));
    }
    still.doubt(FORCE)
}

fn of_finger(rows: &Rows, finger: &Finger, own: &[usize]) -> FingerTrial {
    let gate = |row: usize| finger.gate.get(row).copied();
    let pressing = |row: &usize| match gate(*row) {
        None | Some(Gate::Touch) => -finger.fz_n[*row],
        Some(_) => f64::NAN,
    };
    // A row that does not say the force is as one that is lost; a trial is as long as it is.
    let is_end = |k: usize| k == 0 || k + 1 == own.len();
    let is_known = |row: &usize| gate(*row) == Some(Gate::Bending) || pressing(row).is_finite();
    let said: Vec<usize> =
        own.iter().enumerate().filter(|(k, row)| is_end(*k) || is_known(row)).map(|(_, row)| *row).collect();
    let lifted = if finger.gate.is_empty() {
        Vec::new()
    } else {
        said.iter().map(|row| gate(*row) == Some(Gate::Bending)).collect()
    };
    let force_n: Vec<f64> = said.iter().map(pressing).collect();
    let angle = |(name, values): &(String, Vec<f64>)| {
        let bent = || own.iter().filter(|row| gate(**row) == Some(Gate::Bending)).map(|row| values[*row]);
        let known = bent().filter(|value| value.is_finite());
        let ends = ends(known);
        Some((name.clone(), Spread::of(bent())?, ends))
    };
    let fz_n: Vec<f64> = force_n.iter().map(|force_n| -force_n).collect();
    let force = || std::iter::once((FORCE, &fz_n[..]));
    let time_s: Vec<f64> = said.iter().map(|row| rows.time_s[*row]).collect();
    FingerTrial {
        name: finger.name.clone(),
        doubts: [doubts::forces(force()), doubts::glitches(force()), doubts::cut_off(FORCE, &fz_n)]
            .into_iter()
            .flatten()
            .chain(stands(&time_s, &force_n).or_else(|| doubts::held(FORCE, &time_s, &fz_n)))
            .collect(),
        angles: finger.angles.iter().filter_map(angle).collect(),
        force: Force { time_s, force_n, lifted },
    }
}
