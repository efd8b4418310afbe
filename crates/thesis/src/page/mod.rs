//! The study's page: every data figure of the thesis with its counterpart, and every statement of its text beside what
//! came out.
//!
//! In: folders of results, each of a [`Part`]; several of a part are of several subjects, and the first is shown. Out,
//! in a folder: `study.html`, self-contained but for links to `tables/`, copies of the parts' tables; `statements.csv`;
//! `numbers.json`, all numbers of the parts, those that statements are judged by among them. What is missing is said in
//! its place. Nothing in these files depends on where or when they were made.
//!
//! Of a phantom, each statement is shown with its [`Kind`], and agreement is counted by it: what was put in is no
//! evidence. Of people's recordings kinds mean nothing and are left out.

mod colours;
mod figures;
mod kind;
mod parts;
#[cfg(test)]
mod tests;

use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;

use super::Numbers;
use super::statements::{Judged, Kind, Quantity, Statement, Statements, Verdict};
use colours::colour_numbers;
use figures::{SECTIONS, Section};
use lunula::figure::Page;
use lunula::files::Staging;
use lunula::job::{Report, Watch};
use lunula::stages::Stages;
use lunula::table::{Column, TableWriter, Value};
use lunula::words::Words as _;
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
    /// Of a phantom: where agreement comes from.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub by_kind: Vec<KindFigures>,
}

/// How many statements of a kind agree.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct KindFigures {
    /// The kind.
    pub kind: Kind,
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
    let stages = Stages::default();
    let subject = options.subject.as_deref().unwrap_or_default();
    let shown: Vec<&PartFolder> = Part::all().filter_map(|part| chosen(folders, part, subject)).collect();
    let mut warnings = Vec::new();
    let mut numbers = Numbers::default();
    for one in &shown {
        match one.part.numbers(&one.folder) {
            Ok(own) => numbers.take(one.part.word(), &own),
            // The page is the same wherever it is brought: no folder of this machine is in it.
            Err(why) => {
                let within = format!("{}/", one.folder.display());
                warnings.push(format!("{}: {}", one.part.word(), format!("{why:#}").replace(&within, "")));
            }
        }
    }
    let colours = colour_numbers(&numbers);
    numbers.take("colours", &colours);
    let statements = Statements::of_the_thesis()?;
    let judged = statements.judge(&numbers);
    let by_kind = if options.phantom { by_kind(&judged) } else { Vec::new() };
    let staging = Staging::new(out)?;
    let mut page = Page::new(&options.title);
    introduce(&mut page, &judged, &by_kind);
    let (mut figures, mut lacking) = (0, Vec::new());
    for section in SECTIONS {
        page.anchored_heading(section.name, section.title);
        statements_of(&mut page, &own(section, &judged), options.phantom);
        for figure in section.figures {
            let number = figure.label();
            let found = shown.iter().find(|one| one.part == figure.part);
            let Some(found) = found else {
                lacking.push(format!("{number}: there are no results of \"{}\"", figure.part.word()));
                continue;
            };
            let Ok(png) = fs::read(found.folder.join(format!("{}.png", figure.picture))) else {
                lacking.push(format!("{number}: \"{}\" has no such picture", figure.part.word()));
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
    quantities(&mut page, &statements);
    tables(&mut page, &shown, &staging)?;
    staging.write("study.html", page.finish().as_bytes())?;
    staging.write("numbers.json", numbers.to_text().as_bytes())?;
    statements_table(&judged, options.phantom, &staging, out)?;
    staging.commit()?;
    let [agree, do_not, cannot_tell] = counts(judged.iter());
    let figures = PageFigures { figures, figures_lacking: lacking.clone(), agree, do_not, cannot_tell, by_kind };
    let report = Report { left_out: lacking, warnings, ..Report::new("study", watch, figures) };
    Ok(report.timed(&stages))
}

/// The folder of a part that is shown: the named subject's, else the first's.
fn chosen<'a>(folders: &'a [PartFolder], part: Part, subject: &str) -> Option<&'a PartFolder> {
    let own = || folders.iter().filter(move |one| one.part == part);
    own().find(|one| !subject.is_empty() && one.subject == subject).or_else(|| own().min_by_key(|one| &one.subject))
}

/// The statements of a section.
fn own<'a, 'b>(section: &Section, judged: &'a [Judged<'b>]) -> Vec<&'a Judged<'b>> {
    let within = |one: &&Judged<'_>| section.of.iter().any(|beginning| one.statement.section.starts_with(beginning));
    judged.iter().filter(within).collect()
}

/// How many agree, do not, can't be judged.
fn counts<'a, 'b: 'a>(judged: impl Iterator<Item = &'a Judged<'b>>) -> [usize; 3] {
    judged.fold([0; 3], |mut counts, one| {
        counts[match one.verdict {
            Verdict::Agrees => 0,
            Verdict::DoesNot => 1,
            Verdict::CannotTell(_) => 2,
        }] += 1;
        counts
    })
}

fn by_kind(judged: &[Judged<'_>]) -> Vec<KindFigures> {
    let of = |kind: Kind| {
        let [agree, do_not, cannot_tell] = counts(judged.iter().filter(|one| one.statement.kind == kind));
        KindFigures { kind, agree, do_not, cannot_tell }
    };
    Kind::ALL.map(of).into()
}

/// Whose the results are, how many statements agree, by section and of a phantom by kind.
fn introduce(page: &mut Page, judged: &[Judged<'_>], by_kind: &[KindFigures]) {
    if !by_kind.is_empty() {
        let share =
            |one: &KindFigures| format!("{} {} of {}", one.kind, one.agree, one.agree + one.do_not + one.cannot_tell);
        let shares: Vec<String> = by_kind.iter().map(share).collect();
        page.paragraph(&format!(
            "A phantom is no people. Every recording behind this page was generated: photographs, videos and logs of \
             formulae whose sizes were assumed after the thesis' words. What agreement is worth depends on the \
             statement's kind: \"put in\", the phantom was made after this very sentence, and agreement is no \
             evidence; \"follows\", it is a consequence of the thesis' model or of how models are trained, whatever \
             sizes were assumed; \"emerges\", nobody set it and it could have come out otherwise. Agree: {}. That a \
             statement does not agree says that the thesis' figure needs something that the phantom lacks, or has in \
             another size. Absolute errors are the assumptions' and forecast nothing for a sensor on a finger.",
            shares.join(", ")
        ));
    }
    page.paragraph(
        "Each figure below is the counterpart of the thesis' figure of the same number; those without a number are not \
         in the thesis. Each table sets what its text states beside the test that decides and what came out here; \
         quantities are explained at the end.",
    );
    let row = |title: String, counts: [usize; 3]| -> Vec<String> {
        std::iter::once(title).chain(counts.map(|count| count.to_string())).collect()
    };
    let sections =
        SECTIONS.iter().map(|section| row(section.title.to_owned(), counts(own(section, judged).into_iter())));
    let all = row(format!("all {} statements", judged.len()), counts(judged.iter()));
    let kinds =
        by_kind.iter().map(|one| row(format!("of these: {}", one.kind), [one.agree, one.do_not, one.cannot_tell]));
    let rows: Vec<Vec<String>> = sections.chain([all]).chain(kinds).collect();
    page.table(&["statements", "agree", "do not", "can't be judged"], &rows, |_| false);
    let to = |name: &str, words: &str| (format!("#{name}"), words.to_owned());
    let mut links: Vec<(String, String)> = SECTIONS.iter().map(|section| to(section.name, section.title)).collect();
    links.extend([to("quantities", "Quantities"), to("tables", "Tables")]);
    page.links("", &links);
}

/// Statements of a section as a table; those that do not agree stand out.
fn statements_of(page: &mut Page, judged: &[&Judged<'_>], phantom: bool) {
    let row = |one: &&Judged<'_>| {
        let statement = one.statement;
        let found = match &one.verdict {
            Verdict::CannotTell(why) if one.found.is_empty() => why.clone(),
            Verdict::CannotTell(why) => format!("{} ({why})", one.found),
            _ => one.found.clone(),
        };
        let place = match statement.figure.as_str() {
            "" => statement.section.clone(),
            figure => format!("Fig. {figure}"),
        };
        let mut cells = vec![place, statement.sentence.clone(), statement.test.clone(), found];
        if phantom {
            cells.extend([statement.kind.to_string(), statement.note.clone()]);
        }
        cells.push(one.verdict.word().to_owned());
        cells
    };
    let rows: Vec<Vec<String>> = judged.iter().map(row).collect();
    let [agree, do_not, cannot] = counts(judged.iter().copied());
    page.paragraph(&format!(
        "Of {} statements {agree} agree, {do_not} do not, {cannot} can't be judged.",
        judged.len()
    ));
    let mut header = vec!["figure", "the thesis says", "test", "here"];
    if phantom {
        header.extend(["kind", "note"]);
    }
    header.push("verdict");
    page.table(&header, &rows, |row| judged[row].verdict == Verdict::DoesNot);
}

/// What each quantity means.
fn quantities(page: &mut Page, statements: &Statements) {
    let row = |one: &Quantity| vec![one.name.clone(), one.unit.clone(), one.means.clone(), one.from.clone()];
    let rows: Vec<Vec<String>> = statements.quantities.iter().map(row).collect();
    page.anchored_heading("quantities", "Quantities");
    page.table(&["quantity", "unit", "what it is", "computed by"], &rows, |_| false);
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
            let name = format!("tables/{}-{table}", one.part.word());
            staging.write(&name, &bytes)?;
            links.push((name, format!("{} {table}", one.part.word().replace('_', " "))));
        }
    }
    page.anchored_heading("tables", "Tables");
    page.links("", &links);
    Ok(())
}

fn statements_table(judged: &[Judged<'_>], phantom: bool, staging: &Staging, out: &Path) -> anyhow::Result<()> {
    let name = "statements.csv";
    let mut columns = vec!["id", "section", "figure", "sentence", "test", "found", "verdict", "why"];
    if phantom {
        columns.extend(["kind", "note"]);
    }
    let columns = columns.into_iter().map(Column::text).collect();
    let mut table = TableWriter::create(&staging.place(name)?, &out.join(name), columns, &[])?;
    for Judged { statement, found, verdict } in judged {
        let why = if let Verdict::CannotTell(why) = verdict { why } else { "" };
        let Statement { id, section, figure, sentence, test, kind, note, .. } = statement;
        let kind = kind.to_string();
        let mut texts = vec![id, section, figure, sentence, test, found, verdict.word(), why];
        if phantom {
            texts.extend([kind.as_str(), note]);
        }
        table.write(&texts.into_iter().map(Value::Text).collect::<Vec<_>>())?;
    }
    table.finish()?;
    Ok(())
}
