//! lunula's command line with FFmpeg's libraries: `lunula` hands over to it what needs video.

#[path = "../cli/mod.rs"]
mod cli;

use std::process::ExitCode;

fn main() -> ExitCode {
    cli::run::<true>()
}

/// Frames come and go by the megabyte: this allocator keeps their pages, the system's returns them each time.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;
