//! The network that recognises digits: two layers of small filters, one hidden layer, eleven answers.
//!
//! In: a [`Patch`]. Out: for 0 to 9 and for anything else the logarithm of its probability, up to a common term. The
//! first filters look at 5 x 5 cells and step by two, the second at 3 x 3 and step by two; then come all the places'
//! values and the box's aspect into one hidden layer. Units pass what is above zero. Weights are text, numbers in the
//! order of [`PARTS`]; `digits` of `crates/training` makes them.

use std::sync::LazyLock;

use super::patch::{HEIGHT, Patch, WIDTH};
use super::scores::Scores;

/// Filters of the first layer.
pub const FIRST: usize = 12;
/// Filters of the second layer.
pub const SECOND: usize = 24;
/// Hidden units.
pub const HIDDEN: usize = 40;
/// The digits and anything else.
pub const ANSWERS: usize = 11;

/// The first filters' side, cells.
pub const REACH: usize = 5;
/// The border of zeros that the patch gets for them, cells.
const EDGE: usize = 2;
/// Columns of the patch with its border.
pub const ROW: usize = WIDTH + 2 * EDGE;
const ROWS: usize = HEIGHT + 2 * EDGE;
/// Columns of places of the first filters.
pub const COLUMNS_1: usize = WIDTH / 2;
/// Rows of places of the first filters.
pub const ROWS_1: usize = HEIGHT / 2;
/// Columns of their values with a border of one place.
pub const ROW_1: usize = COLUMNS_1 + 2;
/// Columns of places of the second filters.
pub const COLUMNS_2: usize = COLUMNS_1 / 2;
/// Rows of places of the second filters.
pub const ROWS_2: usize = ROWS_1 / 2;
/// What comes into the hidden layer but for the aspect.
pub const FLAT: usize = COLUMNS_2 * ROWS_2 * SECOND;

/// How many numbers: the first filters' weights (by cell, then filter) and biases, the second's (by place, first
/// filter, second filter) and biases, the hidden units' (by input, then unit; the aspect last) and biases, the answers'
/// (by unit) and biases.
pub const PARTS: [usize; 8] =
    [REACH * REACH * FIRST, FIRST, 9 * FIRST * SECOND, SECOND, (FLAT + 1) * HIDDEN, HIDDEN, HIDDEN * ANSWERS, ANSWERS];

/// The network.
#[derive(Debug, Clone, PartialEq)]
pub struct Net {
    /// In the order of [`PARTS`].
    pub weights: Vec<f32>,
}

/// Every value on the way, for training to walk back.
#[derive(Debug, Clone)]
pub struct Trace {
    /// The patch with a border.
    pub input: [f32; ROW * ROWS],
    /// The first filters' values with a border, filter by filter in each place.
    pub first: [f32; ROW_1 * (ROWS_1 + 2) * FIRST],
    /// The second filters' values, filter by filter in each place.
    pub second: [f32; FLAT],
    /// The patch's.
    pub aspect: f32,
    /// The hidden units' values.
    pub hidden: [f32; HIDDEN],
    /// The answers.
    pub answers: [f32; ANSWERS],
}

impl Default for Trace {
    fn default() -> Self {
        Self {
            input: [0.0; ROW * ROWS],
            first: [0.0; ROW_1 * (ROWS_1 + 2) * FIRST],
            second: [0.0; FLAT],
            aspect: 0.0,
            hidden: [0.0; HIDDEN],
            answers: [0.0; ANSWERS],
        }
    }
}

/// Adds `x` times a row of weights.
#[inline(always)]
fn add<const N: usize>(sums: &mut [f32; N], x: f32, weights: &[f32]) {
    for (sum, w) in sums.iter_mut().zip(&weights[..N]) {
        *sum += x * w;
    }
}

fn start<const N: usize>(biases: &[f32]) -> [f32; N] {
    std::array::from_fn(|k| biases[k])
}

/// The weights' parts in turn.
#[must_use]
pub fn parts(weights: &[f32]) -> [&[f32]; 8] {
    let mut rest = weights;
    PARTS.map(|count| {
        let (part, after) = rest.split_at(count);
        rest = after;
        part
    })
}

static SHIPPED: LazyLock<Net> =
    LazyLock::new(|| Net::parse(include_str!("weights/digits.txt")).expect("the weights that come along are whole"));

impl Net {
    /// With the weights that come along.
    #[must_use]
    pub fn shipped() -> &'static Self {
        &SHIPPED
    }

    /// Reads weights; `None` where the text is no such list.
    #[must_use]
    pub fn parse(text: &str) -> Option<Self> {
        let weights: Vec<f32> = text.split_ascii_whitespace().map(|w| w.parse().ok()).collect::<Option<_>>()?;
        (weights.len() == PARTS.iter().sum::<usize>()).then_some(Self { weights })
    }

    /// How probably a patch shows each digit.
    #[must_use]
    pub fn scores(&self, patch: &Patch) -> Scores {
        let mut trace = Trace::default();
        self.follow(patch, &mut trace);
        Scores::of(trace.answers)
    }

    /// The same with every value on the way. A trace may be used again.
    pub fn follow(&self, patch: &Patch, trace: &mut Trace) {
        let [w1, b1, w2, b2, w3, b3, w4, b4] = parts(&self.weights);
        for (y, row) in patch.ink.chunks_exact(WIDTH).enumerate() {
            let at = (y + EDGE) * ROW + EDGE;
            trace.input[at..at + WIDTH].copy_from_slice(row);
        }
        for y in 0..ROWS_1 {
            for x in 0..COLUMNS_1 {
                let mut sums: [f32; FIRST] = start(b1);
                for i in 0..REACH {
                    let at = (2 * y + i) * ROW + 2 * x;
                    let cells = &trace.input[at..at + REACH];
                    for (value, w) in cells.iter().zip(w1[i * REACH * FIRST..].chunks_exact(FIRST)) {
                        add(&mut sums, *value, w);
                    }
                }
                let at = ((y + 1) * ROW_1 + x + 1) * FIRST;
                trace.first[at..at + FIRST].copy_from_slice(&sums.map(|s| s.max(0.0)));
            }
        }
        for y in 0..ROWS_2 {
            for x in 0..COLUMNS_2 {
                let mut sums: [f32; SECOND] = start(b2);
                for i in 0..3 {
                    let at = ((2 * y + i) * ROW_1 + 2 * x) * FIRST;
                    let values = &trace.first[at..at + 3 * FIRST];
                    for (value, w) in values.iter().zip(w2[i * 3 * FIRST * SECOND..].chunks_exact(SECOND)) {
                        add(&mut sums, *value, w);
                    }
                }
                let at = (y * COLUMNS_2 + x) * SECOND;
                trace.second[at..at + SECOND].copy_from_slice(&sums.map(|s| s.max(0.0)));
            }
        }
        trace.aspect = patch.aspect;
        let mut sums: [f32; HIDDEN] = start(b3);
        for (value, w) in trace.second.iter().chain([&trace.aspect]).zip(w3.chunks_exact(HIDDEN)) {
            if *value != 0.0 {
                add(&mut sums, *value, w);
            }
        }
        trace.hidden = sums.map(|s| s.max(0.0));
        let mut sums: [f32; ANSWERS] = start(b4);
        for (value, w) in trace.hidden.iter().zip(w4.chunks_exact(ANSWERS)) {
            add(&mut sums, *value, w);
        }
        trace.answers = sums;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_answers_are_the_sums_they_say() {
        // Weights and a patch without a pattern; the same sums written out as they are defined, with steps and borders.
        let count: usize = PARTS.iter().sum();
        let value = |k: usize| ((k * 7919 % 1009) as f32 / 1009.0 - 0.48) * 0.2;
        let net = Net { weights: (0..count).map(value).collect() };
        let patch = Patch { ink: std::array::from_fn(|k| value(k * 31 + 5).abs() * 5.0), aspect: 0.6 };
        let [w1, b1, w2, b2, w3, b3, w4, b4] = parts(&net.weights);
        let cell = |x: i64, y: i64| {
            let inside = (0..WIDTH as i64).contains(&x) && (0..HEIGHT as i64).contains(&y);
            if inside { patch.ink[y as usize * WIDTH + x as usize] } else { 0.0 }
        };
        let first = |x: i64, y: i64, f: usize| {
            if !((0..COLUMNS_1 as i64).contains(&x) && (0..ROWS_1 as i64).contains(&y)) {
                return 0.0;
            }
            let sum: f32 =
                (0..25).map(|k| cell(2 * x + k % 5 - 2, 2 * y + k / 5 - 2) * w1[k as usize * FIRST + f]).sum();
            (sum + b1[f]).max(0.0)
        };
        let mut flat = vec![];
        for y in 0..ROWS_2 as i64 {
            for x in 0..COLUMNS_2 as i64 {
                for f in 0..SECOND {
                    let mut sum = b2[f];
                    for k in 0..9 {
                        for g in 0..FIRST {
                            let w = w2[(k as usize * FIRST + g) * SECOND + f];
                            sum += first(2 * x + k % 3 - 1, 2 * y + k / 3 - 1, g) * w;
                        }
                    }
                    flat.push(sum.max(0.0));
                }
            }
        }
        flat.push(patch.aspect);
        let hidden: Vec<f32> = (0..HIDDEN)
            .map(|u| (b3[u] + flat.iter().enumerate().map(|(k, v)| v * w3[k * HIDDEN + u]).sum::<f32>()).max(0.0))
            .collect();
        let mut trace = Trace::default();
        net.follow(&patch, &mut trace);
        for (a, answer) in trace.answers.into_iter().enumerate() {
            let expected = b4[a] + hidden.iter().enumerate().map(|(k, v)| v * w4[k * ANSWERS + a]).sum::<f32>();
            // Sums of up to 577 terms in another order: 1e-6 apart.
            assert!((answer - expected).abs() <= 1e-4 * (1.0 + expected.abs()), "{a}: {answer} {expected}");
        }
    }

    #[test]
    fn text_that_is_no_list_of_weights_is_refused() {
        assert_eq!(Net::parse("1 2 3"), None);
        assert_eq!(Net::parse("one"), None);
    }
}
