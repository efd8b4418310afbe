//! How long `lunula nailvideo` takes for half a minute of 640 x 480 (H.264), as a ratio in one run with only decoding
//! the same file with the same threads. Whole processes, in turn; medians.
//!
//! `cargo bench -p lunula-cli --bench nailvideo`.

mod util;

use std::process::Command;
use std::sync::atomic::{AtomicUsize, Ordering};

use util::{DECODE, compare, decodes_only};

const ROUNDS: usize = 9;
/// The program under test.
const LUNULA: &str = env!("CARGO_BIN_EXE_lunula");

fn main() {
    if decodes_only() {
        return;
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    let place = |name: &str| folder.path().join(name).display().to_string();
    let scene = place("s");
    let made =
        Command::new(LUNULA).args(["phantom", "nailvideo", "--seconds", "30", "--quiet", "--out", &scene]).status();
    assert!(made.expect("the program starts").success(), "no scene was made");
    let [video, outline, out] = ["s/video.mp4", "s/outline.json", "o"].map(place);
    let myself = std::env::current_exe().expect("this program's path").display().to_string();
    let cores = std::thread::available_parallelism().map_or(1, usize::from).to_string();
    let aside = AtomicUsize::new(0);
    for threads in ["1", &cores] {
        let job = [LUNULA, "nailvideo", &video, "--outline", &outline, "--out", &out, "--threads", threads, "--quiet"];
        let all = job.to_vec();
        let tables = [&job[..], &["--no-figures"]].concat();
        let frames = [&tables[..], &["--frames"]].concat();
        let runs = [
            ("lunula nailvideo, photodiodes only", tables),
            ("the same with normalized frames", frames),
            ("the same with sheet, traces and page", all),
            ("only decoding", vec![myself.as_str(), DECODE, &video, threads]),
        ];
        println!("900 frames of 640 x 480, {threads} thread(s), medians of {ROUNDS} whole processes:");
        // Replacing files costs the file system more than making them.
        let new_folder = || drop(std::fs::rename(&out, format!("{out}-{}", aside.fetch_add(1, Ordering::Relaxed))));
        let ratios = compare(&runs, ROUNDS, new_folder);
        let [frames, all, decoding] = [ratios[1], ratios[2], ratios[3]];
        println!(
            "photodiodes take {decoding:.2} times only decoding, with frames {:.2}, with pictures {:.2}",
            decoding / frames,
            decoding / all
        );
    }
}
