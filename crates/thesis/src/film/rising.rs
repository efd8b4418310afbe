//! One nail under rising force (Fig. 5): its normalized frames, averaged near each force of a row of forces.
//!
//! In: the folder `frames` and `photodiodes.csv` of `lunula nailvideo`, and the log with `Fz_N` on the video's clock.
//! Out: `rising.png`, `.svg`; `numbers.json`, how the regions over the bone and at the tip change up to 1 N and from
//! there to 4 N, shares of full scale. Only frames before the greatest pressing are used; a force that was not reached,
//! or that no frame is near to, has no picture.

use std::path::Path;

use anyhow::{Context, ensure};
use image::GrayAlphaImage;
use ndarray::{Array2, Axis, Slice};

use super::pair::pressing_n;
use crate::Numbers;
use crate::coloration::{grey_picture, region_mean};
use lunula::figure::{Scale, Sheet, Stretch, Tile, TilePicture, grey_map};
use lunula::files::Staging;
use lunula::table::Table;

/// The forces shown, newtons (Fig. 5 names none).
const FORCES_N: [f64; 8] = [0.0, 0.25, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0];
/// How far off a frame's force may be: a quarter of the smallest step.
const NEAR_N: f64 = 0.0625;
const COLUMNS: usize = 4;
/// The grey levels go from and to these shares of the values within the pictures' middle halves.
const SHARES: [f64; 2] = [0.01, 0.99];

/// Draws the sheet into `out`; gives the forces shown.
///
/// # Errors
/// A file that can't be read, no frame near any force, a folder that can't be written to.
pub(crate) fn rising(frames: &Path, photodiodes: &Path, log: &Path, out: &Path) -> anyhow::Result<Vec<f64>> {
    let shown = near_forces(frames, photodiodes, log)?;
    ensure!(!shown.is_empty(), "{}: no frame is within {NEAR_N} N of a force shown", frames.display());
    let staging = Staging::new(out)?;
    staging.write("numbers.json", numbers(&shown).to_text().as_bytes())?;
    let sheet = sheet(&shown);
    staging.write("rising.png", &sheet.png()?)?;
    staging.write("rising.svg", sheet.svg()?.as_bytes())?;
    staging.commit()?;
    Ok(shown.into_iter().map(|(force_n, _)| force_n).collect())
}

/// The forces that frames are near to, each with their mean.
fn near_forces(frames: &Path, photodiodes: &Path, log: &Path) -> anyhow::Result<Vec<(f64, Array2<f32>)>> {
    let table = Table::read(photodiodes)?;
    let index = table.integers("frame")?;
    let times_s: Vec<f64> = table.numbers("time_s")?.into_iter().map(|time| time.unwrap_or(f64::NAN)).collect();
    let pressing_n = pressing_n(log, &times_s)?;
    let known = (0..pressing_n.len()).filter(|&row| pressing_n[row].is_finite());
    let last = known.max_by(|&a, &b| pressing_n[a].total_cmp(&pressing_n[b])).context("no frame has a force")?;
    let mut shown = Vec::new();
    for force_n in FORCES_N {
        let near = (0..=last).filter(|&row| (pressing_n[row] - force_n).abs() <= NEAR_N);
        let paths = near.filter_map(|row| Some(frames.join(format!("{:06}.png", index[row]?))));
        let pictures = paths.filter(|path| path.is_file()).map(|path| grey_picture(&path));
        let pictures: Vec<Array2<f32>> = pictures.collect::<Result<_, _>>()?;
        let count = pictures.len() as f32;
        let sum = pictures.into_iter().reduce(|sum, one| sum + one);
        shown.extend(sum.map(|sum| (force_n, sum / count)));
    }
    Ok(shown)
}

/// Changes of regions from one force to another.
fn numbers(shown: &[(f64, Array2<f32>)]) -> Numbers {
    let mut numbers = Numbers::default();
    let value = |name: &str, force_n: f64| {
        shown.iter().find(|(own, _)| *own == force_n).and_then(|(_, map)| region_mean(map, name))
    };
    let change = |name: &str, [from_n, to_n]: [f64; 2]| Some(value(name, to_n)? - value(name, from_n)?);
    for name in ["bone", "tip"] {
        numbers.set(format!("{name}_to_1N"), change(name, [0.0, 1.0]));
        numbers.set(format!("{name}_beyond_1N"), change(name, [1.0, 4.0]));
    }
    numbers
}

/// From nearly the darkest to nearly the lightest value within the middle halves of all pictures.
fn stretch(shown: &[(f64, Array2<f32>)]) -> Stretch {
    let half = |size: usize| Slice::from(size / 4..3 * size / 4);
    let inner = |(_, map): &(f64, Array2<f32>)| {
        let rows = map.slice_axis(Axis(0), half(map.nrows()));
        let middle = rows.slice_axis(Axis(1), half(map.ncols()));
        middle.iter().copied().filter(|value| value.is_finite()).collect()
    };
    let mut middle: Vec<f32> = shown.iter().flat_map::<Vec<f32>, _>(inner).collect();
    middle.sort_by(f32::total_cmp);
    let at = |share: f64| middle.get((share * middle.len().saturating_sub(1) as f64) as usize).copied();
    let [low, high] = SHARES.map(|share| at(share).unwrap_or(f32::NAN));
    Stretch::Linear { low, high }
}

fn sheet(shown: &[(f64, Array2<f32>)]) -> Sheet {
    let stretch = stretch(shown);
    let tile = |(force_n, map): &(f64, Array2<f32>)| {
        let picture: GrayAlphaImage = grey_map(map, stretch);
        Tile { caption: format!("{force_n} N"), picture: TilePicture::Grey(picture), png: None }
    };
    Sheet {
        title: "The nail under rising normal force, green".to_owned(),
        tiles: shown.iter().map(tile).collect(),
        columns: COLUMNS,
        scale: Some(Scale { stretch, label: "intensity, % of full scale".to_owned() }),
    }
}
