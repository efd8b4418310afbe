//! A small helper for tests of the command line: a folder of its own, the binary, and what it answered.

#![allow(dead_code, unreachable_pub, reason = "every test file uses a part of it")]

pub mod browser;
pub mod desk;
pub(crate) mod hand_film;
pub mod page;
pub(crate) mod real_data;
pub(crate) mod running;
pub mod sensor;

use std::path::{Path, PathBuf};
use std::process::Command;

use image::{Rgb, RgbImage};
use lunula::labelme::{LabelMe, Shape};
use lunula::phantom::nail::Pose;
use lunula::phantom::photos::{LightKind, PhotoOptions};

pub(crate) use real_data::repository;

/// What a command answered.
pub struct Answer {
    pub code: i32,
    pub stdout: String,
    pub stderr: String,
}

impl Answer {
    #[track_caller]
    pub fn expect(self, code: i32) -> Self {
        assert_eq!(self.code, code, "stdout:\n{}\nstderr:\n{}", self.stdout, self.stderr);
        self
    }

    #[track_caller]
    pub fn says(self, words: &str) -> Self {
        assert!(self.stderr.contains(words), "`{words}` is not in:\n{}", self.stderr);
        self
    }

    #[track_caller]
    pub fn never_says(self, words: &str) -> Self {
        assert!(!self.stderr.contains(words), "`{words}` is in:\n{}", self.stderr);
        self
    }

    #[track_caller]
    pub fn says_all(self, words: &[&str]) -> Self {
        words.iter().fold(self, |answer, words| answer.says(words))
    }

    /// A refusal that says all of this.
    #[track_caller]
    pub fn refuses(self, words: &[&str]) -> Self {
        self.expect(2).says_all(words)
    }

    /// The same of standard output.
    #[track_caller]
    pub fn prints(self, words: &str) -> Self {
        assert!(self.stdout.contains(words), "`{words}` is not in:\n{}", self.stdout);
        self
    }

    #[track_caller]
    pub fn never_prints(self, words: &str) -> Self {
        assert!(!self.stdout.contains(words), "`{words}` is in:\n{}", self.stdout);
        self
    }

    pub fn json(&self) -> serde_json::Value {
        assert_eq!(self.stdout.lines().count(), 1, "one JSON object on one line:\n{}", self.stdout);
        serde_json::from_str(&self.stdout).expect("JSON on standard output")
    }
}

/// What a value of JSON has to be.
pub trait Json {
    fn number(&self) -> f64;
    fn words(&self) -> &str;
    fn list(&self) -> &[serde_json::Value];
}

impl Json for serde_json::Value {
    #[track_caller]
    fn number(&self) -> f64 {
        self.as_f64().unwrap_or_else(|| panic!("a number, not {self}"))
    }

    #[track_caller]
    fn words(&self) -> &str {
        self.as_str().unwrap_or_else(|| panic!("a text, not {self}"))
    }

    #[track_caller]
    fn list(&self) -> &[serde_json::Value] {
        self.as_array().unwrap_or_else(|| panic!("a list, not {self}"))
    }
}

/// A phantom's video is encoded as fast as a camera does, unless a test says how: `medium`, the default, took a sixth
/// of these tests' time.
fn fast_encoding(arguments: &[&str]) -> &'static [&'static str] {
    match arguments {
        ["phantom", "video" | "nailvideo", options @ ..] if !options.contains(&"--x264") => &["--x264", "veryfast"],
        _ => &[],
    }
}

/// A folder that goes away with the test.
pub struct Dir(tempfile::TempDir);

impl Dir {
    pub fn new() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder"))
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// A place for a file; its folder is made.
    pub fn place(&self, name: &str) -> PathBuf {
        let path = self.path(name);
        std::fs::create_dir_all(path.parent().expect("within the folder")).expect("a folder");
        path
    }

    pub fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        std::fs::write(self.place(name), bytes).expect("a file");
    }

    /// Runs the binary in this folder.
    pub fn lunula(&self, arguments: &[&str]) -> Answer {
        self.lunula_with(&[], arguments)
    }

    /// The same with a command line whose words have no spaces.
    pub fn words(&self, line: &str) -> Answer {
        self.lunula(&line.split_whitespace().collect::<Vec<_>>())
    }

    /// The same with environment variables.
    pub fn lunula_with(&self, variables: &[(&str, &str)], arguments: &[&str]) -> Answer {
        let output = Command::new(env!("CARGO_BIN_EXE_lunula"))
            .args(arguments)
            .args(fast_encoding(arguments))
            .envs(variables.iter().copied())
            .current_dir(self.0.path())
            .output()
            .expect("the binary runs");
        Answer {
            code: output.status.code().unwrap_or(-1),
            stdout: String::from_utf8(output.stdout).expect("text"),
            stderr: String::from_utf8(output.stderr).expect("text"),
        }
    }

    /// All files below `folder` with their bytes, by name.
    pub fn bytes_of(&self, folder: &str) -> std::collections::BTreeMap<String, Vec<u8>> {
        bytes_below(&self.path(folder))
    }

    /// The names of all files below `folder`.
    pub fn names_of(&self, folder: &str) -> Vec<String> {
        self.bytes_of(folder).into_keys().collect()
    }

    /// All results under `folder`, without what holds times.
    pub fn results_of(&self, folder: &str) -> std::collections::BTreeMap<String, Vec<u8>> {
        let mut found = self.bytes_of(folder);
        let is_timed = |name: &str| name.ends_with("report.html") || name.ends_with("run.json");
        found.retain(|name, _| !name.starts_with(".lunula/") && !is_timed(name));
        found
    }

    /// The results of a command line that puts them into the folder `{out}`: the same bytes on one thread and on four.
    #[track_caller]
    pub fn on_any_threads(&self, line: &str) -> std::collections::BTreeMap<String, Vec<u8>> {
        for (out, threads) in [("one", 1), ("four", 4)] {
            self.words(&format!("{} --threads {threads}", line.replace("{out}", out))).expect(0);
        }
        self.same_results("one", "four")
    }

    /// The results of two folders, which are the same.
    #[track_caller]
    pub fn same_results(&self, one: &str, other: &str) -> std::collections::BTreeMap<String, Vec<u8>> {
        let [first, second] = [one, other].map(|folder| self.results_of(folder));
        let differ: Vec<&String> =
            first.keys().chain(second.keys()).filter(|name| first.get(*name) != second.get(*name)).collect();
        assert!(differ.is_empty(), "other bytes in {other} than in {one}: {differ:?}");
        first
    }

    /// A table's rows, each by column.
    pub fn table(&self, name: &str) -> Vec<std::collections::BTreeMap<String, String>> {
        let mut reader = csv::Reader::from_path(self.path(name)).expect("a table");
        reader.deserialize().map(|row| row.expect("a row")).collect()
    }

    pub fn array(&self, name: &str) -> ndarray::Array2<f32> {
        ndarray_npy::read_npy(self.path(name)).expect("an array of float32")
    }
}

/// All files below a folder whose names end so.
pub fn paths_below(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            found.extend(paths_below(&path, ending));
        } else if path.to_string_lossy().ends_with(ending) {
            found.push(path);
        }
    }
    found
}

/// All files below a folder with their bytes, by name.
pub fn bytes_below(folder: &Path) -> std::collections::BTreeMap<String, Vec<u8>> {
    let named = |path: PathBuf| {
        let name = path.strip_prefix(folder).expect("below").to_string_lossy().into_owned();
        (name, std::fs::read(&path).expect("a file"))
    };
    paths_below(folder, "").into_iter().map(named).collect()
}

/// The number in a cell of a table; none where it is empty.
#[track_caller]
pub fn known(row: &std::collections::BTreeMap<String, String>, column: &str) -> Option<f64> {
    (!row[column].is_empty()).then(|| number(row, column))
}

/// The number in a cell of a table.
#[track_caller]
pub fn number(row: &std::collections::BTreeMap<String, String>, column: &str) -> f64 {
    row[column].parse().unwrap_or_else(|_| panic!("`{}` in `{column}`", row[column]))
}

/// A nail drawn without noise: light skin, a rounded nail of 60 x 80 px, distal end up, its middle at (80, 70).
pub fn drawn_nail() -> RgbImage {
    RgbImage::from_fn(160, 140, |x, y| {
        let (u, v) = ((f64::from(x) - 80.0) / 30.0, (f64::from(y) - 70.0) / 40.0);
        if u.powi(4) + v.powi(4) <= 1.0 { Rgb([190, 110 + x as u8 / 4, 120]) } else { Rgb([170, 90, 80]) }
    })
}

/// The drawn nail's outline in LabelMe's coordinates.
pub fn drawn_outline() -> Vec<[f64; 2]> {
    (0..72)
        .map(|k| {
            let angle = f64::from(k) * std::f64::consts::TAU / 72.0;
            let rounded = |c: f64| c.signum() * c.abs().sqrt();
            [80.5 + 30.0 * rounded(angle.cos()), 70.5 + 40.0 * rounded(angle.sin())]
        })
        .collect()
}

/// The axis line of the drawn nail, proximal to distal.
pub fn drawn_axis() -> Vec<[f64; 2]> {
    vec![[80.5, 110.5], [80.5, 30.5]]
}

/// A LabelMe file for a picture of `size` with these shapes: label, type, points.
pub fn labelme(size: [u32; 2], shapes: &[(&str, &str, Vec<[f64; 2]>)]) -> String {
    let shapes = shapes.iter().map(|(label, kind, points)| Shape::new(label, kind, points.clone())).collect();
    serde_json::to_string(&LabelMe::new("picture.png", size[0], size[1], shapes)).expect("JSON")
}

/// The drawn nail's LabelMe file.
pub fn drawn_labels() -> String {
    labelme([160, 140], &[("nail", "polygon", drawn_outline()), ("axis", "line", drawn_axis())])
}

impl Dir {
    /// Puts the drawn nail, annotated, at `<name>.png`.
    pub fn nail(&self, name: &str) {
        self.photo(name, drawn_nail(), drawn_labels());
    }

    /// Puts a picture at `<name>.png` and a LabelMe file beside it.
    pub fn photo(&self, name: &str, picture: impl Into<image::DynamicImage>, labels: String) {
        picture.into().save(self.place(&format!("{name}.png"))).expect("a picture");
        self.write(&format!("{name}.json"), labels);
    }
}

/// A small set of synthetic photographs that a test can afford.
pub fn small_set(subjects: u32, poses: &[Pose]) -> PhotoOptions {
    PhotoOptions {
        seed: 11,
        subjects,
        poses: poses.to_vec(),
        width: 320,
        height: 240,
        light: LightKind::Chamber,
        ..PhotoOptions::default()
    }
}

/// A pipeline that generates a log of touches for each session with its seed, of this length, fits a model of force to
/// it and evaluates that.
pub fn touch_pipeline(sessions: &[(&str, u64)], length: &str) -> String {
    let logs: String = sessions
        .iter()
        .map(|(name, seed)| format!("    {{ name = \"{name}\", seed = {seed}, protocol = \"touch\", {length} }},\n"))
        .collect();
    format!(
        r#"wanted = ["force", "how_good"]
[phantom]
log = [
{logs}]
[inputs.logs]
files = "{{phantom}}/log/{{session}}/log.csv"
[stage.force]
job = "train"
each = ["session"]
data = "logs"
target = "force"
[stage.how_good]
job = "evaluate"
model = "force"
data = "logs"
"#
    )
}

/// The same pipeline without its phantoms.
pub fn without_phantom(pipeline: &str) -> String {
    let at = |section| pipeline.find(section).expect("the section");
    pipeline[..at("[phantom]")].to_owned() + &pipeline[at("[inputs")..]
}
