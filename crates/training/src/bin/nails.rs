//! `nails`: makes and judges the weights that find nails on photographs.

use std::path::PathBuf;

use anyhow::{Context, ensure};
use clap::{Parser, Subcommand};
use lunula::photo::outline::Detector;
use lunula_training::nails::{self, Part, folds};

/// Make or judge the weights that find nails on photographs
///
/// The weights that lunula comes with (src/photo/outline/detect/weights/*.txt) are those of, in this order,
/// `nails train first border`, `nails train scorer` and `nails train judge` with 450 phantoms and, in --hands,
/// annotated photographs of hands. Detection with the weights that are compiled in makes part of what the next ones
/// learn from: write each step's into that folder and build again before the next. The same scenes, weights before and
/// kind of processor give the same weights.
#[derive(Debug, Parser)]
#[command(version, max_term_width = 100)]
struct Arguments {
    /// Folder of photographs of hands: images/, and under the same names masks/ with nails white; in sorted order those
    /// of even index are used, those of odd index never, but for `table --held-out`
    #[arg(long, value_name = "FOLDER", global = true)]
    hands: Option<PathBuf>,
    #[command(subcommand)]
    job: Job,
}

#[derive(Debug, Subcommand)]
enum Job {
    /// Fit networks by Adam (batches of 64) and write their weights; minutes each in a release build
    ///
    /// Scenes are phantoms of any tone, light, pose and turn up to 30 degrees (seed 1000; of the judge 2000), three
    /// quarters as many pictures without nails, and --hands.
    Train {
        /// Which ones: first and scorer write scorer.txt, border border.txt, judge judge-0.txt to judge-2.txt
        #[arg(required = true)]
        parts: Vec<Part>,
        /// Phantoms
        #[arg(long, default_value_t = 450)]
        count: u32,
        /// Folder for the weights
        #[arg(long)]
        out: PathBuf,
    },
    /// Print precision, recall and calibration of detection with the weights that are compiled in; takes minutes
    Table {
        /// On photographs of odd index too: each look at them makes them less of a test
        #[arg(long, requires = "hands")]
        held_out: bool,
        /// Who finds nails
        #[arg(long, value_enum, default_value_t)]
        detector: Detector,
        /// Of the phantoms and of the pictures without nails; no network has learned from 3000 or 7000
        #[arg(long, default_value_t = 3000)]
        seed: u64,
    },
    /// Print recall and precision of the network on photographs of --hands that it has not seen; takes minutes
    #[command(
        long_about = "Print recall and precision of the network on photographs of --hands that it has not seen\n\n\
        What crates/training/nail-net trains without a fold is judged on that fold, by the whole of detection."
    )]
    Folds(folds::Folds),
}

fn main() -> anyhow::Result<()> {
    let Arguments { hands, job } = Arguments::parse();
    match job {
        Job::Train { parts, count, out } => {
            let both = parts.contains(&Part::First) && parts.contains(&Part::Scorer);
            ensure!(!both, "first and scorer write the same file: run one after the other");
            let alone = parts.len() == 1 || !parts.contains(&Part::Judge);
            ensure!(alone, "judge learns from other scenes than the others: run it by itself");
            std::fs::create_dir_all(&out).with_context(|| out.display().to_string())?;
            for (name, text) in nails::train(&parts, count, hands.as_deref(), &|what| eprintln!("{what}"))? {
                let path = out.join(name);
                std::fs::write(&path, text).with_context(|| path.display().to_string())?;
            }
            Ok(())
        }
        Job::Table { held_out, detector, seed } => {
            print!("{}", nails::table(hands.as_deref(), held_out, detector, seed)?);
            Ok(())
        }
        Job::Folds(with) => {
            print!("{}", folds::table(&hands.context("--hands is missing")?, &with)?);
            Ok(())
        }
    }
}
