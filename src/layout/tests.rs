//! The job from tables and maps that it has an exact answer to, and what it refuses.

use std::fmt::Write as _;
use std::path::Path;

use image::{GrayAlphaImage, LumaA};
use ndarray::Array2;
use ndarray_npy::WriteNpyExt;

use super::*;
use crate::job::{Outputs, Watch, read};
use crate::nail::Positions;
use crate::predictor::DataFile;
use crate::table::Table;
use crate::trial::Folder;

/// Of few operations on tables of 9 digits.
const NEAR: f64 = 1e-6;

impl Folder {
    fn write(&self, name: &str, text: &str) -> &Self {
        self.file(name, text);
        self
    }

    /// Lays out what files say, with options as a pipeline writes them; without pictures.
    fn run(&self, files: &[&str], options: &str) -> Result<LayoutReport, LayoutError> {
        let given = read::<LayoutOptions>(&options.parse().unwrap(), "lunula layout").unwrap();
        let data = files.iter().map(|name| DataFile { name: (*name).to_owned(), ..self.path(name).into() }).collect();
        let positions = Some(self.path("positions.toml")).filter(|path| path.exists());
        let outputs = Outputs { figures: false, ..Outputs::all(self.path("out")) };
        run(&LayoutInputs { data, positions }, &given.options, &outputs, &Watch::nobody())
    }

    fn refused(&self, files: &[&str], options: &str) -> String {
        let refused = self.run(files, options).unwrap_err().to_string();
        assert!(!self.path("out").exists(), "nothing was written: {refused}");
        refused
    }

    fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.path("out").join(name)).unwrap()
    }
}

/// Waves of no common period: what the reading of candidate `k` is by itself.
fn wave(row: usize, k: usize) -> f64 {
    (row as f64 * (0.37 + 0.113 * k as f64)).sin() + 0.5 * (row as f64 * 1.7 + k as f64).cos()
}

/// Cells of a grid of 4 x 4 and forces that two of them explain, with what others add, for one person.
fn cells(person: usize, rows: usize, change: impl Fn(usize, usize, f64) -> String) -> String {
    let mut text = "time_s,Fx_N,Fz_N".to_owned();
    (0..16).for_each(|k| write!(text, ",C_{:02}_{:02}", k / 4, k % 4).unwrap());
    text.push('\n');
    for row in 0..rows {
        let at = |k: usize| wave(row + 31 * person, k);
        let (fx, fz) = (at(5) - at(10), -2.0 * at(5) - at(10));
        write!(text, "{:.2},{fx:.9},{fz:.9}", 0.04 * row as f64).unwrap();
        (0..16).for_each(|k| write!(text, ",{}", change(row, k, at(k))).unwrap());
        text.push('\n');
    }
    text
}

fn plain(_: usize, _: usize, value: f64) -> String {
    format!("{value:.9}")
}

/// Readings with noise of `size`.
fn noisy(size: f64) -> impl Fn(usize, usize, f64) -> String {
    move |row, k, value| plain(row, k, value + size * wave(7 * row + 3, k + 40))
}

/// A table with its rows changed.
fn changed(text: &str, change: impl Fn(&mut Vec<String>)) -> String {
    let (head, rows) = text.split_once('\n').unwrap();
    let row = |line: &str| {
        let mut row: Vec<String> = line.split(',').map(str::to_owned).collect();
        change(&mut row);
        row.join(",") + "\n"
    };
    format!("{head}\n{}", rows.lines().map(row).collect::<String>())
}

/// Eight photodiodes in the rows that are read, and an angle that the seventh explains; `cell` of row and photodiode.
fn photodiodes(rows: impl Iterator<Item = usize>, cell: impl Fn(usize, usize) -> String) -> String {
    let mut text = "time_s,P1,P2,P3,P4,P5,P6,P7,P8,J2_deg\n".to_owned();
    for row in rows {
        let cells: Vec<String> = (0..8).map(|k| cell(row, k)).collect();
        writeln!(text, "{row},{},{:.9}", cells.join(","), 3.0 * wave(row, 6)).unwrap();
    }
    text
}

#[test]
fn the_two_cells_that_explain_the_forces_are_found_where_they_lie() {
    let folder = Folder::new();
    folder
        .write("a.csv", &cells(0, 200, plain))
        .write("b.csv", &cells(1, 200, plain))
        .write("c.csv", &cells(2, 200, plain));
    let report = folder.run(&["a.csv", "b.csv", "c.csv"], "k = '1..3'").unwrap();
    // Of a grid of 4 x 4 over 125 % of the box only the four in the middle are 0.5 mm from its edge.
    assert_eq!((report.candidates, report.left_out_candidates.edge, report.persons.len()), (4, 12, 3));
    assert_eq!(
        (report.chosen.k, report.chosen.candidates.clone()),
        (2, vec!["C_01_01".to_owned(), "C_02_02".to_owned()])
    );
    assert!(report.chosen.by_target.iter().all(|(_, rmse)| *rmse <= NEAR), "{:?}", report.chosen.by_target);
    let of = |k: usize| report.methods.iter().find(|one| one.k == k && one.method == Method::Best).unwrap();
    assert!(of(1).error > 0.1 && of(2).error <= NEAR && of(2).optimal == Some(true));
    assert!(of(1).left_out.unwrap().error > 0.1 && of(2).left_out.unwrap().error <= NEAR);
    let positions = Positions::from_json(&folder.read("layout.json")).unwrap();
    let places: Vec<(&str, f64, f64)> =
        positions.photodiodes.iter().map(|one| (one.name.as_str(), one.u, one.v)).collect();
    assert_eq!(places, [("P1", -0.3125, 0.3125), ("P2", 0.3125, -0.3125)]);
    let table = Table::read(&folder.path("out/layout.csv")).unwrap();
    // Four methods of three numbers, and all: the thesis' eight are not among four candidates.
    assert_eq!(table.rows(), 13);
    assert_eq!(table.texts("proof").unwrap()[0].as_deref(), Some("optimal"));
    assert!(report.notes.iter().any(|note| note.contains("thesis' eight are left out")), "{:?}", report.notes);
}

#[test]
fn a_file_that_contradicts_the_others_is_named_and_a_time_that_is_no_number_is_none() {
    let folder = Folder::new();
    let [a, b, c] = [0, 1, 2].map(|person| cells(person, 400, noisy(0.1)));
    let run = |c: &str| {
        folder.write("a.csv", &a).write("b.csv", &b).write("c.csv", c);
        folder.run(&["a.csv", "b.csv", "c.csv"], "k = '2'").unwrap()
    };
    let contradicted = |report: &LayoutReport| report.warnings.iter().any(|said| said.contains("contradicts"));
    let as_it_is = run(&c);
    assert!(!contradicted(&as_it_is), "{:?}", as_it_is.warnings);
    let negated = run(&changed(&c, |row| row[1] = (-row[1].parse::<f64>().unwrap()).to_string()));
    let said = "c.csv contradicts the other files: in it Fx_N looks to have the other sign";
    assert!(negated.warnings.iter().any(|warning| warning.starts_with(said)), "{:?}", negated.warnings);
    let by_clock = run(&changed(&c, |row| row[0] = "12:30:01".to_owned()));
    assert_eq!(by_clock.chosen.candidates, as_it_is.chosen.candidates);
}

#[test]
fn a_column_of_subjects_is_as_good_as_a_file_for_each_and_threads_change_nothing() {
    let (apart, together) = (Folder::new(), Folder::new());
    let mut all = String::new();
    for (person, name) in ["a", "b", "c"].iter().enumerate() {
        let own = cells(person, 120, noisy(0.1));
        apart.write(&format!("{name}.csv"), &own);
        for (at, line) in own.lines().enumerate() {
            match at {
                0 if person == 0 => writeln!(all, "{line},subject").unwrap(),
                0 => {}
                _ => writeln!(all, "{line},{name}.csv").unwrap(),
            }
        }
    }
    together.write("all.csv", &all);
    let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool(1).install(|| apart.run(&["a.csv", "b.csv", "c.csv"], "k = '1..4'")).unwrap();
    pool(3).install(|| together.run(&["all.csv"], "k = '1..4'")).unwrap();
    for name in ["layout.csv", "layout.json"] {
        assert_eq!(apart.read(name), together.read(name));
    }
    std::fs::remove_dir_all(apart.path("out")).unwrap();
    pool(3).install(|| apart.run(&["c.csv", "b.csv", "a.csv"], "k = '1..4'")).unwrap();
    assert_eq!(apart.read("layout.csv"), together.read("layout.csv"));
}

#[test]
fn cells_outside_of_the_outline_are_left_out_and_hidden_rows_counted() {
    let folder = Folder::new();
    let holes = |row: usize, k: usize, value: f64| match k {
        6 => String::new(),
        9 => "0.25".to_owned(),
        10 if row.is_multiple_of(20) => "NaN".to_owned(),
        _ => plain(row, k, value),
    };
    folder.write("a.csv", &cells(0, 200, holes));
    let report = folder.run(&["a.csv"], "k = '1,2'").unwrap();
    let out = report.left_out_candidates;
    assert_eq!((report.candidates, out.edge, out.missing, out.constant), (2, 12, 1, 1));
    assert_eq!((report.persons[0].rows, report.persons[0].incomplete), (190, 10));
    // One person: no interval, and the report says so.
    assert!(report.methods.iter().all(|one| one.left_out.is_none()));
    assert!(report.notes.iter().any(|note| note.starts_with("no intervals")), "{:?}", report.notes);
    assert_eq!((report.chosen.k, report.chosen.why.contains("no intervals")), (2, true));
    let table = Table::read(&folder.path("out/layout.csv")).unwrap();
    assert!(table.numbers("left_out_error").unwrap().iter().all(Option::is_none));
}

#[test]
fn photodiodes_are_not_read_where_the_sensor_had_a_fault() {
    let folder = Folder::new();
    let table = |read: &dyn Fn(usize) -> bool, status: &dyn Fn(usize) -> &'static str| {
        // Where it is saturated P7 reads what it can at most.
        let value = |row: usize, k: usize| if k == 6 && status(row) != "ok" { 5.0 } else { wave(row, k) };
        let all = photodiodes((0..200).filter(|row| read(*row)), |row, k| plain(row, k, value(row, k)));
        let with_status = changed(&all, |row| row.push(status(row[0].parse().unwrap()).to_owned()));
        with_status.replacen("J2_deg", "J2_deg,sensor_status", 1)
    };
    let saturates = |row: usize| if row.is_multiple_of(10) { "saturated: P7" } else { "ok" };
    let run = |text: &str| folder.write("a.csv", text).run(&["a.csv"], "k = '1'").unwrap();
    let report = run(&table(&|_| true, &saturates));
    assert_eq!((report.persons[0].rows, report.persons[0].incomplete), (180, 20));
    assert!(report.notes.iter().any(|note| note.ends_with("P7 in 20 rows")), "{:?}", report.notes);
    let without = run(&table(&|row| saturates(row) == "ok", &|_| "ok"));
    assert_eq!(
        (&report.chosen.candidates, &report.chosen.by_target),
        (&without.chosen.candidates, &without.chosen.by_target)
    );
    // Of another photodiode nothing is missing.
    let often = run(&table(&|_| true, &|row| if row % 3 == 0 { "saturated: P7; no ambient: P2" } else { "ok" }));
    assert_eq!((often.candidates, often.left_out_candidates.missing, often.persons[0].incomplete), (6, 2, 0));
    let unknown = run(&table(&|_| true, &|row| if row < 5 { "loose" } else { "ok" }));
    let says = |one: &String| one.contains("a.csv: `sensor_status` says something") && one.contains("5 rows");
    assert!(unknown.warnings.iter().any(says), "{:?}", unknown.warnings);
}

#[test]
fn photodiodes_have_the_thesis_places_or_those_of_a_file() {
    let folder = Folder::new();
    folder.write("a.csv", &photodiodes(0..100, |row, k| plain(row, k, wave(row, k))));
    let report = folder.run(&["a.csv"], "k = '1'").unwrap();
    assert_eq!(report.chosen.candidates, ["P7"]);
    let thesis = Positions::thesis().photodiodes;
    let chosen = &report.chosen.positions.photodiodes[0];
    assert_eq!((chosen.name.as_str(), chosen.u, chosen.v), ("P1", thesis[6].u, thesis[6].v));
    let all = report.methods.iter().find(|one| one.method == Method::Thesis).unwrap();
    assert_eq!((all.k, all.error <= NEAR), (8, true));
    let report = folder.run(&["a.csv"], "k = '3'\nkeep = ['P1', 'P2']").unwrap();
    assert_eq!(report.chosen.candidates, ["P1", "P7", "P2"]);
    assert!(report.warnings.iter().all(|said| !said.contains("--apart")), "{:?}", report.warnings);
    let report = folder.run(&["a.csv"], "k = '3'\nkeep = ['P1', 'P2']\napart = 5.0").unwrap();
    assert!(report.warnings.iter().any(|said| said.contains("P1 and P2 are 3.08 mm apart")), "{:?}", report.warnings);
    let report = folder.run(&["a.csv"], "k = '2'\nmirror = true").unwrap();
    assert_eq!(report.chosen.candidates, ["P7", "P5"]);
    let positions =
        "name = 'x'\nnail_width_mm = 12.0\ndiameter_mm = 1.0\n[[photodiode]]\nname = 'P1'\nu = 0.0\nv = 0.0\n";
    std::fs::remove_dir_all(folder.path("out")).unwrap();
    let refused = folder.write("positions.toml", positions).refused(&["a.csv"], "k = '1'");
    assert!(refused.contains("P2") && refused.contains("positions.toml does not say"), "{refused}");
    std::fs::remove_file(folder.path("positions.toml")).unwrap();
    let alike = photodiodes(0..100, |row, _| wave(row, 0).to_string());
    let same = folder.write("a.csv", &alike).refused(&["a.csv"], "k = '1'");
    assert!(same.contains("a.csv: all photodiodes read the same"), "{same}");
}

#[test]
fn what_can_not_be_laid_out_is_refused_by_name() {
    let folder = Folder::new();
    folder
        .write("a.csv", &cells(0, 100, plain))
        .write("few.csv", &cells(0, 3, plain))
        .write("none.csv", &cells(0, 0, plain));
    folder.write("no-cells.csv", "time_s,Fz_N\n0,1\n").write("part.csv", "C_00_00,C_03_03,Fz_N\n1,2,3\n");
    folder.write("flat.csv", &cells(0, 100, |_, _, _| "1".to_owned()));
    folder.write(
        "word.csv",
        &cells(0, 100, |row, k, value| if (row, k) == (7, 5) { "wet".to_owned() } else { plain(row, k, value) }),
    );
    folder.write("dead.csv", &cells(0, 100, |row, k, value| if k == 5 { String::new() } else { plain(row, k, value) }));
    let still = cells(0, 100, plain).replace("Fx_N", "Fy_N");
    folder.write("still.csv", &changed(&still, |row| row[2] = "-1.5".to_owned()));
    std::fs::create_dir(folder.path("empty")).unwrap();
    let cases: [(&[&str], &str, &[&str]); 18] = [
        (&["a.csv"], "k = '1..8'", &["8 photodiodes", "4 candidates"]),
        (&["few.csv"], "k = '1..2'", &["few.csv", "3 of 3 rows", "4 are the fewest"]),
        (&["none.csv"], "k = '1'", &["none.csv", "no row below"]),
        (&["no-cells.csv"], "k = '1'", &["no-cells.csv", "no candidates"]),
        (&["part.csv"], "k = '1'", &["part.csv", "2 cells", "4 x 4", "--grid"]),
        (&["part.csv"], "k = '1'\ngrid = 3", &["outside of --grid 3"]),
        (&["flat.csv"], "k = '1'", &["no candidate is left", "4 are the same"]),
        (&["word.csv"], "k = '1'", &["word.csv:9", "C_01_01", "wet", "no finite number"]),
        (&["dead.csv"], "k = '1'\nkeep = ['C_01_01']", &["--keep: C_01_01"]),
        (&["a.csv"], "k = '1'\nkeep = ['C_09_09']", &["C_09_09 is not a candidate"]),
        (&["a.csv"], "k = '1'\nkeep = ['C_01_01', 'C_01_02']", &["--keep names 2 places"]),
        (&["a.csv"], "k = '1,2'\nchoose = 3", &["--choose 3"]),
        (&["a.csv"], "k = '2'\napart = 30", &["no 2 of 4 candidates lie 30 mm apart"]),
        (&["a.csv"], "k = '1'\ntargets = ['J2_deg']", &["a.csv", "no column J2_deg", "Fx_N, Fz_N"]),
        (&["a.csv"], "k = '1'\ntargets = ['Fz_N', 'Fz_N']", &["there twice"]),
        (&["a.csv", "still.csv"], "k = '1'", &["still.csv", "Fz_N is the same in all rows"]),
        (&["empty"], "k = '1'", &["empty", "a folder without maps"]),
        (&["missing.csv"], "k = '1'", &["missing.csv"]),
    ];
    for (files, options, says) in cases {
        let refused = folder.refused(files, options);
        assert!(says.iter().all(|words| refused.contains(words)), "{files:?} {options}: {refused}");
    }
    let no_target = cells(0, 50, plain).replace("Fx_N", "x").replace("Fz_N", "z");
    let refused = folder.write("b.csv", &no_target).refused(&["b.csv"], "k = '1'");
    assert!(refused.contains("there is no target"), "{refused}");
    let other = folder.write("c.csv", "P1,Fx_N,Fz_N\n1,2,3\n").refused(&["a.csv", "c.csv"], "k = '1'");
    assert!(other.contains("c.csv") && other.contains("no column C_00_00"), "{other}");
}

#[test]
fn numbers_of_photodiodes_are_ranges_and_lists() {
    let read = |text: &str| text.parse::<Numbers>().map(|numbers| numbers.0);
    assert_eq!(read("1..3"), Ok(vec![1, 2, 3]));
    assert_eq!(read("8,2,4,2"), Ok(vec![2, 4, 8]));
    for wrong in ["", "0", "1..17", "3..2", "a", "1,,2"] {
        assert!(read(wrong).is_err(), "{wrong}");
    }
}

/// Maps and normalized pictures of 32 x 32 pixels; `level` of pose, subject and cell of 8 x 8.
fn maps(folder: &Folder, poses: &[&str], subjects: usize, level: impl Fn(usize, usize, [u32; 2]) -> u8) {
    std::fs::create_dir_all(folder.path("set/maps")).unwrap();
    for (pose, name) in poses.iter().enumerate() {
        let place = folder.path("set/normalized").join(name);
        std::fs::create_dir_all(&place).unwrap();
        let mut mean = Array2::<f32>::zeros((32, 32));
        for subject in 0..subjects {
            let picture = GrayAlphaImage::from_fn(32, 32, |x, y| LumaA([level(pose, subject, [y / 4, x / 4]), 255]));
            picture.save(place.join(format!("s{subject}.png"))).unwrap();
            mean.indexed_iter_mut().for_each(|((y, x), sum)| {
                *sum += f32::from(picture.get_pixel(x as u32, y as u32).0[0]) / 255.0 / subjects as f32;
            });
        }
        let file = std::fs::File::create(folder.path("set/maps").join(format!("{name}-mean.npy"))).unwrap();
        mean.write_npy(file).unwrap();
    }
}

#[test]
fn poses_are_told_apart_where_they_differ() {
    let folder = Folder::new();
    let noise = |pose: usize, subject: usize, [row, column]: [u32; 2]| {
        let which = 97 * pose + 31 * subject + 13 * row as usize + 7 * column as usize;
        (6.0 * wave(which, subject)).round() as i32
    };
    let level = |pose: usize, subject: usize, at: [u32; 2]| {
        let change = match (pose, at) {
            (1, [2, 3]) | (2, [5, 4]) => 60,
            _ => 0,
        };
        (100 + change + noise(pose, subject, at)) as u8
    };
    maps(&folder, &["nominal", "normal", "shear"], 6, level);
    let report = folder.run(&["set"], "k = '1..3'\ncells = 8").unwrap();
    assert_eq!((report.persons.len(), report.targets.len(), report.error_of_none), (6, 3, 0.5));
    let of = |k: usize| report.methods.iter().find(|one| one.k == k && one.method == Method::Best).unwrap();
    assert_eq!(of(2).places, ["C_02_03", "C_05_04"]);
    assert!(of(2).error < 0.01 && of(1).error > 0.1, "{} {}", of(1).error, of(2).error);
    let interval = of(2).left_out.unwrap();
    // Six subjects without a fault leave 0.39 open.
    assert!(interval.error < 0.02 && interval.interval[1] > 0.05, "{interval:?}");
    assert_eq!(report.chosen.by_target.len(), 3);
    let refused = |folder: &Folder, options: &str| {
        let _ = std::fs::remove_dir_all(folder.path("out"));
        folder.refused(&["set"], options)
    };
    let few = Folder::new();
    maps(&few, &["nominal", "normal"], 2, level);
    assert!(refused(&few, "k = '1..2'\ncells = 8").contains("2 degrees of freedom"));
    let one = Folder::new();
    maps(&one, &["nominal"], 4, level);
    assert!(refused(&one, "k = '1'").contains("maps of one pose"));
    std::fs::write(one.path("set/maps/normal-mean.npy"), b"no array").unwrap();
    assert!(refused(&one, "k = '1'").contains("normal"));
}

/// Of 36 cells four separate any 6 + 6 pictures somehow; a subject that had no part in that says what it is worth.
#[test]
fn poses_that_do_not_differ_are_confused_by_half_of_those_left_out() {
    let folder = Folder::new();
    let level = |pose: usize, subject: usize, [row, column]: [u32; 2]| {
        let which = (pose * 1_000_003 + subject * 10_007 + row as usize * 101 + column as usize + 1) as u64;
        let mixed = which.wrapping_mul(0x9E37_79B9_7F4A_7C15);
        let mixed = (mixed ^ (mixed >> 31)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        ((mixed ^ (mixed >> 29)) >> 56) as u8
    };
    maps(&folder, &["a", "b"], 6, level);
    let run = |options: &str| {
        let _ = std::fs::remove_dir_all(folder.path("out"));
        let report = folder.run(&["set"], options).unwrap();
        assert!(report.warnings.iter().any(|said| said.contains("say nothing of who is left out")), "{report:?}");
        let best = report.methods.iter().find(|one| one.k == 4 && one.method == Method::Best).unwrap();
        (best.error, best.left_out.unwrap())
    };
    let (error, left_out) = run("k = '4'\ncells = 8");
    assert!(error < 0.01 && left_out.error > 0.3, "{error} and {left_out:?}");
    // Photodiodes that show their noise alone say nothing of any pose.
    let (error, left_out) = run("k = '4'\ncells = 8\nnoise = 1e6");
    assert!((error - 0.5).abs() < 1e-6 && (left_out.error - 0.5).abs() < 1e-3, "{error} and {left_out:?}");
    // Of few subjects Student's t reaches beyond all pictures, of which no more can be wrong.
    let few = Folder::new();
    maps(&few, &["a", "b"], 3, level);
    let report = few.run(&["set"], "k = '1'\ncells = 8").unwrap();
    let ends: Vec<f64> = report.methods.iter().filter_map(|one| Some(one.left_out?.interval[1])).collect();
    assert!(ends.contains(&1.0) && ends.iter().all(|end| *end <= 1.0), "{ends:?}");
}

#[test]
fn pictures_show_the_places_and_the_errors() {
    let folder = Folder::new();
    folder.write("a.csv", &cells(0, 100, noisy(0.3))).write("b.csv", &cells(1, 100, noisy(0.3)));
    let given = read::<LayoutOptions>(&"k = '1..3'\nchoose = 3".parse().unwrap(), "").unwrap();
    let data = ["a.csv", "b.csv"].map(|name| DataFile::from(folder.path(name))).to_vec();
    let outputs = Outputs { report: false, ..Outputs::all(folder.path("out")) };
    let inputs = LayoutInputs { data, positions: None };
    let report = run(&inputs, &given.options, &outputs, &Watch::nobody()).unwrap();
    let names = |path: &Path| path.file_name().unwrap().to_string_lossy().into_owned();
    assert_eq!(
        report.pictures.iter().map(|path| names(path)).collect::<Vec<_>>(),
        ["layout.png", "error-against-k.png"]
    );
    let svg = folder.read("layout.svg");
    assert!(["P1", "P2", "P3", "3 chosen places"].iter().all(|words| svg.contains(words)));
    assert!(folder.read("error-against-k.svg").contains("QR pivots"));
    assert!(image::open(folder.path("out/layout.png")).unwrap().width() >= 640);
    assert!(!folder.path("out/run.json").exists());
}
