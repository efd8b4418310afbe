//! Least squares by Levenberg's and Marquardt's method within bounds.
//!
//! In: a function of coordinates of about unit size that gives residuals and the derivatives of what is fitted, or
//! refuses a point. Out: the best point and why the search stopped. A step minimizes `|r - J s|^2 + lambda |D s|^2`
//! within the bounds, by orthogonal triangles; `D` holds the largest norms of the columns so far (Moré 1978,
//! doi:10.1007/BFb0067700). A refused point shortens the step, as one that is worse.

use crate::fit::algebra::qr;

/// The longest step of a coordinate.
const LONGEST: f64 = 1.0;
/// A shorter step is within rounding.
const SHORTEST: f64 = 1e-10;
/// Of the largest column's norm, what a column counts at least in `D`.
const LEAST_COLUMN: f64 = 1e-6;
/// Of the data's norm, residuals that are rounding.
const ROUNDING: f64 = 1e-13;
/// Of the sum of squares, a reduction that is not worth a step.
const NO_REDUCTION: f64 = 1e-11;

/// A point and what was found there.
pub(in crate::fit) trait Point {
    fn at(&self) -> &[f64];
    /// Data less what is fitted.
    fn residuals(&self) -> &[f64];
    /// The derivatives of what is fitted by each coordinate.
    fn columns(&self) -> &[Vec<f64>];
}

/// Why a fit stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// What is left to gain is less than the tolerance asked for.
    Converged,
    /// The residuals are rounding.
    Exact,
    /// No step that is long enough to count reduces the residuals: the limit of the simulations' precision.
    Precision,
    /// The points allowed were used.
    Points,
}

/// Bounds, tolerance and work of a search.
#[derive(Clone, Copy)]
pub(in crate::fit) struct Search<'a> {
    pub(in crate::fit) lower: &'a [f64],
    pub(in crate::fit) upper: &'a [f64],
    pub(in crate::fit) tolerance: f64,
    /// Data less unknowns.
    pub(in crate::fit) freedom: f64,
    /// The norm of the data.
    pub(in crate::fit) data: f64,
    pub(in crate::fit) most_points: usize,
}

pub(in crate::fit) struct Minimum<P> {
    pub(in crate::fit) point: P,
    pub(in crate::fit) stop: Stop,
    pub(in crate::fit) iterations: usize,
}

impl Search<'_> {
    /// From a point to the nearest minimum.
    pub(in crate::fit) fn run<P: Point>(&self, first: P, mut evaluate: impl FnMut(&[f64]) -> Option<P>) -> Minimum<P> {
        let (mut point, n) = (first, self.lower.len());
        let mut scales = vec![0.0_f64; n];
        let (mut lambda, mut growth, mut longest) = (1e-3_f64, 2.0, LONGEST);
        let (mut points, mut iterations) = (1, 0);
        loop {
            let norms: Vec<f64> = point.columns().iter().map(|column| qr::norm(column)).collect();
            let largest = norms.iter().fold(0.0, |most: f64, norm| most.max(*norm));
            for (scale, norm) in scales.iter_mut().zip(&norms) {
                *scale = scale.max(*norm).max(LEAST_COLUMN * largest);
            }
            let ssr = qr::dot(point.residuals(), point.residuals());
            if ssr.sqrt() <= ROUNDING * self.data {
                return Minimum { point, stop: Stop::Exact, iterations };
            }
            let mut columns = point.columns().to_vec();
            let mut target = point.residuals().to_vec();
            let triangle = qr::triangle(&mut columns, &mut target);
            let quadratic = Quadratic { triangle, target: target[..n].to_vec() };
            // What Gauss and Newton would still gain.
            let (_, left) = quadratic.step(&self.room(point.at(), f64::INFINITY), 1e-9, &scales);
            let worth = self.tolerance * self.tolerance * ssr / self.freedom;
            if left <= worth.max(NO_REDUCTION * ssr) {
                return Minimum { point, stop: Stop::Converged, iterations };
            }
            loop {
                let (step, gain) = quadratic.step(&self.room(point.at(), longest), lambda.sqrt(), &scales);
                let size = step.iter().fold(0.0, |most: f64, s| most.max(s.abs()));
                if size <= SHORTEST {
                    return Minimum { point, stop: Stop::Precision, iterations };
                }
                if points >= self.most_points {
                    return Minimum { point, stop: Stop::Points, iterations };
                }
                points += 1;
                let moved = point.at().iter().zip(&step).zip(self.lower.iter().zip(self.upper));
                let trial: Vec<f64> = moved.map(|((at, s), (low, high))| (at + s).clamp(*low, *high)).collect();
                match evaluate(&trial) {
                    Some(next) => {
                        let ratio = (ssr - qr::dot(next.residuals(), next.residuals())) / gain;
                        if gain > 0.0 && ratio > 1e-4 {
                            point = next;
                            iterations += 1;
                            // Nielsen's rule.
                            let twice = 2.0 * ratio - 1.0;
                            lambda = (lambda * (1.0 - twice * twice * twice).max(0.1)).max(1e-15);
                            growth = 2.0;
                            longest = LONGEST.min(2.0 * longest);
                            break;
                        }
                    }
                    None => longest = 0.25 * size,
                }
                lambda *= growth;
                growth *= 2.0;
            }
        }
    }

    /// The step that each coordinate may take.
    fn room(&self, at: &[f64], longest: f64) -> Vec<[f64; 2]> {
        let bounds = self.lower.iter().zip(self.upper);
        at.iter()
            .zip(bounds)
            .map(|(at, (low, high))| [(low - at).max(-longest).min(0.0), (high - at).min(longest).max(0.0)])
            .collect()
    }
}

/// `|target - triangle s|^2`, the triangle row-major.
struct Quadratic {
    triangle: Vec<f64>,
    target: Vec<f64>,
}

impl Quadratic {
    /// The minimum of this and `|damping D s|^2` within bounds that hold 0, and how much of this it gains over 0.
    /// Coordinates that would leave their bounds are set on them one by one, the one that goes farthest beyond first.
    fn step(&self, room: &[[f64; 2]], damping: f64, scales: &[f64]) -> (Vec<f64>, f64) {
        let n = scales.len();
        let mut step = vec![0.0; n];
        let mut free: Vec<usize> = (0..n).filter(|&j| scales[j] > 0.0).collect();
        while !free.is_empty() {
            let mut target: Vec<f64> = (0..n).map(|i| self.target[i] - self.row(i, &step, &free)).collect();
            let rows = n + free.len();
            target.resize(rows, 0.0);
            let mut columns: Vec<Vec<f64>> = free
                .iter()
                .enumerate()
                .map(|(k, &j)| {
                    let mut column: Vec<f64> = (0..n).map(|i| self.triangle[i * n + j]).collect();
                    column.resize(rows, 0.0);
                    column[n + k] = damping * scales[j];
                    column
                })
                .collect();
            let m = free.len();
            let r = qr::triangle(&mut columns, &mut target);
            for k in (0..m).rev() {
                let sum: f64 = (k + 1..m).map(|l| r[k * m + l] * step[free[l]]).sum();
                step[free[k]] = (target[k] - sum) / r[k * m + k];
            }
            let beyond = |j: usize| (step[j] - step[j].clamp(room[j][0], room[j][1])).abs();
            let farthest = (0..m).max_by(|&a, &b| beyond(free[a]).total_cmp(&beyond(free[b])));
            match farthest {
                Some(k) if beyond(free[k]) > 0.0 => {
                    let j = free.remove(k);
                    step[j] = step[j].clamp(room[j][0], room[j][1]);
                }
                _ => break,
            }
        }
        let mut gain = 0.0;
        for i in 0..n {
            let fitted = self.row(i, &step, &[]);
            gain += fitted * (2.0 * self.target[i] - fitted);
        }
        (step, gain)
    }

    /// `(triangle s)_i` without some columns.
    fn row(&self, i: usize, step: &[f64], without: &[usize]) -> f64 {
        let n = step.len();
        (i..n).filter(|j| !without.contains(j)).map(|j| self.triangle[i * n + j] * step[j]).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Sample {
        at: Vec<f64>,
        residuals: Vec<f64>,
        columns: Vec<Vec<f64>>,
    }

    impl Point for Sample {
        fn at(&self) -> &[f64] {
            &self.at
        }
        fn residuals(&self) -> &[f64] {
            &self.residuals
        }
        fn columns(&self) -> &[Vec<f64>] {
            &self.columns
        }
    }

    /// Rosenbrock's valley: residuals 10 (y - x^2) and 1 - x; no point is given where x > 1.5.
    fn valley(at: &[f64]) -> Option<Sample> {
        let [x, y] = [at[0], at[1]];
        (x <= 1.5).then(|| Sample {
            at: at.to_vec(),
            residuals: vec![-10.0 * (y - x * x), -(x - 1.0)],
            columns: vec![vec![-20.0 * x, 1.0], vec![10.0, 0.0]],
        })
    }

    fn search(lower: [f64; 2], upper: [f64; 2], from: [f64; 2]) -> Minimum<Sample> {
        let search =
            Search { lower: &lower, upper: &upper, tolerance: 1e-8, freedom: 1.0, data: 1.0, most_points: 500 };
        search.run(valley(&from).expect("in the valley"), valley)
    }

    #[test]
    fn finds_the_end_of_rosenbrocks_valley() {
        let found = search([-9.0; 2], [9.0; 2], [-1.2, 1.0]);
        assert!(matches!(found.stop, Stop::Exact | Stop::Precision), "{:?}", found.stop);
        assert!((found.point.at[0] - 1.0).abs() + (found.point.at[1] - 1.0).abs() <= 1e-9, "{:?}", found.point.at);
        assert!(found.iterations <= 40, "{}", found.iterations);
    }

    #[test]
    fn stops_on_a_bound_at_the_best_that_is_left() {
        // Along x = 0.5 the best y is 0.25; along y = 0.09 the best x solves 200 x (x^2 - 0.09) = 1 - x.
        let found = search([-9.0; 2], [0.5, 9.0], [-1.2, 1.0]);
        assert_eq!(found.stop, Stop::Converged);
        assert_eq!(found.point.at[0], 0.5);
        assert!((found.point.at[1] - 0.25).abs() <= 1e-6, "{:?}", found.point.at);
        let found = search([-9.0; 2], [9.0, 0.09], [0.2, 0.0]);
        let x = found.point.at[0];
        assert!((200.0 * x * (x * x - 0.09) - (1.0 - x)).abs() <= 1e-4, "{:?}", found.point.at);
    }

    #[test]
    fn a_refused_region_is_kept_out_of() {
        let found = search([-9.0; 2], [9.0; 2], [1.5, -3.0]);
        assert!((found.point.at[0] - 1.0).abs() <= 1e-8, "{:?} {:?}", found.stop, found.point.at);
    }
}
