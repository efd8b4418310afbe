//! A [`Dataset`](crate::Dataset) to a model by least squares: [`fit_linear`] (equations 9 and 10 to 15),
//! [`fit_quadratic`] (equation 16), with a [`FitReport`] of what is known about the numbers. Here columns get the
//! photodiodes' names. Of the cells of a nail's picture: [`fit_eigennails`].

mod eigennails;
mod fault;
mod jackknife;
mod linear;
mod printed;
mod quadratic;
mod report;

pub use eigennails::{Directions, EigennailsReport, OnScores, fit_eigennails};
pub use fault::FitFault;
pub use linear::fit_linear;
pub use printed::{Printed, linear_f0, quadratic_printed};
pub use quadratic::fit_quadratic;
pub use report::FitReport;
