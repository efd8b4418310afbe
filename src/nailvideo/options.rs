//! How a video of a nail is measured: the options of `lunula nailvideo` and of a pipeline's stage; and where results
//! go.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use crate::job;
use crate::photo::outline::Side;

/// What of the light is taken off a photodiode's green.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Light {
    /// The red of the same place, which blood hardly changes: 100 (ln green - ln red), of light
    Red,
    /// The green of the skin about the nail: 100 (ln green - ln green of the skin), of light
    Skin,
    /// Nothing: green light as a fraction of full scale's
    None,
}

impl Light {
    /// The unit of the values.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Self::Red => "100 (ln green - ln red) of light",
            Self::Skin => "100 (ln green - ln green of the skin) of light",
            Self::None => "green light, fraction of full scale's",
        }
    }
}

/// An interval of the video's time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Window {
    /// Its start, seconds from the first frame.
    pub from_s: f64,
    /// Its end, seconds from the first frame.
    pub to_s: f64,
}

impl std::str::FromStr for Window {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let ends = text.split_once("..").and_then(|(from, to)| Some((job::number(from).ok()?, job::number(to).ok()?)));
        let known = ends.filter(|(from, to)| from < to && *from >= 0.0);
        let (from_s, to_s) = known.ok_or_else(|| "write two times in seconds, as 2..5.5".to_owned())?;
        Ok(Self { from_s, to_s })
    }
}

impl std::fmt::Display for Window {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}..{}", self.from_s, self.to_s)
    }
}

/// How to work.
#[derive(Debug, Clone, Args)]
pub struct NailVideoOptions {
    /// What of the light is taken off [default: red; none for a grey video]
    #[arg(long, value_enum)]
    pub light: Option<Light>,
    /// Side of the picture that the distal end points to, for an outline without an axis [default: found in the frame]
    #[arg(long, value_enum)]
    pub distal: Option<Side>,
    /// Averages of N x N cells of the normalized nail (125 % of its box) as well: cells.csv
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(2..=100))]
    pub cells: Option<u8>,
    /// Mean and SD of the normalized nail over these times, as 2..5.5 (seconds); may be given again
    #[arg(long, value_name = "START..END")]
    pub maps: Vec<Window>,
    /// Threads that decode (0: all cores).
    #[arg(skip)]
    pub threads: usize,
}

impl Default for NailVideoOptions {
    fn default() -> Self {
        job::defaults()
    }
}

/// What is looked at.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Inputs {
    /// The video.
    pub video: PathBuf,
    /// The nail in the first frame: a LabelMe file (which may name another frame, as `nail.json` does), or a mask.
    pub outline: Option<PathBuf>,
    /// Where the photodiodes are; without a file the thesis' eight.
    pub positions: Option<PathBuf>,
}

/// Where results go.
#[derive(Debug, Clone)]
pub struct Outputs {
    /// The folder of all results.
    pub folder: PathBuf,
    /// Whether every normalized frame is written.
    pub frames: bool,
    /// Whether pictures are drawn.
    pub figures: bool,
    /// Whether the report is written beside them.
    pub report: bool,
    /// Tables end in `csv` or `parquet`.
    pub ending: &'static str,
}

impl Outputs {
    /// The place of a table.
    #[must_use]
    pub fn table(&self, name: &str) -> PathBuf {
        self.folder.join(format!("{name}.{}", self.ending))
    }
}
