//! `lunula switch tune`: thresholds and holds from held-out recordings, for a rate of false switches.
//!
//! In: recordings that the models were not trained on, with what is true of contact. Out: `switch.toml`, beside it
//! `<switch>.run.json` ([`TuneReport`]) and the curve of delay against false switches. Predictions are made row by row
//! as `lunula live` makes them.

use std::iter;

use lunula_live::switch::{Evaluation, Goal, Match, SwitchConfig, crossings_per_hour, matches, tune};

use super::doubts::elsewhere;
use super::figures::{WIDTH, curve_chart};
use super::flattery::flattery;
use super::options::TuneOptions;
use super::report::{CurvePoint, TuneFigures, TuneReport, note};
use super::traces::{SwitchInputs, Traces, read_traces};
use crate::figure::draw_charts;
use crate::files::{Places, beside};
use crate::job::{Outputs, Report, Watch};
use crate::live::error::LiveError;
use crate::stages::{Stages, Step, left_out};

/// The picture's name, after the table's.
const PICTURE: &str = "curve";

/// Chooses a switch's thresholds; every result is in its place when it returns.
///
/// # Errors
/// [`LiveError`] where there is no choice: nothing is written.
pub fn tune_switch(
    inputs: &SwitchInputs,
    options: &TuneOptions,
    outputs: &Outputs,
    watch: &Watch<'_>,
) -> Result<TuneReport, LiveError> {
    let stages = Stages::default();
    let Outputs { out, figures, report, .. } = outputs;
    let report_at = report.then(|| beside(out, ".run.json"));
    let mut places = Places::not_over(inputs.recordings.iter().map(|file| &file.path).chain(&inputs.models));
    places.check(std::iter::once(out).chain(&report_at))?;
    let Traces { recordings: read, traces, led, model_sha256, mut warnings, notes, failed } =
        stages.time("predict", || read_traces(inputs, options.column.as_deref(), &options.truth, watch))?;
    warnings.extend(stages.time("compare with training", || flattery(inputs, &options.truth))?);
    let goal = Goal {
        false_per_hour: options.false_per_hour,
        missed_share: options.missed,
        watchdog_s: options.watchdog,
        outside: options.outside,
    };
    let of_goal = SwitchConfig { watchdog_s: goal.watchdog_s, ..SwitchConfig::of(1.0, 0.0) };
    of_goal.check().map_err(|why| LiveError::Request(why.to_string()))?;
    let tuned = stages.time("choose", || tune(&traces, &goal)).map_err(|why| {
        // What is doubtful about the recordings may be why.
        LiveError::Request(iter::once(why.to_string()).chain(warnings.clone()).collect::<Vec<_>>().join("; "))
    })?;
    watch.go_on()?;
    let switch = SwitchConfig { column: options.column.clone(), model_sha256, ..tuned.chosen.config.clone() };
    let mut report = Report {
        warnings,
        notes,
        failed,
        left_out: left_out(tune_plan(inputs.recordings.len(), outputs)),
        ..Report::new(
            "switch tune",
            watch,
            TuneFigures {
                recordings: read,
                contact: options.truth.contact.to_string(),
                rice_per_hour: tuned.noise.map(|noise| crossings_per_hour(noise, switch.on_n)),
                switch,
                chosen: tuned.chosen.evaluation.clone(),
                held_out: tuned.held_out,
                noise: tuned.noise,
                curve: tuned.curve.into_iter().filter_map(CurvePoint::of).collect(),
                tried: tuned.tried,
            },
        )
    };
    note(&mut report, &tuned.chosen.evaluation, inputs, &options.truth, led);
    let weak = weak(&report, options);
    report.warnings.extend(weak);
    let found: Vec<Vec<Match>> = traces.iter().map(|trace| matches(&report.switch, trace)).collect();
    let elsewhere = elsewhere(&report.recordings, &traces, &found);
    report.warnings.extend(elsewhere);
    let text = toml::to_string(&report.switch).map_err(|why| LiveError::Request(why.to_string()))?;
    places.write(out, &text)?;
    if *figures {
        let title = "Mean delay of presses against false switches";
        let drawn = stages.time("figures", || {
            let chart = curve_chart(title, &report, options.false_per_hour);
            places.draw(out, PICTURE, |png, svg| draw_charts(&[chart], WIDTH, png, svg))
        })?;
        report.pictures.push(drawn);
    }
    Ok(report.timed(&stages).commit(places, report_at.as_deref())?)
}

/// What would be done and what not.
#[must_use]
pub fn tune_plan(recordings: usize, outputs: &Outputs) -> Vec<Step> {
    vec![
        Step::new("predict", true, format!("{recordings} recordings, row by row as live")),
        Step::new("choose", true, "thresholds and holds".to_owned()),
        Step::new("held out", recordings > 1, "each recording judged by what the others choose".to_owned()),
        Step::figures(outputs.figures, "delay against false switches"),
    ]
}

/// What has to be known of a choice before it is trusted.
fn weak(report: &TuneReport, options: &TuneOptions) -> Vec<String> {
    let mut warnings = Vec::new();
    let judged = report.held_out.as_ref().unwrap_or(&report.chosen);
    if report.held_out.is_none() {
        let why = match report.recordings.len() {
            0 | 1 => "there is no other recording to judge the choice on",
            _ => "without one of the recordings, the others allow no choice that could be judged on it",
        };
        warnings.push(format!(
            "{why}: it was judged on what chose it, which flatters; name several recordings, or hold one back for \
             `lunula switch evaluate`"
        ));
    }
    let goal = options.false_per_hour;
    if let Some(rate) = judged.rate.filter(|rate| rate.false_per_hour_low > goal) {
        // What was chosen on all keeps the goal on all.
        warnings.push(format!(
            "the goal is missed on recordings that are held out: {} false switches in {:.2} h are {:.1} an hour at \
             least, and {goal} are allowed; choose with a lower --false-per-hour, or train the model on more sessions, \
             rest among them",
            judged.false_switches, judged.hours, rate.false_per_hour_low
        ));
    } else if let Some(rate) = judged.rate.filter(|rate| rate.false_per_hour_high > goal) {
        let more = if judged.false_switches == 0 {
            // Nothing counted in so long means at most the goal.
            format!("{:.1} h without any would show it", 3.0 / goal)
        } else {
            "more recordings would show it".to_owned()
        };
        warnings.push(format!(
            "{} false switches in {:.2} h agree with up to {:.1} an hour, and {goal} are allowed: {more}",
            judged.false_switches, judged.hours, rate.false_per_hour_high
        ));
    }
    let Evaluation { missed, presses, .. } = *judged;
    let share = options.missed;
    if judged.misses_more_than(share) {
        warnings.push(format!(
            "the goal is missed on recordings that are held out: {missed} of {presses} presses are missed, and {:.1} % \
             are allowed; name more recordings with presses, or choose with a higher --missed",
            100.0 * share
        ));
    }
    warnings
}
