//! What is aligned, how, and where results go.

use std::path::PathBuf;

use clap::Args;

use super::tie::LagTie;
use crate::job::{not_negative, number};
use crate::log::LogReading;

/// What is aligned.
#[derive(Debug, Clone)]
pub struct AlignInputs {
    /// The table of joint angles, as `lunula posture` writes it.
    pub joints: PathBuf,
    /// The log of photodiodes and forces.
    pub log: PathBuf,
    /// The table of markers; only [`AlignOutputs::dlc`] needs it.
    pub tracks: Option<PathBuf>,
}

/// How the clocks are tied.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sync {
    /// By the clock in the picture.
    Clock,
    /// By an offset that the user knows.
    Offset {
        /// The log's time at the video's first frame, seconds.
        offset_s: f64,
        /// Its standard error, seconds; none: not known.
        sd_s: Option<f64>,
    },
    /// By the lag at which the photodiodes best explain the angles.
    Correlate,
}

impl Sync {
    /// Reads `clock`, `offset=SECONDS`, `offset=SECONDS+-ERROR` or `correlate`.
    ///
    /// # Errors
    /// What to write instead.
    pub fn parse(text: &str) -> Result<Self, String> {
        let number = |text: &str| number(text).ok();
        let offset = |text: &str| {
            let (offset, sd) = text.split_once("+-").map_or((text, None), |(offset, sd)| (offset, Some(sd)));
            let sd_s = sd.map(number);
            (sd_s != Some(None)).then_some(())?;
            Some(Self::Offset { offset_s: number(offset)?, sd_s: sd_s.flatten() })
        };
        let sync = match text {
            "clock" => Some(Self::Clock),
            "correlate" => Some(Self::Correlate),
            other => other.strip_prefix("offset=").and_then(offset),
        };
        sync.ok_or_else(|| {
            "choose clock, offset=SECONDS (offset=60.25, or with its standard error offset=60.25+-0.01) or correlate"
                .to_owned()
        })
    }
}

/// How to work: the options of `lunula align` and of a pipeline's stage.
#[derive(Debug, Clone, Default, Args)]
pub struct AlignOptions {
    /// How the clocks are tied: clock (in the picture), offset=SECONDS (the log's time at the video's first frame; with
    /// its standard error offset=SECONDS+-ERROR, without which labels have no standard errors), correlate
    /// [default: clock, where the table of angles has it]
    #[arg(long, value_name = "clock|offset=SECONDS|correlate", value_parser = Sync::parse, allow_hyphen_values = true)]
    pub sync: Option<Sync>,
    /// The log's time when the clock in the picture shows zero [default: the log's zero, hour or midnight that makes
    /// the two overlap]
    #[arg(long = "clock-zero", value_name = "SECONDS", value_parser = number, allow_negative_numbers = true)]
    pub clock_zero_s: Option<f64>,
    /// Where the lag is looked for, and the sensor's own.
    #[command(flatten)]
    pub lag: LagTie,
    /// The longest time between two frames that were seen over which labels are interpolated [default: two frames]
    #[arg(long = "max-gap", value_name = "SECONDS", value_parser = not_negative)]
    pub max_gap_s: Option<f64>,
    /// How the log is read.
    #[command(flatten)]
    pub log: LogReading,
    /// Written into the set's column `subject`
    #[arg(long)]
    pub subject: Option<String>,
    /// Written into the set's column `session`
    #[arg(long)]
    pub session: Option<String>,
    /// What the finger does, for the names of the BIDS dataset [default: bending]
    #[arg(long)]
    pub task: Option<String>,
    /// The recording's number among several of one subject, session and task, for the names of the BIDS dataset
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..))]
    pub run: Option<u32>,
}

/// Where results go.
#[derive(Debug, Clone)]
pub struct AlignOutputs {
    /// The labelled set; certificate, report and pictures stand beside it, named after it.
    pub training: PathBuf,
    /// The angles as an OpenSim motion file, on the log's clock.
    pub mot: Option<PathBuf>,
    /// The angles as a BIDS Motion folder.
    pub bids: Option<PathBuf>,
    /// The markers as a DeepLabCut table.
    pub dlc: Option<PathBuf>,
    /// Whether pictures are drawn.
    pub figures: bool,
    /// Whether the report is written beside the set.
    pub report: bool,
}

impl AlignOutputs {
    /// The labelled set with its certificate alone.
    #[must_use]
    pub fn only(training: PathBuf) -> Self {
        Self { training, mot: None, bids: None, dlc: None, figures: false, report: false }
    }
}
