//! What a page gets to know of the nail that is shown.

use super::picture::View;
use super::state::{Decision, State};
use super::survey::Rank;
use crate::photo::PhotoSet;

/// The state, as a page reads it. Corners are pixels of the upright photograph.
#[derive(Debug, serde::Serialize)]
pub(super) struct Now<'a> {
    /// Grows with each change.
    revision: u64,
    /// `None`: it waits for nails to be found, or there is none left.
    nail: Option<Seen<'a>>,
    is_first: bool,
    accepted: usize,
    rejected: usize,
    /// Nails without a decision, of those that are doubtful or missing and of the others.
    doubtful_left: usize,
    others_left: usize,
    /// Photographs that are still to be searched.
    open: usize,
    failed: &'a [String],
    said: &'a str,
    is_fault: bool,
}

#[derive(Debug, serde::Serialize)]
struct Seen<'a> {
    /// Which: keys name it.
    id: usize,
    photo: &'a str,
    number: usize,
    of: usize,
    why: &'a str,
    doubtful: bool,
    decision: Option<Decision>,
    view: Option<View>,
    points: Vec<[f64; 2]>,
    corner: Option<usize>,
    /// From the proximal to the distal end of the box.
    axis: [[f64; 2]; 2],
    length_px: f64,
    width_px: f64,
    axis_deg: f64,
    /// Why it can't be accepted as it is.
    fault: Option<String>,
    can_undo: bool,
}

pub(super) fn now<'a>(set: &'a PhotoSet, state: &'a State) -> Now<'a> {
    let decided = |decision| state.items.iter().filter(|item| item.decision == Some(decision)).count();
    let is_open = |rank: Rank| rank <= Rank::Missing;
    let left =
        |open: bool| state.items.iter().filter(|item| item.decision.is_none() && is_open(item.rank) == open).count();
    let nail = state.current().map(|id| {
        let item = &state.items[id];
        let frame = item.shape.frame();
        let short = |v: f64| (100.0 * v).round() / 100.0;
        Seen {
            id,
            photo: &set.photos[item.photo].file,
            number: item.number,
            of: state.items.iter().filter(|other| other.photo == item.photo).count(),
            why: &item.why,
            doubtful: is_open(item.rank),
            decision: item.decision.filter(|_| !item.is_unsaved()),
            view: item.view,
            points: item.shape.points.iter().map(|point| point.map(short)).collect(),
            corner: item.corner,
            axis: [-0.5, 0.5].map(|along| frame.photo_from_nail(0.0, along).map(short)),
            length_px: short(frame.length_px),
            width_px: short(frame.width_px),
            axis_deg: short(item.shape.axis.clockwise_deg()),
            fault: item.shape.outline().err().map(|fault| fault.to_string()),
            can_undo: item.decision.is_some() || !item.before.is_empty(),
        }
    });
    Now {
        revision: state.revision,
        nail,
        is_first: state.at == 0,
        accepted: decided(Decision::Accepted),
        rejected: decided(Decision::Rejected),
        doubtful_left: left(true),
        others_left: left(false),
        open: state.open,
        failed: &state.failed,
        said: &state.said,
        is_fault: state.is_fault,
    }
}
