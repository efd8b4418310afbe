//! What is to be predicted: forces, posture, or other columns of the table.

use lunula_predictor::FORCES;

/// The posture that is predicted (5.1.2): J2, which stands for the coupled flexion of PIP and DIP.
pub const POSTURE: &str = "J2_deg";

/// Columns to be predicted.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Target(Vec<String>);

impl Target {
    /// `force`, `posture`, or names of columns with commas in between.
    ///
    /// # Errors
    /// An empty name, or one that is there twice; in words.
    pub fn parse(text: &str) -> Result<Self, String> {
        let columns: Vec<String> = match text {
            "force" => FORCES.map(str::to_owned).to_vec(),
            "posture" => vec![POSTURE.to_owned()],
            other => other.split(',').map(|name| name.trim().to_owned()).collect(),
        };
        if let Some(wrong) =
            columns.iter().enumerate().find(|(k, name)| name.is_empty() || columns[..*k].contains(name))
        {
            return Err(format!(
                "`{}` is empty or there twice; write force, posture or columns as Fz_N,J3_deg",
                wrong.1
            ));
        }
        Ok(Self(columns))
    }

    /// The columns' names.
    #[must_use]
    pub fn columns(&self) -> &[String] {
        &self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn targets_are_forces_posture_or_columns() {
        assert_eq!(Target::parse("force").unwrap().columns(), ["Fx_N", "Fy_N", "Fz_N"]);
        assert_eq!(Target::parse("posture").unwrap().columns(), ["J2_deg"]);
        assert_eq!(Target::parse("Fz_N, J3_deg").unwrap().columns(), ["Fz_N", "J3_deg"]);
        assert!(Target::parse("").is_err() && Target::parse("Fz_N,Fz_N").is_err());
    }
}
