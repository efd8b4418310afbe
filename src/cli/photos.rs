//! `lunula photos`: photographs to coloration maps, and `lunula photos merge`.

use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::{Args, Subcommand};
use lunula::photo::outline::SavedOutlines;
use lunula::photo::{
    MergeError, OutlineHome, Outputs, PhotoSet, PhotosError, PhotosOptions, PhotosReport, Results, SetFault, Watch,
    merge, plan, run as run_photos,
};
use lunula::stages::Step;
use lunula::words::{shown, shown_lines};

use super::{Common, Interrupted, Outcome, print_line, print_steps};

/// Photographs of nails to coloration maps: outlines, normalized pictures, mean and standard deviation over subjects
///
/// SET is a folder SET/<pose>/<subject>.<png|jpg|tif|bmp>, a flat folder (one pose), or holds photos.csv with the
/// columns file,subject,pose and optionally outline. The outline of a nail comes from the first of: that column,
/// <stem>.json beside the photograph (LabelMe: polygon `nail`, line `axis` from proximal to distal), a mask under
/// --masks, detection. Results: nails.csv, normalized/, maps/*.npy, figures/, report.html, run.json.
#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub(super) struct PhotosArgs {
    #[command(subcommand)]
    merge: Option<PhotosCommand>,
    /// Folder of photographs
    #[arg(required = true)]
    set: Option<PathBuf>,
    /// Folder for the results
    #[arg(long, required = true)]
    out: Option<PathBuf>,
    /// Masks named as the photographs (MASKS/<pose>/<stem>.* or MASKS/<stem>.*); each connected region is a nail
    #[arg(long, value_name = "MASKS")]
    masks: Option<PathBuf>,
    #[command(flatten)]
    options: PhotosOptions,
    /// Save detected outlines as LabelMe files to correct: beside the photographs, or in FOLDER with a photos.csv
    #[arg(long, value_name = "FOLDER", num_args = 0..=1, require_equals = true)]
    write_outlines: Option<Option<PathBuf>>,
    /// Show what would be done and what left out, and do nothing
    #[arg(long)]
    plan: bool,
    #[command(flatten)]
    common: Common,
}

#[derive(Debug, Subcommand)]
enum PhotosCommand {
    /// Join maps that were made in parts: the same bytes as made at once
    Merge(MergeArgs),
}

#[derive(Debug, Args)]
struct MergeArgs {
    /// Folders that `lunula photos` wrote
    #[arg(required = true, num_args = 1..)]
    parts: Vec<PathBuf>,
    /// Folder for the results
    #[arg(long)]
    out: PathBuf,
    #[command(flatten)]
    common: Common,
}

impl PhotosArgs {
    fn options(&self) -> anyhow::Result<PhotosOptions> {
        if let Some(masks) = self.masks.as_ref().filter(|m| !m.is_dir()) {
            anyhow::bail!("--masks {}: is not a folder", masks.display());
        }
        let mut options = self.options.clone();
        options.outlines.masks = self.masks.clone();
        Ok(options)
    }

    fn outputs(&self, out: &Path) -> Outputs {
        let outlines = self.write_outlines.as_ref().map(|folder| match folder {
            Some(folder) => OutlineHome::Folder(folder.clone()),
            None => OutlineHome::BesidePhotographs,
        });
        Outputs { folder: out.to_owned(), results: Results::Maps, outlines }
    }
}

pub(super) fn run(args: &PhotosArgs) -> anyhow::Result<Outcome> {
    if let Some(PhotosCommand::Merge(args)) = &args.merge {
        return run_merge(args);
    }
    let (set, out) = args.set.as_ref().zip(args.out.as_ref()).context("SET and --out are needed")?;
    let options = args.options()?;
    let apart: Vec<&Path> = std::iter::once(out.as_path()).chain(args.masks.as_deref()).collect();
    if PhotoSet::would_take_results(set, out) {
        anyhow::bail!(
            "--out {}: is among the photographs of {}, where results would be taken for photographs; choose another \
             --out",
            out.display(),
            set.display()
        );
    }
    let set = PhotoSet::open(set, &apart)?;
    let outputs = args.outputs(out);
    if args.plan {
        return Ok(print_plan(args, &set, &plan(&set, &options, &outputs)));
    }
    let stop = args.common.start()?;
    let bar = args.common.progress(set.photos.len(), "photographs");
    let report = run_photos(&set, &options, &outputs, &Watch { stop: &stop, tick: &|| bar.inc(1) });
    bar.finish_and_clear();
    match report {
        Ok(report) => finish(&args.common, &report, out),
        Err(PhotosError::Interrupted) => Err(Interrupted.into()),
        Err(PhotosError::NothingUsable { failed, outlines }) => {
            outlines.iter().flat_map(SavedOutlines::notes).for_each(|note| args.common.say(&note));
            Err(PhotosError::NothingUsable { failed, outlines }.into())
        }
        Err(other) => Err(other.into()),
    }
}

fn run_merge(args: &MergeArgs) -> anyhow::Result<Outcome> {
    let stop = args.common.start()?;
    match merge(&args.parts, &args.out, &Watch { stop: &stop, tick: &|| {} }) {
        Ok(report) => finish(&args.common, &report, &args.out),
        Err(MergeError::Interrupted) => Err(Interrupted.into()),
        Err(other) => Err(other.into()),
    }
}

fn print_plan(args: &PhotosArgs, set: &PhotoSet, steps: &[Step]) -> Outcome {
    if args.common.json {
        print_line(&serde_json::json!({ "job": "photos", "plan": steps, "failed": set.faults }).to_string());
    } else {
        print_steps(steps);
    }
    name_failures(&set.faults);
    if set.faults.is_empty() { Outcome::Done } else { Outcome::SomeFailed }
}

fn name_failures(failed: &[SetFault]) {
    for fault in failed {
        eprintln!("failed: {}: {}", shown(&fault.place), shown_lines(&fault.what));
    }
}

fn finish(common: &Common, report: &PhotosReport, out: &Path) -> anyhow::Result<Outcome> {
    common.warn(&report.warnings);
    name_failures(&report.failed);
    common.print_json(report)?;
    report.notes.iter().for_each(|note| common.say(&format!("note: {note}")));
    for pose in &report.poses {
        common.say(&format!("{:<28} {:>4} subject(s)", pose.pose, pose.subjects));
    }
    if common.verbose {
        for stage in &report.stages {
            common.say(&format!("{:<28} {:>9.3} s of threads, {} runs", stage.stage, stage.thread_s, stage.runs));
        }
        common.say_left_out(&report.left_out);
    }
    common.say(&format!("{:.2} s; look at {}", report.wall_s, out.join("report.html").display()));
    Ok(if report.failed.is_empty() { Outcome::Done } else { Outcome::SomeFailed })
}
