//! `lunula nailvideo`: a video of a nail to virtual photodiodes.

use std::path::PathBuf;

use anyhow::Context;
use clap::Args;
use lunula::job::Given;
use lunula::nailvideo::{self, Inputs, NailVideoOptions, NailVideoReport, Outputs, mask_of};

use crate::jobs::{self, ResultArgs};
use crate::{Common, Outcome};

/// Read virtual photodiodes off a video of a nail: follow the nail, average places of it, find presses
///
/// The nail's outline comes from --outline or --masks, drawn on the first frame, or is detected in the first frame that
/// shows one nail well. The nail is followed by its motion since that frame; where it is not sure, or something lies
/// over a photodiode, values are missing. Results in the folder: photodiodes.csv (a log, as align, train and predict
/// read it), motion.csv, presses.csv (onset, t50, t90 and tau of each press and release with 95 % intervals; research
/// use, not a diagnostic), nail.png and nail.json (the outline, to be corrected), report.html, run.json.
#[derive(Debug, Args)]
#[command(mut_arg("no_figures", |no| no.help("Draw no pictures and write no page")))]
pub(crate) struct NailVideoArgs {
    /// The video, in any format that FFmpeg reads
    video: PathBuf,
    /// The nail in the first frame: a LabelMe file (a polygon `nail`, a line `axis`; `nail.json` names another frame
    /// where it is of one), or a mask picture
    #[arg(long, value_name = "FILE")]
    outline: Option<PathBuf>,
    /// A folder with a mask of the first frame, named as the video
    #[arg(long, value_name = "DIR", conflicts_with = "outline")]
    masks: Option<PathBuf>,
    /// Where the photodiodes are: positions.toml, or layout.json [default: the thesis' eight, read off its words]
    #[arg(long, value_name = "FILE")]
    positions: Option<PathBuf>,
    #[command(flatten)]
    given: Given<NailVideoOptions>,
    /// Write every normalized frame as well: frames/NNNNNN.png
    #[arg(long)]
    frames: bool,
    /// Tables as Parquet
    #[arg(long)]
    parquet: bool,
    #[command(flatten)]
    results: ResultArgs,
}

impl NailVideoArgs {
    fn inputs(&self) -> anyhow::Result<Inputs> {
        let of_mask = |folder: &PathBuf| {
            mask_of(folder, &self.video).with_context(|| {
                let stem = self.video.file_stem().unwrap_or_default().to_string_lossy();
                format!("{}: has no picture named {stem}; name the mask as the video", folder.display())
            })
        };
        let mask = self.masks.as_ref().map(of_mask).transpose()?;
        let outline = self.outline.clone().or(mask);
        Ok(Inputs { video: self.video.clone(), outline, positions: self.positions.clone() })
    }

    fn outputs(&self) -> Outputs {
        Outputs {
            folder: self.results.place(),
            frames: self.frames,
            figures: !self.results.no_figures,
            report: true,
            ending: if self.parquet { "parquet" } else { "csv" },
        }
    }
}

pub(crate) fn run(args: &NailVideoArgs) -> anyhow::Result<Outcome> {
    let NailVideoArgs { given, results, .. } = args;
    let options = NailVideoOptions { threads: results.job.common.threads(), ..given.options.clone() };
    jobs::run(
        &results.request("nailvideo", "frames", &given.said),
        || Ok(nailvideo::plan(&args.inputs()?, &options, &args.outputs())?),
        |watch| Ok(nailvideo::run(&args.inputs()?, &options, &args.outputs(), watch)?),
        say,
    )
}

fn say(common: &Common, report: &NailVideoReport) {
    let known = |value: Option<f64>, digits: usize| value.map_or("-".into(), |v| format!("{v:.digits$}"));
    let (nail, frames) = (&report.nail, &report.frames);
    common.say(&format!(
        "nail {:.0} x {:.0} px ({}), followed in {} of {} frames to ± {} px",
        nail.width_px,
        nail.length_px,
        nail.outline,
        frames.followed,
        frames.all,
        known(report.se_px, 2)
    ));
    for (why, count) in &frames.lost {
        common.say(&format!("{why}: {count} frames"));
    }
    for one in &report.photodiodes {
        let absent: Vec<String> = one.absent.iter().map(|(why, count)| format!("{count} {why}")).collect();
        let absent = if absent.is_empty() { String::new() } else { format!("; {}", absent.join(", ")) };
        common.say(&format!("{:<6} {:>7} frames, noise {}{absent}", one.name, one.frames, known(one.noise_sd, 3)));
    }
    common.say(&format!("{} presses ({})", report.presses, report.presses_are_for));
    for (status, count) in &report.courses {
        common.say(&format!("{count:>5} courses {status}"));
    }
    common.say(&format!("{:.0} % of the time went into decoding", 100.0 * report.decoding_share));
}
