//! What a session does of all that it can: its plan, and what its report says was left out.

use std::path::Path;

use crate::live::options::{LiveOptions, SessionFiles, StreamOptions};
use crate::stages::Step;

/// What `lunula record` does.
#[must_use]
pub fn record_steps(options: &StreamOptions, files: &SessionFiles) -> Vec<Step> {
    let predict = Step::new("predict", false, "`lunula live` does".to_owned());
    [reads(options), vec![records(files), predict]].concat()
}

/// What `lunula live` and `lunula mouse` do.
#[must_use]
pub fn live_steps(options: &LiveOptions, files: &SessionFiles) -> Vec<Step> {
    let path = |path: &Path| path.display().to_string();
    let mut steps = reads(&options.stream);
    steps.push(Step::new("predict", true, format!("{} models", files.models.len())));
    steps.push(Step::new("gate", files.models.len() > 1, "where one model predicts forces and one posture".to_owned()));
    match &files.mouse {
        Some(mouse) => {
            let how = if mouse.uinput { "a mouse of this computer" } else { "events only" };
            steps.push(Step::new("pointer", true, how.to_owned()));
        }
        None => {
            let switches = files.switches.iter().map(|switch| path(&switch.what)).collect::<Vec<_>>().join(", ");
            let reason = if switches.is_empty() { "no --switch".to_owned() } else { switches };
            steps.push(Step::new("switch", !files.switches.is_empty(), reason));
        }
    }
    steps.push(records(files));
    let tcp = options.tcp.map_or("no --tcp".to_owned(), |address| address.to_string());
    steps.push(Step::new("serve", options.tcp.is_some(), tcp));
    let lsl = options.lsl.clone().unwrap_or("no --lsl".to_owned());
    steps.push(Step::new("lsl", options.lsl.is_some(), lsl));
    let page = if options.serve { "the last seconds, ten pictures a second" } else { "no --serve" };
    steps.push(Step::new("page", options.serve, page.to_owned()));
    steps
}

fn reads(options: &StreamOptions) -> Vec<Step> {
    let sources = |sources: &[_]| sources.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
    let forces = if options.force.is_empty() { "no --force".to_owned() } else { sources(&options.force) };
    vec![Step::new("read", true, sources(&options.source)), Step::new("join forces", !options.force.is_empty(), forces)]
}

fn records(files: &SessionFiles) -> Step {
    let out = files.out.as_ref().map_or("no --out".to_owned(), |out| out.display().to_string());
    Step::new("record", files.out.is_some(), out)
}
