//! Whether the voltages hold something beside the model that parameters take up.
//!
//! Light may change with the load itself (the nail bends and tilts under the sensor), and a photodiode may not be quite
//! linear. Both look much like another stiffness, and what is left of them in the residuals passes for slow noise. So
//! to each photodiode is added, in turn, a part that goes with the load, and one with the square of its signal,
//! parameters following on the linearized model. Where that explains clearly more, standard errors don't say how sure
//! parameters are.
//!
//! What is not determined: which of the two it is, or whether a parameter that is held is another finger's, which looks
//! alike and makes errors as large.
//!
//! Measured (`tests/fit/beside.rs`): 3 % of the step that go with the load put a stiffness four standard errors off.

use crate::fit::algebra::levenberg::Point;
use crate::fit::algebra::qr::{norm, triangle};
use crate::fit::problem::{Evaluation, Problem};

/// Of a column's norm, what is left of it when parameters do the same.
const DEPENDENT: f64 = 1e-6;

/// Less of a photodiode's range is rounding of a recording without noise, or of no consequence (assumed).
const LEAST_SHARE: f64 = 0.003;

/// What voltages may hold beside the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Part {
    /// Light that goes with the load.
    Load,
    /// A signal that goes with its own square.
    Square,
}

/// A part that was found.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Beside {
    /// Which.
    pub part: Part,
    /// Its largest share of a photodiode's range.
    pub share: f64,
    /// The root of what it explains of the sum of squares, for each photodiode, in standard deviations of the noise.
    pub sds: f64,
}

impl Beside {
    /// Whether it is more than noise does: of 400 recordings of the model with white noise, pulse and waves it is at
    /// most 3.2 standard deviations.
    #[must_use]
    pub fn is_clear(&self) -> bool {
        self.sds > 4.0 && self.share > LEAST_SHARE
    }
}

/// The part that explains most, the coordinates `inside` their bounds following.
pub(in crate::fit) fn beside(problem: &Problem, best: &Evaluation, inside: &[usize], sd_v: f64) -> Option<Beside> {
    let of = |part: Part| {
        let (raw, ranges): (Vec<Vec<f64>>, Vec<f64>) =
            (0..problem.diodes.len()).map(|diode| column(problem, best, diode, part)).unzip();
        let extra = problem.as_columns(best, raw);
        let wholes: Vec<f64> = extra.iter().map(|column| norm(column)).collect();
        let mut columns: Vec<Vec<f64>> = inside.iter().map(|&q| best.columns()[q].clone()).collect();
        columns.extend(extra);
        let (n, first, mut target) = (columns.len(), inside.len(), best.residuals().to_vec());
        let r = triangle(&mut columns, &mut target);
        let free = |k: usize| k < first || r[k * n + k].abs() > DEPENDENT * wholes[k - first];
        if n == first || !(0..n).all(free) {
            return None;
        }
        let mut moved = vec![0.0; n];
        for k in (0..n).rev() {
            let known: f64 = (k + 1..n).map(|j| r[k * n + j] * moved[j]).sum();
            moved[k] = (target[k] - known) / r[k * n + k];
        }
        let squares: f64 = target[first..n].iter().map(|value| value * value).sum();
        let shares = moved[first..].iter().zip(&ranges).map(|(size, range)| (size / range).abs());
        Some(Beside { part, share: shares.fold(0.0, f64::max), sds: (squares / (n - first) as f64).sqrt() / sd_v })
    };
    [Part::Load, Part::Square].into_iter().filter_map(of).max_by(|a, b| a.sds.total_cmp(&b.sds))
}

/// What a part adds to a diode's signal, weighted, from 0 to 1; 0 in the rows of others. And the signal's range.
fn column(problem: &Problem, best: &Evaluation, of: usize, part: Part) -> (Vec<f64>, f64) {
    let rows = problem.diodes[of].rows.clone();
    let mut column = vec![0.0; problem.target.len()];
    for channel in problem.channels.iter().filter(|channel| rows.contains(&channel.rows.start)) {
        let own = match part {
            Part::Load => problem.loads_pa(channel),
            Part::Square => best.signals[channel.rows.clone()].to_vec(),
        };
        column[channel.rows.clone()].copy_from_slice(&own);
    }
    let ends = |values: &[f64]| {
        values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], value| [a.min(*value), b.max(*value)])
    };
    let [least, most] = ends(&column[rows.clone()]);
    for row in rows.clone() {
        let along = (column[row] - least) / (most - least).max(f64::MIN_POSITIVE);
        column[row] = problem.weights[row] * if part == Part::Square { along * along } else { along };
    }
    let [least, most] = ends(&best.signals[rows]);
    (column, most - least)
}
