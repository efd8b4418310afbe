//! Frame by frame: the clock is found, its cells and glyphs are learnt, then it is followed.

mod follow;
mod learn;
mod locate;
mod reader;

pub use reader::ClockReader;
