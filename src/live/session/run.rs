//! The loop of a session, and its entries: `live` and `record`.

use std::os::fd::OwnedFd;
use std::path::PathBuf;
use std::sync::atomic::Ordering;

use lunula_live::latency::Latency as Times;
use lunula_live::source::{Address, HostClock, MOST_WAITED, Place, Ready, wait};
use lunula_live::switch::{Switch, compared};

use super::decide::Plan;
use super::feed::Feed;
use super::fingers::{Finger, fingers, of_finger, predicted_beside};
use super::lane::{Lane, Shared};
use super::outputs::Outputs;
use super::outputs::pointer::read_mouse;
use super::outputs::recording::Recording;
use super::report::{Ended, REPORT, SessionReport, report};
use crate::files::{Places, beside};
use crate::job::Watch;
use crate::live::error::LiveError;
use crate::live::onlooker::Attended;
use crate::live::options::{LiveOptions, SessionFiles, StreamOptions};
use crate::live::steps::{live_steps, record_steps};
use crate::live::switch::{of_another_model, read_switch};
use crate::live::view::{Counts, Health, View};
use crate::predictor::{Answering, open_models};
use crate::stages::{Stages, left_out};

/// The loop looks up at least so often, nanoseconds: to be stopped, to find a lost source, to let readers in.
const TICK_NS: u64 = 100_000_000;
/// A reader that is behind is tried again after so long, nanoseconds.
const BEHIND_NS: u64 = 2_000_000;
/// Rows of several recordings that are handed out before anything else is looked at.
const TURNS: u32 = 4096;

/// Who hears rows and messages.
pub struct Readers<'a> {
    /// Where rows of answers go: standard output.
    pub rows: Option<OwnedFd>,
    /// Whoever looks after the session: states, alarms, notes.
    pub tell: &'a dyn Fn(&str),
    /// A page that shows it.
    pub view: Option<View>,
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
    let all = fingers(&options.stream, files)?;
    let gate = options.answer.gate.gate().map_err(|why| LiveError::Request(why.to_string()))?;
    let (mut plans, mut warnings) = (Vec::new(), Vec::new());
    let mut header: Option<Vec<String>> = None;
    for finger in &all {
        let opened = open_models(&finger.models)?.of_samples()?;
        let switch = finger.switch.as_deref().map(read_switch).transpose()?;
        let other = switch.as_ref().and_then(|switch| {
            let model_sha256 = opened.sha256_of(compared(switch.column.as_deref()).0);
            of_another_model(switch, model_sha256)
        });
        for warning in opened.warnings.into_iter().chain(other) {
            if !warnings.contains(&warning) {
                (readers.tell)(&format!("warning: {warning}"));
                warnings.push(warning);
            }
        }
        let answering = Answering::new(opened.predictors, gate, options.answer.intervals)?;
        let own = answering.header();
        if let Some(other) = header.replace(own.clone()).filter(|other| *other != own) {
            let what = format!(
                "the models of one finger give {}, those of another {}; name models of the same columns for each",
                other.join(","),
                own.join(",")
            );
            return Err(LiveError::Request(what));
        }
        let switch = switch.map(Switch::new);
        plans.push(Plan { answering: Some(answering), switch, ..finger.plan(options.answer.keep_faults) });
    }
    if let (Some(mouse), Some(plan)) = (&files.mouse, plans.first_mut()) {
        if all.len() > 1 {
            return Err(LiveError::Request("a mouse has one finger; name one --source".to_owned()));
        }
        let config = mouse.config.as_deref().map(read_mouse).transpose()?.unwrap_or_default();
        plan.mouse = Some((config, mouse.clone()));
    }
    let has_switch = plans.iter().any(|plan| plan.switch.is_some());
    if files.events.is_some() && !has_switch {
        return Err(LiveError::Request("--events are a switch's: name one with --switch".to_owned()));
    }
    check_places(&all, files)?;
    let waits = all.iter().all(Finger::waits);
    let mut outputs = Outputs::new(readers.rows, waits, options.tcp, files.events.clone(), readers.tell)?;
    outputs.view = readers.view;
    if let Some(out) = &files.out {
        outputs.predicted = Some(Recording::new(&predicted_beside(out), files.replace, waits)?);
    }
    let labels = plans.first().and_then(|plan| plan.answering.as_ref()).map_or(&[][..], Answering::columns);
    let named = all.iter().any(|finger| finger.name.is_some());
    outputs.name(header.unwrap_or_default(), labels, named, has_switch, options.lsl.as_deref())?;
    let mut session = Session::new(&options.stream, files, all, plans, outputs, readers.tell, None, watch)?;
    session.warnings = warnings;
    let job = if files.mouse.is_some() { "mouse" } else { "live" };
    let left_out = left_out(live_steps(options, files));
    session.run(job, left_out, watch)
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
    let all = fingers(options, files)?;
    check_places(&all, files)?;
    let plans = all.iter().map(|finger| finger.plan(false)).collect();
    let session = Session::new(options, files, all, plans, Outputs::default(), tell, None, watch)?;
    session.run("record", left_out(record_steps(options, files)), watch)
}

/// Records what somebody who looks on wants recorded, of one finger.
pub(crate) fn attend<'a>(
    options: &'a StreamOptions,
    files: &'a SessionFiles,
    mut attended: Attended<'a>,
    tell: &'a dyn Fn(&str),
    watch: &Watch<'_>,
) -> Result<SessionReport, LiveError> {
    let all = fingers(options, files)?;
    if all.len() > 1 {
        return Err(LiveError::Request("one finger at a time; name one --source".to_owned()));
    }
    check_places(&all, files)?;
    let job = attended.job;
    let plans = all.iter().map(|finger| finger.plan(false)).collect();
    let mut outputs = Outputs::default();
    outputs.view = attended.view.take();
    let session = Session::new(options, files, all, plans, outputs, tell, Some(attended), watch)?;
    session.run(job, left_out(record_steps(options, files)), watch)
}

/// No result goes over an input, and no events over those of another session.
fn check_places(all: &[Finger<'_>], files: &SessionFiles) -> Result<(), LiveError> {
    let mut inputs: Vec<PathBuf> = files.models.iter().chain(&files.switches).map(|of| of.what.clone()).collect();
    inputs.extend(files.mouse.iter().filter_map(|mouse| mouse.config.clone()));
    for source in all.iter().flat_map(|finger| std::iter::once(finger.source).chain(finger.force)) {
        if let Place::File { path, .. } = &source.place {
            inputs.push(path.clone());
        }
    }
    let of_mouse = files.mouse.iter().filter_map(|mouse| mouse.events.as_ref());
    let events: Vec<&PathBuf> = files.events.iter().chain(of_mouse).collect();
    if files.replace && files.out.is_none() && events.is_empty() {
        let what = "--replace is for a recording or events that exist; name them with --out or --events";
        return Err(LiveError::Request(what.to_owned()));
    }
    let mut results: Vec<PathBuf> = events.iter().copied().cloned().collect();
    if let Some(out) = &files.out {
        results.extend([predicted_beside(out), beside(out, REPORT)]);
        results.extend(all.iter().map(|finger| of_finger(out, finger.name.as_deref())));
    }
    Places::not_over(inputs).check(results)?;
    // Tables of two formats have one certificate.
    if let Some(out) = files.out.as_ref().filter(|_| !files.replace)
        && ["csv", "parquet"].iter().any(|ending| out.with_extension(ending).exists())
        && beside(out, REPORT).exists()
        && !out.exists()
    {
        return Err(LiveError::Exists(beside(out, REPORT)));
    }
    // Pipes and devices keep nothing. Recordings look for themselves.
    match events.into_iter().find(|events| !files.replace && events.is_file()) {
        Some(events) => Err(LiveError::Exists(events.clone())),
        None => Ok(()),
    }
}

/// A session as it goes.
struct Session<'a> {
    files: &'a SessionFiles,
    lanes: Vec<Lane<'a>>,
    shared: Shared<'a>,
    warnings: Vec<String>,
    wake_up: Times,
    /// Whether its sources are several recordings, played in the order of their rows, and whether they have begun.
    in_order: bool,
    begun: bool,
}

impl<'a> Session<'a> {
    #[allow(clippy::too_many_arguments, reason = "all that a session is made of, once")]
    fn new(
        options: &'a StreamOptions,
        files: &'a SessionFiles,
        all: Vec<Finger<'a>>,
        plans: Vec<Plan>,
        outputs: Outputs,
        tell: &'a dyn Fn(&str),
        attended: Option<Attended<'a>>,
        watch: &Watch<'_>,
    ) -> Result<Self, LiveError> {
        watch.go_on()?;
        let (clock, mut rows, onlooker) = match attended {
            None => (HostClock::start(), None, None),
            Some(Attended { onlooker, columns, clock, rows, .. }) => (clock, rows, Some((onlooker, columns))),
        };
        let waits = all.iter().all(Finger::waits);
        let mut lanes = Vec::new();
        for (finger, mut plan) in all.iter().zip(plans) {
            if let Some(out) = &files.out {
                let out = of_finger(out, finger.name.as_deref());
                plan.recording = Some(Recording::new(&out, files.replace, waits)?);
            }
            let open = |source: &'a Address, needs: &[String]| Feed::open(source, options, needs, &clock);
            let needs = plan.answering.as_ref().map_or(&[][..], Answering::inputs);
            let feed = match rows.take() {
                None => open(finger.source, needs)?,
                Some(rows) => Feed::of_rows(finger.source, rows, options),
            };
            let force = finger.force.map(|source| open(source, &[])).transpose()?;
            lanes.push(Lane::new(feed, force, plan));
        }
        let feeds = || lanes.iter().flat_map(Lane::feeds);
        let live = feeds().filter(|feed| feed.stream.is_live()).count();
        let several = feeds().count() > 1;
        if live > 0 && live < feeds().count() {
            let what = "recordings have clocks of their own; name either live sources or recordings, not both";
            return Err(LiveError::Request(what.to_owned()));
        }
        let shared = Shared {
            clock,
            tell,
            log: &options.log,
            outputs,
            notes: Vec::new(),
            work: Times::default(),
            arrival: Times::default(),
            seconds: options.seconds,
            ends: false,
            onlooker,
            cells: String::new(),
        };
        let in_order = several && live == 0;
        Ok(Self { files, lanes, shared, warnings: Vec::new(), wake_up: Times::default(), in_order, begun: false })
    }

    fn run(mut self, job: &'static str, left_out: Vec<String>, watch: &Watch<'_>) -> Result<SessionReport, LiveError> {
        let stages = Stages::default();
        let mut tick_ns = self.shared.clock.now_ns() + TICK_NS;
        let (mut ready, mut fault) = (None, None);
        while fault.is_none() && !watch.stop.load(Ordering::Relaxed) {
            fault = self.turn(ready, &mut tick_ns).err();
            self.shared.outputs.flush();
            if fault.is_some() || self.is_over() {
                break;
            }
            ready = Some(self.wait(tick_ns)?);
        }
        let Self { files, lanes, shared, warnings, wake_up, .. } = self;
        report(Ended { job, stages, files, lanes, shared, warnings, left_out, wake_up, fault }, watch)
    }

    /// Takes what has come, and what follows from time that has passed.
    fn turn(&mut self, ready: Option<Ready>, tick_ns: &mut u64) -> Result<(), LiveError> {
        if self.in_order {
            self.play_in_order()?;
        } else {
            self.poll(ready)?;
        }
        let now_ns = self.shared.clock.now_ns();
        for lane in &mut self.lanes {
            lane.advance(now_ns, &mut self.shared)?;
        }
        if let Some((onlooker, _)) = &mut self.shared.onlooker {
            onlooker.tick(now_ns)?;
            self.shared.ends |= onlooker.is_over();
        }
        if now_ns >= *tick_ns {
            *tick_ns = now_ns + TICK_NS;
            let tell = self.shared.tell;
            self.lanes.iter_mut().flat_map(Lane::feeds_mut).for_each(|feed| feed.tick(now_ns, tell));
            self.shared.outputs.let_in(tell);
            self.show_health(now_ns);
        }
        Ok(())
    }

    /// Tells a page how the session does, now and then.
    fn show_health(&mut self, now_ns: u64) {
        let Some(view) = &mut self.shared.outputs.view else { return };
        if !view.wants_health(now_ns) {
            return;
        }
        let counts = self.lanes.iter().map(|lane| Counts::of(&lane.feed.stream.certificate())).collect();
        view.health(Health { work: self.shared.work.summary(), arrival: self.shared.arrival.summary(), counts });
    }

    /// Looks at sources that are ready; at all of them where that is not known.
    fn poll(&mut self, ready: Option<Ready>) -> Result<(), LiveError> {
        let mut place = 0;
        let mut is_ready = || {
            place += 1;
            ready.is_none_or(|ready| ready.stream(place - 1))
        };
        for lane in &mut self.lanes {
            if is_ready() {
                lane.poll(&mut self.shared)?;
            }
            if lane.force.is_some() && is_ready() {
                lane.poll_force(&mut self.shared)?;
            }
        }
        Ok(())
    }

    /// Plays rows of several recordings, always the earliest; of rows at the same time the first source's.
    fn play_in_order(&mut self) -> Result<(), LiveError> {
        for _ in 0..TURNS {
            // What a recording holds next; before that is read, it is looked at first.
            let next_s = |feed: &Feed<'_>| match feed.stream.next_s() {
                _ if feed.stream.ended() => f64::INFINITY,
                Some(next_s) if !next_s.is_nan() => next_s,
                _ => f64::NEG_INFINITY,
            };
            let feeds = || self.lanes.iter().flat_map(Lane::feeds).enumerate();
            let earliest = feeds().map(|(place, feed)| (next_s(feed), place)).min_by(|a, b| a.0.total_cmp(&b.0));
            let Some((first_s, place)) = earliest.filter(|(first_s, _)| *first_s < f64::INFINITY) else { break };
            let others = feeds().filter(|(other, _)| *other != place);
            let until_s = others.map(|(_, feed)| next_s(feed)).fold(f64::INFINITY, f64::min);
            let now_ns = self.shared.clock.now_ns();
            if first_s > f64::NEG_INFINITY && !std::mem::replace(&mut self.begun, true) {
                self.lanes.iter_mut().flat_map(Lane::feeds_mut).for_each(|feed| feed.stream.play_from(first_s, now_ns));
            }
            for (other, feed) in self.lanes.iter_mut().flat_map(Lane::feeds_mut).enumerate() {
                feed.stream.play_until(if other == place { until_s } else { f64::NEG_INFINITY });
            }
            let (lane, is_force) = self.lane_at(place);
            let lane = &mut self.lanes[lane];
            let feed = if is_force { lane.force.as_ref() } else { Some(&lane.feed) };
            if feed.and_then(|feed| feed.stream.due_ns()).is_some_and(|due_ns| due_ns > now_ns) {
                break;
            }
            if is_force {
                lane.poll_force(&mut self.shared)?;
            } else {
                lane.poll(&mut self.shared)?;
            }
            if self.shared.ends {
                break;
            }
        }
        Ok(())
    }

    /// Which finger a source is of, counted as [`Lane::feeds`], and whether it is the force transducer's.
    fn lane_at(&self, place: usize) -> (usize, bool) {
        let mut left = place;
        for (at, lane) in self.lanes.iter().enumerate() {
            let feeds = lane.feeds().count();
            if left < feeds {
                return (at, left == 1);
            }
            left -= feeds;
        }
        (0, false)
    }

    /// Whether nothing more comes, or nobody hears it.
    fn is_over(&self) -> bool {
        let files = self.files;
        let others = files.out.is_some() || files.events.is_some() || files.mouse.is_some();
        self.shared.ends || self.lanes.iter().all(Lane::is_over) || !others && self.shared.outputs.nobody_reads()
    }

    /// Waits for bytes or a deadline.
    fn wait(&mut self, tick_ns: u64) -> Result<Ready, LiveError> {
        let clock = self.shared.clock;
        let now_ns = clock.now_ns();
        // A reader that is behind is looked at again soon.
        let soon_ns = if self.shared.outputs.is_behind() { now_ns + BEHIND_NS } else { tick_ns };
        let mut until_ns = tick_ns.min(soon_ns);
        let mut streams = [&self.lanes[0].feed.stream; MOST_WAITED];
        let mut count = 0;
        for lane in &self.lanes {
            until_ns = until_ns.min(lane.due_ns(now_ns).unwrap_or(until_ns));
            for feed in lane.feeds() {
                streams[count] = &feed.stream;
                count += 1;
            }
        }
        let ready = wait(&streams[..count], &[], Some(until_ns), &clock);
        let ready = ready.map_err(|why| LiveError::Request(format!("can't wait for the stream ({why})")))?;
        // Woken by the clock: how late is the machine's own part.
        let now_ns = clock.now_ns();
        if streams[0].is_live() && now_ns >= until_ns {
            self.wake_up.record_ns(now_ns - until_ns);
        }
        Ok(ready)
    }
}

#[cfg(test)]
mod tests {
    use std::fmt::Write as _;
    use std::path::Path;

    use lunula_live::source::OfFinger;
    use lunula_predictor::{Kind, Recipe};

    use super::*;
    use crate::live::options::AnswerOptions;
    use crate::predictor::{DataFile, GateChoices, TrainInputs, TrainOptions, TrainOutputs, Wanted, train};

    /// Eight photodiodes that a force, or an angle, is a sum of.
    fn log(path: &Path, rows: u32) {
        let mut text = "time_s,P1,P2,P3,P4,P5,P6,P7,P8,Fx_N,Fy_N,Fz_N,J2_deg\n".to_owned();
        for k in 0..rows {
            let t_s = 0.001 * f64::from(k);
            let volts: [f64; 8] = std::array::from_fn(|p| 3.0 + ((1.0 + p as f64) * 1.7 * t_s).sin());
            let _ = write!(text, "{t_s:.3}");
            let others = [volts[0] - volts[1], volts[2] - volts[3], -volts[4], 10.0 * volts[5]];
            for one in volts.iter().chain(&others) {
                let _ = write!(text, ",{one:.5}");
            }
            text.push('\n');
        }
        std::fs::write(path, text).unwrap();
    }

    fn model(dir: &Path, targets: &[&str]) -> OfFinger<PathBuf> {
        let model = dir.join(format!("{}.json", targets[0]));
        let inputs = TrainInputs {
            data: vec![DataFile::from(dir.join("train.csv"))],
            validate: Vec::new(),
            stop_on: Vec::new(),
        };
        let wanted = Wanted { targets: targets.iter().map(|one| (*one).to_owned()).collect(), ..Wanted::default() };
        let options = TrainOptions { wanted, recipe: Recipe::new(Kind::Linear), level: 0.9 };
        let outputs = TrainOutputs { model: model.clone(), learning_curve: None, merit: None };
        train(&inputs, &options, &outputs, &Watch::nobody()).unwrap();
        OfFinger::any(model)
    }

    /// Allocations of a whole session over so many rows: models, gate, switch, recording, rows to a reader.
    fn allocations(dir: &Path, rows: u32, models: &[OfFinger<PathBuf>]) -> u64 {
        let name = format!("{rows}.csv");
        log(&dir.join(&name), rows);
        let stream = StreamOptions {
            source: vec![OfFinger::any(dir.join(&name).to_str().unwrap().parse().unwrap())],
            ..StreamOptions::default()
        };
        let gate = GateChoices { f_min: 0.1, theta_touch: 0.0, hysteresis: 0.0 };
        let answer = AnswerOptions { gate, intervals: false, keep_faults: false };
        let options = LiveOptions { stream, answer, tcp: None, lsl: None, serve: false };
        let files = SessionFiles {
            out: Some(dir.join(format!("out-{rows}.csv"))),
            models: models.to_vec(),
            switches: vec![OfFinger::any(dir.join("s.toml"))],
            ..SessionFiles::default()
        };
        let reader = std::fs::File::create(dir.join("rows.csv")).unwrap();
        let counted = allocation_counter::measure(|| {
            let readers = Readers { rows: Some(reader.into()), tell: &|_| {}, view: None };
            let report = live(&options, &files, readers, &Watch::nobody()).unwrap();
            assert_eq!((report.rows, report.answered), (u64::from(rows), u64::from(rows)));
        });
        counted.count_total
    }

    #[test]
    fn nothing_is_allocated_for_a_sample_from_its_bytes_to_its_answer() {
        let dir = tempfile::tempdir().unwrap();
        log(&dir.path().join("train.csv"), 2_000);
        std::fs::write(dir.path().join("s.toml"), "on_N = 3.2\noff_N = 3.0\nwatchdog_s = 0.5\n").unwrap();
        let models = [model(dir.path(), &["Fx_N", "Fy_N", "Fz_N"]), model(dir.path(), &["J2_deg"])];
        allocations(dir.path(), 1_000, &models);
        let (few, many) = (allocations(dir.path(), 20_000, &models), allocations(dir.path(), 200_000, &models));
        // Buffers grow to their size and the recording's thread takes them: some hundred, whatever the rows.
        assert!(many <= few + 100, "{few} for 20 000 rows, {many} for 200 000");
    }
}
