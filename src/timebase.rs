//! One clock's time as a straight line in another's.
//!
//! `other = at_reference + (1 + drift) (own - reference)`. The line is held at the own time at which the errors of its
//! height and of its slope do not depend on each other, so that the standard error at any time follows from the two.

/// A clock's time as a straight line in another's, with standard errors.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Timebase {
    /// The own time at which height and slope err independently, seconds.
    pub reference_s: f64,
    /// The other clock's time there, seconds.
    pub at_reference_s: f64,
    /// Its standard error, seconds.
    pub at_reference_sd_s: f64,
    /// How much faster the other clock runs, as a share: 1e-6 is a millionth.
    pub drift: f64,
    /// Its standard error.
    pub drift_sd: f64,
}

impl Timebase {
    /// The other clock's time at the own time `own_s`.
    #[must_use]
    pub fn other_s(&self, own_s: f64) -> f64 {
        self.at_reference_s + (1.0 + self.drift) * (own_s - self.reference_s)
    }

    /// The own time at which the other clock shows `other_s`.
    #[must_use]
    pub fn own_s(&self, other_s: f64) -> f64 {
        self.reference_s + (other_s - self.at_reference_s) / (1.0 + self.drift)
    }

    /// The standard error of [`other_s`](Self::other_s) at the own time `own_s`, seconds.
    #[must_use]
    pub fn sd_s(&self, own_s: f64) -> f64 {
        self.at_reference_sd_s.hypot(self.drift_sd * (own_s - self.reference_s))
    }

    /// The same line with the errors that three own times and the standard errors there tell, `[time, error]` in
    /// seconds; the slope's stays 0 where the times coincide or the error is the same at all of them.
    #[must_use]
    pub fn with_errors(self, [first, middle, last]: [[f64; 2]; 3]) -> Self {
        let variance = |point: [f64; 2]| point[1] * point[1];
        // variance = at_middle + slope (t - middle) + curve (t - middle)^2
        let (before, after) = (first[0] - middle[0], last[0] - middle[0]);
        let (down, up) = (variance(first) - variance(middle), variance(last) - variance(middle));
        let determinant = before * after * (after - before);
        let curve = (up * before - down * after) / determinant;
        let slope = (down * after * after - up * before * before) / determinant;
        // Without a curve there is no reference; what rounding leaves of one is none.
        let noise = 1e-6 * variance(middle) / (after * after).max(before * before);
        if !(determinant.abs() > 0.0 && curve > noise) {
            let at_reference_s = self.other_s(middle[0]);
            let reference_s = middle[0];
            return Self { reference_s, at_reference_s, at_reference_sd_s: middle[1], drift_sd: 0.0, ..self };
        }
        let reference_s = middle[0] - 0.5 * slope / curve;
        let least = (variance(middle) - 0.25 * slope * slope / curve).max(0.0);
        Self {
            reference_s,
            at_reference_s: self.other_s(reference_s),
            at_reference_sd_s: least.sqrt(),
            drift: self.drift,
            drift_sd: curve.sqrt(),
        }
    }

    /// The other clock's time at the own time 0, seconds.
    #[must_use]
    pub fn offset_s(&self) -> f64 {
        self.other_s(0.0)
    }

    /// The standard error of [`offset_s`](Self::offset_s), seconds.
    #[must_use]
    pub fn offset_sd_s(&self) -> f64 {
        self.sd_s(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_at_three_times_tell_how_they_grow() {
        let line =
            Timebase { reference_s: 3.0, at_reference_s: 70.0, at_reference_sd_s: 2e-3, drift: 1e-5, drift_sd: 1e-4 };
        let plain = Timebase { reference_s: 0.0, at_reference_s: line.other_s(0.0), ..line };
        let fitted = plain.with_errors([0.0, 4.0, 20.0].map(|t| [t, line.sd_s(t)]));
        for (got, want) in [
            (fitted.reference_s, 3.0),
            (fitted.at_reference_sd_s, 2e-3),
            (fitted.drift_sd, 1e-4),
            (fitted.other_s(9.0), line.other_s(9.0)),
        ] {
            assert!((got - want).abs() <= 1e-9, "{got} {want}");
        }
        for same in [[[5.0, 0.01]; 3], [[0.0, 0.01], [5.0, 0.01], [9.0, 0.01]]] {
            let fitted = plain.with_errors(same);
            assert!(fitted.drift_sd == 0.0 && fitted.sd_s(100.0) == 0.01);
        }
    }

    #[test]
    fn there_and_back_and_the_error_grows_from_the_reference_on() {
        let line =
            Timebase { reference_s: 10.0, at_reference_s: 70.0, at_reference_sd_s: 3e-3, drift: 1e-4, drift_sd: 4e-4 };
        assert!((line.own_s(line.other_s(25.0)) - 25.0).abs() <= 1e-12);
        assert!((line.offset_s() - (60.0 - 1e-3)).abs() <= 1e-12);
        assert!((line.offset_sd_s() - 5e-3).abs() <= 1e-15 && line.sd_s(10.0) == 3e-3);
    }
}
