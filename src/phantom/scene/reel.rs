//! A video's frames: drawn side by side while those before them are encoded, and handed on in their order.

use rayon::prelude::*;

use super::place::Error;
use crate::job::Watch;
use crate::video::VideoError;

/// Draws so many frames and hands each on with its number; watched: the ticks count frames.
pub(in crate::phantom) fn draw_and_encode<T: Send>(
    frames: usize,
    draw: impl Fn(usize) -> T + Sync,
    mut encode: impl FnMut(usize, T) -> Result<(), VideoError> + Send,
    watch: &Watch<'_>,
) -> Result<(), Error> {
    let all: Vec<usize> = (0..frames).collect();
    let draw = |batch: &[usize]| -> Vec<T> { batch.par_iter().map(|&frame| draw(frame)).collect() };
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
    Ok(())
}
