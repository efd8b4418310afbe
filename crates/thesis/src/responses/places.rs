//! Where photodiodes sit on the nail, for pictures arranged as Fig. 24, 27, 30 and 32 are.
//!
//! Fig. 16 is a picture; its words and those of 3.3 say that the eight are laterally symmetric, that P1 and P2 are
//! distal and P3 and P4 proximal, that P1 to P4 are over the middle (they answer alike to shear to either side, or not
//! at all), P5 on the right and P7 on the left. P6 and P8 are taken for the proximal neighbours of P5 and P7; of those
//! the thesis says nothing.

/// Rows from distal to proximal, each from left to right as seen from above; an empty name is a place without a
/// photodiode.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Places(pub Vec<Vec<String>>);

impl Default for Places {
    fn default() -> Self {
        let rows = [["", "P1", ""], ["P7", "P2", "P5"], ["P8", "P3", "P6"], ["", "P4", ""]];
        Self(rows.iter().map(|row| row.iter().map(|&name| name.to_owned()).collect()).collect())
    }
}

impl Places {
    /// Checks a sensor's own places.
    ///
    /// # Errors
    /// A photodiode twice, or none at all; the words say which.
    pub(crate) fn checked(rows: Vec<Vec<String>>) -> Result<Self, String> {
        let names: Vec<&String> = rows.iter().flatten().filter(|name| !name.is_empty()).collect();
        if names.is_empty() {
            return Err(
                "names no photodiode; write rows as [[\"\", \"P1\", \"\"], [\"P7\", \"P2\", \"P5\"]]".to_owned()
            );
        }
        match names.iter().enumerate().find(|(k, name)| names[..*k].contains(name)) {
            Some((_, twice)) => Err(format!("{twice} is at two places; name it once")),
            None => Ok(Self(rows)),
        }
    }

    /// Rows of what `own` makes of a photodiode, those of `names` without a place in rows of their own below; none
    /// where there is no photodiode.
    #[must_use]
    pub(crate) fn arrange<T>(&self, names: &[String], own: impl Fn(usize) -> T) -> Vec<Vec<Option<T>>> {
        let at = |name: &String| names.iter().position(|known| known == name).map(&own);
        let mut rows: Vec<Vec<Option<T>>> = self.0.iter().map(|row| row.iter().map(at).collect()).collect();
        rows.retain(|row| row.iter().any(Option::is_some));
        let width = self.0.iter().map(Vec::len).max().unwrap_or(1).max(1);
        let left: Vec<usize> =
            (0..names.len()).filter(|&k| !self.0.iter().flatten().any(|name| *name == names[k])).collect();
        rows.extend(left.chunks(width).map(|row| row.iter().map(|&k| Some(own(k))).collect()));
        rows
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eight_stand_as_on_the_nail_and_others_below() {
        let names: Vec<String> = (1..=9).map(|k| format!("P{k}")).collect();
        let rows = Places::default().arrange(&names, |k| k + 1);
        assert_eq!(rows[1], [Some(7), Some(2), Some(5)]);
        assert_eq!(rows[4], [Some(9)]);
        assert_eq!(Places::default().arrange(&names[1..2], |_| ()).len(), 1);
    }

    #[test]
    fn a_photodiode_is_at_one_place() {
        let row = |names: [&str; 2]| vec![names.map(str::to_owned).to_vec()];
        assert!(Places::checked(row(["P1", "P1"])).unwrap_err().contains("P1"));
        assert!(Places::checked(row(["", ""])).is_err());
        assert!(Places::checked(row(["P1", ""])).is_ok());
    }
}
