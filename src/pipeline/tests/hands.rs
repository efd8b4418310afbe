//! Results and inputs changed between runs: what that touches is made again, and nothing that somebody wrote is lost.

use std::fs;
use std::sync::{Arc, Mutex};

use super::super::{Source, Standing, Why, survey};
use super::toys::{
    Diary, Toy, folder_and_diary, from_scratch, given, left_at_work, options, outcomes, ran, result, results, run_on,
    run_with, toy,
};
use crate::job::{Made, Work};

#[test]
fn nothing_is_done_twice_and_a_survey_tells_why_something_is() {
    let dir = tempfile::tempdir().unwrap();
    let (out, diary) = (dir.path().join("out"), Diary::default());
    fs::write(dir.path().join("x.txt"), "x").unwrap();
    fs::write(dir.path().join("y.txt"), "y").unwrap();
    let tasks = |salt| {
        [
            toy("a/1", 1, vec![given(dir.path(), "x.txt")], &diary),
            toy("a/2", salt, vec![given(dir.path(), "y.txt")], &diary),
            toy("b", 1, vec![result("a/1", "text.txt"), result("a/2", "deep")], &diary),
        ]
    };
    assert_eq!(survey(&tasks(1), &out).unwrap(), vec![Standing::Run(Why::NeverMade); 3]);
    assert!(!out.exists());
    let report = run_on(&tasks(1), &out);
    assert_eq!((outcomes(&report), ran(&diary).len()), (vec!["done"; 3], 3));
    assert_eq!(report.tasks[2].made.as_ref().unwrap().warnings, ["made of 2 inputs"]);
    assert_eq!(survey(&tasks(1), &out).unwrap(), vec![Standing::Done; 3]);
    let again = run_on(&tasks(1), &out);
    assert_eq!((outcomes(&again), ran(&diary).len()), (vec!["kept"; 3], 0));
    assert_eq!(again.tasks[2].made.as_ref().unwrap().warnings, ["made of 2 inputs"]);

    fs::write(dir.path().join("x.txt"), "z").unwrap();
    let changed = |what: &str| Standing::Run(Why::InputChanged(what.into()));
    let follows = |what: &str| Standing::Run(Why::Follows(what.into()));
    assert_eq!(survey(&tasks(1), &out).unwrap(), [changed("x.txt"), Standing::Done, follows("a/1")]);
    assert_eq!(
        survey(&tasks(2), &out).unwrap()[1],
        Standing::Run(Why::OptionsChanged(vec!["salt".into()])),
        "options are named"
    );
    let report = run_on(&tasks(1), &out);
    assert_eq!(outcomes(&report), ["done", "kept", "done"]);
    assert_eq!(report.tasks[2].why.as_deref(), Some("input a/1/text.txt changed"));
    assert_eq!(results(&out), from_scratch(&tasks(1)));

    let mut newer = tasks(1);
    newer[1].options["revision"] = 2.into();
    assert_eq!(survey(&newer, &out).unwrap()[1], Standing::Run(Why::VersionChanged));
    // It comes out as before, so what needs it stands.
    assert_eq!(outcomes(&run_on(&newer, &out)), ["kept", "done", "kept"]);
    assert!(left_at_work(&out).is_empty());
}

#[test]
fn an_edited_result_is_kept_beside_and_made_anew_a_deleted_one_made_anew() {
    let (dir, diary) = folder_and_diary();
    let tasks = [toy("a", 1, vec![], &diary), toy("b", 1, vec![result("a", "")], &diary)];
    run_on(&tasks, dir.path());
    let made = results(dir.path());
    for kept in ["text.txt.edited", "text.txt.edited.2"] {
        fs::write(dir.path().join("a/text.txt"), kept).unwrap();
        assert_eq!(survey(&tasks, dir.path()).unwrap()[0], Standing::Run(Why::Edited("text.txt".into())));
        let report = run_on(&tasks, dir.path());
        assert_eq!(outcomes(&report), ["done", "kept"]);
        assert!(
            report.warnings.iter().any(|warning| warning.contains("edited by hand") && warning.contains(kept)),
            "{report:?}"
        );
        assert_eq!(fs::read_to_string(dir.path().join("a").join(kept)).unwrap(), kept);
        assert_eq!(results(dir.path()), made);
    }
    // It is reported once, and what works on the folder does not see it.
    let mut tasks = tasks;
    tasks[1] = toy("b", 2, vec![result("a", "")], &diary);
    assert!(run_on(&tasks, dir.path()).warnings.is_empty());
    assert_eq!(results(dir.path()), from_scratch(&tasks));

    fs::remove_file(dir.path().join("a/deep/more.txt")).unwrap();
    assert_eq!(survey(&tasks, dir.path()).unwrap()[0], Standing::Run(Why::Deleted("deep/more.txt".into())));
    assert_eq!(outcomes(&run_on(&tasks, dir.path())), ["done", "kept"]);
    assert_eq!(results(dir.path()), from_scratch(&tasks));
}

#[test]
fn a_file_where_results_belong_is_named_and_left() {
    let dir = tempfile::tempdir().unwrap();
    let tasks = [toy("a", 1, vec![], &Diary::default())];
    run_on(&tasks, dir.path());
    fs::remove_dir_all(dir.path().join("a")).unwrap();
    fs::write(dir.path().join("a"), "mine").unwrap();
    let report = run_on(&tasks, dir.path());
    assert!(report.failures[0].what.contains("is a file that is none of the results"), "{report:?}");
    assert_eq!(fs::read_to_string(dir.path().join("a")).unwrap(), "mine");
    fs::remove_file(dir.path().join("a")).unwrap();
    assert!(run_on(&tasks, dir.path()).is_whole());
    assert_eq!(results(dir.path()), from_scratch(&tasks));
}

#[test]
fn an_edit_is_kept_even_where_the_task_changed_too() {
    let (dir, diary) = folder_and_diary();
    run_on(&[toy("a", 1, vec![], &diary)], dir.path());
    fs::write(dir.path().join("a/text.txt"), "mine").unwrap();
    let report = run_on(&[toy("a", 2, vec![], &diary)], dir.path());
    assert_eq!(report.warnings.len(), 1, "{report:?}");
    assert_eq!(fs::read_to_string(dir.path().join("a/text.txt.edited")).unwrap(), "mine");
}

#[test]
fn what_is_no_result_is_left_told_and_not_shown_to_jobs() {
    let (dir, diary) = folder_and_diary();
    let tasks =
        |salt| [toy("a", 1, vec![], &diary), toy("b", salt, vec![result("a", ""), result("a", "deep")], &diary)];
    run_on(&tasks(1), dir.path());
    fs::write(dir.path().join("a/deep/notes.txt"), "mine").unwrap();
    let report = run_on(&tasks(2), dir.path());
    assert_eq!(outcomes(&report), ["kept", "done"]);
    assert!(report.warnings.iter().any(|warning| warning.contains("notes.txt")), "{report:?}");
    assert_eq!(fs::read_to_string(dir.path().join("a/deep/notes.txt")).unwrap(), "mine");
    let mut found = results(dir.path());
    found.remove("a/deep/notes.txt");
    assert_eq!(found, from_scratch(&tasks(2)));
}

#[test]
fn what_is_made_no_more_is_removed_unless_somebody_edited_it() {
    let dir = tempfile::tempdir().unwrap();
    let task = |salt| [Toy { salt, odd: true, ..Toy::default() }.task("a", vec![])];
    run_on(&task(1), dir.path());
    run_on(&task(2), dir.path());
    assert!(!dir.path().join("a/odd.txt").exists());
    run_on(&task(3), dir.path());
    fs::write(dir.path().join("a/odd.txt"), "mine").unwrap();
    let report = run_on(&task(4), dir.path());
    assert!(report.warnings.iter().any(|warning| warning.contains("odd.txt")), "{report:?}");
    assert_eq!(fs::read_to_string(dir.path().join("a/odd.txt")).unwrap(), "mine");
}

#[test]
fn a_task_of_before_is_told_and_makes_room_only_where_it_is_in_the_way() {
    let (dir, diary) = folder_and_diary();
    run_on(&[toy("a", 1, vec![], &diary), toy("b", 1, vec![], &diary)], dir.path());
    let now = [toy("a/deep", 1, vec![], &diary)];
    let report = run_on(&now, dir.path());
    assert_eq!(report.strays, ["b"]);
    assert!(dir.path().join("b/text.txt").exists() && !dir.path().join("a/text.txt").exists());
    let back = [toy("a", 1, vec![], &diary)];
    assert!(run_on(&back, dir.path()).is_whole());
    assert!(!dir.path().join("a/deep/text.txt").exists());
    // Many that one is in the way of, side by side.
    let many: Vec<_> = (0..40).map(|k| toy(&format!("a/deep/{k}"), 1, vec![], &diary)).collect();
    let report = run_with(&many, dir.path(), &options(8));
    assert!(report.is_whole() && report.warnings.is_empty(), "{:?} {:?}", report.failures, report.warnings);
    assert!(!dir.path().join("a/text.txt").exists() && dir.path().join("b/text.txt").exists());
}

#[test]
fn a_given_folder_is_all_that_is_in_it() {
    let dir = tempfile::tempdir().unwrap();
    let (out, diary) = (dir.path().join("out"), Diary::default());
    fs::create_dir_all(dir.path().join("set/p")).unwrap();
    fs::write(dir.path().join("set/p/1.txt"), "1").unwrap();
    let tasks = [toy("a", 1, vec![given(dir.path(), "set")], &diary)];
    run_on(&tasks, &out);
    assert_eq!(outcomes(&run_on(&tasks, &out)), ["kept"]);
    fs::rename(dir.path().join("set/p/1.txt"), dir.path().join("set/p/2.txt")).unwrap();
    assert_eq!(outcomes(&run_on(&tasks, &out)), ["done"]);
    fs::write(dir.path().join("set/3.txt"), "").unwrap();
    assert_eq!(outcomes(&run_on(&tasks, &out)), ["done"]);
}

#[test]
fn an_unreadable_record_counts_as_none() {
    let (dir, diary) = folder_and_diary();
    let tasks = [toy("a", 1, vec![], &diary)];
    run_on(&tasks, dir.path());
    for entry in fs::read_dir(dir.path().join(".lunula/records")).unwrap() {
        fs::write(entry.unwrap().path(), "{\"format\": 1, \"task\": ").unwrap();
    }
    assert_eq!(survey(&tasks, dir.path()).unwrap(), [Standing::Run(Why::NeverMade)]);
    let report = run_on(&tasks, dir.path());
    // The same bytes stand there already: nobody's work is set aside.
    assert_eq!((outcomes(&report), report.warnings.len()), (vec!["done"], 0));
}

#[test]
fn a_before_is_shown_only_where_it_is_whole_and_of_the_same_options() {
    let dir = tempfile::tempdir().unwrap();
    let shown: Arc<Mutex<Vec<bool>>> = Arc::default();
    let run_once = |text: &str, option: u64| {
        fs::write(dir.path().join("in.txt"), text).unwrap();
        let mut task = toy("a", 1, vec![given(dir.path(), "in.txt")], &Diary::default());
        task.options = serde_json::json!({ "salt": option });
        let shown = Arc::clone(&shown);
        task.job = Arc::new(move |work: &Work<'_>| {
            shown.lock().unwrap().push(work.before.is_some());
            fs::write(work.folder.join("x.txt"), "x")?;
            Ok(Made::default())
        });
        assert!(matches!(task.inputs[0].source, Source::Given { .. }));
        run_on(&[task], &dir.path().join("out"));
    };
    run_once("1", 1);
    run_once("2", 1);
    run_once("3", 2);
    fs::write(dir.path().join("out/a/x.txt"), "mine").unwrap();
    run_once("4", 2);
    assert_eq!(*shown.lock().unwrap(), [false, true, false, false]);
}
