//! `lunula fit`: parameters that made a recording are found again from it, with what it does not tell said; bad
//! requests are refused whole.

use crate::util::{Answer, Dir, Json, number};

fn run(dir: &Dir, command: &str, options: &str) -> Answer {
    dir.words(&format!("{command} {options}"))
}

fn parameter(dir: &Dir, file: &str, name: &str) -> f64 {
    let text = dir.text(file);
    let value = text.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(" = "));
    value.expect("a parameter of the file").parse().expect("a number")
}

/// That these parameters are found again, relative errors of at most `near`.
#[track_caller]
fn found_again(dir: &Dir, file: &str, near: f64, parameters: &[(&str, f64)]) {
    for (name, truth) in parameters {
        let found = parameter(dir, file, name);
        assert!((found / truth - 1.0).abs() <= near, "{file}: {name}: {found} and not {truth}");
    }
}

/// A response to steps on both places, with the nail's values.
const STEPS: &str = "--pf1 step:6000@0..2 --pf2 step:4000@0.5..2.5 --every 0.02 --rtol 1e-9 --with-loads --no-figures";

/// The same at rows 25, 50, 75 of 0.02 s, of which every second one is odd.
const STEPS_AT_ODD_ROWS: &str =
    "--pf1 step:6000@0.5..2 --pf2 step:4000@1..2.5 --every 0.02 --rtol 1e-9 --with-loads --no-figures";

#[test]
fn what_made_a_recording_is_found_again() {
    // The recording's loads bend at its samples: measured 1.3e-8 of the parameters, 2.1e-10 V of the fitted voltages.
    const NEAR: f64 = 1e-6;
    const NEAR_V: f64 = 1e-8;
    let dir = Dir::new();
    dir.write("ramps.csv", "time_s,pf1_Pa,pf2_Pa\n0,0,0\n0.1,6000,0\n1.5,6000,5000\n2,6000,5000\n2.1,0,0\n");
    let nail = "--set k_C1_N_per_m=7e4 --set k_C2_N_per_m=7e4 --set b_V_N_s_per_m=250 --set V0_1_V=0.5 --set V1_1_V=3 \
                --set V1_2_V=2";
    run(
        &dir,
        "simulate",
        &format!("--loads ramps.csv {nail} --every 0.02 --rtol 1e-9 --with-loads --out r.csv --no-figures"),
    )
    .expect(0);
    let twice = run(&dir, "fit", "r.csv ./r.csv --free k_C,b_V --out t.json --no-figures").expect(0);
    twice.says("r.csv, ./r.csv: the same to the byte, and counted 2 times");
    let report = run(&dir, "fit", "r.csv --free k_C,b_V --out f.json --json").expect(0).json();
    let written = dir.parsed("f.json");
    assert_eq!(written["free"], report["free"]);
    assert_eq!(report["converged"], true);
    let vessels = [("k_C1_N_per_m", 7e4), ("k_C2_N_per_m", 7e4), ("b_V_N_s_per_m", 250.0)];
    found_again(&dir, "f.toml", NEAR, &vessels);
    found_again(&dir, "f.toml", NEAR, &[("V0_1_V", 0.5), ("V1_1_V", 3.0), ("V1_2_V", 2.0)]);
    assert!(report["r2"].number() > 0.999_999);
    assert!(report["correlations"].list().len() == 6);
    // The fitted parameters are a file for simulate.
    run(&dir, "simulate", "--loads ramps.csv --params f.toml --every 0.02 --out again.csv --no-figures").expect(0);
    let (measured, again) = (dir.table("r.csv"), dir.table("again.csv"));
    let worst =
        measured.iter().zip(&again).map(|(a, b)| (number(a, "VP1") - number(b, "VP1")).abs()).fold(0.0, f64::max);
    assert!(worst <= NEAR_V, "{worst}");
    let fitted = dir.table("f-fitted.csv");
    assert_eq!(fitted.len(), 2 * measured.len());
    let misses = fitted.iter().map(|row| (number(row, "measured_V") - number(row, "fitted_V")).abs());
    assert!(misses.fold(0.0, f64::max) <= NEAR_V);
    let files: Vec<String> = dir.bytes_of(".").into_keys().filter(|name| name.starts_with('f')).collect();
    assert_eq!(
        files,
        ["f-estimates.csv", "f-fitted.csv", "f-fitted.png", "f-fitted.svg", "f.json", "f.run.json", "f.toml"]
    );
}

#[test]
fn every_subject_has_photodiodes_of_its_own() {
    // Measured 2.0e-15.
    const NEAR: f64 = 1e-12;
    let dir = Dir::new();
    for (name, scaling) in [("a", 2.0), ("b", 5.0)] {
        run(&dir, "simulate", &format!("--static 0..9000/500 --set V1_1_V={scaling} --out {name}.csv --no-figures"))
            .expect(0);
    }
    let report = run(&dir, "fit", "a.csv b.csv --subject anna,ben --free k_V --out f.json --json").expect(0).json();
    assert_eq!(report["photodiodes"].list().len(), 4);
    let notes = report["notes"].to_string();
    assert!(notes.contains("anna, ben have one value of k_V_N_per_m"), "{notes}");
    for (file, scaling) in [("f-anna.toml", 2.0), ("f-ben.toml", 5.0)] {
        found_again(&dir, file, NEAR, &[("V1_1_V", scaling), ("k_V_N_per_m", 1e3)]);
    }
    // Recordings of the same name have files of their own.
    dir.write("day/a.csv", std::fs::read(dir.path("b.csv")).unwrap());
    run(&dir, "fit", "a.csv day/a.csv --calibrate recording --free none --out g.json").expect(0);
    for (file, scaling) in [("g-a.toml", 2.0), ("g-a-2.toml", 5.0)] {
        found_again(&dir, file, NEAR, &[("V1_1_V", scaling)]);
    }
}

#[test]
fn persons_and_recordings_that_differ_are_named() {
    let dir = Dir::new();
    for (name, k) in [("a", "7e4"), ("b", "1.3e5"), ("c", "7e4")] {
        let k = format!("--set k_C1_N_per_m={k} --set k_C2_N_per_m={k}");
        run(&dir, "simulate", &format!("{STEPS} {k} --until 4 --out {name}.csv")).expect(0);
    }
    let text = dir.text("c.csv");
    let lines: Vec<&str> = text.lines().collect();
    let places: Vec<usize> =
        lines[0].split(',').enumerate().filter(|(_, name)| name.starts_with("VP")).map(|(k, _)| k).collect();
    let in_mv = lines[1..].iter().map(|line| {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        for &k in &places {
            cells[k] = (1e3 * cells[k].parse::<f64>().expect("a voltage")).to_string();
        }
        cells.join(",") + "\n"
    });
    dir.write("mv.csv", format!("{}\n{}", lines[0], in_mv.collect::<String>()));
    let fit = |of: &str| {
        let options = format!("{of} --free k_C,b_C --between held --unloaded-before --out f.json --no-figures");
        run(&dir, "fit", &options).expect(0)
    };
    let differ = "one value for both doesn't hold";
    let persons = fit("a.csv b.csv --subject anna,ben");
    persons.says("k_C1_N_per_m is 7.0").says("by anna alone and 1.30").says("by ben alone").says(differ);
    let fitted: serde_json::Value = serde_json::from_str(&dir.text("f.json")).expect("a result");
    let alone = &fitted["alone"];
    let k = |part: usize| alone[part]["free"][0]["values"][0].as_f64().expect("a value");
    assert!((k(0) / 7e4 - 1.0).abs() < 0.01 && (k(1) / 1.3e5 - 1.0).abs() < 0.01, "{alone}");
    fit("a.csv b.csv").says("by a.csv alone and").says(differ);
    fit("a.csv c.csv").never_says(differ).never_says("in another unit");
    fit("a.csv c.csv --subject anna,ben").never_says(differ);
    fit("a.csv mv.csv").says("V1_1_V is").says("in another unit, or put on again?").never_says(differ);
    fit("a.csv mv.csv --calibrate recording").never_says("in another unit").never_says(differ);
    fit("a.csv mv.csv b.csv --subject anna,anna,ben").says("V1_1_V is").says("by mv.csv alone");
    dir.write("day/a.csv", std::fs::read(dir.path("b.csv")).unwrap());
    fit("a.csv day/a.csv").says("by a.csv alone and 1.30").says("by day/a.csv alone");
    fit("a.csv").never_says("alone");
}

#[test]
fn a_log_of_forces_and_photodiodes_of_other_names_is_read() {
    // Measured 2.2e-16.
    const NEAR: f64 = 1e-12;
    let dir = Dir::new();
    run(&dir, "simulate", "--static 0..9000/500 --load distal --set V1_2_V=3 --out s.csv --no-figures").expect(0);
    let mut log = "Fz_N,P3,other\n".to_owned();
    for row in dir.table("s.csv") {
        // On 2 cm2, pressing is negative.
        log += &format!("{},{},x\n", -2e-4 * number(&row, "pf2_Pa"), row["VP2"]);
    }
    // A photodiode's cell may be empty.
    log += "-1,,x\n";
    dir.write("log.csv", log);
    let options = "log.csv --force Fz_N --area-cm2 2 --load distal --photodiode P3=2 --free none --out f.json --json";
    let report = run(&dir, "fit", options).expect(0).json();
    found_again(&dir, "f.toml", NEAR, &[("V1_2_V", 3.0)]);
    assert_eq!((report["recordings"][0]["missing"].as_u64(), report["values"].as_u64()), (Some(1), Some(19)));
}

#[test]
fn what_recordings_do_not_determine_is_said() {
    let dir = Dir::new();
    let mut constant = "time_s,pf1_Pa,pf2_Pa,VP1,VP2\n".to_owned();
    for k in 0..50 {
        constant += &format!("{},0,0,0.900{},0.8\n", f64::from(k) * 0.02, k % 3);
    }
    // Loads that don't change.
    dir.write("constant.csv", &constant);
    let report = run(&dir, "fit", "constant.csv --free b_C --out f.json --json").expect(0).json();
    assert_eq!(report["free"][0]["identifiable"], false);
    assert!(report["free"][0]["standard_errors"].is_null());
    // Nor photodiodes that do.
    dir.write("still.csv", constant.replace("0.9001,", "0.9000,").replace("0.9002,", "0.9000,"));
    run(&dir, "fit", "still.csv --free b_C --out s.json").expect(2).says("every photodiode is constant (VP1, VP2)");
    assert!(!report["not_identifiable"].list().is_empty());
    assert!(report["warnings"].to_string().contains("b_C1_N_s_per_m"), "{}", report["warnings"]);
    run(&dir, "simulate", &format!("{STEPS} --set k_V_N_per_m=3000 --out r.csv")).expect(0);
    let report =
        run(&dir, "fit", "r.csv --free k_V --bounds k_V=0.5x..2x --between held --unloaded-before --out b.json --json")
            .expect(0)
            .json();
    assert_eq!(report["free"][0]["at_bound"], "upper");
    let said = report["warnings"].to_string();
    assert!(said.contains("the other errors hold for this bound only"), "{said}");
}

#[test]
fn voltages_may_be_missing_but_not_be_no_numbers() {
    // The missing ones were exact, the rest gives the same: measured 9.4e-8.
    const NEAR: f64 = 1e-5;
    let dir = Dir::new();
    run(&dir, "simulate", &format!("{STEPS} --set k_V_N_per_m=1500 --out r.csv")).expect(0);
    let with = |missing: &str| -> String {
        let rows = dir.table("r.csv").into_iter().enumerate().map(|(k, row)| {
            let first = if k % 3 == 1 { missing } else { &row["VP1"] };
            format!("{},{},{},{first},{}\n", row["time_s"], row["pf1_Pa"], row["pf2_Pa"], row["VP2"])
        });
        format!("time_s,pf1_Pa,pf2_Pa,VP1,VP2\n{}", rows.collect::<String>())
    };
    dir.write("empty.csv", with(""));
    let jumps = "--between held --unloaded-before";
    let report = run(&dir, "fit", &format!("empty.csv --free k_V {jumps} --out f.json --json")).expect(0).json();
    assert_eq!((report["recordings"][0]["missing"].as_u64(), report["values"].as_u64()), (Some(67), Some(335)));
    found_again(&dir, "f.toml", NEAR, &[("k_V_N_per_m", 1500.0)]);
    let empty = dir.table("f-fitted.csv").iter().filter(|row| row["measured_V"].is_empty()).count();
    assert_eq!(empty, 67);
    for (cell, words) in [("NaN", "is no finite number"), ("inf", "is no finite number"), ("off", "is no number")] {
        dir.write("bad.csv", with(cell));
        run(&dir, "fit", &format!("bad.csv --free k_V {jumps} --out g.json"))
            .expect(2)
            .says("bad.csv:3: column `VP1`")
            .says(words);
    }
    dir.write("none.csv", "time_s,pf1_Pa,pf2_Pa,VP1\n0,0,0,\n1,0,0,\n");
    run(&dir, "fit", "none.csv --free k_V --out g.json").expect(2).says("none.csv");
    assert!(!dir.path("g.json").exists());
}

#[test]
fn bad_requests_are_refused_whole() {
    let dir = Dir::new();
    run(&dir, "simulate", &format!("{STEPS} --out r.csv")).expect(0);
    dir.write("short.csv", "time_s,pf1_Pa,pf2_Pa,VP1\n0,0,0,0.9\n1,0,0,0.8\n");
    dir.write("bad.csv", "time_s,pf1_Pa,pf2_Pa,VP1\n0,0,0,0.9\n1,,0,0.9\n0.5,nan,0,0.9\n");
    dir.write("volts.csv", "time_s,pf1_Pa,pf2_Pa,VP1\n0,0,0,0.9\n1,0,0,inf\n");
    dir.write("names.csv", "time_s,pf1_Pa,pf2_Pa,P1\n0,0,0,0.9\n");
    let before = dir.bytes_of(".").len();
    for (options, words) in [
        ("r.csv --free speed --out f.json", "--free speed"),
        ("r.csv --free k_C --bounds k_V=1..2 --out f.json", "--bounds k_V"),
        ("r.csv --free k_C --bounds k_C=5..2 --out f.json", "bounds"),
        ("r.csv --free k_C --bounds k_C=wide --out f.json", "0.1x..10x"),
        ("r.csv --free k_C,k_C1 --out f.json", "free twice"),
        ("r.csv --free k_C --set m_V_kg=2e-3 --set m_V_kg=1e-3 --out f.json", "`m_V_kg` is given twice"),
        ("r.csv --free none --calibrate held --out f.json", "nothing is free"),
        ("r.csv --free k_C --subject a,b --out f.json", "--subject"),
        ("r.csv --free k_C --photodiode P3=1 --out f.json", "P3"),
        ("r.csv --free k_C --photodiode VP1=3 --out f.json", "2 units"),
        ("r.csv --free k_C --photodiode VP1=1 --photodiode VP9=2 --out f.json", "VP9=2: no recording has this column"),
        ("r.csv --free k_C --photodiode VP1=1 --photodiode VP9=2 --out f.json", "did you mean `VP2`?"),
        ("r.csv --free k_C --photodiode VP1=1 --photodiode VP1=2 --out f.json", "--photodiode VP1: is named twice"),
        ("r.csv --free k_C --force Fz_N --out f.json", "--area-cm2"),
        ("r.csv --free k_C --force VP1 --area-cm2 0 --out f.json", "greater than 0"),
        ("r.csv --free k_C --force Fz_kN --area-cm2 2 --out f.json", "`Fz_kN` is a force that is not in newtons"),
        ("r.csv --free k_C --force VP1 --area-cm2 -1 --out f.json", "greater than 0"),
        ("r.csv --free k_C --out r.csv", "is an input itself"),
        ("short.csv --free k_C,b_C,k_V --out f.json", "2 voltages can't determine 5 unknowns"),
        ("bad.csv --free k_C --out f.json", "bad.csv:3: column `pf1_Pa`: is empty"),
        ("bad.csv --free k_C --out f.json", "bad.csv:4: column `time_s`"),
        ("volts.csv --free k_C --out f.json", "volts.csv:3: column `VP1`"),
        ("names.csv --free k_C --out f.json", "--photodiode P3=1"),
        ("nowhere.csv --free k_C --out f.json", "nowhere.csv"),
        ("r.csv --out f.json", "--free"),
    ] {
        run(&dir, "fit", options).expect(2).says(words);
    }
    assert_eq!(dir.bytes_of(".").len(), before);
}

#[test]
fn the_plan_says_what_runs() {
    let dir = Dir::new();
    run(&dir, "simulate", &format!("{STEPS} --out r.csv")).expect(0);
    run(&dir, "fit", "r.csv --free k_C --plan").expect(0).prints("1 free groups, 1 recordings, 201 samples");
}

#[test]
fn no_side_file_replaces_an_input() {
    let dir = Dir::new();
    run(&dir, "simulate", &format!("{STEPS} --out v-fitted.csv")).expect(0);
    run(&dir, "fit", "v-fitted.csv --free none --out w.json --no-figures").expect(0);
    let before = dir.bytes_of(".");
    for options in [
        "v-fitted.csv --free k_C --out v.json",
        "v-fitted.csv --params w.toml --free k_C --out w.json",
        "v-fitted.csv --params w.toml --free k_C --out w.toml",
    ] {
        run(&dir, "fit", options).expect(2).says("is an input itself");
        run(&dir, "fit", &format!("{options} --plan")).expect(2).says("is an input itself");
    }
    assert!(dir.bytes_of(".") == before);
}

#[test]
fn noisier_photodiodes_count_less() {
    // The noise's SD from 201 values has a standard error of 5 %: four of them.
    const NEAR: f64 = 0.2;
    let dir = Dir::new();
    run(&dir, "simulate", &format!("{STEPS} --set k_V_N_per_m=1500 --out r.csv")).expect(0);
    let (mut log, mut seed) = ("time_s,pf1_Pa,pf2_Pa,VP1,VP2\n".to_owned(), 1_u64);
    // Twelve uniform numbers less six have SD 1.
    let mut gauss = || -> f64 {
        let mut next = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..12).map(|_| next()).sum::<f64>() - 6.0
    };
    for row in dir.table("r.csv") {
        let [first, second] = [("VP1", 1e-5), ("VP2", 1e-3)].map(|(name, sd)| number(&row, name) + sd * gauss());
        log += &format!("{},{},{},{first},{second}\n", row["time_s"], row["pf1_Pa"], row["pf2_Pa"]);
    }
    dir.write("noisy.csv", log);
    let options = "noisy.csv --free k_V --between held --unloaded-before --no-figures --json";
    let report = run(&dir, "fit", &format!("{options} --out f.json")).expect(0).json();
    for (k, sd) in [1e-5, 1e-3].into_iter().enumerate() {
        let noise_v = report["recordings"][0]["noise_v"][k].number();
        assert!((noise_v / sd - 1.0).abs() <= NEAR, "{noise_v} {sd}");
    }
    // With the same noises given it is the same fit; with others it is another.
    let found = |options: &str| {
        let report = run(&dir, "fit", options).expect(0).json();
        (report["free"][0]["values"][0].number(), report["free"][0]["standard_errors"][0].number())
    };
    let (written, sure) = found(&format!("{options} --noise VP1=1e-5,VP2=1e-3 --out g.json"));
    let (_, unsure) = found(&format!("{options} --noise VP1=1,VP2=1 --out h.json"));
    let value = report["free"][0]["values"][0].number();
    assert!((written - value).abs() <= sure, "{written} {value} {sure}");
    assert!(sure < 0.5 * unsure, "{sure} {unsure}");
    run(&dir, "fit", &format!("{options} --noise VP1=0 --out i.json")).expect(2).says("VP1=5e-5");
}

#[test]
fn a_force_that_never_presses_is_refused() {
    let dir = Dir::new();
    dir.write("log.csv", "Fz_N,VP1\n0,0.9\n1,0.8\n2,0.7\n3,0.6\n");
    let options = "log.csv --force Fz_N --free none --out f.json --area-cm2 1";
    run(&dir, "fit", options).expect(2).says("`Fz_N` is never negative: nothing presses");
    assert!(!dir.path("f.json").exists());
}

#[test]
fn loads_of_the_wrong_sign_are_warned_of() {
    let dir = Dir::new();
    run(&dir, "simulate", &format!("{STEPS} --out r.csv")).expect(0);
    let recorded = |header: &str, loads: &dyn Fn(f64, f64) -> String| -> String {
        let row = |row: &std::collections::BTreeMap<String, String>| {
            let pressed = loads(number(row, "pf1_Pa"), number(row, "pf2_Pa"));
            format!("{},{pressed},{},{}\n", row["time_s"], row["VP1"], row["VP2"])
        };
        format!("{header}\n{}", dir.table("r.csv").iter().map(row).collect::<String>())
    };
    let fitted = |name: &str, options: &str| {
        let own = "--free none --between held --unloaded-before --no-figures --out f.json";
        run(&dir, "fit", &format!("{name} {options} {own}")).expect(0).stderr
    };
    const PRESSED: &str = "time_s,pf1_Pa,pf2_Pa,VP1,VP2";
    const SIGN: &str = "it is not 0: pressing is positive, and negative pressure is suction";
    for (name, signs) in [("both.csv", [-1.0, -1.0]), ("one.csv", [-1.0, 1.0]), ("none.csv", [1.0, 1.0])] {
        dir.write(name, recorded(PRESSED, &|first, second| format!("{},{}", signs[0] * first, signs[1] * second)));
        let said = fitted(name, "");
        for ((column, highest), sign) in [("pf1_Pa", 6000), ("pf2_Pa", 4000)].into_iter().zip(signs) {
            let words = format!("{name}: {column} goes from -{highest} to 0 Pa");
            assert_eq!(said.contains(&words), sign < 0.0, "{said}");
        }
        assert_eq!(said.contains(SIGN), name != "none.csv", "{said}");
        // What photodiodes do then is what no light does.
        let negative = format!("the scaling V_1 is negative for unit 1 of {name}");
        assert_eq!(said.contains(&negative), name != "none.csv", "{said}");
    }
    // Forces that pull, however small.
    let options = "--force Fz_N --area-cm2 0.5 --load proximal";
    for (name, pull, pulls) in [("up.csv", 5e-5, true), ("down.csv", -5e-5, false)] {
        let force = |first: f64, _: f64| format!("{}", if first == 0.0 { -0.001 } else { pull * first });
        dir.write(name, recorded("time_s,Fz_N,VP1,VP2", &force));
        let said = fitted(name, options);
        assert_eq!(said.contains("Fz_N goes from -0.001 to 0.300 N, as if the finger pulled"), pulls, "{said}");
        assert_eq!(said.contains("as if the finger pulled"), pulls, "{said}");
    }
}

#[test]
fn light_that_goes_with_the_load_is_warned_of() {
    let dir = Dir::new();
    let press = |t: f64, [on, off, pa]: [f64; 3]| 0.5 * pa * (((t - on) / 0.12).tanh() - ((t - off) / 0.12).tanh());
    let presses = [[1.0, 3.0, 4000.0], [4.5, 6.0, 2500.0], [7.5, 10.0, 5500.0], [11.5, 13.0, 3500.0]];
    let mut loads = "time_s,pf1_Pa,pf2_Pa\n".to_owned();
    for k in 0..=800 {
        let t = 0.02 * f64::from(k);
        let pa = presses.iter().map(|&one| press(t, one)).sum::<f64>().max(0.0);
        loads += &format!("{t:.2},{pa:.6},{pa:.6}\n");
    }
    dir.write("loads.csv", loads);
    run(&dir, "simulate", "--loads loads.csv --until 16 --every 0.02 --with-loads --out r.csv --no-figures").expect(0);
    let rows = dir.table("r.csv");
    let swings = ["VP1", "VP2"].map(|name| {
        let ends = |[a, b]: [f64; 2], row| [number(row, name).min(a), number(row, name).max(b)];
        let [least, most] = rows.iter().fold([f64::MAX, f64::MIN], ends);
        (name, most - least)
    });
    let said = |light: f64| {
        let mut text = "time_s,pf1_Pa,pf2_Pa,VP1,VP2\n".to_owned();
        for (k, row) in rows.iter().enumerate() {
            let pa = number(row, "pf1_Pa");
            let noise = 0.002 * ((((k * 7919 + 31) * (k + 17)) % 2003) as f64 / 1001.0 - 1.0);
            let [first, second] = swings.map(|(name, swing)| number(row, name) + swing * (light * pa / 5500.0 + noise));
            text += &format!("{},{pa},{pa},{first},{second}\n", row["time_s"]);
        }
        dir.write("light.csv", text);
        let answer = run(&dir, "fit", "light.csv --free k_C,b_C --out f.json --json --no-figures").expect(0);
        (answer.json()["beside"]["share"].number(), answer.stderr)
    };
    let (share, stderr) = said(0.03);
    assert!(stderr.contains("goes with the load itself, and that the model has not"), "{stderr}");
    assert!((0.02..0.045).contains(&share), "{share}");
    let (_, stderr) = said(0.0);
    assert!(!stderr.contains("goes with"), "{stderr}");
}

#[test]
fn loads_that_are_late_or_never_at_0_are_warned_of() {
    let dir = Dir::new();
    ramps(&dir);
    let rows = dir.table("r.csv");
    let warned = |late_rows: usize, offset_pa: f64| {
        let mut text = "time_s,pf1_Pa,pf2_Pa,VP1,VP2\n".to_owned();
        for (k, row) in rows.iter().enumerate() {
            let load = |name: &str| number(&rows[k.saturating_sub(late_rows)], name) + offset_pa;
            let noise = 1e-4 * (((k * 7919 + 31) * (k + 17)) % 2003) as f64 / 1001.0;
            let [first, second] = ["VP1", "VP2"].map(|name| number(row, name) + noise);
            text += &format!("{},{},{},{first},{second}\n", row["time_s"], load("pf1_Pa"), load("pf2_Pa"));
        }
        dir.write("moved.csv", text);
        let answer = run(&dir, "fit", "moved.csv --free k_C,b_C --out f.json --json --no-figures").expect(0);
        let delay_s = answer.json()["recordings"][0]["delay_s"][0].number();
        (delay_s, answer.stderr)
    };
    let (delay_s, said) = warned(0, 0.0);
    assert!(delay_s.abs() < 0.01 && !said.contains("clock") && !said.contains("rests at"), "{delay_s} {said}");
    let (delay_s, said) = warned(4, 0.0);
    assert!((-0.12..-0.04).contains(&delay_s), "{delay_s}");
    assert!(said.contains("ms before what the loads would make of them: are both on one clock?"), "{said}");
    let (_, said) = warned(0, 300.0);
    assert!(said.contains("stays at exactly 300") || said.contains("rests at 300 Pa"), "{said}");
}

#[test]
fn a_photodiode_that_some_recordings_lack_is_noted() {
    let dir = Dir::new();
    run(&dir, "simulate", "--static 0..9000/500 --out a.csv --no-figures").expect(0);
    let mut second = "pf1_Pa,pf2_Pa,VP1\n".to_owned();
    for row in dir.table("a.csv") {
        second += &format!("{},{},{}\n", row["pf1_Pa"], row["pf2_Pa"], row["VP1"]);
    }
    dir.write("b.csv", second);
    for named in ["", "--photodiode VP1=1 --photodiode VP2=2"] {
        let answer = run(&dir, "fit", &format!("a.csv b.csv {named} --free none --out f.json --no-figures")).expect(0);
        answer.says("b.csv: lacks VP2, which other recordings have").says("fitted without");
    }
}

#[test]
fn words_name_subjects_and_constant_photodiodes_and_every_wrong_name_once() {
    let dir = Dir::new();
    run(&dir, "simulate", "--static 0..9000/500 --out s.csv --no-figures").expect(0);
    let mut flat = "pf1_Pa,pf2_Pa,VP1,VP2\n".to_owned();
    for row in dir.table("s.csv") {
        flat += &format!("{},{},0.9,{}\n", row["pf1_Pa"], row["pf2_Pa"], row["VP2"]);
    }
    dir.write("flat.csv", flat);
    let answer = run(&dir, "fit", "s.csv flat.csv --subject anna,ben --free none --out f.json --no-figures").expect(0);
    let words = answer.stdout.clone() + &answer.stderr;
    assert!(words.contains("flat.csv: VP1 is constant: it determines nothing, and is left out"), "{words}");
    assert!(!words.contains("VP2 is constant") && words.contains("unit 1 of anna") && words.contains("unit 2 of ben"));
    let wrong = run(&dir, "fit", "s.csv --free k_Q,zz --out g.json").expect(2).stderr;
    assert!(wrong.contains("--free k_Q,zz") && wrong.matches("k_C, k_V").count() == 1, "{wrong}");
}

#[test]
fn a_constant_photodiode_changes_nothing_of_the_fit_of_the_others() {
    let dir = Dir::new();
    run(&dir, "simulate", "--static 0..9000/500 --out s.csv --no-figures").expect(0);
    let rows = dir.table("s.csv");
    // Another unit's photodiode is stuck; the other one has noise of up to 2 mV.
    let write = |file: &str, constant: Option<f64>| {
        let mut csv = "pf1_Pa,pf2_Pa,VP1,VP2\n".to_owned();
        for (k, row) in rows.iter().enumerate() {
            let first = number(row, "VP1") + 4e-3 * ((k * k * 7 + 3 * k) % 11) as f64 / 10.0 - 2e-3;
            let second = constant.map_or(row["VP2"].clone(), |value| value.to_string());
            csv += &format!("{},{},{first},{second}\n", row["pf1_Pa"], row["pf2_Pa"]);
        }
        dir.write(file, csv);
    };
    write("good.csv", None);
    let fit = |options: &str| {
        let answer = run(&dir, "fit", &format!("{options} --free k_C,b_C --out f.json --no-figures"));
        (answer.expect(0), std::fs::read(dir.path("f-estimates.csv")).unwrap(), dir.parsed("f.json")["r2"].clone())
    };
    let (_, alone, r2) = fit("good.csv --photodiode VP1=1");
    for constant in [0.0, 0.7, 3.3] {
        write("stuck.csv", Some(constant));
        let (answer, estimates, stuck_r2) = fit("stuck.csv");
        answer.says("VP2 is constant: it determines nothing, and is left out");
        assert_eq!((estimates, stuck_r2), (alone.clone(), r2.clone()), "{constant} V");
    }
    // In one of two recordings alone, the other one's is used.
    let (answer, two, _) = fit("good.csv stuck.csv");
    answer.says("stuck.csv: VP2 is constant");
    assert_ne!(two, alone);
}

/// A recorded response as a log with an LED that goes on and off: unlit rows hold the room's light alone. Rows of this
/// remainder by two are lit.
fn modulated(dir: &Dir, header: &str, lit_from: usize) -> String {
    let mut log = header.to_owned() + "\n";
    for (k, row) in dir.table("r.csv").iter().enumerate() {
        let (time_s, lit) = (number(row, "time_s"), k % 2 == lit_from);
        let room = 0.3 + 0.05 * time_s.sin();
        let [first, second] =
            ["VP1", "VP2"].map(|name| if lit { number(row, name) + room } else { room }).map(|value| value.to_string());
        let loads = format!("{},{}", row["pf1_Pa"], row["pf2_Pa"]);
        log += &format!("{},{},{loads},{first},{second}\n", 1000.0 + time_s, u8::from(lit));
    }
    log
}

fn ramps(dir: &Dir) {
    dir.write("ramps.csv", "time_s,pf1_Pa,pf2_Pa\n0,0,0\n0.1,6000,0\n1.5,6000,5000\n2,6000,5000\n2.1,0,0\n");
    let options =
        "--loads ramps.csv --set k_V_N_per_m=1500 --every 0.02 --rtol 1e-9 --with-loads --out r.csv --no-figures";
    run(dir, "simulate", options).expect(0);
}

#[test]
fn a_log_with_an_led_is_fitted_to_the_leds_own_light() {
    // The room's light is interpolated: measured 0.999 99. With unlit rows taken for light it is below 0.1.
    const R2: f64 = 0.999;
    // Measured: 5e-5; 8e-3 where one unlit row has a wrong time.
    const STIFFNESS: f64 = 5e-4;
    const MISTIMED: f64 = 0.02;
    const HEADER: &str = "time_s,led,pf1_Pa,pf2_Pa,P1,P2";
    let dir = Dir::new();
    ramps(&dir);
    dir.write("log.csv", modulated(&dir, HEADER, 0));
    let options = "--free k_V --photodiode P1=1 --photodiode P2=2 --no-figures --json";
    let answer = run(&dir, "fit", &format!("log.csv {options} --out f.json")).expect(0);
    let report = answer.json();
    assert!(report["r2"].number() > R2, "{}", report["r2"]);
    // The loads turn at unlit rows: with lit rows' loads alone it is 1797.
    let stiffness = |report: &serde_json::Value| report["free"][0]["values"][0].number();
    assert!((stiffness(&report) / 1500.0 - 1.0).abs() <= STIFFNESS, "{}", stiffness(&report));
    answer.says("interpolated between the unlit samples");
    // The first and the last lit row have no unlit one on one side.
    assert!(report["recordings"][0]["faults"].as_u64().unwrap() > 0, "{report}");
    // Under other names, as `align` takes them.
    dir.write("other.csv", modulated(&dir, "t,lamp,near,far,a,b", 0));
    let columns = "--columns time_s=t,led=lamp,pf1_Pa=near,pf2_Pa=far,P1=a,P2=b";
    let named = run(&dir, "fit", &format!("other.csv {columns} {options} --out g.json")).expect(0).json();
    assert_eq!((&named["r2"], &named["free"]), (&report["r2"], &report["free"]));
    // A column that isn't known for the LED's.
    dir.write("lamp.csv", modulated(&dir, "time_s,lamp,pf1_Pa,pf2_Pa,P1,P2", 0));
    let lamp = run(&dir, "fit", &format!("lamp.csv {options} --out l.json")).expect(0).json();
    let said = lamp["warnings"].to_string();
    assert!(said.contains("lamp.csv: P1, P2 go up and down from row to row"), "{said}");
    assert!(!report["warnings"].to_string().contains("go up and down"), "{report}");
    // An unlit row is the first one.
    dir.write("dark.csv", modulated(&dir, HEADER, 1));
    let dark = run(&dir, "fit", &format!("dark.csv {options} --out d.json")).expect(0).json();
    assert!((stiffness(&dark) / 1500.0 - 1.0).abs() <= STIFFNESS, "{}", stiffness(&dark));
    assert_eq!(dark["recordings"][0]["samples"].as_u64(), report["recordings"][0]["samples"].as_u64());
    // Unlit rows without a load, or of a lit row's time, are no fault.
    let log = modulated(&dir, HEADER, 0);
    let mut few = HEADER.to_owned() + "\n";
    let mut lit_at = "";
    for (k, row) in log.lines().skip(1).enumerate() {
        let mut cells: Vec<&str> = row.split(',').collect();
        match k {
            60 => lit_at = cells[0],
            51 => cells[2] = "",
            61 => cells[0] = lit_at,
            _ => {}
        }
        few += &(cells.join(",") + "\n");
    }
    dir.write("few.csv", few);
    let few = run(&dir, "fit", &format!("few.csv {options} --out w.json")).expect(0).json();
    assert!((stiffness(&few) / 1500.0 - 1.0).abs() <= MISTIMED, "{}", stiffness(&few));
}

#[test]
fn steps_that_jump_at_unlit_rows_are_found() {
    // Measured: 1e-5.
    const STIFFNESS: f64 = 5e-4;
    let dir = Dir::new();
    run(&dir, "simulate", &format!("--set k_V_N_per_m=1500 {STEPS_AT_ODD_ROWS} --out r.csv")).expect(0);
    for lit_from in [0, 1] {
        dir.write("log.csv", modulated(&dir, "time_s,led,pf1_Pa,pf2_Pa,P1,P2", lit_from));
        let options =
            "--free k_V --photodiode P1=1 --photodiode P2=2 --between held --unloaded-before --no-figures --json";
        let report = run(&dir, "fit", &format!("log.csv {options} --out f.json")).expect(0).json();
        let stiffness = report["free"][0]["values"][0].number();
        assert!((stiffness / 1500.0 - 1.0).abs() <= STIFFNESS, "{lit_from} {stiffness}");
    }
}

#[test]
fn the_loads_of_a_log_are_those_of_all_its_rows() {
    let dir = Dir::new();
    ramps(&dir);
    let log = modulated(&dir, "time_s,led,pf1_Pa,pf2_Pa,P1,P2", 0);
    let log = log.replace("\n1000", "\n0").replace("\n100", "\n");
    dir.write("log.csv", &log);
    dir.write("table.csv", log.replace("led,", "x,"));
    for name in ["log", "table"] {
        run(&dir, "simulate", &format!("--loads {name}.csv --until 2 --out {name}-t.csv --no-figures")).expect(0);
    }
    assert_eq!(std::fs::read(dir.path("log-t.csv")).unwrap(), std::fs::read(dir.path("table-t.csv")).unwrap());
}

#[test]
fn rows_with_a_fault_of_the_sensor_have_no_voltage() {
    let dir = Dir::new();
    ramps(&dir);
    let mut set = "time_s,pf1_Pa,pf2_Pa,VP1,VP2,sensor_status\n".to_owned();
    for (k, row) in dir.table("r.csv").iter().enumerate() {
        let (first, status) = match k % 10 {
            3 => ("10", "saturated: VP1"),
            4 => (row["VP1"].as_str(), "loose"),
            _ => (row["VP1"].as_str(), "ok"),
        };
        set += &format!("{},{},{},{first},{},{status}\n", row["time_s"], row["pf1_Pa"], row["pf2_Pa"], row["VP2"]);
    }
    dir.write("set.csv", set);
    let report = run(&dir, "fit", "set.csv --free k_V --out f.json --no-figures --json").expect(0).json();
    assert!(report["r2"].number() > 0.999_999, "{}", report["r2"]);
    assert_eq!((&report["recordings"][0]["faults"], &report["recordings"][0]["missing"]), (&20.into(), &0.into()));
    assert!(report["warnings"][0].words().contains("does not know in 20 rows, first `loose`"), "{report}");
}

/// A slow, uneven press and the response to it, a hundred rows a second.
fn pressed(dir: &Dir) -> Vec<[f64; 5]> {
    let mut loads = "time_s,pf1_Pa,pf2_Pa\n".to_owned();
    for k in 0..=300 {
        let t_s = 0.01 * f64::from(k);
        let load = 3000.0 * (1.0 - (2.1 * t_s).cos()) + 600.0 * (1.0 - (7.0 * t_s).cos());
        loads += &format!("{t_s},{load},{}\n", 0.8 * load);
    }
    dir.write("loads.csv", loads);
    let options = "--loads loads.csv --set k_V_N_per_m=1500 --every 0.01 --with-loads --out r.csv --no-figures";
    run(dir, "simulate", options).expect(0);
    let names = ["time_s", "pf1_Pa", "pf2_Pa", "VP1", "VP2"];
    dir.table("r.csv").iter().map(|row| names.map(|name| number(row, name))).collect()
}

#[test]
fn a_lost_time_and_what_a_slower_or_saturated_device_measured_are_warned_of() {
    let dir = Dir::new();
    let rows = pressed(&dir);
    let said = |head: &str, change: &dyn Fn(usize, [f64; 5]) -> [f64; 5]| {
        let mut text = head.to_owned() + "\n";
        for (k, row) in rows.iter().enumerate() {
            text += &(change(k, *row).map(|value| value.to_string()).join(",") + "\n");
        }
        dir.write("set.csv", text);
        run(&dir, "fit", "set.csv --free k_V --out f.json --no-figures").expect(0)
    };
    let head = "time_s,pf1_Pa,pf2_Pa,VP1,VP2";
    let plain = said(head, &|_, row| row);
    plain.never_says("is it the time").never_says("of a slower device").never_says("cut off");
    said(&head.replace("time_s", "stamp"), &|_, row| row).says("the column `stamp` grows evenly").says("equilibria");
    let held = |k: usize, row: [f64; 5]| {
        let [_, first, second, ..] = rows[k / 10 * 10];
        [row[0], first, second, row[3], row[4]]
    };
    let slow = said(head, &held).says("pf1_Pa stays for 10 rows, 0.1 s, and jumps").says("pf2_Pa stays for 10 rows");
    slow.never_says("cut off");
    let [least, most] =
        rows.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], row| [low.min(row[4]), high.max(row[4])]);
    let top = least + 0.7 * (most - least);
    said(head, &|_, row| [row[0], row[1], row[2], row[3], row[4].min(top)])
        .says("VP2 stays at exactly")
        .says("cut off");
}

#[test]
fn the_result_is_the_same_bytes_wherever_and_whenever() {
    let dir = Dir::new();
    ramps(&dir);
    std::fs::create_dir(dir.path("day")).unwrap();
    std::fs::copy(dir.path("r.csv"), dir.path("day/r.csv")).unwrap();
    let here = run(&dir, "fit", "r.csv --free k_V --out f.json").expect(0);
    run(&dir, "fit", "day/r.csv --free k_V --out day/g.json").expect(0);
    let result = |name: &str| dir.text(name);
    assert_eq!(result("f.json"), result("day/g.json"));
    assert!(!result("f.json").contains("wall_s") && result("f.run.json").contains("wall_s"), "{}", here.stdout);
}
