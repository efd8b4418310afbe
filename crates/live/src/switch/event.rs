//! What a switch says: press and release, when and why.

use std::io::{self, Write};

use serde::Serialize;

/// Press or release.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Turn {
    /// It is pressed from now on.
    Press,
    /// It is released.
    Release,
}

/// What made a switch turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Reason {
    /// The value.
    Value,
    /// Predictions beyond the trained voltages.
    Outside,
    /// No valid sample came for too long.
    Watchdog,
    /// The stream's clock was set back.
    Clock,
    /// The source was lost.
    Lost,
    /// The session ended.
    End,
}

/// A turn of a switch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SwitchEvent {
    /// When it was decided, seconds of the stream's clock.
    pub t_s: f64,
    /// Press or release.
    pub turn: Turn,
    /// Why.
    pub reason: Reason,
    /// The value then, N; NaN where it is not known.
    pub value: f64,
    /// How long after the threshold was crossed, seconds: what the holds cost; of a watchdog, the time without a valid
    /// sample.
    pub delay_s: f64,
}

impl SwitchEvent {
    /// A line of JSON: `{"t":12.08,"event":"press","reason":"value","finger":"index","switch":"x+","force_N":0.61,
    /// "delay_s":0.04}`; what is not known is left out, `value` is the key of the value. Nothing is allocated.
    pub fn write_json(
        &self,
        to: &mut impl Write,
        value: &str,
        finger: Option<&str>,
        switch: Option<&str>,
    ) -> io::Result<()> {
        write!(to, "{{\"t\":{},\"event\":", self.t_s)?;
        serde_json::to_writer(&mut *to, &self.turn)?;
        write!(to, ",\"reason\":")?;
        serde_json::to_writer(&mut *to, &self.reason)?;
        for (key, text) in [("finger", finger), ("switch", switch)] {
            if let Some(text) = text {
                write!(to, ",\"{key}\":")?;
                serde_json::to_writer(&mut *to, text)?;
            }
        }
        if self.value.is_finite() {
            write!(to, ",\"{value}\":{}", self.value)?;
        }
        // Without the rounding of a difference of times.
        writeln!(to, ",\"delay_s\":{}}}", (self.delay_s * 1e9).round() / 1e9)
    }
}
