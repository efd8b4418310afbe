//! What every command leaves behind where the disk is full, breaks, or the process is killed, at each of its calls that
//! change files.
//!
//! After a fault: with exit status 2 every file is as it was and none is new; with 0 all results are there; with 1
//! standard error says what failed; and always each file is whole, an earlier run's or this one's, and the same command
//! run again gives the same bytes as one that nothing disturbed and leaves nothing else. Hidden leftovers are the next
//! run's to clear.
//!
//! `cargo test` tries a few calls of the fast commands. All calls of all commands print a table:
//! `LUNULA_FAULTS=all cargo test --features xdf --test all faults:: -- --nocapture`; a command's name in place of `all`
//! tries that one. With `TMPDIR` in memory it takes half an hour, as no disk is waited for, but for `phantom study`,
//! whose 3500 calls take most of a day:
//! `LUNULA_FAULTS_EVERY=211` tries every 211th, from the last on.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::util::{Dir, repository, touch_pipeline};

/// A command that writes below `out`: the run that left results there before (none: it refuses to write over any), and
/// the one that is disturbed.
struct Job {
    name: &'static str,
    before: &'static str,
    run: &'static str,
    /// Whether a run takes less than about a fifth of a second.
    fast: bool,
}

const fn fast(name: &'static str, before: &'static str, run: &'static str) -> Job {
    Job { name, before, run, fast: true }
}

const fn slow(name: &'static str, before: &'static str, run: &'static str) -> Job {
    Job { name, before, run, fast: false }
}

/// Paths are relative to the test's folder; inputs are those of [`inputs`]. Without `tradeoff`, the results of which
/// are times.
const JOBS: &[Job] = &[
    fast("photos", "photos in/s01 --size 16 --out out/maps", "photos in/both --size 16 --out out/maps"),
    slow(
        "photos --write-outlines",
        "photos in/s01 --outline detect --write-outlines=out/drawn --size 24 --out out/maps",
        "photos in/s01 --outline detect --write-outlines=out/drawn --size 16 --out out/maps",
    ),
    fast("photos merge", "photos merge in/maps1 --out out/maps", "photos merge in/maps1 in/maps2 --out out/maps"),
    slow(
        "posture",
        "posture in/video/video.mp4 --markers in/video/markers.toml --out out/j.csv --no-clock",
        "posture in/video/video.mp4 --markers in/video/markers.toml --out out/j.csv --no-clock --smooth \
         --tracks out/tracks.csv --overlay out/overlay.mp4",
    ),
    slow(
        "camera",
        "camera in/board/views --board 5x4 --square-mm 20 --coefficients 0 --out out/camera.toml",
        "camera in/board/views --board 5x4 --square-mm 20 --coefficients 4 --out out/camera.toml",
    ),
    fast(
        "align",
        "align --joints in/video/truth/joints.csv --log in/bend/log.csv --sync offset=59.5 --out out/set.csv",
        "align --joints in/video/truth/joints.csv --log in/bend/log.csv --sync offset=59.6 --out out/set.csv \
         --mot out/set.mot --dlc out/tracks.csv --tracks in/video/truth/tracks.csv",
    ),
    fast(
        "align --bids",
        "align --joints in/video/truth/joints.csv --log in/bend/log.csv --sync offset=59.5 --bids out/bids --task bend \
         --subject S01 --out out/set.parquet",
        "align --joints in/video/truth/joints.csv --log in/bend/log.csv --sync offset=59.6 --bids out/bids --task bend \
         --subject S01 --out out/set.parquet",
    ),
    fast(
        "train",
        "train in/a.csv --target force --validate in/b.csv --out out/model.json",
        "train in/a.csv --target posture --validate in/b.csv --out out/model.json",
    ),
    fast(
        "train --learning-curve",
        "train in/a.csv in/b.csv --target force --validate in/c.csv --out out/model.json --learning-curve \
         out/curve.csv",
        "train in/a.csv in/c.csv --target force --validate in/b.csv --out out/model.json --learning-curve \
         out/curve.csv",
    ),
    fast(
        "evaluate",
        "evaluate in/force.json in/b.csv --out out/errors",
        "evaluate in/force.json in/c.csv --out out/errors",
    ),
    fast(
        "predict",
        "predict in/force.json in/b.csv --out out/predicted.csv",
        "predict in/force.json in/posture.json in/b.csv --out out/predicted.csv",
    ),
    fast("analyse", "analyse in/force.json --out out/modes", "analyse in/force2.json --out out/modes"),
    fast(
        "prune",
        "prune in/a.csv --validate in/b.csv --out out/prune",
        "prune in/a.csv --validate in/c.csv --out out/prune",
    ),
    fast("layout", "layout in/a.csv --k 1..2 --out out/layout", "layout in/b.csv --k 1..2 --out out/layout"),
    slow(
        "trajectory",
        "trajectory force --seconds 20 --out out/path.csv",
        "trajectory random --seconds 20 --out out/path.csv",
    ),
    fast(
        "simulate",
        "simulate --pf1 step:5000@0..0.2 --until 0.4 --every 0.1 --out out/steps.csv",
        "simulate --pf1 step:6000@0..0.2 --until 0.4 --every 0.1 --out out/steps.csv",
    ),
    fast(
        "simulate --static",
        "simulate --static 0..2000/1000 --load distal --out out/static.csv",
        "simulate --static 0..3000/1000 --load distal --out out/static.csv",
    ),
    fast("fit", "fit in/press.csv --free b_V --out out/fit.json", "fit in/press.csv --free k_V --out out/fit.json"),
    fast(
        "performance",
        "performance in/trials.csv --path-m 1.42 --speed-mps 0.025 --decisions 27 --out out/learned",
        "performance in/trials.csv --path-m 1.42 --speed-mps 0.05 --decisions 27 --out out/learned",
    ),
    fast(
        "switch tune",
        "switch tune in/touch/log.csv --model in/touch.json --contact Fz_N<-0.3 --missed 0.9 --outside count \
         --out out/s.toml",
        "switch tune in/touch/log.csv --model in/touch.json --contact Fz_N<-0.2 --missed 0.9 --outside count \
         --out out/s.toml",
    ),
    fast(
        "switch evaluate",
        "switch evaluate in/s.toml in/touch/log.csv --model in/touch.json --contact Fz_N<-0.3 --out out/judged",
        "switch evaluate in/s.toml in/touch/log.csv --model in/touch.json --contact Fz_N<-0.2 --out out/judged",
    ),
    fast("skill", "skill in/a.csv --out out/skill", "skill in/b.csv --out out/skill"),
    fast(
        "phantom photos",
        "phantom photos --seed 1 --subjects 1 --poses normal --size 120x90 --no-normalized --out out/scene",
        "phantom photos --seed 2 --subjects 1 --poses normal --size 120x90 --no-normalized --out out/scene",
    ),
    slow(
        "phantom board",
        "phantom board --board 5x4 --seed 1 --views 2 --size 160x120 --out out/scene",
        "phantom board --board 5x4 --seed 2 --views 2 --size 160x120 --out out/scene",
    ),
    slow(
        "phantom video",
        "phantom video --seed 1 --seconds 0.3 --size 320x240 --fps 15 --no-hide --out out/scene",
        "phantom video --seed 2 --seconds 0.3 --size 320x240 --fps 15 --no-hide --out out/scene",
    ),
    fast(
        "phantom log",
        "phantom log --seed 1 --seconds 2 --rate 20 --out out/scene",
        "phantom log --seed 2 --seconds 2 --rate 20 --out out/scene",
    ),
    slow(
        "phantom study",
        "phantom study --seed 1 --subjects 1 --sensors 1 --presses 1 --seconds 1 --video-size 160x120 --fps 5 --out \
         out/study",
        "phantom study --seed 2 --subjects 1 --sensors 1 --presses 1 --seconds 1 --video-size 160x120 --fps 5 --out \
         out/study",
    ),
    fast("run", "run in/before.toml --out out/run", "run in/after.toml --out out/run"),
    fast("merge", "merge in/before1 in/before2 --out out/run", "merge in/after1 in/after2 --out out/run"),
    // It never writes over a file.
    fast("init", "", "init in/both --out out/pipeline.toml"),
    fast("man", "man --out out/man", "man --out out/man"),
];

fn inputs(dir: &Dir) {
    let noise = |row: usize| ((row * 7919 + row * row * 31) % 1009) as f64 / 1009.0;
    for (name, first, rows) in [("a", 0, 60), ("b", 100, 40), ("c", 200, 40)] {
        let mut text = "time_s,P1,P2,Fx_N,Fy_N,Fz_N,J2_deg\n".to_owned();
        for row in first..first + rows {
            let (a, b, c) = (noise(row), noise(row + 5000), noise(row + 9000) / 50.0);
            let _ = writeln!(text, "{row},{a},{b},{},{b},{},{}", a - b + c, c - a - b, 30.0 * a + c);
        }
        dir.write(&format!("in/{name}.csv"), text);
    }
    dir.write("in/s.toml", "on_N = 0.5\noff_N = 0.3\n");
    dir.write("in/trials.csv", "operator,method,trial,time_s\nA,pendant,1,200\nA,virtual,1,100\n");
    let photos = |more: &str, out: &str| {
        let line = format!("phantom photos --subjects 1 --poses normal --size 160x120 --no-normalized --out {out}");
        dir.run(&format!("{line} {more}"));
    };
    photos("--seed 1", "in/scene1");
    photos("--seed 2", "in/scene2");
    for (to, subjects) in [("s01", &[1][..]), ("s02", &[2]), ("both", &[1, 2])] {
        for k in subjects {
            for ending in ["png", "json"] {
                let from = dir.path(&format!("in/scene{k}/photos/normal/s01.{ending}"));
                std::fs::copy(from, dir.place(&format!("in/{to}/normal/s0{k}.{ending}"))).expect("a file");
            }
        }
    }
    for (name, seed) in [("before", 1), ("after", 3)] {
        let sessions = [("a", seed), ("b", 2)];
        let named = "name = \"touch\"\n".to_owned() + &touch_pipeline(&sessions, "seconds = 4, rate = 25");
        dir.write(&format!("in/{name}.toml"), named);
        for part in [1, 2] {
            dir.run(&format!("run in/{name}.toml --shard {part}/2 --out in/{name}{part}"));
        }
    }
    for line in [
        "photos in/s01 --size 16 --out in/maps1",
        "photos in/s02 --size 16 --out in/maps2",
        "phantom video --seconds 0.4 --size 320x240 --fps 15 --no-hide --start --out in/video",
        "phantom board --board 5x4 --views 4 --size 320x240 --out in/board",
        "phantom log --seconds 3 --rate 50 --protocol bending --out in/bend",
        "phantom log --seconds 30 --rate 25 --protocol contacts --seed 4 --out in/touch",
        "train in/touch/log.csv --target force --out in/touch.json",
        "train in/a.csv --target force --validate in/b.csv --out in/force.json",
        "train in/b.csv --target force --validate in/a.csv --out in/force2.json",
        "train in/a.csv --target posture --validate in/b.csv --out in/posture.json",
        "simulate --pf1 step:5000@0..1 --until 2 --every 0.1 --with-loads --no-figures --out in/press.csv",
    ] {
        dir.run(line);
    }
}

impl Dir {
    fn run(&self, line: &str) {
        let answer = self.lunula(&line.split_whitespace().chain(["-q"]).collect::<Vec<_>>());
        assert_eq!(answer.code, 0, "{line}\n{}", answer.stderr);
    }
}

/// Files by name, those below hidden folders too.
type Files = BTreeMap<String, Vec<u8>>;

/// What is put where the call is.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Fault {
    /// An error of the system.
    Fails(i32),
    Killed,
}

const ENOSPC: i32 = 28;
const EIO: i32 = 5;

struct Ended {
    code: i32,
    stderr: String,
    calls: usize,
}

impl Ended {
    /// Which call the fault was put at.
    fn place(&self) -> &str {
        self.stderr.lines().find(|line| line.starts_with("fault: ")).unwrap_or("fault: none")
    }
}

/// A job, tried.
struct Bench<'a> {
    dir: &'a Dir,
    inject: PathBuf,
    job: &'a Job,
    /// What stands below `out` before.
    before: Files,
    /// What stands there after a run that nothing disturbed.
    after: Files,
    /// Those that are never the same twice: they hold times.
    timed: BTreeSet<String>,
    calls: usize,
}

fn is_hidden(name: &str) -> bool {
    name.split('/').any(|part| part.starts_with('.'))
}

fn seen(files: &Files) -> impl Iterator<Item = (&String, &Vec<u8>)> {
    files.iter().filter(|(name, _)| !is_hidden(name))
}

/// The hidden file or folder that a file is or is in.
fn leftover(name: &str) -> &str {
    let start = if name.starts_with('.') { 0 } else { name.find("/.").map_or(0, |at| at + 1) };
    name[start..].find('/').map_or(name, |end| &name[..start + end])
}

fn hidden(files: &Files) -> BTreeSet<&String> {
    files.keys().filter(|name| is_hidden(name)).collect()
}

impl<'a> Bench<'a> {
    /// With results of an earlier run, or with none.
    fn new(dir: &'a Dir, inject: &Path, job: &'a Job, earlier: bool) -> Self {
        let (inject, none) = (inject.to_owned(), Files::new());
        let mut bench = Self { dir, inject, job, before: none.clone(), after: none, timed: BTreeSet::new(), calls: 0 };
        if earlier && !job.before.is_empty() {
            bench.restore();
            dir.run(job.before);
            bench.before = bench.now();
        }
        let mut twice = [(); 2].map(|()| {
            bench.restore();
            let ended = bench.run(0, Fault::Killed);
            assert_eq!(ended.code, 0, "{}: {}", job.run, ended.stderr);
            bench.calls = ended.calls;
            bench.now()
        });
        let [one, other] = &mut twice;
        // Times may be the same twice by chance.
        let timed = |(name, bytes): &(&String, &Vec<u8>)| {
            ["run.json", "report.html"].iter().any(|end| name.ends_with(end)) || other.get(*name) != Some(*bytes)
        };
        bench.timed = seen(one).filter(timed).map(|(name, _)| name.clone()).collect();
        let other = bench.timed.iter().find(|name| !name.ends_with(".json") && !name.ends_with(".html"));
        assert_eq!(other, None, "{}: not the same twice", job.run);
        bench.after = std::mem::take(one);
        bench
    }

    fn now(&self) -> Files {
        if self.dir.path("out").exists() { self.dir.bytes_of("out") } else { Files::new() }
    }

    fn restore(&self) {
        let out = self.dir.path("out");
        if out.exists() {
            std::fs::remove_dir_all(&out).expect("the folder of results goes");
        }
        std::fs::create_dir(&out).expect("a folder");
        self.before.iter().for_each(|(name, bytes)| self.dir.write(&format!("out/{name}"), bytes));
    }

    fn run(&self, call: usize, fault: Fault) -> Ended {
        let error = if let Fault::Fails(error) = fault { error } else { 0 };
        let root = self.dir.path("").canonicalize().expect("a folder");
        let output = Command::new(&self.inject)
            .args([root.join("out").as_os_str(), call.to_string().as_ref(), error.to_string().as_ref()])
            .arg(env!("CARGO_BIN_EXE_lunula"))
            .args(self.job.run.split_whitespace())
            .args(["-q", "--threads", "1"])
            .current_dir(&root)
            .output()
            .expect("the injector runs");
        let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
        let calls = stderr.lines().rev().find_map(|line| line.strip_prefix("calls: ")?.parse().ok());
        let code = output.status.code().unwrap_or(-1);
        assert!(code != 120, "faults can't be injected here (ptrace and seccomp are needed): {stderr}");
        Ended { code, calls: calls.expect("the injector counts"), stderr }
    }

    /// Whether a file's bytes are those of the disturbed run, as far as they can be known.
    fn is_new(&self, name: &str, bytes: &[u8]) -> bool {
        if !self.timed.contains(name) {
            return self.after.get(name).is_some_and(|after| after == bytes);
        }
        match name.ends_with(".json") {
            true => serde_json::from_slice::<serde_json::Value>(bytes).is_ok(),
            false => bytes.trim_ascii_end().ends_with(b"</html>"),
        }
    }

    /// A fault at a call, and the same command again: the exit status, and what is wrong.
    fn try_at(&self, call: usize, fault: Fault) -> (i32, Vec<String>) {
        self.restore();
        let ended = self.run(call, fault);
        let now = self.now();
        let mut wrong = Vec::new();
        for (name, bytes) in seen(&now) {
            let (old, new) = (self.before.get(name) == Some(bytes), self.is_new(name, bytes));
            match (ended.code, old, new) {
                (2, true, _) | (1 | 137, true, _) | (0 | 1 | 137, _, true) => {}
                (2, false, _) if self.before.contains_key(name) => wrong.push(format!("{name} was changed")),
                (2, false, _) => wrong.push(format!("{name} is new")),
                (0, true, _) if !self.after.contains_key(name) => wrong.push(format!("{name} was not removed")),
                (0, true, _) => wrong.push(format!("{name} is the earlier run's")),
                _ => wrong.push(format!("{name} is neither the earlier run's nor this one's")),
            }
        }
        // What was killed may have put an earlier file aside for the next run to bring back or replace.
        let lacking = |needed: &Files, what: &str| -> Vec<String> {
            let gone = seen(needed).filter(|(name, _)| !now.contains_key(*name) && self.after.contains_key(*name));
            gone.map(|(name, _)| format!("{name} {what}")).collect()
        };
        match ended.code {
            0 => wrong.extend(lacking(&self.after, "is missing")),
            137 => {}
            _ => wrong.extend(lacking(&self.before, "is gone")),
        }
        let said = ended.stderr.lines().filter(|line| !line.starts_with("fault: ") && !line.starts_with("calls: "));
        let said: Vec<&str> = said.filter(|line| !line.is_empty()).collect();
        match (ended.code, fault) {
            (137, Fault::Killed) => {}
            (0, _) => {}
            (1 | 2, Fault::Fails(_)) if said.is_empty() => wrong.push("standard error says nothing".to_owned()),
            (1 | 2, Fault::Fails(_)) => {}
            _ => wrong.push(format!("exit status {}", ended.code)),
        }
        let again = self.run(0, Fault::Killed);
        let then = self.now();
        if again.code == 2 && self.job.before.is_empty() && seen(&then).eq(seen(&self.after)) {
            // It was there.
        } else if again.code == 0 {
            for name in self.after.keys().chain(then.keys()).filter(|name| !is_hidden(name)).collect::<BTreeSet<_>>() {
                match then.get(name) {
                    None => wrong.push(format!("again: {name} is missing")),
                    Some(bytes) if !self.is_new(name, bytes) => {
                        wrong.push(format!("again: {name} is not as undisturbed"))
                    }
                    Some(_) => {}
                }
            }
            let left: BTreeSet<&str> =
                hidden(&then).difference(&hidden(&self.after)).map(|name| leftover(name)).collect();
            if !left.is_empty() {
                wrong.push(format!("again: left {}", Vec::from_iter(left).join(", ")));
            }
        } else {
            wrong.push(format!("again: exit status {}: {}", again.code, again.stderr.trim()));
        }
        let context = format!(
            "{} | {} | {fault:?} at {call} of {} ({}), exit status {}",
            self.job.name,
            if self.before.is_empty() { "nothing before" } else { "results before" },
            self.calls,
            ended.place(),
            ended.code
        );
        let heard = said.first().map_or(String::new(), |line| format!(" [{line}]"));
        (ended.code, wrong.into_iter().map(|what| format!("{context}: {what}{heard}")).collect())
    }
}

/// Exit statuses of many faults.
#[derive(Default)]
struct Tally {
    points: usize,
    statuses: BTreeMap<i32, usize>,
    wrong: usize,
}

impl Tally {
    fn add(&mut self, (code, wrong): &(i32, Vec<String>)) {
        self.points += 1;
        *self.statuses.entry(*code).or_default() += 1;
        self.wrong += usize::from(!wrong.is_empty());
    }

    fn line(&self) -> String {
        let of = |code| self.statuses.get(&code).copied().unwrap_or(0);
        format!("{:>7} {:>6} {:>6} {:>6} {:>6} {:>6}", self.points, of(2), of(1), of(0), of(137), self.wrong)
    }
}

#[test]
fn a_fault_at_any_call_leaves_results_whole_and_the_next_run_makes_them_right() {
    let chosen = std::env::var("LUNULA_FAULTS").ok();
    let dir = Dir::new();
    inputs(&dir);
    let inject = dir.path("inject");
    let source = repository().join("tests/faults/inject.c");
    let built = Command::new("cc").args(["-O1", "-o"]).arg(&inject).arg(source).status().expect("cc runs");
    assert!(built.success());
    let every = std::env::var("LUNULA_FAULTS_EVERY").map_or(1, |every| every.parse().expect("a number of calls"));
    let mut wrong = Vec::new();
    let mut tried = 0;
    if chosen.is_some() {
        eprintln!("{:<24} {:>7} {:>6} {:>6} {:>6} {:>6} {:>6}", "command", "points", "2", "1", "0", "killed", "wrong");
    }
    for (k, job) in JOBS.iter().enumerate() {
        match &chosen {
            None if !job.fast => continue,
            Some(name) if name != "all" && name != job.name => continue,
            _ => {}
        }
        let mut tally = Tally::default();
        let mut try_at = |bench: &Bench<'_>, call, fault| {
            let tried = bench.try_at(call, fault);
            tally.add(&tried);
            if chosen.is_some() {
                tried.1.iter().for_each(|what| eprintln!("wrong: {what}"));
            }
            wrong.extend(tried.1);
        };
        let fails = |call: usize| Fault::Fails(if call.is_multiple_of(2) { ENOSPC } else { EIO });
        if chosen.is_none() {
            let bench = Bench::new(&dir, &inject, job, true);
            // Others in each job, the same in each run.
            let call = |point: usize| 1 + (k * 37 + point * 101) % bench.calls;
            for (point, fault) in [fails(k), Fault::Killed, fails(k + 1)].into_iter().enumerate() {
                try_at(&bench, call(point), fault);
            }
        } else {
            let states: &[bool] = if job.before.is_empty() { &[false] } else { &[true, false] };
            for bench in states.iter().map(|&earlier| Bench::new(&dir, &inject, job, earlier)) {
                for call in (1..=bench.calls).rev().step_by(every) {
                    try_at(&bench, call, fails(call));
                    try_at(&bench, call, Fault::Killed);
                }
            }
        }
        tried += tally.points;
        if chosen.is_some() {
            eprintln!("{:<24} {}", job.name, tally.line());
        }
    }
    assert!(wrong.is_empty(), "{} of {tried} faults:\n{}", wrong.len(), wrong.join("\n"));
    assert!(tried >= if chosen.is_some() { 1 } else { 3 * 18 }, "{tried} faults");
}
