//! Anything that a phantom writes into one folder: what files it will be, what is known of each, about what it costs,
//! and how it is made.
//!
//! All files are known before one of them stands, so that others can plan with them.

use std::path::Path;

use serde_json::{Value, json};

use crate::job::{Facts, Watch};
use crate::phantom::Faults;
use crate::phantom::board::{self, BoardOptions};
use crate::phantom::log::{self, LogOptions, LogScene};
use crate::phantom::nailvideo::{self, NailVideoOptions};
use crate::phantom::photos::{self, PhotoOptions};
use crate::phantom::video::{self, Scene, VideoOptions};

/// What is written into one folder.
pub trait Generated: Send + Sync {
    /// Can it be made?
    ///
    /// # Errors
    /// What is wrong with the options, in the command line's words.
    fn check(&self) -> Result<(), Faults>;

    /// All that its bytes depend on.
    fn options(&self) -> Value;

    /// The files that it will be, with `/`, sorted.
    fn files(&self) -> Vec<String>;

    /// What is known of one of its files.
    fn facts(&self, _file: &str) -> Facts {
        Facts::default()
    }

    /// About what it costs.
    fn cost(&self) -> Cost;

    /// Makes it in `folder`. The bytes are the same whatever the number of threads.
    ///
    /// # Errors
    /// Why it was not made; of each of its parts what stood before is as it was.
    fn write(&self, folder: &Path, watch: &Watch<'_>) -> anyhow::Result<()>;
}

/// About what something generated costs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cost {
    /// Memory, bytes.
    pub memory: u64,
    /// Seconds on one thread.
    pub seconds: f64,
}

/// Seconds on one thread a pixel of a photograph, of a frame and of a board's view (assumed), and a millisecond of a
/// log; measured with a release build on a Xeon of 2.1 GHz.
const PHOTO_S_PER_PX: f64 = 4e-7;
const FRAME_S_PER_PX: f64 = 3.5e-8;
/// Of a nail's frame; measured with a development build, 12 s of 640x480.
const NAIL_FRAME_S_PER_PX: f64 = 1.2e-7;
const VIEW_S_PER_PX: f64 = 4e-7;
const LOG_S_PER_MS: f64 = 8e-7;
/// Bytes that everything takes, and a pixel of the photographs and frames under way, and a row where the whole log is
/// looked at before it is written.
const LEAST: f64 = 3e7;
const BYTES_PER_PX: f64 = 250.0;
const BYTES_PER_ROW: f64 = 32.0;

impl Cost {
    /// Of so much memory beyond what everything takes, bytes, and of so many seconds.
    #[must_use]
    pub fn of(memory: f64, seconds: f64) -> Self {
        Self { memory: (LEAST + memory) as u64, seconds }
    }
}

fn sorted(mut files: Vec<String>) -> Vec<String> {
    files.sort();
    files
}

impl Generated for PhotoOptions {
    fn check(&self) -> Result<(), Faults> {
        self.check()
    }

    fn options(&self) -> Value {
        json!({ "photos": self })
    }

    fn files(&self) -> Vec<String> {
        sorted(self.files())
    }

    fn facts(&self, file: &str) -> Facts {
        if Path::new(file).starts_with("photos") {
            Facts { grey: Some(self.grey), outlined: Some(self.annotate), ..Facts::default() }
        } else {
            Facts::default()
        }
    }

    fn cost(&self) -> Cost {
        let pixels = f64::from(self.width) * f64::from(self.height);
        let all = f64::from(self.subjects) * self.poses.len() as f64;
        Cost::of(BYTES_PER_PX * pixels, PHOTO_S_PER_PX * pixels * all)
    }

    fn write(&self, folder: &Path, watch: &Watch<'_>) -> anyhow::Result<()> {
        photos::write_watched(self, folder, watch)?;
        Ok(())
    }
}

impl Generated for VideoOptions {
    fn check(&self) -> Result<(), Faults> {
        self.check()
    }

    fn options(&self) -> Value {
        json!({ "video": self })
    }

    fn files(&self) -> Vec<String> {
        sorted(self.files())
    }

    fn facts(&self, file: &str) -> Facts {
        let clock = Some(self.clock.is_some());
        match file {
            "video.mp4" | "markers.toml" => {
                let distorted = Some(self.lens.is_some() || self.plane.is_some());
                Facts { clock, distorted, ..Facts::default() }
            }
            "truth/joints.csv" => Facts { clock, ..Facts::default() },
            _ => Facts::default(),
        }
    }

    fn cost(&self) -> Cost {
        let pixels = (self.width * self.height) as f64;
        Cost::of(BYTES_PER_PX * pixels, FRAME_S_PER_PX * pixels * self.frames() as f64)
    }

    fn write(&self, folder: &Path, watch: &Watch<'_>) -> anyhow::Result<()> {
        video::write_watched(&Scene::new(self.clone())?, folder, watch)?;
        Ok(())
    }
}

impl Generated for NailVideoOptions {
    fn check(&self) -> Result<(), Faults> {
        self.check()
    }

    fn options(&self) -> Value {
        json!({ "nailvideo": self })
    }

    fn files(&self) -> Vec<String> {
        sorted(self.files())
    }

    fn facts(&self, file: &str) -> Facts {
        if file == "log.csv" {
            Facts { led: Some(false), forces: Some(true), ..Facts::default() }
        } else {
            Facts::default()
        }
    }

    fn cost(&self) -> Cost {
        let pixels = f64::from(self.size.0) * f64::from(self.size.1);
        let log_s = LOG_S_PER_MS * 1e3 * (self.seconds() + 10.0);
        Cost::of(BYTES_PER_PX * pixels, NAIL_FRAME_S_PER_PX * pixels * self.frames() as f64 + log_s)
    }

    fn write(&self, folder: &Path, watch: &Watch<'_>) -> anyhow::Result<()> {
        nailvideo::write_watched(&nailvideo::Scene::new(self.clone())?, folder, watch)?;
        Ok(())
    }
}

impl Generated for BoardOptions {
    fn check(&self) -> Result<(), Faults> {
        self.check()
    }

    fn options(&self) -> Value {
        json!({ "board": self })
    }

    fn files(&self) -> Vec<String> {
        sorted(self.files())
    }

    fn cost(&self) -> Cost {
        let pixels = f64::from(self.size.0) * f64::from(self.size.1);
        Cost::of(BYTES_PER_PX * pixels, VIEW_S_PER_PX * pixels * self.views as f64)
    }

    fn write(&self, folder: &Path, watch: &Watch<'_>) -> anyhow::Result<()> {
        board::write_watched(&board::Scene::new(self.clone())?, folder, watch)?;
        Ok(())
    }
}

impl Generated for LogOptions {
    fn check(&self) -> Result<(), Faults> {
        self.check()
    }

    fn options(&self) -> Value {
        json!({ "log": self })
    }

    fn files(&self) -> Vec<String> {
        sorted(log::files(self))
    }

    fn facts(&self, file: &str) -> Facts {
        match file {
            "log.csv" => Facts { led: Some(self.led), forces: Some(self.forces), ..Facts::default() },
            "truth/angles.csv" => Facts { clock: Some(true), ..Facts::default() },
            _ => Facts::default(),
        }
    }

    fn cost(&self) -> Cost {
        let span_s = self.lead_s + self.seconds + self.trail_s;
        let kept = if self.saturate { BYTES_PER_ROW * span_s * self.rate_hz } else { 0.0 };
        Cost::of(kept, LOG_S_PER_MS * 1e3 * (span_s + 10.0))
    }

    fn write(&self, folder: &Path, _watch: &Watch<'_>) -> anyhow::Result<()> {
        log::write(&LogScene::new(self.clone())?, folder)?;
        Ok(())
    }
}
