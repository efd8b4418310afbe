//! Video files: frames with their own time and their own planes in, frames with given times out.
//!
//! A [`Video`] gives [`Frame`]s in the order of presentation, each with the time that its container gives it and with
//! its Y', Cb and Cr samples as they were decoded: nothing is converted, nothing copied. Frames and coordinates are
//! those of the *stored* picture; [`Turn`] leads from there to the picture as it is shown (upright). The centre of the
//! top-left sample of the luma is (0, 0), x to the right, y down.

mod bgr;
mod convert;
mod decode;
mod encode;
mod error;
mod extent;
mod frame;
mod header;
mod hidden;
mod info;
mod matrix;
mod order;
mod pixel;
mod reader;
mod source;
mod turn;
mod upright;

pub use bgr::Bgr;
pub use decode::{End, Item, Video};
pub use encode::{Encoder, Encoding};
pub use error::VideoError;
pub use frame::{Format, Frame, Picture, Plane};
pub use header::Header;
pub use info::Info;
pub use matrix::Matrix;
pub use turn::Turn;
