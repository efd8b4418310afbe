//! `lunula train --model eigennails` on recordings of which there is too little: said or refused, never NaN.

use std::fmt::Write as _;

use crate::util::{Answer, Dir, number};

const SIDE: usize = 6;
const REGRESSIONS: [&str; 2] = ["ridge", "process"];

/// given.csv: so many rows of 36 cells, and the forces of each row.
fn table(dir: &Dir, rows: usize, cell: impl Fn(usize, usize) -> f64, forces: impl Fn(usize) -> [f64; 3]) {
    let names = (0..SIDE * SIDE).map(|k| format!("C_{:02}_{:02}", k / SIDE, k % SIDE));
    let mut text = format!("time_s,{},Fx_N,Fy_N,Fz_N\n", names.collect::<Vec<_>>().join(","));
    for row in 0..rows {
        let cells: Vec<String> = (0..SIDE * SIDE).map(|k| format!("{:?}", cell(row, k))).collect();
        let forces = forces(row).map(|force| format!("{force:?}"));
        writeln!(text, "{:?},{},{}", 0.1 * row as f64, cells.join(","), forces.join(",")).expect("text");
    }
    dir.write("given.csv", text);
}

/// Cells that each follow three forces in their own way, with noise of 0.3 SD.
fn following(forces: impl Fn(usize) -> [f64; 3]) -> impl Fn(usize, usize) -> f64 {
    move |row, k| {
        let [x, y, z] = forces(row);
        let own = |rate: f64| (rate * k as f64).sin();
        let noise = (((row * 37 + k) as f64 * 78.233).sin() * 43_758.545_3).fract();
        50.0 + own(0.7) * x + own(1.3) * y + own(2.1) * z + 0.5 * noise
    }
}

fn swings(row: usize) -> [f64; 3] {
    let t = row as f64;
    [(0.9 * t).sin(), (1.7 * t).cos(), -2.0 + (0.4 * t).sin()]
}

fn press_n(row: usize) -> f64 {
    -2.0 + (0.4 * row as f64).sin()
}

fn train(dir: &Dir, more: &str) -> Answer {
    let line = format!("train given.csv --target force --model eigennails --out m.json {more}");
    dir.words(&line)
}

/// What the model predicts of given.csv: each force and its SD of each row, all finite.
fn predicted(dir: &Dir, rows: usize) -> Vec<[f64; 3]> {
    dir.lunula(&["predict", "m.json", "given.csv", "--out", "p.csv"]).expect(0);
    let table = dir.table("p.csv");
    assert_eq!(table.len(), rows);
    assert!(table.iter().all(|row| ["Fx_N_sd", "Fy_N_sd", "Fz_N_sd"].iter().all(|sd| number(row, sd).is_finite())));
    let all: Vec<[f64; 3]> = table.iter().map(|row| ["Fx_N", "Fy_N", "Fz_N"].map(|force| number(row, force))).collect();
    assert!(all.iter().flatten().all(|force| force.is_finite()));
    all
}

#[test]
fn a_nail_that_is_only_pressed_has_no_directions_and_still_targets_stay() {
    let press = |row: usize| [0.0, 0.0, press_n(row)];
    for regression in REGRESSIONS {
        let dir = Dir::new();
        table(&dir, 80, following(press), press);
        let answer = train(&dir, &format!("--regression {regression}")).expect(0);
        assert!(answer.stdout.contains("no directions: all rows of clear direction are of one, press"));
        answer.says("Fx_N is 0.0 in all training rows, and so in all predictions").says("Fy_N is 0.0 in all");
        for (row, forces) in predicted(&dir, 80).iter().enumerate() {
            let off = (forces[2] - press_n(row)).abs();
            assert!(forces[0] == 0.0 && forces[1] == 0.0 && off <= PRESS_OFF_N, "{regression} {row}: {forces:?}");
        }
    }
}

/// Most that the noise of 36 cells leaves of pressing, newtons; measured 0.098.
const PRESS_OFF_N: f64 = 0.12;

#[test]
fn cells_alike_make_one_mode() {
    for regression in REGRESSIONS {
        let dir = Dir::new();
        table(&dir, 80, |row, _| 50.0 + 3.0 * press_n(row), swings);
        train(&dir, &format!("--regression {regression}")).expect(0).prints("1 eigennails explain 100.0 %");
        for (row, forces) in predicted(&dir, 80).iter().enumerate() {
            // Measured 1e-11 N of ridge and 1e-4 N of a process.
            assert!((forces[2] - press_n(row)).abs() <= 1e-3, "{regression} {row}: {forces:?}");
        }
    }
}
