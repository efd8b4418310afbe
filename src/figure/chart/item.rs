//! What can be drawn on a chart, and how far it reaches.

use super::reach::Reach;

/// Something on a chart. Colours are counted; one that is not there is the first again.
#[derive(Debug, Clone)]
pub enum Item {
    /// Intervals of the horizontal axis, lightly grey.
    Spans {
        /// For the legend; without a name it is not in it.
        name: Option<String>,
        /// From and to.
        spans: Vec<[f64; 2]>,
    },
    /// What lies between two curves.
    Band {
        /// Pieces of x, low, high.
        runs: Vec<Vec<[f64; 3]>>,
        /// Its line's colour.
        colour: usize,
    },
    /// A curve.
    Line {
        /// For the legend; without a name it is not in it.
        name: Option<String>,
        /// Pieces of x, y; a piece of one point is a dot.
        runs: Vec<Vec<[f64; 2]>>,
        /// Counted from 0.
        colour: usize,
        /// How wide, pixels.
        width: u32,
    },
    /// Single points.
    Dots {
        /// For the legend; without a name it is not in it.
        name: Option<String>,
        /// x and y of each.
        points: Vec<[f64; 2]>,
        /// Counted from 0.
        colour: usize,
    },
    /// Points with a label beside each, clear of the others where there is room.
    Points {
        /// In the legend.
        name: String,
        /// In any order; those that are not on the axes are not drawn.
        points: Vec<Point>,
        /// Whether the dots are hollow.
        hollow: bool,
        /// Counted from 0.
        colour: usize,
    },
    /// A ring or a square about a point.
    Mark(Mark),
    /// A thin grey line from point to point.
    Path(Vec<[f64; 2]>),
    /// Upright marks from a low to a high end: a standard deviation about a curve's point.
    Errors {
        /// x, low end, high end; those that are not finite are not drawn.
        marks: Vec<[f64; 3]>,
        /// Counted from 0.
        colour: usize,
    },
    /// Bars that stand on zero.
    Bars {
        /// For the legend; without a name it is not in it.
        name: Option<String>,
        /// The bars.
        bars: Vec<Bar>,
        /// Counted from 0.
        colour: usize,
    },
    /// The line y = x, from one end of the axes to the other; both axes get the same ends.
    Diagonal {
        /// For the legend; without a name it is not in it.
        name: Option<String>,
    },
    /// Names below places of the horizontal axis, instead of its numbers. A name may have several lines.
    Names(Vec<(f64, String)>),
    /// A line of text, which begins at a point and lies below it.
    Text {
        /// x and y.
        at: [f64; 2],
        /// What is written.
        text: String,
        /// Counted from 0.
        colour: usize,
    },
    /// A line of text that begins above a point or ends below it: beside a falling curve.
    Label {
        /// x and y.
        at: [f64; 2],
        /// What is written.
        text: String,
        /// Counted from 0.
        colour: usize,
        /// Whether it is above.
        above: bool,
    },
    /// Grey boxes, as a picture under the rest: left, low, right and high end, and a level from 0 (black) to 1 (white).
    Shades(Vec<([f64; 4], f64)>),
    /// Nothing, but the axes reach to these points.
    Room(Vec<[f64; 2]>),
}

/// A point with a label beside it.
#[derive(Debug, Clone)]
pub struct Point {
    /// Along the horizontal axis.
    pub x: f64,
    /// Along the vertical axis.
    pub y: f64,
    /// Written beside it; nothing if empty.
    pub label: String,
    /// Horizontal error bar: from, to.
    pub x_range: Option<[f64; 2]>,
}

/// A ring or a square about a point.
#[derive(Debug, Clone)]
pub struct Mark {
    /// Along the horizontal axis.
    pub x: f64,
    /// Along the vertical axis.
    pub y: f64,
    /// Ring or square; one of each fits about the same point.
    pub shape: MarkShape,
    /// In the legend.
    pub name: String,
}

/// The shape of a [`Mark`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MarkShape {
    /// A circle.
    Ring,
    /// An upright square.
    Square,
}

/// A bar that stands on zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bar {
    /// Its middle on the horizontal axis.
    pub at: f64,
    /// How wide it is, on the same axis.
    pub width: f64,
    /// How high; it is not drawn where this is not finite.
    pub value: f64,
    /// The ends of an error mark.
    pub error: Option<[f64; 2]>,
}

impl Item {
    /// Takes the lowest and highest x and y of all that is finite.
    pub(super) fn reach(&self, reach: &mut Reach) {
        match self {
            Self::Spans { spans, .. } => spans.iter().flatten().for_each(|&x| reach.x.take(x)),
            Self::Band { runs, .. } => runs.iter().flatten().for_each(|&[x, low, high]| {
                reach.x.take(x);
                reach.y.take(low);
                reach.y.take(high);
            }),
            Self::Line { runs, .. } => runs.iter().flatten().for_each(|&p| reach.take(p)),
            Self::Dots { points, .. } | Self::Room(points) => points.iter().for_each(|&p| reach.take(p)),
            Self::Points { points, .. } => points.iter().for_each(|point| reach.take([point.x, point.y])),
            Self::Mark(mark) => reach.take([mark.x, mark.y]),
            Self::Path(points) => points.iter().for_each(|&p| reach.take(p)),
            Self::Bars { bars, .. } => bars.iter().for_each(|bar| {
                reach.take([bar.at - 0.5 * bar.width, 0.0]);
                reach.take([bar.at + 0.5 * bar.width, bar.value]);
                bar.error.iter().flatten().for_each(|&end| reach.y.take(end));
            }),
            Self::Errors { marks, .. } => marks.iter().for_each(|&[x, low, high]| {
                reach.take([x, low]);
                reach.y.take(high);
            }),
            Self::Shades(boxes) => boxes.iter().for_each(|([left, low, right, high], _)| {
                reach.take([*left, *low]);
                reach.take([*right, *high]);
            }),
            Self::Text { at, .. } | Self::Label { at, .. } => reach.take(*at),
            Self::Diagonal { .. } | Self::Names(_) => {}
        }
    }

    /// Its entry in the legend.
    pub(super) fn name(&self) -> Option<&str> {
        match self {
            Self::Spans { name, .. }
            | Self::Line { name, .. }
            | Self::Dots { name, .. }
            | Self::Bars { name, .. }
            | Self::Diagonal { name } => name.as_deref(),
            Self::Points { name, .. } | Self::Mark(Mark { name, .. }) => Some(name),
            Self::Band { .. }
            | Self::Path(_)
            | Self::Errors { .. }
            | Self::Text { .. }
            | Self::Label { .. }
            | Self::Names(_)
            | Self::Shades(_)
            | Self::Room(_) => None,
        }
    }
}
