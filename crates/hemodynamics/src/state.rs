//! The state of the walls: lumens and their rates, scaled by the nominal diameters.

use crate::parameters::{Parameters, Site};

/// The state `x` of equation 2, scaled: for every wall, capillaries first and the vein last, the lumen
/// `d / D = 1 + x / D` and its rate `v / D` in 1/s.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Lumens over nominal diameters; open where greater than 0.
    pub lumens: Vec<f64>,
    /// Rates of the lumens, 1/s.
    pub rates: Vec<f64>,
}

/// Why a state can't be used.
#[derive(Debug, thiserror::Error, Clone, PartialEq)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum StateFault {
    #[error("the state has {got} values for {walls} walls; it needs a displacement and a velocity for each")]
    Length { walls: usize, got: usize },
    #[error("the state of {site} is {value}; it has to be a finite number")]
    NotFinite { site: Site, value: f64 },
    #[error(
        "{site} is closed in this state (its lumen is {lumen} times its nominal diameter); the model knows open \
         vessels only"
    )]
    Closed { site: Site, lumen: f64 },
    #[error("{site} is {lumen:.3e} times its nominal diameter wide in this state; displacements are in metres")]
    Wide { site: Site, lumen: f64 },
}

/// No vessel is so many times as wide as its nominal diameter (assumed).
const WIDE: f64 = 100.0;

impl State {
    /// The state in which no wall is displaced (`x = 0`) and none moves. It is not the state at rest: pressed by the
    /// blood alone, the walls are further out.
    pub fn undisplaced(parameters: &Parameters) -> State {
        let walls = parameters.walls().len();
        State { lumens: vec![1.0; walls], rates: vec![0.0; walls] }
    }

    /// From displacements (m) and velocities (m/s) of the walls. An error where a number is missing, not finite, or
    /// closes a vessel, or opens it as no vessel is.
    pub fn from_metres(
        parameters: &Parameters,
        displacements_m: &[f64],
        velocities_mps: &[f64],
    ) -> Result<State, StateFault> {
        let walls = parameters.walls().len();
        for values in [displacements_m, velocities_mps] {
            if values.len() != walls {
                return Err(StateFault::Length { walls, got: values.len() });
            }
        }
        let scaled = |values: &[f64]| -> Vec<f64> {
            values.iter().zip(parameters.walls()).map(|(value, wall)| value / wall.diameter_m).collect()
        };
        let state = State {
            lumens: scaled(displacements_m).into_iter().map(|x| 1.0 + x).collect(),
            rates: scaled(velocities_mps),
        };
        state.check()?;
        match (0..walls).find(|&j| state.lumens[j] > WIDE) {
            Some(j) => Err(StateFault::Wide { site: Site::of_wall(j, walls - 1), lumen: state.lumens[j] }),
            None => Ok(state),
        }
    }

    /// Whether all values are finite and all vessels open. An error names the first that is not.
    pub fn check(&self) -> Result<(), StateFault> {
        let units = self.lumens.len().saturating_sub(1);
        if self.rates.len() != self.lumens.len() {
            return Err(StateFault::Length { walls: self.lumens.len(), got: self.rates.len() });
        }
        for (j, (&lumen, &rate)) in self.lumens.iter().zip(&self.rates).enumerate() {
            let site = Site::of_wall(j, units);
            if let Some(&value) = [lumen, rate].iter().find(|value| !value.is_finite()) {
                return Err(StateFault::NotFinite { site, value });
            }
            if lumen <= 0.0 {
                return Err(StateFault::Closed { site, lumen });
            }
        }
        Ok(())
    }

    pub(crate) fn check_walls(&self, walls: usize) -> Result<(), StateFault> {
        self.check()?;
        match self.lumens.len() {
            got if got != walls => Err(StateFault::Length { walls, got }),
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn metres_become_lumens() {
        let parameters = Parameters::thesis();
        let velocities_mps = [1e-6, 0.0, -2e-3];
        let state = State::from_metres(&parameters, &[9e-6, -5e-6, 1e-4], &velocities_mps).unwrap();
        assert_eq!(state.lumens, [1.9, 0.5, 2.0]);
        for (j, v) in velocities_mps.into_iter().enumerate() {
            assert!((parameters.wall(j).diameter_m * state.rates[j] - v).abs() <= 1e-16 * v.abs());
        }
    }

    #[test]
    fn closed_missing_and_endless_walls_are_named() {
        let fault_of = |x: &[f64], v: &[f64]| State::from_metres(&Parameters::thesis(), x, v).unwrap_err();
        assert_eq!(fault_of(&[0.0; 2], &[0.0; 3]), StateFault::Length { walls: 3, got: 2 });
        assert_eq!(fault_of(&[0.0; 3], &[0.0; 4]), StateFault::Length { walls: 3, got: 4 });
        // An empty capillary is closed, and so is one that is turned inside out.
        assert_eq!(
            fault_of(&[0.0, -1e-5, 0.0], &[0.0; 3]),
            StateFault::Closed { site: Site::Capillary(1), lumen: 0.0 }
        );
        assert_eq!(fault_of(&[0.0, 0.0, -2e-4], &[0.0; 3]), StateFault::Closed { site: Site::Vein, lumen: -1.0 });
        // Micrometres.
        assert!(matches!(fault_of(&[9.0, 5.0, 1e2], &[0.0; 3]), StateFault::Wide { site: Site::Capillary(0), .. }));
        assert!(matches!(
            fault_of(&[f64::NAN, 0.0, 0.0], &[0.0; 3]),
            StateFault::NotFinite { site: Site::Capillary(0), .. }
        ));
        assert!(matches!(
            fault_of(&[0.0; 3], &[0.0, 0.0, f64::INFINITY]),
            StateFault::NotFinite { site: Site::Vein, .. }
        ));
        // Too many diameters for a double.
        assert!(matches!(fault_of(&[1e305, 0.0, 0.0], &[0.0; 3]), StateFault::NotFinite { .. }));
        assert_eq!(State { lumens: vec![1.0; 3], rates: vec![] }.check(), Err(StateFault::Length { walls: 3, got: 0 }));
        assert_eq!(State::undisplaced(&Parameters::along_nail(5).unwrap()).check(), Ok(()));
    }
}
