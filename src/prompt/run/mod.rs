//! A protocol as it is gone through: which step, whether it waits, moves or stands still, and why.
//!
//! In: keys, samples, forces and the time of the server's clock, seconds. Out: what is prompted at any time
//! ([`Run::prompted`]), which rows are collected, and what happened ([`Turn`]). Nothing here reads a clock, so that a
//! simulated session is the same code as a real one.
//!
//! The prompt moves only while all is well: it stops when the person says so, when the page is hidden or gone, and when
//! no force or no sample has come for [`SILENT_S`]. What the program itself decides takes effect [`LEAD_S`] later, so
//! that the page knows of it before it is drawn; what the person decides takes effect when the key was pressed.

mod course;
mod gates;

pub(crate) use course::{Course, What};
pub(crate) use gates::{Gates, Verdict};

use serde::{Deserialize, Serialize};

use crate::prompt::protocol::{Check, Prompted, Protocol, Step, StepKind};

/// Without a force or a sample for so long the prompt stops, seconds.
pub(crate) const SILENT_S: f64 = 0.4;
/// How far ahead the program decides, seconds: longer than a message to a page takes.
pub(crate) const LEAD_S: f64 = 0.15;
/// A page that sends nothing for so long is gone, seconds.
pub(crate) const GONE_S: f64 = 2.0;
/// A key is not believed to be older than this, seconds.
const OLDEST_KEY_S: f64 = 0.5;
/// How hard to press for the check of the sign, newtons; at most half of the cone's height.
const SIGN_N: f64 = 1.0;

/// What a person, or the page, says.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Key {
    /// Begin, pause, go on.
    Go,
    /// The step from its beginning.
    Reset,
    /// The next step, whatever the checks say.
    Skip,
    /// The short extra trajectory, once all is done.
    Extra,
    /// Stop, and keep what there is; once stopped, end.
    Stop,
    /// The page can't be seen.
    Hidden,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Phase {
    /// For the person, who has read the step's text.
    Waiting,
    /// It moves, or checks.
    Running,
    /// It stands still until the person says so.
    Paused,
    /// It stands still until forces and samples come again.
    Stalled,
    /// All steps are done, or the person stopped.
    Done,
    /// Nobody wants more.
    Over,
}

impl Phase {
    /// As the page has it.
    #[must_use]
    pub(crate) fn word(&self) -> &'static str {
        match self {
            Self::Waiting => "waiting",
            Self::Running => "running",
            Self::Paused => "paused",
            Self::Stalled => "stalled",
            Self::Done => "done",
            Self::Over => "over",
        }
    }
}

/// Something that happened.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Turn {
    /// When, seconds of the server's clock.
    pub time_s: f64,
    /// In which step.
    pub step: String,
    /// The step's own time then, seconds.
    pub at_s: f64,
    /// What: `begins`, `paused`, ..
    pub event: &'static str,
    /// Why, where that is not plain.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub why: String,
    /// How long it stood still before, where it goes on, seconds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stood_s: Option<f64>,
}

/// A protocol under way.
#[derive(Debug, Clone)]
pub(crate) struct Run {
    /// With what was added.
    pub(in crate::prompt) protocol: Protocol,
    pub(in crate::prompt) course: Course,
    /// Which step; as many as there are once all are done.
    step: usize,
    phase: Phase,
    why: String,
    gates: Option<Gates>,
    force_s: f64,
    sample_s: f64,
    /// When the page was heard last; none where there is no page to wait for.
    page_s: Option<f64>,
    /// When it stopped, seconds.
    stood_from_s: f64,
    /// What happened so far.
    pub(in crate::prompt) turns: Vec<Turn>,
    /// Steps that were passed over, in words.
    pub(in crate::prompt) skipped: Vec<String>,
    /// Changes with whatever a page has to know at once.
    pub(in crate::prompt) version: u64,
}

impl Run {
    /// At the beginning; `has_page` where somebody has to look at a page for the prompt to move.
    #[must_use]
    pub(crate) fn new(protocol: Protocol, has_page: bool) -> Self {
        Self {
            protocol,
            course: Course::default(),
            step: 0,
            phase: Phase::Waiting,
            why: String::new(),
            gates: None,
            force_s: f64::NEG_INFINITY,
            sample_s: f64::NEG_INFINITY,
            page_s: has_page.then_some(f64::NEG_INFINITY),
            stood_from_s: 0.0,
            turns: Vec::new(),
            skipped: Vec::new(),
            version: 0,
        }
    }

    /// The photodiodes' names are known.
    pub(crate) fn begin(&mut self, photodiodes: Vec<String>, full_scale_v: Option<[f64; 2]>) {
        self.gates = Some(Gates::new(photodiodes, full_scale_v));
        self.version += 1;
    }

    /// A key at `key_s`, which came at `now_s`.
    pub(crate) fn key(&mut self, key: Key, key_s: f64, now_s: f64) {
        let key_s = if key_s.is_finite() { key_s.clamp(now_s - OLDEST_KEY_S, now_s) } else { now_s };
        match (key, &self.phase) {
            (Key::Go, Phase::Waiting) => self.begin_step(now_s),
            (Key::Go, Phase::Running) if self.is_moving() => self.stand(key_s, Phase::Paused, "paused", String::new()),
            (Key::Go, Phase::Stalled) => self.pause_stalled(now_s),
            (Key::Go, Phase::Paused) => self.go_on(now_s),
            (Key::Reset, Phase::Running | Phase::Paused | Phase::Stalled) => {
                let what = self.course.at(now_s).0.what;
                self.course.push(
                    now_s + LEAD_S,
                    0.0,
                    if what == What::Nothing { what } else { What::Step(self.step) },
                    false,
                );
                self.note(now_s, "reset", String::new(), None);
                self.enter(Phase::Waiting, String::new());
            }
            (Key::Skip, Phase::Waiting | Phase::Running | Phase::Paused | Phase::Stalled) => {
                let unmet = self.unmet();
                let name = self.name();
                let what = if unmet.is_empty() { "not done".to_owned() } else { unmet };
                self.skipped.push(format!("{name}: passed over, {what}"));
                self.note(now_s, "passed over", what, None);
                self.next_step(now_s);
            }
            (Key::Stop, Phase::Done) => self.enter(Phase::Over, String::new()),
            (Key::Stop, Phase::Waiting | Phase::Running | Phase::Paused | Phase::Stalled) => {
                self.course.push(now_s + LEAD_S, 0.0, What::Nothing, false);
                self.note(now_s, "stopped", "by hand".to_owned(), None);
                self.enter(Phase::Done, "stopped; what was recorded is kept".to_owned());
            }
            (Key::Hidden, Phase::Running) if self.is_moving() => {
                self.stand(key_s, Phase::Paused, "paused", "the page was hidden".to_owned());
            }
            (Key::Hidden, Phase::Stalled) => self.pause_stalled(now_s),
            _ => {}
        }
    }

    /// One more step at the end, which begins when the person says so.
    pub(crate) fn append(&mut self, step: Step) {
        if self.phase == Phase::Done {
            self.step = self.protocol.steps.len();
            self.protocol.steps.push(step);
            self.enter(Phase::Waiting, String::new());
        }
    }

    /// The page is there at `now_s`, and seen.
    pub(crate) fn page(&mut self, now_s: f64) {
        if let Some(page_s) = &mut self.page_s {
            *page_s = page_s.max(now_s);
        }
    }

    /// A sample with the LED on, or `None` for one with it off.
    pub(crate) fn sample(&mut self, time_s: f64, volts: Option<&[f64]>) {
        self.sample_s = self.sample_s.max(time_s);
        if let (Some(volts), Some(gates)) = (volts, &mut self.gates) {
            gates.sample(time_s, volts);
        }
    }

    /// A force, newtons; one that is not known is none.
    pub(crate) fn force(&mut self, time_s: f64, force_n: [f64; 3]) {
        if force_n.iter().all(|force| force.is_finite()) {
            self.force_s = self.force_s.max(time_s);
            if let Some(gates) = &mut self.gates {
                gates.force(time_s, force_n);
            }
        }
    }

    /// Time has passed.
    pub(crate) fn advance(&mut self, now_s: f64) {
        match self.phase {
            Phase::Running => {
                if self.is_moving() {
                    self.advance_movement(now_s);
                } else {
                    self.advance_checks(now_s);
                }
            }
            Phase::Stalled if self.silence(now_s).is_none() => self.go_on(now_s),
            _ => {}
        }
    }

    fn advance_movement(&mut self, now_s: f64) {
        let (stretch, at_s) = self.course.at(now_s);
        if stretch.what != What::Step(self.step) {
            // It is about to begin.
            return;
        }
        let whole_s = self.current().and_then(Step::motion).map_or(0.0, |motion| motion.whole_s());
        if stretch.moves && at_s >= whole_s {
            let end_s = stretch.from_s + (whole_s - stretch.at_s);
            return self.end_movement(end_s, now_s);
        }
        if let Some(why) = self.silence(now_s) {
            return self.stand(now_s + LEAD_S, Phase::Stalled, "stalled", why);
        }
        if self.page_s.is_some_and(|page_s| now_s - page_s.max(stretch.from_s) > GONE_S) {
            self.stand(now_s + LEAD_S, Phase::Paused, "paused", "the page is gone; open it again".to_owned());
        }
    }

    /// What of the stream is silent, in words.
    fn silence(&self, now_s: f64) -> Option<String> {
        let silent = |last_s: f64| now_s - last_s > SILENT_S;
        if silent(self.force_s) {
            Some(format!("no force for {SILENT_S} s; the ring waits for it"))
        } else if silent(self.sample_s) {
            Some(format!("no sample for {SILENT_S} s; the ring waits for it"))
        } else {
            None
        }
    }

    fn end_movement(&mut self, end_s: f64, now_s: f64) {
        let unmet = self.unmet();
        if unmet.is_empty() {
            self.note(end_s, "ends", String::new(), None);
            self.next_step(now_s);
        } else {
            self.course.push(now_s + LEAD_S, 0.0, What::Nothing, false);
            self.note(end_s, "to be repeated", unmet.clone(), None);
            self.enter(Phase::Waiting, format!("once more: {unmet}"));
        }
    }

    /// Checks that do not hold yet, in words; none where all do.
    fn unmet(&self) -> String {
        let unmet = self.verdicts().into_iter().filter(|(_, verdict)| !verdict.passed);
        unmet.map(|(_, verdict)| verdict.says).collect::<Vec<_>>().join("; ")
    }

    /// The checks of the step and how they stand.
    #[must_use]
    pub(crate) fn verdicts(&self) -> Vec<(Check, Verdict)> {
        let checks = self.current().map_or(&[][..], |step| &step.checks);
        let unknown = || Verdict { passed: false, says: "no sample yet".to_owned() };
        let verdict = |check: Check| self.gates.as_ref().map_or_else(unknown, |gates| gates.verdict(check));
        checks.iter().map(|&check| (check, verdict(check))).collect()
    }

    fn advance_checks(&mut self, now_s: f64) {
        let verdicts = self.verdicts();
        if verdicts.iter().all(|(_, verdict)| verdict.passed) {
            self.note(now_s, "passed", String::new(), None);
            return self.next_step(now_s);
        }
        // The finger presses only once the tare is known.
        let waits_for = verdicts.iter().find(|(check, verdict)| *check >= Check::Tare && !verdict.passed);
        let what = if waits_for.is_some_and(|(check, _)| *check == Check::Sign) { What::Press } else { What::Nothing };
        if self.course.at(now_s + LEAD_S).0.what != what {
            self.course.push(now_s + LEAD_S, 0.0, what, false);
            self.version += 1;
        }
    }

    fn next_step(&mut self, now_s: f64) {
        self.course.push(now_s + LEAD_S, 0.0, What::Nothing, false);
        self.step += 1;
        match self.current() {
            None => {
                self.note(now_s, "done", String::new(), None);
                self.enter(Phase::Done, "all steps are done".to_owned());
            }
            Some(step) if step.waits => self.enter(Phase::Waiting, String::new()),
            Some(_) => self.begin_step(now_s),
        }
    }

    fn begin_step(&mut self, now_s: f64) {
        let Some(step) = self.current() else { return };
        match step.kind {
            StepKind::Ask => {
                self.note(now_s, "done", String::new(), None);
                self.next_step(now_s);
            }
            StepKind::Check => {
                if let Some(gates) = &mut self.gates {
                    gates.reset();
                }
                self.note(now_s, "begins", String::new(), None);
                self.enter(Phase::Running, String::new());
            }
            StepKind::Move(_) => {
                if let Some(why) = self.silence(now_s) {
                    return self.enter(Phase::Waiting, why);
                }
                if let Some(gates) = &mut self.gates {
                    gates.begin_movement();
                }
                self.page(now_s);
                let begins_s = self.course.push(now_s + LEAD_S, 0.0, What::Step(self.step), true);
                self.note(begins_s, "begins", String::new(), None);
                self.enter(Phase::Running, String::new());
            }
        }
    }

    /// Stands still from `from_s` on.
    fn stand(&mut self, from_s: f64, phase: Phase, event: &'static str, why: String) {
        let at_s = self.course.stop(from_s);
        self.stood_from_s = self.course.stretches().last().map_or(from_s, |stretch| stretch.from_s);
        self.turns.push(Turn {
            time_s: self.stood_from_s,
            step: self.name(),
            at_s,
            event,
            why: why.clone(),
            stood_s: None,
        });
        self.enter(phase, why);
    }

    /// What waited for the stream waits for the person as well.
    fn pause_stalled(&mut self, now_s: f64) {
        self.note(now_s, "paused", "while the stream was silent".to_owned(), None);
        self.enter(Phase::Paused, String::new());
    }

    fn go_on(&mut self, now_s: f64) {
        if let Some(why) = self.silence(now_s) {
            return self.enter(Phase::Stalled, why);
        }
        self.page(now_s);
        let at_s = self.course.at(now_s + LEAD_S).1;
        let from_s = self.course.push(now_s + LEAD_S, at_s, What::Step(self.step), true);
        let stood_s = Some((from_s - self.stood_from_s).max(0.0));
        self.note(from_s, "goes on", String::new(), stood_s);
        self.enter(Phase::Running, String::new());
    }

    fn enter(&mut self, phase: Phase, why: String) {
        (self.phase, self.why) = (phase, why);
        self.version += 1;
    }

    fn note(&mut self, time_s: f64, event: &'static str, why: String, stood_s: Option<f64>) {
        let at_s = self.course.at(time_s).1;
        self.turns.push(Turn { time_s, step: self.name(), at_s, event, why, stood_s });
    }

    fn name(&self) -> String {
        self.current().map_or(String::new(), |step| step.name.clone())
    }

    fn is_moving(&self) -> bool {
        self.current().is_some_and(|step| step.motion().is_some())
    }

    #[must_use]
    pub(crate) fn current(&self) -> Option<&Step> {
        self.protocol.steps.get(self.step)
    }

    /// What is prompted at `time_s`, if anything, and the step's place and own time, where it is one's.
    #[must_use]
    pub(crate) fn prompted(&self, time_s: f64) -> (Option<Prompted>, Option<(usize, f64)>) {
        let (stretch, at_s) = self.course.at(time_s);
        match stretch.what {
            What::Nothing => (None, None),
            What::Press => {
                let press_n = SIGN_N.min(0.5 * self.protocol.space.fz_max_n());
                (Some(Prompted::Force([0.0, 0.0, -press_n])), None)
            }
            What::Step(place) => {
                let motion = self.protocol.steps.get(place).and_then(Step::motion);
                (motion.map(|motion| motion.at(at_s)), Some((place, at_s)))
            }
        }
    }

    /// The step whose rows are collected at `time_s`; none while nothing moves.
    #[must_use]
    pub(crate) fn collecting(&self, time_s: f64) -> Option<&Step> {
        let (stretch, at_s) = self.course.at(time_s);
        let What::Step(place) = stretch.what else { return None };
        let step = self.protocol.steps.get(place).filter(|step| step.collects && stretch.moves)?;
        step.motion().is_some_and(|motion| at_s <= motion.whole_s()).then_some(step)
    }

    /// How it is, and why.
    #[must_use]
    pub(crate) fn phase(&self) -> (&Phase, &str) {
        (&self.phase, &self.why)
    }

    /// The step's place, and how many there are.
    #[must_use]
    pub(crate) fn place(&self) -> (usize, usize) {
        (self.step, self.protocol.steps.len())
    }
}

#[cfg(test)]
mod tests;
