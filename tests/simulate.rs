//! `lunula simulate`: the table is the model's response, collapse ends it with a word, bad requests are refused whole.

use crate::util::{Answer, Dir, Json, number};

fn run(dir: &Dir, options: &str) -> Answer {
    dir.words(&format!("simulate {options}"))
}

/// Displacements of the walls at rest, m, with ten digits (facts: unloaded, they stand further out than x = 0).
const REST_M: [(&str, f64); 3] = [("xC1_m", 9.273971e-6), ("xC2_m", 9.273971e-6), ("xV_m", 1.076_925e-4)];
/// Half a step of the last digit.
const DIGITS: f64 = 1e-7;
const WALLS: [&str; 3] = ["xC1_m", "xC2_m", "xV_m"];

#[test]
fn a_step_begins_at_rest_and_its_rows_stand_at_multiples() {
    let dir = Dir::new();
    let report = run(&dir, "--pf1 step:5000@0..2 --out t.csv --json").expect(0).json();
    let header = dir.text("t.csv");
    assert_eq!(header.lines().next(), Some("time_s,xC1_m,xC2_m,xV_m,vC1_mps,vC2_mps,vV_mps,VP1,VP2"));
    let rows = dir.table("t.csv");
    assert_eq!((rows.len(), report["rows"].as_u64()), (401, Some(401)));
    for (k, row) in rows.iter().enumerate() {
        let decimal: f64 = format!("{}.{:02}", k / 100, k % 100).parse().unwrap();
        assert!(number(row, "time_s") == decimal, "{k}: {}", row["time_s"]);
    }
    for (column, rest_m) in REST_M {
        assert!((number(&rows[0], column) / rest_m - 1.0).abs() <= DIGITS, "{column}");
    }
    // Pressed on the vein, it narrows and the capillaries swell: less light (Fig. 76).
    assert!(number(&rows[199], "xV_m") < number(&rows[0], "xV_m"));
    assert!(number(&rows[199], "xC1_m") > number(&rows[0], "xC1_m"));
    assert!(number(&rows[199], "VP1") < number(&rows[0], "VP1"));
    assert_eq!(dir.names_of("."), ["t-response.png", "t-response.svg", "t.csv", "t.run.json"]);
}

#[test]
fn a_file_of_loads_is_the_load_that_it_holds() {
    // Both are solved to 1e-10 D, and D is 1e-5 and 1e-4 m: measured 0 and, of a thousand rows, 1.6e-14.
    const NEAR_M: f64 = 2e-14;
    let dir = Dir::new();
    dir.write("few.csv", "time_s,pf1_Pa,pf2_Pa\n0,0,0\n1,4000,2000\n3,4000,2000\n");
    let rows = (0..=1000).map(f64::from).map(|k| format!("{},{},{},10000\n", k / 250.0, 8.0 * k, 2.0 * k));
    dir.write("thousand.csv", format!("time_s,pf1_Pa,pf2_Pa,ph_Pa\n{}", rows.collect::<String>()));
    for (file, until_s, loads) in [
        ("few.csv", 3, "--pf1 ramp:0..4000@0..1 --pf2 ramp:0..2000@0..1"),
        ("thousand.csv", 4, "--pf1 ramp:0..8000@0..4 --pf2 ramp:0..2000@0..4"),
    ] {
        let usual = format!("--until {until_s} --every 0.05 --rtol 1e-10 --no-figures");
        run(&dir, &format!("--loads {file} {usual} --out a.csv")).expect(0);
        run(&dir, &format!("{loads} {usual} --out b.csv")).expect(0);
        let (a, b) = (dir.table("a.csv"), dir.table("b.csv"));
        assert_eq!((a.len(), b.len()), (20 * until_s + 1, a.len()), "{file}");
        for (a, b) in a.iter().zip(&b) {
            for column in WALLS {
                let gap = (number(a, column) - number(b, column)).abs();
                assert!(gap <= NEAR_M, "{file}: {column} at {}: {gap}", a["time_s"]);
            }
        }
    }
}

#[test]
fn loads_that_never_act_or_suck_are_named() {
    let dir = Dir::new();
    let said = |options: &str| run(&dir, &format!("{options} --every 0.1 --out t.csv --no-figures")).expect(0);
    const CONSTANT: &str = "and the run goes from 0 to 2 s: the load is constant all the time";
    for (load, when) in [
        ("--pf1 step:5000@3..9", "has loads from 3 to 9 s"),
        ("--pf2 ramp:0..5000@2..3", "has loads from 2 to 3 s"),
        ("--ph step:12000@-3..-1", "has loads from -3 to -1 s"),
    ] {
        said(&format!("{load} --until 2")).says(&format!("{load}: {when}, {CONSTANT}"));
    }
    dir.write("late.csv", "time_s,pf1_Pa,pf2_Pa,ph_pa\n3,0,0,9000\n4,5000,0,9000\n");
    let late = said("--loads late.csv --until 2");
    late.says(&format!("late.csv: has loads from 3 to 4 s, {CONSTANT}"))
        .says("late.csv: the column `ph_pa` is not used; did you mean `ph_Pa`?");
    // Suction, by each way to give a load.
    dir.write("suck.csv", "time_s,pf1_Pa,pf2_Pa\n0,0,0\n0.55,-2000,1000\n1,0,1000\n");
    said("--pf1 step:-2000@0.55..0.58 --until 2")
        .says("--pf1 step:-2000@0.55..0.58 goes below 0: pressing is positive");
    said("--pf2 sine:0+100@1 --until 2").says("--pf2 sine:0+100@1 goes below 0");
    said("--loads suck.csv --until 2").says("suck.csv: pf1_Pa goes below 0");
    // Pressures in kPa: both, one of them, those of a table, those at rest.
    said("--pf1 step:5@1..9 --until 2").says("no pressure of --pf1 is greater than 5 Pa, which hardly presses");
    said("--pf1 step:5000@1..9 --pf2 0.5 --until 2")
        .says("no pressure of --pf2 is greater than 0.5 Pa")
        .never_says("--pf1");
    dir.write("kpa.csv", "time_s,pf1_Pa,pf2_Pa\n0,0,0\n0.5,5,0\n1,0,0\n");
    said("--loads kpa.csv --until 2").says("kpa.csv: no pressure of pf1_Pa and pf2_Pa is greater than 5 Pa");
    dir.write("one.csv", "time_s,pf1_Pa,pf2_Pa\n0,0,0\n0.5,5000,3\n1,0,0\n");
    said("--loads one.csv --until 2")
        .says("one.csv: no pressure of pf2_Pa is greater than 3 Pa, and the other reaches");
    dir.write("little.csv", "time_s,pf1_Pa,pf2_Pa\n0,0,0\n0.5,5000,100\n1,0,0\n");
    said("--loads little.csv --until 2").never_says("no pressure of");
    // Rows that miss what presses, and what pulsates.
    said("--ph sine:10000+2000@5 --pf1 step:5000@0.12..0.18 --until 2")
        .says("--ph sine:10000+2000@5: repeats every 0.2000 s, and rows are 0.1 s apart")
        .says("--pf1 step:5000@0.12..0.18: begins and ends between two rows");
    said("--ph sine:10000+2000@1.2 --pf1 step:5000@0.12..1 --until 2").never_says("smaller --every");
    run(&dir, "--static 0..9/3 --out s.csv --no-figures")
        .expect(0)
        .says("no pressure of --static is greater than 9 Pa");
    // Beats a minute, and a stiffness in N/mm.
    said("--ph sine:10000+2000@72 --until 2").says("repeats 72 times a second").says("They are @1.200");
    said("--pf1 step:5000@1..9 --set k_C1_N_per_m=100 --until 2").says("times its nominal diameter: is a stiffness");
    // A logger's table with a hole, in milliseconds, and one that ends while it presses.
    let table = |name: &str, unit: f64, holds: &dyn Fn(u32) -> bool| {
        let rows = (0..200).filter(|k| holds(*k)).map(|k| format!("{},{},0\n", f64::from(k) * 0.01 * unit, 20 * k));
        dir.write(name, format!("time_s,pf1_Pa,pf2_Pa\n{}", rows.collect::<String>()));
    };
    table("hole.csv", 1.0, &|k| !(50..120).contains(&k));
    said("--loads hole.csv --until 2").says("hole.csv: rows come every 0.01 s, and none is between 0.49 and 1.2 s");
    table("ms.csv", 1000.0, &|_| true);
    said("--loads ms.csv --until 2").says("ms.csv: rows are 10 s apart, if the stamps are in seconds");
    table("whole.csv", 1.0, &|_| true);
    let whole = said("--loads whole.csv --until 3").says("ends at 1.99 s with 3980 and 0 Pa, which press on");
    whole.never_says("rows ");
    run(&dir, "--static -500..0/100 --out s.csv --no-figures").expect(0).says("loads begin at -500 Pa: pressing is");
    for fine in [
        "--pf1 step:5000@1..9 --pf2 sine:1000+1000@1",
        "--ph sine:10000+2000@1.2 --pf1 step:5000@1..9",
        "--pf1 step:5000@-1..0",
        "--pf1 ramp:5000..0@0..1",
    ] {
        let answer = said(&format!("{fine} --until 2"));
        assert!(
            !["constant", "below 0", "times", "hardly"].iter().any(|word| answer.stderr.contains(word)),
            "{}",
            answer.stderr
        );
    }
}

#[test]
fn faults_of_a_load_file_name_row_and_column() {
    let dir = Dir::new();
    dir.write("bad.csv", "time_s,pf1_Pa,pf2_Pa\n0,0,0\n1,nan,0\n0.5,3,\n0.5,inf,soft\n");
    run(&dir, "--loads bad.csv --out t.csv").refuses(&[
        "bad.csv:3: column `pf1_Pa`: `NaN` is no finite number",
        "bad.csv:4: column `time_s`: 0.5 s comes after 1 s",
        "bad.csv:4: column `pf2_Pa`: is empty",
        "bad.csv:5: column `time_s`: 0.5 s comes after 0.5 s",
        "bad.csv:5: column `pf1_Pa`: `inf` is no finite number",
        "bad.csv:5: column `pf2_Pa`: `soft` is no number",
    ]);
    dir.write("columns.csv", "time_s,force\n0,0\n");
    run(&dir, "--loads columns.csv --out t.csv").expect(2).says("`pf1_Pa`, `pf2_Pa`");
    dir.write("none.csv", "time_s,pf1_Pa,pf2_Pa\n");
    run(&dir, "--loads none.csv --out t.csv").expect(2).says("no rows");
    run(&dir, "--loads nowhere.csv --out t.csv").expect(2).says("nowhere.csv");
    assert!(!dir.path("t.csv").exists());
    dir.write("loads.csv", "time_s,pf1_Pa,pf2_Pa\n0,0,0\n1,10,10\n");
    run(&dir, "--loads loads.csv --out loads.csv").expect(2).says("is an input itself");
}

#[test]
fn a_vessel_that_closes_is_an_error_with_its_time_and_nothing_is_written() {
    // The lumen crosses zero at 0.388736 s and 0.078334 s (six digits of independent solvers): measured 3.1e-7.
    const SIX_DIGITS_S: f64 = 5e-7;
    let dir = Dir::new();
    for (load, time_s) in [("1.2e4", 0.388_736), ("2e4", 0.078_334)] {
        let answer = run(&dir, &format!("--pf1 step:{load}@0..2 --out t.csv")).expect(2);
        let said = &answer.stderr;
        assert!(said.contains('V') && said.contains("--collapse contact"), "{said}");
        let digits =
            said.split_whitespace().find_map(|word| word.trim_end_matches([';', ':', ',']).parse::<f64>().ok());
        let shown = digits.expect("a time");
        assert!((shown - time_s).abs() <= SIX_DIGITS_S, "{said}");
        assert_eq!(dir.bytes_of(".").len(), 0);
    }
    let answer = run(&dir, "--pf1 step:1.2e4@0..2 --out t.csv --keep-partial --json").expect(1);
    let report = answer.json();
    assert_eq!(report["collapsed"]["vessel"], "V");
    assert_eq!(report["failed"].as_array().map(Vec::len), Some(1));
    let rows = dir.table("t.csv");
    assert_eq!((rows.len(), rows[38]["time_s"].as_str()), (39, "0.38"));
    run(&dir, "--pf1 step:1.2e4@0..2 --collapse contact --out c.csv").expect(0);
    let open = dir.table("c.csv").iter().all(|row| number(row, "xV_m") > -1e-4);
    assert!(open, "no vessel is closed");
}

#[test]
fn a_run_goes_on_from_another_and_from_zero() {
    // Both are solved to 1e-10 D: measured 1.9e-16.
    const NEAR_M: f64 = 2e-14;
    let dir = Dir::new();
    run(&dir, "--pf1 step:5000@0..9 --until 2 --rtol 1e-10 --out whole.csv --no-figures").expect(0);
    run(&dir, "--pf1 step:5000@0..9 --until 1 --rtol 1e-10 --out first.csv --no-figures").expect(0);
    run(&dir, "--pf1 5000 --from first.csv --until 1 --rtol 1e-10 --out second.csv --no-figures").expect(0);
    let (whole, second) = (dir.table("whole.csv"), dir.table("second.csv"));
    for (k, row) in second.iter().enumerate() {
        let gap = (number(row, "xV_m") - number(&whole[100 + k], "xV_m")).abs();
        assert!(gap <= NEAR_M, "{k}: {gap}");
    }
    run(&dir, "--from zero --until 0 --out zero.csv --no-figures").expect(0);
    let zero = dir.table("zero.csv");
    assert_eq!(zero.len(), 1);
    assert!(["xC1_m", "xV_m", "vC1_mps", "vV_mps"].iter().all(|column| number(&zero[0], column) == 0.0));
    dir.write("closed.csv", "xC1_m,xC2_m,xV_m,vC1_mps,vC2_mps,vV_mps\n0,0,-2e-4,0,0,0\n");
    run(&dir, "--from closed.csv --out t.csv").expect(2).says("V is closed");
    run(&dir, "--from first.csv --units 3 --out t.csv").expect(2).says("`xC3_m`");
}

#[test]
fn parameters_are_printed_read_and_set_and_all_faults_reported() {
    let dir = Dir::new();
    let printed = run(&dir, "--print-params --units 3").expect(0).stdout;
    assert!(printed.contains("units = 3\n") && printed.contains("k_C3_N_per_m = 6.66"), "{printed}");
    dir.write("p.toml", &printed);
    run(&dir, "--pf2 step:3000@0..1 --params p.toml --until 1 --out three.csv --no-figures").expect(0);
    assert!(dir.table("three.csv")[0].contains_key("VP3"));
    run(&dir, "--params p.toml --units 2 --out t.csv").expect(2).says("--units 2");
    dir.write("bad.toml", "base = \"thesis\"\nk_C1_N_per_m = -1\n");
    run(&dir, "--params bad.toml --out t.csv").refuses(&["bad.toml", "k_C1_N_per_m = -1"]);
    let set = run(&dir, "--print-params --set k_V_N_per_m=500").expect(0).stdout;
    assert!(set.contains("k_V_N_per_m = 5e2\n"), "{set}");
    run(&dir, "--set k_V_N_per_m=-5 --set m_V_kg=0 --out t.csv").expect(2).says("k_V_N_per_m = -5").says("m_V_kg = 0");
    run(&dir, "--set speed=3 --out t.csv").expect(2).says("no parameter speed");
    let twice = "--set k_V_N_per_m=500 --set m_V_kg=1e-3 --set k_V_N_per_m=600 --set k_V_N_per_m=500 --out t.csv";
    let answer = run(&dir, twice).expect(2);
    assert_eq!(answer.stderr.matches("is given twice").count(), 1, "{}", answer.stderr);
    answer.says("`k_V_N_per_m` is given twice");
}

#[test]
fn equilibria_are_listed_for_every_load_and_none_where_there_is_none() {
    let dir = Dir::new();
    let report = run(&dir, "--static 0..12000/100 --load proximal --out s.csv --json").expect(0).json();
    let rows = dir.table("s.csv");
    assert_eq!((rows.len(), report["loads"].as_u64()), (121, Some(121)));
    for (column, rest_m) in REST_M {
        assert!((number(&rows[0], column) / rest_m - 1.0).abs() <= DIGITS, "{column}");
    }
    for row in &rows {
        // From 1.1e4 Pa on, no equilibrium has open vessels.
        if number(row, "pf1_Pa") < 1.1e4 - 100.0 {
            assert!(number(row, "stable") == 1.0 && row["why"].is_empty() && number(row, "xV_m") > -1e-4);
        } else if number(row, "pf1_Pa") >= 1.1e4 {
            assert!(["xC1_m", "xV_m", "VP1", "stable", "branch"].iter().all(|column| row[*column].is_empty()));
            assert_eq!(row["why"], "no equilibrium with open vessels");
        }
        assert!(number(row, "pf2_Pa") == 0.0);
    }
    assert!(dir.path("s-static.png").is_file() && dir.path("s.run.json").is_file());
    let report =
        run(&dir, "--static 0..12000/100 --load proximal --collapse contact --out c.csv --json").expect(0).json();
    assert_eq!((report["with_one"].as_u64(), report["with_none"].as_u64()), (Some(121), Some(0)));
}

#[test]
fn several_equilibria_at_a_load_are_rows_of_their_own() {
    let dir = Dir::new();
    let set = "--set k_C1_N_per_m=5e4 --set k_C2_N_per_m=5e4";
    let report = run(&dir, &format!("--static 0..10000/100 --load distal {set} --out s.csv --json")).expect(0).json();
    let several = report["with_several"].as_u64().unwrap();
    assert!(several > 0 && !report["bistable_pa"].list().is_empty(), "{report}");
    let folds = report["folds"].list().iter().filter(|fold| fold["what"] == "fold").count();
    assert_eq!(folds, 2);
    let rows = dir.table("s.csv");
    assert!(rows.iter().any(|row| row["stable"] == "0"), "an unstable one between them");
    assert_eq!(rows.len() as u64, report["rows"].as_u64().unwrap());
}

#[test]
fn bad_requests_are_refused_whole() {
    let dir = Dir::new();
    for (options, words) in [
        ("--pf1 1 --every 0 --until -1 --rtol 2 --out t.csv", "--until -1"),
        ("--pf1 1 --every 0 --until -1 --rtol 2 --out t.csv", "--every 0"),
        ("--pf1 1 --every 0 --until -1 --rtol 2 --out t.csv", "--rtol 2"),
        ("--pf1 1 --until 1e9 --every 1e-6 --out t.csv", "rows"),
        ("--pf1 1 --until inf --out t.csv", "--until inf"),
        ("--pf1 step:5000 --out t.csv", "step:5000@0..2"),
        ("--pf1 step:5000@2..0 --out t.csv", "grow"),
        ("--pf1 nan --out t.csv", "finite"),
        ("--pf1 1 --loads l.csv --out t.csv", "--loads"),
        ("--static 0..1e9/1 --out t.csv", "more than"),
        ("--static 0..100/10 --until 3 --out t.csv", "--until"),
        ("--static 0..100/10 --ph sine:10000+1000@1 --out t.csv", "--ph"),
        ("--load distal --pf1 1 --out t.csv", "--static"),
        ("--pf1 1 --out t.txt", ".csv or .parquet"),
        ("--pf1 1 --units 0 --out t.csv", "--units"),
        ("--pf1 1", "--out"),
        ("--pf1 1 --params no.toml --out t.csv", "no.toml"),
    ] {
        run(&dir, options).expect(2).says(words);
    }
    dir.write("in-the-way", "a file");
    run(&dir, "--pf1 1 --out in-the-way/t.csv").expect(2).says("in-the-way");
    assert_eq!(dir.names_of("."), ["in-the-way"]);
}

/// What a table of other programs begins with.
const PEER_COLUMNS: &str =
    "stage,choice,scene,setting,error,error_unit,run_s,run_low_s,run_high_s,repeats,work,machine,version,date";

#[test]
fn the_tradeoff_keeps_every_tolerance_and_draws_peers() {
    let dir = Dir::new();
    let row = |scene: &str, setting: &str| {
        let unit = "\"largest |x - x_ref| / D over 20 step responses, full model\"";
        format!("hemodynamics,solving,{scene},{setting},1e-3,{unit},1e-4,,,,,a laptop,2.0,2026-11-22\n")
    };
    let rows = [row("20 step responses", "\"Other (C), 1e-3\""), row("others", "\"Far (C), 1e-3\"")].concat();
    dir.write("peers.csv", format!("{PEER_COLUMNS}\n{rows}"));
    let done = dir.words("tradeoff hemodynamics --repeats 1 --peers peers.csv --out t --json").expect(0);
    let peers = &done.json()["peers"];
    assert_eq!([&peers[0]["peer"], &peers[1]["peer"]], ["Other (C)", "Far (C)"], "{peers}");
    assert_eq!([&peers[0]["measured"], &peers[1]["measured"]], [true, false], "{peers}");
    assert!(peers[1]["what"].as_str().unwrap().contains("another scene (others)"), "{peers}");
    let rows = dir.table("t/tradeoff.csv");
    let mut kept = 0;
    for row in &rows {
        let Some(rtol) = row["setting"].strip_prefix("lunula, ") else { continue };
        let rtol: f64 = rtol.parse().unwrap();
        assert!(number(row, "error") <= rtol, "{}: {}", row["setting"], row["error"]);
        kept += 1;
    }
    assert_eq!(kept, 10);
    for series in ["full, order 5", "full, order 13", "printed form", "Other (C)"] {
        assert!(rows.iter().any(|row| row["setting"].starts_with(series)), "{series}");
    }
    assert_eq!(dir.names_of("t"), ["tradeoff.csv", "tradeoff.png", "tradeoff.svg"]);
    let default: Vec<&str> =
        rows.iter().filter(|row| row["default"] == "true").map(|row| row["setting"].as_str()).collect();
    assert_eq!(default, ["lunula, 1e-8"]);
    assert_eq!(rows.iter().filter(|row| row["knee"] == "true").count(), 1);
    assert!(rows.iter().all(|row| (row["peer"] == "true") == row["setting"].starts_with("Other")));
    dir.write("bad.csv", format!("{PEER_COLUMNS}\n{}", row("a", "b").replacen("hemodynamics", "hemodynamic", 1)));
    for job in ["hemodynamics", "all"] {
        let answer = dir.lunula(&["tradeoff", job, "--peers", "bad.csv", "--out", "u"]).expect(2);
        let named = answer.stderr.contains("bad.csv:2: column `stage`") && answer.stderr.contains("`hemodynamics`?");
        assert!(named && !dir.path("u").exists(), "{}", answer.stderr);
    }
}

fn column(dir: &Dir, table: &str, name: &str) -> Vec<f64> {
    dir.table(table).iter().map(|row| number(row, name)).collect()
}

fn worst(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, |worst, gap| if gap <= worst { worst } else { gap })
}

#[test]
fn a_pulse_of_the_blood_goes_through_the_capillaries() {
    // Six seconds are fifty time constants: what is left is within the solver's tolerance, 1e-8 of 1e-5 m; measured
    // 1.8e-14.
    const PERIODIC_M: f64 = 1e-13;
    let dir = Dir::new();
    run(&dir, "--ph sine:10000+2000@1 --until 8 --with-loads --out p.csv --no-figures").expect(0);
    let (x, light) = (column(&dir, "p.csv", "xC1_m"), column(&dir, "p.csv", "VP1"));
    let pressure = column(&dir, "p.csv", "ph_Pa");
    assert_eq!((x.len(), pressure[25]), (801, 12_000.0));
    let gap = worst(&x[600..700], &x[700..800]);
    assert!(gap <= PERIODIC_M, "{gap}");
    // More pressure swells the capillaries, which take more light; both lag the pressure, whose top is at 0.25 s.
    let top = (700..800).max_by(|&a, &b| x[a].total_cmp(&x[b])).unwrap();
    assert!((726..=750).contains(&top), "{top}");
    assert!(light[top] < light[top - 50] && x[top] - x[top - 50] > 1e-8, "{} {}", x[top], x[top - 50]);
    // A pulse of no height is none.
    run(&dir, "--ph sine:10000+0@1 --pf1 step:5000@0..1 --until 2 --out flat.csv --no-figures").expect(0);
    run(&dir, "--pf1 step:5000@0..1 --until 2 --out plain.csv --no-figures").expect(0);
    for wall in WALLS {
        let gap = worst(&column(&dir, "flat.csv", wall), &column(&dir, "plain.csv", wall));
        assert!(gap <= PERIODIC_M, "{wall}: {gap}");
    }
}

#[test]
fn optics_are_chosen_and_the_tangent_touches_at_rest() {
    const DIGITS: f64 = 4e-15;
    let dir = Dir::new();
    for optics in ["beer-lambert", "quadratic", "linear"] {
        run(&dir, &format!("--pf2 step:8000@0..1 --until 2 --optics {optics} --out {optics}.csv --no-figures"))
            .expect(0);
    }
    let [exact, quadratic, linear] =
        ["beer-lambert.csv", "quadratic.csv", "linear.csv"].map(|table| column(&dir, table, "VP2"));
    // V_0 = 0 and V_1 = 1: absorption is alpha d^2.
    let printed: Vec<f64> = exact.iter().map(|light| 1.0 + light.ln()).collect();
    assert!(worst(&printed, &quadratic) <= DIGITS && worst(&exact, &quadratic) > 1e-3);
    // The run begins at rest, the working point.
    assert!((linear[0] - exact[0]).abs() <= DIGITS && worst(&exact, &linear) > 1e-3);
}
