//! The resolution of a device's clock: the last decimal in which its stamps are written.

/// Stamps are read to this part of their last decimal: 1.7e9 s and a thousandth are known to 2e-4 of it.
const READ_PART: f64 = 1e-3;

/// Digits of a stamp that a number of 64 bits still holds to that part.
const MOST: f64 = 1e13;

/// The coarsest decimal of which all stamps are multiples, one unit at most.
#[derive(Debug, Clone)]
pub struct Resolution {
    /// Of a unit so many parts.
    parts: f64,
}

impl Default for Resolution {
    fn default() -> Self {
        Self { parts: 1.0 }
    }
}

impl Resolution {
    /// Reads a stamp.
    pub fn read(&mut self, stamp: f64) {
        loop {
            let parts = stamp * self.parts;
            if parts.abs() >= MOST || (parts - parts.round()).abs() <= READ_PART {
                return;
            }
            self.parts *= 10.0;
        }
    }

    /// The resolution in the stamps' unit.
    #[must_use]
    pub fn unit(&self) -> f64 {
        self.parts.recip()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_decimal_is_the_resolution() {
        for (stamps, unit) in [
            (&[5000.0, 5001.0][..], 1.0),
            (&[59.01, 59.02], 0.01),
            (&[0.001, 0.002, 123_456.789], 0.001),
            (&[1_764_471_913.017, 1_764_471_913.034], 0.001),
            (&[59.007_385, 59.017_385], 1e-6),
        ] {
            let mut resolution = Resolution::default();
            stamps.iter().for_each(|stamp| resolution.read(*stamp));
            assert!((resolution.unit() / unit - 1.0).abs() <= 1e-9, "{stamps:?}: {resolution:?}");
        }
        // What no decimal holds ends, too.
        let mut resolution = Resolution::default();
        resolution.read(1.0 / 3.0);
        assert!(resolution.unit() <= 1e-9);
    }
}
