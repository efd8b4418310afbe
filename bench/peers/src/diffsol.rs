//! diffsol's BDF on the same responses, equations and tolerances.

use std::time::Instant;

use anyhow::{Context, ensure};
use lunula::tradeoff::hemodynamics::{Bench, ERROR, SOLVING};
use lunula::tradeoff::{Job, Timing};
use lunula_hemodynamics::State;
use lunula_hemodynamics_peer::{Peer, Step, bdf};

use crate::found::Found;

const VERSION: &str = "diffsol 0.18, matrices of nalgebra";
const TOLERANCES: [f64; 4] = [1e-4, 1e-6, 1e-9, 1e-12];
/// Absolute tolerances of rates over those of lumens, and what rows say of them.
const RATES: [(f64, &str); 2] = [(10.0, ""), (1e4, " (loose)")];

/// A response: its load, and lumens at each time.
struct Case {
    step: Step,
    times_s: Vec<f64>,
    lumens: Vec<[f64; 3]>,
}

/// Measures every tolerance, `repeats` times; one that diffsol does not reach leaves the others.
pub(crate) fn measure(bench: &Bench, repeats: usize, found: &mut Found) -> anyhow::Result<()> {
    let cases: Vec<Case> = [cases(bench, true)?, cases(bench, false)?].into_iter().flatten().collect();
    let first = cases.first().and_then(|case| case.lumens.first()).context("no response")?;
    let rest = State { lumens: first.to_vec(), rates: vec![0.0; 3] };
    for (rates, loose) in RATES {
        for rtol in TOLERANCES {
            let name = format!("diffsol BDF, {rtol:.0e}{loose}");
            let peer = Peer { rest: &rest, rates };
            found.try_program(&name, |found| tolerance(&name, &peer, rtol, &cases, repeats, found));
        }
    }
    Ok(())
}

fn tolerance(
    name: &str,
    peer: &Peer<'_>,
    rtol: f64,
    cases: &[Case],
    repeats: usize,
    found: &mut Found,
) -> anyhow::Result<()> {
    let solve = |case: &Case, lumens: &mut Vec<[f64; 3]>| {
        bdf(peer, case.step, rtol, &case.times_s[1..], lumens).map_err(anyhow::Error::msg)
    };
    let (mut error, mut work, mut lumens) = (0.0_f64, 0, Vec::new());
    for case in cases {
        work += solve(case, &mut lumens)?;
        for (found, exact) in lumens.iter().flatten().zip(case.lumens[1..].iter().flatten()) {
            let miss = (found - exact).abs();
            ensure!(miss.is_finite(), "it is not a number");
            error = error.max(miss);
        }
    }
    let mut seconds = Vec::new();
    for _ in 0..repeats.max(1) {
        let begun = Instant::now();
        for case in cases {
            solve(case, &mut lumens)?;
        }
        seconds.push(begun.elapsed().as_secs_f64() / cases.len() as f64);
    }
    let work = work / cases.len() as u64;
    found.add((Job::Hemodynamics, SOLVING.1), name, (error, ERROR), Timing::of(seconds), work, VERSION);
    Ok(())
}

/// The responses of a kind: a new one begins with each load.
fn cases(bench: &Bench, proximal: bool) -> anyhow::Result<Vec<Case>> {
    let mut cases: Vec<(f64, Case)> = Vec::new();
    for line in bench.reference(proximal).lines().skip(1) {
        let row =
            line.split(',').map(str::parse::<f64>).collect::<Result<Vec<_>, _>>().with_context(|| line.to_owned())?;
        let [load_pa, time_s, walls @ ..] = &row[..] else { anyhow::bail!("{line}") };
        let lumens = [0, 1, 2].map(|wall| 1.0 + walls[wall]);
        if cases.last().is_none_or(|(load, _)| load != load_pa) {
            let (on, off) = (*load_pa, 0.0);
            let [proximal_pa, distal_pa] = if proximal { [on, off] } else { [off, on] };
            let step = Step { proximal_pa, distal_pa };
            cases.push((on, Case { step, times_s: Vec::new(), lumens: Vec::new() }));
        }
        if let Some((_, case)) = cases.last_mut() {
            case.times_s.push(*time_s);
            case.lumens.push(lumens);
        }
    }
    Ok(cases.into_iter().map(|(_, case)| case).collect())
}
