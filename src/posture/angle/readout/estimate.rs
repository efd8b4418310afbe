//! How long a rolling shutter takes, from how segments seem to change their lengths while they move.
//!
//! In: the sights of frame after frame and the frames' times; out: the read-out time that they show, with its standard
//! error. Of a segment whose markers are the share `d` of the picture's rows apart, the lower one is seen `readout d`
//! later; where the segment moves along itself at `v`, it seems longer by `readout d v`. Lengths that depend on the
//! direction (skin that slides, a camera that looks obliquely, a wrong lens) are fitted beside it, by the sine and
//! cosine of the direction and of its double; what goes there and back meets each direction at both speeds. The
//! standard error is the jackknife's over stretches of the video, and what the markers' lasting errors make of it,
//! which light and shade take along as the finger moves.
//!
//! What is not determined: anything where no segment moves along itself, or the finger lies along the rows.

use nalgebra::{SMatrix, SVector};

use crate::posture::angle::view::View;
use crate::posture::{Layout, Sight};
use crate::video::Info;

/// Constant, cosine and sine of the direction and of its double; then what a second of read-out time changes; then the
/// length.
const BESIDE: usize = 5;
const PARTS: usize = BESIDE + 2;
/// Sums of products of these.
type Sums = SMatrix<f64, PARTS, PARTS>;

/// Stretches of the video: no more than these, and as many frames in the first.
const MOST_STRETCHES: usize = 32;
const STRETCH_FRAMES: u64 = 16;
/// Fewer give no standard error.
const FEWEST_STRETCHES: usize = 6;
/// Directions that a segment hardly takes are no reason for its length.
const NEGLIGIBLE: f64 = 1e-9;
/// The share of the markers' lasting errors that may go with the speed (assumed; paint with a shaded side on
/// photographs of real hands made 27 ms, of standard error 5 without this, of lengths that change by 0.06 px).
const WITH_SPEED: f64 = 0.3;
/// A read-out time is believed beyond so many standard errors and so many milliseconds. Measured on eleven kinds of
/// phantoms without a rolling shutter: at most 1.8 standard errors; where these are below 3 ms, at most 2.3 ms.
const SURE_SDS: f64 = 4.0;
const SURE_MS: f64 = 4.0;

/// What a video shows of its read-out time.
pub(in crate::posture) struct Rolling {
    view: View,
    height: usize,
    given_s: f64,
    segments: Vec<Segment>,
    frame: u64,
    stretch_frames: u64,
}

struct Segment {
    markers: [usize; 2],
    /// The last two frames' times and places, later first; none where one of its markers is not seen.
    last: [Option<Seen>; 2],
    /// Its first length, from which lengths count.
    first_px: Option<f64>,
    stretches: Vec<Sums>,
    /// Variances of its markers' lasting errors along it, added up over `stretches`' frames.
    lasting_px2: f64,
}

/// A segment in a frame.
#[derive(Clone, Copy)]
struct Seen {
    time_s: f64,
    middle_px: [f64; 2],
    along_px: [f64; 2],
    /// How much later than the proximal marker the distal one is taken, as a share of the read-out time.
    later: f64,
    /// The variance of both markers' lasting errors along it.
    lasting_px2: f64,
}

impl Rolling {
    pub(in crate::posture) fn new(layout: &Layout, info: &Info) -> Self {
        let wanted = |segment: &usize| layout.joints.iter().any(|joint| joint.segments.contains(segment));
        let markers = (0..layout.segments.len()).filter(wanted).map(|segment| layout.segments[segment].markers);
        Self {
            view: View::new(layout, info),
            height: info.format.height,
            given_s: layout.readout_s,
            segments: markers
                .map(|markers| Segment {
                    markers,
                    last: [None; 2],
                    first_px: None,
                    stretches: Vec::new(),
                    lasting_px2: 0.0,
                })
                .collect(),
            frame: 0,
            stretch_frames: STRETCH_FRAMES,
        }
    }

    /// Takes the next frame's sights: as seen, or as moved to one moment by the read-out time that was given.
    pub(in crate::posture) fn add(&mut self, time_s: f64, sights: &[Sight]) {
        let mut stretch = (self.frame / self.stretch_frames) as usize;
        if stretch == MOST_STRETCHES {
            for segment in &mut self.segments {
                segment.stretches = segment.stretches.chunks(2).map(|two| two.iter().sum()).collect();
            }
            self.stretch_frames *= 2;
            stretch = (self.frame / self.stretch_frames) as usize;
        }
        self.frame += 1;
        let rows = (self.height - 1).max(1) as f64;
        for segment in &mut self.segments {
            let ends = segment.markers.map(|marker| match &sights[marker] {
                Sight::Seen(centre) => {
                    Some((self.view.flat(centre)?.at_px, centre.at_px[1] / rows, centre.lasting_px2))
                }
                Sight::Lost(_) => None,
            });
            let seen = match ends {
                [Some((a, above, a_px2)), Some((b, below, b_px2))] => {
                    let along_px = [0, 1].map(|axis| b[axis] - a[axis]);
                    let [xx, xy, yy] = [0, 1, 2].map(|part| a_px2[part] + b_px2[part]);
                    let [x, y] = along_px.map(|part| part / along_px[0].hypot(along_px[1]));
                    Some(Seen {
                        time_s,
                        middle_px: [0, 1].map(|axis| 0.5 * (a[axis] + b[axis])),
                        along_px,
                        later: below - above,
                        lasting_px2: x * x * xx + 2.0 * x * y * xy + y * y * yy,
                    })
                }
                _ => None,
            };
            if let (Some(before), Some(this), Some(after)) = (segment.last[1], segment.last[0], &seen) {
                segment.stretches.resize(stretch + 1, Sums::zeros());
                segment.stretches[stretch] += this.sums(&before, after, &mut segment.first_px);
                segment.lasting_px2 += this.lasting_px2;
            }
            segment.last = [seen, segment.last[0]];
        }
    }

    /// The read-out time beside the one that is given and its standard error, seconds.
    fn estimate_s(&self) -> Option<[f64; 2]> {
        let stretches = self.segments.iter().map(|segment| segment.stretches.len()).max()?;
        // The segments weigh by how well each keeps its length.
        let weights: Vec<f64> =
            self.segments.iter().map(|segment| 1.0 / segment.left_px2().max(f64::MIN_POSITIVE)).collect();
        let pooled = |without: Option<usize>| {
            let [mut both, mut own] = [0.0; 2];
            for (segment, weight) in self.segments.iter().zip(&weights) {
                let [[squares, product], _] = segment.rest(without);
                both += weight * product;
                own += weight * squares;
            }
            Some(both / own).filter(|seconds| seconds.is_finite())
        };
        let estimate_s = pooled(None)?;
        let left_out_s: Vec<f64> = (0..stretches).map(|stretch| pooled(Some(stretch))).collect::<Option<_>>()?;
        let count = left_out_s.len() as f64;
        let mean_s = left_out_s.iter().sum::<f64>() / count;
        let squares: f64 = left_out_s.iter().map(|one_s| (one_s - mean_s).powi(2)).sum();
        let [mut own, mut lasting] = [0.0; 2];
        for (segment, weight) in self.segments.iter().zip(&weights) {
            let [[squares, _], _] = segment.rest(None);
            own += weight * squares;
            // What an error that goes with the speed adds to the product.
            lasting += weight * weight * squares * segment.lasting_px2.max(0.0);
        }
        let lasting_s2 = WITH_SPEED * WITH_SPEED * lasting / (own * own);
        let sd_s = (squares * (count - 1.0) / count + lasting_s2).sqrt();
        (stretches >= FEWEST_STRETCHES && sd_s.is_finite()).then_some([estimate_s, sd_s])
    }

    /// How long the rows take in all, and its standard error, milliseconds.
    pub(in crate::posture) fn readout_ms(&self) -> Option<[f64; 2]> {
        self.estimate_s().map(|[more_s, sd_s]| [1e3 * (self.given_s + more_s), 1e3 * sd_s])
    }

    /// What to say of it once all frames are through.
    pub(in crate::posture) fn doubt(&self) -> Option<String> {
        let ([all_ms, sd_ms], given_ms) = (self.readout_ms()?, 1e3 * self.given_s);
        let ms = all_ms - given_ms;
        (ms.abs() > SURE_MS.max(SURE_SDS * sd_ms)).then(|| match self.given_s {
            0.0 if ms > 0.0 => format!(
                "segments change their lengths with their speed as under a rolling shutter whose last row is taken \
                 about {ms:.0} ms after the first (standard error {sd_ms:.1}): angles of moving joints are off by \
                 what they turn by meanwhile; write readout_ms = {ms:.0}, or what the camera was measured to take, \
                 into the marker file"
            ),
            0.0 => format!(
                "segments change their lengths with their speed as under a rolling shutter that takes the rows from \
                 below to above, in about {:.0} ms (standard error {sd_ms:.1}), which readout_ms can't undo: is the \
                 video upside down?",
                -ms
            ),
            _ => format!(
                "readout_ms = {given_ms} of the marker file does not fit: segments change their lengths with their \
                 speed as if it were about {:.0} (standard error {sd_ms:.1})",
                all_ms
            ),
        })
    }
}

impl Seen {
    /// What this frame, between two others, adds to the sums.
    fn sums(&self, before: &Self, after: &Self, first_px: &mut Option<f64>) -> Sums {
        let [x, y] = self.along_px;
        let length_px = x.hypot(y);
        let over_s = after.time_s - before.time_s;
        let speed = |axis: usize| (after.middle_px[axis] - before.middle_px[axis]) / over_s;
        let longer = self.later * (speed(0) * x + speed(1) * y) / length_px;
        let (sin, cos) = y.atan2(x).sin_cos();
        let from_px = *first_px.get_or_insert(length_px);
        let row = SVector::from([1.0, cos, sin, cos * cos - sin * sin, 2.0 * sin * cos, longer, length_px - from_px]);
        if row.iter().all(|part| part.is_finite()) { row * row.transpose() } else { Sums::zeros() }
    }
}

impl Segment {
    /// The variance of the length that neither explains, pixels squared.
    fn left_px2(&self) -> f64 {
        let [[own, both], [_, length]] = self.rest(None);
        let count: f64 = self.stretches.iter().map(|sums| sums[(0, 0)]).sum();
        (length - if own > 0.0 { both * both / own } else { 0.0 }) / count
    }

    /// Products of what a second of read-out time changes and of the length, less what directions explain; without one
    /// of the stretches.
    fn rest(&self, without: Option<usize>) -> [[f64; 2]; 2] {
        let kept = self.stretches.iter().enumerate().filter(|(stretch, _)| Some(*stretch) != without);
        let sums: Sums = kept.map(|(_, sums)| sums).sum();
        let beside = sums.fixed_view::<BESIDE, BESIDE>(0, 0).into_owned();
        let across = sums.fixed_view::<BESIDE, 2>(0, BESIDE).into_owned();
        let Ok(inverse) = beside.pseudo_inverse(NEGLIGIBLE * beside.trace().max(1.0)) else { return [[0.0; 2]; 2] };
        let rest = sums.fixed_view::<2, 2>(BESIDE, BESIDE) - across.transpose() * inverse * across;
        [[rest[(0, 0)], rest[(0, 1)]], [rest[(1, 0)], rest[(1, 1)]]]
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::posture::Centre;
    use crate::video::Format;

    const FILE: &str = "[markers]\na = '#1e6fd9'\nb = '#1e6fd9'\nc = '#e91e63'\nd = '#e91e63'\n[segments]\np = ['a', \
                        'b']\n q = ['c', 'd']\n[joints]\nJ1 = ['p', 'q']\n";

    /// Ten seconds of two segments that swing and sway, their lengths longer by `stretch` of themselves as they turn
    /// down, filmed by a shutter that takes `readout_s`; the marker file begins with `given`.
    fn filmed(readout_s: f64, stretch: f64, given: &str) -> Rolling {
        let layout = Layout::parse(&format!("{given}\n{FILE}"), Path::new("m.toml")).expect("a sound marker file");
        let format = Format { width: 640, height: 360, subsampling: None, depth: 8 };
        let mut rolling = Rolling::new(&layout, &Info::plain(format));
        let mut random = ChaCha8Rng::seed_from_u64(7);
        for frame in 0..300 {
            let time_s = f64::from(frame) / 30.0;
            let places = |t_s: f64| {
                let turn = [0.6 + 0.4 * (3.1 * t_s).sin(), 0.9 + 0.5 * (2.3 * t_s + 1.0).sin()];
                let along =
                    turn.map(|rad: f64| [0, 1].map(|axis| [rad.cos(), rad.sin()][axis] * (1.0 + stretch * rad.sin())));
                let base = [200.0 + 30.0 * (1.3 * t_s).sin(), 60.0 + 25.0 * (1.9 * t_s).sin()];
                let on = |from: [f64; 2], along: [f64; 2], px: f64| [from[0] + px * along[0], from[1] + px * along[1]];
                let [b, c] = [90.0, 110.0].map(|px| on(base, along[0], px));
                [base, b, c, on(c, along[1], 80.0)]
            };
            let sights: Vec<Sight> = (0..4)
                .map(|marker| {
                    let taken_s = (0..20).fold(time_s, |t_s, _| time_s + readout_s * places(t_s)[marker][1] / 359.0);
                    let at_px = places(taken_s)[marker].map(|at| at + random.random_range(-0.1..0.1));
                    let none = [0.0; 3];
                    Sight::Seen(Centre { at_px, covariance_px2: none, lasting_px2: none, radius_px: 6.0 })
                })
                .collect();
            rolling.add(time_s, &sights);
        }
        rolling
    }

    #[test]
    fn a_rolling_shutter_is_seen_whatever_the_skin_does() {
        for (readout_s, stretch) in [(0.016, 0.0), (0.016, 0.1), (0.025, 0.0)] {
            let rolling = filmed(readout_s, stretch, "");
            let [estimate_s, sd_s] = rolling.estimate_s().expect("segments that move along themselves");
            // Measured: 0.1 to 0.7 ms.
            assert!(
                (estimate_s - readout_s).abs() <= 1e-3 && sd_s <= 1e-3,
                "{readout_s} {stretch}: {estimate_s} {sd_s}"
            );
            let doubt = rolling.doubt().expect("it is doubted");
            assert!(doubt.contains(&format!("about {:.0} ms", 1e3 * estimate_s)), "{doubt}");
        }
        let upwards = filmed(-0.016, 0.0, "").doubt().expect("it is doubted");
        assert!(upwards.contains("from below to above"), "{upwards}");
    }

    #[test]
    fn a_shutter_that_does_not_roll_is_not_doubted() {
        for stretch in [0.0, 0.1, -0.1] {
            assert_eq!(filmed(0.0, stretch, "").doubt(), None, "{stretch}");
        }
    }

    #[test]
    fn what_lasting_errors_of_a_pixel_may_make_is_not_doubted() {
        let mut rolling = filmed(0.016, 0.0, "");
        rolling.segments.iter_mut().for_each(|segment| segment.lasting_px2 = 300.0);
        let [_, sd_s] = rolling.estimate_s().expect("segments that move along themselves");
        assert!(sd_s > 0.004 && rolling.doubt().is_none(), "{sd_s}");
    }

    #[test]
    fn a_read_out_time_that_does_not_fit_is_doubted() {
        // The sights are as they were seen: all of it is left.
        let doubt = filmed(0.010, 0.0, "readout_ms = 16").doubt().expect("it is doubted");
        assert!(doubt.contains("readout_ms = 16 ") && doubt.contains("about 25 "), "{doubt}");
    }

    #[test]
    fn without_motion_or_for_a_moment_nothing_is_said() {
        let mut still = filmed(0.016, 0.0, "");
        still.segments.iter_mut().for_each(|segment| segment.stretches.truncate(FEWEST_STRETCHES - 1));
        assert_eq!(still.doubt(), None);
        still
            .segments
            .iter_mut()
            .for_each(|segment| segment.stretches.iter_mut().for_each(|sums| *sums = Sums::zeros()));
        assert_eq!(still.doubt(), None);
        still.segments.clear();
        assert_eq!(still.doubt(), None);
    }
}
