//! What makes the weights that lunula comes with: two programs, `digits` and `nails`, each with its recipe in its
//! `--help`.
//!
//! [`digits`] draws characters and fits the network that reads filmed clocks; [`nails`] renders phantoms and fits the
//! five networks that find nails. What a network sees in training is made by the library's own steps
//! (`lunula::clock::training`, `lunula::photo::outline::training`), so that it sees the same in use.

pub mod digits;
pub mod nails;
