//! What a layout is asked for: the options of `lunula layout` and of a pipeline's stage; inputs and outputs.

use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

use clap::{Args, ValueHint};

use crate::job::{not_negative, number};
use crate::log::LogReading;
use crate::predictor::DataFile;

/// The most photodiodes that are looked for: more are better chosen by leaving out.
const MOST_PLACES: usize = 16;
/// The largest grid of `--cells`, as of the candidates that the search takes.
const MOST_CELLS: i64 = 32;

/// Numbers of photodiodes: `1..8`, `4`, `2,4,8`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Numbers(pub Vec<usize>);

impl FromStr for Numbers {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let one = |text: &str| text.trim().parse::<usize>().ok().filter(|k| (1..=MOST_PLACES).contains(k));
        let part = |text: &str| match text.split_once("..") {
            Some((from, to)) => Some((one(from)?..=one(to.trim_start_matches('='))?).collect::<Vec<usize>>()),
            None => Some(vec![one(text)?]),
        };
        let parts: Option<Vec<_>> = text.split(',').map(part).collect();
        let mut all = parts.unwrap_or_default().concat();
        all.sort_unstable();
        all.dedup();
        if all.is_empty() {
            return Err(format!("write numbers of photodiodes from 1 to {MOST_PLACES}, as 1..8 or 2,4,8"));
        }
        Ok(Self(all))
    }
}

impl fmt::Display for Numbers {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let all: Vec<String> = self.0.iter().map(ToString::to_string).collect();
        f.write_str(&all.join(","))
    }
}

/// How to choose.
#[derive(Debug, Clone, Args)]
pub struct LayoutOptions {
    /// Numbers of photodiodes to lay out: 1..8, or 2,4,8
    #[arg(long, value_name = "NUMBERS", default_value = "1..8")]
    pub k: Numbers,
    /// What the readings are to say, as Fx_N,Fy_N,Fz_N [default: those of Fx_N, Fy_N, Fz_N, J2_deg that there are]
    #[arg(long, value_name = "COLUMNS", value_delimiter = ',')]
    pub targets: Option<Vec<String>>,
    /// The number of photodiodes that layout.json holds [default: the smallest whose error is within a standard error
    /// of that of all candidates together, or if none is, of the best number]
    #[arg(long, value_name = "K")]
    pub choose: Option<usize>,
    /// Photodiodes that every layout has, by the candidates' names, as P1,P4 or C_03_08
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub keep: Vec<String>,
    /// Left and right alike: with every place its mirror image
    #[arg(long)]
    pub mirror: bool,
    /// Distance between the middles of two photodiodes, at least
    #[arg(long, value_name = "MM", default_value = "1.5", value_parser = not_negative)]
    pub apart: f64,
    /// Distance of a photodiode's middle from the edges of the nail's box, at least
    #[arg(long, value_name = "MM", default_value = "0.5", value_parser = not_negative)]
    pub edge: f64,
    /// What a photodiode adds to each reading: the SD, in the readings' unit, besides what the recordings have already
    #[arg(long, value_name = "SD", default_value = "0", value_parser = not_negative)]
    pub noise: f64,
    /// The nail's width
    #[arg(long, value_name = "MM", default_value = "12", value_parser = width)]
    pub nail_width: f64,
    /// The nail's length
    #[arg(long, value_name = "MM", default_value = "14", value_parser = width)]
    pub nail_length: f64,
    /// The disc that a photodiode sees, for layout.json
    #[arg(long, value_name = "MM", default_value = "1", value_parser = diameter)]
    pub diameter: f64,
    /// The grid of C_rr_cc columns has so many rows and columns [default: all its cells are there, so they say it]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=MOST_CELLS))]
    pub grid: Option<u32>,
    /// Of maps, the candidates are a grid of so many rows and columns
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u32).range(4..=MOST_CELLS))]
    pub cells: u32,
    /// Random layouts that exchange starts from, besides the greedy one
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u32).range(0..=10_000))]
    pub starts: u32,
    /// The seed of random layouts
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Multiply-adds that the proof of each number of photodiodes may take, in billions (1 to 4 s each)
    #[arg(long, value_name = "BILLIONS", default_value = "0.5", value_parser = not_negative)]
    pub proof: f64,
    /// How raw logs are read.
    #[command(flatten)]
    pub log: LogReading,
}

fn width(text: &str) -> Result<f64, String> {
    number(text).ok().filter(|mm| (3.0..=30.0).contains(mm)).ok_or_else(|| "a nail has 3 to 30 mm".to_owned())
}

fn diameter(text: &str) -> Result<f64, String> {
    number(text).ok().filter(|mm| *mm > 0.0 && *mm <= 6.0).ok_or_else(|| "write more than 0 and up to 6 mm".to_owned())
}

/// What is read.
#[derive(Debug, Clone, PartialEq, Eq, Args)]
pub struct LayoutInputs {
    /// Tables (csv, parquet) or raw logs; or one folder that lunula photos wrote
    #[arg(required = true, value_name = "INPUT", value_parser = DataFile::parser(), value_hint = ValueHint::AnyPath)]
    pub data: Vec<DataFile>,
    /// Where the photodiodes P1, P2, .. are (toml or json) [default: the thesis' eight]
    #[arg(long, value_name = "FILE")]
    pub positions: Option<PathBuf>,
}
