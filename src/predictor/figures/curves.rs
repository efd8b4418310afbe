//! Errors over the number of photodiodes, the best of each number named (beyond Fig. 113), and over the training rows.

use crate::figure::{Chart, Item};

/// Height of the pictures, pixels.
const HEIGHT_PX: u32 = 600;

/// The best subset of one size.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::predictor) struct Subset {
    /// The photodiodes in it.
    pub photodiodes: Vec<String>,
    /// Its error.
    pub error: f64,
}

/// Errors on a learning curve.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::predictor) struct LearningSeries {
    /// For the legend.
    pub name: String,
    /// How much was learnt from, ascending, and the error.
    pub points: Vec<[f64; 2]>,
}

/// The error of the best subset of each size, by the measure `name`; the photodiodes in it are written at the
/// points, `all` is every one of `photodiodes`.
pub(in crate::predictor) fn best_subsets(
    title: &str,
    y_label: &str,
    photodiodes: &[String],
    name: &str,
    best: &[Subset],
) -> Chart {
    let most = photodiodes.len();
    let mut best: Vec<&Subset> = best.iter().filter(|subset| subset.error.is_finite()).collect();
    best.sort_by_key(|subset| subset.photodiodes.len());
    let points: Vec<[f64; 2]> = best.iter().map(|s| [s.photodiodes.len() as f64, s.error]).collect();
    let mut items = vec![
        Item::Room(vec![[0.5, 0.0], [most as f64 + 0.5, 0.0]]),
        Item::Names((1..=most).map(|n| (n as f64, n.to_string())).collect()),
        Item::Line { name: Some(name.to_owned()), runs: vec![points.clone()], colour: 0, width: 2 },
        Item::Dots { name: None, points: points.clone(), colour: 0 },
    ];
    items.extend(best.iter().zip(points).map(|(subset, at)| Item::Label {
        at,
        text: in_words(&subset.photodiodes, photodiodes),
        colour: 0,
        above: true,
    }));
    Chart::new(title, "number of photodiodes", y_label, items, HEIGHT_PX).from_zero()
}

/// `P1 P4`, `all but P3`, `all`: whichever is shorter.
fn in_words(subset: &[String], all: &[String]) -> String {
    let without: Vec<&str> = all.iter().filter(|p| !subset.contains(p)).map(String::as_str).collect();
    match without.len() {
        0 => "all".to_owned(),
        n if n < subset.len() => format!("all but {}", without.join(" ")),
        _ => subset.join(" "),
    }
}

/// Errors over how much was learnt from.
pub(in crate::predictor) fn learning_curve(
    title: &str,
    x_label: &str,
    y_label: &str,
    series: &[LearningSeries],
) -> Chart {
    let mut items = Vec::new();
    for (colour, one) in series.iter().enumerate() {
        let points: Vec<[f64; 2]> = one.points.iter().copied().filter(|p| p[1].is_finite()).collect();
        items.push(Item::Line { name: Some(one.name.clone()), runs: vec![points.clone()], colour, width: 2 });
        items.push(Item::Dots { name: None, points, colour });
    }
    Chart::new(title, x_label, y_label, items, HEIGHT_PX).from_zero()
}
