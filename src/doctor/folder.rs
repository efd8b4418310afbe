//! Whether a folder takes results: files written, renamed over others, locked; how much room there is.

use std::fs::{self, File, TryLockError};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use super::machine::gib;
use super::{Check, clock};

/// Less is soon full, bytes.
const LITTLE: u64 = 1 << 30;

/// Tries the folder that results are to go to, or the one that it would be made in.
pub(super) fn examine(out: &Path) -> Vec<Check> {
    let at = standing(out);
    let shown = at.display();
    let trial = match tempfile::Builder::new().prefix(".lunula-").tempdir_in(&at) {
        Ok(trial) => trial,
        Err(why) => return vec![cannot("results", &at, &why)],
    };
    let mut checks = match renamed(trial.path()) {
        Ok(()) => vec![Check::good("results", format!("{shown} can be written to"))],
        Err(why) => return vec![cannot("results", &at, &why)],
    };
    checks.push(match locked(trial.path()) {
        Ok(true) => Check::good("locks", "keep two runs apart"),
        Ok(false) => Check::bad(
            "locks",
            format!("{shown}: a lock that is held was given a second time"),
            "never run two pipelines into this folder at once, or choose one on a local disk",
        ),
        Err(why) => Check::bad(
            "locks",
            format!("{shown}: {why}"),
            "choose a folder on a local disk, or have the server lock files",
        ),
    });
    checks.push(room(&at));
    checks.extend(letters(trial.path()));
    let stamp = fs::metadata(trial.path().join(RESULT)).and_then(|data| data.modified());
    checks.extend(stamp.ok().and_then(|modified| clock::of_folder(modified, SystemTime::now())));
    checks
}

/// Tries the folder for temporary files.
pub(super) fn temporary() -> Vec<Check> {
    let at = std::env::temp_dir();
    vec![match tempfile::tempdir_in(&at).and_then(|trial| renamed(trial.path())) {
        Ok(()) => Check::good("temporary files", format!("{} can be written to", at.display())),
        Err(why) => Check::bad(
            "temporary files",
            format!("{}: {why}", at.display()),
            "set TMPDIR to a folder that can be written to",
        ),
    }]
}

const RESULT: &str = "result";

/// The nearest folder above that stands.
fn standing(out: &Path) -> PathBuf {
    let whole = std::path::absolute(out).unwrap_or_else(|_| out.to_owned());
    whole.ancestors().find(|folder| folder.exists()).map_or_else(|| PathBuf::from("/"), Path::to_owned)
}

fn cannot(what: &str, at: &Path, why: &io::Error) -> Check {
    Check::bad(what, format!("{}: {why}", at.display()), "choose another --out, or make room and permission for it")
}

/// Writes a file and renames it over another, as results are.
fn renamed(folder: &Path) -> io::Result<()> {
    let place = folder.join(RESULT);
    fs::write(&place, "before")?;
    let beside = folder.join("beside");
    let mut file = File::create(&beside)?;
    file.write_all(b"after")?;
    file.sync_all()?;
    fs::rename(&beside, &place)?;
    if fs::read(&place)? == b"after" {
        Ok(())
    } else {
        Err(io::Error::other("a renamed file does not hold what was written"))
    }
}

/// Whether a lock keeps another out, and lets it in when it is given back.
fn locked(folder: &Path) -> io::Result<bool> {
    let path = folder.join("lock");
    let (first, second) = (File::create(&path)?, File::create(&path)?);
    first.lock()?;
    match second.try_lock() {
        Ok(()) => return Ok(false),
        Err(TryLockError::WouldBlock) => {}
        Err(TryLockError::Error(why)) => return Err(why),
    }
    first.unlock()?;
    second.lock()?;
    Ok(true)
}

fn room(at: &Path) -> Check {
    const REMEDY: &str = "make room, or choose another --out";
    match rustix::fs::statvfs(at) {
        Err(why) => Check::note("room", format!("not known ({why})"), REMEDY),
        Ok(disk) => {
            let free = disk.f_bavail.saturating_mul(disk.f_frsize);
            let found = format!("{} free", gib(free));
            if free < LITTLE { Check::note("room", found, REMEDY) } else { Check::good("room", found) }
        }
    }
}

/// Subjects `s1` and `S1` are two; to some file systems they are one.
fn letters(folder: &Path) -> Option<Check> {
    fs::write(folder.join("s1"), "").ok()?;
    folder.join("S1").exists().then(|| {
        let remedy = "name no two subjects alike but for capital letters";
        Check::note("capital letters", "files s1 and S1 are the same here", remedy)
    })
}

#[cfg(test)]
mod tests {
    use super::super::State;
    use super::*;

    #[test]
    fn a_folder_that_can_be_written_to_is_good_and_left_as_it_was() {
        let folder = tempfile::tempdir().unwrap();
        let checks = examine(&folder.path().join("not/yet/there"));
        let of = |what: &str| checks.iter().find(|check| check.what == what).map(|check| check.state);
        assert_eq!(of("results"), Some(State::Good), "{checks:?}");
        assert_eq!(of("locks"), Some(State::Good), "{checks:?}");
        assert!(of("room").is_some());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn a_file_in_the_place_of_a_folder_is_bad() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        fs::write(&file, "").unwrap();
        let checks = examine(&file.join("out"));
        assert_eq!(checks.len(), 1);
        assert_eq!(checks[0].state, State::Bad);
        assert!(checks[0].found.contains("file"), "{checks:?}");
    }
}
