//! The command line of lunula.

fn main() {}
