//! How long `lunula photos` takes for 128 annotated photographs of 640 x 480, all results written, as a ratio in one run with
//! only decoding the same files on the same cores, and with the same job in Python. Whole processes, in turn; medians.
//!
//! `cargo bench --bench photos`. The peers need `python3` with opencv-python-headless or scikit-image; what is missing is
//! said and left out.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Instant;

use lunula::phantom::photos::{LightKind, PhotoOptions, write};
use lunula::photo::{PhotoSet, Photograph};
use rayon::prelude::*;

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
    write(&options, scene.path()).expect("synthetic photographs");
    let set = scene.path().join("photos").display().to_string();
    let out = scene.path().join("out").display().to_string();
    let myself = std::env::current_exe().expect("this program's path").display().to_string();
    let peer = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/peer.py");
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
    let mut times = vec![Vec::new(); runs.len()];
    // The first round warms the disk's cache and does not count.
    for round in 0..=ROUNDS {
        for ((name, command), times) in runs.iter().zip(&mut times) {
            // Replacing files costs the file system more than making them, and differently for each program.
            let _ = std::fs::remove_dir_all(&out);
            let taken = seconds(command).unwrap_or_else(|| panic!("{name} failed: {command:?}"));
            if round > 0 {
                times.push(taken);
            }
        }
    }
    println!("{} photographs of 640 x 480, {cores} threads, medians of {ROUNDS} whole processes:", 128);
    let ours = times[0].clone();
    for ((name, _), times) in runs.iter().zip(&times) {
        let ratios = ours.iter().zip(times).map(|(ours, theirs)| theirs / ours).collect();
        println!("{name:<34} {:>7.3} s   {:>6.2} times lunula's", median(times.clone()), median(ratios));
    }
    println!(
        "lunula photos takes {:.2} times only decoding",
        median(ours.iter().zip(&times[1]).map(|(a, b)| a / b).collect())
    );
}

fn decode(set: &Path) {
    let set = PhotoSet::open(set, &[]).expect("the set");
    set.photos.par_iter().with_max_len(1).for_each(|photo| {
        std::hint::black_box(Photograph::read(&photo.path).expect("a photograph"));
    });
}

/// How long a command takes; `None` where it fails.
fn seconds(command: &[&str]) -> Option<f64> {
    let start = Instant::now();
    let status =
        Command::new(command[0]).args(&command[1..]).stdout(Stdio::null()).stderr(Stdio::null()).status().ok()?;
    status.success().then(|| start.elapsed().as_secs_f64())
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
