//! A program that is written to and read from while it runs.

use std::io::{BufRead, BufReader, Write};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use super::Dir;
use super::page::ends;

/// What does not come within this never comes.
pub const PATIENCE: Duration = Duration::from_secs(20);

/// A program at work, and its lines as they come.
pub struct Running {
    pub child: Child,
    /// On standard output.
    pub lines: Receiver<String>,
    /// On standard error.
    pub said: Receiver<String>,
}

/// Starts the binary in a folder, to be written to and read from.
pub fn spawned(dir: &Dir, arguments: &[&str]) -> Child {
    Command::new(env!("CARGO_BIN_EXE_lunula"))
        .args(arguments)
        .current_dir(dir.path(""))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the binary runs")
}

/// The same, its lines taken as they come.
pub fn start(dir: &Dir, arguments: &[&str]) -> Running {
    let mut child = spawned(dir, arguments);
    let (out, lines) = channel();
    let stdout = BufReader::new(child.stdout.take().expect("a pipe"));
    std::thread::spawn(move || stdout.lines().map_while(Result::ok).all(|line| out.send(line).is_ok()));
    let (err, said) = channel();
    let stderr = BufReader::new(child.stderr.take().expect("a pipe"));
    std::thread::spawn(move || stderr.lines().map_while(Result::ok).all(|line| err.send(line).is_ok()));
    Running { child, lines, said }
}

/// The same of a command line whose words have no spaces.
pub fn started(dir: &Dir, line: &str) -> Running {
    start(dir, &line.split_whitespace().collect::<Vec<_>>())
}

impl Running {
    pub fn write(&mut self, text: &str) {
        let to = self.child.stdin.as_mut().expect("open");
        to.write_all(text.as_bytes()).and_then(|()| to.flush()).expect("the program reads");
    }

    /// Waits for a line on standard error that holds these words.
    #[track_caller]
    pub fn hears(&self, words: &str) -> String {
        let start = Instant::now();
        while let Ok(line) = self.said.recv_timeout(PATIENCE.saturating_sub(start.elapsed())) {
            if line.contains(words) {
                return line;
            }
        }
        panic!("never said `{words}`");
    }

    /// The next line on standard output.
    #[track_caller]
    pub fn line(&self) -> String {
        self.lines.recv_timeout(PATIENCE).expect("an answer")
    }

    /// Closes its input and waits: its exit status, the lines that are left, what it said.
    pub fn end(mut self) -> (i32, Vec<String>, String) {
        drop(self.child.stdin.take());
        let code = ends(self.child);
        (code, self.lines.iter().collect(), self.said.iter().collect::<Vec<_>>().join("\n"))
    }
}
