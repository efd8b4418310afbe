//! The table of joint angles that `lunula posture` writes, as far as labels need it.
//!
//! In: CSV or Parquet with `time_s` and `<joint>_deg`; `<joint>_sd_deg`, `clock_s` and columns of its error where
//! they are there. Out: a [`Posture`]. `status` is held against the angles; other columns (`frame`) are not needed. A
//! table of one frame is a table; one of none is refused.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::flexion;
use crate::median::median_of;
use crate::table::{Table, TableError};

/// No joint turns further, degrees: `lunula posture` follows angles past half a turn.
const MOST_DEG: f64 = 720.0;

/// Joint angles over the video's time.
///
/// ```
/// use std::path::Path;
///
/// use lunula::align::Posture;
///
/// let posture = Posture::read(Path::new("fixtures/finger/truth/joints.csv"))?;
/// assert_eq!(posture.joints, ["J1", "J2", "J3"]);
/// assert_eq!(posture.angles_deg[1].len(), posture.time_s.len());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Posture {
    /// The file.
    pub path: PathBuf,
    /// Each frame's presentation time, seconds, ascending.
    pub time_s: Vec<f64>,
    /// What the clock in the picture says, fitted over the video; NaN where it is not known.
    pub clock_s: Vec<f64>,
    /// What `clock_s` was fitted to, and how surely; none where the table does not tell.
    pub clock: Option<ClockColumns>,
    /// The joints' names, in the table's order.
    pub joints: Vec<String>,
    /// For each joint, its angle in each frame, degrees; NaN where it is not known.
    pub angles_deg: Vec<Vec<f64>>,
    /// For each joint, the angle's standard error in each frame, degrees; NaN where it is not known.
    pub sds_deg: Vec<Vec<f64>>,
    /// What to doubt of the table.
    pub warnings: Vec<String>,
}

/// What `lunula posture` reports of the clock in each frame, seconds; NaN where it is not known.
#[derive(Debug, Clone, PartialEq)]
pub struct ClockColumns {
    /// What it was read to show, counted on over midnight.
    pub read_s: Vec<f64>,
    /// The standard error of `clock_s`.
    pub sd_s: Vec<f64>,
    /// The least that `clock_s` can be by all readings.
    pub low_s: Vec<f64>,
    /// The greatest.
    pub high_s: Vec<f64>,
}

impl Posture {
    /// Of joints J1, J2, ... with these angles, each of one standard error, and no clock.
    #[cfg(test)]
    pub(super) fn of(time_s: Vec<f64>, angles_deg: Vec<Vec<f64>>, sd_deg: f64) -> Self {
        Self {
            path: "joints.csv".into(),
            clock_s: vec![f64::NAN; time_s.len()],
            clock: None,
            joints: (1..=angles_deg.len()).map(|k| format!("J{k}")).collect(),
            sds_deg: vec![vec![sd_deg; time_s.len()]; angles_deg.len()],
            warnings: Vec::new(),
            time_s,
            angles_deg,
        }
    }

    /// Whether the clock in the picture was read.
    #[must_use]
    pub fn has_clock(&self) -> bool {
        self.clock_s.iter().any(|clock_s| clock_s.is_finite())
    }

    /// Reads a table of joint angles.
    ///
    /// # Errors
    /// A table that can't be read, without `time_s`, without a joint or without a frame; a frame without a time; times
    /// that do not ascend strictly; a negative standard error. Each names its place.
    pub fn read(path: &Path) -> Result<Self, TableError> {
        let table = Table::read(path)?;
        let refused = |what: &str| TableError::Read { path: path.to_owned(), what: what.to_owned() };
        let time_s = times(&table)?;
        let names = table.names();
        let joints = joints_of(names);
        if joints.is_empty() {
            let names = names.join(", ");
            return Err(refused(&format!(
                "has no column of a joint's angle, such as `J2_deg`; its columns are {names}; give the table that \
                 `lunula posture` writes"
            )));
        }
        if time_s.is_empty() {
            return Err(refused("has no row; labels need frames: look at the video that it was made from"));
        }
        let known = |name: &str| -> Result<Option<Vec<f64>>, TableError> {
            table.has(name).then(|| Ok(missing_as_nan(table.numbers(name)?))).transpose()
        };
        let unknown = || vec![f64::NAN; time_s.len()];
        let mut angles_deg = Vec::with_capacity(joints.len());
        let mut sds_deg = Vec::with_capacity(joints.len());
        for joint in &joints {
            let column = format!("{joint}_deg");
            let angles = missing_as_nan(table.numbers(&column)?);
            if let Some(row) = angles.iter().position(|angle| angle.abs() > MOST_DEG) {
                let what = format!("`{:e}` is no joint's angle in degrees; correct it or leave it empty", angles[row]);
                return Err(table.cell(row, &column, what));
            }
            angles_deg.push(angles);
            let name = format!("{joint}_sd_deg");
            let sds = known(&name)?.unwrap_or_else(unknown);
            if let Some(row) = sds.iter().position(|&sd| sd < 0.0) {
                let what = format!("`{}` is no standard error; correct it or leave it empty", sds[row]);
                return Err(table.cell(row, &name, what));
            }
            sds_deg.push(sds);
        }
        let mut warnings = Vec::new();
        if table.has("status") {
            let mut lost = vec![false; time_s.len()];
            table.each_text("status", |row, status| lost[row] = status.starts_with("lost"))?;
            warnings.extend(empty_lost(&mut angles_deg, &lost));
        }
        let columns = joints.iter().zip(angles_deg.iter().zip(&sds_deg));
        warnings.extend(columns.filter_map(|(joint, (angles, sds))| filled_in(joint, angles, sds)));
        let angles: Vec<&[f64]> = angles_deg.iter().map(Vec::as_slice).collect();
        warnings.extend(flexion::doubts(&joints, &angles));
        warnings.iter_mut().for_each(|warning| *warning = format!("{}: {warning}", path.display()));
        let [read_s, sd_s, low_s, high_s] = ["read", "sd", "low", "high"].map(|what| known(&format!("clock_{what}_s")));
        let clock = match (read_s?, sd_s?, low_s?, high_s?) {
            (Some(read_s), Some(sd_s), Some(low_s), Some(high_s)) => Some(ClockColumns { read_s, sd_s, low_s, high_s }),
            _ => None,
        };
        Ok(Self {
            path: path.to_owned(),
            clock_s: known("clock_s")?.unwrap_or_else(unknown),
            clock,
            time_s,
            joints,
            angles_deg,
            sds_deg,
            warnings,
        })
    }
}

/// Takes away the angles of frames in which a marker that they need was lost, and says so: somebody filled them in.
fn empty_lost(angles_deg: &mut [Vec<f64>], lost: &[bool]) -> Option<String> {
    let is_whole = |row: usize| angles_deg.iter().all(|angles| !angles[row].is_nan());
    let filled: Vec<usize> = (0..lost.len()).filter(|&row| lost[row] && is_whole(row)).collect();
    for angles in angles_deg {
        filled.iter().for_each(|&row| angles[row] = f64::NAN);
    }
    let first = filled.first()?;
    Some(format!(
        "{} frame(s), the first in row {}, have every angle although their `status` says that a marker was lost: they \
         are not used; leave empty what is not known",
        filled.len(),
        first + 1
    ))
}

/// So many frames of one angle to the last digit were not measured where the angle leaps before or after them.
const HELD: usize = 10;
/// An angle to the last digit that stands so often between frames on its other side stands for none.
const OFTEN: usize = 3;
/// A leap: degrees, standard errors, and times as much as angles usually change (assumed: a finger turns back by less
/// within a frame).
const LEAP_DEG: f64 = 2.0;
const LEAP_SDS: f64 = 10.0;
const LEAP_TIMES: f64 = 8.0;

/// What to say of frames whose angle of a joint stands for none, or was held. Angles whose standard error is 0, or
/// not known, are not measured.
fn filled_in(joint: &str, angles_deg: &[f64], sds_deg: &[f64]) -> Option<String> {
    let is_measured = |row: &usize| angles_deg[*row].is_finite() && sds_deg[*row] > 0.0;
    let known: Vec<usize> = (0..angles_deg.len()).filter(is_measured).collect();
    // Where digits are fewer than the error allows, a finger that rests has one angle.
    let digit_deg = 10f64.powf((median_of(known.iter().map(|&row| sds_deg[row]))? / 3.0).log10().floor());
    let is_coarse = |row: &usize| (angles_deg[*row] / digit_deg - (angles_deg[*row] / digit_deg).round()).abs() < 1e-6;
    if known.iter().all(is_coarse) {
        return None;
    }
    let runs: Vec<&[usize]> = known.chunk_by(|a, b| angles_deg[*a] == angles_deg[*b]).collect();
    let by_deg = |pair: &[&[usize]]| angles_deg[pair[1][0]] - angles_deg[pair[0][0]];
    let usual_deg = median_of(runs.windows(2).map(|pair| by_deg(pair).abs()))?;
    let leaps = |pair: &[&[usize]]| {
        let sd_deg = sds_deg[pair[0][0]].hypot(sds_deg[pair[1][0]]);
        by_deg(pair).abs() > LEAP_DEG.max(LEAP_SDS * sd_deg).max(LEAP_TIMES * usual_deg)
    };
    // Of each value: where it stands first, in how many frames, and whether one after the other.
    let mut odd: BTreeMap<u64, (usize, usize, bool)> = BTreeMap::new();
    for around in runs.windows(3) {
        let [before, after] = [&around[..2], &around[1..]];
        let is_held = around[1].len() >= HELD && (leaps(before) || leaps(after));
        let stands_out = leaps(before) && leaps(after) && by_deg(before) * by_deg(after) < 0.0;
        if is_held || stands_out {
            let first = around[1][0];
            let (_, frames, held) = odd.entry(angles_deg[first].to_bits()).or_insert((first, 0, false));
            *frames += around[1].len();
            *held |= is_held;
        }
    }
    let often = odd.into_values().filter(|(_, frames, held)| *held || *frames >= OFTEN);
    let (first, frames, _) = often.max_by_key(|(first, frames, _)| (*frames, usize::MAX - first))?;
    Some(format!(
        "{joint} is exactly {} in {frames} frame(s), the first in row {}, far from the frames around them: was it \
         filled in? Leave empty what is not known",
        angles_deg[first],
        first + 1
    ))
}

/// `J2_deg` is the angle of `J2`; `J2_sd_deg` is nobody's angle.
pub(super) fn joints_of(columns: &[String]) -> Vec<String> {
    let named = columns.iter().filter_map(|column| column.strip_suffix("_deg"));
    named.filter(|joint| !joint.is_empty() && !joint.ends_with("_sd")).map(str::to_owned).collect()
}

pub(super) fn missing_as_nan(cells: Vec<Option<f64>>) -> Vec<f64> {
    cells.into_iter().map(|cell| cell.unwrap_or(f64::NAN)).collect()
}

/// The frames' times, checked.
fn times(table: &Table) -> Result<Vec<f64>, TableError> {
    const NAME: &str = "time_s";
    let mut times_s: Vec<f64> = Vec::with_capacity(table.rows());
    for (row, time_s) in table.numbers(NAME)?.into_iter().enumerate() {
        let Some(time_s) = time_s else {
            return Err(table.cell(
                row,
                NAME,
                "is empty; every frame has a time: fill it in or delete the row".to_owned(),
            ));
        };
        if let Some(&before) = times_s.last().filter(|&&before| time_s <= before) {
            let what = format!(
                "{time_s} comes after {before}; times must ascend: sort the rows and delete what is there twice"
            );
            return Err(table.cell(row, NAME, what));
        }
        times_s.push(time_s);
    }
    Ok(times_s)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Posture, String> {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("joints.csv");
        std::fs::write(&path, text).unwrap();
        Posture::read(&path).map_err(|e| e.to_string())
    }

    /// NaN is equal to NaN here.
    fn same(a: &[f64], b: &[f64]) -> bool {
        a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a == b || a.is_nan() && b.is_nan())
    }

    #[test]
    fn frames_that_were_filled_in_have_no_angle_and_radians_are_doubted() {
        let filled = read("time_s,J1_deg,J2_deg,status\n0,1,40,ok\n1,0,0,lost: a\n2,,5,lost: b\n").unwrap();
        assert!(same(&filled.angles_deg.concat(), &[1.0, f64::NAN, f64::NAN, 40.0, f64::NAN, 5.0]));
        assert!(filled.warnings[0].contains("joints.csv: 1 frame(s), the first in row 2, have every angle"));
        assert_eq!(filled.warnings.len(), 1);
        let of = |most: &str| read(&format!("time_s,J2_deg\n0,0\n1,{most}\n")).unwrap().warnings.concat();
        assert!(of("1.4").contains("no angle is further from 0 than 1.40 degrees"), "{}", of("1.4"));
        assert_eq!([of("0.2"), of("4")].concat(), "");
    }

    #[test]
    fn angles_that_were_filled_in_are_doubted() {
        let said = |sd: f64, of: &dyn Fn(usize, f64) -> f64| {
            let angle = |k: usize| 40.0 - 35.0 * (0.05 * k as f64).cos() + 0.03 * ((k * 7) % 11) as f64;
            let row = |k: usize| format!("{k},{:.4},{sd}\n", of(k, angle(k)));
            let rows = (0..300).map(row).collect::<String>();
            read(&format!("time_s,J2_deg,J2_sd_deg\n{rows}")).unwrap().warnings.concat()
        };
        assert_eq!(said(0.2, &|_, angle| angle), "");
        let zeros = said(0.2, &|k, angle| if (100..190).contains(&k) { 0.0 } else { angle });
        assert!(zeros.contains("J2 is exactly 0 in 90 frame(s), the first in row 101, far from"), "{zeros}");
        let none = said(0.2, &|k, angle| if k % 7 == 3 { -1.0 } else { angle });
        assert!(none.contains("J2 is exactly -1 in ") && none.contains("far from the frames around"), "{none}");
        let held = said(0.2, &|k, angle| if (130..150).contains(&k) { 22.0 } else { angle });
        assert!(held.contains("J2 is exactly 22 in 20 frame(s), the first in row 131, far from"), "{held}");
        // Whole degrees, a rest, which may be smoothed, or is known exactly, one glitch.
        assert_eq!(said(0.2, &|k, angle| if k > 62 { 75.2 } else { angle }), "");
        assert_eq!(said(0.2, &|_, angle| angle.round()), "");
        assert_eq!(said(0.2, &|k, _| if k % 100 < 50 { 10.0 } else { 41.0 }), "");
        assert_eq!(said(0.0, &|k, angle| if (100..190).contains(&k) { 0.0 } else { angle }), "");
        assert_eq!(said(0.2, &|k, angle| if k == 70 { 99.0 } else { angle }), "");
    }

    #[test]
    fn angles_that_a_finger_cannot_have_are_doubted() {
        let bent = |sign: f64| {
            let row = |k: i32| format!("{k},{}\n", sign * 0.8 * f64::from(k));
            read(&format!("time_s,J2_deg\n{}", (0..100).map(row).collect::<String>())).unwrap().warnings.concat()
        };
        assert_eq!(bent(1.0), "");
        let negated = bent(-1.0);
        assert!(negated.contains("joints.csv: angles that a finger can't have: J2") && negated.contains("is positive"));
    }

    #[test]
    fn the_table_of_posture_is_read() {
        let posture = read(
            "frame,time_s,clock_s,J2_deg,J2_sd_deg,thumb_deg,thumb_sd_deg,status,\
             clock_read_s,clock_sd_s,clock_low_s,clock_high_s\n\
             0,0,71,12.5,0.02,30,0.03,ok,71,0.02,70.99,71.01\n\
             1,0.033367,71.033,,,31,0.03,lost: a,,0.01,71,71.05\n",
        )
        .unwrap();
        assert_eq!(posture.joints, ["J2", "thumb"]);
        assert_eq!((posture.time_s, posture.clock_s), (vec![0.0, 0.033_367], vec![71.0, 71.033]));
        assert!(same(&posture.angles_deg.concat(), &[12.5, f64::NAN, 30.0, 31.0]));
        assert!(same(&posture.sds_deg.concat(), &[0.02, f64::NAN, 0.03, 0.03]));
        let clock = posture.clock.unwrap();
        assert!(same(&clock.read_s, &[71.0, f64::NAN]));
        assert_eq!((clock.sd_s[1], clock.low_s[0], clock.high_s[1]), (0.01, 70.99, 71.05));
    }

    #[test]
    fn the_tables_of_others_need_a_time_and_an_angle_only() {
        let posture = read("time_s,J2_deg\n-1.5,3\n").unwrap();
        assert_eq!((posture.time_s, posture.angles_deg), (vec![-1.5], vec![vec![3.0]]));
        assert!(posture.clock_s[0].is_nan() && posture.sds_deg[0][0].is_nan() && posture.clock.is_none());
        let posture = read("note,J2_sd_deg,J2_deg,knee left_deg,time_s\nx,0.1,1,,0\ny,,2,,1\n").unwrap();
        assert_eq!(posture.joints, ["J2", "knee left"]);
        assert!(same(&posture.sds_deg[0], &[0.1, f64::NAN]) && posture.angles_deg[1].iter().all(|a| a.is_nan()));
    }

    #[test]
    fn what_is_wrong_is_named_with_its_place() {
        for (text, words) in [
            ("time_s,J2_deg\n0,1\n0.1,2\n0.1,3\n", "joints.csv:4: column `time_s`: 0.1 comes after 0.1"),
            ("time_s,J2_deg\n0,1\n-1,2\n", "joints.csv:3: column `time_s`: -1 comes after 0"),
            ("time_s,J2_deg\n0,1\n,2\n", "joints.csv:3: column `time_s`: is empty"),
            ("time_s,J2_deg\n0,1\nnan,2\n", "joints.csv:3: column `time_s`: `NaN` is no finite number"),
            ("time_s,J2_deg\n0,1\n1,1e300\n", "joints.csv:3: column `J2_deg`: `1e300` is no joint's angle"),
            ("time_s,J2_deg\n0,1\n1,ok\n", "joints.csv:3: column `J2_deg`: `ok` is no finite number"),
            ("time_s,J2_deg,J2_sd_deg\n0,1,-0.5\n", "joints.csv:2: column `J2_sd_deg`: `-0.5` is no standard error"),
            ("frame,J2_deg\n0,1\n", "has no column `time_s`"),
            (
                "time_s,_deg,J2_sd_deg\n0,1,2\n",
                "no column of a joint's angle, such as `J2_deg`; its columns are time_s",
            ),
            ("time_s,J2_deg\n", "has no row"),
            ("", "is empty"),
        ] {
            let error = read(text).unwrap_err();
            assert!(error.contains(words) && error.contains("joints.csv"), "{error}");
        }
    }
}
