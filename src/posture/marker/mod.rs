//! One marker in one frame: how it looks, and its centre to a fraction of a pixel with its standard error.
//!
//! In: a frame, where its chroma lies, how the marker looks and where it is within a few pixels. Out: a [`fit::Fit`],
//! or why there is none.

pub(super) mod blot;
pub(super) mod centre;
mod disc;
pub(super) mod fit;
pub(super) mod inflation;
pub(in crate::posture) mod looks;
pub(super) mod method;
mod rough;
pub(super) mod sight;
