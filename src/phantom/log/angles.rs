//! The exact joint angles of a log's finger as a table of `lunula posture`, so that `lunula align` makes a posture
//! training set without a video.
//!
//! In: a [`LogScene`]. Out: `frame,time_s,clock_s`, angle and standard error (0: exact) of each joint, `status`, then
//! what posture reports of the clock in the picture. Frames come 30 a second from the video's time 0 on; `clock_s` is
//! the log's clock, which a jump of its stamps does not change.

use std::path::Path;

use super::LogScene;
use super::doing::Doing;
use crate::phantom::motion::finger::JOINTS;
use crate::table::{Column, TableError, TableWriter, Value};

/// Frames a second.
pub(super) const FPS: f64 = 30.0;

/// Writes the table; a log that begins and ends with the video's first frame has that frame.
pub(super) fn write_angles(scene: &LogScene, path: &Path) -> Result<(), TableError> {
    let options = scene.options();
    let mut columns = vec![Column::integer("frame"), Column::number("time_s"), Column::number("clock_s")];
    columns.extend(
        JOINTS.iter().flat_map(|joint| ["deg", "sd_deg"].map(|what| Column::number(format!("{joint}_{what}")))),
    );
    columns.push(Column::text("status"));
    columns.extend(["read", "sd", "low", "high"].map(|what| Column::number(format!("clock_{what}_s"))));
    let mut table = TableWriter::create(path, path, columns, &[])?;
    let mut doing = Doing::new(options);
    let frames = ((options.seconds * FPS).round() as usize).max(1);
    for frame in 0..frames {
        let time_s = frame as f64 / FPS;
        let clock_s = options.log_s(time_s);
        let mut cells = vec![Value::Integer(frame as i64), Value::Number(time_s), Value::Number(clock_s)];
        let angles_deg = doing.touch(time_s).angles_rad.map(f64::to_degrees);
        cells.extend(angles_deg.into_iter().flat_map(|angle| [Value::Number(angle), Value::Number(0.0)]));
        cells.push(Value::Text("ok"));
        cells.extend([clock_s, 0.0, clock_s, clock_s].map(Value::Number));
        table.write(&cells)?;
    }
    table.finish()
}
