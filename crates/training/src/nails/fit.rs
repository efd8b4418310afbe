//! Fitting a network: Adam on small batches, seeded.

use lunula::photo::outline::training::{Net, softsign};
use rand::{SeedableRng, seq::SliceRandom};
use rand_chacha::ChaCha8Rng;

use super::rows::Rows;
use super::scenes::bell;

/// Adam on squared error (`logistic` false) or on the logistic loss.
pub(super) fn fit(rows: &Rows, hidden: usize, epochs: usize, logistic: bool, decay: f32, seed: u64) -> Net {
    let n = rows.x[0].len();
    let count = rows.x.len();
    let norm: Vec<[f32; 2]> = (0..n)
        .map(|i| {
            let mean = rows.x.iter().map(|r| f64::from(r[i])).sum::<f64>() / count as f64;
            let var = rows.x.iter().map(|r| (f64::from(r[i]) - mean).powi(2)).sum::<f64>() / count as f64;
            [mean as f32, (1.0 / (var.sqrt() + 1e-3)) as f32]
        })
        .collect();
    let z: Vec<Vec<f32>> =
        rows.x.iter().map(|r| r.iter().zip(&norm).map(|(v, m)| (v - m[0]) * m[1]).collect()).collect();
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut w: Vec<f32> = (0..(n + 1) * hidden).map(|_| (bell(&mut rng) / (n as f64).sqrt()) as f32).collect();
    w.extend((0..hidden).map(|_| (bell(&mut rng) / (hidden as f64).sqrt()) as f32));
    w.push(0.0);
    let (mut m, mut v) = (vec![0.0f32; w.len()], vec![0.0f32; w.len()]);
    let mut order: Vec<usize> = (0..count).collect();
    let batch = 64;
    let mut t = 0;
    let split = (n + 1) * hidden;
    for epoch in 0..epochs {
        order.shuffle(&mut rng);
        let rate = 3e-3 * (1.0 - epoch as f32 / epochs as f32) + 5e-5;
        for part in order.chunks(batch) {
            let mut g: Vec<f32> = w.iter().enumerate().map(|(i, w)| if i < split { decay * w } else { 0.0 }).collect();
            let scale = 1.0 / part.len() as f32;
            for &i in part {
                let x = &z[i];
                let pre: Vec<f32> = w[..split]
                    .chunks_exact(n + 1)
                    .map(|u| u[n] + u[..n].iter().zip(x).map(|(a, b)| a * b).sum::<f32>())
                    .collect();
                let out = w[split + hidden] + pre.iter().zip(&w[split..]).map(|(p, w)| softsign(*p) * w).sum::<f32>();
                let e = scale * if logistic { 1.0 / (1.0 + (-out).exp()) - rows.y[i] } else { out - rows.y[i] };
                g[split + hidden] += e;
                for k in 0..hidden {
                    g[split + k] += e * softsign(pre[k]);
                    let d = e * w[split + k] / (1.0 + pre[k].abs()).powi(2);
                    let unit = &mut g[k * (n + 1)..(k + 1) * (n + 1)];
                    unit[n] += d;
                    for (g, x) in unit[..n].iter_mut().zip(x) {
                        *g += d * x;
                    }
                }
            }
            t += 1;
            let (c1, c2) = (1.0 - 0.9f32.powi(t), 1.0 - 0.999f32.powi(t));
            for i in 0..w.len() {
                m[i] = 0.9 * m[i] + 0.1 * g[i];
                v[i] = 0.999 * v[i] + 0.001 * g[i] * g[i];
                w[i] -= rate * (m[i] / c1) / ((v[i] / c2).sqrt() + 1e-8);
            }
        }
    }
    Net { inputs: n, hidden, norm, first: w[..split].to_vec(), second: w[split..].to_vec() }
}

/// Root mean square error on the rows.
pub(super) fn rms(net: &Net, rows: &Rows) -> f32 {
    (rows.x.iter().zip(&rows.y).map(|(x, y)| (net.answer(x) - y).powi(2)).sum::<f32>() / rows.y.len() as f32).sqrt()
}

/// The weights as [`Net::parse`] reads them.
pub(super) fn text(net: &Net) -> String {
    let mut out = format!("{} {}\n", net.inputs, net.hidden);
    for [a, b] in &net.norm {
        out += &format!("{a} {b}\n");
    }
    for w in net.first.iter().chain(&net.second) {
        out += &format!("{w}\n");
    }
    out
}
