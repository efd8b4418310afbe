//! A parameter's name: the thesis' symbol with its unit, one definition for files, fits and messages.

use std::fmt;
use std::str::FromStr;

/// A lumped vessel of the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Site {
    /// The capillaries of a unit, counted from 0 at the proximal end; written from `C1` on, as in the thesis.
    Capillary(usize),
    /// The vein, `V`.
    Vein,
}

impl Site {
    /// The vessel of wall `j` among those of `units` units and the vein.
    pub fn of_wall(j: usize, units: usize) -> Site {
        if j < units { Site::Capillary(j) } else { Site::Vein }
    }
}

impl fmt::Display for Site {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Site::Capillary(i) => write!(f, "C{}", i + 1),
            Site::Vein => f.write_str("V"),
        }
    }
}

/// A parameter. It is written, and read, with its unit: `k_C1_N_per_m`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Symbol {
    /// `k`, N/m.
    Stiffness(Site),
    /// `m`, kg.
    Mass(Site),
    /// `b`, N s/m.
    Damping(Site),
    /// `A`, m2.
    Area(Site),
    /// `D`, m.
    Diameter(Site),
    /// `L` of a vessel, m.
    Length(Site),
    /// `N`.
    Count(Site),
    /// `R_V1`, `R_V2`, .., Pa s/m3.
    Venule(usize),
    /// Share of `P_F2` on a unit.
    LoadShare(usize),
    /// `L` of the light, m.
    Path(usize),
    /// `V_Tissue`, m3.
    Tissue(usize),
    /// `V_0`, V.
    Offset(usize),
    /// `V_1`, V.
    Scaling(usize),
    /// `mu_Blood`, Pa s.
    Viscosity,
    /// `epsilon`, 1/m.
    Absorption,
    /// `P_H`, Pa.
    Upstream,
    /// `P_L`, Pa.
    Downstream,
}

const OF_VESSELS: [fn(Site) -> Symbol; 7] =
    [Symbol::Stiffness, Symbol::Mass, Symbol::Damping, Symbol::Area, Symbol::Diameter, Symbol::Length, Symbol::Count];
const OF_UNITS: [fn(usize) -> Symbol; 6] =
    [Symbol::Venule, Symbol::LoadShare, Symbol::Path, Symbol::Tissue, Symbol::Offset, Symbol::Scaling];
const OF_BLOOD: [Symbol; 4] = [Symbol::Viscosity, Symbol::Absorption, Symbol::Upstream, Symbol::Downstream];

/// Every symbol of a model of `units` units, in the order of files.
pub(super) fn all(units: usize) -> Vec<Symbol> {
    let sites = || (0..=units).map(|j| Site::of_wall(j, units));
    let vessels = OF_VESSELS.into_iter().flat_map(|symbol| sites().map(symbol));
    let units = OF_UNITS.into_iter().flat_map(|symbol| (0..units).map(symbol));
    vessels.chain(units).chain(OF_BLOOD).collect()
}

impl Symbol {
    /// Why a value can't be used, or `None` where it can.
    pub(super) fn wrong(self, value: f64) -> Option<&'static str> {
        let may_be_zero = matches!(self, Symbol::Damping(_) | Symbol::Venule(_) | Symbol::LoadShare(_));
        match self {
            _ if !value.is_finite() => Some("it has to be a finite number"),
            Symbol::Offset(_) | Symbol::Scaling(_) | Symbol::Upstream | Symbol::Downstream => None,
            _ if may_be_zero && value < 0.0 => Some("it can't be negative"),
            _ if !may_be_zero && value <= 0.0 => Some("it has to be greater than 0"),
            _ => None,
        }
    }
}

impl fmt::Display for Symbol {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Symbol::Stiffness(site) => write!(f, "k_{site}_N_per_m"),
            Symbol::Mass(site) => write!(f, "m_{site}_kg"),
            Symbol::Damping(site) => write!(f, "b_{site}_N_s_per_m"),
            Symbol::Area(site) => write!(f, "A_{site}_m2"),
            Symbol::Diameter(site) => write!(f, "D_{site}_m"),
            Symbol::Length(site) => write!(f, "L_{site}_m"),
            Symbol::Count(site) => write!(f, "N_{site}"),
            Symbol::Venule(i) => write!(f, "R_V{}_Pa_s_per_m3", i + 1),
            Symbol::LoadShare(i) => write!(f, "share_{}", i + 1),
            Symbol::Path(i) => write!(f, "L_{}_m", i + 1),
            Symbol::Tissue(i) => write!(f, "V_Tissue{}_m3", i + 1),
            Symbol::Offset(i) => write!(f, "V0_{}_V", i + 1),
            Symbol::Scaling(i) => write!(f, "V1_{}_V", i + 1),
            Symbol::Viscosity => f.write_str("mu_Blood_Pa_s"),
            Symbol::Absorption => f.write_str("epsilon_per_m"),
            Symbol::Upstream => f.write_str("P_H_Pa"),
            Symbol::Downstream => f.write_str("P_L_Pa"),
        }
    }
}

impl serde::Serialize for Symbol {
    fn serialize<S: serde::Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.collect_str(self)
    }
}

impl FromStr for Symbol {
    type Err = String;

    /// From its name as it is written. The error lists how names look.
    fn from_str(name: &str) -> Result<Symbol, String> {
        // A name holds its unit's number, among others: those of the units that it may be of.
        let numbers = name.split(|c: char| !c.is_ascii_digit()).filter_map(|digits| digits.parse::<usize>().ok());
        let units = numbers.filter_map(|n| n.checked_sub(1));
        let of_units = units.flat_map(|i| {
            OF_VESSELS.map(|symbol| symbol(Site::Capillary(i))).into_iter().chain(OF_UNITS.map(|symbol| symbol(i)))
        });
        let others = OF_VESSELS.map(|symbol| symbol(Site::Vein)).into_iter().chain(OF_BLOOD);
        of_units.chain(others).find(|symbol| symbol.to_string() == name).ok_or_else(|| {
            format!(
                "there is no parameter {name}; their names hold the unit, as in k_C1_N_per_m, b_V_N_s_per_m, \
                 R_V1_Pa_s_per_m3, V0_1_V, V1_1_V"
            )
        })
    }
}
