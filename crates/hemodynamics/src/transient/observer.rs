//! What every accepted step reports to those who solve the linear equations along a trajectory (sensitivities).

use crate::model::InputLanes;
use crate::radau::Table;

/// A step that was accepted. Jacobians at its stages come from [`crate::Model::jacobian`] there.
pub(crate) struct AcceptedStep<'a, const S: usize> {
    /// Where it begins, s.
    pub(crate) from_s: f64,
    /// Its size, s.
    pub(crate) step_s: f64,
    pub(crate) table: &'static Table<S>,
    /// Lumens and rates of each wall at the stages.
    pub(crate) stages: [&'a [[f64; S]]; 2],
    pub(crate) inputs: &'a InputLanes<S>,
    /// The times asked for that lie in the step, its end included.
    pub(crate) times_s: &'a [f64],
}

/// Receives the accepted steps. `()` ignores them.
pub(crate) trait StepObserver {
    fn accepted<const S: usize>(&mut self, step: &AcceptedStep<'_, S>);

    /// Whether the time of a collapse is to be found to its last digits, which takes another run.
    fn times_collapse(&self) -> bool {
        true
    }
}

impl StepObserver for () {
    fn accepted<const S: usize>(&mut self, _: &AcceptedStep<'_, S>) {}
}
