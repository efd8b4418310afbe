//! What `lunula phantom ..` takes, in words: the command line's options, which are a pipeline file's keys.

mod choices;
mod clock;
mod log;
mod photos;
mod video;
mod worn;

pub(in crate::phantom) use choices::parse_plane;
pub use choices::parse_size;
pub use log::LogRequest;
pub use photos::PhotosRequest;
pub use video::VideoRequest;
