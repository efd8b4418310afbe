//! The commands of the hemodynamic model: simulate, fit.

mod fit;
mod simulate;

use std::path::PathBuf;

use clap::Args;
use lunula::hemodynamics::model::Symbol;
use lunula::hemodynamics::{GivenParameters, HemodynamicsError};

use super::{Common, Outcome, one_of, print_line};

pub(super) use fit::{FitArgs, run as fit};
pub(super) use simulate::{SimulateArgs, run as simulate};

/// Which nail.
#[derive(Debug, Clone, Args)]
struct NailArgs {
    /// Parameters by the thesis' symbols with their units, as k_C1_N_per_m = 1e5 [default: the thesis' table];
    /// --print-params writes a whole file to start from
    #[arg(long, value_name = "PARAMS.toml")]
    params: Option<PathBuf>,
    /// Capillary units along the nail, each with its photodiode and its share of the distal load [default: what
    /// --params says, or 2, the thesis' model]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1000))]
    units: Option<u16>,
    /// A single parameter, before the file's; as often as wanted, as --set b_V_N_s_per_m=300
    #[arg(long, value_name = "NAME=VALUE", value_parser = parse_setting)]
    set: Vec<(Symbol, f64)>,
}

impl NailArgs {
    fn given(&self) -> GivenParameters {
        GivenParameters { file: self.params.clone(), units: self.units.map(usize::from), set: self.set.clone() }
    }
}

fn parse_setting(text: &str) -> Result<(Symbol, f64), String> {
    let (name, value) = text.split_once('=').ok_or("write NAME=VALUE, as k_C1_N_per_m=5e4")?;
    let value = value.trim().parse().map_err(|_| format!("{value}: is no number"))?;
    Ok((name.trim().parse()?, value))
}

/// An error of a job, with a word of its own where somebody stopped it.
fn ended(error: HemodynamicsError) -> anyhow::Error {
    match error {
        HemodynamicsError::Interrupted => lunula::job::Interrupted.into(),
        error => error.into(),
    }
}
