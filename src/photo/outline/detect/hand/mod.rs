//! Where a hand's fingers end: silhouettes that may be skin, and the rounded caps on them.

mod silhouette;
mod tips;

pub(super) use silhouette::silhouettes;
pub(super) use tips::{strongest, tips};
