//! Random parameters and states, the same in every run.

use lunula_hemodynamics::{Inputs, Parameters, Symbol};

/// Steele's splitmix64 (doi:10.1145/2714064.2660195).
pub(crate) struct Draw(pub(crate) u64);

impl Draw {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.next() >> 11) as f64 / (1u64 << 53) as f64)
    }

    /// Uniform in the logarithm.
    pub(crate) fn decades(&mut self, low: f64, high: f64) -> f64 {
        10f64.powf(self.between(low.log10(), high.log10()))
    }

    fn sign(&mut self) -> f64 {
        if self.next() & 1 == 0 { 1.0 } else { -1.0 }
    }

    /// Units of the thesis' table, every parameter within a decade either way, shares of the load anything.
    pub(crate) fn parameters(&mut self, units: usize) -> Parameters {
        let mut parameters = Parameters::along_nail(units).expect("at least one unit");
        for symbol in parameters.symbols() {
            let value = match symbol {
                Symbol::LoadShare(_) => self.between(0.0, 1.0),
                Symbol::Downstream => self.between(0.0, 3e3),
                _ => parameters.get(symbol).expect("its own symbol") * self.decades(0.1, 10.0),
            };
            parameters = parameters.set(symbol, value).expect("still a parameter");
        }
        parameters
    }

    /// Lumens over nominal diameters from 1e-8 to 3, each on its own.
    pub(crate) fn lumens(&mut self, walls: usize) -> Vec<f64> {
        (0..walls).map(|_| self.decades(1e-8, 3.0)).collect()
    }

    /// Rates from 1e-3 to 1e5 1/s of either sign.
    pub(crate) fn rates(&mut self, walls: usize) -> Vec<f64> {
        (0..walls).map(|_| self.sign() * self.decades(1e-3, 1e5)).collect()
    }

    pub(crate) fn inputs(&mut self, parameters: &Parameters) -> Inputs {
        Inputs {
            upstream_pa: parameters.upstream_pa(),
            downstream_pa: parameters.downstream_pa(),
            proximal_pa: self.between(-1e3, 2e4),
            distal_pa: self.between(-1e3, 2e4),
        }
    }
}
