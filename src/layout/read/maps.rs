//! The results of `lunula photos` to the separation of poses.
//!
//! In: `maps/POSE-mean.npy` and `normalized/POSE/SUBJECT.png`, those that `nails.csv` lists where that is there: others
//! are of an earlier run. A candidate is a cell of a grid over the normalized
//! picture, and its reading the mean of the cell's pixels, fraction of full scale. Out: the differences of poses'
//! means, one column for each two poses, and the covariance of subjects about their pose's mean, pooled over poses.
//!
//! The pictures hold skin around the nail, and no outline: cells outside of |u|^3 + |v|^3 = 1 (assumed; a phantom's
//! nails lie about there) are left out.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use image::DynamicImage;
use lunula_predictor::{Criterion, LayoutProblem, Moments};
use ndarray::{Array1, Array2};
use rayon::prelude::*;

use super::given::{Contrast, Given, LeftOutCandidates, Parts, PersonFigures, Target, WithoutSubject, pairs};
use super::places::{MARGIN, Place, middle};
use crate::input;
use crate::layout::error::LayoutError;
use crate::layout::options::LayoutOptions;
use crate::npy;
use crate::photograph::{Photograph, is_picture};
use crate::table::Table;

const MEAN: &str = "-mean.npy";
/// Pictures of so many poses and subjects are read at most (assumed).
const MOST_PICTURES: usize = 100_000;
/// The largest normalized picture, megapixels.
const MOST_MEGAPIXELS: u32 = 25;

/// Whether a folder holds maps.
pub(in crate::layout) fn is_maps(folder: &Path) -> bool {
    poses(folder).is_ok_and(|poses| !poses.is_empty())
}

/// The poses of which there is a mean map, sorted.
fn poses(folder: &Path) -> Result<Vec<String>, LayoutError> {
    let names = listed(&folder.join("maps"))?;
    Ok(names.iter().filter_map(|name| name.strip_suffix(MEAN)).map(str::to_owned).collect())
}

/// The names in a folder, sorted.
fn listed(folder: &Path) -> Result<Vec<String>, LayoutError> {
    let paths = input::list(folder).map_err(|why| LayoutError::input(folder, why.to_string()))?;
    Ok(paths.iter().filter_map(|path| Some(path.file_name()?.to_str()?.to_owned())).collect())
}

/// A subject's readings of a pose; NaN where a cell is not seen.
struct Reading {
    pose: usize,
    subject: String,
    values: Vec<f64>,
}

impl Reading {
    /// Those of some cells.
    fn at(&self, kept: &[usize]) -> Array1<f64> {
        kept.iter().map(|&k| self.values[k]).collect()
    }
}

pub(super) fn read(folder: &Path, options: &LayoutOptions) -> Result<Given, LayoutError> {
    let listed = nails(folder)?;
    let is_of_run = |pose: &String| listed.as_ref().is_none_or(|listed| listed.contains_key(pose));
    let (poses, strays): (Vec<String>, Vec<String>) = poses(folder)?.into_iter().partition(is_of_run);
    let mut strays: Vec<String> = strays.into_iter().map(|pose| format!("maps/{pose}{MEAN}")).collect();
    if poses.len() < 2 {
        return Err(LayoutError::input(
            &folder.join("maps"),
            "has maps of one pose; there are no others to separate it from",
        ));
    }
    let n = options.cells as usize;
    let said_margin = margin_of(folder)?;
    let margin = said_margin.unwrap_or(MARGIN);
    let readings = read_all(folder, &poses, listed.as_ref(), n, &mut strays)?;
    let all = (0..n * n).map(|k| middle(format!("C_{:02}_{:02}", k / n, k % n), [k / n, k % n], n, margin));
    let all: Vec<Place> = all.collect();
    let mut left_out = LeftOutCandidates::default();
    let mut kept = Vec::new();
    for (k, place) in all.iter().enumerate() {
        if !place.is_inside(options) || place.u.abs().powi(3) + place.v.abs().powi(3) > 1.0 {
            left_out.edge += 1;
        } else if readings.iter().any(|one| one.values[k].is_nan()) {
            left_out.missing += 1;
        } else {
            kept.push(k);
        }
    }
    let subjects: BTreeSet<&str> = readings.iter().map(|one| one.subject.as_str()).collect();
    LayoutProblem::fits(kept.len(), subjects.len())?;
    let everybody: Vec<&Reading> = readings.iter().collect();
    let largest = options.k.0.last().copied().unwrap_or(1);
    let (moments, _, freedom) = moments(&everybody, &poses, &kept);
    if freedom < 2 * largest {
        let what = format!(
            "{} pictures of {} poses leave {freedom} degrees of freedom for the covariance of subjects, and \
             {largest} photodiodes take {} at least; photograph more subjects, or lower --k",
            readings.len(),
            poses.len(),
            2 * largest
        );
        return Err(LayoutError::input(&folder.join("normalized"), what));
    }
    let without = |subject: &&str| {
        let (own, others): (Vec<&Reading>, Vec<&Reading>) = readings.iter().partition(|one| one.subject == **subject);
        let (moments, means, freedom) = moments_of_all_poses(&others, &poses, &kept)?;
        let own = own.into_iter().map(|one| (one.pose, one.at(&kept))).collect();
        (freedom >= largest).then_some(WithoutSubject { moments, means, own })
    };
    let parts: Vec<WithoutSubject> = subjects.iter().filter_map(without).collect();
    let persons = |subject: &&str| {
        let rows = readings.iter().filter(|one| one.subject == **subject).count();
        PersonFigures { name: (*subject).to_owned(), rows, incomplete: 0 }
    };
    let targets =
        pairs(poses.len()).map(|[a, b]| Target { name: format!("{} / {}", poses[a], poses[b]), sd: Vec::new() });
    Ok(Given {
        criterion: Criterion::Confusion,
        places: kept.iter().map(|&k| all[k].clone()).collect(),
        moments: vec![moments],
        parts: Parts::Subjects(if parts.len() == subjects.len() { parts } else { Vec::new() }),
        persons: subjects.iter().map(persons).collect(),
        targets: targets.collect(),
        left_out,
        rows: freedom,
        contrast: Some(contrast(folder, &poses, margin)?),
        notes: said_margin.is_none().then(|| assumed(folder)).into_iter().collect(),
        warnings: warning_of(&strays, folder).into_iter().collect(),
    })
}

/// Subjects by pose.
type Subjects = BTreeMap<String, BTreeSet<String>>;

/// The poses and subjects that were used, where a table says so.
fn nails(folder: &Path) -> Result<Option<Subjects>, LayoutError> {
    let path = folder.join("nails.csv");
    if !path.exists() {
        return Ok(None);
    }
    let table = Table::read(&path)?;
    let mut all = Subjects::new();
    let rows = table.texts("pose")?.into_iter().zip(table.texts("subject")?).zip(table.texts("used")?);
    for ((pose, subject), used) in rows {
        if let (Some(pose), Some(subject), Some("true")) = (pose, subject, used.as_deref()) {
            all.entry(pose).or_default().insert(subject);
        }
    }
    Ok(Some(all))
}

fn warning_of(strays: &[String], folder: &Path) -> Option<String> {
    let [first, others @ ..] = strays else { return None };
    let more = if others.is_empty() { String::new() } else { format!(" and {} more", others.len()) };
    Some(format!(
        "{}{more}: not in nails.csv, so of an earlier run, and left out; write each run into a folder of its own",
        folder.join(first).display()
    ))
}

fn assumed(folder: &Path) -> String {
    format!(
        "{} has no run.json, which says how much of the nail's surroundings its pictures show: {MARGIN} times the \
         nail's box is assumed, as `lunula photos` makes them unless --margin says otherwise",
        folder.display()
    )
}

/// The pictures' side over the nail's box, as the report beside the maps says it; none where there is no report.
///
/// # Errors
/// A report of something else.
fn margin_of(folder: &Path) -> Result<Option<f64>, LayoutError> {
    let path = folder.join("run.json");
    // A pipeline's results have none.
    let Ok(text) = std::fs::read_to_string(&path) else { return Ok(None) };
    let report: serde_json::Value = serde_json::from_str(&text).unwrap_or_default();
    let margin = report["normalization"]["margin"].as_f64().filter(|margin| (1.0..=10.0).contains(margin));
    margin.map(Some).ok_or_else(|| {
        let what = "is not the report of `lunula photos` on these pictures, which says how much of the nail's \
                    surroundings they show; run `lunula photos` again";
        LayoutError::input(&path, what)
    })
}

/// Every subject's readings of every pose; pictures that are not listed become strays.
fn read_all(
    folder: &Path,
    poses: &[String],
    listed_nails: Option<&Subjects>,
    n: usize,
    strays: &mut Vec<String>,
) -> Result<Vec<Reading>, LayoutError> {
    let mut files = Vec::new();
    let normalized = folder.join("normalized");
    if !normalized.is_dir() {
        let what = "is not there: the nails' normalized pictures, which `lunula photos merge` leaves with the parts; \
                    name a folder that `lunula photos` wrote of all photographs at once";
        return Err(LayoutError::input(&normalized, what));
    }
    for (pose, name) in poses.iter().enumerate() {
        let place = normalized.join(name);
        let pictures: Vec<String> = listed(&place)?.into_iter().filter(|file| is_picture(Path::new(file))).collect();
        let subjects = listed_nails.and_then(|nails| nails.get(name));
        let stems = subjects.cloned().unwrap_or_else(|| pictures.iter().map(|file| stem(file)).collect());
        for file in pictures {
            let own = stem(&file);
            // `ann-2` is another picture of ann, where there is one of her.
            let first = own.rsplit_once('-').filter(|(subject, number)| {
                stems.contains(*subject) && !number.is_empty() && number.bytes().all(|b| b.is_ascii_digit())
            });
            let first = first.filter(|_| subjects.is_none_or(|subjects| !subjects.contains(&own)));
            let subject = first.map_or(own.clone(), |(subject, _)| subject.to_owned());
            if subjects.is_none_or(|subjects| subjects.contains(&subject)) {
                files.push((pose, subject, place.join(&file)));
            } else {
                strays.push(format!("normalized/{name}/{file}"));
            }
        }
    }
    if files.len() > MOST_PICTURES {
        return Err(LayoutError::input(folder, format!("has {} pictures; {MOST_PICTURES} are the most", files.len())));
    }
    let read = |(pose, subject, path): &(usize, String, std::path::PathBuf)| {
        let picture = Photograph::read_up_to(path, MOST_MEGAPIXELS);
        let picture = picture.map_err(|why| LayoutError::input(path, why.to_string()))?;
        Ok(Reading { pose: *pose, subject: subject.clone(), values: cell_means(&picture.image, n) })
    };
    files.par_iter().map(read).collect()
}

fn stem(file: &str) -> String {
    Path::new(file).file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned())
}

/// The mean of each cell of `n` x `n`, fraction of full scale; NaN where a pixel of it is not seen.
fn cell_means(picture: &DynamicImage, n: usize) -> Vec<f64> {
    let levels = picture.to_luma_alpha16();
    let (width, height) = (levels.width() as usize, levels.height() as usize);
    let (mut sums, mut counts) = (vec![0.0; n * n], vec![0_u32; n * n]);
    for (x, y, pixel) in levels.enumerate_pixels() {
        let at = y as usize * n / height * n + x as usize * n / width;
        counts[at] += 1;
        sums[at] += if pixel.0[1] == 0 { f64::NAN } else { f64::from(pixel.0[0]) };
    }
    sums.iter().zip(counts).map(|(sum, count)| sum / (65535.0 * f64::from(count))).collect()
}

/// The moments, where every pose has a picture.
fn moments_of_all_poses(readings: &[&Reading], poses: &[String], kept: &[usize]) -> Option<MomentsOfPoses> {
    let all = (0..poses.len()).all(|pose| readings.iter().any(|one| one.pose == pose));
    (all && readings.len() > poses.len()).then(|| moments(readings, poses, kept))
}

/// Covariance about the poses' means and differences of these; these; and the covariance's degrees of freedom.
type MomentsOfPoses = (Moments, Vec<Array1<f64>>, usize);

fn moments(readings: &[&Reading], poses: &[String], kept: &[usize]) -> MomentsOfPoses {
    let mut by_pose: BTreeMap<usize, Vec<Array1<f64>>> = BTreeMap::new();
    readings.iter().for_each(|one| by_pose.entry(one.pose).or_default().push(one.at(kept)));
    let mut means = vec![Array1::<f64>::zeros(kept.len()); poses.len()];
    let mut centred: Vec<Array1<f64>> = Vec::new();
    for (pose, rows) in by_pose {
        let mut mean = Array1::<f64>::zeros(kept.len());
        rows.iter().for_each(|row| mean += row);
        mean /= rows.len() as f64;
        centred.extend(rows.into_iter().map(|row| row - &mean));
        means[pose] = mean;
    }
    let freedom = readings.len().saturating_sub(poses.len());
    let x = Array2::from_shape_fn((centred.len(), kept.len()), |(row, k)| centred[row][k]);
    let c = x.t().dot(&x) / freedom.max(1) as f64;
    let between: Vec<[usize; 2]> = pairs(poses.len()).collect();
    let b = Array2::from_shape_fn((kept.len(), between.len()), |(k, pair)| {
        let [a, b] = between[pair];
        means[a][k] - means[b][k]
    });
    (Moments { c, b }, means, freedom)
}

/// The SD of the mean maps over poses.
fn contrast(folder: &Path, poses: &[String], margin: f64) -> Result<Contrast, LayoutError> {
    let mut maps: Vec<Array2<f32>> = Vec::new();
    for pose in poses {
        let path = folder.join("maps").join(format!("{pose}{MEAN}"));
        let map = npy::read::<f32>(&path).map_err(|why| LayoutError::input(&path, why))?;
        if maps.first().is_some_and(|first| first.dim() != map.dim()) {
            let what = "has another size than the map of the first pose; make the maps again, at once";
            return Err(LayoutError::input(&path, what));
        }
        maps.push(map);
    }
    let count = maps.len() as f32;
    let sd = Array2::from_shape_fn(maps[0].dim(), |at| {
        let mean = maps.iter().map(|map| map[at]).sum::<f32>() / count;
        (maps.iter().map(|map| (map[at] - mean).powi(2)).sum::<f32>() / count).sqrt()
    });
    Ok(Contrast { sd, margin })
}
