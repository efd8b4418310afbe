//! What makes a model's answers to a recording doubtful: that they are no better than the mean of what was measured,
//! and what they look like then, or much better with two columns exchanged; and, of answers that nothing was measured
//! for, voltages that it was not trained on.

use lunula_predictor::{Dataset, FrictionCone, Mismatch, Predictor, beside_model};
use ndarray::{Array2, ArrayView1, ArrayView2};

use crate::median::ends;
use crate::predictor::data::looks;
use crate::words::grouped;

/// The share of rows outside of what was trained on from which it is said (assumed).
const OUTSIDE: f64 = 0.05;
/// Of fewer rows, and of a target that varies by less of its own square (rounding), nothing is said.
const ROWS: usize = 10;
/// A force this far outside of a cone of friction is none of noise, newtons (assumed).
const FAR_N: f64 = 0.1;
const CONSTANT: f64 = 1e-24;
/// Answers follow what was measured where they share so much of its variance (assumed) ...
const FOLLOWS: f64 = 0.8;
/// ... in another unit where they are so many times as large, or as small (assumed), ...
const OTHER_UNIT: f64 = 3.0;
/// ... or by so much, where a factor alone leaves so little of the errors of an offset alone (assumed: a sensor that is
/// put on again changes its gains by less).
const OTHER_GAIN: f64 = 1.7;
const FACTOR: f64 = 0.5;

/// What to say of answers to a recording: `data` are its rows, `seen` those with lags that were answered by `values`.
pub(in crate::predictor) fn doubts(
    predictor: &Predictor,
    data: &Dataset,
    seen: &Dataset,
    values: &Array2<f64>,
) -> Vec<String> {
    // Targets that go astray alike are one warning.
    let alike = grouped(seen.targets().iter().enumerate().filter_map(|(k, target)| {
        let trained = predictor.targets().get(k).map(|channel| channel.high - channel.low);
        Some((astray(seen.y().column(k), values.column(k), trained)?, target.as_str()))
    }));
    let mut doubts: Vec<String> =
        alike.iter().map(|(looks, targets)| format!("{}: {looks}", targets.join(", "))).collect();
    if !doubts.is_empty() {
        let outside = data.x().outer_iter().filter(|row| predictor.is_outside(&row.to_vec())).count();
        doubts.extend(extrapolated(outside as u64, data.rows() as u64));
    }
    doubts.extend(on_other_columns(predictor, data, seen, values));
    doubts
}

/// What to say of forces that were measured outside of the cone into which predicted ones are brought.
pub(in crate::predictor) fn outside_cone(cone: &FrictionCone, forces_n: ArrayView2<f64>) -> Option<String> {
    let far = |force: &[f64; 3]| {
        let gaps = cone.nearest(*force).into_iter().zip(force).map(|(near, own)| near - own);
        gaps.map(|gap| gap * gap).sum::<f64>().sqrt() > FAR_N
    };
    let forces = forces_n.outer_iter().map(|row| [row[0], row[1], row[2]]);
    let known: Vec<[f64; 3]> = forces.filter(|force| force.iter().all(|value| value.is_finite())).collect();
    let outside = known.iter().filter(|force| far(force)).count();
    (known.len() >= ROWS && outside as f64 > OUTSIDE * known.len() as f64).then(|| {
        format!(
            "{:.0} % of the measured forces lie outside of the cone of friction by more than {FAR_N} N, where no \
             prediction can follow them: is --friction this surface's coefficient, or are signs or columns others?",
            100.0 * outside as f64 / known.len() as f64
        )
    })
}

/// What to say of recordings whose columns stand in another order than those that a model was trained on, or whose
/// forces lie along other axes.
fn on_other_columns(predictor: &Predictor, data: &Dataset, seen: &Dataset, values: &Array2<f64>) -> Vec<String> {
    let answer = |order: &[usize]| Some(predictor.predict(&data.only_inputs(order)).ok()?.1);
    let columns: Vec<&str> = data.inputs().iter().chain(data.targets()).map(String::as_str).collect();
    let say = |one: Mismatch| {
        format!(
            "{}: {}, here or where the model was trained: put right it leaves {:.0} % of the variance unexplained \
             instead of {:.0} %",
            seen.recordings()[one.part].name,
            looks(one.difference, &columns, false),
            100.0 * one.mended,
            100.0 * one.recorded
        )
    };
    beside_model(seen, values, data.inputs().len(), answer).into_iter().map(say).collect()
}

/// What to say where more than a twentieth of the rows are extrapolated.
pub(crate) fn extrapolated(outside: u64, rows: u64) -> Option<String> {
    (outside as f64 > OUTSIDE * rows as f64).then(|| {
        format!(
            "{outside} of {rows} rows lie outside of the voltages that the model was trained on; their predictions \
             are extrapolated"
        )
    })
}

/// What to say of a target that is predicted no better than by its mean, or in another unit; it went over so much in
/// training.
fn astray(measured: ArrayView1<'_, f64>, predicted: ArrayView1<'_, f64>, trained: Option<f64>) -> Option<String> {
    let pairs = measured.iter().copied().zip(predicted.iter().copied());
    let pairs: Vec<(f64, f64)> = pairs.filter(|(m, p)| m.is_finite() && p.is_finite()).collect();
    let count = pairs.len() as f64;
    let total = |of: &dyn Fn(f64, f64) -> f64| pairs.iter().map(|pair| of(pair.0, pair.1)).sum::<f64>();
    let [m, p] = [total(&|m, _| m) / count, total(&|_, p| p) / count];
    let sum = |of: fn(f64, f64) -> f64| total(&|measured, predicted| of(measured - m, predicted - p));
    let [own, other, both] = [sum(|m, _| m * m), sum(|_, p| p * p), sum(|m, p| m * p)];
    let errors = total(&|m, p| (m - p).powi(2));
    if pairs.len() < ROWS || own <= CONSTANT * count * m * m || !errors.is_finite() {
        return None;
    }
    let follows = other > 0.0 && both * both >= FOLLOWS * own * other;
    let is_other = |times: f64, most: f64| !(1.0 / most..=most).contains(&times.abs());
    // By a factor about the means, or by one alone.
    let [mm, mp, pp] = [total(&|m, _| m * m), total(&|m, p| m * p), total(&|_, p| p * p)];
    let by_factor = mm - mp * mp / pp;
    let is_gain = by_factor <= FACTOR * (own - 2.0 * both + other) && by_factor <= (1.0 - FOLLOWS) * own;
    let [about, alone] = [both / other, mp / pp];
    let times = [(about, is_other(about, OTHER_UNIT)), (alone, is_gain && is_other(alone, OTHER_GAIN))];
    if let Some((times, _)) = times.into_iter().find(|(_, is_other)| follows && *is_other) {
        let ends = ends(pairs.iter().map(|(m, _)| *m));
        let as_trained = trained.is_some_and(|trained| !is_other((ends[1] - ends[0]) / trained, OTHER_GAIN));
        let looks = if as_trained {
            ", and goes as far as in training: are the voltages in another unit, or do the recordings that the model \
             was trained on contradict each other?"
        } else {
            ": is it, or are the voltages, in another unit, or has one of them another gain?"
        };
        return Some(format!("what was measured is {times:.3} times what is predicted{looks}"));
    }
    let looks = match (follows, both > 0.0) {
        _ if errors < own => return None,
        (true, true) => {
            format!(
                "it is right but for an offset of {:.3}: was the transducer zeroed, has a photodiode another gain? Or \
                 train on this session too",
                m - p
            )
        }
        (true, false) => "it is right but for the sign: negate what was measured (forces are those of the finger on \
                          the surface)"
            .to_owned(),
        (false, _) => "photodiodes in another order, another sensor or person, or rows of other times?".to_owned(),
    };
    Some(format!("predicted no better than by the mean of what was measured; {looks}"))
}

#[cfg(test)]
mod tests {
    use ndarray::Array1;

    use super::*;

    #[test]
    fn forces_that_no_cone_holds_are_doubted() {
        let slides = |k: usize| [0.5 * (0.2 * k as f64).sin(), 0.2, -1.0 - 0.01 * (k % 50) as f64];
        let forces = Array2::from_shape_fn((200, 3), |(k, j)| slides(k)[j]);
        let said = |mu: f64| outside_cone(&FrictionCone::new(mu).expect("a coefficient"), forces.view());
        assert_eq!(said(0.8), None);
        assert!(said(0.1).is_some_and(|said| said.contains("% of the measured forces lie outside")));
    }

    #[test]
    fn what_goes_astray_says_what_it_looks_like() {
        let force: Array1<f64> = (0..300).map(|k| -3.0 + 2.0 * (0.1 * f64::from(k)).sin()).collect();
        let said = |of: &dyn Fn(f64) -> f64| astray(force.view(), force.mapv(of).view(), None).unwrap_or_default();
        // A model that learnt little of it: the force itself is as in training.
        let shrunk = force.mapv(|force| -2.8 + 0.1 * force);
        let alike = astray(force.view(), shrunk.view(), Some(4.2)).unwrap_or_default();
        assert!(alike.contains("10.000 times what is predicted, and goes as far as in training"), "{alike}");
        let other = astray(force.view(), shrunk.view(), Some(42.0)).unwrap_or_default();
        assert!(other.contains("is it, or are the voltages, in another unit"), "{other}");
        assert_eq!(said(&|force| force), "");
        assert_eq!(said(&|force| 0.8 * force - 0.5), "");
        assert!(said(&|force| -force).contains("but for the sign"), "{}", said(&|force| -force));
        let grams = said(&|force| 101.97 * force);
        assert!(grams.contains("measured is 0.010 times what is predicted"), "{grams}");
        assert!(said(&|force| -101.97 * force).contains("is -0.010 times"));
        // Of half the size, and twice: no offset.
        for (of, times) in [(2.0, "0.500"), (0.5, "2.000")] {
            let gain = said(&|force| of * force);
            assert!(gain.contains(&format!("measured is {times} times what is predicted")), "{gain}");
        }
        assert_eq!(said(&|force| 0.7 * force), "", "a sensor that was put on again");
        let offset = said(&|force| force + 4.0);
        assert!(offset.contains("an offset of -4.000"), "{offset}");
        assert!(said(&|force| 10.0 * force.powi(2) % 7.0).contains("in another order"));
        // The mean itself is no better than the mean.
        assert!(said(&|_| -3.0).contains("no better than by the mean"));
        assert_eq!(said(&|_| f64::NAN), "", "that there are no answers is said elsewhere");
        // Of a target that does not change but for rounding, and of a few rows, there is nothing to tell.
        let constant = Array1::from_elem(30, 0.1);
        assert_eq!(astray(constant.view(), (&constant + 1.0).view(), None), None);
        assert_eq!(astray(ndarray::arr1(&[1.0, 2.0]).view(), ndarray::arr1(&[2.0, 1.0]).view(), None), None);
    }
}
