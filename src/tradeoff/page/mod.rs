//! What is written: a job's table and picture, and one page of all jobs.

pub(in crate::tradeoff) mod curves;
pub(in crate::tradeoff) mod solvers;
use std::fmt::Display;
use std::path::Path;

use super::choices::choices;
use super::hemodynamics;
use super::judge::{Figures, Tradeoff, Verdict};
use crate::figure::{Page, draw_log_log};
use crate::files::Staging;
use crate::tradeoff::judge::knee::{BEND, SAME};
use crate::tradeoff::measure::rows::{Row, write_table};
use crate::tradeoff::measure::timing::Effort;
use curves::{PANEL_PX, panels};
use solvers::solver_panels;

/// Under what circumstances was measured.
#[derive(Debug, Clone)]
pub struct Setting {
    /// Seed of the synthetic scenes.
    pub seed: u64,
    /// How much.
    pub effort: Effort,
    /// Tables of other programs' figures, as the user named them.
    pub tables: Vec<String>,
}

impl Tradeoff {
    /// Writes `tradeoff.csv`, `tradeoff.png` and `tradeoff.svg`.
    ///
    /// # Errors
    /// Where a file can't be written, or there is nothing to draw.
    pub fn write(&self, out: &Path) -> anyhow::Result<()> {
        let staging = Staging::new(out)?;
        write_table(&self.rows.iter().collect::<Vec<_>>(), &staging)?;
        self.draw("tradeoff", &staging)?;
        staging.commit()?;
        Ok(())
    }

    /// Its picture: the curves as `name`.
    fn draw(&self, name: &str, staging: &Staging) -> anyhow::Result<()> {
        let [png, svg] = ["png", "svg"].map(|ending| staging.place(&format!("{name}.{ending}")));
        let solvers = self.job == hemodynamics::SOLVING.0;
        let panels = if solvers { solver_panels(self) } else { panels(self) };
        draw_log_log(&panels, panels.len().min(2), PANEL_PX.0, &png?, &svg?)
    }
}

/// Writes all jobs' curves: `index.html`, `tradeoff.csv`, `<job>.png` and `.svg`. `failed`: jobs without curves,
/// and why.
///
/// # Errors
/// Where a file can't be written.
pub fn index(done: &[Tradeoff], failed: &[(&str, String)], setting: &Setting, out: &Path) -> anyhow::Result<()> {
    let staging = Staging::new(out)?;
    write_table(&done.iter().flat_map(|job| &job.rows).collect::<Vec<_>>(), &staging)?;
    for job in done {
        job.draw(job.job, &staging)?;
    }
    let read = |name: String| staging.read(&name);
    let mut page = Page::new("Error against run time");
    introduce(&mut page, setting);
    page.heading("Knees and defaults");
    let curves: Vec<&Verdict> = done.iter().flat_map(|job| &job.curves).collect();
    let header = ["job", "what is chosen", "error", "knee", "default", "the default is", "best other program"];
    let rows: Vec<Vec<String>> = curves.iter().map(|curve| summary(curve)).collect();
    page.table(&header, &rows, |at| curves[at].decides && curves[at].default_is != "the knee");
    page.paragraph(
        "Marked: the default is not the knee of the error that decides. Why it is the default stands with each job.",
    );
    for (job, why) in failed {
        page.heading(job);
        page.paragraph(&format!("Not measured: {why}"));
    }
    for job in done {
        page.heading(job.job);
        page.png(&read(format!("{}.png", job.job))?, &format!("error against run time of {}", job.job));
        page.list(&reasons(job.job));
        page.paragraph("Other programs:");
        page.list(
            &job.peers
                .iter()
                .map(|peer| format!("{}{}: {}", if peer.measured { "" } else { "Not on it: " }, peer.peer, peer.what))
                .collect::<Vec<_>>(),
        );
        if !job.refused.is_empty() {
            page.paragraph("Without an answer:");
            page.list(&job.refused);
        }
        let header = ["what is chosen", "setting", "error", "its unit", "seconds", "quartiles", "repeats", "work", ""];
        page.table(&header, &job.rows.iter().map(line).collect::<Vec<_>>(), |at| {
            job.rows[at].knee || job.rows[at].default
        });
    }
    let wall_s: f64 = done.iter().map(|job| job.wall_s).sum();
    page.paragraph(&format!("lunula {}; measuring took {wall_s:.0} s.", env!("CARGO_PKG_VERSION")));
    staging.write("index.html", page.finish().as_bytes())?;
    staging.commit()?;
    Ok(())
}

fn introduce(page: &mut Page, setting: &Setting) {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let Effort { repeats, quick, .. } = setting.effort;
    page.paragraph(&format!(
        "Each job over its settings on generated scenes whose truth is known (seed {}{}). Seconds are of one thread, \
         an input, of the stage alone that a setting changes: the median of {repeats} repeats in turns, with \
         quartiles; hemodynamics three times as many. Measured on {} with {cores} cores, {}; compare ratios, not \
         seconds, between machines.",
        setting.seed,
        if quick { ", small scenes and fewer settings" } else { "" },
        std::env::consts::ARCH,
        std::env::consts::OS,
    ));
    page.paragraph(&format!(
        "Ring: the knee, beyond which more time buys little. Of the settings that are worth their time (grey line; \
         what differs by less than {:.0} % or lies within the spread of the times is the same), it is the one farthest \
         below the chord between their ends, both axes logarithmic and brought to a unit square (Satopaa et al. 2011, \
         doi:10.1109/ICDCSW.2011.20), by {BEND} at least; without such a bend the most exact one if the error falls as \
         many times as the time grows, else the cheapest. Square: the default. Empty dots: other programs.",
        100.0 * SAME
    ));
    if !setting.tables.is_empty() {
        page.paragraph(&format!("Figures of other programs were also taken from {}.", setting.tables.join(", ")));
    }
}

/// Why a job's defaults are its defaults.
fn reasons(job: &str) -> Vec<String> {
    let own = choices().into_iter().filter(|choice| choice.job == job);
    own.map(|choice| format!("{} ({}): the default is {}. {}", choice.name, choice.option, choice.default, choice.why))
        .collect()
}

fn summary(curve: &Verdict) -> Vec<String> {
    let shown = |shown: &Option<Figures>| shown.as_ref().map_or("none".to_owned(), |shown| shown.to_string());
    let knee = if curve.knee.is_some() { format!("{} ({})", shown(&curve.knee), curve.knee_why) } else { shown(&None) };
    let name = |what: &str| what.to_owned();
    let unit = if curve.decides { format!("{} (decides)", curve.error_unit) } else { curve.error_unit.clone() };
    vec![
        name(curve.job),
        name(curve.choice),
        unit,
        knee,
        shown(&curve.default),
        curve.default_is.clone(),
        shown(&curve.peer),
    ]
}

fn line(row: &Row) -> Vec<String> {
    let marks = [(row.knee, "knee"), (row.default, "default"), (row.peer, "other program")];
    let marks: Vec<&str> = marks.into_iter().filter_map(|(is, name)| is.then_some(name)).collect();
    vec![
        row.choice.to_owned(),
        row.setting.clone(),
        number(row.error),
        row.error_unit.clone(),
        number(row.run_s),
        format!("{} to {}", number(row.run_low_s), number(row.run_high_s)),
        if row.repeats == 0 { String::new() } else { row.repeats.to_string() },
        row.work.to_string(),
        marks.join(", "),
    ]
}

/// Three digits.
fn number(value: f64) -> String {
    if !value.is_finite() {
        return String::new();
    }
    let size = value.abs();
    if size != 0.0 && !(1e-3..1e5).contains(&size) { format!("{value:.1e}") } else { short(value) }
}

fn short(value: f64) -> String {
    let digits = if value == 0.0 { 0 } else { (2 - value.abs().log10().floor() as i32).clamp(0, 6) };
    format!("{value:.0$}", digits as usize)
}

impl Display for Figures {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: {}, {}", self.setting, number(self.error), time(self.run_s))
    }
}

/// With a unit that suits it.
fn time(seconds: f64) -> String {
    match seconds {
        s if s < 1e-6 => format!("{} ns", short(1e9 * s)),
        s if s < 1e-3 => format!("{} us", short(1e6 * s)),
        s if s < 1.0 => format!("{} ms", short(1e3 * s)),
        s => format!("{} s", short(s)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tradeoff::judge::tests::judged_by_default;
    use crate::tradeoff::peers::PeerReport;

    #[test]
    fn numbers_and_times_are_short() {
        assert_eq!([0.012345, 123.456, 2.5e-7, 0.0, 3e7].map(number), ["0.0123", "123", "2.5e-7", "0", "3.0e7"]);
        assert_eq!([2.9e-8, 6.9e-5, 0.0123, 2.0].map(time), ["29.0 ns", "69.0 us", "12.3 ms", "2.00 s"]);
    }

    #[test]
    fn the_page_has_every_job_its_knees_and_what_is_missing() {
        let mut job = judged_by_default(None);
        job.peers.push(PeerReport { peer: "Other".into(), measured: false, what: "of another scene".into() });
        job.refused.push("c: no answer".into());
        let folder = tempfile::tempdir().unwrap();
        let setting =
            Setting { seed: 7, effort: Effort { repeats: 2, ..Effort::default() }, tables: vec!["mine.csv".into()] };
        index(&[job], &[("posture", "no video".into())], &setting, folder.path()).unwrap();
        let page = std::fs::read_to_string(folder.path().join("index.html")).unwrap();
        for words in [
            "seed 7",
            "mine.csv",
            "b: 0.500, 1.50 s",
            "beyond the knee: 20.00 times its time",
            "Not on it: Other: of another scene",
            "c: no answer",
            "Not measured: no video",
            "data:image/png;base64,",
        ] {
            assert!(page.contains(words), "`{words}` is not on the page");
        }
        let table = std::fs::read_to_string(folder.path().join("tradeoff.csv")).unwrap();
        let lines: Vec<&str> = table.lines().collect();
        assert!(
            lines[0].starts_with("job,setting,error,error_unit,run_s,work") && lines[0].ends_with("knee,default,peer")
        );
        assert_eq!(lines.len(), 4);
        assert!(lines[2].ends_with("true,false,false") && lines[3].ends_with("false,true,false"), "{table}");
    }
}
