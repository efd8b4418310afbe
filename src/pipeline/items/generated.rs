//! Generated recordings: what the block `[phantom]` of a pipeline file asks for, and what will stand below `{phantom}`.
//!
//! ```toml
//! [phantom]
//! photos = { seed = 1, grey = true }                  # {phantom}/photos/photos/<pose>/<subject>.png, truth/
//! video = { scene = "hard", seconds = 20 }            # {phantom}/video/video.mp4, markers.toml, truth/
//! log = { protocol = "touch" }                        # {phantom}/log/log.csv, truth/
//! board = { views = 12 }                              # {phantom}/board/views/01.png .., truth/
//! nailvideo = { protocol = "touch" }                  # {phantom}/nailvideo/video.mp4, outline.json, log.csv, truth/
//! video = [{ name = "a", .. }, { name = "b", .. }]    # or several of a kind: {phantom}/video/a, {phantom}/video/b
//! ```
//!
//! The options are those of `lunula phantom photos|video|log|board|nailvideo`, with `_` for `-`. Each recording is a
//! task of its own. What may be asked for is a list ([`Block`]): others bring experiments of many recordings.

use std::collections::BTreeMap;
use std::sync::Arc;

use clap::Args;
use toml::{Table, Value};

use crate::job::{Keys, Made, OptionFault, Said, Work, read};
use crate::phantom::board::BoardOptions;
use crate::phantom::nailvideo::NailVideoRequest;
use crate::phantom::request::{LogRequest, PhotosRequest, VideoRequest};
use crate::phantom::{Faults, Generated};
use crate::pipeline::{Catalogue, CatalogueFile, CatalogueTask};
use crate::stages::Stages;

/// Counted up where the same options give other bytes than before.
const REVISION: u32 = 1;
/// The name of one of several.
const NAME: &str = "name";

/// What the block `[phantom]` may ask for, by its name there.
#[derive(Debug, Clone, Copy)]
pub struct Block {
    /// Its name: `video`.
    pub name: &'static str,
    /// Whether it may be a list, with a name in each.
    pub several: bool,
    /// Reads its options. A fault's key is the option's, empty where it is of all of them.
    pub read: fn(&Table) -> Result<Asked, OptionFault>,
}

/// What is to be generated.
pub enum Asked {
    /// One scene, in the folder of the block's name.
    Scene(Box<dyn Generated>),
    /// A whole experiment.
    Experiment {
        /// Each in its own folder.
        recordings: Vec<Placed>,
        /// The text of the tables of sessions, by path: they are also among the recordings' files.
        tables: BTreeMap<String, String>,
    },
}

/// Something generated, and its place.
pub struct Placed {
    /// Its folder, with `/`. None is another's beginning up to a `/`.
    pub name: String,
    /// Whose it is.
    pub keys: Keys,
    /// What it is.
    pub recording: Box<dyn Generated>,
}

/// The scenes of `lunula phantom photos|video|log|board|nailvideo`.
#[must_use]
pub fn scenes() -> &'static [Block] {
    &[
        Block { name: "photos", several: false, read: |o| scene(o, "photos", |r: &PhotosRequest| Ok(r.options())) },
        Block { name: "video", several: true, read: |o| scene(without_files(o)?, "video", VideoRequest::options) },
        Block { name: "log", several: true, read: |o| scene(without_files(o)?, "log", LogRequest::options) },
        Block { name: "board", several: true, read: |o| scene(o, "board", |r: &BoardOptions| Ok(r.clone())) },
        Block {
            name: "nailvideo",
            several: true,
            read: |o| scene(without_files(o)?, "nailvideo", NailVideoRequest::options),
        },
    ]
}

/// The scene that `lunula phantom NAME` makes with these options.
fn scene<R: Args, G: Generated + 'static>(
    options: &Table,
    name: &str,
    make: fn(&R) -> anyhow::Result<G>,
) -> Result<Asked, OptionFault> {
    let request = read::<R>(options, &format!("`lunula phantom {name}`"))?.options;
    let scene = make(&request).map_err(|why| OptionFault::whole(format!("{why:#}")))?;
    Ok(Asked::Scene(Box::new(scene)))
}

/// What a block `[phantom]` makes, which may ask for any of `known`.
///
/// # Errors
/// [`OptionFault`], the first thing that is wrong; a key within a block is named as `video.seconds`.
pub fn phantom_catalogue(block: &Table, known: &[Block]) -> Result<Catalogue, OptionFault> {
    let names = || known.iter().map(|one| one.name).collect::<Vec<_>>().join(", ");
    let mut placed = Vec::new();
    let mut tables = BTreeMap::new();
    if block.is_empty() {
        let example = known.first().map_or("", |one| one.name);
        let what = format!("[phantom] asks for nothing; write one of {}, as {example} = {{ seed = 1 }}", names());
        return Err(OptionFault::whole(what));
    }
    for (key, value) in block {
        let Some(asked) = known.iter().find(|one| one.name == key) else {
            let what = format!("`{key}` is nothing that can be generated; there are {}", names());
            return Err(OptionFault { key: key.clone(), what });
        };
        for (name, options) in blocks(asked, value)? {
            let recording = match (asked.read)(&options).map_err(|fault| inner(key, fault))? {
                Asked::Scene(recording) => recording,
                Asked::Experiment { recordings, tables: own } => {
                    placed.extend(recordings);
                    tables.extend(own);
                    continue;
                }
            };
            let refused = |faults: Faults| OptionFault { key: key.clone(), what: format!("`{key}`: {faults}") };
            recording.check().map_err(refused)?;
            let keys = Keys(name.iter().map(|name| ("session".to_owned(), name.clone())).collect());
            let name = name.map_or_else(|| key.clone(), |name| format!("{key}/{name}"));
            placed.push(Placed { name, keys, recording });
        }
    }
    if let Some(name) = twice(&placed) {
        let what = format!(
            "two recordings would stand in {{phantom}}/{name}; leave one out, or give single scenes other names"
        );
        return Err(OptionFault::whole(what));
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
fn blocks(asked: &Block, value: &Value) -> Result<Vec<(Option<String>, Table)>, OptionFault> {
    let key = asked.name;
    let fault = |what: String| OptionFault { key: key.to_owned(), what };
    match value {
        Value::Table(options) => Ok(vec![(None, options.clone())]),
        Value::Array(several) if asked.several => {
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
fn without_files(options: &Table) -> Result<&Table, OptionFault> {
    const NAMES: [&str; 6] = ["eq27", "free", "random", "even", "rest", "sway"];
    if options.contains_key("positions") {
        let what = "`positions` names a file; a pipeline has the thesis' places".to_owned();
        return Err(OptionFault { key: "positions".to_owned(), what });
    }
    match options.get("trajectory").and_then(Value::as_str) {
        Some(other) if !NAMES.contains(&other) => {
            let what = format!("`trajectory` is {} in a pipeline, not a file as `{other}`", NAMES.join(", "));
            Err(OptionFault { key: "trajectory".to_owned(), what })
        }
        _ => Ok(options),
    }
}

fn inner(key: &str, fault: OptionFault) -> OptionFault {
    let key = if fault.key.is_empty() { key.to_owned() } else { format!("{key}.{}", fault.key) };
    OptionFault { key, what: fault.what }
}

fn catalogue(placed: Vec<Placed>, tables: BTreeMap<String, String>) -> Catalogue {
    let mut files = Vec::new();
    let mut tasks = Vec::new();
    for (task, Placed { name, keys, recording }) in placed.into_iter().enumerate() {
        files.extend(recording.files().into_iter().map(|file| CatalogueFile {
            path: format!("{name}/{file}"),
            task,
            facts: recording.facts(&file),
        }));
        let cost = recording.cost();
        let options = serde_json::json!({ "kind": "phantom", "revision": REVISION, "recording": recording.options() });
        let job = Arc::new(move |work: &Work<'_>| generate(&*recording, work));
        tasks.push(CatalogueTask { name, keys, options, memory: cost.memory, cost_s: cost.seconds, job });
    }
    files.sort_by(|a, b| a.path.cmp(&b.path));
    Catalogue { tasks, files, tables }
}

/// Makes a recording.
fn generate(recording: &dyn Generated, work: &Work<'_>) -> anyhow::Result<Made> {
    let stages = Stages::default();
    let said = Said::default();
    work.run(&said, |watch| stages.time("generate", || recording.write_watched(work.folder, watch)))?;
    let report = serde_json::json!({ "job": "phantom", "files": recording.files().len() });
    Ok(Made { report, stages: stages.list(), ..Made::default() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Facts;

    fn of(text: &str) -> Result<Catalogue, OptionFault> {
        phantom_catalogue(&text.parse().unwrap(), scenes())
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
    fn contacts_are_listed_with_their_options() {
        let log = |more: &str| of(&format!("log = {{ protocol = \"contacts\"{more} }}")).unwrap();
        let plain = log("");
        let other = log(", kinds = [\"press\", \"tap\"], no_forces = true, pulse = 0.01");
        assert_eq!(facts_of(&plain, "log/truth/contacts.csv"), Facts::default());
        assert_eq!(facts_of(&other, "log/log.csv").forces, Some(false));
        let text = other.tasks[0].options.to_string();
        assert!(text.contains("\"kinds\":[\"press\",\"tap\"]") && text.contains("\"pulse_v\":0.01"), "{text}");
        assert!(!of("log = {}").unwrap().files.iter().any(|file| file.path.ends_with("contacts.csv")));
        assert_eq!(refused("log = { protocol = \"contacts\", kinds = [\"kick\"] }").0, "log.kinds");
    }

    #[test]
    fn what_is_wrong_is_told_of_its_key() {
        for (text, key, words) in [
            ("", "", "asks for nothing"),
            ("videos = {}", "videos", "there are photos, video, log, board, nailvideo"),
            ("log = 1", "log", "has to be a table"),
            ("video = { secnds = 1 }", "video.secnds", "did you mean `seconds`"),
            ("video = { seconds = \"long\" }", "video.seconds", "`long`"),
            ("video = { trajectory = \"mine.csv\" }", "video.trajectory", "not a file"),
            ("video = [{ seconds = 1 }]", "video", "a name of letters"),
            ("video = [{ name = \"../a\" }]", "video", "a name of letters"),
            ("photos = [{ name = \"a\" }]", "photos", "has to be a table"),
            ("video = [{ name = \"a\" }, { name = \"a\" }]", "", "{phantom}/video/a"),
            ("log = { seconds = -1 }", "log", "--seconds -1"),
        ] {
            let (found, what) = refused(text);
            assert!(found == key && what.contains(words), "{text}: {found}: {what}");
        }
    }
}
