//! The nails of a set as they are now, and the order in which they are shown.

use std::path::PathBuf;

use super::annotation::{Annotation, Shapes};
use super::key::Key;
use super::picture::View;
use super::shape::NailShape;
use super::survey::{Find, Rank};

/// States of a nail that are kept to go back to.
const MOST_UNDONE: usize = 10_000;

/// What a person said of a nail.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Decision {
    Accepted,
    Rejected,
}

/// A nail that is looked at.
#[derive(Debug)]
pub(super) struct Item {
    /// Its photograph's place in the set.
    pub(super) photo: usize,
    /// Its number on the photograph, from 1.
    pub(super) number: usize,
    pub(super) rank: Rank,
    pub(super) why: String,
    pub(super) shape: NailShape,
    pub(super) corner: Option<usize>,
    pub(super) decision: Option<Decision>,
    pub(super) view: Option<View>,
    pub(super) shapes: Shapes,
    begun: NailShape,
    /// As it was when it was decided on last.
    decided: Option<NailShape>,
    pub(super) before: Vec<NailShape>,
    /// The gesture that made the latest change.
    pub(super) gesture: Option<u64>,
    pub(super) keys: u64,
}

impl Item {
    pub(super) fn new(photo: usize, number: usize, find: Find) -> Self {
        let Find { rank, shapes, shape, why } = find;
        let begun = shape.clone();
        Self {
            photo,
            number,
            rank,
            why,
            shape,
            corner: None,
            decision: None,
            view: None,
            shapes,
            begun,
            decided: None,
            before: vec![],
            gesture: None,
            keys: 0,
        }
    }

    /// Remembers what it is now, to be gone back to.
    pub(super) fn remember(&mut self) {
        self.before.push(self.shape.clone());
        if self.before.len() > MOST_UNDONE {
            self.before.remove(0);
        }
        self.gesture = None;
    }

    pub(super) fn is_changed(&self) -> bool {
        self.shape != self.begun
    }

    pub(super) fn decide(&mut self, decision: Decision) {
        self.decision = Some(decision);
        self.decided = Some(self.shape.clone());
    }

    /// Whether it was changed since it was decided on last.
    pub(super) fn is_changed_since(&self) -> bool {
        self.decision.is_some() && self.decided.as_ref() != Some(&self.shape)
    }

    /// Whether no file has what it was changed to.
    pub(super) fn is_unsaved(&self) -> bool {
        match self.decision {
            Some(Decision::Accepted) => self.is_changed_since(),
            Some(Decision::Rejected) => false,
            None => self.is_changed(),
        }
    }
}

/// What is shared between who presses keys and who looks for nails.
#[derive(Debug, Default)]
pub(super) struct State {
    pub(super) items: Vec<Item>,
    /// The file of each photograph that was looked at.
    pub(super) annotations: Vec<Option<Annotation>>,
    /// Nails in the order in which they were shown, and where in it one is.
    pub(super) trail: Vec<usize>,
    pub(super) at: usize,
    /// Photographs that nobody has looked for nails on yet.
    pub(super) open: usize,
    pub(super) failed: Vec<String>,
    pub(super) said: String,
    pub(super) is_fault: bool,
    /// Grows with each change of what is seen.
    pub(super) revision: u64,
    pub(super) whole: bool,
    pub(super) saved: Vec<PathBuf>,
    pub(super) kept: Vec<PathBuf>,
}

impl State {
    /// The nail that is shown.
    pub(super) fn current(&self) -> Option<usize> {
        self.trail.get(self.at).copied()
    }

    /// The nail that is shown next, if it was not shown before.
    pub(super) fn ahead(&self) -> Option<usize> {
        let fresh = (0..self.items.len()).filter(|item| !self.trail.contains(item));
        fresh.min_by_key(|&item| (self.items[item].rank, self.items[item].photo, self.items[item].number))
    }

    pub(super) fn say(&mut self, what: impl Into<String>) {
        (self.said, self.is_fault) = (what.into(), false);
    }

    pub(super) fn fault(&mut self, what: impl Into<String>) {
        (self.said, self.is_fault) = (what.into(), true);
    }
}

/// What a key does to a nail and to nothing else.
pub(super) fn reshape(item: &mut Item, key: Key) {
    let corner = item.corner;
    match key {
        Key::Corner { forwards } => return item.corner = item.shape.beside(corner, forwards),
        Key::Choose { corner } => return item.corner = corner.filter(|&corner| corner < item.shape.points.len()),
        Key::Drag { gesture, .. } if item.gesture == Some(gesture) => {
            // From where the pointer began.
            item.shape.clone_from(item.before.last().unwrap_or(&item.begun));
        }
        _ => item.remember(),
    }
    let shape = &mut item.shape;
    match key {
        Key::Move { by, stride } => shape.step(corner, by, stride),
        Key::Grow { by, stride } => match corner {
            Some(corner) => shape.bulge(corner, if by[0] == 0.0 { by[1] } else { by[0] }, stride),
            None => shape.grow(by, stride),
        },
        Key::Turn { by, stride } => shape.turn(by, stride),
        Key::TurnAxis { by } => shape.turn_axis(by),
        Key::Flip => shape.flip(),
        Key::Place { to_px } => shape.place(to_px),
        Key::Drag { gesture, corner, by_px } => {
            shape.pull(corner, by_px);
            item.gesture = Some(gesture);
        }
        Key::Insert => item.corner = corner.and_then(|corner| shape.insert(corner)),
        Key::Remove if corner.is_some_and(|corner| shape.remove(corner)) => {
            item.corner = corner.map(|corner| corner.min(item.shape.points.len() - 1));
        }
        Key::Reset => (item.shape, item.corner) = (item.begun.clone(), None),
        _ => {}
    }
    if item.before.last() == Some(&item.shape) && item.gesture.is_none() {
        item.before.pop();
    }
}
