//! lunula: ground truth for fingernail sensing.

pub mod figure;
pub mod files;
pub mod labelme;
pub mod phantom;
pub mod photo;
pub mod stages;
pub mod tradeoff;
