//! Synthetic nail videos: what is written agrees with itself, whatever the threads; bad options are refused.

use std::fs;

use crate::util::{Answer, Dir};
use lunula::nail::Positions;
use lunula::phantom::Generated as _;
use lunula::phantom::nailvideo::{NailProtocol, NailVideoOptions, Scene};
use lunula::phantom::video::Coding;
use lunula::video::Curve;
use ndarray_npy::ReadNpyExt as _;

/// A small, fast scene.
const SMALL: &str = "--size 160x128 --nail-px 60 --seconds 3 --x264 ultrafast";

fn run(dir: &Dir, options: &str) -> Answer {
    dir.words(&format!("phantom nailvideo {options}"))
}

#[test]
fn the_sensor_that_is_worn_logs_the_green_of_the_same_nail() {
    let dir = Dir::new();
    run(&dir, &format!("{SMALL} --protocol touch --out s")).expect(0);
    let (frames, log) = (dir.table("s/truth/frames.csv"), dir.table("s/truth/log.csv"));
    assert_eq!((frames.len(), log.len()), (90, 150));
    let number = |text: &str| text.parse::<f64>().unwrap_or_else(|_| panic!("`{text}`"));
    for photodiode in (1..=8).map(|k| format!("P{k}")) {
        // The volts without drift would be the green times a gain: the drift is 10 mV, a textured disc is seen by
        // cameras of two sizes.
        let ratios: Vec<f64> = log
            .iter()
            .filter_map(|row| {
                let time_s = number(&row["time_s"]);
                let after = frames.iter().position(|frame| number(&frame["time_s"]) > time_s)?;
                let [a, b] = [after - 1, after].map(|k| &frames[k]);
                let share = (time_s - number(&a["time_s"])) * 30.0;
                let [a, b] = [a, b].map(|frame| Curve::Bt709.encoded(number(&frame[&photodiode])));
                let green = (1.0 - share) * a + share * b;
                Some(number(&row[&photodiode]) / green)
            })
            .collect();
        let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
        assert!(ratios.len() > 140 && (4.9..=5.9).contains(&mean), "{photodiode}: {mean}");
        assert!(ratios.iter().all(|ratio| (ratio / mean - 1.0).abs() <= 0.012), "{photodiode}");
    }
    // `phantom log` of the same person and the same finger reads the same volts.
    dir.words("phantom log --sensor nail --force spiral --spiral-seconds 3 --lead 0").expect(2);
    let more = "phantom log --sensor nail --force spiral --spiral-seconds 3 --lead 0 --trail 0 --rate 50 --no-led \
                --ambient 0 --clock-offset 0 --out l";
    dir.words(more).expect(0);
    assert_eq!(fs::read(dir.path("l/log.csv")).unwrap(), fs::read(dir.path("s/log.csv")).unwrap());
}

#[test]
fn the_same_seed_gives_the_same_bytes_whatever_the_threads() {
    let dir = Dir::new();
    let options = NailVideoOptions {
        size: (128, 96),
        nail_px: 50.0,
        seconds: Some(1.5),
        rod: vec![[10, 5]],
        cut: vec![[30, 2]],
        blur: 0.5,
        jerk_px: 8.0,
        flicker_percent: 5.0,
        gradient_percent: 12.0,
        ..NailVideoOptions::default()
    };
    for (name, threads, seed) in [("one", 1, 9), ("three", 3, 9), ("other", 3, 10)] {
        let options = NailVideoOptions { seed, ..options.clone() };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| options.write(&dir.path(name))).unwrap();
    }
    for file in ["video.mp4", "outline.json", "log.csv", "truth/frames.csv", "truth/presses.csv"] {
        let [one, three, other] = ["one", "three", "other"].map(|name| fs::read(dir.path(name).join(file)).unwrap());
        assert!(one == three, "{file}");
        assert!(file.ends_with("presses.csv") || one != other, "{file}: another seed");
    }
}

#[test]
fn photodiodes_lie_where_the_file_says() {
    let dir = Dir::new();
    let mut positions = Positions::thesis();
    positions.photodiodes.truncate(2);
    positions.photodiodes[0].name = "tip".to_owned();
    fs::write(dir.path("layout.json"), serde_json::to_string(&positions).unwrap()).unwrap();
    run(&dir, &format!("{SMALL} --positions layout.json --normalized 60 --out s")).expect(0);
    let (log, frames) = (dir.table("s/log.csv"), dir.table("s/truth/frames.csv"));
    let names: Vec<&str> = log[0].keys().map(String::as_str).collect();
    assert_eq!(names, ["Fx_N", "Fy_N", "Fz_N", "P2", "time_s", "tip"]);
    assert!(frames[0].contains_key("tip_hidden") && !frames[0].contains_key("P1"));
    let read = Positions::from_toml(&dir.text("s/positions.toml")).unwrap();
    assert_eq!(read, positions);
    for (frame, name) in [(0, "000000"), (60, "000060")] {
        let bytes = fs::read(dir.path(&format!("s/truth/normalized/{name}.npy"))).unwrap();
        let picture = ndarray::Array2::<f32>::read_npy(&bytes[..]).unwrap();
        for (place, column) in positions.photodiodes.iter().zip(["tip", "P2"]) {
            // 160 of 400 pixels are half a nail; a disc of 1/12 of the nail has a radius of 13.3 of them across.
            let centre = [200.0 + 160.0 * place.u - 0.5, 200.0 - 160.0 * place.v - 0.5];
            let (mut sum, mut count) = (0.0, 0.0);
            for ((i, j), &green) in picture.indexed_iter() {
                if (j as f64 - centre[0]).hypot(i as f64 - centre[1]) <= 13.3 {
                    (sum, count) = (sum + f64::from(green), count + 1.0);
                }
            }
            // The normalized picture is as wide as it is high: along the nail the disc is an ellipse there.
            let exact: f64 = Curve::Bt709.encoded(frames[frame][column].parse().unwrap());
            assert!((sum / count - exact).abs() <= 0.003, "{name} {column}: {} {exact}", sum / count);
        }
    }
    let presses = dir.table("s/truth/presses.csv");
    assert_eq!((presses.len(), &presses[0]["onset_s"][..], &presses[0]["release_s"][..]), (1, "1.5", "4"));
}

#[test]
fn what_cannot_be_drawn_is_refused_with_all_that_is_wrong() {
    let dir = Dir::new();
    run(&dir, "--out s --nail-px 9000 --blur 2 --rod 5000+3 --cut 0+3")
        .expect(2)
        .says("--nail-px 9000")
        .says("--blur 2")
        .says("--rod 5000+3")
        .says("begin later");
    run(&dir, "--out s --nail-px 600").expect(2).says("times as long as wide");
    run(&dir, "--out s --size 161x128").expect(2).says("even sides");
    run(&dir, "--out s --seconds nan").expect(2).says("--seconds NaN");
    fs::write(dir.path("p.toml"), "name = 'x'\n").unwrap();
    run(&dir, "--out s --positions p.toml").expect(2).says("p.toml");
    let nine = Positions {
        photodiodes: (0..9)
            .map(|k| lunula::nail::Position { name: format!("Q{k}"), u: 0.1 * f64::from(k), v: 0.0 })
            .collect(),
        ..Positions::thesis()
    };
    fs::write(dir.path("nine.json"), serde_json::to_string(&nine).unwrap()).unwrap();
    run(&dir, "--out s --positions nine.json").expect(2).says("at most 8");
    dir.lunula(&["phantom", "log", "--positions", "nine.json", "--out", "l"]).expect(2).says("--sensor nail");
    assert!(!dir.path("s").exists());
    fs::create_dir_all(dir.path("s")).unwrap();
    fs::write(dir.path("s/video.mp4"), "mine").unwrap();
    run(&dir, &format!("{SMALL} --out s")).expect(2).says("video.mp4");
    assert_eq!(fs::read(dir.path("s/video.mp4")).unwrap(), b"mine");
}

#[test]
fn extremes_are_drawn() {
    let coding = Coding { preset: "ultrafast".to_owned(), ..Coding::default() };
    let base = NailVideoOptions { seconds: Some(0.4), coding, ..NailVideoOptions::default() };
    let dir = Dir::new();
    for (name, options) in [
        ("tiny", NailVideoOptions { size: (64, 64), nail_px: 12.0, ..base.clone() }),
        ("single", NailVideoOptions { seconds: Some(0.0), size: (64, 64), nail_px: 20.0, ..base.clone() }),
        (
            "hard",
            NailVideoOptions {
                size: (160, 128),
                nail_px: 60.0,
                drift_px: 30.0,
                turn_deg: 45.0,
                scale_percent: 20.0,
                tilt_percent: 20.0,
                jerk_px: 12.0,
                blur: 1.0,
                noise: 50.0,
                crf: 51,
                flicker_percent: 60.0,
                gradient_percent: 60.0,
                light_drift_percent: 60.0,
                colour_drift_percent: 60.0,
                protocol: NailProtocol::TouchRandom,
                ..base.clone()
            },
        ),
    ] {
        let scene = Scene::new(options).unwrap();
        assert_eq!(scene.options().write(&dir.path(name)).unwrap().count, scene.frames());
        for frame in 0..scene.frames() {
            let truth = scene.truth(frame);
            assert!(truth.photodiodes.iter().flatten().all(|value| (0.0..1.0).contains(value)));
            assert!(truth.motion.is_some_and(|motion| motion.0.iter().all(|value| value.is_finite())));
        }
    }
}
