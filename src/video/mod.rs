//! Video files: frames with their own time and their own planes in, frames with given times out.
//!
//! A [`Video`] gives [`Frame`]s in the order of presentation, each with the time that its container gives it and with
//! its Y', Cb and Cr samples as they were decoded: nothing is converted, nothing copied; HDR is made ordinary video.
//! Frames and coordinates are those of the *stored* picture; [`Turn`] leads from there to the picture as it is shown
//! (upright). The centre of the top-left sample of the luma is (0, 0), x to the right, y down.

/// Endings of films, in lower case.
pub(crate) const FILMS: [&str; 6] = ["mp4", "mov", "avi", "mkv", "m4v", "webm"];

mod colour;
mod error;
mod frame;
mod info;
mod quantizer;
mod read;
mod turn;
mod write;

pub use colour::bgr::Bgr;
pub use colour::curve::Curve;
pub(crate) use colour::curve::{Lit, Times};
pub use colour::matrix::Matrix;
pub use colour::transfer::Transfer;
pub use error::VideoError;
pub use frame::{Format, Frame, Picture, Plane};
pub use info::Info;
pub use read::decode::{End, Item, Video};
pub use read::header::Header;
pub use turn::Turn;
pub use write::codec::Codec;
pub use write::encode::{Encoder, Encoding};
