//! What a page shows of a session while it goes: traces, answers, contact, switch, how the source is.
//!
//! The session's thread only keeps the least and the largest of each photodiode over [`BIN_S`], and hands such a bin
//! on; a full queue loses the bin, never the sample. Another thread ([`Window`]) keeps the last seconds and makes a
//! picture of them ten times a second, whoever looks: to make one of ten fingers takes as long as hundreds of samples.
//! Pages are told the latest.

mod window;

use std::sync::mpsc::{SyncSender, sync_channel};

use lunula_live::latency::LatencySummary;
use lunula_live::source::StreamCertificate;
use lunula_live::time::RowCounts;
use lunula_live::wire::Spoil;
use lunula_predictor::Contact;
use serde::Serialize;

use crate::predictor::contact_word;

pub use window::Window;

/// A pixel of a trace, seconds: ten seconds are 200 pixels.
const BIN_S: f64 = 0.05;
/// How the session does is looked up so often, nanoseconds.
const HEALTH_NS: u64 = 1_000_000_000;
/// Bins and news that may wait for the window: some seconds of ten fingers.
const MOST_WAITING: usize = 1024;

/// Where a session leaves what a page shows.
#[derive(Debug)]
pub struct View {
    to: SyncSender<News>,
    open: Vec<Option<Bin>>,
    /// When it wants to know how the session does, nanoseconds.
    due_ns: u64,
}

/// What happened.
#[derive(Debug)]
enum News {
    Finger(usize, Finger),
    Bin(usize, Bin),
    State(usize, String),
    Health(Health),
}

/// A finger's columns.
#[derive(Debug, Clone, Default, Serialize)]
struct Finger {
    /// None where there is one only.
    name: Option<String>,
    photodiodes: Vec<String>,
    answers: Vec<String>,
    has_switch: bool,
}

/// Some samples of a finger, and the last answer among them.
#[derive(Debug, Clone)]
struct Bin {
    /// Which one, counted from 0 of the stream's clock.
    place: f64,
    low: Vec<f64>,
    high: Vec<f64>,
    answers: Vec<f64>,
    contact: Option<&'static str>,
    /// Whether the switch was pressed in any of it.
    pressed: Option<bool>,
}

/// How the session does.
#[derive(Debug, Clone, Default, Serialize)]
pub(super) struct Health {
    pub(super) work: Option<LatencySummary>,
    pub(super) arrival: Option<LatencySummary>,
    /// Of each finger.
    pub(super) counts: Vec<Counts>,
}

/// Rows of a finger's sensor.
#[derive(Debug, Clone, Copy, Default, Serialize)]
pub(super) struct Counts {
    rows: u64,
    lost: u64,
    spoilt: u64,
    rate_hz: Option<f64>,
}

impl Counts {
    pub(super) fn of(stream: &StreamCertificate) -> Self {
        let RowCounts { rows, lost, lost_by_time, .. } = stream.counts;
        let spoilt = stream.spoilt.iter().filter(|rows| rows.kind != Spoil::BeforeNames).map(|rows| rows.count).sum();
        Self { rows, lost: lost + lost_by_time, spoilt, rate_hz: stream.rate_hz }
    }
}

/// A sample that was answered.
pub(super) struct Seen<'a> {
    pub(super) time_s: f64,
    pub(super) volts: &'a [f64],
    pub(super) answers: &'a [f64],
    /// What the gate said.
    pub(super) contact: Option<Contact>,
    /// Whether its switch is pressed; none without one.
    pub(super) pressed: Option<bool>,
}

impl View {
    /// A session's end and a page's.
    #[must_use]
    pub fn new() -> (Self, Window) {
        let (to, from) = sync_channel(MOST_WAITING);
        (Self { to, open: Vec::new(), due_ns: 0 }, Window::new(from))
    }

    /// A finger's columns are known.
    pub(super) fn finger(
        &mut self,
        place: usize,
        name: Option<&str>,
        [photodiodes, answers]: [&[String]; 2],
        has_switch: bool,
    ) {
        self.open.resize_with(self.open.len().max(place + 1), || None);
        let [photodiodes, answers] = [photodiodes, answers].map(<[String]>::to_vec);
        self.tell(News::Finger(place, Finger { name: name.map(str::to_owned), photodiodes, answers, has_switch }));
    }

    pub(super) fn sample(&mut self, finger: usize, seen: &Seen<'_>) {
        let place = (seen.time_s / BIN_S).floor();
        let Some(open) = self.open.get_mut(finger).filter(|_| place.is_finite()) else { return };
        let over = open.take_if(|bin| bin.place != place);
        let bin = open.get_or_insert_with(|| Bin::new(place, seen.volts.len()));
        bin.add(seen);
        if let Some(over) = over {
            self.tell(News::Bin(finger, over));
        }
    }

    /// How a finger's source is.
    pub(super) fn state(&mut self, finger: usize, state: &str) {
        self.tell(News::State(finger, state.to_owned()));
    }

    /// Whether it is time to say how the session does.
    pub(super) fn wants_health(&mut self, now_ns: u64) -> bool {
        let is_due = now_ns >= self.due_ns;
        if is_due {
            self.due_ns = now_ns + HEALTH_NS;
        }
        is_due
    }

    /// How the session does.
    pub(super) fn health(&mut self, health: Health) {
        self.tell(News::Health(health));
    }

    /// Never waits.
    fn tell(&self, news: News) {
        drop(self.to.try_send(news));
    }
}

impl Bin {
    fn new(place: f64, photodiodes: usize) -> Self {
        let [low, high] = [f64::NAN; 2].map(|unknown| vec![unknown; photodiodes]);
        Self { place, low, high, answers: Vec::new(), contact: None, pressed: None }
    }

    fn add(&mut self, seen: &Seen<'_>) {
        // The least and largest of what is known.
        self.low.iter_mut().zip(seen.volts).for_each(|(low, &volts)| *low = low.min(volts));
        self.high.iter_mut().zip(seen.volts).for_each(|(high, &volts)| *high = high.max(volts));
        self.answers.clear();
        self.answers.extend_from_slice(seen.answers);
        self.contact = seen.contact.map(contact_word);
        self.pressed = seen.pressed.map(|pressed| pressed || self.pressed == Some(true));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(of: &[&str]) -> Vec<String> {
        of.iter().map(|name| (*name).to_owned()).collect()
    }

    /// A finger of one photodiode and one force.
    fn view() -> (View, Window) {
        let (mut view, window) = View::new();
        view.finger(0, None, [&names(&["P1"]), &names(&["Fz_N"])], true);
        (view, window)
    }

    fn seen(time_s: f64, volts: &[f64], pressed: bool) -> Seen<'_> {
        Seen { time_s, volts, answers: &[-1.5], contact: Some(Contact::Touch), pressed: Some(pressed) }
    }

    fn picture(window: &mut Window) -> serde_json::Value {
        window.take();
        serde_json::from_str(&window.picture()).unwrap()
    }

    #[test]
    fn a_pixel_has_the_least_and_the_largest_of_its_samples() {
        let (mut view, mut window) = view();
        for (k, volts) in [1.0, 3.0, 2.0, f64::NAN, 5.0].into_iter().enumerate() {
            view.sample(0, &seen(0.02 * k as f64, &[volts], k == 1));
        }
        // 0 to 0.05 s hold three, 0.05 to 0.1 s two, which are not over.
        view.state(0, "ok");
        let shown = picture(&mut window);
        let finger = &shown["fingers"][0];
        assert_eq!((&finger["low"][0], &finger["high"][0]), (&serde_json::json!([1.0]), &serde_json::json!([3.0])));
        assert!(finger["pressed"] == true && finger["contact"] == "touch" && finger["state"] == "ok");
        assert_eq!(finger["values"], serde_json::json!([-1.5]));
        view.sample(0, &seen(0.31, &[4.0], false));
        let shown = picture(&mut window);
        // Without samples there is no trace.
        assert_eq!(shown["fingers"][0]["low"][0], serde_json::json!([1.0, 5.0]));
        view.sample(0, &seen(0.36, &[4.0], false));
        let shown = picture(&mut window);
        assert_eq!(shown["fingers"][0]["low"][0], serde_json::json!([1.0, 5.0, null, null, null, null, 4.0]));
        assert!(shown["fingers"][0]["pressed"] == false);
    }

    #[test]
    fn the_window_is_bounded_and_a_clock_set_back_begins_it_again() {
        let (mut view, mut window) = view();
        for k in 0..5000 {
            view.sample(0, &seen(0.05 * f64::from(k), &[1.0], false));
            window.take();
        }
        assert_eq!(picture(&mut window)["fingers"][0]["low"][0].as_array().unwrap().len(), 200);
        // A leap over a day is a window of nothing but its end.
        view.sample(0, &seen(1e5, &[2.0], false));
        view.sample(0, &seen(1e5 + 0.06, &[2.0], false));
        let shown = picture(&mut window);
        let trace = shown["fingers"][0]["low"][0].as_array().unwrap();
        assert!(trace.len() == 200 && trace[198].is_null() && trace[199] == 2.0);
        view.sample(0, &seen(1.0, &[7.0], false));
        view.sample(0, &seen(1.06, &[7.0], false));
        assert_eq!(picture(&mut window)["fingers"][0]["low"][0], serde_json::json!([7.0]));
    }

    #[test]
    fn nobody_who_looks_holds_the_session_up() {
        let (mut view, window) = view();
        for k in 0..10_000 {
            view.sample(0, &seen(0.06 * f64::from(k), &[1.0], false));
        }
        drop(window);
        view.sample(0, &seen(1e3, &[1.0], false));
        view.state(0, "lost");
    }
}
