//! How fast a force's noise changes it, by the rows at rest.
//!
//! In: a force and its contacts. Out: the root mean square of the rate that its noise at rest leaves behind the low
//! pass of the rate of presses, whatever the noise's spectrum. Noise only while a finger presses is not seen.

use super::contact::Contact;
use super::figures::{AROUND_S, even_rate};
use super::force::{Force, Row};
use super::smooth::low_passed;

/// Rests are looked at in pieces of at least and at most so long, seconds: five periods of 10 Hz, and ten seconds
/// (assumed).
const PIECE_S: [f64; 2] = [0.5, 10.0];
/// Less rest says nothing, seconds (assumed).
const LEAST_S: f64 = 1.0;

/// The rate of a force's noise at rest, newtons a second: the median over pieces, so that a light touch in one of them
/// does not count. None where the finger hardly ever rests for long.
#[must_use]
pub fn noise_of_rate(force: &Force, contacts: &[Contact]) -> Option<f64> {
    let pieces = pieces(force, contacts);
    let long_s: f64 = pieces.iter().map(|piece| piece.time_s[piece.time_s.len() - 1] - piece.time_s[0]).sum();
    if long_s < LEAST_S {
        return None;
    }
    let mut rates: Vec<f64> = pieces.iter().filter_map(of_piece).collect();
    let middle = rates.len() / 2;
    (!rates.is_empty()).then(|| *rates.select_nth_unstable_by(middle, f64::total_cmp).1)
}

fn of_piece(piece: &Force) -> Option<f64> {
    let (rate, period_s) = even_rate(piece)?;
    let rate = low_passed(&rate, 1.0 / period_s);
    Some((rate.iter().map(|rate| rate * rate).sum::<f64>() / rate.len() as f64).sqrt())
}

/// Rows of known force without a gap, away from contacts.
fn pieces(force: &Force, contacts: &[Contact]) -> Vec<Force> {
    let longest_s = force.longest_step_s();
    let mut contacts = contacts.iter().peekable();
    let (mut pieces, mut piece) = (Vec::new(), Vec::new());
    for (row, &time_s) in force.time_s.iter().enumerate() {
        while contacts.next_if(|contact| contact.to_s + AROUND_S < time_s).is_some() {}
        let is_near = contacts.peek().is_some_and(|contact| contact.from_s - AROUND_S <= time_s);
        let known = if let Row::Known(force_n) = force.row(row) { Some(force_n).filter(|_| !is_near) } else { None };
        let ends = piece.first().zip(piece.last()).is_some_and(|(first, last): (&[f64; 2], &[f64; 2])| {
            known.is_none() || time_s - last[0] > longest_s || time_s - first[0] > PIECE_S[1]
        });
        if ends {
            end(&mut piece, &mut pieces);
        }
        piece.extend(known.map(|force_n| [time_s, force_n]));
    }
    end(&mut piece, &mut pieces);
    pieces
}

fn end(piece: &mut Vec<[f64; 2]>, pieces: &mut Vec<Force>) {
    let piece = std::mem::take(piece);
    if piece.first().zip(piece.last()).is_some_and(|(first, last)| last[0] - first[0] >= PIECE_S[0]) {
        let [time_s, force_n] = [0, 1].map(|k| piece.iter().map(|row| row[k]).collect());
        pieces.push(Force { time_s, force_n, lifted: Vec::new() });
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{SQRT_2, TAU};

    use super::super::{Thresholds, contacts};
    use super::*;

    #[test]
    fn a_tremor_at_rest_changes_the_force_as_fast_as_it_is() {
        let thresholds = Thresholds { touch_n: 0.2, release_n: 0.1, hold_s: 0.05 };
        // Presses of a second every three seconds, and another touch that is too light.
        let press = |time_s: f64| {
            let light = if (10.0..12.0).contains(&time_s) { 0.15 } else { 0.0 };
            if time_s % 3.0 < 1.0 { 2.0 * (std::f64::consts::PI * (time_s % 3.0)).sin() } else { light }
        };
        for (hz, passed) in [(5.0, 1.0), (9.5, 0.975), (40.0, 4e-4)] {
            let time_s: Vec<f64> = (0..3000).map(|row| 0.01 * f64::from(row)).collect();
            let tremor = |time_s: f64| 0.03 * SQRT_2 * (TAU * hz * time_s).sin();
            let force_n = time_s.iter().map(|time_s| press(*time_s) + tremor(*time_s)).collect();
            let force = Force { time_s, force_n, lifted: Vec::new() };
            let found = contacts(&force, &thresholds);
            let rate = noise_of_rate(&force, &found).unwrap();
            let expected = 0.03 * TAU * hz * passed;
            println!("{hz} Hz: {rate:.3} of {expected:.3}");
            // Pieces are mirrored at their ends.
            assert!((rate - expected).abs() <= 0.025 * 0.03 * TAU * hz, "{hz}: {rate} of {expected}");
        }
        let still = Force { time_s: vec![0.0, 0.1, 0.2], force_n: vec![0.0; 3], lifted: Vec::new() };
        assert_eq!(noise_of_rate(&still, &[]), None);
    }
}
