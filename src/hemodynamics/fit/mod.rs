//! `lunula fit`: free parameters of the model, and the photodiodes' offset and scaling, to recorded responses (Fig.
//! 79-82).

mod alone;
mod fitted;
mod job;
mod kind;
mod names;
mod noise;
mod options;
mod recording;
mod report;
mod results;

pub use alone::Alone as FitAlone;
pub use fitted::{own_parameters, voltages};
pub use job::{fit, plan as fit_plan};
pub use options::{FitInputs, FitOptions};
pub use recording::{Between, PhotodiodeColumn, RecordingColumns};
pub use report::{FitFigures, FitReport, FittedPhotodiode, RecordingReport};
