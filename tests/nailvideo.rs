//! `lunula nailvideo` on generated videos: motion, photodiodes and presses against exact truth, and what is refused.

use std::fs;

use crate::util::{Answer, Dir};

/// A nail that is pressed once, small and fast.
const SCENE: &str = "phantom nailvideo --size 320x240 --nail-px 90 --seconds 6 --drift 5 --x264 ultrafast --out s";

fn words(dir: &Dir, text: &str) -> Answer {
    dir.lunula(&text.split_whitespace().collect::<Vec<_>>())
}

fn number(text: &str) -> Option<f64> {
    (!text.is_empty()).then(|| text.parse().unwrap_or_else(|_| panic!("`{text}`")))
}

#[test]
fn the_photodiodes_are_those_of_the_truth() {
    let dir = Dir::new();
    words(&dir, &format!("{SCENE} --rod 150+20")).expect(0);
    let job = "nailvideo s/video.mp4 --outline s/outline.json --positions s/positions.toml --light none";
    words(&dir, &format!("{job} --cells 6 --maps 0..1 --out out")).expect(0);
    let (truth, seen) = (dir.table("s/truth/frames.csv"), dir.table("out/photodiodes.csv"));
    assert_eq!((truth.len(), seen.len()), (180, 180));
    let (mut squares, mut count, mut hidden) = (0.0, 0.0, 0);
    for (truth, seen) in truth.iter().zip(&seen) {
        assert_eq!(seen["frame"], truth["frame"]);
        for name in (1..=8).map(|k| format!("P{k}")) {
            let covered = number(&truth[&format!("{name}_hidden")]).unwrap();
            let value = number(&seen[&name]);
            assert_eq!(value.is_some(), seen[&format!("{name}_status")] == "ok");
            if covered > 0.5 {
                assert!(value.is_none(), "frame {} {name}", seen["frame"]);
                hidden += 1;
            } else if let Some(value) = value.filter(|_| covered == 0.0) {
                squares += (255.0 * (value - number(&truth[&name]).unwrap())).powi(2);
                count += 1.0;
            }
        }
    }
    let rms = f64::sqrt(squares / count);
    println!("{count} values, {rms:.2} of 255 RMS; {hidden} hidden");
    assert!(count >= 1300.0 && rms <= 0.8 && hidden > 0, "{count} {rms} {hidden}");
    let cells = dir.table("out/cells.csv");
    assert!(cells.len() == 180 && !cells[0]["C_02_02"].is_empty() && cells[0]["C_00_00"].is_empty());
    assert!(dir.path("out/maps/0-1-mean.npy").is_file() && dir.path("out/report.html").is_file());
    let presses = dir.table("out/presses.csv");
    assert!(presses.iter().all(|row| row["use"].contains("not a diagnostic")));
}

#[test]
fn a_press_has_its_onset_and_its_release() {
    let dir = Dir::new();
    words(&dir, SCENE).expect(0);
    let job = "nailvideo s/video.mp4 --outline s/outline.json --no-figures --out out";
    words(&dir, job).expect(0);
    let truth = dir.table("s/truth/presses.csv");
    let rows = dir.table("out/presses.csv");
    for (event, column) in [("press", "onset_s"), ("release", "release_s")] {
        let truth = number(&truth[0][column]).unwrap();
        let of = rows.iter().filter(|row| row["event"] == event && row["status"] == "ok");
        let mut errors: Vec<f64> = of.filter_map(|row| Some((number(&row["onset_s"])? - truth).abs())).collect();
        errors.sort_by(f64::total_cmp);
        println!("{event}: {errors:.3?}");
        // A frame is 0.033 s.
        assert!(errors.len() >= 4 && errors[errors.len() / 2] <= 0.034, "{event}: {errors:?}");
    }
    // The same bytes whatever the threads.
    words(&dir, &job.replace("--out out", "--threads 1 --out one")).expect(0);
    for name in ["photodiodes.csv", "motion.csv", "presses.csv", "nail.json", "nail.png"] {
        assert!(
            fs::read(dir.path("out").join(name)).unwrap() == fs::read(dir.path("one").join(name)).unwrap(),
            "{name}"
        );
    }
    // `predict` and its like read it as a log.
    words(&dir, "nailvideo s/video.mp4 --outline s/outline.json --plan").expect(0);
}

#[test]
fn what_can_not_be_followed_is_refused_with_its_remedy() {
    let dir = Dir::new();
    words(&dir, "phantom nailvideo --size 160x128 --nail-px 20 --seconds 1 --x264 ultrafast --out tiny").expect(0);
    let small = words(&dir, "nailvideo tiny/video.mp4 --outline tiny/outline.json --out out").expect(2);
    small.says("20 px wide").says("film it nearer");
    dir.write(
        "far.toml",
        "name = 'x'\nnail_width_mm = 12.0\ndiameter_mm = 1.0\n[[photodiode]]\nname = 'P3'\nu = 1.4\nv = 0.0\n",
    );
    let far = "nailvideo tiny/video.mp4 --outline tiny/outline.json --positions far.toml --out out";
    words(&dir, far).expect(2).says("far.toml").says("P3").says("outside of the nail");
    words(&dir, "nailvideo tiny/video.mp4 --maps 3..1 --out out").expect(2).says("two times in seconds");
    words(&dir, "nailvideo nowhere.mp4 --out out").expect(2).says("nowhere.mp4");
    words(&dir, "nailvideo tiny/video.mp4 --masks tiny --out out").expect(2).says("name the mask as the video");
    assert!(!dir.path("out").exists());
}
