//! A switch of a session: answers to presses and releases.

use lunula_live::switch::{Reading, Reason, Switch, SwitchEvent, Turn, compared};
use lunula_live::wire::Row;
use serde::Serialize;

use super::events::EventsFile;
use crate::live::error::LiveError;
use crate::live::session::columns::StreamColumns;

/// A switch of one finger.
pub(crate) struct SwitchOutput {
    switch: Switch,
    finger: Option<String>,
    /// Where in an answer the value is, and its sign.
    column: usize,
    sign: f64,
    /// Where a tracker's place is in a row.
    place: Option<[usize; 2]>,
    /// The switch under the press.
    name: Option<String>,
    /// What it did.
    pub(crate) counts: SwitchCounts,
}

/// What switches did in a session.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct SwitchCounts {
    /// Presses.
    pub presses: u64,
    /// Releases.
    pub releases: u64,
    /// Of these, those by the watchdog, a clock set back, a lost source or the session's end.
    pub let_go: u64,
}

impl SwitchOutput {
    /// A switch of these answers; `finger` where the session has several.
    ///
    /// # Errors
    /// A column that the models do not predict, places without a tracker.
    pub(crate) fn new(
        switch: Switch,
        finger: Option<String>,
        predicted: &[String],
        columns: &StreamColumns,
    ) -> Result<Self, LiveError> {
        let (name, sign) = compared(switch.config().column.as_deref());
        let column = predicted.iter().position(|one| one == name).ok_or_else(|| {
            LiveError::Request(format!(
                "the switch compares {name}, and the models predict {}; name a model of it",
                predicted.join(", ")
            ))
        })?;
        let place = columns.place("x_m").zip(columns.place("y_m")).map(|(x, y)| [x, y]);
        if place.is_none() && !switch.config().places.is_empty() {
            let what = "the switch has places, and the stream has no x_m and y_m of a tracker";
            return Err(LiveError::Request(what.to_owned()));
        }
        let finger = finger.or_else(|| switch.config().finger.clone());
        Ok(Self { switch, finger, column, sign, place, name: None, counts: SwitchCounts::default() })
    }

    /// Whether it is pressed.
    pub(crate) fn is_pressed(&self) -> bool {
        self.switch.is_pressed()
    }

    /// After how long without a valid sample it lets go, seconds; none where it waits for ever.
    pub(crate) fn watchdog_s(&self) -> Option<f64> {
        Some(self.switch.config().watchdog_s).filter(|watchdog_s| *watchdog_s > 0.0)
    }

    /// When its watchdog lets go.
    pub(crate) fn due_s(&self) -> Option<f64> {
        self.switch.due_s()
    }

    /// An answer to a row; the clock of `events` is ahead of the stream's by `ahead_s`.
    pub(crate) fn sample(
        &mut self,
        row: &Row<'_>,
        answer: &[f64],
        outside: bool,
        ahead_s: f64,
        events: Option<&mut EventsFile>,
    ) -> Result<(), LiveError> {
        self.find_place(row);
        let value = self.sign * answer[self.column];
        let event = self.switch.sample(row.time_s, Reading { value, outside });
        self.hear(event, ahead_s, events)
    }

    /// Time has passed without a row.
    pub(crate) fn advance(
        &mut self,
        now_s: f64,
        ahead_s: f64,
        events: Option<&mut EventsFile>,
    ) -> Result<(), LiveError> {
        let event = self.switch.advance(now_s);
        self.hear(event, ahead_s, events)
    }

    /// The source is lost, or the session ends.
    pub(crate) fn lose(
        &mut self,
        t_s: f64,
        reason: Reason,
        ahead_s: f64,
        events: Option<&mut EventsFile>,
    ) -> Result<(), LiveError> {
        let event = self.switch.lose(t_s, reason);
        self.hear(event, ahead_s, events)
    }

    /// Which switch is under the finger: while nothing is pressed it changes, so that the place where a press begins
    /// decides.
    fn find_place(&mut self, row: &Row<'_>) {
        let Some([x, y]) = self.place.filter(|_| !self.switch.is_pressed()) else { return };
        let found = self.switch.config().at(row.values[x], row.values[y]);
        if self.name.as_deref() != found {
            self.name = found.map(str::to_owned);
        }
    }

    fn hear(
        &mut self,
        event: Option<SwitchEvent>,
        ahead_s: f64,
        events: Option<&mut EventsFile>,
    ) -> Result<(), LiveError> {
        let Some(mut event) = event else { return Ok(()) };
        match event.turn {
            Turn::Press => self.counts.presses += 1,
            Turn::Release => {
                self.counts.releases += 1;
                self.counts.let_go += u64::from(!matches!(event.reason, Reason::Value | Reason::Outside));
            }
        }
        let Some(events) = events else { return Ok(()) };
        event.t_s += ahead_s;
        let config = self.switch.config();
        let name = self.name.as_deref().or(config.name.as_deref());
        let key = if config.column.is_some() { "value" } else { "force_N" };
        events.write(|line| event.write_json(line, key, self.finger.as_deref(), name))
    }
}
