//! Equilibria against those of exact polynomials (tests/reference), every one and no other.

use super::tests::load;
use super::*;
use crate::model::Collapse;
use crate::parameters::Parameters;

/// Lumens over nominal diameters away from folds; measured 9e-16.
const TOLERANCE: f64 = 1e-13;
/// The rightmost eigenvalue, relative: the table has six digits; measured 4e-6.
const LEADING: f64 = 1e-5;

/// The rows of a table without its comments and heading.
fn rows(table: &str) -> impl Iterator<Item = Vec<&str>> {
    table.lines().filter(|line| !line.starts_with('#')).skip(1).map(|line| line.split(',').collect())
}

/// Loads checked and the worst gap of a lumen.
fn check(model: &Model, rows: &[Vec<&str>]) -> (usize, f64) {
    let (mut loads, mut worst) = (0, 0.0_f64);
    let number = |text: &str| text.parse::<f64>().expect("a number");
    for row in rows {
        let all = equilibria(model, &load(number(row[0]), number(row[1]))).expect("equilibria");
        let count: usize = row[2].parse().expect("a count");
        assert_eq!(all.len(), count, "{row:?}");
        if row[3].is_empty() || row[3] == "0" {
            loads += 1;
        }
        if count == 0 {
            continue;
        }
        let truth = [number(row[4]), number(row[5]), number(row[6])];
        let gap = |one: &Equilibrium| {
            one.state.lumens.iter().zip(truth).map(|(lumen, truth)| (lumen - truth).abs()).fold(0.0, f64::max)
        };
        let nearest = all.iter().min_by(|a, b| gap(a).total_cmp(&gap(b))).expect("at least one");
        assert!(gap(nearest) <= TOLERANCE, "{row:?} {}", gap(nearest));
        worst = worst.max(gap(nearest));
        let leading = number(row[7]);
        assert!((nearest.eigenvalues[0].real_per_s / leading - 1.0).abs() <= LEADING, "{row:?}");
        let stability = if leading < 0.0 { Stability::Stable } else { Stability::Unstable };
        assert!(nearest.stability == stability && nearest.certified);
    }
    (loads, worst)
}

#[test]
fn over_the_loads_of_the_thesis() {
    let model = Model::new(&Parameters::thesis(), Collapse::Error);
    let table: Vec<_> = rows(include_str!("../../tests/reference/equilibria.csv")).collect();
    let (loads, worst) = check(&model, &table);
    println!("{loads} loads, {worst:e}");
    assert_eq!(loads, 330);
}

#[test]
fn in_bistable_sets() {
    for (set, names, factor) in [
        ("k_C / 2", ["k_C1_N_per_m", "k_C2_N_per_m"], 0.5),
        ("R_Vi x 10", ["R_V1_Pa_s_per_m3", "R_V2_Pa_s_per_m3"], 10.0),
    ] {
        let parameters = names.iter().fold(Parameters::thesis(), |p, name| {
            let symbol = name.parse().expect("a symbol");
            p.set(symbol, factor * p.get(symbol).expect("there")).expect("positive")
        });
        let table: Vec<_> = rows(include_str!("../../tests/reference/bistable.csv"))
            .filter(|row| row[0] == set)
            .map(|row| row[1..].to_vec())
            .collect();
        let (loads, worst) = check(&Model::new(&parameters, Collapse::Error), &table);
        println!("{set}: {loads} loads, {} rows, {worst:e}", table.len());
        assert!(table.len() > loads, "several at some loads");
    }
}
