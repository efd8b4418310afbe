//! Listens to a source and says what comes: `cargo run --release -p lunula-live --example listen -- serial:auto`. What
//! is known of the stream follows on standard error. Columns named `time_us`, `time_ms`, `time_s`, `n` and `led` are
//! read as such, all others as numbers.

use std::error::Error;
use std::io::Write;
use std::ops::ControlFlow;

use lunula_live::source::{Address, Event, HostClock, Stream, StreamOptions, wait};
use lunula_live::wire::{Meaning, Use};

fn naming(names: &[String]) -> Result<Meaning, String> {
    let mut meaning = Meaning::default();
    for name in names {
        meaning.uses.push(match name.as_str() {
            "time_us" => Use::Time { per_second: 1e6 },
            "time_ms" => Use::Time { per_second: 1e3 },
            "time_s" => Use::Time { per_second: 1.0 },
            "n" => Use::Counter,
            "led" => Use::Led,
            _ => {
                meaning.values += 1;
                Use::Value { at: meaning.values - 1, scaled: true }
            }
        });
    }
    Ok(meaning)
}

fn main() -> Result<(), Box<dyn Error>> {
    let source = std::env::args().nth(1).unwrap_or("-".to_owned());
    let address: Address = source.parse()?;
    let clock = HostClock::start();
    let mut stream = Stream::open(&address, StreamOptions::default(), Box::new(naming), clock.now_ns())?;
    let mut out = std::io::BufWriter::new(std::io::stdout().lock());
    while !stream.ended() {
        wait(&[&stream], &[], None, &clock)?;
        let mut failed = Ok(());
        stream.poll(clock.now_ns(), &mut |event| {
            match event {
                Event::Row(row) => failed = writeln!(out, "{} {:?}", row.time_s, row.values),
                Event::Columns(names) => failed = writeln!(out, "{}", names.join(" ")),
                other => eprintln!("{other:?}"),
            }
            if failed.is_ok() { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        })?;
        failed?;
        out.flush()?;
    }
    eprintln!("{:#?}", stream.certificate());
    Ok(())
}
