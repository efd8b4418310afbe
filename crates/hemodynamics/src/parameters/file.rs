//! Parameters as TOML: the thesis' symbols with their units as keys, as in `k_C1_N_per_m = 1e5`.
//!
//! `units` is the number of capillary units (2 where it is not said). Every parameter has to be there, unless
//! `base = "thesis"` says that what is missing is that of [`Parameters::along_nail`]. Unknown keys are refused, all
//! faults are reported at once.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::{ParameterFault, Parameters, Symbol};

impl Parameters {
    /// Reads a file's text. An error names every key that is unknown, missing, no number, or out of range.
    pub fn from_toml(text: &str) -> Result<Parameters, ParameterFault> {
        let mut table: BTreeMap<String, toml::Value> =
            toml::from_str(text).map_err(|error| ParameterFault::Syntax(error.to_string()))?;
        let mut faults = Vec::new();
        let units = match table.remove("units") {
            None => 2,
            Some(toml::Value::Integer(n)) if (1..=1000).contains(&n) => n as usize,
            Some(other) => {
                return Err(ParameterFault::Values(vec![format!(
                    "  units = {other}: it has to be a number from 1 to 1000"
                )]));
            }
        };
        let complete = match table.remove("base") {
            None => true,
            Some(toml::Value::String(base)) if base == "thesis" => false,
            Some(other) => {
                faults.push(format!("  base = {other}: there is only base = \"thesis\""));
                false
            }
        };
        let mut parameters = Parameters::along_nail(units)?;
        let mut missing = Vec::new();
        for symbol in parameters.symbols() {
            let key = symbol.to_string();
            match table.remove(&key).map(|value| (number(&value), value)) {
                None if complete => missing.push(key),
                None => {}
                Some((None, value)) => faults.push(format!("  {key} = {value}: it has to be a number")),
                Some((Some(value), _)) => match symbol.wrong(value) {
                    Some(wrong) => faults.push(format!("  {key} = {value}: {wrong}")),
                    None => *parameters.place(symbol).expect("a symbol of these units") = value,
                },
            }
        }
        for key in table.keys() {
            faults.push(match key.parse::<Symbol>() {
                Ok(_) => format!("  {key}: there are {units} units; say units = .. for more"),
                Err(_) => format!("  {key}: there is no such parameter"),
            });
        }
        if !missing.is_empty() {
            faults.push(format!("  missing: {}", missing.join(", ")));
            faults.push("  (a line base = \"thesis\" takes what is missing from the thesis' table)".into());
        }
        if faults.is_empty() {
            parameters.check_products(&mut faults);
        }
        if faults.is_empty() { Ok(parameters) } else { Err(ParameterFault::Values(faults)) }
    }

    /// As a file's text: every parameter, a line each. Read again it gives the same parameters to the last digit.
    pub fn to_toml(&self) -> String {
        let mut text = format!("units = {}\n", self.units.len());
        for symbol in self.symbols() {
            let value = self.get(symbol).expect("a symbol of these units");
            writeln!(text, "{symbol} = {value:e}").expect("writing to a string");
        }
        text
    }
}

/// A TOML number of either kind.
fn number(value: &toml::Value) -> Option<f64> {
    value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_gives_the_same_parameters_to_the_last_digit() {
        let parameters = Parameters::along_nail(3).unwrap();
        assert_eq!(Parameters::from_toml(&parameters.to_toml()), Ok(parameters));
    }

    #[test]
    fn with_the_thesis_as_base_a_file_holds_what_differs() {
        let parameters = Parameters::from_toml("base = \"thesis\"\nk_C1_N_per_m = 50_000\n").unwrap();
        let expected = Parameters::thesis().set("k_C1_N_per_m".parse().unwrap(), 5e4).unwrap();
        assert_eq!(parameters, expected);
    }

    #[test]
    fn all_faults_are_reported_at_once() {
        let text = "k_C1_N_per_m = -1\nk_C2_N_per_m = nan\nm_V_kg = 0\nb_V_N_s_per_m = 0.0\nspeed = 3\nD_V_m = \
                    \"wide\"\nk_C3_N_per_m = 1e5\n";
        let message = Parameters::from_toml(text).unwrap_err().to_string();
        for part in [
            "k_C1_N_per_m = -1: ",
            "k_C2_N_per_m = NaN: ",
            "m_V_kg = 0: ",
            "speed: ",
            "D_V_m = \"wide\": ",
            "missing: ",
        ] {
            assert!(message.contains(part), "{part} is not in\n{message}");
        }
        assert!(message.contains("k_C3_N_per_m: there are 2 units"), "{message}");
        assert!(!message.contains("b_V_N_s_per_m"), "no damping is allowed:\n{message}");
        assert!(message.contains("base = \"thesis\""), "{message}");
    }

    #[test]
    fn values_that_cannot_be_computed_with_are_refused() {
        let message = Parameters::from_toml("base = \"thesis\"\nD_V_m = 1e-90\n").unwrap_err().to_string();
        assert!(message.contains("V: N pi D^4"), "{message}");
    }

    #[test]
    fn a_file_of_a_thousand_units_called_two_is_refused_at_once() {
        // Thirteen thousand keys that are no parameters of two units: 30 ms.
        let text = Parameters::along_nail(1000).unwrap().to_toml().replace("units = 1000", "units = 2");
        let message = Parameters::from_toml(&text).unwrap_err().to_string();
        assert_eq!(message.matches("there are 2 units").count(), 13 * 998);
    }

    #[test]
    fn what_is_not_toml_is_reported_with_its_place() {
        let message = Parameters::from_toml("units = 2\nk_C1 =").unwrap_err().to_string();
        assert!(message.contains("line 2"), "{message}");
    }

    #[test]
    fn every_name_is_read_as_it_is_written() {
        let symbols = Parameters::along_nail(12).unwrap().symbols();
        assert_eq!(symbols.len(), 7 * 13 + 6 * 12 + 4);
        for symbol in symbols {
            assert_eq!(symbol.to_string().parse(), Ok(symbol));
        }
    }
}
