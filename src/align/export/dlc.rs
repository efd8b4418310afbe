//! Markers as DeepLabCut's table of a single animal: three lines of names (scorer, bodyparts, coords), then a row a
//! frame: its number, and x, y and likelihood of each marker.
//!
//! In: the table of markers that `lunula posture` writes (`tracks.csv`). Places are pixels of the shown picture as
//! there. DeepLabCut's table has no time: of a video of variable frame rate, take it from the table of angles by the
//! frame's number. Some readers count rows instead of reading that number; the table of `lunula posture` has all
//! frames, so both are the same.
//!
//! Likelihood is the probability that the marker's centre lies within a pixel of where it is reported, by its standard
//! error along each axis:
//! 1 - exp(-1 / (2 sd^2)), so 1 where sd is 0.2 px and 0.39 where it is 1 px. A marker that was not seen has empty
//! places and likelihood
//! 0. One whose error is not known has no likelihood.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use super::{ExportError, fixed, write};
use crate::align::posture::{Posture, missing_as_nan};
use crate::table::{Table, TableError};

/// Decimals of a place in pixels, as many as the table of markers has, and of a likelihood.
const DECIMALS: usize = 4;

/// A marker in a frame.
#[derive(Debug, Clone, Copy)]
struct Sight {
    x_px: f64,
    y_px: f64,
    sd_px: f64,
}

/// Times of a frame in two tables are no further apart, seconds: both are rounded.
const SAME_S: f64 = 1e-5;

/// Writes the markers of the table `tracks` that are to stand at `path` into the file `at`; `posture` is what the same
/// video gave of angles.
///
/// # Errors
/// A table that can't be read, of another video, or without the columns `frame`, `marker`, `x_px`, `y_px`; a row
/// without a frame or a marker; a marker twice in a frame; a file that can't be written.
pub(crate) fn dlc(at: &Path, path: &Path, tracks: &Path, posture: &Posture) -> Result<(), ExportError> {
    let (markers, frames) = read(tracks, posture)?;
    let mut text = String::new();
    for (first, cells) in [("scorer", None), ("bodyparts", None), ("coords", Some(["x", "y", "likelihood"]))] {
        text.push_str(first);
        for marker in &markers {
            for place in 0..3 {
                text.push(',');
                match (cells, first) {
                    (Some(cells), _) => text.push_str(cells[place]),
                    (None, "scorer") => text.push_str("lunula"),
                    (None, _) => text.push_str(&quoted(marker)),
                }
            }
        }
        text.push('\n');
    }
    for (frame, sights) in frames {
        // A String takes all that is written.
        let _ = write!(text, "{frame}");
        for sight in sights {
            let seen = sight.filter(|s| s.x_px.is_finite() && s.y_px.is_finite());
            let cells = match seen {
                Some(s) => [s.x_px, s.y_px, likelihood(s.sd_px)],
                None => [f64::NAN, f64::NAN, 0.0],
            };
            for cell in cells {
                let _ = write!(text, ",{}", fixed(cell, DECIMALS, ""));
            }
        }
        text.push('\n');
    }
    write(at, path, &text)
}

/// The probability that the centre is within a pixel, of a normal error of this size along both axes.
fn likelihood(sd_px: f64) -> f64 {
    if sd_px == 0.0 { 1.0 } else { -(-0.5 / (sd_px * sd_px)).exp_m1() }
}

/// A cell of CSV.
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}

type Frames = BTreeMap<i64, Vec<Option<Sight>>>;

/// The markers in the order of the table, and what each frame shows of them.
fn read(tracks: &Path, posture: &Posture) -> Result<(Vec<String>, Frames), ExportError> {
    let table = Table::read(tracks)?;
    if table.has("time_s") {
        let mut there = missing_as_nan(table.numbers("time_s")?);
        there.sort_unstable_by(f64::total_cmp);
        let has = |time_s: f64| {
            let next = there.partition_point(|&there| there < time_s - SAME_S);
            there.get(next).is_some_and(|there| *there <= time_s + SAME_S)
        };
        if let Some(lacking) = posture.time_s.iter().find(|time_s| !has(**time_s)) {
            let what = format!(
                "has no frame at {lacking} s, and {} has: give the markers and the angles of one video",
                posture.path.display()
            );
            return Err(TableError::Read { path: tracks.to_owned(), what }.into());
        }
    }
    let (names, x, y) = (table.texts("marker")?, table.numbers("x_px")?, table.numbers("y_px")?);
    let sds = if table.has("sd_px") { table.numbers("sd_px")? } else { vec![None; table.rows()] };
    let numbers = table.integers("frame")?;
    let mut markers: Vec<String> = Vec::new();
    let mut rows = Vec::with_capacity(table.rows());
    for (row, name) in names.into_iter().enumerate() {
        let empty = |column: &str| table.cell(row, column, "is empty; fill it in or delete the row".to_owned());
        let name = name.ok_or_else(|| empty("marker"))?;
        let frame = numbers[row].ok_or_else(|| empty("frame"))?;
        let marker = markers.iter().position(|known| *known == name).unwrap_or_else(|| {
            markers.push(name);
            markers.len() - 1
        });
        rows.push((frame, marker));
    }
    let mut frames = Frames::new();
    for (row, (frame, marker)) in rows.into_iter().enumerate() {
        let sights = frames.entry(frame).or_insert_with(|| vec![None; markers.len()]);
        let known = |cell: Option<f64>| cell.unwrap_or(f64::NAN);
        let sight = Sight { x_px: known(x[row]), y_px: known(y[row]), sd_px: known(sds[row]) };
        if sights[marker].replace(sight).is_some() {
            let what = format!("`{}` is in frame {frame} twice; delete one row", markers[marker]);
            return Err(table.cell(row, "marker", what).into());
        }
    }
    Ok((markers, frames))
}
