//! Digits drawn with many typefaces and as seven segments, and what is no digit; no photographs.
//!
//! In: a folder of typefaces ([`Faces`]), a count of steps. Out: a network ([`train`]), its weights as text ([`text`]),
//! and what any network is worth on what it was not made from ([`judge`]).

mod faces;
mod fit;
mod flaws;
mod mask;
mod scene;
mod segments;
#[cfg(test)]
mod tests;

use image::{GrayImage, Luma};
use lunula::clock::Scores;
use lunula::clock::training::{HEIGHT, Net, PARTS, WIDTH};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

pub use faces::{Face, Faces};
pub use scene::{Kind, OTHER, Sample, samples};
pub use segments::Display;

/// Confidences at which outcomes are counted.
pub const LEVELS: [f64; 5] = [0.8, 0.9, 0.95, 0.98, 0.99];
/// Of the first weights and of the numbers of the samples.
const SEED: u64 = 1;
/// The first number of the held-out samples that training reports on; those of training are far below.
const WATCHED: u64 = 1 << 50;
/// The first number of the samples of [`figures`].
const JUDGED: u64 = 1 << 51;
/// Held-out samples of a report in training.
const WATCHED_COUNT: u64 = 4000;

/// What becomes of samples.
#[derive(Debug, Default)]
pub struct Outcome {
    /// How many.
    pub count: usize,
    /// Read right at each of [`LEVELS`].
    pub right: [usize; LEVELS.len()],
    /// Read wrong, what is no digit as a digit among them, at each of [`LEVELS`].
    pub wrong: [usize; LEVELS.len()],
    /// How often the likeliest digit is at least 0.5 probable, and how often it is right then.
    pub answered: [usize; 2],
    /// The sum of its probability then.
    pub promised: f64,
    /// Sum of the logarithmic loss.
    pub loss: f64,
}

fn draw(faces: &Faces, kind: Kind, number: u64) -> Sample {
    samples(faces, kind, 1, &mut ChaCha8Rng::seed_from_u64(number)).swap_remove(0)
}

/// What a network makes of `count` samples, from number `from` on.
pub fn judge(net: &Net, faces: &Faces, kind: Kind, from: u64, count: u64) -> Outcome {
    let each: Vec<(usize, Scores)> = (from..from + count)
        .into_par_iter()
        .map(|k| {
            let s = draw(faces, kind, k);
            (s.label, net.scores(&s.patch))
        })
        .collect();
    let mut outcome = Outcome { count: each.len(), ..Outcome::default() };
    for (label, scores) in each {
        outcome.loss -= if label == OTHER { scores.other } else { scores.digits[label] }.max(1e-12).ln();
        let (digit, probability) = scores.likeliest();
        let right = usize::from(digit) == label;
        if probability >= 0.5 {
            outcome.answered[0] += 1;
            outcome.answered[1] += usize::from(right);
            outcome.promised += probability;
        }
        for (k, _) in LEVELS.iter().enumerate().filter(|(_, level)| probability >= **level) {
            if right { outcome.right[k] += 1 } else { outcome.wrong[k] += 1 }
        }
    }
    outcome
}

/// Fits a network to `steps` batches drawn with `known` typefaces. `report` gets each thousandth step, the mean loss
/// since the last report and what the network is worth on `held_out` ones.
pub fn train(known: &Faces, held_out: &Faces, steps: usize, mut report: impl FnMut(usize, f32, &Net, &Outcome)) -> Net {
    fit::fit(
        steps,
        SEED,
        |number| samples(known, Kind::Any, 2, &mut ChaCha8Rng::seed_from_u64(number)),
        |step, loss, net| report(step, loss, net, &judge(net, held_out, Kind::Any, WATCHED, WATCHED_COUNT)),
    )
}

/// What the weights that the library comes with are worth on `count` samples of each kind, a line each.
pub fn figures(faces: &Faces, count: u64) -> Vec<String> {
    let each = [Kind::Clean, Kind::Digits, Kind::Others, Kind::Any].into_iter();
    each.map(|kind| {
        let outcome = judge(Net::shipped(), faces, kind, JUDGED, count);
        let shares = |counts: [usize; LEVELS.len()]| counts.map(|n| n as f64 / outcome.count as f64);
        let [answered, right] = outcome.answered;
        format!(
            "{kind:?} {}: at {LEVELS:?} read {:.4?}, wrong {:?} {:.6?}; promised {:.4}, kept {:.4}",
            outcome.count,
            shares(outcome.right),
            outcome.wrong,
            shares(outcome.wrong),
            outcome.promised / answered as f64,
            right as f64 / answered as f64,
        )
    })
    .collect()
}

/// Weights as the library reads them: the parts one after the other, 16 numbers a line.
#[must_use]
pub fn text(net: &Net) -> String {
    let mut text = String::new();
    let mut rest = &net.weights[..];
    for count in PARTS {
        let (part, after) = rest.split_at(count);
        for line in part.chunks(16) {
            let numbers: Vec<String> = line.iter().map(|w| format!("{w:.3}")).collect();
            text.push_str(&numbers.join(" "));
            text.push('\n');
        }
        rest = after;
    }
    text
}

/// A sheet of samples to look at: eight rows of clean digits, eight of any, eight of what is no digit.
#[must_use]
pub fn sheet(faces: &Faces) -> GrayImage {
    let (columns, scale) = (30usize, 3usize);
    let (wide, tall) = (WIDTH * scale + 4, HEIGHT * scale + 4);
    let mut sheet = GrayImage::from_pixel((columns * wide) as u32, (24 * tall) as u32, Luma([90]));
    for row in 0..24usize {
        let kind = [Kind::Clean, Kind::Digits, Kind::Others][row / 8];
        for column in 0..columns {
            let s = draw(faces, kind, (row * columns + column) as u64);
            for y in 0..HEIGHT * scale {
                for x in 0..WIDTH * scale {
                    let ink = s.patch.ink()[y / scale * WIDTH + x / scale];
                    let value = ((ink + 0.3) / 1.6 * 255.0) as u8;
                    sheet.put_pixel((column * wide + x) as u32, (row * tall + y) as u32, Luma([value]));
                }
            }
        }
    }
    sheet
}
