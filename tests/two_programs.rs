//! `lunula` without FFmpeg's libraries and `lunula-video` beside it, to which it hands over what needs video.

use std::process::Command;

use crate::util::Dir;

#[test]
fn what_needs_video_is_handed_over_with_all_its_arguments() {
    let dir = Dir::new();
    let answer = dir.lunula(&["posture", "none.mp4", "--suggest"]).expect(2);
    assert!(answer.stderr.contains("none.mp4"), "{}", answer.stderr);
    dir.lunula(&["phantom", "video", "--seconds", "0.2", "--size", "320x180", "--out", "s", "-q"]).expect(0);
    assert!(dir.path("s/video.mp4").is_file());
}

#[test]
fn alone_it_says_what_is_missing_and_does_the_rest() {
    let dir = Dir::new();
    let alone = dir.path("lunula");
    std::fs::copy(env!("CARGO_BIN_EXE_lunula"), &alone).expect("a copy");
    let run = |arguments: &[&str]| Command::new(&alone).args(arguments).output().expect("the program runs");
    let refused = run(&["posture", "none.mp4", "--suggest"]);
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert_eq!(refused.status.code(), Some(2), "{said}");
    assert!(said.contains("lunula-video") && said.contains("install it beside"), "{said}");
    assert!(run(&["--help"]).status.success());
}
