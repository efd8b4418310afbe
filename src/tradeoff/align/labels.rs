//! Labels over gaps: markers are lost now and then, and angles interpolated over longer and longer gaps.
//!
//! The angles are the job's own, with frames taken out: every [`APART`] frames a gap of as many as [`LOST`] says, in
//! turn. The error is that of the labels that rows have; how many have one is given as `work`.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use anyhow::{Context, ensure};

use super::{Settings, column};
use crate::align::{AlignInputs, AlignOptions, AlignOutputs, run as run_align};
use crate::job::Watch;
use crate::posture::Layout;
use crate::table::Table;
use crate::tradeoff::measure::rows::Measured;
use crate::tradeoff::measure::timing::in_turns;

/// How long a gap is labelled over: job and choice.
pub const BRIDGING: (&str, &str) = ("align", "bridging");
/// The error's name and unit.
pub const LABEL_ERROR: &str = "labels of joint angles, markers lost now and then, degrees RMS";
/// Frames from a gap's beginning to the next one's.
const APART: usize = 45;
/// Frames lost in a gap, in turn.
const LOST: [usize; 5] = [1, 2, 4, 8, 16];
/// The longest gap that is bridged, in frame intervals; none: what the job does.
const INTERVALS: [(&str, Option<f64>); 4] = [
    ("no frame bridged", Some(1.5)),
    ("gaps of two frames", None),
    ("gaps of five frames", Some(5.5)),
    ("gaps of twenty frames", Some(20.5)),
];
/// What `lunula align` does.
pub(in crate::tradeoff) fn bridging_default() -> String {
    let default =
        INTERVALS.into_iter().find(|(_, intervals)| intervals.is_none() == AlignOptions::default().max_gap_s.is_none());
    default.map_or("none of those measured", |(name, _)| name).to_owned()
}

/// Measures every setting, where the log's truth is known.
pub(super) fn measure(
    layout: &Layout,
    joints: &Path,
    settings: &Settings,
    measured: &mut Measured,
) -> anyhow::Result<()> {
    let truth = settings.truth.join("log.csv");
    if !truth.is_file() {
        measured.refused.push(format!("labels: {} is missing", truth.display()));
        return Ok(());
    }
    let folder = tempfile::tempdir()?;
    let labels = Labels::new(layout, joints, settings, folder.path())?;
    let gappy = &labels.joints;
    let times_s = column(gappy, "time_s")?;
    let span_s = times_s.last().zip(times_s.first()).map_or(f64::NAN, |(last, first)| last - first);
    let interval_s = span_s / (times_s.len() as f64 - 1.0);
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let training = folder.path().join("training.csv");
    let found = in_turns(&INTERVALS, &settings.effort, |(_, intervals), first| {
        let inputs = AlignInputs { joints: gappy.clone(), log: settings.log.clone(), tracks: None };
        let options = AlignOptions { max_gap_s: intervals.map(|n| n * interval_s), ..AlignOptions::default() };
        let outputs = AlignOutputs::only(training.clone());
        let report = one.install(|| run_align(&inputs, &options, &outputs, &Watch::nobody()))?;
        Ok((report.wall_s, first.then(|| labels.error(&training)).transpose()?))
    })?;
    for ((name, _), found) in INTERVALS.into_iter().zip(found) {
        measured.add(BRIDGING, name, LABEL_ERROR, found);
    }
    Ok(())
}

/// Angles over gaps, and what labels from them should be.
#[derive(Debug)]
pub struct Labels {
    /// The table of angles with frames taken out.
    pub joints: PathBuf,
    truth: Truth,
}

impl Labels {
    /// From the angles of all frames; the table is written to `folder`.
    pub(super) fn new(layout: &Layout, joints: &Path, settings: &Settings, folder: &Path) -> anyhow::Result<Self> {
        let truth = Truth::read(&settings.log, &settings.truth.join("log.csv"), layout)?;
        let gappy = folder.join("joints.csv");
        lose(joints, &gappy)?;
        Ok(Self { joints: gappy, truth })
    }

    /// The error of a labelled log ([`LABEL_ERROR`]), and how many rows have all labels.
    ///
    /// # Errors
    /// A table that can't be read, rows that are not the log's, no label at all.
    pub fn error(&self, training: &Path) -> anyhow::Result<(f64, u64)> {
        self.truth.error(training)
    }
}

/// Takes frames out of a table of angles.
fn lose(joints: &Path, gappy: &Path) -> anyhow::Result<()> {
    let mut reader = csv::Reader::from_path(joints).with_context(|| joints.display().to_string())?;
    let header = reader.headers()?.clone();
    let mut writer = csv::Writer::from_path(gappy).with_context(|| gappy.display().to_string())?;
    writer.write_record(&header)?;
    for (frame, record) in reader.records().enumerate() {
        let lost = frame >= APART && frame % APART < LOST[frame / APART % LOST.len()];
        let record = record?;
        let cell = |(name, cell): (&str, &str)| match name {
            "status" if lost => "lost: taken out".to_owned(),
            _ if lost && name.ends_with("_deg") => String::new(),
            _ => cell.to_owned(),
        };
        writer.write_record(header.iter().zip(&record).map(cell))?;
    }
    Ok(writer.flush()?)
}

/// The exact angles at the log's rows.
#[derive(Debug)]
struct Truth {
    joints: Vec<String>,
    /// By the bits of the log's time.
    rows: HashMap<u64, Vec<f64>>,
}

impl Truth {
    fn read(log: &Path, truth: &Path, layout: &Layout) -> anyhow::Result<Self> {
        let joints: Vec<String> = layout.joints.iter().map(|joint| format!("{}_deg", joint.name)).collect();
        let times_s = column(log, "time_s")?;
        let angles = joints.iter().map(|name| column(truth, name)).collect::<anyhow::Result<Vec<_>>>()?;
        ensure!(
            angles.iter().all(|angles| angles.len() == times_s.len()),
            "{}: has not the log's rows",
            truth.display()
        );
        let row = |(k, time_s): (usize, &f64)| (time_s.to_bits(), angles.iter().map(|angles| angles[k]).collect());
        Ok(Self { rows: times_s.iter().enumerate().map(row).collect(), joints })
    }

    fn error(&self, training: &Path) -> anyhow::Result<(f64, u64)> {
        let table = Table::read(training)?;
        let times_s = column(training, "time_s")?;
        let labels = self.joints.iter().map(|name| table.numbers(name)).collect::<Result<Vec<_>, _>>()?;
        let (mut squares, mut count, mut whole) = (0.0, 0_u64, 0);
        for (k, time_s) in times_s.iter().enumerate() {
            let exact = self.rows.get(&time_s.to_bits()).with_context(|| format!("{time_s} s is no row of the log"))?;
            let misses: Vec<f64> =
                labels.iter().zip(exact).filter_map(|(labels, exact)| Some(labels[k]? - exact)).collect();
            squares += misses.iter().map(|miss| miss * miss).sum::<f64>();
            count += misses.len() as u64;
            whole += u64::from(misses.len() == self.joints.len());
        }
        ensure!(count > 0, "no row has a label");
        Ok(((squares / count as f64).sqrt(), whole))
    }
}
