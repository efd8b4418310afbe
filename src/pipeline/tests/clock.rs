//! Files whose times lie: a changed file is never taken for the one that it was.

use std::fs::{self, File};
use std::path::Path;
use std::time::{Duration, SystemTime};

use super::toys::{Diary, given, outcomes, run_on, toy};
use crate::pipeline::store::hashes::{ContentHash, Hashes, now_ns};

/// When a file that is written now is at rest.
fn later_ns() -> i128 {
    now_ns() + 2_100_000_000
}

fn date(path: &Path, at: SystemTime) {
    File::options().write(true).open(path).unwrap().set_modified(at).unwrap();
}

#[test]
fn a_file_at_rest_is_read_once_and_a_changed_one_is_seen_whatever_its_date() {
    let dir = tempfile::tempdir().unwrap();
    let (path, future, place) = (dir.path().join("x"), dir.path().join("future"), dir.path().join("hashes"));
    fs::write(&path, "one").unwrap();
    fs::write(&future, "one").unwrap();
    date(&future, SystemTime::now() + Duration::from_secs(86_400));
    let hashes = Hashes::keep(&place);
    let hash = |hashes: &Hashes, path: &Path| hashes.of_file(path).unwrap().0;
    // Just written: it may change again within the same tick of the clock.
    (0..2).for_each(|_| assert_eq!(hash(&hashes, &path), ContentHash::of(b"one")));
    assert_eq!(hashes.read(), 2);
    drop(hashes);
    let hashes = Hashes::keep(&place).by(later_ns);
    (0..3).for_each(|_| assert_eq!(hash(&hashes, &path), ContentHash::of(b"one")));
    assert_eq!(hashes.read(), 1);
    (0..2).for_each(|_| assert_eq!(hash(&hashes, &future), ContentHash::of(b"one")));
    assert_eq!(hashes.read(), 3);
    drop(hashes);

    // A line that was cut short is not read and does not swallow the next.
    let mut text = fs::read(&place).unwrap();
    let line = text.clone();
    text.extend_from_slice(&line[..line.len() / 2]);
    fs::write(&place, text).unwrap();
    let hashes = Hashes::keep(&place).by(later_ns);
    hash(&hashes, &path);
    assert_eq!(hashes.read(), 0);

    // The same size, and the date that it had: the inode differs.
    let dated = fs::metadata(&path).unwrap().modified().unwrap();
    for (text, at) in [("two", dated), ("six", SystemTime::UNIX_EPOCH), ("ten", dated)] {
        fs::write(&path, text).unwrap();
        date(&path, at);
        assert_eq!(hash(&hashes, &path), ContentHash::of(text.as_bytes()));
        assert_eq!(hash(&Hashes::look(&place).by(later_ns), &path), ContentHash::of(text.as_bytes()));
    }
}

#[test]
fn a_run_sees_changes_dated_before_it_and_after_it() {
    let dir = tempfile::tempdir().unwrap();
    let (out, diary) = (dir.path().join("out"), Diary::default());
    let path = dir.path().join("x.txt");
    let tasks = [toy("a", 1, vec![given(dir.path(), "x.txt")], &diary)];
    let hour = Duration::from_secs(3600);
    fs::write(&path, "0").unwrap();
    run_on(&tasks, &out);
    let first = fs::metadata(&path).unwrap().modified().unwrap();
    for (text, at) in
        [("1", first), ("2", first - hour), ("3", first + hour), ("4", first), ("5", SystemTime::UNIX_EPOCH)]
    {
        fs::write(&path, text).unwrap();
        date(&path, at);
        assert_eq!(outcomes(&run_on(&tasks, &out)), ["done"], "dated {at:?}");
        assert_eq!(outcomes(&run_on(&tasks, &out)), ["kept"]);
        // A new date, the same bytes: nothing to do.
        date(&path, at + hour);
        assert_eq!(outcomes(&run_on(&tasks, &out)), ["kept"]);
    }
}
