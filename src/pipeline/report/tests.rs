//! Reports of runs that never were.

use super::page::page;
use super::summary;
use crate::job::{Made, Quality};
use crate::pipeline::run::{Outcome, RunReport, TaskReport};
use crate::pipeline::tests::planned::Bench;

#[test]
fn a_run_is_summed_up_by_stage() {
    let bench = Bench::new(&[("v/a.mp4", ""), ("v/b.mp4", ""), ("v/c.mp4", "")]);
    let plan = bench.plan(
        "[inputs.v]\nfiles = \"v/{s}.mp4\"\n[stage.angles]\njob = \"track\"\nvideo = \
                           \"v\"\n[stage.idle]\njob = \"track\"\nvideo = \"v\"\n"
            .replace("[inputs", "wanted = [\"angles\"]\n[inputs")
            .as_str(),
    );
    let quality =
        |value: f64, against_truth| Quality { what: "J2".into(), value, unit: "degrees RMS".into(), against_truth };
    let task = |id: &str, outcome, made: Option<Made>| TaskReport {
        task: id.into(),
        stage: "angles".into(),
        keys: plan.tasks[0].keys.clone(),
        outcome,
        why: None,
        wall_s: Some(1.5),
        made,
        outputs: Vec::new(),
        without: Vec::new(),
    };
    let made = |value: f64| Made {
        quality: vec![quality(value, true), quality(f64::NAN, false)],
        left_out: vec!["clock: <nobody> needs it".into()],
        ..Made::default()
    };
    let report = RunReport {
        tasks: vec![
            task("angles/a", Outcome::Done, Some(Made { failed: vec!["a.png: is damaged".into()], ..made(0.01) })),
            task("angles/b", Outcome::Kept, Some(made(0.03))),
            task("angles/c", Outcome::Failed("no video".into()), None),
        ],
        wall_s: 2.0,
        threads: 4,
        ..RunReport::default()
    };
    let run = summary(&plan, &report);
    let angles = &run.stages[0];
    assert_eq!((angles.done, angles.kept, angles.failed), (1, 1, 1));
    assert_eq!((angles.task_s, angles.share), (3.0, 1.0));
    assert_eq!(angles.quality.len(), 1, "what is no number is no quality");
    assert_eq!((angles.quality[0].least, angles.quality[0].median, angles.quality[0].greatest), (0.01, 0.02, 0.03));
    assert_eq!(angles.left_out[0].count, 2);
    let failed: Vec<_> = report.failed_inputs().collect();
    assert_eq!(failed, [(&"angles/a".to_owned(), "a.png: is damaged")]);
    assert_eq!(angles.failed_inputs[0].what, "a.png: is damaged");
    assert_eq!(run.stages[1].left_out[0].what, "nothing wanted needs it");
    let html = page(&run);
    assert!(html.contains("J2 0.0200 (0.0100 to 0.0300) degrees RMS"), "{html}");
    assert!(html.contains("clock: &lt;nobody&gt; needs it (2 times)"), "{html}");
    let json = serde_json::to_value(&run).unwrap();
    assert_eq!(json["tasks"][2]["outcome"], "failed");
    assert_eq!(json["tasks"][2]["what"], "no video");
}
