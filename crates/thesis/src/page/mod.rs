//! The study's page: every data figure of the thesis with its counterpart, and every statement of its text beside what
//! came out.
//!
//! In: folders of results, each of a [`Part`]; several of a part are of several subjects, and the first is shown. Out,
//! in a folder: `study.html`, self-contained but for links to `tables/`, copies of the parts' tables; `statements.csv`;
//! `numbers.json`, all numbers that statements are judged by. What is missing is said in its place. Nothing in these
//! files depends on where or when they were made.

mod figures;
mod kind;
mod parts;
#[cfg(test)]
mod tests;

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use serde::Serialize;

use super::Numbers;
use super::statements::{Judged, Verdict, judge};
use figures::{SECTIONS, Section};
pub(crate) use kind::StudyJob;
use lunula::figure::Page;
use lunula::files::Staging;
use lunula::job::{Report, Watch};
use lunula::stages::Stages;
use lunula::table::{Column, TableWriter, Value};
pub use parts::Part;

/// A folder of results.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PartFolder {
    /// Which part.
    pub part: Part,
    /// The folder.
    pub folder: PathBuf,
    /// Whose it is; empty where it is of all.
    pub subject: String,
}

/// The page's title, and whose results it shows.
#[derive(Debug, Clone, PartialEq, Eq, Args)]
pub struct PageOptions {
    /// The page's title
    #[arg(long, default_value = "The thesis' figures, and what it states of them")]
    pub title: String,
    /// The recordings are generated; the page says so
    #[arg(long)]
    pub phantom: bool,
    /// Whose results are shown where a part has several subjects' [default: the first one's]
    #[arg(long)]
    pub subject: Option<String>,
}

/// What came out.
pub type PageReport = Report<PageFigures>;

/// The figures of a run.
#[derive(Debug, Clone, Serialize)]
pub struct PageFigures {
    /// Figures that have a counterpart.
    pub figures: usize,
    /// Figures that have none, and why.
    pub figures_lacking: Vec<String>,
    /// Statements that agree.
    pub agree: usize,
    /// Statements that do not.
    pub do_not: usize,
    /// Statements that can't be judged.
    pub cannot_tell: usize,
}

/// Writes the page into `out`.
///
/// # Errors
/// Where a file can't be read or written.
pub fn study_page(
    folders: &[PartFolder],
    options: &PageOptions,
    out: &Path,
    watch: &Watch<'_>,
) -> anyhow::Result<PageReport> {
    let start = Instant::now();
    let subject = options.subject.as_deref().unwrap_or_default();
    let shown: Vec<&PartFolder> = Part::ALL.iter().filter_map(|part| chosen(folders, *part, subject)).collect();
    let mut warnings = Vec::new();
    let mut numbers = Numbers::default();
    for one in &shown {
        match one.part.numbers(&one.folder) {
            Ok(own) => numbers.take(one.part.name(), &own),
            // The page is the same wherever it is brought: no folder of this machine is in it.
            Err(why) => {
                let within = format!("{}/", one.folder.display());
                warnings.push(format!("{}: {}", one.part.name(), format!("{why:#}").replace(&within, "")));
            }
        }
    }
    over_validation(&mut numbers);
    let judged = judge(&numbers);
    let staging = Staging::new(out)?;
    let mut page = Page::new(&options.title);
    introduce(&mut page, options, &judged);
    let (mut figures, mut lacking) = (0, Vec::new());
    for section in SECTIONS {
        page.anchored_heading(section.name, section.title);
        statements_of(&mut page, &own(section, &judged));
        for figure in section.figures {
            let number = format!("Fig. {}", figure.number);
            let found = shown.iter().find(|one| one.part == figure.part);
            let Some(found) = found else {
                lacking.push(format!("{number}: there are no results of \"{}\"", figure.part.name()));
                continue;
            };
            let Ok(png) = fs::read(found.folder.join(format!("{}.png", figure.picture))) else {
                lacking.push(format!("{number}: \"{}\" has no such picture", figure.part.name()));
                continue;
            };
            let whose = match found.subject.as_str() {
                "" => String::new(),
                subject => format!(" Subject {subject}."),
            };
            page.figure(&png, &number, &format!("{}{whose}", figure.caption));
            figures += 1;
        }
    }
    if !lacking.is_empty() {
        page.anchored_heading("lacking", "Figures that are left out");
        page.list(&lacking);
    }
    if !warnings.is_empty() {
        page.anchored_heading("warnings", "To be known");
        page.list(&warnings);
    }
    watch.go_on()?;
    tables(&mut page, &shown, &staging)?;
    staging.write("study.html", page.finish().as_bytes())?;
    staging.write("numbers.json", numbers.to_text().as_bytes())?;
    statements_table(&judged, &staging, out)?;
    staging.commit()?;
    let count = |word: &str| judged.iter().filter(|one| one.verdict.word() == word).count();
    let figures = PageFigures {
        figures,
        figures_lacking: lacking.clone(),
        agree: count(Verdict::Agrees.word()),
        do_not: count(Verdict::DoesNot.word()),
        cannot_tell: judged.iter().filter(|one| matches!(one.verdict, Verdict::CannotTell(_))).count(),
    };
    let report = Report { left_out: lacking, warnings, ..Report::new("study", watch, figures) };
    Ok(report.timed(&Stages::default(), start))
}

/// The folder of a part that is shown: the named subject's, else the first's.
fn chosen<'a>(folders: &'a [PartFolder], part: Part, subject: &str) -> Option<&'a PartFolder> {
    let own = || folders.iter().filter(move |one| one.part == part);
    own().find(|one| !subject.is_empty() && one.subject == subject).or_else(|| own().min_by_key(|one| &one.subject))
}

/// How much worse the touch model is at random touching than in validation.
fn over_validation(numbers: &mut Numbers) {
    for target in ["Fx_N", "Fy_N", "Fz_N"] {
        let get = |part: Part| numbers.get(&format!("{}.{target}.rmse", part.name()));
        let ratio = get(Part::TouchTest).zip(get(Part::TouchValidation)).map(|(test, validation)| test / validation);
        numbers.set(format!("touch_test.{target}.over_validation"), ratio);
    }
}

/// The statements of a section.
fn own<'a>(section: &Section, judged: &'a [Judged]) -> Vec<&'a Judged> {
    let within = |one: &&Judged| section.of.iter().any(|beginning| one.statement.section.starts_with(beginning));
    judged.iter().filter(within).collect()
}

/// How many agree, do not, can't be judged.
fn counts(judged: &[&Judged]) -> [usize; 3] {
    let of = |holds: fn(&Verdict) -> bool| judged.iter().filter(|one| holds(&one.verdict)).count();
    [
        of(|verdict| *verdict == Verdict::Agrees),
        of(|verdict| *verdict == Verdict::DoesNot),
        of(|verdict| matches!(verdict, Verdict::CannotTell(_))),
    ]
}

fn introduce(page: &mut Page, options: &PageOptions, judged: &[Judged]) {
    if options.phantom {
        page.paragraph(
            "A phantom is no people. Every recording behind this page was generated: photographs, videos and logs of \
             formulae whose sizes were assumed after the thesis' words. That a statement agrees says that its \
             explanation is sufficient, or just that the formula was made after it; that it does not says that the \
             thesis' figure needs something that the phantom lacks, or has in another size. Absolute errors are the \
             assumptions' and forecast nothing for a sensor on a finger.",
        );
    }
    page.paragraph(
        "Each figure below is the counterpart of the thesis' figure of the same number. Each table sets what the \
         thesis' text states beside what came out here; what was taken for \"little\", \"about\" or \"comparable\" \
         stands with it, and nothing but the numbers decides the verdict.",
    );
    let all: Vec<&Judged> = judged.iter().collect();
    let mut rows: Vec<Vec<String>> = SECTIONS
        .iter()
        .map(|section| (section.title.to_owned(), counts(&own(section, judged))))
        .map(|(title, counts)| std::iter::once(title).chain(counts.map(|count| count.to_string())).collect())
        .collect();
    let sums = counts(&all).map(|count| count.to_string());
    rows.push(std::iter::once(format!("all {} statements", all.len())).chain(sums).collect());
    page.table(&["section", "agree", "do not", "can't be judged"], &rows, |_| false);
    let to = |name: &str, words: &str| (format!("#{name}"), words.to_owned());
    let mut links: Vec<(String, String)> = SECTIONS.iter().map(|section| to(section.name, section.title)).collect();
    links.push(to("tables", "Tables"));
    page.links("", &links);
}

/// Statements of a section as a table; those that do not agree stand out.
fn statements_of(page: &mut Page, judged: &[&Judged]) {
    let rows: Vec<Vec<String>> = judged
        .iter()
        .map(|one| {
            let figure = one.statement.figure;
            let found = match &one.verdict {
                Verdict::CannotTell(why) if one.found.is_empty() => why.clone(),
                Verdict::CannotTell(why) => format!("{} ({why})", one.found),
                _ => one.found.clone(),
            };
            let place = if figure.is_empty() { one.statement.section.to_owned() } else { format!("Fig. {figure}") };
            vec![
                place,
                one.statement.says.to_owned(),
                one.statement.stated.to_owned(),
                found,
                one.verdict.word().to_owned(),
            ]
        })
        .collect();
    let [agree, do_not, cannot] = counts(judged);
    page.paragraph(&format!(
        "Of {} statements {agree} agree, {do_not} do not, {cannot} can't be judged.",
        judged.len()
    ));
    page.table(&["figure", "the thesis says", "stated", "here", "verdict"], &rows, |row| {
        judged[row].verdict == Verdict::DoesNot
    });
}

/// Copies the parts' tables and links to them.
fn tables(page: &mut Page, shown: &[&PartFolder], staging: &Staging) -> anyhow::Result<()> {
    let mut links = vec![
        ("statements.csv".to_owned(), "all statements".to_owned()),
        ("numbers.json".to_owned(), "all numbers".to_owned()),
    ];
    for one in shown {
        for table in one.part.tables() {
            let Ok(bytes) = fs::read(one.folder.join(table)) else { continue };
            let name = format!("tables/{}-{table}", one.part.name());
            staging.write(&name, &bytes)?;
            links.push((name, format!("{} {table}", one.part.name().replace('_', " "))));
        }
    }
    page.anchored_heading("tables", "Tables");
    page.links("", &links);
    Ok(())
}

fn statements_table(judged: &[Judged], staging: &Staging, out: &Path) -> anyhow::Result<()> {
    let name = "statements.csv";
    let columns = ["id", "section", "figure", "says", "stated", "test", "found", "verdict", "why"].map(Column::text);
    let mut table = TableWriter::create(&staging.place(name)?, &out.join(name), columns.to_vec(), &[])?;
    for one in judged {
        let statement = one.statement;
        let why = match &one.verdict {
            Verdict::CannotTell(why) => why.as_str(),
            _ => "",
        };
        let test = statement.test.words();
        let texts = [
            statement.id,
            statement.section,
            statement.figure,
            statement.says,
            statement.stated,
            &test,
            &one.found,
            one.verdict.word(),
            why,
        ];
        table.write(&texts.map(Value::Text))?;
    }
    table.finish()?;
    Ok(())
}
