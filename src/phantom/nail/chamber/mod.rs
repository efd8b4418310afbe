//! What photographs the nail: camera and light.

pub(in crate::phantom::nail) mod camera;
pub(in crate::phantom::nail) mod light;
