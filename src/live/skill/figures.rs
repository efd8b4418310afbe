//! Pictures: the forces of a trial with its contacts, and the figures of all trials.

use std::path::Path;

use lunula_live::skill::{Contact, Force};

use super::read::Trial;
use super::report::{MEASURES, Measure, TrialFigures};
use super::summary;
use crate::figure::{Chart, Item, MOST_BINS, Thinned, draw_charts, draw_panels};

/// Trials that are drawn, each in a picture of its own.
pub(super) const MOST_DRAWN: usize = 20;
const WIDTH: u32 = 1200;
/// Of one finger of a trial, and what titles and labels need more.
const PANEL_PX: u32 = 220;
/// Of the summary's panels.
const COLUMNS: usize = 2;
const SUMMARY: (u32, u32) = (640, 320);
/// More numbers of trials do not fit below a panel.
const MOST_NUMBERED: usize = 20;

/// The curves of a trial, thinned.
#[derive(Debug, Clone)]
pub(super) struct Drawn {
    title: String,
    fingers: Vec<DrawnFinger>,
}

#[derive(Debug, Clone)]
struct DrawnFinger {
    name: String,
    runs: Vec<Vec<[f64; 2]>>,
    contacts: Vec<[f64; 2]>,
}

impl Drawn {
    /// Of a trial, in seconds from its first row on.
    pub(super) fn of(trial: &Trial, touched: &[Vec<Contact>]) -> Self {
        let from_s = trial.fingers.first().and_then(|one| one.force.time_s.first()).copied().unwrap_or(0.0);
        let finger = |(finger, contacts): (&super::read::FingerTrial, &Vec<Contact>)| DrawnFinger {
            name: finger.name.clone(),
            runs: runs(&finger.force, from_s),
            contacts: contacts.iter().map(|one| [one.from_s - from_s, one.to_s - from_s]).collect(),
        };
        let whose = trial.subject.as_ref().map_or(String::new(), |subject| format!("{subject}, "));
        Self {
            title: format!("{whose}trial {}: pressing force", trial.trial),
            fingers: trial.fingers.iter().zip(touched).map(finger).collect(),
        }
    }
}

/// A force as a curve that breaks where it is not known.
fn runs(force: &Force, from_s: f64) -> Vec<Vec<[f64; 2]>> {
    let mut curve = Thinned::of_at_most(MOST_BINS);
    let longest_s = force.longest_step_s();
    let mut before_s = f64::INFINITY;
    for (&time_s, &force_n) in force.time_s.iter().zip(&force.force_n) {
        if time_s - before_s > longest_s {
            curve.push(0.5 * (before_s + time_s) - from_s, std::iter::once(None));
        }
        curve.push(time_s - from_s, std::iter::once(force_n.is_finite().then_some([force_n, f64::NAN])));
        before_s = time_s;
    }
    curve.curve(0)
}

/// One panel per finger, contacts shaded.
pub(super) fn draw_trial(trial: &Drawn, png: &Path, svg: &Path) -> anyhow::Result<()> {
    let last = trial.fingers.len().saturating_sub(1);
    let ends = trial.fingers.iter().flat_map(|finger| finger.runs.iter().flatten().map(|point| [point[0], 0.0]));
    let room: Vec<[f64; 2]> = ends.collect();
    let panel = |(k, finger): (usize, &DrawnFinger)| {
        let title = if k == 0 { trial.title.as_str() } else { "" };
        let label = if k == last { "time, s" } else { "" };
        Chart::new(
            title,
            label,
            format!("{}, N", finger.name),
            vec![
                Item::Room(room.clone()),
                Item::Spans { name: (k == 0).then(|| "contact".to_owned()), spans: finger.contacts.clone() },
                Item::Line { name: None, runs: finger.runs.clone(), colour: k, width: 2 },
            ],
            PANEL_PX + if k == 0 { 50 } else { 0 } + if k == last { 20 } else { 0 },
        )
        .from_zero()
    };
    let charts: Vec<Chart> = trial.fingers.iter().enumerate().map(panel).collect();
    draw_charts(&charts, WIDTH, png, svg)
}

/// Each figure over the trials of each person: dots, and a line through the mean over people.
pub(super) fn draw_summary(trials: &[TrialFigures], png: &Path, svg: &Path) -> anyhow::Result<()> {
    let known =
        |measure: &&Measure| trials.iter().flat_map(|trial| &trial.fingers).any(|one| (measure.of)(one).is_some());
    let charts: Vec<Chart> = MEASURES.iter().filter(known).map(|measure| chart(trials, measure)).collect();
    draw_panels(&charts, COLUMNS, SUMMARY.0, png, svg)
}

/// Whole numbers below the axis, while there is room for them.
fn numbers_of_trials(trials: &[TrialFigures], people: &[Option<String>]) -> Option<Item> {
    let of = |subject: &Option<String>| trials.iter().filter(|trial| trial.subject == *subject).count();
    let most = people.iter().map(of).max().unwrap_or(0);
    (most <= MOST_NUMBERED).then(|| Item::Names((1..=most).map(|k| (k as f64, k.to_string())).collect()))
}

fn chart(trials: &[TrialFigures], measure: &Measure) -> Chart {
    let people = summary::people(trials);
    let mut items: Vec<Item> = numbers_of_trials(trials, &people).into_iter().collect();
    for (colour, finger) in summary::fingers(trials).into_iter().enumerate() {
        let mut points = Vec::new();
        for subject in &people {
            let own = trials.iter().filter(|trial| trial.subject == *subject).enumerate();
            points.extend(own.filter_map(|(k, trial)| {
                let one = trial.fingers.iter().find(|one| one.finger == finger)?;
                Some([(k + 1) as f64, (measure.of)(one)?])
            }));
        }
        points.sort_by(|a: &[f64; 2], b| a[0].total_cmp(&b[0]));
        let mean = |same: &[[f64; 2]]| [same[0][0], same.iter().map(|point| point[1]).sum::<f64>() / same.len() as f64];
        let means: Vec<[f64; 2]> = points.chunk_by(|a, b| a[0] == b[0]).map(mean).collect();
        let runs = means.chunk_by(|a, b| b[0] - a[0] <= 1.0).map(<[_]>::to_vec).collect();
        items.push(Item::Line { name: Some(finger), runs, colour, width: 2 });
        items.push(Item::Dots { name: None, points, colour });
    }
    let label = match people.len() {
        1 => "trial, in the order given",
        _ => "trial, in the order given (dots: people, line: their mean)",
    };
    // A smoothness is negative.
    Chart { from_zero: measure.name != "smoothness", ..Chart::new("", label, measure.axis, items, SUMMARY.1) }
}
