//! Results that are whole go to their places together; what others wrote into the same folder stays.

use std::path::{Path, PathBuf};
use std::{fs, io};

/// Synthetic photographs, whose `truth` is a folder of theirs alone.
pub(super) const PHOTOS_RECORD: &str = "truth/phantom.json";

/// What stands under `out`, is one of `names`, and was not written by whoever writes `record`; or belongs to photographs.
pub(super) fn in_the_way(out: &Path, names: &[&str], record: &str) -> Option<PathBuf> {
    let photographs = Some(out.join(PHOTOS_RECORD)).filter(|place| record != PHOTOS_RECORD && place.exists());
    let stands = || names.iter().map(|name| out.join(name)).find(|place| place.exists());
    photographs.or_else(|| if out.join(record).is_file() { None } else { stands() })
}

/// Moves `names` from `stage` to `out`; what stood there goes into `stage`, to be deleted with it, or back where a move fails. A name
/// that `stage` does not have is taken away from `out`.
///
/// # Errors
/// The place that could not be written, and what the system says.
pub(super) fn put_in_place(stage: &Path, out: &Path, names: &[&str]) -> Result<(), (PathBuf, io::Error)> {
    let mut moves = Vec::new();
    let mut made = Vec::new();
    for (k, name) in names.iter().enumerate() {
        let place = out.join(name);
        if place.exists() {
            moves.push((place.clone(), stage.join(format!("old-{k}"))));
        }
        if stage.join(name).exists() {
            if let Some(folder) = place.parent().filter(|folder| !folder.exists()) {
                fs::create_dir_all(folder).map_err(|source| (folder.to_owned(), source))?;
                made.push(folder.to_owned());
            }
            moves.push((stage.join(name), place));
        }
    }
    for (k, (from, to)) in moves.iter().enumerate() {
        if let Err(source) = fs::rename(from, to) {
            for (from, to) in moves[..k].iter().rev() {
                fs::rename(to, from).map_err(|source| (from.clone(), source))?;
            }
            for folder in made.iter().rev() {
                // Best effort: only an empty folder can be left.
                let _ = fs::remove_dir(folder);
            }
            return Err((to.clone(), source));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_own_files_are_replaced_and_what_is_no_longer_made_goes() {
        let dir = tempfile::tempdir().unwrap();
        let (out, stage) = (dir.path().join("out"), dir.path().join("stage"));
        for (file, text) in [("out/truth/other", "other"), ("out/truth/a", "old"), ("out/truth/b", "old")] {
            let path = dir.path().join(file);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        fs::create_dir_all(stage.join("truth")).unwrap();
        fs::create_dir_all(stage.join("deep")).unwrap();
        fs::write(stage.join("truth/a"), "new").unwrap();
        fs::write(stage.join("deep/c"), "new").unwrap();
        let names = ["truth/a", "truth/b", "deep/c"];
        assert_eq!(in_the_way(&out, &names, "truth/record"), Some(out.join("truth/a")));
        assert_eq!(in_the_way(&out, &names, "truth/a"), None);
        put_in_place(&stage, &out, &names).unwrap();
        let read = |name: &str| fs::read_to_string(out.join(name)).ok();
        assert_eq!(
            (read("truth/a").as_deref(), read("truth/b"), read("deep/c").as_deref()),
            (Some("new"), None, Some("new"))
        );
        assert_eq!(read("truth/other").as_deref(), Some("other"));
    }

    #[test]
    fn where_a_move_fails_all_is_as_it_was() {
        let dir = tempfile::tempdir().unwrap();
        let (out, stage) = (dir.path().join("out"), dir.path().join("stage"));
        fs::create_dir_all(out.join("folder/full")).unwrap();
        fs::create_dir_all(&stage).unwrap();
        fs::write(out.join("a"), "old").unwrap();
        fs::write(stage.join("a"), "new").unwrap();
        fs::write(stage.join("folder"), "new").unwrap();
        // The place to which the standing folder would go is taken by one with something in it.
        fs::create_dir_all(stage.join("old-1/taken")).unwrap();
        let failed = put_in_place(&stage, &out, &["a", "folder"]).unwrap_err();
        assert_eq!(failed.0, stage.join("old-1"));
        assert_eq!(fs::read_to_string(out.join("a")).unwrap(), "old");
        assert!(out.join("folder/full").is_dir());
    }
}
