//! lunula: ground truth for fingernail sensing.

pub mod labelme;
pub mod photo;
