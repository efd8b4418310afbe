//! The tables of a study: sessions, presses, people, trials of appendix C, and what was asked for.
//!
//! Files are named relative to the tables' folder; a cell is empty where there is no such file. `truth` of a session
//! are the exact angles at the video's frames, `truth_log` the exact angles, forces and volts of the log's rows;
//! `truth` of a press are the person's parameters.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::trials::trials;
use super::{Entry, RECORD, Study, StudyRecording, TABLES};
use lunula::phantom::Generated as _;
use lunula::phantom::nail::Subject;

const SESSIONS: &str = "subject,session,kind,repetition,video,markers,log,truth,truth_log\n";
const PRESSES: &str = "subject,site,kind,recording,truth\n";
const SUBJECTS: &str = "subject,tone,skin,sensor,presses\n";
/// Where 4.2.2's seven white, seven Asian and two black subjects part on the tones of sixteen.
const SKINS: [(f64, &str); 3] = [(7.0 / 16.0, "white"), (14.0 / 16.0, "Asian"), (f64::INFINITY, "black")];

/// The texts of the tables, by name.
pub(super) fn tables(study: &Study) -> BTreeMap<String, String> {
    let (mut sessions, mut presses) = (SESSIONS.to_owned(), PRESSES.to_owned());
    let up = format!("{}/", TABLES.split('/').map(|_| "..").collect::<Vec<_>>().join("/"));
    for (StudyRecording { name, subject, recording }, entry) in &study.entries {
        let files = recording.files();
        let subject = subject.as_deref().unwrap_or_default();
        let file = |file: &str| {
            if files.iter().any(|own| own == file) { format!("{up}{name}/{file}") } else { String::new() }
        };
        match entry {
            Entry::Photos => {}
            Entry::Session(session) => {
                let cells = ["video.mp4", "markers.toml", "log.csv", "truth/joints.csv", "truth/log.csv"].map(file);
                let (own, kind, repetition) = (session.name, session.kind, session.repetition);
                // Writing to a text does not fail.
                let _ = writeln!(sessions, "{subject},{own},{kind},{repetition},{}", cells.join(","));
            }
            Entry::Press(site) => {
                for kind in ["slow", "quick"] {
                    let [recording, truth] = [format!("{kind}.csv"), "truth/parameters.toml".to_owned()];
                    let _ = writeln!(presses, "{subject},{site},{kind},{},{}", file(&recording), file(&truth));
                }
            }
        }
    }
    let options = study.options();
    let mut subjects = SUBJECTS.to_owned();
    for (k, name) in study.subjects().iter().enumerate() {
        let tone = Subject::random(options.seed, k as u32).tone.darkness();
        let skin = SKINS.into_iter().find(|(end, _)| tone < *end).map_or("", |(_, skin)| skin);
        let yes = |count: u32| u8::from((k as u32) < count);
        let _ = writeln!(subjects, "{name},{tone:.3},{skin},{},{}", yes(options.sensors), yes(options.presses));
    }
    let record = serde_json::json!({ "study": options, "typical": study.subjects().first() });
    [
        ("sessions.csv", sessions),
        ("presses.csv", presses),
        ("subjects.csv", subjects),
        ("trials.csv", trials(options.seed)),
        (RECORD, format!("{record:#}\n")),
    ]
    .map(|(name, text)| (name.to_owned(), text))
    .into()
}
