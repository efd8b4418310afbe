//! A person at the page of `lunula edit`: presses keys, and sees what there is.

#![allow(unreachable_pub, reason = "shared by tests and a bench")]

use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex};

use lunula::outlines::{EditOptions, Editor};
use lunula::photo::PhotoSet;
use serde_json::Value;

/// An editor, and the state that it showed last.
pub struct Desk {
    pub editor: Editor,
    seen: Arc<Mutex<String>>,
}

impl Desk {
    /// At a set of photographs, looked through.
    pub fn at(set: &Path) -> Self {
        let seen = Arc::new(Mutex::new(String::new()));
        let news = Arc::clone(&seen);
        let show = Box::new(move |json: &str| json.clone_into(&mut news.lock().expect("no panic")));
        let set = PhotoSet::open(set, &[]).expect("photographs");
        let editor = Editor::new(set, &EditOptions::default(), show).expect("options of a default");
        editor.survey(&AtomicBool::new(false));
        Self { editor, seen }
    }

    /// The state as pages hear it.
    pub fn sees(&self) -> Value {
        serde_json::from_str(&self.seen.lock().expect("no panic")).expect("a state")
    }
}
