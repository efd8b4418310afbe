//! What one frame shows of one marker.

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Centre {
    /// Column and row in the stored picture.
    pub at_px: [f64; 2],
    /// Variance of x, covariance, variance of y.
    pub covariance_px2: [f64; 3],
    /// The part of it that stays from frame to frame, as what is taken for a blot's outline does.
    pub lasting_px2: [f64; 3],
    /// Radius of a disc of the marker's area.
    pub radius_px: f64,
}

impl Centre {
    /// The standard error of a coordinate: the root of the mean of both variances.
    #[must_use]
    pub(crate) fn sd_px(&self) -> f64 {
        (0.5 * (self.covariance_px2[0] + self.covariance_px2[2])).sqrt()
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Loss {
    /// Nothing of its colour where it can be.
    NotFound,
    /// Seen in part only, or changed in shape or size.
    Hidden,
    /// It reaches over the picture's border.
    AtTheBorder,
    /// It can't be distinguished from another marker.
    Ambiguous,
    /// The frame could not be decoded.
    Undecoded,
}

/// A marker in a frame: seen or not.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Sight {
    Seen(Centre),
    /// Why it is not seen.
    Lost(Loss),
}
