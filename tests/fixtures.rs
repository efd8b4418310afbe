//! The fixtures are what `fixtures/make.sh` makes, and the commands of README and book that use them work.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::util::{Dir, bytes_below, paths_below, repository};

fn fixtures() -> PathBuf {
    repository().join("fixtures")
}

fn files(root: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = bytes_below(root);
    found.retain(|name, _| !name.ends_with("make.sh") && !name.ends_with("README.md"));
    found
}

#[test]
fn the_fixtures_are_made_again_byte_for_byte() {
    let dir = Dir::new();
    let made = dir.path("made");
    std::fs::create_dir(&made).expect("a folder");
    let status = Command::new("sh")
        .arg(fixtures().join("make.sh"))
        .arg(&made)
        .env("LUNULA", env!("CARGO_BIN_EXE_lunula"))
        .status()
        .expect("a shell");
    assert!(status.success());
    let (committed, made) = (files(&fixtures()), files(&made));
    assert_eq!(committed.keys().collect::<Vec<_>>(), made.keys().collect::<Vec<_>>());
    let differ: Vec<_> =
        committed.iter().filter(|(name, bytes)| made[*name] != **bytes).map(|(name, _)| name).collect();
    assert!(differ.is_empty(), "{differ:?}: run fixtures/make.sh, look at what changed, and commit it");
    assert!(committed.len() == 16 && committed.values().map(Vec::len).sum::<usize>() < 2_000_000);
}

/// A page's `lunula` commands within blocks of `sh` and `console`, lines ended by a backslash joined, and the error
/// that the page shows for one.
fn commands(page: &str) -> Vec<(String, Option<String>)> {
    let mut found = Vec::new();
    for block in page.split("```").skip(1).step_by(2) {
        let Some((language, text)) = block.split_once('\n') else { continue };
        let text = text.replace("\\\n", " ");
        let lines: Vec<&str> = text.lines().collect();
        for (at, line) in lines.iter().enumerate() {
            let own = match language {
                "sh" => Some(*line),
                "console" => line.strip_prefix("$ "),
                _ => None,
            };
            if let Some(command) = own.filter(|line| line.starts_with("lunula ")) {
                let error = lines.get(at + 1).filter(|next| next.starts_with("error: "));
                found.push((command.to_owned(), error.map(|error| (*error).to_owned())));
            }
        }
    }
    found
}

/// Each page's commands that use fixtures, or what such a command of the same page made, in the page's order.
#[test]
fn the_commands_of_readme_and_book_that_use_fixtures_work() {
    let mut all = paths_below(&repository().join("docs"), ".md");
    all.push(repository().join("README.md"));
    all.sort();
    let program = Path::new(env!("CARGO_BIN_EXE_lunula")).parent().expect("its folder");
    let path = format!("{}:{}", program.display(), std::env::var("PATH").unwrap_or_default());
    let mut done = 0;
    for page in all {
        let text = std::fs::read_to_string(&page).expect("a page");
        let commands = commands(&text);
        if !commands.iter().any(|(command, _)| command.contains("fixtures/")) {
            continue;
        }
        let dir = Dir::new();
        let copied = Command::new("cp").arg("-r").args([fixtures(), dir.path("fixtures")]).status();
        assert!(copied.expect("cp").success());
        for (command, error) in commands {
            let from_here = |word: &str| word.starts_with("fixtures/") || dir.path(word).exists();
            if !command.split_whitespace().skip(1).any(from_here) {
                continue;
            }
            let shell = Command::new("sh").args(["-c", &command]).env("PATH", &path).current_dir(dir.path("")).output();
            let output = shell.expect("a shell");
            let said = String::from_utf8_lossy(&output.stderr).into_owned();
            let as_shown = error.as_ref().map_or(output.status.success(), |error| said.contains(error));
            assert!(as_shown, "{}: {command}\n{said}", page.display());
            done += 1;
        }
    }
    assert!(done >= 5, "{done}");
}
