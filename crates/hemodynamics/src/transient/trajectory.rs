//! What a run gives: the states at the times asked for, and how it went.

use crate::state::State;

/// How a run went.
#[derive(Clone, Debug, PartialEq, Default, serde::Serialize)]
pub struct Statistics {
    /// Stages of the method: 3, 5 or 7.
    pub stages: u32,
    /// Steps accepted.
    pub steps: u64,
    /// Steps tried and rejected.
    pub rejected: u64,
    /// Evaluations of the accelerations of all walls at one state.
    pub evaluations: u64,
    /// Jacobians evaluated and factored.
    pub factorizations: u64,
    /// Newton iterations, of all stages at once.
    #[serde(skip)]
    pub iterations: u64,
    /// The smallest step accepted, s; none where there was none.
    pub smallest_step_s: Option<f64>,
    /// The largest step accepted, s; none where there was none.
    pub largest_step_s: Option<f64>,
}

/// The states at the times asked for, as far as the run came.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Trajectory {
    pub(super) walls: usize,
    pub(super) times_s: Vec<f64>,
    pub(super) lumens: Vec<f64>,
    pub(super) rates: Vec<f64>,
    pub(crate) statistics: Statistics,
}

impl Trajectory {
    /// The times, s.
    pub fn times_s(&self) -> &[f64] {
        &self.times_s
    }

    /// The number of times.
    pub fn len(&self) -> usize {
        self.times_s.len()
    }

    /// Whether not one time was reached.
    pub fn is_empty(&self) -> bool {
        self.times_s.is_empty()
    }

    /// The lumens `d / D` of all walls at time `k`.
    pub fn lumens(&self, k: usize) -> &[f64] {
        &self.lumens[k * self.walls..(k + 1) * self.walls]
    }

    /// The rates `v / D` of all walls at time `k`, 1/s.
    pub fn rates(&self, k: usize) -> &[f64] {
        &self.rates[k * self.walls..(k + 1) * self.walls]
    }

    /// The state at time `k`.
    pub fn state(&self, k: usize) -> State {
        State { lumens: self.lumens(k).to_vec(), rates: self.rates(k).to_vec() }
    }

    /// How the run went.
    pub fn statistics(&self) -> &Statistics {
        &self.statistics
    }

    pub(crate) fn begin(&mut self, walls: usize, times: usize) {
        self.walls = walls;
        self.times_s.clear();
        self.lumens.clear();
        self.rates.clear();
        self.times_s.reserve(times);
        self.lumens.reserve(times * walls);
        self.rates.reserve(times * walls);
        self.statistics = Statistics::default();
    }

    /// Room for one more state: its lumens and rates, still 0.
    pub(crate) fn push(&mut self, time_s: f64) -> (&mut [f64], &mut [f64]) {
        self.times_s.push(time_s);
        let from = self.lumens.len();
        self.lumens.resize(from + self.walls, 0.0);
        self.rates.resize(from + self.walls, 0.0);
        (&mut self.lumens[from..], &mut self.rates[from..])
    }

    pub(crate) fn truncate(&mut self, times: usize) {
        self.times_s.truncate(times);
        self.lumens.truncate(times * self.walls);
        self.rates.truncate(times * self.walls);
    }
}
