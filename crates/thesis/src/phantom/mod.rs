//! A whole experiment: photographs, videos with a clock, logs, presses, and the tables that say which is whose (3.3,
//! 4.2.2, 4.3.4, 5.3).
//!
//! In: [`StudyOptions`]. Out, under one folder, a recording in each:
//! - `photos/`: a set as `lunula phantom photos` writes it, grey as through the thesis' green filter, in its chamber:
//!   `photos/photos/<pose>/<subject>.png`;
//! - `<subject>/<session>/`: `log.csv`, and where the finger bends only `video.mp4` and `markers.toml`. Everybody who
//!   wears the sensor has `touch-1`, `touch-2`, `touch-3` (Fig. 94 to 97), `random` (Fig. 99), `bending` (Fig. 101) and
//!   `bending-random`; the first one, the typical subject, also has the preliminary experiments `normal`, `lateral`,
//!   `longitudinal` and `free-bending` (Fig. 23 to 34);
//! - `presses/<subject>-<site>/`: `slow.csv` and `quick.csv` (Fig. 79 to 82);
//! - `tables/`: `sessions.csv`, `presses.csv`, `subjects.csv`, whose files are named relative to the tables,
//!   `trials.csv` (appendix C), and `study.json`;
//! - in each of the former `truth/`.
//!
//! Everything is known before anything is made ([`Study::recordings`], [`Study::tables`]), and each recording is made
//! for itself, so that whoever wants only one makes only one. The same options give the same bytes whatever the number
//! of threads.
//!
//! What is not modelled: people's sex; that a person's nail, photodiodes and pulp belong together.

mod options;
pub(crate) mod presses;
mod recording;
mod request;
mod session;
mod tables;
#[cfg(test)]
mod tests;
pub(crate) mod trials;
mod write;

use std::collections::BTreeMap;

pub use options::StudyOptions;
pub use recording::Recording;
pub use request::StudyRequest;
use session::{Session, sessions};
pub use write::{StudyError, StudySummary, write_watched};

use crate::section::people::FIRST_SEED;
use lunula::hemodynamics::Pressed;
use lunula::job::{Keys, OptionFault, read};
use lunula::phantom::photos::{LightKind, PhotoOptions};
use lunula::phantom::{Faults, Generated as _};
use lunula::pipeline::{Asked, Block, Placed};
use lunula::words::{Words, in_order};
use presses::PressOptions;

/// The tables' folder, and which of its files says what was asked for.
const TABLES: &str = "tables";
const RECORD: &str = "study.json";

/// What a recording is of.
#[derive(Debug, Clone)]
enum Entry {
    Photos,
    Session(Session),
    /// On this place.
    Press(&'static str),
}

/// A study, settled.
#[derive(Debug, Clone)]
pub struct Study {
    options: StudyOptions,
    subjects: Vec<String>,
    entries: Vec<(StudyRecording, Entry)>,
}

/// One recording of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct StudyRecording {
    /// Its folder, with `/`.
    pub name: String,
    /// Whose it is.
    pub subject: Option<String>,
    /// What it is.
    pub recording: Recording,
}

/// A study as a block of `[phantom]`.
pub(crate) const BLOCK: Block = Block { name: "study", several: false, read: asked };

fn asked(options: &toml::Table) -> Result<Asked, OptionFault> {
    let request = read::<StudyRequest>(options, "`lunula phantom study`")?.options;
    let refused = |faults: Faults| OptionFault { key: String::new(), what: format!("`study`: {faults}") };
    let study = Study::new(request.options()).map_err(refused)?;
    let placed = |one: StudyRecording| Placed {
        keys: Keys(one.subject.map(|subject| ("subject".to_owned(), subject)).into_iter().collect()),
        name: one.name,
        recording: Box::new(one.recording),
    };
    let recordings = study.recordings().into_iter().map(placed).collect();
    Ok(Asked::Experiment { recordings, tables: study.tables() })
}

impl Study {
    /// Settles a study.
    ///
    /// # Errors
    /// [`Faults`]: all that is wrong with the options.
    pub fn new(options: StudyOptions) -> Result<Self, Faults> {
        options.check()?;
        let photos = PhotoOptions {
            seed: options.seed,
            subjects: options.subjects,
            grey: true,
            light: LightKind::Chamber,
            truth_normalized: false,
            ..PhotoOptions::default()
        };
        let subjects: Vec<String> = (0..options.subjects).map(|k| photos.subject_name(k)).collect();
        let of = |name: String, subject: Option<&String>, recording: Recording| StudyRecording {
            name,
            subject: subject.cloned(),
            recording,
        };
        let mut entries = vec![(of("photos".to_owned(), None, Recording::Photos(photos)), Entry::Photos)];
        for (subject, name) in (0..options.sensors).zip(&subjects) {
            for (number, session) in sessions(subject) {
                let recording = session.recording(&options, subject, number);
                let one = of(format!("{name}/{}", session.name), Some(name), recording);
                entries.push((one, Entry::Session(session)));
            }
        }
        for (k, name) in (0..options.presses).zip(&subjects) {
            for site in [Pressed::Proximal, Pressed::Distal] {
                let seed = options.seed.wrapping_sub(1).wrapping_mul(10_000).wrapping_add(FIRST_SEED + u64::from(k));
                let press = Recording::Press(PressOptions { name: name.clone(), seed, site });
                let one = of(format!("presses/{name}-{}", site.word()), Some(name), press);
                entries.push((one, Entry::Press(site.word())));
            }
        }
        // All videos are alike, and all logs: what is wrong with one is said once.
        let faults = entries.iter().filter_map(|(one, _)| one.recording.check().err()).flat_map(|faults| faults.0);
        Faults(in_order(faults)).none()?;
        Ok(Self { options, subjects, entries })
    }

    /// What was asked for.
    #[must_use]
    pub fn options(&self) -> &StudyOptions {
        &self.options
    }

    /// Who is photographed; those who wear the sensor come first.
    #[must_use]
    pub fn subjects(&self) -> &[String] {
        &self.subjects
    }

    /// The texts of the tables, by place under the study's folder.
    #[must_use]
    pub fn tables(&self) -> BTreeMap<String, String> {
        tables::tables(self).into_iter().map(|(name, text)| (format!("{TABLES}/{name}"), text)).collect()
    }

    /// All recordings, the tables last. No name is another's beginning up to a `/`.
    #[must_use]
    pub fn recordings(&self) -> Vec<StudyRecording> {
        let tables = Recording::Texts(tables::tables(self));
        let tables = StudyRecording { name: TABLES.to_owned(), subject: None, recording: tables };
        self.entries.iter().map(|(one, _)| one.clone()).chain([tables]).collect()
    }
}
