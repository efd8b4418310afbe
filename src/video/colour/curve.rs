//! How the ordinary samples of frames stand for light: the curves that cameras encode by, and back.
//!
//! In: a part of red, green or blue, 0 to 1. Out: light, 1 being that of a part of 1, or the other way. A curve is
//! straight up to a knee and a shifted power of light from there on, so that the ratio of two encoded colours moves
//! with brightness alone, and that of their light does not. What a camera does on top of the standard's curve (a
//! shoulder, a tone that is mapped) is not known here.

use super::transfer::{GAMMA, Transfer};

/// A curve between light and encoded parts.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Curve {
    /// BT.601's, BT.709's and BT.2020's, the same for all of them.
    #[default]
    Bt709,
    /// IEC 61966-2-1.
    Srgb,
    /// A power, as HDR is made ordinary with.
    Power,
}

/// `light = ((part + shift) / (1 + shift))^power` from `knee` on, `part / slope` below.
#[derive(Debug, Clone, Copy)]
struct Shape {
    shift: f64,
    power: f64,
    knee: f64,
    slope: f64,
}

/// To the digits of BT.2020's 12 bits, with which straight line and power meet.
const BT709: Shape =
    Shape { shift: 0.099_296_826_809_44, power: 1.0 / 0.45, knee: 4.5 * 0.018_053_968_510_807, slope: 4.5 };
const SRGB: Shape = Shape { shift: 0.055, power: 2.4, knee: 0.04045, slope: 12.92 };
const POWER: Shape = Shape { shift: 0.0, power: GAMMA, knee: 0.0, slope: 1.0 };

/// What so many times the light does to encoded parts.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lit {
    curve: Curve,
    factor: f64,
    /// Above the knee both ends of the curve are powers: all that is left of them is this.
    root: f64,
}

/// [`Curve::times`] by a table, for factors up to 2: a power for each pixel took 7 % of a phantom's time.
#[derive(Debug, Clone)]
pub(crate) struct Times {
    curve: Curve,
    roots: Vec<f64>,
}

/// Entries of the table for each 1, and where it begins to count: from there on roots are right to 2e-6.
const STEPS: f64 = 1024.0;
const LEAST: f64 = 0.1;

impl Curve {
    /// Of frames as they are read, of a file that says this of its own.
    #[must_use]
    pub fn of_read(transfer: Transfer) -> Self {
        if transfer == Transfer::Power { Self::Bt709 } else { Self::Power }
    }

    /// Light of an encoded part.
    #[must_use]
    pub fn light(self, part: f64) -> f64 {
        let Shape { shift, power, knee, slope } = self.shape();
        if part < knee { part / slope } else { ((part + shift) / (1.0 + shift)).powf(power) }
    }

    /// The encoded part of light.
    #[must_use]
    pub fn encoded(self, light: f64) -> f64 {
        let Shape { shift, power, knee, slope } = self.shape();
        if light < knee / slope { light * slope } else { (1.0 + shift) * light.powf(1.0 / power) - shift }
    }

    /// So many times the light.
    pub(crate) fn times(self, factor: f64) -> Lit {
        Lit { curve: self, factor, root: factor.powf(1.0 / self.shape().power) }
    }

    fn shape(self) -> Shape {
        match self {
            Self::Bt709 => BT709,
            Self::Srgb => SRGB,
            Self::Power => POWER,
        }
    }
}

impl Times {
    pub(crate) fn new(curve: Curve) -> Self {
        let entries = 2 * STEPS as usize;
        Self { curve, roots: (0..=entries).map(|k| curve.times(k as f64 / STEPS).root).collect() }
    }

    pub(crate) fn of(&self, factor: f64) -> Lit {
        let at = factor * STEPS;
        let whole = at as usize;
        if factor < LEAST || whole + 1 >= self.roots.len() {
            return self.curve.times(factor);
        }
        let share = at - whole as f64;
        let root = self.roots[whole] + share * (self.roots[whole + 1] - self.roots[whole]);
        Lit { curve: self.curve, factor, root }
    }
}

impl Lit {
    /// Both at once; of one curve.
    pub(crate) fn and(self, other: Self) -> Self {
        Self { factor: self.factor * other.factor, root: self.root * other.root, ..self }
    }

    pub(crate) fn factor(self) -> f64 {
        self.factor
    }

    /// The encoded part of so many times the light of a part.
    pub(crate) fn of(self, part: f64) -> f64 {
        let Shape { shift, knee, .. } = self.curve.shape();
        let lit = (part + shift) * self.root - shift;
        if part.min(lit) >= knee { lit } else { self.curve.encoded(self.factor * self.curve.light(part)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Curve; 3] = [Curve::Bt709, Curve::Srgb, Curve::Power];

    #[test]
    fn known_levels_are_the_standards() {
        // BT.709's own constants have fewer digits: 0.5 is ((0.5 + 0.099) / 1.099)^(1 / 0.45).
        let cases = [
            (Curve::Bt709, 0.5, 0.259_590, 2e-4),
            (Curve::Bt709, 0.045, 0.01, 1e-12),
            (Curve::Srgb, 0.5, 0.214_041, 1e-6),
            (Curve::Srgb, 0.02, 0.001_548, 1e-6),
            (Curve::Power, 0.5, 0.217_638, 1e-6),
        ];
        for (curve, part, light, within) in cases {
            assert!((curve.light(part) - light).abs() <= within, "{curve:?} {part}: {}", curve.light(part));
        }
    }

    #[test]
    fn parts_go_there_and_back_and_light_is_multiplied() {
        for (curve, k) in ALL.into_iter().flat_map(|curve| (0..=130).map(move |k| (curve, k))) {
            let part = 0.01 * f64::from(k);
            let back = curve.encoded(curve.light(part));
            // sRGB's knee and slope have few digits: its two ends are 2e-7 apart there.
            assert!((back - part).abs() <= 1e-6, "{curve:?} {part}: {back}");
            for factor in [0.0, 0.02, 0.5, 1.0, 1.7] {
                let [lit, light] = [curve.times(factor).of(part), factor * curve.light(part)];
                assert!((curve.light(lit) - light).abs() <= 1e-6, "{curve:?} {part} times {factor}: {lit}");
                let twice = curve.times(factor).and(curve.times(0.6)).of(part);
                assert!((curve.light(twice) - 0.6 * light).abs() <= 1e-6, "{curve:?} {part} times {factor}: {twice}");
            }
        }
        assert!(Curve::Bt709.light(f64::NAN).is_nan());
    }

    #[test]
    fn tables_give_what_powers_give() {
        for curve in ALL {
            let times = Times::new(curve);
            for k in 0..2500 {
                let factor = 0.000_93 * f64::from(k);
                let [quick, exact] = [times.of(factor).root, curve.times(factor).root];
                assert!((quick - exact).abs() <= 2e-6, "{curve:?} {factor}: {quick} {exact}");
            }
        }
    }
}
