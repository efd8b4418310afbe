//! A real Chromium, by its driver (W3C WebDriver): keys as a person presses them, and what is to be seen.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use base64::Engine;
use serde_json::{Value, json};

/// Keys that have no letter.
pub const ENTER: &str = "\u{e007}";
pub const TAB: &str = "\u{e004}";
pub const ESCAPE: &str = "\u{e00c}";
pub const RIGHT: &str = "\u{e014}";
pub const SPACE: &str = " ";

/// The longest that the driver takes: to start a browser on a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);

/// A browser with one tab or several; closed when it is dropped.
pub struct Browser {
    driver: Child,
    port: u16,
    session: String,
    _profile: tempfile::TempDir,
}

impl Browser {
    /// A driver and its port; none where it ended before it had one, as happened once beside five others.
    fn driver() -> Option<(Child, u16)> {
        let mut driver = Command::new("chromedriver")
            .arg("--port=0")
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("chromedriver is installed");
        // Its first line says what was asked for: port 0.
        let mut said = BufReader::new(driver.stdout.take().expect("a pipe"));
        let lines = said.by_ref().lines().map_while(Result::ok);
        let port =
            lines.filter_map(|line| line.trim_end_matches('.').rsplit_once("successfully on port ")?.1.parse().ok());
        let Some(port) = { port }.next() else {
            drop((driver.kill(), driver.wait()));
            return None;
        };
        // The pipe stays open while it runs.
        driver.stdout = Some(said.into_inner());
        Some((driver, port))
    }

    /// Opens a page in a window of this size, CSS pixels.
    pub fn open(url: &str, [width, height]: [u32; 2]) -> Self {
        let (driver, port) = (0..3).find_map(|_| Self::driver()).expect("a port");
        let profile = tempfile::tempdir().expect("a temporary folder");
        let mut browser = Self { driver, port, session: String::new(), _profile: profile };
        let data = format!("--user-data-dir={}", browser._profile.path().display());
        let size = format!("--window-size={width},{height}");
        let flags = ["--headless=new", "--no-sandbox", "--disable-gpu", "--no-first-run", &size, &data];
        let options = json!({ "args": flags });
        let wanted = json!({ "capabilities": { "alwaysMatch": { "goog:chromeOptions": options } } });
        let id = browser.calls("POST", "/session", &wanted)["sessionId"].as_str().expect("a session").to_owned();
        browser.session = format!("/session/{id}");
        browser.does("url", &json!({ "url": url }));
        browser
    }

    /// Presses keys one after another; `modifier` is held meanwhile.
    pub fn presses(&self, keys: &[&str]) {
        let strokes: Vec<Value> = keys
            .iter()
            .flat_map(|key| ["keyDown", "keyUp"].map(|kind| json!({ "type": kind, "value": key })))
            .collect();
        self.does("actions", &json!({ "actions": [{ "type": "key", "id": "keys", "actions": strokes }] }));
    }

    /// What a script returns.
    pub fn runs(&self, script: &str) -> Value {
        self.does("execute/sync", &json!({ "script": script, "args": [] }))
    }

    /// The text of an element.
    pub fn text(&self, id: &str) -> String {
        let text = self.runs(&format!("return document.getElementById({id:?}).textContent"));
        text.as_str().unwrap_or_default().to_owned()
    }

    /// Another tab comes to the front.
    pub fn opens_another_tab(&self) {
        let tab = self.does("window/new", &json!({ "type": "tab" }));
        self.does("window", &json!({ "handle": tab["handle"] }));
    }

    /// The first tab comes to the front.
    pub fn goes_back_to_the_first_tab(&self) {
        let tabs = self.calls("GET", &format!("{}/window/handles", self.session), &Value::Null);
        self.does("window", &json!({ "handle": tabs[0] }));
    }

    /// The page as it is to be seen, as a PNG.
    pub fn saves(&self, path: &Path) {
        let png = self.calls("GET", &format!("{}/screenshot", self.session), &Value::Null);
        let bytes = base64::engine::general_purpose::STANDARD.decode(png.as_str().expect("base64"));
        std::fs::write(path, bytes.expect("base64")).expect("a picture");
    }

    fn does(&self, command: &str, body: &Value) -> Value {
        self.calls("POST", &format!("{}/{command}", self.session), body)
    }

    #[track_caller]
    fn calls(&self, method: &str, path: &str, body: &Value) -> Value {
        let body = if body.is_null() { String::new() } else { body.to_string() };
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).expect("the driver listens");
        let head = format!("Host: 127.0.0.1:{}\r\nConnection: close\r\nContent-Length: {}", self.port, body.len());
        write!(stream, "{method} {path} HTTP/1.1\r\n{head}\r\n\r\n{body}").expect("the driver reads");
        stream.set_read_timeout(Some(PATIENCE)).expect("a limit");
        // The driver leaves the connection open.
        let mut lines = BufReader::new(stream);
        let mut length = 0;
        let mut line = String::new();
        while lines.read_line(&mut line).expect("an answer") > 2 {
            let field = line.trim_end().to_lowercase();
            length = field.strip_prefix("content-length:").map_or(length, |of| of.trim().parse().expect("a length"));
            line.clear();
        }
        let mut json = vec![0; length];
        lines.read_exact(&mut json).expect("an answer");
        let value: Value = serde_json::from_slice(&json).unwrap_or_else(|why| panic!("{path}: {why}"));
        assert!(value["value"]["error"].is_null(), "{path}: {value}");
        value["value"].clone()
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // Where the session failed there is none to end.
        if !std::thread::panicking() {
            self.calls("DELETE", &self.session, &Value::Null);
        }
        let _ = (self.driver.kill(), self.driver.wait());
    }
}
