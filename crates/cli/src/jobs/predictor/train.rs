//! `lunula train`: recordings to a model file.

use std::path::PathBuf;

use clap::Args;
use lunula::job::Given;
use lunula::predictor::models::{EigennailsReport, Report};
use lunula::predictor::{TrainChoices, TrainInputs, TrainOutputs, TrainReport, train, train_plan};

use crate::jobs::predictor::{figure, say_merit, say_rows};
use crate::jobs::{self, JobArgs, Request, needed};
use crate::{Common, Outcome};

/// Train a model that predicts forces or angles from photodiodes (chapter 5)
///
/// A recording is a table with P1.. and Fx_N,Fy_N,Fz_N or J2_deg, as `lunula align` writes it, or a log with forces
/// (with a column `led`, lit less unlit samples are taken). Each file, session and subject in it is a recording of its
/// own. Rows with an empty cell that is needed are left out and counted. Models: linear (equation 9), quadratic (16:
/// all squares and products) and network (17, 18); eigennails read cells C_00_00, C_00_01, .. of the nail's picture, as
/// `lunula nailvideo --cells` makes them, in place of photodiodes. What --validate names is only reported on, and its
/// errors give the prediction intervals: name recordings of another session.
#[derive(Debug, Args)]
pub(crate) struct TrainArgs {
    #[command(flatten)]
    inputs: TrainInputs,
    #[command(flatten)]
    given: Given<TrainChoices>,
    /// The model file
    #[arg(long, value_name = "MODEL.json", required_unless_present = "plan")]
    out: Option<PathBuf>,
    /// The error on the recordings to validate on, against how much was trained on: a table, and a picture beside it
    #[arg(long, value_name = "CURVE.csv", requires = "validate")]
    learning_curve: Option<PathBuf>,
    #[command(flatten)]
    job: JobArgs,
}

pub(crate) fn run(args: &TrainArgs) -> anyhow::Result<Outcome> {
    let TrainArgs { inputs, given, out, learning_curve, job } = args;
    let options = given.options.options();
    jobs::run(
        &Request { name: "train", unit: "steps", job, said: &given.said, result: out.clone() },
        || {
            let ambient = inputs.ambient_step(&options.wanted.rows);
            Ok(train_plan(inputs, ambient, &options.recipe, learning_curve.is_some()))
        },
        |watch| {
            let model = needed(out.clone())?;
            let outputs = TrainOutputs { model, learning_curve: learning_curve.clone(), merit: None };
            Ok(train(inputs, &options, &outputs, watch)?)
        },
        say,
    )
}

fn say(common: &Common, report: &TrainReport) {
    say_rows(common, report.data.iter().chain(&report.validate));
    match &report.fit {
        Report::LeastSquares(fit) => common.say(&format!(
            "{} terms, {} of them independent; condition {}, {} digits of the coefficients can be trusted",
            fit.terms.len(),
            fit.rank.map_or("-".to_owned(), |rank| rank.to_string()),
            fit.condition.map_or("infinite".to_owned(), |condition| format!("{condition:.1e}")),
            fit.digits.map_or("-".to_owned(), |digits| format!("{digits:.0}"))
        )),
        Report::Network(fit) => {
            let best = &fit.restarts[fit.best];
            common.say(&format!(
                "{} parameters; best of {} networks after {} epochs; RMSE in SDs: best {:.4}, median {:.4}, \
                 quartiles \
                 {:.4} apart",
                fit.parameters,
                fit.restarts.len(),
                best.best_epoch,
                best.score,
                fit.median_score,
                fit.score_iqr
            ));
        }
        Report::Eigennails(fit) => say_eigennails(common, fit, &report.targets),
    }
    say_merit(common, "trained", &report.training);
    if let Some(merit) = &report.validation {
        say_merit(common, "validated", merit);
    }
    for one in &report.without {
        say_merit(common, &format!("validated, without {}", one.without), &one.validation);
    }
    if let Some(half_width) = &report.half_width {
        for (name, half) in &half_width.0 {
            common.say(&format!(
                "  {name:<8} {:.0} % of the validated rows within ± {}",
                100.0 * report.level,
                figure(*half)
            ));
        }
    }
}

fn say_eigennails(common: &Common, fit: &EigennailsReport, targets: &[String]) {
    let explained: f64 = fit.explained.iter().sum();
    common.say(&format!(
        "{} eigennails explain {:.1} % of what {} rows of cells do; chosen by leaving out {}",
        fit.modes,
        100.0 * explained,
        fit.rows,
        fit.left_out
    ));
    for (name, rmse) in targets.iter().zip(&fit.left_out_rmse) {
        common.say(&format!("  {name:<8} RMSE {:>8} on {} left out (ridge)", figure(*rmse), fit.left_out));
    }
    match (&fit.directions, &fit.no_directions) {
        (Some(found), _) => common.say(&format!(
            "  directions ({}): {:.1} % of {} rows recognized; {:.1} % are of the most frequent",
            found.classes.join(", "),
            100.0 * found.accuracy,
            found.rows.iter().sum::<usize>(),
            100.0 * found.guess
        )),
        (None, Some(why)) => common.say(&format!("  no directions: {why}")),
        (None, None) => {}
    }
}
