//! `lunula photos`: photographs to coloration maps, and `lunula photos merge`.

use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::Context;
use clap::{Args, Subcommand, ValueEnum};
use lunula::files::{Places, Staging};
use lunula::photo::outline::{DetectOptions, Drawn, MaskValues, OutlineOptions, Side, Sources};
use lunula::photo::{
    Channel, DetectedOutline, MOST_MEGAPIXELS, NailTable, Normalization, PhotoSet, PhotosError, PhotosOptions,
    Resample, RunReport, SetFault, Watch, keep_outlines, merge, plan, run as run_photos, write_nails,
};
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
    /// On which side of the picture the distal ends lie, for outlines without an axis [default: found in each picture]
    #[arg(long, value_enum)]
    distal: Option<SideArg>,
    /// Which picture annotations and masks were drawn on, where EXIF turns it and its size can't tell
    #[arg(long, value_enum, default_value = "auto")]
    annotations: DrawnArg,
    /// Save detected outlines as LabelMe files to correct: beside the photographs, or in FOLDER with a photos.csv
    #[arg(long, value_name = "FOLDER", num_args = 0..=1, require_equals = true)]
    write_outlines: Option<Option<PathBuf>>,
    /// Width and height of the normalized pictures, pixels
    #[arg(long, default_value_t = 400)]
    size: usize,
    /// How much they show, in boxes of the nail
    #[arg(long, default_value_t = 1.25)]
    margin: f64,
    /// The channel of colour photographs
    #[arg(long, value_enum, default_value = "green")]
    channel: ChannelArg,
    /// Undo the sRGB curve, so that values are proportional to light
    #[arg(long)]
    linear: bool,
    /// The sample of 16-bit files that is full scale: 4095 where 12 bits are kept in 16 [default: 65535]
    #[arg(long, value_name = "SAMPLE")]
    white: Option<u16>,
    /// Megapixels beyond which a photograph is refused, before memory is taken for it
    #[arg(
        long,
        value_name = "MP",
        default_value_t = MOST_MEGAPIXELS,
        value_parser = clap::value_parser!(u32).range(1..=10_000)
    )]
    max_megapixels: u32,
    /// How values between pixels come about
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
    /// Say what would be done and left out, and do nothing
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
    /// Annotated where somebody drew one, else detected
    Auto,
    /// Only what somebody drew: manifest, LabelMe, masks
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
            anyhow::bail!("--masks {}: is no folder", masks.display());
        }
        Ok(PhotosOptions {
            normalization: normalization.check().map_err(anyhow::Error::msg)?,
            outlines,
            max_megapixels: Some(self.max_megapixels),
            keep_detected: self.write_outlines.is_some(),
            parts: None,
        })
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
    if args.plan {
        return Ok(print_plan(args, &set, &options));
    }
    let start = Instant::now();
    let stop = args.common.start()?;
    let staging = Staging::new(out)?;
    let bar = args.common.progress(set.photos.len(), "photographs");
    let watch = Watch { stop: &stop, tick: &|| bar.inc(1) };
    let result = run_photos(&set, &options, &staging, &watch);
    bar.finish_and_clear();
    let result = match result {
        Err(PhotosError::Interrupted) => return Err(Interrupted.into()),
        Err(PhotosError::NothingUsable { failed, detected }) => {
            // What was found but not trusted is what a person most needs to see.
            let mut places = Places::default();
            let said = save_outlines(args, &detected, &set, &mut places)?;
            places.commit()?;
            said.iter().for_each(|said| args.common.say(said));
            return Err(PhotosError::NothingUsable { failed, detected }.into());
        }
        other => other?,
    };
    let report = RunReport::of_photos(&set, &options, &result, start.elapsed());
    let nails = NailTable::of(&result.rows, &set);
    write_nails(nails.rows(), &staging)?;
    report.write_html(&nails, &staging)?;
    report.write_json(&staging)?;
    let mut places = Places::default();
    let said = save_outlines(args, &result.detected, &set, &mut places)?;
    put_in_place(staging, places, &args.common, out)?;
    said.iter().for_each(|said| args.common.say(said));
    finish(&args.common, &report, out)
}

/// Returns what to say of them once they are in their places.
fn save_outlines(
    args: &PhotosArgs,
    detected: &[DetectedOutline],
    set: &PhotoSet,
    places: &mut Places,
) -> anyhow::Result<Option<String>> {
    let Some(folder) = &args.write_outlines else { return Ok(None) };
    let kept = keep_outlines(detected, set, folder.as_deref(), places)?;
    for path in &kept.stood {
        args.common.warn(&[format!("{} stands and stays as it is", path.display())]);
    }
    let place = folder.as_ref().map_or_else(|| "beside the photographs".into(), |f| format!("in {}", f.display()));
    Ok(Some(format!("{} outlines saved {place} for LabelMe", kept.written.len())))
}

fn run_merge(args: &MergeArgs) -> anyhow::Result<Outcome> {
    args.common.start()?;
    let staging = Staging::new(&args.out)?;
    let report = merge(&args.parts, &staging)?;
    put_in_place(staging, Places::default(), &args.common, &args.out)?;
    finish(&args.common, &report, &args.out)
}

/// An earlier run's results beside these are not deleted, but nobody should take them for this run's.
fn put_in_place(staging: Staging, outlines: Places, common: &Common, out: &Path) -> anyhow::Result<()> {
    if let [first, others @ ..] = &staging.left_from_earlier()[..] {
        let also = if others.is_empty() { String::new() } else { format!(" and {} more", others.len()) };
        common.warn(&[format!("{first}{also} in {} stood before and are not of this run", out.display())]);
    }
    Ok(staging.commit_with(outlines)?)
}

fn print_plan(args: &PhotosArgs, set: &PhotoSet, options: &PhotosOptions) -> Outcome {
    let steps = plan(set, options);
    if args.common.json {
        print_line(&serde_json::json!({ "job": "photos", "plan": steps, "failed": set.faults }).to_string());
    } else {
        print_steps(&steps);
    }
    name_failures(&set.faults);
    if set.faults.is_empty() { Outcome::Done } else { Outcome::SomeFailed }
}

fn name_failures(failed: &[SetFault]) {
    for fault in failed {
        eprintln!("failed: {}: {}", shown(&fault.place), shown_lines(&fault.what));
    }
}

fn finish(common: &Common, report: &RunReport, out: &Path) -> anyhow::Result<Outcome> {
    common.warn(&report.warnings);
    name_failures(&report.failed);
    common.print_json(report)?;
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
