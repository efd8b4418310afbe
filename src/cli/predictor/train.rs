//! `lunula train`: recordings to a model file.

use std::path::PathBuf;

use anyhow::Context;
use clap::Args;
use lunula::predictor::models::{Deficient, Kind, Recipe, Report};
use lunula::predictor::{
    DataFile, HIDDEN, LEVEL, ModelChoice, Target, TrainInputs, TrainOptions, TrainOutputs, Wanted, share,
    train as run_train, train_plan,
};

use super::{Common, Outcome, RowsArgs, ended, figure, one_of, say_merit, say_notes};

/// Recordings of photodiodes with forces or angles to a model that tells forces or angles from photodiodes (5.)
///
/// A recording is a table with P1.. and Fx_N,Fy_N,Fz_N or J2_deg, as `lunula align` writes it, or a log with forces
/// (with a column `led`, lit less unlit samples are taken). Each file, session and subject in it is a recording of its
/// own. Rows with an empty cell that is needed are left out and counted. Models: linear (equation 9), quadratic (16:
/// all squares and products) and network (17, 18). What --validate names is only reported on, and its errors tell the
/// prediction intervals: name recordings of another session.
#[derive(Debug, Args)]
pub(crate) struct TrainArgs {
    /// Recordings to train on (.csv, .csv.gz where a log, .parquet)
    #[arg(required = true, value_name = "DATA")]
    data: Vec<PathBuf>,
    /// force (Fx_N, Fy_N, Fz_N), posture (J2_deg), or columns as Fz_N,J3_deg
    #[arg(long, value_name = "force|posture|COLUMNS", value_parser = Target::parse)]
    target: Target,
    /// Which model
    #[arg(long, value_parser = one_of::<ModelChoice>(), default_value = "linear")]
    model: ModelChoice,
    /// Hidden nodes of the network
    #[arg(long, value_name = "N", default_value_t = HIDDEN, value_parser = clap::value_parser!(u16).range(1..=1000))]
    hidden: u16,
    /// Recordings to report on
    #[arg(long, value_name = "DATA", num_args = 1..)]
    validate: Vec<PathBuf>,
    /// Recordings on which the network's training stops early [default: every fifth of 20 blocks of each training
    /// recording]
    #[arg(long, value_name = "DATA", num_args = 1..)]
    stop_on: Vec<PathBuf>,
    /// The photodiodes to read, as P1,P3,P4 [default: all columns P1, P2, ..]
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    inputs: Option<Vec<String>>,
    /// Voltages so many seconds ago are inputs as well, as 0.1,0.2
    #[arg(long, value_name = "SECONDS,..", value_delimiter = ',')]
    lags: Vec<f64>,
    /// Predicted forces are brought into the cone of this coefficient of friction
    #[arg(long, value_name = "MU")]
    friction: Option<f64>,
    /// Where rows do not determine the linear or quadratic model: refuse, minimum-norm, drop (photodiodes that add
    /// nothing) or ridge=LAMBDA
    #[arg(long, value_name = "WHAT", default_value = "refuse", value_parser = str::parse::<Deficient>)]
    deficient: Deficient,
    /// Where a network's first weights come from
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Networks that are trained, of which the best on the rows to stop on is taken
    #[arg(
        long,
        value_name = "N",
        default_value_t = Recipe::new(Kind::Linear).restarts as u16,
        value_parser = clap::value_parser!(u16).range(1..=1000)
    )]
    restarts: u16,
    /// Epochs that a network is trained for at most
    #[arg(
        long,
        value_name = "N",
        default_value_t = Recipe::new(Kind::Linear).max_epochs as u32,
        value_parser = clap::value_parser!(u32).range(1..)
    )]
    epochs: u32,
    /// The share of rows that prediction intervals are to hold
    #[arg(long, value_name = "SHARE", default_value_t = LEVEL)]
    level: f64,
    #[command(flatten)]
    rows: RowsArgs,
    /// A recording that can't be read is named and left out (exit status 1), where others can be [default: it is an
    /// error]
    #[arg(long)]
    skip_failed: bool,
    /// The model file
    #[arg(long, value_name = "MODEL.json", required_unless_present = "plan")]
    out: Option<PathBuf>,
    /// The error on the recordings to validate on, against how much was trained on: a table, and a picture beside it
    #[arg(long, value_name = "CURVE.csv", requires = "validate")]
    learning_curve: Option<PathBuf>,
    /// Say what would be done and left out, and do nothing
    #[arg(long)]
    plan: bool,
    #[command(flatten)]
    common: Common,
}

pub(crate) fn run(args: &TrainArgs) -> anyhow::Result<Outcome> {
    let stop = args.common.start()?;
    let level = share(args.level).map_err(|why| anyhow::anyhow!("--level {why}"))?;
    let inputs = TrainInputs {
        data: DataFile::of(&args.data),
        validate: DataFile::of(&args.validate),
        stop_on: DataFile::of(&args.stop_on),
    };
    let options = TrainOptions {
        wanted: Wanted { skip_failed: args.skip_failed, ..args.rows.wanted(args.inputs.clone(), &args.target) },
        recipe: Recipe {
            deficient: args.deficient,
            seed: args.seed,
            restarts: usize::from(args.restarts),
            max_epochs: args.epochs as usize,
            lags_s: args.lags.clone(),
            friction_mu: args.friction,
            ..Recipe::new(args.model.kind(args.hidden))
        },
        level,
    };
    if args.plan {
        let steps = train_plan(&inputs, &options.recipe, args.learning_curve.is_some());
        return args.common.show_plan("train", &steps);
    }
    let out = args.out.as_ref().context("--out is needed")?;
    let outputs = TrainOutputs { model: out.clone(), learning_curve: args.learning_curve.clone(), merit: None };
    let report = run_train(&inputs, &options, &outputs, &stop).map_err(ended)?;
    report.failed.iter().for_each(|file| eprintln!("failed: {}", file.why));
    say_notes(&args.common, &report.warnings);
    args.common.print_json(&report)?;
    let common = &args.common;
    for file in report.data.iter().chain(&report.validate).filter(|file| file.used < file.rows) {
        common.say(&format!(
            "{}: {} of {} rows used ({} lack a cell, {} invalid, {} with a fault of the sensor)",
            file.path.display(),
            file.used,
            file.rows,
            file.empty,
            file.invalid,
            file.faults
        ));
    }
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
                "{} parameters; best of {} networks after {} epochs; RMSE in SDs: best {:.4}, median {:.4}, quartiles \
                 {:.4} apart",
                fit.parameters,
                fit.restarts.len(),
                best.best_epoch,
                best.score,
                fit.median_score,
                fit.score_iqr
            ));
        }
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
                100.0 * args.level,
                figure(*half)
            ));
        }
    }
    if common.verbose {
        report.data.iter().chain(&report.validate).flat_map(|file| &file.notes).for_each(|note| common.say(note));
        common.say_left_out(&report.left_out);
        common.say_stages(&report.stages);
    }
    common.say(&format!("{:.2} s; the model is {}", report.wall_s, out.display()));
    Ok(if report.failed.is_empty() { Outcome::Done } else { Outcome::SomeFailed })
}
