//! A server of a folder for tests.
#![allow(dead_code, unreachable_pub, clippy::unwrap_used, reason = "for tests, each of which uses its part")]

use std::io::{Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

use lunula_ui::{Server, Settings, Site};

/// A server of a folder, until it is dropped.
pub struct Running {
    pub at: String,
    pub token: String,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
    _dir: Option<tempfile::TempDir>,
}

pub fn run(fill: impl FnOnce(&Path)) -> Running {
    let dir = tempfile::tempdir().unwrap();
    fill(dir.path());
    let site = lunula_ui::results(&[dir.path().to_owned()]).unwrap();
    let mut running = serve(site);
    running._dir = Some(dir);
    running
}

/// A server of a site, until it is dropped.
pub fn serve(site: Site) -> Running {
    let server = Server::bind(&Settings::default(), vec![site]).unwrap();
    let url = server.url();
    let (at, token) = url.strip_prefix("http://").unwrap().split_once("/#").unwrap();
    let (at, token) = (at.to_owned(), token.to_owned());
    let stop = Arc::new(AtomicBool::new(false));
    let until = Arc::clone(&stop);
    let thread = std::thread::spawn(move || server.run(&until).unwrap());
    Running { at, token, stop, thread: Some(thread), _dir: None }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        self.thread.take().map(JoinHandle::join);
    }
}

/// An answer: its status, its head, its body.
pub struct Answer {
    pub status: u16,
    pub head: String,
    pub body: String,
}

impl Running {
    /// The address of the page.
    pub fn url(&self) -> String {
        format!("http://{}/#{}", self.at, self.token)
    }

    pub fn sends(&self, text: &str) -> Answer {
        let mut stream = TcpStream::connect(&self.at).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(20))).unwrap();
        // Whoever is not listened to may find the connection reset: an answer without a status.
        let _ = stream.write_all(text.as_bytes());
        let mut answer = Vec::new();
        let _ = stream.read_to_end(&mut answer);
        let answer = String::from_utf8_lossy(&answer).into_owned();
        let (head, body) = answer.split_once("\r\n\r\n").unwrap_or((&answer, ""));
        let status = head.split(' ').nth(1).and_then(|status| status.parse().ok()).unwrap_or(0);
        Answer { status, head: head.to_lowercase(), body: body.to_owned() }
    }

    pub fn asks(&self, method: &str, path: &str, headers: &str, body: &str) -> Answer {
        self.sends(&format!(
            "{method} {path} HTTP/1.1\r\nHost: {}\r\nConnection: close\r\nContent-Length: {}\r\n{headers}\r\n{body}",
            self.at,
            body.len()
        ))
    }

    /// As the page does: the token for a cookie.
    pub fn cookie(&self) -> String {
        let origin = format!("Origin: http://{}\r\n", self.at);
        let answer = self.asks("POST", "/api/session", &origin, &self.token);
        assert_eq!(answer.status, 204, "{}", answer.head);
        let line = answer.head.lines().find_map(|line| line.strip_prefix("set-cookie: ")).unwrap();
        assert!(line.contains("httponly") && line.contains("samesite=strict"), "{line}");
        format!("Cookie: {}\r\n", line.split(';').next().unwrap())
    }
}
