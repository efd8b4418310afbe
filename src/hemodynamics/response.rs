//! What a run gives: the walls and the photodiodes at each of its times.

use lunula_hemodynamics::Parameters;

/// The walls and photodiodes over time, a row a time.
#[derive(Debug, Clone, PartialEq)]
pub struct Response {
    /// The times, s.
    pub times_s: Vec<f64>,
    /// Walls: capillary units and the vein.
    pub walls: usize,
    /// Lumens over nominal diameters, row by row, a value a wall.
    pub lumens: Vec<f64>,
    /// Their rates, 1/s, likewise.
    pub rates: Vec<f64>,
    /// Photodiodes, V, row by row, a value a unit.
    pub volts: Vec<f64>,
}

impl Response {
    /// Rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.times_s.len()
    }

    /// Lumen of wall `j` in a row.
    #[must_use]
    pub fn lumen(&self, row: usize, j: usize) -> f64 {
        self.lumens[row * self.walls + j]
    }

    /// Displacement of wall `j` in a row, m.
    #[must_use]
    pub fn displacement_m(&self, parameters: &Parameters, row: usize, j: usize) -> f64 {
        parameters.wall(j).diameter_m * (self.lumen(row, j) - 1.0)
    }

    /// Velocity of wall `j` in a row, m/s.
    #[must_use]
    pub fn velocity_mps(&self, parameters: &Parameters, row: usize, j: usize) -> f64 {
        parameters.wall(j).diameter_m * self.rates[row * self.walls + j]
    }

    /// Diameter of the vessel of wall `j` over time, micrometres.
    #[must_use]
    pub fn diameters_um(&self, parameters: &Parameters, j: usize) -> Vec<f64> {
        let nominal_um = 1e6 * parameters.wall(j).diameter_m;
        (0..self.rows()).map(|row| nominal_um * self.lumen(row, j)).collect()
    }

    /// Photodiode `i` over time, V.
    #[must_use]
    pub fn photodiode_v(&self, i: usize) -> Vec<f64> {
        self.volts.chunks_exact(self.walls - 1).map(|row| row[i]).collect()
    }
}
