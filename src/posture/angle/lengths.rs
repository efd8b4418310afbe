//! Whether each segment keeps its length: where one of its two markers is followed wrongly, it does not.
//!
//! In: from frame to frame the places of both ends of a segment. Out: the segments whose lengths vary by more than skin
//! that slides explains, or by less while one end stands still and the other moves, as where something of a marker's
//! colour on the table was taken for it ([`Lengths::changing`]): in all frames, or from when it was found again to when
//! it was lost.
//!
//! Measured on 16 videos of two phantoms (480x270, the fingertip's marker hidden in the first second, a disc of its
//! colour 22 or 28 px beside it): in 11 the disc was followed, J3 32 to 75 degrees off; its segment's length varied by
//! 6 to 9 %, and nothing was said of the others.

/// A segment whose length varies by more is not one segment, as a standard deviation over the mean (assumed: skin that
/// slides evenly by 15 % makes 5 %).
const MOST_SD: f64 = 0.075;
/// One that stands still at one end and moves at the other varies by no more than this.
const MOST_STILL_SD: f64 = 0.025;
/// An end stands still that moves by less than this share of the length, and moves that moves by more than that.
const STILL: f64 = 0.015;
const MOVES: f64 = 0.1;
/// Segments whose lengths vary by no more than so many times as much as another's vary alike, as where the camera zooms
/// (on two phantom films zoomed by 25 % all four vary by 11 %).
const ALIKE: f64 = 1.25;
/// Below so many frames of a segment it has no say.
const FRAMES: f64 = 20.0;
/// ... and of frames running below so many (assumed; another finger's mark was followed for 14).
const RUNNING: f64 = 10.0;

/// What the segments of one video say.
#[derive(Debug, Clone)]
pub(super) struct Lengths {
    segments: Vec<Segment>,
    /// Frames so far.
    frames: u64,
}

#[derive(Debug, Clone, Default)]
struct Segment {
    /// All its frames.
    all: Sums,
    /// Those running up to the last one that shows it.
    run: Run,
    /// Earlier runs in which one end stands still and the length varies.
    doubted: Vec<Run>,
}

/// Frames running.
#[derive(Debug, Clone, Default)]
struct Run {
    first: u64,
    last: u64,
    sums: Sums,
}

impl Run {
    fn is_doubted(&self) -> bool {
        self.sums.length.count >= RUNNING && self.sums.is_to_something_still()
    }
}

/// Of a segment over some frames.
#[derive(Debug, Clone, Default)]
struct Sums {
    length: Moments,
    /// Of each end its columns and rows.
    ends: [[Moments; 2]; 2],
}

impl Sums {
    /// The standard deviation of its length over the mean.
    fn share(&self) -> f64 {
        self.length.variance().sqrt() / self.length.mean
    }

    fn add(&mut self, ends_px: [[f64; 2]; 2]) {
        self.length.add((ends_px[1][0] - ends_px[0][0]).hypot(ends_px[1][1] - ends_px[0][1]));
        for (moments, at) in self.ends.iter_mut().flatten().zip(ends_px.into_iter().flatten()) {
            moments.add(at);
        }
    }

    /// Whether one end stands still, the other moves, and the length varies by more than is a segment's.
    fn is_to_something_still(&self) -> bool {
        let moved = self.ends.map(|end| (end[0].variance() + end[1].variance()).sqrt() / self.length.mean);
        moved[0].min(moved[1]) < STILL && moved[0].max(moved[1]) > MOVES && self.share() > MOST_STILL_SD
    }
}

/// Mean and variance of numbers as they come (Welford 1962, doi:10.1080/00401706.1962.10490022).
#[derive(Debug, Clone, Copy, Default)]
struct Moments {
    count: f64,
    mean: f64,
    squares: f64,
}

impl Moments {
    fn add(&mut self, value: f64) {
        self.count += 1.0;
        let off = value - self.mean;
        self.mean += off / self.count;
        self.squares += off * (value - self.mean);
    }

    fn variance(&self) -> f64 {
        self.squares / self.count
    }
}

impl Lengths {
    pub(super) fn new(segments: usize) -> Self {
        Self { segments: vec![Segment::default(); segments], frames: 0 }
    }

    /// Takes the places of a segment's ends in the frame at hand.
    pub(super) fn add(&mut self, segment: usize, ends_px: [[f64; 2]; 2]) {
        let Segment { all, run, doubted } = &mut self.segments[segment];
        all.add(ends_px);
        if run.sums.length.count == 0.0 || run.last + 1 < self.frames {
            let before = std::mem::replace(run, Run { first: self.frames, ..Run::default() });
            doubted.extend(Some(before).filter(Run::is_doubted));
        }
        run.last = self.frames;
        run.sums.add(ends_px);
    }

    pub(super) fn next_frame(&mut self) {
        self.frames += 1;
    }

    /// That all segments change their lengths alike.
    pub(super) fn zoomed(&self) -> Option<String> {
        let shares = || self.segments.iter().map(|segment| segment.all.share());
        let [least, most] =
            shares().fold([f64::INFINITY, 0.0], |[least, most], share| [share.min(least), share.max(most)]);
        let enough = self.segments.len() > 1 && self.segments.iter().all(|segment| segment.all.length.count >= FRAMES);
        (enough && least > MOST_SD && most < ALIKE * least).then(|| {
            format!(
                "all segments change their lengths alike, by {:.0} % (the standard deviation over frames): did the \
                 camera zoom, or the hand come nearer? Angles are as right as before; a zoom of 20 % at once loses \
                 markers",
                100.0 * most
            )
        })
    }

    /// The segments that are doubted, and what to say of each.
    pub(super) fn changing(&self) -> Vec<(usize, String)> {
        if self.zoomed().is_some() {
            return Vec::new();
        }
        let changes = |(number, segment): (usize, &Segment)| Some((number, segment.changes()?));
        self.segments.iter().enumerate().filter_map(changes).collect()
    }
}

impl Segment {
    /// What to say of it, if it is doubted.
    fn changes(&self) -> Option<String> {
        if self.all.length.count < FRAMES {
            return None;
        }
        let still = self.all.is_to_something_still();
        let (share, when) = if still || self.all.share() > MOST_SD {
            (self.all.share(), String::new())
        } else {
            let runs: Vec<&Run> = self.doubted.iter().chain(Some(&self.run).filter(|run| run.is_doubted())).collect();
            let first = runs.first()?;
            let others = match runs.len() {
                1 => String::new(),
                count => format!(", and in {} other place(s)", count - 1),
            };
            (first.sums.share(), format!(" in frames {} to {}{others}", first.first, first.last))
        };
        let end =
            if still || !when.is_empty() { " while one of its ends stands still and the other moves" } else { "" };
        Some(format!(
            "changes its length by {:.0} % (the standard deviation over frames){end}{when}: is one of the two markers \
             hidden in part, or another thing of its colour followed for it? --overlay shows what was followed",
            100.0 * share
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of two segments of 50 and 30 px that bend by up to 80 degrees, for whose tip something at `still` is taken.
    fn changing(still: Option<[f64; 2]>, frames: std::ops::Range<i32>) -> Vec<(usize, String)> {
        let mut lengths = Lengths::new(2);
        for frame in frames {
            let bent = 80f64.to_radians() * (0.5 - 0.5 * (0.1 * f64::from(frame)).cos());
            let joint = [50.0 * (0.5 * bent).cos(), 50.0 * (0.5 * bent).sin()];
            let tip = [joint[0] + 30.0 * bent.cos(), joint[1] + 30.0 * bent.sin()];
            lengths.add(0, [[0.0, 0.0], joint]);
            lengths.add(1, [joint, still.unwrap_or(tip)]);
            lengths.next_frame();
        }
        lengths.changing()
    }

    #[test]
    fn a_segment_to_something_that_stands_still_changes_its_length() {
        assert_eq!(changing(None, 0..200), []);
        for still in [[80.0, 8.0], [72.0, 30.0], [60.0, 50.0]] {
            let all = changing(Some(still), 0..200);
            assert!(all.len() == 1 && all[0].0 == 1 && all[0].1.contains("changes its length by "), "{all:?}");
        }
        // Followed only while the length is about right.
        let some = changing(Some([76.0, 12.0]), 0..24);
        assert!(some.len() == 1 && some[0].1.contains("while one of its ends stands still"), "{some:?}");
        assert_eq!(changing(Some([80.0, 8.0]), 0..19), [], "too few frames");
    }

    #[test]
    fn another_mark_that_is_followed_for_some_frames_is_named_with_these() {
        // It turns by 0.02 a frame; from the 90th on the distal end passes by a mark that stands still.
        let taken = |frames: u64| {
            let mut lengths = Lengths::new(1);
            for frame in 0..200 {
                let rad = 0.02 * frame as f64;
                let tip = [50.0 * rad.cos(), 50.0 * rad.sin()];
                let passes = [30.0 * (frame as f64 - 97.0) / 7.0, 45.0];
                match frame {
                    90.. if frame < 90 + frames => lengths.add(0, [[0.0; 2], passes]),
                    // It is lost before and behind.
                    80..110 => {}
                    _ => lengths.add(0, [[0.0; 2], tip]),
                }
                lengths.next_frame();
            }
            lengths.changing()
        };
        let all = taken(14);
        assert!(all.len() == 1 && all[0].1.contains("still and the other moves in frames 90 to 103: "), "{all:?}");
        assert_eq!(taken(9), []);
        assert_eq!(taken(0), []);
    }

    #[test]
    fn where_all_lengths_change_alike_the_camera_zooms() {
        let all = |factors: [f64; 2]| {
            let mut lengths = Lengths::new(2);
            for frame in 0..200 {
                let zoom = (f64::from(frame - 100) / 60.0).clamp(0.0, 1.0);
                for (segment, factor) in factors.into_iter().enumerate() {
                    lengths.add(segment, [[0.0, 0.0], [30.0 * (1.0 + factor * zoom), 0.0]]);
                }
                lengths.next_frame();
            }
            (lengths.zoomed().is_some(), lengths.changing().len())
        };
        assert_eq!(all([0.25, 0.25]), (true, 0));
        assert_eq!(all([0.25, 0.6]), (false, 2));
        assert_eq!(all([0.25, 0.0]), (false, 1));
        assert_eq!(all([0.05, 0.05]), (false, 0));
    }

    #[test]
    fn skin_that_slides_and_a_tip_that_rests_do_not() {
        let (mut slides, mut rests) = (Lengths::new(1), Lengths::new(1));
        for frame in 0..200 {
            let bent = 0.5 - 0.5 * (0.1 * f64::from(frame)).cos();
            slides.add(0, [[0.0, 0.0], [30.0 * (1.0 + 0.15 * bent), 0.0]]);
            // The fingertip on a table, the joint above it bends.
            let rad = 1.2 * bent;
            rests.add(0, [[30.0 * rad.cos(), -30.0 * rad.sin()], [0.0, 0.02 * f64::from(frame % 5)]]);
            slides.next_frame();
            rests.next_frame();
        }
        assert_eq!(slides.changing(), []);
        assert_eq!(rests.changing(), []);
    }
}
