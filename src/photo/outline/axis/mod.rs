//! The axis of each nail found from the photograph: the finger lies on its proximal side.
//!
//! In: the upright photograph and the outlines of its nails, which tell no direction. Out: for each nail the axis from
//! proximal to distal with a confidence, or why it is unknown. Directions are clockwise from up, see [`Axis`].
//!
//! For each of 72 directions the picture around the nail is compared with a finger that points there (`finger`: its two
//! sides, its tip, its skin, the nail's symmetry). The likelihoods become probabilities; the confidence is the
//! probability within 40 degrees of the best direction, and the axis the mean direction there. Fingers of one hand
//! point about the same way, save the thumb: so the other nails of the photograph give a prior, which is mostly
//! uniform. It can tip the scales where the nail's own surroundings leave it open, by a factor of about 4 at most;
//! where it would turn a nail around against its own surroundings, the nail is left out instead.
//!
//! Not determined: tilt towards the camera, and nails without a visible finger (a drawing, a plain background).
//!
//! Measured by `tests/nail_axes.rs`: of 127 nails on 26 real photographs of hands 122 are found, none by over 22
//! degrees off, half within 3.2 (which is what the truth, read by eye, is good for); of phantom close-ups whose nail
//! takes up to half of the photograph's height all, half within 0.4 degrees; of those up to 0.7 of it 92 %, none wrong.

mod finger;
mod surroundings;

use image::DynamicImage;
use thiserror::Error;

use super::moments::solidity;
use super::{Axis, Moments, Outline};
use finger::{evidence, evidence_above};
use surroundings::Surroundings;

const DIRECTIONS: usize = 72;
/// Log-likelihood below the best one at which a direction's neighbours are not looked at.
const HOPELESS: f64 = 5.0;
/// Probability within 40 degrees of the best direction below which a nail is left out. At 0.5 one nail of 127 in grey
/// versions of the real photographs was wrong, at 0.6 none in nine versions of all of them.
pub const LEAST_CONFIDENCE: f64 = 0.6;
/// Directions that count as the same answer, degrees to either side.
const PEAK_DEG: f64 = 40.0;
/// Share of the prior that knows nothing of the other nails.
const UNIFORM: f64 = 0.6;
/// Spread of the directions of a hand's fingers, degrees (standard deviation).
const SPREAD_DEG: f64 = 30.0;
/// How far nails point off the side that was given for them, degrees (standard deviation).
const HINT_DEG: f64 = 30.0;
/// The others turn a nail only where its own picture gives the other direction at least this part of its best one's
/// probability.
const STANDING: f64 = 0.5;
/// Outlines below this long axis show no finger, pixels.
const LEAST_LENGTH_PX: f64 = 5.0;
/// A nail seen from above or aslant has an outline without dents; below this solidity it is not a single nail ..
const DENTED: f64 = 0.91;
/// .. save in profile, where it is a bent sliver, more elongated than this.
const PROFILE: f64 = 2.5;
/// Shapes below this elongation have no axis of their own.
const ROUND: f64 = 1.1;
/// Above this elongation a nail's long axis lies along the finger: nails are at most about this much wider than long.
const WIDE: f64 = 1.35;
/// Probability from which the picture alone is sure enough to doubt what a person said, and how far off that must be,
/// degrees. Measured on each nail alone: at 0.9 and 60 degrees not one right axis of 127 real nails, of the same in
/// grey and of 240 phantoms is doubted, and 100, 95 and 187 of the reversed ones are. The least sure wrong answer has
/// 0.69.
const SURE: f64 = 0.9;
const CONTRADICTS_DEG: f64 = 60.0;
/// From here on a drawn axis slants, and is warned of: right ones of 120 phantoms never are, of 127 real nails one is;
/// those drawn off by 25 degrees are on 90 of the phantoms, and on 90 of the real nails (`tests/nail_axes.rs`).
const SLANTS_DEG: f64 = 18.0;
/// Log-likelihood a nail by which a turned or mirrored annotation must fit better than as it was drawn. Measured: a
/// right one is never more than 1.4 behind (26 real photographs, 240 phantoms), one of a turned real picture always 3.4
/// or more.
const TURNED: f64 = 3.0;

/// The axis of a nail as found, and how sure that is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FoundAxis {
    /// From proximal to distal.
    pub axis: Axis,
    /// Probability that the finger points within 40 degrees of it, 0 to 1.
    pub confidence: f64,
}

/// A nail whose axis is not known.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{doubt}; {}", Self::ADVICE)]
pub struct AxisUnknown {
    /// Why.
    pub doubt: AxisDoubt,
    /// The most probable axis all the same, where there is one.
    pub best_guess: Option<FoundAxis>,
}

impl AxisUnknown {
    /// What a person can do.
    pub(in crate::photo) const ADVICE: &str = "say --distal, or draw an `axis` line from proximal to distal in LabelMe";
}

/// Why the axis of a nail is not known.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum AxisDoubt {
    #[error("the nail's outline lies outside of the photograph")]
    Outside,
    #[error("the nail is {length_px:.1} px long, too small to see the finger's direction")]
    TooSmall { length_px: f64 },
    #[error(
        "the outline is dented (it fills {share:.2} of its convex hull) as where two nails touch; separate them first"
    )]
    Dented { share: f64 },
    #[error("nothing around the nail shows where the finger lies")]
    Featureless,
    #[error("the finger's direction is not clear from the picture (confidence {confidence:.2})")]
    Unclear {
        /// Probability of the best direction, 0 to 1.
        confidence: f64,
    },
    #[error("the picture around the nail and the other fingers point to different sides")]
    AgainstOthers,
}

/// A side of the photograph.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum, serde::Serialize)]
#[serde(rename_all = "snake_case")]
#[allow(missing_docs, reason = "the names say it, also in the help")]
pub enum Side {
    Up,
    Down,
    Left,
    Right,
}

impl Side {
    /// The direction to that side.
    pub fn axis(self) -> Axis {
        let degrees: f64 = match self {
            Self::Up => 0.0,
            Self::Right => 90.0,
            Self::Down => 180.0,
            Self::Left => -90.0,
        };
        Axis::from_clockwise_rad(degrees.to_radians())
    }
}

/// The shape's own axis that points nearest to `hint`.
///
/// A nail is about mirror-symmetric, so its axis is one of the two principal axes of its area; which one and which end
/// the hint says. Where the shape has no axis (nearly round), or is so long across the hint that the hint can't mean
/// its short axis, the axis is the hint itself.
pub fn axis_towards(outline: &Outline, hint: Side) -> Axis {
    let shape = Moments::of(outline);
    if shape.elongation() < ROUND {
        return hint.axis();
    }
    let to_hint = turn(shape.major.clockwise_rad() - hint.axis().clockwise_rad());
    let quarters = (to_hint / std::f64::consts::FRAC_PI_2).round();
    if quarters as i64 % 2 != 0 && shape.elongation() > WIDE {
        return hint.axis();
    }
    Axis::from_clockwise_rad(shape.major.clockwise_rad() - quarters * std::f64::consts::FRAC_PI_2)
}

/// The axes of the nails of one photograph, in the order of `outlines`.
pub fn find_axes(image: &DynamicImage, outlines: &[Outline]) -> Vec<Result<FoundAxis, AxisUnknown>> {
    let alone: Vec<Result<Directions, AxisDoubt>> = outlines.iter().map(|outline| look(image, outline)).collect();
    let known: Vec<Option<&Directions>> = alone.iter().map(|found| found.as_ref().ok()).collect();
    (0..outlines.len())
        .map(|i| match &alone[i] {
            Err(doubt) => Err(AxisUnknown { doubt: *doubt, best_guess: None }),
            Ok(own) => {
                let others: Vec<&Directions> =
                    known.iter().enumerate().filter(|(j, _)| *j != i).filter_map(|(_, d)| *d).collect();
                decide(own, &others)
            }
        })
        .collect()
}

/// The axes of nails whose distal ends all point to one side, give or take: as [`find_axes`], but looked for around
/// `hint`; where the picture does not tell, the shape and the hint do ([`axis_towards`]).
pub fn find_axes_towards(image: &DynamicImage, outlines: &[Outline], hint: Side) -> Vec<Axis> {
    let around = |outline| {
        let mut directions = look(image, outline).ok()?;
        for (k, p) in directions.0.iter_mut().enumerate() {
            let away = turn(direction(k) - hint.axis().clockwise_rad()).to_degrees();
            *p *= (-0.5 * (away / HINT_DEG).powi(2)).exp();
        }
        let found = directions.normalized().peak();
        let near = turn(found.axis.clockwise_rad() - hint.axis().clockwise_rad()).abs() < std::f64::consts::FRAC_PI_2;
        (near && found.confidence >= LEAST_CONFIDENCE).then_some(found.axis)
    };
    outlines.iter().map(|outline| around(outline).unwrap_or_else(|| axis_towards(outline, hint))).collect()
}

/// What the picture around one nail says of an axis that a person gave.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Verdict {
    /// The same.
    Agrees,
    /// Nothing sure.
    Silent,
    /// It is sure of one so many degrees further clockwise.
    Slants(f64),
    /// It is sure of another one.
    Contradicts(FoundAxis),
}

/// Asks the picture around `outline`; other nails of the photograph are not asked. With it, where that is known, how
/// well a finger along `axis` fits.
pub(super) fn verdict(image: &DynamicImage, outline: &Outline, axis: Axis) -> (Verdict, Option<f64>) {
    match see(image, outline) {
        Err(_) => (Verdict::Silent, None),
        Ok(patch) => {
            let scores = bounded(&patch, axis);
            if surely_agrees(&scores, axis) {
                return (Verdict::Agrees, None);
            }
            let found = weigh(&patch, |k| scores[k].known()).peak();
            (verdict_of(found, axis), Some(evidence(&patch, axis.clockwise_rad())))
        }
    }
}

fn verdict_of(found: FoundAxis, axis: Axis) -> Verdict {
    let by_deg = turn(found.axis.clockwise_rad() - axis.clockwise_rad()).to_degrees();
    match by_deg.abs() {
        _ if found.confidence < SURE => Verdict::Silent,
        off if off > CONTRADICTS_DEG => Verdict::Contradicts(found),
        off if off > SLANTS_DEG => Verdict::Slants(by_deg),
        _ => Verdict::Agrees,
    }
}

/// What is known of a direction's log-likelihood.
#[derive(Debug, Clone, Copy)]
enum Score {
    Known(f64),
    /// It is the mean of those of the directions to both sides, which are [`HOPELESS`].
    Mean(f64),
    AtMost(f64),
}

impl Score {
    fn known(self) -> Option<f64> {
        if let Self::Known(score) = self { Some(score) } else { None }
    }

    fn most(self) -> f64 {
        let (Self::Known(score) | Self::Mean(score) | Self::AtMost(score)) = self;
        score
    }

    fn is_bound(self) -> bool {
        matches!(self, Self::AtMost(_))
    }
}

/// Log-likelihood below the best direction's from which [`bounded`] does not ask how far: 72 directions there have less
/// than a hundredth of the probability.
const FAR_BELOW: f64 = 9.0;

/// The scores of all directions, where those far below the best one are bounded, not measured: that takes less. The
/// drawn axis is asked first, as most are right.
fn bounded(patch: &Surroundings, axis: Axis) -> [Score; DIRECTIONS] {
    let drawn = (axis.clockwise_rad() / std::f64::consts::TAU * DIRECTIONS as f64 / 2.0).round() as i64 * 2;
    let from_drawn = |steps: i64| (drawn + steps).rem_euclid(DIRECTIONS as i64) as usize;
    let mut scores = [Score::AtMost(0.0); DIRECTIONS];
    let mut best = f64::NEG_INFINITY;
    let ask = |k: usize, best: &mut f64| {
        let floor = *best - FAR_BELOW;
        let score = evidence_above(patch, direction(k), floor).map_or(Score::AtMost(floor), Score::Known);
        *best = best.max(score.most());
        score
    };
    // The likeliest first.
    for steps in (0..DIRECTIONS as i64 / 2).step_by(2) {
        for k in [from_drawn(steps), from_drawn(-steps - 2)] {
            scores[k] = ask(k, &mut best);
        }
    }
    let best_of_even = best;
    for k in (1..DIRECTIONS).step_by(2) {
        let (before, after) = (scores[k - 1], scores[(k + 1) % DIRECTIONS]);
        scores[k] = if before.most().max(after.most()) >= best_of_even - HOPELESS {
            ask(k, &mut best)
        } else {
            let mean = 0.5 * (before.most() + after.most());
            if before.is_bound() || after.is_bound() { Score::AtMost(mean) } else { Score::Mean(mean) }
        };
    }
    scores
}

/// Whether the [`verdict`] is surely that the picture agrees: true only where it is the same whatever the bounded
/// directions are.
fn surely_agrees(scores: &[Score; DIRECTIONS], axis: Axis) -> bool {
    let best = scores.iter().map(|score| score.most()).fold(f64::NEG_INFINITY, f64::max);
    let part =
        |bounds: bool| scores.map(|score| if score.is_bound() == bounds { (score.most() - best).exp() } else { 0.0 });
    let (known, bounds) = (Directions(part(false)), part(true));
    let unknown: f64 = bounds.iter().sum();
    let found = known.peak();
    let all = known.0.iter().sum::<f64>() + unknown;
    let mass = known.around(direction(known.best())).0;
    let least = mass / all;
    let off_deg = found.axis.apart_deg(axis) + 2.0 * PEAK_DEG * unknown / mass;
    // Beyond what rounding could tip.
    least >= SURE + 1e-9 && off_deg <= SLANTS_DEG - 1e-9
}

/// Whether two axes that people gave are the same, as far as a picture could contradict them.
pub(super) fn agree(one: Axis, other: Axis) -> bool {
    one.apart_deg(other) <= CONTRADICTS_DEG
}

/// How a picture may have been turned after it was annotated, in words; `None` where the annotation fits as well as it
/// is.
///
/// Each outline and drawn axis is moved as the picture would have been, and fingers are looked for there; the third of
/// each is how well one fits as it was drawn, where [`verdict`] found that. Turns that change the picture's size show
/// in the size, so a quarter turn is tried on square pictures only.
pub(super) fn turned_since(image: &DynamicImage, drawn: &[(&Outline, Axis, Option<f64>)]) -> Option<&'static str> {
    let size = [f64::from(image.width()), f64::from(image.height())];
    let fits = |outline: &Outline, axis: Axis| {
        let patch = Surroundings::read(image, outline, &Moments::of(outline))?;
        Some(evidence(&patch, axis.clockwise_rad()))
    };
    let as_drawn: Vec<Option<f64>> =
        drawn.iter().map(|(outline, axis, fit)| fit.or_else(|| fits(outline, *axis))).collect();
    let turns = if size[0] == size[1] { &TURNS[..] } else { &TURNS[..4] };
    let gains = turns.iter().filter_map(|(name, turned)| {
        let gain = |((outline, axis, _), before): (&(&Outline, Axis, _), &Option<f64>)| {
            let last = [size[0] - 1.0, size[1] - 1.0];
            let points: Vec<[f64; 2]> = outline.points().into_iter().map(|p| turned(p, last)).collect();
            let axis = Axis::through(turned([0.0; 2], [0.0; 2]), turned(axis.distal(), [0.0; 2]))?;
            Some(fits(&Outline::new(&points).ok()?, axis)? - (*before)?)
        };
        let gains: Vec<f64> = drawn.iter().zip(&as_drawn).filter_map(gain).collect();
        (!gains.is_empty()).then(|| (gains.iter().sum::<f64>() / gains.len() as f64, *name))
    });
    let (gain, name) = gains.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (gain > TURNED).then_some(name)
}

/// A point moved with a picture whose last column and row are given.
type Turn = fn([f64; 2], [f64; 2]) -> [f64; 2];
/// The turns that a picture may have had, and a program that writes rows and columns; the first four go with every
/// picture's size.
const TURNS: [(&str, Turn); 7] = [
    ("turned by 180 degrees", |[x, y], [right, bottom]| [right - x, bottom - y]),
    ("mirrored left to right", |[x, y], [right, _]| [right - x, y]),
    ("mirrored top to bottom", |[x, y], [_, bottom]| [x, bottom - y]),
    ("with x and y exchanged (rows before columns?)", |[x, y], _| [y, x]),
    ("turned by 90 degrees clockwise", |[x, y], [_, bottom]| [bottom - y, x]),
    ("turned by 90 degrees counterclockwise", |[x, y], [right, _]| [y, right - x]),
    ("mirrored along a diagonal", |[x, y], [right, bottom]| [bottom - y, right - x]),
];

/// Probabilities of the directions, 360 / [`DIRECTIONS`] degrees apart from up clockwise.
#[derive(Debug, Clone, PartialEq)]
struct Directions([f64; DIRECTIONS]);

/// What the picture around one nail says.
fn look(image: &DynamicImage, outline: &Outline) -> Result<Directions, AxisDoubt> {
    see(image, outline).map(|patch| weigh(&patch, |_| None))
}

/// The surroundings of a nail that show something.
fn see(image: &DynamicImage, outline: &Outline) -> Result<Surroundings, AxisDoubt> {
    let shape = Moments::of(outline);
    if shape.major_px < LEAST_LENGTH_PX {
        return Err(AxisDoubt::TooSmall { length_px: shape.major_px });
    }
    let share = solidity(outline);
    if share < DENTED && shape.elongation() < PROFILE {
        return Err(AxisDoubt::Dented { share });
    }
    let patch = Surroundings::read(image, outline, &shape).ok_or(AxisDoubt::Outside)?;
    if patch.featureless {
        return Err(AxisDoubt::Featureless);
    }
    Ok(patch)
}

/// How probable each direction is; the score of some is `known`.
fn weigh(patch: &Surroundings, known: impl Fn(usize) -> Option<f64>) -> Directions {
    let score = |k: usize| known(k).unwrap_or_else(|| evidence(patch, direction(k)));
    // Every second direction first; those between two hopeless ones need no look.
    let mut scores = [0.0; DIRECTIONS];
    for k in (0..DIRECTIONS).step_by(2) {
        scores[k] = score(k);
    }
    let best = scores.iter().step_by(2).copied().fold(f64::MIN, f64::max);
    for k in (1..DIRECTIONS).step_by(2) {
        let (before, after) = (scores[k - 1], scores[(k + 1) % DIRECTIONS]);
        let hopeless = before.max(after) < best - HOPELESS;
        scores[k] = if hopeless { 0.5 * (before + after) } else { score(k) };
    }
    let best = scores.iter().copied().fold(f64::MIN, f64::max);
    Directions(scores.map(|score| (score - best).exp())).normalized()
}

/// One nail, given the others of its photograph.
fn decide(own: &Directions, others: &[&Directions]) -> Result<FoundAxis, AxisUnknown> {
    let together = own.given(others);
    let found = together.peak();
    let unsure = |doubt| Err(AxisUnknown { doubt, best_guess: Some(found) });
    let alone = own.peak();
    let turned = turn(found.axis.clockwise_rad() - alone.axis.clockwise_rad()).abs();
    if turned > PEAK_DEG.to_radians() && own.around(found.axis.clockwise_rad()).0 < STANDING * alone.confidence {
        return unsure(AxisDoubt::AgainstOthers);
    }
    if found.confidence < LEAST_CONFIDENCE {
        return unsure(AxisDoubt::Unclear { confidence: found.confidence });
    }
    Ok(found)
}

impl Directions {
    fn normalized(mut self) -> Self {
        let sum: f64 = self.0.iter().sum();
        self.0.iter_mut().for_each(|p| *p /= sum);
        self
    }

    /// These directions with the other fingers' as a prior.
    fn given(&self, others: &[&Self]) -> Self {
        if others.is_empty() {
            return self.clone();
        }
        let mut kernel: [f64; DIRECTIONS] =
            std::array::from_fn(|k| (-0.5 * (turn(direction(k)).to_degrees() / SPREAD_DEG).powi(2)).exp());
        let sum: f64 = kernel.iter().sum();
        kernel.iter_mut().for_each(|weight| *weight /= sum);
        let mean: [f64; DIRECTIONS] =
            std::array::from_fn(|k| others.iter().map(|other| other.0[k]).sum::<f64>() / others.len() as f64);
        let joint = std::array::from_fn(|k| {
            let parallel: f64 = (0..DIRECTIONS).map(|j| mean[j] * kernel[(k + DIRECTIONS - j) % DIRECTIONS]).sum();
            self.0[k] * (UNIFORM / DIRECTIONS as f64 + (1.0 - UNIFORM) * parallel)
        });
        Self(joint).normalized()
    }

    /// The mean direction around the most probable one, and the probability there.
    fn peak(&self) -> FoundAxis {
        let best = self.best();
        let (mass, mean) = self.around(direction(best));
        FoundAxis { axis: Axis::from_clockwise_rad(direction(best) + mean), confidence: mass.min(1.0) }
    }

    fn best(&self) -> usize {
        (0..DIRECTIONS).rev().max_by(|&a, &b| self.0[a].total_cmp(&self.0[b])).unwrap_or(0)
    }

    /// The probability within [`PEAK_DEG`] of `centre_rad`, and the mean offset from it there.
    fn around(&self, centre_rad: f64) -> (f64, f64) {
        let (mut mass, mut moment) = (0.0, 0.0);
        for (k, p) in self.0.iter().enumerate() {
            let away = turn(direction(k) - centre_rad);
            if away.abs() <= PEAK_DEG.to_radians() + 1e-9 {
                mass += p;
                moment += p * away;
            }
        }
        (mass, moment / mass)
    }
}

/// Direction `k`, clockwise from up, radians.
fn direction(k: usize) -> f64 {
    std::f64::consts::TAU * k as f64 / DIRECTIONS as f64
}

/// An angle brought to -pi..=pi.
fn turn(angle: f64) -> f64 {
    Axis::from_clockwise_rad(angle).clockwise_rad()
}

#[cfg(test)]
mod tests {
    use image::{Rgb, RgbImage};
    use rand::{RngExt, SeedableRng};

    use super::*;

    /// Fingers of every direction and contrast on noise, with axes drawn right and wrong.
    #[test]
    fn the_quick_verdict_is_that_of_all_directions() {
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(7);
        let (mut quick, mut verdicts) = (0, [0; 4]);
        for _ in 0..120 {
            let turn: f64 = random.random_range(-3.1..3.1);
            let (contrast, noise) = (random.random_range(0.0..90.0), random.random_range(1.0..40.0));
            let (sin, cos) = turn.sin_cos();
            let image = RgbImage::from_fn(240, 240, |x, y| {
                let (dx, dy) = (f64::from(x) - 120.0, f64::from(y) - 120.0);
                let (across, along) = (dx * cos + dy * sin, dx * sin - dy * cos);
                let round = (across / 30.0).powi(2) + ((along - 10.0).max(0.0) / 26.0).powi(2);
                let level = 90.0 + if round < 1.0 { contrast } else { 0.0 } + noise * random.random_range(-1.0..1.0);
                Rgb([level as u8, (0.8 * level) as u8, (0.7 * level) as u8])
            });
            let image = DynamicImage::from(image);
            let point = |k: usize| {
                let (s, c) = (std::f64::consts::TAU * k as f64 / 24.0).sin_cos();
                let (across, along) = (15.0 * s, 20.0 * c + 8.0);
                [120.0 + across * cos + along * sin, 120.0 + across * sin - along * cos]
            };
            let outline = Outline::new(&(0..24).map(point).collect::<Vec<_>>()).expect("an ellipse");
            let Ok(patch) = see(&image, &outline) else { continue };
            for off in [0.0, 0.3, 1.0, 1.1, 3.0] {
                let axis = Axis::from_clockwise_rad(turn + off);
                let scores = bounded(&patch, axis);
                let weighed = weigh(&patch, |_| None);
                assert_eq!(weighed, weigh(&patch, |k| scores[k].known()), "{turn} {off}");
                let all = verdict_of(weighed.peak(), axis);
                verdicts[match all {
                    Verdict::Agrees => 0,
                    Verdict::Silent => 1,
                    Verdict::Contradicts(_) => 2,
                    Verdict::Slants(_) => 3,
                }] += 1;
                quick += usize::from(surely_agrees(&scores, axis));
                assert!(all == Verdict::Agrees || !surely_agrees(&scores, axis), "{turn} {off}");
            }
        }
        assert!(verdicts.iter().all(|&count| count > 10) && 10 * quick > 8 * verdicts[0], "{quick} of {verdicts:?}");
    }
}
