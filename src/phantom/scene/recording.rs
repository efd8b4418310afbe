//! Anything that a phantom writes into one folder: what files it will be, about what it costs, and how it is made.
//!
//! All files are known before one of them stands, so that others can plan with them.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Serialize;
use thiserror::Error;

use crate::files::{Staging, WriteError};
use crate::job::Watch;
use crate::phantom::Faults;
use crate::phantom::log::{self, LogOptions, LogScene};
use crate::phantom::photos::{self, OptionFault, PhotoOptions};
use crate::phantom::study::presses::{self, PressOptions};
use crate::phantom::video::{self, Scene, VideoOptions};

/// What is written into one folder.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Recording {
    /// Photographs.
    Photos(PhotoOptions),
    /// A video, and a marker file.
    Video(Box<VideoOptions>),
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

/// Why a recording was not made.
#[derive(Debug, Error)]
pub enum RecordingError {
    /// The options can't be met.
    #[error(transparent)]
    Faults(#[from] Faults),
    /// No photographs.
    #[error(transparent)]
    Photos(#[from] photos::Error),
    /// No video.
    #[error(transparent)]
    Video(#[from] video::Error),
    /// No log.
    #[error(transparent)]
    Log(#[from] log::Error),
    /// No presses.
    #[error(transparent)]
    Press(#[from] presses::Error),
    /// No text.
    #[error(transparent)]
    Text(#[from] WriteError),
}

/// About what a recording costs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cost {
    /// Memory, bytes.
    pub memory: u64,
    /// Seconds on one thread.
    pub seconds: f64,
}

/// Seconds on one thread a pixel of a photograph and of a frame, and a millisecond of a log; measured with a release
/// build on a Xeon of 2.1 GHz.
const PHOTO_S_PER_PX: f64 = 4e-7;
const FRAME_S_PER_PX: f64 = 3.5e-8;
const LOG_S_PER_MS: f64 = 8e-7;
/// Bytes that everything takes, and a pixel of the photographs and frames under way, and a row.
const LEAST: f64 = 3e7;
const BYTES_PER_PX: f64 = 250.0;
const BYTES_PER_ROW: f64 = 1000.0;

impl Recording {
    /// Can it be made?
    ///
    /// # Errors
    /// What is wrong with the options, in the command line's words.
    pub fn check(&self) -> Result<(), Faults> {
        let faults = |fault: OptionFault| Faults(vec![fault.to_string()]);
        match self {
            Self::Photos(options) => options.check().map_err(faults),
            Self::Video(options) => options.check(),
            Self::Log(options) => options.check(),
            Self::Filmed { video, log } => video.check().and_then(|()| log.check()),
            Self::Press(_) | Self::Texts(_) => Ok(()),
        }
    }

    /// The files that it will be, with `/`, sorted.
    #[must_use]
    pub fn files(&self) -> Vec<String> {
        let mut files: Vec<String> = match self {
            Self::Photos(options) => options.files(),
            Self::Video(options) => options.files(),
            Self::Log(_) => log::files(),
            Self::Filmed { video, .. } => video.files().into_iter().chain(log::files()).collect(),
            Self::Press(_) => presses::RESULTS.map(str::to_owned).to_vec(),
            Self::Texts(texts) => texts.keys().cloned().collect(),
        };
        files.sort();
        files
    }

    /// About what it costs.
    #[must_use]
    pub fn cost(&self) -> Cost {
        let more = |memory: f64, seconds: f64| Cost { memory: (LEAST + memory) as u64, seconds };
        let film = |video: &VideoOptions| {
            let pixels = (video.width * video.height) as f64;
            more(BYTES_PER_PX * pixels, FRAME_S_PER_PX * pixels * video.frames() as f64)
        };
        let note = |log: &LogOptions| {
            let span_s = log.lead_s + log.seconds + log.trail_s;
            more(BYTES_PER_ROW * span_s * log.rate_hz, LOG_S_PER_MS * 1e3 * (span_s + 10.0))
        };
        match self {
            Self::Photos(options) => {
                let pixels = f64::from(options.width) * f64::from(options.height);
                let all = f64::from(options.subjects) * options.poses.len() as f64;
                more(BYTES_PER_PX * pixels, PHOTO_S_PER_PX * pixels * all)
            }
            Self::Video(video) => film(video),
            Self::Log(log) => note(log),
            Self::Filmed { video, log } => {
                let (film, note) = (film(video), note(log));
                Cost { memory: film.memory + note.memory, seconds: film.seconds + note.seconds }
            }
            Self::Press(_) => more(0.0, 0.05),
            Self::Texts(_) => more(0.0, 0.001),
        }
    }

    /// Makes it in `folder`. The bytes are the same whatever the number of threads.
    ///
    /// # Errors
    /// [`RecordingError`]; of each of its parts what stood before is as it was.
    pub fn write(&self, folder: &Path, watch: &Watch<'_>) -> Result<(), RecordingError> {
        let film = |options: &VideoOptions| -> Result<(), RecordingError> {
            video::write_watched(&Scene::new(options.clone())?, folder, watch)?;
            Ok(())
        };
        let note = |options: &LogOptions| -> Result<(), RecordingError> {
            log::write(&LogScene::new(options.clone())?, folder)?;
            Ok(())
        };
        match self {
            Self::Photos(options) => photos::write_watched(options, folder, watch).map(|_| ())?,
            Self::Video(options) => film(options)?,
            Self::Log(options) => note(options)?,
            Self::Filmed { video, log } => {
                film(video)?;
                note(log)?;
            }
            Self::Press(options) => presses::write(options, folder)?,
            Self::Texts(texts) => {
                let staging = Staging::new(folder)?;
                texts.iter().try_for_each(|(name, text)| staging.write(name, text.as_bytes()))?;
                staging.commit()?;
            }
        }
        Ok(())
    }
}
