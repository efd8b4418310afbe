//! Photographs of nails to coloration maps (section 4.2.2, Fig. 51-56).
//!
//! A photograph is read, outlined, framed, normalized, added up, drawn: [`PhotoSet`] lists which, [`Photograph`] holds upright
//! pixels, [`outline`] finds the nails, [`NailFrame`] measures axis and box, [`normalize`](fn@normalize) brings the green
//! channel into the nail's frame, [`Sums`] become mean and SD. [`run`] is the one entry; [`merge`](fn@merge) joins results
//! made in parts.

mod frame;
mod job;
mod keep;
mod maps;
mod merge;
mod normalize;
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
pub use job::{DetectedOutline, NailRow, PhotosError, PhotosOptions, PhotosResult, Watch, run};
pub use keep::{Kept, keep_outlines};
pub use maps::{DuplicateSubject, Maps, Sums};
pub use merge::{MergeError, merge};
pub use normalize::{FULL_SCALE, Normalization, Normalized, Resample, normalize};
pub use partial::{PartialFault, Partials, join};
pub use plan::plan;
pub use plane::Channel;
pub use read::{Depth, Photograph, ReadFault};
pub use report::{NailTable, PoseCount, RunReport};
pub use results::{NAIL_COLUMNS, nail_cells, write_nails};
pub use set::{Photo, PhotoSet, SetError, SetFault};
