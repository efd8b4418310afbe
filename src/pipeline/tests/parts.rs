//! What merging refuses, and what it brings together.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::super::{Input, MergeFault, Parts, PipelineMark, RunFault, RunOptions, Shard, Share, Task, run};
use super::super::{Results, RunReport, RunWatch};
use super::toys::{Act, Diary, Toy, from_scratch, given, mark, options, outcomes, result, results, run_with, toy};

/// A folder with what is given, and tasks: one shared, four of parts 0 to 3, one that gathers.
fn bench() -> (tempfile::TempDir, Vec<Task>) {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path();
    fs::write(dir.join("x.txt"), "x").unwrap();
    let diary = Diary::default();
    let mut tasks = vec![Task { share: Share::Each, ..toy("shared", 1, vec![given(dir, "x.txt")], &diary) }];
    for k in 0..4 {
        let inputs = vec![result("shared", "text.txt")];
        tasks.push(Task { share: Share::Part(k), ..toy(&format!("own/{k}"), k as u64, inputs, &diary) });
    }
    let all = (0..4).map(|k| Input { may_fail: true, ..result(&format!("own/{k}"), "") }).collect();
    tasks.push(toy("all", 1, all, &diary));
    (folder, tasks)
}

fn part(tasks: &[Task], dir: &Path, index: usize, of: usize) -> PathBuf {
    let out = dir.join(format!("part-{index}-{of}"));
    let report = run_with(tasks, &out, &RunOptions { shard: Shard::new(index, of), ..options(2) });
    assert_eq!(report.not_done + report.failed, 0);
    out
}

fn merge(parts: &[PathBuf], tasks: &[Task], pipeline: &PipelineMark, out: &Path) -> Result<RunReport, MergeFault> {
    let (merged, _) = Parts::open(parts)?.merge(tasks, pipeline, out)?;
    let watch = RunWatch { stop: &std::sync::atomic::AtomicBool::new(false), tick: &|_| {} };
    Ok(merged.run(tasks, &options(2), &watch)?)
}

#[test]
fn a_part_does_its_own_and_what_that_needs() {
    let (dir, tasks) = bench();
    let out = dir.path().join("part");
    let report = run_with(&tasks, &out, &RunOptions { shard: Shard::new(2, 3), ..options(2) });
    assert_eq!(outcomes(&report), ["done", "elsewhere", "done", "elsewhere", "elsewhere", "elsewhere"]);
    let other = RunOptions { shard: Shard::new(1, 3), ..options(2) };
    let watch = RunWatch { stop: &std::sync::atomic::AtomicBool::new(false), tick: &|_| {} };
    let fault = run(&tasks, &out, &other, &watch).unwrap_err();
    assert!(matches!(fault, RunFault::OtherPart { .. }), "{fault}");
    // More parts than there is work: some have nothing.
    let report = run_with(&tasks, &dir.path().join("idle"), &RunOptions { shard: Shard::new(9, 9), ..options(2) });
    assert_eq!((report.elsewhere, report.is_whole()), (6, true));
}

#[test]
fn parts_are_written_i_of_n() {
    assert_eq!("2/7".parse(), Ok(Shard::new(2, 7).unwrap()));
    for wrong in ["0/7", "8/7", "2", "2/", "/7", "a/b", "-1/2", "1/0", ""] {
        assert!(wrong.parse::<Shard>().is_err(), "{wrong}");
    }
}

#[test]
fn a_merge_is_made_again_with_what_is_new() {
    let (dir, tasks) = bench();
    let parts = [part(&tasks, dir.path(), 2, 2), part(&tasks, dir.path(), 1, 2)];
    let out = dir.path().join("out");
    let report = merge(&parts, &tasks, &mark(), &out).unwrap();
    assert_eq!((report.kept, report.done), (5, 1));
    assert_eq!(results(&out), from_scratch(&tasks));
    let again = merge(&parts, &tasks, &mark(), &out).unwrap();
    assert_eq!((again.kept, again.done), (6, 0));
    // An input that changed after the parts: its tasks are made again, whatever times say.
    fs::write(dir.path().join("x.txt"), "y").unwrap();
    assert_eq!(merge(&parts, &tasks, &mark(), &out).unwrap().done, 6);
    assert_eq!(results(&out), from_scratch(&tasks));
}

#[test]
fn a_failed_task_of_a_part_is_tried_again_by_the_merge() {
    let (dir, mut tasks) = bench();
    let mut broken = Toy { act: Act::Fail, ..Toy::default() }.task("own/1", vec![result("shared", "text.txt")]);
    broken.share = Share::Part(1);
    tasks[2] = broken;
    let folders: Vec<PathBuf> = (1..=2).map(|k| dir.path().join(format!("p{k}"))).collect();
    for (k, folder) in folders.iter().enumerate() {
        run_with(&tasks, folder, &RunOptions { shard: Shard::new(k + 1, 2), ..options(2) });
    }
    let out = dir.path().join("out");
    let report = merge(&folders, &tasks, &mark(), &out).unwrap();
    assert_eq!(outcomes(&report), ["kept", "kept", "failed", "kept", "kept", "done"]);
    assert_eq!(results(&out), from_scratch(&tasks));
}

#[test]
fn what_does_not_belong_together_is_refused_and_nothing_written() {
    let (dir, tasks) = bench();
    let out = dir.path().join("out");
    let [one, two, three] = [1, 2, 3].map(|k| part(&tasks, dir.path(), k, 3));
    let fault = |parts: &[&PathBuf], pipeline: &PipelineMark| {
        let parts: Vec<PathBuf> = parts.iter().map(|part| (*part).clone()).collect();
        let fault = merge(&parts, &tasks, pipeline, &out).unwrap_err();
        assert!(!out.exists(), "{fault}");
        fault
    };
    let error = fault(&[&three, &one], &mark()).to_string();
    assert!(error.starts_with("2/3: of 3 parts this is missing"), "{error}");
    assert!(matches!(fault(&[&one, &two, &three, &one], &mark()), MergeFault::Twice { part, .. } if part == "1/3"));
    let of_two = part(&tasks, dir.path(), 2, 2);
    assert!(matches!(fault(&[&one, &of_two], &mark()), MergeFault::Differ { .. }));
    assert!(matches!(fault(&[&one, &dir.path().to_owned()], &mark()), MergeFault::NoPart(_)));

    let changed =
        PipelineMark { decides: super::super::ContentHash::of(b"other"), text: "one\nthree\n".into(), ..mark() };
    let error = fault(&[&one, &two, &three], &changed).to_string();
    assert!(error.contains("line 2 says \"two\" and \"three\""), "{error}");
    let other = dir.path().join("other");
    let options = RunOptions { shard: Shard::new(2, 3), pipeline: changed, ..options(1) };
    run_with(&tasks, &other, &options);
    assert!(matches!(fault(&[&one, &other, &three], &mark()), MergeFault::Differ { .. }));

    let held = Results::open(&two).unwrap();
    assert!(matches!(fault(&[&one, &two, &three], &mark()), MergeFault::Busy { holder: Some(_), .. }));
    drop(held);

    let record = crate::pipeline::store::Store::new(&two).record_place("own/1");
    let hidden = record.with_extension("hidden");
    fs::rename(&record, &hidden).unwrap();
    let error = fault(&[&one, &two, &three], &mark()).to_string();
    assert!(error.contains("did not come to its end: own/1 not done; run it again with --shard 2/3"), "{error}");
    fs::rename(&hidden, &record).unwrap();

    fs::write(two.join("own/1/text.txt"), "mine").unwrap();
    assert!(matches!(fault(&[&one, &two, &three], &mark()), MergeFault::Spoilt { what: "was edited by hand", .. }));
    fs::remove_file(two.join("own/1/text.txt")).unwrap();
    assert!(matches!(fault(&[&one, &two, &three], &mark()), MergeFault::Spoilt { what: "was deleted", .. }));
}

#[test]
fn parts_that_made_different_things_of_one_name_are_refused() {
    let (dir, tasks) = bench();
    let one = part(&tasks, dir.path(), 1, 2);
    fs::write(dir.path().join("x.txt"), "changed between the parts").unwrap();
    let two = part(&tasks, dir.path(), 2, 2);
    let fault = merge(&[one, two], &tasks, &mark(), &dir.path().join("out")).unwrap_err();
    assert!(matches!(&fault, MergeFault::Overlap { task, .. } if task == "shared"), "{fault}");
}

#[test]
fn what_needs_several_parts_is_the_whole_s_whatever_it_says() {
    let dir = tempfile::tempdir().unwrap();
    let diary = Arc::default();
    let mut tasks: Vec<Task> = vec![
        toy("a", 1, vec![], &diary),
        toy("b", 1, vec![], &diary),
        toy("c", 1, vec![result("a", ""), result("b", "")], &diary),
        toy("d", 1, vec![result("c", "")], &diary),
        toy("e", 1, vec![result("a", "")], &diary),
    ];
    let shares = [Share::Part(0), Share::Part(1), Share::Part(0), Share::Part(0), Share::Each];
    tasks.iter_mut().zip(shares).for_each(|(task, share)| task.share = share);
    let report = run_with(&tasks, dir.path(), &RunOptions { shard: Shard::new(1, 2), ..options(2) });
    assert_eq!(outcomes(&report), ["done", "elsewhere", "elsewhere", "elsewhere", "elsewhere"]);
}
