//! `lunula run --shard` and `lunula merge` from end to end: parts brought together are the whole run, and what does not
//! belong together is refused.

use std::fs;

use crate::util::Dir;

/// Photographs to maps, one subject's going to one part; the maps gather over all.
const PIPELINE: &str = r#"name = "colours"
wanted = ["maps"]
[phantom]
photos = { seed = 3, subjects = 4, poses = ["normal"], size = "320x240", grey = true }
[inputs.photos]
files = "{phantom}/photos/photos/{pose}/{subject}.png"
[stage.normalized]
job = "normalize"
photo = "photos"
[stage.maps]
job = "maps"
sums = "normalized"
"#;

fn parts(dir: &Dir, of: usize) -> Vec<String> {
    let name = |k: usize| format!("part-{k}-of-{of}");
    for k in 1..=of {
        let shard = format!("{k}/{of}");
        dir.lunula(&["run", "p.toml", "--shard", &shard, "--out", &name(k), "--quiet"]).expect(0);
    }
    (1..=of).map(name).collect()
}

fn merge<'a>(parts: &'a [String], more: &[&'a str]) -> Vec<&'a str> {
    let parts = parts.iter().map(String::as_str);
    ["merge"].into_iter().chain(parts).chain(more.iter().copied()).collect()
}

#[test]
fn one_three_and_seven_parts_merged_are_the_same_bytes_as_the_whole_run() {
    let dir = Dir::new();
    dir.write("p.toml", PIPELINE);
    dir.lunula(&["run", "p.toml", "--out", "whole", "--quiet"]).expect(0);
    let whole = dir.results_of("whole");
    assert!(whole.keys().any(|name| name.starts_with("maps/")), "{:?}", whole.keys());
    for of in [1, 3, 7] {
        let parts = parts(&dir, of);
        assert!(of == 1 || !dir.path(&parts[0]).join("maps").exists(), "no part makes the maps");
        let out = format!("merged-{of}");
        let report = dir.lunula(&merge(&parts, &["--out", &out, "--json"])).expect(0).json();
        let (done, kept) = (report["done"].as_u64(), report["kept"].as_u64());
        assert_eq!((done, kept), (Some(1), Some(5)), "{report}");
        assert!(dir.results_of(&out) == whole, "{of} parts");
        let again = dir.lunula(&merge(&parts, &["--out", &out, "--json"])).expect(0).json();
        assert_eq!(again["done"].as_u64(), Some(0), "{again}");
    }
}

#[test]
fn what_does_not_belong_together_is_refused_and_nothing_is_written() {
    let dir = Dir::new();
    dir.write("p.toml", PIPELINE);
    let made = parts(&dir, 2);
    let refused = |parts: &[String], words: &str| {
        dir.lunula(&merge(parts, &["--out", "out"])).expect(2).says(words);
        assert!(!dir.path("out").exists());
    };
    refused(&made[..1], "2/2: of 2 parts this is missing");
    refused(&[made[0].clone(), made[0].clone(), made[1].clone()], "both are part 1/2");
    dir.write("other.toml", format!("# another\n{}", PIPELINE.replace("seed = 3", "seed = 4")));
    dir.lunula(&["run", "other.toml", "--shard", "2/2", "--out", "other", "--quiet"]).expect(0);
    refused(&[made[0].clone(), "other".into()], "are parts of different runs: line 4 says");
    let moved = dir.lunula(&merge(&made, &["--out", "out", "--pipeline", "other.toml"])).expect(2);
    moved.says("made by another pipeline than other.toml is now");
    dir.lunula(&["run", "p.toml", "--shard", "1/2", "--out", &made[1]]).expect(2).says("holds part 2/2 of a run");
    dir.lunula(&["run", "p.toml", "--shard", "3/2", "--out", "out"]).expect(2).says("a part is written I/N");

    // A comment decides nothing, and the parts remember what was run.
    fs::write(dir.path("p.toml"), format!("# mine\n{PIPELINE}")).unwrap();
    dir.lunula(&merge(&made, &["--out", "out", "--quiet"])).expect(0);
    fs::remove_file(dir.path("p.toml")).unwrap();
    dir.lunula(&merge(&made, &["--out", "out"])).expect(0).says("if it was moved, give it with --pipeline");
}
