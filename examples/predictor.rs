//! Touch forces from photodiodes, trained on one recording and judged on another:
//! `cargo run --example predictor -- fixtures/touch/log.csv fixtures/touch/other.csv`.

use std::path::Path;

use anyhow::Context;
use lunula::log::{AmbientOptions, Channel, Columns, Log, samples};
use lunula::predictor::models::{Dataset, Kind, Predictor, Recipe, score};
use ndarray::Array2;

/// The lit rows of a log in which nothing is wrong, ambient light taken away.
fn dataset(path: &str) -> anyhow::Result<Dataset> {
    let log = Log::read(Path::new(path), &Columns::default())?;
    let samples = samples(&log, &AmbientOptions::default())?;
    let rows: Vec<usize> = (0..samples.time_s.len()).filter(|row| samples.faults[*row].is_empty()).collect();
    let table = |channels: &[Channel]| {
        Array2::from_shape_fn((rows.len(), channels.len()), |(row, k)| channels[k].values[rows[row]])
    };
    let names = |channels: &[Channel]| channels.iter().map(|channel| channel.name.clone()).collect();
    let (volts, forces_n) = (table(&samples.photodiodes), table(&samples.forces));
    let step_s = samples.time_s[1] - samples.time_s[0];
    Ok(Dataset::plain(names(&samples.photodiodes), names(&samples.forces), volts, forces_n, step_s)?)
}

fn main() -> anyhow::Result<()> {
    let mut arguments = std::env::args().skip(1);
    let (train, other) = arguments.next().zip(arguments.next()).context("name two recordings with forces")?;
    let predictor = Predictor::fit(&dataset(&train)?, None, &Recipe::new(Kind::Linear))?;
    let other = dataset(&other)?;
    let (seen, forces_n) = predictor.predict(&other)?;
    for target in score(seen.y().view(), forces_n.view(), &predictor.target_names()).targets {
        println!("{}: RMSE {:.3} N, R2 {:.3}", target.name, target.rmse, target.r2.unwrap_or(f64::NAN));
    }
    Ok(())
}
