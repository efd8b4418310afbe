//! Resampling of the same photographs by OpenCV and scikit-image, three kernels each.

use std::path::Path;

use lunula::tradeoff::photos::{RESAMPLING, Scene, kernels, scenes};
use lunula::tradeoff::{Job, Timing};

use crate::Bench;
use crate::found::Found;
use crate::python::Package;

/// The script's word, its name, packages.
type Peer = (&'static str, &'static str, [Package; 2]);
/// What can resample a photograph in Python.
const PEERS: [Peer; 2] = [
    ("opencv", "OpenCV", [("cv2", "opencv-python-headless"), ("numpy", "numpy")]),
    ("skimage", "scikit-image", [("skimage", "scikit-image"), ("numpy", "numpy")]),
];

pub(crate) fn measure(bench: &Bench, folder: &Path, found: &mut Found) -> anyhow::Result<()> {
    let scenes = scenes(&bench.plan.photos(folder)?)?;
    for peer in PEERS {
        found.try_program(peer.1, |found| program(bench, peer, &scenes, found));
    }
    Ok(())
}

fn program(bench: &Bench, (word, name, packages): Peer, scenes: &[Scene], found: &mut Found) -> anyhow::Result<()> {
    let version = bench.python.versions(&packages)?;
    let repeats = bench.plan.effort.repeats.to_string();
    for scene in scenes {
        for (kernel, work) in kernels() {
            let out = tempfile::tempdir()?;
            let set = std::path::absolute(scene.folder())?.display().to_string();
            let arguments = [word, &set, &out.path().display().to_string(), "1", kernel, &repeats];
            let answers = bench.python.answers("photos.py", out.path(), &arguments)?;
            let time = Timing::of(answers.into_iter().flat_map(|answer| answer.seconds).collect());
            for (unit, error) in scene.errors(out.path())? {
                let setting = format!("{name}, {kernel}");
                found.add((Job::Photos, RESAMPLING.1), &setting, (error, unit), time, work, &version);
            }
        }
    }
    Ok(())
}
