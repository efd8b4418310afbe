//! The options of the predictors' commands and of pipelines' stages, and what the jobs make of them.

use clap::Args;
use lunula_predictor::{By, Deficient, Gate, GateFault, Kind, OnScores, Recipe};

use crate::job::{not_negative, one_of};
use crate::predictor::data::{RowOptions, Wanted};
use crate::predictor::jobs::evaluate::EvaluateOptions;
use crate::predictor::jobs::predict::PredictOptions;
use crate::predictor::jobs::train::TrainOptions;
use crate::predictor::options::choices::{ByChoice, F_MIN_N, FOLDS, HIDDEN, LEVEL, ModelChoice, share};
use crate::predictor::options::target::Target;

fn level(text: &str) -> Result<f64, String> {
    share(text.trim().parse().map_err(|_| "write a number, such as 0.9".to_owned())?)
}

/// How a network is trained.
#[derive(Debug, Clone, Copy, Args)]
pub struct NetworkOptions {
    /// Hidden nodes of the network
    #[arg(long, value_name = "N", default_value_t = HIDDEN, value_parser = clap::value_parser!(u16).range(1..=1000))]
    pub hidden: u16,
    /// Seed of a network's first weights
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Networks that are trained; the best on the rows to stop on is taken
    #[arg(
        long,
        value_name = "N",
        default_value_t = Recipe::new(Kind::Linear).restarts as u16,
        value_parser = clap::value_parser!(u16).range(1..=1000)
    )]
    pub restarts: u16,
    /// Epochs that a network is trained for at most
    #[arg(
        long,
        value_name = "N",
        default_value_t = Recipe::new(Kind::Linear).max_epochs as u32,
        value_parser = clap::value_parser!(u32).range(1..)
    )]
    pub epochs: u32,
}

impl NetworkOptions {
    /// What is trained.
    #[must_use]
    pub fn recipe(self, model: ModelChoice) -> Recipe {
        Recipe {
            seed: self.seed,
            restarts: usize::from(self.restarts),
            max_epochs: self.epochs as usize,
            ..Recipe::new(model.kind(self.hidden))
        }
    }

    /// About how long training takes for so many rows, seconds: measured at 3e-6 s for each row, hidden node and start.
    #[must_use]
    pub fn cost_s(self, rows: f64) -> f64 {
        3e-6 * rows * f64::from(self.hidden) * f64::from(self.restarts)
    }
}

/// The options of `lunula train`.
#[derive(Debug, Clone, Args)]
pub struct TrainChoices {
    /// force (Fx_N, Fy_N, Fz_N), posture (J2_deg), or columns as Fz_N,J3_deg
    #[arg(long, value_name = "force|posture|COLUMNS", value_parser = Target::parse)]
    pub target: Target,
    /// Which model
    #[arg(long, value_parser = one_of::<ModelChoice>(), default_value = "linear")]
    pub model: ModelChoice,
    /// How a network is trained.
    #[command(flatten)]
    pub network: NetworkOptions,
    /// What eigennails fit to the scores
    #[arg(long, value_parser = one_of::<OnScores>(), default_value = "ridge")]
    pub regression: OnScores,
    /// Modes of eigennails [default: as many as do best on paths left out]
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u16).range(1..=1000))]
    pub modes: Option<u16>,
    /// The photodiodes to read, as P1,P3,P4 [default: all columns P1, P2, ..; of eigennails C_00_00, C_00_01, ..]
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub inputs: Option<Vec<String>>,
    /// Voltages so many seconds ago are inputs as well, as 0.1,0.2
    #[arg(long, value_name = "SECONDS,..", value_delimiter = ',')]
    pub lags: Vec<f64>,
    /// Predicted forces are brought into the cone of this coefficient of friction
    #[arg(long, value_name = "MU")]
    pub friction: Option<f64>,
    /// Where rows do not determine the linear or quadratic model: refuse, minimum-norm, drop (photodiodes that add
    /// nothing) or ridge=LAMBDA
    #[arg(long, value_name = "WHAT", default_value = "refuse", value_parser = str::parse::<Deficient>)]
    pub deficient: Deficient,
    /// The share of rows that prediction intervals are to hold
    #[arg(long, value_name = "SHARE", default_value_t = LEVEL, value_parser = level)]
    pub level: f64,
    /// Which rows count.
    #[command(flatten)]
    pub rows: RowOptions,
    /// A recording that can't be read is named and left out (exit status 1) as long as others can be [default: it is an
    /// error]
    #[arg(long)]
    pub skip_failed: bool,
}

impl TrainChoices {
    /// As the job takes them.
    #[must_use]
    pub fn options(&self) -> TrainOptions {
        let plain = self.network.recipe(self.model);
        let kind = match plain.kind {
            Kind::Eigennails { .. } => {
                Kind::Eigennails { on_scores: self.regression, modes: self.modes.map(usize::from) }
            }
            other => other,
        };
        TrainOptions {
            wanted: Wanted {
                inputs: self.inputs.clone(),
                targets: self.target.columns().to_vec(),
                rows: self.rows.clone(),
                skip_failed: self.skip_failed,
                cells: matches!(kind, Kind::Eigennails { .. }),
                ..Wanted::default()
            },
            recipe: Recipe {
                kind,
                deficient: self.deficient,
                lags_s: self.lags.clone(),
                friction_mu: self.friction,
                ..plain
            },
            level: self.level,
        }
    }
}

/// The options of `lunula evaluate`.
#[derive(Debug, Clone, Args)]
pub struct EvaluateChoices {
    /// What is held out in turn
    #[arg(long, value_parser = one_of::<ByChoice>())]
    pub by: Option<ByChoice>,
    /// Hold out by rows, trajectory, path, session and subject, beside the mean, the nearest row and (of a model of a
    /// nail's cells) a linear model of photodiodes: what shuffled rows and repeated paths flatter is named
    #[arg(long)]
    pub splits: bool,
    /// Parts of shuffled rows
    #[arg(long, value_name = "N", default_value_t = FOLDS, value_parser = clap::value_parser!(u16).range(2..=1000))]
    pub folds: u16,
    /// Seed of the shuffle
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// The share of rows that intervals of held-out parts are to hold
    #[arg(long, value_name = "SHARE", default_value_t = LEVEL, value_parser = level)]
    pub level: f64,
    /// Which rows count.
    #[command(flatten)]
    pub rows: RowOptions,
}

impl EvaluateChoices {
    /// As the job takes them.
    #[must_use]
    pub fn options(&self) -> EvaluateOptions {
        let by = self.by.map(|by| by.by(self.folds, self.seed));
        let rows = By::Rows { folds: usize::from(self.folds), seed: self.seed };
        let splits = self.splits.then_some([rows, By::Trajectory, By::Path, By::Session, By::Subject]);
        EvaluateOptions { rows: self.rows.clone(), by, splits, level: self.level, title: None }
    }
}

/// When the finger touches, and what its angle is then.
#[derive(Debug, Clone, Copy, Args)]
pub struct GateChoices {
    /// The pressing at or above which the finger touches
    #[arg(long, value_name = "NEWTONS", default_value_t = F_MIN_N)]
    pub f_min: f64,
    /// The angle while it touches
    #[arg(long, value_name = "DEGREES", default_value_t = 0.0, allow_negative_numbers = true)]
    pub theta_touch: f64,
    /// How far below --f-min the pressing has to fall before the finger no longer touches
    #[arg(long, value_name = "NEWTONS", default_value_t = 0.0, value_parser = not_negative)]
    pub hysteresis: f64,
}

impl GateChoices {
    /// The gate.
    ///
    /// # Errors
    /// Thresholds that can't be.
    pub fn gate(self) -> Result<Gate, GateFault> {
        Gate::new(self.f_min, self.theta_touch, self.hysteresis)
    }
}

/// The options of `lunula predict`.
#[derive(Debug, Clone, Args)]
pub struct PredictChoices {
    /// Equation 9's threshold and angle while touching.
    #[command(flatten)]
    pub gate: GateChoices,
    /// Each prediction's interval as well, as TARGET_low, TARGET_high (the models need to be trained with
    /// --validate)
    #[arg(long)]
    pub intervals: bool,
    /// Which rows count.
    #[command(flatten)]
    pub rows: RowOptions,
}

impl PredictChoices {
    /// As the job takes them.
    ///
    /// # Errors
    /// Thresholds that can't be.
    pub fn options(&self) -> Result<PredictOptions, GateFault> {
        Ok(PredictOptions { gate: self.gate.gate()?, intervals: self.intervals, rows: self.rows.clone() })
    }
}

/// The options of `lunula prune`.
#[derive(Debug, Clone, Args)]
pub struct PruneChoices {
    /// force, posture, or columns as Fz_N,J3_deg
    #[arg(long, value_name = "force|posture|COLUMNS", default_value = "force", value_parser = Target::parse)]
    pub target: Target,
    /// The photodiodes to choose from [default: all columns P1, P2, ..]
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub inputs: Option<Vec<String>>,
    /// Which rows count.
    #[command(flatten)]
    pub rows: RowOptions,
}

impl PruneChoices {
    /// As the job takes them.
    #[must_use]
    pub fn wanted(&self) -> Wanted {
        let targets = self.target.columns().to_vec();
        Wanted { inputs: self.inputs.clone(), targets, rows: self.rows.clone(), ..Wanted::default() }
    }
}
