//! What the jobs refuse or warn of, on small recordings.

mod eigennails;

use crate::job::Watch;
use std::fmt::Write as _;
use std::path::PathBuf;

use lunula_predictor::{By, Gate, Kind, OnScores, Recipe};

use super::*;
use crate::trial::Folder;

/// Rows of a force and an angle seen by three photodiodes; `timed`: with a column of times.
pub(crate) fn recording(rows: u32, phase: f64, scale: f64, timed: bool) -> String {
    let mut text = if timed { "time_s," } else { "" }.to_owned() + "P1,P2,P3,Fx_N,Fy_N,Fz_N,J2_deg\n";
    for k in 0..rows {
        let t = f64::from(k) * 0.04;
        let [a, b, c] = [3.1, 5.3, 7.7].map(|rate| (rate * t + phase).sin());
        let noise = [0.01, 0.02].map(|size| size * (97.0 * t + phase).sin());
        let volts = [2.0 + a + noise[0], 2.0 + b - c, 2.0 + c + noise[1]].map(|volt| volt * scale);
        if timed {
            write!(text, "{t},").unwrap();
        }
        writeln!(text, "{:?},{:?},{:?},{a},{b},{},{}", volts[0], volts[1], volts[2], -1.0 - c, 20.0 * b).unwrap();
    }
    text
}

impl Folder {
    /// A recording of 60 rows.
    fn recorded(&self, name: &str, phase: f64, scale: f64, timed: bool) -> PathBuf {
        self.file(name, recording(60, phase, scale, timed))
    }

    /// Two recordings.
    fn two(&self) -> [PathBuf; 2] {
        [self.recorded("a.csv", 0.0, 1.0, true), self.recorded("b.csv", 0.5, 1.0, true)]
    }

    fn train(&self, inputs: &TrainInputs, target: &str, recipe: Recipe) -> Result<(PathBuf, TrainReport), String> {
        let wanted = Wanted { targets: Target::parse(target).unwrap().columns().to_vec(), ..Wanted::default() };
        let model = self.path(&format!("{target}.json"));
        let outputs = TrainOutputs { model: model.clone(), learning_curve: None, merit: None };
        let options = TrainOptions { wanted, recipe, level: 0.9 };
        let report = train(inputs, &options, &outputs, &Watch::nobody()).map_err(|why| why.to_string())?;
        Ok((model, report))
    }
}

fn inputs(data: &[&PathBuf], validate: &[&PathBuf], stop_on: &[&PathBuf]) -> TrainInputs {
    let all = |paths: &[&PathBuf]| paths.iter().map(|path| DataFile::from((*path).clone())).collect();
    TrainInputs { data: all(data), validate: all(validate), stop_on: all(stop_on) }
}

fn linear() -> Recipe {
    Recipe::new(Kind::Linear)
}

#[test]
fn what_is_reported_is_no_place_to_stop() {
    let folder = Folder::new();
    let [a, b] = folder.two();
    let copy = folder.path("copy.csv");
    std::fs::copy(&b, &copy).unwrap();
    let recipe = Recipe { restarts: 1, max_epochs: 3, ..Recipe::new(Kind::Network { hidden: 2 }) };
    let said = folder.train(&inputs(&[&a], &[&b], &[&copy]), "force", recipe).unwrap_err();
    assert!(said.contains("--stop-on and --validate"), "{said}");
}

#[test]
fn a_learning_curve_ends_at_the_model_also_where_it_stops_on_others() {
    let folder = Folder::new();
    let [a, b] = folder.two();
    let [stop, held] =
        [("stop.csv", 0.9), ("held.csv", 1.4)].map(|(name, phase)| folder.recorded(name, phase, 1.0, true));
    let network = Recipe { restarts: 2, max_epochs: 30, ..Recipe::new(Kind::Network { hidden: 2 }) };
    for lags_s in [vec![], vec![0.1]] {
        let curve = folder.path("curve.csv");
        let outputs =
            TrainOutputs { model: folder.path("network.json"), learning_curve: Some(curve.clone()), merit: None };
        let wanted = Wanted { targets: Target::parse("force").unwrap().columns().to_vec(), ..Wanted::default() };
        let options = TrainOptions { wanted, recipe: Recipe { lags_s, ..network.clone() }, level: 0.9 };
        let report = train(&inputs(&[&a, &b], &[&held], &[&stop]), &options, &outputs, &Watch::nobody()).unwrap();
        let text = std::fs::read_to_string(&curve).unwrap();
        let [names, last] = [text.lines().next(), text.lines().last()].map(|line| line.unwrap().split(','));
        let at_end: Vec<(&str, &str)> = names.zip(last).filter(|(name, _)| name.ends_with("_validate_rmse")).collect();
        assert_eq!(at_end.len(), 3, "{text}");
        for ((name, value), (_, rmse)) in at_end.iter().zip(&report.validation.as_ref().unwrap().rmse.0) {
            let value: f64 = value.parse().unwrap();
            assert!((value / rmse - 1.0).abs() <= 1e-6, "{name}: {value} {rmse}");
        }
    }
}

#[test]
fn a_recording_under_two_names_is_told() {
    let folder = Folder::new();
    let [a, b] = folder.two();
    let copy = folder.path("copy.csv");
    std::fs::copy(&a, &copy).unwrap();
    let (model, report) = folder.train(&inputs(&[&a, &copy], &[], &[]), "force", linear()).unwrap();
    assert!(report.warnings.iter().any(|w| w.contains("copy.csv holds the rows of")), "{:?}", report.warnings);
    let options = EvaluateOptions { by: Some(By::Trajectory), ..EvaluateOptions::default() };
    let found = evaluate(&model, &DataFile::of(&[a, copy, b]), &options, None, &Watch::nobody()).unwrap();
    let warned = |words: &str| found.warnings.iter().any(|warning| warning.contains(words));
    assert!(warned("120 of 180 rows stand in other parts as well"), "{:?}", found.warnings);
}

#[test]
fn a_model_of_nothing_and_one_of_several_persons_are_named() {
    let folder = Folder::new();
    let [a, b] = folder.two();
    let of = |inputs: &TrainInputs| folder.train(inputs, "force", linear()).unwrap().1;
    let own = of(&inputs(&[&a, &b], &[], &[]));
    assert!(own.notes.iter().all(|note| !note.contains("persons")), "{:?}", own.notes);
    assert!(own.warnings.iter().all(|said| !said.contains("hardly anything")), "{:?}", own.warnings);
    let mut both = inputs(&[&a, &b], &[], &[]);
    both.data.iter_mut().zip(["anna", "ben"]).for_each(|(file, who)| file.subject = Some(who.to_owned()));
    let notes = of(&both).notes;
    assert!(notes.iter().any(|note| note.starts_with("one model of 2 persons (anna, ben): ")), "{notes:?}");
    // What a transducer says that nobody touches.
    let still = recording(600, 0.0, 1.0, true).lines().enumerate().fold(String::new(), |text, (k, line)| {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        if k > 0 {
            (4..7).for_each(|at| cells[at] = format!("{}", 1e-3 * f64::from((k * k * at) as u32 % 17)));
        }
        text + &cells.join(",") + "\n"
    });
    let warnings = of(&inputs(&[&folder.file("still.csv", still)], &[], &[])).warnings;
    assert!(warnings.iter().any(|said| said.contains("explains hardly anything")), "{warnings:?}");
}

#[test]
fn predictions_beyond_a_number_are_no_success() {
    let folder = Folder::new();
    let (a, huge) = (folder.recorded("a.csv", 0.0, 1e-300, true), folder.recorded("b.csv", 0.5, 1e300, true));
    let (model, report) = folder.train(&inputs(&[&a], &[&huge], &[]), "force", linear()).unwrap();
    assert!(report.warnings.iter().any(|w| w.contains("beyond 1e308")), "{:?}", report.warnings);
    let options = EvaluateOptions::default();
    let said = evaluate(&model, &[huge.into()], &options, None, &Watch::nobody()).unwrap_err().to_string();
    assert!(said.contains("60 of 60 rows is beyond 1e308"), "{said}");
}

fn options() -> PredictOptions {
    let gate = Gate::new(0.5, 0.0, 0.0).unwrap();
    PredictOptions { gate, intervals: true, rows: RowOptions::default() }
}

#[test]
fn lags_without_times_are_refused() {
    let folder = Folder::new();
    let (a, b) = (folder.recorded("a.csv", 0.0, 1.0, true), folder.recorded("b.csv", 0.5, 1.0, false));
    let recipe = Recipe { lags_s: vec![0.1], ..linear() };
    let c = folder.recorded("c.csv", 0.9, 1.0, true);
    let (model, _) = folder.train(&inputs(&[&a], &[&c], &[]), "force", recipe).unwrap();
    let said = predict(std::slice::from_ref(&model), &b, &options(), &folder.path("p.csv"), &Watch::nobody())
        .unwrap_err()
        .to_string();
    assert!(said.contains("b.csv: has no time_s"), "{said}");
}

#[test]
fn an_angle_that_the_gate_rules_has_no_interval() {
    let folder = Folder::new();
    let [a, b] = folder.two();
    let models =
        ["force", "posture"].map(|target| folder.train(&inputs(&[&a], &[&b], &[]), target, linear()).unwrap().0);
    predict(&models, &b, &options(), &folder.path("p.csv"), &Watch::nobody()).unwrap();
    let text = std::fs::read_to_string(folder.path("p.csv")).unwrap();
    let rows: Vec<Vec<&str>> = text.lines().skip(1).map(|line| line.split(',').collect()).collect();
    let mut seen = [0, 0];
    for row in &rows {
        let touches = row[row.len() - 1] == "touch";
        assert_eq!([row[11], row[12]].map(str::is_empty), [touches; 2], "{row:?}");
        assert!(!row[5].is_empty());
        seen[usize::from(touches)] += 1;
    }
    assert!(seen[0] > 5 && seen[1] > 5, "{seen:?}");
}
