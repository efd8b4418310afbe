//! What `lunula phantom ..` takes, in words: the command line's options, which are a pipeline file's keys.

mod choices;
mod clock;
mod log;
mod photos;
mod video;
mod worn;

pub use choices::parse_size;
pub(in crate::phantom) use choices::{
    parse_gap, parse_percent, parse_plane, parse_set_clock, parse_span_of_frames, positions,
};
pub use log::LogRequest;
pub use photos::PhotosRequest;
pub use video::VideoRequest;
