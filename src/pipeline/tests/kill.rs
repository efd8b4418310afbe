//! Killed at any moment: what was recorded is kept, and the end is the same bytes.

use std::collections::BTreeSet;
use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::time::Duration;

use super::super::{Input, Task};
use super::toys::{Toy, from_scratch, left_at_work, options, result, results, run_on, run_with};
use crate::job::{Maker, Work};
use crate::pipeline::store::Store;

const OUT: &str = "LUNULA_TEST_KILLED";

/// 120 tasks in three layers, which write down, outside of the results, that they begin; and one that gathers all.
fn tasks(log: &Path) -> Vec<Task> {
    let mut tasks: Vec<Task> = Vec::new();
    for layer in 0..3_u64 {
        for k in 0..40_u64 {
            let inputs: Vec<Input> = match layer {
                0 => Vec::new(),
                _ => vec![
                    result(&format!("l{}/{k}", layer - 1), "deep"),
                    result(&format!("l{}/{}", layer - 1, (k + 7) % 40), "text.txt"),
                ],
            };
            let toy = Toy { salt: 40 * layer + k, id: format!("l{layer}/{k}"), odd: true, ..Toy::default() };
            let mut task = toy.clone().task(&toy.id, inputs);
            let log = log.to_owned();
            task.job = Arc::new(move |work: &Work<'_>| {
                let mut log = fs::File::options().create(true).append(true).open(&log)?;
                log.write_all(format!("{}\n", toy.id).as_bytes())?;
                std::thread::sleep(Duration::from_millis(6));
                toy.run(work)
            });
            tasks.push(task);
        }
    }
    let all = (0..40).map(|k| result(&format!("l2/{k}"), "")).collect();
    tasks.push(Toy::default().task("all", all));
    tasks
}

/// Run, and killed, by [`killed_at_ten_moments`].
#[test]
#[ignore = "run by another test"]
fn child_that_is_killed() {
    let out = std::env::var(OUT).unwrap();
    run_with(&tasks(&Path::new(&out).with_extension("log")), Path::new(&out), &options(3));
}

#[test]
fn killed_at_ten_moments() {
    let dir = tempfile::tempdir().unwrap();
    let (out, log) = (dir.path().join("out"), dir.path().join("out.log"));
    let tasks = tasks(&log);
    let store = Store::new(&out);
    let recorded = || -> BTreeSet<String> {
        tasks.iter().filter(|task| store.record(&task.id).is_some()).map(|task| task.id.clone()).collect()
    };
    let (mut kills, mut waited) = (0, 0);
    while kills < 10 {
        let stood = recorded();
        let before = fs::read_to_string(&log).unwrap_or_default().lines().count();
        let mut child = Command::new(std::env::current_exe().unwrap())
            .args(["--ignored", "--exact", "pipeline::tests::kill::child_that_is_killed"])
            .env(OUT, &out)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        // Moments that follow no rhythm of the run's.
        waited = (waited * 5 + 17) % 43;
        let begun = || fs::read_to_string(&log).unwrap_or_default().lines().count() > before;
        while !begun() && child.try_wait().unwrap().is_none() {
            std::thread::sleep(Duration::from_micros(200));
        }
        std::thread::sleep(Duration::from_micros(waited * 300));
        child.kill().unwrap();
        child.wait().unwrap();
        kills += 1;
        let text = fs::read_to_string(&log).unwrap_or_default();
        let again: Vec<&str> = text.lines().skip(before).filter(|id| stood.contains(*id)).collect();
        assert!(again.is_empty(), "recorded and done again: {again:?}");
    }
    let stood = recorded();
    assert!(stood.len() < tasks.len(), "killed only after it was done");
    // What was under way as the last was killed may have been finished by its record.
    let report = run_on(&tasks, &out);
    assert!(report.is_whole() && report.kept >= stood.len(), "{} stood, {} kept", stood.len(), report.kept);
    assert!(left_at_work(&out).is_empty() && report.warnings.is_empty(), "{:?}", report.warnings);
    assert_eq!(results(&out), from_scratch(&tasks));
}

/// Each place where a process can end as it puts results there, one after the other.
#[test]
fn half_moved_is_finished() {
    use crate::pipeline::store::commit::{commit, files, outputs};
    use crate::pipeline::store::hashes::Hashes;
    use crate::pipeline::store::record::{FORMAT, Fingerprint, Record};

    let before = Toy { salt: 1, odd: true, ..Toy::default() }.task("a", vec![]);
    let now = Toy { salt: 2, odd: true, ..Toy::default() }.task("a", vec![]);
    let expected = from_scratch(std::slice::from_ref(&now));
    for moved in 0..=2 {
        let dir = tempfile::tempdir().unwrap();
        run_on(std::slice::from_ref(&before), dir.path());
        let store = Store::new(dir.path());
        let hashes = Hashes::look(&store.hashes());
        let work = store.work().join("1-1");
        fs::create_dir_all(files(&work)).unwrap();
        let stop = std::sync::atomic::AtomicBool::new(false);
        let folder = files(&work);
        let made =
            now.job.run(&Work { inputs: vec![], folder: &folder, before: None, threads: 1, stop: &stop }).unwrap();
        let outputs = outputs(&work, &hashes).unwrap();
        let key = Fingerprint::new(&now, vec![], vec![]).key;
        let record = Record {
            format: FORMAT,
            task: "a".into(),
            key,
            options: now.options.clone(),
            inputs: vec![],
            without: vec![],
            outputs,
            made,
            wall_s: 0.0,
            at: String::new(),
            lunula: String::new(),
        };
        fs::write(work.join("record.json"), serde_json::to_vec(&record).unwrap()).unwrap();
        for output in record.outputs.iter().take(moved) {
            fs::rename(folder.join(&output.name), dir.path().join("a").join(&output.name)).unwrap();
        }
        let report = run_on(std::slice::from_ref(&now), dir.path());
        assert_eq!((report.kept, report.warnings.len()), (1, 0), "{moved} moved: {:?}", report.warnings);
        assert_eq!(results(dir.path()), expected, "{moved} moved");
        assert!(left_at_work(dir.path()).is_empty());
        // Without its record it is nobody's.
        fs::create_dir_all(files(&work)).unwrap();
        fs::write(files(&work).join("text.txt"), "half").unwrap();
        assert_eq!(run_on(std::slice::from_ref(&now), dir.path()).kept, 1);
        assert!(left_at_work(dir.path()).is_empty());
        assert!(commit(&store, &hashes, &work, &record).is_err(), "its folder is gone");
    }
}
