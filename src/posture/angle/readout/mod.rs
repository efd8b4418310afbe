//! A rolling shutter: from where each marker was when its row was taken to where it was at the frame's own moment.
//!
//! In: the sights of frame after frame and the frames' times; out: the same sights, each centre moved to where the
//! marker was when the frame's first row was taken, with the covariance of its error. A camera takes the rows of a
//! stored picture from above to below, evenly; row `y` of `h` is taken the share `y / (h - 1)` of the read-out time
//! after the first. The frame's time is taken to be that of its first row, so that each marker's place then lies
//! between its last two sights, and needs none of a later frame.
//!
//! The place is that of the parabola through the last three sights at their own moments. A marker that isn't seen in
//! each of the last three frames has none: how fast it moves isn't known. Turning by 30 degrees and back once a second
//! at 30 frames a second, the parabola is 0.02 degrees off (the third derivative times 0.064 of an interval's cube), a
//! line through the last two 0.16.
//!
//! What is not determined: the read-out time, which no file says ([`Rolling`] doubts it); and motion within the disc of
//! a mark, whose rows are some hundredths of the picture.

mod estimate;

use std::collections::VecDeque;

pub(in crate::posture) use estimate::Rolling;

use crate::posture::marker::sight::Loss;
use crate::posture::{Centre, Sight};

/// Frames that a place is taken from.
const FRAMES: usize = 3;

/// When the rows of a picture are taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::posture) struct Rows {
    readout_s: f64,
    height: usize,
}

impl Rows {
    /// Of stored pictures of `height` rows; none for a shutter that takes them all at once.
    pub(in crate::posture) fn new(readout_s: f64, height: usize) -> Option<Self> {
        (readout_s > 0.0).then_some(Self { readout_s, height })
    }

    /// How long after the frame's first row one is taken, seconds.
    pub(in crate::posture) fn late_s(&self, row: f64) -> f64 {
        self.readout_s * row / (self.height - 1).max(1) as f64
    }
}

/// Follows the markers of one video.
pub(in crate::posture) struct Readout {
    rows: Rows,
    /// The last frames' sights, each centre with its moment, oldest first.
    last: VecDeque<Vec<Option<(f64, Centre)>>>,
}

impl Readout {
    pub(in crate::posture) fn new(rows: Rows) -> Self {
        Self { rows, last: VecDeque::new() }
    }

    /// The sights of the next frame as they were at `time_s`, when its first row was taken.
    pub(in crate::posture) fn step(&mut self, time_s: f64, sights: &[Sight]) -> Vec<Sight> {
        let taken = |sight: &Sight| match sight {
            Sight::Seen(centre) => Some((time_s + self.rows.late_s(centre.at_px[1]), *centre)),
            Sight::Lost(_) => None,
        };
        self.last.push_back(sights.iter().map(taken).collect());
        if self.last.len() > FRAMES {
            self.last.pop_front();
        }
        let at = |marker: usize, sight: &Sight| match sight {
            Sight::Seen(_) => self.place(marker, time_s).map_or(Sight::Lost(Loss::NotFound), Sight::Seen),
            lost @ Sight::Lost(_) => *lost,
        };
        sights.iter().enumerate().map(|(marker, sight)| at(marker, sight)).collect()
    }

    /// Where a marker was at `time_s`, by Lagrange's weights of its last sights.
    fn place(&self, marker: usize, time_s: f64) -> Option<Centre> {
        let seen: Vec<(f64, Centre)> = self.last.iter().map(|sights| sights[marker]).collect::<Option<_>>()?;
        let is_ordered = seen.windows(2).all(|two| two[0].0 < two[1].0);
        let (_, centre) = *seen.last().filter(|_| seen.len() == FRAMES && is_ordered)?;
        let mut moved = Centre { at_px: [0.0; 2], covariance_px2: centre.lasting_px2, ..centre };
        for (k, (taken_s, one)) in seen.iter().enumerate() {
            let others = seen.iter().enumerate().filter(|&(other, _)| other != k);
            let weight: f64 = others.map(|(_, (other_s, _))| (time_s - other_s) / (taken_s - other_s)).product();
            (0..2).for_each(|axis| moved.at_px[axis] += weight * one.at_px[axis]);
            for (sum, (all, lasting)) in
                moved.covariance_px2.iter_mut().zip(one.covariance_px2.iter().zip(one.lasting_px2))
            {
                *sum += weight * weight * (all - lasting);
            }
        }
        Some(moved)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(at_px: [f64; 2]) -> Sight {
        Sight::Seen(Centre { at_px, covariance_px2: [0.02, 0.0, 0.02], lasting_px2: [0.01, 0.0, 0.01], radius_px: 9.0 })
    }

    fn readout() -> Readout {
        Readout::new(Rows::new(0.020, 481).unwrap())
    }

    /// A marker that falls evenly faster from row 100, as it is seen by a shutter that takes 20 ms.
    fn falling(time_s: f64) -> (f64, f64) {
        let row = |t_s: f64| 100.0 + 150.0 * t_s + 200.0 * t_s * t_s;
        let taken_s = (0..60).fold(time_s, |taken_s, _| time_s + 0.020 * row(taken_s) / 480.0);
        (row(time_s), row(taken_s))
    }

    #[test]
    fn a_marker_is_where_it_was_when_the_first_row_was_taken() {
        let mut readout = readout();
        let mut gaps = Vec::new();
        for frame in 0..20 {
            let time_s = f64::from(frame) / 30.0;
            let (then, shown) = falling(time_s);
            match readout.step(time_s, &[seen([5.0, shown])])[0] {
                Sight::Seen(centre) => gaps.push([(centre.at_px[1] - then).abs(), (shown - then).abs()]),
                Sight::Lost(_) => assert!(frame < 2),
            }
        }
        assert_eq!(gaps.len(), 18);
        let worst = |which: usize| gaps.iter().map(|gap| gap[which]).fold(0.0, f64::max);
        assert!(worst(0) <= 1e-9 && worst(1) > 4.0, "{gaps:?}");
    }

    #[test]
    fn errors_are_those_of_the_parabola_and_lasting_ones_remain() {
        let mut readout = readout();
        // In the middle of the picture, 10 ms late of 20 between frames: weights of -1/8, 3/4, 3/8.
        let sights = (0..3).map(|frame| readout.step(0.020 * f64::from(frame), &[seen([5.0, 240.0])])[0]);
        let Some(Sight::Seen(centre)) = sights.last() else { panic!("it is seen in three frames") };
        let share = (1.0 + 36.0 + 9.0) / 64.0;
        assert!((centre.covariance_px2[0] - 0.01 * (1.0 + share)).abs() <= 1e-12, "{centre:?}");
        assert!((centre.at_px[1] - 240.0).abs() <= 1e-9 && centre.lasting_px2 == [0.01, 0.0, 0.01], "{centre:?}");
    }

    #[test]
    fn without_three_sights_in_a_row_there_is_none() {
        let mut readout = readout();
        let lost = Sight::Lost(Loss::Hidden);
        let place = seen([5.0, 240.0]);
        let sights = [place, place, place, lost, place, place, place];
        let seen: Vec<bool> = (0..)
            .zip(sights)
            .map(|(frame, sight)| matches!(readout.step(f64::from(frame) / 30.0, &[sight])[0], Sight::Seen(_)))
            .collect();
        assert_eq!(seen, [false, false, true, false, false, false, true]);
        // Times that stand still order nothing.
        let still: Vec<Sight> = (0..4).map(|_| readout.step(9.0, &[place])[0]).collect();
        assert!(matches!(still[3], Sight::Lost(_)), "{still:?}");
    }

    #[test]
    fn a_shutter_that_takes_all_rows_at_once_needs_none_of_it() {
        assert_eq!(Rows::new(0.0, 480), None);
    }
}
