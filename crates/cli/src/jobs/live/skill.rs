//! `lunula skill`: what fingers did in trials.

use std::path::PathBuf;

use anyhow::ensure;
use clap::Args;
use lunula::job::Given;
use lunula::live::skill::{self, FingerSpread, SkillInputs, SkillOptions, SkillReport};
use lunula::predictor::DataFile;

use crate::jobs::{self, ResultArgs};
use crate::{Common, Outcome};

const EXAMPLES: &str = "Examples:
Trials of one person, a recording each, the first of them the reference:
  lunula skill 1.csv 2.csv 3.csv --reference-trial 1 --out results
Two people, whose recordings hold several trials each (column trial):
  lunula skill anna.csv ben.csv --subject anna,ben --reference expert.csv --out results

A recording has time_s and, for each finger, index.Fz_N, middle.Fz_N, .. on one clock; a plain Fz_N is that of \
--finger. lunula predict writes such tables, and logs of photodiodes with a normal force are read too. Pressing is a \
negative Fz_N.";

/// Measure what fingers do in trials: contacts, forces, smoothness, order, distance from a reference (thesis 6.3)
///
/// Results: skill.json, with each finger's time in contact, presses, peak and mean force, impulse, fastest rise and
/// smoothness (spectral arc length) in each trial, which finger touched first, how far it is from a reference by
/// dynamic time warping, and means and SD over trials and people; skill.csv, one row per finger and trial; pictures;
/// run.json. Gaps and unknown forces end a contact, and their time is not counted. Forces and posture are never known
/// at once: where a column contact of lunula predict says which, forces are of rows in touch and angles of rows in
/// bending.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct SkillArgs {
    /// Recordings of trials; a recording without a column trial is one, named after its file
    #[arg(required = true, value_name = "RECORDING")]
    recordings: Vec<PathBuf>,
    /// Whose each recording is, in their order, such as anna,anna,ben [default: the column subject, else nobody is
    /// named]
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    subject: Vec<String>,
    /// A recording of one trial that the others are compared with
    #[arg(long, value_name = "RECORDING")]
    reference: Option<PathBuf>,
    #[command(flatten)]
    given: Given<SkillOptions>,
    #[command(flatten)]
    results: ResultArgs,
}

impl SkillArgs {
    fn inputs(&self) -> anyhow::Result<SkillInputs> {
        let (recordings, subjects) = (self.recordings.len(), self.subject.len());
        ensure!(
            subjects == 0 || subjects == recordings,
            "--subject: {subjects} names for {recordings} recordings; write one for each, with commas between them"
        );
        let one = |(k, file)| DataFile { subject: self.subject.get(k).cloned(), ..file };
        Ok(SkillInputs {
            recordings: DataFile::of(&self.recordings).into_iter().enumerate().map(one).collect(),
            reference: self.reference.clone().map(DataFile::from),
        })
    }
}

pub(crate) fn run(args: &SkillArgs) -> anyhow::Result<Outcome> {
    let SkillArgs { given, results, .. } = args;
    jobs::run(
        &results.request("skill", "recordings", &given.said),
        || {
            let SkillInputs { recordings, reference } = args.inputs()?;
            Ok(skill::plan(recordings.len(), reference.is_some(), &given.options, &results.outputs())?)
        },
        |watch| Ok(skill::run(&args.inputs()?, &given.options, &results.outputs(), watch)?),
        say,
    )
}

fn say(common: &Common, report: &SkillReport) {
    for person in &report.people {
        let whose = person.subject.as_ref().map_or(String::new(), |subject| format!("{subject}: "));
        common.say(&format!("{whose}{}, mean ± SD over trials", trials(person.trials)));
        person.fingers.iter().for_each(|finger| say_finger(common, finger));
        let first = person.first.iter().map(|(finger, trials)| format!("{finger} in {trials}"));
        let first: Vec<String> = first.collect();
        if person.fingers.len() > 1 && !first.is_empty() {
            common.say(&format!("  touched first: {}", first.join(", ")));
        }
    }
    if report.over_people.iter().any(|finger| finger.over.values().flatten().any(|over| over.n > 1)) {
        common.say("mean ± SD over people");
        report.over_people.iter().for_each(|finger| say_finger(common, finger));
    }
}

fn trials(count: usize) -> String {
    if count == 1 { "1 trial".to_owned() } else { format!("{count} trials") }
}

fn say_finger(common: &Common, finger: &FingerSpread) {
    let figure = |name: &str, unit: &str| {
        let over = finger.over.get(name).copied().flatten()?;
        let sd = over.sd.map_or(String::new(), |sd| format!(" ± {sd:.2}"));
        Some(format!("{:.2}{sd} {unit}", over.mean))
    };
    let words = [
        figure("presses", "presses"),
        figure("contact_s", "s in contact"),
        figure("peak_N", "N at most"),
        figure("impulse_Ns", "N s"),
        figure("smoothness", "smooth"),
        figure("distance_N", "N from the reference"),
    ];
    let words: Vec<String> = words.into_iter().flatten().collect();
    let words = if words.is_empty() { "nothing known".to_owned() } else { words.join(", ") };
    common.say(&format!("  {:<8} {words}", finger.finger));
}
