//! Other programs on the scenes of `lunula tradeoff`: writes the table that its `--peers` takes.
//!
//! In: stages, seed and effort as of `lunula tradeoff`, which make the same scenes. Out: a row for each setting of each
//! program ([`PeerRow`]). The Python scripts beside this crate are run where `python3` has their packages, and give
//! times and results; how wrong a result is, the library's own code says, by the code that says it of lunula's. What is
//! missing is named, with how to get it.

mod align;
#[cfg(feature = "diffsol")]
mod diffsol;
mod found;
mod hemodynamics;
mod photos;
mod posture;
mod predictor;
mod python;
mod recipe;

use std::path::PathBuf;

use anyhow::{Context, ensure};
use clap::Parser;
use lunula::tradeoff::peers::{PeerRow, write_peers};
use lunula::tradeoff::{Effort, Job, Plan};

use found::Found;
use python::Python;

/// Measure other programs on the scenes of `lunula tradeoff`, for its --peers
///
/// Every time is of one thread and the median of the repeats. Compare with lunula's of the same machine: run `lunula
/// tradeoff` with the same --seed, --repeats and --quick right after.
#[derive(Debug, Parser)]
#[command(name = "lunula-peers", version, max_term_width = 100)]
struct Arguments {
    /// Stages to measure: photos, posture, align, predictor, hemodynamics [default: all]
    stages: Vec<String>,
    /// The table [default: bench/runs/DATE-MACHINE/peers.csv]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Seed of the synthetic scenes
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Runs of each setting; the median time counts
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u16).range(1..=1000))]
    repeats: u16,
    /// Smaller scenes
    #[arg(long)]
    quick: bool,
    /// Python 3.11 or later, with the packages of requirements.txt
    #[arg(long, default_value = "python3")]
    python: String,
    /// The machine's name in the table [default: its processor]
    #[arg(long)]
    machine: Option<String>,
}

/// On what and with what other programs are measured.
struct Bench {
    plan: Plan,
    python: Python,
}

fn main() -> anyhow::Result<()> {
    let Arguments { stages, out, seed, repeats, quick, python, machine } = Arguments::parse();
    let stages = stages.iter().map(|name| Job::named(name).map_err(anyhow::Error::msg));
    let stages = stages.collect::<anyhow::Result<Vec<_>>>()?;
    let stages = if stages.is_empty() { Job::ALL.to_vec() } else { stages };
    let effort = Effort { repeats: usize::from(repeats), quick, ..Effort::default() };
    let bench = Bench { plan: Plan::new(seed, effort, Vec::new()), python: Python::new(python) };
    let machine = machine.unwrap_or_else(processor);
    let date = jiff::Timestamp::now().strftime("%Y-%m-%d").to_string();
    let out = out.unwrap_or_else(|| {
        let runs = concat!(env!("CARGO_MANIFEST_DIR"), "/../runs");
        PathBuf::from(runs).join(format!("{date}-{}", words(&machine))).join("peers.csv")
    });
    let mut rows = Vec::new();
    for stage in stages {
        eprintln!("{}: {}", stage.name(), bench.plan.scene(stage));
        let mut found = Found::default();
        let folder = tempfile::tempdir()?;
        match stage {
            Job::Photos => photos::measure(&bench, folder.path(), &mut found)?,
            Job::Posture => posture::measure(&bench, folder.path(), &mut found)?,
            Job::Align => align::measure(&bench, folder.path(), &mut found)?,
            Job::Predictor => predictor::measure(&bench, folder.path(), &mut found)?,
            Job::Switch => found.left_out.push("switch: no other program says how often a switch is false".to_owned()),
            Job::Hemodynamics => hemodynamics::measure(&bench, folder.path(), &mut found)?,
        }
        let scene = bench.plan.scene(stage);
        rows.extend(found.rows.into_iter().map(|row| PeerRow {
            stage,
            scene: scene.clone(),
            machine: machine.clone(),
            date: date.clone(),
            ..row
        }));
        found.left_out.iter().for_each(|what| eprintln!("left out: {what}"));
    }
    ensure!(!rows.is_empty(), "no other program could be measured");
    if let Some(folder) = out.parent() {
        std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    }
    write_peers(&rows, &out)?;
    println!("{} rows: lunula tradeoff all --peers {} --out DIR", rows.len(), out.display());
    Ok(())
}

/// The processor's name and how many of its cores there are.
fn processor() -> String {
    let about = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = about.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
    let name = name.map_or(std::env::consts::ARCH, |(_, name)| name.trim());
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    format!("{name}, {cores} cores")
}

/// A name as a part of a folder's.
fn words(name: &str) -> String {
    let parts = name.split(|c: char| !c.is_ascii_alphanumeric()).filter(|part| !part.is_empty());
    parts.map(str::to_lowercase).collect::<Vec<_>>().join("-")
}
