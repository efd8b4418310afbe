//! The page on a run.

use super::{Count, QualitySummary, RunSummary, StageSummary};
use crate::figure::Page;

/// How many of the things said of a stage stand on the page.
const SHOWN: usize = 20;

pub(super) fn page(run: &RunSummary<'_>) -> String {
    let mut page = Page::new(run.pipeline);
    if !run.about.is_empty() {
        page.paragraph(run.about);
    }
    let elsewhere = if run.elsewhere > 0 { format!(", {} in other parts", run.elsewhere) } else { String::new() };
    page.paragraph(&format!(
        "{} tasks done, {} stood, {} failed, {} not done{elsewhere}; {} on {} threads{}.",
        run.done,
        run.kept,
        run.failed,
        run.not_done,
        seconds(run.wall_s),
        run.threads,
        if run.stopped { "; stopped from outside" } else { "" }
    ));
    if !run.failures.is_empty() {
        page.heading("What failed");
        let rows: Vec<Vec<String>> = run.failures.iter().map(|f| vec![f.task.clone(), f.what.clone()]).collect();
        page.table(&["task", "why"], &rows, |_| true);
    }
    page.heading("Stages");
    page.paragraph(
        "Time is summed over tasks, as it was when they were done; the error is the middle one of all \
                    tasks, with the least and the greatest.",
    );
    let rows: Vec<Vec<String>> = run.stages.iter().map(row).collect();
    let header = [
        "stage",
        "job",
        "done",
        "stood",
        "failed",
        "time",
        "share",
        "error where truth is known",
        "as the job itself states",
    ];
    page.table(&header, &rows, |at| run.stages[at].failed > 0 || !run.stages[at].failed_inputs.is_empty());
    for stage in &run.stages {
        said(&mut page, stage);
    }
    if !run.warnings.is_empty() {
        page.heading("Warnings");
        page.list(&run.warnings);
    }
    if !run.strays.is_empty() {
        page.heading("Results of an earlier pipeline");
        page.paragraph("This pipeline has no such tasks; what they made was left as it stood.");
        page.list(run.strays);
    }
    page.finish()
}

fn row(stage: &StageSummary) -> Vec<String> {
    let quality = |truth: bool| -> String {
        let of: Vec<String> = stage.quality.iter().filter(|one| one.against_truth == truth).map(shown).collect();
        of.join("; ")
    };
    let number = |count: usize| if count > 0 { count.to_string() } else { String::new() };
    let nothing = stage.done + stage.kept + stage.failed == 0;
    vec![
        stage.stage.clone(),
        stage.job.clone(),
        if nothing { "left out".to_owned() } else { number(stage.done) },
        number(stage.kept),
        number(stage.failed),
        if nothing { String::new() } else { seconds(stage.task_s) },
        if nothing { String::new() } else { format!("{:.1} %", 100.0 * stage.share) },
        quality(true),
        quality(false),
    ]
}

fn shown(one: &QualitySummary) -> String {
    let range =
        if one.tasks > 1 { format!(" ({} to {})", digits(one.least), digits(one.greatest)) } else { String::new() };
    format!("{} {}{range} {}", one.what, digits(one.median), one.unit)
}

/// What was left out of a stage, what its jobs warn of.
fn said(page: &mut Page, stage: &StageSummary) {
    let lists = [
        ("left out", &stage.left_out),
        ("warnings", &stage.warnings),
        ("inputs that gave nothing", &stage.failed_inputs),
    ];
    for (what, counts) in lists {
        if counts.is_empty() {
            continue;
        }
        page.heading(&format!("{}: {what}", stage.stage));
        let mut lines: Vec<String> = counts.iter().take(SHOWN).map(line).collect();
        if counts.len() > SHOWN {
            lines.push(format!("and {} more, in run.json", counts.len() - SHOWN));
        }
        page.list(&lines);
    }
}

fn line(count: &Count) -> String {
    if count.count > 1 { format!("{} ({} times)", count.what, count.count) } else { count.what.clone() }
}

fn seconds(s: f64) -> String {
    match s {
        s if s < 0.1 => format!("{:.1} ms", 1000.0 * s),
        s if s < 100.0 => format!("{s:.2} s"),
        s => format!("{:.1} min", s / 60.0),
    }
}

/// Three digits.
fn digits(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 {
        "0".to_owned()
    } else if (1e-3..1e4).contains(&size) {
        let decimals = (2 - size.log10().floor() as i32).max(0) as usize;
        format!("{value:.decimals$}")
    } else {
        format!("{value:.2e}")
    }
}
