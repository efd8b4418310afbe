//! Ink in the picture: a crop of grey values, its connected pieces, and the lines they form.

pub(super) mod crop;
pub(super) mod line;
pub(super) mod pieces;
