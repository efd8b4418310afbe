//! `lunula skill`: presses of known times and impulses are measured to the digit, what is not known is not counted.

use std::fmt::Write as _;

use crate::util::{Answer, Dir, Json, number};

/// Rows a second, and sums of rounded rows.
const RATE_HZ: f64 = 100.0;
const NEAR: f64 = 1e-6;
/// The default thresholds.
const TOUCH_N: f64 = 0.2;
const RELEASE_N: f64 = 0.1;

fn run(dir: &Dir, options: &str) -> Answer {
    dir.words(&format!("skill {options}"))
}

/// A press: up in a tenth of a second, held, down in a fifth.
#[derive(Clone, Copy)]
struct Press {
    from_s: f64,
    held_s: f64,
    peak_n: f64,
}

const fn press(from_s: f64, held_s: f64, peak_n: f64) -> Press {
    Press { from_s, held_s, peak_n }
}

impl Press {
    fn at(&self, time_s: f64) -> f64 {
        let since_s = time_s - self.from_s;
        self.peak_n * (since_s / 0.1).min((0.3 + self.held_s - since_s) / 0.2).clamp(0.0, 1.0)
    }

    /// Time in contact and impulse, exact.
    fn exact(&self) -> [f64; 2] {
        let Self { held_s, peak_n, .. } = *self;
        let (up_s, down_s) = (0.1 * (1.0 - TOUCH_N / peak_n), 0.2 * (1.0 - RELEASE_N / peak_n));
        let impulse_ns = 0.5 * (peak_n + TOUCH_N) * up_s + peak_n * held_s + 0.5 * (peak_n + RELEASE_N) * down_s;
        [up_s + held_s + down_s, impulse_ns]
    }
}

fn exact(presses: &[Press]) -> [f64; 2] {
    [0, 1].map(|k| presses.iter().map(|press| press.exact()[k]).sum())
}

/// Forces of fingers, `seconds` long, from `start_s` on.
fn rows(start_s: f64, seconds: f64, fingers: &[&[Press]]) -> Vec<Vec<f64>> {
    let row = |k: usize| {
        let time_s = k as f64 / RATE_HZ;
        let force = |presses: &&[Press]| -presses.iter().map(|press| press.at(time_s)).sum::<f64>();
        std::iter::once(start_s + time_s).chain(fingers.iter().map(force)).collect()
    };
    (0..=(seconds * RATE_HZ) as usize).map(row).collect()
}

/// Four seconds of the index finger's presses, each row as `of` makes it of time and force.
fn altered(of: impl Fn(f64, f64) -> Vec<f64>) -> Vec<Vec<f64>> {
    rows(0.0, 4.0, &[&INDEX]).iter().map(|row| of(row[0], row[1])).collect()
}

/// NaN is an empty cell.
fn csv(names: &str, rows: &[Vec<f64>]) -> String {
    let mut text = format!("{names}\n");
    for row in rows {
        let cell = |value: &f64| if value.is_nan() { String::new() } else { format!("{value:?}") };
        let _ = writeln!(text, "{}", row.iter().map(cell).collect::<Vec<_>>().join(","));
    }
    text
}

const INDEX: [Press; 2] = [press(0.5, 0.4, 2.0), press(2.0, 0.3, 1.0)];
const MIDDLE: [Press; 1] = [press(1.2, 0.5, 1.5)];
const NAMES: &str = "time_s,index.Fz_N,middle.Fz_N";

#[test]
fn contacts_forces_and_order_are_those_of_the_presses() {
    let dir = Dir::new();
    dir.write("first.csv", csv(NAMES, &rows(100.0, 4.0, &[&INDEX, &MIDDLE])));
    let report = run(&dir, "first.csv --out o --json").expect(0).json();
    let trial = &report["trials"][0];
    assert_eq!((trial["trial"].words(), trial["first"].words()), ("first", "index"));
    assert!(trial["subject"].is_null() && report["over_people"].list().is_empty());
    for (k, presses) in [&INDEX[..], &MIDDLE].into_iter().enumerate() {
        let finger = &trial["fingers"][k];
        let near = |name: &str, exact: f64| {
            let found = finger[name].number();
            assert!((found - exact).abs() <= NEAR, "{name} of finger {k}: {found}, not {exact}");
        };
        let [contact_s, impulse_ns] = exact(presses);
        let peak_n = presses.iter().map(|press| press.peak_n).fold(0.0, f64::max);
        near("contact_s", contact_s);
        near("impulse_ns", impulse_ns);
        near("mean_n", impulse_ns / contact_s);
        near("peak_n", peak_n);
        near("peak_rise_n_per_s", peak_n / 0.1);
        near("onset_s", presses[0].from_s + 0.1 * TOUCH_N / presses[0].peak_n);
        near("known_s", 4.0);
        assert!(finger["presses"] == presses.len() && finger["cut"] == 0 && finger["rank"] == k + 1);
        assert!(finger["smoothness"].number() < -1.4 && finger["distance_n"].is_null());
    }
    let table = dir.table("o/skill.csv");
    assert_eq!((table.len(), table[1]["finger"].as_str(), table[1]["rank"].as_str()), (2, "middle", "2"));
    assert!((number(&table[0], "impulse_Ns") - exact(&INDEX)[1]).abs() <= NEAR && table[0]["distance_N"].is_empty());
    assert_eq!(
        dir.names_of("o"),
        [
            "run.json",
            "skill-summary.png",
            "skill-summary.svg",
            "skill-trial-01.png",
            "skill-trial-01.svg",
            "skill.csv",
            "skill.json"
        ]
    );
}

/// Trials of one person in one table: as many presses as the trial's number.
fn session(trials: &[u32], peak_n: f64) -> String {
    let mut text = "time_s,trial,index.Fz_N\n".to_owned();
    for &trial in trials {
        let presses: Vec<Press> = (0..trial).map(|k| press(0.5 + f64::from(k), 0.4, peak_n)).collect();
        for row in rows(100.0 * f64::from(trial), 4.0, &[&presses]) {
            let _ = writeln!(text, "{:?},{trial},{:?}", row[0], row[1]);
        }
    }
    text
}

#[test]
fn means_are_over_trials_then_over_people() {
    let dir = Dir::new();
    dir.write("a.csv", session(&[1, 2, 3], 2.0));
    dir.write("b.csv", session(&[1, 3], 1.0));
    let report = run(&dir, "a.csv b.csv --subject anna,ben --out o --json").expect(0).json();
    let person = |k: usize| &report["people"][k]["fingers"][0]["over"];
    let of = |over: &serde_json::Value, name: &str| {
        [over[name]["mean"].number(), over[name]["sd"].number(), over[name]["n"].number()]
    };
    assert_eq!(of(person(0), "presses"), [2.0, 1.0, 3.0]);
    assert_eq!(of(person(1), "presses"), [2.0, 2.0_f64.sqrt(), 2.0]);
    let peaks = of(&report["over_people"][0]["over"], "peak_N");
    assert!((peaks[0] - 1.5).abs() <= NEAR && (peaks[1] - 0.5_f64.sqrt()).abs() <= NEAR && peaks[2] == 2.0);
    let contact = of(person(0), "contact_s");
    assert!((contact[0] - 2.0 * press(0.0, 0.4, 2.0).exact()[0]).abs() <= NEAR);
    assert_eq!(report["people"][0]["first"]["index"], 3);
    // A column says whose a row is.
    let both = "subject,".to_owned() + &session(&[1], 2.0).replace('\n', "\ncleo,");
    dir.write("c.csv", both.trim_end_matches("cleo,"));
    let report = run(&dir, "c.csv --out c --json").expect(0).json();
    assert_eq!(report["people"][0]["subject"].words(), "cleo");
}

#[test]
fn a_trial_is_compared_with_the_reference_whatever_its_pace() {
    let dir = Dir::new();
    let (slower, weaker) = (altered(|t_s, force| vec![1.1 * t_s, force]), altered(|t_s, force| vec![t_s, 0.5 * force]));
    for (name, rows) in [("expert", rows(7.0, 4.0, &[&INDEX])), ("slower", slower), ("weaker", weaker)] {
        dir.write(&format!("{name}.csv"), csv("time_s,Fz_N", &rows));
    }
    dir.write("idle.csv", csv("time_s,Fz_N", &rows(0.0, 4.0, &[&[]])));
    let report =
        run(&dir, "expert.csv slower.csv weaker.csv idle.csv --reference expert.csv --finger index --out o --json");
    let report = report.expect(0).json();
    let finger = |k: usize| &report["trials"][k]["fingers"][0];
    let distance = |k: usize| finger(k)["distance_n"].number();
    // The reference is not compared with itself, however it is named.
    assert!(finger(0)["distance_n"].is_null() && finger(0)["finger"] == "index");
    assert!(distance(1) <= 0.02, "{}", distance(1));
    assert!(distance(2) > 5.0 * distance(1) && distance(2) > 0.1, "{} {}", distance(1), distance(2));
    assert!(finger(3)["distance_n"].is_null() && finger(3)["peak_n"].is_null() && finger(3)["presses"] == 0);
    run(&dir, "expert.csv --band 5 --out alone").expect(0).says("--band is of no use here: there is no reference");
    let report = run(&dir, "expert.csv weaker.csv --reference-trial expert --out t --json").expect(0).json();
    assert_eq!(report["reference"].words(), "expert");
    assert!(report["trials"][0]["fingers"][0]["distance_n"].is_null());
    assert!((report["trials"][1]["fingers"][0]["distance_n"].number() - distance(2)).abs() <= 1e-12);
}

#[test]
fn gaps_and_unknown_forces_end_a_contact_and_are_no_time() {
    let dir = Dir::new();
    let long = [press(0.5, 3.0, 2.0)];
    let mut all = rows(0.0, 5.0, &[&long, &INDEX]);
    // Forces are not known from 2.00 to 2.02 s, and in single rows, which are as rows that are lost; rows between 1.0
    // and 1.5 s are lost.
    [200, 201, 202, 250, 270, 271].into_iter().for_each(|row| all[row][1] = f64::NAN);
    all.retain(|row| !(1.005..1.495).contains(&row[0]));
    dir.write("t.csv", csv(NAMES, &all));
    let answer = run(&dir, "t.csv --out o --json").expect(0);
    let report = answer.json();
    let index = &report["trials"][0]["fingers"][0];
    let [contact_s, impulse_ns] = exact(&long);
    assert!((index["contact_s"].number() - (contact_s - 0.54)).abs() <= NEAR);
    assert!((index["impulse_ns"].number() - (impulse_ns - 2.0 * 0.54)).abs() <= NEAR);
    assert!((index["unknown_s"].number() - 0.54).abs() <= NEAR && (index["known_s"].number() - 4.46).abs() <= NEAR);
    // One beginning was seen.
    assert!(index["presses"] == 1 && index["cut"] == 3 && index["smoothness"].is_null());
    answer.says("1 of 1 trials have gaps or unknown forces").says("one without a beginning is no press");
}

#[test]
fn forces_are_of_rows_in_touch_and_angles_of_rows_in_bending() {
    let dir = Dir::new();
    let mut text = "time_s,Fx_N,Fz_N,J2_deg,J2_deg_low,contact\n".to_owned();
    for row in rows(0.0, 4.0, &[&INDEX]) {
        let (time_s, fz_n) = (row[0], row[1]);
        let invalid = (3.0..3.2).contains(&time_s);
        match () {
            () if invalid => writeln!(text, "{time_s},,,,,invalid"),
            // What a model says of the other's rows is not to be used.
            () if fz_n <= -0.25 => writeln!(text, "{time_s},0,{fz_n},999,0,touch"),
            () => writeln!(text, "{time_s},0,-77,{},0,bending", 10.0 + 5.0 * time_s),
        }
        .unwrap();
    }
    dir.write("t.csv", &text);
    let answer = run(&dir, "t.csv --out o --json").expect(0);
    let report = answer.json();
    let finger = &report["trials"][0]["fingers"][0];
    assert!(finger["presses"] == 2 && (finger["peak_n"].number() - 2.0).abs() <= NEAR, "{finger}");
    assert!((finger["unknown_s"].number() - 0.21).abs() <= NEAR);
    let posture = report["trials"][0]["posture"].list();
    assert_eq!((posture.len(), posture[0]["angle"].words()), (1, "J2_deg"));
    assert!(
        (posture[0]["lowest"].number() - 10.0).abs() <= NEAR && (posture[0]["highest"].number() - 30.0).abs() <= NEAR
    );
    answer.says("they are never known at once (5.1.2)");
    // Without the gate nobody knows where angles hold.
    dir.write("plain.csv", csv("time_s,Fz_N,J2_deg", &rows(0.0, 4.0, &[&INDEX, &MIDDLE])));
    let answer = run(&dir, "plain.csv --out p --json").expect(0);
    assert!(answer.json()["trials"][0]["posture"].list().is_empty());
    answer.says("angles are left out");
    dir.write("odd.csv", "time_s,Fz_N,contact\n0,0,touch\n0.1,-1,tuoch\n");
    run(&dir, "odd.csv --out q").expect(2).says("odd.csv:3: column `contact`: `tuoch` is no contact");
}

#[test]
fn a_log_of_another_lab_is_read_and_a_wrong_sign_is_seen() {
    let dir = Dir::new();
    let lit = csv("time_s;Fz_N;P1", &altered(|t_s, force| vec![t_s, force, 1.0]));
    dir.write("lab.csv", lit.replace(',', ";"));
    let report = run(&dir, "lab.csv --out o --json").expect(0).json();
    let impulse_ns = report["trials"][0]["fingers"][0]["impulse_ns"].number();
    assert!((impulse_ns - exact(&INDEX)[1]).abs() <= NEAR);
    let up = altered(|t_s, force| vec![t_s, -force]);
    dir.write("up.csv", csv("time_s,Fz_N", &up));
    let answer = run(&dir, "up.csv --out u --json").expect(0);
    assert_eq!(answer.json()["trials"][0]["fingers"][0]["presses"], 0);
    dir.write("ms.csv", csv("time_s,Fz_N", &altered(|t_s, force| vec![1000.0 * t_s, force])));
    run(&dir, "ms.csv --out t").expect(0).says("ms.csv: rows are 10 s apart");
    // What is true of contact is no gate.
    let flagged = altered(|t_s, force| vec![t_s, force, f64::from(force < 0.0)]);
    dir.write("flag.csv", csv("time_s,Fz_N,contact", &flagged));
    let flag = run(&dir, "flag.csv --out f --json").expect(0);
    assert_eq!(flag.json()["trials"][0]["fingers"], report["trials"][0]["fingers"]);
    flag.says("column `contact` is 0 or 1, whether the finger touches, and is not read");
    // A decimal point that was lost, and a transducer at the end of its range.
    let lost = altered(|t_s, force| vec![t_s, if t_s == 1.5 { 1e4 * force - 1e3 } else { force }]);
    dir.write("lost.csv", csv("time_s,Fz_N", &lost));
    run(&dir, "lost.csv --out t").expect(0).says("finger: Fz_N is -").says("far beyond all others");
    dir.write("end.csv", csv("time_s,Fz_N", &altered(|t_s, force| vec![t_s, force.max(-0.7)])));
    run(&dir, "end.csv --out t").expect(0).says("finger: Fz_N stays at exactly -0.7, its least value");
    // A spike in one row, a force that stands still while it presses, and a column that was copied to another finger.
    let wavers = |k: usize| -1.2 + (0.05 * k as f64).cos() + 0.01 * (7.0 * k as f64).sin();
    let of = |name: &str, names: &str, force: &dyn Fn(usize) -> Vec<f64>| {
        let rows = (0..1000).map(|k| [vec![0.01 * k as f64], force(k)].concat()).collect::<Vec<_>>();
        dir.write(name, csv(names, &rows));
        run(&dir, &format!("{name} --out t")).expect(0)
    };
    let two = "time_s,index.Fz_N,middle.Fz_N";
    of("good.csv", two, &|k| vec![wavers(k), wavers(k + 90)]).never_says("warning");
    of("spike.csv", "time_s,Fz_N", &|k| vec![if k == 500 { -22.0 } else { wavers(k) }])
        .says("finger: Fz_N is -22 in one of 1 row(s), far beyond all others");
    of("still.csv", "time_s,Fz_N", &|k| vec![wavers(if (200..500).contains(&k) { 200 } else { k })])
        .says("finger: Fz_N keep(s) all values in 1 stretch(es), the longest 300 samples from 2.000 to 4.990 s");
    of("copied.csv", two, &|k| vec![wavers(k); 2]).says("middle: Fz_N is that of index in every row");
    of("off.csv", two, &|k| vec![wavers(k), 0.0]).says("middle: Fz_N is the same to the last digit in all ");
    dir.write("again.csv", csv("time_s,Fz_N", &up));
    run(&dir, "up.csv again.csv --out t")
        .expect(0)
        .says("up.csv, again.csv: the same to the byte, and counted 2 times");
    answer.says("up.csv: trial up: finger: Fz_N goes from 0.000 to 2.000 N, as if the finger pulled");
}

#[test]
fn columns_whose_names_are_near_to_those_that_are_read_are_named() {
    let dir = Dir::new();
    let names = "time_s,index.Fz_N,middle.FZ_N,ring_Fz_N,thumb.Fz,little.Fz_mN,index.Fz_N_low,Trial";
    let fingers = rows(0.0, 4.0, &[&INDEX, &MIDDLE, &MIDDLE, &MIDDLE, &MIDDLE, &MIDDLE]);
    let numbered: Vec<Vec<f64>> = fingers.into_iter().map(|row| [row, vec![1.0]].concat()).collect();
    dir.write("near.csv", csv(names, &numbered));
    let answer = run(&dir, "near.csv --out o --json").expect(0);
    assert_eq!(answer.json()["trials"][0]["fingers"].list().len(), 1);
    answer
        .never_says("`index.")
        .says("near.csv: `middle.FZ_N` is not read; is it `middle.Fz_N`, in newtons?")
        .says("`ring_Fz_N` is not read; is it `ring.Fz_N`")
        .says("`thumb.Fz` is not read; is it `thumb.Fz_N`")
        .says("`little.Fz_mN` is not read; is it `little.Fz_N`, in newtons?")
        .says("`Trial` is not read; is it `trial`?");
}

#[test]
fn a_column_of_subjects_is_believed_and_another_name_is_warned_of() {
    let dir = Dir::new();
    let table = csv("time_s,Fz_N", &rows(0.0, 4.0, &[&INDEX]));
    let named =
        table.lines().map(|line| format!("{line},{}\n", if line.starts_with('t') { "subject" } else { "anna" }));
    dir.write("own.csv", named.collect::<String>());
    let answer = run(&dir, "own.csv --subject zoe --out o --json").expect(0);
    assert_eq!(answer.json()["trials"][0]["subject"].words(), "anna");
    answer.says("own.csv: column `subject` says whose its rows are (`anna`), and --subject zoe is not used for them");
    run(&dir, "own.csv --subject anna --out p").expect(0).never_says("--subject");
}

#[test]
fn presses_that_run_together_as_the_zero_moves_are_named() {
    let dir = Dir::new();
    let presses: Vec<Press> = (0..30).map(|k| press(1.0 + f64::from(k), 0.3, 2.0)).collect();
    let moved = |by_n: f64| {
        let mut rows = rows(0.0, 32.0, &[&presses]);
        rows.iter_mut().filter(|row| row[0] >= 16.0).for_each(|row| row[1] -= by_n);
        csv("time_s,Fz_N", &rows)
    };
    dir.write("moved.csv", moved(0.3));
    run(&dir, "moved.csv --out o").expect(0).says("finger: from 16.0 to ").says("did the transducer's zero move?");
    dir.write("still.csv", moved(0.0));
    run(&dir, "still.csv --out p").expect(0).never_says("zero move");
}

#[test]
fn noise_near_the_threshold_is_no_contact() {
    let dir = Dir::new();
    let presses: Vec<Press> = (0..6).map(|k| press(1.0 + f64::from(k), 0.3, 2.0)).collect();
    let noisy = |by_n: f64| {
        let mut rows = rows(0.0, 8.0, &[&presses]);
        rows.iter_mut().enumerate().for_each(|(k, row)| row[1] += by_n * (((k * k * 31) % 17) as f64 / 8.0 - 1.0));
        csv("time_s,Fz_N", &rows)
    };
    dir.write("noisy.csv", noisy(0.25));
    run(&dir, "noisy.csv --out o").expect(0).says("noisy.csv: trial noisy: ").says("N (SD) or more, and --touch is");
    // Most of it is faster than 15 Hz: smoothness is 0.1 % off.
    dir.write("quiet.csv", noisy(0.06));
    run(&dir, "quiet.csv --out p").expect(0).never_says("scatters").never_says("smoothness is in part");
    // A tremor hardly bends from row to row, and is seen in how smooth presses are.
    let mut trembling = rows(0.0, 8.0, &[&presses]);
    trembling.iter_mut().for_each(|row| row[1] += 0.03 * (std::f64::consts::TAU * 9.5 * row[0]).sin());
    dir.write("tremor.csv", csv("time_s,Fz_N", &trembling));
    run(&dir, "tremor.csv --out t")
        .expect(0)
        .never_says("scatters")
        .says("noise at rest, up to 15 Hz, changes the force");
}

#[test]
fn wrong_recordings_are_refused_and_others_are_done() {
    let dir = Dir::new();
    dir.write("good.csv", csv(NAMES, &rows(0.0, 4.0, &[&INDEX, &MIDDLE])));
    dir.write("again/good.csv", csv(NAMES, &rows(0.0, 4.0, &[&INDEX, &MIDDLE])));
    let refused = |name: &str, text: &str| {
        dir.write(name, text);
        let answer = run(&dir, &format!("{name} --out o")).expect(2);
        assert!(!dir.path("o").exists());
        answer
    };
    refused("a.csv", "time_s,P1\n0,1\n0.1,2\n").says("a.csv: has no normal force; name its column Fz_N");
    refused("b.csv", "time_s,Fz_N\n0,0\n0.2,0\n0.1,0\n").says("b.csv: line 4: time_s falls from 0.2 to 0.1");
    let coarse = altered(|t_s, force| vec![(t_s * 50.0).floor() / 50.0, force]);
    refused("g.csv", &csv("time_s,Fz_N", &coarse)).says("g.csv: 200 of 401 rows of a trial have the time of the row");
    refused("f.csv", "t,force\n0,1\n").says("f.csv: is neither a table with time_s and Fz_N");
    refused("c.csv", "time_s,Fz_N\n0,soft\n").says("c.csv:2: column `Fz_N`: `soft` is no finite number");
    refused("d.csv", "time_s,Fz_N\n,0\n,1\n").says("d.csv: has no row with a time and a trial");
    refused("e.csv", "time_s,Fz_N,finger.Fz_N\n0,0,0\n").says("two columns are the force of `finger`");
    let bad = |options: &str| run(&dir, &format!("{options} --out o")).expect(2);
    bad("good.csv again/good.csv").says("good.csv and again/good.csv: both are trial good");
    bad("good.csv --touch 0.1 --release 0.3").says("--release 0.3: is above --touch 0.1");
    bad("good.csv --touch 0 --release 0 --band 300").says("--touch 0: every finger touches").says("--band 300");
    bad("good.csv --hold -1").says("a number of at least 0");
    bad("good.csv --subject a,b").says("--subject: 2 names for 1 recordings");
    bad("good.csv --reference-trial best").says("--reference-trial best: there is no such trial; there are good");
    bad("good.csv --reference-trial good --reference good.csv").says("choose one of them");
    assert!(!dir.path("o").exists());
    // One that can't be read keeps no other back.
    let answer = run(&dir, "a.csv good.csv --out o --json").expect(1);
    assert!(answer.json()["trials"].list().len() == 1 && answer.json()["failed"].list().len() == 1);
    answer.says("failed: a.csv: has no normal force");
    dir.write("skill.csv", csv(NAMES, &rows(0.0, 4.0, &[&INDEX, &MIDDLE])));
    run(&dir, "skill.csv --out .").expect(2).says("is an input itself");
}

#[test]
fn no_more_pictures_than_anybody_looks_at() {
    let dir = Dir::new();
    let trials: Vec<String> = (0..23)
        .flat_map(|trial| {
            [format!("{trial}.0,{trial},0"), format!("{trial}.1,{trial},-1"), format!("{trial}.2,{trial},0")]
        })
        .collect();
    dir.write("many.csv", format!("time_s,trial,Fz_N\n{}\n", trials.join("\n")));
    let answer = run(&dir, "many.csv --out o --json").expect(0);
    assert_eq!(answer.json()["pictures"].list().len(), 21);
    answer.says("the first 20 of 23 trials are drawn");
}
