//! Which model: the thesis' table or a file of parameters, single values instead of theirs, what happens where a vessel
//! closes, the optics.

use std::path::Path;

use clap::Args;
use lunula_hemodynamics::{Collapse, Parameters, Symbol};

use crate::hemodynamics::HemodynamicsError;
use crate::hemodynamics::choices::OpticsChoice;
use crate::job::one_of;

/// Which model.
#[derive(Debug, Clone, Default, PartialEq, Args)]
pub struct ModelOptions {
    /// What happens where a vessel closes: error, or contact (opposite walls push each other apart below a twentieth of
    /// the nominal diameter)
    #[arg(long, value_parser = one_of::<Collapse>(), default_value = "error")]
    pub collapse: Collapse,
    /// How light depends on the capillaries
    #[arg(long, value_parser = one_of::<OpticsChoice>(), default_value = "beer-lambert")]
    pub optics: OpticsChoice,
    /// Capillary units along the nail, each with its photodiode and its share of the distal load [default: as many as
    /// --params has, or 2, the thesis' model]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1000))]
    pub units: Option<u16>,
    /// A single parameter, such as b_V_N_s_per_m=300, which replaces that of --params; may be given more than once
    #[arg(long, value_name = "NAME=VALUE", value_parser = setting)]
    pub set: Vec<(Symbol, f64)>,
}

fn setting(text: &str) -> Result<(Symbol, f64), String> {
    let (name, value) = text.split_once('=').ok_or("write NAME=VALUE, such as k_C1_N_per_m=5e4")?;
    let value = value.trim().parse().map_err(|_| format!("{value}: is not a number"))?;
    Ok((name.trim().parse()?, value))
}

impl ModelOptions {
    /// The parameters of `file`, or the thesis' table, with the single values in place.
    ///
    /// # Errors
    /// [`HemodynamicsError`] with every fault of the file, or of the single values.
    pub fn parameters(&self, file: Option<&Path>) -> Result<Parameters, HemodynamicsError> {
        let parameters = match file {
            None => Parameters::along_nail(usize::from(self.units.unwrap_or(2)))?,
            Some(path) => {
                let parameters = read_parameters(path)?;
                let found = parameters.units().len();
                if let Some(units) = self.units.filter(|&units| usize::from(units) != found) {
                    let what = format!(
                        "--units {units}: {} has {found}; leave --units out, or write units = {units} there",
                        path.display()
                    );
                    return Err(HemodynamicsError::Options(vec![what]));
                }
                parameters
            }
        };
        let set = |parameters: Parameters, &(symbol, value): &(Symbol, f64)| parameters.set(symbol, value);
        let mut faults = Vec::new();
        for (at, one) in self.set.iter().enumerate() {
            if self.set[..at].iter().filter(|(symbol, _)| *symbol == one.0).count() == 1 {
                faults.push(format!("`{}` is given twice; set it once", one.0));
            }
            if let Err(why) = set(parameters.clone(), one) {
                faults.push(why.to_string());
            }
        }
        if !faults.is_empty() {
            return Err(HemodynamicsError::Options(faults));
        }
        Ok(self.set.iter().try_fold(parameters, set)?)
    }
}

/// Reads a file of parameters.
///
/// # Errors
/// [`HemodynamicsError`] with every fault of the file.
pub(in crate::hemodynamics) fn read_parameters(path: &Path) -> Result<Parameters, HemodynamicsError> {
    let text = crate::input::read_text(path).map_err(|why| HemodynamicsError::Open { path: path.to_owned(), why })?;
    Parameters::from_toml(&text).map_err(|why| HemodynamicsError::ParameterFile { path: path.to_owned(), why })
}
