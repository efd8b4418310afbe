//! Parameters from a file, the thesis' table, and single values named on the command line.

use std::path::PathBuf;

use lunula_hemodynamics::{Parameters, Symbol};

use crate::hemodynamics::HemodynamicsError;

/// Which parameters.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct GivenParameters {
    /// A file of the thesis' symbols; none: the thesis' table.
    pub file: Option<PathBuf>,
    /// Capillary units along the nail; none: what the file says, or two.
    pub units: Option<usize>,
    /// Single values, which go before the file's.
    pub set: Vec<(Symbol, f64)>,
}

impl GivenParameters {
    /// Reads and checks them.
    ///
    /// # Errors
    /// [`HemodynamicsError`] with every fault of the file, or of the single values.
    pub fn read(&self) -> Result<Parameters, HemodynamicsError> {
        let parameters = match &self.file {
            None => Parameters::along_nail(self.units.unwrap_or(2))?,
            Some(path) => {
                let text =
                    crate::input::read_text(path).map_err(|why| HemodynamicsError::Open { path: path.clone(), why })?;
                let parameters = Parameters::from_toml(&text)
                    .map_err(|why| HemodynamicsError::ParameterFile { path: path.clone(), why })?;
                let found = parameters.units().len();
                if let Some(units) = self.units.filter(|&units| units != found) {
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
        for one in &self.set {
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
