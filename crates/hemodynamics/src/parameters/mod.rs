//! The model's parameters, checked: nothing that is negative, missing or no number goes further than here.
//!
//! In: the thesis' table ([`Parameters::thesis`], section 4.3.2), the same nail cut into `n` units
//! ([`Parameters::along_nail`]), a TOML file ([`Parameters::from_toml`]) or values set one by one
//! ([`Parameters::set`]). Out: [`Parameters`]; all faults are reported at once. Units are SI; each [`Symbol`] says
//! its own in the name that it has in files (`k_C1_N_per_m`).

mod file;
mod symbol;

use std::f64::consts::PI;

pub use symbol::{Site, Symbol};

/// A lumped vessel: the wall (mass, spring, damper over an area) and the lumen of equation 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vessel {
    /// Stiffness of the wall `k`, N/m.
    pub stiffness_n_per_m: f64,
    /// Inertia of wall and blood `m`, kg.
    pub mass_kg: f64,
    /// Damping of the wall `b`, N s/m; may be 0.
    pub damping_n_s_per_m: f64,
    /// Surface area `A`, m2.
    pub area_m2: f64,
    /// Nominal diameter `D`, m.
    pub diameter_m: f64,
    /// Length `L`, m.
    pub length_m: f64,
    /// Number of such vessels in parallel `N`.
    pub count: f64,
}

/// A capillary unit: a zone of the nail bed, what of the distal load reaches it, and the photodiode above it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// Its capillaries.
    pub capillary: Vessel,
    /// Resistance of the venules behind it `R_V1`, `R_V2`, Pa s/m3; may be 0.
    pub venule_pa_s_per_m3: f64,
    /// The share of the distal pressure `P_F2` that presses on it: 0 under the bone, 1 at the tip.
    pub load_share: f64,
    /// Path length of the light `L` (equation 7), m.
    pub path_m: f64,
    /// Volume of the tissue that the light passes `V_Tissue`, m3.
    pub tissue_m3: f64,
    /// Bias of the photodiode `V_0` (equation 6), V.
    pub offset_v: f64,
    /// Scaling of the photodiode `V_1` (equation 6), V.
    pub scaling_v: f64,
}

/// All parameters of the model.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameters {
    units: Vec<Unit>,
    vein: Vessel,
    viscosity_pa_s: f64,
    absorption_per_m: f64,
    upstream_pa: f64,
    downstream_pa: f64,
}

/// What is wrong with parameters; every fault in a line of its own.
#[derive(Debug, thiserror::Error, Clone, PartialEq, Eq)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum ParameterFault {
    #[error("the parameters can't be used:\n{}", .0.join("\n"))]
    Values(Vec<String>),
    #[error("the parameters are no TOML: {0}")]
    Syntax(String),
}

const MOST_UNITS: usize = 1000;

/// The vessels of the thesis' table, literal powers of ten.
const CAPILLARY: Vessel = Vessel {
    stiffness_n_per_m: 1e5,
    mass_kg: 1e-3,
    damping_n_s_per_m: 1e4,
    area_m2: 1e-4,
    diameter_m: 1e-5,
    length_m: 1e-3,
    count: 1e5,
};
const VEIN: Vessel = Vessel {
    stiffness_n_per_m: 1e3,
    mass_kg: 1e-3,
    damping_n_s_per_m: 1e2,
    area_m2: 1e-4,
    diameter_m: 1e-4,
    length_m: 1e-2,
    count: 1e2,
};

impl Parameters {
    /// The thesis' table (section 4.3.2): two units, the proximal one shielded from the distal pressure and the distal
    /// one under all of it. Photodiodes have the offset 0 V and the scaling 1 V.
    pub fn thesis() -> Parameters {
        Parameters::along_nail(2).expect("two units are more than none")
    }

    /// The nail bed of the thesis' table cut into `n` equal units from proximal to distal: what is extensive
    /// (capillaries, area, stiffness, damping, mass, tissue, venules) is shared out, and a unit's share of the distal
    /// pressure is the part of it that lies in the distal half, beyond the bone. `n = 2` is [`Parameters::thesis`]. An
    /// error where `n` is not 1 to 1000.
    pub fn along_nail(n: usize) -> Result<Parameters, ParameterFault> {
        if let Some(wrong) = wrong_units(n) {
            return Err(ParameterFault::Values(vec![wrong]));
        }
        let part = 2.0 / n as f64;
        let units = (0..n)
            .map(|i| {
                let distal_half = (2.0 * (i + 1) as f64 - n as f64).clamp(0.0, 2.0) / 2.0;
                Unit {
                    capillary: Vessel {
                        stiffness_n_per_m: CAPILLARY.stiffness_n_per_m * part,
                        mass_kg: CAPILLARY.mass_kg * part,
                        damping_n_s_per_m: CAPILLARY.damping_n_s_per_m * part,
                        area_m2: CAPILLARY.area_m2 * part,
                        count: CAPILLARY.count * part,
                        ..CAPILLARY
                    },
                    venule_pa_s_per_m3: 1e11 / part,
                    load_share: distal_half,
                    path_m: 1e-3,
                    tissue_m3: 1e-7 * part,
                    offset_v: 0.0,
                    scaling_v: 1.0,
                }
            })
            .collect();
        Parameters::new(units, VEIN, 3e-3, 460.0, [1e4, 0.0])
    }

    /// From all of its parts: the units from proximal to distal, the vein, the blood's viscosity (Pa s) and absorption
    /// (1/m), and the blood pressures `[P_H, P_L]` (Pa, gage). An error names every value that is not finite, not
    /// positive where it has to be, or missing, and what of the equations comes out as no positive number from values
    /// too far apart.
    pub fn new(
        units: Vec<Unit>,
        vein: Vessel,
        viscosity_pa_s: f64,
        absorption_per_m: f64,
        [upstream_pa, downstream_pa]: [f64; 2],
    ) -> Result<Parameters, ParameterFault> {
        let parameters = Parameters { units, vein, viscosity_pa_s, absorption_per_m, upstream_pa, downstream_pa };
        parameters.check()?;
        Ok(parameters)
    }

    /// The capillary units from proximal to distal; at least one.
    pub fn units(&self) -> &[Unit] {
        &self.units
    }

    /// The vein.
    pub fn vein(&self) -> &Vessel {
        &self.vein
    }

    /// Viscosity of the blood, Pa s.
    pub fn viscosity_pa_s(&self) -> f64 {
        self.viscosity_pa_s
    }

    /// Absorption coefficient of the blood `epsilon`, 1/m.
    pub fn absorption_per_m(&self) -> f64 {
        self.absorption_per_m
    }

    /// Upstream blood pressure `P_H`, Pa (gage), where the loads give none.
    pub fn upstream_pa(&self) -> f64 {
        self.upstream_pa
    }

    /// Downstream blood pressure `P_L`, Pa (gage), where the loads give none.
    pub fn downstream_pa(&self) -> f64 {
        self.downstream_pa
    }

    /// The walls: the capillaries from proximal to distal, the vein last.
    pub fn walls(&self) -> impl ExactSizeIterator<Item = &Vessel> + '_ {
        (0..self.units.len() + 1).map(|j| self.wall(j))
    }

    /// The vessel of wall `j`, `j` from 0 to the number of units (the vein).
    pub fn wall(&self, j: usize) -> &Vessel {
        self.units.get(j).map_or(&self.vein, |unit| &unit.capillary)
    }

    /// The compound `alpha` of equation 7 of unit `i`, 1/m2.
    pub fn alpha_per_m2(&self, i: usize) -> f64 {
        let unit = &self.units[i];
        let vessels = unit.capillary.count * unit.capillary.length_m;
        PI * self.absorption_per_m * unit.path_m * vessels / (4.0 * unit.tissue_m3)
    }

    /// Every parameter's symbol, in the order of the files.
    pub fn symbols(&self) -> Vec<Symbol> {
        symbol::all(self.units.len())
    }

    /// The value of a parameter in the unit of its name; `None` where there is no such unit.
    pub fn get(&self, symbol: Symbol) -> Option<f64> {
        let mut copy = self.clone();
        copy.place(symbol).map(|value| *value)
    }

    /// The same parameters with one changed. An error where there is no such unit or where the value can't be used.
    pub fn set(&self, symbol: Symbol, value: f64) -> Result<Parameters, ParameterFault> {
        let mut changed = self.clone();
        let Some(place) = changed.place(symbol) else {
            let n = self.units.len();
            return Err(ParameterFault::Values(vec![format!("  {symbol}: there are {n} units only")]));
        };
        *place = value;
        changed.check()?;
        Ok(changed)
    }

    fn place(&mut self, symbol: Symbol) -> Option<&mut f64> {
        Some(match symbol {
            Symbol::Stiffness(site) => &mut self.vessel(site)?.stiffness_n_per_m,
            Symbol::Mass(site) => &mut self.vessel(site)?.mass_kg,
            Symbol::Damping(site) => &mut self.vessel(site)?.damping_n_s_per_m,
            Symbol::Area(site) => &mut self.vessel(site)?.area_m2,
            Symbol::Diameter(site) => &mut self.vessel(site)?.diameter_m,
            Symbol::Length(site) => &mut self.vessel(site)?.length_m,
            Symbol::Count(site) => &mut self.vessel(site)?.count,
            Symbol::Venule(i) => &mut self.units.get_mut(i)?.venule_pa_s_per_m3,
            Symbol::LoadShare(i) => &mut self.units.get_mut(i)?.load_share,
            Symbol::Path(i) => &mut self.units.get_mut(i)?.path_m,
            Symbol::Tissue(i) => &mut self.units.get_mut(i)?.tissue_m3,
            Symbol::Offset(i) => &mut self.units.get_mut(i)?.offset_v,
            Symbol::Scaling(i) => &mut self.units.get_mut(i)?.scaling_v,
            Symbol::Viscosity => &mut self.viscosity_pa_s,
            Symbol::Absorption => &mut self.absorption_per_m,
            Symbol::Upstream => &mut self.upstream_pa,
            Symbol::Downstream => &mut self.downstream_pa,
        })
    }

    fn vessel(&mut self, site: Site) -> Option<&mut Vessel> {
        match site {
            Site::Capillary(i) => self.units.get_mut(i).map(|unit| &mut unit.capillary),
            Site::Vein => Some(&mut self.vein),
        }
    }

    /// Every fault at once.
    fn check(&self) -> Result<(), ParameterFault> {
        let mut faults = Vec::from_iter(wrong_units(self.units.len()));
        let mut copy = self.clone();
        for symbol in self.symbols() {
            let value = *copy.place(symbol).expect("a symbol of these units");
            if let Some(wrong) = symbol.wrong(value) {
                faults.push(format!("  {symbol} = {value}: {wrong}"));
            }
        }
        if faults.is_empty() {
            self.check_products(&mut faults);
        }
        if faults.is_empty() { Ok(()) } else { Err(ParameterFault::Values(faults)) }
    }

    /// Whether the equations' coefficients are numbers that can be computed with.
    fn check_products(&self, faults: &mut Vec<String>) {
        let mut far = |what: String| faults.push(format!("  {what}: these values are too far apart to compute with"));
        for (j, wall) in self.walls().enumerate() {
            let site = Site::of_wall(j, self.units.len());
            let d = wall.diameter_m;
            let products = [
                ("A / (m D)", wall.area_m2 / (wall.mass_kg * d)),
                ("k / m", wall.stiffness_n_per_m / wall.mass_kg),
                ("A D", wall.area_m2 * d),
                (
                    "N pi D^4 / (128 L mu)",
                    wall.count * PI * (d * d) * (d * d) / (128.0 * wall.length_m * self.viscosity_pa_s),
                ),
            ];
            for (product, value) in products {
                if !(value.is_normal() && value > 0.0) {
                    far(format!("{site}: {product} = {value:e}"));
                }
            }
            if !(wall.damping_n_s_per_m / wall.mass_kg).is_finite() {
                far(format!("{site}: b / m is infinite"));
            }
        }
        for i in 0..self.units.len() {
            let alpha = self.alpha_per_m2(i);
            if !(alpha.is_normal() && alpha > 0.0) {
                far(format!("unit {}: alpha = {alpha:e}", i + 1));
            }
        }
    }
}

/// Why there can't be so many units, or `None` where there can.
fn wrong_units(n: usize) -> Option<String> {
    let wrong = !(1..=MOST_UNITS).contains(&n);
    wrong.then(|| format!("  units = {n}: it has to be a number from 1 to {MOST_UNITS}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_are_1_to_1000_units() {
        for n in [0, 1001, usize::MAX] {
            let message = Parameters::along_nail(n).unwrap_err().to_string();
            assert!(message.contains("from 1 to 1000"), "{message}");
        }
        assert_eq!(Parameters::along_nail(1000).unwrap().units().len(), 1000);
        let none = Parameters::new(vec![], VEIN, 3e-3, 460.0, [1e4, 0.0]).unwrap_err().to_string();
        assert!(none.contains("units = 0"), "{none}");
    }

    #[test]
    fn along_the_nail_what_is_extensive_is_shared_out() {
        for n in [1, 2, 3, 7, 1000] {
            let parameters = Parameters::along_nail(n).unwrap();
            let sum = |of: fn(&Unit) -> f64| parameters.units().iter().map(of).sum::<f64>();
            // Roundings of n terms; measured 2e-14 of the sum.
            let near = |sum: f64, whole: f64| assert!((sum / whole - 1.0).abs() <= 1e-12, "{n}: {sum} of {whole}");
            near(sum(|unit| unit.capillary.stiffness_n_per_m), 2e5);
            near(sum(|unit| unit.capillary.count), 2e5);
            near(sum(|unit| unit.tissue_m3), 2e-7);
            near(sum(|unit| 1.0 / unit.venule_pa_s_per_m3), 2e-11);
            near(sum(|unit| unit.load_share), n as f64 / 2.0);
        }
    }

    #[test]
    fn values_too_far_apart_are_refused_with_what_they_make() {
        for (name, value, part) in [
            ("D_V_m", 1e-90, "V: N pi D^4 / (128 L mu) = 0e0"),
            ("D_C1_m", 1e90, "C1: N pi D^4 / (128 L mu) = inf"),
            ("m_C2_kg", 1e-308, "C2: k / m = inf"),
            ("epsilon_per_m", 1e308, "unit 1: alpha = inf"),
        ] {
            let message = Parameters::thesis().set(name.parse().unwrap(), value).unwrap_err().to_string();
            assert!(message.contains(part), "{message}");
        }
    }

    #[test]
    fn the_issues_extremes_are_parameters() {
        for (name, factor) in [("k_C1_N_per_m", 1e-1), ("k_V_N_per_m", 1e3), ("m_V_kg", 1e-9), ("m_C1_kg", 1e3)] {
            let symbol = name.parse().unwrap();
            let value = Parameters::thesis().get(symbol).unwrap() * factor;
            assert_eq!(Parameters::thesis().set(symbol, value).unwrap().get(symbol), Some(value));
        }
        assert!(Parameters::thesis().set("b_V_N_s_per_m".parse().unwrap(), 0.0).is_ok());
        let missing = Parameters::thesis().set(Symbol::Venule(2), 1.0).unwrap_err().to_string();
        assert!(missing.contains("R_V3_Pa_s_per_m3: there are 2 units"), "{missing}");
        assert_eq!(Parameters::thesis().get(Symbol::Mass(Site::Capillary(2))), None);
    }
}
