//! Where photodiodes lie on a nail: `positions.toml`, or the same as JSON (`layout.json`).
//!
//! In: a file's text. Out: [`Positions`], each in the nail's own frame: `u` across the nail in half widths, positive to
//! the right of the photograph with the tip up, `v` along its axis in half lengths, positive to the tip (distal), both
//! from the middle of the outline's box. A photodiode averages over a disc.
//!
//! ```toml
//! name = "my sensor"
//! nail_width_mm = 12.0     # what a millimetre is on a nail of another width
//! diameter_mm = 1.0        # of the disc that one photodiode sees
//!
//! [[photodiode]]
//! name = "P1"
//! u = 0.0
//! v = 0.72
//! ```
//!
//! The thesis prints its places in a picture only (Fig. 16). [`Positions::thesis`] is read off its words: P1 and P2
//! toward the distal end, P3 and P4 toward the proximal end (3.3.2); P2, P3 and P4 respond alike to either lateral
//! shear, so they lie on the axis; P7 left and P5 right (3.3.3); P6 and P8, which no sentence places, proximal of them.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// More photodiodes than fit on a nail (assumed).
const MOST: usize = 64;
/// So many in one quarter are hardly meant (assumed).
const QUARTER: usize = 4;
/// Widths of a nail, millimetres: a baby's to more than a large thumb's (assumed).
const NAIL_WIDTH_MM: std::ops::RangeInclusive<f64> = 3.0..=30.0;

/// Why a file is no list of photodiodes' places.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{0}")]
pub struct PositionsFault(String);

/// One photodiode on the nail.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Position {
    /// The column's name in logs: `P1`.
    pub name: String,
    /// Across the nail, half widths from the middle; right is positive with the tip up.
    pub u: f64,
    /// Along the axis, half lengths from the middle; distal is positive.
    pub v: f64,
}

/// The photodiodes of a sensor, real or virtual.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Positions {
    /// Where the places come from, in words.
    pub name: String,
    /// The nail's width to which the disc's diameter refers, millimetres.
    pub nail_width_mm: f64,
    /// The disc that each photodiode averages over, millimetres.
    pub diameter_mm: f64,
    /// In the order of the columns.
    #[serde(rename = "photodiode")]
    pub photodiodes: Vec<Position>,
}

impl Positions {
    /// The thesis' eight, read off its words (module's head): dies of 1 mm on a nail 12 mm wide.
    #[must_use]
    pub fn thesis() -> Self {
        const PLACES: [(&str, f64, f64); 8] = [
            ("P1", 0.0, 0.72),
            ("P2", 0.0, 0.28),
            ("P3", 0.0, -0.14),
            ("P4", 0.0, -0.56),
            ("P5", 0.58, 0.36),
            ("P6", 0.58, -0.14),
            ("P7", -0.58, 0.36),
            ("P8", -0.58, -0.14),
        ];
        Self {
            name: "thesis (read off its words)".to_owned(),
            nail_width_mm: 12.0,
            diameter_mm: 1.0,
            photodiodes: PLACES.map(|(name, u, v)| Position { name: name.to_owned(), u, v }).to_vec(),
        }
    }

    /// Reads `positions.toml`.
    ///
    /// # Errors
    /// [`PositionsFault`] with line and column where the text is no TOML or has other keys; what is wrong of a
    /// photodiode, by its name.
    pub fn from_toml(text: &str) -> Result<Self, PositionsFault> {
        let read: Self = toml::from_str(text).map_err(|e| PositionsFault(e.to_string().trim_end().to_owned()))?;
        read.checked()
    }

    /// Reads the same as JSON: what [`serde_json`] writes of it.
    ///
    /// # Errors
    /// As [`Positions::from_toml`].
    pub fn from_json(text: &str) -> Result<Self, PositionsFault> {
        let read: Self = serde_json::from_str(text).map_err(|e| PositionsFault(e.to_string()))?;
        read.checked()
    }

    /// The disc's radius as a share of the nail's width.
    #[must_use]
    pub fn radius_widths(&self) -> f64 {
        0.5 * self.diameter_mm / self.nail_width_mm
    }

    /// Photodiodes that share one place, a list for each such place.
    #[must_use]
    pub fn at_one_place(&self) -> Vec<Vec<&str>> {
        let mut places: Vec<(&Position, Vec<&str>)> = Vec::new();
        for place in &self.photodiodes {
            match places.iter_mut().find(|(first, _)| first.u == place.u && first.v == place.v) {
                Some((_, names)) => names.push(&place.name),
                None => places.push((place, vec![&place.name])),
            }
        }
        places.into_iter().map(|(_, names)| names).filter(|names| names.len() > 1).collect()
    }

    /// What to say of several photodiodes in one quarter of the nail: places as a picture's are counted, from a corner.
    #[must_use]
    pub fn in_one_quarter(&self) -> Option<String> {
        let one_side = |of: fn(&Position) -> f64| {
            let mut sides = self.photodiodes.iter().map(of);
            let first = sides.next().unwrap_or(0.0);
            sides.all(|place| place * first >= 0.0)
        };
        (self.photodiodes.len() >= QUARTER && one_side(|one| one.u) && one_side(|one| one.v)).then(|| {
            format!(
                "all {} photodiodes lie in one quarter of the nail: u and v go from -1 to 1 from its middle, to the \
                 right and towards the tip; are these shares of the whole nail, from a corner?",
                self.photodiodes.len()
            )
        })
    }

    fn checked(self) -> Result<Self, PositionsFault> {
        let fault = |text: String| Err(PositionsFault(text));
        if !NAIL_WIDTH_MM.contains(&self.nail_width_mm) {
            let (least, most) = (NAIL_WIDTH_MM.start(), NAIL_WIDTH_MM.end());
            return fault(format!("nail_width_mm is {}; a nail is {least} to {most} mm wide", self.nail_width_mm));
        }
        if !(self.diameter_mm > 0.0 && self.diameter_mm <= 0.5 * self.nail_width_mm) {
            return fault(format!(
                "diameter_mm is {}; give more than 0 and at most half of nail_width_mm",
                self.diameter_mm
            ));
        }
        if self.photodiodes.is_empty() || self.photodiodes.len() > MOST {
            let count = self.photodiodes.len();
            return fault(format!("{count} photodiodes; give 1 to {MOST} [[photodiode]] tables"));
        }
        let mut names = BTreeSet::new();
        for Position { name, .. } in &self.photodiodes {
            let letters = name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
            if !(letters && name.starts_with(|c: char| c.is_ascii_alphabetic())) {
                return fault(format!("a photodiode is called {name:?}; use letters, digits and _, a letter first"));
            }
            if !names.insert(name) {
                return fault(format!("two photodiodes are called {name}"));
            }
        }
        let is_outside = |one: &&Position| !(one.u.abs() <= 1.0 && one.v.abs() <= 1.0);
        let outside = self.photodiodes.iter().filter(is_outside);
        let outside: Vec<String> = outside.map(|one| format!("{} at u = {}, v = {}", one.name, one.u, one.v)).collect();
        if !outside.is_empty() {
            return fault(format!(
                "outside of the nail: {}; u and v are -1 to 1 (half widths, half lengths)",
                outside.join("; ")
            ));
        }
        Ok(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_thesis_eight_survive_toml_and_json() {
        let thesis = Positions::thesis();
        let json = serde_json::to_string(&thesis).unwrap();
        assert_eq!(Positions::from_json(&json).unwrap(), thesis);
        assert_eq!(Positions::from_toml(&toml::to_string(&thesis).unwrap()).unwrap(), thesis);
        assert!((thesis.radius_widths() - 1.0 / 24.0).abs() <= 1e-15);
    }

    #[test]
    fn all_places_outside_of_the_nail_are_named() {
        let text = "name = 'x'\nnail_width_mm = 12\ndiameter_mm = 1\n[[photodiode]]\nname = 'P3'\nu = 1.2\nv = 0\n\
                    [[photodiode]]\nname = 'P4'\nu = 1\nv = 0\n[[photodiode]]\nname = 'P5'\nu = 0\nv = -3\n";
        let fault = Positions::from_toml(text).unwrap_err().to_string();
        assert!(fault.starts_with("outside of the nail: P3 at u = 1.2, v = 0; P5 at u = 0, v = -3;"), "{fault}");
        let nan = Positions::from_toml(&text.replace("1.2", "nan")).unwrap_err().to_string();
        assert!(nan.contains("outside"), "{nan}");
    }

    #[test]
    fn places_counted_from_a_corner_are_doubted() {
        let thesis = Positions::thesis();
        assert_eq!(thesis.in_one_quarter(), None);
        let mut shares = thesis.clone();
        shares.photodiodes.iter_mut().for_each(|one| (one.u, one.v) = (0.5 + 0.5 * one.u, 0.5 + 0.5 * one.v));
        assert!(shares.in_one_quarter().is_some_and(|said| said.contains("all 8 photodiodes lie in one quarter")));
        shares.photodiodes.truncate(3);
        assert_eq!(shares.in_one_quarter(), None);
    }

    #[test]
    fn other_keys_twins_and_sizes_are_refused() {
        let good =
            "name = 'x'\nnail_width_mm = 12.0\ndiameter_mm = 1.0\n[[photodiode]]\nname = 'P1'\nu = 0.0\nv = 0.0\n";
        assert!(Positions::from_toml(good).is_ok());
        let twice = format!("{good}[[photodiode]]\nname = 'P1'\nu = 0.5\nv = 0.0\n");
        for (text, says) in [
            (good.replace("diameter_mm", "radius_mm"), "radius_mm"),
            (good.replace("diameter_mm = 1.0", "diameter_mm = 0.0"), "diameter_mm"),
            (good.replace("nail_width_mm = 12.0", "nail_width_mm = 0.0"), "nail_width_mm"),
            (good.replace("'P1'", "'time s'"), "letters"),
            (twice, "two photodiodes"),
            ("name = 'x'\nnail_width_mm = 12.0\ndiameter_mm = 1.0\nphotodiode = []\n".to_owned(), "0 photodiodes"),
        ] {
            let fault = Positions::from_toml(&text).unwrap_err().to_string();
            assert!(fault.contains(says), "{says}: {fault}");
        }
    }
}
