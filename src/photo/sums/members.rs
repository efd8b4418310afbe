//! Which subjects' pictures sums are made of, and their contents' hashes: they show whether an earlier run's sums can
//! be added to.
//!
//! `members.json`: the normalization and, by pose, the parts that were added up. Of a part of a pipeline
//! (`partials/members.json`) it lists that part's own.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::maps::Sums;
use crate::files::{Staging, WriteError};
use crate::input;
use crate::photo::normalize::Normalization;

/// Where the list is among the results of a part of a pipeline.
pub(in crate::photo) const OF_A_PART: &str = "partials/members.json";
/// Where it is among maps.
pub(super) const OF_MAPS: &str = "members.json";

/// Sums that were added, all of one file.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(in crate::photo) struct Member {
    /// Whose pictures.
    pub(super) subjects: BTreeSet<String>,
    /// Of the file's content.
    sha256: String,
}

/// All that was added, by pose.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(in crate::photo) struct Members {
    /// What the normalized pictures were made with.
    pub(super) normalization: Normalization,
    /// By pose, sorted.
    pub(super) poses: BTreeMap<String, BTreeSet<Member>>,
}

impl Member {
    /// What was written of `sums`.
    pub(in crate::photo) fn of(sums: &Sums, file: &[u8]) -> Self {
        Self { subjects: sums.subjects.clone(), sha256: format!("{:x}", Sha256::digest(file)) }
    }
}

impl Members {
    /// None yet.
    pub(in crate::photo) fn new(normalization: Normalization) -> Self {
        Self { normalization, poses: BTreeMap::new() }
    }

    pub(in crate::photo) fn add(&mut self, pose: &str, member: Member) {
        self.poses.entry(pose.to_owned()).or_default().insert(member);
    }

    /// Each pose and subject that was added.
    pub(super) fn names(&self) -> impl Iterator<Item = (&str, &str)> {
        self.poses.iter().flat_map(|(pose, members)| {
            members.iter().flat_map(|member| &member.subjects).map(move |subject| (pose.as_str(), subject.as_str()))
        })
    }

    /// Reads a list.
    pub(super) fn read(file: &Path) -> Result<Self, String> {
        let text = input::read(file).map_err(|why| why.to_string())?;
        serde_json::from_slice(&text).map_err(|why| why.to_string())
    }

    /// Writes the list, [`OF_A_PART`] or [`OF_MAPS`].
    pub(in crate::photo) fn write(&self, staging: &Staging, name: &str) -> Result<(), WriteError> {
        let text = serde_json::to_string_pretty(self).map_err(|why| staging.refused(name, why))?;
        staging.write(name, (text + "\n").as_bytes())
    }
}
