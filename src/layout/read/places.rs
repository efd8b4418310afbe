//! Where candidates lie: cells of a grid over the normalized nail, or photodiodes whose places a file says.

use std::path::Path;

use lunula_predictor::Candidate;

use crate::input;
use crate::layout::error::LayoutError;
use crate::layout::options::LayoutOptions;
use crate::nail::Positions;
use crate::predictor::cell;

/// The side of a normalized picture, as a multiple of the nail's box, unless the pictures' report says otherwise.
pub(super) const MARGIN: f64 = 1.25;

/// A candidate on the nail.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::layout) struct Place {
    /// The column's name.
    pub(in crate::layout) name: String,
    /// Across, half widths.
    pub(in crate::layout) u: f64,
    /// Along, half lengths, distal positive.
    pub(in crate::layout) v: f64,
}

impl Place {
    /// In millimetres, as the search measures distances.
    pub(in crate::layout) fn candidate(&self, options: &LayoutOptions) -> Candidate {
        let [across_mm, along_mm] = [0.5 * options.nail_width * self.u, 0.5 * options.nail_length * self.v];
        Candidate { name: self.name.clone(), across_mm, along_mm }
    }

    /// Whether it keeps its distance from the edges of the nail's box.
    pub(super) fn is_inside(&self, options: &LayoutOptions) -> bool {
        let reach = |size_mm: f64| 1.0 - options.edge / (0.5 * size_mm);
        self.u.abs() <= reach(options.nail_width) && self.v.abs() <= reach(options.nail_length)
    }
}

/// The middle of a cell of a grid of `n` x `n` over a picture `margin` times the nail's box.
pub(super) fn middle(name: String, [row, column]: [usize; 2], n: usize, margin: f64) -> Place {
    // Both from the middle, so that mirror images are exactly that.
    let at = |k: usize| margin * (2.0 * k as f64 + 1.0 - n as f64) / n as f64;
    Place { name, u: at(column), v: -at(row) }
}

/// Whether a column is a photodiode: `P12`.
pub(in crate::layout) fn is_photodiode(name: &str) -> bool {
    name.strip_prefix('P').is_some_and(|digits| !digits.is_empty() && digits.bytes().all(|b| b.is_ascii_digit()))
}

/// The cells among columns, with their places; all of a grid, or of one whose size `options` say.
pub(super) fn cells(path: &Path, names: &[String], options: &LayoutOptions) -> Result<Vec<Place>, LayoutError> {
    let found: Vec<(&String, [usize; 2])> = names.iter().filter_map(|name| Some((name, cell(name)?))).collect();
    let reach = found.iter().flat_map(|(_, at)| at).max().map_or(0, |most| most + 1);
    let n = match options.grid {
        Some(n) if reach <= n as usize => n as usize,
        Some(n) => {
            let what = format!("has a cell in row or column {}, outside of --grid {n}", reach - 1);
            return Err(LayoutError::input(path, what));
        }
        None if found.len() == reach * reach => reach,
        None => {
            let what = format!(
                "has {} cells, not all of a grid of {reach} x {reach}, so where they lie is not known; say with --grid \
                 how many rows and columns the grid has",
                found.len()
            );
            return Err(LayoutError::input(path, what));
        }
    };
    Ok(found.into_iter().map(|(name, at)| middle(name.clone(), at, n, MARGIN)).collect())
}

/// Places of photodiodes: of a file, or the thesis' eight.
pub(super) fn photodiodes(
    path: &Path,
    names: &[String],
    positions: Option<&Path>,
) -> Result<(Vec<Place>, Positions), LayoutError> {
    let known = match positions {
        None => Positions::thesis(),
        Some(file) => read_positions(file)?,
    };
    let place = |name: &String| {
        let one = known.photodiodes.iter().find(|one| one.name == *name);
        one.map(|one| Place { name: name.clone(), u: one.u, v: one.v }).ok_or_else(|| {
            let what = match positions {
                Some(file) => format!("has a column {name}, whose place {} does not say; add it there", file.display()),
                None => {
                    format!("has a column {name}, whose place is not known; say with --positions where each one is")
                }
            };
            LayoutError::input(path, what)
        })
    };
    let places = names.iter().filter(|name| is_photodiode(name)).map(place).collect::<Result<_, _>>()?;
    Ok((places, known))
}

/// Reads a file of places, TOML or by its name JSON.
fn read_positions(file: &Path) -> Result<Positions, LayoutError> {
    let text = input::read_text(file).map_err(|why| LayoutError::input(file, why.to_string()))?;
    let json = file.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("json"));
    let read = if json { Positions::from_json(&text) } else { Positions::from_toml(&text) };
    read.map_err(|why| LayoutError::input(file, why.to_string()))
}
