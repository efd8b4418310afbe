//! Fitting the network: Adam on small batches of fresh samples, the gradient walked back by hand.

use lunula::clock::training::{
    ANSWERS, COLUMNS_1, COLUMNS_2, FIRST, FLAT, HIDDEN, Net, PARTS, REACH, ROW, ROW_1, ROWS_1, ROWS_2, SECOND, Trace,
    parts,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::flaws::bell;
use super::scene::Sample;

/// Characters of a batch.
const BATCH: usize = 160;
/// A batch is always summed in these parts, however many threads there are.
const PORTIONS: usize = 8;

/// Random weights to start from.
fn start(rng: &mut ChaCha8Rng) -> Vec<f32> {
    let inputs = [REACH * REACH, 0, 9 * FIRST, 0, FLAT, 0, HIDDEN, 0];
    let mut weights = Vec::new();
    for (count, inputs) in PARTS.into_iter().zip(inputs) {
        let sd = if inputs == 0 { 0.0 } else { (2.0 / inputs as f32).sqrt() };
        weights.extend((0..count).map(|_| sd * bell(rng)));
    }
    weights
}

fn parts_mut(weights: &mut [f32]) -> [&mut [f32]; 8] {
    let mut rest = weights;
    PARTS.map(|count| {
        let (part, after) = std::mem::take(&mut rest).split_at_mut(count);
        rest = after;
        part
    })
}

/// Adds a sample's gradient; gives its loss.
pub(super) fn walk_back(net: &Net, sample: &Sample, trace: &mut Trace, gradient: &mut [f32]) -> f32 {
    net.follow(&sample.patch, trace);
    let [_, _, w2, _, w3, _, w4, _] = parts(&net.weights);
    let [g1, h1, g2, h2, g3, h3, g4, h4] = parts_mut(gradient);
    let most = trace.answers.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    let shares = trace.answers.map(|a| (a - most).exp());
    let total: f32 = shares.iter().sum();
    let loss = total.ln() + most - trace.answers[sample.label];
    let mut d4 = shares.map(|s| s / total);
    d4[sample.label] -= 1.0;

    let mut d3 = [0.0f32; HIDDEN];
    for (k, h) in trace.hidden.iter().enumerate() {
        let row = k * ANSWERS..(k + 1) * ANSWERS;
        for ((g, w), d) in g4[row.clone()].iter_mut().zip(&w4[row]).zip(&d4) {
            *g += h * d;
            d3[k] += w * d;
        }
        if *h <= 0.0 {
            d3[k] = 0.0;
        }
    }
    h4.iter_mut().zip(&d4).for_each(|(g, d)| *g += d);
    h3.iter_mut().zip(&d3).for_each(|(g, d)| *g += d);
    let mut d2 = [0.0f32; FLAT];
    for (k, value) in trace.second.iter().chain([&trace.aspect]).enumerate() {
        if *value == 0.0 {
            continue;
        }
        let row = k * HIDDEN..(k + 1) * HIDDEN;
        g3[row.clone()].iter_mut().zip(&d3).for_each(|(g, d)| *g += value * d);
        if k < FLAT {
            d2[k] = w3[row].iter().zip(&d3).map(|(w, d)| w * d).sum();
        }
    }
    let mut d1 = [0.0f32; ROW_1 * (ROWS_1 + 2) * FIRST];
    for (place, d) in d2.chunks_exact(SECOND).enumerate() {
        if d.iter().all(|d| *d == 0.0) {
            continue;
        }
        h2.iter_mut().zip(d).for_each(|(g, d)| *g += d);
        let (x, y) = (place % COLUMNS_2, place / COLUMNS_2);
        for i in 0..3 {
            let at = ((2 * y + i) * ROW_1 + 2 * x) * FIRST;
            for k in 0..3 * FIRST {
                let value = trace.first[at + k];
                let row = (i * 3 * FIRST + k) * SECOND..(i * 3 * FIRST + k + 1) * SECOND;
                if value > 0.0 {
                    g2[row.clone()].iter_mut().zip(d).for_each(|(g, d)| *g += value * d);
                    d1[at + k] += w2[row].iter().zip(d).map(|(w, d)| w * d).sum::<f32>();
                }
            }
        }
    }
    for y in 0..ROWS_1 {
        for x in 0..COLUMNS_1 {
            let at = ((y + 1) * ROW_1 + x + 1) * FIRST;
            let d = &d1[at..at + FIRST];
            if d.iter().all(|d| *d == 0.0) {
                continue;
            }
            h1.iter_mut().zip(d).for_each(|(g, d)| *g += d);
            for i in 0..REACH {
                for j in 0..REACH {
                    let value = trace.input[(2 * y + i) * ROW + 2 * x + j];
                    let row = (i * REACH + j) * FIRST;
                    g1[row..row + FIRST].iter_mut().zip(d).for_each(|(g, d)| *g += value * d);
                }
            }
        }
    }
    debug_assert_eq!(COLUMNS_2 * ROWS_2 * SECOND, FLAT);
    loss
}

/// Fits to `steps` batches; `draw` gives the samples of a number, `report` gets each thousandth step and the mean loss
/// since the one before.
pub(super) fn fit(
    steps: usize,
    seed: u64,
    draw: impl Fn(u64) -> Vec<Sample> + Sync,
    mut report: impl FnMut(usize, f32, &Net),
) -> Net {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut net = Net { weights: start(&mut rng) };
    let count = net.weights.len();
    let (mut m, mut v) = (vec![0.0f32; count], vec![0.0f32; count]);
    let mut losses = 0.0;
    let first: u64 = rng.random::<u64>() >> 16;
    for step in 0..steps {
        let portions: Vec<(Vec<f32>, f32, u32)> = (0..PORTIONS)
            .into_par_iter()
            .map(|portion| {
                let mut gradient = vec![0.0f32; count];
                let mut trace = Trace::default();
                let each = BATCH / PORTIONS;
                let (mut loss, mut count) = (0.0, 0);
                for k in 0..each {
                    for sample in draw(first + (step * BATCH + portion * each + k) as u64) {
                        loss += walk_back(&net, &sample, &mut trace, &mut gradient);
                        count += 1;
                    }
                }
                (gradient, loss, count)
            })
            .collect();
        let samples = portions.iter().map(|p| p.2).sum::<u32>() as f32;
        let warm = ((step + 1) as f32 / 200.0).min(1.0);
        let done = step as f32 / steps as f32;
        let rate = 2e-3 * warm * 0.5 * (1.0 + (std::f32::consts::PI * done).cos()) + 2e-6;
        let t = step as i32 + 1;
        let (c1, c2) = (1.0 - 0.9f32.powi(t), 1.0 - 0.999f32.powi(t));
        for k in 0..count {
            let g = portions.iter().map(|p| p.0[k]).sum::<f32>() / samples;
            m[k] = 0.9 * m[k] + 0.1 * g;
            v[k] = 0.999 * v[k] + 0.001 * g * g;
            net.weights[k] -= rate * (m[k] / c1) / ((v[k] / c2).sqrt() + 1e-8);
        }
        losses += portions.iter().map(|p| p.1).sum::<f32>() / samples;
        if (step + 1) % 1000 == 0 {
            report(step + 1, losses / 1000.0, &net);
            losses = 0.0;
        }
    }
    net
}
