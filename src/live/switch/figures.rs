//! The pictures of switches: delay against false switches, and how delays are spread.

use lunula_live::switch::{Fate, Match};

use super::report::TuneReport;
use crate::figure::{Chart, Item};

pub(super) const WIDTH: u32 = 900;
const HEIGHT: u32 = 520;

/// The curve of mean delay against false switches an hour, the goal and the choice.
pub(super) fn curve_chart(title: &str, report: &TuneReport, goal: f64) -> Chart {
    // Beyond some multiples of the goal nobody looks.
    let farthest = report.curve.iter().map(|point| point.false_per_hour).fold(0.0, f64::max);
    let most = farthest.clamp(1.5 * goal, 20.0 * goal);
    let points: Vec<[f64; 2]> = report
        .curve
        .iter()
        .filter(|point| point.false_per_hour <= most)
        .map(|point| [point.false_per_hour, 1e3 * point.delay_on_s])
        .collect();
    let chosen = report.chosen.rate.zip(report.chosen.delay_on_s).map(|(rate, delay)| (rate.false_per_hour, delay));
    let highest = points.iter().map(|point| point[1]).fold(1.0, f64::max);
    let mut items = vec![
        Item::Spans { name: Some("more than the goal".to_owned()), spans: vec![[goal, most]] },
        Item::Room(vec![[0.0, 0.0], [0.0, highest]]),
        Item::Line { name: None, runs: vec![points.clone()], colour: 0, width: 2 },
        Item::Dots { name: Some("fastest thresholds and holds".to_owned()), points, colour: 0 },
    ];
    if let Some((rate, delay)) = chosen {
        let at = [rate, 1e3 * delay.mean];
        items.push(Item::Dots { name: Some("chosen".to_owned()), points: vec![at], colour: 1 });
        let text = format!("on {} N, off {} N", report.switch.on_n, report.switch.off_n);
        items.push(Item::Label { at, text, colour: 1, above: true });
    }
    Chart::new(
        title,
        format!("false switches per hour (counted in {:.2} h)", report.chosen.hours),
        "mean delay of presses, ms",
        items,
        HEIGHT,
    )
    .from_zero()
}

/// The share of presses and of releases that came within a delay.
pub(super) fn delays_chart(found: &[Vec<Match>]) -> Chart {
    let known = || found.iter().flatten().filter(|one| one.fate == Fate::True);
    let on = known().filter_map(|one| Some(one.press_s - one.contact.filter(|contact| contact.start_known)?.start_s));
    let off = known().filter_map(|one| Some(one.release_s - one.contact.filter(|contact| contact.end_known)?.end_s));
    let curve = |delays: Vec<f64>| {
        let mut delays: Vec<f64> = delays.into_iter().filter(|delay| delay.is_finite()).collect();
        delays.sort_by(f64::total_cmp);
        let all = delays.len() as f64;
        delays.iter().enumerate().map(|(k, delay)| [1e3 * delay, 100.0 * (k + 1) as f64 / all]).collect::<Vec<_>>()
    };
    let lines =
        [("press, after true contact began", curve(on.collect())), ("release, after it ended", curve(off.collect()))];
    let mut items = vec![Item::Room(vec![[0.0, 0.0], [0.0, 100.0]])];
    items.extend(lines.into_iter().enumerate().map(|(colour, (name, points))| Item::Line {
        name: Some(name.to_owned()),
        runs: vec![points],
        colour,
        width: 2,
    }));
    Chart::new("Delays of the switch", "delay, ms", "share within it, %", items, HEIGHT).from_zero()
}
