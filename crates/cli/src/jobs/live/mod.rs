//! The commands of what the sensor is for, a file each.

mod performance;
mod skill;

pub(crate) use performance::PerformanceArgs;
pub(crate) use skill::SkillArgs;
