//! `lunula run --shard` and `lunula merge` from end to end: what does not belong together is refused. What does is
//! merged in `cluster.rs`.

use std::fs;

use crate::pipeline::COLORATION;
use crate::util::Dir;

fn merge<'a>(parts: &'a [String], more: &[&'a str]) -> Vec<&'a str> {
    let parts = parts.iter().map(String::as_str);
    ["merge"].into_iter().chain(parts).chain(more.iter().copied()).collect()
}

#[test]
fn what_does_not_belong_together_is_refused_and_nothing_is_written() {
    let dir = Dir::new();
    dir.write("p.toml", COLORATION);
    let made = ["1/2", "2/2"].map(|shard| {
        let out = shard.replace('/', "-of-");
        dir.lunula(&["run", "p.toml", "--shard", shard, "--out", &out, "--quiet"]).expect(0);
        out
    });
    let refused = |parts: &[String], words: &str| {
        dir.lunula(&merge(parts, &["--out", "out"])).expect(2).says(words);
        assert!(!dir.path("out").exists());
    };
    refused(&made[..1], "2/2: of 2 parts this is missing");
    dir.write("other.toml", format!("# another\n{}", COLORATION.replace("seed = 3", "seed = 4")));
    dir.lunula(&["run", "other.toml", "--shard", "2/2", "--out", "other", "--quiet"]).expect(0);
    refused(&[made[0].clone(), "other".into()], "are parts of different runs: line 4 says");
    let moved = dir.lunula(&merge(&made, &["--out", "out", "--pipeline", "other.toml"])).expect(2);
    moved.says("made by another pipeline than other.toml is now");
    dir.lunula(&["run", "p.toml", "--shard", "1/2", "--out", &made[1]]).expect(2).says("holds part 2/2 of a run");
    dir.lunula(&["run", "p.toml", "--shard", "3/2", "--out", "out"]).expect(2).says("a part is written I/N");

    // A comment decides nothing, and the parts remember what was run.
    fs::write(dir.path("p.toml"), format!("# mine\n{COLORATION}")).unwrap();
    dir.lunula(&merge(&made, &["--out", "out", "--quiet"])).expect(0);
    fs::remove_file(dir.path("p.toml")).unwrap();
    dir.lunula(&merge(&made, &["--out", "out"])).expect(0).says("if it was moved, give it with --pipeline");
}
