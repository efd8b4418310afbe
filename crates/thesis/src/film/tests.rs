//! A nail that is seen by both, made here.

use std::fmt::Write as _;
use std::path::Path;

use super::pair::Traces;
use super::rising::rising;
use super::*;

/// Forces of a moment.
fn forces(time_s: f64) -> [f64; 3] {
    [(1.1 * time_s).sin(), (1.7 * time_s).cos(), -1.5 + (0.4 * time_s).sin()]
}

/// Three photodiodes that are straight lines of the forces, to which one can go back; `noise` on each.
fn seen(time_s: f64, noise: f64) -> [f64; 3] {
    let [fx, fy, fz] = forces(time_s);
    let noise = |k: f64| noise * (1e4 * time_s + k).sin();
    [2.0 + 0.1 * fx + noise(0.0), 2.0 + 0.1 * fy + 0.05 * fz + noise(1.0), 2.0 - 0.1 * fz + noise(2.0)]
}

/// A log of 50 rows a second, and the camera's frames of 15: its values are the volts by another straight line.
pub(crate) fn pair(folder: &Path, name: &str, from_s: f64, camera_noise: f64) -> Pair {
    let mut log = "time_s,P1,P2,P3,Fx_N,Fy_N,Fz_N\n".to_owned();
    for time_s in (0..1000).map(|k| from_s + 0.02 * f64::from(k)) {
        let cells: Vec<String> = seen(time_s, 1e-3).iter().chain(&forces(time_s)).map(f64::to_string).collect();
        writeln!(log, "{time_s},{}", cells.join(",")).unwrap();
    }
    let mut camera = "frame,time_s,P1,P2,P3,P1_sd,status\n".to_owned();
    for (k, time_s) in (0..300).map(|k| (k, from_s + f64::from(k) / 15.0)) {
        let cells: Vec<String> =
            seen(time_s, camera_noise).iter().map(|volts| (0.3 - 0.1 * volts).to_string()).collect();
        // A frame in which the nail is lost, and one past the log's end.
        let cells = if k == 7 { vec![String::new(); 3] } else { cells };
        writeln!(camera, "{k},{time_s},{},0.1,ok", cells.join(",")).unwrap();
    }
    let at = |what: &str| folder.join(format!("{name}-{what}.csv"));
    std::fs::write(at("log"), log).unwrap();
    std::fs::write(at("camera"), camera).unwrap();
    Pair { log: at("log"), camera: at("camera") }
}

#[test]
fn a_camera_that_sees_the_same_predicts_as_well_and_a_noisy_one_worse() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let run = |noise: f64| {
        let training = [pair(folder.path(), "a", 0.0, noise), pair(folder.path(), "b", 20.0, noise)];
        film(&training, &[pair(folder.path(), "c", 50.0, noise)], &out).unwrap()
    };
    let same = run(1e-3);
    // The last frames of each recording are past the last row of its log: 19.98 s.
    assert_eq!(same.frames_left_out, 3);
    for Errors { target, sensor, camera } in &same.errors {
        // Noise of 0.001 V RMS 0.7 on slopes of 0.1 V/N; measured 0.007 to 0.008.
        assert!(*sensor > 0.004 && *sensor < 0.02 && (camera / sensor - 1.0).abs() < 0.3, "{target} {sensor} {camera}");
    }
    assert!(same.correlations.iter().all(|(_, correlation)| correlation.unwrap() < -0.999), "{same:?}");
    let noisy = run(1e-2);
    assert!(noisy.errors.iter().all(|one| one.camera > 5.0 * one.sensor), "{noisy:?}");
    let numbers = Numbers::read(&out.join("numbers.json")).unwrap();
    let fx = &noisy.errors[0];
    assert_eq!(numbers.get("Fx_N.camera_over_sensor"), Some(fx.camera / fx.sensor));
    for file in ["film.csv", "traces.png", "rmse.png", "labelled/training-2.csv", "labelled/held-out-1.csv"] {
        assert!(out.join(file).is_file(), "{file}");
    }
}

#[test]
fn the_cameras_values_are_brought_to_the_sensors_volts() {
    let folder = tempfile::tempdir().unwrap();
    let traces = Traces::of(&pair(folder.path(), "a", 0.0, 0.0)).unwrap();
    let first = &traces.all[0];
    let [time_s, volts] = first.camera[100];
    // A thousandth of noise in the sensor's volts.
    assert!((volts - seen(time_s, 0.0)[0]).abs() < 1e-3, "{volts}");
    assert!(first.camera[7][1].is_nan());
}

#[test]
fn a_log_without_forces_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let pair = pair(folder.path(), "a", 0.0, 0.0);
    std::fs::write(&pair.log, "time_s,P1,Fx_N\n0,1,2\n1,1,2\n").unwrap();
    let why = film(std::slice::from_ref(&pair), std::slice::from_ref(&pair), &folder.path().join("out")).unwrap_err();
    assert!(format!("{why:#}").contains("a-log.csv: has not all of Fx_N, Fy_N, Fz_N"), "{why:#}");
}

/// Frames of a press to `most` tenths of a newton and back, whose level is their force on the way up, and black on the
/// way down: frames, photodiodes' table, log.
pub(crate) fn pressed(folder: &Path, most: u8) -> [PathBuf; 3] {
    let at = ["frames", "photodiodes.csv", "log.csv"].map(|name| folder.join(name));
    std::fs::create_dir(&at[0]).unwrap();
    let (mut table, mut log) = ("frame,time_s\n".to_owned(), "time_s,Fz_N\n".to_owned());
    for k in 0..2 * most {
        let [force_n, level] = if k <= most { [k, 5 * k] } else { [2 * most - k, 0] };
        writeln!(table, "{k},{k}").unwrap();
        writeln!(log, "{k},{}", -0.1 * f64::from(force_n)).unwrap();
        let picture = image::GrayImage::from_pixel(40, 40, image::Luma([level]));
        picture.save(at[0].join(format!("{k:06}.png"))).unwrap();
    }
    std::fs::write(&at[1], table).unwrap();
    std::fs::write(&at[2], log).unwrap();
    at
}

#[test]
fn frames_on_the_way_to_the_greatest_force_are_shown_by_their_force() {
    let folder = tempfile::tempdir().unwrap();
    let [frames, photodiodes, log] = pressed(folder.path(), 20);
    let out = folder.path().join("out");
    let shown = rising(&frames, &photodiodes, &log, &out).unwrap();
    assert_eq!(shown, [0.0, 0.25, 0.5, 1.0, 1.5, 2.0]);
    let numbers = Numbers::read(&out.join("numbers.json")).unwrap();
    let tip = numbers.get("tip_to_1N").unwrap();
    assert!((tip - 50.0 / 255.0).abs() < 1e-6, "{tip}");
    assert_eq!(numbers.get("tip_beyond_1N"), None);
    assert!(out.join("rising.png").is_file());
}
