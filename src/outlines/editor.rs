//! The outlines of a set while a person goes through them: which nail is shown, what was done to it, what was saved.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::annotation::{Annotation, Saved, Says, Shapes};
use super::key::{Key, Press};
use super::options::EditOptions;
use super::picture::{Parts, Pictures, Png, View, normalized_png};
use super::report::{EditFigures, EditReport};
use super::shape::NailShape;
use super::state::{Decision, Item, State, reshape};
use super::survey::{Find, Rank, blank, home, survey};
use super::view::{Now, now};
use crate::job::{Report, Watch};
use crate::photo::outline::{Sources, snap};
use crate::photo::{PhotoSet, Photograph};
use crate::stages::Stages;

/// Whether a key did anything.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pressed {
    /// It did, or said why not.
    Done,
    /// It was pressed at a nail that is not shown any more.
    Late,
    /// It is no key.
    Unknown,
}

/// Who is told the state, as JSON, whenever it changes; the call may not wait.
pub type Show = dyn Fn(&str) + Send + Sync;

/// The outlines of a set while they are corrected. Any thread may call it.
pub struct Editor {
    pub(super) set: PhotoSet,
    options: EditOptions,
    pictures: Arc<Pictures>,
    parts: Arc<Parts>,
    state: Mutex<State>,
    show: Box<Show>,
    stages: Stages,
}

impl Editor {
    /// Of the photographs of `set`; `show` hears of each change.
    ///
    /// # Errors
    /// Options that make no sense here, in words.
    pub fn new(set: PhotoSet, options: &EditOptions, show: Box<Show>) -> Result<Self, String> {
        if options.outlines.sources == Sources::Detect {
            return Err("--outline detect: what is drawn is what is corrected; leave it out".to_owned());
        }
        let state = State {
            annotations: set.photos.iter().map(|_| None).collect(),
            open: set.photos.len(),
            failed: set.faults.iter().map(ToString::to_string).collect(),
            ..State::default()
        };
        let pictures = Arc::new(Pictures::new(options.max_megapixels, options.normalization.white));
        let options = options.clone();
        let (state, stages) = (Mutex::new(state), Stages::default());
        let editor = Self { set, options, pictures, parts: Arc::default(), state, show, stages };
        editor.tell(&mut editor.lock());
        Ok(editor)
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Looks for the nails of every photograph, those first that somebody has to look at; ends where `stop` says so.
    pub fn survey(&self, stop: &AtomicBool) {
        let mut order: Vec<(Rank, usize)> = Vec::new();
        for (number, photo) in self.set.photos.iter().enumerate() {
            match home(photo, &self.options) {
                Ok((_, rank)) => order.push((rank, number)),
                Err(why) => self.note(number, Err(why)),
            }
        }
        order.sort_unstable();
        for (_, number) in order {
            if stop.load(Ordering::Relaxed) {
                return;
            }
            let photo = &self.set.photos[number];
            // The first is about to be seen; the others pass by.
            let is_first = self.lock().items.is_empty();
            let picture = self.stages.time("read", || match is_first {
                true => self.pictures.get(number, &photo.path),
                false => self.pictures.read(&photo.path).map(Arc::new),
            });
            let found =
                picture.and_then(|picture| self.stages.time("outline", || survey(photo, &picture, &self.options)));
            self.note(number, found);
        }
    }

    /// Adds what was found on a photograph.
    fn note(&self, number: usize, found: Result<(Annotation, Vec<Find>), String>) {
        let mut state = self.lock();
        state.open -= 1;
        match found {
            Ok((annotation, finds)) => {
                state.annotations[number] = Some(annotation);
                state.items.extend((1..).zip(finds).map(|(k, find)| Item::new(number, k, find)));
            }
            Err(why) => state.failed.push(format!("{}: {why}", self.set.photos[number].file)),
        }
        if state.current().is_none() {
            self.go_on(&mut state);
        }
        self.tell(&mut state);
    }

    /// A key of a page, as JSON: `{"key":"accept","nail":3}`.
    pub fn key(&self, json: &[u8]) -> Pressed {
        let Some(Press { nail, key }) = Press::read(json) else { return Pressed::Unknown };
        let mut state = self.lock();
        if nail.is_some() && nail != state.current() {
            return Pressed::Late;
        }
        state.say("");
        match (key, state.current()) {
            (Key::Next, _) => self.go_on(&mut state),
            (Key::Previous, _) => self.go_back(&mut state),
            (_, None) => {}
            (key, Some(item)) => {
                state.items[item].keys += 1;
                self.change(&mut state, item, key);
            }
        }
        self.tell(&mut state);
        Pressed::Done
    }

    fn change(&self, state: &mut State, at: usize, key: Key) {
        match key {
            Key::Accept => self.accept(state, at),
            Key::Reject => self.decide(state, at, Decision::Rejected),
            Key::Undo => self.undo(state, at),
            Key::Zoom => {
                state.whole = !state.whole;
                state.items[at].view = None;
            }
            Key::Another => self.another(state, at),
            Key::Snap => self.snap(state, at),
            key => reshape(&mut state.items[at], key),
        }
    }

    fn snap(&self, state: &mut State, at: usize) {
        let picture = match self.picture(state.items[at].photo) {
            Ok(picture) => picture,
            Err(why) => return state.fault(why),
        };
        let item = &mut state.items[at];
        let found = item.shape.outline().map_err(|fault| fault.to_string()).and_then(|outline| {
            let found = self.stages.time("snap", || snap(&picture.image, &outline, item.shape.axis));
            found.ok_or_else(|| "no border was found from here; move it closer".to_owned())
        });
        match found {
            Ok(found) => {
                item.remember();
                item.shape = NailShape { points: found.outline.points(), axis: found.axis };
                item.corner = None;
            }
            Err(why) => state.fault(why),
        }
    }

    /// Only what a run would take.
    fn accept(&self, state: &mut State, at: usize) {
        let item = &state.items[at];
        match self.normalized_as(item.photo, &item.shape, item.view) {
            Ok(_) => self.decide(state, at, Decision::Accepted),
            Err(why) => state.fault(format!("not saved: {why}")),
        }
    }

    fn decide(&self, state: &mut State, at: usize, decision: Decision) {
        let item = &state.items[at];
        let shape = item.shape.clone();
        let same = !item.is_changed();
        let says = match decision {
            Decision::Accepted => Says::Nail(&shape, same),
            Decision::Rejected => Says::NotANail,
        };
        if self.save(state, at, says) {
            state.items[at].decide(decision);
            self.go_on(state);
        }
    }

    /// Whether the file says so now.
    fn save(&self, state: &mut State, at: usize, says: Says<'_>) -> bool {
        let State { items, annotations, .. } = &mut *state;
        let item = &mut items[at];
        let Some(annotation) = annotations[item.photo].as_mut() else { return false };
        if matches!(says, Says::NotANail | Says::AsItWas) && item.shapes.polygon.is_none() {
            // No file knows of it.
            return true;
        }
        match self.stages.time("save", || annotation.save(&mut item.shapes, says)) {
            Ok(Saved { path, kept }) => {
                let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
                match kept {
                    None => state.say(format!("saved in {name}")),
                    Some(kept) => {
                        state.fault(format!(
                            "{} was changed by another program and stays as it is; what is corrected here is in {}: \
                             keep one of them",
                            kept.display(),
                            path.display()
                        ));
                        state.kept.push(kept);
                    }
                }
                let is_there = path.exists();
                state.saved.retain(|saved| is_there || *saved != path);
                if is_there && !state.saved.contains(&path) {
                    state.saved.push(path);
                }
                true
            }
            Err(why) => {
                state.fault(format!("not saved: {why}"));
                false
            }
        }
    }

    /// The latest first; without a decision the file says what it said when it was read.
    fn undo(&self, state: &mut State, at: usize) {
        let item = &state.items[at];
        if item.decision.is_some() && (item.before.is_empty() || !item.is_changed_since()) {
            if self.save(state, at, Says::AsItWas) {
                state.items[at].decision = None;
                if !state.is_fault {
                    state.say("taken back");
                }
            }
            return;
        }
        let item = &mut state.items[at];
        match item.before.pop() {
            Some(shape) => {
                (item.shape, item.gesture) = (shape, None);
                item.corner = item.corner.filter(|&corner| corner < item.shape.points.len());
            }
            None => state.say("as it was at first; P goes to the nail before"),
        }
    }

    fn another(&self, state: &mut State, at: usize) {
        let photo = state.items[at].photo;
        let middle = state.items[at].view.map(|view| {
            [f64::from(view.x) + f64::from(view.width) / 2.0, f64::from(view.y) + f64::from(view.height) / 2.0]
        });
        let picture = match self.picture(state.items[at].photo) {
            Ok(picture) => picture,
            Err(why) => return state.fault(why),
        };
        let shape = blank(middle.unwrap_or([0.0; 2]), &picture);
        let number = state.items.iter().filter(|item| item.photo == photo).count() + 1;
        let why = "drawn here: move the template, snap".to_owned();
        state.items.push(Item::new(photo, number, Find { rank: Rank::Missing, shapes: Shapes::default(), shape, why }));
        let new = state.items.len() - 1;
        let next = state.at + 1;
        state.trail.insert(next, new);
        state.at = next;
        state.whole = true;
        self.come(state);
    }

    fn go_on(&self, state: &mut State) {
        // At the end it waits, or is over.
        if state.at < state.trail.len() {
            state.at += 1;
        }
        if state.at == state.trail.len() {
            state.trail.extend(state.ahead());
        }
        state.whole = false;
        self.come(state);
    }

    fn go_back(&self, state: &mut State) {
        state.at = state.at.saturating_sub(1);
        state.whole = false;
        self.come(state);
    }

    /// A nail comes to be seen; the next one is fetched meanwhile.
    fn come(&self, state: &mut State) {
        let Some(at) = state.current() else { return };
        state.whole |= state.items[at].rank == Rank::Missing && !state.items[at].is_changed();
        if let Err(why) = self.picture(state.items[at].photo) {
            state.fault(why);
        }
        let Some(next) = state.trail.get(state.at + 1).copied().or_else(|| state.ahead()) else { return };
        let (photo, shape) = (state.items[next].photo, state.items[next].shape.clone());
        let (pictures, parts) = (Arc::clone(&self.pictures), Arc::clone(&self.parts));
        let path = self.set.photos[photo].path.clone();
        std::thread::spawn(move || {
            // What can't be read is said when it is shown.
            let picture = pictures.get(photo, &path)?;
            let size = [picture.image.width(), picture.image.height()];
            parts.get(photo, &picture, View::around(&shape, size)).map(drop)
        });
    }

    fn picture(&self, photo: usize) -> Result<Arc<Photograph>, String> {
        let photo_of = &self.set.photos[photo];
        let named = |why| format!("{}: {why}", photo_of.file);
        self.stages.time("read", || self.pictures.get(photo, &photo_of.path)).map_err(named)
    }

    /// Says what is to be seen now.
    fn tell(&self, state: &mut State) {
        state.revision += 1;
        if let Some(at) = state.current()
            && let Ok(picture) = self.picture(state.items[at].photo)
        {
            let size = [picture.image.width(), picture.image.height()];
            let item = &state.items[at];
            let view = item.view.filter(|view| state.whole || view.serves(&item.shape, size));
            let fresh = || if state.whole { View::whole(size) } else { View::around(&item.shape, size) };
            state.items[at].view = Some(view.unwrap_or_else(fresh));
        }
        let now: Now<'_> = now(&self.set, state);
        (self.show)(&serde_json::to_string(&now).unwrap_or_else(|_| "null".to_owned()));
    }

    /// The part of the photograph around the nail that is shown, as a JPEG.
    pub fn photo(&self) -> Option<Vec<u8>> {
        let (photo, view) = {
            let state = self.lock();
            let item = &state.items[state.current()?];
            (item.photo, item.view?)
        };
        let picture = self.picture(photo).ok()?;
        self.stages.time("draw", || Some(self.parts.get(photo, &picture, view).ok()?.jpeg.clone()))
    }

    /// The nail that is shown, as it would come out, as a PNG; `rough`, for a look between two keys, or as the results
    /// will have it.
    ///
    /// # Errors
    /// Why it would be left out, in words.
    pub fn normalized(&self, rough: bool) -> Result<Vec<u8>, String> {
        let (photo, shape, view) = {
            let state = self.lock();
            let item = &state.items[state.current().ok_or("no nail is shown")?];
            (item.photo, item.shape.clone(), item.view)
        };
        self.normalized_as(photo, &shape, view.filter(|_| rough))
    }

    fn normalized_as(&self, photo: usize, shape: &NailShape, roughly_on: Option<View>) -> Png {
        let picture = self.picture(photo)?;
        let with = &self.options.normalization;
        self.stages.time("normalize", || {
            let part = roughly_on.map(|view| self.parts.get(photo, &picture, view)).transpose()?;
            let rough = part.and_then(|part| part.normalized(&picture, shape, with));
            rough.unwrap_or_else(|| normalized_png(&picture, shape, with))
        })
    }

    /// What was done.
    #[must_use]
    pub fn report(&self, watch: &Watch<'_>) -> EditReport {
        let state = self.lock();
        let decided = |decision| state.items.iter().filter(|item| item.decision == Some(decision)).count();
        let keys = state.items.iter().filter(|item| item.decision.is_some()).map(|item| item.keys).sum();
        let figures = EditFigures {
            photographs: self.set.photos.len(),
            nails: state.items.len(),
            accepted: decided(Decision::Accepted),
            rejected: decided(Decision::Rejected),
            unseen_photographs: state.open,
            keys,
            saved: state.saved.clone(),
        };
        let mut report = Report::new("edit", watch, figures);
        report.failed.clone_from(&state.failed);
        let beside =
            "was changed by another program meanwhile and stays as it is; its outlines from here are beside it";
        report.warnings = state.kept.iter().map(|kept| format!("{}: {beside}", kept.display())).collect();
        let unsaved = state.items.iter().filter(|item| item.is_unsaved()).map(|item| {
            let file = &self.set.photos[item.photo].file;
            format!("{file}: nail {} was changed and not accepted since, so that the change is lost", item.number)
        });
        report.warnings.extend(unsaved);
        report.timed(&self.stages)
    }
}
