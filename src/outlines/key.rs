//! What a page says: a key, or what a pointer did, at the nail that it showed.

use super::shape::Stride;

/// Farthest that anything is moved at once, pixels: more is no person.
const FARTHEST_PX: f64 = 1e6;

/// A key, and the nail that was seen when it was pressed.
#[derive(Debug, Clone, Copy, PartialEq, serde::Deserialize)]
pub(super) struct Press {
    /// A key at a nail that is not shown any more does nothing; none: whatever is shown.
    #[serde(default)]
    pub(super) nail: Option<usize>,
    #[serde(flatten)]
    pub(super) key: Key,
}

/// What is to happen.
#[derive(Debug, Clone, Copy, PartialEq, serde::Deserialize)]
#[serde(tag = "key", rename_all = "snake_case")]
pub(super) enum Key {
    /// It is a nail, so; the next one.
    Accept,
    /// It is none; the next one.
    Reject,
    Next,
    Previous,
    Undo,
    /// As it was at first.
    Reset,
    /// All, or the corner that was chosen: steps right and down.
    Move {
        by: [f64; 2],
        #[serde(default)]
        stride: Stride,
    },
    /// Steps longer and wider; of the corner that was chosen, outwards.
    Grow {
        by: [f64; 2],
        #[serde(default)]
        stride: Stride,
    },
    /// Steps clockwise.
    Turn {
        by: f64,
        #[serde(default)]
        stride: Stride,
    },
    /// Steps clockwise, the axis alone.
    TurnAxis {
        by: f64,
    },
    Flip,
    /// The border is looked for from here.
    Snap,
    /// The next corner around, or the one before.
    Corner {
        forwards: bool,
    },
    /// This corner, or none.
    Choose {
        corner: Option<usize>,
    },
    Insert,
    Remove,
    /// All of it there.
    Place {
        to_px: [f64; 2],
    },
    /// Of one gesture of a pointer, so far: a corner, or all.
    Drag {
        gesture: u64,
        corner: Option<usize>,
        by_px: [f64; 2],
    },
    /// All of the photograph, or the nail.
    Zoom,
    /// Another nail on this photograph.
    Another,
}

impl Press {
    /// `None` where it is none, or no person could mean it.
    pub(super) fn read(json: &[u8]) -> Option<Self> {
        let press: Self = serde_json::from_slice(json).ok()?;
        let moved = match press.key {
            Key::Move { by, .. } | Key::Grow { by, .. } => by.map(|steps| 1e4 * steps),
            Key::Turn { by, .. } | Key::TurnAxis { by } => [1e4 * by; 2],
            Key::Place { to_px } => to_px,
            Key::Drag { by_px, .. } => by_px,
            _ => [0.0; 2],
        };
        moved.iter().all(|px| px.abs() <= FARTHEST_PX).then_some(press)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_read_and_what_is_none_is_not() {
        let read = |json: &str| Press::read(json.as_bytes());
        assert_eq!(read(r#"{"key":"accept","nail":3}"#), Some(Press { nail: Some(3), key: Key::Accept }));
        let moved = Key::Move { by: [1.0, 0.0], stride: Stride::Coarse };
        assert_eq!(read(r#"{"key":"move","by":[1,0],"stride":"coarse"}"#), Some(Press { nail: None, key: moved }));
        assert_eq!(read(r#"{"key":"choose","corner":null}"#).map(|p| p.key), Some(Key::Choose { corner: None }));
        for wrong in [
            "",
            "{}",
            r#"{"key":"explode"}"#,
            r#"{"key":"move"}"#,
            r#"{"key":"move","by":[1e9,0]}"#,
            r#"{"key":"drag","gesture":-1,"by_px":[0,0]}"#,
            r#"{"key":"place","to_px":[1e300,0]}"#,
            r#"{"key":"accept","nail":"1"}"#,
        ] {
            assert_eq!(read(wrong), None, "{wrong}");
        }
    }
}
