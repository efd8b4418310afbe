//! The tables of section 5.4 of the thesis on generated logs of seven people.
//!
//! `cargo run --release -p lunula-thesis --example section_5_4 -- OUT [NAME=VALUE ..]` prints Markdown and writes logs,
//! a table and pictures into OUT; the same bytes each time. What the phantom assumes may be changed, by the names of
//! `lunula phantom log`: `posture-shift` (by up to how many degrees of J2 the finger is off straight in each
//! repetition, 3), `follow` (its error, a share, 0.06), `wander` (drift, 0.01 V), `noise` (0.0005 V), `lag` and
//! `hysteresis` (shares of the usual, 1).

use std::path::{Path, PathBuf};

use anyhow::Context;
use lunula::align::{AlignInputs, AlignOptions, AlignOutputs, run as align};
use lunula::job::{Outputs, Watch};
use lunula::phantom::Generated as _;
use lunula::phantom::log::{LogOptions, Protocol};
use lunula::predictor::models::{Kind, Recipe};
use lunula_thesis::compare::{CompareOptions, Person, compare};
use rayon::prelude::*;

const PEOPLE: u32 = 7;

/// What is assumed otherwise than usual.
type Changes = Vec<(String, f64)>;

fn main() -> anyhow::Result<()> {
    let mut arguments = std::env::args().skip(1);
    let out = PathBuf::from(arguments.next().context("name a folder: section_5_4 OUT [NAME=VALUE ..]")?);
    let change = |text: String| {
        let (name, value) = text.split_once('=').with_context(|| format!("{text}: write NAME=VALUE"))?;
        Ok((name.to_owned(), value.parse().with_context(|| format!("{text}: no number"))?))
    };
    let changes = arguments.map(change).collect::<anyhow::Result<Changes>>()?;
    let people = (1..=PEOPLE).into_par_iter().map(|subject| person(subject, &changes, &out.join("logs")));
    let people = people.collect::<anyhow::Result<Vec<_>>>()?;
    let kinds = [Kind::Linear, Kind::Quadratic, Kind::Network { hidden: 8 }];
    let options = CompareOptions { models: kinds.map(Recipe::new).to_vec(), bending_s: Protocol::Touch.seconds()[0] };
    let report = compare(&people, &options, Some(&Outputs::all(out.clone())), &Watch::nobody())?;
    report.warnings.iter().for_each(|warning| eprintln!("note: {warning}"));
    for comparison in &report.comparisons {
        println!("{}", comparison.markdown());
    }
    eprintln!("{:.1} s; look at {}", report.wall_s, out.join("fig-105.png").display());
    Ok(())
}

/// Makes one person's logs.
fn person(subject: u32, changes: &Changes, out: &Path) -> anyhow::Result<Person> {
    let log = |protocol: Protocol, repetition: u32| -> anyhow::Result<PathBuf> {
        let usual = LogOptions::of(protocol, u64::from(100 * subject + repetition));
        let mut options = LogOptions { subject, lead_s: 0.0, trail_s: 0.0, ..usual };
        for (name, value) in changes {
            match name.as_str() {
                "posture-shift" => options.posture_shift_rad = value.to_radians(),
                "follow" => options.follow = *value,
                "wander" => options.wander_v = *value,
                "noise" => options.noise_sd_v = *value,
                "lag" => options.dynamics.lag = *value,
                "hysteresis" => options.dynamics.hysteresis = *value,
                _ => anyhow::bail!("{name}: choose posture-shift, follow, wander, noise, lag or hysteresis"),
            }
        }
        let folder = out.join(format!("subject-{subject}-{repetition}"));
        options.write(&folder)?;
        Ok(folder)
    };
    let touch = |repetition| -> anyhow::Result<PathBuf> { Ok(log(Protocol::Touch, repetition)?.join("log.csv")) };
    let labelled = |protocol, repetition| -> anyhow::Result<PathBuf> {
        let folder = log(protocol, repetition)?;
        let [joints, log, training] = ["truth/angles.csv", "log.csv", "training.csv"].map(|name| folder.join(name));
        let inputs = AlignInputs { joints, log, tracks: None };
        let outputs = AlignOutputs::only(training.clone());
        let options = AlignOptions {
            subject: Some(subject.to_string()),
            session: Some("1".to_owned()),
            ..AlignOptions::default()
        };
        align(&inputs, &options, &outputs, &Watch::nobody())?;
        Ok(training)
    };
    Ok(Person {
        name: subject.to_string(),
        touch: [touch(1)?, touch(2)?, touch(3)?],
        touch_random: log(Protocol::TouchRandom, 4)?.join("log.csv"),
        bending: labelled(Protocol::Bending, 5)?,
        bending_random: labelled(Protocol::BendingRandom, 6)?,
    })
}
