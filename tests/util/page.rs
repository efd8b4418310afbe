//! A command that serves a page, asked as the page asks.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use super::Dir;

/// A page's address, with its secret.
pub struct Page(pub String);

impl Dir {
    /// Runs the binary in this folder until it has printed its page's address.
    pub fn page(&self, arguments: &[&str]) -> (Child, Page) {
        let mut child = Command::new(env!("CARGO_BIN_EXE_lunula"))
            .args(arguments)
            .current_dir(self.path(""))
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("the binary runs");
        let (mut url, mut lines) = (String::new(), BufReader::new(child.stdout.take().expect("a pipe")));
        lines.read_line(&mut url).expect("an address");
        child.stdout = Some(lines.into_inner());
        (child, Page(url.trim().to_owned()))
    }
}

impl Page {
    /// What is answered to a message of the page, head and all.
    pub fn posts(&self, path: &str, body: &str) -> String {
        self.asks("POST", path, body)
    }

    /// The body of what the page reads.
    pub fn reads(&self, path: &str) -> String {
        let answer = self.asks("GET", path, "");
        answer.split_once("\r\n\r\n").map_or_else(String::new, |(_, body)| body.to_owned())
    }

    /// The latest of what the page is told.
    pub fn hears(&self, path: &str) -> serde_json::Value {
        let stream = self.connect("GET", path, "");
        stream.set_read_timeout(Some(Duration::from_secs(20))).expect("a limit");
        let told = BufReader::new(stream).lines().map_while(Result::ok).find_map(|line| {
            let json = line.strip_prefix("data: ")?;
            serde_json::from_str(json).ok()
        });
        told.expect("news")
    }

    fn asks(&self, method: &str, path: &str, body: &str) -> String {
        let mut answer = Vec::new();
        let _ = self.connect(method, path, body).read_to_end(&mut answer);
        String::from_utf8_lossy(&answer).into_owned()
    }

    /// As the page does, with the token.
    fn connect(&self, method: &str, path: &str, body: &str) -> TcpStream {
        let (at, token) = self.0.strip_prefix("http://").and_then(|url| url.split_once("/#")).expect("an address");
        let mut stream = TcpStream::connect(at).expect("it listens");
        let head = format!("Host: {at}\r\nOrigin: http://{at}\r\nAuthorization: Bearer {token}\r\nConnection: close");
        let length = body.len();
        write!(stream, "{method} /api/{path} HTTP/1.1\r\n{head}\r\nContent-Length: {length}\r\n\r\n{body}")
            .expect("it reads");
        stream
    }
}

/// Until something is so, at most 30 s.
#[track_caller]
pub fn until(what: &str, mut is_so: impl FnMut() -> bool) {
    let start = Instant::now();
    while !is_so() {
        assert!(start.elapsed() < Duration::from_secs(30), "{what}: not within 30 s");
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// How it ends; killed after 20 s.
#[track_caller]
pub fn ends(mut child: Child) -> i32 {
    let start = Instant::now();
    loop {
        if let Some(status) = child.try_wait().expect("a child") {
            return status.code().unwrap_or(-1);
        }
        if start.elapsed() > Duration::from_secs(20) {
            let _ = child.kill();
            panic!("the program does not end");
        }
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// As Ctrl-C does.
pub fn interrupts(child: &Child) {
    signal(child, "-INT");
}

/// Sends a signal, named as `kill` names it.
pub fn signal(child: &Child, name: &str) {
    let sent = Command::new("kill").args([name, &child.id().to_string()]).status().expect("kill");
    assert!(sent.success());
}
