//! The prompter's page and its server, with a prompter of the test's own.

#![allow(clippy::unwrap_used, reason = "tests, and what they share")]

mod util;

use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use lunula_ui::{Latest, Prompting, prompt};
use serde_json::{Value, json};
use util::{Running, serve};

/// A prompter whose ring goes round, a newton out in six seconds, and presses ever harder and less.
struct Bench {
    start: Instant,
    keys: Mutex<Vec<Value>>,
    frames: Mutex<Vec<Value>>,
    state: Latest,
    force: Latest,
    /// When the ring stopped, if it did.
    stopped_s: Mutex<Option<f64>>,
}

impl Bench {
    fn new() -> Arc<Self> {
        Arc::new(Self {
            start: Instant::now(),
            keys: Mutex::default(),
            frames: Mutex::default(),
            state: Latest::new("null"),
            force: Latest::new("[]"),
            stopped_s: Mutex::default(),
        })
    }

    fn now_s(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }

    fn prompted(&self, time_s: f64) -> [f64; 3] {
        let time_s = self.stopped_s.lock().unwrap().map_or(time_s, |stopped_s| time_s.min(stopped_s));
        let (sin, cos) = time_s.sin_cos();
        [sin, cos, -1.5 - (0.7 * time_s).sin()]
    }

    fn leave(&self) {
        let now_s = self.now_s();
        let (from_s, to_s) = (now_s - 0.25, now_s + 1.25);
        let rows: Vec<[f64; 3]> = (0..=75).map(|k| self.prompted(from_s + 0.02 * f64::from(k))).collect();
        let state = json!({
            "now_s": now_s,
            "phase": if self.stopped_s.lock().unwrap().is_some() { "paused" } else { "running" },
            "why": "",
            "step": {"place": 0, "count": 1, "name": "<b>force</b>", "text": "follow <img src=x>", "kind": "force",
                     "collects": true, "session": 1, "at_s": now_s, "seconds": 180.0, "followed_n": 0.2},
            "checks": [],
            "ahead": [{"from_s": from_s, "to_s": to_s, "rows": rows}],
            "scale_n": 3.0, "fz_max_n": 3.0, "mu": 0.75,
            "cover": {"rows": 10, "visited": 0.5, "cells": "10".repeat(96), "hole_n": 0.7,
                      "hole_at_n": [0.5, 0.0, -2.0]},
            "extra": null, "frames": [0, 0],
        });
        self.state.leave(&state.to_string());
        let [x, y, z] = self.prompted(now_s - 0.3);
        self.force.leave(&json!([now_s, x, y, z]).to_string());
    }
}

struct Page(Arc<Bench>);

impl Prompting for Page {
    fn now_s(&self) -> f64 {
        self.0.now_s()
    }

    fn key(&self, json: &[u8]) -> bool {
        let Ok(key) = serde_json::from_slice::<Value>(json) else { return false };
        if key["key"] == "go" {
            *self.0.stopped_s.lock().unwrap() = key["time_s"].as_f64();
            self.0.leave();
        }
        self.0.keys.lock().unwrap().push(key);
        true
    }

    fn frames(&self, json: &[u8]) -> bool {
        let Ok(mut seen) = serde_json::from_slice::<Value>(json) else { return false };
        let Some(frames) = seen["frames"].as_array_mut() else { return false };
        self.0.frames.lock().unwrap().append(frames);
        true
    }
}

fn started() -> (Arc<Bench>, Running) {
    let bench = Bench::new();
    let running = serve(prompt(Arc::new(Page(Arc::clone(&bench))), &bench.state, &bench.force));
    (bench, running)
}

#[test]
fn keys_and_frames_need_the_page_and_what_is_none_is_refused() {
    let (bench, server) = started();
    let own = format!("Origin: http://{}\r\n", server.at);
    let key = r#"{"key":"go","time_s":1.5}"#;
    for (path, body) in [("key", key), ("frames", r#"{"frames":[]}"#), ("clock", "")] {
        let path = format!("/api/prompt/{path}");
        assert_eq!(server.asks("POST", &path, &own, body).status, 403, "{path} without the cookie");
        let with = format!("{}{own}", server.cookie());
        assert_eq!(server.asks("POST", &path, &server.cookie(), body).status, 403, "{path} without an origin");
        assert!(matches!(server.asks("POST", &path, &with, body).status, 200 | 204), "{path}");
        assert_eq!(server.asks("GET", &path, &server.cookie(), "").status, 405, "{path}");
    }
    assert_eq!(bench.keys.lock().unwrap().len(), 1);
    let with = format!("{}{own}", server.cookie());
    assert_eq!(server.asks("POST", "/api/prompt/key", &with, "no key").status, 400);
    assert_eq!(server.asks("POST", "/api/prompt/frames", &with, &"x".repeat(300 << 10)).status, 413);
    assert_eq!(server.asks("GET", "/api/prompt/state", "", "").status, 403);
    let clock: Value = serde_json::from_str(&server.asks("POST", "/api/prompt/clock", &with, "").body).unwrap();
    assert!((clock["time_s"].as_f64().unwrap() - bench.now_s()).abs() <= 5.0);
    let page = server.asks("GET", "/", "", "").body;
    assert!(page.contains("prompt.js") && !page.contains(&server.token));
}

/// A browser that looks at a page, until it is dropped.
struct Looking {
    child: Child,
    _profile: tempfile::TempDir,
}

impl Looking {
    fn at(url: &str) -> Self {
        let profile = tempfile::tempdir().unwrap();
        let child = Command::new("chromium")
            .args("--headless --no-sandbox --disable-gpu --remote-debugging-port=0 --window-size=1200,800".split(' '))
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .arg(url)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("chromium is installed");
        Self { child, _profile: profile }
    }
}

impl Drop for Looking {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn numbers(frame: &Value, key: &str) -> Vec<f64> {
    let list = frame[key].as_array().unwrap_or_else(|| panic!("no {key} in {frame}"));
    list.iter().map(|one| one.as_f64().unwrap()).collect()
}

#[test]
#[ignore = "needs Chromium: `make test` runs it where that is installed"]
fn in_browser_every_frame_shows_the_ring_where_it_is_at_the_frames_own_time() {
    /// How far a frame may be off, pixels; measured 0.02.
    const MOST_PX: f64 = 1.0;
    let (bench, server) = started();
    let over = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            while !over.load(Ordering::Relaxed) {
                bench.leave();
                std::thread::sleep(Duration::from_millis(40));
            }
        });
        let _looking = Looking::at(&server.url());
        let start = Instant::now();
        while bench.frames.lock().unwrap().len() < 100 && start.elapsed() < Duration::from_secs(60) {
            std::thread::sleep(Duration::from_millis(50));
        }
        over.store(true, Ordering::Relaxed);
    });
    let frames = bench.frames.lock().unwrap();
    assert!(frames.len() >= 100, "{} frames in a minute", frames.len());
    for (n, frame) in frames.iter().enumerate() {
        assert_eq!(frame["n"], n, "no frame is lost");
        let force = bench.prompted(frame["time_s"].as_f64().unwrap());
        let (centre, ring, bar) = (numbers(frame, "centre_px"), numbers(frame, "ring_px"), numbers(frame, "bar_px"));
        let per_n = frame["px_per_n"].as_f64().unwrap();
        let off = (ring[0] - centre[0] - per_n * force[0]).hypot(ring[1] - centre[1] + per_n * force[1]);
        let triangle = (frame["triangle_px"].as_f64().unwrap() - bar[0] - bar[1] * force[2]).abs();
        assert!(off.max(triangle) <= MOST_PX && per_n > 50.0, "{off} and {triangle} px in {frame}");
        assert!(frame["uncertainty_s"].as_f64().unwrap() <= 0.5, "{frame}");
    }
    // The disc came with the forces.
    assert!(frames.iter().any(|frame| frame["disc_px"].is_array() && frame["line_px"].is_number()));
}
