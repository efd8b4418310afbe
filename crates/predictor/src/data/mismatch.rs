//! Whether the parts of a dataset (files, days) agree on which column is which, and in which unit; whether a recording
//! agrees with a model on which column is which.
//!
//! In: a [`Dataset`] and its parts. Out: of each part the one column, or the two, that look exchanged, scaled or turned
//! in sign beside the other parts, or two forces that look measured along other axes ([`Parts::mismatches`]); and
//! whether one model of all parts is much worse than one of each ([`Parts::apart`]). In: recordings, and what a model
//! makes of them with their inputs in any order. Out: which two columns look exchanged, or which two forces turned
//! ([`beside_model`]).
//!
//! A linear model (equations 10 to 13) of the other parts is tried on the part as it is and with each pair of columns
//! exchanged, each column scaled, and the same the other way round. Only what explains both is said. Of 182 pairs of
//! phantom logs of touch that agree (persons, days, kinds of photodiodes) none was called a mismatch; with an exchange
//! or a sign made in one of two logs of a person 218 of 240 were found, gains of 0.5 and 2 139 of 192, forces turned by
//! 90 and 180 degrees 48 of 48, by 45 degrees 9 of 24, none under another name (`cargo test --test all
//! mismatches_of_phantom_logs -- --ignored --nocapture`). Bending is hardly linear from day to day: little is found
//! there. Beside a model of one log 334 of 336 exchanges in another of the person are found by a linear model, 112 by a
//! quadratic one, forces turned by 30, 45 and 90 degrees in 28, 47 and 48 of 48 and in 14, 16 and 16, none under
//! another name, and none in 728 that agree (`exchanges_beside_models_of_phantom_logs`).

use std::ops::Range;

use ndarray::{Array1, Array2, Axis, Slice};

use crate::algebra::cholesky::Cholesky;
use crate::{Dataset, Recording};

/// Rows of a part for each unknown, at least, and inputs, at most: more of them explain much by chance.
const ROWS: usize = 20;
const INPUTS: usize = 16;
/// It is sure where the model of the others, once the columns are put right, leaves so little of the targets' variance
/// unexplained, so many times less than as they are, one way or the other by so much, and so many times less than with
/// any other columns put right (assumed; the head says what they give).
const UNEXPLAINED: f64 = 0.4;
const TIMES: f64 = 0.5;
const LESS: f64 = 0.05;
const RIVAL: f64 = 1.5;
/// A sensor that is put on again changes its gains by less than this (assumed).
const GAIN: f64 = 1.7;
/// Axes of a transducer that is mounted again are turned by less, degrees (assumed).
const TURN_DEG: f64 = 15.0;
/// Forces that are turned beside a model change alike: their variances are no more different (assumed).
const COMPARABLE: f64 = 0.2;
/// How targets that are forces, newtons along an axis each, are called at their end.
const FORCE: &str = "_N";
/// A model of all parts is much worse where it leaves this many times the error that one of each part leaves, and so
/// much more of the targets' variance. Of the phantom's logs of touch 48 pairs of days and paths of a finger never do,
/// 82 of 192 pairs of two fingers do; most others are of random forces, which each one's own model explains less.
const MUCH: f64 = 1.5;
const MATTERS: f64 = 0.03;
/// Of the inputs' variance: what keeps columns that depend on each other solvable.
const LEAST: f64 = 1e-10;

/// How columns of a part differ from the others'. Columns are counted over inputs, then targets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Difference {
    /// Two columns stand in each other's place.
    Exchanged([usize; 2]),
    /// All inputs stand in the one of the orders that are looked for which is counted so.
    Ordered(usize),
    /// Two forces are measured along axes that are turned so far, degrees from the first towards the second.
    Turned {
        /// Which.
        columns: [usize; 2],
        /// -180 to 180.
        by_deg: f64,
    },
    /// A column is so many times the others'.
    Scaled {
        /// Which.
        column: usize,
        /// Below 0 where its sign is another.
        by: f64,
    },
}

/// A part that contradicts the others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mismatch {
    /// Its place among the parts.
    pub part: usize,
    /// What would explain it.
    pub difference: Difference,
    /// The share of its targets' variance that a linear model of the other parts leaves unexplained.
    pub recorded: f64,
    /// The same with the columns put right.
    pub mended: f64,
}

/// A part that one model of all parts fits worst, where that model is much worse than one of each part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Apart {
    /// Its place among the parts.
    pub part: usize,
    /// The target, counted over targets, whose error grows most.
    pub target: usize,
    /// How many times the error of a model of its own that of the model of all is, RMS over all parts.
    pub times: f64,
}

/// The parts of a dataset that have rows enough to be compared.
#[derive(Debug, Clone)]
pub struct Parts {
    /// Each by its place among all, and its sums.
    large: Vec<(usize, Moments)>,
}

impl Parts {
    /// Of parts as ranges of rows. None where there are fewer than two with rows enough for the inputs, or hidden or
    /// too many inputs.
    #[must_use]
    pub fn of(data: &Dataset, parts: &[Range<usize>]) -> Option<Self> {
        let inputs = data.inputs().len();
        let large: Vec<_> = parts.iter().enumerate().filter(|(_, rows)| rows.len() >= ROWS * (1 + inputs)).collect();
        let is_comparable = (1..=INPUTS).contains(&inputs) && large.len() >= 2;
        let sums = |(part, rows)| (part, Moments::of(data, rows));
        is_comparable.then(|| Self { large: large.into_iter().map(sums).collect() })
    }

    /// The sums of those that are wanted, by their place.
    fn sum(&self, is_wanted: impl Fn(usize) -> bool) -> Moments {
        let mut sum = self.large[0].1.nothing();
        self.large.iter().filter(|(part, _)| is_wanted(*part)).for_each(|(_, one)| sum.add(one));
        sum
    }

    /// Those that contradict the others. Of two that contradict each other both are named: the rows do not say which is
    /// right. Nothing is said of hidden inputs.
    ///
    /// Inputs may stand in each other's place, or be scaled, one or two of them; where there are `orders`, as of a
    /// picture's cells, only all of them at once: of each order, which input comes in each one's place. Done twice it
    /// changes nothing.
    #[must_use]
    pub fn mismatches(&self, orders: &[Vec<usize>]) -> Vec<Mismatch> {
        let differs = |(part, own): &(usize, Moments)| {
            let others = self.sum(|other| other != *part);
            let [there, back] = [(&others, own), (own, &others)].map(|(of, on)| explained(of, on, orders));
            let ((difference, recorded, mended), (again, recorded_back, mended_back)) = (there?, back?);
            let agree = match (difference, again) {
                (Difference::Scaled { column, by }, Difference::Scaled { column: same, by: back }) => {
                    column == same && is_gain(by * back)
                }
                (Difference::Turned { columns, by_deg }, Difference::Turned { columns: same, by_deg: back }) => {
                    columns == same && !is_turn(by_deg + back)
                }
                (one, other) => one == other || is_mirror_image(one, other),
            };
            let matters = (recorded - mended).max(recorded_back - mended_back) >= LESS;
            (agree && matters).then_some(Mismatch { part: *part, difference, recorded, mended })
        };
        self.large.iter().filter_map(differs).collect()
    }

    /// Whether one linear model of all is much worse than one of each, as it is of two persons.
    #[must_use]
    pub fn apart(&self) -> Option<Apart> {
        let all = self.sum(|_| true);
        let model = all.model()?;
        let own = self.large.iter().map(|(_, one)| one.model()).collect::<Option<Vec<_>>>()?;
        let of_target = |(target, column): (usize, usize)| {
            let left = self.large.iter().zip(&own).map(|((_, one), own)| {
                [&model, own].map(|model| one.unexplained_of(&model[target], column) * one.at(column, column))
            });
            let left: Vec<[f64; 2]> = left.collect();
            let [pooled, alone] = [0, 1].map(|k| left.iter().map(|both| both[k]).sum::<f64>());
            let times = |both: &[f64; 2]| both[0] / both[1];
            let ((part, _), _) = self.large.iter().zip(&left).max_by(|a, b| times(a.1).total_cmp(&times(b.1)))?;
            let matters = pooled - alone >= MATTERS * all.at(column, column);
            let times = (pooled / alone).sqrt();
            (matters && times >= MUCH && times.is_finite()).then_some(Apart { part: *part, target, times })
        };
        all.targets().enumerate().filter_map(of_target).max_by(|a, b| a.times.total_cmp(&b.times))
    }
}

/// The recordings that a model contradicts as they are, and does not with two columns exchanged, or two forces turned.
/// `answered`: the rows that were answered by `values`, as they are; `answer`: the same rows with the inputs in another
/// order. Offsets do not count.
#[must_use]
pub fn beside_model(
    answered: &Dataset,
    values: &Array2<f64>,
    inputs: usize,
    answer: impl Fn(&[usize]) -> Option<Array2<f64>>,
) -> Vec<Mismatch> {
    if inputs > INPUTS {
        return Vec::new();
    }
    let targets = answered.targets().len();
    let own: Vec<usize> = (0..targets).collect();
    let both = |one: &Recording, values: &Array2<f64>, [target, k]: [usize; 2]| {
        let rows = Slice::from(one.rows.clone());
        [(answered.y(), target), (values, k)].map(|(of, column)| of.column(column).slice_axis(Axis(0), rows).to_owned())
    };
    let share = |one: &Recording, values: &Array2<f64>, order: &[usize]| {
        let shares = order.iter().enumerate().map(|(k, &target)| {
            let [measured, values] = both(one, values, [target, k]);
            (&measured - &values).var(0.0) / measured.var(0.0)
        });
        shares.sum::<f64>() / targets as f64
    };
    let of_recording = |(part, one)| (part, one, share(one, values, &own));
    let mut doubted: Vec<(usize, &Recording, f64)> =
        answered.recordings().iter().enumerate().map(of_recording).collect();
    doubted.retain(|(_, one, recorded)| one.rows.len() >= ROWS * (1 + inputs) && *recorded >= LESS);
    if doubted.is_empty() {
        return Vec::new();
    }
    let in_order = |count: usize, [a, b]: [usize; 2]| {
        let mut order: Vec<usize> = (0..count).collect();
        order.swap(a, b);
        order
    };
    // Answers are looked at one after the other: together they would take as much memory as there are pairs.
    let mut tried = vec![Vec::new(); doubted.len()];
    let mut look = |pair, values: &Array2<f64>, order: &[usize]| {
        for ((_, one, _), tried) in doubted.iter().zip(&mut tried) {
            tried.push((Difference::Exchanged(pair), share(one, values, order)));
        }
    };
    for pair in pairs(0..inputs) {
        if let Some(values) = answer(&in_order(inputs, pair)) {
            look(pair, &values, &own);
        }
    }
    for pair in pairs(0..targets) {
        look(pair.map(|k| inputs + k), values, &in_order(targets, pair));
    }
    for pair in pairs_of(&forces(answered.targets())) {
        for ((_, one, recorded), tried) in doubted.iter().zip(&mut tried) {
            let [[a, of_a], [b, of_b]] = pair.map(|k| both(one, values, [k, k]).map(centred));
            // Where one hardly changes, any crosstalk of the other looks like a turn.
            let spread = [a.dot(&a), b.dot(&b)];
            if spread[0].min(spread[1]) < COMPARABLE * spread[0].max(spread[1]) {
                continue;
            }
            let (sin, cos) = (of_a.dot(&b) - of_b.dot(&a), of_a.dot(&a) + of_b.dot(&b));
            let by = sin.atan2(cos);
            let difference = Difference::Turned { columns: pair.map(|k| inputs + k), by_deg: by.to_degrees() };
            let left = |measured: &Array1<f64>, values: &Array1<f64>| (measured - values).var(0.0) / measured.var(0.0);
            let back = [&a * by.cos() + &b * by.sin(), &b * by.cos() - &a * by.sin()];
            let gain = left(&back[0], &of_a) - left(&a, &of_a) + left(&back[1], &of_b) - left(&b, &of_b);
            tried.push((difference, recorded + gain / targets as f64));
        }
    }
    // A force of another sign, which answers with two photodiodes exchanged are like, is no exchange.
    let with_sign = |one: &Recording, k: usize| {
        let [measured, values] = both(one, values, [k, k]);
        (&measured + &values).var(0.0) / measured.var(0.0) - (&measured - &values).var(0.0) / measured.var(0.0)
    };
    let found = doubted.into_iter().zip(tried).filter_map(|((part, one, recorded), tried)| {
        let (difference, mended) = best(tried, recorded)?;
        let is_sign = (0..targets).any(|k| mended > recorded + with_sign(one, k) / targets as f64);
        let matters = recorded - mended >= LESS && is_other(difference);
        (matters && !is_sign).then_some(Mismatch { part, difference, recorded, mended })
    });
    found.collect()
}

/// Every two of some columns.
fn pairs(columns: Range<usize>) -> impl Iterator<Item = [usize; 2]> {
    let end = columns.end;
    columns.flat_map(move |a| (a + 1..end).map(move |b| [a, b]))
}

/// Every two of some places.
fn pairs_of(places: &[usize]) -> impl Iterator<Item = [usize; 2]> {
    pairs(0..places.len()).map(|pair| pair.map(|k| places[k]))
}

fn forces(targets: &[String]) -> Vec<usize> {
    (0..targets.len()).filter(|k| targets[*k].ends_with(FORCE)).collect()
}

fn centred(values: Array1<f64>) -> Array1<f64> {
    let mean = values.mean().unwrap_or_default();
    values - mean
}

/// Of differences and what is left unexplained with each put right, the one that is clearly best and surely needed.
fn best(mut all: Vec<(Difference, f64)>, recorded: f64) -> Option<(Difference, f64)> {
    all.retain(|(_, share)| share.is_finite());
    all.sort_by(|a, b| a.1.total_cmp(&b.1));
    let &(difference, mended) = all.first()?;
    let rival = all[1..].iter().find(|rival| !is_mirror_image(difference, rival.0));
    let is_clear = rival.is_none_or(|rival| rival.1 >= RIVAL * mended);
    let is_sure = mended <= UNEXPLAINED.min(TIMES * recorded);
    (is_clear && is_sure).then_some((difference, mended))
}

/// Whether one is a column of the other sign and the other one inputs in another order: where a picture is alike on
/// both sides, they are the same.
fn is_mirror_image(one: Difference, other: Difference) -> bool {
    let sign = |of: Difference| matches!(of, Difference::Scaled { by, .. } if by < 0.0);
    let order = |of: Difference| matches!(of, Difference::Ordered(_));
    sign(one) && order(other) || order(one) && sign(other)
}

/// Whether axes are turned by more than those of a transducer that was mounted again.
fn is_turn(by_deg: f64) -> bool {
    (TURN_DEG..360.0 - TURN_DEG).contains(&by_deg.rem_euclid(360.0))
}

/// Whether a difference is more than mounting again makes.
fn is_other(difference: Difference) -> bool {
    match difference {
        Difference::Scaled { by, .. } => !is_gain(by),
        Difference::Turned { by_deg, .. } => is_turn(by_deg),
        Difference::Exchanged(_) | Difference::Ordered(_) => true,
    }
}

/// Whether a sensor that was put on again may differ so much.
fn is_gain(by: f64) -> bool {
    (1.0 / GAIN..GAIN).contains(&by)
}

/// Sums of products of all columns, each about its mean in its recording; inputs first.
#[derive(Debug, Clone)]
struct Moments {
    inputs: usize,
    columns: usize,
    /// The targets that are forces, counted over columns.
    forces: Vec<usize>,
    /// Columns x columns, row by row.
    sums: Vec<f64>,
}

impl Moments {
    fn of(data: &Dataset, rows: &Range<usize>) -> Self {
        let inputs = data.inputs().len();
        let columns = inputs + data.targets().len();
        let forces = forces(data.targets()).into_iter().map(|k| inputs + k).collect();
        let mut all = Self { inputs, columns, forces, sums: vec![0.0; columns * columns] };
        let value = |row: usize, k: usize| {
            if k < all.inputs { data.x()[[row, k]] } else { data.y()[[row, k - all.inputs]] }
        };
        for one in data.recordings() {
            let own = one.rows.start.max(rows.start)..one.rows.end.min(rows.end);
            let mean = |k: usize| own.clone().map(|row| value(row, k)).sum::<f64>() / own.len() as f64;
            let means: Vec<f64> = (0..all.columns).map(mean).collect();
            for row in own.clone() {
                let about: Vec<f64> = means.iter().enumerate().map(|(k, mean)| value(row, k) - mean).collect();
                let products = about.iter().flat_map(|a| about.iter().map(move |b| a * b));
                all.sums.iter_mut().zip(products).for_each(|(sum, product)| *sum += product);
            }
        }
        all
    }

    /// Of the same columns, and no row.
    fn nothing(&self) -> Self {
        Self { sums: vec![0.0; self.sums.len()], ..self.clone() }
    }

    fn add(&mut self, other: &Self) {
        self.sums.iter_mut().zip(&other.sums).for_each(|(sum, other)| *sum += other);
    }

    fn at(&self, a: usize, b: usize) -> f64 {
        self.sums[a * self.columns + b]
    }

    fn targets(&self) -> Range<usize> {
        self.inputs..self.columns
    }

    /// What they were if a difference were put right.
    fn without(&self, difference: Difference, orders: &[Vec<usize>]) -> Self {
        // Each is a sum of two columns at most.
        let one = |column: usize, by: f64| [(column, by), (column, 0.0)];
        let from = |k: usize| match difference {
            Difference::Exchanged([a, b]) if k == a => one(b, 1.0),
            Difference::Exchanged([a, b]) if k == b => one(a, 1.0),
            Difference::Ordered(order) if k < self.inputs => one(orders[order][k], 1.0),
            Difference::Scaled { column, by } if k == column => one(k, 1.0 / by),
            Difference::Turned { columns: [a, b], by_deg } if k == a || k == b => {
                let (sin, cos) = by_deg.to_radians().sin_cos();
                if k == a { [(a, cos), (b, sin)] } else { [(b, cos), (a, -sin)] }
            }
            _ => one(k, 1.0),
        };
        let place = |k: usize| {
            let both = [from(k / self.columns), from(k % self.columns)];
            let parts = both[0].into_iter().flat_map(|one| both[1].map(|other| (one, other)));
            let known = parts.filter(|((_, of_a), (_, of_b))| *of_a != 0.0 && *of_b != 0.0);
            known.map(|((a, of_a), (b, of_b))| of_a * of_b * self.at(a, b)).sum()
        };
        Self { sums: (0..self.sums.len()).map(place).collect(), forces: self.forces.clone(), ..*self }
    }

    /// Weights of the linear model, of each target over the inputs.
    fn model(&self) -> Option<Vec<Vec<f64>>> {
        // Each input over its own spread: one in other units is not lost beside the others.
        let spread: Vec<f64> = (0..self.inputs).map(|k| self.at(k, k).sqrt()).collect();
        let places = (0..self.inputs).flat_map(|a| (0..self.inputs).map(move |b| (a, b)));
        let over = |value: f64, spread: f64| if spread > 0.0 { value / spread } else { 0.0 };
        let alike = places.map(|(a, b)| over(self.at(a, b), spread[a] * spread[b])).collect();
        let factor = Cholesky::of(alike, self.inputs, LEAST)?;
        let weights = self.targets().map(|target| {
            let mut own: Vec<f64> = (0..self.inputs).map(|k| over(self.at(k, target), spread[k])).collect();
            factor.solve(&mut own);
            own.iter().zip(&spread).map(|(own, spread)| over(*own, *spread)).collect()
        });
        Some(weights.collect())
    }

    /// An input with what a model's weights make of all inputs.
    fn with(&self, weights: &[f64], k: usize) -> f64 {
        weights.iter().enumerate().map(|(j, weight)| weight * self.at(j, k)).sum()
    }

    /// What a model's weights make of all inputs, with itself.
    fn modelled(&self, weights: &[f64]) -> f64 {
        weights.iter().enumerate().map(|(k, weight)| weight * self.with(weights, k)).sum()
    }

    /// The share of the targets' variance that a model leaves unexplained, the mean over targets.
    fn unexplained(&self, model: &[Vec<f64>]) -> f64 {
        self.targets().zip(model).map(|(target, weights)| self.unexplained_of(weights, target)).sum::<f64>()
            / model.len() as f64
    }

    /// The same of one target, a column.
    fn unexplained_of(&self, weights: &[f64], target: usize) -> f64 {
        1.0 + (self.modelled(weights) - 2.0 * self.with(weights, target)) / self.at(target, target)
    }

    /// By how much two forces are turned, best, against what a model of the others makes of the inputs.
    fn turn(&self, model: &[Vec<f64>], columns: [usize; 2]) -> Difference {
        let [a, b] = columns;
        let [of_a, of_b] = columns.map(|k| &model[k - self.inputs]);
        let sin = self.with(of_a, b) - self.with(of_b, a);
        let cos = self.with(of_a, a) + self.with(of_b, b);
        Difference::Turned { columns, by_deg: sin.atan2(cos).to_degrees() }
    }

    /// By how much a column differs, best, from what a model of the others makes of the inputs.
    fn scale(&self, model: &[Vec<f64>], column: usize) -> f64 {
        if let Some(weights) = column.checked_sub(self.inputs).map(|target| &model[target]) {
            return self.with(weights, column) / self.modelled(weights);
        }
        let (mut missing, mut own) = (0.0, 0.0);
        for (target, weights) in self.targets().zip(model) {
            let (weight, variance) = (weights[column], self.at(target, target));
            missing += weight * (self.at(column, target) - self.with(weights, column)) / variance;
            own += weight * weight * self.at(column, column) / variance;
        }
        1.0 / (1.0 + missing / own)
    }
}

/// The difference that explains best what a model of the one says wrongly of the other, and what share of the variance
/// is left unexplained without and with it; none where none does clearly, or none is needed.
fn explained(of: &Moments, on: &Moments, orders: &[Vec<usize>]) -> Option<(Difference, f64, f64)> {
    let model = of.model()?;
    let recorded = on.unexplained(&model);
    let each = if orders.is_empty() { 0..on.inputs } else { 0..0 };
    let scaled = each.clone().chain(on.targets());
    let scaled = scaled.map(|column| Difference::Scaled { column, by: on.scale(&model, column) });
    let exchanged = pairs(each).chain(pairs(on.targets())).map(Difference::Exchanged);
    let ordered = (0..orders.len()).map(Difference::Ordered);
    // A picture that is turned is like forces that are.
    let turned = pairs_of(&on.forces).filter(|_| orders.is_empty()).map(|columns| on.turn(&model, columns));
    let put_right = |difference: Difference| (difference, on.without(difference, orders).unexplained(&model));
    let all = exchanged.chain(scaled).chain(ordered).chain(turned);
    let (difference, mended) = best(all.map(put_right).collect(), recorded)?;
    is_other(difference).then_some((difference, recorded, mended))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows of each part.
    const EACH: usize = 400;

    /// Parts of one finger's touch, of photodiodes that answer not quite linearly; each part has its own path, offsets
    /// and gains near 1.
    fn touched(parts: usize) -> [Array2<f64>; 2] {
        let force = |part: usize, row: usize| {
            let t = 0.04 * row as f64 + 37.0 * part as f64;
            [(0.9 * t).sin(), (0.53 * t).cos(), -2.0 + (1.31 * t).sin() + 0.4 * (0.21 * t).cos()]
        };
        let of_row = |k: usize| (k / EACH, force(k / EACH, k % EACH));
        let x = Array2::from_shape_fn((parts * EACH, 5), |(row, input)| {
            let (part, [fx, fy, fz]) = of_row(row);
            let own = [fx - 0.4 * fz, fy + 0.5 * fz, fx + fy, 0.7 * fz - fx, 0.8 * fy - 0.6 * fx][input];
            let noise = ((row * (7 + input)) % 11) as f64 - 5.0;
            let gain = 1.0 + 0.03 * ((part + input) % 3) as f64;
            2.0 + 0.1 * (part + input) as f64 + 0.2 * gain * (own + 0.05 * own * own) + 0.002 * noise
        });
        let y = Array2::from_shape_fn((parts * EACH, 3), |(row, target)| of_row(row).1[target]);
        [x, y]
    }

    /// The second part is of another finger: each photodiode sees other forces.
    fn touched_by_two(parts: usize) -> [Array2<f64>; 2] {
        let [mut x, y] = touched(parts);
        for row in EACH..2 * EACH {
            let own: Vec<f64> = x.row(row).to_vec();
            (0..5).for_each(|k| x[[row, k]] = own[(k + 1) % 5] - 0.7 * own[(k + 3) % 5]);
        }
        [x, y]
    }

    fn dataset([x, y]: [Array2<f64>; 2]) -> (Dataset, Vec<Range<usize>>) {
        let parts: Vec<Range<usize>> = (0..x.nrows() / EACH).map(|k| k * EACH..(k + 1) * EACH).collect();
        let recordings = (0..).zip(&parts).map(|(k, rows)| Recording::of(k.to_string(), rows.clone())).collect();
        let inputs = (1..=x.ncols()).map(|k| format!("P{k}")).collect();
        let targets = ["Fx_N", "Fy_N", "Fz_N"].map(str::to_owned).to_vec();
        (Dataset::with_hidden(inputs, targets, vec![0.0; x.nrows()], x, y, recordings).unwrap(), parts)
    }

    fn found(columns: [Array2<f64>; 2]) -> Vec<Mismatch> {
        let (data, parts) = dataset(columns);
        Parts::of(&data, &parts).map_or_else(Vec::new, |parts| parts.mismatches(&[]))
    }

    /// The rows of a part, with a difference made in its columns.
    fn changed([mut x, mut y]: [Array2<f64>; 2], part: usize, difference: Difference) -> [Array2<f64>; 2] {
        for row in part * EACH..(part + 1) * EACH {
            match difference {
                Difference::Exchanged([a, b]) if a < 5 => x.swap([row, a], [row, b]),
                Difference::Exchanged([a, b]) => y.swap([row, a - 5], [row, b - 5]),
                Difference::Scaled { column, by } if column < 5 => x[[row, column]] *= by,
                Difference::Scaled { column, by } => y[[row, column - 5]] *= by,
                Difference::Ordered(_) => x.row_mut(row).as_slice_mut().unwrap().reverse(),
                Difference::Turned { columns, by_deg } => {
                    let (sin, cos) = by_deg.to_radians().sin_cos();
                    let [a, b] = columns.map(|column| column - 5);
                    let (along, across) = (y[[row, a]], y[[row, b]]);
                    (y[[row, a]], y[[row, b]]) = (cos * along - sin * across, sin * along + cos * across);
                }
            }
        }
        [x, y]
    }

    #[test]
    fn what_differs_in_one_part_is_found() {
        let scaled = |column, by| Difference::Scaled { column, by };
        let exchanged = [[0, 1], [2, 4], [5, 7], [6, 7]].map(Difference::Exchanged);
        let others = [scaled(3, -1.0), scaled(1, 1000.0), scaled(5, -1.0), scaled(7, 9.81)];
        let turned = [([5, 6], 30.0), ([5, 6], 90.0), ([5, 6], -135.0), ([5, 6], 180.0), ([6, 7], 40.0)];
        let turned = turned.map(|(columns, by_deg)| Difference::Turned { columns, by_deg });
        for made in exchanged.into_iter().chain(others).chain(turned) {
            for parts in [2, 3, 5] {
                let all = found(changed(touched(parts), 1, made));
                let one = all.iter().find(|one| one.part == 1);
                let one = one.unwrap_or_else(|| panic!("{made:?} of {parts} parts isn't found: {all:?}"));
                match (one.difference, made) {
                    (Difference::Scaled { column, by }, Difference::Scaled { column: own, by: made }) => {
                        assert_eq!(column, own);
                        assert!((by / made - 1.0).abs() < 0.2, "{by} for {made}");
                    }
                    (Difference::Turned { columns, by_deg }, Difference::Turned { columns: own, by_deg: made }) => {
                        assert_eq!(columns, own);
                        assert!(((by_deg - made + 180.0).rem_euclid(360.0) - 180.0).abs() < 5.0, "{by_deg} for {made}");
                    }
                    (one, made) => assert_eq!(one, made),
                }
                assert!(one.mended < 0.1 && one.recorded > 2.0 * one.mended, "{one:?}");
                // Of two, either may be wrong; of more, those that agree are right.
                assert_eq!(all.len(), if parts == 2 { 2 } else { 1 }, "{all:?}");
            }
        }
        // A gain matters less, where others see the same forces.
        let [one, other] = found(changed(touched(2), 1, scaled(2, 2.0)))[..] else { panic!("no gain is found") };
        let by = [one, other].map(|one| match one.difference {
            Difference::Scaled { column: 2, by } => by,
            other => panic!("{other:?}"),
        });
        assert!((by[0] / 0.5 - 1.0).abs() < 0.2 && (by[1] / 2.0 - 1.0).abs() < 0.2, "{by:?}");
    }

    #[test]
    fn parts_of_several_persons_are_apart() {
        let of = |columns: [Array2<f64>; 2]| {
            let (data, parts) = dataset(columns);
            Parts::of(&data, &parts)?.apart()
        };
        assert_eq!(of(touched(1)), None);
        assert_eq!(of(touched(3)), None);
        let found = of(touched_by_two(3)).unwrap();
        assert!(found.times > 2.0, "{found:?}");
    }

    #[test]
    fn inputs_in_an_order_that_is_looked_for_are_found() {
        let orders = [vec![1, 0, 2, 3, 4], vec![4, 3, 2, 1, 0]];
        let said = |columns: [Array2<f64>; 2], orders: &[Vec<usize>]| {
            let (data, parts) = dataset(columns);
            let all = Parts::of(&data, &parts).unwrap().mismatches(orders);
            all.iter().map(|one| (one.part, one.difference)).collect::<Vec<_>>()
        };
        let made = Difference::Ordered(1);
        assert_eq!(said(changed(touched(3), 1, made), &orders), [(1, made)]);
        assert_eq!(said(changed(touched(3), 1, made), &[]), [], "two exchanged at once");
        assert_eq!(said(touched(3), &orders), []);
        // Targets are looked at as ever, single inputs are not.
        let [target, input] = [[5, 7], [2, 4]].map(Difference::Exchanged);
        assert_eq!(said(changed(touched(3), 1, target), &orders), [(1, target)]);
        assert_eq!(said(changed(touched(3), 1, input), &orders), []);
    }

    #[test]
    fn a_recording_in_another_order_or_on_other_axes_than_the_models_is_found() {
        // The model is of other days: their offsets and gains differ.
        let (trained, _) = dataset(touched(1));
        let model = Moments::of(&trained, &(0..EACH)).model().unwrap();
        let weights = Array2::from_shape_fn((5, 3), |(input, target)| model[target][input]);
        let said = |columns: [Array2<f64>; 2]| {
            let (data, _) = dataset(columns);
            let answer = |order: &[usize]| Some(data.only_inputs(order).x().dot(&weights));
            beside_model(&data, &data.x().dot(&weights), 5, answer)
        };
        assert_eq!(said(touched(3)), []);
        for pair in [[0, 1], [2, 4], [5, 7], [6, 7]] {
            let all = said(changed(touched(3), 1, Difference::Exchanged(pair)));
            let [Mismatch { part: 1, difference, recorded, mended }] = all[..] else { panic!("{pair:?}: {all:?}") };
            assert_eq!(difference, Difference::Exchanged(pair));
            assert!(mended < 0.1 && recorded > 2.0 * mended, "{all:?}");
        }
        for by_deg in [30.0, -90.0, 180.0] {
            let made = Difference::Turned { columns: [5, 6], by_deg };
            let all = said(changed(touched(3), 1, made));
            let [Mismatch { part: 1, difference: Difference::Turned { columns, by_deg: found }, .. }] = all[..] else {
                panic!("{made:?}: {all:?}")
            };
            assert_eq!(columns, [5, 6]);
            assert!(((found - by_deg + 180.0).rem_euclid(360.0) - 180.0).abs() < 5.0, "{found} for {by_deg}");
        }
        let little = Difference::Turned { columns: [5, 6], by_deg: 8.0 };
        assert_eq!(said(changed(touched(3), 1, little)), [], "a transducer that was mounted again");
        assert_eq!(said(changed(touched(3), 1, Difference::Scaled { column: 2, by: 2.0 })), [], "no exchange");
        let negated = changed(touched(3), 1, Difference::Scaled { column: 5, by: -1.0 });
        assert_eq!(said(negated), [], "a force, no exchange");
        let [x, mut y] = changed(touched(3), 1, Difference::Exchanged([0, 1]));
        y.column_mut(1).fill(0.0);
        assert_eq!(said([x, y]), [], "a target that does not change");
    }

    #[test]
    fn parts_that_agree_or_say_too_little_are_no_mismatch() {
        assert_eq!(found(touched(3)), []);
        let gain = |by| found(changed(touched(2), 1, Difference::Scaled { column: 2, by }));
        assert_eq!(gain(1.3), [], "a sensor that was put on again");
        let wrong = || changed(touched(2), 1, Difference::Exchanged([0, 1]));
        assert_eq!(found(wrong()).len(), 2);
        assert_eq!(found(touched_by_two(2)), []);
        // A dead photodiode, a target that does not change, hidden inputs.
        let [mut x, y] = wrong();
        x.column_mut(3).fill(2.5);
        assert_eq!(found([x, y]).len(), 2, "the other photodiodes still say it");
        let [x, mut y] = wrong();
        y.column_mut(1).fill(0.0);
        assert_eq!(found([x, y]), []);
        let [mut x, y] = wrong();
        x[[EACH + 3, 2]] = f64::NAN;
        assert_eq!(found([x, y]), []);
    }
}
