//! Random tasks and random changes: brought up to date is the same as made from nothing.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::sync::Arc;

use proptest::prelude::*;

use super::super::{Input, Parts, Shard, Share, Standing, Task, survey};
use super::toys::{
    Diary, Toy, from_scratch, given, left_at_work, mark, options, outcomes, ran, result, results, run_with,
};

/// A task's plan: salt, bluntness, which given files and which earlier tasks it works on, whose it is.
#[derive(Debug, Clone)]
struct Plan {
    salt: u64,
    blunt: bool,
    given: Vec<usize>,
    needs: Vec<(usize, usize, bool)>,
    share: Share,
}

/// What happens between two runs.
#[derive(Debug, Clone)]
enum Change {
    Given(usize, u8),
    Salt(usize, u64),
    Edit(usize),
    Delete(usize),
    Nothing,
}

const GIVEN: usize = 4;
const PLACES: [&str; 3] = ["", "text.txt", "deep"];

fn plans() -> impl Strategy<Value = Vec<Plan>> {
    let share = prop_oneof![(0..9_usize).prop_map(Share::Part), Just(Share::Each), Just(Share::Whole)];
    let plan = (
        0..3_u64,
        any::<bool>(),
        prop::collection::vec(0..GIVEN, 0..2),
        prop::collection::vec((0..30_usize, 0..PLACES.len(), any::<bool>()), 0..4),
        share,
    );
    let plan = plan.prop_map(|(salt, blunt, given, needs, share)| Plan { salt, blunt, given, needs, share });
    prop::collection::vec(plan, 1..14)
}

fn changes() -> impl Strategy<Value = Vec<Change>> {
    let change = prop_oneof![
        (0..GIVEN, any::<u8>()).prop_map(|(at, byte)| Change::Given(at, byte)),
        (0..14_usize, 0..3_u64).prop_map(|(at, salt)| Change::Salt(at, salt)),
        (0..14_usize).prop_map(Change::Edit),
        (0..14_usize).prop_map(Change::Delete),
        Just(Change::Nothing),
    ];
    prop::collection::vec(change, 1..5)
}

fn id(at: usize) -> String {
    format!("s{}/t{at}", at % 3)
}

fn tasks(plans: &[Plan], folder: &Path, diary: &Diary) -> Vec<Task> {
    let tasks = plans.iter().enumerate().map(|(at, plan)| {
        let earlier = |&(needed, place, may_fail): &(usize, usize, bool)| {
            (at > 0).then(|| Input { may_fail, ..result(&id(needed % at.max(1)), PLACES[place]) })
        };
        let given = plan.given.iter().map(|k| given(folder, &format!("given-{k}.txt")));
        let inputs = given.chain(plan.needs.iter().filter_map(earlier)).collect();
        let toy = Toy {
            salt: plan.salt,
            blunt: plan.blunt.then_some(2),
            odd: true,
            diary: Arc::clone(diary),
            ..Toy::default()
        };
        let mut task = toy.task(&id(at), inputs);
        task.share = plan.share;
        task.cost_s = plan.salt as f64;
        task
    });
    tasks.collect()
}

fn give(folder: &Path) {
    (0..GIVEN).for_each(|k| fs::write(folder.join(format!("given-{k}.txt")), [k as u8]).unwrap());
}

fn of(tasks: &[Task], out: &Path) -> BTreeMap<String, Vec<u8>> {
    let ours = |name: &String| tasks.iter().any(|task| name.starts_with(&format!("{}/", task.id)));
    results(out).into_iter().filter(|(name, _)| ours(name)).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn up_to_date_is_as_made_from_nothing(mut plans in plans(), changes in changes()) {
        let dir = tempfile::tempdir().unwrap();
        let (out, diary) = (dir.path().join("out"), Diary::default());
        give(dir.path());
        run_with(&tasks(&plans, dir.path(), &diary), &out, &options(2));
        for (k, change) in changes.into_iter().enumerate() {
            ran(&diary);
            let count = plans.len();
            match &change {
                Change::Given(at, byte) => fs::write(dir.path().join(format!("given-{at}.txt")), [*byte]).unwrap(),
                Change::Salt(at, salt) => plans[at % count].salt = *salt,
                Change::Edit(at) => fs::write(out.join(id(at % count)).join("text.txt"), "edited").unwrap(),
                Change::Delete(at) => fs::remove_file(out.join(id(at % count)).join("deep/more.txt")).unwrap(),
                Change::Nothing => {}
            }
            let tasks = tasks(&plans, dir.path(), &diary);
            let foreseen = survey(&tasks, &out).unwrap();
            let report = run_with(&tasks, &out, &options([1, 2, 4][k % 3]));
            prop_assert!(report.is_whole());
            let done = ran(&diary);
            for (task, (standing, outcome)) in tasks.iter().zip(foreseen.iter().zip(outcomes(&report))) {
                // What is foreseen to stand stands; what is foreseen to follow may come to nothing.
                prop_assert!(*standing != Standing::Done || outcome == "kept", "{} {standing:?} {outcome}", task.id);
                prop_assert_eq!(outcome == "done", done.contains(&task.id));
            }
            prop_assert_eq!(results(&out), from_scratch(&tasks), "after {:?}", change);
            prop_assert_eq!(survey(&tasks, &out).unwrap(), vec![Standing::Done; tasks.len()]);
            prop_assert!(left_at_work(&out).is_empty());
        }
    }

    #[test]
    fn parts_merged_are_as_made_at_once(plans in plans()) {
        let dir = tempfile::tempdir().unwrap();
        give(dir.path());
        let diary = Diary::default();
        let tasks = tasks(&plans, dir.path(), &diary);
        let whole = from_scratch(&tasks);
        for count in [1, 3, 7] {
            ran(&diary);
            let folders: Vec<_> = (1..=count).map(|k| dir.path().join(format!("part-{k}-of-{count}"))).collect();
            for (k, folder) in folders.iter().enumerate() {
                let shard = Shard::new(k + 1, count);
                let report = run_with(&tasks, folder, &super::super::RunOptions { shard, ..options(2) });
                prop_assert!(report.is_whole());
            }
            let mut in_parts = ran(&diary);
            in_parts.dedup();
            let out = dir.path().join(format!("merged-{count}"));
            let (merged, counts) = Parts::open(&folders).unwrap().merge(&tasks, &mark(), &out).unwrap();
            let watch = super::super::RunWatch { stop: &std::sync::atomic::AtomicBool::new(false), tick: &|_| {} };
            let report = merged.run(&tasks, &options(2), &watch).unwrap();
            prop_assert!(report.is_whole() && report.warnings.is_empty());
            prop_assert_eq!(counts.imported, in_parts.len());
            prop_assert_eq!(report.kept, in_parts.len(), "what parts made is not made again");
            prop_assert_eq!(of(&tasks, &out), whole.clone());
        }
    }
}
