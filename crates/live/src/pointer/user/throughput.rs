//! Throughput of ISO 9241-411 as Soukoreff and MacKenzie (2004, DOI 10.1016/j.ijhcs.2004.09.001) define it.
//!
//! Of each condition and person: ID_e = log2(D_e / W_e + 1), W_e = 4.133 SD of the end points along the way from target
//! to target, D_e the mean way, MT the mean time from click to click; throughput is the mean of ID_e / MT over the
//! conditions, then over persons (their equation 10), with its standard error between persons.

use super::desk::Desk;
use super::hand::{Hand, Target};
use super::person::Person;
use super::task::Task;
use crate::pointer::{Click, Config, Mode};
use crate::spread::Spread;

/// W_e of an SD: 96 % of normal end points are within (the source's).
const WIDTH_OF_SD: f64 = 4.133;

/// What persons achieve.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Throughput {
    /// The mean, bits/s; none where a target was given up, or nothing can be made of it.
    pub(super) bits_per_s: Option<f64>,
    /// Its standard error between persons, bits/s; none of fewer than two.
    pub(super) standard_error: Option<f64>,
    pub(super) given_up: usize,
    /// The conditions, means over persons.
    pub(super) conditions: Vec<Condition>,
}

/// A condition's means.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Condition {
    /// Diameter of the ring, px.
    pub(super) distance_px: f64,
    /// Diameter of a target, px.
    pub(super) width_px: f64,
    /// W_e, px.
    pub(super) effective_width_px: f64,
    /// D_e, px.
    pub(super) effective_distance_px: f64,
    /// MT, s.
    pub(super) movement_s: f64,
    /// The share of clicks beside the target.
    pub(super) missed: f64,
    /// ID_e / MT, bits/s.
    pub(super) bits_per_s: f64,
}

/// The throughput of one person for each seed; `sensor` makes each person's. Only of the mode `velocity`, whose curve
/// the simulated person has learned: none of another, and none without clicks by pressing.
pub(super) fn throughput<S>(
    config: &Config,
    person: &Person,
    task: &Task,
    seeds: &[u64],
    mut sensor: impl FnMut(u64) -> S,
) -> Throughput
where
    S: FnMut(f64, [f64; 3]) -> [f64; 3],
{
    let mut all = Throughput { bits_per_s: None, standard_error: None, given_up: 0, conditions: Vec::new() };
    if config.mode != Mode::Velocity || config.click != Click::Press || !task.can_be_walked() {
        return all;
    }
    let mut persons = Vec::new();
    for &seed in seeds {
        let (mut desk, mut hand) = (Desk::new(config, sensor(seed)), Hand::new(*person, *config, seed));
        let mut of_person = Vec::new();
        for &distance_px in &task.distances_px {
            for &width_px in &task.widths_px {
                match ring(&mut desk, &mut hand, task, distance_px, width_px) {
                    Some(condition) => of_person.push(condition),
                    None => all.given_up += 1,
                }
            }
        }
        persons.push(of_person);
    }
    let conditions = task.distances_px.len() * task.widths_px.len();
    if all.given_up > 0 || conditions == 0 || persons.is_empty() {
        return all;
    }
    let each = Spread::of(persons.iter().map(|of| mean(of.iter().map(|condition| condition.bits_per_s))));
    all.bits_per_s = each.map(|each| each.mean);
    all.standard_error = each.and_then(|each| Some(each.sd? / (each.n as f64).sqrt()));
    all.conditions = (0..conditions).map(|index| mean_condition(&persons, index)).collect();
    all
}

/// One ring; none where a target was given up.
fn ring(
    desk: &mut Desk<impl FnMut(f64, [f64; 3]) -> [f64; 3]>,
    hand: &mut Hand,
    task: &Task,
    distance_px: f64,
    width_px: f64,
) -> Option<Condition> {
    let mut ends = Vec::new();
    let mut before: Option<(Target, [f64; 2], f64)> = None;
    for target in task.targets(distance_px, width_px) {
        let shown_s = desk.t_s();
        let at_px = loop {
            let force_n = hand.aim(desk.t_s(), desk.at.map(|count| count as f64), target);
            if let Some(at_px) = desk.feel(force_n) {
                break at_px.map(|count| count as f64);
            }
            if desk.t_s() - shown_s > task.patience_s {
                return None;
            }
        };
        if let Some((from, from_px, from_s)) = before {
            ends.push(End::new(from, from_px, target, at_px, desk.t_s() - from_s));
        }
        before = Some((target, at_px, desk.t_s()));
    }
    let along = Spread::of(ends.iter().map(|end| end.beyond_px))?;
    let (effective_width_px, movement_s) = (WIDTH_OF_SD * along.sd?, mean(ends.iter().map(|end| end.took_s)));
    let effective_distance_px = mean(ends.iter().map(|end| end.way_px));
    let bits = (effective_distance_px / effective_width_px + 1.0).log2();
    Some(Condition {
        distance_px,
        width_px,
        effective_width_px,
        effective_distance_px,
        movement_s,
        missed: mean(ends.iter().map(|end| f64::from(u8::from(end.missed)))),
        bits_per_s: bits / movement_s,
    })
}

/// A click, seen from the one before.
struct End {
    /// How far beyond the target's centre, along the line from target to target, px.
    beyond_px: f64,
    /// How far from where it began, along that line, px.
    way_px: f64,
    took_s: f64,
    missed: bool,
}

impl End {
    fn new(from: Target, from_px: [f64; 2], to: Target, at_px: [f64; 2], took_s: f64) -> Self {
        let line: [f64; 2] = std::array::from_fn(|axis| to.centre_px[axis] - from.centre_px[axis]);
        let length = line[0].hypot(line[1]);
        let along = |a: [f64; 2], b: [f64; 2]| ((b[0] - a[0]) * line[0] + (b[1] - a[1]) * line[1]) / length;
        let off = (at_px[0] - to.centre_px[0]).hypot(at_px[1] - to.centre_px[1]);
        Self {
            beyond_px: along(to.centre_px, at_px),
            way_px: along(from_px, at_px),
            took_s,
            missed: off > to.radius_px,
        }
    }
}

fn mean_condition(persons: &[Vec<Condition>], index: usize) -> Condition {
    let of = |figure: fn(&Condition) -> f64| mean(persons.iter().map(|conditions| figure(&conditions[index])));
    Condition {
        distance_px: of(|condition| condition.distance_px),
        width_px: of(|condition| condition.width_px),
        effective_width_px: of(|condition| condition.effective_width_px),
        effective_distance_px: of(|condition| condition.effective_distance_px),
        movement_s: of(|condition| condition.movement_s),
        missed: of(|condition| condition.missed),
        bits_per_s: of(|condition| condition.bits_per_s),
    }
}

fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len() as f64;
    values.sum::<f64>() / count
}
