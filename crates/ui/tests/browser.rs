//! The pages in a real browser; `make test` runs these by name where Chromium is installed.

#![allow(clippy::unwrap_used, reason = "tests, and what they share")]

mod util;

use std::path::Path;
use std::process::Command;

use lunula_ui::Latest;
use util::{run, serve};

/// The page as it is when its scripts are done.
fn page(url: &str, arguments: &[&str]) -> String {
    let profile = tempfile::tempdir().unwrap();
    // A page that never comes to rest is given up.
    let output = Command::new("timeout")
        .args("100 chromium --headless --no-sandbox --disable-gpu --virtual-time-budget=8000 --dump-dom".split(' '))
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .args(arguments)
        .arg(url)
        .output()
        .expect("chromium is installed");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn lab(dir: &Path) {
    for (name, text) in [
        ("a", r#"{"job":"photos","version":"0.1.0","warnings":["one nail is doubtful"],"failed":[],"wall_s":2.5}"#),
        ("<img src=x onerror=alert(1)>", r#"{"job":"<b>posture</b>","warnings":[],"failed":["<script>x</script>"]}"#),
    ] {
        let at = dir.join(name);
        std::fs::create_dir(&at).unwrap();
        std::fs::write(at.join("run.json"), text).unwrap();
    }
}

#[test]
#[ignore = "needs Chromium: `make test` runs it where that is installed"]
fn in_browser_the_page_lists_results_and_names_stay_text() {
    let server = run(lab);
    let dom = page(&server.url(), &[]);
    assert!(dom.contains(">2 results<"), "{dom}");
    assert!(dom.contains("1 warning") && dom.contains("1 failed"), "{dom}");
    assert!(dom.contains("&lt;img src=x onerror=alert(1)&gt;/run.json") && dom.contains("&lt;b&gt;posture"), "{dom}");
    assert!(!dom.contains("<b>") && !dom.contains("<img"), "{dom}");
}

#[test]
#[ignore = "needs Chromium: `make test` runs it where that is installed"]
fn in_browser_without_the_token_there_is_nothing_to_see() {
    let server = run(lab);
    for url in [format!("http://{}/", server.at), format!("http://{}/#{}", server.at, "0".repeat(48))] {
        let dom = page(&url, &[]);
        assert!(dom.contains("Not loaded:") && !dom.contains("photos,"), "{dom}");
    }
}

#[test]
#[ignore = "needs Chromium: `make test` runs it where that is installed"]
fn in_browser_another_page_can_not_read_results() {
    let server = run(lab);
    // A page of another origin that asks this server in every way that a script has.
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("evil.html");
    let at = &server.at;
    std::fs::write(
        &file,
        format!(
            "<p id=o>nothing</p><iframe src=\"http://{at}/\"></iframe><script>\
             fetch('http://{at}/api/results',{{credentials:'include'}}).then(r=>r.text())\
             .then(t=>o.textContent='got '+t)\
             .catch(e=>o.textContent='refused');</script>"
        ),
    )
    .unwrap();
    let dom = page(&format!("file://{}", file.display()), &[]);
    assert!(dom.contains(">refused<"), "{dom}");
}

#[test]
#[ignore = "needs Chromium: `make test` runs it where that is installed"]
fn in_browser_a_session_is_drawn_and_what_is_not_known_is_said() {
    let finger = |name: &str, state: &str| {
        serde_json::json!({
            "name": name, "photodiodes": ["P1", "P9"], "places": [[0.0, 0.72], null],
            "answers": ["Fx_N", "Fy_N", "Fz_N"], "has_switch": true,
            "low": [[1.0, null, 2.0], [null, null, null]], "high": [[1.5, null, 2.5], [null, null, null]],
            "values": [0.5, null, -2.0], "contact": null, "pressed": true, "state": state, "time_s": 12.0,
        })
    };
    let name = "<img src=x onerror=alert(1)>";
    let counts = serde_json::json!({ "rows": 700, "lost": 3, "spoilt": 1, "rate_hz": 25.0 });
    let picture = serde_json::json!({
        "bin_s": 0.05, "pixels": 200, "cone": { "fz_max_n": 3.0, "mu": 0.75 }, "ended": true,
        "fingers": [finger("index", "ok"), finger(name, "stalled")],
        "health": { "work": { "p50_us": 2.0, "p99_us": 9.0 }, "arrival": null, "counts": [counts] },
    });
    let server = serve(lunula_ui::live(&Latest::new(&picture.to_string())));
    let dom = page(&server.url(), &[]);
    for words in [
        "The session is over. Work per row 2 µs, 99 of 100 within 9 µs.",
        "700 rows at 25.00 Hz, 3 lost, 1 spoilt",
        "Fx 0.50 N, Fy not known, Fz -2.00 N",
        "switch pressed",
        "source stalled",
        "&lt;img src=x onerror=alert(1)&gt;",
    ] {
        assert!(dom.contains(words), "{words}: {dom}");
    }
    assert!(dom.matches("<canvas").count() == 4 && !dom.contains("<img"), "{dom}");
}
