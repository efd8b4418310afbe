//! What decoding costs: nanoseconds of a row, from the best of some runs.
//! `cargo run --release -p lunula-live --example speed`

use std::hint::black_box;
use std::time::Instant;

use lunula_live::time::{Link, Sequence};
use lunula_live::wire::{Frame, Frames, LineOptions, Lines, Meaning, Step, Use, crc16};

const ROWS: u32 = 100_000;

/// The first column is the time, and the second, where frames have it, the counter.
fn naming(counter: bool) -> impl Fn(&[String]) -> Result<Meaning, String> {
    move |names| {
        let first = if counter { 3 } else { 1 };
        let mut uses = vec![Use::Time { per_second: if counter { 1e6 } else { 1.0 } }];
        if counter {
            uses.extend([Use::Counter, Use::Led]);
        }
        uses.extend((first..names.len()).map(|at| Use::Value { at: at - first, scaled: false }));
        Ok(Meaning { uses, values: names.len() - first, texts: 0 })
    }
}

fn best_ns(mut run: impl FnMut()) -> f64 {
    let times = (0..20).map(|_| {
        let begun = Instant::now();
        run();
        begun.elapsed().as_secs_f64() * 1e9 / f64::from(ROWS)
    });
    times.fold(f64::INFINITY, f64::min)
}

fn main() {
    let body = |row: u32| {
        let volts: Vec<String> = (1..9).map(|k| format!("{:.6}", f64::from(row % 1000 * k) * 0.000_317)).collect();
        format!("{:.6},{}", f64::from(row) * 0.001, volts.join(","))
    };
    let plain: String = (0..ROWS).map(|row| body(row) + "\n").collect();
    let sealed: String = (0..ROWS).map(|row| format!("${}*{:04X}\n", body(row), crc16(body(row).as_bytes()))).collect();
    for (what, text) in [("nine numbers", &plain), ("nine numbers with a CRC", &sealed)] {
        let ns = best_ns(|| {
            let mut lines = Lines::new(Box::new(naming(false)), LineOptions::default());
            let mut sequence = None;
            let mut names = &b"time_s,P1,P2,P3,P4,P5,P6,P7,P8\n"[..];
            while let Ok(Some(_)) = lines.next(&mut names, 0) {
                sequence = Some(Sequence::new(&lines.decoded().meaning, Link::Recording, None));
            }
            for piece in text.as_bytes().chunks(4096) {
                let mut piece = piece;
                while let Ok(Some(step)) = lines.next(&mut piece, 0) {
                    if let (Step::Sample(sample), Some(sequence)) = (step, &mut sequence) {
                        black_box(sequence.take(&sample, 0));
                        black_box(&lines.decoded().values);
                    }
                }
            }
        });
        println!("a line of {what}: {ns:.0} ns");
    }
    let frame = |row: u32| Frame {
        photodiodes: std::array::from_fn(|k| (row as u16).wrapping_mul(k as u16)),
        time_us: row * 1000,
        counter: row as u16,
        lit: row.is_multiple_of(2),
    };
    let bytes: Vec<u8> = (0..ROWS).flat_map(|row| frame(row).encoded()).collect();
    let ns = best_ns(|| {
        let mut frames = Frames::new(Box::new(naming(true)), None);
        for piece in bytes.chunks(4096) {
            let mut piece = piece;
            while let Ok(Some(step)) = frames.next(&mut piece) {
                black_box(step);
                black_box(&frames.decoded().values);
            }
        }
    });
    println!("a frame: {ns:.0} ns");
}
