//! What a recording says of true contact: a column of 0 and 1, or a force beyond a threshold.

use std::fmt;
use std::str::FromStr;

use crate::job::number;

/// A column, and what of it is contact.
#[derive(Debug, Clone, PartialEq)]
pub struct TrueContact {
    /// Its name.
    pub column: String,
    side: Side,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Side {
    /// 1 is contact, 0 is none.
    Flag,
    Below(f64),
    Above(f64),
}

impl FromStr for TrueContact {
    type Err = String;

    /// Reads `contact`, `Fz_N<-0.2` or `force>0.2`.
    fn from_str(text: &str) -> Result<Self, String> {
        const EXAMPLE: &str = "write a column of 0 and 1, as contact, or a force with its threshold, as Fz_N<-0.2";
        let (column, side) = match text.split_once(['<', '>']) {
            None => (text, Side::Flag),
            Some((column, threshold)) => {
                let threshold = number(threshold).map_err(|_| EXAMPLE.to_owned())?;
                let below = text.contains('<');
                (column, if below { Side::Below(threshold) } else { Side::Above(threshold) })
            }
        };
        let column = column.trim().to_owned();
        if column.is_empty() { Err(EXAMPLE.to_owned()) } else { Ok(Self { column, side }) }
    }
}

impl fmt::Display for TrueContact {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.side {
            Side::Flag => write!(to, "{}", self.column),
            Side::Below(threshold) => write!(to, "{}<{threshold}", self.column),
            Side::Above(threshold) => write!(to, "{}>{threshold}", self.column),
        }
    }
}

impl TrueContact {
    /// Whether a value is contact; none where it is not known.
    ///
    /// # Errors
    /// A flag that is neither 0 nor 1.
    pub fn of(&self, value: f64) -> Result<Option<bool>, f64> {
        if value.is_nan() {
            return Ok(None);
        }
        match self.side {
            Side::Below(threshold) => Ok(Some(value < threshold)),
            Side::Above(threshold) => Ok(Some(value > threshold)),
            Side::Flag if value == 1.0 => Ok(Some(true)),
            Side::Flag if value == 0.0 => Ok(Some(false)),
            Side::Flag => Err(value),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contact_is_a_flag_or_a_force_beyond_a_threshold() {
        let read = |text: &str| text.parse::<TrueContact>().unwrap();
        let below = read("Fz_N < -0.2");
        assert_eq!((below.column.as_str(), below.to_string().as_str()), ("Fz_N", "Fz_N<-0.2"));
        assert_eq!([-0.3, -0.2, f64::NAN].map(|value| below.of(value)), [Ok(Some(true)), Ok(Some(false)), Ok(None)]);
        assert_eq!([0.3, 0.1].map(|value| read("f>0.2").of(value)), [Ok(Some(true)), Ok(Some(false))]);
        assert_eq!([1.0, 0.0, 0.5].map(|v| read("contact").of(v)), [Ok(Some(true)), Ok(Some(false)), Err(0.5)]);
        for bad in ["", "<1", "Fz_N<", "Fz_N<x"] {
            assert!(bad.parse::<TrueContact>().unwrap_err().contains("Fz_N<-0.2"), "{bad}");
        }
    }
}
