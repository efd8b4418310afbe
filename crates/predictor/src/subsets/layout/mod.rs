//! Where to put photodiodes: the k places out of many whose readings leave the least error (sections 5.5 and 7.2, which
//! ask for a study of the effect of location).
//!
//! In: for each person the second moments of readings at all candidates, C = X'X/n, and of readings with targets, B =
//! X'Y/n ([`Moments`]); which places may be chosen together ([`Rules`]). Out: sets of places with their cost, found by
//! forward greedy and exchange ([`search`]), and a proof that none is better, or how far below any could be
//! ([`prove`]); what others choose, beside it ([`pivoted`], [`determinant`]).
//!
//! The cost of places K is a mean over persons and columns of B of a function that falls with q = B_K' C_KK^-1 B_K:
//!
//! - [`Criterion::Error`]: columns of B are targets over their SD; sqrt(1 - q), the RMSE of the linear model over the
//!   SD, which [`crate::every_subset`] scores by. Without a place, 1.
//! - [`Criterion::Confusion`]: columns are differences of two classes' means and C is the covariance within classes, so
//!   q is their squared Mahalanobis distance; exp(-q/8)/2, what two classes are confused at most (Bhattacharyya's
//!   bound; Kailath 1967, doi:10.1109/TCOM.1967.1089532). Without a place, 1/2.
//!
//! q never falls with another place, so what all places that are left could reach bounds what any of them can: leaps
//! and bounds (Furnival and Wilson 1974, doi:10.2307/1267601). Exchange: Fedorov (Theory of Optimal Experiments,
//! 1972), seeded. The same problem gives the same places, in whichever order candidates are named, on any number of
//! threads.
//!
//! Not determined: how well a model does on rows it was not fitted to. Second moments are those of the rows given.

mod baseline;
mod bound;
mod ladder;
mod problem;
mod rules;
mod search;
#[cfg(test)]
mod tests;

pub use baseline::{determinant, pivoted};
pub use bound::{Proof, prove};
pub use problem::{Candidate, Criterion, LayoutFault, LayoutProblem, MOST_CANDIDATES, Moments};
pub use rules::Rules;
pub use search::{Choice, Starts, search};
