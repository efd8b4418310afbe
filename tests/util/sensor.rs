//! A sensor whose physics is known: forces and angle are linear in the volts, with coefficients that a double holds
//! exactly.
//!
//! Volts are multiples of 2^-10, coefficients of 2^-4: every cell of the table is exact, so that coefficients, RMSE,
//! bias and R2 of what is fitted to it are known.

use super::{Dir, Json};

/// The sensor's description, in order.
pub const TARGETS: [&str; 4] = ["Fx_N", "Fy_N", "Fz_N", "J2_deg"];

/// What target `target` has of photodiode `k`, both from 0: newtons or degrees a volt.
pub fn slope(target: usize, k: usize) -> f64 {
    let of_force = (((target * 7 + k * 5 + 3) % 17) as f64 - 8.0) / 16.0;
    if target == 3 { 32.0 * of_force } else { of_force }
}

/// The slopes of a target in all eight photodiodes.
pub fn slopes(target: usize) -> [f64; 8] {
    std::array::from_fn(|k| slope(target, k))
}

/// What a target is where all volts are 0.
pub fn offset(target: usize) -> f64 {
    [0.25, -0.5, -0.375, 40.0][target] - (0..8).map(|k| 2.5 * slope(target, k)).sum::<f64>()
}

/// The volts of photodiode `k`, from 0, in a row: 2 to 3 V.
pub fn volt(row: usize, k: usize) -> f64 {
    const STEPS: [usize; 8] = [1, 457, 229, 881, 113, 673, 331, 557];
    let step = STEPS[k % 8] + 61 * (k / 8);
    2.0 + ((row * step + row * row / 7 * (k + 1) + 101 * k) % 1009) as f64 / 1024.0
}

/// A table in the making.
#[derive(Clone)]
pub struct Recording {
    pub names: Vec<String>,
    /// A row's cells each.
    pub rows: Vec<Vec<String>>,
}

impl Recording {
    /// Rows of the sensor with 8 photodiodes, 25 a second: `time_s`, `P1` .. `P8`, forces and angle.
    pub fn of(rows: std::ops::Range<usize>) -> Self {
        let mut names = vec!["time_s".to_owned()];
        names.extend((1..=8).map(|k| format!("P{k}")));
        names.extend(TARGETS.map(str::to_owned));
        let first = rows.start;
        let row = |row: usize| {
            let mut cells = vec![((row - first) as f64 / 25.0).to_string()];
            cells.extend((0..8).map(|k| volt(row, k).to_string()));
            let target = |target| offset(target) + (0..8).map(|k| slope(target, k) * volt(row, k)).sum::<f64>();
            cells.extend((0..4).map(|k| target(k).to_string()));
            cells
        };
        Self { rows: rows.map(row).collect(), names }
    }

    fn place(&self, column: &str) -> usize {
        self.names.iter().position(|name| name == column).unwrap_or_else(|| panic!("no column {column}"))
    }

    pub fn numbers(&self, column: &str) -> Vec<f64> {
        let place = self.place(column);
        self.rows.iter().map(|row| row[place].parse().expect("a number")).collect()
    }

    /// Another value in each row of a column, by the row and the value before; a column that is not there comes last.
    pub fn with(mut self, column: &str, value: impl Fn(usize, &str) -> String) -> Self {
        if !self.names.iter().any(|name| name == column) {
            self.names.push(column.to_owned());
            self.rows.iter_mut().for_each(|row| row.push(String::new()));
        }
        let place = self.place(column);
        for (k, row) in self.rows.iter_mut().enumerate() {
            row[place] = value(k, &row[place]);
        }
        self
    }

    /// The same with numbers.
    pub fn map(self, column: &str, value: impl Fn(usize, f64) -> f64) -> Self {
        self.with(column, |row, cell| value(row, cell.parse().expect("a number")).to_string())
    }

    /// One cell.
    pub fn cell(self, row: usize, column: &str, text: &str) -> Self {
        self.with(column, |k, before| if k == row { text.to_owned() } else { before.to_owned() })
    }

    /// Only these columns, in this order.
    pub fn only(&self, columns: &[&str]) -> Self {
        let places: Vec<usize> = columns.iter().map(|column| self.place(column)).collect();
        let rows = self.rows.iter().map(|row| places.iter().map(|&place| row[place].clone()).collect()).collect();
        Self { names: columns.iter().map(|&name| name.to_owned()).collect(), rows }
    }

    pub fn without(&self, column: &str) -> Self {
        let kept: Vec<&str> = self.names.iter().map(String::as_str).filter(|name| *name != column).collect();
        self.only(&kept)
    }

    pub fn renamed(mut self, column: &str, name: &str) -> Self {
        let place = self.place(column);
        self.names[place] = name.to_owned();
        self
    }

    pub fn csv(&self) -> String {
        let lines = std::iter::once(&self.names).chain(&self.rows).map(|cells| cells.join(",") + "\n");
        lines.collect()
    }
}

impl Dir {
    /// Writes a table.
    pub fn recording(&self, name: &str, recording: &Recording) {
        self.write(name, recording.csv());
    }

    /// A file's text.
    pub fn text(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).unwrap_or_else(|why| panic!("{name}: {why}"))
    }

    /// A file of JSON.
    pub fn parsed(&self, name: &str) -> serde_json::Value {
        serde_json::from_str(&self.text(name)).unwrap_or_else(|why| panic!("{name}: {why}"))
    }

    /// A file of JSON, a value on each line.
    pub fn json_lines(&self, name: &str) -> Vec<serde_json::Value> {
        let parsed = |line: &str| serde_json::from_str(line).unwrap_or_else(|why| panic!("{name}: {why}: {line}"));
        self.text(name).lines().map(parsed).collect()
    }

    /// Trains `model` on `data` (names with spaces in between).
    pub fn train(&self, data: &str, target: &str, model: &str, more: &[&str]) -> super::Answer {
        let data: Vec<&str> = data.split(' ').collect();
        self.lunula(&[&["train"], &data[..], &["--target", target, "--out", model], more].concat())
    }
}

/// Numbers of JSON.
#[track_caller]
pub fn numbers(json: &serde_json::Value) -> Vec<f64> {
    json.list().iter().map(Json::number).collect()
}

/// That no number is farther off than `most`; NaN is.
#[track_caller]
pub fn near(found: &[f64], wanted: &[f64], most: f64) {
    assert_eq!(found.len(), wanted.len(), "{found:?} against {wanted:?}");
    for (found, wanted) in found.iter().zip(wanted) {
        assert!((found - wanted).abs() <= most, "{found} against {wanted}, farther than {most}");
    }
}
