//! The photos job's files: normalized pictures, maps, figures and `nails.csv`, all by way of a
//! [`Staging`](crate::files::Staging).

mod draw;
mod maps;
mod nails;
mod outlines;

pub(crate) use draw::Scratch;
pub(super) use draw::{DrawnPose, DrawnSheet, draw_sheets, thumbnail, write_normalized};
pub(crate) use maps::write_npy;
pub(super) use maps::{write_maps, write_pose, write_sums};
pub use nails::NailRow;
pub(super) use nails::{NailTable, nail_columns};
pub(super) use outlines::{DrawnPhotograph, MOST_DRAWN, draw_outlines, drawn_outlines};
