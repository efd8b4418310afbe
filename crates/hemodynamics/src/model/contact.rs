//! The force of opposite walls on each other: [`crate::Collapse::Contact`].

/// Lumen over nominal diameter below which walls touch, `d_c / D`.
pub(crate) const TOUCH: f64 = 0.05;

/// The force over `k D`: `(d_c / d - 1)^3` below `d_c`, 0 above.
pub(crate) fn contact(lumen: f64) -> f64 {
    let near = (TOUCH / lumen - 1.0).max(0.0);
    near * near * near
}

/// Its derivative by the lumen.
pub(crate) fn contact_slope(lumen: f64) -> f64 {
    let near = (TOUCH / lumen - 1.0).max(0.0);
    -3.0 * near * near * TOUCH / (lumen * lumen)
}
