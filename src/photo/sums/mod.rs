//! Sums over subjects: maps from them, files of them, and how those made in parts are joined.

mod accuracy;
mod batch;
mod gather;
mod look;
mod maps;
mod members;
mod merge;
mod npz;
mod partial;

pub use accuracy::Accuracy;
pub(super) use batch::Batch;
pub use gather::{GatherFigures, GatherReport, Gathering, gather};
pub(super) use look::{Look, one_picture, seen_again};
pub(super) use maps::mean_of_nails;
pub use maps::{DuplicateSubject, Maps, Sums};
pub(super) use members::{Member, Members, OF_A_PART};
pub use merge::{merge, merge_plan};
pub use partial::{PartialFault, Partials, join};
pub(super) use partial::{bytes, bytes_of_part, part_name};
