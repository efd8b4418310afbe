//! Whole processes timed in turn, and compared as ratios.

#![allow(unreachable_pub, reason = "shared by the benches")]

use std::process::{Command, Stdio};
use std::time::Instant;

use lunula::video::Video;

/// A command with its name in the table.
pub type Run<'a> = (&'a str, Vec<&'a str>);

/// Times every command `rounds` times, in turn, after a round that warms the disk's cache; `before` is called before
/// each. Prints the medians and the ratio of each to the first. Returns the ratio of the first to each.
pub fn compare(runs: &[Run<'_>], rounds: usize, before: impl Fn()) -> Vec<f64> {
    let mut times = vec![Vec::new(); runs.len()];
    for round in 0..=rounds {
        for ((name, command), times) in runs.iter().zip(&mut times) {
            before();
            let taken = seconds(command).unwrap_or_else(|| panic!("{name} failed: {command:?}"));
            if round > 0 {
                times.push(taken);
            }
        }
    }
    let ours = times[0].clone();
    let mut ratios = Vec::new();
    for ((name, _), times) in runs.iter().zip(times) {
        let theirs = median(ours.iter().zip(&times).map(|(ours, theirs)| theirs / ours).collect());
        ratios.push(median(ours.iter().zip(&times).map(|(ours, theirs)| ours / theirs).collect()));
        println!("{name:<44} {:>7.3} s   {theirs:>6.2} times lunula's", median(times));
    }
    ratios
}

/// How long a command takes; `None` where it fails.
pub fn seconds(command: &[&str]) -> Option<f64> {
    let start = Instant::now();
    let status =
        Command::new(command[0]).args(&command[1..]).stdout(Stdio::null()).stderr(Stdio::null()).status().ok()?;
    status.success().then(|| start.elapsed().as_secs_f64())
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// A bench's own word for "only decode this file with so many threads".
pub const DECODE: &str = "--decode-only";

/// Whether this program was started to only decode a file, which is done then.
#[allow(dead_code, reason = "of benches on videos")]
pub fn decodes_only() -> bool {
    let arguments: Vec<String> = std::env::args().collect();
    let Some(at) = arguments.iter().position(|argument| argument == DECODE) else { return false };
    let threads = arguments[at + 2].parse().expect("a number of threads");
    let mut video = Video::open(arguments[at + 1].as_ref(), threads).expect("a video");
    std::hint::black_box(video.count_rest().expect("frames"));
    true
}
