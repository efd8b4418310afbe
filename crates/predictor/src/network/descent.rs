//! One restart: Levenberg's and Marquardt's descent from given weights.
//!
//! M. T. Hagan & M. B. Menhaj, Training feedforward networks with the Marquardt algorithm, IEEE Trans. Neural Networks
//! 5 (1994), doi 10.1109/72.329697, with the damping of MATLAB's `trainlm`: mu starts at 0.001, is divided by 10 after
//! a step that lowers the error and multiplied by 10 until one does. Departure: the error is the mean over rows and
//! targets, not the sum, so that mu means the same for any number of rows.

use serde::{Deserialize, Serialize};

use super::TrainOptions;
use super::cholesky::Damped;
use super::normal::Normal;
use super::rows::Rows;
use super::weights::{Forward, Shape};

const FIRST_DAMPING: f64 = 1e-3;
const DAMPING_STEP: f64 = 10.0;
const MOST_DAMPING: f64 = 1e10;
/// Below this a smaller damping changes nothing.
const LEAST_DAMPING: f64 = 1e-20;
/// Mean square error, of targets of variance 1, that only rounding leaves.
const PERFECT: f64 = 1e-28;
/// Over so many epochs [`TrainOptions::min_decrease`] is looked at.
const SETTLING: usize = 10;

/// Why training stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stopped {
    /// The error of the stop rows did not fall below its least for [`TrainOptions::patience`] epochs.
    StopRowsRose,
    /// The gradient is below [`TrainOptions::min_gradient`].
    Gradient,
    /// The error hardly falls any more: [`TrainOptions::min_decrease`].
    Settled,
    /// [`TrainOptions::max_epochs`] are over.
    MaxEpochs,
    /// No step lowers the error, however damped.
    DampingTooLarge,
    /// Only rounding is left of the error.
    Perfect,
}

#[derive(Debug, Clone)]
pub(super) struct Descent {
    /// Those of the best epoch.
    pub(super) weights: Vec<f64>,
    pub(super) epochs: usize,
    pub(super) best_epoch: usize,
    pub(super) why: Stopped,
}

/// The least error of the stop rows so far.
struct Best {
    error: f64,
    epoch: usize,
    weights: Vec<f64>,
}

/// Descends from `weights`. The weights returned are those of the least error on `stop`, or the last where there is
/// none.
pub(super) fn descend(
    shape: Shape,
    mut weights: Vec<f64>,
    rows: &Rows,
    stop: Option<&Rows>,
    options: &TrainOptions,
) -> Descent {
    let mut normal = Normal::new(shape);
    let mut damped = Damped::new(weights.len());
    let mut forward = Forward::new(shape);
    let mut trial = weights.clone();
    let mut error = forward.mean_square(&weights, rows);
    let mut past = vec![error];
    let mut mu = FIRST_DAMPING;
    let mut best =
        stop.map(|stop| Best { error: forward.mean_square(&weights, stop), epoch: 0, weights: weights.clone() });
    let mut epoch = 0;
    let why = loop {
        if error <= PERFECT {
            break Stopped::Perfect;
        }
        if best.as_ref().is_some_and(|best| epoch - best.epoch >= options.patience) {
            break Stopped::StopRowsRose;
        }
        if epoch == options.max_epochs {
            break Stopped::MaxEpochs;
        }
        if epoch >= SETTLING && past[epoch - SETTLING] - error <= options.min_decrease * error {
            break Stopped::Settled;
        }
        normal.accumulate(&weights, rows);
        // Twice: the gradient of the mean square.
        if 2.0 * normal.gradient.iter().map(|g| g * g).sum::<f64>().sqrt() < options.min_gradient {
            break Stopped::Gradient;
        }
        let lowered = loop {
            if damped.solve(&normal.matrix, &normal.gradient, mu) {
                for ((trial, weight), step) in trial.iter_mut().zip(&weights).zip(&damped.step) {
                    *trial = weight + step;
                }
                let tried = forward.mean_square(&trial, rows);
                // Not so where it is NaN.
                if tried < error {
                    break Some(tried);
                }
            }
            mu *= DAMPING_STEP;
            if mu > MOST_DAMPING {
                break None;
            }
        };
        let Some(lowered) = lowered else { break Stopped::DampingTooLarge };
        error = lowered;
        std::mem::swap(&mut weights, &mut trial);
        mu = (mu / DAMPING_STEP).max(LEAST_DAMPING);
        epoch += 1;
        past.push(error);
        if let (Some(best), Some(stop)) = (&mut best, stop) {
            let now = forward.mean_square(&weights, stop);
            if now < best.error || best.error.is_nan() {
                *best = Best { error: now, epoch, weights: weights.clone() };
            }
        }
    };
    match best {
        Some(best) => Descent { weights: best.weights, epochs: epoch, best_epoch: best.epoch, why },
        None => Descent { weights, epochs: epoch, best_epoch: epoch, why },
    }
}
