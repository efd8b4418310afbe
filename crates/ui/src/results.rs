//! Folders of results: which runs are below them, and their files by number.
//!
//! A run is the JSON that a job leaves beside its results: `run.json`, `NAME.run.json` or `NAME.stream.json`. Its
//! pictures are those of its folder and the folder's `figures` (of `NAME.run.json` those that begin with `NAME`), its
//! report the folder's `report.html`. Links are not followed, so nothing outside of the folders is ever read.

use std::collections::HashMap;
use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::UNIX_EPOCH;

use axum::extract::{Path as At, State};
use axum::http::header::{CONTENT_SECURITY_POLICY, CONTENT_TYPE, HeaderValue};
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use axum::{Json, Router};
use serde::Serialize;
use serde_json::Value;

use crate::pages::RESULTS;
use crate::server::UiError;
use crate::site::{SMALL_BODY, Site};

/// What a report may do: be looked at. It may hold names and texts of anybody's files.
const SANDBOX: &str = "sandbox; default-src 'none'; style-src 'unsafe-inline'; img-src data:; font-src data:; base-uri \
                       'none'; form-action 'none'; frame-ancestors 'self'";

/// Folders in folders; a study has four (*assumed* enough for years of studies in one folder).
const MOST_DEEP: usize = 8;
/// Files and folders that are looked at, and runs that are listed.
const MOST_LOOKED_AT: usize = 100_000;
const MOST_RUNS: usize = 2_000;
const MOST_PICTURES: usize = 60;
/// Lines of a list, and bytes of a run's JSON and of any file.
const MOST_LINES: usize = 50;
const MOST_JSON: u64 = 16 << 20;
const MOST_FILE: u64 = 64 << 20;

/// A site that shows the results below these folders.
///
/// # Errors
/// A folder that can't be read.
pub fn results(folders: &[PathBuf]) -> Result<Site, UiError> {
    let mut roots = Vec::new();
    for path in folders {
        let root = path.canonicalize().and_then(|root| fs::read_dir(&root).map(|_| root));
        roots.push(root.map_err(|why| UiError::Folder { path: path.clone(), why })?);
    }
    let routes = Router::new()
        .route("/api/results", get(list))
        .route("/api/file/{number}", get(file))
        .with_state(Arc::new(Mutex::new(Folders::new(roots))));
    let [page, script] = &RESULTS;
    Ok(Site {
        name: "results",
        title: "Results",
        page: *page,
        assets: std::slice::from_ref(script),
        routes,
        most_body: SMALL_BODY,
    })
}

async fn list(State(folders): State<Arc<Mutex<Folders>>>) -> Response {
    let look = move || folders.lock().unwrap_or_else(PoisonError::into_inner).look();
    let looked = tokio::task::spawn_blocking(look).await;
    looked.map_or_else(|_| StatusCode::INTERNAL_SERVER_ERROR.into_response(), |found| Json(found).into_response())
}

async fn file(State(folders): State<Arc<Mutex<Folders>>>, At(number): At<usize>) -> Response {
    let read = move || folders.lock().unwrap_or_else(PoisonError::into_inner).read(number);
    let Ok(Some(file)) = tokio::task::spawn_blocking(read).await else { return StatusCode::NOT_FOUND.into_response() };
    let mut headers = HeaderMap::new();
    headers.insert(CONTENT_TYPE, HeaderValue::from_static(file.kind));
    // Of whoever made it, not ours.
    headers.insert(CONTENT_SECURITY_POLICY, HeaderValue::from_static(SANDBOX));
    (headers, file.bytes).into_response()
}

/// What is below the folders.
#[derive(Debug, Default, Serialize)]
pub(crate) struct Results {
    runs: Vec<Run>,
    /// What was not looked at, in words.
    left_out: Option<String>,
}

/// A run of a job.
#[derive(Debug, Serialize)]
struct Run {
    /// The number of its JSON.
    id: usize,
    /// Where it is, from the folder that was named.
    name: String,
    job: String,
    version: String,
    made_unix_s: f64,
    wall_s: Option<f64>,
    warnings: Vec<String>,
    failed: Vec<String>,
    left_out: Vec<String>,
    report: Option<usize>,
    pictures: Vec<Picture>,
}

#[derive(Debug, Serialize)]
struct Picture {
    id: usize,
    name: String,
}

/// A file that may be read.
#[derive(Debug, PartialEq)]
pub(crate) struct ResultFile {
    pub(crate) kind: &'static str,
    pub(crate) bytes: Vec<u8>,
}

/// The folders, and the files that were listed.
#[derive(Debug)]
pub(crate) struct Folders {
    roots: Vec<PathBuf>,
    listed: Vec<PathBuf>,
    numbers: HashMap<PathBuf, usize>,
}

impl Folders {
    /// Of these folders, with links resolved.
    pub(crate) fn new(roots: Vec<PathBuf>) -> Self {
        Self { roots, listed: Vec::new(), numbers: HashMap::new() }
    }

    /// Looks for runs.
    pub(crate) fn look(&mut self) -> Results {
        let mut results = Results::default();
        let (mut looked_at, mut unread, mut left_out) = (0, Vec::new(), Vec::new());
        for root in self.roots.clone() {
            let mut folders = vec![(root.clone(), 0)];
            while let Some((folder, depth)) = folders.pop() {
                let Ok(entries) = fs::read_dir(&folder) else { continue };
                let mut files = Vec::new();
                for entry in entries.flatten() {
                    looked_at += 1;
                    // A link is neither.
                    match entry.file_type() {
                        Ok(kind) if kind.is_file() => files.push(entry.path()),
                        Ok(kind) if kind.is_dir() && depth < MOST_DEEP => folders.push((entry.path(), depth + 1)),
                        _ => {}
                    }
                }
                files.sort();
                for file in files.iter().filter(|file| stem_of_run(file).is_some()) {
                    if results.runs.len() >= MOST_RUNS {
                        break;
                    }
                    match read_json(file) {
                        Some(value) => results.runs.extend(self.run(&root, file, &value, &files)),
                        None => unread.push(shown(&root, file)),
                    }
                }
                if looked_at > MOST_LOOKED_AT || results.runs.len() >= MOST_RUNS {
                    let most = format!("({MOST_RUNS} results or {MOST_LOOKED_AT} files at most)");
                    left_out = vec![format!("not all was looked at {most}")];
                    folders.clear();
                }
            }
        }
        unread.sort();
        if let Some(first) = unread.first() {
            left_out.push(format!("{} can't be read as JSON ({first} first)", unread.len()));
        }
        results.left_out = (!left_out.is_empty()).then(|| left_out.join("; "));
        // The newest first, then by name.
        results.runs.sort_by(|a, b| b.made_unix_s.total_cmp(&a.made_unix_s).then_with(|| a.name.cmp(&b.name)));
        results
    }

    /// A file that was listed; its folder may have changed since.
    pub(crate) fn read(&self, number: usize) -> Option<ResultFile> {
        let path = self.listed.get(number)?;
        let kind = kind_of(path)?;
        let real = path.canonicalize().ok().filter(|real| real == path)?;
        if !self.roots.iter().any(|root| real.starts_with(root)) {
            return None;
        }
        Some(ResultFile { kind, bytes: read_file(&real, MOST_FILE)? })
    }

    fn run(&mut self, root: &Path, json: &Path, value: &Value, beside: &[PathBuf]) -> Option<Run> {
        let stem = stem_of_run(json)?;
        let text = |key: &str| value.get(key).and_then(Value::as_str).map(str::to_owned);
        let job = text("job").or_else(|| text("pipeline"))?;
        let lines = |key: &str| -> Vec<String> {
            listed(value, key).filter_map(Value::as_str).take(MOST_LINES).map(str::to_owned).collect()
        };
        // A pipeline counts in `failed` what `failures` lists, and what its jobs warn of stands by stage.
        let failures = listed(value, "failures").filter_map(|one| said(one, one, "task"));
        let failed = lines("failed").into_iter().chain(failures.take(MOST_LINES)).collect();
        let of_stages = listed(value, "stages")
            .flat_map(|stage| listed(stage, "warnings").filter_map(move |one| said(one, stage, "stage")));
        let warnings = lines("warnings").into_iter().chain(of_stages.take(MOST_LINES)).collect();
        let folder = json.parent()?;
        let mut pictures: Vec<PathBuf> = beside.to_vec();
        if stem.is_empty() {
            let figures = fs::read_dir(folder.join("figures")).into_iter().flatten().flatten();
            pictures
                .extend(figures.filter(|one| one.file_type().is_ok_and(|kind| kind.is_file())).map(|one| one.path()));
            pictures.sort();
        }
        let is_own = |path: &&PathBuf| {
            let name = path.file_name().map(|name| name.to_string_lossy()).unwrap_or_default();
            name.starts_with(stem) && name.ends_with(".png")
        };
        let pictures: Vec<&PathBuf> = pictures.iter().filter(is_own).take(MOST_PICTURES).collect();
        let report = folder.join("report.html");
        let made = fs::metadata(json).and_then(|one| one.modified()).ok()?;
        Some(Run {
            id: self.number(json),
            name: shown(root, json),
            job,
            version: text("version").unwrap_or_default(),
            made_unix_s: made.duration_since(UNIX_EPOCH).map_or(0.0, |since| since.as_secs_f64()),
            wall_s: value.get("wall_s").and_then(Value::as_f64),
            warnings,
            failed,
            left_out: lines("left_out"),
            report: (stem.is_empty() && beside.contains(&report)).then(|| self.number(&report)),
            pictures: pictures
                .into_iter()
                .map(|path| Picture { id: self.number(path), name: shown(folder, path) })
                .collect(),
        })
    }

    fn number(&mut self, path: &Path) -> usize {
        if let Some(number) = self.numbers.get(path) {
            return *number;
        }
        let number = self.listed.len();
        self.listed.push(path.to_owned());
        self.numbers.insert(path.to_owned(), number);
        number
    }
}

/// What a list of a run's JSON holds.
fn listed<'a>(value: &'a Value, key: &str) -> impl Iterator<Item = &'a Value> + use<'a> {
    value.get(key).and_then(Value::as_array).into_iter().flatten()
}

/// What is said of one of a pipeline's parts, behind its name.
fn said(one: &Value, part: &Value, name: &str) -> Option<String> {
    Some(format!("{}: {}", part.get(name)?.as_str()?, one.get("what")?.as_str()?))
}

/// What the names of a run's files begin with, where a file is a run's JSON.
fn stem_of_run(path: &Path) -> Option<&str> {
    let name = path.file_name()?.to_str()?;
    if name == "run.json" {
        return Some("");
    }
    let stem = name.strip_suffix(".run.json").or_else(|| name.strip_suffix(".stream.json"))?;
    (!stem.is_empty()).then_some(stem)
}

/// A path below the folder that was named, that folder's own name first.
fn shown(root: &Path, path: &Path) -> String {
    let below = path.strip_prefix(root).unwrap_or(path);
    let root = root.file_name().map(PathBuf::from).unwrap_or_default();
    root.join(below).display().to_string()
}

fn kind_of(path: &Path) -> Option<&'static str> {
    match path.extension()?.to_str()? {
        "html" => Some("text/html; charset=utf-8"),
        "png" => Some("image/png"),
        "json" => Some("application/json"),
        _ => None,
    }
}

/// A run's JSON, where it is whole.
fn read_json(path: &Path) -> Option<Value> {
    serde_json::from_slice(&read_file(path, MOST_JSON)?).ok()
}

/// A file's bytes, where it has no more than so many.
fn read_file(path: &Path, most: u64) -> Option<Vec<u8>> {
    let mut bytes = Vec::new();
    let read = File::open(path).ok()?.take(most + 1).read_to_end(&mut bytes).ok()?;
    (read as u64 <= most).then_some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn write(path: PathBuf, text: &str) {
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }

    fn desk() -> (tempfile::TempDir, PathBuf) {
        let dir = tempfile::tempdir().unwrap();
        let root = dir.path().canonicalize().unwrap().join("lab");
        let run =
            |job: &str| format!("{{\"job\":\"{job}\",\"version\":\"0.1.0\",\"warnings\":[\"w\"],\"wall_s\":1.5}}");
        write(root.join("photos/run.json"), &run("photos"));
        write(root.join("photos/report.html"), "<p>x</p>");
        write(root.join("photos/figures/mean.png"), "png");
        write(root.join("posture/joints.run.json"), &run("posture"));
        write(root.join("posture/joints-angles.png"), "png");
        write(root.join("posture/other.png"), "png");
        write(root.join("posture/broken.run.json"), "{\"job\":");
        let failures = "[{\"task\":\"align/1\",\"what\":\"log.csv:7: no number\"}]";
        let stages = "[{\"stage\":\"force\",\"warnings\":[{\"what\":\"few rows\",\"count\":2}]}]";
        let study = format!("{{\"pipeline\":\"s\",\"failed\":1,\"failures\":{failures},\"stages\":{stages}}}");
        write(root.join("study/run.json"), &study);
        (dir, root)
    }

    #[test]
    fn runs_are_found_with_their_pictures_and_reports() {
        let (_dir, root) = desk();
        let mut folders = Folders::new(vec![root]);
        let Results { mut runs, left_out } = folders.look();
        assert_eq!(left_out.as_deref(), Some("1 can't be read as JSON (lab/posture/broken.run.json first)"));
        runs.sort_by(|a, b| a.name.cmp(&b.name));
        let names: Vec<&str> = runs.iter().map(|run| run.name.as_str()).collect();
        assert_eq!(names, ["lab/photos/run.json", "lab/posture/joints.run.json", "lab/study/run.json"]);
        assert_eq!(runs[2].failed, ["align/1: log.csv:7: no number"]);
        assert_eq!(runs[2].warnings, ["force: few rows"]);
        let pictures = |run: &Run| run.pictures.iter().map(|one| one.name.clone()).collect::<Vec<_>>();
        assert_eq!(pictures(&runs[0]), ["photos/figures/mean.png"]);
        assert_eq!(pictures(&runs[1]), ["posture/joints-angles.png"]);
        assert_eq!((runs[1].report, runs[1].wall_s, runs[1].warnings.len()), (None, Some(1.5), 1));
        let report = folders.read(runs[0].report.unwrap()).unwrap();
        assert_eq!(report, ResultFile { kind: "text/html; charset=utf-8", bytes: b"<p>x</p>".to_vec() });
        assert_eq!(folders.read(10_000), None);
        // The same numbers when it looks again.
        let again = folders.look().runs;
        assert!(again.iter().all(|run| runs.iter().any(|old| old.id == run.id && old.name == run.name)));
    }

    #[cfg(unix)]
    #[test]
    fn links_lead_nowhere_even_when_made_later() {
        use std::os::unix::fs::symlink;

        let (dir, root) = desk();
        let secret = dir.path().join("secret");
        write(secret.join("run.json"), "{\"job\":\"secret\"}");
        write(secret.join("key.png"), "key");
        symlink(&secret, root.join("link")).unwrap();
        symlink(secret.join("run.json"), root.join("posture/run.json")).unwrap();
        let mut folders = Folders::new(vec![root.clone()]);
        let runs = folders.look().runs;
        assert!(runs.len() == 3 && runs.iter().all(|run| run.job != "secret"));
        let picture = runs.iter().flat_map(|run| &run.pictures).find(|one| one.name.ends_with("mean.png")).unwrap().id;
        assert!(folders.read(picture).is_some());
        fs::remove_file(root.join("photos/figures/mean.png")).unwrap();
        symlink(secret.join("key.png"), root.join("photos/figures/mean.png")).unwrap();
        assert_eq!(folders.read(picture), None);
    }

    #[test]
    fn a_file_that_is_too_large_is_not_read() {
        let (_dir, root) = desk();
        let path = root.join("photos/report.html");
        File::options().write(true).open(&path).unwrap().set_len(MOST_FILE + 1).unwrap();
        let mut folders = Folders::new(vec![root]);
        let report = folders.look().runs.iter().find_map(|run| run.report).unwrap();
        assert_eq!(folders.read(report), None);
    }
}
