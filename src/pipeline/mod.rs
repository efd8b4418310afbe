//! Pipelines over all jobs: what is wanted, once; only what is needed for it, and nothing twice.

mod init;
mod items;
mod jobs;
mod parts;
mod plan;
mod report;
mod run;
mod spec;
mod store;
mod tasks;
#[cfg(test)]
mod tests;

pub use init::{InitError, Proposal, propose};
pub use items::catalogue::{Catalogue, CatalogueFile, CatalogueTask};
pub use items::generated::{Asked, Block, Placed, phantom_catalogue, scenes};
pub use jobs::kinds;
pub use parts::merge::{MergeFault, Merged, Parts};
pub use parts::shard::{PartMark, PipelineMark, Shard, ShardFault};
pub use plan::{Plan, PlanFate, PlanLine, StagePlan, plan_text};
pub use report::{Count, QualitySummary, RunSummary, StageSummary, TaskSummary, summary, write_reports};
pub use run::{
    Event, Outcome, Progress, Results, RunFault, RunOptions, RunReport, RunWatch, TaskFailure, TaskReport, run,
};
pub use spec::{PipelineError, Spec};
pub use store::hashes::ContentHash;
pub use store::lock::Holder;
pub use store::record::Output;
pub use store::standing::{Standing, Why, survey};
pub use tasks::graph::GraphFault;
pub use tasks::{Input, Share, Source, Task, TaskId};

pub use crate::toml_file::Fault;
