//! The skill job: recordings in, figures, a table and pictures out.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, Ordering};

use lunula_live::skill::{Contact, Figures, Force, noise_of_rate, noise_of_white};
use rayon::prelude::*;

use super::analysis::{self, Reference};
use super::figures::{self, Drawn, MOST_DRAWN};
use super::options::{SkillInputs, SkillOptions};
use super::read::read;
use super::report::{SkillFigures, SkillReport, TrialFigures};
use super::summary;
use super::table::{self, TABLE};
use crate::files::{Places, json_text};
use crate::job::{Outputs, Report, Watch};
use crate::live::error::LiveError;
use crate::log::doubts;
use crate::median::{SD_OF_MAD, median_of};
use crate::predictor::DataFile;
use crate::stages::{Stages, Step, left_out};
use crate::table::copies;
use crate::words::twins;

pub(super) const FIGURES: &str = "skill.json";
/// The report, with places and times.
const REPORT: &str = "run.json";

/// What would be done and what not, of so many recordings; `reference`: whether a recording is compared with.
///
/// # Errors
/// [`LiveError::Request`].
pub fn plan(
    recordings: usize,
    reference: bool,
    options: &SkillOptions,
    outputs: &Outputs,
) -> Result<Vec<Step>, LiveError> {
    let mut faults = options.faults();
    if reference && options.reference_trial.is_some() {
        faults.push("--reference-trial: there is a --reference recording as well; choose one of them".to_owned());
    }
    if !faults.is_empty() {
        return Err(LiveError::Request(faults.join("; ")));
    }
    let compared = reference || options.reference_trial.is_some();
    let why = if compared { "by time warping" } else { "neither --reference nor --reference-trial" };
    Ok(vec![
        Step::new("read", true, format!("{recordings} recordings")),
        Step::new("contacts", true, format!("from {} N on, to {} N", options.touch_n, options.release_n)),
        Step::new("distance from a reference", compared, why.to_owned()),
        Step::new("means", true, "over trials, and over people".to_owned()),
        Step::figures(outputs.figures, "forces by trial, figures over trials"),
    ])
}

/// What a recording gave.
struct Done {
    trials: Vec<TrialFigures>,
    drawn: Vec<Drawn>,
    notes: Vec<String>,
    warnings: Vec<String>,
    /// What was said for all of them together.
    gated: bool,
    angles_without_gate: bool,
}

/// Runs the job; every result is in its place when it returns.
///
/// # Errors
/// [`LiveError`] where there are no results.
pub fn run(
    inputs: &SkillInputs,
    options: &SkillOptions,
    outputs: &Outputs,
    watch: &Watch<'_>,
) -> Result<SkillReport, LiveError> {
    let stages = Stages::default();
    let steps = plan(inputs.recordings.len(), inputs.reference.is_some(), options, outputs)?;
    let folder = &outputs.out;
    let files = inputs.recordings.iter().chain(&inputs.reference).map(|one| &one.path);
    let mut places = Places::not_over(files);
    places.check([FIGURES, TABLE, REPORT].map(|name| folder.join(name)))?;
    let reference = stages.time("reference", || Reference::find(inputs, options))?;
    watch.go_on()?;
    let count = AtomicU64::new(0);
    let one = |recording: &DataFile| {
        watch.go_on()?;
        let done = stages.time("contacts", || analysed(recording, reference.as_ref(), options, outputs.figures));
        (watch.tick)(count.fetch_add(1, Ordering::Relaxed) + 1, Some(inputs.recordings.len() as u64));
        Ok(done)
    };
    let all: Vec<Result<Done, LiveError>> = inputs.recordings.par_iter().map(one).collect::<Result<_, LiveError>>()?;
    let (mut done, mut failed) = (Vec::new(), Vec::new());
    for (recording, one) in inputs.recordings.iter().zip(all) {
        match one {
            Ok(one) => done.push((recording, one)),
            Err(why) => failed.push(why.to_string()),
        }
    }
    if done.is_empty() {
        return Err(LiveError::Faults(failed));
    }
    distinct(&done)?;
    let (mut notes, mut warnings) = said(&done, reference.as_ref());
    let drawn: Vec<Drawn> = done.iter_mut().flat_map(|(_, one)| std::mem::take(&mut one.drawn)).collect();
    let trials: Vec<TrialFigures> = done.into_iter().flat_map(|(_, one)| one.trials).collect();
    let people: Vec<_> = summary::people(&trials).iter().map(|subject| summary::person(subject, &trials)).collect();
    warnings.extend(twins("subjects", trials.iter().filter_map(|trial| trial.subject.as_deref())));
    let figures = SkillFigures {
        reference: reference.map(|reference| reference.name),
        over_people: summary::over_people(&people),
        people,
        trials,
    };
    places.write(&folder.join(FIGURES), &json_text(&figures))?;
    stages.time("table", || table::write(&figures, folder, &mut places))?;
    let mut pictures = Vec::new();
    if outputs.figures {
        let beside = folder.join(FIGURES);
        pictures.push(places.draw(&beside, "summary", |png, svg| {
            stages.time("figures", || figures::draw_summary(&figures.trials, png, svg))
        })?);
        for (k, trial) in drawn.iter().take(MOST_DRAWN).enumerate() {
            watch.go_on()?;
            pictures.push(places.draw(&beside, &format!("trial-{:02}", k + 1), |png, svg| {
                stages.time("figures", || figures::draw_trial(trial, png, svg))
            })?);
        }
        if figures.trials.len() > MOST_DRAWN {
            notes.push(format!("the first {MOST_DRAWN} of {} trials are drawn", figures.trials.len()));
        }
    }
    let left_out = left_out(steps);
    let mut report = Report { left_out, notes, warnings, failed, pictures, ..Report::new("skill", watch, figures) };
    if report.figures.reference.is_none() {
        report.unused(&["band"], "there is no reference to compare trials with");
    }
    Ok(report.timed(&stages).commit(places, outputs.report.then(|| folder.join(REPORT)).as_deref())?)
}

/// Reads a recording and looks at its trials.
fn analysed(
    recording: &DataFile,
    reference: Option<&Reference>,
    options: &SkillOptions,
    draw: bool,
) -> Result<Done, LiveError> {
    let read = read(recording, &options.finger)?;
    let name = &recording.name;
    let (mut trials, mut drawn, mut warnings) = (Vec::new(), Vec::new(), Vec::new());
    let first = read.trials.first().and_then(|trial| trial.fingers.first());
    let time = first.and_then(|finger| doubts::time(&finger.force.time_s));
    warnings.extend(read.warnings.iter().cloned().chain(time).map(|doubt| format!("{name}: {doubt}")));
    for trial in &read.trials {
        let (figures, touched) = analysis::figures(name, trial, reference, options);
        for ((finger, touched), own) in trial.fingers.iter().zip(&touched).zip(&figures.fingers) {
            let noise_n = noise_n(&finger.force.force_n, options.touch_n);
            let noisy = noise_n.and_then(|sd_n| noisy(sd_n, options.touch_n));
            let white = || Some(noise_of_white(noise_n?, 1.0 / finger.force.period_s()?));
            let noise = noise_of_rate(&finger.force, touched).or_else(white);
            let unsmooth = noise.and_then(|rate| unsmooth(&own.figures, rate));
            let merged = merged(&finger.force, touched);
            let doubts = finger.doubts.iter().chain(&noisy).chain(&unsmooth).chain(&merged);
            warnings.extend(doubts.map(|doubt| format!("{name}: trial {}: {}: {doubt}", trial.trial, finger.name)));
        }
        if draw && drawn.len() < MOST_DRAWN {
            drawn.push(Drawn::of(trial, &touched));
        }
        trials.push(figures);
    }
    let mut notes: Vec<String> = read.notes.iter().map(|note| format!("{name}: {note}")).collect();
    for (rows, what) in [(read.without_time, "time"), (read.without_trial, "trial")] {
        if rows > 0 {
            notes.push(format!("{name}: {rows} rows have no {what} and are not counted"));
        }
    }
    Ok(Done { trials, drawn, notes, warnings, gated: read.gated, angles_without_gate: read.angles_without_gate })
}

/// Noise of so much of --touch, of rows at rest, ends contacts and begins others: of six generated presses twenty were
/// counted where it had three quarters (white, 100 rows a second), and their time in contact was a third too long. Of
/// the rows below --touch half of it is seen then.
const NOISY: f64 = 0.45;
/// Fewer rows say nothing of noise.
const ROWS: usize = 100;

/// The SD of a force's noise, by the spread of its rows at rest about their neighbours' mean.
fn noise_n(force_n: &[f64], touch_n: f64) -> Option<f64> {
    let at_rest = |three: &&[f64]| three.iter().all(|force_n| force_n.abs() < touch_n);
    let bends = force_n.windows(3).filter(at_rest).map(|three| (three[0] - 2.0 * three[1] + three[2]).abs());
    let count = bends.clone().count();
    // Of independent rows, that has six times the variance of one.
    let sd_n = SD_OF_MAD * median_of(bends)? / 6f64.sqrt();
    (count >= ROWS).then_some(sd_n)
}

/// That a force is too noisy for the threshold.
fn noisy(sd_n: f64, touch_n: f64) -> Option<String> {
    (sd_n > NOISY * touch_n).then(|| {
        format!(
            "the force scatters at rest by {sd_n:.2} N (SD) or more, and --touch is {touch_n} N: contacts are made of \
             noise, and broken by it; choose a higher --touch and --release, or filter the force"
        )
    })
}

/// Noise of the force's rate, of its fastest in a press, above which smoothness is that of the noise too: of generated
/// trials (five shapes, 0.5 to 5 N, 100 and 250 rows a second, noise of 0.001 to 0.05 N) it was at most 8 % off in the
/// 1215 below this (white noise, tremors of 5, 9.5 and 12 Hz, bands of 3 to 15 and 7 to 12 Hz; 11 % with noise of 0.5
/// to 3 Hz), and up to 16 % at a third more.
const UNSMOOTH: f64 = 0.045;

/// That noise at rest, whose rate is this, decides how smooth presses are.
fn unsmooth(figures: &Figures, rate: f64) -> Option<String> {
    let fastest = figures.fastest_n_per_s.filter(|fastest| rate > UNSMOOTH * fastest)?;
    Some(format!(
        "noise at rest, up to 15 Hz, changes the force by {rate:.2} N/s (RMS), and presses change it by {fastest:.1} \
         N/s at the fastest: smoothness is in part that of the noise; compare it with that of equal presses and noise \
         only; where the noise is the sensor's, record more rows a second"
    ))
}

/// Presses run together in a contact that lasts so many times as long as the usual one, of so many, in which the force
/// falls below the first of these shares of its peak and rises above the second again so often (generated presses: 9
/// times as long and one rise at most; with a transducer that drifts 18 and 25 times, 4 and 6 rises).
const LONG: f64 = 10.0;
const CONTACTS: usize = 3;
const FALLS: f64 = 0.35;
const RISES: f64 = 0.6;
const AGAIN: usize = 4;

/// That presses have become one contact, as where a transducer's zero has moved.
fn merged(force: &Force, contacts: &[Contact]) -> Option<String> {
    let length_s = |contact: &Contact| contact.to_s - contact.from_s;
    let usual_s = median_of(contacts.iter().map(length_s)).filter(|_| contacts.len() >= CONTACTS)?;
    let rises = |contact: &Contact| {
        let force_n = &force.force_n[contact.rows.clone()];
        let peak_n = force_n.iter().copied().fold(0.0, f64::max);
        let (mut is_low, mut rises) = (false, 0);
        for force_n in force_n {
            is_low |= *force_n < FALLS * peak_n;
            if is_low && *force_n > RISES * peak_n {
                (is_low, rises) = (false, rises + 1);
            }
        }
        rises
    };
    let long = contacts.iter().filter(|contact| length_s(contact) >= LONG * usual_s);
    let (contact, rises) = long.map(|contact| (contact, rises(contact))).max_by_key(|(_, rises)| *rises)?;
    (rises >= AGAIN).then(|| {
        format!(
            "from {:.1} to {:.1} s it is one contact, {usual_s:.1} s in the median, in which the force falls and rises \
             {rises} times: did the transducer's zero move? Zero it again, or choose a higher --touch and --release",
            contact.from_s, contact.to_s
        )
    })
}

/// A person has each trial once.
fn distinct(done: &[(&DataFile, Done)]) -> Result<(), LiveError> {
    let mut seen: BTreeMap<(&Option<String>, &str), &DataFile> = BTreeMap::new();
    let mut twice = Vec::new();
    for (recording, one) in done {
        for trial in &one.trials {
            let Some(first) = seen.insert((&trial.subject, &trial.trial), recording) else { continue };
            let whose = trial.subject.as_ref().map_or(String::new(), |subject| format!(" of {subject}"));
            twice.push(format!(
                "{} and {}: both are trial {}{whose}; say whose each recording is with --subject, or number the trials \
                 in a column `trial`",
                first.name, recording.name, trial.trial
            ));
        }
    }
    if twice.is_empty() { Ok(()) } else { Err(LiveError::Faults(twice)) }
}

/// Notes and warnings on all recordings.
fn said(done: &[(&DataFile, Done)], reference: Option<&Reference>) -> (Vec<String>, Vec<String>) {
    let mut notes: Vec<String> = done.iter().flat_map(|(_, one)| one.notes.iter().cloned()).collect();
    let files = done.iter().map(|(recording, _)| (recording.name.clone(), recording.path.as_path()));
    let mut warnings = copies(files.collect());
    warnings.extend(done.iter().flat_map(|(_, one)| one.warnings.iter().cloned()));
    if done.iter().any(|(_, one)| one.gated) {
        notes.push(
            "column `contact`: forces are those of rows in touch, angles those of rows in bending; they are never \
             known at once (5.1.2)"
                .to_owned(),
        );
    }
    if done.iter().any(|(_, one)| one.angles_without_gate) {
        notes.push(
            "angles are left out: without a column `contact` it is not known in which rows they hold (5.1.2)"
                .to_owned(),
        );
    }
    let trials = || done.iter().flat_map(|(_, one)| &one.trials);
    let lost = |trial: &&TrialFigures| trial.fingers.iter().any(|one| one.figures.unknown_s > 0.0);
    let with_gaps = trials().filter(lost).count();
    if with_gaps > 0 {
        notes.push(format!(
            "{with_gaps} of {} trials have gaps or unknown forces (unknown_s): that time is not counted, and a contact \
             ends there",
            trials().count()
        ));
    }
    let cut: usize = trials().flat_map(|trial| &trial.fingers).map(|one| one.figures.cut).sum();
    if cut > 0 {
        let contacts = if cut == 1 { "1 contact begins or ends" } else { &format!("{cut} contacts begin or end") };
        notes.push(format!("{contacts} in a gap, or before or after the trial: one without a beginning is no press"));
    }
    if let Some(reference) = reference.filter(|reference| !reference.touches()) {
        warnings.push(format!("{}: is the reference and has no contact: nothing is compared with it", reference.name));
    }
    let is_compared = |trial: &TrialFigures| trial.fingers.iter().any(|one| one.distance_n.is_some());
    if let Some(reference) = reference.filter(|reference| reference.touches() && !trials().any(is_compared)) {
        warnings.push(format!(
            "{}: nothing is compared with the reference: no other trial has one of its fingers, with a contact and \
             forces that are known throughout",
            reference.name
        ));
    }
    (notes, warnings)
}
