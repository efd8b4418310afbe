//! Least squares whose numbers can be trusted: equations 10 to 15, solved without equation 11.
//!
//! In: a design, rows x columns (voltages, or terms of them; no column of ones), and targets, rows x targets. Out: a
//! [`LeastSquares`] for y = y_c + J (x - m), with rank, condition and what is known about its digits.
//!
//! How: columns are scaled by powers of two and centred (both without rounding, [`problem`]), brought to a triangle by
//! Householder reflections ([`reflect`]), the triangle is pivoted for the rank ([`small`]), and the solution is refined
//! with residuals of twice the length ([`refine`]). Multiplying a column by a power of two changes nothing but the unit
//! of its coefficient. Same bytes on every machine.
//!
//! **Rank.** A column counts as dependent where what is left of it beside the ones and the columns taken before is
//! shorter than sqrt(rows) (8 + sqrt(rows / 64)) 2^-52 times its largest value before centring: no further from the
//! others than rounding its own values (and the reflections) may have moved it. That is about arithmetic, not about
//! noise: two photodiodes that differ by 2^-30 are distinguished, with a warning in [`LeastSquares::digits`]. A
//! constant column depends on the ones.
//!
//! **What has no answer is missing.** With as many rows as terms and one for the offset, residuals are zero and there
//! is no residual SD. A constant target has coefficients of exactly 0. Without columns there is only the mean.

mod blocks;
mod factor;
mod fault;
mod normal;
mod problem;
mod refine;
mod reflect;
mod settle;
mod solve;
mod survey;

use ndarray::{Array2, ArrayView2};
use serde::{Deserialize, Serialize};

pub(crate) use factor::rounding;
pub use fault::{Dependent, LeastSquaresFault};
pub(crate) use problem::Problem;
pub(crate) use reflect::triangle;
pub(crate) use solve::solve;

/// What is asked of a fit.
#[derive(Debug, Clone, PartialEq)]
pub struct LeastSquaresOptions {
    /// What to do where columns depend on each other, or rows are too few.
    pub deficient: Deficient,
    /// At most so many steps of refinement; it ends earlier where another would change nothing.
    pub refinements: usize,
    /// By what.
    pub solver: Solver,
    /// Whether the [`FitReport`](crate::FitReport) of a fit of recordings has standard errors, which take as long again
    /// as the fit.
    pub standard_errors: bool,
}

impl Default for LeastSquaresOptions {
    fn default() -> Self {
        Self { deficient: Deficient::Refuse, refinements: 2, solver: Solver::Orthogonal, standard_errors: false }
    }
}

/// Where columns depend on each other, or rows are fewer than the unknowns.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Deficient {
    /// An error that names the columns.
    #[default]
    Refuse,
    /// Of all solutions the one with the least sum of squares of coefficient times length of its centred column:
    /// duplicates share.
    MinimumNorm,
    /// Columns are left out, the pivoting's last: their coefficient is 0, and they are listed.
    Drop,
    /// Adds lambda times that sum of squares to what is made small, whether the rank is full or not. Lambda is a number
    /// without unit, above 0: 1 counts as much as the data's own spread. Constant columns get 0.
    Ridge(f64),
}

impl std::str::FromStr for Deficient {
    type Err = String;

    /// `refuse`, `minimum-norm`, `drop` or `ridge=LAMBDA`.
    fn from_str(text: &str) -> Result<Self, String> {
        let ridge = |lambda: &str| lambda.parse().ok().filter(|lambda: &f64| *lambda > 0.0 && lambda.is_finite());
        let parsed = match text {
            "refuse" => Some(Self::Refuse),
            "minimum-norm" => Some(Self::MinimumNorm),
            "drop" => Some(Self::Drop),
            other => other.strip_prefix("ridge=").and_then(ridge).map(Self::Ridge),
        };
        parsed.ok_or_else(|| {
            "choose refuse, minimum-norm, drop or ridge=LAMBDA (as ridge=1e-6, \
             of voltages in units of their spread)"
                .to_owned()
        })
    }
}

/// How the coefficients are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Solver {
    /// As this module says.
    #[default]
    Orthogonal,
    /// Equation 11 as printed, with equation 12's row of ones: products of the raw columns, inverted. For comparison
    /// only: it loses twice the digits. [`Deficient`] and refinements do not apply; rank and condition are not looked
    /// at.
    Normal,
}

/// A fit: y = y_c + J (x - m).
#[derive(Debug, Clone, PartialEq)]
pub struct LeastSquares {
    /// m: the columns' means, in their units.
    pub centre: Vec<f64>,
    /// y_c: the targets at the centre, their means up to rounding of the centre.
    pub target_centre: Vec<f64>,
    /// J: targets x columns, a target's unit a column's.
    pub coefficients: Array2<f64>,
    /// y_c - J m (equations 13 and 15's F_0), worked out before rounding; only for print: in use it cancels digits.
    pub intercept: Vec<f64>,
    /// Rows used.
    pub rows: usize,
    /// Of the centred columns; none where not looked at.
    pub rank: Option<usize>,
    /// Of the centred columns, each over its own length; descending; empty where not looked at.
    pub singular_values: Vec<f64>,
    /// First over last of them; infinite where one is zero, 1 without columns, NaN where not looked at.
    pub condition: f64,
    /// Of the system that was solved (without what was dropped, or with the ridge).
    pub solved_condition: f64,
    /// Columns left out.
    pub dropped: Vec<usize>,
    /// Columns that take part in the direction that the rows tell least about: a tenth or more of its largest
    /// component.
    pub near_collinear: Vec<usize>,
    /// Targets x columns, as the coefficients, of residuals that are independent of each other (those of rows that
    /// follow each other in time are not); NaN where none is defined: no degrees of freedom, dropped, minimum norm,
    /// ridge.
    pub standard_errors: Array2<f64>,
    /// A target each, in its unit; none without degrees of freedom.
    pub residual_sd: Vec<Option<f64>>,
    /// Steps of refinement taken.
    pub refined: usize,
}

impl LeastSquares {
    /// Decimal digits of the coefficients that rounding the rows' last bit leaves alone, to a tenth: 16 less those of
    /// the condition. NaN where that is not known.
    #[must_use]
    pub fn digits(&self) -> f64 {
        let digits = -(self.solved_condition * f64::EPSILON / 2.0).log10().clamp(-16.0, 0.0);
        // Machines differ in a logarithm's last bit.
        (digits * 10.0).round() / 10.0
    }
}

/// Fits `targets` (rows x targets) to `design` (rows x columns, no column of ones).
pub fn least_squares(
    design: ArrayView2<'_, f64>,
    targets: ArrayView2<'_, f64>,
    options: &LeastSquaresOptions,
) -> Result<LeastSquares, LeastSquaresFault> {
    match options.solver {
        Solver::Orthogonal => solve(Problem::new(design, targets)?, options),
        Solver::Normal => normal::normal(design, targets),
    }
}
