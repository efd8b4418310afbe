//! Against scikit-learn on shared matrices, and on a nail whose forces are known.

mod phantom;

use ndarray::{Array2, Axis};

use super::*;
use crate::{Kind, Predictor, Process, Recipe};
use phantom::{Nail, Path, ROWS, SIDE};

/// Largest gap found to scikit-learn: 2e-12 (a process with noise of 1e-4).
const SCIKIT: f64 = 1e-9;

fn scikit() -> serde_json::Value {
    serde_json::from_str(include_str!("scikit.json")).unwrap()
}

fn numbers(value: &serde_json::Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect()
}

fn matrix(value: &serde_json::Value) -> Array2<f64> {
    let rows: Vec<Vec<f64>> = value.as_array().unwrap().iter().map(numbers).collect();
    Array2::from_shape_fn((rows.len(), rows[0].len()), |(i, j)| rows[i][j])
}

fn near(ours: f64, theirs: f64, what: &str) {
    assert!((ours - theirs).abs() <= SCIKIT * theirs.abs().max(1.0), "{what}: {ours} and {theirs}");
}

#[test]
fn ridge_is_that_of_scikit_learn() {
    let all = scikit();
    let (x, y) = (matrix(&all["x"]), matrix(&all["y"]));
    let every: Vec<usize> = (0..x.nrows()).collect();
    let whole = ridge::Moments::of(x.view(), y.view(), &every);
    let groups = numbers(&all["groups"]);
    let cases = all["ridge"].as_array().unwrap();
    assert_eq!(cases.len(), 3);
    for case in cases {
        let alpha = case["alpha"].as_f64().unwrap();
        let fits = whole.solve(4, alpha).unwrap();
        let (coefficients, offset) = (matrix(&case["coefficients"]), numbers(&case["offset"]));
        for (target, (b, at)) in fits.iter().enumerate() {
            near(*at, offset[target], "offset");
            b.iter().zip(coefficients.row(target)).for_each(|(ours, theirs)| near(*ours, *theirs, "coefficient"));
        }
        let left_out = matrix(&case["left_out"]);
        for group in 0..5 {
            let rows: Vec<usize> = every.iter().copied().filter(|&row| groups[row] == f64::from(group)).collect();
            let rest = whole.without(&ridge::Moments::of(x.view(), y.view(), &rows)).solve(4, alpha).unwrap();
            for &row in &rows {
                for (target, (b, offset)) in rest.iter().enumerate() {
                    let ours = offset + b.iter().zip(x.row(row)).map(|(b, x)| b * x).sum::<f64>();
                    near(ours, left_out[[row, target]], "left out");
                }
            }
        }
    }
}

#[test]
fn the_process_is_that_of_scikit_learn() {
    let all = scikit();
    let (x, y, at) = (matrix(&all["x"]), matrix(&all["y"]), matrix(&all["at"]));
    let cases = all["process"].as_array().unwrap();
    assert_eq!(cases.len(), 3);
    for case in cases {
        let of = |name: &str| case[name].as_f64().unwrap();
        let one = Covariance { amplitude: of("amplitude"), length: of("length"), noise: of("noise"), widened: 1.0 };
        let ours = Process::new(x.clone(), y.clone(), vec![one; 2], &[1.0; 4]).unwrap();
        // Cells that are the scores themselves.
        let basis = Basis::new(vec![0.0; 4], Array2::eye(4), vec![1.0; 4], 0.0).unwrap();
        let model = Eigennails::new(basis, Regression::Process(ours), vec![[-9.0, 9.0]; 4]).unwrap();
        let (means, sds) = (model.predict(at.view()), model.sd(at.view()));
        for target in 0..2 {
            let theirs = |name: &str| numbers(&case[name][target]);
            for (row, (mean, sd)) in theirs("means").iter().zip(theirs("sds")).enumerate() {
                near(means[[row, target]], *mean, "mean");
                near(sds[[row, target]], sd, "SD");
            }
            let column = y.column(target).to_vec();
            let ours = process::log_likelihood_of(&x, &column, &one);
            near(ours, case["likelihoods"][target].as_f64().unwrap(), "likelihood");
        }
    }
}

#[test]
fn the_discriminant_is_that_of_scikit_learn() {
    let all = scikit();
    let (x, at) = (matrix(&all["x"]), matrix(&all["at"]));
    let labels: Vec<Option<usize>> = numbers(&all["labels"]).iter().map(|label| Some(*label as usize)).collect();
    let every: Vec<usize> = (0..x.nrows()).collect();
    let found = directions::Discriminant::fit(&x, &labels, &every).unwrap();
    let theirs = matrix(&all["log_shares"]);
    for (row, theirs) in at.rows().into_iter().zip(theirs.rows()) {
        let ours = found.log_likelihoods(row);
        let sum = ours.iter().map(|one| one.exp()).sum::<f64>().ln();
        ours.iter().zip(theirs).for_each(|(ours, theirs)| near(ours - sum, *theirs, "log share"));
    }
}

/// RMSE of each target and the share within 1.96 SD.
fn judged(model: &Eigennails, data: &Dataset) -> ([f64; 3], [f64; 3]) {
    let errors = model.predict(data.x().view()) - data.y();
    let sds = model.sd(data.x().view());
    let rows = data.rows() as f64;
    let of = |target: usize| errors.column(target).iter().map(|e| e * e).sum::<f64>();
    let within = |target: usize| {
        let pairs = errors.column(target).into_iter().zip(sds.column(target));
        pairs.filter(|(e, sd)| e.abs() <= 1.96 * **sd).count() as f64 / rows
    };
    ([0, 1, 2].map(|k| (of(k) / rows).sqrt()), [0, 1, 2].map(within))
}

#[test]
fn intervals_of_a_process_hold_on_held_out_trajectories() {
    for seed in 1..=3 {
        let nail = Nail::new(seed);
        let train = nail.film(&[Path::Spiral(0), Path::Spiral(1), Path::Random(2), Path::Random(3)]);
        let test = nail.film(&[Path::Spiral(4), Path::Random(5), Path::Random(6)]);
        for on_scores in [OnScores::Ridge, OnScores::Process] {
            let (model, report) = fit_eigennails(&train, on_scores, None).unwrap();
            assert_eq!((report.left_out.as_str(), report.rows, report.hidden), ("paths", 1200, 0));
            let (rmse, within) = judged(&model, &test);
            // Measured 0.19 to 0.31 N; forces have SDs of 0.8 to 1.4 N.
            assert!(rmse.iter().all(|rmse| *rmse <= 0.35), "{seed} {on_scores:?}: {rmse:?}");
            // Measured 0.902 to 0.972; of ridge, whose SD is that of all rows alike, 0.899 to 0.958.
            let least = if on_scores == OnScores::Process { 0.9 } else { 0.87 };
            assert!(within.iter().all(|share| (least..=0.98).contains(share)), "{seed} {on_scores:?}: {within:?}");
        }
    }
}

#[test]
fn far_from_all_rows_a_process_says_that_it_is_lost() {
    let nail = Nail::new(1);
    let train = nail.film(&[Path::Spiral(0), Path::Random(2)]);
    let (model, _) = fit_eigennails(&train, OnScores::Process, Some(6)).unwrap();
    let usual = model.sd(train.x().view()).mean_axis(Axis(0)).unwrap();
    // Another light: all cells far brighter.
    let other = train.x().mapv(|cell| 3.0 * cell);
    let lost = model.sd(other.view()).mean_axis(Axis(0)).unwrap();
    assert!(lost.iter().zip(&usual).all(|(lost, usual)| *lost > 3.0 * usual), "{lost} and {usual}");
    assert!(model.is_outside(&other.row(0).to_vec()) && !model.is_outside(&train.x().row(40).to_vec()));
}

#[test]
fn hidden_cells_widen_the_interval_and_keep_the_answer() {
    let nail = Nail::new(2);
    let train = nail.film(&[Path::Spiral(0), Path::Random(2)]);
    let mut x = nail.film(&[Path::Random(5)]).x().clone();
    for on_scores in [OnScores::Ridge, OnScores::Process] {
        let (model, _) = fit_eigennails(&train, on_scores, Some(8)).unwrap();
        let (whole, sd) = (model.predict(x.view()), model.sd(x.view()));
        // A rod over two rows of cells at the tip.
        let mut hidden = x.clone();
        hidden.slice_axis_mut(Axis(1), (0..24).into()).fill(f64::NAN);
        let (part, wider) = (model.predict(hidden.view()), model.sd(hidden.view()));
        let more = wider.mean_axis(Axis(0)).unwrap() / sd.mean_axis(Axis(0)).unwrap();
        // The tip says little of Fx (measured 1.000) and more of Fz (1.05 and 1.2).
        assert!(more.iter().all(|more| (0.999..2.0).contains(more)) && more[2] > 1.02, "{on_scores:?}: {more}");
        let far = (&part - &whole).iter().zip(&wider).filter(|(apart, sd)| apart.abs() > 2.0 * **sd).count();
        assert!(20 * far <= part.len(), "{on_scores:?}: {far} of {}", part.len());
        hidden.slice_axis_mut(Axis(1), (0..80).into()).fill(f64::NAN);
        assert!(model.predict(hidden.view()).iter().chain(&model.sd(hidden.view())).all(|value| value.is_nan()));
    }
    // Trained on, rows that lack cells are left out and counted.
    x.slice_axis_mut(Axis(0), (0..200).into()).column_mut(5).fill(f64::NAN);
    let film = nail.film(&[Path::Random(5)]);
    let set = |x: &Array2<f64>| {
        let names = |all: &[String]| all.to_vec();
        let (time, recordings) = (film.time_s().to_vec(), film.recordings().to_vec());
        let (inputs, targets) = (names(film.inputs()), names(film.targets()));
        Dataset::with_hidden(inputs, targets, time, x.clone(), film.y().clone(), recordings).unwrap()
    };
    let (_, report) = fit_eigennails(&set(&x), OnScores::Ridge, None).unwrap();
    assert_eq!((report.rows, report.hidden, report.left_out.as_str()), (100, 200, "blocks of time"));
    assert!(report.warnings[0].contains("200 of 300 rows lack a cell"), "{:?}", report.warnings);
    x.column_mut(5).fill(f64::NAN);
    let says = fit_eigennails(&set(&x), OnScores::Ridge, None).unwrap_err().to_string();
    assert!(says.contains("0 of 300 rows have all cells") && says.contains("C_00_05 is hidden in 300"), "{says}");
}

#[test]
fn six_directions_are_recognized() {
    let data = Nail::new(3).film(&[Path::Directions(0), Path::Directions(1), Path::Directions(2)]);
    let (_, report) = fit_eigennails(&data, OnScores::Ridge, None).unwrap();
    let found = report.directions.unwrap();
    assert_eq!(found.classes, ["none", "press", "+Fx", "-Fx", "+Fy", "-Fy"]);
    // Measured 0.93: each hold begins with blood that is still on its way.
    assert!(found.accuracy >= 0.85 && found.guess < 0.5, "{found:?}");
    assert_eq!(found.confusion.iter().flatten().sum::<usize>(), found.rows.iter().sum::<usize>());
}

#[test]
fn one_direction_few_rows_and_a_constant_nail() {
    let film = Nail::new(1).film(&[Path::Spiral(0)]);
    // The beginning of the spiral is one straight press.
    let start = film.only_rows(&(0..12).collect::<Vec<_>>());
    let few = film.only_rows(&(0..9).collect::<Vec<_>>());
    let set = |x: Array2<f64>, y: Array2<f64>| {
        Dataset::plain(film.inputs().to_vec(), film.targets().to_vec(), x, y, 0.1).unwrap()
    };
    let constant = set(Array2::from_elem((ROWS, SIDE * SIDE), 0.1), film.y().clone());
    let shaded = Array2::from_shape_fn((ROWS, SIDE * SIDE), |(_, cell)| 50.3 + 0.7 * cell as f64);
    let shaded = set(shaded, film.y().clone());
    for on_scores in [OnScores::Ridge, OnScores::Process] {
        let (model, report) = fit_eigennails(&start, on_scores, Some(16)).unwrap();
        assert_eq!(report.modes, 11, "twelve centred rows");
        let words = "16 modes were asked for, and 12 rows of 144 cells determine 11";
        assert!(report.warnings.iter().any(|one| one.contains(words)), "{on_scores:?}: {:?}", report.warnings);
        let (forces, sds) = (model.predict(start.x().view()), model.sd(start.x().view()));
        assert!(forces.iter().chain(&sds).all(|value| value.is_finite()), "{on_scores:?}");
        assert!(report.directions.is_none() && report.no_directions.unwrap().contains("of one, press"));
        let says = fit_eigennails(&few, on_scores, None).unwrap_err().to_string();
        assert!(says.contains("9 of 9 rows have all cells, and at least 10"), "{says}");
        for still in [&constant, &shaded] {
            assert_eq!(fit_eigennails(still, on_scores, None).unwrap_err(), FitFault::Unchanging);
        }
        // Targets that do not change are predicted as they are.
        let still = set(film.x().clone(), Array2::from_elem((ROWS, 3), -1.25));
        let (model, report) = fit_eigennails(&still, on_scores, None).unwrap();
        let apart = model.predict(film.x().view()).mapv(|value| (value + 1.25).abs());
        assert!(apart.iter().all(|gap| *gap <= 1e-9), "{on_scores:?}");
        assert!(report.warnings[0].contains("Fx_N is -1.25 in all training rows"));
    }
}

#[test]
fn model_files_bring_the_model_back_and_rows_are_those_of_a_batch() {
    let film = Nail::new(1).film(&[Path::Spiral(0), Path::Random(1)]);
    for on_scores in [OnScores::Ridge, OnScores::Process] {
        let recipe = Recipe::new(Kind::Eigennails { on_scores, modes: Some(5) });
        let model = Predictor::fit(&film, None, &recipe).unwrap();
        let again = Predictor::from_json(&model.to_json()).unwrap();
        assert!(!again.edited && again.predictor == model);
        let (_, batch) = model.predict(&film).unwrap();
        let mut row = [0.0; 3];
        again.predictor.predict_row(&film.x().row(77).to_vec(), &mut row);
        assert_eq!(row.to_vec(), batch.row(77).to_vec());
        let damaged = model.to_json().replacen("\"noise\": ", "\"noise\": -", 1);
        assert!(Predictor::from_json(&damaged).unwrap_err().to_string().contains("noise"));
    }
    let lags =
        Recipe { lags_s: vec![0.1], ..Recipe::new(Kind::Eigennails { on_scores: OnScores::Ridge, modes: None }) };
    assert!(Predictor::fit(&film, None, &lags).unwrap_err().to_string().contains("leave out the lags"));
}

#[test]
fn slopes_are_those_of_the_predictions() {
    let film = Nail::new(1).film(&[Path::Spiral(0), Path::Random(1)]);
    for on_scores in [OnScores::Ridge, OnScores::Process] {
        let (model, _) = fit_eigennails(&film, on_scores, Some(5)).unwrap();
        let at = film.x().row(150).to_vec();
        let slopes = model.jacobian_at(&at);
        for cell in [0, 66, 130] {
            let moved = |by: f64| {
                let mut x = at.clone();
                x[cell] += by;
                let mut out = [0.0; 3];
                model.predict_row(&x, &mut out);
                out
            };
            let (up, down) = (moved(1e-4), moved(-1e-4));
            for target in 0..3 {
                let by_steps = (up[target] - down[target]) / 2e-4;
                // Measured 1e-9.
                assert!((slopes[[target, cell]] - by_steps).abs() <= 1e-7, "{on_scores:?} {cell} {target}");
            }
        }
    }
}
