//! The predictors' jobs as pipelines know them, and what they have in common: which file is called how, which columns
//! they need.

mod analyse;
mod evaluate;
mod predict;
mod prune;
mod train;

use std::collections::BTreeSet;
use std::path::Path;

use crate::job::{Demand, Foreseen, Outputs, Quality, Work};
use crate::predictor::data::DataFile;
use crate::predictor::merit::figures::Merit;
use crate::predictor::options::target::Target;

pub use analyse::AnalyseJob;

const ROWS: &str = "predicted";

/// Which of the results, in a folder.
fn outputs(folder: &Path, demand: &Demand) -> Outputs {
    Outputs { rows: demand.wants(ROWS), ..demand.outputs(folder) }
}

/// The recordings of a role.
fn data_files(work: &Work<'_>, role: &str) -> Vec<DataFile> {
    work.of(role).map(DataFile::from).collect()
}

fn foreseen(inputs: &[Foreseen], role: &str) -> Vec<DataFile> {
    inputs.iter().filter(|input| input.role == role).map(|input| DataFile::from(input.path.clone())).collect()
}

/// The joints among columns: `J2` of `J2_deg`.
fn joints(target: &Target) -> BTreeSet<String> {
    target.columns().iter().filter_map(|column| column.strip_suffix("_deg")).map(str::to_owned).collect()
}

/// What recordings have to hold for a target: its joints and no others; the clock in the picture where these results
/// need it.
fn only_joints(joints: BTreeSet<String>, own: &Demand) -> Demand {
    Demand { parts: BTreeSet::new(), joints: Some(joints), clock: own.clock }
}

/// The RMSE of each target against what was measured; `on` which rows, where that has to be said.
fn measured(merit: &Merit, on: &str) -> Vec<Quality> {
    let one = |(column, rmse): &(String, f64)| Quality {
        what: format!("{column}{on}"),
        value: *rmse,
        unit: match column.rsplit_once('_') {
            Some((_, "N")) => "N RMS",
            Some((_, "deg")) => "degrees RMS",
            _ => "RMS",
        }
        .to_owned(),
        against_truth: true,
    };
    merit.rmse.0.iter().filter(|(_, rmse)| rmse.is_finite()).map(one).collect()
}
