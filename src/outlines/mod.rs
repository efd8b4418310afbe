//! The outlines of a set of photographs, corrected by a person, a nail at a time.
//!
//! In: a [`PhotoSet`](crate::photo::PhotoSet), and keys. Out: LabelMe files beside the photographs (or where the set's
//! list has them), which `lunula photos` reads; pictures of the part around the nail that is shown, and of the nail as
//! it would come out, made by the code that makes the results. Doubtful nails come first, then photographs on which
//! nothing was found, then drawn outlines where the network sees the nail elsewhere, then what detection found, then
//! what somebody has drawn.
//!
//! Who draws and listens is not known here: [`Editor`] leaves its state as JSON and is given keys as JSON. Most
//! corrections are of five numbers (place, length, width, direction), each changed by a key, and the border is looked
//! for from there. A nail is saved when it is accepted, whole or not at all.

mod annotation;
mod editor;
mod key;
mod options;
mod picture;
mod report;
mod shape;
mod state;
mod survey;
mod view;

pub use crate::photo::outline::NOT_A_NAIL;
pub use editor::{Editor, Pressed, Show};
pub use options::EditOptions;
pub use report::{EditFigures, EditReport};
pub use shape::Stride;
pub use survey::edit_steps;
