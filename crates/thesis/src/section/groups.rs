//! The parameters that the thesis tunes within an order of magnitude (4.3.4), in groups that move together.

use lunula_hemodynamics::{Parameters, Site, Symbol};

/// What is tuned: each group moves by one factor.
pub(crate) const GROUPS: [(&str, &[Symbol]); 4] = [
    ("k_C", &[Symbol::Stiffness(Site::Capillary(0)), Symbol::Stiffness(Site::Capillary(1))]),
    ("b_C", &[Symbol::Damping(Site::Capillary(0)), Symbol::Damping(Site::Capillary(1))]),
    ("k_V", &[Symbol::Stiffness(Site::Vein)]),
    ("b_V", &[Symbol::Damping(Site::Vein)]),
];

/// Parameters whose groups are multiplied; none where one is no parameter any more.
pub(crate) fn scaled(parameters: &Parameters, factors: &[f64; 4]) -> Option<Parameters> {
    let all = GROUPS.iter().zip(factors).flat_map(|((_, symbols), factor)| symbols.iter().map(move |s| (*s, *factor)));
    let mut scaled = parameters.clone();
    for (symbol, factor) in all {
        scaled = scaled.set(symbol, factor * parameters.get(symbol)?).ok()?;
    }
    Some(scaled)
}
