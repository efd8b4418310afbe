//! A row of voltages in, forces and angle out, as a recording or a live sensor gives one row after the other.
//!
//! With a model of force and one of posture the two are gated as in equations 9 and 16: while the finger presses (N =
//! -Fz at F_min or more) the angle is theta_touch, else the posture model gives it. A row that lacks a voltage that a
//! model reads has no prediction of that model; without an Fz there is no telling touch from bending, and no angle.
//! Where a recording begins, what was remembered of the one before (lags, the gate's state) is forgotten; the gate
//! forgets over a gap as well.

use lunula_predictor::{Contact, FORCES, Gate, GateState, LagStream, Predictor};

use crate::predictor::error::PredictorError;
use crate::predictor::options::target::POSTURE;
use crate::table::push_number;

/// After a gap of more than this the gate no longer knows whether the finger touches, seconds: assumed.
const FORGOTTEN_S: f64 = 1.0;

/// How predictions are made from models.
#[derive(Debug, Clone)]
pub struct Answering {
    voices: Vec<Voice>,
    inputs: Vec<String>,
    columns: Vec<String>,
    gate: Option<Gated>,
    intervals: bool,
    /// Half the width of each column's interval.
    half_widths: Vec<f64>,
    /// The time of the row before.
    last_s: f64,
    /// Rows outside of what a model was trained on.
    outside: u64,
    /// Whether the last row lay far outside.
    is_far_outside: bool,
    /// The SD that models give of their own, a column each; NaN of those that give none.
    sds: Vec<f64>,
}

#[derive(Debug, Clone)]
struct Voice {
    predictor: Predictor,
    /// Where its inputs are in a row.
    places: Vec<usize>,
    first: usize,
    buffer: Option<LagStream>,
    row: Vec<f64>,
    seen: Vec<f64>,
}

#[derive(Debug, Clone)]
struct Gated {
    gate: Gate,
    state: GateState,
    fz: usize,
    angle: usize,
}

impl Answering {
    /// Of one model or more; with forces and [`POSTURE`] among their targets, `gate` is applied.
    ///
    /// # Errors
    /// Two models that tell the same target, or intervals of a model that has none.
    pub fn new(models: Vec<Predictor>, gate: Gate, intervals: bool) -> Result<Self, PredictorError> {
        let mut inputs: Vec<String> = Vec::new();
        let mut columns: Vec<String> = Vec::new();
        let mut voices = Vec::new();
        for predictor in models {
            let places = predictor.inputs().iter().map(|channel| {
                inputs.iter().position(|name| *name == channel.name).unwrap_or_else(|| {
                    inputs.push(channel.name.clone());
                    inputs.len() - 1
                })
            });
            let places: Vec<usize> = places.collect();
            let first = columns.len();
            for target in predictor.target_names() {
                if columns.contains(&target) {
                    return Err(PredictorError::Request(format!("two models tell {target}; name one of them")));
                }
                columns.push(target);
            }
            if intervals && predictor.intervals().is_none() {
                let what = "has no prediction intervals; train it with --validate, on recordings of other sessions";
                return Err(PredictorError::Request(format!(
                    "the model of {} {what}",
                    predictor.target_names().join(", ")
                )));
            }
            let buffer = predictor.lags().map(|lags| lags.stream(places.len()));
            let width = predictor.model().inputs();
            voices.push(Voice {
                row: vec![0.0; places.len()],
                seen: vec![0.0; width],
                predictor,
                places,
                first,
                buffer,
            });
        }
        let place = |name: &str| columns.iter().position(|column| column == name);
        let gate = place(FORCES[2]).zip(place(POSTURE)).map(|(fz, angle)| Gated {
            gate,
            state: GateState::default(),
            fz,
            angle,
        });
        let of = |voice: &Voice| voice.predictor.intervals().map_or_else(Vec::new, |found| found.half_width.clone());
        let half_widths = voices.iter().flat_map(of).collect();
        let sds = vec![f64::NAN; columns.len()];
        Ok(Self {
            voices,
            inputs,
            columns,
            gate,
            intervals,
            half_widths,
            outside: 0,
            is_far_outside: false,
            last_s: f64::NAN,
            sds,
        })
    }

    /// The photodiodes that a row holds, in order.
    #[must_use]
    pub fn inputs(&self) -> &[String] {
        &self.inputs
    }

    /// What an answer holds, in order.
    #[must_use]
    pub fn columns(&self) -> &[String] {
        &self.columns
    }

    /// Whether a model reads voltages of the past.
    #[must_use]
    pub fn needs_time(&self) -> bool {
        self.voices.iter().any(|voice| voice.buffer.is_some())
    }

    /// Options that are of use to a gate alone, ..
    pub(crate) const GATES: [&str; 3] = ["f_min", "theta_touch", "hysteresis"];
    /// .. and why they are of none.
    pub(crate) const NO_GATE: &str = "only a model of force and one of posture together are gated";

    /// Whether force and posture are gated.
    #[must_use]
    pub fn is_gated(&self) -> bool {
        self.gate.is_some()
    }

    /// Half the width of each column's interval, where intervals are asked for.
    #[must_use]
    pub fn half_widths(&self) -> Option<Vec<f64>> {
        self.intervals.then(|| self.half_widths.clone())
    }

    /// Columns of which the models give an SD of their own, by their places.
    #[must_use]
    pub fn with_sd(&self) -> Vec<usize> {
        let own = self.voices.iter().filter(|voice| voice.predictor.eigennails().is_some());
        own.flat_map(|voice| voice.first..voice.first + voice.predictor.targets().len()).collect()
    }

    /// The SD of what would be measured about each column of the last answer, in its unit; NaN where not known.
    #[must_use]
    pub fn sds(&self) -> &[f64] {
        &self.sds
    }

    /// The columns after the time: each prediction, then each interval's ends.
    #[must_use]
    pub fn output_columns(&self) -> Vec<String> {
        let mut names = self.columns.clone();
        if self.intervals {
            names.extend(self.columns.iter().flat_map(|name| [format!("{name}_low"), format!("{name}_high")]));
        }
        names
    }

    /// The columns of a row as [`push_row`](Self::push_row) writes it.
    #[must_use]
    pub fn header(&self) -> Vec<String> {
        let mut names = vec!["time_s".to_owned()];
        names.extend(self.output_columns());
        names.extend(self.is_gated().then(|| "contact".to_owned()));
        names
    }

    /// Writes a row of CSV, without its end: the time, an answer, its intervals, what the gate says. The same text as a
    /// table's; nothing is allocated that `line` has room for.
    pub fn push_row(&self, line: &mut String, time_s: f64, answer: &[f64], contact: Option<Contact>) {
        push_number(line, time_s);
        for value in answer.iter().copied() {
            line.push(',');
            push_number(line, value);
        }
        let half_widths = self.intervals.then_some(&self.half_widths[..]);
        for value in interval_cells(answer, half_widths, self.ruled(contact)) {
            line.push(',');
            push_number(line, value);
        }
        if let Some(contact) = contact {
            line.push(',');
            line.push_str(contact_word(contact));
        }
    }

    /// The angle that theta_touch stands for: the posture model's errors say nothing of it.
    #[must_use]
    pub fn ruled(&self, contact: Option<Contact>) -> Option<usize> {
        self.gate.as_ref().filter(|_| contact == Some(Contact::Touch)).map(|gated| gated.angle)
    }

    /// The greatest value of a photodiode that a model was trained on.
    pub(crate) fn greatest_input(&self) -> f64 {
        let inputs = self.voices.iter().flat_map(|voice| voice.predictor.inputs());
        inputs.map(|channel| channel.high).fold(f64::NEG_INFINITY, f64::max)
    }

    /// How many rows lay outside of what a model was trained on.
    #[must_use]
    pub fn outside(&self) -> u64 {
        self.outside
    }

    /// Whether the last row lay so far outside of what some model was trained on that nothing is to be done by it.
    #[must_use]
    pub fn is_far_outside(&self) -> bool {
        self.is_far_outside
    }

    /// Answers a row: `row` volts as [`inputs`](Self::inputs) (NaN where missing), `out` as [`columns`](Self::columns),
    /// NaN where not known; `begins` where a recording does. Nothing is allocated. Returns what the gate says, where
    /// there is one.
    pub fn answer(&mut self, time_s: f64, begins: bool, row: &[f64], out: &mut [f64]) -> Option<Contact> {
        if begins {
            self.voices.iter_mut().filter_map(|voice| voice.buffer.as_mut()).for_each(LagStream::reset);
        }
        if let Some(gated) = self.gate.as_mut().filter(|_| begins || time_s - self.last_s > FORGOTTEN_S) {
            gated.state = GateState::default();
        }
        self.last_s = time_s;
        self.is_far_outside = false;
        // Of models whose word counts, and of a posture model whose word counts only where the finger does not touch.
        let (mut outside, mut outside_bending) = (false, false);
        for voice in &mut self.voices {
            let Voice { predictor, places, first, buffer, row: own, seen } = voice;
            for (value, &place) in own.iter_mut().zip(places.iter()) {
                *value = row[place];
            }
            let out = &mut out[*first..*first + predictor.targets().len()];
            let known = match buffer {
                Some(buffer) => buffer.push(time_s, own, seen),
                None => {
                    seen.copy_from_slice(own);
                    // A picture with too few cells is answered by NaN.
                    predictor.reads_hidden() || seen.iter().all(|value| value.is_finite())
                }
            };
            if known {
                predictor.predict_row(seen, out);
                if let Some(model) = predictor.eigennails() {
                    model.sd_row(seen, &mut self.sds[*first..*first + out.len()]);
                }
                let posture_only = predictor.targets().len() == 1 && predictor.targets()[0].name == POSTURE;
                *(if posture_only { &mut outside_bending } else { &mut outside }) |= predictor.is_outside(own);
                self.is_far_outside |= predictor.is_far_outside(own);
            } else {
                out.fill(f64::NAN);
            }
        }
        let Some(gated) = &mut self.gate else {
            self.outside += u64::from(outside || outside_bending);
            return None;
        };
        let contact = gated.gate.step(&mut gated.state, out[gated.fz]);
        self.outside += u64::from(outside || (outside_bending && contact == Contact::Bending));
        // The SD is that of the posture model, whose word counts only in bending.
        if contact != Contact::Bending {
            self.sds[gated.angle] = f64::NAN;
        }
        out[gated.angle] = match contact {
            Contact::Bending => out[gated.angle],
            Contact::Touch => gated.gate.theta_touch_deg(),
            Contact::Invalid => f64::NAN,
        };
        Some(contact)
    }
}

/// Both ends of each prediction's interval; none of an angle that the gate rules.
pub(in crate::predictor) fn interval_cells<'a>(
    answer: &'a [f64],
    half_widths: Option<&'a [f64]>,
    ruled: Option<usize>,
) -> impl Iterator<Item = f64> + 'a {
    let all = answer.iter().zip(half_widths.unwrap_or_default()).enumerate();
    all.flat_map(move |(k, (value, half))| if Some(k) == ruled { [f64::NAN; 2] } else { [value - half, value + half] })
}

/// What a table says of a contact.
#[must_use]
pub(crate) fn contact_word(contact: Contact) -> &'static str {
    match contact {
        Contact::Touch => "touch",
        Contact::Bending => "bending",
        Contact::Invalid => "invalid",
    }
}
