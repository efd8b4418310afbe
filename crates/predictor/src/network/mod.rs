//! Training of networks (equations 17, 18): Levenberg-Marquardt from several seeded starts, stopped early.
//!
//! In: a [`Dataset`] to fit, another to stop at, options. Out: the best restart's [`Network`] and what every restart
//! came to. The stop rows choose the epoch and the restart, so they are not for reporting the error: that takes a third
//! set.
//!
//! Inputs and targets are centred and scaled by the training rows. Photodiodes that do not change get weight 0, targets
//! that do not change are predicted as they are; both with a warning. Fewer errors than weights are allowed with a
//! warning: damping keeps each step finite, and only the stop rows keep such a network from learning its rows by heart.
//!
//! Each restart has a random stream of its own (ChaCha8: the seed, the restart's number) and runs on one thread in a
//! fixed order of sums, so results are the same bytes for any number of threads and on any processor.

mod cholesky;
mod descent;
mod normal;
mod rows;
mod scaling;
mod start;
#[cfg(test)]
mod tests;
mod weights;

use ndarray::Array2;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use thiserror::Error;

pub use descent::Stopped;

use crate::{Dataset, Network};
use rows::Rows;
use scaling::Scaling;
use weights::Shape;

/// How a network is trained. Figures are MATLAB's (`trainlm`) where it has them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TrainOptions {
    /// Hidden nodes N.
    pub hidden: usize,
    /// Of the random starts.
    pub seed: u64,
    /// Starts.
    pub restarts: usize,
    /// The most epochs of a restart.
    pub max_epochs: usize,
    /// Epochs without a new least error on the stop rows until a restart ends.
    pub patience: usize,
    /// The gradient's length (mean square error of targets of SD 1, by weights) below which a restart has converged.
    pub min_gradient: f64,
    /// A restart has settled when its mean square error fell by less than this share in 10 epochs; 0: never. 1e-4 costs
    /// 0.1 to 0.5 % of the RMSE that four times as many epochs reach.
    pub min_decrease: f64,
}

impl Default for TrainOptions {
    fn default() -> Self {
        Self { hidden: 8, seed: 1, restarts: 10, max_epochs: 1000, patience: 6, min_gradient: 1e-7, min_decrease: 1e-4 }
    }
}

/// What one restart came to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Restart {
    /// Which, from 0: its random stream.
    pub index: usize,
    /// Epochs run.
    pub epochs: usize,
    /// After how many the weights were kept.
    pub best_epoch: usize,
    /// Why it ended.
    pub why: Stopped,
    /// RMSE of the training rows, each target in its unit.
    pub train_rmse: Vec<f64>,
    /// RMSE of the stop rows, each target in its unit; `None` without stop rows.
    pub stop_rmse: Option<Vec<f64>>,
    /// What restarts are compared by: RMSE of all targets that change, each in its standard deviations, on the stop
    /// rows or, where there are none, on the training rows.
    pub score: f64,
}

/// How training went.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TrainReport {
    /// Hidden nodes N.
    pub hidden: usize,
    /// Weights and biases that were fitted.
    pub parameters: usize,
    /// Training rows.
    pub rows: usize,
    /// Rows that training was stopped by; `None`: it ran until it converged.
    pub stop_rows: Option<usize>,
    /// Of the random starts.
    pub seed: u64,
    /// All, in order.
    pub restarts: Vec<Restart>,
    /// The one whose network was returned: the least score, the first of equal ones.
    pub best: usize,
    /// The scores' median.
    pub median_score: f64,
    /// From the scores' lower to their upper quartile.
    pub score_iqr: f64,
    /// What a user should know.
    pub warnings: Vec<String>,
}

/// Why no network was trained.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum TrainFault {
    #[error("there are no {what} {of}: nothing can be trained")]
    Nothing { what: &'static str, of: &'static str },
    #[error("{0} is 0, it must be at least 1")]
    Option(&'static str),
    #[error("the stop rows hold {found}, the training rows {wanted}: give both the same columns in the same order")]
    Columns { found: String, wanted: String },
    #[error("{0} spans more than 1.8e308, the largest number there is; give it another unit")]
    Range(String),
    #[error("the stop rows are beyond all comparison with the training rows; check their units")]
    Stop,
}

/// Trains a network on `data`, stopped by `stop`; without, it runs until it converges, which fits the noise too where
/// rows are few.
pub fn train_network(
    data: &Dataset,
    stop: Option<&Dataset>,
    options: &TrainOptions,
) -> Result<(Network, TrainReport), TrainFault> {
    check(data, stop, options)?;
    let mut warnings = Vec::new();
    let inputs = scalings(data.x(), data.inputs())?;
    let targets = scalings(data.y(), data.targets())?;
    for (scaling, name) in inputs.iter().zip(data.inputs()).filter(|(scaling, _)| scaling.constant) {
        warnings.push(format!("{name} is {:?} in all training rows: its weights are 0", scaling.centre));
    }
    for (scaling, name) in targets.iter().zip(data.targets()).filter(|(scaling, _)| scaling.constant) {
        warnings.push(format!("{name} is {:?} in all training rows, and so in all predictions", scaling.centre));
    }
    let live = |all: &[Scaling]| -> Vec<(usize, Scaling)> {
        all.iter().copied().enumerate().filter(|(_, scaling)| !scaling.constant).collect()
    };
    let inputs: Vec<Scaling> = inputs.into_iter().map(Scaling::rounded).collect();
    let (live_inputs, live_targets) = (live(&inputs), live(&targets));
    let shape = Shape { inputs: live_inputs.len(), hidden: options.hidden, targets: live_targets.len() };
    let rows = Rows::new(data.x(), data.y(), &live_inputs, &live_targets);
    let stop_rows = stop.map(|stop| Rows::new(stop.x(), stop.y(), &live_inputs, &live_targets));
    if !live_targets.is_empty() && data.rows() * live_targets.len() < shape.parameters() {
        warnings.push(format!(
            "{} rows for {} weights: without more rows or fewer nodes the network learns its rows by heart",
            data.rows(),
            shape.parameters()
        ));
    }
    if stop.is_none() {
        warnings.push("no stop rows: training ran until it converged, which fits the noise too".to_owned());
    }
    let ranges = rows.ranges();
    let build = |weights: &[f64]| network(shape, weights, &inputs, &targets);
    let runs: Vec<(Restart, Network)> = (0..options.restarts)
        .into_par_iter()
        .map(|index| {
            let mut random = ChaCha8Rng::seed_from_u64(options.seed);
            random.set_stream(index as u64);
            let first = start::nguyen_widrow(shape, &ranges, &mut random);
            let run = descent::descend(shape, first, &rows, stop_rows.as_ref(), options);
            let network = build(&run.weights);
            let train = rmse(&network, data);
            let stop_rmse = stop.map(|stop| rmse(&network, stop));
            let score = score(stop_rmse.as_ref().unwrap_or(&train), &targets);
            let restart = Restart {
                index,
                epochs: run.epochs,
                best_epoch: run.best_epoch,
                why: run.why,
                train_rmse: train,
                stop_rmse,
                score,
            };
            (restart, network)
        })
        .collect();
    let mut best = 0;
    let (mut restarts, mut networks) = (Vec::new(), Vec::new());
    for (restart, network) in runs {
        let finite = |rmse: &[f64]| rmse.iter().all(|value| value.is_finite());
        if !(restart.score.is_finite() && restart.stop_rmse.as_deref().is_none_or(finite)) {
            return Err(TrainFault::Stop);
        }
        restarts.push(restart);
        networks.push(network);
        let last = restarts.len() - 1;
        if restarts[last].score < restarts[best].score {
            best = last;
        }
    }
    let mut scores: Vec<f64> = restarts.iter().map(|restart| restart.score).collect();
    scores.sort_by(f64::total_cmp);
    if restarts[best].why == Stopped::MaxEpochs {
        warnings.push(format!("the best restart was still improving after {} epochs; allow more", options.max_epochs));
    }
    let report = TrainReport {
        hidden: options.hidden,
        parameters: shape.parameters(),
        rows: data.rows(),
        stop_rows: stop.map(Dataset::rows),
        seed: options.seed,
        best,
        median_score: quantile(&scores, 0.5),
        score_iqr: quantile(&scores, 0.75) - quantile(&scores, 0.25),
        restarts,
        warnings,
    };
    Ok((networks.swap_remove(best), report))
}

fn check(data: &Dataset, stop: Option<&Dataset>, options: &TrainOptions) -> Result<(), TrainFault> {
    for (name, value) in [("the number of hidden nodes", options.hidden), ("the number of restarts", options.restarts)]
    {
        if value == 0 {
            return Err(TrainFault::Option(name));
        }
    }
    if data.rows() == 0 {
        return Err(TrainFault::Nothing { what: "rows", of: "to train on" });
    }
    if data.targets().is_empty() {
        return Err(TrainFault::Nothing { what: "targets", of: "to train for" });
    }
    if let Some(stop) = stop {
        let columns = |data: &Dataset| [data.inputs(), data.targets()].concat().join(", ");
        let (found, wanted) = (columns(stop), columns(data));
        if found != wanted {
            return Err(TrainFault::Columns { found, wanted });
        }
        if stop.rows() == 0 {
            return Err(TrainFault::Nothing { what: "rows", of: "to stop by" });
        }
    }
    Ok(())
}

fn scalings(values: &Array2<f64>, names: &[String]) -> Result<Vec<Scaling>, TrainFault> {
    let one = |(column, name): (_, &String)| Scaling::of(column).ok_or_else(|| TrainFault::Range(name.clone()));
    values.columns().into_iter().zip(names).map(one).collect()
}

/// The network of all inputs and targets: those that do not change have weights of 0.
fn network(shape: Shape, weights: &[f64], inputs: &[Scaling], targets: &[Scaling]) -> Network {
    let places = |all: &[Scaling]| -> Vec<usize> { (0..all.len()).filter(|&k| !all[k].constant).collect() };
    let mut hidden_weights = Array2::zeros((shape.hidden, inputs.len()));
    let mut hidden_biases = vec![0.0; shape.hidden];
    for (node, weights) in weights[..shape.first()].chunks_exact(1 + shape.inputs).enumerate() {
        hidden_biases[node] = weights[0];
        for (weight, i) in weights[1..].iter().zip(places(inputs)) {
            hidden_weights[[node, i]] = *weight;
        }
    }
    let mut output_weights = Array2::zeros((targets.len(), shape.hidden));
    let mut output_biases = vec![0.0; targets.len()];
    for (weights, k) in shape.outputs(weights).zip(places(targets)) {
        output_biases[k] = weights[0];
        for (node, weight) in weights[1..].iter().enumerate() {
            output_weights[[k, node]] = *weight;
        }
    }
    let centres = |all: &[Scaling]| all.iter().map(|scaling| scaling.centre).collect();
    let scales = |all: &[Scaling]| all.iter().map(|scaling| scaling.scale).collect();
    Network::new(
        centres(inputs),
        scales(inputs),
        hidden_weights,
        hidden_biases,
        output_weights,
        output_biases,
        centres(targets),
        scales(targets),
    )
    .expect("finite weights: a step that is not finite is never taken")
}

/// Each target's RMSE in its unit, without overflow.
fn rmse(network: &Network, data: &Dataset) -> Vec<f64> {
    let errors = network.predict(data.x().view()) - data.y();
    let one = |column: ndarray::ArrayView1<'_, f64>| {
        let unit = scaling::power_of_two(column.iter().fold(0.0_f64, |most, error| most.max(error.abs())));
        (column.iter().map(|error| (error / unit).powi(2)).sum::<f64>() / column.len() as f64).sqrt() * unit
    };
    errors.columns().into_iter().map(one).collect()
}

fn score(rmse: &[f64], targets: &[Scaling]) -> f64 {
    let live: Vec<f64> = rmse
        .iter()
        .zip(targets)
        .filter(|(_, scaling)| !scaling.constant)
        .map(|(rmse, scaling)| rmse / scaling.scale)
        .collect();
    if live.is_empty() { 0.0 } else { (live.iter().map(|value| value * value).sum::<f64>() / live.len() as f64).sqrt() }
}

/// Linear between the sorted values.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    let place = share * (sorted.len() - 1) as f64;
    let below = sorted[place.floor() as usize];
    below + (sorted[place.ceil() as usize] - below) * place.fract()
}
