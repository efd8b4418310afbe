//! What fails fails its own branch; everything else is done.

use std::fs;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::super::{Event, GraphFault, Input, Outcome, Results, RunFault, RunWatch, Standing, Why, run, survey};
use super::toys::{
    Act, Diary, Toy, folder_and_diary, from_scratch, given, left_at_work, options, outcomes, ran, result, results,
    run_on, toy,
};
use crate::job::{Made, Work};

fn failing(id: &str, act: Act, diary: &Diary) -> super::super::Task {
    Toy { act, diary: Arc::clone(diary), ..Toy::default() }.task(id, vec![])
}

#[test]
fn a_branch_fails_alone_and_is_tried_again() {
    let (dir, diary) = folder_and_diary();
    let tasks = |act: Act| {
        [
            failing("a/1", act, &diary),
            toy("a/2", 1, vec![], &diary),
            toy("b/1", 1, vec![result("a/1", "text.txt")], &diary),
            toy("b/2", 1, vec![result("a/2", "text.txt")], &diary),
            toy("c", 1, vec![result("b/1", ""), result("b/2", "")], &diary),
            toy(
                "d",
                1,
                vec![Input { may_fail: true, ..result("b/1", "") }, Input { may_fail: true, ..result("b/2", "") }],
                &diary,
            ),
        ]
    };
    for (act, what) in [(Act::Fail, "the toy is broken"), (Act::Panic, "the program has a fault here: the toy fell")] {
        let report = run_on(&tasks(act.clone()), dir.path());
        assert_eq!(outcomes(&report)[..3], ["failed", outcomes(&report)[1], "not done"]);
        assert_eq!(outcomes(&report)[4], "not done");
        assert_eq!((report.failed, report.not_done), (1, 2));
        let reasons: Vec<&str> = report.failures.iter().map(|failure| failure.what.as_str()).collect();
        assert_eq!(reasons, [what, "needs a/1, which failed", "needs b/1, which needs a/1, which failed"]);
        assert_eq!(report.tasks[5].without, ["b/1"]);
        assert_eq!(survey(&tasks(act), dir.path()).unwrap()[0], Standing::Run(Why::Failed(what.into())));
    }
    ran(&diary);
    // What was done without it is done with it as soon as it is there.
    let report = run_on(&tasks(Act::Nothing), dir.path());
    assert_eq!(outcomes(&report), ["done", "kept", "done", "kept", "done", "done"]);
    assert_eq!(results(dir.path()), from_scratch(&tasks(Act::Nothing)));
    assert_eq!(survey(&tasks(Act::Nothing), dir.path()).unwrap(), vec![Standing::Done; 6]);
}

#[test]
fn a_task_whose_gathered_inputs_all_failed_says_so() {
    let (dir, diary) = folder_and_diary();
    let tasks =
        [failing("a", Act::Fail, &diary), toy("b", 1, vec![Input { may_fail: true, ..result("a", "") }], &diary)];
    let report = run_on(&tasks, dir.path());
    assert_eq!(report.tasks[1].outcome, Outcome::Failed("nothing to work on: all of its in failed".into()));
}

#[test]
fn a_failure_is_forgotten_where_the_inputs_are_again_what_they_were() {
    let dir = tempfile::tempdir().unwrap();
    run_on(&[toy("a", 0, vec![], &Diary::default())], dir.path());
    let broken = Toy { salt: 1, act: Act::Fail, ..Toy::default() }.task("a", vec![]);
    run_on(&[broken], dir.path());
    let store = crate::pipeline::store::Store::new(dir.path());
    assert_eq!(store.failure("a").unwrap().what, "the toy is broken");
    assert_eq!(outcomes(&run_on(&[toy("a", 0, vec![], &Diary::default())], dir.path())), ["kept"]);
    assert_eq!(store.failure("a"), None);
}

#[test]
fn what_stood_before_a_failure_stands() {
    let (dir, diary) = folder_and_diary();
    run_on(&[toy("a", 0, vec![], &diary)], dir.path());
    let made = results(dir.path());
    let broken = Toy { salt: 1, act: Act::Fail, ..Toy::default() }.task("a", vec![]);
    assert_eq!(outcomes(&run_on(&[broken], dir.path())), ["failed"]);
    assert_eq!(results(dir.path()), made);
    assert!(left_at_work(dir.path()).is_empty());
}

#[test]
fn missing_inputs_and_names_are_told() {
    let (dir, diary) = folder_and_diary();
    let tasks = [
        toy("a", 1, vec![given(dir.path(), "no.txt")], &diary),
        toy("b", 1, vec![], &diary),
        toy("c", 1, vec![result("b", "no.txt")], &diary),
    ];
    let out = dir.path().join("out");
    assert_eq!(survey(&tasks, &out).unwrap()[0], Standing::Run(Why::InputMissing("no.txt".into())));
    let report = run_on(&tasks, &out);
    assert_eq!(outcomes(&report), ["failed", "done", "failed"]);
    assert!(report.failures[0].what.contains("no.txt: is not there"), "{report:?}");
    assert_eq!(report.failures[1].what, "b made no no.txt");
}

#[test]
fn an_input_that_changes_as_it_is_worked_on_fails_the_task() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("x.txt"), "x").unwrap();
    let mut task = toy("a", 1, vec![given(dir.path(), "x.txt")], &Diary::default());
    task.job = Arc::new(|work: &Work<'_>| {
        fs::write(&work.inputs[0].path, "changed")?;
        Ok(Made::default())
    });
    let out = dir.path().join("out");
    let report = run_on(&[task], &out);
    assert!(report.failures[0].what.contains("changes as it is read"), "{report:?}");
    assert!(results(&out).is_empty());
}

#[test]
fn a_stopped_run_leaves_nothing_half_and_goes_on_later() {
    let (dir, diary) = folder_and_diary();
    let tasks = |act: Act| {
        [
            toy("a", 1, vec![], &diary),
            Toy { act, diary: Arc::clone(&diary), ..Toy::default() }.task("b", vec![result("a", "")]),
            toy("c", 1, vec![Input { may_fail: true, ..result("b", "") }], &diary),
        ]
    };
    let stop = AtomicBool::new(false);
    let tick = |progress: super::super::Progress| {
        if matches!(progress.event, Event::Begins(task) if task.id == "b") {
            stop.store(true, Ordering::Relaxed);
        }
    };
    let report =
        run(&tasks(Act::WaitForStop), dir.path(), &options(2), &RunWatch { stop: &stop, tick: &tick }).unwrap();
    assert_eq!((outcomes(&report), report.stopped), (vec!["done", "not done", "not done"], true));
    assert!(left_at_work(dir.path()).is_empty());
    assert_eq!(outcomes(&run_on(&tasks(Act::Nothing), dir.path())), ["kept", "done", "done"]);
}

#[test]
fn one_run_at_a_time() {
    let dir = tempfile::tempdir().unwrap();
    let held = Results::open(dir.path()).unwrap();
    let fault = Results::open(dir.path()).unwrap_err();
    let RunFault::Busy { holder: Some(holder), .. } = &fault else { panic!("{fault}") };
    assert_eq!(holder.pid, std::process::id());
    assert!(fault.to_string().contains("another run works here (process"), "{fault}");
    drop(held);
    Results::open(dir.path()).unwrap();
}

/// A task's name and those that it needs.
type Named<'a> = (&'a str, &'a [&'a str]);

#[test]
fn tasks_that_make_no_sense_leave_no_folder() {
    let (dir, diary) = folder_and_diary();
    let toys = |list: &[Named]| -> Vec<super::super::Task> {
        let inputs = |needs: &[&str]| needs.iter().map(|needed| result(needed, "")).collect();
        list.iter().map(|(id, needs)| toy(id, 1, inputs(needs), &diary)).collect()
    };
    let cases: [(&[Named], GraphFault); 5] = [
        (&[("a", &[]), ("a", &[])], GraphFault::Twice("a".into())),
        (&[("a/b", &[]), ("a", &[])], GraphFault::Within { inner: "a/b".into(), outer: "a".into() }),
        (&[("a", &["b"])], GraphFault::Unknown { task: "a".into(), needs: "b".into() }),
        (&[("a/../b", &[])], GraphFault::Name("a/../b".into())),
        (
            &[("x", &["a"]), ("a", &["b"]), ("b", &["c"]), ("c", &["a"])],
            GraphFault::Circle(["a", "b", "c", "a"].map(String::from).to_vec()),
        ),
    ];
    for (list, expected) in cases {
        let out = dir.path().join("out");
        let watch = RunWatch { stop: &AtomicBool::new(false), tick: &|_| {} };
        let fault = run(&toys(list), &out, &options(1), &watch).unwrap_err();
        assert!(matches!(&fault, RunFault::Tasks(found) if *found == expected), "{fault}");
        assert!(!out.exists());
    }
}
