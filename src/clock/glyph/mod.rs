//! One digit's picture: a digit or none, and how probable it is.
//!
//! In: a [`Patch`], cut out of a plane at the box of the character's ink ([`InkBox`]) with what background and ink are
//! worth there ([`Levels`]). Out: [`Scores`], the probability of each digit and of anything else. Printed and screen
//! typefaces, proportional or monospaced, and seven-segment displays are read alike; only digits that stand about
//! upright (10 degrees) are known.
//!
//! It abstains rather than misread: two digits blended by a change during the exposure, a digit that is covered in
//! part, a segment that is neither lit nor dark, marks, letters and blanks are *other*. A segment that is wholly gone
//! can't be detected: a covered 8 may show a clean 9.
//!
//! The way down, a file each: [`patch`] the picture in the character's own frame; [`net`] the small network that
//! weighs it; [`scores`] its answers. `crates/training` makes the weights from drawn digits alone.

mod net;
mod patch;
mod scores;

pub use patch::{InkBox, Levels, Patch};
pub use scores::{SURE, Scores};

use net::Net;

/// The network and what it looks at, for `crates/training`, which fits it: no promise of the library.
#[doc(hidden)]
pub mod training {
    pub use super::net::{
        ANSWERS, COLUMNS_1, COLUMNS_2, FIRST, FLAT, HIDDEN, Net, PARTS, REACH, ROW, ROW_1, ROWS_1, ROWS_2, SECOND,
        Trace, parts,
    };
    pub use super::patch::{HEIGHT, WIDTH};
}

/// How probably a patch shows each digit.
#[must_use]
pub fn recognise(patch: &Patch) -> Scores {
    Net::shipped().scores(patch)
}
