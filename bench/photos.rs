//! How long `lunula photos` takes for 128 annotated photographs of 640 x 480, all results written, as a ratio in one
//! run with only decoding the same files on the same cores, and with the same job in Python. Whole processes, in turn;
//! medians.
//!
//! `cargo bench --bench photos`. The peers need `python3` with opencv-python-headless or scikit-image; what is missing
//! is said and left out.

mod util;

use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

use lunula::phantom::Generated as _;
use lunula::phantom::photos::{FileFormat, LightKind, PhotoOptions};
use lunula::photo::{PhotoSet, Photograph};
use rayon::prelude::*;
use util::{compare, seconds};

const ROUNDS: usize = 7;
/// The bench's own word for "only decode this set".
const DECODE: &str = "--decode-only";

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    if let Some(at) = arguments.iter().position(|a| a == DECODE) {
        return decode(Path::new(&arguments[at + 1]));
    }
    let scene = tempfile::tempdir().expect("a temporary folder");
    let options = PhotoOptions { light: LightKind::Chamber, truth_normalized: false, ..PhotoOptions::default() };
    options.write(scene.path()).expect("synthetic photographs");
    let set = scene.path().join("photos").display().to_string();
    let out = scene.path().join("out").display().to_string();
    let myself = std::env::current_exe().expect("this program's path").display().to_string();
    let peer = concat!(env!("CARGO_MANIFEST_DIR"), "/../../bench/peers/photos.py");
    let cores = rayon::current_num_threads().to_string();
    let lunula = vec![env!("CARGO_BIN_EXE_lunula"), "photos", &set, "--out", &out, "--quiet"];
    let mut runs = vec![("lunula photos", lunula), ("only decoding", vec![myself.as_str(), DECODE, &set])];
    for (name, module, processes) in [
        ("Python, OpenCV", "cv2", "1"),
        ("Python, OpenCV, all cores", "cv2", &cores),
        ("Python, scikit-image", "skimage", "1"),
        ("Python, scikit-image, all cores", "skimage", &cores),
    ] {
        let kind = if module == "cv2" { "opencv" } else { "skimage" };
        if seconds(&["python3", "-c", &format!("import numpy, {module}")]).is_some() {
            runs.push((name, vec!["python3", peer, kind, &set, &out, processes]));
        } else {
            println!("{name}: left out, python3 has no {module}");
        }
    }
    println!("{} photographs of 640 x 480, {cores} threads, medians of {ROUNDS} whole processes:", 128);
    // Replacing files costs the file system more than making them, and so does making them where as many were removed
    // a moment ago; both differently for each program.
    let aside = AtomicUsize::new(0);
    let new_folder = || {
        let before = format!("{out}-{}", aside.fetch_add(1, Ordering::Relaxed));
        drop(std::fs::rename(&out, before));
    };
    let ratios = compare(&runs, ROUNDS, new_folder);
    println!("lunula photos takes {:.2} times only decoding", ratios[1]);
    let jpeg = tempfile::tempdir().expect("a temporary folder");
    PhotoOptions { format: FileFormat::Jpg, ..options }.write(jpeg.path()).expect("synthetic photographs");
    let set = jpeg.path().join("photos").display().to_string();
    let lunula = vec![env!("CARGO_BIN_EXE_lunula"), "photos", &set, "--out", &out, "--quiet"];
    println!("the same as JPEG:");
    let runs = [("lunula photos", lunula), ("only decoding", vec![myself.as_str(), DECODE, &set])];
    let ratios = compare(&runs, ROUNDS, new_folder);
    println!("lunula photos takes {:.2} times only decoding", ratios[1]);
}

fn decode(set: &Path) {
    let set = PhotoSet::open(set, &[]).expect("the set");
    set.photos.par_iter().with_max_len(1).for_each(|photo| {
        std::hint::black_box(Photograph::read(&photo.path).expect("a photograph"));
    });
}
