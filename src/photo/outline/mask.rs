//! shim
#![allow(missing_docs)]
use super::Outline;
#[derive(Debug, Clone, thiserror::Error)]
#[error("shim")]
pub struct MaskFault;
#[derive(Debug, Clone, thiserror::Error)]
#[error("shim")]
pub struct DroppedRegion;
pub struct MaskOutlines {
    pub nails: Vec<Outline>,
    pub dropped: Vec<DroppedRegion>,
}
pub fn outlines_from_mask(_: &image::DynamicImage) -> Result<MaskOutlines, MaskFault> {
    Err(MaskFault)
}
