//! What the engine itself takes.

use std::fs;
use std::time::Instant;

use super::toys::{Diary, given, options, result, run_with, toy};

/// 1000 tasks: 500 on given files, 500 on those.
#[test]
#[ignore = "measures; run with --ignored --nocapture"]
fn a_thousand_tasks() {
    let dir = tempfile::tempdir().unwrap();
    let diary = Diary::default();
    let mut tasks = Vec::new();
    for k in 0..500 {
        let name = format!("{k}.txt");
        fs::write(dir.path().join(&name), &name).unwrap();
        tasks.push(toy(&format!("a/{k}"), 1, vec![given(dir.path(), &name)], &diary));
        tasks.push(toy(&format!("b/{k}"), 1, vec![result(&format!("a/{k}"), "")], &diary));
    }
    let out = dir.path().join("out");
    for (what, threads) in [("made, 1 thread", 1), ("again", 1), ("again, 4 threads", 4)] {
        let start = Instant::now();
        let report = run_with(&tasks, &out, &options(threads));
        let took = start.elapsed().as_secs_f64();
        println!("{what}: {took:.3} s, that is as many ms a task, {} done", report.done);
        assert!(report.is_whole());
    }
    let start = Instant::now();
    super::super::survey(&tasks, &out).unwrap();
    println!("survey: {:.3} s", start.elapsed().as_secs_f64());
    let start = Instant::now();
    for task in &tasks {
        let folder = dir.path().join("bare").join(&task.id);
        fs::create_dir_all(folder.join("deep")).unwrap();
        ["text.txt", "deep/more.txt"].iter().for_each(|name| fs::write(folder.join(name), "text").unwrap());
    }
    println!("the files alone: {:.3} s", start.elapsed().as_secs_f64());
}
