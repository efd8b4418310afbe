//! What the sensor is for (thesis 6, appendix C): skill, and how well methods of control are learned. The mathematics
//! are the crate `lunula-live`'s.

pub mod performance;
pub mod skill;
