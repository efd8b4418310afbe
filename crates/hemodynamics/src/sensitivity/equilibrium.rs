//! An equilibrium reached from given lumens, and how it moves with the parameters.
//!
//! In: lumens and inputs. Out: the lumens at which no wall accelerates, reached as walls without inertia would come to
//! rest from there (`0 = F(l, 0) + F_w w`, `w = l'`: implicit Euler steps that grow into Newton's), so that of several
//! equilibria it is the one on whose side the walls start. The derivative along a direction `p` is that of the implicit
//! function: `F_l s = -F_p`.

use super::lu::Lu;
use crate::load::Inputs;
use crate::model::{Arrow, Currents, Model, Tangent};
use crate::parameters::Site;

/// Steps until a search is given up.
const STEPS: usize = 400;
/// Change of any lumen at which Newton's steps have converged, relative.
const CONVERGED: f64 = 1e-14;
/// Change below which steps that don't get shorter are rounding, relative.
const ROUNDING: f64 = 1e-10;
/// Largest change of a lumen in a step, relative.
const LARGEST: f64 = 0.25;
/// The first time step, s: a tenth of what walls need to move.
const FIRST_S: f64 = 0.01;
/// Time beyond which a step is Newton's.
const ENDLESS_S: f64 = 1e9;
/// Time step below which a vessel is closing, s.
const CLOSING_S: f64 = 1e-12;

/// No equilibrium is reached: a vessel closes, or the search ends without one.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("there is no equilibrium with open vessels to be reached under these loads: {site} closes")]
pub(crate) struct NoRest {
    /// The vessel that is closest to being closed.
    pub(crate) site: Site,
}

/// The search's memory.
#[derive(Clone, Debug, Default)]
pub(crate) struct Rest {
    lu: Lu,
    arrow: Arrow,
    still: Vec<f64>,
    step: Vec<f64>,
    trial: Vec<f64>,
}

impl Rest {
    /// Moves `lumens` to the equilibrium that is reached from them.
    pub(crate) fn settle(&mut self, model: &Model, inputs: &Inputs, lumens: &mut [f64]) -> Result<(), NoRest> {
        let walls = model.walls();
        self.still.resize(walls, 0.0);
        self.step.resize(walls, 0.0);
        self.trial.resize(walls, 0.0);
        let mut time = FIRST_S;
        let mut last = f64::INFINITY;
        for _ in 0..STEPS {
            model.accelerations(lumens, &self.still, inputs, &mut self.step);
            model.jacobian(lumens, &self.still, inputs, &mut self.arrow);
            let newton = time >= ENDLESS_S;
            let sound = self.factorize(walls, if newton { 0.0 } else { 1.0 / time });
            if sound {
                self.lu.solve(&mut self.step);
            }
            let change = self.step.iter().zip(&*lumens).fold(0.0, |most: f64, (step, l)| most.max((step / l).abs()));
            if !sound || change > LARGEST {
                time = if newton { 1.0 } else { 0.2 * time };
                if time < CLOSING_S {
                    break;
                }
                continue;
            }
            for (l, step) in lumens.iter_mut().zip(&self.step) {
                *l += step;
            }
            // Newton's steps get short until rounding is all that is left of them.
            if newton && (change <= CONVERGED || (change <= ROUNDING && change >= 0.5 * last)) {
                return Ok(());
            }
            last = if newton { change } else { f64::INFINITY };
            if !newton {
                time *= if change < 0.02 { 100.0 } else { 3.0 };
            }
        }
        let nearest = (0..walls).min_by(|&i, &j| lumens[i].total_cmp(&lumens[j])).unwrap_or(0);
        Err(NoRest { site: Site::of_wall(nearest, walls - 1) })
    }

    /// The derivatives of an equilibrium's lumens along directions, written to `out`, the walls of each direction in
    /// turn. False where the equilibrium is at a fold, where it has none.
    pub(crate) fn derivatives(
        &mut self,
        model: &Model,
        inputs: &Inputs,
        lumens: &[f64],
        tangents: &[Tangent],
        out: &mut [f64],
    ) -> bool {
        let walls = model.walls();
        self.still.resize(walls, 0.0);
        model.jacobian(lumens, &self.still, inputs, &mut self.arrow);
        if !self.factorize(walls, 0.0) {
            return false;
        }
        let mut currents = Currents::default();
        model.currents(lumens, &self.still, inputs, &mut currents);
        for (tangent, out) in tangents.iter().zip(out.chunks_exact_mut(walls)) {
            model.along(lumens, &self.still, inputs, &currents, tangent, out);
            self.lu.solve(out);
        }
        true
    }

    /// `-F_l - F_w / time`.
    fn factorize(&mut self, walls: usize, per_time: f64) -> bool {
        let a = &self.arrow;
        let matrix = self.lu.clear(walls);
        for i in 0..walls {
            for j in 0..walls {
                let border = a.pressure_by_lumen[j] + per_time * a.pressure_by_rate[j];
                matrix[i * walls + j] = -a.by_pressure[i] * border;
            }
            matrix[i * walls + i] -= a.by_lumen[i] + per_time * a.by_rate[i];
        }
        self.lu.factorize()
    }
}
