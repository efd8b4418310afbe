//! A curve of equilibria over the load, followed step by step around its folds (pseudo-arclength continuation, Keller
//! 1977).
//!
//! The load is one more unknown. All units but the one nearest to a turning point of its `p` are eliminated, which
//! leaves two equations for three unknowns: the vein's lumen, that unit's lumen, the load. Their tangent is a cross
//! product, and so is a corrector's step across it. Loads are measured in `scale_pa`, lumens in nominal diameters.

use super::LoadPath;
use crate::equilibrium::network::Network;
use crate::load::Inputs;
use crate::model::Model;

/// A state with its load.
#[derive(Clone, Debug)]
pub(super) struct Place {
    pub(super) vein: f64,
    pub(super) units: Vec<f64>,
    pub(super) load: f64,
}

/// Direction of the curve: of all lumens and the load, of length 1.
#[derive(Clone, Debug)]
pub(super) struct Tangent {
    vein: f64,
    units: Vec<f64>,
    pub(super) load: f64,
}

/// The equations over a load.
pub(super) struct Follower<'a> {
    model: &'a Model,
    inputs: Inputs,
    path: LoadPath,
    pub(super) scale_pa: f64,
}

/// The equations linearized at a place, the units but one eliminated: `rows` times the steps of (vein, pivot, load) is
/// `-values`.
struct Reduced {
    pivot: usize,
    rows: [[f64; 3]; 2],
    values: [f64; 2],
}

/// Corrector steps before giving up.
const MOST_STEPS: usize = 8;
/// A corrector has settled where its step is below this.
const SETTLED: f64 = 1e-13;

impl<'a> Follower<'a> {
    pub(super) fn new(model: &'a Model, inputs: Inputs, path: LoadPath, scale_pa: f64) -> Self {
        Follower { model, inputs, path, scale_pa }
    }

    pub(super) fn inputs(&self, load: f64) -> Inputs {
        self.path.inputs(&self.inputs, load * self.scale_pa)
    }

    pub(super) fn network(&self, load: f64) -> Network {
        Network::new(self.model, &self.inputs(load))
    }

    /// What a unit of the load adds to a unit's external pressure, and to the vein's, Pa.
    fn pressed(&self, i: usize) -> f64 {
        self.path.of(self.scale_pa)[1] * self.model.units[i].share
    }

    fn reduced(&self, at: &Place) -> Reduced {
        let network = self.network(at.load);
        let vein = &network.vein;
        let (venous, slope) = (vein.pressure(at.vein), vein.pressure_slope(at.vein));
        let by_load = self.path.of(self.scale_pa)[0];
        let rows: Vec<_> =
            network.units.iter().zip(&at.units).map(|(unit, &lumen)| unit.row(lumen, venous, slope)).collect();
        let near = |i: usize| (rows[i].alpha / network.units[i].pressure_slope(at.units[i])).abs();
        let pivot = (0..rows.len()).min_by(|&a, &b| near(a).total_cmp(&near(b))).expect("at least one unit");
        let square = at.vein * at.vein;
        let outflow = vein.conductance * (square * square);
        let fall = vein.source - venous;
        let total: f64 = outflow + rows.iter().map(|row| row.conductance).sum::<f64>();
        let by_vein = 4.0 * vein.conductance * (square * at.vein) * fall - total * slope;
        let mut balance = [by_vein, rows[pivot].gamma, -total * by_load];
        let mut value = outflow * fall;
        for (i, row) in rows.iter().enumerate() {
            value += row.conductance * (network.units[i].source - venous);
            if i != pivot {
                let ratio = row.gamma / row.alpha;
                balance[0] += ratio * row.beta;
                balance[2] -= ratio * (self.pressed(i) - row.beta / slope * by_load);
                value -= ratio * row.residual;
            }
        }
        let row = &rows[pivot];
        let wall = [-row.beta, row.alpha, self.pressed(pivot) - row.beta / slope * by_load];
        let mut reduced = Reduced { pivot, rows: [wall, balance], values: [row.residual, value] };
        for (row, value) in reduced.rows.iter_mut().zip(&mut reduced.values) {
            let size = row.iter().fold(0.0_f64, |size, entry| size.max(entry.abs()));
            row.iter_mut().for_each(|entry| *entry /= size);
            *value /= size;
        }
        reduced
    }

    /// All lumens' steps from those of the vein and the load; the pivot's is known. With `residuals` the equations are
    /// made to hold.
    fn spread(&self, at: &Place, reduced: &Reduced, [vein, pivot, load]: [f64; 3], residuals: f64) -> Vec<f64> {
        let network = self.network(at.load);
        let (venous, slope) = (network.vein.pressure(at.vein), network.vein.pressure_slope(at.vein));
        let by_load = self.path.of(self.scale_pa)[0];
        let step = |(i, (unit, &lumen)): (usize, (&crate::equilibrium::network::Vessel, &f64))| {
            if i == reduced.pivot {
                return pivot;
            }
            let row = unit.row(lumen, venous, slope);
            let pressed = self.pressed(i) - row.beta / slope * by_load;
            (row.beta * vein - pressed * load - residuals * row.residual) / row.alpha
        };
        network.units.iter().zip(&at.units).enumerate().map(step).collect()
    }

    /// The direction of the curve at a place, the one of the two that goes along with `before`.
    pub(super) fn tangent(&self, at: &Place, before: Option<&Tangent>) -> Tangent {
        let reduced = self.reduced(at);
        let along = cross(reduced.rows[0], reduced.rows[1]);
        let units = self.spread(at, &reduced, along, 0.0);
        let mut tangent = Tangent { vein: along[0], units, load: along[2] };
        let length = tangent.dot(&tangent).sqrt();
        let turned = before.is_some_and(|before| before.dot(&tangent) < 0.0);
        tangent.scale(if turned { -1.0 / length } else { 1.0 / length });
        tangent
    }

    /// The place on the curve across the tangent from a guess; `None` where the corrector does not settle.
    pub(super) fn correct(&self, mut at: Place, tangent: &Tangent) -> Option<Place> {
        let mut last = f64::INFINITY;
        for _ in 0..MOST_STEPS {
            let reduced = self.reduced(&at);
            let along = [tangent.vein, tangent.units[reduced.pivot], tangent.load];
            let [a, b] = reduced.rows;
            let (ab, bc, ca) = (cross(a, b), cross(b, along), cross(along, a));
            let determinant = dot(ab, along);
            let steps = [0, 1, 2].map(|k| -(reduced.values[0] * bc[k] + reduced.values[1] * ca[k]) / determinant);
            let units = self.spread(&at, &reduced, steps, 1.0);
            let size = units.iter().chain(&steps).fold(0.0_f64, |size, step| size.max(step.abs()));
            if !size.is_finite() || (size > 0.5 * last && last > 1e-9) {
                return None;
            }
            at.vein += steps[0];
            at.load += steps[2];
            at.units.iter_mut().zip(&units).for_each(|(lumen, step)| *lumen += step);
            if size <= SETTLED || (size >= 0.5 * last && last <= 1e-9) {
                return Some(at);
            }
            last = size;
        }
        None
    }
}

impl Place {
    /// The place this far along a tangent.
    pub(super) fn ahead(&self, tangent: &Tangent, by: f64) -> Place {
        Place {
            vein: self.vein + by * tangent.vein,
            units: self.units.iter().zip(&tangent.units).map(|(at, along)| at + by * along).collect(),
            load: self.load + by * tangent.load,
        }
    }

    pub(super) fn between(&self, other: &Place, part: f64) -> Place {
        let mix = |a: f64, b: f64| a + part * (b - a);
        Place {
            vein: mix(self.vein, other.vein),
            units: self.units.iter().zip(&other.units).map(|(a, b)| mix(*a, *b)).collect(),
            load: mix(self.load, other.load),
        }
    }

    /// The least lumen and its wall.
    pub(super) fn least(&self) -> (usize, f64) {
        let lumens = self.units.iter().chain([&self.vein]).copied().enumerate();
        lumens.min_by(|a, b| a.1.total_cmp(&b.1)).expect("at least a vein")
    }

    /// The greatest difference of a lumen.
    pub(super) fn gap(&self, lumens: &[f64]) -> f64 {
        let own = self.units.iter().chain([&self.vein]);
        own.zip(lumens).fold(0.0, |gap, (a, b)| gap.max((a - b).abs()))
    }
}

impl Tangent {
    pub(super) fn dot(&self, other: &Tangent) -> f64 {
        let units: f64 = self.units.iter().zip(&other.units).map(|(a, b)| a * b).sum();
        self.vein * other.vein + self.load * other.load + units
    }

    pub(super) fn scale(&mut self, by: f64) {
        self.vein *= by;
        self.load *= by;
        self.units.iter_mut().for_each(|unit| *unit *= by);
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
