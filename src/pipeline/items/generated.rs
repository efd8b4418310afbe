//! Generated recordings: what the block `[phantom]` of a pipeline file asks for, and what will stand below `{phantom}`.
//!
//! ```toml
//! [phantom]
//! study = { seed = 1, subjects = 4 }     # a whole experiment: {phantom}/photos, {phantom}/s01/bending, ..
//! photos = { seed = 1, grey = true }                  # or single scenes: {phantom}/photos/photos/<pose>/<subject>.png
//! video = { scene = "hard", seconds = 20 }            # {phantom}/video/video.mp4, markers.toml, truth/
//! log = { protocol = "touch" }                        # {phantom}/log/log.csv, truth/
//! video = [{ name = "a", .. }, { name = "b", .. }]    # or several of a kind: {phantom}/video/a, {phantom}/video/b
//! ```
//!
//! The options are those of `lunula phantom study|photos|video|log`, with `_` for `-`. Each recording is a task of its
//! own.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use toml::{Table, Value};

use crate::job::{Facts, Keys, Made, Maker, OptionFault, Said, Work, read};
use crate::phantom::request::{LogRequest, PhotosRequest, StudyRequest, VideoRequest};
use crate::phantom::study::Study;
use crate::phantom::{Faults, Recording};
use crate::pipeline::{Catalogue, CatalogueFile, CatalogueTask};
use crate::stages::Stages;

/// Counted up where the same options give other bytes than before.
const REVISION: u32 = 1;
/// What a block may hold.
const BLOCKS: [&str; 4] = ["study", "photos", "video", "log"];
/// The name of one of several.
const NAME: &str = "name";

/// A recording and its place.
struct Placed {
    name: String,
    keys: Keys,
    recording: Recording,
}

/// What a block `[phantom]` makes.
///
/// # Errors
/// [`OptionFault`], the first thing that is wrong; a key within a block is named as `video.seconds`.
pub fn phantom_catalogue(block: &Table) -> Result<Catalogue, OptionFault> {
    let mut placed = Vec::new();
    let mut tables = BTreeMap::new();
    if block.is_empty() {
        let what = format!("[phantom] asks for nothing; write one of {}, as study = {{ seed = 1 }}", BLOCKS.join(", "));
        return Err(OptionFault { key: String::new(), what });
    }
    for (key, value) in block {
        let blocks = blocks(key, value)?;
        for (name, options) in blocks {
            let fault = |fault: OptionFault| inner(key, fault);
            let refused = |faults: Faults| OptionFault { key: key.clone(), what: format!("`{key}`: {faults}") };
            let one = match key.as_str() {
                "study" => {
                    let request = read::<StudyRequest>(&options, "`lunula phantom study`").map_err(fault)?.options;
                    let study = Study::new(request.options()).map_err(refused)?;
                    tables.extend(study.tables());
                    placed.extend(study.recordings().into_iter().map(|one| Placed {
                        keys: Keys(one.subject.map(|subject| ("subject".to_owned(), subject)).into_iter().collect()),
                        name: one.name,
                        recording: one.recording,
                    }));
                    continue;
                }
                "photos" => {
                    let request = read::<PhotosRequest>(&options, "`lunula phantom photos`").map_err(fault)?.options;
                    Recording::Photos(request.options())
                }
                "video" => {
                    let options = without_files(key, &options)?;
                    let request = read::<VideoRequest>(options, "`lunula phantom video`").map_err(fault)?.options;
                    Recording::Video(Box::new(request.options().map_err(|why| unread(key, &why))?))
                }
                _ => {
                    let options = without_files(key, &options)?;
                    let request = read::<LogRequest>(options, "`lunula phantom log`").map_err(fault)?.options;
                    Recording::Log(Box::new(request.options().map_err(|why| unread(key, &why))?))
                }
            };
            one.check().map_err(refused)?;
            let keys = Keys(name.iter().map(|name| ("session".to_owned(), name.clone())).collect());
            let name = name.map_or_else(|| key.clone(), |name| format!("{key}/{name}"));
            placed.push(Placed { name, keys, recording: one });
        }
    }
    if let Some(name) = twice(&placed) {
        let what = format!(
            "two recordings would stand in {{phantom}}/{name}; leave one out, or give single scenes other names"
        );
        return Err(OptionFault { key: String::new(), what });
    }
    Ok(catalogue(placed, tables))
}

/// A name that stands at the beginning of another's.
fn twice(placed: &[Placed]) -> Option<&str> {
    let mut names: Vec<&str> = placed.iter().map(|one| one.name.as_str()).collect();
    names.sort_unstable();
    let within = |outer: &str, inner: &str| inner == outer || inner.starts_with(&format!("{outer}/"));
    names.windows(2).find(|pair| within(pair[0], pair[1])).map(|pair| pair[0])
}

/// The options of one scene, or of several with their names.
fn blocks(key: &str, value: &Value) -> Result<Vec<(Option<String>, Table)>, OptionFault> {
    let fault = |what: String| OptionFault { key: key.to_owned(), what };
    if !BLOCKS.contains(&key) {
        return Err(fault(format!("`{key}` is nothing that can be generated; there are {}", BLOCKS.join(", "))));
    }
    match value {
        Value::Table(options) => Ok(vec![(None, options.clone())]),
        Value::Array(several) if matches!(key, "video" | "log") => {
            let named = several.iter().map(|one| {
                let mut options = one.as_table()?.clone();
                let name = options.remove(NAME)?.as_str()?.to_owned();
                let plain = |c: char| c.is_alphanumeric() || "-_.".contains(c);
                let usable = !name.is_empty() && !name.starts_with('.') && name.chars().all(plain);
                usable.then_some((Some(name), options))
            });
            let named: Option<Vec<_>> = named.collect();
            named.filter(|all| !all.is_empty()).ok_or_else(|| {
                fault(format!(
                    "`{key}` is a list: write [{{ name = \"a\", .. }}, ..], a name of letters and digits in each"
                ))
            })
        }
        _ => Err(fault(format!("`{key}` has to be a table of options, as {key} = {{ seed = 1 }}"))),
    }
}

/// The planner knows no files but inputs: a movement is known by its name here.
fn without_files<'a>(key: &str, options: &'a Table) -> Result<&'a Table, OptionFault> {
    const NAMES: [&str; 5] = ["eq27", "free", "random", "even", "rest"];
    match options.get("trajectory").and_then(Value::as_str) {
        Some(other) if !NAMES.contains(&other) => {
            let what = format!("`trajectory` is {} in a pipeline, not a file as `{other}`", NAMES.join(", "));
            Err(OptionFault { key: format!("{key}.trajectory"), what })
        }
        _ => Ok(options),
    }
}

fn inner(key: &str, fault: OptionFault) -> OptionFault {
    let key = if fault.key.is_empty() { key.to_owned() } else { format!("{key}.{}", fault.key) };
    OptionFault { key, what: fault.what }
}

fn unread(key: &str, why: &anyhow::Error) -> OptionFault {
    OptionFault { key: key.to_owned(), what: format!("{why:#}") }
}

fn catalogue(placed: Vec<Placed>, tables: BTreeMap<String, String>) -> Catalogue {
    let mut files = Vec::new();
    let mut tasks = Vec::new();
    for (task, Placed { name, keys, recording }) in placed.into_iter().enumerate() {
        files.extend(recording.files().into_iter().map(|file| CatalogueFile {
            path: format!("{name}/{file}"),
            task,
            facts: facts(&recording, &file),
        }));
        let cost = recording.cost();
        let options = serde_json::json!({ "kind": "phantom", "revision": REVISION, "recording": recording });
        let job = Arc::new(Generate(recording));
        tasks.push(CatalogueTask { name, keys, options, memory: cost.memory, cost_s: cost.seconds, job });
    }
    files.sort_by(|a, b| a.path.cmp(&b.path));
    Catalogue { tasks, files, tables }
}

/// What is known of a file of a recording.
fn facts(recording: &Recording, file: &str) -> Facts {
    let none = Facts::default();
    let is = |name: &str| file == name;
    match recording {
        Recording::Photos(options) if Path::new(file).starts_with("photos") => {
            Facts { grey: Some(options.grey), outlined: Some(options.annotate), ..none }
        }
        Recording::Video(video) | Recording::Filmed { video, .. } if is("video.mp4") || is("markers.toml") => {
            Facts { clock: Some(video.clock.is_some()), distorted: Some(video.lens.is_some()), ..none }
        }
        Recording::Log(log) | Recording::Filmed { log, .. } if is("log.csv") => {
            Facts { led: Some(log.led), forces: Some(true), ..none }
        }
        Recording::Filmed { .. } | Recording::Video(_) if is("truth/joints.csv") => {
            Facts { clock: facts(recording, "video.mp4").clock, ..none }
        }
        Recording::Filmed { .. } | Recording::Log(_) if is("truth/angles.csv") => Facts { clock: Some(true), ..none },
        _ => none,
    }
}

/// Makes a recording.
struct Generate(Recording);

impl Maker for Generate {
    fn run(&self, work: &Work) -> anyhow::Result<Made> {
        let stages = Stages::default();
        let said = Said::default();
        work.run(&said, |watch| stages.time("generate", || self.0.write(work.folder, watch)))?;
        let report = serde_json::json!({ "job": "phantom", "files": self.0.files().len() });
        Ok(Made { report, stages: stages.list(), ..Made::default() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Result<Catalogue, OptionFault> {
        phantom_catalogue(&text.parse().unwrap())
    }

    fn refused(text: &str) -> (String, String) {
        let fault = of(text).err().unwrap();
        (fault.key, fault.what)
    }

    fn facts_of(catalogue: &Catalogue, path: &str) -> Facts {
        let file = catalogue.files.iter().find(|file| file.path == path);
        file.unwrap_or_else(|| panic!("{path}: {:#?}", catalogue.files)).facts
    }

    #[test]
    fn single_scenes_have_their_folders_and_their_facts() {
        let catalogue = of("photos = { subjects = 2, poses = [\"nominal\"], no_annotations = true }\n\
            video = [{ name = \"plain\", seconds = 1 }, \
            { name = \"bent\", distortion = [-0.1], clock = \"mm:ss.t\" }]\n\
            log = { no_led = true }")
        .unwrap();
        let names: Vec<&str> = catalogue.tasks.iter().map(|task| task.name.as_str()).collect();
        assert_eq!(names, ["log", "photos", "video/plain", "video/bent"]);
        let photograph = facts_of(&catalogue, "photos/photos/nominal/s02.png");
        assert_eq!((photograph.grey, photograph.outlined), (Some(false), Some(false)));
        let (plain, bent) =
            (facts_of(&catalogue, "video/plain/video.mp4"), facts_of(&catalogue, "video/bent/video.mp4"));
        assert_eq!((plain.clock, plain.distorted), (Some(false), Some(false)));
        assert_eq!((bent.clock, bent.distorted), (Some(true), Some(true)));
        let log = facts_of(&catalogue, "log/log.csv");
        assert_eq!((log.led, log.forces, log.clock), (Some(false), Some(true), None));
        assert!(catalogue.files.is_sorted_by(|a, b| a.path < b.path) && catalogue.tables.is_empty());
        for file in &catalogue.files {
            assert!(file.path.starts_with(&format!("{}/", catalogue.tasks[file.task].name)));
        }
        // What is asked for with other options is another thing.
        let other = of("log = {}").unwrap();
        assert_ne!(catalogue.tasks[0].options, other.tasks[0].options);
    }

    #[test]
    fn a_study_is_a_task_a_recording_and_its_tables_are_among_its_files() {
        let catalogue = of("study = { subjects = 3, sensors = 2, presses = 0 }").unwrap();
        assert_eq!(catalogue.tasks.len(), 1 + 2 * 6 + 4 + 1);
        assert!(catalogue.tables.keys().all(|name| catalogue.files.iter().any(|file| file.path == *name)));
        let task = catalogue.tasks.iter().find(|task| task.name == "s02/bending").unwrap();
        assert_eq!(task.keys.get("subject"), Some("s02"));
        let video = facts_of(&catalogue, "s02/bending/video.mp4");
        assert_eq!((video.clock, video.distorted), (Some(true), Some(false)));
        assert_eq!(facts_of(&catalogue, "photos/photos/nominal/s01.png").grey, Some(true));
        let sessions = &catalogue.tables["tables/sessions.csv"];
        assert!(
            sessions.contains("\ns02,touch-2,touch,2,,,../s02/touch-2/log.csv,,../s02/touch-2/truth/log.csv\n"),
            "{sessions}"
        );
        assert!(!sessions.contains("s02,normal") && sessions.contains("s01,normal"));
        // A person is the same whoever else takes part.
        let more = of("study = { subjects = 16 }").unwrap();
        let options = |catalogue: &Catalogue| {
            catalogue.tasks.iter().find(|task| task.name == "s02/bending").map(|task| task.options.clone())
        };
        assert_eq!(options(&catalogue), options(&more));
        assert_ne!(options(&of("study = { seed = 2 }").unwrap()), options(&more));
    }

    #[test]
    fn what_is_wrong_is_told_of_its_key() {
        for (text, key, words) in [
            ("", "", "asks for nothing"),
            ("studdy = {}", "studdy", "there are study, photos, video, log"),
            ("study = 1", "study", "has to be a table"),
            ("study = { subjects = 0 }", "study", "--subjects 0"),
            ("video = { secnds = 1 }", "video.secnds", "did you mean `seconds`"),
            ("video = { seconds = \"long\" }", "video.seconds", "`long`"),
            ("video = { trajectory = \"mine.csv\" }", "video.trajectory", "not a file"),
            ("video = [{ seconds = 1 }]", "video", "a name of letters"),
            ("video = [{ name = \"../a\" }]", "video", "a name of letters"),
            ("photos = [{ name = \"a\" }]", "photos", "has to be a table"),
            ("video = [{ name = \"a\" }, { name = \"a\" }]", "", "{phantom}/video/a"),
            ("study = {}\nphotos = {}", "", "{phantom}/photos"),
            ("log = { seconds = -1 }", "log", "--seconds -1"),
        ] {
            let (found, what) = refused(text);
            assert!(found == key && what.contains(words), "{text}: {found}: {what}");
        }
    }
}
