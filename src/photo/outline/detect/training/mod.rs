//! Where the weights come from: phantoms of every tone and light, pictures without nails, and photographs of hands.
//!
//! `LUNULA_TRAIN="first border" cargo test --release --lib detect::training -- --ignored`, then `LUNULA_TRAIN=scorer`,
//! then `LUNULA_TRAIN=judge` rewrite `weights/*.txt`: the scorer first on drawn templates alone, then also on what its
//! own search takes for nails, and the judge on the finds of the two others on fresh scenes. The photographs are those
//! of even index in sorted order of the folder named by `LUNULA_HANDS` (`images/`, `masks/`); those of odd index are
//! never looked at. The same scenes, weights before and machine give the same weights.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod calibration;
mod fit;
mod rows;
mod scenes;

use std::path::Path;

use rayon::prelude::*;

use super::net::Net;
use fit::{fit, rms, text};
use rows::{Rows, border_rows, found_rows, scorer_rows};
use scenes::{Look, direct, levels, scenes};

fn save(name: &str, net: &Net) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/photo/outline/detect/weights");
    std::fs::write(folder.join(name), text(net)).unwrap();
}

#[test]
#[ignore = "rewrites the weights; takes minutes"]
fn train() {
    let stage = std::env::var("LUNULA_TRAIN").unwrap_or_default();
    let count = std::env::var("LUNULA_COUNT").ok().and_then(|c| c.parse().ok()).unwrap_or(450);
    // The judge learns from other phantoms than the other two networks have seen.
    let (seed, looks) = if stage.contains("judge") {
        (2000, &[Look::Plain, Look::Grey, Look::Mirrored, Look::Turned][..])
    } else {
        (1000, &[Look::Plain, Look::Grey][..])
    };
    let mut all = scenes(count, seed, looks);
    all.par_iter_mut().for_each(direct);
    let known: usize = all.iter().filter(|s| s.real).flat_map(|s| &s.truths).filter(|t| t.up.is_some()).count();
    eprintln!("{} scenes, {known} real nails with a direction", all.len());
    rayon::join(
        || {
            if stage.contains("scorer") || stage.contains("first") {
                let rows = Rows::gather(&all, 1, |s, rng, rows| {
                    scorer_rows(s, rng, rows);
                    if stage.contains("scorer") {
                        found_rows(s, rng, rows);
                    }
                });
                let net = fit(&rows, 20, 20, false, 1e-5, 1);
                eprintln!("scorer: {} rows, RMS {}", rows.x.len(), rms(&net, &rows));
                save("scorer.txt", &net);
            }
        },
        || {
            if stage.contains("border") {
                let rows = Rows::gather(&all, 2, border_rows);
                let net = fit(&rows, 14, 14, true, 1e-5, 2);
                eprintln!("border: {} rows", rows.x.len());
                save("border.txt", &net);
            }
        },
    );
    if stage.contains("judge") {
        // The same photograph in another look stays on the same side.
        let mut real = 0;
        let mut thirds = [vec![], vec![], vec![]];
        for (k, scene) in all.into_iter().enumerate() {
            let third = if scene.real { real % 13 % 3 } else { k % 3 };
            real += usize::from(scene.real);
            thirds[third].push(scene);
        }
        let rows = thirds.map(|part| {
            Rows::gather(&part, 3, |s, _, rows| {
                for c in super::follow_all(&levels(s), super::leads(&levels(s)), 16) {
                    let right = |up: [f64; 2]| c.axis.distal()[0] * up[0] + c.axis.distal()[1] * up[1] > 0.6;
                    let worth =
                        |t: &scenes::Truth| if t.up.is_none_or(right) { t.outline.iou(&c.outline) } else { 0.0 };
                    let worth = s.truths.iter().map(worth).fold(0.0, f64::max);
                    // Annotations by hand are less exact, and rarer: each counts twice.
                    let (at, soft, times) = if s.real { (0.78, 0.04, 2) } else { (0.82, 0.02, 1) };
                    for _ in 0..times {
                        rows.push(&c.features.to_array(), 1.0 / (1.0 + (-(worth - at) / soft).exp()));
                    }
                }
            })
        });
        for left_out in 0..3 {
            let mut own = Rows::default();
            for part in (0..3).filter(|part| *part != left_out) {
                own.x.extend(rows[part].x.iter().cloned());
                own.y.extend(&rows[part].y);
            }
            eprintln!("judge {left_out}: {} rows", own.x.len());
            save(&format!("judge-{left_out}.txt"), &fit(&own, 8, 30, true, 1e-3, 3 + left_out as u64));
        }
    }
}
