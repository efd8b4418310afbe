//! Photographs of nails to coloration maps (section 4.2.2, Fig. 51-56).
//!
//! A photograph is read, outlined, framed, normalized, added up, drawn: [`PhotoSet`] lists which, [`Photograph`] holds
//! upright pixels, [`outline`] finds the nails, [`NailFrame`] measures axis and box, [`normalize`](fn@normalize) brings
//! the green channel into the nail's frame, [`Sums`] become mean and SD. [`run`] is the one entry; [`merge`](fn@merge)
//! joins results made in parts, [`gather`](fn@gather) those of a pipeline, going on from the sums that stand.

mod frame;
mod gather;
mod job;
mod keep;
mod maps;
mod members;
mod merge;
mod nail_row;
mod normalization;
mod normalize;
mod npz;
pub mod outline;
mod partial;
mod plan;
mod plane;
mod read;
mod report;
mod resample;
mod results;
mod set;

pub use frame::{FrameFault, NailFrame, SMALLEST_EXTENT_PX};
pub use gather::{Gathered, gather};
pub use job::{DetectedOutline, PartOptions, PhotosError, PhotosOptions, PhotosResult, Watch, run};
pub use keep::{Kept, keep_outlines};
pub use maps::{DuplicateSubject, Maps, Sums};
pub use merge::{MergeError, merge};
pub use nail_row::NailRow;
pub use normalization::{Normalization, Resample};
pub use normalize::{FULL_SCALE, Normalized, normalize};
pub use partial::{PartialFault, Partials, join};
pub use plan::{Foreknown, plan, plan_foreknown};
pub use plane::Channel;
pub use read::{Depth, MOST_MEGAPIXELS, Photograph, ReadFault};
pub use report::{NailTable, PoseCount, RunReport};
pub use results::{NAIL_COLUMNS, nail_cells, write_nails};
pub(crate) use set::is_picture;
pub use set::{Photo, PhotoSet, SetError, SetFault};
