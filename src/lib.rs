//! lunula: ground truth for fingernail sensing.

pub mod photo;
