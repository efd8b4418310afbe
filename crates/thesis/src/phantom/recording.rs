//! What a study consists of: what is generated into one folder each.

use std::collections::BTreeMap;
use std::path::Path;

use lunula::files::Staging;
use lunula::job::{Facts, Watch};
use lunula::phantom::log::LogOptions;
use lunula::phantom::photos::PhotoOptions;
use lunula::phantom::video::VideoOptions;
use lunula::phantom::{Cost, Error, Faults, Generated, Written};
use serde::Serialize;

use super::presses::{self, PressOptions};

/// What is written into one folder.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Recording {
    /// Photographs.
    Photos(PhotoOptions),
    /// A log.
    Log(Box<LogOptions>),
    /// A video and the log that was taken meanwhile.
    Filmed {
        /// The video.
        video: Box<VideoOptions>,
        /// The log.
        log: Box<LogOptions>,
    },
    /// Presses.
    Press(PressOptions),
    /// Files of text, by name.
    Texts(BTreeMap<String, String>),
}

impl Recording {
    /// The library's phantoms that it consists of.
    fn phantoms(&self) -> Vec<&dyn Generated> {
        match self {
            Self::Photos(options) => vec![options],
            Self::Log(options) => vec![&**options],
            Self::Filmed { video, log } => vec![&**video, &**log],
            Self::Press(_) | Self::Texts(_) => Vec::new(),
        }
    }
}

impl Generated for Recording {
    fn check(&self) -> Result<(), Faults> {
        self.phantoms().into_iter().try_for_each(Generated::check)
    }

    fn options(&self) -> serde_json::Value {
        serde_json::json!(self)
    }

    fn files(&self) -> Vec<String> {
        let mut files: Vec<String> = match self {
            Self::Press(_) => presses::RESULTS.map(str::to_owned).to_vec(),
            Self::Texts(texts) => texts.keys().cloned().collect(),
            _ => self.phantoms().into_iter().flat_map(Generated::files).collect(),
        };
        files.sort();
        files
    }

    fn facts(&self, file: &str) -> Facts {
        // No two of its phantoms write the same file.
        let known = self.phantoms().into_iter().map(|one| one.facts(file)).find(|facts| *facts != Facts::default());
        known.unwrap_or_default()
    }

    fn cost(&self) -> Cost {
        match self {
            Self::Press(_) => Cost::of(0.0, 0.05),
            Self::Texts(_) => Cost::of(0.0, 0.001),
            _ => self.phantoms().into_iter().map(Generated::cost).fold(Cost { memory: 0, seconds: 0.0 }, |all, one| {
                Cost { memory: all.memory + one.memory, seconds: all.seconds + one.seconds }
            }),
        }
    }

    fn write_watched(&self, folder: &Path, watch: &Watch<'_>) -> Result<Written, Error> {
        match self {
            Self::Press(options) => presses::write(options, folder)?,
            Self::Texts(texts) => {
                let staging = Staging::new(folder)?;
                texts.iter().try_for_each(|(name, text)| staging.write(name, text.as_bytes()))?;
                staging.commit()?;
            }
            _ => self.phantoms().into_iter().try_for_each(|one| one.write_watched(folder, watch).map(drop))?,
        }
        Ok(Written::default())
    }
}
