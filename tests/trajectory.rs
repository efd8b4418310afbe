//! `lunula trajectory`: the tables are the thesis' equations from rest on, what is reported of them is true, bad
//! requests are refused whole.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use lunula::phantom::force::Spiral;

use crate::util::{Answer, Dir, Json, number};

/// Half a step of a force's sixth decimal, and of an angle's fifth.
const FORCE_N: f64 = 0.51e-6;
const ANGLE_DEG: f64 = 0.51e-5;

fn run(dir: &Dir, options: &str) -> Answer {
    dir.words(&format!("trajectory {options}"))
}

fn forces(row: &BTreeMap<String, String>) -> [f64; 3] {
    ["Fx_N", "Fy_N", "Fz_N"].map(|name| number(row, name))
}

#[test]
fn the_table_is_the_spiral_and_its_rates_are_reported() {
    let dir = Dir::new();
    let report = run(&dir, "force --every 0.04 --out t.csv --json").expect(0).json();
    let rows = dir.table("t.csv");
    assert_eq!((rows.len(), rows[1]["time_s"].as_str(), rows[4500]["time_s"].as_str()), (4501, "0.04", "180.00"));
    assert_eq!(forces(&rows[0]), [0.0; 3]);
    for row in &rows {
        let exact = Spiral::default().forces_n(number(row, "time_s"));
        let near = forces(row).iter().zip(exact).all(|(force, exact)| (force - exact).abs() <= FORCE_N);
        assert!(near, "{row:?} is not {exact:?}");
    }
    let spiral = &report["force"]["spiral"];
    let reported = |name: &str| spiral[name].number();
    assert!((reported("radial_rate_printed_n_per_s") - 0.117_81).abs() <= 1e-5);
    assert!((reported("radial_rate_true_n_per_s") - 0.235_62).abs() <= 1e-5);
    assert!(
        (reported("shortest_printed_s") - 141.37).abs() <= 0.01 && (reported("shortest_true_s") - 282.74).abs() <= 0.01
    );
    assert_eq!(report["force"]["keeps_limit"], true);
    assert_eq!(report["warnings"].list().len(), 0);
    let files: Vec<String> = dir.bytes_of(".").into_keys().collect();
    let pictures = ["t-cone.png", "t-cone.svg", "t-force.png", "t-force.svg", "t-path.png", "t-path.svg"];
    assert_eq!(files, [&pictures[..], &["t.csv", "t.run.json"]].concat());
}

#[test]
fn the_reported_rates_are_those_of_the_rows() {
    // Rows a fortieth of a second apart cut the corners of what is measured a millisecond apart; measured 1.9e-4 of it.
    const NEAR: f64 = 1e-3;
    let dir = Dir::new();
    for (name, kind) in [("f", "force --every 0.025"), ("r", "random --every 0.025 --seed 3")] {
        let report = run(&dir, &format!("{kind} --out {name}.csv --no-figures --json")).expect(0).json();
        let rows = dir.table(&format!("{name}.csv"));
        let reported = &report["force"]["rates"]["components_n_per_s"];
        for k in 0..3 {
            let rate = rows.windows(2).map(|pair| (forces(&pair[1])[k] - forces(&pair[0])[k]).abs() / 0.025);
            let largest = rate.fold(0.0, f64::max);
            let reported = reported[k].number();
            assert!((largest / reported - 1.0).abs() <= NEAR, "{name} {k}: {largest} {reported}");
        }
    }
}

#[test]
fn random_forces_begin_at_rest_stay_in_the_cone_and_are_the_seeds() {
    let dir = Dir::new();
    for (name, more) in [("one", "--seed 7"), ("other", "--seed 8")] {
        let report =
            run(&dir, &format!("random {more} --fz-max 2 --mu 0.5 --out {name}/t.csv --json")).expect(0).json();
        assert_eq!(report["force"]["coverage"]["outside"], 0);
    }
    let rows = dir.table("one/t.csv");
    assert_eq!((rows.len(), forces(&rows[0])), (2501, [0.0; 3]));
    assert!(dir.text("one/t.csv") != dir.text("other/t.csv"));
}

#[test]
fn bending_is_equation_27_and_random_bending_stays_in_its_range() {
    let dir = Dir::new();
    let report = run(&dir, "posture --every 0.1 --lead 2 --trail 1 --out p.csv --json").expect(0).json();
    assert_eq!(report["rows"], 631);
    for row in dir.table("p.csv") {
        let t_s = (number(&row, "time_s") - 2.0).clamp(0.0, 60.0);
        let j2_deg = 35.0 - 40.0 * (TAU * 0.1 * t_s).cos();
        assert!((number(&row, "J2_deg") - j2_deg).abs() <= ANGLE_DEG, "{t_s}");
    }
    let posture = &report["posture"];
    assert!((posture["fastest_deg_per_s"].number() - 25.13).abs() <= 0.01);
    assert!(dir.path("p-posture.png").is_file());
    run(&dir, "posture --random --seed 4 --seconds 300 --out r.csv --no-figures").expect(0);
    let rows = dir.table("r.csv");
    assert_eq!(number(&rows[0], "J2_deg"), -5.0);
    assert!(rows.iter().all(|row| (-5.0..=75.0).contains(&number(row, "J2_deg"))));
    assert!(rows.iter().any(|row| number(row, "J2_deg") > 60.0));
    assert!(!dir.path("r-posture.png").exists());
}

#[test]
fn lead_and_trail_are_at_rest() {
    let dir = Dir::new();
    for kind in ["force --seconds 30", "random --seconds 30"] {
        run(&dir, &format!("{kind} --lead 1.5 --trail 3 --every 0.1 --out t.csv --no-figures")).expect(0);
        let rows = dir.table("t.csv");
        assert_eq!(rows.len(), 346);
        for row in &rows {
            let t_s = number(row, "time_s");
            let rest = forces(row) == [0.0; 3];
            if !(1.5..33.5).contains(&t_s) {
                assert!(rest, "{kind} at {t_s}");
            } else if (2.0..33.0).contains(&t_s) {
                assert!(!rest, "{kind} at {t_s}");
            }
        }
    }
}

#[test]
fn what_cannot_be_is_refused_all_at_once_and_nothing_is_written() {
    let dir = Dir::new();
    let refused = |options: &str| run(&dir, &format!("{options} --out out/t.csv")).expect(2);
    refused("force --every 0 --mu 0 --fc nan --fz-max -3 --tau inf")
        .says("--every 0: choose more than 0 s")
        .says("--mu 0: choose 0.01 to 10")
        .says("--fc NaN: choose 0.001 to 10 Hz")
        .says("--fz-max -3: choose 0.01 to 100 N")
        .says("--tau inf: choose 0.001 to 1000 s");
    refused("force --every nan").says("--every NaN: choose more than 0 s");
    refused("force --every 181").says("--every 181: longer than the 180 s of --seconds");
    refused("force --every 1.8e-7").says("--every 0.00000018: 1.000e9 rows; choose 9.4e-6 s or more");
    refused("random --seconds 1e-3")
        .says("--seconds 0.001: choose 1 to 1000000 s")
        .says("--soft-start 5: longer than the 0.001 s");
    refused("posture --hz 0 --lead -1").says("--hz 0: choose 0.001 to 10 Hz").says("--lead -1: choose 0 to");
    refused("posture --seed 3").says("--random");
    run(&dir, "force --out out/t.txt").expect(2).says("ends in .csv or .parquet");
    run(&dir, "force").expect(2).says("--out");
    run(&dir, "sideways --out out/t.csv").expect(2);
    assert!(dir.bytes_of(".").is_empty());
}

#[test]
fn extremes_are_played_and_warned_of() {
    let dir = Dir::new();
    let warned = |options: &str| {
        let report = run(&dir, &format!("{options} --out t.csv --json -q")).expect(0).json();
        report["warnings"].list().iter().map(|text| text.words().to_owned()).collect::<String>()
    };
    // As short as can be: the soft start is all of it.
    let hasty = warned("force --seconds 2");
    assert!(
        hasty.contains("equation 19 allows 1.00") && hasty.contains("less than the 141 s of equation 26"),
        "{hasty}"
    );
    let rows = dir.table("t.csv");
    assert_eq!((rows.len(), forces(&rows[0])[2], forces(&rows[50])[2]), (51, 0.0, -3.0));
    assert!(warned("force --soft-start 0").contains("begins infinitely fast"));
    // One step: the first row and the last.
    assert!(warned("force --every 180").contains("too far apart"));
    assert_eq!(dir.table("t.csv").len(), 2);
    // Steps that are no decimal numbers keep all their digits.
    run(&dir, "posture --every 0.03333333333333333 --out third.csv --no-figures").expect(0);
    let rows = dir.table("third.csv");
    assert_eq!((rows.len(), rows[1]["time_s"].as_str()), (1801, "0.03333333333333333"));
    // The largest cone, and the smallest.
    assert_eq!(warned("force --fz-max 0.01 --mu 0.01 --seconds 1000"), "");
    assert!(warned("force --fz-max 100 --mu 10 --fs 100 --fc 10").contains("equation 26"));
    // What happens between rows is not in them; eight rows a turn are enough.
    let said = warned("posture --hz 10 --every 0.1 --seconds 5");
    assert!(said.contains("leaves the straight line by up to 100 % of its range"), "{said}");
    assert!(warned("force --fc 10 --every 0.1 --seconds 20").contains("too far apart"));
    let said = warned("posture --hz 1 --every 0.125 --seconds 20");
    assert!(!said.contains("too far apart"), "{said}");
}

#[test]
fn a_plan_says_what_is_left_out_and_does_nothing() {
    let dir = Dir::new();
    let plan = run(&dir, "posture --plan --no-figures --out t.csv --json").expect(0).json();
    let fates: Vec<_> = plan["plan"].list().iter().map(|step| step["fate"].words()).collect();
    assert_eq!(fates, ["run", "run", "left_out", "left_out", "left_out"]);
    run(&dir, "force --plan").expect(0).prints("4501 rows of time_s, Fx_N, Fy_N, Fz_N");
    run(&dir, "force --plan --every 0").expect(2).says("--every 0");
    assert!(dir.bytes_of(".").is_empty());
}

#[test]
fn an_earlier_table_is_replaced_whole_and_others_stay() {
    let dir = Dir::new();
    dir.write("t.csv", "mine before");
    dir.write("t.txt", "mine");
    std::fs::create_dir(dir.path("folder.csv")).unwrap();
    run(&dir, "force --out folder.csv").expect(2).says("is a folder");
    run(&dir, "force --seconds 10 --out t.csv --no-figures").expect(0);
    assert_eq!((dir.table("t.csv").len(), dir.bytes_of(".")["t.txt"].as_slice()), (251, b"mine".as_slice()));
}
