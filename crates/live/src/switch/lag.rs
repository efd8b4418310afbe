//! How far what a model says follows true contact.
//!
//! In: a [`Trace`]. Out: by how much contact has to be shifted to be likest to the values, a Pearson correlation of the
//! rows around contacts. Blood takes 0.1 to 0.3 s (4.3): values that follow later, or that come before contact, are on
//! another clock. *Measured* on three phantom recordings of contacts: -0.02 to 0.02 s with models of contact and of
//! force that have lags, 0.06 to 0.12 s with those without, at correlations of 0.88 to 0.97; 0.24 s with forces learnt
//! of spirals alone, and up to 0.64 s on other phantoms, at 0.6 to 0.87. With contact 0.4 s ahead so much more.

use super::evaluate::Trace;

/// Shifts that are tried.
const SHIFTS: i32 = 50;
const STEP_S: f64 = 0.02;
/// Rows so near to a contact count.
const NEAR_S: f64 = 1.5;
/// So many of them at most, evenly spread.
const ROWS: usize = 50_000;
/// Fewer contacts, or a worse likeness, say nothing.
const FEWEST: usize = 5;
const ALIKE: f64 = 0.6;

/// By how much values follow contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lag {
    /// Seconds; below 0 where they come before it.
    pub by_s: f64,
    /// The correlation with contact shifted so.
    pub shifted: f64,
    /// The same as recorded.
    pub recorded: f64,
}

impl Lag {
    /// Of a recording; none where it has fewer than five whole contacts, or values that are not like contact.
    #[must_use]
    pub fn of(trace: &Trace) -> Option<Self> {
        let contacts = &trace.contacts.contacts;
        if contacts.iter().filter(|one| one.start_known && one.end_known).count() < FEWEST {
            return None;
        }
        let is_near = |t_s: f64| {
            let begun = contacts.partition_point(|one| one.start_s <= t_s + NEAR_S);
            begun > 0 && t_s <= contacts[begun - 1].end_s + NEAR_S
        };
        let rows = trace.time_s.iter().copied().zip(trace.value.iter().copied());
        let rows: Vec<(f64, f64)> = rows.filter(|(t_s, value)| value.is_finite() && is_near(*t_s)).collect();
        let rows: Vec<(f64, f64)> = rows.iter().step_by(1 + rows.len() / ROWS).copied().collect();
        let at = |by_s: f64| {
            let touches = |t_s: f64| trace.contacts.touches(t_s - by_s).map(|touches| f64::from(u8::from(touches)));
            correlation(rows.iter().filter_map(|(t_s, value)| Some([touches(*t_s)?, *value])))
        };
        let shifts = (-SHIFTS..=SHIFTS).map(|k| f64::from(k) * STEP_S);
        let (by_s, shifted) =
            shifts.filter_map(|by_s| Some((by_s, at(by_s)?))).max_by(|one, other| one.1.total_cmp(&other.1))?;
        (shifted >= ALIKE).then_some(Self { by_s, shifted, recorded: at(0.0)? })
    }
}

/// Pearson's; none of numbers that do not change.
fn correlation(pairs: impl Iterator<Item = [f64; 2]> + Clone) -> Option<f64> {
    let count = pairs.clone().count() as f64;
    let mean = pairs.clone().fold([0.0; 2], |sum, pair| [sum[0] + pair[0] / count, sum[1] + pair[1] / count]);
    let [a, b, both] = pairs.fold([0.0; 3], |[a, b, both], pair| {
        let off = [pair[0] - mean[0], pair[1] - mean[1]];
        [a + off[0] * off[0], b + off[1] * off[1], both + off[0] * off[1]]
    });
    let correlation = both / (a * b).sqrt();
    correlation.is_finite().then_some(correlation)
}
