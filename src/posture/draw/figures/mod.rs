//! Pictures of a video's joint angles: all of them over time, and the last joint against the one before it (Fig. 33).
//!
//! Rows are fed one after the other; memory and files do not grow with the video.

mod line;

use std::path::Path;

pub use line::CouplingLine;
use line::Pairs;

use crate::figure::{Chart, Item, Thinned, draw_charts};
use crate::posture::{Angle, Layout};

/// Gathers what the pictures show.
#[derive(Debug)]
pub struct AngleFigures {
    names: Vec<String>,
    rows: Thinned,
    coupling: Option<Coupling>,
}

/// Two joints that follow each other on the finger.
#[derive(Debug)]
struct Coupling {
    joints: [usize; 2],
    pairs: Pairs,
    dots: Vec<[f64; 2]>,
    /// Of so many pairs, one is drawn.
    every: u64,
}

const WIDTH: u32 = 1400;
/// Pairs of angles that are drawn, at most.
const MOST_DOTS: usize = 4096;

impl AngleFigures {
    /// For the joints of a layout.
    #[must_use]
    pub fn new(layout: &Layout) -> Self {
        let coupling =
            last_two(layout).map(|joints| Coupling { joints, pairs: Pairs::default(), dots: Vec::new(), every: 1 });
        Self { names: layout.joints.iter().map(|j| j.name.clone()).collect(), rows: Thinned::default(), coupling }
    }

    /// Takes a row: an angle for each of the layout's joints.
    pub fn push(&mut self, time_s: f64, angles: &[Option<Angle>]) {
        let degrees = |angle: &Angle| [angle.rad.to_degrees(), angle.sd_rad.to_degrees()];
        self.rows.push(time_s, angles.iter().map(|angle| angle.as_ref().map(degrees)));
        if let Some(coupling) = &mut self.coupling {
            let [x, y] = coupling.joints;
            if let (Some(x), Some(y)) = (angles[x], angles[y]) {
                coupling.push(x, y);
            }
        }
    }

    /// The joint before the last along the finger, and the last; none where no two follow each other.
    #[must_use]
    pub fn coupled_joints(&self) -> Option<[&str; 2]> {
        self.coupling.as_ref().map(|c| c.joints.map(|j| self.names[j].as_str()))
    }

    /// The line of the last joint's angle over that of the one before; none where the layout or the angles tell none.
    #[must_use]
    pub fn coupling_line(&self) -> Option<CouplingLine> {
        self.coupling.as_ref()?.pairs.line()
    }

    /// Draws all angles over time, and below their standard errors.
    ///
    /// # Errors
    /// A file that can't be written.
    pub fn draw_angles(&self, png: &Path, svg: &Path) -> anyhow::Result<()> {
        let spans = self.rows.lacking();
        let name = Some("an angle is missing".to_owned()).filter(|_| !spans.is_empty());
        let mut angles = vec![Item::Spans { name, spans: spans.clone() }];
        let mut errors = vec![Item::Spans { name: None, spans }];
        for (joint, name) in self.names.iter().enumerate() {
            angles.push(Item::Band { runs: self.rows.band(joint), colour: joint });
            let curve = self.rows.curve(joint);
            angles.push(Item::Line { name: Some(name.clone()), runs: curve, colour: joint, width: 1 });
            errors.push(Item::Line { name: None, runs: self.rows.largest_sd(joint), colour: joint, width: 1 });
        }
        let charts = [
            Chart::new(
                "Joint angles over time (bands: plus or minus one standard error)",
                "",
                "angle, degrees of flexion",
                angles,
                560,
            ),
            Chart::new("", "time, s", "standard error, degrees", errors, 280).from_zero(),
        ];
        draw_charts(&charts, WIDTH, png, svg)
    }

    /// Draws the last joint's angle against that of the one before, with its line. Draws nothing and says so where the
    /// layout has no two joints that follow each other.
    ///
    /// # Errors
    /// A file that can't be written.
    pub fn draw_coupling(&self, png: &Path, svg: &Path) -> anyhow::Result<bool> {
        let (Some(coupling), Some([x, y])) = (&self.coupling, self.coupled_joints()) else { return Ok(false) };
        let drawn = if coupling.every == 1 { String::new() } else { format!(", one of {} drawn", coupling.every) };
        let mut items = vec![Item::Dots {
            name: Some(format!("{} frames{drawn}", coupling.pairs.count)),
            points: coupling.dots.clone(),
            colour: 5,
        }];
        if let Some(line) = coupling.pairs.line() {
            let sign = if line.intercept_deg < 0.0 { '\u{2212}' } else { '+' };
            let slope = format!("{:.3}", line.slope).replace('-', "\u{2212}");
            let name = format!(
                "{y} = {slope} {x} {sign} {:.2}\u{b0}, r = {}",
                line.intercept_deg.abs(),
                format!("{:.4}", line.correlation).replace('-', "\u{2212}")
            );
            let ends = coupling.dots.iter().fold([f64::MAX, f64::MIN], |e, p| [e[0].min(p[0]), e[1].max(p[0])]);
            let run = ends.map(|x| [x, line.intercept_deg + line.slope * x]).to_vec();
            items.push(Item::Line { name: Some(name), runs: vec![run], colour: 1, width: 2 });
        }
        let chart = Chart::new(
            format!("{y} against {x}"),
            format!("{x}, degrees of flexion"),
            format!("{y}, degrees of flexion"),
            items,
            620,
        );
        draw_charts(&[chart], 820, png, svg)?;
        Ok(true)
    }
}

impl Coupling {
    fn push(&mut self, x: Angle, y: Angle) {
        if self.pairs.count.is_multiple_of(self.every) {
            if self.dots.len() == MOST_DOTS {
                self.every *= 2;
                let mut keep = false;
                self.dots.retain(|_| {
                    keep = !keep;
                    keep
                });
            }
            if self.pairs.count.is_multiple_of(self.every) {
                self.dots.push([x.rad.to_degrees(), y.rad.to_degrees()]);
            }
        }
        self.pairs.push(x, y);
    }
}

/// The last two joints of the finger with the most joints in a row, of which the first's distal segment is the
/// second's proximal
/// one; of several such fingers the first in the file.
fn last_two(layout: &Layout) -> Option<[usize; 2]> {
    let joints = &layout.joints;
    let before = |joint: usize| (0..joints.len()).find(|&a| joints[a].segments[1] == joints[joint].segments[0]);
    // A ring has no end: it is walked once at most.
    let depth = |joint: usize| std::iter::successors(before(joint), |&a| before(a)).take(joints.len()).count();
    let pairs = (0..joints.len()).rev().filter_map(|b| Some([before(b).filter(|&a| a != b)?, b]));
    pairs.max_by_key(|&[_, b]| depth(b))
}

#[cfg(test)]
mod tests;
