//! What photodiodes on the nail see of the capillaries under them.
//!
//! In: the capillaries' lumens `l = d / D` and [`Parameters`]. Out: voltages, and their derivatives by the lumens.
//! Every choice of [`Optics`] is `V_Pi = V_0i + V_1i f_i(l_i)` with one [`Photodiodes::signal`] `f_i`; offset and
//! scaling are each photodiode's own.
//!
//! With `a = alpha_i D_Ci^2` (equation 7) the thesis has `f = exp(-a l^2)` (equation 6, Beer and Lambert) and its first
//! two Taylor terms `f = 1 - a l^2`, which are equation 8 with `V'_0 = V_0 + V_1` and `V'_1 = V_1 alpha`. The thesis
//! estimates `alpha (D + x)^2` as 1e-2; its table gives 0.134 at rest, and there the two terms overstate changes by 7 %
//! (capillaries emptying) to 15 % (swelling) unless `V_0` and `V_1` are fitted again. So equation 6 is the default.
//!
//! `exp` is that of the crate `libm`: the same digits on every machine.

use crate::parameters::{Parameters, Site};

/// How light depends on a lumen.
#[derive(Clone, Debug, PartialEq, Default)]
pub enum Optics {
    /// Equation 6: `V_0 + V_1 exp(-alpha (D + x)^2)`.
    #[default]
    BeerLambert,
    /// Equation 8: `V'_0 - V'_1 (D + x)^2` with `V'_0 = V_0 + V_1` and `V'_1 = V_1 alpha`.
    Quadratic,
    /// The tangent of equation 6 at these lumens `d / D` of the capillaries, usually those at rest.
    Linear(Vec<f64>),
}

/// The photodiodes of all units, with their products computed.
#[derive(Clone, Debug, PartialEq)]
pub struct Photodiodes {
    diodes: Vec<Diode>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Diode {
    /// `alpha D^2`.
    absorbance: f64,
    offset: f64,
    scaling: f64,
    curve: Curve,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Curve {
    Exponential,
    Quadratic,
    /// Lumen, signal and slope at the working point.
    Tangent(f64, f64, f64),
}

/// Why photodiodes can't be had.
#[derive(Debug, thiserror::Error, Clone, PartialEq)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum OpticsFault {
    #[error("the optics' working point has {got} lumens; it needs one for each of {units} capillary units")]
    Length { units: usize, got: usize },
    #[error("the optics' working point of {site} is {lumen}; it has to be a finite lumen (d / D) greater than 0")]
    Lumen { site: Site, lumen: f64 },
}

impl Photodiodes {
    /// The photodiodes of these parameters. An error where the working point of [`Optics::Linear`] is not an open lumen
    /// for each unit.
    pub fn new(parameters: &Parameters, optics: &Optics) -> Result<Photodiodes, OpticsFault> {
        let units = parameters.units();
        if let Optics::Linear(lumens) = optics {
            if lumens.len() != units.len() {
                return Err(OpticsFault::Length { units: units.len(), got: lumens.len() });
            }
            if let Some(i) = lumens.iter().position(|&lumen| !(lumen.is_finite() && lumen > 0.0)) {
                return Err(OpticsFault::Lumen { site: Site::Capillary(i), lumen: lumens[i] });
            }
        }
        let diodes = units.iter().enumerate().map(|(i, unit)| {
            let d = unit.capillary.diameter_m;
            let absorbance = parameters.alpha_per_m2(i) * (d * d);
            let curve = match optics {
                Optics::BeerLambert => Curve::Exponential,
                Optics::Quadratic => Curve::Quadratic,
                Optics::Linear(lumens) => {
                    let at = lumens[i];
                    let signal = libm::exp(-absorbance * (at * at));
                    Curve::Tangent(at, signal, -2.0 * absorbance * at * signal)
                }
            };
            Diode { absorbance, offset: unit.offset_v, scaling: unit.scaling_v, curve }
        });
        Ok(Photodiodes { diodes: diodes.collect() })
    }

    /// The number of photodiodes: one for each capillary unit.
    #[allow(clippy::len_without_is_empty, reason = "there is at least one unit")]
    pub fn len(&self) -> usize {
        self.diodes.len()
    }

    /// The signal `f_i` at a lumen of capillary `i`, without offset and scaling: 1 through an empty capillary.
    pub fn signal(&self, i: usize, lumen: f64) -> f64 {
        let diode = &self.diodes[i];
        match diode.curve {
            Curve::Exponential => libm::exp(-diode.absorbance * (lumen * lumen)),
            Curve::Quadratic => 1.0 - diode.absorbance * (lumen * lumen),
            Curve::Tangent(at, signal, slope) => signal + slope * (lumen - at),
        }
    }

    /// The derivative of [`Photodiodes::signal`] by the lumen.
    pub fn signal_slope(&self, i: usize, lumen: f64) -> f64 {
        let diode = &self.diodes[i];
        match diode.curve {
            Curve::Exponential => -2.0 * diode.absorbance * lumen * libm::exp(-diode.absorbance * (lumen * lumen)),
            Curve::Quadratic => -2.0 * diode.absorbance * lumen,
            Curve::Tangent(_, _, slope) => slope,
        }
    }

    /// The derivative of [`Photodiodes::signal`] by the logarithm of `alpha D^2`.
    pub fn signal_by_absorbance(&self, i: usize, lumen: f64) -> f64 {
        let diode = &self.diodes[i];
        let absorption = diode.absorbance * (lumen * lumen);
        match diode.curve {
            Curve::Exponential => -absorption * libm::exp(-absorption),
            Curve::Quadratic => -absorption,
            Curve::Tangent(at, signal, slope) => {
                let there = diode.absorbance * (at * at);
                -there * signal + slope * (1.0 - there) * (lumen - at)
            }
        }
    }

    /// The voltage of photodiode `i` at a lumen of capillary `i`, V.
    pub fn voltage(&self, i: usize, lumen: f64) -> f64 {
        self.diodes[i].offset + self.diodes[i].scaling * self.signal(i, lumen)
    }

    /// The derivative of [`Photodiodes::voltage`] by the lumen, V.
    pub fn slope(&self, i: usize, lumen: f64) -> f64 {
        self.diodes[i].scaling * self.signal_slope(i, lumen)
    }

    /// All voltages (V) at the lumens of all capillaries (the vein's may follow), written to `out`, a value for each
    /// unit.
    pub fn voltages(&self, lumens: &[f64], out: &mut [f64]) {
        for (i, volts) in out.iter_mut().enumerate() {
            *volts = self.voltage(i, lumens[i]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lumen of both capillaries at rest (the walls are displaced by 9.273971e-6 m).
    const REST: f64 = 1.927_397_1;

    fn diodes(optics: Optics) -> Photodiodes {
        Photodiodes::new(&Parameters::thesis(), &optics).expect("a good working point")
    }

    #[test]
    fn at_rest_absorption_is_0_134() {
        let absorption = -diodes(Optics::BeerLambert).signal(0, REST).ln();
        // 0.13421 measured.
        assert!((absorption - 0.134).abs() <= 5e-4, "{absorption}");
    }

    #[test]
    fn two_terms_overstate_changes_by_7_to_15_percent() {
        let (exact, two) = (diodes(Optics::BeerLambert), diodes(Optics::Quadratic));
        let excess = |lumen: f64| {
            (two.signal(0, lumen) - two.signal(0, REST)) / (exact.signal(0, lumen) - exact.signal(0, REST)) - 1.0
        };
        // Measured: 0.0686 emptied, 0.1436 about rest, 0.1495 swollen to the pressure P_H.
        for (lumen, expected) in [(1e-9, 0.0686), (REST * (1.0 - 1e-6), 0.1436), (2.0, 0.1495)] {
            assert!((excess(lumen) - expected).abs() <= 1e-4, "{lumen}: {}", excess(lumen));
        }
    }

    #[test]
    fn equation_8_is_its_printed_form() {
        let parameters = Parameters::thesis();
        let parameters = parameters.set("V0_2_V".parse().unwrap(), 0.3).unwrap();
        let parameters = parameters.set("V1_2_V".parse().unwrap(), -2.5).unwrap();
        let diodes = Photodiodes::new(&parameters, &Optics::Quadratic).unwrap();
        let (primed_0, primed_1) = (0.3 - 2.5, -2.5 * parameters.alpha_per_m2(1));
        for lumen in [0.01, 0.7, 1.9, 3.0] {
            let d = 1e-5 * lumen;
            let printed = primed_0 - primed_1 * d * d;
            assert!((diodes.voltage(1, lumen) - printed).abs() <= 1e-15, "{lumen}");
        }
    }

    #[test]
    fn slopes_are_derivatives() {
        // Central differences at 1e-6: measured 2.1e-10.
        const TOLERANCE: f64 = 1e-9;
        let parameters = Parameters::thesis().set("V1_1_V".parse().unwrap(), 3.5).unwrap();
        for optics in [Optics::BeerLambert, Optics::Quadratic, Optics::Linear(vec![REST, 1.0])] {
            let diodes = Photodiodes::new(&parameters, &optics).unwrap();
            for lumen in [0.05, 1.0, REST, 2.5] {
                let numeric = (diodes.voltage(0, lumen + 1e-6) - diodes.voltage(0, lumen - 1e-6)) / 2e-6;
                let gap = (diodes.slope(0, lumen) - numeric).abs();
                assert!(gap <= TOLERANCE, "{optics:?} at {lumen}: {gap}");
            }
        }
    }

    #[test]
    fn signals_change_with_absorbance() {
        // Central differences at 1e-5: measured 6e-12.
        const TOLERANCE: f64 = 1e-10;
        let parameters = Parameters::thesis();
        let at = |epsilon: f64, optics: &Optics| {
            Photodiodes::new(&parameters.set(crate::Symbol::Absorption, epsilon).unwrap(), optics).unwrap()
        };
        for optics in [Optics::BeerLambert, Optics::Quadratic, Optics::Linear(vec![REST, 1.0])] {
            let (up, down) = (at(460.0 * libm::exp(1e-5), &optics), at(460.0 * libm::exp(-1e-5), &optics));
            for lumen in [0.05, 1.0, REST, 2.5] {
                let numeric = (up.signal(0, lumen) - down.signal(0, lumen)) / 2e-5;
                let gap = (at(460.0, &optics).signal_by_absorbance(0, lumen) - numeric).abs();
                assert!(gap <= TOLERANCE, "{optics:?} at {lumen}: {gap}");
            }
        }
    }

    #[test]
    fn the_tangent_touches_equation_6_at_each_working_point() {
        let (exact, tangent) = (diodes(Optics::BeerLambert), diodes(Optics::Linear(vec![REST, 1.1])));
        for (i, at) in [REST, 1.1].into_iter().enumerate() {
            assert_eq!(tangent.voltage(i, at), exact.voltage(i, at));
            assert_eq!(tangent.slope(i, at), exact.slope(i, at));
        }
    }

    #[test]
    fn a_working_point_has_to_be_open_lumens_of_all_units() {
        let message = |lumens: Vec<f64>| {
            Photodiodes::new(&Parameters::thesis(), &Optics::Linear(lumens)).unwrap_err().to_string()
        };
        assert!(message(vec![1.0]).contains("1 lumens"));
        assert!(message(vec![1.0, 0.0]).contains("C2 is 0"));
        assert!(message(vec![f64::NAN, 1.0]).contains("C1 is NaN"));
    }

    #[test]
    fn all_voltages_are_those_of_each() {
        let diodes = diodes(Optics::BeerLambert);
        let mut out = [f64::NAN; 2];
        diodes.voltages(&[1.9, 0.4, 2.0], &mut out);
        assert_eq!(out, [diodes.voltage(0, 1.9), diodes.voltage(1, 0.4)]);
        assert_eq!(diodes.len(), 2);
        // An emptied capillary lets through everything, an endlessly wide one nothing.
        assert_eq!([0.0, 1e200].map(|lumen| diodes.voltage(0, lumen)), [1.0, 0.0]);
    }
}
