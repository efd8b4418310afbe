//! The variational equations along a transient.
//!
//! In: every step that the solver accepts, with its stages, and the derivatives of the state at the start along each
//! direction. Out: the derivatives of the lumens at every time asked for. With `U`, `W` the derivatives of lumens and
//! rates at the stages of a step of size `h`, `U = u + h A W` and `A^-1 (W - w) / h = F_l U + F_w W + F_p`, the
//! Jacobians taken at each stage: one linear system for all directions. What comes out is the derivative of the
//! discrete solution on fixed steps, and of the same order as the solution itself.

use super::lu::Lu;
use crate::model::{Arrow, Currents, Model, Tangent};
use crate::radau::Table;
use crate::transient::{AcceptedStep, StepObserver};

/// Derivatives along directions, carried from step to step.
pub(crate) struct Variation<'a> {
    model: &'a Model,
    tangents: &'a [Tangent],
    /// Derivatives of the lumens and the rates at the end of the last step, the walls of each direction in turn.
    lumens: Vec<f64>,
    rates: Vec<f64>,
    /// Derivatives of the lumens at the times asked for: times, directions, walls.
    out: Vec<f64>,
    /// Whether every step's system could be solved.
    pub(crate) sound: bool,
    pub(crate) steps: u64,
    memory: Memory,
}

#[derive(Default)]
struct Memory {
    lu: Lu,
    /// `A^-1`, row-major, of a method with so many stages.
    inverse: Vec<f64>,
    stages: usize,
    arrows: Vec<Arrow>,
    currents: Currents,
    lumens: Vec<f64>,
    rates: Vec<f64>,
    /// `F_p` and then `W - w` of each direction: directions, stages, walls.
    unknown: Vec<f64>,
    /// `U - u` of one direction: stages, walls.
    rise: Vec<f64>,
}

impl<'a> Variation<'a> {
    /// Starts with derivatives of the lumens (the walls of each direction in turn), the rates depending on nothing.
    pub(crate) fn new(model: &'a Model, tangents: &'a [Tangent], lumens: Vec<f64>) -> Self {
        let rates = vec![0.0; lumens.len()];
        Variation { model, tangents, lumens, rates, out: vec![], sound: true, steps: 0, memory: Memory::default() }
    }

    /// Puts out the derivatives at the present.
    pub(crate) fn put_out(&mut self) {
        self.out.extend_from_slice(&self.lumens);
    }

    /// The derivatives put out: times, directions, walls.
    pub(crate) fn into_derivatives(self) -> Vec<f64> {
        self.out
    }
}

impl StepObserver for Variation<'_> {
    /// That a vessel closes is enough to know.
    fn times_collapse(&self) -> bool {
        false
    }

    fn accepted<const S: usize>(&mut self, step: &AcceptedStep<'_, S>) {
        self.steps += 1;
        let (walls, h) = (self.model.walls(), step.step_s);
        let memory = &mut self.memory;
        memory.begin(step.table, walls, self.tangents.len());
        for s in 0..S {
            for j in 0..walls {
                memory.lumens[j] = step.stages[0][j][s];
                memory.rates[j] = step.stages[1][j][s];
            }
            let inputs = step.inputs.lane(s);
            self.model.jacobian(&memory.lumens, &memory.rates, &inputs, &mut memory.arrows[s]);
            self.model.currents(&memory.lumens, &memory.rates, &inputs, &mut memory.currents);
            for (q, tangent) in self.tangents.iter().enumerate() {
                let out = &mut memory.unknown[(q * S + s) * walls..][..walls];
                self.model.along(&memory.lumens, &memory.rates, &inputs, &memory.currents, tangent, out);
            }
        }
        if !memory.factorize(step.table, walls, h) {
            self.sound = false;
        }
        let next = self.out.len();
        self.out.resize(next + step.times_s.len() * self.lumens.len(), f64::NAN);
        for q in 0..self.tangents.len() {
            let (u, w) = (&mut self.lumens[q * walls..][..walls], &mut self.rates[q * walls..][..walls]);
            let z = &mut memory.unknown[q * S * walls..][..S * walls];
            for (s, arrow) in memory.arrows.iter().enumerate() {
                let ahead = h * step.table.nodes[s];
                let mut pressure = 0.0;
                for j in 0..walls {
                    pressure += arrow.pressure_by_lumen[j] * (u[j] + ahead * w[j]) + arrow.pressure_by_rate[j] * w[j];
                }
                for j in 0..walls {
                    z[s * walls + j] += arrow.by_lumen[j] * (u[j] + ahead * w[j])
                        + arrow.by_rate[j] * w[j]
                        + arrow.by_pressure[j] * pressure;
                }
            }
            memory.lu.solve(z);
            for s in 0..S {
                for j in 0..walls {
                    let sum: f64 = (0..S).map(|r| step.table.weights_by_column[r][s] * z[r * walls + j]).sum();
                    memory.rise[s * walls + j] = h * (step.table.nodes[s] * w[j] + sum);
                }
            }
            for (k, &time) in step.times_s.iter().enumerate() {
                let basis = step.table.basis(((time - step.from_s) / h).min(1.0));
                let at = next + k * self.tangents.len() * walls + q * walls;
                for (j, (out, u)) in self.out[at..at + walls].iter_mut().zip(&*u).enumerate() {
                    let sum: f64 = (0..S).map(|s| basis[s] * memory.rise[s * walls + j]).sum();
                    *out = u + sum;
                }
            }
            for j in 0..walls {
                u[j] += memory.rise[(S - 1) * walls + j];
                w[j] += z[(S - 1) * walls + j];
            }
        }
        self.sound &= self.lumens.iter().all(|value| value.is_finite());
    }
}

impl Memory {
    fn begin<const S: usize>(&mut self, table: &Table<S>, walls: usize, directions: usize) {
        if self.stages == S {
            return;
        }
        self.stages = S;
        let mut a = Lu::default();
        let matrix = a.clear(S);
        for (i, row) in matrix.chunks_exact_mut(S).enumerate() {
            for (j, value) in row.iter_mut().enumerate() {
                *value = table.weights_by_column[j][i];
            }
        }
        let regular = a.factorize();
        debug_assert!(regular, "A of a Radau method is regular");
        self.inverse = vec![0.0; S * S];
        for j in 0..S {
            let mut column = [0.0; S];
            column[j] = 1.0;
            a.solve(&mut column);
            for (i, value) in column.iter().enumerate() {
                self.inverse[i * S + j] = *value;
            }
        }
        self.arrows = vec![Arrow::default(); S];
        self.lumens = vec![0.0; walls];
        self.rates = vec![0.0; walls];
        self.unknown = vec![0.0; directions * S * walls];
        self.rise = vec![0.0; S * walls];
    }

    /// `A^-1 / h - F_w - h F_l A`, rows and columns by stages and then walls.
    fn factorize<const S: usize>(&mut self, table: &Table<S>, walls: usize, h: f64) -> bool {
        let n = S * walls;
        let matrix = self.lu.clear(n);
        for (s, arrow) in self.arrows.iter().enumerate() {
            for i in 0..walls {
                let row = &mut matrix[(s * walls + i) * n..][..n];
                for (r, block) in row.chunks_exact_mut(walls).enumerate() {
                    let ahead = h * table.weights_by_column[r][s];
                    for (value, by_lumen) in block.iter_mut().zip(&arrow.pressure_by_lumen) {
                        *value = -ahead * arrow.by_pressure[i] * by_lumen;
                    }
                    block[i] += self.inverse[s * S + r] / h - ahead * arrow.by_lumen[i];
                    if r == s {
                        for (value, by_rate) in block.iter_mut().zip(&arrow.pressure_by_rate) {
                            *value -= arrow.by_pressure[i] * by_rate;
                        }
                        block[i] -= arrow.by_rate[i];
                    }
                }
            }
        }
        self.lu.factorize()
    }
}
