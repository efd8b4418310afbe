//! A folder of nail photographs to coloration maps: `cargo run --example photos -- fixtures/photos maps`.

use std::path::Path;

use anyhow::Context;
use lunula::job::Watch;
use lunula::photo::{Outputs, PhotoSet, PhotosOptions, run};

fn main() -> anyhow::Result<()> {
    let mut arguments = std::env::args().skip(1);
    let (set, out) = arguments.next().zip(arguments.next()).context("name a folder of photographs and one for maps")?;
    let out = Path::new(&out);
    let set = PhotoSet::open(Path::new(&set), &[out])?;
    let report = run(&set, &PhotosOptions::default(), &Outputs::maps(out), &Watch::nobody())?;
    for pose in &report.figures.poses {
        println!("{}: {} subjects, mean in {}/maps/{}-mean.npy", pose.pose, pose.subjects, out.display(), pose.pose);
    }
    report.failed.iter().for_each(|what| eprintln!("left out: {what}"));
    Ok(())
}
