//! Why a reduced model was not solved.

use crate::parameters::Site;
use crate::transient::{SolveFault, Trajectory};

/// Why a reduced model was not solved.
#[derive(Debug, thiserror::Error, Clone, PartialEq)]
pub enum ReducedFault {
    /// As with the full model.
    #[error(transparent)]
    Solve(#[from] SolveFault),
    /// A wall that nothing but its inertia holds back.
    #[error("{site} has neither damping nor venules: without its inertia it has no rate; use the full model")]
    Undamped {
        /// Which.
        site: Site,
    },
    /// The walls' contact is too stiff for an explicit method.
    #[error(
        "{evaluations} evaluations were spent by {time_s} s on steps that stability keeps short: the reduced model is stiff there; use the full model"
    )]
    Stiff {
        /// How many.
        evaluations: u64,
        /// How far the run came, s.
        time_s: f64,
        /// The run before.
        before: Box<Trajectory>,
    },
    /// The first-order correction is no small one.
    #[error(
        "the jump of the loads at {time_s} s moves {site} by more than its lumen before its inertia is worn off; the masses are too large for a correction; use the full model"
    )]
    Layer {
        /// Which.
        site: Site,
        /// When, s.
        time_s: f64,
    },
}
