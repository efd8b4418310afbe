//! Joint angles and a log on another clock to a labelled training set:
//! `cargo run --example align -- joints.csv fixtures/finger/log.csv training.csv`.

use lunula::align::{AlignInputs, AlignOptions, AlignOutputs, run};
use lunula::job::Watch;

fn main() -> anyhow::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [joints, log, training] = &arguments[..] else { anyhow::bail!("name angles, a log and a table to write") };
    let inputs = AlignInputs { joints: joints.into(), log: log.into(), tracks: None };
    let outputs =
        AlignOutputs { training: training.into(), mot: None, bids: None, dlc: None, figures: true, report: true };
    let report = run(&inputs, &AlignOptions::default(), &outputs, &Watch::nobody())?;
    for label in &report.figures.labels {
        println!("{}: {} of {} rows labelled", label.joint, label.rows, report.figures.rows_read);
    }
    report.warnings.iter().for_each(|warning| eprintln!("warning: {warning}"));
    Ok(())
}
