//! Fits of 12 000 rows of 8 photodiodes to 3 forces on one thread: medians and best of many, in milliseconds.
//! `cargo bench -p lunula-predictor --bench least_squares`

use std::hint::black_box;
use std::time::Instant;

use lunula_predictor::{
    Dataset, LeastSquaresOptions, Solver, fit_linear, fit_quadratic, least_squares, modes, quadratic_terms,
};
use ndarray::Array2;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const ROWS: usize = 12_000;
const TIMES: usize = 41;

fn main() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let x = Array2::from_shape_fn((ROWS, 8), |_| 2.0 + rng.random_range(-0.5..0.5));
    let slopes = Array2::from_shape_fn((8, 3), |(i, k)| ((i * 3 + k) as f64).sin());
    let y = x.dot(&slopes) + Array2::from_shape_fn((ROWS, 3), |_| rng.random_range(-0.05..0.05));
    let pairs = quadratic_terms(8);
    let terms = Array2::from_shape_fn((ROWS, 44), |(i, j)| match j.checked_sub(8) {
        None => x[[i, j]],
        Some(term) => x[[i, pairs[term].0]] * x[[i, pairs[term].1]],
    });
    let names = |letter: &str, count: usize| (1..=count).map(|k| format!("{letter}{k}")).collect::<Vec<_>>();
    let data = Dataset::plain(names("P", 8), names("F", 3), x.clone(), y.clone(), 0.04).expect("finite rows");
    let options = LeastSquaresOptions::default();
    let plain = LeastSquaresOptions { refinements: 0, ..options.clone() };
    let normal = LeastSquaresOptions { solver: Solver::Normal, ..options.clone() };
    println!("{:<44}{:>9}{:>9}", "12 000 rows, 3 targets, one thread", "median ms", "best ms");
    time("least_squares, 8 columns", || least_squares(x.view(), y.view(), &options));
    time("least_squares, 8 columns, not refined", || least_squares(x.view(), y.view(), &plain));
    time("least_squares, 8 columns, normal equations", || least_squares(x.view(), y.view(), &normal));
    time("least_squares, 44 columns", || least_squares(terms.view(), y.view(), &options));
    time("least_squares, 44 columns, not refined", || least_squares(terms.view(), y.view(), &plain));
    time("least_squares, 44 columns, normal equations", || least_squares(terms.view(), y.view(), &normal));
    time("fit_linear", || fit_linear(&data, &options));
    time("fit_quadratic, terms included", || fit_quadratic(&data, &options));
    let square = Array2::from_shape_fn((44, 44), |(i, j)| if i <= j { terms[[i, j]] } else { 0.0 });
    time("modes, 44 x 44", || modes(square.view()));
}

fn time<T>(what: &str, run: impl Fn() -> T) {
    let mut took: Vec<f64> = (0..TIMES)
        .map(|_| {
            let start = Instant::now();
            black_box(run());
            start.elapsed().as_secs_f64() * 1e3
        })
        .collect();
    took.sort_by(f64::total_cmp);
    println!("{what:<44}{:>9.3}{:>9.3}", took[TIMES / 2], took[0]);
}
