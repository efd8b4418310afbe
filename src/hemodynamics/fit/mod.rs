//! `lunula fit`: free parameters of the model, and the photodiodes' offset and scaling, to recorded responses (Fig.
//! 79-82).

mod estimates;
mod figure;
mod fitted;
mod job;
mod names;
mod noise;
mod options;
mod parameter_files;
mod recording;
mod report;

pub(super) use fitted::{own_parameters, voltages};
pub use job::{FitOutputs, fit, outline as fit_outline, plan as fit_plan};
pub use options::{FitOptions, STARTS};

pub use recording::{Between, ForceColumn, PhotodiodeColumn, RecordingColumns};
pub use report::{FitReport, FittedCombination, FittedGroup, FittedPhotodiode, FittedRival, RecordingReport};
