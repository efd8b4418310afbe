//! A prompted session from its beginning to its end.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use lunula_live::source::{Address, OfFinger, Pace as PlayPace, Place, Rows};

use super::attend::{Attendant, COLUMNS};
use super::desk::{Desk, Pace, Show};
use super::error::PromptError;
use super::frames::Frames;
use super::protocol::{Prompted, Protocol};
use super::report::{PromptReport, figures};
use super::run::Run;
use crate::files::{Places, beside};
use crate::job::{Report, Watch};
use crate::live::{Attended, Growing, PhantomRows, SessionFiles, StreamOptions, View, attend};
use crate::phantom::log::Prompting;
use crate::phantom::sensor::Touch;
use crate::phantom::trajectory::J3_PER_J2;
use crate::stages::{Stages, Step};

/// The source that follows the prompter.
const SUBJECT: &str = "subject";

/// The clock of the page, for a marker file.
pub const CLOCK: &str = include_str!("protocol/clock.toml");

/// Files of a prompted session.
#[derive(Debug, Clone, Default)]
pub struct PromptFiles {
    /// The protocol; none: that of 5.2.4.
    pub protocol: Option<PathBuf>,
    /// The recording, a CSV table.
    pub out: PathBuf,
    /// Whether a recording that exists is replaced.
    pub replace: bool,
}

/// A prompted session: one thread goes through it ([`run`](Self::run)), others hand in what a page says.
pub struct Prompter {
    desk: Desk,
    options: StreamOptions,
    files: PromptFiles,
    alone: bool,
}

/// What a simulated session reads in place of a sensor.
///
/// # Errors
/// Never: an address that a test parses.
pub fn subject() -> Result<OfFinger<Address>, String> {
    "phantom:subject?rate=max".parse()
}

/// What is done, and what is left out.
#[must_use]
pub fn prompt_steps(options: &StreamOptions, files: &PromptFiles) -> Vec<Step> {
    let protocol = files.protocol.as_ref().map_or("that of 5.2.4".to_owned(), |path| path.display().to_string());
    let forces = options.force.first().map_or("the source's own".to_owned(), ToString::to_string);
    let page = if is_alone(options) { "nobody looks: the subject is simulated" } else { "until it is interrupted" };
    vec![
        Step::new("protocol", true, protocol),
        Step::new("read", true, options.source.first().map_or(String::new(), ToString::to_string)),
        Step::new("join forces", !options.force.is_empty(), forces),
        Step::new("page", !is_alone(options), page.to_owned()),
        Step::new("record", true, files.out.display().to_string()),
    ]
}

/// Whether the source is a subject that is simulated as fast as it can be: nobody looks at a page then.
#[must_use]
pub fn is_alone(options: &StreamOptions) -> bool {
    pace_of(options) == Some(PlayPace::Max)
}

fn pace_of(options: &StreamOptions) -> Option<PlayPace> {
    match &options.source.first()?.what.place {
        Place::Phantom { kind, pace, .. } if kind == SUBJECT => Some(*pace),
        _ => None,
    }
}

impl Prompter {
    /// Reads the protocol and makes ready; pages hear of it by `show`.
    ///
    /// # Errors
    /// A protocol with faults, a recording that exists, a source that can't follow a prompt.
    pub fn new(options: &StreamOptions, files: &PromptFiles, show: Arc<dyn Show>) -> Result<Self, PromptError> {
        let refused = |what: &str| Err(PromptError::Request(what.to_owned()));
        if options.source.len() > 1 {
            return refused("one finger at a time; name one --source");
        }
        let Some(source) = options.source.first() else {
            return refused("--source is needed: where samples come from, or --simulate");
        };
        if !files.out.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("csv")) {
            let what =
                format!("{}: a prompted recording is a CSV table; let its name end in .csv", files.out.display());
            return Err(PromptError::Request(what));
        }
        let of_recording = |source: &Address| matches!(source.place, Place::File { .. });
        if of_recording(&source.what) || options.force.iter().any(|force| of_recording(&force.what)) {
            return refused(
                "a recording follows no prompt; name a live source, or phantom:subject for a simulated one",
            );
        }
        let pace = match (&source.what.place, pace_of(options)) {
            (_, Some(PlayPace::Max)) => Pace::Clock(0.0),
            (_, Some(PlayPace::Rate(1.0))) => Pace::Played(None),
            (_, Some(PlayPace::Rate(_))) => return refused("phantom:subject is played at rate=1 or rate=max"),
            (Place::Phantom { kind, .. }, None) => {
                let what = format!("phantom:{kind} follows no prompt; phantom:subject does");
                return Err(PromptError::Request(what));
            }
            (_, None) => Pace::Live,
        };
        if pace != Pace::Live && !options.force.is_empty() {
            return refused("the simulated subject has its own force transducer; leave --force out");
        }
        let protocol = match &files.protocol {
            None => Protocol::thesis(),
            Some(path) => Protocol::read(path)?,
        };
        let alone = is_alone(options);
        let mut results = vec![beside(&files.out, ".run.json"), beside(&files.out, ".extra.toml")];
        results.push(files.out.clone());
        let frames = if alone {
            None
        } else {
            let at = beside(&files.out, ".frames.csv");
            results.extend([at.clone(), beside(&files.out, ".clock.toml")]);
            Some(Growing::new(&at, files.replace, false)?)
        };
        Places::not_over(files.protocol.iter()).check(results)?;
        let run = Run::new(protocol, !alone);
        let desk = Desk::new(run, Frames::new(frames), pace, show);
        Ok(Self { desk, options: options.clone(), files: files.clone(), alone })
    }

    /// The server's clock now, seconds since the session began.
    #[must_use]
    pub fn now_s(&self) -> f64 {
        self.desk.now_s()
    }

    /// A key of the page: `{"key":"go","time_s":12.3}`; whether it is one.
    #[must_use]
    pub fn key(&self, json: &[u8]) -> bool {
        self.desk.key(json)
    }

    /// Frames that a page has shown: `{"frames":[..]}`; whether they are some.
    #[must_use]
    pub fn frames(&self, json: &[u8]) -> bool {
        self.desk.frames(json)
    }

    /// Goes through the protocol until it is done and nobody wants more, or it is interrupted; a page of the sensor
    /// shows what is left in `view`.
    ///
    /// # Errors
    /// A source that gives nothing, files that can't be written. What was recorded until then is kept.
    pub fn run(&self, view: Option<View>, tell: &dyn Fn(&str), watch: &Watch<'_>) -> Result<PromptReport, PromptError> {
        let stages = Stages::default();
        let rows = self.subject_rows()?;
        let session =
            SessionFiles { out: Some(self.files.out.clone()), replace: self.files.replace, ..SessionFiles::default() };
        let full_scale_v = self.options.log.ambient.full_scale_v;
        let mut attendant = Attendant::new(self.desk.clone(), full_scale_v, self.alone);
        let attended =
            Attended { onlooker: &mut attendant, columns: &COLUMNS, clock: self.desk.clock, rows, job: "prompt", view };
        let of_session = attend(&self.options, &session, attended, tell, watch)?;
        let mut shared = self.desk.lock();
        let mut report = Report::new("prompt", watch, figures(&shared, self.files.out.clone()));
        let frames = shared.frames.finish();
        (report.warnings, report.notes, report.failed) =
            (of_session.warnings.clone(), of_session.notes.clone(), of_session.failed.clone());
        report.left_out.clone_from(&of_session.left_out);
        report.failed.extend(shared.run.skipped.iter().cloned());
        report.failed.extend(frames.as_ref().err().map(ToString::to_string));
        if !report.completed {
            let (place, count) = shared.run.place();
            let unmet = shared.run.verdicts().into_iter().filter(|(_, verdict)| !verdict.passed);
            let unmet: Vec<String> = unmet.map(|(_, verdict)| verdict.says).collect();
            let why = if unmet.is_empty() { String::new() } else { format!(": {}", unmet.join("; ")) };
            report.failed.push(format!("{place} of {count} steps were done{why}"));
        }
        let is_recorded = report.rows > 0;
        if !is_recorded {
            report.failed.push("nothing was collected, and nothing is written".to_owned());
        }
        let space = shared.run.protocol.space;
        drop(shared);
        let mut places = Places::not_over(self.files.protocol.iter());
        if let Some(extra) = report.extra.as_ref().filter(|_| is_recorded) {
            let at = beside(&self.files.out, ".extra.toml");
            places.write(&at, &extra.toml(&space))?;
            report.extra_file = Some(at);
        }
        if frames.unwrap_or(true) {
            report.frames_file = Some(beside(&self.files.out, ".frames.csv"));
        }
        if is_recorded && !self.alone {
            places.write(&beside(&self.files.out, ".clock.toml"), CLOCK)?;
        }
        let report = report.timed(&stages);
        // A recording of before, which is as it was, has a report of its own.
        let at = is_recorded.then(|| beside(&self.files.out, ".run.json"));
        Ok(report.commit(places, at.as_deref())?)
    }

    fn subject_rows(&self) -> Result<Option<Box<dyn Rows>>, PromptError> {
        let Some(source) = self.options.source.first().filter(|_| pace_of(&self.options).is_some()) else {
            return Ok(None);
        };
        let Place::Phantom { settings, .. } = &source.what.place else { return Ok(None) };
        let desk = self.desk.clone();
        let prompting: Prompting = Arc::new(move |time_s: f64| touch(desk.prompted(time_s)));
        let rows = PhantomRows::prompted_by(settings, prompting);
        let named = |what: String| PromptError::Request(format!("{}: {what}", source.what));
        Ok(Some(Box::new(rows.map_err(named)?)))
    }
}

/// What a finger does that is prompted so.
fn touch(prompted: Option<Prompted>) -> Touch {
    match prompted {
        None => Touch { forces_n: [0.0; 3], angles_rad: [0.0; 3] },
        Some(Prompted::Force(forces_n)) => Touch { forces_n, angles_rad: [0.0; 3] },
        Some(Prompted::Bend(j2_deg)) => {
            let j2_rad = j2_deg.to_radians();
            Touch { forces_n: [0.0; 3], angles_rad: [0.0, j2_rad, J3_PER_J2 * j2_rad] }
        }
    }
}

/// Writes the protocol of 5.2.4, to be changed.
///
/// # Errors
/// A file that exists, or can't be written.
pub fn write_protocol(path: &Path) -> Result<(), PromptError> {
    if path.exists() {
        let what = format!("{}: exists already; choose another name", path.display());
        return Err(PromptError::Request(what));
    }
    Ok(crate::files::write_whole(path, super::protocol::THESIS.as_bytes())?)
}

#[cfg(test)]
mod tests;
