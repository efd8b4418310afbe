//! The chessboard: how many inner corners it has, and where they are on it.

use std::fmt;
use std::str::FromStr;

use serde::{Serialize, Serializer};

/// Inner corners of a chessboard: those at which four squares meet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BoardSize {
    /// Across.
    pub columns: usize,
    /// Down.
    pub rows: usize,
}

/// Corners a side that can be looked for.
const CORNERS: std::ops::RangeInclusive<usize> = 3..=50;

impl BoardSize {
    /// How many inner corners there are.
    #[must_use]
    pub fn count(self) -> usize {
        self.columns * self.rows
    }

    /// The corners on the board's plane, row after row, millimetres; the first is (0, 0, 0).
    #[must_use]
    pub fn points_mm(self, square_mm: f64) -> Vec<[f64; 3]> {
        let at = |k: usize| [(k % self.columns) as f64 * square_mm, (k / self.columns) as f64 * square_mm, 0.0];
        (0..self.count()).map(at).collect()
    }
}

impl FromStr for BoardSize {
    type Err = String;

    /// `COLUMNSxROWS`, as `9x6`.
    fn from_str(text: &str) -> Result<Self, String> {
        let sides = text.split_once(['x', 'X']).and_then(|(columns, rows)| {
            Some(Self { columns: columns.trim().parse().ok()?, rows: rows.trim().parse().ok()? })
        });
        let size = sides.ok_or("write how many inner corners it has across and down, as 9x6")?;
        if CORNERS.contains(&size.columns) && CORNERS.contains(&size.rows) {
            return Ok(size);
        }
        let (least, most) = (CORNERS.start(), CORNERS.end());
        Err(format!("a board has {least} to {most} inner corners a side, as 9x6 of 10 x 7 squares"))
    }
}

impl fmt::Display for BoardSize {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}x{}", self.columns, self.rows)
    }
}

impl Serialize for BoardSize {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// Reads the side of a square.
///
/// # Errors
/// What to write instead.
pub fn square_mm(text: &str) -> Result<f64, String> {
    let side: Option<f64> = text.trim().parse().ok();
    side.filter(|side| *side > 0.0 && *side <= 1e4).ok_or_else(|| "write a length in millimetres, as 20".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_board_is_read_and_its_corners_are_counted() {
        let board: BoardSize = "9x6".parse().unwrap();
        let points = board.points_mm(20.0);
        assert_eq!((board.to_string(), points.len()), ("9x6".to_owned(), 54));
        assert_eq!((points[0], points[8], points[53]), ([0.0; 3], [160.0, 0.0, 0.0], [160.0, 100.0, 0.0]));
        for wrong in ["9", "2x6", "9x600", "ax6", "-9x6", "9x6x2", ""] {
            assert!(wrong.parse::<BoardSize>().is_err(), "{wrong}");
        }
        assert!(["0", "-1", "nan", "inf", "wide"].iter().all(|wrong| square_mm(wrong).is_err()));
    }
}
