//! The command line of lunula: parse, run, exit status. What needs video is done by `lunula-video` beside it.

mod cli;

use std::process::ExitCode;

fn main() -> ExitCode {
    cli::run::<false>()
}

/// Photographs come and go by the megabyte: this allocator keeps their pages, the system's returns them each time.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;
