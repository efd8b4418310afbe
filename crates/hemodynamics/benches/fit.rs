//! Time of a fit of stiffness, damping, offset and scaling to a recording of 400 samples in 4 s with 1 % noise:
//! `cargo bench -p lunula-hemodynamics --bench fit`. Prints the best and the median of many fits in milliseconds.

#[path = "../tests/fit/phantom.rs"]
mod phantom;

use std::time::Instant;

use lunula_hemodynamics::{FitOptions, Parameters, Recording, fit};
use phantom::{exact, noisy, pressed, softer, step, tied, with_photodiodes, zero};

const RUNS: u64 = 40;

fn main() {
    let free = tied();
    let truth = with_photodiodes(softer(1.5, 0.6), [2.5; 2], [0.4; 2]);
    let (zero, step, force) = (zero(), step(9000.0), pressed(9000.0, 0.2, 2.2));
    let cases: [(&str, Recording); 5] = [
        ("a proximal step", exact(&truth, &step, &zero, &[0])),
        ("a distal step", exact(&truth, &zero, &step, &[1])),
        ("both photodiodes, both steps", exact(&truth, &step, &step, &[0, 1])),
        ("a measured proximal force of 400 rows", exact(&truth, &force, &zero, &[0])),
        ("a measured distal force of 400 rows", exact(&truth, &zero, &force, &[1])),
    ];
    for (starts, intervals) in [(1, false), (4, false), (4, true)] {
        let options = FitOptions { starts, intervals, ..FitOptions::default() };
        for (name, recording) in &cases {
            let mut points = 0;
            let mut times: Vec<f64> = (0..RUNS)
                .map(|seed| {
                    let recording = [noisy(recording, 0.01, seed)];
                    let begun = Instant::now();
                    let result = fit(&recording, &Parameters::thesis(), &free, &options).expect("a fit");
                    points += result.statistics.points;
                    1e3 * begun.elapsed().as_secs_f64()
                })
                .collect();
            times.sort_by(f64::total_cmp);
            let (best, median, most) = (times[0], times[times.len() / 2], times[times.len() - 1]);
            let points = points as f64 / RUNS as f64;
            let with = if intervals { ", intervals" } else { "" };
            println!(
                "{name}, {starts} starts{with}: {best:.2} ms best, {median:.2} ms median, {most:.2} ms most, \
                 {points:.1} points"
            );
        }
    }
}
