//! Feeds one parser of lunula with inputs: `lunula-fuzz PARSER` is the program that `cargo afl fuzz` runs again and
//! again, with an input on standard input at a time; without a name it lists the parsers.

mod targets;

use std::process::ExitCode;

use targets::{Desk, TARGETS};

fn main() -> ExitCode {
    let name = std::env::args().nth(1).unwrap_or_default();
    let Some(target) = TARGETS.iter().find(|target| target.name == name) else {
        TARGETS.iter().for_each(|target| println!("{}", target.name));
        return ExitCode::from(if name.is_empty() { 0 } else { 2 });
    };
    let desk = std::panic::AssertUnwindSafe(Desk::new());
    afl::fuzz!(|bytes: &[u8]| (target.run)(&desk, bytes));
    ExitCode::SUCCESS
}
