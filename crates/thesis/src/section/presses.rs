//! Recorded presses of people on a photodiode's place (4.3.4), for Fig. 79 to 82.
//!
//! In: tables as `lunula fit` reads them, a person and a place each: `Fz_N` and the photodiode of the pressed place,
//! `VP1` proximal or `VP2` distal, in volts. With `time_s` it is a quick press: pressed as quickly as one can, held,
//! let go. Without, it is a static curve. The force is the finger's on the surface: pressing is negative; it presses on
//! 1 cm2.
//!
//! Out: [`Presses`]. Static curves are brought to common forces, every [`STEP_N`] as far as all reach, straight between
//! rows; a quick press begins, and is let go, where the force leaves rest, or its height, on the way through half of
//! it.

use std::path::Path;

use anyhow::{Context, bail};

use super::experiments::{Presses, QuickPress, SITES};
use super::people::{Recorded, pressures, trace};
use lunula::hemodynamics::Pressed;
use lunula::table::Table;
use lunula_hemodynamics::{Load, Recording};

/// Between two forces of a static curve, newtons.
const STEP_N: f64 = 0.05;
/// No static curve is reported beyond this, newtons.
const MOST_N: f64 = 2.0;
/// Of a quick press' height: what is none of rest or of holding any more.
const LEAVES: f64 = 0.05;

/// A table, and whose it is.
#[derive(Debug, Clone)]
pub(crate) struct PressFile<'a> {
    /// The table.
    pub(crate) path: &'a Path,
    /// What results call it.
    pub(crate) name: &'a str,
    pub(crate) subject: &'a str,
}

/// A table's columns.
struct Pressing {
    subject: String,
    site: Pressed,
    times_s: Option<Vec<f64>>,
    force_n: Vec<f64>,
    volts: Vec<f64>,
}

/// Reads presses.
///
/// # Errors
/// A table that can't be read or lacks a column; the words name it.
pub(crate) fn read_presses(files: &[PressFile<'_>]) -> anyhow::Result<Presses> {
    let all = files.iter().map(read).collect::<anyhow::Result<Vec<_>>>()?;
    let mut presses = Presses::default();
    for (k, site) in SITES.into_iter().enumerate() {
        let own = || all.iter().filter(move |one| one.site == site);
        let reach =
            own().filter(|one| one.times_s.is_none()).map(|one| one.force_n.iter().copied().fold(0.0, f64::max));
        let reach = reach.fold(MOST_N, f64::min);
        for one in own() {
            match &one.times_s {
                None => presses.slow[k].push(slow(one, reach)?),
                Some(times_s) => presses.quick[k].push(quick(one, times_s)?),
            }
        }
    }
    Ok(presses)
}

fn read(file: &PressFile<'_>) -> anyhow::Result<Pressing> {
    let table = Table::read(file.path).with_context(|| file.name.to_owned())?;
    let (site, light) = match (table.has("VP1"), table.has("VP2")) {
        (true, false) => (Pressed::Proximal, "VP1"),
        (false, true) => (Pressed::Distal, "VP2"),
        _ => bail!("{}: has to have the pressed place's photodiode alone: VP1 (proximal) or VP2 (distal)", file.name),
    };
    if !table.has("Fz_N") {
        bail!("{}: has no column Fz_N, the force that presses (negative)", file.name);
    }
    let column = |name: &str| table.values(name).with_context(|| file.name.to_owned());
    let (force, volts) = (column("Fz_N")?, column(light)?);
    let times_s = if table.has("time_s") { Some(column("time_s")?) } else { None };
    let known = |row: &usize| {
        force[*row].is_finite()
            && volts[*row].is_finite()
            && times_s.as_ref().is_none_or(|times_s| times_s[*row].is_finite())
    };
    let rows: Vec<usize> = (0..force.len()).filter(known).collect();
    if rows.len() < 3 {
        bail!("{}: has fewer than three rows with force and light", file.name);
    }
    let of = |values: &[f64]| -> Vec<f64> { rows.iter().map(|&row| values[row]).collect() };
    // Minus zero is zero.
    let force_n = of(&force).into_iter().map(|force| 0.0 - force).collect();
    let times_s = times_s.map(|times_s| of(&times_s));
    Ok(Pressing { subject: file.subject.to_owned(), site, times_s, force_n, volts: of(&volts) })
}

fn slow(one: &Pressing, reach: f64) -> anyhow::Result<Recorded> {
    let mut points: Vec<[f64; 2]> = one.force_n.iter().zip(&one.volts).map(|(&force, &volts)| [force, volts]).collect();
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let steps = (reach / STEP_N + 1e-6).floor() as usize;
    if steps < 4 {
        bail!("subject {}: a slow press reaches {reach:.2} N; press to 2 N", one.subject);
    }
    let force_n: Vec<f64> = (0..=steps).map(|k| STEP_N * k as f64).collect();
    let volts = force_n.iter().map(|&force| between(&points, force)).collect();
    let [proximal, distal] = pressures(one.site, &force_n);
    let recording = Recording::steady(proximal, distal, vec![trace(one.site, volts)]);
    Ok(Recorded { recording: recording.of(&one.subject), force_n, times_s: None })
}

/// On the straight way between the points next to a force.
fn between(points: &[[f64; 2]], force: f64) -> f64 {
    let after = points.partition_point(|point| point[0] < force).min(points.len() - 1);
    let [x1, y1] = points[after];
    let [x0, y0] = points[after.saturating_sub(1)];
    if x1 > x0 && force < x1 { y0 + (force - x0).max(0.0) * (y1 - y0) / (x1 - x0) } else { y1 }
}

fn quick(one: &Pressing, times_s: &[f64]) -> anyhow::Result<QuickPress> {
    let height = one.force_n.iter().copied().fold(0.0, f64::max);
    let over = |at: usize| one.force_n[at] >= 0.5 * height;
    let last = one.force_n.len() - 1;
    let (Some(up), Some(down)) = ((0..=last).find(|&at| over(at)), (0..=last).rev().find(|&at| over(at))) else {
        bail!("subject {}: a quick press has no force", one.subject);
    };
    if height <= 0.0 || up == 0 || down == last {
        bail!("subject {}: a quick press has to begin and to end without force", one.subject);
    }
    let held = {
        let mut middle: Vec<f64> = one.force_n[up..=down].to_vec();
        middle.sort_by(f64::total_cmp);
        middle[middle.len() / 2]
    };
    let begins = (0..up).rev().find(|&at| one.force_n[at] <= LEAVES * held).unwrap_or(0);
    let ends = (up..=down).rev().find(|&at| one.force_n[at] >= (1.0 - LEAVES) * held).unwrap_or(down);
    let [proximal, distal] =
        pressures(one.site, &one.force_n).map(|pa| Load::table(times_s, &pa).map_err(|why| anyhow::anyhow!("{why}")));
    let trace = trace(one.site, one.volts.clone());
    let recording = Recording::transient(times_s.to_vec(), proximal?, distal?, vec![trace]).of(&one.subject);
    let recorded = Recorded { recording, force_n: one.force_n.clone(), times_s: Some(times_s.to_vec()) };
    // A tenth of a second at the end is averaged.
    let moments_s = [times_s[begins], times_s[ends], times_s[last] - 0.1];
    Ok(QuickPress { recorded, moments_s })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fmt::Write as _;

    fn read_text(text: &str) -> anyhow::Result<Presses> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("press.csv");
        std::fs::write(&path, text).unwrap();
        read_presses(&[PressFile { path: &path, name: "press.csv", subject: "S01" }])
    }

    #[test]
    fn a_static_curve_is_brought_to_common_forces() {
        let rows: String = (0..=30).map(|k| format!("{},{}\n", -0.1 * f64::from(k), 0.2 * f64::from(k))).collect();
        let found = read_text(&format!("Fz_N,VP2\n{rows}")).unwrap();
        let one = &found.slow[1][0];
        assert!(found.slow[0].is_empty() && one.force_n.len() == 41);
        let volts = &one.recording.photodiodes[0].voltages_v;
        assert!(one.force_n.iter().zip(volts).all(|(force, volts)| (volts - 2.0 * force).abs() < 1e-9));
    }

    #[test]
    fn a_quick_press_has_its_moments() {
        let mut text = "time_s,Fz_N,VP1\n".to_owned();
        for k in 0..=400 {
            let time_s = f64::from(k) / 100.0;
            let force = ((time_s - 0.5) / 0.2).clamp(0.0, 1.0) - ((time_s - 2.5) / 0.2).clamp(0.0, 1.0);
            writeln!(text, "{time_s},{},{force}", -force).unwrap();
        }
        let [begins, ends, last] = read_text(&text).unwrap().quick[0][0].moments_s;
        assert!(
            (begins - 0.5).abs() <= 0.011 && (ends - 2.5).abs() <= 0.011 && (last - 3.9).abs() < 1e-9,
            "{begins} {ends}"
        );
    }

    #[test]
    fn what_is_no_press_is_named() {
        let fault = |text: &str| format!("{:#}", read_text(text).unwrap_err());
        assert!(fault("Fz_N,P1\n0,1\n").contains("VP1 (proximal)"));
        assert!(fault("VP1\n0\n").contains("Fz_N"));
        assert!(fault("time_s,Fz_N,VP1\n0,-1,1\n1,-1,1\n2,-1,1\n").contains("begin and to end without force"));
        assert!(fault("Fz_N,VP1\n0,1\n,2\n").contains("fewer than three"));
    }
}
