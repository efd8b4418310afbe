//! The pages in a real browser; `make test` runs these by name where Chromium is installed.

#![allow(clippy::unwrap_used, reason = "tests, and what they share")]

mod util;

use std::path::Path;
use std::process::Command;

use util::run;

/// The page as it is when its scripts are done.
fn page(url: &str, arguments: &[&str]) -> String {
    let profile = tempfile::tempdir().unwrap();
    let output = Command::new("chromium")
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--virtual-time-budget=8000", "--dump-dom"])
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
