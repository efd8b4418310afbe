//! What a session reports, and how it ends.

use std::path::PathBuf;

use lunula_live::latency::{Latency as Times, LatencySummary};
use lunula_live::source::{StreamCertificate, StreamTimes};
use serde::Serialize;

use super::decide::{COUNTS, Decide};
use super::feed::Feed;
use super::lane::{Lane, Shared};
use super::outputs::pointer::{PointerCounts, PointerOutput};
use super::outputs::samples::Samples;
use super::outputs::switch::{SwitchCounts, SwitchOutput};
use crate::files::{Places, beside};
use crate::job::{Report, Watch};
use crate::live::error::LiveError;
use crate::live::options::SessionFiles;
use crate::log::doubts;
use crate::predictor::{Answering, extrapolated};
use crate::stages::Stages;

/// The report beside a recording.
pub(super) const REPORT: &str = ".stream.json";

/// How a session went.
pub type SessionReport = Report<SessionFigures>;

/// The figures of a session.
#[derive(Debug, Clone, Default, Serialize)]
pub struct SessionFigures {
    /// The recording; of several fingers the name that theirs are made of.
    pub out: Option<PathBuf>,
    /// Each source: what came, what was lost, how its clock ran.
    pub sources: Vec<SourceFigures>,
    /// The columns of the rows of answers.
    pub columns: Vec<String>,
    /// Rows that came of all fingers.
    pub rows: u64,
    /// Rows that were answered: those with the LED on.
    pub answered: u64,
    /// Of these, rows of which something is not known.
    pub rows_not_known: u64,
    /// Of these, rows outside of the voltages that a model was trained on.
    pub rows_outside: u64,
    /// Rows in touch and bending, where the two are gated.
    pub touch: u64,
    /// See `touch`.
    pub bending: u64,
    /// Rows that were recorded without a force; none where no force transducer is a device of its own.
    pub rows_without_force: Option<u64>,
    /// What the switches did.
    pub switch: Option<SwitchCounts>,
    /// What the mouse did.
    pub pointer: Option<PointerCounts>,
    /// How long rows took.
    pub latency: Latency,
    /// Rows that readers lost, as they were too slow.
    pub lost_by_readers: u64,
    /// Rows that the recording lacks, as the disk was too slow or full.
    pub lost_by_disk: u64,
}

/// One source.
#[derive(Debug, Clone, Serialize)]
pub struct SourceFigures {
    /// Whose it is, where the sources have names.
    pub finger: Option<String>,
    /// What it gives.
    pub gives: SourceRole,
    /// What came, what was lost, how its clock ran.
    #[serde(flatten)]
    pub stream: StreamCertificate,
}

/// What a source gives.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SourceRole {
    /// The samples of a sensor.
    Samples,
    /// Forces at the times of these samples.
    Forces,
}

/// How long a row took on its way; none where it can't be known.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Latency {
    /// Later than the fastest rows came, by the device's clock: what the link adds at times.
    pub arrival: Option<LatencySummary>,
    /// From the row's last byte in our hands to the end of what follows from it.
    pub work: Option<LatencySummary>,
    /// How late the host wakes this program up; of recordings, how late rows were played.
    pub wake_up: Option<LatencySummary>,
}

pub(super) struct Ended<'a> {
    pub(super) job: &'static str,
    pub(super) stages: Stages,
    pub(super) files: &'a SessionFiles,
    pub(super) lanes: Vec<Lane<'a>>,
    pub(super) shared: Shared<'a>,
    pub(super) warnings: Vec<String>,
    pub(super) left_out: Vec<String>,
    pub(super) wake_up: Times,
    pub(super) fault: Option<LiveError>,
}

/// Lets go of what is pressed, ends all files and reports.
///
/// # Errors
/// Nothing came, or nobody could be given the rows.
pub(super) fn report(ended: Ended<'_>, watch: &Watch<'_>) -> Result<SessionReport, LiveError> {
    let Ended { job, stages, files, mut lanes, mut shared, warnings, left_out, wake_up, mut fault } = ended;
    for lane in &mut lanes {
        if let Err(why) = lane.work.lose(true, &mut shared) {
            fault.get_or_insert(why);
        }
    }
    let late = lanes[0].feed.stream.lateness().and_then(Times::summary);
    let latency =
        Latency { arrival: shared.arrival.summary(), work: shared.work.summary(), wake_up: late.or(wake_up.summary()) };
    let mut figures = SessionFigures { out: files.out.clone(), latency, ..SessionFigures::default() };
    let (mut failed, mut silent, mut doubts) = (Vec::new(), Vec::new(), Vec::new());
    let (mut is_gated, mut is_recorded) = (false, false);
    for lane in lanes {
        let finger = lane.finger();
        for (feed, gives) in lane.feeds().zip([SourceRole::Samples, SourceRole::Forces]) {
            let (name, stream) = (feed.name(), feed.stream.certificate());
            failed.extend(Feed::spoilt(&stream.spoilt).map(|rows| format!("{name}: {rows}")));
            if feed.health.rows == 0 {
                let known = !feed.stream.names().is_empty();
                let what = if known { "no row came" } else { "no row came, and no names of columns" };
                let spoilt = Feed::spoilt(&stream.spoilt).next().map_or(String::new(), |rows| format!("; {rows}"));
                silent.push(LiveError::Source { place: name, what: format!("{what}{spoilt}") });
            }
            figures.sources.push(SourceFigures { finger: finger.clone(), gives, stream });
        }
        let period_s = lane.feed.stream.period_s();
        if let Some(decide) = lane.work.decide {
            is_gated |= decide.answers.as_ref().is_some_and(|answers| answers.sensor.answering.is_gated());
            is_recorded |= decide.samples.as_ref().is_some_and(Samples::is_recorded);
            let of_finger = figures.add(decide, period_s, &mut shared.notes, &mut failed);
            let whose = finger.as_ref().map_or(String::new(), |finger| format!("{finger}: "));
            doubts.extend(of_finger.into_iter().map(|doubt| format!("{whose}{doubt}")));
        }
    }
    if figures.rows == 0 {
        return Err(fault
            .or(silent.into_iter().next())
            .unwrap_or_else(|| LiveError::Request("no row came".to_owned())));
    }
    failed.splice(0..0, fault.iter().chain(&silent).map(ToString::to_string));
    let Shared { mut outputs, notes, tell, .. } = shared;
    // Where rows are all that a session gives there is nothing then.
    match outputs.finish() {
        Some(why) if files.out.is_none() => return Err(why),
        why => failed.extend(why.map(|why| why.to_string())),
    }
    figures.lost_by_readers = outputs.lost();
    figures.columns = outputs.header;
    if let Some(mut predicted) = outputs.predicted {
        // Where nothing was answered that is what stands there, and not what an earlier session left.
        failed.extend(predicted.begin().and_then(|()| predicted.close()).err().map(|why| why.to_string()));
        figures.lost_by_disk += predicted.lost;
        failed.extend(predicted.finish().err().map(|why| why.to_string()));
    }
    let mut report = Report { left_out, warnings, notes, failed, ..Report::new(job, watch, figures) };
    let before = report.notes.len();
    let answers = !report.columns.is_empty();
    if !is_gated {
        report.unused(&Answering::GATES, Answering::NO_GATE);
    }
    report.unused(&["piece", "stream"], "rows are taken as they come");
    if answers {
        report.unused(&["ambient"], "the unlit row before each is taken away");
    } else {
        report.unused(&["ambient", "full_scale"], "rows are recorded as they come");
    }
    report.notes[before..].iter().for_each(|note| tell(&format!("note: {note}")));
    let losses: Vec<String> = losses(&report).into_iter().chain(doubts).collect();
    losses.iter().for_each(|warning| tell(&format!("warning: {warning}")));
    report.warnings.extend(losses);
    let mut report = report.timed(&stages);
    // A recording of before, which is as it was, has a certificate of its own.
    if let Some(out) = files.out.as_ref().filter(|_| is_recorded) {
        let mut places = Places::not_over(files.models.iter().map(|model| &model.what));
        let written = places.write(&beside(out, REPORT), &report.text()).and_then(|()| places.commit());
        // Rows stand there, and what of them could not be recorded has to be said as well.
        report.failed.extend(written.err().map(|why| why.to_string()));
    }
    Ok(report)
}

impl SessionFigures {
    /// Adds what was made of a finger's rows, and ends its recording. Returns what to doubt of it.
    fn add(
        &mut self,
        decide: Decide,
        period_s: Option<f64>,
        notes: &mut Vec<String>,
        failed: &mut Vec<String>,
    ) -> Vec<String> {
        let Decide { samples, answers, rows, are_counts, .. } = decide;
        let mut doubts: Vec<String> = are_counts.then(|| COUNTS.to_owned()).into_iter().collect();
        self.rows += rows;
        if let Some(answers) = answers {
            let sensor = &answers.sensor;
            self.answered += sensor.lit;
            self.rows_not_known += sensor.not_known;
            self.rows_outside += sensor.answering.outside();
            self.touch += answers.touch;
            self.bending += answers.bending;
            if let Some(counts) = answers.switch.as_ref().map(|switch| switch.counts) {
                let all = self.switch.get_or_insert_default();
                all.presses += counts.presses;
                all.releases += counts.releases;
                all.let_go += counts.let_go;
            }
            self.pointer = answers.pointer.as_ref().map(|pointer| pointer.counts);
            if sensor.unknown > 0 {
                notes.push(format!("{} rows do not say whether the LED was on and are left out", sensor.unknown));
            }
            let nothing = match (sensor.lit, sensor.unlit) {
                (0, 1..) => Some("the LED was on in no row"),
                (1.., 0) if sensor.has_led() => {
                    Some("the LED was never off, so no ambient light is known; where it stays on, leave `led` out")
                }
                (lit @ 1.., _) if lit == sensor.without => {
                    Some("each lacks a photodiode that a model reads, its ambient light or what was before it")
                }
                _ => None,
            };
            failed.extend(nothing.map(|why| format!("no row is answered: {why}")));
            doubts.extend(sensor.doubts());
            let watchdogs = [
                answers.switch.as_ref().and_then(SwitchOutput::watchdog_s),
                answers.pointer.as_ref().map(PointerOutput::watchdog_s),
            ];
            let shortest_s = watchdogs.into_iter().flatten().fold(f64::INFINITY, f64::min);
            let step_s = period_s.map(|period_s| period_s * rows as f64 / sensor.lit.max(1) as f64);
            doubts.extend(step_s.filter(|_| sensor.lit >= STEPS).and_then(|step_s| impatient(shortest_s, step_s)));
        }
        let Some(mut samples) = samples else { return doubts };
        failed.extend(samples.close().err().map(|why| why.to_string()));
        doubts.extend(samples.doubts());
        if let Some(without) = samples.without_force() {
            *self.rows_without_force.get_or_insert(0) += without;
        }
        self.lost_by_disk += samples.lost();
        failed.extend(samples.finish().err().map(|why| why.to_string()));
        doubts
    }
}

/// More rows than this share that are not answered in full are a warning: lags and ambient light lack the first ones.
const FEW: f64 = 0.02;

/// Rows without a clock that come in longer bursts are a warning, seconds: *measured*, on the rows that press of two
/// phantoms' recordings, forces that are so late are 0.06 N off (RMS; their `Fz_N` spreads by 1.1 N), of the 16 ms of a
/// USB bridge 0.02 N.
const BURST_S: f64 = 0.05;

/// Below so many rows nothing is said of how far apart they are (assumed).
const STEPS: u64 = 10;
/// A device's clock whose drift against the host's is less is right about its unit, millionths (assumed).
const SAME_UNIT_PPM: f64 = 1e5;

/// No device sends rows as text so often (assumed: 2 MBd carry 10,000 of 20 bytes a second).
const MOST_HZ: f64 = 50_000.0;

/// Whether a stream's times are in another unit than seconds, in words: by the step between its rows, unless the
/// arrival of rows agrees with it.
fn unit(stream: &StreamCertificate) -> Option<String> {
    let counts = &stream.counts;
    if stream.times == Some(StreamTimes::Arrival) {
        let rate_hz = stream.rate_hz.filter(|rate_hz| counts.rows >= STEPS && *rate_hz > MOST_HZ)?;
        return Some(format!(
            "rows have no time of their own, and come at {rate_hz:.0} Hz: were they recorded before? Their times are \
             those at which they came here; give them a column time_s"
        ));
    }
    if stream.times != Some(StreamTimes::Device) {
        return None;
    }
    let unfit = counts.doubtful + counts.set_back;
    if unfit >= STEPS && 2 * unfit > counts.rows {
        let what = "the times of most rows do not fit to their arrival: are they in seconds? Write them in seconds, or \
                    say with --time-unit what they are in";
        return Some(what.to_owned());
    }
    let arrives = stream.clock.as_ref().is_some_and(|clock| clock.drift_ppm.abs() < SAME_UNIT_PPM);
    let step_s = stream.rate_hz.filter(|_| !arrives && counts.rows >= STEPS)?.recip();
    doubts::unit(step_s, step_s * counts.rows as f64, counts.rows as usize)
}

/// That a watchdog lets go between answers, which are usually so far apart.
fn impatient(watchdog_s: f64, step_s: f64) -> Option<String> {
    (watchdog_s < step_s).then(|| {
        format!(
            "watchdog_s = {watchdog_s} lets go of everything between two answers, which are {step_s:.3} s apart: \
             nothing can be pressed; write several times that"
        )
    })
}

/// What has to be known of a session before its rows are used.
fn losses(report: &SessionReport) -> Vec<String> {
    let mut warnings = Vec::new();
    for SourceFigures { finger, gives, stream } in &report.sources {
        let whose = finger.as_ref().map_or(String::new(), |finger| format!("{finger}: "));
        let what = if *gives == SourceRole::Forces { "rows of forces" } else { "rows" };
        let counts = &stream.counts;
        for (count, how) in [
            (counts.lost, "never came or came late (by their counter)"),
            (counts.lost_by_time, "never came or came late (estimated from gaps in time)"),
            (counts.disorder, "came behind later ones and are left out"),
            (counts.duplicates, "came twice (by their counter) and are counted once"),
            (
                counts.doubtful,
                "have a time or a count that fits neither to the row before nor to the one behind (a digit \
                               is damaged?) and are left out",
            ),
        ] {
            if count > 0 {
                warnings.push(format!("{whose}{count} {what} {how}"));
            }
        }
        if counts.shared > 0 {
            warnings.push(format!(
                "{whose}{} of {} {what} have the time of the row before (rows stamped in packets, or that came twice): \
                 the rate is by their number, and when within a packet each was made is not known, nor all that is \
                 lost; let the device stamp each row, or number them in a column n",
                counts.shared, counts.rows
            ));
        }
        if let Some(burst_s) = stream.burst_s.filter(|burst_s| *burst_s > BURST_S) {
            warnings.push(format!(
                "{whose}{what} have no time of their own and come in bursts, {:.0} ms apart: their times are spread \
                 over each burst and may be wrong by as much; let the device send its time in a column time_us, or \
                 each row by itself",
                1e3 * burst_s
            ));
        }
        let of = if *gives == SourceRole::Forces { "--force: " } else { "" };
        warnings.extend(unit(stream).map(|doubt| format!("{whose}{of}{doubt}")));
        if counts.set_back > 0 {
            warnings.push(format!(
                "{whose}the clock or counter began again {} time(s): times go on from there by what passed on this \
                 computer, or by one row, and are no longer the device's",
                counts.set_back
            ));
        }
    }
    if let Some(without) = report.rows_without_force.filter(|without| *without > 0) {
        warnings.push(format!(
            "{without} of {} rows have no force: the source of --force had none around their time",
            report.rows
        ));
    }
    if report.lost_by_disk > 0 {
        warnings.push(format!("{} rows are not recorded: the disk was too slow or is full", report.lost_by_disk));
    }
    if report.lost_by_readers > 0 {
        warnings.push(format!("readers lost {} rows: they were too slow", report.lost_by_readers));
    }
    if report.rows_not_known as f64 > FEW * report.answered as f64 {
        warnings.push(format!(
            "{} of {} rows are not answered in full: a photodiode is missing or saturated, or the ambient light or the \
             past that a model reads is not known",
            report.rows_not_known, report.answered
        ));
    }
    warnings.extend(extrapolated(report.rows_outside, report.answered));
    warnings
}

#[cfg(test)]
mod tests {
    use lunula_live::time::{ClockFit, RowCounts};

    use super::*;

    fn stream(counts: RowCounts, step_s: f64, drift_ppm: Option<f64>) -> StreamCertificate {
        let clock = |drift_ppm| ClockFit {
            device_s: 0.0,
            offset_s: 0.0,
            offset_low_s: 0.0,
            offset_se_s: 0.0,
            drift_ppm,
            drift_se_ppm: 0.0,
            rows: counts.rows,
            window_s: 100.0,
        };
        StreamCertificate {
            source: "-".to_owned(),
            form: None,
            columns: Vec::new(),
            times: Some(StreamTimes::Device),
            host_start_unix_s: None,
            counts,
            rate_hz: Some(step_s.recip()),
            burst_s: None,
            spoilt: Vec::new(),
            gaps: Vec::new(),
            gaps_count: 0,
            longest_gap_s: None,
            states: Vec::new(),
            states_left_out: 0,
            clock: drift_ppm.map(clock),
            notes: Vec::new(),
        }
    }

    #[test]
    fn a_time_in_milliseconds_is_doubted_and_a_slow_stream_is_not() {
        let rows = |rows: u64, doubtful: u64| RowCounts { rows, doubtful, ..RowCounts::default() };
        let doubted = unit(&stream(rows(600, 0), 10.0, None)).unwrap();
        assert!(doubted.starts_with("rows are 10 s apart") && doubted.contains("--time-unit"), "{doubted}");
        // A device whose clock runs a thousand times as fast as the host's.
        assert_eq!(unit(&stream(rows(600, 0), 10.0, Some(-999_000.0))), Some(doubted));
        let at_once = StreamCertificate { times: Some(StreamTimes::Arrival), ..stream(rows(600, 0), 2e-6, None) };
        assert!(unit(&at_once).unwrap().starts_with("rows have no time of their own, and come at 500000 Hz"));
        let days = unit(&stream(rows(600, 0), 0.04 / 86_400.0, None)).unwrap();
        assert!(days.contains("days as a spreadsheet counts them"), "{days}");
        let set_back = RowCounts { rows: 600, set_back: 599, ..RowCounts::default() };
        let arrival = unit(&stream(set_back, 20.0, None)).unwrap();
        assert!(arrival.starts_with("the times of most rows do not fit"), "{arrival}");
        for fine in [
            stream(rows(600, 0), 0.01, None),
            stream(rows(60_000, 0), 5e-4, None),
            StreamCertificate { times: Some(StreamTimes::Arrival), ..stream(rows(600, 0), 1e-4, None) },
            stream(rows(9, 0), 10.0, None),
            stream(rows(600, 3), 10.0, Some(40.0)),
            StreamCertificate { times: Some(StreamTimes::Arrival), ..stream(rows(600, 0), 10.0, None) },
        ] {
            assert_eq!(unit(&fine), None, "{fine:?}");
        }
    }
}
