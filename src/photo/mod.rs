//! Photographs of nails to coloration maps (section 4.2.2, Fig. 51-56).
//!
//! A photograph is read, outlined, framed, normalized, added up, drawn: [`PhotoSet`] lists which, [`Photograph`] holds
//! upright pixels, [`outline`] finds the nails, [`NailFrame`] measures axis and box, [`normalize`](fn@normalize) brings
//! the green channel into the nail's frame, [`Sums`] become mean and SD. [`run`] is the one entry; [`merge`](fn@merge)
//! joins results made in parts, [`gather`](fn@gather) those of a pipeline, adding to the sums of an earlier run.
//! Each writes all of its results in one commit and returns its report.

mod channels;
mod error;
mod hues;
mod normalize;
mod options;
pub mod outline;
mod pose;
mod results;
mod run;
mod set;
mod sums;

pub(crate) use crate::photo::hues::{Hues, Mistaken};
pub use crate::photo::run::job::run;
pub use crate::photo::run::kind::MapsJob;
pub use crate::photo::run::plan::plan;
pub use crate::photo::run::report::{PhotosFigures, PhotosReport, PoseCount};
pub use crate::photograph::{Depth, MOST_MEGAPIXELS, Photograph, Profile, ReadFault};
pub use channels::{ChannelDifference, ChannelFigures, ChannelRow, Estimate, ZonesOf};
pub use error::{MergeError, PhotosError};
pub use normalize::{
    Channel, FULL_SCALE, FrameFault, NailFrame, Normalization, Normalized, Resample, SMALLEST_EXTENT_PX, normalize,
};
pub(crate) use normalize::{Normalizer, normalized_or_why};
pub use options::{OutlineHome, Outputs, PhotosOptions, Results};
pub use pose::THESIS_POSES;
pub(crate) use pose::is_of_thesis;
pub use results::NailRow;
pub(crate) use results::{Scratch, write_npy};
pub(crate) use set::{MASKS, stem_of_mask};
pub use set::{Photo, PhotoSet, SetError, SetFault};
pub use sums::{
    Accuracy, DuplicateSubject, GatherFigures, GatherReport, Gathering, Maps, PartialFault, Partials, Sums, gather,
    join, merge, merge_plan,
};
