//! Sessions of several devices: fingers on one clock, a force transducer beside the photodiodes.

use std::fmt::Write as _;
use std::io::{self, Write};
use std::net::{TcpListener, TcpStream};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use crate::live::desk;

/// A sensor's rows from `from_s` on: P1 is 1 V and half a volt per newton.
fn sensor(from_s: f64, step_s: f64, rows: u32, pressing_n: impl Fn(f64) -> f64) -> String {
    let mut text = "time_s,P1\n".to_owned();
    for k in 0..rows {
        let t_s = from_s + step_s * f64::from(k);
        let _ = writeln!(text, "{t_s:.4},{:.5}", 1.0 + 0.5 * pressing_n(t_s));
    }
    text
}

fn press(from_s: f64, to_s: f64) -> impl Fn(f64) -> f64 {
    move |t_s| if (from_s..to_s).contains(&t_s) { 1.0 } else { 0.0 }
}

fn cells(text: &str) -> Vec<Vec<&str>> {
    text.lines().skip(1).map(|line| line.split(',').collect()).collect()
}

#[test]
fn forces_of_a_second_device_are_recorded_at_the_times_of_samples() {
    let dir = desk();
    dir.write("p.csv", sensor(0.0, 0.013, 300, |t_s| t_s));
    let mut forces = "time_s,Fz_N\n".to_owned();
    // On a line, with a gap of half a second.
    (5..150).filter(|k| !(50..75).contains(k)).for_each(|k| {
        let t_s = 0.02 * f64::from(k);
        let _ = writeln!(forces, "{t_s:.3},{:.5}", 0.5 - 2.0 * t_s);
    });
    dir.write("f.csv", forces);
    let all = ["record", "--source", "p.csv", "--force", "f.csv", "--out"];
    dir.lunula(&[&all[..], &["j.csv"]].concat()).expect(0).says("rows have no force");
    let text = dir.text("j.csv");
    assert!(text.starts_with("time_s,P1,Fz_N\n"), "{text}");
    let mut known = 0;
    for row in cells(&text) {
        let t_s: f64 = row[0].parse().unwrap();
        let inside = (0.1..=0.98).contains(&t_s) || (1.5..=2.98).contains(&t_s);
        assert_eq!(!row[2].is_empty(), inside, "{row:?}");
        if inside {
            known += 1;
            let off = row[2].parse::<f64>().unwrap() - (0.5 - 2.0 * t_s);
            assert!(off.abs() <= 1e-9, "{row:?}");
        }
    }
    let report = dir.parsed("j.stream.json");
    assert_eq!((cells(&text).len(), report["rows_without_force"].as_u64()), (300, Some(300 - known)));
    assert_eq!(report["sources"][1]["gives"], "forces");
    // The same at any speed.
    let at = |rate: &str| [format!("p.csv?rate={rate}"), format!("f.csv?rate={rate}")];
    let [p, f] = at("20");
    dir.lunula(&["record", "--source", &p, "--force", &f, "--out", "k.csv", "-q"]).expect(0);
    assert_eq!(dir.text("k.csv"), text);
    dir.lunula(&["record", "--source", "f.csv", "--force", "p.csv", "--out", "x.csv"])
        .expect(2)
        .says("column `P1` of --force is a sensor's: were --source and --force exchanged?");
    // It is what `train` reads.
    dir.train("j.csv", "Fz_N", "j.json", &["-q"]).expect(0);
}

#[test]
fn several_fingers_are_one_stream_and_each_is_what_it_is_alone() {
    let dir = desk();
    dir.write("a.csv", sensor(0.0, 0.01, 500, press(1.0, 2.0)));
    dir.write("b.csv", sensor(0.004, 0.007, 600, press(1.5, 3.0)));
    dir.write("s.toml", "on_N = 0.5\noff_N = 0.3\n");
    dir.write("b.toml", "on_N = 0.6\noff_N = 0.3\nfinger = \"middle\"\n");
    let all = ["live", "--source", "index=a.csv", "--source", "middle=b.csv", "--model", "m.json"];
    let switches = ["--switch", "s.toml", "--switch", "b.toml", "--events", "e.jsonl", "--out", "s.csv"];
    let live = dir.lunula(&[&all[..], &switches].concat()).expect(0).stdout;
    assert!(live.starts_with("time_s,finger,Fz_N,switch\n"), "{live}");
    assert_eq!(dir.text("s.predicted.csv"), live);
    let rows = cells(&live);
    let times: Vec<f64> = rows.iter().map(|row| row[0].parse().unwrap()).collect();
    assert!(rows.len() == 1100 && times.is_sorted());
    for (finger, file, recorded) in [("index", "a.csv", "s.index.csv"), ("middle", "b.csv", "s.middle.csv")] {
        assert_eq!(dir.text(recorded), {
            dir.lunula(&["record", "--source", file, "--out", "alone.csv", "--replace", "-q"]).expect(0);
            dir.text("alone.csv")
        });
        let alone = dir.lunula(&["live", "--source", file, "--model", "m.json", "--switch", "s.toml"]).expect(0).stdout;
        let own: String = rows
            .iter()
            .filter(|row| row[1] == finger)
            .map(|row| format!("{},{},{}\n", row[0], row[2], row[3]))
            .collect();
        assert_eq!(own, alone.split_once('\n').unwrap().1, "{finger}");
    }
    // A switch whose file names its finger goes before the one of all.
    let events = dir.text("e.jsonl");
    let presses =
        |finger: &str| events.lines().filter(|line| line.contains("\"press\"") && line.contains(finger)).count();
    assert_eq!((events.lines().count(), presses("index"), presses("middle")), (4, 1, 1), "{events}");
    let skill = dir.lunula(&["skill", "s.predicted.csv", "--out", "skill"]).expect(0).stdout;
    assert!(skill.contains("index    1.00 presses") && skill.contains("touched first: index in 1"), "{skill}");
    assert!(skill.contains("middle   1.00 presses"), "{skill}");
}

#[test]
fn whose_a_source_is_has_to_be_said_and_to_be_known() {
    let dir = desk();
    dir.write("a.csv", sensor(0.0, 0.01, 50, |_| 0.0));
    dir.write("b.csv", sensor(0.0, 0.01, 50, |_| 0.0));
    dir.write("s.toml", "on_N = 0.5\noff_N = 0.3\nfinger = \"ring\"\n");
    dir.write("other.csv", dir.text("train.csv").replace("Fz_N", "J2_deg"));
    dir.train("other.csv", "J2_deg", "z.json", &["-q"]).expect(0);
    let two = ["live", "--source", "index=a.csv", "--source", "middle=b.csv"];
    let model = ["--model", "m.json"];
    for (arguments, words) in [
        (vec!["live", "--source", "a.csv", "--source", "b.csv", "--model", "m.json"], "whose it is has to be said"),
        (vec!["live", "--source", "i=a.csv", "--source", "i=b.csv", "--model", "m.json"], "two sources are `i`'s"),
        (
            [&two[..], &["--model", "ring=m.json"]].concat(),
            "no source is `ring`'s; those of --source are index, middle",
        ),
        ([&two[..], &["--model", "index=m.json"]].concat(), "no --model is middle's"),
        ([&two[..], &["--model", "index=m.json", "middle=z.json"]].concat(), "models of the same columns"),
        ([&two[..], &model, &["--switch", "s.toml"]].concat(), "is no finger's here"),
        ([&two[..], &model, &["--force", "a.csv", "--out", "o.csv"]].concat(), "whose it is has to be said"),
        (vec!["live", "--source", "a.csv", "--force", "b.csv", "--model", "m.json"], "name the recording with --out"),
        (vec!["live", "--source", "i=-", "--source", "j=-", "--model", "m.json"], "standard input is one source"),
        (vec!["live", "--source", "i=-", "--source", "j=a.csv", "--model", "m.json"], "not both"),
        ([&["mouse"], &two[1..], &model, &["--events", "e.jsonl"]].concat(), "a mouse has one finger"),
        (vec!["record", "--source", "a.csv", "--force", "b.csv", "--out", "o.csv"], "comes from the sensor too"),
    ] {
        dir.lunula(&arguments).expect(2).says(words);
    }
    // A finger of which nothing comes is named, the others are done.
    dir.write("none.csv", "time_s,P1\n");
    let live = dir.lunula(&["live", "--source", "i=a.csv", "--source", "j=none.csv", "--model", "m.json"]).expect(1);
    let live = live.says("none.csv: no row came");
    assert_eq!(live.stdout.lines().count(), 51);
}

/// A device that sends the names of its columns and then `rows`, until the program has gone.
fn device(
    names: String,
    rows: impl FnOnce(&mut TcpStream) -> io::Result<()> + Send + 'static,
) -> (String, JoinHandle<()>) {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let source = format!("tcp:{}?once", listener.local_addr().expect("an address"));
    let sends = std::thread::spawn(move || {
        let (mut stream, _) = listener.accept().expect("the program comes");
        stream.set_nodelay(true).expect("a socket");
        stream.write_all(format!("{names}\n").as_bytes()).expect("the program reads");
        let _gone = rows(&mut stream);
    });
    (source, sends)
}

/// .. of which `name` is the time since `start`, and which has a clock of its own that began long before, for
/// `seconds`.
fn clocked(start: Instant, name: &str, ahead_s: f64, every: Duration, seconds: f64) -> (String, JoinHandle<()>) {
    device(format!("time_s,{name}"), move |stream| {
        let from = Instant::now();
        while from.elapsed().as_secs_f64() < seconds {
            let t_s = start.elapsed().as_secs_f64();
            stream.write_all(format!("{:.6},{t_s:.6}\n", t_s + ahead_s).as_bytes())?;
            std::thread::sleep(every);
        }
        Ok(())
    })
}

/// .. of which `name` is the time since `start`, without a clock, in bursts of `rows`.
fn bursts(start: Instant, name: &str, rows: u32, every: Duration, count: u32) -> (String, JoinHandle<()>) {
    device(name.to_owned(), move |stream| {
        let mut from_s = start.elapsed().as_secs_f64();
        for _ in 0..count {
            std::thread::sleep(every);
            let to_s = start.elapsed().as_secs_f64();
            let made = |k: u32| from_s + (to_s - from_s) * f64::from(k + 1) / f64::from(rows);
            stream.write_all((0..rows).map(|k| format!("{:.6}\n", made(k))).collect::<String>().as_bytes())?;
            from_s = to_s;
        }
        Ok(())
    })
}

/// How far the forces of a recording are from the rows that they stand in, seconds, in order.
fn off_s(text: &str) -> Vec<f64> {
    let number = |cell: &str| cell.parse::<f64>().expect("a number");
    let rows = cells(text).into_iter().filter(|row| !row[2].is_empty());
    let mut off_s: Vec<f64> = rows.map(|row| (number(row[1]) - number(row[2])).abs()).collect();
    off_s.sort_by(f64::total_cmp);
    off_s
}

#[test]
fn devices_with_clocks_of_their_own_are_brought_together() {
    let dir = desk();
    let start = Instant::now();
    let (sensor, one) = clocked(start, "P1", 5.0, Duration::from_millis(5), 2.0);
    let (force, other) = clocked(start, "Fz_N", 9000.0, Duration::from_millis(8), 2.3);
    dir.lunula(&["record", "--source", &sensor, "--force", &force, "--out", "r.csv", "-q"]).expect(0);
    one.join().and_then(|()| other.join()).expect("the devices");
    let text = dir.text("r.csv");
    let off_s = off_s(&text);
    // Before the clocks are fitted a row is where it arrived; how late that is, is the machine's.
    assert!(off_s.len() > 100, "{} rows with a force", off_s.len());
    assert!(off_s[off_s.len() / 2] <= 0.005, "{} s in median", off_s[off_s.len() / 2]);
    // The recorded time is the sensor's own; both are rounded to a microsecond.
    assert!(
        cells(&text)
            .iter()
            .all(|row| { (row[0].parse::<f64>().unwrap() - row[1].parse::<f64>().unwrap() - 5.0).abs() <= 1.5e-6 })
    );
}

#[test]
fn forces_that_come_in_bursts_are_not_a_burst_late() {
    for (rows, every_ms, is_said) in [(20, 100, true), (1, 5, false)] {
        let dir = desk();
        let start = Instant::now();
        let (sensor, one) = clocked(start, "P1", 5.0, Duration::from_millis(5), 2.0);
        let (force, other) = bursts(start, "Fz_N", rows, Duration::from_millis(every_ms), 2400 / every_ms as u32);
        let said = dir.lunula(&["record", "--source", &sensor, "--force", &force, "--out", "r.csv"]).expect(0);
        one.join().and_then(|()| other.join()).expect("the devices");
        let said = if is_said { said.says("come in bursts") } else { said.never_says("come in bursts") };
        let off_s = off_s(&dir.text("r.csv"));
        // Of bursts it was half of one, 50 ms and more.
        assert!(off_s.len() > 100 && off_s[off_s.len() / 2] <= 0.01, "{rows}: {off_s:?} {}", said.stderr);
    }
}

#[test]
fn fingers_of_two_devices_are_on_one_clock_and_one_that_ends_stops_nobody() {
    let dir = desk();
    let start = Instant::now();
    let (index, one) = clocked(start, "P1", 5.0, Duration::from_millis(5), 1.0);
    let (middle, other) = clocked(start, "P1", 9000.0, Duration::from_millis(5), 2.0);
    let sources = ["--source", &format!("index={index}"), "--source", &format!("middle={middle}")];
    dir.lunula(&[&["record"], &sources[..], &["--out", "r.csv", "-q"]].concat()).expect(0);
    one.join().and_then(|()| other.join()).expect("the devices");
    let begin = |name: &str| {
        let text = dir.text(name);
        let rows = cells(&text);
        let mut ahead_s: Vec<f64> =
            rows.iter().map(|row| row[0].parse::<f64>().unwrap() - row[1].parse::<f64>().unwrap()).collect();
        ahead_s.sort_by(f64::total_cmp);
        let last_s: f64 = rows.last().unwrap()[1].parse().unwrap();
        (ahead_s[ahead_s.len() / 2], last_s)
    };
    let ((index_s, index_end_s), (middle_s, middle_end_s)) = (begin("r.index.csv"), begin("r.middle.csv"));
    assert!((index_s - middle_s).abs() <= 0.005, "{index_s} {middle_s}");
    assert!(middle_end_s > index_end_s + 0.5, "{index_end_s} {middle_end_s}");
}

/// A recording of the Lab Streaming Layer with one stream of P1 and P2 at 100 Hz.
#[cfg(feature = "xdf")]
fn xdf(rows: &[[f64; 3]]) -> Vec<u8> {
    let chunk = |tag: u16, content: &[u8]| {
        [&[4][..], &(content.len() as u32 + 2).to_le_bytes(), &tag.to_le_bytes(), content].concat()
    };
    let xml = "<?xml version=\"1.0\"?><info><name>a</name><channel_count>2</channel_count><nominal_srate>0\
               </nominal_srate><channel_format>double64</channel_format><desc><channels><channel><label>P1</label>\
               </channel><channel><label>P2</label></channel></channels></desc></info>";
    let sample =
        |[t_s, p1, p2]: &[f64; 3]| [&[8][..], &t_s.to_le_bytes(), &p1.to_le_bytes(), &p2.to_le_bytes()].concat();
    let samples = |rows: &[[f64; 3]]| {
        let head = [&1_u32.to_le_bytes()[..], &[1, rows.len() as u8]].concat();
        chunk(3, &[head, rows.iter().flat_map(sample).collect()].concat())
    };
    let header = chunk(2, &[&1_u32.to_le_bytes()[..], xml.as_bytes()].concat());
    [b"XDF:".to_vec(), header, rows.chunks(100).flat_map(samples).collect()].concat()
}

#[cfg(feature = "xdf")]
#[test]
fn a_recording_of_the_lab_streaming_layer_is_played_as_any_other() {
    let dir = desk();
    let rows: Vec<[f64; 3]> = (0..250).map(|k| 0.01 * f64::from(k)).map(|t_s| [5.0 + t_s, 1.0 + t_s, 2.0]).collect();
    dir.write("a.xdf", xdf(&rows));
    let live = dir.lunula(&["live", "--source", "a.xdf", "--model", "m.json", "--out", "r.csv"]).expect(0).stdout;
    assert!(dir.text("r.csv").starts_with("time_s,P1,P2\n"));
    assert_eq!((cells(&live).len(), cells(&dir.text("r.csv")).len()), (250, 250));
    for (row, [t_s, p1, _]) in cells(&live).iter().zip(&rows) {
        let [at_s, fz_n] = [row[0], row[1]].map(|cell| cell.parse::<f64>().unwrap());
        assert!((at_s - t_s).abs() <= 1e-9 && (fz_n + 2.0 * (p1 - 1.0)).abs() <= 1e-6, "{row:?}");
    }
    let predicted = dir.lunula(&["predict", "m.json", "a.xdf", "--out", "b.csv"]).expect(0);
    drop(predicted);
    assert_eq!(dir.text("b.csv"), live);
}

/// A session's rows go out as a stream of the Lab Streaming Layer, and come back from it.
#[cfg(feature = "lsl")]
#[test]
fn rows_go_out_as_a_stream_of_the_lab_streaming_layer() {
    let dir = desk();
    let name = format!("lunula-test-{}", std::process::id());
    dir.write("a.csv", sensor(0.0, 0.01, 1500, |t_s| t_s));
    let binary = || {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_lunula"));
        command.current_dir(dir.path("")).stdout(std::process::Stdio::null());
        command
    };
    let sends = ["live", "--source", "a.csv?rate=1", "--model", "m.json", "--lsl", &name, "-q"];
    let mut sends = binary().args(sends).spawn().expect("the binary runs");
    let source = format!("lsl:name={name}");
    let reads = ["record", "--source", &source, "--out", "back.csv", "--seconds", "3", "-q"];
    assert!(binary().args(reads).status().expect("the binary runs").success());
    sends.kill().and_then(|()| sends.wait()).expect("a child");
    let text = dir.text("back.csv");
    assert!(text.starts_with("time_s,Fz_N\n"), "{text}");
    // -Fz_N rises by a newton a second.
    let rows = cells(&text);
    let number = |row: &Vec<&str>, k: usize| row[k].parse::<f64>().unwrap();
    assert!(rows.len() > 250, "{}", rows.len());
    let steps = rows.windows(2).map(|pair| number(&pair[0], 1) - number(&pair[1], 1));
    assert!(steps.clone().all(|step| (step - 0.01).abs() <= 1e-6), "{:?}", steps.fold(0.0, f64::max));
}
