//! A frame drawn row by row: finger, marks, objects, the clock's screen, the sensor.

pub(in crate::phantom::video) mod blot;
pub(in crate::phantom::video) mod edge;
pub(in crate::phantom::video) mod limb;
pub(in crate::phantom::video) mod objects;
pub(in crate::phantom::video) mod paint;
pub(in crate::phantom::video) mod panel;
pub(in crate::phantom::video) mod picture;
pub(in crate::phantom::video) mod row;
pub(in crate::phantom::video) mod sensor;
pub(in crate::phantom::video) mod share;
