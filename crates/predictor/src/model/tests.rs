//! All models against what the equations say, in rows and in batches.

use ndarray::{Array2, ArrayView2, Axis, Slice};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::*;
use crate::algebra::simd::without_vectors;

/// Largest difference to the naive sums found, relative to the size of what is added: 7.3e-16.
const TOLERANCE: f64 = 4e-15;
/// Largest difference of a slope to a central difference of step 1e-5 V found, relative to the largest slope: 5.4e-10.
const SLOPE: f64 = 2e-8;

/// A model of each kind with random numbers.
fn some(inputs: usize, nodes: usize, targets: usize, seed: u64) -> [Model; 3] {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut matrix = |rows, columns| Array2::from_shape_simple_fn((rows, columns), || random.random_range(-1.0..1.0));
    let mut row = |n, centre: f64| (matrix(1, n) * 0.1 + centre).into_raw_vec_and_offset().0;
    let (centre, offset, biases) = (row(inputs, 3.0), row(targets, -1.0), row(nodes, 0.2));
    let scale = |i: usize| 2_f64.powi(-(i as i32 % 4));
    let scales: Vec<f64> = (0..inputs).map(scale).collect();
    let terms = inputs + inputs * (inputs + 1) / 2;
    [
        Model::Linear(Linear::new(centre.clone(), offset.clone(), matrix(targets, inputs)).unwrap()),
        Model::Quadratic(
            Quadratic::new(centre.clone(), scales.clone(), offset.clone(), matrix(targets, terms)).unwrap(),
        ),
        Model::Network(
            Network::new(
                centre,
                scales,
                matrix(nodes, inputs),
                biases,
                matrix(targets, nodes),
                offset.clone(),
                offset,
                (0..targets).map(|k| 1.5 + k as f64).collect(),
            )
            .unwrap(),
        ),
    ]
}

fn volts(rows: usize, inputs: usize, seed: u64) -> Array2<f64> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    Array2::from_shape_simple_fn((rows, inputs), || random.random_range(2.0..4.0))
}

/// Equations 9, 16, 17 and 18 as they stand, and the size of what is added up.
fn naive(model: &Model, x: &[f64]) -> Vec<(f64, f64)> {
    let sum = |first: f64, terms: Vec<f64>| {
        (first + terms.iter().sum::<f64>(), first.abs() + terms.iter().map(|term| term.abs()).sum::<f64>())
    };
    match model {
        Model::Linear(one) => {
            let term = |k: usize, i: usize| one.jacobian()[[k, i]] * (x[i] - one.centre()[i]);
            (0..one.targets()).map(|k| sum(one.offset()[k], (0..x.len()).map(|i| term(k, i)).collect())).collect()
        }
        Model::Quadratic(one) => {
            let mut terms: Vec<f64> = (0..x.len()).map(|i| (x[i] - one.centre()[i]) / one.scale()[i]).collect();
            let pairs: Vec<f64> = quadratic_terms(x.len()).into_iter().map(|(i, j)| terms[i] * terms[j]).collect();
            terms.extend(pairs);
            let row = |k: usize| one.jacobian().row(k).iter().zip(&terms).map(|(a, b)| a * b).collect();
            (0..one.targets()).map(|k| sum(one.offset()[k], row(k))).collect()
        }
        Model::Network(one) => {
            let node = |j: usize| {
                let term = |i: usize| one.hidden_weights[[j, i]] * (x[i] - one.centre()[i]) / one.scale[i];
                (one.hidden_biases[j] + (0..x.len()).map(term).sum::<f64>()).tanh()
            };
            let target = |k: usize| {
                let terms = (0..one.hidden()).map(|j| one.output_weights[[k, j]] * node(j)).collect();
                let (value, size) = sum(one.output_biases[k], terms);
                let scale = one.target_scale[k];
                (one.target_centre[k] + scale * value, one.target_centre[k].abs() + scale * size)
            };
            (0..one.targets()).map(target).collect()
        }
        Model::Eigennails(_) => unreachable!("not among these"),
    }
}

fn row_by_row(model: &Model, x: ArrayView2<'_, f64>) -> Array2<f64> {
    let mut out = Array2::zeros((x.nrows(), model.targets()));
    for (x, mut out) in x.rows().into_iter().zip(out.rows_mut()) {
        model.predict_row(&x.to_vec(), out.as_slice_mut().unwrap());
    }
    out
}

fn same_bits(one: &Array2<f64>, other: &Array2<f64>) -> bool {
    one.dim() == other.dim()
        && one.iter().zip(other).all(|(one, other)| one.to_bits() == other.to_bits() || one.is_nan() && other.is_nan())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn batch_row_and_equations_agree(
        inputs in 1_usize..12, nodes in 1_usize..20, targets in 1_usize..11, rows in 0_usize..70, seed in 0_u64..1000,
    ) {
        let x = volts(rows, inputs, seed);
        for model in some(inputs, nodes, targets, seed) {
            prop_assert_eq!((model.inputs(), model.targets()), (inputs, targets));
            let batch = model.predict(x.view());
            prop_assert!(same_bits(&batch, &row_by_row(&model, x.view())));
            for (x, batch) in x.rows().into_iter().zip(batch.rows()) {
                for ((value, size), found) in naive(&model, x.as_slice().unwrap()).into_iter().zip(batch) {
                    let error = (found - value).abs() / size;
                    prop_assert!(error <= TOLERANCE, "{} where {} is right: {:e}", found, value, error);
                }
            }
        }
    }
}

#[test]
fn without_vectors_the_bits_are_the_same() {
    for (inputs, nodes, targets) in [(8, 8, 3), (1, 1, 1), (5, 3, 2), (7, 9, 4), (12, 4, 9), (70, 3, 2)] {
        let x = volts(53, inputs, 9);
        for model in some(inputs, nodes, targets, 10) {
            let (batch, rows) = without_vectors(|| (model.predict(x.view()), row_by_row(&model, x.view())));
            assert!(same_bits(&batch, &model.predict(x.view())));
            assert!(same_bits(&rows, &row_by_row(&model, x.view())));
        }
    }
}

#[test]
fn any_layout_gives_the_same_bits() {
    const BACK: Slice = Slice { start: 0, end: None, step: -1 };
    let wide = volts(45, 16, 1);
    for model in some(8, 8, 3, 2) {
        let plain = model.predict(wide.slice_axis(Axis(1), Slice::from(..8)).as_standard_layout().view());
        let mut out = Array2::zeros((3, 45)).reversed_axes();
        model.predict_into(wide.slice_axis(Axis(1), Slice::from(..8)), out.view_mut());
        assert!(same_bits(&out, &plain));
        let columns = wide.slice_axis(Axis(1), Slice::from(..8)).t().as_standard_layout().into_owned();
        assert!(same_bits(&model.predict(columns.t()), &plain));
        let backwards = model.predict(wide.slice_axis(Axis(1), Slice::from(..8)).slice_axis(Axis(0), BACK));
        assert!(same_bits(&backwards.slice_axis(Axis(0), BACK).to_owned(), &plain));
        let mut room = Array2::from_elem((45, 6), 7.0);
        model.predict_into(
            wide.slice_axis(Axis(1), Slice::from(..8)),
            room.slice_axis_mut(Axis(1), Slice::new(0, None, 2)),
        );
        assert!(same_bits(&room.slice_axis(Axis(1), Slice::new(0, None, 2)).to_owned(), &plain));
        assert!(room.slice_axis(Axis(1), Slice::new(1, None, 2)).iter().all(|&value| value == 7.0));
    }
}

#[test]
fn very_wide_models_predict_too() {
    let x = volts(19, 70, 3);
    for model in some(70, 3, 2, 4) {
        assert!(same_bits(&model.predict(x.view()), &row_by_row(&model, x.view())));
    }
}

#[test]
fn what_is_not_a_number_gives_none() {
    for model in some(8, 9, 3, 5) {
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for column in 0..8 {
                let mut x = volts(20, 8, 6);
                let clean = model.predict(x.view());
                x[[11, column]] = bad;
                let found = model.predict(x.view());
                assert!(same_bits(&found, &row_by_row(&model, x.view())));
                for (row, (found, clean)) in found.rows().into_iter().zip(clean.rows()).enumerate() {
                    if row == 11 {
                        assert!(found.iter().all(|value| !value.is_finite()), "{model:?} {found}");
                        assert!(!bad.is_nan() || found.iter().all(|value| value.is_nan()), "{found}");
                    } else {
                        assert_eq!(found, clean);
                    }
                }
            }
        }
    }
}

#[test]
fn slopes_are_those_of_differences() {
    for model in some(5, 7, 3, 7) {
        let x = volts(1, 5, 8).row(0).to_vec();
        let slopes = model.jacobian_at(&x);
        let largest = slopes.iter().fold(0.0_f64, |most, slope| most.max(slope.abs()));
        let step = 1e-5;
        for i in 0..5 {
            let at = |value: f64| {
                let mut x = x.clone();
                x[i] = value;
                model.predict(ArrayView2::from_shape((1, 5), &x).unwrap())
            };
            let differences = (at(x[i] + step) - at(x[i] - step)) / (2.0 * step);
            for (slope, difference) in slopes.column(i).iter().zip(differences.index_axis(Axis(0), 0)) {
                let error = (slope - difference).abs() / largest;
                assert!(error <= SLOPE, "{slope} {difference} {error:e}");
            }
        }
    }
}

/// A network of one input and one target, with these weights of its nodes.
fn narrow(weights: Array2<f64>, [centre, scale, target_scale]: [f64; 3]) -> Result<Network, ModelFault> {
    let nodes = weights.nrows();
    Network::new(
        vec![centre],
        vec![scale],
        weights,
        vec![0.0; nodes],
        Array2::ones((1, nodes)),
        vec![0.0],
        vec![0.0],
        vec![target_scale],
    )
}

#[test]
fn extreme_scales_keep_their_digits() {
    let one = |size: f64| {
        let model = narrow(Array2::ones((1, 1)), [3.0 * size, size, size]);
        let mut out = [0.0];
        model.unwrap().predict_row(&[3.5 * size], &mut out);
        out[0] / size
    };
    for size in [1.0, 1e300, 1e-300] {
        assert!((one(size) / 0.5_f64.tanh() - 1.0).abs() <= TOLERANCE);
    }
}

#[test]
fn numbers_that_are_no_model_are_refused() {
    let network = |nodes: usize, scale: f64, weight: f64, columns: usize| {
        narrow(Array2::from_elem((nodes, columns), weight), [0.0, scale, 1.0])
    };
    assert!(network(1, 1.0, 1.0, 1).is_ok());
    assert_eq!(network(1, 0.0, 1.0, 1), Err(ModelFault::Number("scale")));
    assert_eq!(network(1, 1e-310, 1.0, 1), Err(ModelFault::Number("scale")));
    assert_eq!(network(1, 1.0, f64::NAN, 1), Err(ModelFault::Number("hidden weights")));
    let fault = network(0, 1.0, 1.0, 1).unwrap_err();
    assert_eq!(fault.to_string(), "hidden nodes: 0 where 1 are needed");
    let fault = network(2, 1.0, 1.0, 3).unwrap_err();
    assert_eq!(fault.to_string(), "columns of hidden weights: 3 where 1 are needed");
}
