//! What a finger does of its own accord: it presses, holds, slides, taps, nearly presses, and rests in between.
//!
//! In: [`Contacts`], a seed and the kinds. Out: one [`Contact`] after the other, each with its exact times and force;
//! the same at every time whatever is asked for before, without end.
//!
//! Time from 0 on goes in blocks of forty mean pauses and a minute. Within a block a pause is followed by a contact
//! until the next would pass the block's end; a pause lasts between 1/3 and 5/3 of its mean. All of this is *assumed*:
//! the thesis describes no use of a switch. The weights are shares among the kinds that are chosen:
//!
//! | kind | weight | at the surface | pressing | J2 bends by |
//! |---|---|---|---|---|
//! | press | 8 | rises in 0.08 to 0.25 s, holds 0.15 to 1.5 s, lets go in 0.06 to 0.2 s | 0.5 to 3 N | 2 to 6 degrees |
//! | hold | 2 | the same, holds 2 to 6 s, swinging down by up to 0.3 of it at 0.2 to 1 Hz | 0.5 to 3 N | 2 to 6 |
//! | slide | 2 | the same, holds 0.4 to 2.5 s, its shear 0.5 to 0.9 of friction's most | 0.5 to 3 N | 2 to 6 |
//! | tap | 4 | 0.08 to 0.2 s | 1 to 3 N | 2 to 6 |
//! | hover | 3 | near miss: 0.1 to 1 s above it | none | 3 to 12 |
//! | brush | 1 | near miss: 0.1 to 0.5 s | 0.01 to 0.05 N | 2 to 6 |
//! | bend | 1 | far from it: 0.5 to 2 s | none | 15 to 60 |
//!
//! The finger bends before it touches and straightens after it has let go, in 0.15 to 0.4 s (bend: 0.5 to 1.5 s); J1
//! bends 2.5 times as far as J2 (bend: half as far), J3 by two thirds. A press, hold, tap or brush has a shear of up to
//! a fifth of what friction holds, in one direction.

use std::f64::consts::TAU;

use lunula_predictor::{Spiral, smooth};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use serde::Serialize;

use crate::phantom::motion::trajectory::J3_PER_J2;
use crate::phantom::nail::numbers;
use crate::words::Words;

const KIND_CONTACTS: u32 = 29;
/// A block: so many mean pauses, and so many seconds, longer than any contact.
const PAUSES: f64 = 40.0;
const LEAST_BLOCK_S: f64 = 60.0;
/// A pause as a share of its mean.
const PAUSE: [f64; 2] = [1.0 / 3.0, 5.0 / 3.0];
/// How often each kind comes beside the others, in their order.
const WEIGHTS: [u32; 7] = [8, 2, 2, 4, 3, 1, 1];
/// The shear of a slide is reached so long after the pressing, seconds.
const SHEARED_S: f64 = 0.2;
/// A light touch below which nobody speaks of pressing, newtons.
const BRUSH_N: [f64; 2] = [0.01, 0.05];

/// What a finger does at the surface, or near it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ContactKind {
    /// Presses and lets go.
    Press,
    /// Presses for seconds, with slow changes.
    Hold,
    /// Presses and shears, the shear turning.
    Slide,
    /// Touches for a moment.
    Tap,
    /// Near miss: bends as if to press.
    Hover,
    /// Near miss: touches with less than 0.05 N.
    Brush,
    /// Bends far and comes back; touches nothing.
    Bend,
}

impl Words for ContactKind {
    const WORDS: &'static [(Self, &'static str, &'static str)] = &[
        (Self::Press, "press", ""),
        (Self::Hold, "hold", ""),
        (Self::Slide, "slide", ""),
        (Self::Tap, "tap", ""),
        (Self::Hover, "hover", ""),
        (Self::Brush, "brush", ""),
        (Self::Bend, "bend", ""),
    ];
}

impl ContactKind {
    /// All of them.
    pub const ALL: [Self; 7] = [Self::Press, Self::Hold, Self::Slide, Self::Tap, Self::Hover, Self::Brush, Self::Bend];

    /// Whether a switch should see it, which it should not of a near miss.
    #[must_use]
    pub fn presses(self) -> bool {
        matches!(self, Self::Press | Self::Hold | Self::Slide | Self::Tap)
    }

    /// Whether there is a force.
    #[must_use]
    pub fn touches(self) -> bool {
        self.presses() || self == Self::Brush
    }
}

/// A sequence of contacts.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Contacts {
    /// Which kinds there are; none: the finger rests.
    pub kinds: Vec<ContactKind>,
    /// The mean pause between two, seconds, more than 0.
    pub pause_s: f64,
    /// Where the random numbers come from.
    pub seed: u64,
}

/// One contact or near miss. Times are the scene's, seconds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// What it is.
    pub kind: ContactKind,
    /// The finger begins to bend.
    pub begin_s: f64,
    /// It is at the surface, or as near as it comes.
    pub reached_s: f64,
    /// It leaves the surface.
    pub left_s: f64,
    /// It is back.
    pub over_s: f64,
    /// The greatest pressing, newtons.
    pub peak_n: f64,
    rise_s: f64,
    fall_s: f64,
    /// How far the pressing swings down as a share, and how often a second.
    swing: [f64; 2],
    /// The shear at first and later, as shares of what friction holds.
    shear: [f64; 2],
    /// The shear's direction at first, radians, and how it turns, radians a second.
    turn: [f64; 2],
    /// How far J1, J2, J3 bend, radians.
    bend_rad: [f64; 3],
}

impl Contact {
    /// Draws one whose finger begins to bend at `begin_s`.
    fn draw(kind: ContactKind, begin_s: f64, rng: &mut ChaCha8Rng) -> Self {
        let mut within = |[low, high]: [f64; 2]| rng.random_range(low..=high);
        let far = kind == ContactKind::Bend;
        let [there_s, back_s] = [0, 1].map(|_| within(if far { [0.5, 1.5] } else { [0.15, 0.4] }));
        let (rise_s, fall_s) = (within([0.08, 0.25]), within([0.06, 0.2]));
        let held_s = within(match kind {
            ContactKind::Press => [0.15, 1.5],
            ContactKind::Hold => [2.0, 6.0],
            ContactKind::Slide => [0.4, 2.5],
            ContactKind::Tap => [0.08, 0.2],
            ContactKind::Hover => [0.1, 1.0],
            ContactKind::Brush => [0.1, 0.5],
            ContactKind::Bend => [0.5, 2.0],
        });
        let peak_n = within(match kind {
            ContactKind::Press | ContactKind::Hold | ContactKind::Slide => [0.5, 3.0],
            ContactKind::Tap => [1.0, 3.0],
            ContactKind::Brush => BRUSH_N,
            ContactKind::Hover | ContactKind::Bend => [0.0, 0.0],
        });
        let swing = match kind {
            ContactKind::Hold => [within([0.05, 0.3]), within([0.2, 1.0])],
            _ => [0.0, 0.0],
        };
        let first = within([0.0, 0.2]);
        let shear = [first, if kind == ContactKind::Slide { within([0.5, 0.9]) } else { first }];
        let turn = [within([0.0, TAU]), if kind == ContactKind::Slide { within([-3.0, 3.0]) } else { 0.0 }];
        let j2_deg = within(match kind {
            ContactKind::Hover => [3.0, 12.0],
            ContactKind::Bend => [15.0, 60.0],
            _ => [2.0, 6.0],
        });
        let j1_deg = if far { 0.5 * j2_deg } else { 2.5 * j2_deg };
        // The shortest ones have no time to hold.
        let (rise_s, fall_s, at_s) = match kind {
            ContactKind::Tap | ContactKind::Brush => (0.5 * held_s, 0.5 * held_s, held_s),
            ContactKind::Hover | ContactKind::Bend => (rise_s, fall_s, held_s),
            _ => (rise_s, fall_s, rise_s + held_s + fall_s),
        };
        let reached_s = begin_s + there_s;
        let left_s = reached_s + at_s;
        let bend_rad = [j1_deg, j2_deg, J3_PER_J2 * j2_deg].map(f64::to_radians);
        let over_s = left_s + back_s;
        Self { kind, begin_s, reached_s, left_s, over_s, peak_n, rise_s, fall_s, swing, shear, turn, bend_rad }
    }

    /// When it is said to be, seconds: while there is a force; of near misses without one from the bending's beginning
    /// to its end.
    #[must_use]
    pub fn span_s(&self) -> [f64; 2] {
        if self.kind.touches() { [self.reached_s, self.left_s] } else { [self.begin_s, self.over_s] }
    }

    /// `[Fx, Fy, Fz]` at `t_s`, newtons.
    #[must_use]
    pub fn forces_n(&self, t_s: f64) -> [f64; 3] {
        if !self.kind.touches() || t_s <= self.reached_s || t_s >= self.left_s {
            return [0.0; 3];
        }
        let risen = smooth((t_s - self.reached_s) / self.rise_s);
        let fallen = smooth((self.left_s - t_s) / self.fall_s);
        let held_s = (t_s - self.reached_s - self.rise_s).max(0.0);
        let [depth, hz] = self.swing;
        let pressing_n = self.peak_n * risen * fallen * (1.0 - 0.5 * depth * (1.0 - (TAU * hz * held_s).cos()));
        let share = self.shear[0] + (self.shear[1] - self.shear[0]) * smooth(held_s / SHEARED_S);
        let shear_n = share * Spiral::default().mu * pressing_n;
        let direction = self.turn[0] + self.turn[1] * held_s;
        [shear_n * direction.cos(), shear_n * direction.sin(), -pressing_n]
    }

    /// How far J1, J2, J3 bend at `t_s` for it, radians.
    #[must_use]
    pub fn bend_rad(&self, t_s: f64) -> [f64; 3] {
        let bent = smooth((t_s - self.begin_s) / (self.reached_s - self.begin_s));
        let left = smooth((self.over_s - t_s) / (self.over_s - self.left_s));
        self.bend_rad.map(|angle| bent * left * angle)
    }
}

impl Contacts {
    /// The default mean pause, seconds.
    pub const PAUSE_S: f64 = 3.0;

    fn block(&self, block: u32) -> Vec<Contact> {
        if self.pause_s <= 0.0 || !self.pause_s.is_finite() {
            return Vec::new();
        }
        let mut rng = numbers(self.seed, KIND_CONTACTS, block);
        let length_s = self.block_s();
        let mut at_s = f64::from(block) * length_s;
        let end_s = at_s + length_s;
        let mut all = Vec::new();
        loop {
            at_s += self.pause_s * rng.random_range(PAUSE[0]..=PAUSE[1]);
            let Some(kind) = self.draw_kind(&mut rng) else { return all };
            let contact = Contact::draw(kind, at_s, &mut rng);
            if contact.over_s > end_s {
                return all;
            }
            at_s = contact.over_s;
            all.push(contact);
        }
    }

    /// One of the kinds by its weight; none where there are none.
    fn draw_kind(&self, rng: &mut ChaCha8Rng) -> Option<ContactKind> {
        let weight = |kind: ContactKind| WEIGHTS[kind as usize];
        let sum: u32 = self.kinds.iter().map(|kind| weight(*kind)).sum();
        let drawn = (sum > 0).then(|| rng.random_range(0..sum))?;
        let mut passed = 0;
        self.kinds.iter().copied().find(|kind| {
            passed += weight(*kind);
            drawn < passed
        })
    }

    fn block_s(&self) -> f64 {
        PAUSES * self.pause_s + LEAST_BLOCK_S
    }

    /// All that are over by `until_s`, in the order of time.
    pub fn until(&self, until_s: f64) -> impl Iterator<Item = Contact> {
        let blocks = (until_s / self.block_s()).ceil().max(0.0) as u32;
        (0..blocks).flat_map(|block| self.block(block)).filter(move |contact| contact.over_s <= until_s)
    }
}

/// A sequence that is ready to be asked often.
#[derive(Debug, Clone)]
pub(in crate::phantom) struct Sequence {
    contacts: Contacts,
    /// None goes on longer, seconds.
    until_s: f64,
    /// The block that was asked for last, and its contacts.
    block: u32,
    within: Vec<Contact>,
}

impl Sequence {
    /// Of the contacts that are over by `until_s`.
    pub(in crate::phantom) fn new(contacts: &Contacts, until_s: f64) -> Self {
        Self { contacts: contacts.clone(), until_s, block: 0, within: contacts.block(0) }
    }

    /// The contact under way at `t_s`.
    pub(in crate::phantom) fn at(&mut self, t_s: f64) -> Option<&Contact> {
        if t_s < 0.0 {
            return None;
        }
        let block = (t_s / self.contacts.block_s()) as u32;
        if block != self.block {
            (self.block, self.within) = (block, self.contacts.block(block));
        }
        let next = self.within.partition_point(|contact| contact.over_s <= t_s);
        self.within.get(next).filter(|contact| contact.begin_s < t_s && contact.over_s <= self.until_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(seed: u64) -> Contacts {
        Contacts { kinds: ContactKind::ALL.to_vec(), pause_s: Contacts::PAUSE_S, seed }
    }

    #[test]
    fn each_contact_is_as_its_kind_says_and_its_force_is_where_it_says() {
        let mut counts = [0; 7];
        for contact in all(1).until(20_000.0) {
            counts[contact.kind as usize] += 1;
            let Contact { kind, begin_s, reached_s, left_s, over_s, peak_n, .. } = contact;
            let within = |[low, high]: [f64; 2], value: f64| {
                assert!((low - 1e-9..=high + 1e-9).contains(&value), "{kind:?} {value}");
            };
            let (at_s, peaks_n) = match kind {
                ContactKind::Press => ([0.29, 1.95], [0.5, 3.0]),
                ContactKind::Hold => ([2.14, 6.45], [0.5, 3.0]),
                ContactKind::Slide => ([0.54, 2.95], [0.5, 3.0]),
                ContactKind::Tap => ([0.08, 0.2], [1.0, 3.0]),
                ContactKind::Hover => ([0.1, 1.0], [0.0, 0.0]),
                ContactKind::Brush => ([0.1, 0.5], [0.01, 0.05]),
                ContactKind::Bend => ([0.5, 2.0], [0.0, 0.0]),
            };
            within(at_s, left_s - reached_s);
            within(peaks_n, peak_n);
            let (mut greatest, mut sheared, mut turned) = (0.0f64, 0.0f64, 0.0f64);
            for k in 0..=10_000 {
                let t_s = begin_s + f64::from(k) / 10_000.0 * (over_s - begin_s);
                let [fx, fy, fz] = contact.forces_n(t_s);
                let touches = kind.touches() && t_s > reached_s && t_s < left_s;
                // Next to its ends a force is there, if too small to be worth a number.
                assert!(if touches { fz < 0.0 || (t_s - reached_s).min(left_s - t_s) < 1e-6 } else { fz == 0.0 });
                let mu = Spiral::default().mu;
                assert!(fx.hypot(fy) <= -mu * fz + 1e-12, "within the cone");
                greatest = greatest.max(-fz);
                sheared = sheared.max(fx.hypot(fy) / (mu * peak_n));
                turned = turned.max(contact.bend_rad(t_s)[1].to_degrees());
            }
            // Between two of the moments the greatest differs by the square of their distance.
            assert!((greatest - peak_n).abs() <= 1e-4 * peak_n, "{kind:?} {greatest} {peak_n}");
            let bends = match kind {
                ContactKind::Hover => [3.0, 12.0],
                ContactKind::Bend => [15.0, 60.0],
                _ => [2.0, 6.0],
            };
            within(bends, turned);
            if kind == ContactKind::Slide {
                within([0.45, 0.9], sheared);
            } else if kind.touches() {
                within([0.0, 0.2], sheared);
            }
            assert_eq!((contact.bend_rad(begin_s), contact.bend_rad(over_s)), ([0.0; 3], [0.0; 3]));
        }
        // The shares of 21, within four standard deviations.
        let sum = counts.iter().sum::<u32>();
        assert!(sum > 3000, "{sum}");
        for (count, weight) in counts.into_iter().zip(WEIGHTS) {
            let share = f64::from(weight) / 21.0;
            let sd = (f64::from(sum) * share * (1.0 - share)).sqrt();
            assert!((f64::from(count) - share * f64::from(sum)).abs() <= 4.0 * sd, "{counts:?}");
        }
    }

    #[test]
    fn pauses_have_their_mean_and_no_two_contacts_meet() {
        let contacts: Vec<Contact> = all(2).until(20_000.0).collect();
        let pauses: Vec<f64> = contacts.windows(2).map(|pair| pair[1].begin_s - pair[0].over_s).collect();
        assert!(pauses.iter().all(|pause| *pause >= 1.0 - 1e-9));
        // Where two blocks meet, it is longer.
        assert!(pauses.iter().filter(|pause| **pause > 5.0 + 1e-9).count() <= 20_000 / 180);
        let mean = pauses.iter().sum::<f64>() / pauses.len() as f64;
        assert!((mean / Contacts::PAUSE_S - 1.0).abs() <= 0.08, "{mean}");
        assert!(all(2).until(20_000.0).eq(contacts.iter().copied()) && !all(3).until(20_000.0).eq(contacts.clone()));
        // A shorter log has the first of them.
        let fewer: Vec<Contact> = all(2).until(777.0).collect();
        assert!(fewer.len() > 100 && fewer == contacts[..fewer.len()] && contacts[fewer.len()].over_s > 777.0);
    }

    #[test]
    fn what_is_under_way_does_not_depend_on_what_was_asked_before() {
        let contacts = all(4);
        let mut sequence = Sequence::new(&contacts, 1000.0);
        let listed: Vec<Contact> = contacts.until(1000.0).collect();
        for k in (0..9000).chain((0..9000).rev().step_by(7)) {
            let t_s = 0.123_4 * f64::from(k) - 5.0;
            let expected = listed.iter().find(|contact| contact.begin_s < t_s && t_s < contact.over_s);
            assert_eq!(sequence.at(t_s), expected, "{t_s}");
        }
        let none = Contacts { kinds: Vec::new(), ..contacts.clone() };
        assert_eq!(none.until(1e4).count(), 0);
        for pause_s in [0.0, -3.0, f64::NAN, f64::INFINITY] {
            assert_eq!(Contacts { pause_s, ..contacts.clone() }.until(1e4).count(), 0, "{pause_s}");
        }
    }
}
