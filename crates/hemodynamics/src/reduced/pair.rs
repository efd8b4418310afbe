//! The explicit pair of Dormand and Prince, of order 5 with an error estimate of order 4 and a dense output of order 4
//! (J. Comput. Appl. Math. 6, 1980, doi:10.1016/0771-050X(80)90013-3; dense output: Hairer, Norsett, Wanner, Solving Ordinary Differential
//! Equations I, section II.6).

/// Stages, the last being the first of the next step.
pub(super) const STAGES: usize = 7;

/// Nodes.
pub(super) const C: [f64; STAGES] = [0.0, 1.0 / 5.0, 3.0 / 10.0, 4.0 / 5.0, 8.0 / 9.0, 1.0, 1.0];

/// Coefficients of the stages; the last row is the solution of order 5.
pub(super) const A: [[f64; STAGES - 1]; STAGES] = [
    [0.0; 6],
    [1.0 / 5.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [3.0 / 40.0, 9.0 / 40.0, 0.0, 0.0, 0.0, 0.0],
    [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0, 0.0, 0.0, 0.0],
    [19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0, 0.0, 0.0],
    [9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0, 0.0],
    [35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
];

/// The solution of order 5 less that of order 4.
pub(super) const ERROR: [f64; STAGES] =
    [71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339200.0, 22.0 / 525.0, -1.0 / 40.0];

/// The dense output's highest term.
pub(super) const DENSE: [f64; STAGES] = [
    -12715105075.0 / 11282082432.0,
    0.0,
    87487479700.0 / 32700410799.0,
    -10690763975.0 / 1880347072.0,
    701980252875.0 / 199316789632.0,
    -1453857185.0 / 822651844.0,
    69997945.0 / 29380423.0,
];

/// The dense output of a step in one wall: its coefficients are those of Hairer's `contd5`.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Curve([f64; 5]);

impl Curve {
    /// From the lumens at both ends, the step and the rates of all stages.
    pub(super) fn new(from: f64, to: f64, step_s: f64, rates: &[f64; STAGES]) -> Curve {
        let rise = to - from;
        let bend = step_s * rates[0] - rise;
        let mut top = 0.0;
        for (coefficient, rate) in DENSE.iter().zip(rates) {
            top += coefficient * rate;
        }
        Curve([from, rise, bend, rise - step_s * rates[STAGES - 1] - bend, step_s * top])
    }

    /// The lumen at a part of the step, 0 to 1.
    pub(super) fn at(&self, part: f64) -> f64 {
        let [from, rise, bend, third, top] = self.0;
        let rest = 1.0 - part;
        from + part * (rise + rest * (bend + part * (third + rest * top)))
    }

    /// The derivative by that part.
    pub(super) fn slope(&self, part: f64) -> f64 {
        let [_, rise, bend, third, top] = self.0;
        let rest = 1.0 - part;
        rise + (rest - part) * bend + part * (2.0 - 3.0 * part) * third + 2.0 * part * rest * (rest - part) * top
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rows_sum_to_the_nodes_and_the_conditions_of_order_5_hold() {
        // Measured 2.3e-16 (rows and conditions).
        const TOLERANCE: f64 = 2e-15;
        for (row, c) in A.iter().zip(C) {
            assert!((row.iter().sum::<f64>() - c).abs() <= TOLERANCE);
        }
        let powers = |c: f64, p: usize| (0..p).map(|_| c).product::<f64>();
        for p in 0..5 {
            let moment: f64 = (0..STAGES - 1).map(|i| A[STAGES - 1][i] * powers(C[i], p)).sum();
            assert!((moment - 1.0 / (p + 1) as f64).abs() <= TOLERANCE, "order {}", p + 1);
            let error: f64 = (0..STAGES).map(|i| ERROR[i] * powers(C[i], p)).sum();
            assert!(p == 4 || error.abs() <= TOLERANCE, "error's order {}", p + 1);
        }
    }

    /// A step on `y' = y cos t` from 0.3: the errors at its end, inside, and of the slope.
    fn errors(step: f64) -> [f64; 3] {
        let from = 0.3_f64;
        let exact = |part: f64| ((from + part * step).sin() - from.sin()).exp();
        let mut rates = [0.0; STAGES];
        let mut y = 1.0;
        for stage in 0..STAGES {
            y = 1.0 + step * (0..stage).map(|k| A[stage][k] * rates[k]).sum::<f64>();
            rates[stage] = y * (from + C[stage] * step).cos();
        }
        let curve = Curve::new(1.0, y, step, &rates);
        assert_eq!([curve.at(0.0), curve.at(1.0)], [1.0, y]);
        let mut worst = [(y - exact(1.0)).abs(), 0.0, 0.0];
        for part in (0..=20).map(|k| 0.05 * f64::from(k)) {
            let slope = exact(part) * (from + part * step).cos();
            worst[1] = worst[1].max((curve.at(part) - exact(part)).abs());
            worst[2] = worst[2].max((curve.slope(part) / step - slope).abs());
        }
        worst
    }

    #[test]
    fn a_step_and_its_curve_have_their_orders() {
        let (long, short) = (errors(0.1), errors(0.05));
        // Halving gains 2^6 at the end, 2^5 inside, 2^4 in the slope: measured 76, 29 and 14.
        for (k, least) in [(0, 48.0), (1, 24.0), (2, 12.0)] {
            assert!(long[k] / short[k] >= least, "{k}: {}", long[k] / short[k]);
        }
    }
}
