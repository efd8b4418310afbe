//! `lunula photos`: photographs to coloration maps, and `lunula photos merge`.

pub(crate) mod edit;

use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::{Args, Subcommand};
use lunula::job::Given;
use lunula::photo::outline::SavedOutlines;
use lunula::photo::{
    self, MapsJob, OutlineHome, Outputs, PhotoSet, PhotosError, PhotosOptions, PhotosReport, Results, merge,
    merge_plan, plan,
};

use crate::jobs::{self, JobArgs, Plan, Request, needed};
use crate::{Common, Outcome};

/// Turn nail photographs into coloration maps: outlines, normalized pictures, mean and standard deviation over subjects
///
/// SET is a folder SET/<pose>/<subject>.<png|jpg|tif|bmp>, a flat folder (one pose), or holds photos.csv with the
/// columns file,subject,pose and optionally outline and tone (skin tone). The outline of a nail comes from the first
/// of: the column outline, <stem>.json beside the photograph (LabelMe: polygon `nail`, line `axis` from proximal to
/// distal), a mask under --masks, detection. Results: nails.csv, normalized/, maps/*.npy, figures/, report.html,
/// run.json.
#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub(crate) struct PhotosArgs {
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
    given: Given<PhotosOptions>,
    /// Save detected outlines as LabelMe files to correct: beside the photographs, or in FOLDER with a photos.csv
    #[arg(long, value_name = "FOLDER", num_args = 0..=1, require_equals = true)]
    write_outlines: Option<Option<PathBuf>>,
    #[command(flatten)]
    job: JobArgs,
}

#[derive(Debug, Subcommand)]
enum PhotosCommand {
    /// Join maps that were made in parts: the same bytes as from one run
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
    given: Given<MapsJob>,
    #[command(flatten)]
    job: JobArgs,
}

impl PhotosArgs {
    fn options(&self) -> anyhow::Result<PhotosOptions> {
        if let Some(masks) = self.masks.as_ref().filter(|m| !m.is_dir()) {
            anyhow::bail!("--masks {}: is not a folder", masks.display());
        }
        let mut options = self.given.options.clone();
        options.outlines.masks = self.masks.clone();
        Ok(options)
    }

    fn set(&self) -> anyhow::Result<PhotoSet> {
        let (set, out) = self.set.as_ref().zip(self.out.as_ref()).context("SET and --out are needed")?;
        if PhotoSet::would_take_results(set, out) {
            anyhow::bail!(
                "--out {}: is among the photographs of {}, where results would be taken for photographs; choose \
                 another --out",
                out.display(),
                set.display()
            );
        }
        let apart: Vec<&Path> = std::iter::once(out.as_path()).chain(self.masks.as_deref()).collect();
        Ok(PhotoSet::open(set, &apart)?)
    }

    fn outputs(&self) -> Option<Outputs> {
        let outlines = self.write_outlines.as_ref().map(|folder| match folder {
            Some(folder) => OutlineHome::Folder(folder.clone()),
            None => OutlineHome::BesidePhotographs,
        });
        Some(Outputs { folder: self.out.clone()?, results: Results::Maps, outlines })
    }
}

/// `merge`, or the job.
pub(crate) fn run(args: &PhotosArgs) -> anyhow::Result<Outcome> {
    if let Some(PhotosCommand::Merge(args)) = &args.merge {
        return run_merge(args);
    }
    let PhotosArgs { given, out, job, .. } = args;
    let result = out.as_ref().map(|out| out.join("report.html"));
    jobs::run(
        &Request { name: "photos", unit: "photographs", job, said: &given.said, result },
        || {
            let (options, set) = (args.options()?, args.set()?);
            let steps = plan(&set, &options, &needed(args.outputs())?);
            Ok(Plan { steps, failed: set.faults.iter().map(ToString::to_string).collect() })
        },
        |watch| {
            let (options, set) = (args.options()?, args.set()?);
            let report = photo::run(&set, &options, &needed(args.outputs())?, watch);
            Ok(report.inspect_err(|why| {
                if let PhotosError::NothingUsable { outlines, .. } = why {
                    let notes: Vec<String> = outlines.iter().flat_map(SavedOutlines::notes).collect();
                    job.common.note(&notes);
                }
            })?)
        },
        say_poses,
    )
}

fn run_merge(MergeArgs { parts, out, given, job }: &MergeArgs) -> anyhow::Result<Outcome> {
    let result = Some(out.join("report.html"));
    jobs::run(
        &Request { name: "photos merge", unit: "steps", job, said: &given.said, result },
        || Ok(merge_plan(parts)),
        |watch| Ok(merge(parts, out, watch)?),
        say_poses,
    )
}

fn say_poses(common: &Common, report: &PhotosReport) {
    for pose in &report.poses {
        common.say(&format!("{:<28} {:>4} subject(s)", pose.pose, pose.subjects));
    }
    for rows in report.channels.iter().flat_map(|channels| channels.rows.chunk_by(|a, b| a.pose == b.pose)) {
        let of_all = rows.iter().filter(|row| row.tone.is_none());
        let said = of_all.filter_map(|row| Some((row.channel.name(), row.contrast?.mean)));
        let said: Vec<String> = said.map(|(name, mean)| format!("{name} {:.1} %", 100.0 * mean)).collect();
        common.say(&format!("{:<28} white less red zones: {}", rows[0].pose, said.join(", ")));
    }
}
