//! A job's curves as panels: settings, other programs, the front, knee and default.

use super::judge::{Tradeoff, Verdict};
use super::rows::Row;
use crate::figure::{Axis, Mark, MarkShape, Plot, Point, Series};

/// A panel for each curve.
pub(super) fn panels(tradeoff: &Tradeoff) -> Vec<Plot> {
    tradeoff.curves.iter().map(|curve| panel(curve, &tradeoff.rows)).collect()
}

fn panel(curve: &Verdict, rows: &[Row]) -> Plot {
    let on: Vec<&Row> =
        rows.iter().filter(|row| row.choice == curve.choice && row.error_unit == curve.error_unit).collect();
    let mut series: Vec<Series> = Vec::new();
    for &row in &on {
        let name = if row.peer { program(&row.setting) } else { "lunula" };
        let label = if row.peer { row.setting[name.len()..].trim_start_matches([',', ':', ' ']) } else { &row.setting };
        let label = if label.is_empty() { name } else { label };
        let x_range = (row.run_low_s < row.run_high_s).then_some([row.run_low_s, row.run_high_s]);
        let point = Point { x: row.run_s, y: row.error, label: label.to_owned(), x_range };
        match series.iter_mut().find(|known| known.name == name && known.hollow == row.peer) {
            Some(known) => known.points.push(point),
            None => series.push(Series { name: name.to_owned(), points: vec![point], hollow: row.peer }),
        }
    }
    Plot {
        title: format!("{}: {}", curve.job, curve.choice),
        x: Axis { label: "seconds an input, one thread, of the stage alone".into() },
        y: Axis { label: curve.error_unit.clone() },
        series,
        line: front_line(curve),
        marks: marks(&on),
    }
}

/// What a peer's setting begins with.
fn program(setting: &str) -> &str {
    setting.split([',', ':']).next().unwrap_or(setting)
}

/// Settings worth their time; a single one makes no line.
pub(super) fn front_line(curve: &Verdict) -> Vec<[f64; 2]> {
    curve.front.clone()
}

/// The knee and the default, where they are among `rows`.
pub(super) fn marks(rows: &[&Row]) -> Vec<Mark> {
    let mark = |row: &Row, shape, name: &str| Mark { x: row.run_s, y: row.error, shape, name: name.to_owned() };
    let knees = rows.iter().filter(|row| row.knee).map(|row| mark(row, MarkShape::Ring, "knee"));
    let defaults = rows.iter().filter(|row| row.default).map(|row| mark(row, MarkShape::Square, "default"));
    knees.chain(defaults).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tradeoff::judge::tests::{judged, row};
    use crate::tradeoff::photos;

    #[test]
    fn knee_default_and_peers_are_drawn() {
        let default = photos::detection_default();
        let rows =
            vec![row("a", 1.0, 9.0), row("b", 1.5, 0.5), row(&default, 30.0, 0.4), row("Other, fast", 0.1, 0.1).peer()];
        let panels = panels(&judged(rows, &[]).unwrap());
        let names: Vec<(&str, bool)> =
            panels[0].series.iter().map(|series| (series.name.as_str(), series.hollow)).collect();
        assert_eq!(names, [("lunula", false), ("Other", true)]);
        assert_eq!(panels[0].series[1].points[0].label, "fast");
        let marks: Vec<(f64, MarkShape)> = panels[0].marks.iter().map(|mark| (mark.x, mark.shape)).collect();
        assert_eq!(marks, [(1.5, MarkShape::Ring), (30.0, MarkShape::Square)]);
        let folder = tempfile::tempdir().unwrap();
        let [png, svg] = ["a.png", "a.svg"].map(|name| folder.path().join(name));
        crate::figure::draw_log_log(&panels, &png, &svg).unwrap();
        let drawn = std::fs::read_to_string(&svg).unwrap();
        assert!(drawn.contains("knee") && drawn.contains("default") && drawn.contains("fast"));
    }
}
