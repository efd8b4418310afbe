//! How fingers move and press: trajectories, forces, random waves.

pub mod contacts;
pub mod finger;
pub(in crate::phantom) mod follow;
pub mod force;
pub mod presses;
pub mod trajectory;
pub(in crate::phantom) mod wave;
