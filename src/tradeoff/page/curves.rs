//! A job's curves as panels: settings, other programs, the front, knee and default.

use crate::figure::{Chart, Item, Mark, MarkShape, Point};
use crate::tradeoff::judge::{Tradeoff, Verdict, is_on};
use crate::tradeoff::measure::rows::Row;
use crate::tradeoff::peers::program;

/// Width and height of a panel, pixels.
pub(in crate::tradeoff) const PANEL_PX: (u32, u32) = (820, 620);

/// Points of one program.
#[derive(Debug)]
pub(in crate::tradeoff) struct Series {
    pub(in crate::tradeoff) name: String,
    pub(in crate::tradeoff) points: Vec<Point>,
    /// Another program's.
    pub(in crate::tradeoff) peer: bool,
}

/// A chart of `front`, then the points of each program, then the marks.
pub(in crate::tradeoff) fn chart(
    title: String,
    [x, y]: [String; 2],
    front: Vec<[f64; 2]>,
    series: Vec<Series>,
    marks: Vec<Mark>,
) -> Chart {
    let points =
        |(colour, one): (usize, Series)| Item::Points { name: one.name, points: one.points, hollow: one.peer, colour };
    let items = std::iter::once(Item::Path(front)).chain(series.into_iter().enumerate().map(points));
    Chart::new(title, x, y, items.chain(marks.into_iter().map(Item::Mark)).collect(), PANEL_PX.1)
}

/// A panel for each curve that has a point on logarithmic axes.
pub(in crate::tradeoff) fn panels(tradeoff: &Tradeoff) -> Vec<Chart> {
    tradeoff.curves.iter().filter_map(|curve| panel(curve, &tradeoff.rows)).collect()
}

fn panel(curve: &Verdict, rows: &[Row]) -> Option<Chart> {
    let on: Vec<&Row> = rows.iter().filter(|row| is_on(row, curve)).collect();
    if !on.iter().any(|row| row.has_place()) {
        return None;
    }
    let mut series: Vec<Series> = Vec::new();
    for &row in &on {
        let name = if row.peer { program(&row.setting) } else { "lunula" };
        let label = if row.peer { row.setting[name.len()..].trim_start_matches([',', ':', ' ']) } else { &row.setting };
        let label = if label.is_empty() { name } else { label };
        let x_range = (row.run_low_s < row.run_high_s).then_some([row.run_low_s, row.run_high_s]);
        let point = Point { x: row.run_s, y: row.error, label: label.to_owned(), x_range };
        match series.iter_mut().find(|known| known.name == name && known.peer == row.peer) {
            Some(known) => known.points.push(point),
            None => series.push(Series { name: name.to_owned(), points: vec![point], peer: row.peer }),
        }
    }
    let axes = ["seconds an input, one thread, of the stage alone".to_owned(), curve.error_unit.clone()];
    Some(chart(format!("{}: {}", curve.job, curve.choice), axes, curve.front.clone(), series, marks(&on)))
}

/// The knee and the default, where they are among `rows`.
pub(in crate::tradeoff) fn marks(rows: &[&Row]) -> Vec<Mark> {
    let mark = |row: &Row, shape, name: &str| Mark { x: row.run_s, y: row.error, shape, name: name.to_owned() };
    let knees = rows.iter().filter(|row| row.knee).map(|row| mark(row, MarkShape::Ring, "knee"));
    let defaults = rows.iter().filter(|row| row.default).map(|row| mark(row, MarkShape::Square, "default"));
    knees.chain(defaults).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tradeoff::judge::tests::judged_by_default;

    #[test]
    fn knee_default_and_peers_are_drawn() {
        let panels = panels(&judged_by_default(Some("Other, fast")));
        let [Item::Path(_), Item::Points { hollow: false, name: own, .. }, others, marks @ ..] = &panels[0].items[..]
        else {
            panic!("{:?}", panels[0].items)
        };
        assert_eq!(own, "lunula");
        let Item::Points { name, points, hollow: true, .. } = others else { panic!("{others:?}") };
        assert_eq!((name.as_str(), points[0].label.as_str()), ("Other", "fast"));
        let mark = |item: &Item| if let Item::Mark(mark) = item { (mark.x, mark.shape) } else { panic!("{item:?}") };
        let marks: Vec<(f64, MarkShape)> = marks.iter().map(mark).collect();
        assert_eq!(marks, [(1.5, MarkShape::Ring), (30.0, MarkShape::Square)]);
        let folder = tempfile::tempdir().unwrap();
        let [png, svg] = ["a.png", "a.svg"].map(|name| folder.path().join(name));
        crate::figure::draw_log_log(&panels, 2, PANEL_PX.0, &png, &svg).unwrap();
        let drawn = std::fs::read_to_string(&svg).unwrap();
        assert!(drawn.contains("knee") && drawn.contains("default") && drawn.contains("fast"));
    }
}
