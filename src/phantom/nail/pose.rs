//! The eight poses of the thesis (Fig. 51): what the finger does while its nail is photographed.

use std::{fmt, str::FromStr};

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::photo::THESIS_POSES;

/// One of the thesis' eight force and posture poses, in the order of [`THESIS_POSES`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Pose {
    /// No force, the finger held straight out.
    Nominal,
    /// Normal force of -3 N.
    Normal,
    /// Lateral shear of -2 N: sliding to the subject's left.
    LateralNegative,
    /// Lateral shear of +2 N: sliding to the subject's right.
    LateralPositive,
    /// Longitudinal shear of -2 N: pulling backward.
    LongitudinalNegative,
    /// Longitudinal shear of +2 N: pushing forward.
    LongitudinalPositive,
    /// Fully extended, no force.
    Extension,
    /// Fully flexed, no force.
    Flexion,
}

impl Pose {
    /// All eight, in the order of Fig. 51.
    pub const ALL: [Self; 8] = [
        Self::Nominal,
        Self::Normal,
        Self::LateralNegative,
        Self::LateralPositive,
        Self::LongitudinalNegative,
        Self::LongitudinalPositive,
        Self::Extension,
        Self::Flexion,
    ];

    /// The name in folders and tables.
    pub fn name(self) -> &'static str {
        THESIS_POSES[self as usize]
    }
}

impl fmt::Display for Pose {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// A word that names no pose.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("no pose is called \"{0}\"; the poses are {names}", names = Pose::ALL.map(Pose::name).join(", "))]
pub struct UnknownPose(pub String);

impl FromStr for Pose {
    type Err = UnknownPose;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        Self::ALL.into_iter().find(|pose| pose.name() == name).ok_or_else(|| UnknownPose(name.to_owned()))
    }
}
