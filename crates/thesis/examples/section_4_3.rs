//! Figures 76 to 82 of the thesis: its simulations, and its experiments on eight generated people.
//!
//! `cargo run --release -p lunula-thesis --example section_4_3 -- OUT` prints the numbers of the book's
//! section-4-3.md as Markdown and draws the pictures into OUT; the same bytes each time.

use std::path::PathBuf;

use anyhow::Context;

fn main() -> anyhow::Result<()> {
    let out = PathBuf::from(std::env::args().nth(1).context("name a folder: section_4_3 OUT")?);
    print!("{}", lunula_thesis::section_4_3(&out)?);
    eprintln!("look at {}", out.join("fig-76-literal.png").display());
    Ok(())
}
