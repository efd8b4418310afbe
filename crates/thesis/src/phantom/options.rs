//! What study is wanted.

use serde::{Deserialize, Serialize};

use crate::section::people::Person;
use lunula::phantom::Faults;

/// A study to be made.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StudyOptions {
    /// Everything random follows from it.
    pub seed: u64,
    /// How many people are photographed.
    pub subjects: u32,
    /// How many of them wear the sensor.
    pub sensors: u32,
    /// How many of them press on a photodiode's place, slowly and quickly.
    pub presses: u32,
    /// Columns of the videos' pictures.
    pub width: usize,
    /// Rows of the videos' pictures.
    pub height: usize,
    /// Frames a second.
    pub fps: f64,
    /// How long the finger bends before the camera.
    pub seconds: f64,
}

impl StudyOptions {
    /// How many wear the sensor in the thesis (5.3.1).
    pub const SENSORS: u32 = 7;
    /// More people than anybody has.
    pub const MOST: u32 = 9_999;

    /// Checks whether this study can be made; its videos and logs are checked by [`Study::new`](super::Study::new).
    pub(super) fn check(&self) -> Result<(), Faults> {
        let mut faults = Faults::default();
        let Self { subjects, sensors, presses, .. } = *self;
        if !(1..=Self::MOST).contains(&subjects) {
            faults.0.push(format!("--subjects {subjects}: choose 1 to {}", Self::MOST));
        }
        for (option, value) in [("--sensors", sensors), ("--presses", presses)] {
            if value > subjects {
                faults.0.push(format!("{option} {value}: there are {subjects} subjects; choose no more than them"));
            }
        }
        faults.none()
    }
}

impl Default for StudyOptions {
    fn default() -> Self {
        Self {
            seed: 1,
            subjects: 16,
            sensors: Self::SENSORS,
            presses: Person::COUNT as u32,
            width: 640,
            height: 360,
            fps: 30.0,
            seconds: 60.0,
        }
    }
}
