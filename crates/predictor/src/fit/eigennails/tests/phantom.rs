//! A nail by formula: zones that follow the forces, late and with blood that wanders by itself.

use ndarray::Array2;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::{Dataset, Recording};

/// Cells of a side.
pub(super) const SIDE: usize = 12;
/// Rows of a recording, and seconds from one to the next.
pub(super) const ROWS: usize = 300;
const STEP_S: f64 = 0.1;
/// Time constants of the blood, loading and unloading, seconds (4.3).
const LAG_S: [f64; 2] = [0.18, 0.36];
/// SD of a cell's noise and of the blood that wanders, 1/255 of full scale.
const NOISE: f64 = 0.5;
const WANDER: f64 = 0.9;

/// What is prompted; the number seeds how it is followed.
#[derive(Debug, Clone, Copy)]
pub(super) enum Path {
    Spiral(u64),
    Random(u64),
    /// Presses held in six directions, in an order of their own.
    Directions(u64),
}

/// A person's nail.
pub(super) struct Nail {
    seed: u64,
}

impl Nail {
    pub(super) fn new(seed: u64) -> Self {
        Self { seed }
    }

    /// Cells and forces, a recording a path.
    pub(super) fn film(&self, paths: &[Path]) -> Dataset {
        let n = paths.len() * ROWS;
        let (mut x, mut y) = (Array2::zeros((n, SIDE * SIDE)), Array2::zeros((n, 3)));
        let (mut time, mut recordings) = (Vec::new(), Vec::new());
        for (k, path) in paths.iter().enumerate() {
            let start = k * ROWS;
            let number = match path {
                Path::Spiral(number) | Path::Random(number) | Path::Directions(number) => *number,
            };
            let mut random = ChaCha8Rng::seed_from_u64(1000 * self.seed + number);
            let mut normal = move || -> f64 { StandardNormal.sample(&mut random) };
            let phases = [0; 6].map(|_| 3.0 * normal());
            let wander = [0; 3].map(|_| (0.02 + 0.03 * normal().abs().min(2.0), 3.0 * normal()));
            let mut felt = [0.0_f64; 3];
            for row in 0..ROWS {
                let t = STEP_S * row as f64;
                let force = forces(*path, t, &phases).map(|f| f + 0.02 * normal());
                for (felt, force) in felt.iter_mut().zip(force) {
                    let lag = LAG_S[usize::from(force.abs() < felt.abs())];
                    *felt += (force - *felt) * (1.0 - (-STEP_S / lag).exp());
                }
                let blood = wander.map(|(hz, phase)| WANDER * (std::f64::consts::TAU * hz * t + phase).sin());
                let shift = [0, 1].map(|_| 0.01 * normal());
                for cell in 0..SIDE * SIDE {
                    x[[start + row, cell]] = self.cell(cell, felt, blood, shift) + NOISE * normal();
                }
                (0..3).for_each(|target| y[[start + row, target]] = force[target]);
                time.push(t);
            }
            let name = format!("{path:?}");
            recordings.push(Recording { name, session: "1".into(), subject: "a".into(), rows: start..start + ROWS });
        }
        let inputs = (0..SIDE * SIDE).map(|cell| format!("C_{:02}_{:02}", cell / SIDE, cell % SIDE)).collect();
        let targets = crate::FORCES.map(str::to_owned).to_vec();
        Dataset::new(inputs, targets, time, x, y, recordings).unwrap()
    }

    /// A cell's colour, 1/255 of full scale: zones of 4.2.3 about a level.
    fn cell(&self, cell: usize, [fx, fy, fz]: [f64; 3], blood: [f64; 3], shift: [f64; 2]) -> f64 {
        let place = |k: usize| 2.0 * (k as f64 + 0.5) / SIDE as f64 - 1.0;
        let (u, v) = (place(cell % SIDE) + shift[0], -place(cell / SIDE) + shift[1]);
        let own = 0.1 * (self.seed as f64).sin();
        let spot = |at: [f64; 2], wide: f64| (-((u - at[0]).powi(2) + (v - at[1]).powi(2)) / (2.0 * wide * wide)).exp();
        let press = (-fz / 4.0).tanh();
        100.0 + 30.0 * press * spot([0.0, 0.75 + own], 0.35) - 22.0 * (-fz / 2.0).tanh() * spot([0.0, -0.4], 0.45)
            + 8.0 * fx * (0.5 + press) * (spot([0.6, 0.2], 0.3) - spot([-0.6, 0.2 + own], 0.3))
            + 10.0 * (fy / 2.0).tanh() * (spot([0.0, 0.3], 0.3) - spot([0.0, -0.8], 0.4))
            + blood[0]
            + blood[1] * u
            + blood[2] * v
    }
}

/// Fx, Fy, Fz in newtons.
fn forces(path: Path, t: f64, phases: &[f64; 6]) -> [f64; 3] {
    match path {
        Path::Spiral(_) => {
            let late = t - 0.2 - 0.1 * phases[0].sin();
            let (radius, angle) = (0.05 * late.max(0.0), 1.3 * late);
            [radius * angle.cos(), radius * angle.sin(), -1.0 - 0.12 * late + 0.3 * (0.9 * late).sin()]
        }
        Path::Directions(number) => {
            let held = (t / 2.0) as u64;
            let press = 2.0 + phases[held as usize % 6].sin();
            let way = (5 * held + number + held / 6) % 6;
            let [x, y] = [[0.0, 0.0], [0.0, 0.0], [0.5, 0.0], [-0.5, 0.0], [0.0, 0.5], [0.0, -0.5]][way as usize];
            if way == 0 { [0.0; 3] } else { [x * press, y * press, -press] }
        }
        Path::Random(_) => {
            let wave = |k: usize, hz: f64| (std::f64::consts::TAU * hz * t + phases[k]).sin();
            [
                0.8 * (wave(0, 0.21) + wave(1, 0.13)),
                0.8 * (wave(2, 0.17) + wave(3, 0.26)),
                -2.6 + 1.2 * wave(4, 0.15) + 1.0 * wave(5, 0.24),
            ]
        }
    }
}
