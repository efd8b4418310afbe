//! The prompter as it hears a session: each sample and force to the run, to the page, and into the recording.

use lunula_live::source::Condition;
use lunula_live::wire::Row;
use lunula_predictor::FORCES;

use super::desk::{Desk, Pace, Shared, short};
use super::protocol::{Prompted, StepKind};
use super::run::{Key, Phase, Turn};
use crate::live::{LiveError, Onlooker, StreamColumns};
use crate::table::push_number;

/// Further columns of the recording.
pub(super) const COLUMNS: [&str; 6] =
    ["prompt_Fx_N", "prompt_Fy_N", "prompt_Fz_N", "prompt_J2_deg", "session", "trajectory"];

/// A simulated person presses a key after so long, seconds, gives a check up after so long, and a step after so many
/// tries.
const READS_S: f64 = 0.5;
const PATIENCE_S: f64 = 30.0;
const TRIES: usize = 3;

/// Hears a session.
pub(super) struct Attendant {
    desk: Desk,
    full_scale_v: Option<[f64; 2]>,
    /// Where the photodiodes are among a sample's values, and the forces, where the sensor gives them.
    photodiodes: Vec<usize>,
    own_forces: Option<[usize; 3]>,
    forces: Option<[usize; 3]>,
    volts: Vec<f64>,
    /// Whether nobody is there: a simulated person presses the keys.
    alone: Option<Alone>,
}

/// What a simulated person has seen.
#[derive(Default)]
struct Alone {
    /// The state that it looks at, and since when.
    version: u64,
    since_s: f64,
}

impl Attendant {
    pub(super) fn new(desk: Desk, full_scale_v: Option<[f64; 2]>, alone: bool) -> Self {
        Self {
            desk,
            full_scale_v,
            photodiodes: Vec::new(),
            own_forces: None,
            forces: None,
            volts: Vec::new(),
            alone: alone.then(Alone::default),
        }
    }
}

/// Where the three forces are.
fn places(names: &[String]) -> Option<[usize; 3]> {
    let [x, y, z] = FORCES.map(|force| names.iter().position(|name| name == force));
    x.zip(y).zip(z).map(|((x, y), z)| [x, y, z])
}

fn lacking(names: &[String], what: &str) -> LiveError {
    let has = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
    LiveError::Request(format!(
        "the prompter needs {}, and {what} gives {has}; say what they are called, as in --columns Fz_N=ch_3, or name \
         the force transducer with --force",
        FORCES.join(", ")
    ))
}

impl Onlooker for Attendant {
    fn begin(&mut self, columns: &StreamColumns, joins_forces: bool) -> Result<(), LiveError> {
        self.photodiodes = columns.photodiodes().collect();
        if self.photodiodes.is_empty() {
            let what = "no column is a photodiode; say what they are called, as in --columns P1=ch_1";
            return Err(LiveError::Request(what.to_owned()));
        }
        if !joins_forces {
            self.own_forces = Some(places(&columns.values).ok_or_else(|| lacking(&columns.values, "the source"))?);
        }
        let names = self.photodiodes.iter().map(|&place| columns.values[place].clone()).collect();
        self.desk.lock().run.begin(names, self.full_scale_v);
        Ok(())
    }

    fn join(&mut self, names: &[String]) -> Result<(), LiveError> {
        self.forces = Some(places(names).ok_or_else(|| lacking(names, "--force"))?);
        Ok(())
    }

    fn sample(&mut self, row: &Row<'_>, common_s: f64, cells: &mut String) -> Option<f64> {
        let desk = self.desk.clone();
        let mut shared = desk.lock();
        match &mut shared.pace {
            Pace::Live | Pace::Played(Some(_)) => {}
            Pace::Played(ahead_s) => *ahead_s = Some(1e-9 * row.host_ns as f64 - common_s),
            Pace::Clock(now_s) => *now_s = common_s,
        }
        let time_s = common_s + shared.ahead_s();
        self.volts.clear();
        self.volts.extend(self.photodiodes.iter().map(|&place| row.values[place]));
        let is_lit = row.lit != Some(false);
        shared.run.sample(time_s, is_lit.then_some(&self.volts));
        if let Some(places) = self.own_forces {
            self.measured(&mut shared, time_s, places.map(|place| row.values[place]));
        }
        let now_s = desk.of_host(&shared, desk.clock.now_ns());
        self.look(&mut shared, now_s);
        let step = shared.run.collecting(time_s)?;
        let (prompted, _) = shared.run.prompted(time_s);
        let mut cell = |value: f64| {
            cells.push(',');
            push_number(cells, short(value));
        };
        match prompted {
            Some(Prompted::Force(force)) => force.into_iter().chain([f64::NAN]).for_each(&mut cell),
            // The finger is in the air: nothing is prompted of the force.
            Some(Prompted::Bend(j2_deg)) => [f64::NAN, f64::NAN, f64::NAN, j2_deg].into_iter().for_each(&mut cell),
            None => return None,
        }
        cell(f64::from(step.session));
        cells.push(',');
        cells.push_str(&step.name);
        Some(time_s)
    }

    fn force(&mut self, row: &Row<'_>, common_s: f64) {
        let Some(places) = self.forces else { return };
        let desk = self.desk.clone();
        self.measured(&mut desk.lock(), common_s, places.map(|place| row.values[place]));
    }

    fn recorded(&mut self, force_n: [f64; 3]) {
        self.desk.lock().cover.push(force_n);
    }

    fn state(&mut self, _: bool, _: Condition) {}

    fn tick(&mut self, now_ns: u64) -> Result<(), LiveError> {
        let desk = self.desk.clone();
        let mut shared = desk.lock();
        let now_s = desk.of_host(&shared, now_ns);
        self.look(&mut shared, now_s);
        shared.fault.take().map_or(Ok(()), Err)
    }

    fn is_over(&self) -> bool {
        let shared = self.desk.lock();
        match shared.run.phase().0 {
            Phase::Over => true,
            Phase::Done => self.alone.is_some(),
            _ => false,
        }
    }
}

impl Attendant {
    fn measured(&self, shared: &mut Shared, time_s: f64, force_n: [f64; 3]) {
        shared.run.force(time_s, force_n);
        shared.follow(time_s, force_n);
        if force_n.iter().all(|force| force.is_finite()) {
            self.desk.tell_force(shared, time_s, force_n);
        }
    }

    fn look(&mut self, shared: &mut Shared, now_s: f64) {
        shared.run.advance(now_s);
        if let Some(alone) = &mut self.alone {
            alone.look(shared, now_s);
        }
        self.desk.tell(shared, now_s);
    }
}

impl Alone {
    /// Does what a person would.
    fn look(&mut self, shared: &mut Shared, now_s: f64) {
        let version = shared.run.version;
        if self.version != version {
            (self.version, self.since_s) = (version, now_s);
        }
        let waited_s = now_s - self.since_s;
        let is_check = shared.run.current().is_some_and(|step| step.kind == StepKind::Check);
        let tries = |turns: &[Turn]| {
            turns
                .iter()
                .rev()
                .take_while(|turn| turn.event != "ends")
                .filter(|turn| turn.event == "to be repeated")
                .count()
        };
        match shared.run.phase().0 {
            Phase::Waiting if tries(&shared.run.turns) >= TRIES => shared.key(Key::Skip, now_s, now_s),
            Phase::Waiting if waited_s >= READS_S => shared.key(Key::Go, now_s, now_s),
            Phase::Running if is_check && waited_s >= PATIENCE_S => shared.key(Key::Stop, now_s, now_s),
            _ => {}
        }
    }
}
