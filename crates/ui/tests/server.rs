//! The server from outside, over its socket: what strangers get, what the page gets.

#![allow(clippy::unwrap_used, reason = "tests, and what they share")]

mod util;

use std::io::{Read, Write};
use std::net::TcpStream;
use std::path::Path;

use lunula_ui::{Latest, Server, Settings, UiError, live, results};
use util::{Answer, run, serve};

fn one_run(dir: &Path) {
    let at = dir.join("<img src=x onerror=alert(1)>");
    std::fs::create_dir(&at).unwrap();
    std::fs::write(at.join("run.json"), "{\"job\":\"photos\",\"version\":\"0.1.0\",\"warnings\":[]}").unwrap();
    std::fs::write(at.join("report.html"), "<script>alert(1)</script>").unwrap();
}

#[test]
fn the_page_gets_its_results_and_a_report_in_a_sandbox() {
    let server = run(one_run);
    let page = server.asks("GET", "/", "", "");
    assert!(page.status == 200 && page.body.contains("results.js") && !page.body.contains(&server.token));
    for header in ["content-security-policy: default-src 'none'", "nosniff", "no-referrer", "no-store"] {
        assert!(page.head.contains(header), "{header}: {}", page.head);
    }
    let cookie = server.cookie();
    let results = server.asks("GET", "/api/results", &cookie, "");
    assert_eq!(results.status, 200);
    let results: serde_json::Value = serde_json::from_str(&results.body).unwrap();
    assert!(results["runs"][0]["name"].as_str().unwrap().ends_with("<img src=x onerror=alert(1)>/run.json"));
    let report = server.asks("GET", &format!("/api/file/{}", results["runs"][0]["report"]), &cookie, "");
    assert_eq!((report.status, report.body.as_str()), (200, "<script>alert(1)</script>"));
    let policy = report.head.lines().find(|line| line.starts_with("content-security-policy")).unwrap();
    assert!(policy.contains("sandbox;") && !policy.contains("allow-scripts") && !policy.contains("script-src"));
    let bearer = format!("Authorization: Bearer {}\r\n", server.token);
    assert_eq!(server.asks("GET", "/api/results", &bearer, "").status, 200);
}

#[test]
fn strangers_are_refused_and_hear_nothing() {
    let server = run(one_run);
    let cookie = server.cookie();
    let own = format!("Origin: http://{}\r\n", server.at);
    let refused = |answer: Answer| {
        assert_eq!((answer.status, answer.body.as_str()), (403, ""), "{}", answer.head);
        assert!(!answer.head.contains("set-cookie") && !answer.head.contains("access-control"), "{}", answer.head);
    };
    // Another name for this address, as after a rebinding of it.
    refused(server.sends("GET / HTTP/1.1\r\nHost: evil.example\r\nConnection: close\r\n\r\n"));
    refused(server.sends(&format!("GET / HTTP/1.1\r\nHost: evil.example:80\r\nConnection: close\r\n{cookie}\r\n")));
    refused(server.sends("GET / HTTP/1.0\r\n\r\n"));
    // Another page, with the cookie that the browser adds.
    refused(server.asks("GET", "/api/results", &format!("{cookie}Origin: http://evil.example\r\n"), ""));
    refused(server.asks("GET", "/api/results", &format!("{cookie}Sec-Fetch-Site: cross-site\r\n"), ""));
    refused(server.asks("POST", "/api/session", "", &server.token));
    refused(server.asks("POST", "/api/session", "Origin: null\r\n", &server.token));
    refused(server.asks("OPTIONS", "/api/results", "", ""));
    // Nobody, and somebody who guesses.
    refused(server.asks("GET", "/api/results", "", ""));
    refused(server.asks("GET", "/api/file/0", "", ""));
    refused(server.asks("GET", "/api/results", "Authorization: Bearer 0\r\n", ""));
    refused(server.asks("POST", "/api/session", &own, &"0".repeat(48)));
    // Paths are numbers.
    for path in ["/api/file/..%2f..%2fetc%2fpasswd", "/api/file/../../etc/passwd", "/api/file/99", "/../secret", "/x"] {
        let answer = server.asks("GET", path, &cookie, "");
        assert!(matches!(answer.status, 400 | 404), "{path}: {}", answer.status);
    }
}

#[test]
fn half_open_connections_and_large_bodies_hold_nobody_up() {
    let server = run(one_run);
    // A thousand that never ask, and stay.
    let _held: Vec<TcpStream> = (0..1000).map(|_| TcpStream::connect(&server.at).unwrap()).collect();
    let cookie = server.cookie();
    let own = format!("Origin: http://{}\r\n", server.at);
    // Ten gigabytes are announced, and not waited for.
    let announced = format!(
        "POST /api/session HTTP/1.1\r\nHost: {}\r\nConnection: close\r\nContent-Length: 10000000000\r\n{own}\r\n",
        server.at
    );
    assert_eq!(server.sends(&announced).status, 413);
    let long = format!("X: {}\r\n", "x".repeat(100_000));
    assert!(matches!(server.asks("GET", "/", &long, "").status, 0 | 400 | 431));
    assert_eq!(server.asks("GET", "/api/results", &cookie, "").status, 200);
}

#[test]
fn a_folder_that_does_not_exist_and_a_port_that_is_taken_are_said() {
    assert!(matches!(results(&["/does/not/exist".into()]), Err(UiError::Folder { .. })));
    let server = run(one_run);
    let port = server.at.rsplit_once(':').unwrap().1.parse().unwrap();
    let taken = Server::bind(&Settings { port, ..Settings::default() }, vec![results(&[]).unwrap()]).err().unwrap();
    assert!(taken.to_string().contains("choose another --port"), "{taken}");
}

#[test]
fn the_live_page_hears_the_latest_and_says_nothing() {
    let latest = Latest::new("null");
    let server = serve(live(&latest));
    latest.leave("{\"fingers\":[]}");
    assert_eq!(server.asks("GET", "/api/live", "", "").status, 403);
    let page = server.asks("GET", "/", "", "");
    assert!(page.status == 200 && page.body.contains("live.js"));
    for asset in ["live.js", "common.js", "style.css"] {
        assert_eq!(server.asks("GET", &format!("/{asset}"), "", "").status, 200, "{asset}");
    }
    let mut stream = TcpStream::connect(&server.at).unwrap();
    let request = format!("GET /api/live HTTP/1.1\r\nHost: {}\r\n{}\r\n", server.at, server.cookie());
    stream.write_all(request.as_bytes()).unwrap();
    let mut heard = String::new();
    let mut piece = [0; 4096];
    while !heard.contains("data: {\"fingers\":[]}") {
        let read = stream.read(&mut piece).unwrap();
        assert!(read > 0, "{heard}");
        heard.push_str(&String::from_utf8_lossy(&piece[..read]));
    }
    assert!(heard.contains("text/event-stream"));
}
