//! What a pointer says: moves, the button, scrolling, and what it did about its own state.

use serde::ser::{Serialize, SerializeMap, Serializer};

/// A button of the mouse.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Button {
    /// The main one.
    Left,
}

/// Why a pointer let go.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reason {
    /// No valid sample came for too long.
    Watchdog,
    /// The stream's clock was set back, or leapt.
    Clock,
    /// The source was lost.
    Lost,
    /// The session ended, or another one begins.
    End,
}

/// An event. Times are seconds of the stream's clock.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Event {
    /// The pointer moves by whole counts: x to the right for positive `Fx_N`, y down (towards the person) for negative
    /// `Fy_N`, as screens count.
    Move {
        /// When.
        t_s: f64,
        /// Counts to the right.
        dx: i32,
        /// Counts down.
        dy: i32,
    },
    /// A button goes down or up.
    Button {
        /// When.
        t_s: f64,
        /// Which.
        button: Button,
        /// Down, or up.
        down: bool,
    },
    /// The page scrolls by whole lines.
    Scroll {
        /// When.
        t_s: f64,
        /// Lines up; negative: down.
        lines: i32,
    },
    /// The zero of the shear was set, while the finger did not touch.
    Zero {
        /// When.
        t_s: f64,
        /// What now counts as no shear along x, N.
        fx_n: f64,
        /// Along y, N.
        fy_n: f64,
    },
    /// A button was held until it drags: until it is let go, motion counts from this shear.
    Drag {
        /// When.
        t_s: f64,
        /// Shear along x, N.
        fx_n: f64,
        /// Along y, N.
        fy_n: f64,
    },
    /// The finger was seen lifted: from now on it moves and clicks.
    Ready {
        /// When.
        t_s: f64,
    },
    /// The pointer let go of everything, until the finger is seen lifted.
    Lost {
        /// When.
        t_s: f64,
        /// Why.
        reason: Reason,
    },
}

impl Button {
    /// As the events have it.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Left => "left",
        }
    }
}

impl Reason {
    /// As the events have it.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Watchdog => "watchdog",
            Self::Clock => "clock",
            Self::Lost => "lost",
            Self::End => "end",
        }
    }
}

impl Event {
    /// When it was decided, seconds of the stream's clock.
    #[must_use]
    pub fn t_s(&self) -> f64 {
        match *self {
            Self::Move { t_s, .. }
            | Self::Button { t_s, .. }
            | Self::Scroll { t_s, .. }
            | Self::Zero { t_s, .. }
            | Self::Drag { t_s, .. }
            | Self::Ready { t_s }
            | Self::Lost { t_s, .. } => t_s,
        }
    }

    /// The word of the key `event`.
    #[must_use]
    pub fn word(&self) -> &'static str {
        match self {
            Self::Move { .. } => "move",
            Self::Button { .. } => "button",
            Self::Scroll { .. } => "scroll",
            Self::Zero { .. } => "zero",
            Self::Drag { .. } => "drag",
            Self::Ready { .. } => "ready",
            Self::Lost { .. } => "lost",
        }
    }
}

/// `{"t":1.25,"event":"move","dx":1,"dy":0}`: the time, the word, then what belongs to it.
impl Serialize for Event {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("t", &self.t_s())?;
        map.serialize_entry("event", self.word())?;
        match self {
            Self::Move { dx, dy, .. } => {
                map.serialize_entry("dx", dx)?;
                map.serialize_entry("dy", dy)?;
            }
            Self::Button { button, down, .. } => {
                map.serialize_entry("button", button.word())?;
                map.serialize_entry("down", down)?;
            }
            Self::Scroll { lines, .. } => map.serialize_entry("lines", lines)?,
            Self::Zero { fx_n, fy_n, .. } | Self::Drag { fx_n, fy_n, .. } => {
                map.serialize_entry("Fx_N", fx_n)?;
                map.serialize_entry("Fy_N", fy_n)?;
            }
            Self::Ready { .. } => {}
            Self::Lost { reason, .. } => map.serialize_entry("reason", reason.word())?,
        }
        map.end()
    }
}
