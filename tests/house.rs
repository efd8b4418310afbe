//! What holds the code's rooms together: no circle between files and no arrow up a floor, read from the `use` lines; no
//! crowded folder and no long line.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use regex_lite::Regex;

use crate::util::{paths_below, repository};

/// The library's rooms, from the ground up: a room knows those of lower floors, and none of its own beside it.
const FLOORS: [&[&str]; 10] = [
    &["flexion", "median", "nail", "stages", "timebase", "words"],
    &["input"],
    &["files", "labelme", "npy", "photograph", "table", "toml_file", "video", "vision"],
    &["job"],
    &["clock", "figure", "log"],
    &["align", "camera", "hemodynamics", "photo", "posture", "predictor"],
    &["layout", "nailvideo", "outlines", "phantom"],
    &["live"],
    &["doctor", "prompt", "tradeoff"],
    &["pipeline"],
];

/// A file's place among the modules, as `["posture", "job"]`.
type Module = Vec<String>;

/// The files of a crate's `src` that are no tests, and the `use` paths of each.
fn modules(root: &Path) -> BTreeMap<Module, Vec<Module>> {
    let line = Regex::new(r"(?ms)^\s*(pub(\([^)]*\))?\s+)?use\s+((crate|super|self)\b[^;]*);").expect("a pattern");
    let tests = Regex::new(r"#\[cfg\(test\)\]\s*(?:pub(?:\([^)]*\))?\s+)?mod (\w+)( \{|;)").expect("a pattern");
    let (mut found, mut only_tests) = (BTreeMap::new(), Vec::new());
    for path in paths_below(root, ".rs") {
        let inner = path.strip_prefix(root).expect("within it").with_extension("");
        let mut module: Module = inner.iter().map(|part| part.to_string_lossy().into_owned()).collect();
        if module.last().is_some_and(|name| ["mod", "lib", "main"].contains(&name.as_str())) {
            module.pop();
        }
        let text = std::fs::read_to_string(&path).expect("a source file");
        let mut end = text.len();
        for test in tests.captures_iter(&text) {
            only_tests.push([&module[..], &[test[1].to_owned()]].concat());
            if &test[2] == " {" {
                end = end.min(test.get(0).expect("all of it").start());
            }
        }
        let paths = line.captures_iter(&text[..end]).filter(|found| found.get(1).is_none());
        let paths = paths.flat_map(|found| expanded(&found[3])).map(|path| absolute(&module, &path)).collect();
        found.insert(module, paths);
    }
    found.retain(|module: &Module, _| !only_tests.iter().any(|tests| module.starts_with(tests)));
    found
}

/// `a::{b, c::{d, e}}` as `a::b`, `a::c::d`, `a::c::e`.
fn expanded(path: &str) -> Vec<String> {
    let path: String = path.chars().filter(|c| !c.is_whitespace()).collect();
    let Some((head, rest)) = path.split_once('{') else { return vec![path] };
    let (mut all, mut depth, mut part) = (Vec::new(), 0, String::new());
    for c in rest.strip_suffix('}').unwrap_or(rest).chars().chain([',']) {
        match c {
            ',' if depth == 0 => all.extend(expanded(&std::mem::take(&mut part))),
            _ => {
                depth += i32::from(c == '{') - i32::from(c == '}');
                part.push(c);
            }
        }
    }
    all.into_iter().filter(|part| !part.is_empty()).map(|part| format!("{head}{part}")).collect()
}

/// A path from the crate's root.
fn absolute(module: &[String], path: &str) -> Module {
    let mut at = module.to_vec();
    for part in path.split("::") {
        match part {
            "crate" => at.clear(),
            "super" => drop(at.pop()),
            "self" => {}
            _ => at.push(part.to_owned()),
        }
    }
    at
}

/// The file that a path leads to.
fn file<'a>(files: &BTreeMap<Module, Vec<Module>>, mut path: &'a [String]) -> &'a [String] {
    while !files.contains_key(path) && !path.is_empty() {
        path = &path[..path.len() - 1];
    }
    path
}

/// Files that use each other in a circle; a parent and its own child may.
fn circles(files: &BTreeMap<Module, Vec<Module>>) -> Vec<String> {
    let edges: BTreeMap<&[String], BTreeSet<&[String]>> = files
        .iter()
        .map(|(from, paths)| {
            let to = paths.iter().map(|path| file(files, path));
            (from.as_slice(), to.filter(|to| !to.starts_with(from) && !from.starts_with(to)).collect())
        })
        .collect();
    let reached = |from: &[String]| {
        let (mut seen, mut left) = (BTreeSet::new(), vec![from]);
        while let Some(at) = left.pop() {
            left.extend(edges.get(at).into_iter().flatten().filter(|to| seen.insert(**to)));
        }
        seen.contains(from)
    };
    edges.keys().filter(|from| reached(from)).map(|from| from.join("/")).collect()
}

#[test]
fn no_file_uses_another_that_uses_it() {
    let root = repository();
    for (folder, least) in [
        ("src", 400),
        ("crates/cli/src", 25),
        ("crates/predictor/src", 50),
        ("crates/hemodynamics/src", 50),
        ("crates/thesis/src", 40),
        ("crates/training/src", 14),
        ("bench/peers/src", 10),
    ] {
        let files = modules(&root.join(folder));
        assert!(files.len() >= least, "{folder}: {} files", files.len());
        assert_eq!(circles(&files), [""; 0], "{folder}");
    }
}

#[test]
fn no_room_uses_one_of_its_own_floor_or_above() {
    let files = modules(&repository().join("src"));
    let floor = |room: &str| FLOORS.iter().position(|rooms| rooms.contains(&room));
    let mut wrong = Vec::new();
    let mut seen = 0;
    for (from, paths) in files.iter().filter(|(from, _)| !from.is_empty()) {
        let own = floor(&from[0]).unwrap_or_else(|| panic!("{}: on which floor?", from[0]));
        for to in paths.iter().filter(|to| to.first().is_some_and(|room| *room != from[0])) {
            let Some(other) = floor(&to[0]) else { continue };
            seen += 1;
            if other >= own {
                wrong.push(format!("{} -> {}", from.join("/"), to.join("/")));
            }
        }
    }
    assert!(seen > 300, "{seen} arrows between rooms");
    assert_eq!(wrong, [""; 0]);
}

/// Folders that may hold more: the rooms by their names, and the integration tests, a file for each command.
const OPEN_FOLDERS: [&str; 4] = ["src", "tests", "tests/corpus", "crates/hemodynamics/tests/reference"];
/// The most entries of any other folder.
const MOST_ENTRIES: usize = 12;
const MOST_COLUMNS: usize = 120;
/// Tables of numbers, a number of 60 digits a line.
const NUMBERS: &str = "crates/hemodynamics/src/radau/tables.rs";

#[test]
fn no_folder_is_crowded_and_no_line_is_long() {
    let root = repository();
    let (mut crowded, mut long, mut files) = (Vec::new(), Vec::new(), 0);
    let mut folders: Vec<PathBuf> = ["src", "crates", "tests", "bench", "examples"].map(|name| root.join(name)).into();
    while let Some(folder) = folders.pop() {
        let entries: Vec<PathBuf> =
            std::fs::read_dir(&folder).expect("a folder").map(|entry| entry.expect("an entry").path()).collect();
        let name = folder.strip_prefix(root).expect("within it").to_string_lossy().into_owned();
        if entries.len() > MOST_ENTRIES && !OPEN_FOLDERS.contains(&name.as_str()) {
            crowded.push(format!("{name}: {}", entries.len()));
        }
        for path in entries {
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|ending| ending == "rs") && !path.ends_with(NUMBERS) {
                files += 1;
                let text = std::fs::read_to_string(&path).expect("a source file");
                let lines = text.lines().enumerate().filter(|(_, line)| line.chars().count() > MOST_COLUMNS);
                long.extend(lines.map(|(at, _)| format!("{}:{}", path.display(), at + 1)));
            }
        }
    }
    assert!(files > 700, "{files} files");
    assert_eq!(crowded, [""; 0], "more than {MOST_ENTRIES} entries");
    assert_eq!(long, [""; 0], "more than {MOST_COLUMNS} columns");
}

/// The same input gives the same bytes at any time: only what locks, dates records and judges files' times reads it.
#[test]
fn no_job_reads_the_wall_clock() {
    const READERS: [&str; 5] = [
        "doctor.rs",
        "live/session/open.rs",
        "pipeline/run/attempt.rs",
        "pipeline/store/hashes.rs",
        "pipeline/store/lock.rs",
    ];
    let reads = Regex::new(r"\b(SystemTime|Timestamp|Zoned|Utc|Local|OffsetDateTime)::now\b").expect("a pattern");
    let all = ["src", "crates"].map(|folder| paths_below(&repository().join(folder), ".rs")).concat();
    let is_reader = |path: &&PathBuf| {
        let inner = path.strip_prefix(repository()).expect("within it");
        !inner.iter().any(|part| part == "tests" || part == "tests.rs")
            && reads.is_match(&std::fs::read_to_string(path).expect("a source file"))
    };
    let readers: BTreeSet<&PathBuf> = all.iter().filter(is_reader).collect();
    let known = READERS.map(|name| repository().join("src").join(name));
    assert_eq!(readers, known.iter().collect());
}

#[test]
fn architecture_lists_the_same_floors() {
    let page = std::fs::read_to_string(repository().join("ARCHITECTURE.md")).expect("a page");
    for (below, rooms) in FLOORS.iter().enumerate() {
        let row = page.lines().find(|line| line.starts_with(&format!("| {} | ", below + 1)));
        let row = row.unwrap_or_else(|| panic!("ARCHITECTURE.md has no floor {}", below + 1));
        let named = row.split('|').nth(2).unwrap_or_default();
        let named: BTreeSet<&str> = named.split('`').skip(1).step_by(2).collect();
        assert_eq!(named, rooms.iter().copied().collect(), "floor {}", below + 1);
    }
}

#[test]
fn circles_and_paths_are_found() {
    let module = |path: &str| -> Module { path.split('/').map(str::to_owned).collect() };
    assert_eq!(expanded("super::{a, b::{c, d as e}}"), ["super::a", "super::b::c", "super::b::dase"]);
    assert_eq!(absolute(&module("x/y"), "super::z::Q"), module("x/z/Q"));
    let uses = |from: &str, to: &str| (module(from), vec![module(to)]);
    let ring = BTreeMap::from([uses("a/b", "a/c/T"), uses("a/c", "d"), uses("d", "a/b"), uses("a", "a/b")]);
    assert_eq!(circles(&ring), ["a/b", "a/c", "d"]);
    let line = BTreeMap::from([uses("a/b", "a/c/T"), uses("a/c", "d"), uses("d", "e"), uses("a", "a/b")]);
    assert_eq!(circles(&line), [""; 0]);
}
