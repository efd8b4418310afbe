//! One finger of a session: its sensor's source, a force transducer's where that is a device of its own, and what is
//! done with its rows.

use std::ops::ControlFlow;

use lunula_live::latency::Latency as Times;
use lunula_live::source::{Event, HostClock, State};
use lunula_live::wire::Row;

use super::columns::StreamColumns;
use super::decide::{Decide, Kept, Plan};
use super::feed::{Feed, is_away};
use super::open::source_fault;
use super::outputs::Outputs;
use super::outputs::samples::Samples;
use crate::live::error::LiveError;
use crate::live::onlooker::Onlooker;
use crate::log::LogReading;

/// A finger.
pub(super) struct Lane<'a> {
    pub(super) feed: Feed<'a>,
    pub(super) force: Option<Feed<'a>>,
    pub(super) work: Work,
}

/// What is done with a finger's rows, once the columns are known.
pub(super) struct Work {
    pub(super) plan: Option<Plan>,
    pub(super) decide: Option<Decide>,
    /// Columns of forces that were named before the sensor's.
    forces: Option<Vec<String>>,
    forces_ended: bool,
    /// Its name in front of messages, where there are several.
    label: String,
    finger: Option<String>,
    /// Its place among the fingers.
    place: usize,
}

/// What all fingers of a session share.
pub(super) struct Shared<'a> {
    pub(super) clock: HostClock,
    pub(super) tell: &'a dyn Fn(&str),
    pub(super) log: &'a LogReading,
    pub(super) outputs: Outputs,
    pub(super) notes: Vec<String>,
    pub(super) work: Times,
    pub(super) arrival: Times,
    pub(super) seconds: Option<f64>,
    pub(super) ends: bool,
    /// Who looks on, and the columns and cells that it adds to what is recorded.
    pub(super) onlooker: Option<(&'a mut dyn Onlooker, &'a [&'a str])>,
    pub(super) cells: String,
}

impl Shared<'_> {
    fn note(&mut self, label: &str, notes: Vec<String>) {
        for note in notes {
            let note = format!("{label}{note}");
            (self.tell)(&format!("note: {note}"));
            self.notes.push(note);
        }
    }

    fn state(&mut self, (label, place): (&str, usize), is_force: bool, state: State) {
        let of = if is_force { "force: " } else { "" };
        (self.tell)(&format!("state: {label}{of}{}", state.condition.word()));
        if let Some((onlooker, _)) = &mut self.onlooker {
            onlooker.state(is_force, state.condition);
        }
        if let Some(view) = self.outputs.view.as_mut().filter(|_| !is_force) {
            view.state(place, state.condition.word());
        }
    }

    /// Somebody who looks on hears what was recorded.
    fn heard(&mut self, decide: &mut Decide) {
        if let (Some((onlooker, _)), Some(samples)) = (&mut self.onlooker, &mut decide.samples) {
            samples.heard().for_each(|force_n| onlooker.recorded(force_n));
        }
    }
}

impl<'a> Lane<'a> {
    pub(super) fn new(feed: Feed<'a>, force: Option<Feed<'a>>, plan: Plan) -> Self {
        let finger = plan.finger.as_ref().map(|(finger, _)| finger.clone());
        let label = finger.as_ref().map_or(String::new(), |finger| format!("{finger}: "));
        let place = plan.finger.as_ref().map_or(0, |(_, place)| *place);
        let work = Work { plan: Some(plan), decide: None, forces: None, forces_ended: false, label, finger, place };
        Self { feed, force, work }
    }

    /// Whose it is, where there are several.
    pub(super) fn finger(&self) -> Option<String> {
        self.work.finger.clone()
    }

    /// Its sources: the sensor's first.
    pub(super) fn feeds(&self) -> impl Iterator<Item = &Feed<'a>> {
        std::iter::once(&self.feed).chain(&self.force)
    }

    /// See [`feeds`](Self::feeds).
    pub(super) fn feeds_mut(&mut self) -> impl Iterator<Item = &mut Feed<'a>> {
        std::iter::once(&mut self.feed).chain(&mut self.force)
    }

    /// Takes what has come from the sensor.
    ///
    /// # Errors
    /// A source that can't go on, columns that lack, results that can't be written.
    pub(super) fn poll(&mut self, shared: &mut Shared<'_>) -> Result<(), LiveError> {
        self.work.take(&mut self.feed, false, shared)
    }

    /// Takes what has come from the force transducer.
    pub(super) fn poll_force(&mut self, shared: &mut Shared<'_>) -> Result<(), LiveError> {
        self.force.as_mut().map_or(Ok(()), |feed| self.work.take(feed, true, shared))
    }

    /// When a watchdog lets go, nanoseconds of the host's clock; within a second.
    pub(super) fn due_ns(&self, now_ns: u64) -> Option<u64> {
        let due_s = self.work.decide.as_ref().and_then(Decide::due_s).filter(|_| self.feed.stream.is_live())?;
        let left_s = due_s - self.feed.stream.stream_now_s(now_ns);
        Some(now_ns + 1 + (1e9 * left_s.clamp(0.0, 1.0)) as u64)
    }

    /// Whether nothing more comes of it: no rows, and no force that a row waits for.
    pub(super) fn is_over(&self) -> bool {
        let samples = self.work.decide.as_ref().and_then(|decide| decide.samples.as_ref());
        self.feed.stream.ended() && !samples.is_some_and(Samples::is_waiting)
    }

    /// Time has passed.
    pub(super) fn advance(&mut self, now_ns: u64, shared: &mut Shared<'_>) -> Result<(), LiveError> {
        let Some(decide) = self.work.decide.as_mut().filter(|_| self.feed.stream.is_live()) else { return Ok(()) };
        decide.advance(self.feed.stream.stream_now_s(now_ns), &mut shared.outputs)?;
        let settled = decide.samples.as_mut().map_or(Ok(()), |samples| samples.settle(1e-9 * now_ns as f64));
        shared.heard(decide);
        settled
    }
}

impl Work {
    /// Takes what has come from a source: the sensor, or the force transducer.
    fn take(&mut self, feed: &mut Feed<'_>, is_force: bool, shared: &mut Shared<'_>) -> Result<(), LiveError> {
        // What is left of a sensor's stream lies behind the end.
        if shared.ends && !is_force {
            return Ok(());
        }
        let Feed { source, stream, recognizer, health } = feed;
        let is_live = stream.is_live();
        let mut fault = None;
        let now_ns = shared.clock.now_ns();
        let mut on = |event: Event<'_>| {
            let done = match event {
                Event::Columns(_) => {
                    let columns = recognizer.take();
                    health.by_arrival = !columns.time;
                    if is_force { self.join(columns.values, shared) } else { self.begin(columns, shared) }
                }
                Event::Row(row) => {
                    // Of a recording many rows are handed out at one time.
                    let begin_ns = if is_live { row.host_ns } else { shared.clock.now_ns() };
                    health.row(row, &mut shared.arrival);
                    let common_s = health.common_s(row);
                    if is_force {
                        self.force(row, common_s, shared)
                    } else {
                        let done = self.row(row, common_s, shared);
                        shared.work.record_ns(shared.clock.now_ns().saturating_sub(begin_ns));
                        done
                    }
                }
                Event::Spoilt { .. } => {
                    health.spoilt();
                    Ok(())
                }
                Event::State(state) => {
                    shared.state((&self.label, self.place), is_force, state);
                    if !is_force && is_away(state.condition) { self.lose(false, shared) } else { Ok(()) }
                }
                Event::End if is_force => self.end_forces(shared),
                Event::End => self.lose(true, shared),
            };
            fault = done.err();
            // Forces are heard on: rows that are recorded wait for them.
            if fault.is_some() || shared.ends && !is_force { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        stream.poll(now_ns, &mut on).map_err(|why| source_fault(source, why))?;
        fault.map_or(Ok(()), Err)
    }

    /// The sensor's columns are known.
    fn begin(&mut self, columns: StreamColumns, shared: &mut Shared<'_>) -> Result<(), LiveError> {
        let Some(plan) = self.plan.take() else { return Ok(()) };
        let mut notes = Vec::new();
        let decide = Decide::new(plan, columns, shared.log, &mut notes);
        shared.note(&self.label, notes);
        let mut decide = decide?;
        if let Some((onlooker, more)) = &mut shared.onlooker {
            let joins = decide.samples.as_ref().is_some_and(Samples::joins_forces);
            onlooker.begin(&decide.columns, joins)?;
            decide.samples.as_mut().into_iter().for_each(|samples| samples.attended(more));
        }
        if let Some(view) = &mut shared.outputs.view {
            decide.show(view);
        }
        self.decide = Some(decide);
        shared.outputs.begin()?;
        if let Some(names) = self.forces.take() {
            self.join(names, shared)?;
        }
        if self.forces_ended { self.end_forces(shared) } else { Ok(()) }
    }

    /// The force transducer's columns are known.
    fn join(&mut self, names: Vec<String>, shared: &mut Shared<'_>) -> Result<(), LiveError> {
        match self.decide.as_mut().and_then(|decide| decide.samples.as_mut()) {
            Some(samples) => {
                if let Some((onlooker, _)) = &mut shared.onlooker {
                    onlooker.join(&names)?;
                }
                samples.join(&names).map_err(LiveError::Request)
            }
            None => {
                self.forces = Some(names);
                Ok(())
            }
        }
    }

    fn end_forces(&mut self, shared: &mut Shared<'_>) -> Result<(), LiveError> {
        self.forces_ended = true;
        let Some(decide) = &mut self.decide else { return Ok(()) };
        let ended = decide.samples.as_mut().map_or(Ok(()), Samples::end_forces);
        shared.heard(decide);
        ended
    }

    /// A sample of the force transducer.
    fn force(&mut self, row: &Row<'_>, common_s: f64, shared: &mut Shared<'_>) -> Result<(), LiveError> {
        if let Some((onlooker, _)) = &mut shared.onlooker {
            onlooker.force(row, common_s);
        }
        let Some(decide) = &mut self.decide else { return Ok(()) };
        let forces = decide.samples.as_mut();
        let known = forces.map_or(Ok(()), |samples| samples.force(common_s, row.values, row.begins));
        shared.heard(decide);
        known
    }

    fn row(&mut self, row: &Row<'_>, common_s: f64, shared: &mut Shared<'_>) -> Result<(), LiveError> {
        let Some(decide) = &mut self.decide else { return Ok(()) };
        let kept = match &mut shared.onlooker {
            None => Kept::Usual,
            Some((onlooker, _)) => {
                shared.cells.clear();
                let kept = onlooker.sample(row, common_s, &mut shared.cells);
                shared.ends |= onlooker.is_over();
                kept.map_or(Kept::Not, |time_s| Kept::At(time_s, &shared.cells))
            }
        };
        decide.row(row, common_s, kept, &mut shared.outputs)?;
        if let Some(what) = decide.answers.as_mut().and_then(|answers| answers.sensor.stops.take()) {
            (shared.tell)(&format!("warning: {}{what} stand(s) still at {common_s:.3} s", self.label));
        }
        shared.heard(decide);
        if let (Some(seconds), Some([from_s, to_s])) = (shared.seconds, decide.span_s) {
            shared.ends |= to_s - from_s >= seconds;
        }
        Ok(())
    }

    /// The source is lost, or ends.
    pub(super) fn lose(&mut self, ends: bool, shared: &mut Shared<'_>) -> Result<(), LiveError> {
        self.decide.as_mut().map_or(Ok(()), |decide| decide.lose(ends, &mut shared.outputs))
    }
}
