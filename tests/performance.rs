//! `lunula performance`: the arithmetic of appendix C by hand, curves recovered, impossible and doubled rows refused.

use std::fmt::Write as _;

use crate::util::{Answer, Dir, Json, number};

const COURSE: &str = "--path-m 1.42 --speed-mps 0.025 --decisions 27";
/// Driving alone takes 1.42 / 0.025 s.
const SHORTEST_S: f64 = 56.8;

fn run(dir: &Dir, options: &str) -> Answer {
    dir.words(&format!("performance {options}"))
}

/// The time of a trial whose decisions take so long each.
fn time_s(decision_s: f64) -> f64 {
    SHORTEST_S + 27.0 * decision_s
}

fn table(rows: &[(&str, &str, u32, f64)]) -> String {
    let mut text = "operator,method,trial,time_s\n".to_owned();
    for (operator, method, trial, decision_s) in rows {
        let _ = writeln!(text, "{operator},{method},{trial},{:?}", time_s(*decision_s));
    }
    text
}

/// Two operators, the pendant and virtual switches, two trials.
fn by_hand() -> String {
    table(&[
        ("A", "pendant", 1, 8.0),
        ("A", "virtual", 1, 3.0),
        ("B", "pendant", 1, 12.0),
        ("B", "virtual", 1, 5.0),
        ("A", "pendant", 2, 4.0),
        ("A", "virtual", 2, 2.0),
        // B did not do the second trial with virtual switches.
        ("B", "pendant", 2, 6.0),
    ])
}

fn near(value: &serde_json::Value, expected: f64) -> bool {
    (value.number() - expected).abs() <= 1e-9
}

#[test]
fn means_and_paired_differences_are_those_made_by_hand() {
    let dir = Dir::new();
    dir.write("trials.csv", by_hand());
    let report = run(&dir, &format!("trials.csv {COURSE} --out o --json")).expect(0).json();
    assert!(near(&report["shortest_s"], SHORTEST_S));
    let [pendant, virtuals] = [0, 1].map(|k| &report["methods"][k]);
    assert_eq!((pendant["method"].words(), virtuals["method"].words()), ("pendant", "virtual"));
    let first = &pendant["trials"][0];
    // 8 and 12: mean 10, SD sqrt(8).
    assert!(near(&first["mean"], 10.0) && near(&first["sd"], 8.0_f64.sqrt()) && first["n"] == 2);
    let last = &virtuals["trials"][1];
    assert!(near(&last["mean"], 2.0) && last["sd"].is_null() && last["n"] == 1);
    let compared = &report["comparisons"][0];
    assert_eq!((compared["method"].words(), compared["baseline"].words()), ("virtual", "pendant"));
    // Differences -5 and -7: mean -6, SD sqrt(2), standard error 1, t of one degree of freedom 12.7062.
    let pair = &compared["trials"][0];
    assert!(near(&pair["difference"], -6.0) && near(&pair["difference_sd"], 2.0_f64.sqrt()));
    let t = (0.475 * std::f64::consts::PI).tan();
    assert!(near(&pair["difference_interval"][0], -6.0 - t) && near(&pair["difference_interval"][1], -6.0 + t));
    assert!(near(&pair["ratio_of_means"], 0.4) && near(&pair["ratio"], (0.375_f64 * 5.0 / 12.0).sqrt()));
    // One operator did the second trial with both.
    let pair = &compared["trials"][1];
    assert!(pair["n"] == 1 && near(&pair["difference"], -2.0) && pair["difference_interval"].is_null());
    // A: 2.5 against 6 over both trials; B: 5 against 12 in the one that he did with both.
    let overall = &compared["overall"];
    assert!(overall["n"] == 2 && near(&overall["difference"], -5.25));
    assert!(near(&overall["ratio_of_means"], 7.5 / 18.0));
    // 3 less 0.4 of 8, and 5 less 0.4 of 12: -0.2 and 0.2 of 10, and two operators hardly say more.
    let initially = &compared["initially"];
    assert!(near(&initially["ratio"], 0.4) && near(&initially["ratio_se"], 0.02) && initially["holds"].is_null());
    assert_eq!(initially["unsettled"].words(), "its 95 % interval holds half");
    assert!(compared["to_level_off"]["ratio"].is_null() && compared["to_level_off"]["holds"].is_null());
    let notes = report["notes"].list();
    let why = "pendant: exponential not fitted: there are fewer than 6 different trials";
    assert!(notes.iter().any(|note| note.words() == why), "{notes:?}");
    let rows = dir.table("o/rows.csv");
    assert_eq!(rows.len(), 7);
    assert!((number(&rows[2], "decision_s") - 12.0).abs() <= 1e-9);
    let means = dir.table("o/table.csv");
    assert_eq!(means.len(), 4);
    assert!((number(&means[2], "difference_s") + 6.0).abs() <= 1e-9 && means[0]["difference_s"].is_empty());
    assert_eq!(
        dir.names_of("o"),
        [
            "performance-methods.png",
            "performance-methods.svg",
            "performance-operators.png",
            "performance-operators.svg",
            "performance.json",
            "rows.csv",
            "run.json",
            "table.csv"
        ]
    );
    // The other way round.
    let report = run(&dir, &format!("trials.csv {COURSE} --baseline virtual --out v --json")).expect(0).json();
    assert!(near(&report["comparisons"][0]["trials"][0]["difference"], 6.0));
    assert_eq!(report["comparisons"][0]["initially"]["holds"], false);
}

/// Curves without noise: 2 + 6 exp(-(n - 1) / 2.5) and 1.5 + 2 n^-2.
fn curves() -> String {
    let mut rows = Vec::new();
    for trial in 1..=12u32 {
        let n = f64::from(trial);
        for (operator, off) in [("A", -0.25), ("B", 0.25)] {
            rows.push((operator, "pendant", trial, 2.0 + off + 6.0 * (-(n - 1.0) / 2.5).exp()));
            rows.push((operator, "virtual", trial, 1.5 + off + 2.0 * n.powi(-2)));
        }
    }
    table(&rows)
}

#[test]
fn learning_curves_are_recovered_and_say_where_they_level_off() {
    let dir = Dir::new();
    dir.write("trials.csv", curves());
    let report = run(&dir, &format!("trials.csv {COURSE} --out o --json")).expect(0).json();
    let fitted = |k: usize| &report["methods"][k]["fitted"];
    assert_eq!((&fitted(0)["better"], &fitted(1)["better"]), (&"exponential".into(), &"power".into()));
    for (k, law, exact) in [(0, "exponential", [2.0, 6.0, 2.5]), (1, "power", [1.5, 2.0, 2.0])] {
        for (name, exact) in ["a", "b", "c"].iter().zip(exact) {
            let found = fitted(k)[law]["curve"][name]["value"].number();
            // The times are read back from their decimals; measured: 2e-13.
            assert!((found - exact).abs() <= 1e-9, "{law} {name}: {found}");
        }
    }
    // 1 + 2.5 ln 20 = 8.49, and 20^(1/2) = 4.47: the first trials beyond are 9 and 5.
    let level = |k: usize| &report["methods"][k]["levels_off"];
    assert!((level(0)["trial"]["value"].number() - (1.0 + 2.5 * 20.0_f64.ln())).abs() <= 1e-6);
    assert!(level(0)["first_trial"] == 9.0 && level(1)["first_trial"] == 5.0 && level(0)["was_reached"] == true);
    let statement = &report["comparisons"][0]["to_level_off"];
    let ratio = 20.0_f64.sqrt() / (1.0 + 2.5 * 20.0_f64.ln());
    assert!((statement["ratio"].number() - ratio).abs() <= 1e-6 && statement["holds"] == false);
    assert!(report["level"].words().contains("less than 5 % of its rise"));
    // Of seven trials the pendant's level is prolonged: nothing is settled by it.
    let trial = |line: &&str| line.split(',').nth(2).and_then(|trial| trial.parse::<u32>().ok());
    let curves = curves();
    let early = curves.lines().filter(|line| trial(line).is_none_or(|trial| trial <= 7));
    dir.write("early.csv", early.map(|line| format!("{line}\n")).collect::<String>());
    let early = run(&dir, &format!("early.csv {COURSE} --out e --json")).expect(0).json();
    let statement = &early["comparisons"][0]["to_level_off"];
    assert!((statement["ratio"].number() - ratio).abs() <= 1e-6 && statement["holds"].is_null());
    assert_eq!(statement["unsettled"].words(), "a level was not reached");
}

#[test]
fn a_time_that_cannot_be_is_named_and_kept_out() {
    let dir = Dir::new();
    let text = by_hand() + "C,pendant,1,56.7\nC,virtual,1,-3\nC,virtual,2,\nC,pendant,2,NaN\n";
    dir.write("trials.csv", &text);
    let answer = run(&dir, &format!("trials.csv {COURSE} --out o --json")).expect(1);
    let report = answer.json();
    let answer = answer.says("trials.csv: line 9: 56.7 s are less than the 56.800000 s of driving alone");
    answer.says("trials.csv: line 10: -3 s are less").says("note: 2 rows have no time and are not counted");
    assert!(report["rows"] == 7 && report["rows_without_time"] == 2 && report["failed"].list().len() == 2);
    let first = &report["methods"][0]["trials"][0];
    assert!(first["n"] == 2 && near(&first["mean"], 10.0));
}

#[test]
fn wrong_tables_are_refused_and_nothing_is_written() {
    let dir = Dir::new();
    let head = "operator,method,trial,time_s\n";
    let refused = |text: &str, options: &str| {
        dir.write("t.csv", text);
        let answer = run(&dir, &format!("t.csv {COURSE} {options} --out o")).expect(2);
        assert!(!dir.path("o").exists());
        answer
    };
    let twice = format!("{head}A,pendant,1,200\nA,virtual,1,100\nA, pendant,1,190\n");
    refused(&twice, "").says("t.csv: line 2 and line 4: both are operator A, method pendant, trial 1; keep one");
    refused(&format!("{head}A,pendant,0,200\n"), "").says("t.csv:2: column `trial`: write the number of the trial");
    refused(&format!("{head}A,pendant,1.5,200\n"), "").says("t.csv:2: column `trial`: `1.5` is no whole number");
    refused(&format!("{head},pendant,1,200\n"), "").says("t.csv:2: column `operator`: is empty");
    refused(&format!("{head}A,pendant,1,fast\n"), "").says("t.csv:2: column `time_s`: `fast` is no finite number");
    refused("operator,method,trial\nA,pendant,1\n", "").says("has no column `time_s`");
    refused(head, "").says("t.csv: has no trial to use");
    refused(&format!("{head}A,pendant,1,2\n"), "").says("2 s are less than the 56.800000 s of driving alone");
    refused(&by_hand(), "--baseline virtal").says("has no method `virtal` of --baseline; did you mean `virtual`?");
    let mut many = head.to_owned();
    (0..30).for_each(|k| writeln!(many, "A,method {k},1,200").unwrap());
    refused(&many, "").says("column `method`: has 30 different names, more than 20");
    dir.write("t.csv", by_hand());
    let bad = |course: &str| run(&dir, &format!("t.csv {course} --out o")).expect(2);
    bad("--path-m 0 --speed-mps 1 --decisions 1").says("a number above 0");
    bad("--path-m 1 --speed-mps -1 --decisions 1").says("a number above 0");
    bad("--path-m 1 --speed-mps nan --decisions 1").says("a number above 0");
    bad("--path-m 1 --speed-mps 1 --decisions 0").says("--decisions");
    bad("--path-m 1 --speed-mps 1").says("--decisions");
    run(&dir, &format!("none.csv {COURSE} --out o")).expect(2).says("none.csv");
    // A result is never written over the input.
    dir.write("o/rows.csv", by_hand());
    run(&dir, &format!("o/rows.csv {COURSE} --out o")).expect(2).says("is an input itself");
    assert_eq!(dir.bytes_of("o").len(), 1);
}

#[test]
fn one_operator_and_one_method_are_enough() {
    let dir = Dir::new();
    dir.write("trials.csv", table(&[("A", "pendant", 3, 2.0)]));
    let report = run(&dir, &format!("trials.csv {COURSE} --out o --json")).expect(0).json();
    let only = &report["methods"][0];
    assert!(near(&only["trials"][0]["mean"], 2.0) && only["trials"][0]["sd"].is_null());
    assert!(only["levels_off"].is_null() && report["comparisons"].list().is_empty());
    // Nobody did the same trial with both.
    dir.write("trials.csv", table(&[("A", "pendant", 1, 2.0), ("B", "virtual", 1, 1.0), ("A", "virtual", 2, 1.0)]));
    let answer = run(&dir, &format!("trials.csv {COURSE} --out p --json")).expect(0);
    assert!(answer.json()["comparisons"][0]["overall"].is_null());
    answer.says("virtual and pendant: no operator did the same trial with both");
}

#[track_caller]
fn judged(dir: &Dir, trials: String) -> Answer {
    dir.write("trials.csv", trials);
    run(dir, &format!("trials.csv {COURSE} --out o --json")).expect(0)
}

#[test]
fn slips_of_names_and_units_are_warned_of() {
    let dir = Dir::new();
    let said = |text: String| judged(&dir, text);
    let rows = [("A", "pendant", 1, 2.0), ("a", "virtual", 1, 1.0), ("A", "Virtual", 2, 1.0)];
    said(table(&rows))
        .says("operators `A` and `a` differ in case")
        .says("methods `Virtual` and `virtual` differ in case");
    said(table(&rows.map(|(_, method, trial, s)| ("A", method, trial, 1000.0 * s)))).says("is time_s in ms?");
    // One of two operators in ms, and a log that was copied under another name.
    let of = |who: &'static str, unit: f64| [1, 2, 3].map(|k| (who, "pendant", k, unit * (2.0 - 0.3 * f64::from(k))));
    said(table(&[of("A", 1.0), of("B", 900.0), of("C", 1.0)].concat()))
        .says("half of the decisions of B took ")
        .never_says("decisions of A")
        .says("A, C have the same times in all 3 trials, and count apart");
    // A method's log that was copied under another's name, a clock that is never reset, a speed in mm/s.
    let method = |method: &'static str| [1, 2, 3].map(|k| ("A", method, k, 2.0 - 0.3 * f64::from(k)));
    said(table(&[method("pendant"), method("virtual")].concat()))
        .says("pendant, virtual have the same times in all 3 trials");
    let counted_on = |k: u32| ("A", "pendant", k, 3.0 * f64::from(k) + (f64::from(k) - 1.0) * SHORTEST_S / 27.0);
    said(table(&[&(1..5).map(counted_on).collect::<Vec<_>>()[..], &of("B", 1.0)].concat()))
        .says("each trial of A with pendant took a whole drive longer than the one before");
    let on = [1, 2, 3].map(|k| ("A", "virtual", k + 3, 1.6 - 0.3 * f64::from(k)));
    said(table(&[of("A", 1.0), on].concat()))
        .says("the trials of A with virtual begin at 4, where those with another method end: are they counted on?");
    said(by_hand()).never_says("warning");
    run(&dir, "trials.csv --path-m 1.42 --speed-mps 25 --decisions 27 --out o")
        .expect(0)
        .says("driving alone takes 0.057 s of 192 s in the median");
}

/// Five operators who differ by a tenth or so, six trials by two methods.
fn five(slip: impl Fn(&str, &str, u32, f64) -> f64) -> String {
    let mut rows = Vec::new();
    for (k, operator) in ["A", "B", "C", "D", "E"].into_iter().enumerate() {
        for trial in 1..=6u32 {
            for (method, first) in [("pendant", 8.0), ("virtual", 2.4)] {
                let scatter = 0.12 * f64::sin(f64::from(17 * trial) + 5.0 * k as f64 + first);
                let usual = (1.0 + first * (-0.5 * f64::from(trial - 1)).exp()) * (0.05 * k as f64 + scatter).exp();
                rows.push((operator, method, trial, slip(operator, method, trial, usual)));
            }
        }
    }
    table(&rows)
}

#[test]
fn a_slip_in_one_row_and_trials_that_were_stopped_are_warned_of() {
    let dir = Dir::new();
    let said = |text: String| judged(&dir, text);
    let plain = said(five(|_, _, _, usual| usual)).never_says("warning");
    let statement = &plain.json()["comparisons"][0]["initially"];
    assert!(statement["holds"] == true && statement["ratio_se"].number() < 0.05, "{statement}");
    let slip = |operator: &str, method: &str, trial: u32, usual: f64| {
        if (operator, method, trial) == ("B", "virtual", 1) { 10.0 * usual } else { usual }
    };
    let slipped =
        said(five(slip)).says("a decision of B took ").says("s in trial 1 with virtual, ").says("is it a slip?");
    let statement = &slipped.json()["comparisons"][0]["initially"];
    assert!(statement["holds"].is_null(), "{statement}");
    assert_eq!(statement["unsettled"].words(), "its 95 % interval holds half");
    let kept = |operator: &str, method: &str, trial: u32, usual: f64| {
        if (operator, method) == ("C", "pendant") && trial > 1 { 3.1 } else { usual }
    };
    said(five(kept)).says("trials 2 to 6 of C with pendant took exactly ").says("was the last time carried forward?");
    said(five(|_, _, _, usual| usual.min(4.5))).says("trials took exactly 178.3 s, and none longer: were they stopped");
}

#[test]
fn who_stops_early_is_named_and_does_not_bend_the_curve() {
    let dir = Dir::new();
    // A and B differ by a factor; B, the slower, stops.
    let study = |last_of_b: u32, skipped: u32| {
        let decision_s = |trial: u32| 2.0 + 6.0 * (-(f64::from(trial) - 1.0) / 2.5).exp();
        let of = |operator: &'static str, pace: f64| {
            (1..=12).map(move |trial| (operator, "pendant", trial, pace * decision_s(trial)))
        };
        let done = of("B", 1.6).filter(|(_, _, trial, _)| *trial <= last_of_b && *trial != skipped);
        judged(&dir, table(&of("A", 0.9).chain(done).collect::<Vec<_>>()))
    };
    let early = study(5, 0)
        .says("stopped early: B after trial 5 of 12 with pendant.")
        .says("pendant: 7 of 24 trials were not done")
        .json();
    // The mean of paces 0.9 and 1.6 is 1.25.
    let curve = &early["methods"][0]["fitted"]["exponential"]["curve"];
    for (name, exact) in [("a", 1.25 * 2.0), ("b", 1.25 * 6.0), ("c", 2.5)] {
        let found = curve[name]["value"].number();
        assert!((found - exact).abs() <= 1e-6, "{name}: {found}");
    }
    study(12, 0).never_says("stopped early").never_says("were not done");
    study(11, 4).never_says("stopped early").says("pendant: 2 of 24 trials were not done");
}
