//! The pipeline file for what was found, with the reasons in comments.

use std::collections::BTreeSet;
use std::fmt::Write;

use super::look::{Inventory, Passed, PhotoTable, Reason};
use super::shape::{NamePattern, PlaceNames, shape};
use crate::pipeline::items::pattern::{Listed, Match, Pattern};

/// How many names of a sort are listed.
const TOLD: usize = 3;

/// An input of the file: its name in references, and its keys.
struct Input {
    reference: String,
    names: Vec<String>,
    /// The values of the keys, one list per file; none of a table.
    values: Option<Vec<Vec<String>>>,
}

impl Input {
    /// Whether any of these is of one recording with any of the others, which have all of its keys.
    fn meets(&self, others: &Self) -> bool {
        let (Some(own), Some(theirs)) = (&self.values, &others.values) else { return true };
        // One file is of one of several recordings, and its name doesn't say of which.
        if self.names.is_empty() && theirs.len() > 1 {
            return false;
        }
        let at = |name: &String| others.names.iter().position(|other| other == name);
        let Some(places) = self.names.iter().map(at).collect::<Option<Vec<usize>>>() else { return false };
        let are_one = |one: &[String], other: &[String]| places.iter().zip(one).all(|(&at, value)| other[at] == *value);
        own.iter().any(|one| theirs.iter().any(|other| are_one(one, other)))
    }
}

/// A pipeline file for a folder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Proposal {
    /// What to write.
    pub text: String,
    /// Files of the sorts that it works on which it leaves out, and folders with such files that were not looked at, in
    /// words; the text says it too.
    pub left_out: Vec<String>,
}

/// A pipeline file in the making.
struct Draft<'a> {
    from: &'a str,
    /// All files of the folder.
    all: Listed,
    notes: Vec<String>,
    /// Notes of files that a person would expect to be used.
    left_out: Vec<String>,
    inputs: String,
    stages: String,
    wanted: Vec<&'static str>,
}

/// The file; none where nothing found can be worked on.
pub(super) fn pipeline(found: &Inventory, from: &str) -> Option<Proposal> {
    let mut draft = Draft {
        from,
        all: Listed::new(found.all.iter().map(String::as_str)),
        notes: Vec::new(),
        left_out: Vec::new(),
        inputs: String::new(),
        stages: String::new(),
        wanted: Vec::new(),
    };
    draft.photographs(found);
    draft.recordings(found);
    if !found.results.is_empty() {
        draft.notes.push(format!("results of lunula, which are no recordings: {}", listed(&found.results)));
    }
    if !found.runs.is_empty() {
        draft.notes.push(format!("results of `lunula run`, which are no recordings, in {}", listed(&found.runs)));
    }
    for (said, is_missed) in passed_over(found) {
        draft.left_out.extend(is_missed.then(|| said.clone()));
        draft.notes.push(said);
    }
    if !found.unknown.is_empty() {
        draft.notes.push(format!("not known, and not used: {}", listed(&found.unknown)));
    }
    if found.unnamed > 0 {
        draft.notes.push(format!("{} names are not UTF-8, and are not looked at; rename them", found.unnamed));
    }
    if draft.wanted.is_empty() {
        return None;
    }
    let wanted: Vec<String> = draft.wanted.iter().map(|name| format!("\"{name}\"")).collect();
    let notes: String = draft.notes.iter().map(|note| format!("#   {note}\n")).collect();
    let text = format!(
        "# Written by `lunula init`.\n#\n#   lunula run THIS.toml --out results --plan      what would be done, and \
         what not\n#   lunula run THIS.toml --out results             again: only what is new\n#\n# What was \
         found:\n{notes}\nwanted = [{}]\n{}{}",
        wanted.join(", "),
        draft.inputs,
        draft.stages
    );
    Some(Proposal { text, left_out: draft.left_out })
}

/// Folders that were not looked at, a line for each reason, and whether files of use are in them.
pub(super) fn passed_over(found: &Inventory) -> Vec<(String, bool)> {
    let mut kinds: Vec<(Reason, bool)> = found.passed.iter().map(|passed| (passed.reason, passed.is_missed)).collect();
    kinds.sort_unstable();
    kinds.dedup();
    let line = |(reason, is_missed): (Reason, bool)| {
        let of_kind = |passed: &&Passed| (passed.reason, passed.is_missed) == (reason, is_missed);
        let paths: Vec<String> = found.passed.iter().filter(of_kind).map(|passed| passed.path.clone()).collect();
        let why = match reason {
            Reason::GeneratedTruth => "the truth of generated recordings",
            Reason::Truth => "by its name it holds what is true of recordings; rename it where it holds recordings",
            Reason::Deep => "too many folders deep; move it up, or run `lunula init` on a folder nearer to it",
            Reason::NoRecords => {
                "`lunula run` worked there, and which results are its is not known any more; move your own files out"
            }
        };
        (format!("not looked at: {} ({why})", listed(&paths)), is_missed)
    };
    kinds.into_iter().map(line).collect()
}

impl Draft<'_> {
    fn photographs(&mut self, found: &Inventory) {
        self.left_out.extend(found.other_photo_tables.iter().cloned());
        self.notes.extend(found.other_photo_tables.iter().cloned());
        if let Some(table) = &found.photo_table {
            self.photo_table(table, &found.photos);
            return;
        }
        let Some(photos) = self.files("photos", "photographs of nails", &found.photos, PlaceNames::Nails) else {
            return;
        };
        if photos.names.is_empty() {
            self.notes.push("one photograph: a map needs several subjects".to_owned());
        }
        if photos.names == ["subject"] && have_parts(&found.photos) {
            self.notes.push(
                "every photograph is taken for a subject of its own, but names seem to have parts: where they tell \
                 subject and pose,\n#   write files = \"..{subject}_{pose}..\""
                    .to_owned(),
            );
        }
        let without_masks = self.inputs.len();
        let (outlines, of_masks) = match self.files("masks", "masks of nails", &found.masks, PlaceNames::Nails) {
            // A mask of each subject is the same in all poses.
            Some(masks) if masks.meets(&photos) => ("outlines = \"masks\"\n", "masks, "),
            Some(_) => {
                self.inputs.truncate(without_masks);
                self.notes.push(
                    "masks are not used: which photograph each belongs to does not follow from their pattern; put them \
                     into a folder, called as their photographs, and write outlines = \"masks\" in \
                     [stage.normalized]"
                        .to_owned(),
                );
                ("", "")
            }
            None => ("", ""),
        };
        self.maps("photos", outlines, of_masks);
    }

    /// Photographs as a table names them.
    fn photo_table(&mut self, table: &PhotoTable, unnamed: &[String]) {
        let PhotoTable { path, photos, outlines } = table;
        self.notes.push(format!("{photos} photographs of nails, with subjects and poses: {path}"));
        if !unnamed.is_empty() {
            let said = format!(
                "photographs that {path} doesn't name, which are not used: {}; give each a row there",
                listed(unnamed)
            );
            self.notes.push(said.clone());
            self.left_out.push(said);
        }
        let path = quoted(&format!("{}{path}", self.from));
        let _ = write!(self.inputs, "\n[inputs.photos]\ntable = {path}\nkeys = [\"subject\", \"pose\"]\n");
        match outlines {
            true => self.maps("photos.file", "outlines = \"photos.outline\"\n", "the table, "),
            false => self.maps("photos.file", "", ""),
        }
    }

    fn maps(&mut self, photos: &str, outlines: &str, of_masks: &str) {
        let _ = write!(
            self.stages,
            "\n# Each nail upright and of one size, in the green channel; outlines from {of_masks}<photo>.json, else \
             detected.\n[stage.normalized]\njob = \"normalize\"\nphoto = \"{photos}\"\n{outlines}\n\
             # Mean and standard deviation over subjects, for each pose.\n[stage.maps]\njob = \"maps\"\nsums = \
             \"normalized\"\n"
        );
        self.wanted.push("maps");
    }

    fn recordings(&mut self, found: &Inventory) {
        let (video, markers, log, joints) = match &found.sessions {
            Some(sessions) => {
                self.notes.push(format!("{}: a table of {} recordings", sessions.path, sessions.rows));
                let path = quoted(&format!("{}{}", self.from, sessions.path));
                let keys: Vec<String> = sessions.keys.iter().map(|key| quoted(key)).collect();
                let _ = write!(
                    self.inputs,
                    "\n# Its columns of files are named below; an empty cell: there is no such \
                     file.\n[inputs.recordings]\ntable = {path}\nkeys = [{}]\n",
                    keys.join(", ")
                );
                let column = |column: &Option<String>| {
                    column.as_ref().map(|column| Input {
                        reference: format!("recordings.{column}"),
                        names: sessions.keys.clone(),
                        values: None,
                    })
                };
                (column(&sessions.video), column(&sessions.markers), column(&sessions.log), column(&sessions.joints))
            }
            None => {
                let places = PlaceNames::Recordings;
                (
                    self.files("videos", "videos", &found.videos, places),
                    None,
                    self.files("logs", "logs of photodiodes", &found.logs, places),
                    self.files("joints", "tables of angles", &found.joints, places),
                )
            }
        };
        let markers = markers.or_else(|| self.markers(found, video.as_ref()));
        let angles = self.angles(video, markers, joints);
        self.sets(found, angles, log.as_ref());
        self.models(found, log.as_ref());
    }

    /// One marker file for all videos, or one beside each, or one for all that share a key.
    fn markers(&mut self, found: &Inventory, video: Option<&Input>) -> Option<Input> {
        let video = video?;
        let own = shape(&found.markers, PlaceNames::Recordings).filter(|own| own.names.len() == 1);
        let is_shared = |k: usize| {
            let all: BTreeSet<&String> = video.values.iter().flatten().map(|values| &values[k]).collect();
            own.as_ref().is_some_and(|own| own.values.iter().all(|values| all.contains(&values[0])))
        };
        let shared = (0..video.names.len()).find(|&k| is_shared(k)).map(|k| video.names[k].clone());
        let places = shared.as_deref().map_or(PlaceNames::Recordings, PlaceNames::One);
        self.files("markers", "marker files", &found.markers, places)
    }

    fn angles(&mut self, video: Option<Input>, markers: Option<Input>, joints: Option<Input>) -> Option<Input> {
        match (video, markers) {
            (Some(video), Some(markers)) if !markers.names.is_empty() && !markers.meets(&video) => {
                self.notes.push(
                    "which marker file belongs to which video does not follow from their names, so no angles are \
                     planned: put each beside its video, or list them in a table, a row per recording with columns \
                     subject, session, video, markers, and run `lunula init` again"
                        .to_owned(),
                );
                joints
            }
            (Some(video), Some(markers)) => {
                let _ = write!(
                    self.stages,
                    "\n# Joint angles of every frame; joints = [\"J2\"] measures only some of \
                     them.\n[stage.angles]\njob = \"posture\"\nvideo = {}\nmarkers = {}\n",
                    quoted(&video.reference),
                    quoted(&markers.reference)
                );
                self.wanted.push("angles");
                Some(Input { reference: "angles".to_owned(), ..video })
            }
            (Some(_), None) => {
                self.notes.push(
                    "videos without a marker file are not used: write one with `lunula posture VIDEO \
                                 --suggest`, then run `lunula init` again"
                        .to_owned(),
                );
                joints
            }
            (None, _) => joints,
        }
    }

    fn sets(&mut self, found: &Inventory, angles: Option<Input>, log: Option<&Input>) {
        let (Some(angles), Some(log)) = (angles, log) else { return };
        // Each would be labelled with the same angles, and no step could tell that they are another recording's.
        if !log.meets(&angles) {
            self.notes.push(
                "which log belongs to which video does not follow from their names, so no labelled sets are planned: \
                 list them in a table, a row per recording with columns subject, session, video, log, and run \
                 `lunula init` again"
                    .to_owned(),
            );
            return;
        }
        let of_video = angles.reference == "angles";
        let clock = if of_video { found.clock } else { found.joints_clock };
        let sync = if clock {
            "# The clock in the picture ties video and log.\n".to_owned()
        } else {
            self.notes.push("no clock in the picture is known: the lag between video and log is looked for".to_owned());
            "# No clock is known: the lag is looked for; if you know it, write sync = \"offset=SECONDS\".\n".to_owned()
        };
        let line = if clock { "" } else { "sync = \"correlate\"\n" };
        let _ = write!(
            self.stages,
            "\n# Angles on the rows of the logs.\n{sync}[stage.sets]\njob = \"align\"\njoints = {}\nlog = {}\n{line}",
            quoted(&angles.reference),
            quoted(&log.reference)
        );
        self.wanted.push("sets");
    }

    fn models(&mut self, found: &Inventory, log: Option<&Input>) {
        let Some(log) = log.filter(|_| found.forces) else { return };
        let each = if log.names.iter().any(|name| name == "subject") { "each = [\"subject\"]\n" } else { "" };
        if log.names == ["session"] && log.values.is_some() {
            self.notes.push(
                "all logs are trained on as sessions of one person: where {session} is a person, write {subject} for \
                 it throughout, and each = [\"subject\"] in [stage.force]"
                    .to_owned(),
            );
        }
        let _ = write!(
            self.stages,
            "\n# Forces from the photodiodes; validate = .. names recordings to report on that are not trained \
             on.\n[stage.force]\njob = \"train\"\n{each}data = {}\ntarget = \"force\"\n",
            quoted(&log.reference)
        );
        self.wanted.push("force");
    }

    /// An input of files, if there are any.
    fn files(&mut self, name: &str, what: &str, paths: &[String], places: PlaceNames<'_>) -> Option<Input> {
        let NamePattern { pattern, names, values, others } = shape(paths, places)?;
        self.notes.push(format!("{} {what}: {pattern}", values.len()));
        if !others.is_empty() {
            let said = format!(
                "{what} of another folder, name or ending than {pattern}, which are not used: {}; move, rename or \
                 export them as the others, or name them in an input of their own",
                listed(&others)
            );
            self.notes.push(said.clone());
            self.left_out.push(said);
        }
        let _ = write!(self.inputs, "\n[inputs.{name}]\nfiles = {}\n", quoted(&format!("{}{pattern}", self.from)));
        self.choose(what, &pattern, &names, &values);
        Some(Input { reference: name.to_owned(), names, values: Some(values) })
    }

    /// A `where` that leaves out what the pattern fits as well; `values` are of what is meant.
    fn choose(&mut self, what: &str, pattern: &str, names: &[String], values: &[Vec<String>]) {
        let Ok(pattern) = Pattern::parse(pattern) else { return };
        let of = |found: &Match| names.iter().map(|name| found.keys.get(name).unwrap_or_default().to_owned()).collect();
        let mut strays: Vec<Vec<String>> = pattern.find(&self.all).matches.iter().map(of).collect();
        let meant: BTreeSet<&Vec<String>> = values.iter().collect();
        strays.retain(|stray| !meant.contains(stray));
        let mut chosen = Vec::new();
        for (at, name) in names.iter().enumerate() {
            let known: BTreeSet<&str> = values.iter().map(|one| one[at].as_str()).collect();
            let before = strays.len();
            strays.retain(|stray| known.contains(stray[at].as_str()));
            if strays.len() < before {
                let known: Vec<String> = known.into_iter().map(quoted).collect();
                chosen.push(format!("{name} = [{}]", known.join(", ")));
            }
        }
        if !chosen.is_empty() {
            let chosen = chosen.join(", ");
            let _ = writeln!(
                self.inputs,
                "# Only {what}: the pattern fits other files too; add new ones here.\nwhere = {{ {chosen} }}"
            );
        }
        if !strays.is_empty() {
            self.notes.push(format!("{what}: the pattern fits {} more files, which are none; move them", strays.len()));
        }
    }
}

/// Whether names are of several parts, of which the first ones or the last ones come again: `S01_rest`, `S01_press`.
fn have_parts(paths: &[String]) -> bool {
    let stem = |path: &String| {
        let name = path.rsplit('/').next().unwrap_or_default();
        name.rsplit_once('.').map_or(name, |(stem, _)| stem).to_owned()
    };
    let stems: Vec<String> = paths.iter().map(stem).collect();
    let parted: Option<Vec<(&str, &str)>> = stems.iter().map(|stem| stem.split_once(['_', '-'])).collect();
    parted.is_some_and(|parts| {
        let first: BTreeSet<&str> = parts.iter().map(|(first, _)| *first).collect();
        let last: BTreeSet<&str> = parts.iter().map(|(_, last)| *last).collect();
        first.len() > 1 && first.len() < parts.len() && last.len() > 1 && last.len() < parts.len()
    })
}

fn listed(names: &[String]) -> String {
    let shown = names[..names.len().min(TOLD)].join(", ");
    if names.len() > TOLD { format!("{shown}, .. ({} in all)", names.len()) } else { shown }
}

/// A text of TOML.
fn quoted(text: &str) -> String {
    toml::Value::from(text).to_string()
}
