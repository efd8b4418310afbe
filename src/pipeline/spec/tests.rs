//! Faults that a pipeline file shows by itself, each with its line.

use std::path::Path;

use super::{PipelineError, Spec};
use crate::pipeline::tests::planned::TOYS;

const GOOD: &str = r#"# a comment
name = "training"
about = "what it is for"
wanted = ["sets"]

[inputs.bending]
table = "sessions.csv"
where = { kind = "bending", session = [1, 2] }

[inputs.markers]
files = "markers.toml"

[stage.sets]
job = "tie"
joints = "angles"
log = { from = "bending.log", where = { subject = "S01" } }
sync = "clock"

[stage.angles]
job = "track"
video = "bending.video"
markers = "markers"
joints = ["J2"]
"#;

fn read(text: &str) -> Result<Spec, PipelineError> {
    Spec::parse(text, Path::new("p.toml"), TOYS)
}

/// The faults of the good file with `old` replaced by `new`.
#[track_caller]
fn faults(old: &str, new: &str) -> Vec<String> {
    assert!(GOOD.contains(old), "{old}");
    faults_of(&GOOD.replacen(old, new, 1))
}

#[track_caller]
fn faults_of(text: &str) -> Vec<String> {
    match read(text) {
        Err(PipelineError::Faults { faults, .. }) => {
            faults.iter().map(|f| format!("{}:{}: {}", f.line, f.column, f.what)).collect()
        }
        Err(other) => panic!("{other}"),
        Ok(_) => panic!("no fault:\n{text}"),
    }
}

#[test]
fn a_good_file_is_read_and_its_stages_stand_in_order() {
    let spec = read(GOOD).unwrap();
    assert_eq!((spec.name.as_str(), spec.about.as_str()), ("training", "what it is for"));
    let names: Vec<&str> = spec.stages.iter().map(|stage| stage.name.as_str()).collect();
    assert_eq!(names, ["angles", "sets"]);
    assert_eq!(spec.wanted.len(), 1);
    assert_eq!(spec.stages[spec.wanted[0].stage].name, "sets");
    let columns: Vec<&str> = spec.inputs[0].columns.iter().map(|(column, _)| column.as_str()).collect();
    assert_eq!(columns, ["log", "video"]);
    let (key, values, _) = &spec.inputs[0].filter[1];
    assert_eq!((key.as_str(), &values[..]), ("session", &["1".to_owned(), "2".to_owned()][..]));
}

#[test]
fn without_wanted_the_last_stages_are_wanted_and_the_name_is_the_files() {
    let spec = read(&GOOD.replace("wanted = [\"sets\"]\n", "").replace("name = \"training\"\n", "")).unwrap();
    assert_eq!(spec.name, "p");
    assert_eq!(spec.wanted.iter().map(|w| spec.stages[w.stage].name.as_str()).collect::<Vec<_>>(), ["sets"]);
}

#[test]
fn misspelt_keys_and_unknown_names_are_told_with_the_nearest() {
    for (old, new, fault) in [
        ("wanted = ", "wnated = ", "4:1: unknown key `wnated`; did you mean `wanted`?"),
        ("sync = ", "snyc = ", "17:1: unknown key of the job `tie`: `snyc`; did you mean `sync`?"),
        ("\"tie\"", "\"tei\"", "14:7: no job `tei`; did you mean `tie`?"),
        ("\"angles\"", "\"angels\"", "15:10: `angels` is neither an input nor a stage; did you mean `angles`?"),
        (
            "\"markers\"",
            "\"my.toml\"",
            "22:11: `my.toml` is a file's name, and `markers` names an input or a stage; write [inputs.my] with \
             files = \"my.toml\", and markers = \"my\" here",
        ),
        (
            "\"markers\"",
            "\"films/{subject}/angles.mp4\"",
            "22:11: `films/{subject}/angles.mp4` is a file's name, and `markers` names an input or a stage; write \
             [inputs.angles_files] with files = \"films/{subject}/angles.mp4\", and markers = \"angles_files\" here",
        ),
        ("\"markers\"", "\"my\"", "22:11: `my` is neither an input nor a stage; known: bending, markers, sets, angles"),
        (
            "\"bending.video\"",
            "\"bendnig.csv\"",
            "21:9: `bendnig` is neither an input nor a stage; did you mean `bending`?",
        ),
        ("\"angles\"", "\"angles.joint\"", "15:10: the job `track` makes no `joint`; did you mean `joints`?"),
        ("\"markers\"", "\"markers.x\"", "22:11: `markers` are files and have no columns; write \"markers\""),
        ("[\"sets\"]", "[\"set\"]", "4:11: `set` is wanted, and no stage makes it; did you mean `sets`?"),
        ("[\"sets\"]", "\"markers\"", "4:10: `markers` is an input, which is there already; wanted are stages"),
        // An input with a fault is no unknown name too.
        ("table = \"sessions.csv\"", "table = 3", "7:9: `table` has to be text: a path"),
        ("[\"sets\"]", "[]", "4:10: nothing is wanted; name stages, or leave `wanted` out"),
    ] {
        assert_eq!(faults(old, new), [fault], "{new}");
    }
    assert_eq!(
        faults("table = ", "tabel = ")[0],
        "6:9: the input `bending` has neither `table` nor `files`; write table = \"sessions.csv\" or files = \
         \"photos/{pose}/{subject}.png\""
    );
    assert_eq!(
        faults("where = { sub", "wehre = { sub")[0],
        "16:31: unknown key of a reference `wehre`; did you mean `where`?"
    );
    assert!(
        faults("[stage.sets]", "[stages.sets]")
            .contains(&"13:2: unknown key `stages`; did you mean `stage`?".to_owned())
    );
    assert_eq!(
        faults("\"bending.video\"", "\"bending\""),
        ["21:9: `bending` is a table; say which column holds the files: \"bending.COLUMN\""]
    );
    assert_eq!(
        faults("[\"sets\"]", "[\"sets.trainin\"]"),
        ["4:11: `sets.trainin` is wanted, and the job `tie` makes no `trainin`; did you mean `training`?"]
    );
}

#[test]
fn roles_are_given_once_and_all() {
    assert_eq!(
        faults("log = { from = \"bending.log\", where = { subject = \"S01\" } }\n", ""),
        ["13:8: the stage `sets` (job `tie`) lacks `log`: a toy's; name an input or a stage"]
    );
    assert_eq!(
        faults("video = \"bending.video\"", "video = [\"bending.video\", \"bending.log\"]"),
        ["21:9: `video` takes one file of each item; name one input or stage, no list"]
    );
    let doubled = "[inputs.logs]\nfiles = \"*.csv\"\n[stage.m]\njob = \"train\"\ndata = [\"logs\", \"logs\"]\n";
    assert_eq!(faults_of(doubled), ["5:17: `data` names `logs` twice; name it once"]);
    let none = "[stage.m]\njob = \"train\"\ndata = []\n";
    assert_eq!(faults_of(none), ["3:8: `data` is empty; name an input or a stage: a toy's"]);
}

#[test]
fn wrong_types_are_told() {
    for (old, new, place, words) in [
        ("wanted = [\"sets\"]", "wanted = 3", "4:10", "`wanted` has to be stages' names"),
        ("name = \"training\"", "name = 3", "2:8", "`name` has to be text"),
        ("table = \"sessions.csv\"", "table = 3", "7:9", "`table` has to be text"),
        ("\"sessions.csv\"", "\"sessions.csv\"\nfiles = \"x\"", "8:1", "both `table` and `files`"),
        ("where = { kind = \"bending\", session = [1, 2] }", "where = 3", "8:9", "`where` has to be keys"),
        ("session = [1, 2]", "session = []", "8:39", "has to be a value"),
        ("job = \"tie\"", "job = 3", "14:7", "`job` has to be a job's name"),
        ("joints = \"angles\"", "joints = 3", "15:10", "`joints` is integer; name an input or a stage"),
        ("from = \"bending.log\"", "from = 3", "16:16", "`log` lacks `from`"),
        ("sync = \"clock\"", "sync = 3", "17:8", "`sync` has to be text"),
        ("sync = \"clock\"", "each = 3", "17:8", "`each` has to be keys' names"),
        ("sync = \"clock\"", "each = [\"a\", \"a\"]", "17:14", "`each` names `a` twice"),
        (
            "[inputs.markers]\nfiles = \"markers.toml\"",
            "[inputs]\nmarkers = \"x\"",
            "11:1",
            "`markers` is no table but string",
        ),
        ("files = \"markers.toml\"", "files = \"markers.toml\"\nkeys = [\"a\"]", "12:1", "`keys` are of tables"),
    ] {
        let found = faults(old, new);
        assert!(found.iter().any(|f| f.starts_with(&format!("{place}: ")) && f.contains(words)), "{new}: {found:?}");
    }
}

#[test]
fn a_circle_is_told_with_its_lines() {
    let text =
        "[stage.a]\njob = \"evaluate\"\nmodel = \"b\"\ndata = \"b\"\n\n[stage.b]\njob = \"train\"\ndata = \"a\"\n";
    let what = "stages work on one another in a circle: `a` (line 1) -> `b` (line 6) -> `a` (line 1); one of them has \
                to work on an input";
    assert_eq!(faults_of(text), [format!("1:8: {what}")]);
    let own = "[stage.a]\njob = \"train\"\ndata = \"a\"\n";
    assert_eq!(faults_of(own), ["1:8: `a` (line 1) works on itself; name what it is to work on"]);
}

#[test]
fn names_are_folders_and_are_given_once() {
    assert!(faults("[inputs.markers]", "[inputs.\"a.b\"]")[0].starts_with("10:9: `a.b` can't name a input"));
    assert_eq!(
        faults("[inputs.markers]", "[inputs.sets]")[0],
        "13:8: `sets` is an input already (line 10); give the stage another name"
    );
    assert!(
        faults("[stage.sets]", "[stage.phantom]")
            .iter()
            .any(|f| f.starts_with("13:8: a stage can't be called `phantom`"))
    );
    let doubled = faults("[stage.angles]", "[stage.sets]");
    assert!(doubled.iter().any(|f| f.starts_with("19:") && f.contains("stands here a second time")), "{doubled:?}");
}

#[test]
fn what_is_no_toml_or_says_nothing_is_told() {
    assert!(faults("job = \"tie\"", "job = \"tie")[0].starts_with("14:"));
    assert_eq!(faults_of(""), ["1:1: no stages; write [stage.NAME] with its job and what it works on"]);
    assert!(faults_of("stage = 3")[0].starts_with("1:1: `stage` is no table but integer"));
}

#[test]
fn all_faults_are_told_together_in_the_order_of_lines() {
    let text =
        GOOD.replace("wanted = ", "wnated = ").replace("\"tie\"", "\"tei\"").replace("\"markers\"", "\"marker\"");
    let lines: Vec<String> = faults_of(&text).iter().map(|f| f[..f.find(':').unwrap()].to_owned()).collect();
    assert_eq!(lines, ["4", "14", "22"]);
}

#[test]
fn columns_are_characters_and_other_line_ends_are_read() {
    let text = "name = \"Müller\" ; x\r\n";
    let found = faults_of(text);
    assert!(found[0].starts_with("1:17: "), "{found:?}");
    assert!(read(&format!("\u{feff}{}", GOOD.replace('\n', "\r\n"))).is_ok());
}

#[test]
fn a_file_that_is_missing_or_no_text_is_refused_with_the_place() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("p.toml");
    std::fs::write(&path, b"name = \"x\"\n# \xff").unwrap();
    let why = Spec::read(&path, TOYS).err().unwrap().to_string();
    assert!(why.ends_with("p.toml:2:3: not UTF-8 text; save the file as UTF-8"), "{why}");
    assert!(Spec::read(&dir.path().join("none.toml"), TOYS).err().unwrap().to_string().contains("lunula init"));
}

#[test]
fn a_file_of_a_million_quotes_is_refused_at_once() {
    let begun = std::time::Instant::now();
    for (pattern, times) in
        [("\"\n", 500_000), ("\"\"\n", 300_000), ("'a' = ''\n", 100_000), ("[\"", 500_000), ("\"", 1_000_000)]
    {
        let found = faults_of(&pattern.repeat(times));
        assert!(!found.is_empty() && found.len() <= 101, "{pattern:?}: {} faults", found.len());
        assert!(
            found.len() < 101 || found[100].contains("more faults are not named"),
            "{pattern:?}: {:?}",
            found.last()
        );
    }
    let wanted = format!("wanted = [{}]\n{GOOD}", "\"\", ".repeat(200_000)).replace("wanted = [\"sets\"]\n", "");
    assert_eq!(faults_of(&wanted).len(), 101);
    // Measured: 4 s unoptimized on a busy machine; it was 55 s of a million, and ten times that of half a million
    // lines.
    assert!(begun.elapsed().as_secs_f64() < 40.0, "{:?}", begun.elapsed());
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("p.toml");
    std::fs::write(&path, "#".repeat((1 << 20) + 1)).unwrap();
    let why = Spec::read(&path, TOYS).err().unwrap().to_string();
    assert!(why.contains("1048577 bytes") && why.contains("1048576 at most"), "{why}");
}
