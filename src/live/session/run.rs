//! The loop of a session, and its entries: `live`, `record`, and recordings read row by row.

use std::fs::File;
use std::io::BufWriter;
use std::net::TcpListener;
use std::os::fd::OwnedFd;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use lunula_live::latency::Latency as Times;
use lunula_live::pointer::Config;
use lunula_live::source::{Address, Condition, Event, Form, HostClock, Pace, Place, Stream, wait};
use lunula_live::switch::Switch;
use lunula_live::time::ClockFit;
use lunula_live::wire::{Naming, Row, Spoil, SpoiltRows};

use super::columns::StreamColumns;
use super::decide::{Answers, Decide, SwitchOutput};
use super::open::{named, open_stream, source_fault};
use super::pipe::Pipe;
use super::pointer::{PointerOutput, read_mouse};
use super::recording::Recording;
use super::report::{Latency, SessionFigures, SessionReport};
use super::sensor::Sensor;
use crate::files::{Places, beside};
use crate::job::{Report, Watch};
use crate::live::error::LiveError;
use crate::live::options::{LiveOptions, SessionFiles, StreamOptions};
use crate::live::switch::read_switch;
use crate::log::{LogReading, PRECEDING_RULE};
use crate::predictor::{Answering, open_models};
use crate::stages::Stages;

/// The loop looks up at least so often, nanoseconds: to be stopped, to find a lost source, to let readers in.
const TICK_NS: u64 = 100_000_000;
/// A reader that is behind is tried again after so long, nanoseconds.
const BEHIND_NS: u64 = 2_000_000;
/// A stream without a sample for so long after it was opened is an alarm.
const SILENCE_NS: u64 = 1_000_000_000;
/// More spoilt rows than this share in so long are an alarm.
const SPOILT_SHARE: f64 = 0.01;
const SPOILT_NS: u64 = 10_000_000_000;
/// The report beside a recording.
const REPORT: &str = ".stream.json";
/// Whole numbers beyond this are no volts (assumed: no photodiode's amplifier reaches it).
const COUNT_V: f64 = 30.0;

/// Who hears rows and messages.
pub struct Readers<'a> {
    /// Where rows of answers go: standard output.
    pub rows: Option<OwnedFd>,
    /// Whoever looks after the session: states, alarms, notes.
    pub tell: &'a dyn Fn(&str),
}

/// Answers samples as they come.
///
/// # Errors
/// [`LiveError`]: models, switch or source that can't be used, a stream that nothing came of, a file that can't be
/// written. What was recorded until then is kept.
pub fn live(
    options: &LiveOptions,
    files: &SessionFiles,
    readers: Readers<'_>,
    watch: &Watch<'_>,
) -> Result<SessionReport, LiveError> {
    let opened = open_models(&files.models)?;
    opened.warnings.iter().for_each(|warning| (readers.tell)(&format!("warning: {warning}")));
    let gate = options.answer.gate().map_err(|why| LiveError::Request(why.to_string()))?;
    let answering = Answering::new(opened.predictors, gate, options.answer.intervals)?;
    let mut session = Session::new(&options.stream, files, answering.inputs().to_vec(), readers.tell, watch)?;
    session.core.warnings.extend(opened.warnings);
    let switch = files.switch.as_deref().map(read_switch).transpose()?;
    let mouse = files.mouse.as_ref().map(|mouse| -> Result<Mouse, LiveError> {
        let config = mouse.config.as_deref().map(read_mouse).transpose()?.unwrap_or_default();
        Ok(Mouse { config, events: mouse.events.clone(), uinput: mouse.uinput })
    });
    let mouse = mouse.transpose()?;
    let job = if mouse.is_some() { "mouse" } else { "live" };
    if files.events.is_some() && switch.is_none() {
        return Err(LiveError::Request("--events are a switch's: name one with --switch".to_owned()));
    }
    let events = match &files.events {
        None => None,
        Some(path) => {
            let file = File::create(path).map_err(|why| LiveError::Write { path: path.clone(), why })?;
            Some((path.clone(), BufWriter::new(file)))
        }
    };
    let listener = match options.tcp {
        None => None,
        Some(address) => {
            let bound = TcpListener::bind(address).and_then(|one| one.set_nonblocking(true).map(|()| one));
            let refused = |why: std::io::Error| {
                LiveError::Request(format!("--tcp {address}: can't listen there ({why}); choose another port"))
            };
            let bound = bound.map_err(refused)?;
            if let Ok(at) = bound.local_addr() {
                (readers.tell)(&format!("rows are at tcp:{at}"));
            }
            Some(bound)
        }
    };
    session.listener = listener;
    let predicted = match &files.out {
        Some(out) => Some(Recording::new(&predicted_beside(out), files.replace, session.core.waits)?),
        None => None,
    };
    session.core.asked = Some(Asked {
        answering,
        switch: switch.map(Switch::new),
        events,
        mouse,
        predicted,
        rows: readers.rows,
        keep_faults: options.answer.keep_faults,
    });
    session.run(job, watch)
}

/// Records samples as they come.
///
/// # Errors
/// As [`live`].
pub fn record(
    options: &StreamOptions,
    files: &SessionFiles,
    tell: &dyn Fn(&str),
    watch: &Watch<'_>,
) -> Result<SessionReport, LiveError> {
    if files.out.is_none() {
        return Err(LiveError::Request("--out is needed: the recording".to_owned()));
    }
    Session::new(options, files, Vec::new(), tell, watch)?.run("record", watch)
}

/// Reads a recording row by row as a session would, as fast as possible: `columns` hears what it holds, `row` each row.
/// Returns what is worth saying.
///
/// # Errors
/// A file that can't be read, or what `columns` or `row` refuse.
pub(crate) fn each_row(
    path: &Path,
    log: &LogReading,
    extra: &[String],
    mut columns: impl FnMut(&StreamColumns) -> Result<(), String>,
    mut row: impl FnMut(&Row<'_>) -> Result<(), String>,
    watch: &Watch<'_>,
) -> Result<Vec<String>, LiveError> {
    let place = path.display().to_string();
    let refused = |what: String| LiveError::Source { place: place.clone(), what };
    let options = StreamOptions {
        source: Address {
            place: Place::File { path: path.to_owned(), pace: Pace::Max, looped: false },
            form: Form::Lines,
            volts_per_count: None,
        },
        volts_per_count: None,
        names: None,
        keep: extra.to_vec(),
        seconds: None,
        log: log.clone(),
    };
    let clock = HostClock::start();
    let found = Found::default();
    let mut stream = open_stream(&options, found.naming(log, extra, &[]), clock.now_ns())?;
    let mut known = StreamColumns::default();
    let (mut fault, mut rows) = (None, 0u64);
    while !stream.ended() && fault.is_none() {
        watch.go_on()?;
        let mut on = |event: Event<'_>| match event {
            Event::Columns(_) => {
                known = found.take().unwrap_or_default();
                fault = columns(&known).err();
            }
            Event::Row(one) if fault.is_none() => {
                rows += 1;
                fault = row(one).err();
            }
            _ => {}
        };
        stream.poll(clock.now_ns(), &mut on).map_err(|why| source_fault(&options.source, why))?;
    }
    if let Some(what) = fault {
        return Err(refused(what));
    }
    if rows == 0 {
        return Err(refused("no row came".to_owned()));
    }
    let mut notes = known.notes;
    notes.extend(known.led.then(|| PRECEDING_RULE.to_owned()));
    let spoilt = stream.certificate().spoilt;
    notes.extend(spoilt.iter().map(|rows| format!("left out: {}", spoilt_words(rows))));
    Ok(notes)
}

/// The columns of a stream, from whoever names them to whoever works with them.
#[derive(Clone, Default)]
struct Found(Arc<Mutex<Option<StreamColumns>>>);

impl Found {
    fn naming(&self, log: &LogReading, keep: &[String], needs: &[String]) -> Naming {
        let (found, log, keep, needs) = (self.clone(), log.clone(), keep.to_vec(), needs.to_vec());
        Box::new(move |names| {
            let columns = StreamColumns::of(names, &log, &keep)?;
            if columns.values.is_empty() {
                return Err(format!("no column is a photodiode or a force; its columns are {}", names.join(", ")));
            }
            columns.check(&needs)?;
            let meaning = columns.meaning.clone();
            found.0.lock().unwrap_or_else(PoisonError::into_inner).replace(columns);
            Ok(meaning)
        })
    }

    fn take(&self) -> Option<StreamColumns> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

/// Spoilt rows of one kind, in words.
fn spoilt_words(rows: &SpoiltRows) -> String {
    let SpoiltRows { kind, count, line, text } = rows;
    let others = if *count > 1 { format!(", and {} more", count - 1) } else { String::new() };
    format!("line {line} {} (`{text}`){others}", kind.words())
}

/// Where the rows of answers are, beside the recording of samples.
fn predicted_beside(out: &Path) -> PathBuf {
    let ending = out.extension().map_or(String::new(), |ending| format!(".{}", ending.to_string_lossy()));
    beside(out, &format!(".predicted{ending}"))
}

/// What is asked of the models before the columns are known.
struct Asked {
    answering: Answering,
    switch: Option<Switch>,
    events: Option<(PathBuf, BufWriter<File>)>,
    mouse: Option<Mouse>,
    predicted: Option<Recording>,
    rows: Option<OwnedFd>,
    keep_faults: bool,
}

/// What is asked of a pointer.
struct Mouse {
    config: Config,
    events: Option<PathBuf>,
    uinput: bool,
}

/// A session as it goes.
struct Session<'a> {
    stream: Stream,
    clock: HostClock,
    options: &'a StreamOptions,
    found: Found,
    listener: Option<TcpListener>,
    core: Core<'a>,
}

/// What rows go through.
struct Core<'a> {
    clock: HostClock,
    tell: &'a dyn Fn(&str),
    files: &'a SessionFiles,
    log: &'a LogReading,
    seconds: Option<f64>,
    waits: bool,
    is_live: bool,
    asked: Option<Asked>,
    recording: Option<Recording>,
    decide: Option<Decide>,
    warnings: Vec<String>,
    notes: Vec<String>,
    work: Times,
    arrival: Times,
    wake_up: Times,
    /// The line of the fastest rows, and whether any row came.
    clock_fit: Option<ClockFit>,
    any: bool,
    spoilt: SpoiltShare,
    fault: Option<LiveError>,
    ends: bool,
}

/// Rows and spoilt ones since a moment.
#[derive(Debug, Default)]
struct SpoiltShare {
    since_ns: u64,
    rows: u64,
    spoilt: u64,
}

impl<'a> Session<'a> {
    fn new(
        options: &'a StreamOptions,
        files: &'a SessionFiles,
        needs: Vec<String>,
        tell: &'a dyn Fn(&str),
        watch: &Watch<'_>,
    ) -> Result<Self, LiveError> {
        watch.go_on()?;
        let mut inputs: Vec<PathBuf> = files.models.iter().chain(&files.switch).cloned().collect();
        inputs.extend(files.mouse.iter().filter_map(|mouse| mouse.config.clone()));
        if let Place::File { path, .. } = &options.source.place {
            inputs.push(path.clone());
        }
        let out = files.out.iter();
        let results = out.flat_map(|out| [out.clone(), predicted_beside(out), beside(out, REPORT)]);
        let moves = files.mouse.iter().filter_map(|mouse| mouse.events.clone());
        Places::not_over(inputs).check(results.chain(files.events.clone()).chain(moves))?;
        let clock = HostClock::start();
        let found = Found::default();
        let naming = found.naming(&options.log, &options.keep, &needs);
        let stream = open_stream(options, naming, clock.now_ns())?;
        // What comes down a pipe can wait in it.
        let waits = !stream.is_live() || options.source.place == Place::Stdin;
        let recording = files.out.as_ref().map(|out| Recording::new(out, files.replace, waits)).transpose()?;
        let core = Core {
            clock,
            tell,
            files,
            log: &options.log,
            seconds: options.seconds,
            is_live: stream.is_live(),
            waits,
            asked: None,
            recording,
            decide: None,
            warnings: Vec::new(),
            notes: Vec::new(),
            work: Times::default(),
            arrival: Times::default(),
            clock_fit: None,
            any: false,
            wake_up: Times::default(),
            spoilt: SpoiltShare::default(),
            fault: None,
            ends: false,
        };
        Ok(Self { stream, clock, options, found, listener: None, core })
    }

    fn run(mut self, job: &'static str, watch: &Watch<'_>) -> Result<SessionReport, LiveError> {
        let start = Instant::now();
        let mut tick_ns = self.clock.now_ns() + TICK_NS;
        let mut alarmed = false;
        while !watch.stop.load(Ordering::Relaxed) {
            let polled = self.poll();
            if self.core.fault.is_none() {
                self.core.fault = polled.err();
            }
            let now_ns = self.clock.now_ns();
            if self.stream.is_live() {
                self.core.advance(self.stream.stream_now_s(now_ns));
            }
            if now_ns >= tick_ns {
                tick_ns = now_ns + TICK_NS;
                self.tick(now_ns, &mut alarmed);
            }
            self.core.flush();
            if self.core.ends || self.core.fault.is_some() || self.core.nobody_hears(self.listener.is_some()) {
                break;
            }
            self.wait(tick_ns)?;
        }
        self.finish(job, start, watch)
    }

    /// Takes what has come.
    fn poll(&mut self) -> Result<(), LiveError> {
        let Self { stream, options, found, core, clock, .. } = self;
        let mut on = |event: Event<'_>| match event {
            Event::Columns(_) => core.begin(found.take().unwrap_or_default()),
            event if core.fault.is_none() && !core.ends => core.take(event),
            _ => {}
        };
        stream.poll(clock.now_ns(), &mut on).map_err(|why| source_fault(&options.source, why))
    }

    /// Waits for bytes or a deadline.
    fn wait(&mut self, tick_ns: u64) -> Result<(), LiveError> {
        let now_ns = self.clock.now_ns();
        let live = self.stream.is_live();
        // A reader that is behind is looked at again soon.
        let soon_ns = if self.core.is_behind() { now_ns + BEHIND_NS } else { tick_ns };
        let left_s = self.core.due_s().filter(|_| live).map(|due_s| due_s - self.stream.stream_now_s(now_ns));
        let watchdog_ns = left_s.map_or(tick_ns, |left_s| now_ns + 1 + (1e9 * left_s.clamp(0.0, 1.0)) as u64);
        let until_ns = tick_ns.min(soon_ns).min(watchdog_ns);
        let waited = wait(&[&self.stream], &[], Some(until_ns), &self.clock);
        waited.map_err(|why| LiveError::Request(format!("can't wait for the stream ({why})")))?;
        // Woken by the clock: how late is the machine's own part.
        let now_ns = self.clock.now_ns();
        if live && now_ns >= until_ns {
            self.core.wake_up.record_ns(now_ns - until_ns);
        }
        Ok(())
    }

    /// What is looked at now and then.
    fn tick(&mut self, now_ns: u64, alarmed: &mut bool) {
        if !*alarmed && !self.core.any && now_ns > SILENCE_NS && self.stream.is_live() {
            *alarmed = true;
            (self.core.tell)(&format!("alarm: no sample within a second from {}", named(&self.options.source)));
        }
        self.core.clock_fit = self.stream.clock();
        self.core.look_at_spoilt(now_ns);
        let Some(listener) = &self.listener else { return };
        while let Ok((reader, from)) = listener.accept() {
            let ready = reader.set_nonblocking(true).and_then(|()| reader.set_nodelay(true));
            if ready.is_ok() {
                (self.core.tell)(&format!("a reader came: {from}"));
                self.core.join(Pipe::new(reader.into(), false));
            }
        }
    }

    fn finish(self, job: &'static str, start: Instant, watch: &Watch<'_>) -> Result<SessionReport, LiveError> {
        let certificate = self.stream.certificate();
        let late = self.stream.lateness().and_then(Times::summary);
        let mut core = self.core;
        core.end();
        let Core { decide, warnings, mut notes, work, arrival, wake_up, fault, files, .. } = core;
        let Some(decide) = decide else {
            let place = named(&self.options.source);
            let what = "no row came, and no names of columns".to_owned();
            return Err(fault.unwrap_or(LiveError::Source { place, what }));
        };
        let Decide { recording, answers, rows, .. } = decide;
        if rows == 0 {
            let place = named(&self.options.source);
            return Err(fault.unwrap_or(LiveError::Source { place, what: "no row came".to_owned() }));
        }
        let lost_by_disk = recording.as_ref().map_or(0, Recording::lost);
        let mut failed: Vec<String> = fault.iter().map(ToString::to_string).collect();
        let mut figures = SessionFigures {
            out: files.out.clone(),
            columns: Vec::new(),
            rows,
            answered: 0,
            rows_not_known: 0,
            rows_outside: 0,
            touch: 0,
            bending: 0,
            switch: None,
            pointer: None,
            latency: Latency { arrival: arrival.summary(), work: work.summary(), wake_up: late.or(wake_up.summary()) },
            lost_by_readers: 0,
            lost_by_disk,
            stream: certificate,
        };
        if let Some(mut answers) = answers {
            answers.readers.iter_mut().for_each(Pipe::finish);
            let unwritten = answers.readers.iter().find_map(Pipe::failed).map(LiveError::Rows);
            // Where rows are all that a session gives there is nothing then.
            match unwritten {
                Some(why) if files.out.is_none() => return Err(why),
                why => failed.extend(why.map(|why| why.to_string())),
            }
            let sensor = &answers.sensor;
            figures.columns = Answers::header(sensor, answers.switch.is_some());
            (figures.answered, figures.rows_not_known) = (sensor.lit, sensor.not_known);
            figures.rows_outside = sensor.answering().outside();
            (figures.touch, figures.bending) = (answers.touch, answers.bending);
            figures.lost_by_readers = answers.readers.iter().map(Pipe::lost).sum();
            figures.switch = answers.switch.as_ref().map(SwitchOutput::counts);
            figures.pointer = answers.pointer.as_ref().map(PointerOutput::counts);
            if sensor.unknown > 0 {
                notes.push(format!("{} rows do not say whether the LED was on and are left out", sensor.unknown));
            }
            if let Some(recording) = answers.recording {
                failed.extend(recording.finish().err().map(|why| why.to_string()));
            }
        }
        if let Some(recording) = recording {
            failed.extend(recording.finish().err().map(|why| why.to_string()));
        }
        let source = named(&self.options.source);
        failed.extend(
            figures
                .stream
                .spoilt
                .iter()
                .filter(|rows| rows.kind != Spoil::BeforeNames)
                .map(|rows| format!("{source}: {}", spoilt_words(rows))),
        );
        let mut report = Report { warnings, notes, failed, ..Report::new(job, watch, figures) };
        report.warnings.extend(losses(&report));
        let report = report.timed(&Stages::default(), start);
        if let Some(out) = &files.out {
            let mut places = Places::not_over(&files.models);
            places.write(&beside(out, REPORT), &report.text())?;
            places.commit()?;
        }
        Ok(report)
    }
}

impl Core<'_> {
    /// The columns are known.
    fn begin(&mut self, columns: StreamColumns) {
        let mut notes = columns.notes.clone();
        if self.recording.is_some() && !columns.passed_over.is_empty() {
            notes.push(format!(
                "columns that are not recorded: {}; --keep NAME keeps one of numbers",
                columns.passed_over.join(", ")
            ));
        }
        self.note(notes);
        let answers = match self.asked.take() {
            None => None,
            Some(asked) => {
                if columns.led {
                    self.note(vec![PRECEDING_RULE.to_owned()]);
                }
                match answers(asked, &columns, self.log, self.waits) {
                    Ok(answers) => Some(answers),
                    Err(why) => {
                        self.fault = Some(why);
                        return;
                    }
                }
            }
        };
        self.decide = Some(Decide::new(columns, self.recording.take(), answers));
    }

    fn take(&mut self, event: Event<'_>) {
        match event {
            Event::Row(row) => self.row(row),
            Event::Spoilt { .. } => self.spoilt.spoilt += 1,
            Event::State(state) => {
                (self.tell)(&format!("state: {}", state.condition.word()));
                if matches!(state.condition, Condition::Lost | Condition::Reconnecting)
                    && let Some(decide) = &mut self.decide
                {
                    self.fault = decide.lose(false).err();
                }
            }
            Event::Columns(_) => {}
            Event::End => self.ends = true,
        }
    }

    fn row(&mut self, row: &Row<'_>) {
        // Of a recording many rows are handed out at one time.
        let begin_ns = if self.is_live { row.host_ns } else { self.clock.now_ns() };
        self.spoilt.rows += 1;
        self.any = true;
        if let Some(fit) = &self.clock_fit {
            let late_s = 1e-9 * row.host_ns as f64 - fit.host_s(row.time_s);
            self.arrival.record_ns((1e9 * late_s.max(0.0)) as u64);
        }
        let Some(decide) = &mut self.decide else { return };
        let counts = decide.rows == 0 && decide.answers.is_some() && decide.looks_like_counts(row, COUNT_V);
        if counts {
            let what = "the photodiodes are whole numbers beyond 30: they look like a converter's counts, and models \
                        read volts; say what a step is, as --volts-per-count 10/65536";
            self.fault = Some(LiveError::Request(what.to_owned()));
            return;
        }
        if let Err(why) = decide.row(row) {
            self.fault = Some(why);
            return;
        }
        if let (Some(seconds), Some([from_s, to_s])) = (self.seconds, decide.span_s) {
            self.ends |= to_s - from_s >= seconds;
        }
        self.work.record_ns(self.clock.now_ns().saturating_sub(begin_ns));
    }

    fn advance(&mut self, now_s: f64) {
        if let Some(decide) = &mut self.decide
            && let Err(why) = decide.advance(now_s)
        {
            self.fault = Some(why);
        }
    }

    fn due_s(&self) -> Option<f64> {
        self.decide.as_ref()?.due_s()
    }

    fn readers(&mut self) -> &mut [Pipe] {
        let answers = self.decide.as_mut().and_then(|decide| decide.answers.as_mut());
        answers.map_or(&mut [], |answers| &mut answers.readers)
    }

    fn flush(&mut self) {
        self.readers().iter_mut().for_each(Pipe::flush);
    }

    /// Whether every reader has gone, and nothing else comes of the session.
    fn nobody_hears(&mut self, listens: bool) -> bool {
        let files = self.files;
        let others = listens || files.out.is_some() || files.events.is_some() || files.mouse.is_some();
        let readers = self.readers();
        !others && !readers.is_empty() && readers.iter().all(Pipe::is_gone)
    }

    fn is_behind(&mut self) -> bool {
        self.readers().iter().any(Pipe::is_behind)
    }

    fn join(&mut self, reader: Pipe) {
        if let Some(answers) = self.decide.as_mut().and_then(|decide| decide.answers.as_mut()) {
            answers.join(reader);
        }
    }

    /// An alarm where too many rows are spoilt.
    fn look_at_spoilt(&mut self, now_ns: u64) {
        let SpoiltShare { since_ns, rows, spoilt } = self.spoilt;
        if now_ns - since_ns < SPOILT_NS {
            return;
        }
        if spoilt as f64 > SPOILT_SHARE * (rows + spoilt) as f64 {
            (self.tell)(&format!("alarm: {spoilt} of {} rows were spoilt in the last 10 s", rows + spoilt));
        }
        self.spoilt = SpoiltShare { since_ns: now_ns, rows: 0, spoilt: 0 };
    }

    fn note(&mut self, notes: Vec<String>) {
        notes.iter().for_each(|note| (self.tell)(&format!("note: {note}")));
        self.notes.extend(notes);
    }

    /// The session ends: what is pressed lets go.
    fn end(&mut self) {
        if let Some(decide) = &mut self.decide
            && let Err(why) = decide.lose(true)
        {
            self.fault.get_or_insert(why);
        }
    }
}

/// What the models are to do, now that the columns are known.
fn answers(asked: Asked, columns: &StreamColumns, log: &LogReading, waits: bool) -> Result<Answers, LiveError> {
    let refused = LiveError::Request;
    let Asked { answering, switch, events, mouse, predicted, rows, keep_faults } = asked;
    let predicts = answering.columns().to_vec();
    let sensor = Sensor::new(answering, columns, log, keep_faults).map_err(refused)?;
    let switch =
        switch.map(|switch| SwitchOutput::new(switch, &predicts, columns, events)).transpose().map_err(refused)?;
    let pointer = match mouse {
        None => None,
        Some(Mouse { config, events, uinput }) => {
            Some(PointerOutput::new(config, &predicts, events.as_deref(), uinput)?)
        }
    };
    let readers = rows.into_iter().map(|rows| Pipe::new(rows, waits)).collect();
    Ok(Answers::new(sensor, switch, pointer, predicted, readers))
}

/// What has to be known of a session before its rows are used.
fn losses(report: &SessionReport) -> Vec<String> {
    let mut warnings = Vec::new();
    let counts = &report.stream.counts;
    for (lost, how) in [(counts.lost, "by their counter"), (counts.lost_by_time, "estimated from gaps in time")] {
        if lost > 0 {
            warnings.push(format!("{lost} rows never came ({how})"));
        }
    }
    if report.lost_by_disk > 0 {
        warnings.push(format!("{} rows are not recorded: the disk was too slow", report.lost_by_disk));
    }
    if report.lost_by_readers > 0 {
        warnings.push(format!("readers lost {} rows: they were too slow", report.lost_by_readers));
    }
    if report.rows_outside * 20 > report.answered {
        warnings.push(format!(
            "{} of {} rows lie outside of the voltages that the model was trained on; their predictions are \
             extrapolated",
            report.rows_outside, report.answered
        ));
    }
    warnings
}
