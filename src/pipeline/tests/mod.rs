//! The engine of pipelines with toy jobs: their results are texts that tell all that they hang on.

mod clock;
mod failures;
mod hands;
mod jobs;
mod kill;
mod limits;
mod parts;
pub(super) mod planned;
mod random;
mod toys;
