//! `lunula photos`: photographs to coloration maps, and `lunula photos merge`.

use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::{Args, Subcommand, ValueEnum};
use lunula::photo::outline::{DetectOptions, Drawn, MaskValues, OutlineOptions, SavedOutlines, Side, Sources};
use lunula::photo::{
    Channel, MOST_MEGAPIXELS, MergeError, Normalization, OutlineHome, Outputs, PhotoSet, PhotosError, PhotosOptions,
    PhotosReport, Resample, Results, SetFault, Watch, merge, plan, run as run_photos,
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
    /// Where outlines may come from
    #[arg(long, value_enum, default_value = "auto")]
    outline: OutlineArg,
    /// Masks named as the photographs (MASKS/<pose>/<stem>.* or MASKS/<stem>.*); each connected region is a nail
    #[arg(long, value_name = "MASKS")]
    masks: Option<PathBuf>,
    /// Which values of masks are nail, as 255 or 250..255, in the mask's own units [default: a mask has two values]
    #[arg(long, value_name = "VALUES")]
    mask_value: Option<MaskValues>,
    /// Side of the picture that the distal ends point to, for outlines without an axis [default: found in each picture]
    #[arg(long, value_enum)]
    distal: Option<SideArg>,
    /// Whether annotations and masks were drawn on the upright or the stored picture, where EXIF turns it and its size
    /// doesn't show which
    #[arg(long, value_enum, default_value = "auto")]
    annotations: DrawnArg,
    /// Save detected outlines as LabelMe files to correct: beside the photographs, or in FOLDER with a photos.csv
    #[arg(long, value_name = "FOLDER", num_args = 0..=1, require_equals = true)]
    write_outlines: Option<Option<PathBuf>>,
    /// Width and height of the normalized pictures, pixels
    #[arg(long, default_value_t = 400)]
    size: usize,
    /// Side of the normalized pictures, as a multiple of the nail's box
    #[arg(long, default_value_t = 1.25)]
    margin: f64,
    /// Channel of colour photographs to use
    #[arg(long, value_enum, default_value = "green")]
    channel: ChannelArg,
    /// Undo the sRGB curve, so that values are proportional to light
    #[arg(long)]
    linear: bool,
    /// Sample value of 16-bit files that is full scale: 4095 where 12 bits are kept in 16 [default: 65535]
    #[arg(long, value_name = "SAMPLE")]
    white: Option<u16>,
    /// Refuse photographs of more megapixels, before memory is taken for them
    #[arg(
        long,
        value_name = "MP",
        default_value_t = MOST_MEGAPIXELS,
        value_parser = clap::value_parser!(u32).range(1..=10_000)
    )]
    max_megapixels: u32,
    /// How to interpolate between pixels
    #[arg(long, value_enum, default_value = "cubic")]
    resample: ResampleArg,
    /// Longest side, in pixels, of the picture that detection searches
    #[arg(
        long,
        value_name = "PX",
        default_value_t = DetectOptions::default().working_size_px,
        value_parser = clap::value_parser!(u32).range(64..=4096)
    )]
    detect_size: u32,
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

#[derive(Debug, Clone, Copy, ValueEnum)]
enum OutlineArg {
    /// Drawn where there is one, else detected
    Auto,
    /// Only what is drawn: manifest, LabelMe, masks
    Annotated,
    /// Only detection, whatever is drawn
    Detect,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum SideArg {
    Up,
    Down,
    Left,
    Right,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum DrawnArg {
    Auto,
    Upright,
    Stored,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum ChannelArg {
    Red,
    Green,
    Blue,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum ResampleArg {
    Nearest,
    Linear,
    Cubic,
}

impl PhotosArgs {
    fn options(&self) -> anyhow::Result<PhotosOptions> {
        let normalization = Normalization {
            size: self.size,
            margin: self.margin,
            channel: match self.channel {
                ChannelArg::Red => Channel::Red,
                ChannelArg::Green => Channel::Green,
                ChannelArg::Blue => Channel::Blue,
            },
            linear: self.linear,
            resample: match self.resample {
                ResampleArg::Nearest => Resample::Nearest,
                ResampleArg::Linear => Resample::Linear,
                ResampleArg::Cubic => Resample::Cubic,
            },
            white: self.white,
        };
        let outlines = OutlineOptions {
            sources: match self.outline {
                OutlineArg::Auto => Sources::Auto,
                OutlineArg::Annotated => Sources::Annotated,
                OutlineArg::Detect => Sources::Detect,
            },
            listed_only: false,
            masks: self.masks.clone(),
            mask_values: self.mask_value,
            distal: self.distal.map(|side| match side {
                SideArg::Up => Side::Up,
                SideArg::Down => Side::Down,
                SideArg::Left => Side::Left,
                SideArg::Right => Side::Right,
            }),
            drawn: match self.annotations {
                DrawnArg::Auto => Drawn::Auto,
                DrawnArg::Upright => Drawn::Upright,
                DrawnArg::Stored => Drawn::Stored,
            },
            detect: DetectOptions { working_size_px: self.detect_size, ..DetectOptions::default() },
        };
        if let Some(masks) = self.masks.as_ref().filter(|m| !m.is_dir()) {
            anyhow::bail!("--masks {}: is not a folder", masks.display());
        }
        Ok(PhotosOptions {
            normalization: normalization.check().map_err(anyhow::Error::msg)?,
            outlines,
            max_megapixels: Some(self.max_megapixels),
        })
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
