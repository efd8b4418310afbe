//! What a pointer says: moves, the button, scrolling, and what it did about its own state.

use std::io::{self, Write};

use serde::Serialize;

/// A button of the mouse.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Button {
    /// The main one.
    Left,
}

/// Why a pointer let go.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
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

/// Something that a pointer did. It is written as its time, the word of what was done, then what belongs to that.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Event {
    /// When it was decided, seconds of the stream's clock.
    #[serde(rename = "t")]
    pub t_s: f64,
    /// What was done.
    #[serde(flatten)]
    pub what: What,
}

/// What a pointer did.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(tag = "event", rename_all = "lowercase")]
pub enum What {
    /// The pointer moves by whole counts: x to the right for positive `Fx_N`, y down (towards the person) for negative
    /// `Fy_N`, as screens count.
    Move {
        /// Counts to the right.
        dx: i32,
        /// Counts down.
        dy: i32,
    },
    /// A button goes down or up.
    Button {
        /// Which.
        button: Button,
        /// Down, or up.
        down: bool,
    },
    /// The page scrolls by whole lines.
    Scroll {
        /// Lines up; negative: down.
        lines: i32,
    },
    /// The zero of the shear was set, while the finger did not touch.
    Zero {
        /// What now counts as no shear along x, N.
        #[serde(rename = "Fx_N")]
        fx_n: f64,
        /// Along y, N.
        #[serde(rename = "Fy_N")]
        fy_n: f64,
    },
    /// A button was held until it drags: until it is let go, motion counts from this shear.
    Drag {
        /// Shear along x, N.
        #[serde(rename = "Fx_N")]
        fx_n: f64,
        /// Along y, N.
        #[serde(rename = "Fy_N")]
        fy_n: f64,
    },
    /// The finger was seen lifted: from now on it moves and clicks.
    Ready,
    /// The pointer let go of everything, until the finger is seen lifted.
    Lost {
        /// Why.
        reason: Reason,
    },
}

impl Event {
    /// A line of JSON: `{"t":1.25,"event":"move","dx":1,"dy":0}`. Nothing is allocated.
    pub fn write_json(&self, to: &mut impl Write) -> io::Result<()> {
        serde_json::to_writer(&mut *to, self)?;
        to.write_all(b"\n")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EVENTS: [(Event, &str); 8] = [
        (Event { t_s: 1.25, what: What::Move { dx: 1, dy: 0 } }, r#"{"t":1.25,"event":"move","dx":1,"dy":0}"#),
        (
            Event { t_s: 2.0, what: What::Button { button: Button::Left, down: true } },
            r#"{"t":2.0,"event":"button","button":"left","down":true}"#,
        ),
        (Event { t_s: 0.1, what: What::Scroll { lines: -3 } }, r#"{"t":0.1,"event":"scroll","lines":-3}"#),
        (
            Event { t_s: 3.5, what: What::Zero { fx_n: 0.02, fy_n: -0.01 } },
            r#"{"t":3.5,"event":"zero","Fx_N":0.02,"Fy_N":-0.01}"#,
        ),
        (
            Event { t_s: 3.5, what: What::Drag { fx_n: 0.5, fy_n: 0.25 } },
            r#"{"t":3.5,"event":"drag","Fx_N":0.5,"Fy_N":0.25}"#,
        ),
        (Event { t_s: 0.0, what: What::Ready }, r#"{"t":0.0,"event":"ready"}"#),
        (
            Event { t_s: 9.0, what: What::Lost { reason: Reason::Watchdog } },
            r#"{"t":9.0,"event":"lost","reason":"watchdog"}"#,
        ),
        (
            Event { t_s: -1.234_567_890_123_456_7e-300, what: What::Move { dx: i32::MIN, dy: i32::MAX } },
            r#"{"t":-1.2345678901234568e-300,"event":"move","dx":-2147483648,"dy":2147483647}"#,
        ),
    ];

    #[test]
    fn every_event_is_a_line() {
        let mut bytes = Vec::new();
        EVENTS.iter().for_each(|(event, _)| event.write_json(&mut bytes).unwrap());
        let text = String::from_utf8(bytes).unwrap();
        let expected: Vec<&str> = EVENTS.iter().map(|(_, line)| *line).collect();
        assert_eq!(text.lines().collect::<Vec<_>>(), expected);
        assert!(text.ends_with('\n'));
    }

    #[test]
    fn nothing_is_allocated_for_a_line() {
        let counted = allocation_counter::measure(|| {
            for _ in 0..100 {
                EVENTS.iter().for_each(|(event, _)| event.write_json(&mut io::sink()).unwrap());
            }
        });
        assert_eq!(counted.count_total, 0);
    }

    #[test]
    fn a_writer_that_fails_says_so() {
        let mut full: [u8; 10] = [0; 10];
        assert_eq!(EVENTS[0].0.write_json(&mut &mut full[..]).unwrap_err().kind(), io::ErrorKind::WriteZero);
    }
}
