//! A video's frames: drawn side by side while those before them are encoded, in their order.

use std::path::Path;
use std::time::Instant;

use rayon::prelude::*;

use super::place::Error;
use crate::job::Watch;
use crate::video::{Encoder, Encoding, Picture, VideoError};

/// Ticks a second of the frames' times.
pub(in crate::phantom) const TICKS_PER_S: i32 = 90_000;

/// Draws so many frames of a video and encodes each at its ticks; watched: the ticks of `watch` count frames. How long
/// drawing took, summed over the threads, and encoding beside it, seconds.
pub(in crate::phantom) fn film(
    path: &Path,
    (encoding, fps): (Encoding, f64),
    frames: usize,
    draw: impl Fn(usize) -> Picture + Sync,
    ticks: impl Fn(usize) -> i64 + Sync,
    watch: &Watch<'_>,
) -> Result<[f64; 2], Error> {
    let ticks_a_picture = (f64::from(TICKS_PER_S) / fps).round() as i64;
    let encoding = Encoding { ticks_per_s: TICKS_PER_S, ticks_a_picture, ..encoding };
    let mut encoder = Encoder::create(path, &encoding)?;
    let [mut draw_s, mut encode_s] = [0.0; 2];
    let one = |&frame: &usize| {
        let start = Instant::now();
        (draw(frame), start.elapsed().as_secs_f64())
    };
    let mut encode = |frame: usize, (picture, drawn_s): (Picture, f64)| -> Result<(), VideoError> {
        let start = Instant::now();
        encoder.push(&picture, ticks(frame))?;
        encode_s += start.elapsed().as_secs_f64();
        draw_s += drawn_s;
        Ok(())
    };
    let all: Vec<usize> = (0..frames).collect();
    let draw = |batch: &[usize]| -> Vec<(Picture, f64)> { batch.par_iter().map(one).collect() };
    let mut batches = all.chunks(rayon::current_num_threads());
    let mut drawn = batches.next().map(draw).unwrap_or_default();
    let mut done = 0;
    while !drawn.is_empty() {
        let next = batches.next();
        let mut numbered = (done..).zip(drawn);
        let (encoded, following) = rayon::join(
            || numbered.try_fold(0, |count, (frame, one)| encode(frame, one).map(|()| count + 1)),
            || next.map(draw).unwrap_or_default(),
        );
        done += encoded?;
        (watch.tick)(done as u64, Some(frames as u64));
        watch.go_on()?;
        drawn = following;
    }
    let start = Instant::now();
    encoder.finish()?;
    Ok([draw_s, encode_s + start.elapsed().as_secs_f64()])
}
