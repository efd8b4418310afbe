//! Weights to start from: the hidden nodes' slopes shared out over the range of the inputs.
//!
//! D. Nguyen & B. Widrow, Improving the learning speed of 2-layer neural networks by choosing initial values of the
//! adaptive weights, IJCNN 1990, doi 10.1109/IJCNN.1990.137819: for inputs in -1..1, weights of random direction and
//! size 0.7 N^(1/inputs), biases that set the nodes' centres apart along it (evenly, as MATLAB's `initnw`, not at
//! random as the paper). Then the weights are taken from -1..1 to the inputs' own ranges. Output weights are small and
//! random.

use rand::{Rng, RngExt};

use super::weights::Shape;

/// Output weights lie within plus and minus this, in standard deviations of the target.
const OUTPUT: f64 = 0.5;

/// Weights for inputs of these ranges.
pub(super) fn nguyen_widrow(shape: Shape, ranges: &[(f64, f64)], random: &mut impl Rng) -> Vec<f64> {
    let Shape { inputs, hidden, .. } = shape;
    let size = 0.7 * root(hidden as f64, inputs.max(1));
    let mut weights = Vec::with_capacity(shape.parameters());
    for node in 0..hidden {
        let direction: Vec<f64> = (0..inputs).map(|_| random.random_range(-1.0..1.0)).collect();
        let length = direction.iter().map(|value| value * value).sum::<f64>().sqrt();
        let length = if length > 0.0 { length } else { 1.0 };
        // -1 to 1 evenly; one node alone is centred.
        let place = if hidden > 1 { 2.0 * node as f64 / (hidden - 1) as f64 - 1.0 } else { 0.0 };
        let mut bias = size * place * direction.first().map_or(1.0, |first| first.signum());
        let mut own = Vec::with_capacity(inputs);
        for (value, (low, high)) in direction.iter().zip(ranges) {
            let slope = 2.0 / (high - low);
            let weight = size * value / length;
            bias -= weight * slope * 0.5 * (low + high);
            own.push(weight * slope);
        }
        weights.push(bias);
        weights.extend(own);
    }
    while weights.len() < shape.parameters() {
        weights.push(random.random_range(-OUTPUT..OUTPUT));
    }
    weights
}

/// The `degree`-th root of a number from 1 on, by halving: a system's `powf` would not give the same bits everywhere.
fn root(value: f64, degree: usize) -> f64 {
    let within = |x: f64| {
        let mut product = 1.0;
        (0..degree).all(|_| {
            product *= x;
            product <= value
        })
    };
    let (mut low, mut high) = (1.0, value);
    if within(high) {
        return high;
    }
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return low;
        }
        if within(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    /// Largest gap found: 4.4e-16.
    const TOLERANCE: f64 = 5e-15;
    /// Largest gap to `powf` found: 2.2e-16.
    const ROOT: f64 = 5e-15;

    #[test]
    fn roots_are_roots() {
        for (value, degree, wanted) in [(1.0, 7, 1.0), (8.0, 3, 2.0), (9.0, 1, 9.0), (1024.0, 10, 2.0)] {
            assert_eq!(root(value, degree), wanted);
        }
        for (value, degree) in [(2.0, 2), (8.0, 8), (1000.0, 500), (3.0, 17)] {
            let error = (root(value, degree) - value.powf(1.0 / degree as f64)).abs();
            assert!(error <= ROOT, "{value} {degree}: {error:e}");
        }
    }

    #[test]
    fn slopes_have_the_size_of_the_paper_and_cover_the_range() {
        let shape = Shape { inputs: 2, hidden: 9, targets: 1 };
        let ranges = [(1.0, 3.0), (-0.5, 0.0)];
        let weights = nguyen_widrow(shape, &ranges, &mut ChaCha8Rng::seed_from_u64(1));
        assert_eq!(weights.len(), shape.parameters());
        for (node, own) in weights[..shape.first()].chunks_exact(3).enumerate() {
            // Back to inputs of -1..1.
            let back: Vec<f64> = own[1..].iter().zip(&ranges).map(|(w, (low, high))| w * 0.5 * (high - low)).collect();
            let length = back.iter().map(|w| w * w).sum::<f64>().sqrt();
            assert!((length - 0.7 * 3.0).abs() <= TOLERANCE, "{length}");
            let middle = own[0] + own[1] * 2.0 + own[2] * -0.25;
            assert!((middle.abs() - 0.7 * 3.0 * (node as f64 / 4.0 - 1.0).abs()).abs() <= TOLERANCE, "{middle}");
        }
    }
}
