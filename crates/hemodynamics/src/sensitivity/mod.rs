//! How the states of the model depend on its parameters.
//!
//! In: a [`Model`](crate::Model), its loads, and directions in the space of its parameters
//! ([`Tangent`](crate::model::Tangent)). Out: derivatives of the lumens `d / D` along them: at an equilibrium by the
//! implicit function theorem, over a transient by the variational equations `s' = J s + f_p`, solved exactly on the
//! very steps and stages that the solver took.

mod equilibrium;
mod lu;
mod variation;

pub(crate) use equilibrium::{NoRest, Rest};
pub(crate) use variation::Variation;

#[cfg(test)]
mod tests;
