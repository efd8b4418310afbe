//! Time of every subset, 12 000 training and 12 000 validation rows, 3 targets:
//! `cargo bench -p lunula-predictor --bench subsets`. Prints the best and the median of many runs in milliseconds.

use std::time::Instant;

use lunula_predictor::{Dataset, every_subset};
use ndarray::Array2;

fn made(rows: usize, inputs: usize, phase: f64) -> Dataset {
    let x = Array2::from_shape_fn((rows, inputs), |(row, k)| {
        let t = row as f64 * 0.01 + phase;
        2.5 + 0.3 * (t * (1.0 + 0.31 * k as f64)).sin() + 0.1 * (t * 7.7 + k as f64).cos()
    });
    let y = Array2::from_shape_fn((rows, 3), |(row, t)| x[[row, t]] - x[[row, t + 1]] + 0.1 * (row as f64 * 1.7).sin());
    let names = |letter: &str, n: usize| (1..=n).map(|k| format!("{letter}{k}")).collect();
    Dataset::plain(names("P", inputs), names("F", 3), x, y, 0.04).expect("finite rows of one size")
}

fn main() {
    for (inputs, runs) in [(8, 200), (12, 50), (16, 5)] {
        let (train, validate) = (made(12_000, inputs, 0.0), made(12_000, inputs, 0.4));
        let mut times: Vec<f64> = (0..runs)
            .map(|_| {
                let start = Instant::now();
                let subsets = every_subset(&train, &validate).expect("two sets of the same columns");
                assert_eq!(subsets.all.len(), (1 << inputs) - 1);
                1e3 * start.elapsed().as_secs_f64()
            })
            .collect();
        times.sort_by(f64::total_cmp);
        println!("{inputs} photodiodes: best {:.3} ms, median {:.3} ms of {runs} runs", times[0], times[runs / 2]);
    }
}
