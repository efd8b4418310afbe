//! Pictures: each operator's trials (Fig. 123), and the means with their standard deviation and curve (Fig. 124).

use std::collections::BTreeSet;
use std::path::Path;

use super::read::Trials;
use super::report::{MethodFigures, PerformanceFigures};
use crate::figure::{Chart, Item, draw_charts, draw_panels};

const WIDTH: u32 = 1000;
const HEIGHT: u32 = 560;
/// Of the operators' panels.
const COLUMNS: usize = 2;
const PANEL: (u32, u32) = (620, 340);
/// Operators that are drawn.
pub(super) const MOST_PANELS: usize = 12;
/// Points of a curve from one trial to the next.
const FINE: u32 = 20;
/// More numbers of trials do not fit below a panel.
const MOST_NUMBERED: usize = 20;
/// Methods lie so far beside each other, trials.
const ASIDE: f64 = 0.08;

const TRIAL: &str = "trial";
const TIME: &str = "time per decision, s";

/// A chart over these trials; whole numbers are below its axis, while there is room for them.
fn chart(title: String, trials: &BTreeSet<u32>, mut items: Vec<Item>, height: u32) -> Chart {
    if let (Some(&first), Some(&last)) = (trials.first(), trials.last())
        && ((last - first) as usize) < MOST_NUMBERED
    {
        items.push(Item::Names((first..=last).map(|trial| (f64::from(trial), trial.to_string())).collect()));
    }
    Chart::new(title, TRIAL, TIME, items, height).from_zero()
}

/// One panel per operator, a line per method.
pub(super) fn draw_operators(trials: &Trials, png: &Path, svg: &Path) -> anyhow::Result<()> {
    let numbers: BTreeSet<u32> = trials.rows.iter().map(|row| row.trial).collect();
    // All panels have the same axes.
    let room: Vec<[f64; 2]> = trials.rows.iter().map(|row| [f64::from(row.trial), row.decision_s]).collect();
    let panel = |(operator, name): (usize, &String)| {
        let mut items = vec![Item::Room(room.clone())];
        for (method, word) in trials.methods.iter().enumerate() {
            let own = trials.rows.iter().filter(|row| row.operator == operator && row.method == method);
            let mut points: Vec<[f64; 2]> = own.map(|row| [f64::from(row.trial), row.decision_s]).collect();
            points.sort_by(|a, b| a[0].total_cmp(&b[0]));
            // A trial that is missing breaks the line.
            let runs = points.chunk_by(|a, b| b[0] - a[0] <= 1.0).map(<[_]>::to_vec).collect();
            items.push(Item::Line { name: Some(word.clone()), runs, colour: method, width: 2 });
            items.push(Item::Dots { name: None, points, colour: method });
        }
        chart(format!("Operator {name}"), &numbers, items, PANEL.1)
    };
    let panels: Vec<Chart> = trials.operators.iter().enumerate().take(MOST_PANELS).map(panel).collect();
    draw_panels(&panels, COLUMNS, PANEL.0, png, svg)
}

/// The means of each method with their standard deviation, and its better curve.
pub(super) fn draw_methods(figures: &PerformanceFigures, png: &Path, svg: &Path) -> anyhow::Result<()> {
    let many = figures.methods.len();
    let items = figures.methods.iter().enumerate();
    let items = items.flat_map(|(k, method)| method_items(method, k, ASIDE * (k as f64 - 0.5 * (many - 1) as f64)));
    let title = match figures.operators.len() {
        1 => "One operator".to_owned(),
        operators if figures.methods.iter().all(|method| method.not_done() == 0) => {
            format!("Mean of {operators} operators, with standard deviation")
        }
        operators => {
            format!("Mean and standard deviation of who did each trial, and the curve of all {operators} operators")
        }
    };
    let numbers = figures.methods.iter().flat_map(|method| method.trials.iter().map(|of| of.trial)).collect();
    draw_charts(&[chart(title, &numbers, items.collect(), HEIGHT)], WIDTH, png, svg)
}

fn method_items(method: &MethodFigures, colour: usize, aside: f64) -> Vec<Item> {
    let means = || method.trials.iter().map(|of| (f64::from(of.trial) + aside, of.over_operators));
    let marks = means().filter_map(|(x, of)| Some([x, of.mean - of.sd?, of.mean + of.sd?])).collect();
    let mut items = vec![Item::Errors { marks, colour }];
    let mut words = method.method.clone();
    if let (Some(curve), Some(law), Some(first), Some(last)) =
        (method.fitted.better_curve(), method.fitted.better, method.trials.first(), method.trials.last())
    {
        let steps = (last.trial - first.trial) * FINE;
        let at = |k: u32| f64::from(first.trial) + f64::from(k) / f64::from(FINE);
        let run = (0..=steps).map(|k| [at(k), curve.at(at(k))]).collect();
        items.push(Item::Line { name: None, runs: vec![run], colour, width: 2 });
        words.push_str(match law {
            lunula_live::performance::Law::Exponential => ", exponential",
            lunula_live::performance::Law::Power => ", power law",
        });
    }
    items.push(Item::Dots { name: Some(words), points: means().map(|(x, of)| [x, of.mean]).collect(), colour });
    items
}
