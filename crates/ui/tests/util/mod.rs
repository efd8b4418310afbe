//! A server of a folder for tests.
#![allow(dead_code, unreachable_pub, clippy::unwrap_used, reason = "for tests, each of which uses its part")]

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;

use lunula_ui::{Server, Settings};

/// A server of a folder, until it is dropped.
pub struct Running {
    pub at: String,
    pub token: String,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
    _dir: tempfile::TempDir,
}

pub fn run(fill: impl FnOnce(&Path)) -> Running {
    let dir = tempfile::tempdir().unwrap();
    fill(dir.path());
    let site = lunula_ui::results(&[dir.path().to_owned()]).unwrap();
    let server = Server::bind(&Settings::default(), site).unwrap();
    let url = server.url();
    let (at, token) = url.strip_prefix("http://").unwrap().split_once("/#").unwrap();
    let (at, token) = (at.to_owned(), token.to_owned());
    let stop = Arc::new(AtomicBool::new(false));
    let until = Arc::clone(&stop);
    let thread = std::thread::spawn(move || server.run(&until).unwrap());
    Running { at, token, stop, thread: Some(thread), _dir: dir }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        self.thread.take().map(JoinHandle::join);
    }
}

impl Running {
    /// The address of the page.
    pub fn url(&self) -> String {
        format!("http://{}/#{}", self.at, self.token)
    }
}
