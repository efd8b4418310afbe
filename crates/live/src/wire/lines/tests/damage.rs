//! Lines cut anywhere, and damaged.

use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::*;
use crate::time::testing::Taker;
use crate::time::{Link, Sequence, Verdict};

const STREAM: &str = "\u{feff}# made by hand\r\ntime_us,n,led,P1,P2\r\n0,1,1,0.5,\"7\"\r\n\n1000,2,0,,1e3\n2000,3\n\
                      1500,7,0,1,2\r3000,4,1,x,1\nboot: 7\ntime_us,n,led,P1,P2\n10,0,0,-3,2*5\n20,1,1,3,4,\n30,2,1,5,6";

#[test]
fn every_cut_gives_the_same_rows() {
    let text = STREAM.as_bytes();
    let whole = steps(&mut lines(LineOptions::default()), text, &[]).unwrap();
    assert_eq!(whole.iter().filter(|step| step.contains("Some")).count(), 5, "{whole:#?}");
    for first in 0..text.len() {
        for second in first..text.len() {
            let found = steps(&mut lines(LineOptions::default()), text, &[first, second]).unwrap();
            assert_eq!(found, whole, "{first} {second}");
        }
    }
}

proptest! {
    #[test]
    fn however_bytes_are_cut_the_rows_are_the_same(
        cells in prop::collection::vec("[0-9a-z.,;\"#* \t\r\n-]{0,12}", 0..30),
        mut cuts in prop::collection::vec(0_usize..400, 0..20),
    ) {
        let text = format!("time_s,P1\n0,1\n{}", cells.join("\n"));
        cuts.iter_mut().for_each(|cut| *cut = (*cut).min(text.len()));
        cuts.sort_unstable();
        let whole = steps(&mut lines(LineOptions::default()), text.as_bytes(), &[]).unwrap();
        let found = steps(&mut lines(LineOptions::default()), text.as_bytes(), &cuts).unwrap();
        prop_assert_eq!(found, whole);
    }

    #[test]
    fn no_bytes_make_it_panic(bytes in prop::collection::vec(any::<u8>(), 0..2000), is_file: bool, named: bool) {
        let columns = named.then(|| vec!["time_s".to_owned(), "P1".to_owned()]);
        let options = LineOptions { columns, is_file, volts_per_count: None };
        // Whether there are names in it does not matter.
        let _ = steps(&mut lines(options), &bytes, &[]);
    }
}

/// The row of a number.
fn row(n: u64) -> String {
    let mut mixed = n.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let mut text = format!("{},{n},{}", n * 1000, n % 2);
    for _ in 0..2 {
        mixed = mixed.rotate_left(17).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        text.push_str(&format!(",{}", mixed >> 48));
    }
    text
}

const NAMES: &str = "time_us,n,led,P1,P2";

/// How lines are damaged.
#[derive(Clone, Copy)]
struct Damage {
    /// Bits flipped in a line, at most.
    flips: u32,
    /// Whether pieces of lines are lost, with their ends.
    halves: bool,
}

/// What became of damaged streams.
#[derive(Debug, Default)]
struct Outcome {
    /// Rows up to the last that was taken.
    sent: u64,
    rows: u64,
    lost: u64,
    /// Rows that were taken and had not been sent.
    wrong: u64,
}

fn outcome(streams: u32, seal: impl Fn(&str) -> String, damage: Damage) -> Outcome {
    let mut random = ChaCha8Rng::seed_from_u64(19);
    let mut all = Outcome::default();
    for _ in 0..streams {
        let mut stream = seal(NAMES).into_bytes();
        let begin = random.random_range(0..1_000_000_u64);
        for n in begin..begin + 20 {
            let mut line = seal(&row(n)).into_bytes();
            match random.random_range(0..8) {
                // The first row says that there are checksums, and the last how many were lost.
                _ if n == begin || n == begin + 19 => {}
                0 => (0..random.random_range(1..=damage.flips)).for_each(|_| {
                    let at = random.random_range(0..line.len());
                    line[at] ^= 1 << random.random_range(0..8);
                }),
                1 if damage.halves => drop(line.drain(random.random_range(0..line.len())..)),
                2 if damage.halves => {
                    let at = random.random_range(0..line.len());
                    line.drain(at..random.random_range(at..line.len()));
                }
                3 => {
                    line.splice(0..0, format!("ets Jul 29\nrst:0x1\n{}", seal(NAMES)).into_bytes());
                }
                _ => {}
            }
            stream.extend(line);
        }
        let mut decoder = lines(LineOptions::default());
        let (mut sequence, mut taker, mut last) = (None, Taker::default(), begin);
        let mut rest = &stream[..];
        while let Some(step) = decoder.next(&mut rest, 0).unwrap() {
            match step {
                Step::Columns { again: false } => {
                    sequence = Some(Sequence::new(&decoder.decoded().meaning, Link::Recording, None))
                }
                Step::Columns { again: true } => sequence.as_mut().unwrap().begin(),
                Step::Sample(sample) => {
                    let n = sample.counter.unwrap_or(u64::MAX);
                    let lit = sample.lit.map_or(9, u8::from);
                    let values = &decoder.decoded().values;
                    let is = format!("{},{n},{lit},{},{}", sample.time, values[0], values[1]);
                    if n == u64::MAX || is != row(n) || !(begin..begin + 20).contains(&n) {
                        all.wrong += 1;
                        continue;
                    }
                    for (sample, verdict) in taker.take(sequence.as_mut().unwrap(), sample, 0) {
                        let Verdict::Row { lost, .. } = verdict else { panic!("row {n} is late") };
                        all.rows += 1;
                        all.lost += lost;
                        last = sample.counter.unwrap_or(last);
                    }
                }
                Step::Spoilt(_) => {}
            }
        }
        // What was lost behind the last row nobody knows.
        all.sent += last + 1 - begin;
    }
    all
}

fn xor(line: &str) -> String {
    format!("${line}*{:02X}\r\n", xor8(line.as_bytes()))
}

fn crc(line: &str) -> String {
    format!("${line}*{:04X}\r\n", crc16(line.as_bytes()))
}

#[test]
fn no_damaged_row_is_taken_and_every_loss_is_counted() {
    // An XOR sees one flipped bit, and a CRC three and lost pieces.
    for (name, all) in [
        ("xor", outcome(100_000, xor, Damage { flips: 1, halves: false })),
        ("crc", outcome(100_000, crc, Damage { flips: 3, halves: true })),
    ] {
        println!("{name}: {all:?}");
        assert_eq!((all.wrong, all.rows + all.lost), (0, all.sent), "{name}: {all:?}");
        assert!(all.lost > all.sent / 12, "{name}: {all:?}");
    }
}

/// `cargo test --release -p lunula-live -- --ignored --nocapture a_million`
#[test]
#[ignore = "half a minute"]
fn a_million_damaged_streams() {
    for (name, all) in [
        ("xor", outcome(1_000_000, xor, Damage { flips: 1, halves: false })),
        ("crc", outcome(1_000_000, crc, Damage { flips: 3, halves: true })),
    ] {
        println!("{name}: {all:?}");
        // Of 7.3 million rows that were damaged at random, a CRC of 16 bits misses few.
        assert!(all.wrong <= 10 && all.rows + all.lost + all.wrong >= all.sent, "{name}: {all:?}");
    }
}

#[test]
fn an_xor_misses_one_in_hundreds_of_rows_that_lost_a_piece() {
    let all = outcome(20_000, xor, Damage { flips: 1, halves: true });
    println!("{all:?}");
    // Measured: 257 of 146 000 that were damaged. What two equal digits were lost of has the same XOR.
    assert!(all.wrong * 256 <= all.lost, "{all:?}");
}
