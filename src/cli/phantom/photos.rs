//! `lunula phantom photos`: photographs of nails.

use std::path::PathBuf;
use std::sync::atomic::Ordering;

use clap::{Args, ValueEnum};
use lunula::phantom::nail::Pose;
use lunula::phantom::photos::{Error, FileFormat, LightKind, PhotoOptions, write_watched};

use super::{Common, Interrupted, Outcome, parse_size};

/// Photographs of nails of many shapes, sizes, skin tones and lights, in the eight poses of the thesis (4.2.3-4.2.6)
///
/// Writes OUT/photos/<pose>/<subject>.png with a LabelMe file beside each, which `lunula photos OUT/photos` reads, and
/// OUT/truth/: nails.csv, outlines/, normalized/*.npy and maps/*.npy, exact.
#[derive(Debug, Args)]
pub(super) struct PhotosArgs {
    /// Everything random follows from it
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Folder for photos/ and truth/
    #[arg(long)]
    out: PathBuf,
    /// How many subjects; 16 cover all skin tones
    #[arg(long, default_value_t = 16)]
    subjects: u32,
    /// Which poses, separated by commas [default: all eight]
    #[arg(long, value_delimiter = ',')]
    poses: Vec<Pose>,
    /// Width and height of the photographs, pixels
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "640x480", value_parser = parse_size)]
    size: (u32, u32),
    /// Bits a channel
    #[arg(long, default_value_t = 8)]
    depth: u32,
    /// One channel, as through the thesis' green filter
    #[arg(long)]
    grey: bool,
    /// Standard deviation of the sensor's noise, in 255ths of full scale
    #[arg(long, default_value_t = 0.5)]
    noise: f64,
    /// File format of the photographs
    #[arg(long, value_enum, default_value = "png")]
    format: FormatArg,
    /// The thesis' chamber, or dim to bright, tinted, with glare, nails of many sizes up to 30 degrees off upright
    #[arg(long, value_enum, default_value = "varied")]
    light: LightArg,
    /// Draw no outlines beside the photographs
    #[arg(long)]
    no_annotations: bool,
    /// Leave out truth/normalized (0.6 MB a photograph)
    #[arg(long)]
    no_normalized: bool,
    #[command(flatten)]
    common: Common,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum FormatArg {
    Png,
    Jpg,
    Tif,
    Bmp,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum LightArg {
    Chamber,
    Varied,
}

pub(super) fn run(args: &PhotosArgs) -> anyhow::Result<Outcome> {
    let defaults = PhotoOptions::default();
    let options = PhotoOptions {
        seed: args.seed,
        subjects: args.subjects,
        poses: if args.poses.is_empty() { defaults.poses } else { args.poses.clone() },
        width: args.size.0,
        height: args.size.1,
        depth: args.depth,
        grey: args.grey,
        noise_sd: args.noise,
        format: match args.format {
            FormatArg::Png => FileFormat::Png,
            FormatArg::Jpg => FileFormat::Jpg,
            FormatArg::Tif => FileFormat::Tif,
            FormatArg::Bmp => FileFormat::Bmp,
        },
        light: match args.light {
            LightArg::Chamber => LightKind::Chamber,
            LightArg::Varied => LightKind::Varied,
        },
        annotate: !args.no_annotations,
        truth_normalized: !args.no_normalized,
        ..defaults
    };
    let stop = args.common.start()?;
    let bar = args.common.progress(options.subjects as usize * options.poses.len(), "photographs");
    let watch = |done: usize, _: usize| {
        bar.set_position(done as u64);
        !stop.load(Ordering::Relaxed)
    };
    let summary = write_watched(&options, &args.out, &watch).map_err(|error| match error {
        Error::Interrupted => Interrupted.into(),
        other => anyhow::Error::from(other).context("no synthetic photographs"),
    })?;
    bar.finish_and_clear();
    args.common.print_json(&serde_json::json!({
        "job": "phantom photos",
        "version": env!("CARGO_PKG_VERSION"),
        "options": options,
        "photographs": summary.photographs.len(),
        "stages": summary.stages,
        "warnings": [],
    }))?;
    args.common.say(&format!(
        "{} photographs in {}, truth in {}; {:.2} s",
        summary.photographs.len(),
        args.out.join("photos").display(),
        args.out.join("truth").display(),
        summary.stages.total_s
    ));
    Ok(Outcome::Done)
}
