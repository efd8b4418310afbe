//! `compare` in a pipeline, on small tables.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use lunula::job::{At, Demand, Facts, Foreseen, Job as _, Keys, Kind, Made, OptionFault, Prepared, Work};
use lunula::stages::Fate;

use super::CompareChoices;

const KIND: Kind = CompareChoices::KIND;
const ROLES: [&str; 6] = ["set1", "set2", "set3", "random", "bending", "bending_random"];

fn prepare(keys: &str) -> Result<Arc<dyn Prepared>, OptionFault> {
    (KIND.prepare)(&toml::from_str(keys).unwrap())
}

/// The recording of a role: forces and an angle seen by three photodiodes.
fn recording(folder: &Path, role: &'static str, subject: &str) -> At {
    let phase = ROLES.iter().position(|one| *one == role).unwrap() as f64;
    let mut text = "time_s,P1,P2,P3,Fx_N,Fy_N,Fz_N,J2_deg\n".to_owned();
    for k in 0..120 {
        let t = f64::from(k) * 0.04;
        let [a, b, c] = [3.1, 5.3, 7.7].map(|rate| (rate * t + phase).sin());
        let noise = [0.01, 0.02].map(|size| size * (97.0 * t + phase).sin());
        let volts = [2.0 + a + noise[0], 2.0 + b - c, 2.0 + c + noise[1]];
        writeln!(text, "{t},{:?},{:?},{:?},{a},{b},{},{}", volts[0], volts[1], volts[2], -1.0 - c, 20.0 * b).unwrap();
    }
    let name = format!("{subject}-{role}.csv");
    std::fs::write(folder.join(&name), text).unwrap();
    At { role, keys: Keys([("subject".to_owned(), subject.to_owned())].into()), path: folder.join(&name), name }
}

/// What a task of these parts says and writes.
fn make(stage: &str, inputs: Vec<At>, parts: &[&'static str], threads: usize) -> anyhow::Result<(Made, Files)> {
    let (folder, stop) = (tempfile::tempdir()?, AtomicBool::new(false));
    let demand = Demand { parts: parts.iter().copied().collect(), ..Demand::default() };
    let work = Work { inputs, folder: folder.path(), before: None, threads, stop: &stop };
    let made = prepare(stage).unwrap().maker(&Keys::default(), &demand).run(&work)?;
    let entries = std::fs::read_dir(folder.path())?.map(|entry| entry.unwrap());
    let files = entries.map(|entry| (entry.file_name().into_string().unwrap(), std::fs::read(entry.path()).unwrap()));
    Ok((made, files.collect()))
}

type Files = BTreeMap<String, Vec<u8>>;

#[test]
fn results_are_the_same_bytes_in_any_folder_on_any_threads() {
    let stage = "models = ['linear', 'quadratic']\nbending_s = 0.4";
    let run = |threads: usize| {
        let folder = tempfile::tempdir().unwrap();
        let inputs = ROLES.map(|role| recording(folder.path(), role, "S01")).to_vec();
        let (_, files) = make(stage, inputs, &["table", "pictures"], threads).unwrap();
        let place = folder.path().to_str().unwrap().to_owned();
        assert!(files.values().all(|bytes| !String::from_utf8_lossy(bytes).contains(&place)), "a file holds a path");
        files
    };
    let (first, second) = (run(1), run(4));
    assert!(first == second);
    assert_eq!(first.len(), 1 + 2 * 8, "{:?}", first.keys());
}

#[test]
fn who_lacks_a_recording_is_left_out_and_reported() {
    let folder = tempfile::tempdir().unwrap();
    let mut inputs = Vec::new();
    for role in ROLES {
        inputs.push(recording(folder.path(), role, "S01"));
        if role != "random" {
            inputs.push(recording(folder.path(), role, "S02"));
        }
    }
    let stage = "models = ['linear']\nbending_s = 0.4";
    let (made, files) = make(stage, inputs.clone(), &["table"], 1).unwrap();
    assert_eq!(made.failed, ["subject S02: there is no random"]);
    assert_eq!(files.keys().collect::<Vec<_>>(), ["comparisons.csv"], "without pictures there is the table");
    let again = At { name: "again.csv".to_owned(), ..inputs[0].clone() };
    inputs.push(again);
    let why = make(stage, inputs, &["table"], 1).unwrap_err().to_string();
    assert!(why.contains("nobody has all six recordings"), "{why}");
    assert!(why.contains("set1 is S01-set1.csv as well as again.csv"), "{why}");
}

#[test]
fn wrong_keys_are_refused_with_what_to_write() {
    for (stage, what) in [("models = ['cubic']", "linear, quadratic, network"), ("models = []", "at least one")] {
        let Err(fault) = prepare(stage) else { panic!("{stage}: is taken") };
        assert!(fault.key == "models" && fault.what.contains(what), "{stage}: {fault:?}");
    }
}

#[test]
fn a_plan_knows_the_table_and_which_joints_are_needed() {
    let job = prepare("").unwrap();
    let coming = Foreseen {
        role: "set1",
        keys: Keys::default(),
        path: "there/it.csv".into(),
        exists: false,
        facts: Facts::default(),
    };
    let demand = Demand { parts: BTreeSet::from(["table"]), ..Demand::default() };
    let steps = job.steps(&[coming], &demand).unwrap();
    let fate = |stage: &str| steps.iter().find(|step| step.stage == stage).map(|step| step.fate == Fate::Run);
    assert_eq!((fate("tables"), fate("figures")), (Some(true), Some(false)));
    let joints = |role: &str| job.demand(role, &demand).joints.unwrap().into_iter().collect::<Vec<_>>();
    assert_eq!((joints("bending"), joints("set1")), (vec!["J2".to_owned()], Vec::new()));
}
