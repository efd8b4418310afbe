//! lunula: ground truth for fingernail sensing.

pub mod labelme;
pub mod phantom;
pub mod photo;
