//! Frames decoded, cut anywhere, and damaged.

use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::*;
use crate::wire::testing::naming;

fn frame(n: u32) -> Frame {
    let mut mixed = n.wrapping_mul(2_654_435_761);
    let photodiodes = std::array::from_fn(|_| {
        mixed = mixed.rotate_left(7).wrapping_mul(0x9e37_79b9);
        // Many zeros, as COBS has to hide.
        if mixed.is_multiple_of(5) { 0 } else { (mixed >> 16) as u16 }
    });
    Frame { photodiodes, time_us: n.wrapping_mul(1000), counter: n as u16, lit: n.is_multiple_of(2) }
}

/// The numbers of the frames in a stream whose pieces end at `cuts`, each checked against the frame it was.
fn numbers(stream: &[u8], cuts: &[usize]) -> (Vec<u32>, Frames) {
    let mut frames = Frames::new(Box::new(naming), None);
    let mut found = Vec::new();
    let mut begin = 0;
    for end in cuts.iter().copied().chain([stream.len()]) {
        let mut piece = &stream[begin..end];
        begin = end;
        while let Some(step) = frames.next(&mut piece).unwrap() {
            let Step::Sample(sample) = step else { continue };
            let n = sample.counter.unwrap() as u32;
            let truth = frame(n);
            assert_eq!(frames.decoded().values, truth.photodiodes.map(f64::from));
            assert_eq!((sample.time, sample.lit), (f64::from(truth.time_us), Some(truth.lit)));
            found.push(n);
        }
    }
    (found, frames)
}

#[test]
fn a_frame_has_27_bytes_of_which_only_the_last_is_zero() {
    for n in 0..10_000 {
        let wire = frame(n).encoded();
        assert_eq!(wire.iter().position(|&byte| byte == 0), Some(WIRE_BYTES - 1));
        assert_eq!(Frame::decoded(&wire[..WIRE_BYTES - 1]), Ok(frame(n)));
    }
}

#[test]
fn a_frame_allocates_nothing() {
    let stream: Vec<u8> = (0..1000).flat_map(|n| frame(n).encoded()).collect();
    let mut frames = Frames::new(Box::new(naming), Some(1e-3));
    frames.next(&mut &[][..]).unwrap();
    let mut count = 0;
    let counted = allocation_counter::measure(|| {
        for piece in stream.chunks(100) {
            let mut piece = piece;
            while frames.next(&mut piece).unwrap().is_some() {
                count += 1;
            }
        }
    });
    assert_eq!((count, counted.count_total), (1000, 0));
}

proptest! {
    #[test]
    fn however_frames_are_cut_they_are_the_same(mut cuts in prop::collection::vec(0_usize..270, 0..40)) {
        let stream: Vec<u8> = (0..10).flat_map(|n| frame(n).encoded()).collect();
        cuts.sort_unstable();
        prop_assert_eq!(numbers(&stream, &cuts).0, (0..10).collect::<Vec<u32>>());
    }
}

/// Damaged streams: flipped bits, lost bytes, messages of a boot between frames.
#[test]
fn no_damaged_frame_is_taken_for_another() {
    let mut random = ChaCha8Rng::seed_from_u64(19);
    let (mut taken, mut spoilt) = (0, 0);
    for _ in 0..20_000 {
        let mut stream: Vec<u8> = Vec::new();
        for n in 0..20 {
            let mut wire = frame(n).encoded().to_vec();
            match random.random_range(0..10) {
                0 => (0..random.random_range(1..4)).for_each(|_| {
                    let at = random.random_range(0..wire.len());
                    wire[at] ^= 1 << random.random_range(0..8);
                }),
                1 => drop(wire.drain(random.random_range(0..wire.len())..)),
                2 => drop(wire.drain(..random.random_range(0..wire.len()))),
                3 => wire.splice(0..0, b"rst:0x1 (POWERON),boot:0x13\r\n".iter().copied()).for_each(drop),
                _ => {}
            }
            stream.extend(wire);
        }
        let (found, frames) = numbers(&stream, &[]);
        assert!(found.windows(2).all(|pair| pair[0] < pair[1]));
        taken += found.len();
        spoilt += frames.decoded().tally.spoilt();
    }
    println!("{taken} frames taken, {spoilt} spoilt");
    assert!(taken > 200_000 && spoilt > 100_000, "{taken} {spoilt}");
}
