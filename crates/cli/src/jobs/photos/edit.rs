//! `lunula edit`: outlines corrected in the browser of this machine.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use clap::Args;
use lunula::job::{Given, Watch};
use lunula::outlines::{EditOptions, Editor, Pressed, edit_steps};
use lunula::photo::PhotoSet;
use lunula_ui::{Editing, Heard, Latest};

use crate::jobs::{JobArgs, Plan, outcome, show};
use crate::ui::PageArgs;
use crate::{Common, Outcome};

/// Correct the outlines of photographs in the browser of this machine: doubtful nails first, by a few keys each
///
/// Prints one line, the address of the page with a secret, and serves until it is interrupted. The page shows one nail
/// at a time, and beside it the normalized picture that `lunula photos` with the same options would make of it. Enter
/// accepts and saves: a LabelMe file beside the photograph, or where photos.csv has it, which the next run uses; what
/// else is in the file stays, and a file that another program has changed meanwhile is not written over. X says that
/// it is no nail. Photographs without a file are searched as `lunula photos` does.
#[derive(Debug, Args)]
pub(crate) struct EditArgs {
    /// Photographs, as for `lunula photos`
    set: PathBuf,
    #[command(flatten)]
    given: Given<EditOptions>,
    #[command(flatten)]
    page: PageArgs,
    #[command(flatten)]
    job: JobArgs,
}

pub(crate) fn run(args: &EditArgs) -> anyhow::Result<Outcome> {
    let common = &args.job.common;
    let stop = common.start()?;
    let options = &args.given.options;
    let set = PhotoSet::open(&args.set, &[])?;
    if args.job.plan {
        let (steps, failed) = edit_steps(&set, options);
        return show(common, "edit", &Plan { steps, failed });
    }
    let state = Latest::new("null");
    let news = state.clone();
    let editor = Editor::new(set, options, Box::new(move |json: &str| news.leave(json)));
    let editor = Arc::new(editor.map_err(anyhow::Error::msg)?);
    let page = Page(Arc::clone(&editor));
    let server = args.page.bind(vec![lunula_ui::edit(Arc::new(page), &state)])?;
    let over = AtomicBool::new(false);
    let served = std::thread::scope(|scope| {
        scope.spawn(|| editor.survey(&over));
        let served = args.page.listening.serve(server, common, &stop);
        over.store(true, Ordering::Relaxed);
        served
    });
    served?;
    let report = editor.report(&Watch { said: &args.given.said, stop: &stop, tick: &|_, _| {} });
    let outcome = outcome(&report.failed);
    common.warn(&report.warnings);
    common.print_json(&report)?;
    say(common, &report);
    Ok(outcome)
}

fn say(common: &Common, report: &lunula::outlines::EditReport) {
    common.say(&format!(
        "{} of {} nails accepted, {} are none; {} keys, {} files of outlines",
        report.accepted,
        report.nails,
        report.rejected,
        report.keys,
        report.saved.len()
    ));
}

struct Page(Arc<Editor>);

impl Editing for Page {
    fn key(&self, json: &[u8]) -> Heard {
        match self.0.key(json) {
            Pressed::Done => Heard::Done,
            Pressed::Late => Heard::Late,
            Pressed::Unknown => Heard::Unknown,
        }
    }

    fn photo(&self) -> Option<Vec<u8>> {
        self.0.photo()
    }

    fn normalized(&self, rough: bool) -> Result<Vec<u8>, String> {
        self.0.normalized(rough)
    }
}
