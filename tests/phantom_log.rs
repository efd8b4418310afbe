//! Synthetic logs: readings and truth agree, the log belongs to the video of its seed, bad options are refused.

use std::collections::BTreeMap;

use crate::util::{Answer, Dir, number};
use lunula::phantom::force::{ForceTrajectory, Spiral};
use lunula::phantom::log::{LogOptions, LogScene};
use lunula::phantom::sensor::CHANNELS;
use lunula::phantom::trajectory::Trajectory;
use lunula::phantom::{Error, Generated as _};

/// Half a step of the converter and of a number's sixth decimal, volts.
const HALF_STEP_V: f64 = 0.5 * 10.0 / 65_536.0 + 1e-6;

fn run(dir: &Dir, options: &str) -> Answer {
    dir.words(&format!("phantom log {options}"))
}

#[test]
fn a_reading_is_the_leds_light_and_the_ambient_light_and_noise() {
    let dir = Dir::new();
    run(&dir, "--seconds 20 --force random --clock-drift-ppm 45 --clock-offset 754 --out out").expect(0);
    let (log, truth) = (dir.table("out/log.csv"), dir.table("out/truth/log.csv"));
    assert_eq!((log.len(), truth.len()), (550, 550));
    let (mut square, mut count) = (0.0, 0);
    for (k, (row, exact)) in log.iter().zip(&truth).enumerate() {
        assert_eq!(row["led"], if k % 2 == 0 { "1" } else { "0" });
        let (scene_s, log_s) = (number(exact, "time_s"), number(exact, "log_s"));
        assert!((log_s - (754.0 + (1.0 + 45e-6) * scene_s)).abs() <= 1e-9);
        assert!((number(row, "time_s") - log_s).abs() <= 0.6e-6, "six decimals");
        for p in 1..=CHANNELS {
            let lit = number(row, "led") * number(exact, &format!("P{p}"));
            let miss = number(row, &format!("P{p}")) - lit - number(exact, &format!("P{p}_unlit"));
            // Noise of 0.0005 V: of 4400 readings none is six standard deviations off.
            assert!(miss.abs() <= 6.0 * 0.0005 + HALF_STEP_V, "P{p} {miss}");
            square += miss * miss;
            count += 1;
        }
        for force in ["Fx_N", "Fy_N", "Fz_N"] {
            // Noise of 0.001 N and steps of up to 0.0016 N.
            assert!((number(row, force) - number(exact, force)).abs() <= 6.0 * 0.001 + 0.0009);
        }
    }
    // Noise and rounding together; the standard error of this figure is 1 %.
    assert!(((square / f64::from(count)).sqrt() / 0.000_502 - 1.0).abs() <= 0.05);
}

#[test]
fn the_log_belongs_to_the_video_of_its_seed_and_both_stand_together() {
    // A straight line between frames errs by an eighth of the interval's square times the bending's acceleration;
    // measured 0.0026 degrees.
    const NEAR_DEG: f64 = 0.005;
    let dir = Dir::new();
    let video = "phantom video --out s --seed 4 --trajectory random --bend-hz 0.12 --seconds 2 --fps 60 --size 160x96 \
                 --x264 ultrafast --clock mm:ss.t --clock-offset 754 --clock-drift-ppm 80";
    let log = "--out s --seed 4 --trajectory random --bend-hz 0.12 --seconds 2 --clock-offset 754 --clock-drift-ppm 80";
    dir.words(video).expect(0);
    let alone = dir.bytes_of("s");
    run(&dir, log).expect(0);
    let both = dir.bytes_of("s");
    assert_eq!(both.len(), alone.len() + 4);
    assert!(alone.iter().all(|(name, bytes)| both[name] == *bytes));
    // The other order, and each again.
    std::fs::remove_dir_all(dir.path("s")).unwrap();
    run(&dir, log).expect(0);
    dir.words(video).expect(0);
    assert!(dir.bytes_of("s") == both);
    dir.words(video).expect(0);
    run(&dir, log).expect(0);
    assert!(dir.bytes_of("s") == both);

    let (frames, rows) = (dir.table("s/truth/joints.csv"), dir.table("s/truth/log.csv"));
    let mut compared = 0;
    for row in &rows {
        let time_s = number(row, "time_s");
        let after = frames.iter().position(|frame| number(frame, "time_s") > time_s).filter(|&k| k > 0);
        let Some(after) = after else { continue };
        let (a, b) = (&frames[after - 1], &frames[after]);
        let share = (time_s - number(a, "time_s")) / (number(b, "time_s") - number(a, "time_s"));
        let between = |column: &str| number(a, column) + share * (number(b, column) - number(a, column));
        for joint in ["J1_deg", "J2_deg", "J3_deg"] {
            let miss = (between(joint) - number(row, joint)).abs();
            assert!(miss <= NEAR_DEG, "{joint} at {time_s}: {miss}");
        }
        assert!((between("clock_s") - number(row, "log_s")).abs() <= 1e-9);
        compared += 1;
    }
    // 25 a second for 2 s less the last frame's interval.
    assert!((48..=50).contains(&compared), "{compared}");
}

#[test]
fn the_exact_angles_label_a_log_without_a_video() {
    // Between frames a polynomial runs through those around; what is left is the labels' rounding. Measured 0.0002.
    const NEAR_DEG: f64 = 0.001;
    let dir = Dir::new();
    run(&dir, "--protocol bending --seed 3 --clock-offset 754 --clock-drift-ppm 80 --out s").expect(0);
    let angles = dir.table("s/truth/angles.csv");
    assert_eq!(angles.len(), 1800);
    let header = dir.text("s/truth/angles.csv");
    let columns = "frame,time_s,clock_s,J1_deg,J1_sd_deg,J2_deg,J2_sd_deg,J3_deg,J3_sd_deg,status,\
        clock_read_s,clock_sd_s,clock_low_s,clock_high_s";
    assert_eq!(header.lines().next(), Some(columns));
    assert!((number(&angles[1799], "clock_s") - (754.0 + (1.0 + 80e-6) * 1799.0 / 30.0)).abs() <= 1e-9);
    let align =
        "align --joints s/truth/angles.csv --log s/log.csv --out training.csv --subject 1 --session 1 --no-figures";
    dir.words(align).expect(0);
    // Lit samples have one row each.
    let exact = dir.table("s/truth/log.csv").into_iter().filter(|row| row["led"] == "1");
    let mut compared = 0;
    for (row, exact) in dir.table("training.csv").iter().zip(exact) {
        assert!((number(row, "time_s") - number(&exact, "log_s")).abs() <= 0.6e-6);
        if row["label_status"] != "ok" {
            let time_s = number(&exact, "time_s");
            assert!(!(0.0..=1799.0 / 30.0).contains(&time_s), "{time_s}: {}", row["label_status"]);
            continue;
        }
        for joint in ["J1_deg", "J2_deg", "J3_deg"] {
            let miss = (number(row, joint) - number(&exact, joint)).abs();
            assert!(miss <= NEAR_DEG, "{joint}: {miss}");
        }
        // The frames are exact: what is left is how the angle bends between them. Measured 0.0002.
        assert!(number(row, "J2_sd_deg") <= NEAR_DEG);
        compared += 1;
    }
    // 12.5 lit samples a second.
    assert!((748..=751).contains(&compared), "{compared}");
}

#[test]
fn what_a_folder_holds_of_others_is_left_alone() {
    let dir = Dir::new();
    let log = LogOptions { seconds: 1.0, ..LogOptions::default() };
    dir.write("out/log.csv", "mine");
    assert!(matches!(log.write(&dir.path("out")), Err(Error::InTheWay { place, .. }) if place.ends_with("log.csv")));
    assert_eq!(dir.bytes_of("out").len(), 1);
    dir.write("photos/truth/phantom.json", "{}");
    let photos = log.write(&dir.path("photos"));
    assert!(matches!(photos, Err(Error::InTheWay { place, .. }) if place.ends_with("phantom.json")));
    dir.write("file", "mine");
    assert!(matches!(log.write(&dir.path("file/out")), Err(Error::Place(_))));
}

#[test]
fn lost_rows_change_nothing_of_the_others() {
    let whole = LogScene::new(LogOptions { seconds: 20.0, ..LogOptions::default() }).unwrap();
    let holey = LogOptions { dropped: 0.1, gaps_s: vec![[4.0, 1.5], [9.0, 0.2]], ..whole.options().clone() };
    let holey = LogScene::new(holey).unwrap();
    let (all_rows, left) = (whole.rows(), holey.rows());
    let lost = all_rows.len() - left.len();
    // 42 in the gaps, and of the other 508 a tenth: 51 with a standard deviation of 7.
    assert!((70..=120).contains(&lost), "{lost}");
    for row in &left {
        assert_eq!(row, &all_rows[row.sample]);
        assert!(!(4.0..5.5).contains(&row.scene_s) && !(9.0..9.2).contains(&row.scene_s));
    }
    let all = LogScene::new(LogOptions { dropped: 1.0, ..LogOptions::default() }).unwrap();
    assert!(all.rows().is_empty());
    let dir = Dir::new();
    run(&dir, "--drop 1 --out out").expect(0).says("no rows");
    assert_eq!(dir.table("out/log.csv").len(), 0);
}

#[test]
fn stamps_err_repeat_and_jump_as_asked() {
    let usual = LogScene::new(LogOptions::default()).unwrap().rows();
    let stamps = |change: &dyn Fn(&mut LogOptions)| -> Vec<[f64; 2]> {
        let mut options = LogOptions::default();
        change(&mut options);
        let scene = LogScene::new(options).unwrap();
        assert!(scene.samples().zip(&usual).all(|(a, b)| a.log_s == b.log_s && a.read_v == b.read_v));
        scene.samples().map(|row| [row.stamp_s - row.log_s, row.scene_s]).collect()
    };
    let jittered = stamps(&|options| options.jitter_s = 0.03);
    assert!(jittered.iter().all(|[late, _]| late.abs() <= 0.03) && jittered.iter().any(|[late, _]| *late > 0.02));
    assert!(jittered.windows(2).any(|pair| pair[1][0] < pair[0][0] - 0.04), "the order of two rows changes");
    let coarse = stamps(&|options| options.stamp_step_s = 0.1);
    assert!(coarse.iter().all(|[late, _]| (-0.1..=1e-9).contains(late)));
    let jump = lunula::phantom::screen::Jump { at_s: 5.0, by_s: -3.0 };
    for [late, scene_s] in stamps(&|options| options.clock_jump = Some(jump)) {
        assert!((late - if scene_s >= 5.0 { -3.0 } else { 0.0 }).abs() <= 1e-9);
    }
}

#[test]
fn dates_pass_midnight_as_the_videos_clock_does() {
    let dir = Dir::new();
    let clock = "--clock-offset 86395 --seconds 10";
    run(&dir, &format!("{clock} --stamps datetime --out date")).expect(0);
    run(&dir, &format!("{clock} --stamps epoch --out epoch")).expect(0);
    run(&dir, &format!("{clock} --out plain")).expect(0);
    let [dates, epochs, plain] = ["date", "epoch", "plain"].map(|name| dir.table(&format!("{name}/log.csv")));
    let midnight = plain.iter().position(|row| number(row, "time_s") >= 86_400.0).unwrap();
    assert!(dates[midnight - 1]["time"].starts_with("2026-03-14T23:59:59.9"));
    assert!(dates[midnight]["time"].starts_with("2026-03-15T00:00:00.0"));
    for ((date, epoch), row) in dates.iter().zip(&epochs).zip(&plain) {
        // 2026-03-14T00:00:00Z.
        assert!((number(epoch, "time_s") - 1_773_446_400.0 - number(row, "time_s")).abs() <= 2e-6);
        let second: f64 = date["time"][17..].parse().unwrap();
        assert!((number(row, "time_s").rem_euclid(60.0) - second).abs() <= 2e-6);
    }
}

#[test]
fn an_led_that_is_always_on_a_dead_photodiode_and_saturated_ones() {
    let dir = Dir::new();
    run(&dir, "--seconds 20 --no-led --dead P6 --saturate --out out").expect(0);
    let (log, truth) = (dir.table("out/log.csv"), dir.table("out/truth/log.csv"));
    assert!(!log[0].contains_key("led") && truth.iter().all(|row| row["led"] == "1"));
    assert!(log.iter().all(|row| row["P6"] == "0.000000" && number(row, "P5") > 1.0));
    for p in ["P2", "P3"] {
        let cut = log.iter().filter(|row| number(row, p) >= 10.0 - 10.0 / 65_536.0 - 1e-6).count();
        // A fifth, but for the noise about full scale.
        assert!((cut as f64 / log.len() as f64 - 0.2).abs() <= 0.02, "{p} {cut}");
        let exact = truth.iter().filter(|row| number(row, p) + number(row, &format!("{p}_unlit")) > 10.0).count();
        assert!(exact.abs_diff(cut) <= 3, "the truth is not cut");
    }
}

#[test]
fn the_ambient_light_swings_by_what_is_asked_for() {
    for swing in [0.0, 0.1] {
        let options = LogOptions { seconds: 120.0, rate_hz: 101.0, ambient_swing: swing, ..LogOptions::default() };
        let scene = LogScene::new(options).unwrap();
        let share = scene.sensor().photodiodes[0].ambient * 0.5;
        let light = scene.samples().map(|row| (row.unlit_v[0] - scene.sensor().photodiodes[0].dark_v) / share - 1.0);
        let greatest = light.fold(0.0, |greatest: f64, part| greatest.max(part.abs()));
        assert!(greatest <= swing + 1e-12 && greatest >= 0.7 * swing, "{greatest}");
    }
}

#[test]
fn a_spiral_is_pressed_by_a_straight_finger_that_lets_go_at_its_end() {
    let dir = Dir::new();
    run(&dir, "--force spiral --spiral-seconds 30 --trail 3 --out out").expect(0);
    let rows = dir.table("out/truth/log.csv");
    let spiral = Spiral { duration_s: 30.0, ..Spiral::default() };
    for row in &rows {
        let expected = spiral.forces_n(number(row, "time_s"));
        for (force, expected) in ["Fx_N", "Fy_N", "Fz_N"].iter().zip(expected) {
            assert!((number(row, force) - expected).abs() <= 1e-12);
        }
        assert!(["J1_deg", "J2_deg", "J3_deg"].iter().all(|joint| number(row, joint) == 0.0));
    }
    let last = rows.last().unwrap();
    assert!(number(last, "time_s") > 32.9 && number(last, "Fz_N") == 0.0);
    // Blood that came back: what is left of the lag and the drift. Measured 0.0098, of a range of 0.6.
    const LEFT_V: f64 = 0.03;
    let left = number(last, "P1") - number(last, "P1_static");
    assert!(left.abs() <= LEFT_V, "{left}");
}

#[test]
fn seeds_people_and_sessions_tell_the_bytes() {
    let dir = Dir::new();
    for (name, more) in [
        ("one", ""),
        ("same", "--threads 1"),
        ("seed", "--seed 2"),
        ("subject", "--subject 2"),
        ("session", "--session 2"),
    ] {
        run(&dir, &format!("--seconds 3 --trajectory random --force random {more} --out {name}")).expect(0);
    }
    let one = dir.bytes_of("one");
    assert_eq!(one.len(), 4);
    assert!(one == dir.bytes_of("same"));
    for name in ["seed", "subject", "session"] {
        assert!(one["log.csv"] != dir.bytes_of(name)["log.csv"], "{name}");
    }
    let angles = |name: &str| {
        dir.table(&format!("{name}/truth/log.csv")).iter().map(|row| row["J2_deg"].clone()).collect::<Vec<_>>()
    };
    assert!(angles("one") == angles("subject") && angles("one") != angles("seed"));
}

#[test]
fn bad_options_are_refused_all_at_once() {
    let dir = Dir::new();
    let refused = |options: &str| run(&dir, &format!("{options} --out out")).expect(2);
    refused("--rate 0 --drop 2 --noise nan --gap 4+-1")
        .says("--rate 0: choose 0.01")
        .says("--drop 2: choose 0 to 1 of the rows")
        .says("--noise NaN: choose 0 to 10 V")
        .says("--gap 4+-1: choose a beginning and a length");
    refused("--force spiral --trajectory eq27").says("--force spiral: the finger rests while it spirals");
    refused("--force spiral --spiral-seconds 0").says("--spiral-seconds 0: choose more than 0 s");
    refused("--lead -20").says("--lead -20: the log ends before it begins");
    refused("--rate 100000 --seconds 1000000").says("more than 20000000 samples");
    refused("--dead P9").says("`P9` is no photodiode; there are P1 to P8");
    refused("--gap 11+1 --clock-jump=-1+5 --seconds 10 --trail 0")
        .says("--gap 11+1: the log is of -1 to 10 s of the video's time")
        .says("--clock-jump -1+5: the log is of -1 to 10 s");
    refused("--force-hz 1 --force spiral").says("--force-hz: the force has no such rate");
    refused("--spiral-seconds 5").says("--spiral-seconds: there is no spiral; choose --force spiral");
    refused("--gap now").says("`now` is not FROM+LENGTH");
    refused("--clock-jump 5").says("`5` is not TIME+SECONDS");
    refused("--trajectory nowhere.csv")
        .says("--trajectory is eq27, free, random, even, rest, sway or a table")
        .says("nowhere.csv");
    assert!(!dir.path("out").exists());
    refused("--protocol touch --follow 0.5 --posture-shift -1")
        .says("--follow 0.5: choose 0 to 0.4")
        .says("--posture-shift -1");
    refused("--touch-from 3").says("--touch-from: nothing is touched");
    refused("--protocol wave").says("touch-random");
    let options = LogOptions {
        trajectory: Trajectory::Given { rows: vec![[0.0; 4], [0.0; 4]] },
        force: ForceTrajectory::Random { hz: f64::NAN, seed: 1 },
        ..LogOptions::default()
    };
    let words = LogScene::new(options).unwrap_err().to_string();
    assert!(words.contains("ascending times") && words.contains("--force-hz NaN"), "{words}");
}

/// A protocol's log and truth, with the options before `--out`.
fn protocol(dir: &Dir, name: &str, options: &str) -> [Vec<BTreeMap<String, String>>; 2] {
    run(dir, &format!("--protocol {options} --out {name}")).expect(0);
    [dir.table(&format!("{name}/log.csv")), dir.table(&format!("{name}/truth/log.csv"))]
}

#[test]
fn the_protocols_are_as_long_and_cycle_as_often_as_in_the_thesis() {
    let dir = Dir::new();
    // Seconds; how often a column rises through a middle before a time.
    for (name, seconds, (column, middle, before_s), cycles) in [
        ("touch", 240, ("J2_deg", 30.0, 60.0), 6),
        ("touch-random", 120, ("J2_deg", 30.0, 20.0), 2),
        ("bending", 60, ("J2_deg", 30.0, 60.0), 6),
        ("bending-random", 60, ("Fz_N", 0.0, 60.0), 0),
        ("free-bending", 60, ("J2_deg", 30.0, 60.0), 6),
        ("normal", 100, ("Fz_N", -2.0, 100.0), 5),
        ("lateral", 100, ("Fx_N", 1.0, 100.0), 5),
        ("longitudinal", 100, ("Fy_N", 1.0, 100.0), 5),
    ] {
        let exact = "--follow 0 --posture-shift 0 --rate 10 --lead 0 --trail 0";
        let [log, truth] = protocol(&dir, name, &format!("{name} {exact}"));
        assert_eq!(log.len(), 10 * seconds, "{name}");
        let before = truth.iter().filter(|row| number(row, "time_s") < before_s);
        let values: Vec<f64> = before.map(|row| number(row, column)).collect();
        let rises = values.windows(2).filter(|pair| pair[0] < middle && pair[1] >= middle).count();
        assert_eq!(rises, cycles, "{name}");
    }
}

#[test]
fn exact_repetitions_are_the_prompt_and_others_tell_their_shift() {
    let dir = Dir::new();
    let short = "touch --bend-hz 0.2 --touch-from 10 --spiral-seconds 40 --rate 10";
    let [_, shifted] = protocol(&dir, "shifted", short);
    let [_, exact] = protocol(&dir, "exact", &format!("{short} --follow 0 --posture-shift 0"));
    let spiral = Spiral { duration_s: 40.0, ..Spiral::default() };
    for row in &exact {
        let time_s = number(row, "time_s");
        let expected = if time_s > 10.0 { spiral.forces_n(time_s - 10.0) } else { [0.0; 3] };
        for (force, expected) in ["Fx_N", "Fy_N", "Fz_N"].iter().zip(expected) {
            assert!((number(row, force) - expected).abs() <= 1e-12, "{force} at {time_s}");
        }
        assert!(time_s < 10.0 || number(row, "J2_deg") == 0.0);
    }
    let record = dir.parsed("shifted/truth/log.json");
    let shift_deg = number(&shifted[shifted.len() / 2], "J2_deg");
    assert!((record["posture_shift_deg"][1].as_f64().unwrap() - shift_deg).abs() <= 1e-9 && shift_deg != 0.0);
    assert!(record["options"]["touch_from_s"] == 10.0 && record["options"]["follow"] == 0.06);
}

#[test]
fn logs_without_a_protocol_tell_nothing_of_one() {
    let dir = Dir::new();
    run(&dir, "--seconds 2 --out out").expect(0);
    let record = String::from_utf8(dir.bytes_of("out")["truth/log.json"].clone()).unwrap();
    assert!(["follow", "posture_shift", "touch_from"].iter().all(|word| !record.contains(word)), "{record}");
    // The options of a protocol serve alone as well.
    run(&dir, "--force spiral --touch-from 4 --spiral-seconds 10 --out two").expect(0);
    let truth = dir.table("two/truth/log.csv");
    assert!(number(truth.last().unwrap(), "time_s") > 14.9, "bending, the spiral, the trail");
    assert!(truth.iter().all(|row| number(row, "time_s") > 4.0 || number(row, "Fz_N") == 0.0));
}
