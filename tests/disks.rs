//! Full disks, killed runs, inputs that are no files: what is there before is there after, and the exit status says
//! what was done.

use std::os::unix::fs::symlink;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::util::Dir;

/// Runs a request where no file may grow beyond so many KiB: writes beyond fail, as on a full disk.
fn with_room(dir: &Dir, room: u32, request: &str) -> (i32, String) {
    let script = format!("trap '' XFSZ; ulimit -f {room}; exec {} {request}", env!("CARGO_BIN_EXE_lunula"));
    let output = Command::new("bash").args(["-c", &script]).current_dir(dir.path(".")).output().expect("bash runs");
    (output.status.code().unwrap_or(-1), String::from_utf8(output.stderr).expect("text"))
}

#[test]
fn on_a_full_disk_results_are_whole_or_as_they_were() {
    let dir = Dir::new();
    dir.lunula(&["phantom", "log", "--seed", "1", "--out", "lg", "-q"]).expect(0);
    dir.nail("set/rest/S1");
    let [mut refused, mut done, mut kept] = [0; 3];
    for (name, old, new) in [
        (
            "a table and its pictures",
            "simulate --until 0.1 --pf1 100 --out out/s.csv",
            "simulate --until 0.2 --pf1 900 --out out/s.csv",
        ),
        (
            "a model",
            "train lg/log.csv --target force --out out/m.json",
            "train lg/log.csv --target force --model quadratic --out out/m.json",
        ),
        ("a log", "phantom log --seed 2 --out out", "phantom log --seed 3 --seconds 9 --out out"),
        (
            "a video",
            "phantom video --seed 2 --seconds 0.1 --size 320x240 --x264 medium --out out",
            "phantom video --seed 3 --seconds 0.2 --size 320x240 --x264 medium --out out",
        ),
        ("maps", "photos set --size 100 --out out", "photos set --size 110 --out out"),
    ] {
        let run = |request: &str| dir.words(request).expect(0);
        run(new);
        let wanted = dir.results_of("out");
        std::fs::remove_dir_all(dir.path("out")).unwrap();
        run(old);
        let stood = dir.bytes_of("out");
        for room in [0, 1, 3, 8, 20, 50, 120] {
            let (code, said) = with_room(&dir, room, new);
            if code == 0 {
                done += 1;
                assert!(dir.results_of("out") == wanted, "{name}, {room} KiB: {said}");
                break;
            }
            let now = dir.bytes_of("out");
            kept += usize::from(said.contains("cannot be written") && said.contains("nothing there was changed"));
            refused += 1;
            assert_eq!(code, 2, "{name}, {room} KiB: {said}");
            assert!(now == stood, "{name}, {room} KiB: {:?} {:?}\n{said}", now.keys(), stood.keys());
        }
        std::fs::remove_dir_all(dir.path("out")).unwrap();
    }
    assert!(refused >= 10 && done >= 3 && kept >= 1, "{refused} refused, {done} done, {kept} said to change nothing");
}

#[test]
fn on_a_full_disk_a_recording_keeps_whole_rows_and_counts_them() {
    let dir = Dir::new();
    let rows: String = (0..6000).map(|k| format!("{k},{}\n", 100_000 + k)).collect();
    dir.write("1.csv", format!("time_s,P1\n{rows}"));
    let (code, said) = with_room(&dir, 32, "record --source 1.csv --out r.csv --json");
    assert_eq!(code, 1, "{said}");
    assert!(said.contains("what was recorded until then is kept"), "{said}");
    let kept = dir.text("r.csv");
    assert!(
        kept.len() > 30_000 && kept.ends_with('\n') && dir.text("1.csv").starts_with(&kept),
        "{} bytes",
        kept.len()
    );
    let lost = 6000 - (kept.lines().count() - 1);
    assert!(said.contains(&format!("{lost} rows are not recorded")), "{lost}: {said}");
    // It is as large as the files may be, and can't hold more.
    let (code, said) = with_room(&dir, 0, "record --source 1.csv --out none.csv");
    assert!(code != 0 && said.contains("can't be written"), "{said}");
}

#[test]
fn a_report_that_can_t_be_written_is_not_nothing_done() {
    let dir = Dir::new();
    dir.write(
        "p.toml",
        "[inputs.photos]\nfiles = \"set/{pose}/{subject}.png\"\n\n[stage.rest]\njob = \
                         \"normalize\"\nphoto = \"photos\"\n",
    );
    dir.nail("set/rest/S1");
    dir.write("out/report.html/mine", "");
    let run = ["run", "p.toml", "--out", "out"];
    dir.lunula(&run).expect(1).says("but not the report of it").says("report.html: is a folder");
    assert!(dir.path("out/rest").is_dir() && !dir.path("out/run.json").exists());
    // Now nothing is done.
    dir.lunula(&run).expect(2).says("report.html: is a folder");
    dir.lunula(&["run", "p.toml", "--out", "part", "--shard", "1/1", "-q"]).expect(0);
    dir.write("both/run.json/mine", "");
    let merge = ["merge", "part", "--out", "both"];
    dir.lunula(&merge).expect(1).says("run.json: is a folder");
    assert!(dir.path("both/rest").is_dir() && !dir.path("both/report.html").exists());
    dir.lunula(&merge).expect(2);
}

#[test]
fn results_and_outlines_come_together_or_not_at_all() {
    let dir = Dir::new();
    dir.nail("set/rest/S1");
    let request = ["photos", "set", "--out", "out", "--write-outlines=found"];
    dir.write("out/nails.csv/mine", "");
    dir.lunula(&request).expect(2).says("nails.csv: is a folder");
    assert!(!dir.path("found").exists() && !dir.path("out/maps").exists());
    std::fs::remove_dir_all(dir.path("out")).unwrap();
    dir.write("found/photos.csv/mine", "");
    dir.lunula(&request).expect(2).says("photos.csv: is a folder");
    assert!(!dir.path("out").exists());
    std::fs::remove_dir_all(dir.path("found")).unwrap();
    dir.lunula(&request).expect(0);
    assert!(dir.path("found/photos.csv").is_file() && dir.path("out/nails.csv").is_file());
}

fn hidden(dir: &Dir, folder: &str) -> Vec<String> {
    let entries = std::fs::read_dir(dir.path(folder)).into_iter().flatten().flatten();
    entries.filter_map(|entry| entry.file_name().into_string().ok()).filter(|name| name.starts_with('.')).collect()
}

fn start(dir: &Dir, request: &str) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_lunula"));
    command.args(request.split(' ')).current_dir(dir.path(".")).stdout(Stdio::null()).stderr(Stdio::piped());
    command.spawn().expect("the binary runs")
}

#[test]
fn what_a_killed_run_left_is_cleared_and_what_runs_is_left_alone() {
    let dir = Dir::new();
    let mut long = start(&dir, "phantom video --seed 1 --seconds 60 --out out -q");
    let begun = Instant::now();
    let at_work = loop {
        let there = hidden(&dir, "out");
        if let Some(first) = there.iter().find(|name| dir.path("out").join(name).join(".lock").exists()) {
            break first.clone();
        }
        assert!(begun.elapsed() < Duration::from_secs(60) && long.try_wait().unwrap().is_none(), "{there:?}");
        std::thread::sleep(Duration::from_millis(5));
    };
    // Its lock comes at once after its file.
    std::thread::sleep(Duration::from_millis(100));
    dir.lunula(&["phantom", "log", "--seed", "1", "--out", "out", "-q"]).expect(0);
    assert_eq!(hidden(&dir, "out"), [at_work]);
    long.kill().unwrap();
    long.wait().unwrap();
    assert_eq!(hidden(&dir, "out").len(), 1, "a kill leaves it");
    dir.lunula(&["phantom", "log", "--seed", "2", "--out", "out", "-q"]).expect(0);
    assert_eq!(hidden(&dir, "out"), [""; 0]);
}

#[test]
fn a_phantom_killed_between_its_renames_can_be_run_again() {
    let dir = Dir::new();
    let request = "phantom photos --seed 1 --subjects 1 --poses extension --size 160x120 --out out -q";
    dir.words(request).expect(0);
    let whole = dir.bytes_of("out");
    // The first folder was taken from its place, and the new one is not there yet.
    dir.write("out/.lunula-killed/.lock", "");
    dir.write("out/.lunula-killed/.before/0.place", "truth");
    std::fs::rename(dir.path("out/truth"), dir.path("out/.lunula-killed/.before/0")).unwrap();
    dir.words(request).expect(0);
    assert!(dir.bytes_of("out") == whole);
    // The first time, when only one of both has come to its place.
    std::fs::remove_dir_all(dir.path("out/photos")).unwrap();
    dir.words(request).expect(0);
    assert!(dir.bytes_of("out") == whole);
    // Somebody else's is in the way as ever.
    std::fs::remove_dir_all(dir.path("out/truth")).unwrap();
    dir.words(request).expect(2).says("stands already");
}

#[test]
fn pipes_are_read_devices_are_refused_and_a_wait_ends_at_once() {
    let dir = Dir::new();
    dir.lunula(&["phantom", "log", "--seed", "1", "--out", "lg", "-q"]).expect(0);
    let train = |data: &str| dir.lunula(&["train", data, "--target", "force", "--out", "m.json", "-q"]);
    symlink("/dev/zero", dir.path("zero.csv")).unwrap();
    train("zero.csv").expect(2).says("zero.csv").says("is a device");
    let pipe = dir.path("pipe.csv");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let text = std::fs::read(dir.path("lg/log.csv")).unwrap();
    let writer = std::thread::spawn({
        let pipe = pipe.clone();
        move || std::fs::write(pipe, text).unwrap()
    });
    train("pipe.csv").expect(0);
    writer.join().unwrap();
    // Nobody writes.
    let mut waiting = start(&dir, "train pipe.csv --target force --out other.json");
    std::thread::sleep(Duration::from_millis(300));
    assert!(waiting.try_wait().unwrap().is_none(), "it waits");
    let interrupted = Instant::now();
    let kill = format!("kill -INT {}", waiting.id());
    assert!(Command::new("bash").args(["-c", &kill]).status().unwrap().success());
    let status = waiting.wait().unwrap();
    assert!(interrupted.elapsed() < Duration::from_secs(5), "{:?}", interrupted.elapsed());
    assert_eq!(status.code(), Some(130));
    assert!(!dir.path("other.json").exists());
}
