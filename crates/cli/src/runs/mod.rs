//! The commands of pipelines: run, merge, init.

pub(crate) mod init;
pub(crate) mod memory;
pub(crate) mod merge;
pub(crate) mod run;

use lunula::job::Kind;
use lunula::pipeline::{Block, Catalogue, PipelineError, Spec, phantom_catalogue, scenes};

/// The kinds of stages: the library's and the study's, by name.
fn kinds() -> Vec<&'static Kind> {
    let mut kinds = [lunula::pipeline::kinds(), lunula_thesis::kinds()].concat();
    kinds.sort_unstable_by_key(|kind| kind.name);
    kinds
}

/// What a pipeline file generates: the library's scenes and the study.
fn generated(spec: &Spec) -> Result<Option<Catalogue>, PipelineError> {
    let known: Vec<Block> = [lunula_thesis::experiments(), scenes()].concat();
    spec.catalogue(|block| phantom_catalogue(block, &known))
}
