//! Patterns on lists of files and on the disk.

use super::walk::Matches;
use super::{Disk, Listed, Pattern};
use crate::pipeline::tests::planned::folder_of;

fn find(pattern: &str, files: &[&str]) -> Matches {
    Pattern::parse(pattern).unwrap().find(&Listed::new(files.iter().copied()))
}

fn found(pattern: &str, files: &[&str]) -> Vec<String> {
    find(pattern, files).matches.iter().map(|m| format!("{} {}", m.path, m.keys).trim().to_owned()).collect()
}

#[test]
fn places_become_keys_and_results_are_sorted() {
    let files = ["photos/rest/S02.png", "photos/rest/S01.png", "photos/press/S01.png", "photos/press/S01.json"];
    let expected = [
        "photos/press/S01.png pose=press subject=S01",
        "photos/rest/S01.png pose=rest subject=S01",
        "photos/rest/S02.png pose=rest subject=S02",
    ];
    assert_eq!(found("photos/{pose}/{subject}.png", &files), expected);
    assert_eq!(found("./photos//{pose}/{subject}.png", &files), expected);
    assert_eq!(Pattern::parse("photos/{pose}/{subject}.png").unwrap().names, ["pose", "subject"]);
}

#[test]
fn wildcards_stay_within_a_folder_and_two_stars_go_through_folders() {
    let files = ["a.csv", "x/a.csv", "x/y/a.csv", "x/y/b.csv", "x/y/bc.csv", "x/.hidden/a.csv", "x/._a.csv"];
    assert_eq!(found("*.csv", &files), ["a.csv"]);
    assert_eq!(found("x/?.csv", &files), ["x/a.csv"]);
    assert_eq!(found("**/a.csv", &files), ["a.csv", "x/a.csv", "x/y/a.csv"]);
    assert_eq!(found("x/**/[bc].csv", &files), ["x/y/b.csv"]);
    assert_eq!(found("x/**/[!b].csv", &files), ["x/a.csv", "x/y/a.csv"]);
    assert_eq!(found("x/y/**", &files), ["x/y/a.csv", "x/y/b.csv", "x/y/bc.csv"]);
    assert_eq!(found("**/**/bc.csv", &files), ["x/y/bc.csv"]);
    assert_eq!(found("x/.hidden/{name}.csv", &files), ["x/.hidden/a.csv name=a"]);
}

#[test]
fn a_place_that_stands_twice_is_the_same_twice() {
    let files = ["S01/S01.csv", "S01/S02.csv", "a-a", "a-b"];
    assert_eq!(found("{s}/{s}.csv", &files), ["S01/S01.csv s=S01"]);
    assert_eq!(found("{s}-{s}", &files), ["a-a s=a"]);
}

#[test]
fn odd_names_are_names() {
    let files = ["dots/S.0.1.csv", "uni/Müller 日本.csv", "odd/a+b(1)[x].csv"];
    assert_eq!(found("dots/{s}.csv", &files), ["dots/S.0.1.csv s=S.0.1"]);
    assert_eq!(found("uni/{s}.csv", &files), ["uni/Müller 日本.csv s=Müller 日本"]);
    assert_eq!(found("odd/a+b(1)*.csv", &files), ["odd/a+b(1)[x].csv"]);
}

#[test]
fn a_name_that_can_be_read_in_two_ways_is_told() {
    let both = find("{subject}_{session}.csv", &["S01_1.csv", "S_01_2.csv"]);
    assert_eq!(both.matches.len(), 1);
    assert_eq!(both.ambiguous, ["`S_01_2.csv` can be read as session=01_2 subject=S or as session=2 subject=S_01"]);
}

#[test]
fn a_pattern_that_ends_in_a_slash_finds_folders() {
    let files = ["sets/S01/a.csv", "sets/S02/a.csv", "sets/readme"];
    assert_eq!(found("sets/{s}/", &files), ["sets/S01 s=S01", "sets/S02 s=S02"]);
    assert_eq!(found("sets/{s}", &files), ["sets/readme s=readme"]);
    assert_eq!(found("sets/S01", &files), ["sets/S01"]);
}

#[test]
fn where_nothing_is_found_the_nearest_folder_is_named() {
    let files = ["photos/rest/S01.jpg", "photos/rest/S02.jpg", "log.csv"];
    let why = |pattern: &str| find(pattern, &files).nothing.unwrap();
    assert_eq!(why("phtos/{p}/{s}.png"), "there is no `phtos` in the folder ., did you mean `photos`?");
    assert_eq!(
        why("photos/{p}/{s}.png"),
        "nothing like `{s}.png` is in the folder photos/rest, which holds S01.jpg, S02.jpg"
    );
    assert!(why("log.csv/").contains("`log.csv` in . is a file"));
    assert!(why("photos/*").contains("nothing like `*`"));
    assert!(find("photos/{p}/{s}.jpg", &files).nothing.is_none());
}

#[test]
fn what_is_no_pattern_is_told() {
    for (pattern, words) in [
        ("a/{x.csv", "without its }"),
        ("a/x}.csv", "without its beginning"),
        ("a/[x.csv", "without its ]"),
        ("a/{}.csv", "names no key"),
        ("a/{b c}.csv", "names no key"),
        ("a/[].csv", "no character"),
        ("a/{phantom}.csv", "only at the beginning"),
    ] {
        let why = Pattern::parse(pattern).unwrap_err();
        assert!(why.contains(words), "{pattern}: {why}");
    }
}

#[test]
fn the_disk_is_read_like_a_list_and_results_are_never_inputs() {
    let dir = folder_of(&[("a/x.csv", ""), ("a/b/y.csv", ""), ("out/a/z.csv", "")]);
    let pattern = Pattern::parse("**/{n}.csv").unwrap();
    let out = Some(dir.path().join("out").canonicalize().unwrap());
    let paths = |disk: &Disk| -> Vec<String> { pattern.find(disk).matches.into_iter().map(|m| m.path).collect() };
    assert_eq!(paths(&Disk { base: dir.path().to_owned(), out }), ["a/b/y.csv", "a/x.csv"]);
    assert_eq!(paths(&Disk { base: dir.path().to_owned(), out: None }), ["a/b/y.csv", "a/x.csv", "out/a/z.csv"]);
    std::fs::create_dir(dir.path().join("out/.lunula")).unwrap();
    assert_eq!(paths(&Disk { base: dir.path().to_owned(), out: None }), ["a/b/y.csv", "a/x.csv"], "another run's");
    let named = Pattern::parse("out/a/{n}.csv").unwrap();
    assert_eq!(named.find(&Disk { base: dir.path().to_owned(), out: None }).matches.len(), 1);
    let full = Pattern::parse(&format!("{}/a/*.csv", dir.path().display())).unwrap();
    let there = full.find(&Disk { base: ".".into(), out: None });
    assert_eq!(there.matches[0].path, format!("{}/a/x.csv", dir.path().display()));
}

#[cfg(unix)]
#[test]
fn names_that_are_not_utf8_are_left_out_and_listed_where_the_pattern_fits_them() {
    use std::os::unix::ffi::OsStrExt;
    let dir = folder_of(&[("a/x.csv", ""), ("a/z.txt", "")]);
    for name in [&b"a/M\xfcller.csv"[..], b"a/M\xfcller.txt", b"\xe4/y.csv"] {
        let path = dir.path().join(std::ffi::OsStr::from_bytes(name));
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, "").unwrap();
    }
    let disk = Disk { base: dir.path().to_owned(), out: None };
    for (pattern, left_out) in [
        ("{day}/{n}.csv", &["a/M\u{fffd}ller.csv", "\u{fffd}"][..]),
        ("**/{n}.csv", &["a/M\u{fffd}ller.csv", "\u{fffd}"]),
        ("a/{n}.csv", &["a/M\u{fffd}ller.csv"]),
        ("a/x*.csv", &[]),
    ] {
        let found = Pattern::parse(pattern).unwrap().find(&disk);
        let paths: Vec<&str> = found.matches.iter().map(|one| one.path.as_str()).collect();
        assert_eq!(
            (paths, found.not_utf8),
            (vec!["a/x.csv"], left_out.iter().map(ToString::to_string).collect()),
            "{pattern}"
        );
    }
}
