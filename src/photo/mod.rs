//! Photographs of nails to coloration maps (section 4.2.2, Fig. 51-56).
//!
//! A photograph is read, outlined, framed, normalized, added up, drawn: [`PhotoSet`] lists which, [`Photograph`] holds
//! upright pixels, [`outline`] finds the nails, [`NailFrame`] measures axis and box, [`normalize`](fn@normalize) brings
//! the green channel into the nail's frame, [`Sums`] become mean and SD. [`run`] is the one entry; [`merge`](fn@merge)
//! joins results made in parts, [`gather`](fn@gather) those of a pipeline, adding to the sums of an earlier run.
//! Each writes all of its results in one commit and returns its report.

mod error;
mod job;
mod kind;
mod normalize;
mod options;
pub mod outline;
mod plan;
mod read;
mod report;
mod results;
mod set;
mod sums;

pub use error::{MergeError, PhotosError};
pub use job::run;
pub use kind::{MapsJob, NormalizeJob};
pub use normalize::{
    Channel, FULL_SCALE, FrameFault, NailFrame, Normalization, Normalized, Resample, SMALLEST_EXTENT_PX, normalize,
};
pub use options::{OutlineHome, Outputs, PhotosOptions, Results};
pub use plan::plan;
pub use read::{Depth, MOST_MEGAPIXELS, Photograph, ReadFault};
pub use report::{PhotosFigures, PhotosReport, PoseCount};
pub use results::NailRow;
pub use set::{Photo, PhotoSet, SetError, SetFault};
pub use sums::{
    Accuracy, DuplicateSubject, GatherFigures, GatherReport, Gathering, Maps, PartialFault, Partials, Sums, gather,
    join, merge, merge_plan,
};
