//! Plans with toys: what is needed, of whom, in which share, and what is wrong with inputs.

use crate::pipeline::plan::{Plan, PlanFate, plan_text};
use crate::pipeline::store::standing::{Standing, Why};
use crate::pipeline::tasks::{Share, Source};
use crate::pipeline::tests::planned::Bench;

const SESSIONS: &str = "subject,session,kind,video,log,note_file\n\
    S01,1,bending,v/S01.mp4,l/S01.csv,n/a.txt\n\
    S02,1,bending,v/S02.mp4,l/S02.csv,n/b.txt\n\
    S02,2,bending,,l/S02b.csv,\n\
    S03,1,touch,v/S03.mp4,l/S03.csv,\n";

const STUDY: &str = r#"wanted = ["sets"]
[inputs.bending]
table = "sessions.csv"
where = { kind = "bending" }
[stage.angles]
job = "track"
video = "bending.video"
[stage.sets]
job = "tie"
joints = "angles"
log = "bending.log"
"#;

fn files() -> Vec<(&'static str, &'static str)> {
    vec![
        ("sessions.csv", SESSIONS),
        ("v/S01.mp4", "1"),
        ("v/S02.mp4", "2"),
        ("v/S03.mp4", "3"),
        ("l/S01.csv", "1"),
        ("l/S02.csv", "2"),
        ("l/S02b.csv", "2"),
        ("l/S03.csv", "3"),
        ("markers.toml", ""),
    ]
}

fn bench() -> Bench {
    Bench::new(&files())
}

/// The study's files, one of them with other content.
fn bench_with(name: &str, content: &str) -> Bench {
    let others = files().into_iter().filter(|(known, _)| *known != name);
    Bench::new(&others.chain([(name, content)]).collect::<Vec<_>>())
}

fn ids(plan: &Plan) -> Vec<&str> {
    plan.tasks.iter().map(|task| task.id.as_str()).collect()
}

fn shares(plan: &Plan) -> Vec<(&str, Share)> {
    plan.tasks.iter().map(|task| (task.id.as_str(), task.share)).collect()
}

#[test]
fn rows_become_tasks_and_join_by_keys() {
    let plan = bench().plan(STUDY);
    assert_eq!(
        ids(&plan),
        ["angles/S01/1/bending", "angles/S02/1/bending", "sets/S01/1/bending", "sets/S02/1/bending"],
        "in the table's order, without columns of files"
    );
    let sets = &plan.tasks[3];
    assert_eq!(sets.keys.to_string(), "kind=bending session=1 subject=S02");
    let named: Vec<String> = sets.inputs.iter().map(|input| format!("{} {:?}", input.role, input.source)).collect();
    assert!(
        named[0].starts_with("joints Result { task: \"angles/S02/1/bending\", name: \"joints.csv\" }"),
        "{named:?}"
    );
    assert!(matches!(&sets.inputs[1].source, Source::Given { name, .. } if name == "l/S02.csv"));
    assert!(plan.warnings.is_empty(), "{:?}", plan.warnings);
}

#[test]
fn what_has_no_file_or_no_partner_is_left_out_with_the_reason() {
    let text = plan_text(&bench().plan(STUDY).stage_plans(&[]));
    let expected = "\
angles (track)        run       2: never made
                      left out  1: sessions.csv names no `video` for it
  work                run       2: 1 input(s)
  clock               run       2: wanted
  channel             run       2: in colour
sets (tie)            run       2: never made
                      left out  1: its `log` has no `joints`: kind=bending session=2 subject=S02
  work                run       2: 2 input(s)
  clock               run       2: wanted
  channel             run       2: in colour
";
    assert_eq!(text, expected);
}

#[test]
fn rows_that_a_where_leaves_out_are_not_counted_as_lacking_a_file() {
    let of_all = STUDY
        .replace("where = { kind = \"bending\" }\n", "")
        .replace("video = \"bending.video\"", "video = { from = \"bending.video\", where = { kind = \"bending\" } }");
    let bench = bench_with(
        "sessions.csv",
        "subject,session,kind,video,log\nS01,1,bending,v/S01.mp4,l/S01.csv\nS02,1,bending,,l/S02.csv\n\
         S02,2,touch,,l/S02b.csv\nS03,1,touch,,l/S03.csv\n",
    );
    let left_out = |text: &str| -> Vec<String> {
        let stages = bench.plan(text).stage_plans(&[]);
        let lines = stages.iter().flat_map(|stage| stage.tasks.iter().map(move |line| (&stage.stage, line)));
        let left = lines.filter(|(_, line)| line.fate == PlanFate::LeftOut);
        left.map(|(stage, line)| format!("{stage} {}: {}", line.count, line.reason)).collect()
    };
    let one = "angles 1: sessions.csv names no `video` for it";
    let alone = "sets 1: its `log` has no `joints`: kind=bending session=1 subject=S02";
    assert_eq!(left_out(&of_all), [one, alone]);
    // The same by the stage's own `where`, and without any.
    let by_stage = of_all.replace(
        "video = { from = \"bending.video\", where = { kind = \"bending\" } }",
        "video = \"bending.video\"\nwhere = { kind = \"bending\" }",
    );
    assert_eq!(left_out(&by_stage), [one, alone]);
    let without = of_all.replace(", where = { kind = \"bending\" }", "");
    let said = left_out(&without);
    assert!(said[0] == "angles 3: sessions.csv names no `video` for it" && said[1].starts_with("sets 3: "), "{said:?}");
    // Models are for all rows of a subject, whichever rows they were made of.
    let models = "wanted = [\"errors\"]\n[inputs.all]\ntable = \"sessions.csv\"\n[stage.model]\njob = \"train\"\n\
                  each = [\"subject\"]\ndata = { from = \"all.log\", where = { kind = \"touch\" } }\n[stage.pred]\n\
                  job = \"tie\"\njoints = \"model\"\nlog = \"all.log\"\n\
                  [stage.errors]\njob = \"train\"\ndata = \"pred\"\n";
    assert_eq!(left_out(models), ["pred 1: its `log` has no `joints`: kind=bending session=1 subject=S01"]);
}

#[test]
fn files_in_the_folder_of_results_that_no_run_made_are_refused() {
    let text = "[inputs.logs]\nfiles = \"{day}/{n}.csv\"\n[stage.model]\njob = \"train\"\ndata = \"logs\"\n";
    let logs = [("mon/a.csv", "1"), ("tue/a.csv", "2")];
    let bench = |more: &[(&str, &str)]| Bench::new(&[&logs[..], more].concat());
    let task = ("out/run.json", "{\"tasks\": [{\"task\": \"model\"}, {\"task\": \"x\"}]}");
    let earlier = [task, ("out/model/merit.csv", "3"), ("out/x/b.csv", "4")];
    assert_eq!(bench(&earlier).plan(&text.replace("{day}", "**")).tasks[0].inputs.len(), 2);
    let own = [&earlier[..], &[("out/wed.csv", "5")]].concat();
    let faults = bench(&own).faults(text);
    let out = "/out, where results go and no inputs are looked for: out/wed.csv; choose a folder of its own for --out";
    assert!(faults.len() == 1 && faults[0].starts_with("2:9: `{day}/{n}.csv` finds 1 file(s) in "), "{faults:?}");
    assert!(faults[0].ends_with(out), "{faults:?}");
    // Above all inputs, and results of an earlier run named as inputs.
    let inside = text.replace("{day}", "out/{day}");
    let faults = bench(&[("out/mon/a.csv", "1"), ("out/tue/a.csv", "2")]).faults(&inside);
    assert!(
        faults[0].contains("finds 2 file(s) in ") && faults[0].contains(": out/mon/a.csv, out/tue/a.csv;"),
        "{faults:?}"
    );
    let faults = bench(&earlier).faults(&inside);
    assert!(faults[0].contains("finds nothing but results of an earlier run in "), "{faults:?}");
}

#[test]
fn a_stage_that_nothing_wanted_needs_is_left_out_and_its_inputs_are_not_looked_at() {
    let more =
        format!("{STUDY}[inputs.none]\nfiles = \"nowhere/*.csv\"\n[stage.model]\njob = \"train\"\ndata = \"none\"\n");
    let plan = bench().plan(&more);
    assert_eq!(plan.tasks.len(), 4);
    let stages = plan.stage_plans(&[]);
    let model = stages.iter().find(|stage| stage.stage == "model").unwrap();
    assert_eq!((model.run, model.tasks[0].reason.as_str()), (0, "nothing wanted needs it"));
    assert!(plan_text(&stages).contains("model (train)         left out  nothing wanted needs it\n"));
}

#[test]
fn only_tasks_that_a_wanted_one_needs_run() {
    let text =
        STUDY.replace("log = \"bending.log\"", "log = { from = \"bending.log\", where = { subject = \"S01\" } }");
    let plan = bench().plan(&text);
    assert_eq!(ids(&plan), ["angles/S01/1/bending", "sets/S01/1/bending"]);
    let angles = &plan.stage_plans(&[])[0];
    assert!(
        angles
            .tasks
            .iter()
            .any(|l| l.fate == PlanFate::LeftOut && l.count == 1 && l.reason == "nothing wanted needs it")
    );
}

#[test]
fn demands_flow_back_from_what_is_wanted() {
    let options = |text: &str, id: &str| {
        let plan = bench().plan(text);
        plan.tasks.iter().find(|task| task.id.starts_with(id)).unwrap().options["options"].clone()
    };
    let with_clock = options(STUDY, "angles");
    assert_eq!((&with_clock["clock"], &with_clock["joints"]), (&true.into(), &serde_json::Value::Null));
    assert_eq!(with_clock["parts"], serde_json::json!(["joints"]));
    let offset = STUDY.replace("log = \"bending.log\"", "log = \"bending.log\"\nsync = \"offset=3\"");
    assert_eq!(options(&offset, "angles")["clock"], false);
    // Wanted itself, all of it is wanted; a part that is made only where it is wanted has to be named.
    let both = offset.replace("[\"sets\"]", "[\"sets\", \"angles\"]");
    assert_eq!(options(&both, "angles")["clock"], true);
    let tracks = offset.replace("[\"sets\"]", "[\"sets\", \"angles.tracks\"]");
    assert_eq!(options(&tracks, "angles")["parts"], serde_json::json!(["joints", "tracks"]));
    let train =
        format!("{}[stage.model]\njob = \"train\"\ndata = \"sets\"\n", offset.replace("[\"sets\"]", "[\"model\"]"));
    assert_eq!(options(&train, "angles")["joints"], serde_json::json!(["J2"]));
    assert_eq!(options(&train, "sets")["parts"], serde_json::json!(["training"]));
}

#[test]
fn gathering_jobs_make_a_task_for_each_value_and_join_what_has_no_keys() {
    let gather = |each: &str| {
        format!(
            "[inputs.all]\ntable = \"sessions.csv\"\n[inputs.extra]\nfiles = \"markers.toml\"\n[stage.model]\njob = \
             \"train\"\n{each}data = \"all.log\"\nvalidate = \"extra\"\n"
        )
    };
    let by_kind = bench().plan(&gather("each = [\"kind\", \"subject\"]\n"));
    assert_eq!(ids(&by_kind), ["model/bending/S01", "model/bending/S02", "model/touch/S03"]);
    assert_eq!(ids(&bench().plan(&gather(""))), ["model"]);
    let plan = bench().plan(&gather("each = [\"subject\"]\n"));
    assert_eq!(ids(&plan), ["model/S01", "model/S02", "model/S03"]);
    let roles: Vec<&str> = plan.tasks[1].inputs.iter().map(|input| input.role).collect();
    assert_eq!(roles, ["data", "data", "validate"]);
    assert!(plan.tasks[1].inputs.iter().all(|input| input.may_fail));
    let held = gather("each = [\"subject\"]\n")
        .replace("validate = \"extra\"", "validate = { from = \"all.log\", where = { session = 2 } }");
    assert_eq!(bench().plan(&held).tasks.len(), 3, "any number may be none");
}

#[test]
fn models_meet_the_logs_of_their_subject() {
    let text = "wanted = [\"how_good\"]\n[inputs.all]\ntable = \"sessions.csv\"\n[stage.model]\njob = \"train\"\neach \
                = [\"subject\"]\ndata = \"all.log\"\n\
                [stage.how_good]\njob = \"evaluate\"\nmodel = \"model\"\ndata = \
                { from = \"all.log\", where = { session = 1 } }\n";
    let plan = bench().plan(text);
    let last = plan.tasks.last().unwrap();
    assert_eq!((last.id.as_str(), last.inputs.len()), ("how_good/S03", 2));
    assert_eq!(plan.parts(), 3);
}

#[test]
fn files_become_tasks_with_what_lies_beside_them() {
    let bench = Bench::new(&[("p/rest/S01.png", ""), ("p/rest/S01.json", ""), ("p/press/S01.png", "")]);
    let plan = bench.plan(
        "[inputs.photos]\nfiles = \"p/{pose}/{subject}.png\"\n[stage.n]\njob = \"normalize\"\nphoto = \"photos\"\n",
    );
    assert_eq!(ids(&plan), ["n/press/S01", "n/rest/S01"]);
    assert_eq!(plan.tasks[0].inputs.len(), 1);
    let beside = &plan.tasks[1].inputs[1];
    assert_eq!((beside.role, beside.keys.to_string()), ("annotation", "pose=rest subject=S01".to_owned()));
    assert!(matches!(&beside.source, Source::Given { name, .. } if name == "p/rest/S01.json"));
}

#[test]
fn generated_recordings_are_planned_before_they_stand() {
    let text = "wanted = [\"sets\"]\n[phantom]\nstudy = {}\n[inputs.all]\ntable = \
                \"{phantom}/tables/sessions.csv\"\n[inputs.markers]\nfiles = \"{phantom}/markers/markers.toml\"\n\
                [inputs.logs]\nfiles = \"{phantom}/recordings/{subject}/*.csv\"\n\
                [stage.angles]\njob = \"track\"\nvideo = \"all.video\"\nmarkers = \"markers\"\n[stage.sets]\njob = \
                \"tie\"\njoints = \"angles\"\nlog = \"logs\"\n";
    let plan = bench().plan(text);
    assert_eq!(
        shares(&plan),
        [
            ("phantom/recordings/S01", Share::Part(0)),
            ("phantom/recordings/S02", Share::Part(1)),
            ("phantom/markers", Share::Each),
            ("angles/S01/bending", Share::Part(0)),
            ("angles/S02/bending", Share::Part(1)),
            ("sets/S01/bending", Share::Part(0)),
            ("sets/S02/bending", Share::Part(1)),
        ]
    );
    let video = &plan.tasks[3].inputs[0].source;
    assert!(
        matches!(video, Source::Result { task, name } if task == "phantom/recordings/S01" && name == "bending.mp4")
    );
    let shown = plan_text(&plan.stage_plans(&[]));
    assert!(shown.contains("phantom               run       3: never made\n"), "{shown}");
    assert!(shown.contains("  channel             left out  2: it is grey\n"), "facts are known beforehand:\n{shown}");
}

#[test]
fn what_gathers_everything_is_made_when_parts_are_merged() {
    let text = format!(
        "{}[stage.model]\njob = \"train\"\ndata = \"sets\"\n[stage.test]\njob = \"evaluate\"\nmodel = \"model\"\ndata \
         = \"sets\"\n",
        STUDY.replace("[\"sets\"]", "[\"test\"]")
    );
    let plan = bench().plan(&text);
    assert_eq!(
        shares(&plan),
        [
            ("angles/S01/1/bending", Share::Part(0)),
            ("angles/S02/1/bending", Share::Part(1)),
            ("sets/S01/1/bending", Share::Part(0)),
            ("sets/S02/1/bending", Share::Part(1)),
            ("model", Share::Whole),
            ("test", Share::Whole),
        ]
    );
}

#[test]
fn what_stands_is_told_as_done() {
    let plan = bench().plan(STUDY);
    let standing = [
        Standing::Done,
        Standing::Run(Why::InputChanged("v".into())),
        Standing::Done,
        Standing::Run(Why::Follows("x".into())),
    ];
    let stages = plan.stage_plans(&standing);
    assert_eq!((stages[0].run, stages[0].done), (1, 1));
    let text = plan_text(&stages);
    assert!(text.contains("angles (track)        run       1: an input changed\n"), "{text}");
    assert!(text.contains("                      done      1: its results stand\n"), "{text}");
    assert!(text.contains("  work                done      1: 1 input(s)\n"), "{text}");
}

#[test]
fn files_that_do_not_stand_are_told_and_stop_nothing_else() {
    let bench = Bench::new(&files().into_iter().filter(|(name, _)| *name != "v/S02.mp4").collect::<Vec<_>>());
    let plan = bench.plan(STUDY);
    assert_eq!(plan.tasks.len(), 4);
    assert_eq!(plan.warnings.len(), 1);
    assert!(plan.warnings[0].starts_with("sessions.csv, line 3: the `video` of `angles`, "), "{:?}", plan.warnings);
    assert!(plan.stage_plans(&[])[0].cannot_tell[0].contains("angles/S02/1/bending: "));
}

#[test]
fn one_recording_under_the_names_of_two_subjects_is_warned_of() {
    let plan = |changed: &str, content: &str| bench_with(changed, content).plan(STUDY).warnings;
    let said = plan("v/S02.mp4", "1");
    assert_eq!(said.len(), 1, "{said:?}");
    assert!(said[0].contains("v/S01.mp4, ") && said[0].contains("v/S02.mp4: the same to the byte"), "{said:?}");
    // A log that is a video's bytes, and one that nobody wants: `files` has both.
    assert_eq!(plan("markers.toml", "1"), [""; 0]);
}

/// The sessions are in a table of these rows.
fn bench_of(rows: &[&str]) -> Bench {
    bench_with("sessions.csv", &format!("subject,session,kind,video,log\n{}\n", rows.join("\n")))
}

fn warned(rows: &[&str], pipeline: &str) -> Vec<String> {
    bench_of(rows).plan(pipeline).warnings
}

/// A right value, one in the wrong case, one with letters exchanged, one of another kind.
const SLIPS: [&str; 4] = [
    "S01,1,bending,v/S01.mp4,l/S01.csv",
    "S02,1,Bending,v/S02.mp4,l/S02.csv",
    "S02,2,bendign,v/S02.mp4,l/S02b.csv",
    "S03,1,touch,v/S03.mp4,l/S03.csv",
];
const WRONG_CASE: &str = "sessions.csv, line 3: kind = \"Bending\" is left out where a `where` asks for \"bending\"; \
                          did you mean `bending`?";
const EXCHANGED: &str = "sessions.csv, line 4: kind = \"bendign\" is left out where a `where` asks for \"bending\"; \
                         did you mean `bending`?";

#[test]
fn rows_that_a_slip_leaves_out_are_warned_of_with_the_nearest_value() {
    assert_eq!(warned(&SLIPS, STUDY), [WRONG_CASE, EXCHANGED]);
    // Through a stage: each row is made into a set; the model leaves that in the wrong case out.
    let of_all = STUDY.replace("where = { kind = \"bending\" }\n", "");
    let through = of_all.replace("[\"sets\"]", "[\"sets\", \"model\"]")
        + "[stage.model]\njob = \"train\"\ndata = { from = \"sets\", where = { kind = \"bending\" } }\n";
    let said: Vec<String> = warned(&SLIPS, &through).into_iter().filter(|what| what.contains("left out")).collect();
    assert_eq!(said, [WRONG_CASE]);
    let spaced: Vec<String> = (2..7).map(|session| format!("S01,{session},TOUCH,,l/S0{session}.csv")).collect();
    let rows: Vec<&str> = [SLIPS[3]].into_iter().chain(spaced.iter().map(String::as_str)).collect();
    let touch = STUDY.replace("\"bending\" }", "\"touch\" }");
    let said = warned(&rows, &touch);
    assert!(
        said.len() == 1 && said[0].starts_with("sessions.csv, line 3, line 4, line 5 and 2 more: kind ="),
        "{said:?}"
    );
}

#[test]
fn rows_whose_value_is_the_same_number_are_warned_of() {
    let rows = |sessions: [&str; 4]| sessions.map(|session| format!("S01,{session},touch,,l/S0{session}.csv"));
    let plan = |sessions: [&str; 4], asked: &str| {
        let model = "[inputs.all]\ntable = \"sessions.csv\"\n[stage.model]\njob = \"train\"\n";
        let data = format!("data = {{ from = \"all.log\", where = {{ session = [{asked}] }} }}\n");
        let rows = rows(sessions);
        bench_of(&rows.each_ref().map(String::as_str)).try_plan(&format!("{model}{data}"))
    };
    let said = |sessions, asked| {
        let warnings = plan(sessions, asked).unwrap_or_else(|why| panic!("{why}")).warnings;
        warnings.into_iter().filter(|what| what.contains("did you mean")).collect::<Vec<_>>()
    };
    for other in ["01", "1.0", "001", "Session1", "S_01"] {
        let what = format!(
            "sessions.csv, line 3: session = \"{other}\" is left out where a `where` asks for \"1\"; did you mean `1`?"
        );
        assert_eq!(said(["1", other, "3", "10"], "\"1\""), [what]);
    }
    assert_eq!(said(["S01", "S02", "day_a", "day_b"], "\"S01\", \"day_a\""), [""; 0]);
    assert_eq!(said(["1", "2", "11", "cal1"], "\"1\""), [""; 0]);
    // Where no row has it, the refusal names that one.
    for (sessions, same) in
        [(["10", "01", "2", "3"], "01"), (["11", "12", "1.0", "0"], "1.0"), (["2", "3", "4", "S1"], "S1")]
    {
        let why = plan(sessions, "\"1\"").err().map(|why| why.to_string()).unwrap_or_default();
        assert!(why.ends_with(&format!("nothing has session = \"1\"; did you mean `{same}`?")), "{why}");
    }
}

#[test]
fn values_that_a_stage_is_done_for_each_of_and_that_are_all_but_the_same_are_warned_of() {
    let model = "[stage.model]\njob = \"train\"\ndata = \"sets\"\neach = [\"subject\"]\n";
    let each = STUDY.replace("[\"sets\"]", "[\"sets\", \"model\"]") + model;
    let other = ["S02,2,bending,v/S02.mp4,l/S02b.csv", "s02,1,bending,v/S03.mp4,l/S03.csv"];
    let twins = "sessions.csv: the values of `subject` `S02` and `s02` differ in case or spaces only, and count apart: \
                 are they the same?";
    assert_eq!(warned(&other, &each), [twins]);
    assert_eq!(warned(&other, STUDY), [""; 0], "for each of all keys");
    assert_eq!(warned(&[other[0], SLIPS[0]], &each), [""; 0]);
}

#[test]
fn a_row_that_does_not_say_whose_it_is_is_in_no_ones_model() {
    let text = "[inputs.all]\ntable = \"sessions.csv\"\nwhere = { kind = \"touch\" }\n[stage.model]\njob = \"train\"\n\
                data = \"all.log\"\neach = [\"subject\"]\n";
    let plan = bench_of(&["S01,1,touch,,l/S01.csv", "S02,1,touch,,l/S02.csv", ",1,touch,,l/S03.csv"]).plan(text);
    let inputs: Vec<(&str, usize)> = plan.tasks.iter().map(|task| (task.id.as_str(), task.inputs.len())).collect();
    assert_eq!(inputs, [("model/S01", 1), ("model/S02", 1)]);
    let empty = "sessions.csv, line 4: `subject` is empty: what is there is in no group of `subject`";
    assert!(plan.warnings.len() == 1 && plan.warnings[0].starts_with(empty), "{:?}", plan.warnings);
    // Joined, it goes with two sessions that others have: the refusal says why.
    let faults = bench_of(&["S01,1,bending,v/S01.mp4,l/S01.csv", ",1,bending,v/S02.mp4,l/S02.csv"]).faults(STUDY);
    assert!(
        faults[0].contains("would both be written to") && faults[0].contains("line 3: `subject` is empty"),
        "{faults:?}"
    );
}

#[test]
fn rows_that_are_left_out_by_choice_are_not_warned_of() {
    let both = STUDY.replace("\"bending\" }", "[\"bending\", \"Bending\", \"bendign\"] }");
    let of_subject = STUDY.replace("kind = \"bending\"", "subject = \"S01\"");
    let lettered = ["S01,day_a,bending,v/S01.mp4,l/S01.csv", "S01,day_b,bending,v/S02.mp4,l/S02.csv"];
    let of_day = STUDY.replace("kind = \"bending\"", "session = \"day_a\"");
    for (rows, pipeline) in [(&SLIPS[..], &both), (&SLIPS, &of_subject), (&lettered, &of_day)] {
        let said = warned(rows, pipeline);
        assert!(!said.iter().any(|what| what.contains("did you mean")), "{pipeline}: {said:?}");
    }
}

#[test]
fn files_that_only_the_case_of_letters_leaves_out_are_warned_of() {
    let bench = Bench::new(&[("l/a.csv", "1"), ("l/b.CSV", "2"), ("l/c.Csv", "3"), ("l/d.txt", "4")]);
    let one = "[inputs.logs]\nfiles = \"l/{n}.csv\"\n[stage.model]\njob = \"train\"\ndata = \"logs\"\n";
    assert_eq!(
        bench.plan(one).warnings,
        ["`l/{n}.csv` leaves out 2 file(s) whose names differ only in the case of letters: l/b.CSV, l/c.Csv; rename \
          them, or write such a letter as [cC]"]
    );
    let all = one.replace("{n}.csv", "{n}.[cC][sS][vV]");
    assert_eq!(bench.plan(&all).warnings, [""; 0]);
    let others = format!("[inputs.more]\nfiles = \"l/{{n}}.C*\"\n{}", one.replace("\"logs\"", "[\"logs\", \"more\"]"));
    assert_eq!(bench.plan(&others).warnings, [""; 0], "another input has them");
    // A photograph that came later, of another format; a preview and a mask are none.
    let pictures = ["p/a.png", "p/b.png", "p/c.JPG", "p/b.jpg", "p/a_mask.jpg", "p/a_thumb.jpg", "p/c.txt"];
    let pictures = pictures.map(|path| (path, path));
    let maps = "[inputs.nails]\nfiles = \"p/{subject}.png\"\n[stage.maps]\njob = \"normalize\"\nphoto = \"nails\"\n";
    let said = Bench::new(&pictures).plan(maps).warnings;
    let what = "`p/{subject}.png` leaves out 1 file(s) of another format, of which it takes none: p/c.JPG;";
    assert!(said.len() == 1 && said[0].starts_with(what), "{said:?}");
    #[cfg(unix)]
    {
        use std::os::unix::ffi::OsStrExt;
        std::fs::write(bench.0.path().join(std::ffi::OsStr::from_bytes(b"l/M\xfcller.csv")), "5").unwrap();
        let what = "`l/{n}.[cC][sS][vV]` leaves out 1 name(s) that are not UTF-8: l/M\u{fffd}ller.csv; rename them";
        assert_eq!(bench.plan(&all).warnings, [what]);
    }
}

#[test]
fn two_inputs_that_would_write_the_same_files_are_told() {
    let double = "subject,kind,video,log\nS01,bending,v/S01.mp4,l/S01.csv\nS01,bending,v/S02.mp4,l/S02.csv\n";
    let what = "sessions.csv, line 2 and sessions.csv, line 3 would both be written to `angles/S01/bending`; add a \
                column or a {place} that tells them apart, or choose with `where`";
    assert_eq!(bench_with("sessions.csv", double).faults(STUDY)[0], format!("5:8: {what}"));
    let no_place = "[inputs.v]\nfiles = \"v/*.mp4\"\n\n[stage.angles]\njob = \"track\"\nvideo = \"v\"\n";
    let found = bench().faults(no_place);
    assert!(found[0].starts_with("4:8: v/S01.mp4 and v/S02.mp4 would both be written to `angles`;"), "{found:?}");
    let odd = "subject,kind,video,log\na/b,bending,v/S01.mp4,l/S01.csv\na_b,bending,v/S02.mp4,l/S02.csv\n";
    let keyed = STUDY.replace("where = {", "keys = [\"subject\"]\nwhere = {");
    let found = bench_with("sessions.csv", odd).faults(&keyed);
    assert!(found[0].starts_with("6:8: ") && found[0].contains("differ only in characters"), "{found:?}");
}

#[test]
fn many_inputs_of_one_name_are_told_once() {
    let rows = "subject,kind,video,log\nS01,bending,v/S01.mp4,l/S01.csv\n\
        S01,bending,v/S02.mp4,l/S02.csv\nS01,bending,v/S03.mp4,l/S03.csv\n";
    let found = bench_with("sessions.csv", rows).faults(STUDY);
    assert_eq!(found.iter().filter(|fault| fault.contains("to `angles/S01/bending`")).count(), 1, "{found:?}");
}

#[test]
fn doubled_rows_are_told_with_their_lines() {
    let commas = "subject,kind,video,log\nS01,bending,v/S01.mp4,l/S01.csv\n\nS01,bending,v/S01.mp4,l/S01.csv\n";
    let semicolons = "subject;kind;video;log\nS01;bending;v/S01.mp4;l/S01.csv\n\nS01;bending;v/S01.mp4;l/S01.csv\n";
    for double in [commas, semicolons] {
        let said = ["3:9: sessions.csv holds 1 row(s) twice: line 2 and line 4; remove one of each"];
        assert_eq!(bench_with("sessions.csv", double).faults(STUDY), said);
    }
}

#[test]
fn tables_that_are_empty_missing_or_lack_columns_are_told() {
    assert_eq!(
        bench_with("sessions.csv", "subject,kind,video,log\n").faults(STUDY)[0],
        "3:9: sessions.csv has no rows; add one for each recording"
    );
    assert!(bench_with("sessions.csv", "").faults(STUDY)[0].starts_with("3:9: "));
    assert!(bench().faults(&STUDY.replace("sessions.csv", "session.csv"))[0].starts_with("3:9: "));
    assert_eq!(
        bench().faults(&STUDY.replace("bending.video", "bending.vidoe")),
        ["7:9: sessions.csv has no column `vidoe`; did you mean `video`?"]
    );
    assert_eq!(
        bench().faults(&STUDY.replace("kind = \"bending\"", "knid = \"bending\"")),
        ["4:11: there is no key `knid` to choose by; did you mean `kind`?"]
    );
    assert_eq!(
        bench().faults(&STUDY.replace("kind = \"bending\"", "kind = \"bendign\"")),
        ["4:11: nothing has kind = \"bendign\"; did you mean `bending`?"]
    );
}

#[test]
fn a_glob_that_matches_nothing_is_told_with_the_nearest_folder() {
    let text = "[inputs.v]\nfiles = \"videos/{subject}.mp4\"\n[stage.angles]\njob = \"track\"\nvideo = \"v\"\n";
    let found = bench().faults(text);
    assert!(
        found[0].starts_with("2:9: nothing matches `videos/{subject}.mp4`: there is no `videos` in the folder ."),
        "{found:?}"
    );
    let found = bench().faults(&text.replace("videos/{subject}.mp4", "v/{subject}.avi"));
    assert!(
        found[0].ends_with("nothing like `{subject}.avi` is in the folder v, which holds S01.mp4, S02.mp4, S03.mp4"),
        "{found:?}"
    );
    let found = bench().faults(&text.replace("videos/", "{phantom}/"));
    assert!(found[0].starts_with("2:9: `{phantom}` is named, but there is no [phantom]"), "{found:?}");
}

#[test]
fn a_wanted_stage_without_anything_to_work_on_is_told_with_the_reason() {
    let none = "subject,session,kind,video,log\nS01,1,bending,,l/S01.csv\nS02,1,bending,,l/S02.csv\n";
    let what = "`sets` is wanted and has nothing to work on: its `joints` comes from `angles` (line 5), which has \
                nothing: sessions.csv names no `video` for it (2)";
    assert_eq!(bench_with("sessions.csv", none).faults(STUDY), [format!("1:11: {what}")]);
}

#[test]
fn relations_that_cannot_be_joined_are_told() {
    let text = STUDY
        .replace("[stage.angles]", "[inputs.days]\nfiles = \"l/{day}.csv\"\n[stage.angles]")
        .replace("bending.log", "days");
    let found = bench().faults(&text);
    assert!(
        found[0].starts_with("13:7: `joints` (subject, session, kind) and `log` (day) have no key in common"),
        "{found:?}"
    );
    let many = STUDY
        .replace("video = \"bending.video\"", "video = \"one\"\nmarkers = \"bending.log\"")
        .replace("[stage.angles]", "[inputs.one]\nfiles = \"v/S01.mp4\"\n[stage.angles]");
    let found = bench().faults(&many.replace("[\"sets\"]", "[\"angles\"]"));
    assert!(found[0].starts_with("10:11: `markers` of `angles` takes one file, and for all there are 3:"), "{found:?}");
    let each =
        "[inputs.v]\nfiles = \"v/{subject}.mp4\"\n[stage.m]\njob = \"train\"\neach = [\"subjcet\"]\ndata = \"v\"\n";
    assert_eq!(
        bench().faults(each),
        ["5:8: `each` names `subjcet`, which nothing that `m` works on has; did you mean `subject`?"]
    );
}

#[test]
fn options_of_what_is_generated_are_told_at_their_line() {
    let text = "[inputs.v]\nfiles = \"v/{s}.mp4\"\n[phantom]\nstduy = {}\n[stage.m]\njob = \"train\"\ndata = \"v\"\n";
    assert_eq!(bench().faults(text), ["4:1: no phantom `stduy`; there is `study`"]);
}

#[test]
fn odd_key_values_are_folders_and_empty_ones_hold_for_all() {
    let odd = "subject,session,video,log\nMüller \
               日本,1.5,v/S01.mp4,l/S01.csv\n../x,..,v/S02.mp4,l/S02.csv\n,3,v/S03.mp4,l/S03.csv\n";
    let text = STUDY.replace("where = { kind = \"bending\" }\n", "").replace("[\"sets\"]", "[\"angles\"]");
    assert_eq!(
        ids(&bench_with("sessions.csv", odd).plan(&text)),
        ["angles/Müller_日本/1.5", "angles/_._x/_.", "angles/_/3"]
    );
}
