//! What the posture job writes: the tables of angles and of markers, the overlay, the pictures and the report beside
//! them.

use std::path::{Path, PathBuf};

use crate::clock::{ClockFit, ClockFormat};
use crate::files::{Places, beside};
use crate::flexion::Plausibility;
use crate::posture::angle::joints::{Angle, AngleRow};
use crate::posture::angle::smooth::smooth;
use crate::posture::angle::view::View;
use crate::posture::draw::figures::AngleFigures;
use crate::posture::draw::overlay::{Drawing, Mark, Overlay};
use crate::posture::error::PostureError;
use crate::posture::layout::{Layout, MarkerShape};
use crate::posture::marker::sight::Sight;
use crate::posture::options::{Outputs, PostureOptions};
use crate::posture::run::filmed_clock::ClockRow;
use crate::posture::run::report::{
    CouplingReport, FrameCounts, JointReport, JointSums, MarkerReport, MarkerSums, PostureReport, in_words,
};
use crate::stages::Stages;
use crate::table::{Column, TableWriter, Value};
use crate::video::{Frame, Info, VideoError};

/// Decimals of a time in seconds: a microsecond, finer than the ticks of most containers.
const TIME_DECIMALS: usize = 6;
/// Decimals of the clock's standard error in seconds: enough to tell from three of them how it grows.
const CLOCK_SD_DECIMALS: usize = 9;
/// Decimals of an angle in degrees: a hundredth of the least standard error seen.
const ANGLE_DECIMALS: usize = 5;
const PLACE_DECIMALS: usize = 4;

/// What one frame gave.
pub(in crate::posture) struct Row<'a> {
    /// The frame's place.
    pub(in crate::posture) index: u64,
    pub(in crate::posture) time_s: f64,
    /// Its planes; none where it could not be decoded.
    pub(in crate::posture) frame: Option<&'a Frame<'a>>,
    /// Each marker of the layout.
    pub(in crate::posture) sights: &'a [Sight],
    pub(in crate::posture) joints: AngleRow,
}

/// A row that waits for the smoother.
struct Held {
    index: u64,
    time_s: f64,
    angles: AngleRow,
}

/// Results in the making.
pub(in crate::posture) struct Results<'a> {
    layout: &'a Layout,
    view: View,
    needed: Vec<usize>,
    places: Places,
    joints_path: PathBuf,
    joints: TableWriter,
    tracks: Option<TableWriter>,
    overlay: Option<Overlay>,
    /// What pictures and the coupling are made of.
    figures: AngleFigures,
    with_pictures: bool,
    /// Rows that wait for the clock's fit or the smoother; none where they are written at once.
    held: Option<Vec<Held>>,
    smooths: bool,
    clock: bool,
    pub(in crate::posture) frames: FrameCounts,
    pub(in crate::posture) markers: Vec<MarkerSums>,
    pub(in crate::posture) angles: Vec<JointSums>,
    pub(in crate::posture) plausibility: Plausibility,
}

impl<'a> Results<'a> {
    pub(in crate::posture) fn start(
        video: &Path,
        layout: &'a Layout,
        info: &Info,
        options: &PostureOptions,
        outputs: &Outputs,
    ) -> Result<Self, PostureError> {
        let mut places = Places::not_over([video]);
        let facts = facts(layout);
        let clock = layout.clock.as_ref().filter(|_| options.reads_clock());
        let columns = joint_columns(layout, clock.map(|clock| &clock.format));
        let joints = table(&mut places, &outputs.joints, columns, &facts)?;
        let tracks = outputs.tracks.as_deref();
        let tracks = tracks.map(|path| table(&mut places, path, track_columns(), &facts)).transpose()?;
        let overlay = outputs.overlay.as_deref();
        let overlay = overlay.map(|path| start_overlay(&mut places, path, info)).transpose()?;
        let needed = layout.needed();
        Ok(Self {
            layout,
            view: View::new(layout, info),
            needed: (0..needed.len()).filter(|&m| needed[m]).collect(),
            places,
            joints_path: outputs.joints.clone(),
            joints,
            tracks,
            overlay,
            figures: AngleFigures::new(layout),
            with_pictures: outputs.figures && !layout.joints.is_empty(),
            held: (options.smooth || clock.is_some()).then(Vec::new),
            smooths: options.smooth,
            clock: clock.is_some(),
            frames: FrameCounts::default(),
            markers: vec![MarkerSums::default(); layout.markers.len()],
            angles: vec![JointSums::default(); layout.joints.len()],
            plausibility: Plausibility::new(layout.joints.iter().map(|joint| &joint.name)),
        })
    }

    /// Takes a frame's row.
    pub(in crate::posture) fn add(&mut self, row: Row<'_>) -> Result<(), PostureError> {
        self.frames.all += 1;
        self.frames.undecoded += u64::from(row.frame.is_none());
        self.frames.complete += u64::from(row.joints.lost.is_empty());
        for &marker in &self.needed {
            self.markers[marker].add(row.index, &row.sights[marker]);
        }
        self.write_tracks(&row)?;
        match &mut self.held {
            Some(held) => held.push(Held { index: row.index, time_s: row.time_s, angles: row.joints }),
            None => self.write_joints(row.index, row.time_s, &row.joints, None)?,
        }
        Ok(())
    }

    fn write_tracks(&mut self, row: &Row<'_>) -> Result<(), PostureError> {
        let Some(table) = &mut self.tracks else { return Ok(()) };
        for &marker in &self.needed {
            let name = self.layout.markers[marker].name.as_str();
            let (place, status) = match &row.sights[marker] {
                Sight::Seen(centre) => {
                    let [x_px, y_px] = self.view.shown(centre).at_px;
                    ([x_px, y_px, centre.sd_px()].map(Value::Number), "ok".to_owned())
                }
                Sight::Lost(why) => ([Value::Missing; 3], format!("lost: {}", in_words(*why))),
            };
            let [x_px, y_px, sd_px] = place;
            let (frame, time_s) = (Value::Integer(row.index as i64), Value::Number(row.time_s));
            table.write(&[frame, time_s, name.into(), x_px, y_px, sd_px, status.as_str().into()])?;
        }
        Ok(())
    }

    /// Draws the frame for the overlay, where one is wanted.
    pub(in crate::posture) fn draw(&mut self, row: &Row<'_>) -> Result<(), PostureError> {
        let Some(overlay) = &mut self.overlay else { return Ok(()) };
        let Some(frame) = row.frame else { return Ok(overlay.add_missing(row.index, row.time_s)?) };
        let layout = self.layout;
        // A marker that no wanted joint needs is not looked for.
        let mark = |&marker: &usize| Mark { name: &layout.markers[marker].name, sight: row.sights[marker] };
        let marks = self.needed.iter().map(mark);
        let place = |marker: usize| self.needed.iter().position(|&needed| needed == marker);
        let segments = layout.segments.iter().filter_map(|segment| {
            let [one, other] = segment.markers;
            Some([place(one)?, place(other)?])
        });
        let texts = layout.joints.iter().zip(&row.joints.angles).map(|(joint, angle)| match angle {
            Some(angle) => {
                let (deg, sd_deg) = (angle.rad.to_degrees(), angle.sd_rad.to_degrees());
                format!("{} {deg:.1}° ± {sd_deg:.2}", joint.name)
            }
            None => format!("{} lost", joint.name),
        });
        let drawing = Drawing { marks: marks.collect(), segments: segments.collect(), texts: texts.collect() };
        Ok(overlay.add(frame, &drawing)?)
    }

    fn write_joints(
        &mut self,
        index: u64,
        time_s: f64,
        row: &AngleRow,
        clock: Option<ClockRow>,
    ) -> Result<(), PostureError> {
        for (sums, angle) in self.angles.iter_mut().zip(&row.angles) {
            sums.add(angle.as_ref());
        }
        self.plausibility.add(row.angles.iter().map(|angle| angle.map(|angle| angle.rad.to_degrees())));
        self.figures.push(time_s, &row.angles);
        let status = row.status(self.layout);
        let mut cells =
            vec![Value::Integer(index as i64), Value::Number(time_s), clock.map(|clock| clock.clock_s).into()];
        for angle in &row.angles {
            cells.push(angle.map(|angle| angle.rad.to_degrees()).into());
            cells.push(angle.map(|angle| angle.sd_rad.to_degrees()).into());
        }
        cells.push(status.as_str().into());
        if self.clock {
            let of = |value: fn(ClockRow) -> Option<f64>| Value::from(clock.and_then(value));
            cells.push(of(|clock| clock.read_s));
            cells.push(of(|clock| Some(clock.sd_s)));
            cells.push(of(|clock| Some(clock.bounds_s[0])));
            cells.push(of(|clock| Some(clock.bounds_s[1])));
        }
        Ok(self.joints.write(&cells)?)
    }

    /// Smooths the rows that wait for it, where that is wanted; says of which joints it can't.
    pub(in crate::posture) fn smooth(&mut self) -> Vec<String> {
        let mut warnings = Vec::new();
        let Some(held) = self.held.as_mut().filter(|_| self.smooths) else { return warnings };
        let times_s: Vec<f64> = held.iter().map(|row| row.time_s).collect();
        for joint in 0..self.layout.joints.len() {
            let raw: Vec<Option<Angle>> = held.iter().map(|row| row.angles.angles[joint]).collect();
            let smoothed = smooth(&times_s, &raw);
            for (row, angle) in held.iter_mut().zip(smoothed.angles) {
                row.angles.angles[joint] = angle;
            }
            let name = &self.layout.joints[joint].name;
            warnings.extend(smoothed.doubt.map(|doubt| format!("{name}: {doubt}")));
            self.angles[joint].smoothing = smoothed.model;
        }
        warnings
    }

    /// Writes the rows that waited, with the clock's time where its fit gives it.
    pub(in crate::posture) fn write_held(&mut self, clock: Option<&ClockFit>) -> Result<(), PostureError> {
        for (k, row) in self.held.take().into_iter().flatten().enumerate() {
            let clock = clock.map(|fit| ClockRow::new(fit, k, row.time_s));
            self.write_joints(row.index, row.time_s, &row.angles, clock)?;
        }
        Ok(())
    }

    pub(in crate::posture) fn marker_reports(&self, shape: impl Fn(usize) -> Option<MarkerShape>) -> Vec<MarkerReport> {
        self.needed.iter().map(|&m| self.markers[m].report(&self.layout.markers[m].name, shape(m))).collect()
    }

    pub(in crate::posture) fn joint_reports(&self) -> Vec<JointReport> {
        let joints = self.layout.joints.iter().zip(&self.angles).enumerate();
        joints.map(|(k, (joint, sums))| sums.report(&joint.name, self.plausibility.outside(k))).collect()
    }

    pub(in crate::posture) fn coupling(&self) -> Option<CouplingReport> {
        let ([from, to], line) = (self.figures.coupled_joints()?, self.figures.coupling_line()?);
        Some(CouplingReport {
            from: from.to_owned(),
            to: to.to_owned(),
            frames: line.count,
            slope: line.slope,
            intercept_deg: line.intercept_deg,
            correlation: line.correlation,
        })
    }

    /// Draws the pictures beside the table; returns where those that a person looks at will stand.
    pub(in crate::posture) fn draw_pictures(&mut self) -> Result<Vec<PathBuf>, PostureError> {
        if !self.with_pictures {
            return Ok(Vec::new());
        }
        let figures = &self.figures;
        let mut pictures = Vec::new();
        for kind in ["angles", "coupling"] {
            if kind == "coupling" && figures.coupled_joints().is_none() {
                continue;
            }
            pictures.push(self.places.draw(&self.joints_path, kind, |png, svg| match kind {
                "angles" => figures.draw_angles(png, svg),
                _ => figures.draw_coupling(png, svg).map(|_| ()),
            })?);
        }
        Ok(pictures)
    }

    /// Ends the tables and puts everything into its place, with the report where it is wanted.
    pub(in crate::posture) fn finish(
        self,
        report: PostureReport,
        stages: &Stages,
        with_report: bool,
    ) -> Result<PostureReport, PostureError> {
        self.joints.finish()?;
        if let Some(tracks) = self.tracks {
            tracks.finish()?;
        }
        if let Some(overlay) = self.overlay {
            overlay.finish()?;
        }
        let mut report = report.timed(stages);
        let decoding: f64 = report.stages.iter().filter(|s| s.stage == "decode").map(|s| s.thread_s).sum();
        report.decoding_share = decoding / report.wall_s;
        let at = with_report.then(|| beside(&self.joints_path, ".run.json"));
        Ok(report.commit(self.places, at.as_deref())?)
    }
}

fn start_overlay(places: &mut Places, path: &Path, info: &Info) -> Result<Overlay, PostureError> {
    let at = places.place(path)?;
    Overlay::create(&at, info).map_err(|error| match error {
        // It is not yet where it will stand.
        VideoError::Write { what, .. } => VideoError::Write { path: path.to_owned(), what }.into(),
        other => other.into(),
    })
}

fn table(
    places: &mut Places,
    path: &Path,
    columns: Vec<Column>,
    facts: &[(String, String)],
) -> Result<TableWriter, PostureError> {
    Ok(TableWriter::create(&places.place(path)?, path, columns, facts)?)
}

fn joint_columns(layout: &Layout, clock: Option<&ClockFormat>) -> Vec<Column> {
    let time = |name: &str| Column::rounded(name, TIME_DECIMALS);
    let mut columns = vec![Column::integer("frame"), time("time_s"), time("clock_s")];
    for joint in &layout.joints {
        columns.push(Column::rounded(format!("{}_deg", joint.name), ANGLE_DECIMALS));
        columns.push(Column::rounded(format!("{}_sd_deg", joint.name), ANGLE_DECIMALS));
    }
    columns.push(Column::text("status"));
    if let Some(format) = clock {
        columns.push(Column::rounded("clock_read_s", format.decimals()));
        columns.push(Column::rounded("clock_sd_s", CLOCK_SD_DECIMALS));
        columns.extend(["clock_low_s", "clock_high_s"].map(time));
    }
    columns
}

fn track_columns() -> Vec<Column> {
    let place = |name: &str| Column::rounded(name, PLACE_DECIMALS);
    vec![
        Column::integer("frame"),
        Column::rounded("time_s", TIME_DECIMALS),
        Column::text("marker"),
        place("x_px"),
        place("y_px"),
        place("sd_px"),
        Column::text("status"),
    ]
}

/// What Parquet keeps beside the cells.
fn facts(layout: &Layout) -> Vec<(String, String)> {
    let flexion = layout.flexion.name();
    [
        ("lunula", env!("CARGO_PKG_VERSION").to_owned()),
        ("time_s", "presentation time from the first frame's, seconds".to_owned()),
        ("clock_s", "what the clock in the picture says, fitted over the whole video, seconds".to_owned()),
        ("clock_sd_s", "standard error of clock_s".to_owned()),
        ("clock_low_s", "the least that clock_s can be by all readings; clock_high_s the greatest".to_owned()),
        ("clock_read_s", "what it was read to show in this frame, counted on over midnight, seconds".to_owned()),
        ("angles", format!("degrees, positive in flexion, which is {flexion} on the shown picture")),
        ("sd", "standard error, in the unit of what it belongs to".to_owned()),
        ("pixels", "the centre of the shown picture's top-left pixel is (0, 0), x right, y down".to_owned()),
    ]
    .map(|(key, value)| (key.to_owned(), value))
    .to_vec()
}
