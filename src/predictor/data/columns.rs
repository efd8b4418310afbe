//! Which columns of a table are photodiodes or cells, and what to say of one that is not there.

use lunula_predictor::FORCES;

use crate::log::is_force_in_another_unit;

/// The number of a photodiode: `P12` is 12; `P01` and `P` are none.
fn number(name: &str) -> Option<u32> {
    let digits = name.strip_prefix('P')?;
    let plain = !digits.starts_with('0') && digits.bytes().all(|b| b.is_ascii_digit());
    digits.parse().ok().filter(|_| plain)
}

/// All photodiodes, in the order of their numbers.
pub(super) fn photodiodes(names: &[String]) -> Vec<String> {
    in_order(names, number)
}

/// Row and column of a cell of a nail's picture, from 0: `C_03_11`.
pub(crate) fn cell(name: &str) -> Option<[usize; 2]> {
    let (row, column) = name.strip_prefix("C_")?.split_once('_')?;
    let place = |digits: &str| {
        let plain = digits.len() >= 2 && digits.bytes().all(|b| b.is_ascii_digit());
        digits.parse::<u16>().ok().filter(|_| plain).map(usize::from)
    };
    Some([place(row)?, place(column)?])
}

/// All cells, row by row.
pub(super) fn cells(names: &[String]) -> Vec<String> {
    in_order(names, cell)
}

/// The names that have a place, in the order of places.
fn in_order<T: Ord>(names: &[String], place: fn(&str) -> Option<T>) -> Vec<String> {
    let mut found: Vec<(T, &String)> = names.iter().filter_map(|name| Some((place(name)?, name))).collect();
    found.sort();
    found.into_iter().map(|(_, name)| name.clone()).collect()
}

/// Of their box, the cells of a nail are more than this (assumed: those of an ellipse 0.79).
const FILLED: f64 = 0.5;

/// What to say of a table whose cells are of another grid than those of a model: cells of one name are other places
/// then. A model reads the cells on the nail, whose box lies in the grid's middle; of cells that were chosen, which
/// fill no box that spans the grid, the grid isn't known.
pub(super) fn other_grid(inputs: &[String], names: &[String]) -> Option<String> {
    let of_model: Vec<[usize; 2]> = inputs.iter().filter_map(|name| cell(name)).collect();
    let side = |cells: &[[usize; 2]], axis: usize, edge: bool| {
        let least = cells.iter().map(|at| at[axis]).min().filter(|_| edge).unwrap_or(0);
        Some(cells.iter().map(|at| at[axis]).max()? + least + 1)
    };
    let sides = |cells: &[[usize; 2]], edge| Some([side(cells, 0, edge)?, side(cells, 1, edge)?]);
    let of_table: Vec<[usize; 2]> = names.iter().filter_map(|name| cell(name)).collect();
    let ([rows, columns], [own_rows, own_columns]) = (sides(&of_model, true)?, sides(&of_table, false)?);
    let spans = [0, 1].map(|axis| {
        let places = || of_model.iter().map(|at| at[axis]);
        Some(1 + places().max()? - places().min()?)
    });
    let [high, wide] = [spans[0]?, spans[1]?];
    if 2 * high < rows || 2 * wide < columns || (of_model.len() as f64) < FILLED * (high * wide) as f64 {
        return None;
    }
    // Other shapes are a choice of somebody's.
    (rows == columns && own_rows == own_columns && rows != own_rows).then(|| {
        format!(
            "has cells of a grid of {own_rows} x {own_rows}, and the model was trained on cells as of {rows} x {rows}: \
             they are other places of the nail; make the table with --cells {rows}"
        )
    })
}

/// That a column is not there, the nearest name and those that are.
pub(crate) fn missing(name: &str, names: &[String]) -> String {
    const MOST: usize = 40;
    if names.iter().all(|name| name.parse::<f64>().is_ok()) {
        return format!("holds numbers where the names of the columns should be. {}", listed(names, 8));
    }
    let alike = |other: &String| {
        let (other, name) = (other.to_lowercase(), name.to_lowercase());
        let stem = other.len() >= 2 && (name.starts_with(&other) || other.starts_with(&name));
        strsim::normalized_damerau_levenshtein(&other, &name) + if stem { 0.5 } else { 0.0 }
    };
    if number(name).is_some() && names.iter().any(|name| name == "P0") {
        return format!(
            "has no column `{name}`. Photodiodes are counted from 1: where `P0` is the first, call them P1, P2, .. in \
             this order. {}",
            listed(names, MOST)
        );
    }
    // P3 is not P4 written wrongly, nor Fx_N Fz_N.
    let both = |is: fn(&str) -> bool, other: &str| is(name) && is(other);
    let another = |other: &str| both(|n| number(n).is_some(), other) || both(|n| FORCES.contains(&n), other);
    let others = names.iter().filter(|other| !another(other));
    let nearest = others.map(|n| (alike(n), n)).filter(|(alike, _)| *alike >= 0.5);
    // Of equals the first.
    let nearest = nearest.rev().max_by(|a, b| a.0.total_cmp(&b.0));
    let help = match nearest {
        None => ".".to_owned(),
        Some((_, near)) if is_force_in_another_unit(near) => {
            format!("; `{near}` is in another unit: write newtons.")
        }
        Some((_, near)) => format!("; is it `{near}`?"),
    };
    format!("has no column `{name}`{help} {}", listed(names, MOST))
}

pub(super) fn listed(names: &[String], most: usize) -> String {
    const LONGEST: usize = 40;
    let shown = |name: &String| name.chars().take(LONGEST).flat_map(char::escape_debug).collect::<String>();
    let mut all: Vec<String> = names.iter().take(most).map(shown).collect();
    if names.len() > most {
        all.push(format!(".. ({} in all)", names.len()));
    }
    format!("Its columns are {}", all.join(", "))
}
