//! The job as a whole, on recordings that are made here.

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::path::Path;

use super::*;
use lunula::job::read;

/// A table of a force that goes up and down `cycles` times, with two photodiodes.
fn recording(path: &Path, cycles: f64) {
    let mut text = "time_s,Fx_N,Fz_N,P1,P2\n".to_owned();
    for k in 0..(250.0 * cycles) as u32 {
        let time_s = f64::from(k) / 12.5;
        let fx = -2.0 * (TAU * 0.05 * time_s).cos();
        let fz = -3.0 - 0.2 * (2.0 * TAU * 0.05 * time_s).sin();
        writeln!(text, "{time_s},{fx},{fz},{},{}", 1.0 + 0.2 * fx, 2.0 - 0.1 * fx).unwrap();
    }
    std::fs::write(path, text).unwrap();
}

fn of(drive: &str) -> ResponsesOptions {
    ResponsesOptions { drive: drive.to_owned(), bins: 16, places: Vec::new() }
}

fn run(cycles: f64, options: &ResponsesOptions) -> (tempfile::TempDir, Result<ResponsesReport, ResponsesError>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lateral.csv");
    recording(&path, cycles);
    let files = [DataFile { name: "lateral.csv".to_owned(), ..path.into() }];
    let found = responses(&files, options, &folder.path().join("out"), &Watch::nobody());
    (folder, found)
}

#[test]
fn a_recording_gives_pictures_a_table_and_numbers() {
    let (folder, found) = run(5.0, &of("Fx_N"));
    let found = found.unwrap();
    assert_eq!(found.cycles, 5);
    let numbers = Numbers::read(&folder.path().join("out/numbers.json")).unwrap();
    assert_eq!(numbers, found.numbers);
    assert!((numbers.get("P1.slope_V_per_N").unwrap() - 0.2).abs() < 2e-3);
    assert!((numbers.get("P2.phase_deg").unwrap().abs() - 180.0).abs() < 2.0);
    assert!((numbers.get("P2.sensitivity_share").unwrap() - 0.5).abs() < 0.01);
    assert!((numbers.get("Fz_N.mean").unwrap() + 3.0).abs() < 0.01);
    assert!(numbers.get("Fz_N.second_over_first").unwrap() > 5.0, "{numbers:?}");
    for name in ["moves.png", "outputs.svg", "averages.png"] {
        assert!(folder.path().join("out").join(name).is_file(), "{name}");
    }
    let table = std::fs::read_to_string(folder.path().join("out/responses.csv")).unwrap();
    assert_eq!(table.lines().count(), 1 + 2 * 2 * 16);
}

#[test]
fn one_cycle_has_no_spread_and_none_is_an_error() {
    let (_folder, one) = run(1.0, &of("Fx_N"));
    let one = one.unwrap();
    assert_eq!((one.cycles, one.numbers.get("P1.sd_V")), (1, None));
    assert!(one.warnings.iter().any(|warning| warning.contains("one cycle")), "{:?}", one.warnings);
    let (folder, none) = run(0.4, &of("Fx_N"));
    let words = none.unwrap_err().to_string();
    assert!(words.contains("lateral.csv") && words.contains("Fx_N"), "{words}");
    assert!(!folder.path().join("out").exists());
}

#[test]
fn a_request_that_is_none_says_what_to_choose() {
    for (keys, what) in [("drive = 'Fq_N'", "Fz_N"), ("drive = 'Fx_N'\nbins = 1", "4..=200")] {
        let fault = read::<ResponsesOptions>(&keys.parse().unwrap(), "").err().unwrap();
        assert!(fault.what.contains(what), "{keys}: {fault:?}");
    }
    assert!(responses(&[], &of("Fx_N"), Path::new("nowhere"), &Watch::nobody()).is_err());
}
