//! What is prompted over the server's time: stretches in which a step moves or stands still.
//!
//! A stretch may begin a little in the future, so that a page knows of it before it happens; what is asked for of the
//! past stays as it was.

/// What a stretch is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum What {
    /// Nothing is prompted.
    Nothing,
    /// The check of the force's sign: press a little.
    Press,
    /// A step of the protocol, by its place.
    Step(usize),
}

/// A stretch of time, until the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stretch {
    /// When it begins, seconds of the server's clock.
    pub(crate) from_s: f64,
    /// The step's own time then, seconds.
    pub(crate) at_s: f64,
    /// What it is about.
    pub(crate) what: What,
    /// Whether the step's own time goes on.
    pub(crate) moves: bool,
}

/// All stretches so far.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Course(Vec<Stretch>);

impl Default for Course {
    fn default() -> Self {
        Self(vec![Stretch { from_s: f64::NEG_INFINITY, at_s: 0.0, what: What::Nothing, moves: false }])
    }
}

impl Course {
    /// From `from_s` on; never before what began last. Returns when it begins.
    pub(crate) fn push(&mut self, from_s: f64, at_s: f64, what: What, moves: bool) -> f64 {
        let from_s = self.0.last().map_or(from_s, |last| from_s.max(last.from_s));
        self.0.push(Stretch { from_s, at_s, what, moves });
        from_s
    }

    /// Stops at `from_s`, or when what began last begins; where the step is then.
    pub(crate) fn stop(&mut self, from_s: f64) -> f64 {
        let from_s = self.0.last().map_or(from_s, |last| from_s.max(last.from_s));
        let (stretch, at_s) = self.at(from_s);
        self.push(from_s, at_s, stretch.what, false);
        at_s
    }

    /// The stretch at `time_s`, and the step's own time then, seconds.
    #[must_use]
    pub(crate) fn at(&self, time_s: f64) -> (Stretch, f64) {
        let after = self.0.partition_point(|stretch| stretch.from_s <= time_s).max(1);
        let stretch = self.0[after - 1];
        let at_s = if stretch.moves { stretch.at_s + (time_s - stretch.from_s) } else { stretch.at_s };
        (stretch, at_s)
    }

    /// All of them but the first, which has no beginning.
    #[must_use]
    pub(crate) fn stretches(&self) -> &[Stretch] {
        self.0.get(1..).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_steps_time_goes_on_only_where_it_moves() {
        let mut course = Course::default();
        assert_eq!(course.at(-1e9).0.what, What::Nothing);
        course.push(10.0, 0.0, What::Step(2), true);
        assert_eq!(course.at(9.9).0.what, What::Nothing);
        assert_eq!(course.at(14.0), (course.0[1], 4.0));
        assert_eq!(course.stop(15.0), 5.0);
        assert_eq!(course.at(99.0).1, 5.0);
        course.push(20.0, 5.0, What::Step(2), true);
        assert_eq!((course.at(14.0).1, course.at(17.0).1, course.at(21.5).1), (4.0, 5.0, 6.5));
        // Stopped before it began again: it does not begin.
        course.push(30.0, 6.5, What::Step(2), false);
        course.push(31.0, 6.5, What::Step(2), true);
        assert_eq!((course.stop(30.5), course.at(40.0).1, course.stretches().len()), (6.5, 6.5, 6));
    }
}
