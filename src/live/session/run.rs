//! The loop of a session, and its entries: `live`, `record`, and recordings read row by row.

use std::cell::RefCell;
use std::fs::File;
use std::io::BufWriter;
use std::net::TcpListener;
use std::os::fd::{BorrowedFd, OwnedFd};
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::time::Instant;

use lunula_live::latency::Latencies;
use lunula_live::source::{Event, HostClock, Place, Source, Stream, StreamState};
use lunula_live::switch::{Reason, Switch};
use lunula_live::wire::{Meaning, Row};

use super::columns::StreamColumns;
use super::decide::{Answers, Decide, SwitchOutput};
use super::pipe::Pipe;
use super::recording::Recording;
use super::report::{Latency, SessionFigures, SessionReport};
use super::sensor::Sensor;
use super::table_rows::open_stream;
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
/// A stream without a sample for so long after it was opened is an alarm.
const SILENCE_NS: u64 = 1_000_000_000;
/// More spoilt rows than this share in so long are an alarm.
const SPOILT_SHARE: f64 = 0.01;
const SPOILT_NS: u64 = 10_000_000_000;
/// The report beside a recording.
const REPORT: &str = ".stream.json";
/// So many rows of counts where volts should be make sure that they are.
const COUNT_ROWS: u32 = 20;
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
    let mut session = Session::new(&options.stream, files, readers.tell, watch)?;
    let opened = open_models(&files.models)?;
    opened.warnings.iter().for_each(|warning| (readers.tell)(&format!("warning: {warning}")));
    session.core.warnings.extend(opened.warnings);
    let gate = options.answer.gate().map_err(|why| LiveError::Request(why.to_string()))?;
    let answering = Answering::new(opened.predictors, gate, options.answer.intervals)?;
    let switch = files.switch.as_deref().map(read_switch).transpose()?;
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
        Some(out) => Some(Recording::new(&predicted_beside(out), files.replace)?),
        None => None,
    };
    session.needs = answering.inputs().to_vec();
    session.core.asked = Some(Asked {
        answering,
        switch: switch.map(Switch::new),
        events,
        predicted,
        rows: readers.rows,
        keep_faults: options.answer.keep_faults,
    });
    session.run("live", watch)
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
    Session::new(options, files, tell, watch)?.run("record", watch)
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
    let source: Source = format!("{place}?rate=max").parse().map_err(refused)?;
    let options = StreamOptions {
        source,
        volts_per_count: None,
        names: None,
        keep: extra.to_vec(),
        seconds: None,
        log: log.clone(),
    };
    let mut stream = open_stream(&options, HostClock::start())?;
    let mut found = StreamColumns::default();
    let mut fault = None;
    let mut ends = false;
    while !ends && fault.is_none() {
        watch.go_on()?;
        let mut naming = |names: &[String]| -> Result<Meaning, String> {
            found = StreamColumns::of(names, log, extra)?;
            columns(&found)?;
            Ok(found.meaning.clone())
        };
        let mut take = |event: Event<'_>| {
            match event {
                Event::Row(one) => fault = row(&one).err(),
                Event::End => ends = true,
                _ => {}
            }
            fault.is_none()
        };
        stream.poll(&mut naming, &mut take).map_err(|why| refused(why.what))?;
    }
    if let Some(what) = fault {
        return Err(refused(what));
    }
    let mut notes = found.notes;
    notes.extend(found.led.then(|| PRECEDING_RULE.to_owned()));
    let certificate = stream.certificate();
    if certificate.rows == 0 {
        return Err(refused(stream.nothing()));
    }
    for kind in certificate.spoilt_kinds {
        notes.push(format!("{} rows with {} are left out, first line {}", kind.rows, kind.what, kind.first_line));
    }
    Ok(notes)
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
    predicted: Option<Recording>,
    rows: Option<OwnedFd>,
    keep_faults: bool,
}

/// A session as it goes.
struct Session<'a> {
    stream: Stream,
    clock: HostClock,
    options: &'a StreamOptions,
    /// The photodiodes that models read.
    needs: Vec<String>,
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
    asked: Option<Asked>,
    recording: Option<Recording>,
    decide: Option<Decide>,
    warnings: Vec<String>,
    notes: Vec<String>,
    work: Latencies,
    wake_up: Latencies,
    spoilt: SpoiltShare,
    counts: u32,
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
        tell: &'a dyn Fn(&str),
        watch: &Watch<'_>,
    ) -> Result<Self, LiveError> {
        watch.go_on()?;
        let mut inputs: Vec<PathBuf> = files.models.iter().chain(&files.switch).cloned().collect();
        if let Place::File { path, .. } = &options.source.place {
            inputs.push(path.clone());
        }
        let out = files.out.iter();
        let results = out.flat_map(|out| [out.clone(), predicted_beside(out), beside(out, REPORT)]);
        Places::not_over(inputs).check(results.chain(files.events.clone()))?;
        let recording = files.out.as_ref().map(|out| Recording::new(out, files.replace)).transpose()?;
        let clock = HostClock::start();
        let stream = open_stream(options, clock)?;
        let core = Core {
            clock,
            tell,
            files,
            log: &options.log,
            seconds: options.seconds,
            // What comes down a pipe can wait in it.
            waits: stream.can_wait() || options.source.place == Place::Stdin,
            asked: None,
            recording,
            decide: None,
            warnings: Vec::new(),
            notes: Vec::new(),
            work: Latencies::default(),
            wake_up: Latencies::default(),
            spoilt: SpoiltShare::default(),
            counts: 0,
            fault: None,
            ends: false,
        };
        Ok(Self { stream, clock, options, needs: Vec::new(), listener: None, core })
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
            if let Some(now_s) = self.stream.now_s(now_ns) {
                self.core.advance(now_s);
            }
            if now_ns >= tick_ns {
                tick_ns = now_ns + TICK_NS;
                self.tick(now_ns, &mut alarmed);
            }
            self.core.flush();
            if self.core.ends || self.core.fault.is_some() || self.core.nobody_hears(self.listener.is_some()) {
                break;
            }
            self.wait(tick_ns);
        }
        self.finish(job, start, watch)
    }

    /// Takes what has come.
    fn poll(&mut self) -> Result<(), LiveError> {
        let Self { stream, options, needs, core, .. } = self;
        let found = RefCell::new(None);
        let mut naming = |names: &[String]| -> Result<Meaning, String> {
            let columns = StreamColumns::of(names, &options.log, &options.keep)?;
            if columns.values.is_empty() {
                return Err(format!("no column is a photodiode or a force; its columns are {}", names.join(", ")));
            }
            columns.check(needs)?;
            let meaning = columns.meaning.clone();
            found.replace(Some(columns));
            Ok(meaning)
        };
        let mut take = |event: Event<'_>| {
            if matches!(event, Event::Names { again: false })
                && let Some(columns) = found.take()
            {
                core.begin(columns);
            } else {
                core.take(event);
            }
            core.fault.is_none() && !core.ends
        };
        stream.poll(&mut naming, &mut take).map_err(|why| LiveError::Source { place: why.place, what: why.what })
    }

    /// Waits for bytes, a deadline, or a reader.
    fn wait(&mut self, tick_ns: u64) {
        let watchdog_ns = self.core.due_s().and_then(|due_s| self.stream.moment_ns(due_s));
        let until_ns = watchdog_ns.map_or(tick_ns, |due_ns| due_ns.min(tick_ns));
        {
            let writers = self.core.waiting();
            self.stream.wait(until_ns, &writers);
        }
        // Woken by the clock: how late is the machine's own part.
        let now_ns = self.clock.now_ns();
        if now_ns >= until_ns {
            self.core.wake_up.record(now_ns - until_ns);
        }
    }

    /// What is looked at now and then.
    fn tick(&mut self, now_ns: u64, alarmed: &mut bool) {
        if !*alarmed && self.stream.rows() == 0 && now_ns > SILENCE_NS && !self.core.waits {
            *alarmed = true;
            let what =
                format!("alarm: no sample within a second from {}: {}", self.options.source, self.stream.nothing());
            (self.core.tell)(&what);
        }
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
        let nothing = self.stream.nothing();
        let (arrival_us, late) = (self.stream.arrival(), self.stream.lateness());
        let mut core = self.core;
        core.end();
        let Core { decide, warnings, mut notes, work, wake_up, fault, files, .. } = core;
        let Some(decide) = decide else {
            let place = self.options.source.named();
            return Err(fault.unwrap_or(LiveError::Source { place, what: nothing }));
        };
        let Decide { recording, answers, rows, .. } = decide;
        if rows == 0 {
            let place = self.options.source.named();
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
            latency: Latency { arrival_us, work_us: work.percentiles(), wake_up_us: late.or(wake_up.percentiles()) },
            lost_by_readers: 0,
            lost_by_disk,
            stream: certificate,
        };
        if let Some(mut answers) = answers {
            answers.readers.iter_mut().for_each(Pipe::finish);
            failed.extend(answers.readers.iter().filter_map(Pipe::failed));
            let sensor = &answers.sensor;
            figures.columns = Answers::header(sensor, answers.switch.is_some());
            (figures.answered, figures.rows_not_known) = (sensor.lit, sensor.not_known);
            figures.rows_outside = sensor.answering().outside();
            (figures.touch, figures.bending) = (answers.touch, answers.bending);
            figures.lost_by_readers = answers.readers.iter().map(Pipe::lost).sum();
            figures.switch = answers.switch.as_ref().map(SwitchOutput::counts);
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
        for kind in &figures.stream.spoilt_kinds {
            failed.push(format!(
                "{}: {} rows with {}, first in line {}: `{}`",
                figures.stream.source, kind.rows, kind.what, kind.first_line, kind.first
            ));
        }
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
            Event::Row(row) => self.row(&row),
            Event::Spoilt(_) => self.spoilt.spoilt += 1,
            Event::State(state) => {
                (self.tell)(&format!("state: {}", state.word()));
                if state == StreamState::Lost
                    && let Some(decide) = &mut self.decide
                {
                    self.fault = decide.lose(Reason::Lost).err();
                }
            }
            Event::Names { .. } => {}
            Event::End => self.ends = true,
        }
    }

    fn row(&mut self, row: &Row<'_>) {
        self.spoilt.rows += 1;
        let Some(decide) = &mut self.decide else { return };
        if let Err(why) = decide.row(row) {
            self.fault = Some(why);
            return;
        }
        if self.counts < COUNT_ROWS && decide.answers.is_some() {
            self.counts = if decide.looks_like_counts(row, COUNT_V) { self.counts + 1 } else { u32::MAX };
            if self.counts == COUNT_ROWS {
                let what = "the photodiodes are whole numbers beyond 30: they look like a converter's counts, and models \
                            read volts; say what a step is, as --volts-per-count 10/65536";
                self.fault = Some(LiveError::Request(what.to_owned()));
            }
        }
        if let (Some(seconds), Some([from_s, to_s])) = (self.seconds, decide.span_s) {
            self.ends |= to_s - from_s >= seconds;
        }
        self.work.record(self.clock.now_ns().saturating_sub(row.host_ns));
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
        let others = listens || self.files.out.is_some() || self.files.events.is_some();
        let readers = self.readers();
        !others && !readers.is_empty() && readers.iter().all(Pipe::is_gone)
    }

    fn waiting(&self) -> Vec<BorrowedFd<'_>> {
        let answers = self.decide.as_ref().and_then(|decide| decide.answers.as_ref());
        answers.map_or_else(Vec::new, |answers| answers.readers.iter().filter_map(Pipe::waiting).collect())
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
            && let Err(why) = decide.lose(Reason::End)
        {
            self.fault.get_or_insert(why);
        }
    }
}

/// What the models are to do, now that the columns are known.
fn answers(asked: Asked, columns: &StreamColumns, log: &LogReading, waits: bool) -> Result<Answers, LiveError> {
    let refused = LiveError::Request;
    let Asked { answering, switch, events, predicted, rows, keep_faults } = asked;
    let predicts = answering.columns().to_vec();
    let sensor = Sensor::new(answering, columns, log, keep_faults).map_err(refused)?;
    let switch =
        switch.map(|switch| SwitchOutput::new(switch, &predicts, columns, events)).transpose().map_err(refused)?;
    let readers = rows.into_iter().map(|rows| Pipe::new(rows, waits)).collect();
    Ok(Answers::new(sensor, switch, predicted, readers))
}

/// What has to be known of a session before its rows are used.
fn losses(report: &SessionReport) -> Vec<String> {
    let mut warnings = Vec::new();
    let losses = &report.stream.losses;
    if losses.lost > 0 {
        let how = if losses.counted { "by their counter" } else { "estimated from gaps in time" };
        warnings.push(format!(
            "{} rows never came ({how}, in {} places); lines of 70 bytes fill 115200 bits a second at 160 rows a second: \
             raise the baud rate, or send frames",
            losses.lost, losses.gaps
        ));
    }
    if report.lost_by_disk > 0 {
        warnings.push(format!("{} rows are not recorded: the disk was too slow", report.lost_by_disk));
    }
    if report.lost_by_readers > 0 {
        warnings.push(format!("readers lost {} rows: they were too slow", report.lost_by_readers));
    }
    if report.rows_outside * 20 > report.answered {
        warnings.push(format!(
            "{} of {} rows lie outside of the voltages that the model was trained on; their predictions are extrapolated",
            report.rows_outside, report.answered
        ));
    }
    warnings
}
