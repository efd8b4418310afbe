//! What a page is shown of a session: traces of the photodiodes, what was made of them, how the streams are.
//!
//! In: rows as they are answered. Out: at most [`PER_S`] times a second JSON of the latest, for whoever shows it; no
//! call waits, and a page that is slow gets fewer of them. Traces are decimated here: the least and the greatest value
//! of each bin of [`BIN_S`], so that a spike of one sample is seen whatever the rate. A message has the last
//! [`BINS`] bins of each photodiode, by their number, so that a page that missed one has no gap.

use std::collections::VecDeque;

use lunula_live::latency::Latency as Times;
use lunula_live::source::{Condition, Stream};
use lunula_predictor::Contact;
use serde::Serialize;

use crate::nail::Positions;

/// How often a page hears, a second, and how often of losses and latencies.
const PER_S: u64 = 25;
const COUNTS_PER_S: u64 = 2;
const S_NS: u64 = 1_000_000_000;
/// A bin of a trace, seconds, and how many a message has.
const BIN_S: f64 = 0.05;
const BINS: usize = 30;

/// Looks at a session.
pub(crate) struct View<'a> {
    show: &'a dyn Fn(&str),
    fingers: Vec<FingerView>,
    shown_ns: u64,
    counted_ns: u64,
    work: Option<[f64; 2]>,
}

/// What is shown of a finger.
#[derive(Debug, Clone, Default, Serialize)]
struct FingerView {
    name: Option<String>,
    /// Each photodiode, and where it is on the nail, in half widths and half lengths, where that is known.
    photodiodes: Vec<Photodiode>,
    /// The columns of the answer, and the latest one; what is not known is null.
    columns: Vec<String>,
    answer: Vec<Option<f64>>,
    contact: Option<&'static str>,
    pressed: Option<bool>,
    /// How the sensor's stream is, and the force transducer's.
    state: &'static str,
    force_state: Option<&'static str>,
    rows: u64,
    lost: u64,
    spoilt: u64,
    rate_hz: Option<f64>,
    /// The latest row's time, seconds.
    time_s: Option<f64>,
}

#[derive(Debug, Clone, Serialize)]
struct Photodiode {
    name: String,
    at: Option<[f64; 2]>,
    /// Where it is in a row.
    #[serde(skip)]
    place: usize,
    /// `[bin, least, greatest]`.
    trace: VecDeque<(i64, f64, f64)>,
}

/// What was made of a row.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Made<'a> {
    pub(crate) values: &'a [f64],
    pub(crate) contact: Option<Contact>,
    pub(crate) pressed: Option<bool>,
}

#[derive(Serialize)]
struct Message<'a> {
    bin_s: f64,
    fingers: &'a [FingerView],
    /// Work for a row, microseconds: half of the rows, 99 of 100.
    work_us: Option<[f64; 2]>,
}

impl<'a> View<'a> {
    /// Of fingers of these names, whether each has a force transducer of its own.
    pub(crate) fn new(show: &'a dyn Fn(&str), fingers: impl Iterator<Item = (Option<String>, bool)>) -> Self {
        let finger = |(name, joins): (Option<String>, bool)| FingerView {
            name,
            state: Condition::Ok.word(),
            force_state: joins.then_some(Condition::Ok.word()),
            ..FingerView::default()
        };
        Self { show, fingers: fingers.map(finger).collect(), shown_ns: 0, counted_ns: 0, work: None }
    }

    /// A finger's columns are known: its photodiodes, with their places in a row, and those of its answers.
    pub(crate) fn begin(
        &mut self,
        finger: usize,
        photodiodes: impl Iterator<Item = (usize, String)>,
        columns: &[String],
    ) {
        let Some(finger) = self.fingers.get_mut(finger) else { return };
        let known = Positions::thesis();
        let at = |name: &str| known.photodiodes.iter().find(|one| one.name == name).map(|one| [one.u, one.v]);
        let one = |(place, name): (usize, String)| Photodiode { at: at(&name), name, place, trace: VecDeque::new() };
        finger.photodiodes = photodiodes.map(one).collect();
        finger.columns = columns.to_vec();
    }

    /// A row with the LED on, at a time of the clock that all fingers are on.
    pub(crate) fn row(&mut self, finger: usize, time_s: f64, values: &[f64], made: Option<Made<'_>>) {
        let Some(finger) = self.fingers.get_mut(finger).filter(|_| time_s.is_finite()) else { return };
        finger.time_s = Some(time_s);
        let bin = (time_s / BIN_S).floor() as i64;
        for one in &mut finger.photodiodes {
            let Some(&value) = values.get(one.place).filter(|value| value.is_finite()) else { continue };
            match one.trace.back_mut() {
                Some((last, low, high)) if *last == bin => (*low, *high) = (low.min(value), high.max(value)),
                _ => {
                    if one.trace.len() == BINS {
                        one.trace.pop_front();
                    }
                    one.trace.push_back((bin, value, value));
                }
            }
        }
        let Some(Made { values, contact, pressed }) = made else { return };
        finger.answer.clear();
        finger.answer.extend(values.iter().map(|value| Some(*value).filter(|value| value.is_finite())));
        finger.pressed = pressed;
        finger.contact = contact.map(|contact| match contact {
            Contact::Touch => "touch",
            Contact::Bending => "bending",
            Contact::Invalid => "not known",
        });
    }

    /// How a source of a finger is.
    pub(crate) fn state(&mut self, finger: usize, is_force: bool, condition: Condition) {
        let Some(finger) = self.fingers.get_mut(finger) else { return };
        if is_force {
            finger.force_state = Some(condition.word());
        } else {
            finger.state = condition.word();
        }
    }

    /// Whether losses and latencies are to be looked at.
    pub(crate) fn counts_are_due(&mut self, now_ns: u64, work: &Times) -> bool {
        let due = now_ns >= self.counted_ns + S_NS / COUNTS_PER_S;
        if due {
            self.counted_ns = now_ns;
            self.work = work.summary().map(|work| [work.p50_us, work.p99_us]);
        }
        due
    }

    /// What came of a finger's sensor, and what did not.
    pub(crate) fn counts(&mut self, finger: usize, stream: &Stream) {
        let Some(finger) = self.fingers.get_mut(finger) else { return };
        let known = stream.certificate();
        (finger.rows, finger.rate_hz) = (known.counts.rows, known.rate_hz);
        finger.lost = known.counts.lost + known.counts.lost_by_time;
        finger.spoilt = known.spoilt.iter().map(|rows| rows.count).sum();
    }

    /// Time has passed: whoever shows it hears the latest, where that is due.
    pub(crate) fn tick(&mut self, now_ns: u64) {
        if now_ns < self.shown_ns + S_NS / PER_S {
            return;
        }
        self.shown_ns = now_ns;
        let message = Message { bin_s: BIN_S, fingers: &self.fingers, work_us: self.work };
        if let Ok(json) = serde_json::to_string(&message) {
            (self.show)(&json);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::cell::RefCell;

    use serde_json::Value;

    use super::*;

    #[test]
    fn a_spike_of_one_sample_is_seen_and_messages_are_few() {
        let shown = RefCell::new(Vec::new());
        let show = |json: &str| shown.borrow_mut().push(serde_json::from_str::<Value>(json).unwrap());
        let mut view = View::new(&show, [(Some("index".to_owned()), true)].into_iter());
        view.begin(0, [(0, "P1".to_owned()), (1, "P9".to_owned())].into_iter(), &["Fz_N".to_owned()]);
        // A second at 1 kHz, a spike at 0.5 s, nothing known of P9 from 0.7 s on.
        for k in 0..1000u32 {
            let t_s = f64::from(k) / 1000.0;
            let values = [if k == 500 { 9.0 } else { 2.0 }, if k < 700 { 1.0 } else { f64::NAN }];
            let made = Made { values: &[f64::NAN], contact: Some(Contact::Touch), pressed: Some(true) };
            view.row(0, t_s, &values, Some(made));
            view.row(7, t_s, &values, None);
            view.tick(u64::from(k) * 1_000_000);
        }
        view.state(0, false, Condition::Stalled);
        view.tick(2 * S_NS);
        let shown = shown.into_inner();
        assert!((24..=27).contains(&shown.len()), "{} messages in a second", shown.len());
        let finger = &shown.last().unwrap()["fingers"][0];
        let trace = finger["photodiodes"][0]["trace"].as_array().unwrap();
        assert_eq!((trace.len(), &trace[10]), (20, &serde_json::json!([10, 2.0, 9.0])));
        assert!(trace.iter().filter(|bin| bin[2] == 9.0).count() == 1);
        assert_eq!(finger["photodiodes"][1]["trace"].as_array().unwrap().len(), 14);
        assert!(finger["photodiodes"][1]["at"].is_null() && finger["photodiodes"][0]["at"].is_array());
        assert!(finger["answer"][0].is_null() && finger["pressed"] == true && finger["contact"] == "touch");
        assert_eq!((&finger["state"], &finger["force_state"]), (&"stalled".into(), &"ok".into()));
    }
}
