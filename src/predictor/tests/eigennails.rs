//! Eigennails from tables of cells to predictions, and what splits say of them.

use super::*;
use crate::job::Outputs;

const SIDE: usize = 6;
const ROWS: usize = 150;

impl Folder {
    /// Cells of a nail that follow the forces, the corner cell outside of it; every fifth row lacks the upper row of
    /// cells where `rod`. Forces are those of `forces`, colours those of `colours`: the seeds of their paths.
    fn cells(&self, name: &str, colours: u64, forces: u64, rod: bool) -> PathBuf {
        self.rows_of_cells(ROWS, name, colours, forces, rod)
    }

    fn rows_of_cells(&self, rows: usize, name: &str, colours: u64, forces: u64, rod: bool) -> PathBuf {
        let cells = (0..SIDE * SIDE).map(|k| format!("C_{:02}_{:02}", k / SIDE, k % SIDE));
        let mut text = format!("time_s,{},P1,P2,Fx_N,Fy_N,Fz_N\n", cells.collect::<Vec<_>>().join(","));
        let path = |seed: u64, t: f64, k: u64| -> f64 {
            let seed = seed as f64;
            let one = |j: f64| {
                (0.5 * j * (1.0 + 0.3 * (12.9 * seed + k as f64).sin()) * t + (seed * j).powi(2) + k as f64).sin()
            };
            0.5 * (one(1.0) + one(2.0) + one(3.0))
        };
        for row in 0..rows {
            let t = 0.1 * row as f64;
            let [x, y, z] = [0, 1, 2].map(|k| path(colours, t, k));
            let at = |k: usize| {
                let (u, v) = ((k % SIDE) as f64 - 2.5, 2.5 - (k / SIDE) as f64);
                let noise = ((row * 37 + k) as f64 * 78.233 + colours as f64).sin() * 43_758.545_3;
                50.0 + 3.0 * x * u + 2.0 * y * v + 4.0 * z * (-0.2 * (u * u + v * v)).exp() + 0.2 * noise.fract()
            };
            write!(text, "{t}").unwrap();
            for k in 0..SIDE * SIDE {
                if k == 0 || rod && row % 5 == 0 && k < SIDE {
                    text.push(',');
                } else {
                    write!(text, ",{:?}", at(k)).unwrap();
                }
            }
            let [fx, fy, fz] = [0, 1, 2].map(|k| path(forces, t, k));
            writeln!(text, ",{:?},{:?},{fx},{fy},{}", at(8), at(27), fz - 2.0).unwrap();
        }
        self.file(name, text)
    }

    /// What is said of a third file of cells beside two, its rows, of time, cells and forces, changed.
    fn said_of(&self, change: impl Fn(&[Vec<String>]) -> Vec<Vec<String>>) -> Vec<String> {
        let [a, b, c] = [("a.csv", 1), ("b.csv", 2), ("c.csv", 3)]
            .map(|(name, seed)| self.rows_of_cells(3 * ROWS, name, seed, seed, false));
        let text = std::fs::read_to_string(&c).unwrap();
        let (head, rows) = text.split_once('\n').unwrap();
        let rows: Vec<Vec<String>> = rows.lines().map(|line| line.split(',').map(str::to_owned).collect()).collect();
        let changed: Vec<String> = change(&rows).iter().map(|row| row.join(",") + "\n").collect();
        std::fs::write(&c, format!("{head}\n{}", changed.concat())).unwrap();
        self.nails(&[&a, &b, &c], &[], OnScores::Ridge).unwrap().1.warnings
    }

    fn nails(
        &self,
        data: &[&PathBuf],
        validate: &[&PathBuf],
        on_scores: OnScores,
    ) -> Result<(PathBuf, TrainReport), String> {
        let targets = Target::parse("force").unwrap().columns().to_vec();
        let wanted = Wanted { targets, cells: true, ..Wanted::default() };
        let model = self.path("nails.json");
        let outputs = TrainOutputs { model: model.clone(), learning_curve: None, merit: None };
        let recipe = Recipe::new(Kind::Eigennails { on_scores, modes: None });
        let options = TrainOptions { wanted, recipe, level: 0.9 };
        let report = train(&inputs(data, validate, &[]), &options, &outputs, &Watch::nobody());
        Ok((model, report.map_err(|why| why.to_string())?))
    }
}

fn beside() -> EvaluateOptions {
    let ways = [By::Rows { folds: 5, seed: 1 }, By::Trajectory, By::Path, By::Session, By::Subject];
    EvaluateOptions { splits: Some(ways), ..EvaluateOptions::default() }
}

#[test]
fn cells_are_trained_on_evaluated_and_predicted() {
    let folder = Folder::new();
    let [a, b, held] =
        [("a.csv", 1), ("b.csv", 2), ("held.csv", 3)].map(|(name, seed)| folder.cells(name, seed, seed, false));
    let rod = folder.cells("rod.csv", 4, 4, true);
    for on_scores in [OnScores::Ridge, OnScores::Process] {
        let (model, report) = folder.nails(&[&a, &b], &[&held], on_scores).unwrap();
        assert_eq!(report.inputs.len(), SIDE * SIDE - 1, "the corner is outside of the nail");
        assert!(report.notes[0].contains("35 of 36 cells are used"), "{:?}", report.notes);
        assert!(report.warnings.is_empty(), "{:?}", report.warnings);
        // Measured 0.013 to 0.02 N, and 0.09 of a process off the paths that it has seen; forces have SDs of 0.6 N.
        let rmse = |merit: &Merit| merit.rmse.0.iter().fold(0.0, |most: f64, (_, rmse)| most.max(*rmse));
        assert!(rmse(report.validation.as_ref().unwrap()) < 0.15, "{on_scores:?} {:?}", report.validation);
        let out = Outputs::all(folder.path(&format!("out-{on_scores:?}")));
        let data = DataFile::of(&[held.clone(), rod.clone()]);
        let found = evaluate(&model, &data, &EvaluateOptions::default(), Some(&out), &Watch::nobody()).unwrap();
        assert_eq!(found.merit.rows, 2 * ROWS, "rows that lack cells are predicted");
        assert!(
            found.within_own.as_ref().unwrap().0.iter().all(|(_, share)| share.unwrap() > 0.7),
            "{:?}",
            found.within_own
        );
        for name in ["eigennails.png", "eigennails.svg", "scatter.png"] {
            assert!(out.out.join(name).metadata().unwrap().len() > 500, "{name}");
        }
        let predicted = folder.path("predicted.csv");
        let gate = Gate::new(0.5, 0.0, 0.0).unwrap();
        let options = PredictOptions { gate, intervals: false, rows: RowOptions::default() };
        let report = predict(&[model], &rod, &options, &predicted, &Watch::nobody()).unwrap();
        assert_eq!((report.rows, report.rows_not_known), (ROWS as u64, 0));
        let text = std::fs::read_to_string(&predicted).unwrap();
        let mut lines = text.lines();
        assert_eq!(lines.next(), Some("time_s,Fx_N,Fy_N,Fz_N,Fx_N_sd,Fy_N_sd,Fz_N_sd"));
        // Every fifth row is hidden in part: its SDs are the widest.
        let sds: Vec<f64> = lines.map(|line| line.rsplit(',').next().unwrap().parse().unwrap()).collect();
        let mean = |hidden: bool| {
            let own: Vec<f64> = (0..ROWS).filter(|row| (row % 5 == 0) == hidden).map(|row| sds[row]).collect();
            own.iter().sum::<f64>() / own.len() as f64
        };
        assert!(mean(true) > mean(false), "{on_scores:?}: {} {}", mean(true), mean(false));
    }
}

#[test]
fn labels_of_another_recording_are_named_and_repeated_paths_too() {
    let folder = Folder::new();
    let others: Vec<PathBuf> = (0..6).map(|k| folder.cells(&format!("o{k}.csv"), 10 + k, 40 + k, false)).collect();
    let (model, _) = folder.nails(&others.iter().collect::<Vec<_>>(), &[], OnScores::Ridge).unwrap();
    let out = Outputs::all(folder.path("out"));
    let found = evaluate(&model, &DataFile::of(&others), &beside(), Some(&out), &Watch::nobody()).unwrap();
    let splits = found.splits.as_ref().unwrap();
    let path = splits.ways.iter().find(|split| split.by == By::Path).unwrap();
    let names: Vec<&str> = path.methods.iter().map(|one| one.method.as_str()).collect();
    assert_eq!(names, ["mean", "nearest row", "eigennails", "P1-P2 linear"]);
    for one in &path.methods[1..] {
        assert!(one.targets.iter().all(|target| target.beats_mean == Some(false)), "{one:?}");
    }
    assert_eq!(splits.leaks.len(), 3, "{:?}", splits.leaks);
    let leak = found.warnings.iter().filter(|warning| warning.contains("rows of one recording on both sides leak"));
    assert_eq!(leak.count(), 3, "{:?}", found.warnings);
    assert!(found.notes[0].starts_with("Fx_N: shuffled rows flatter, times: nearest row"), "{:?}", found.notes);
    let table = std::fs::read_to_string(out.out.join("splits.csv")).unwrap();
    assert!(
        table
            .starts_with("by,parts,method,target,rows,rmse,rmse_low,rmse_high,beats_mean,fault\nrows,5,mean,Fx_N,900,")
    );
    assert!(out.out.join("splits.png").is_file() && out.out.join("splits.svg").is_file());
    // The same path twice, with other colours' noise.
    let [a, again] = ["a.csv", "again.csv"].map(|name| folder.cells(name, 1, 1, name == "again.csv"));
    let b = folder.cells("b.csv", 2, 2, false);
    let (_, report) = folder.nails(&[&a, &b], &[&again], OnScores::Ridge).unwrap();
    assert!(report.warnings.iter().any(|warning| warning.contains("again.csv that of")), "{:?}", report.warnings);
}

#[test]
fn files_of_cells_that_contradict_the_others_are_named() {
    let folder = Folder::new();
    let each = |change: &dyn Fn(&mut Vec<String>)| {
        folder.said_of(|rows| {
            let mut rows = rows.to_vec();
            rows.iter_mut().for_each(change);
            rows
        })
    };
    assert_eq!(each(&|_| ()), [""; 0]);
    let only = |said: Vec<String>, words: &str| {
        let such = said.iter().filter(|one| one.contains("contradicts") || one.contains(words)).count();
        assert!(such == 1 && said.iter().any(|one| one.contains(words)), "{words}: {said:?}");
    };
    // Row `from` of the picture in the place of `to`.
    let turned = |from: fn(usize, usize) -> [usize; 2]| {
        each(&move |row| {
            let cells = row[1..=SIDE * SIDE].to_vec();
            for k in 0..SIDE * SIDE {
                let [i, j] = from(k / SIDE, k % SIDE);
                row[1 + k].clone_from(&cells[i * SIDE + j]);
            }
        })
    };
    // These nails are alike on both sides.
    only(turned(|i, j| [i, SIDE - 1 - j]), "mirrored");
    only(
        turned(|i, j| [SIDE - 1 - i, SIDE - 1 - j]),
        "c.csv contradicts the other files: in it the picture looks turned by",
    );
    let force = 3 + SIDE * SIDE;
    only(each(&|row| row.swap(force, force + 2)), "Fx_N and Fz_N look exchanged");
    let negate = |row: &mut Vec<String>| row[force + 2] = (-row[force + 2].parse::<f64>().unwrap()).to_string();
    only(each(&negate), "Fz_N looks to have the other sign");
    let larger = |row: &mut Vec<String>| {
        let cells = row[1..=SIDE * SIDE].iter_mut().filter(|cell| !cell.is_empty());
        cells.for_each(|cell| *cell = (255.0 * cell.parse::<f64>().unwrap()).to_string());
    };
    only(each(&larger), "c.csv are 260 times as large as those of");
    only(each(&|row| row[20] = "7.5".to_owned()), "C_03_01: the same to the last digit in all rows");
    let late = folder.said_of(|rows| {
        let at = |k: usize| [&rows[k][..force], &rows[k - 30][force..]].concat();
        (30..rows.len()).map(at).collect()
    });
    only(late, "c.csv: the cells answer 3.0 s before Fx_N, Fy_N, Fz_N, as in no finger");
    let hangs = folder.said_of(|rows| {
        let held = |k: usize| if (200..280).contains(&k) { 200 } else { k };
        (0..rows.len()).map(|k| [&rows[k][..1], &rows[held(k)][1..force], &rows[k][force..]].concat()).collect()
    });
    only(hangs, "c.csv: all cells keep their values in 80 rows, from 20.0 to 27.9 s");
}

#[test]
fn what_can_not_be_used_says_why() {
    let folder = Folder::new();
    let volts = folder.recorded("volts.csv", 0.0, 1.0, true);
    let said = folder.nails(&[&volts], &[], OnScores::Ridge).unwrap_err();
    assert!(said.contains("has no cell `C_00_00`") && said.contains("nailvideo --cells"), "{said}");
    let a = folder.cells("a.csv", 1, 1, false);
    let (model, _) = folder.nails(&[&a], &[], OnScores::Ridge).unwrap();
    let said = analyse(&model, None, &Watch::nobody()).unwrap_err().to_string();
    assert!(said.contains("evaluate --out"), "{said}");
    let said = open_models(std::slice::from_ref(&model)).unwrap().of_samples().err().unwrap().to_string();
    assert!(said.contains("cells of a nail's picture") && said.contains("lunula predict"), "{said}");
    let evaluated = evaluate(&model, &DataFile::of(&[volts]), &EvaluateOptions::default(), None, &Watch::nobody());
    assert!(evaluated.unwrap_err().to_string().contains("has no column `C_00_01`"));
}
