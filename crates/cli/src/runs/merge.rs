//! `lunula merge`: the parts of a run that was cut, as if it had been made at once.

use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Args;
use lunula::pipeline::{Parts, PipelineMark, Plan, RunOptions, Spec};

use crate::runs::run::{finish, watched};
use crate::runs::{generated, kinds, memory};
use crate::{Common, Outcome};

/// Bring the parts of a run made with --shard together: the same bytes as from one run
///
/// PARTS are the folders that `lunula run PIPELINE --shard I/N --out PART` wrote, all N of them in any order. Their
/// results are linked or copied into --out, then what no part could do (what gathers over all of them) is done there,
/// and whatever inputs have changed since. A part that is missing, given twice, not at its end, or made by another
/// pipeline or version is refused, and so are parts that made different things of one name; nothing is written then.
/// May be called again with the same --out.
#[derive(Debug, Args)]
pub(crate) struct MergeArgs {
    /// Folders of the parts
    #[arg(required = true, num_args = 1..)]
    parts: Vec<PathBuf>,
    /// Folder for the results
    #[arg(long)]
    out: PathBuf,
    /// The pipeline file, if it has moved since the parts were run
    #[arg(long, value_name = "FILE")]
    pipeline: Option<PathBuf>,
    /// Memory that tasks may take together, as 4GB or 500MB [default: three quarters of what is free]
    #[arg(long, value_name = "SIZE", value_parser = memory::parse)]
    memory: Option<u64>,
    #[command(flatten)]
    common: Common,
}

pub(crate) fn run(args: &MergeArgs) -> anyhow::Result<Outcome> {
    let common = &args.common;
    let stop = common.start()?;
    let parts = Parts::open(&args.parts)?;
    let mark = pipeline(&parts, args)?;
    let spec = Spec::parse(&mark.text, Path::new(&mark.path), &kinds())?;
    let generated = generated(&spec)?;
    let plan = Plan::new(&spec, &args.out, generated.as_ref())?;
    common.warn(&plan.warnings);
    let (results, merged) = parts.merge(&plan.tasks, &mark, &args.out)?;
    common.warn(&merged.warnings);
    let (count, brought, stood) = (args.parts.len(), merged.imported, merged.stood);
    common.say(&format!("{brought} results of {count} parts brought together, {stood} were there already"));
    let options = RunOptions {
        threads: common.threads.map_or_else(memory::threads, usize::from),
        memory: args.memory.unwrap_or_else(memory::free),
        shard: None,
        pipeline: mark,
    };
    let report = watched(common, &stop, plan.tasks.len(), |watch| results.run(&plan.tasks, &options, watch))?;
    finish(common, &plan, &report, &args.out)
}

/// The pipeline that was given, or the parts' own as it was when they were run.
fn pipeline(parts: &Parts, args: &MergeArgs) -> anyhow::Result<PipelineMark> {
    if let Some(path) = &args.pipeline {
        let text = std::fs::read_to_string(path).with_context(|| format!("{}: cannot be read", path.display()))?;
        return Ok(PipelineMark::new(path, &text));
    }
    let own = parts.pipeline().context("no parts were given")?;
    let change = match std::fs::read_to_string(&own.path) {
        Err(why) => format!("cannot be read now ({why}); if it was moved, give it with --pipeline"),
        Ok(text) if PipelineMark::new(Path::new(&own.path), &text).decides != own.decides => "has changed since".into(),
        Ok(_) => return Ok(own.clone()),
    };
    args.common.warn(&[format!("{}: {change}; the parts are merged as it was when they were run", own.path)]);
    Ok(own.clone())
}
