//! How sure is sure: of the finds of each confidence, how many are right.

use std::path::Path;

use rayon::prelude::*;

use super::super::{DetectOptions, detect};
use super::scenes::{Look, Scene, direct, empty, hands, phantom};

/// Confidence, IoU, cosine of the angle between the axes (1 where the truth's is not known).
type Find = [f64; 3];

fn finds(scenes: &mut [Scene]) -> Vec<Find> {
    let options = DetectOptions { min_confidence: 0.0, ..DetectOptions::default() };
    scenes.par_iter_mut().for_each(direct);
    let of = |scene: &Scene| -> Vec<Find> {
        let best = |d: &super::super::Detected| -> Find {
            let truth =
                scene.truths.iter().max_by(|a, b| a.outline.iou(&d.outline).total_cmp(&b.outline.iou(&d.outline)));
            let up = truth.and_then(|t| t.up).unwrap_or(d.axis.distal());
            let v = d.axis.distal();
            [d.confidence, truth.map_or(0.0, |t| t.outline.iou(&d.outline)), v[0] * up[0] + v[1] * up[1]]
        };
        detect(&scene.image, &options).nails.iter().map(best).collect()
    };
    scenes.par_iter().flat_map_iter(of).collect()
}

/// Prints precision and recall by the least confidence, and the calibration by tenths.
#[test]
#[ignore = "prints tables for a person; takes minutes"]
fn table() {
    let mut sets = vec![
        ("phantoms", (0..400).into_par_iter().map(|k| phantom(3000, k)).collect::<Vec<_>>()),
        ("no nails", (0..400).into_par_iter().map(|k| empty(3000, k)).collect()),
    ];
    if let Ok(folder) = std::env::var("LUNULA_HANDS") {
        sets.push(("hands, seen in training", hands(Path::new(&folder), 0, Look::Plain)));
        if std::env::var_os("LUNULA_HELD_OUT").is_some() {
            sets.push(("hands, held out", hands(Path::new(&folder), 1, Look::Plain)));
        }
    }
    for (name, mut scenes) in sets {
        let nails: usize = scenes.iter().map(|s| s.truths.len()).sum();
        let finds = finds(&mut scenes);
        eprintln!("{name}: {} pictures, {nails} nails", scenes.len());
        for least in [0.3, 0.5, 0.6, 0.7, 0.75, 0.8, 0.85, 0.9, 0.95] {
            let kept: Vec<&Find> = finds.iter().filter(|f| f[0] >= least).collect();
            let count = |iou: f64| kept.iter().filter(|f| f[1] >= iou).count();
            let worst = kept.iter().map(|f| f[1]).fold(1.0, f64::min);
            let turned = kept.iter().filter(|f| f[2] < 0.7).count();
            eprintln!(
                "  >= {least}: {} finds, {} at IoU 0.7, {} at 0.8, {} at 0.95, worst {worst:.2}, {turned} turned",
                kept.len(),
                count(0.7),
                count(0.8),
                count(0.95)
            );
        }
        for tenth in 0..10 {
            let own: Vec<&Find> = finds.iter().filter(|f| (f[0] * 10.0).min(9.0) as usize == tenth).collect();
            let right = own.iter().filter(|f| f[1] >= 0.8 && f[2] > 0.7).count();
            eprintln!("  {:.1}: {right} of {}", f64::from(tenth as u32) / 10.0, own.len());
        }
    }
}
