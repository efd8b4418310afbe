//! Phantoms of every tone and light, pictures without nails, and photographs of hands, and the networks that find nails
//! fitted to them.
//!
//! In: which networks ([`Part`]), how many phantoms, a folder of annotated photographs of hands. Out: the weights of
//! each as text ([`train`]), and how detection with the weights that are compiled in does ([`table`]).

mod fit;
pub mod folds;
mod rows;
mod scenes;
mod table;

use std::path::Path;

use lunula::photo::outline::training::{Net, follow_all, leads};
use rayon::prelude::*;

use fit::{fit, rms, text};
use rows::{Rows, border_rows, found_rows, scorer_rows};
use scenes::{Look, Scene, Truth, direct, levels, scenes};
pub use table::table;

/// A step of the recipe.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Part {
    /// The scorer on drawn templates alone
    First,
    /// The border
    Border,
    /// The scorer also on what the search with the weights that are compiled in takes for nails
    Scorer,
    /// The three judges on the finds with the weights that are compiled in, on fresh scenes
    Judge,
}

/// Of the phantoms of scorer and border, and of the judge, which learns from others.
const SEEDS: [u64; 2] = [1000, 2000];

/// The weights of `parts`, each a file's name and its text, from `count` phantoms, three quarters as many pictures
/// without nails, and every other photograph of `hands` (`images/`, `masks/`). `report` gets what was done.
///
/// # Errors
/// A photograph that can't be read, with its path.
pub fn train(
    parts: &[Part],
    count: u32,
    hands: Option<&Path>,
    report: &(dyn Fn(String) + Sync),
) -> anyhow::Result<Vec<(String, String)>> {
    let judge = parts.contains(&Part::Judge);
    let (seed, looks) = if judge {
        (SEEDS[1], &[Look::Plain, Look::Grey, Look::Mirrored, Look::Turned][..])
    } else {
        (SEEDS[0], &[Look::Plain, Look::Grey][..])
    };
    let mut all = scenes(count, seed, hands, looks)?;
    all.par_iter_mut().for_each(direct);
    let known = all.iter().filter(|s| s.real).flat_map(|s| &s.truths).filter(|t| t.up.is_some()).count();
    report(format!("{} scenes, {known} real nails with a direction", all.len()));
    let (scorer, border) = rayon::join(|| scorer(parts, &all, report), || border(parts, &all, report));
    let mut made: Vec<(String, Net)> = scorer.into_iter().chain(border).collect();
    if judge {
        made.extend(judges(all, report));
    }
    Ok(made.into_iter().map(|(name, net)| (name, text(&net))).collect())
}

fn scorer(parts: &[Part], all: &[Scene], report: &(dyn Fn(String) + Sync)) -> Option<(String, Net)> {
    let searched = parts.contains(&Part::Scorer);
    if !searched && !parts.contains(&Part::First) {
        return None;
    }
    let rows = Rows::gather(all, 1, |s, rng, rows| {
        scorer_rows(s, rng, rows);
        if searched {
            found_rows(s, rng, rows);
        }
    });
    let net = fit(&rows, 20, 20, false, 1e-5, 1);
    report(format!("scorer: {} rows, RMS {}", rows.x.len(), rms(&net, &rows)));
    Some(("scorer.txt".to_owned(), net))
}

fn border(parts: &[Part], all: &[Scene], report: &(dyn Fn(String) + Sync)) -> Option<(String, Net)> {
    if !parts.contains(&Part::Border) {
        return None;
    }
    let rows = Rows::gather(all, 2, border_rows);
    let net = fit(&rows, 14, 14, true, 1e-5, 2);
    report(format!("border: {} rows", rows.x.len()));
    Some(("border.txt".to_owned(), net))
}

/// Each learns from two thirds of the scenes.
fn judges(all: Vec<Scene>, report: &(dyn Fn(String) + Sync)) -> Vec<(String, Net)> {
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
            for c in follow_all(&levels(s), leads(&levels(s)), 16) {
                let right = |up: [f64; 2]| c.axis.distal()[0] * up[0] + c.axis.distal()[1] * up[1] > 0.6;
                let worth = |t: &Truth| if t.up.is_none_or(right) { t.outline.iou(&c.outline) } else { 0.0 };
                let worth = s.truths.iter().map(worth).fold(0.0, f64::max);
                // Annotations by hand are less exact, and rarer: each counts twice.
                let (at, soft, times) = if s.real { (0.78, 0.04, 2) } else { (0.82, 0.02, 1) };
                for _ in 0..times {
                    rows.push(&c.features.to_array(), 1.0 / (1.0 + (-(worth - at) / soft).exp()));
                }
            }
        })
    });
    let judge = |left_out: usize| {
        let mut own = Rows::default();
        for part in (0..3).filter(|part| *part != left_out) {
            own.x.extend(rows[part].x.iter().cloned());
            own.y.extend(&rows[part].y);
        }
        report(format!("judge {left_out}: {} rows", own.x.len()));
        (format!("judge-{left_out}.txt"), fit(&own, 8, 30, true, 1e-3, 3 + left_out as u64))
    };
    (0..3).map(judge).collect()
}
