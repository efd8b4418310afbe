//! Videos read and written: times, damage, layouts of samples, writing. All files are made as the tests run.

#![allow(unreachable_pub, clippy::unwrap_used, reason = "helpers of tests, shared by several files")]

mod damage;
mod layouts;
mod refusals;
mod scene;
mod times;
mod writing;
