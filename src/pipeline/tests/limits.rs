//! Threads and memory are bounded, and a disk that fills fails what needs room.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use super::super::{RunOptions, Task};
use super::toys::{
    Act, Diary, Toy, from_scratch, left_at_work, options, outcomes, result, results, run_on, run_with, toy,
};
use crate::job::{Made, Work};

/// Counts what toys at work take together.
#[derive(Default)]
struct Scale {
    now: AtomicU64,
    most: AtomicU64,
}

fn heavy(id: &str, bytes: u64, scale: &Arc<Scale>) -> Task {
    let mut task = toy(id, bytes, vec![], &Diary::default());
    task.memory = bytes;
    let scale = Arc::clone(scale);
    task.job = Arc::new(move |work: &Work<'_>| {
        let now = scale.now.fetch_add(bytes, Ordering::SeqCst) + bytes;
        scale.most.fetch_max(now, Ordering::SeqCst);
        std::thread::sleep(Duration::from_millis(3));
        scale.now.fetch_sub(bytes, Ordering::SeqCst);
        fs::write(work.folder.join("x.txt"), "x")?;
        Ok(Made::default())
    });
    task
}

#[test]
fn tasks_at_work_stay_within_the_memory() {
    let scale = Arc::new(Scale::default());
    let sizes = [10, 40, 60, 30, 70, 20, 90, 50, 100, 10, 10, 40, 80, 60, 30];
    let tasks: Vec<Task> = sizes.iter().enumerate().map(|(k, &size)| heavy(&format!("a/{k}"), size, &scale)).collect();
    let dir = tempfile::tempdir().unwrap();
    let bounded = |threads, memory| RunOptions { memory, ..options(threads) };
    assert!(run_with(&tasks, dir.path(), &bounded(8, 100)).warnings.is_empty());
    let most = scale.most.swap(0, Ordering::SeqCst);
    assert!((91..=100).contains(&most), "{most} at once: side by side, and no more than allowed");

    let one = tempfile::tempdir().unwrap();
    let report = run_with(&tasks, one.path(), &bounded(8, 65));
    let most = scale.most.load(Ordering::SeqCst);
    assert_eq!(most, 100, "those that are too heavy run alone");
    assert_eq!((report.done, report.warnings.len()), (sizes.len(), 4));
    assert!(report.warnings.iter().all(|warning| warning.contains("runs alone")), "{report:?}");
}

#[test]
fn threads_are_shared_and_the_longest_way_begins_first() {
    let dir = tempfile::tempdir().unwrap();
    let diary = Diary::default();
    let sleeper =
        |id: &str, inputs| Toy { act: Act::Sleep(30), diary: Arc::clone(&diary), ..Toy::default() }.task(id, inputs);
    let mut tasks: Vec<Task> = (0..4).map(|k| sleeper(&format!("short/{k}"), vec![])).collect();
    tasks.push(sleeper("long/1", vec![]));
    tasks.push(sleeper("long/2", vec![result("long/1", "")]));
    tasks.push(Task { cost_s: 2.0, ..sleeper("long/3", vec![result("long/2", "")]) });
    run_with(&tasks, dir.path(), &options(1));
    let order: Vec<String> = diary.lock().unwrap().drain(..).map(|(id, _)| id).collect();
    assert_eq!(order, ["long/1", "long/2", "long/3", "short/0", "short/1", "short/2", "short/3"]);

    let dir = tempfile::tempdir().unwrap();
    run_with(&tasks[4..], dir.path(), &options(6));
    assert!(diary.lock().unwrap().drain(..).all(|(_, threads)| threads == 6), "one at a time has all threads");
    let dir = tempfile::tempdir().unwrap();
    run_with(&tasks[..4], dir.path(), &options(6));
    assert!(diary.lock().unwrap().drain(..).all(|(_, threads)| threads <= 6));
}

const FULL: &str = "LUNULA_TEST_FULL";

fn tasks_on_a_full_disk() -> [Task; 4] {
    let diary = Diary::default();
    [
        Toy { act: Act::Big(3_000_000), ..Toy::default() }.task("big", vec![]),
        toy("small", 1, vec![], &diary),
        toy("after/big", 1, vec![result("big", "text.txt")], &diary),
        toy("after/small", 1, vec![result("small", "text.txt")], &diary),
    ]
}

/// Run by [`a_full_disk_fails_what_needs_room_and_nothing_else`] where files may not grow.
#[test]
#[ignore = "run by another test"]
fn child_on_a_full_disk() {
    let out = std::env::var(FULL).unwrap();
    let report = run_on(&tasks_on_a_full_disk(), Path::new(&out));
    fs::write(Path::new(&out).with_extension("json"), serde_json::to_vec(&report).unwrap()).unwrap();
}

#[test]
fn a_full_disk_fails_what_needs_room_and_nothing_else() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("out");
    // Files end at 1 to 2 MB, and whoever writes on gets an error instead of being killed: as a disk that is full.
    let shell =
        "trap '' XFSZ; ulimit -f 2000; exec \"$0\" --ignored --exact pipeline::tests::limits::child_on_a_full_disk";
    let child = Command::new("sh").args(["-c", shell]).arg(std::env::current_exe().unwrap()).env(FULL, &out).output();
    let child = child.unwrap();
    assert!(child.status.success(), "{}", String::from_utf8_lossy(&child.stdout));
    let report: super::super::RunReport =
        serde_json::from_slice(&fs::read(out.with_extension("json")).unwrap()).unwrap();
    assert_eq!(outcomes(&report), ["failed", "done", "not done", "done"]);
    assert!(report.failures[0].what.contains("there is no room: make some"), "{report:?}");
    assert!(left_at_work(&out).is_empty() && !out.join("big").exists());
    assert_eq!(outcomes(&run_on(&tasks_on_a_full_disk(), &out)), ["done", "kept", "done", "kept"]);
    assert_eq!(results(&out), from_scratch(&tasks_on_a_full_disk()));
}
