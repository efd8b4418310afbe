//! Pipelines over all jobs: what is wanted, once; only what is needed for it, and nothing twice.

mod catalogue;
mod commit;
mod graph;
mod hashes;
mod init;
mod items;
mod kinds;
mod lock;
mod merge;
mod pattern;
mod plan;
mod record;
mod report;
mod run;
mod said;
mod shard;
mod spec;
mod standing;
mod store;
mod task;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod toys;

pub use catalogue::{Catalogue, CatalogueFile, CatalogueTask, Catalogues};
pub use graph::GraphFault;
pub use hashes::ContentHash;
pub use init::{InitError, propose};
pub use kinds::{kinds, phantom_catalogue};
pub use lock::Holder;
pub use merge::{MergeFault, Merged, Parts};
pub use plan::{Plan, PlanFate, PlanLine, StagePlan, plan_text};
pub use record::Output;
pub use report::{Count, QualitySummary, RunSummary, StageSummary, TaskSummary, summary, write_reports};
pub use run::{
    Event, Outcome, Progress, Results, RunFault, RunOptions, RunReport, RunWatch, TaskFailure, TaskReport, run,
};
pub use shard::{PartMark, PipelineMark, Shard, ShardFault};
pub use spec::{PipelineError, Spec};
pub use standing::{Standing, Why, survey};
pub use task::{Input, Share, Source, Task, TaskId};

pub use crate::toml_file::Fault;
