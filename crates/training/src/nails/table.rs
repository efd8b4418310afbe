//! How sure is sure: of the finds of each confidence, how many are right.

use std::fmt::Write as _;
use std::path::Path;

use lunula::photo::outline::{DetectOptions, Detected, Detector, detect};
use rayon::prelude::*;

use super::scenes::{Look, Scene, direct, empty, hands, phantom};

/// Confidence, IoU, cosine of the angle between the axes (1 where the truth's is not known).
type Find = [f64; 3];

/// How many phantoms, and how many pictures without nails.
const COUNT: u32 = 400;
const LEAST: [f64; 10] = [0.3, 0.4, 0.5, 0.6, 0.7, 0.75, 0.8, 0.85, 0.9, 0.95];

fn finds(scenes: &mut [Scene], detector: Detector) -> Vec<Find> {
    let options = DetectOptions { detector, min_confidence: Some(0.0), ..DetectOptions::default() };
    scenes.par_iter_mut().for_each(direct);
    let of = |scene: &Scene| -> Vec<Find> {
        let best = |d: &Detected| -> Find {
            let truth =
                scene.truths.iter().max_by(|a, b| a.outline.iou(&d.outline).total_cmp(&b.outline.iou(&d.outline)));
            let up = truth.and_then(|t| t.up).unwrap_or(d.axis.distal());
            let v = d.axis.distal();
            [d.confidence, truth.map_or(0.0, |t| t.outline.iou(&d.outline)), v[0] * up[0] + v[1] * up[1]]
        };
        detect(&scene.image, &options).expect("OpenCV works").nails.iter().map(best).collect()
    };
    scenes.par_iter().flat_map_iter(of).collect()
}

/// Precision and recall by the least confidence, and the calibration by tenths, of detection with the weights that are
/// compiled in, on phantoms and pictures made from `seed`; on photographs of `folder` too, those of odd index only if
/// they are `held_out`.
///
/// # Errors
/// A photograph that can't be read, with its path.
pub fn table(folder: Option<&Path>, held_out: bool, detector: Detector, seed: u64) -> anyhow::Result<String> {
    let phantoms = (0..COUNT).into_par_iter().map(|k| phantom(seed, k)).collect::<anyhow::Result<Vec<_>>>()?;
    let empty = (0..COUNT).into_par_iter().map(|k| empty(seed, k)).collect::<anyhow::Result<Vec<_>>>()?;
    let (colour, grey) = phantoms.into_iter().partition(|scene| scene.image.color().has_color());
    let mut sets = vec![("phantoms in colour", colour), ("phantoms in grey", grey), ("no nails", empty)];
    if let Some(folder) = folder {
        sets.push(("hands, seen in training", hands(folder, 0, Look::Plain)?));
        if held_out {
            sets.push(("hands, held out", hands(folder, 1, Look::Plain)?));
        }
    }
    let mut text = String::new();
    for (name, mut scenes) in sets {
        let nails: usize = scenes.iter().map(|s| s.truths.len()).sum();
        let finds = finds(&mut scenes, detector);
        writeln!(text, "{name}: {} pictures, {nails} nails", scenes.len())?;
        for least in LEAST {
            let kept: Vec<&Find> = finds.iter().filter(|f| f[0] >= least).collect();
            let count = |iou: f64| kept.iter().filter(|f| f[1] >= iou).count();
            let mut ious: Vec<f64> = kept.iter().map(|f| f[1]).collect();
            ious.sort_by(f64::total_cmp);
            let [worst, median] = [0, ious.len() / 2].map(|at| ious.get(at).copied().unwrap_or(f64::NAN));
            let turned = kept.iter().filter(|f| f[2] < 0.7).count();
            writeln!(
                text,
                "  >= {least}: {} finds, {} at IoU 0.7, {} at 0.8, {} at 0.95, median {median:.3}, worst {worst:.2}, \
                 {turned} turned",
                kept.len(),
                count(0.7),
                count(0.8),
                count(0.95)
            )?;
        }
        for tenth in 0..10 {
            let own: Vec<&Find> = finds.iter().filter(|f| (f[0] * 10.0).min(9.0) as usize == tenth).collect();
            let right = own.iter().filter(|f| f[1] >= 0.8 && f[2] > 0.7).count();
            writeln!(text, "  {:.1}: {right} of {}", f64::from(tenth as u32) / 10.0, own.len())?;
        }
    }
    Ok(text)
}
