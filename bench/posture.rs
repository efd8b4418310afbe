//! How long `lunula posture` takes for a video of 1280 x 720 (H.264), as a ratio in one run with only decoding the same
//! file with the same threads, and with what a user of OpenCV would write. Whole processes, in turn; medians.
//!
//! `cargo bench --bench posture`. The peer needs `python3` with opencv-python-headless; where it is missing that is
//! said.

mod util;

use lunula::phantom::Generated as _;
use lunula::phantom::screen::Clock;
use lunula::phantom::video::{Preset, VideoOptions};
use util::{DECODE, Run, compare, decodes_only, seconds};

const ROUNDS: usize = 5;
const SECONDS: f64 = 40.0;

fn main() {
    if decodes_only() {
        return;
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    let clock = Some(Clock::default());
    let options = VideoOptions { seconds: SECONDS, clock, ..VideoOptions::new(Preset::Clean) };
    let frames = options.frames();
    options.write(folder.path()).expect("a synthetic video");
    let place = |name: &str| folder.path().join(name).display().to_string();
    let (video, markers, out) = (place("video.mp4"), place("markers.toml"), place("joints.csv"));
    let myself = std::env::current_exe().expect("this program's path").display().to_string();
    let peer = concat!(env!("CARGO_MANIFEST_DIR"), "/../../bench/peers/posture.py");
    let opencv = seconds(&["python3", "-c", "import numpy, cv2, tomllib"]).is_some();
    if !opencv {
        println!("Python, OpenCV: left out, python3 has no cv2");
    }
    let cores = std::thread::available_parallelism().map_or(1, usize::from).to_string();
    for threads in ["1", &cores] {
        let lunula = env!("CARGO_BIN_EXE_lunula");
        let job =
            vec![lunula, "posture", &video, "--markers", &markers, "--out", &out, "--threads", threads, "--quiet"];
        let without = [&job[..], &["--no-clock"]].concat();
        let mut runs: Vec<Run<'_>> = vec![
            ("lunula posture, with the clock", job),
            ("lunula posture", without),
            ("only decoding", vec![myself.as_str(), DECODE, &video, threads]),
        ];
        if opencv {
            // VideoCapture decodes with all cores in either case; the rest is given the number to use.
            runs.push((
                "Python, OpenCV: VideoCapture, HSV, inRange",
                vec!["python3", peer, &video, &markers, "", threads],
            ));
        }
        println!("{frames} frames of 1280 x 720, {threads} thread(s), medians of {ROUNDS} whole processes:");
        let ratios = compare(&runs, ROUNDS, || {});
        println!("lunula posture takes {:.2} times only decoding", ratios[2] / ratios[1]);
        println!("the clock in the picture makes it {:.3} times as long", ratios[1]);
    }
}
