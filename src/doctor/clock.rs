//! The machine's clock. Nothing of a result hangs on it; records of a run tell its times.

use std::path::Path;
use std::time::{Duration, SystemTime};

use super::Check;

/// A file's time may be so much later than now: clocks of two machines are a little apart.
const APART: Duration = Duration::from_secs(5);
const REMEDY: &str = "set the clock (`timedatectl set-ntp true`); records of runs would tell wrong times";

/// Whether it is now later than when this program was written, as it should be.
pub(super) fn examine(program: &Path) -> Option<Check> {
    let written = std::fs::metadata(program).and_then(|data| data.modified()).ok()?;
    Some(after(written, SystemTime::now()))
}

fn after(written: SystemTime, now: SystemTime) -> Check {
    match written.duration_since(now) {
        Ok(late) if late > APART => {
            let found = format!("{:.0} s before this program was written: it was set back", late.as_secs_f64());
            Check::note("clock", found, REMEDY)
        }
        _ => Check::good("clock", "later than when this program was written"),
    }
}

/// Whether a file written `now` bears that time: a server's clock may be another.
pub(super) fn of_folder(modified: SystemTime, now: SystemTime) -> Option<Check> {
    let (apart, which) = match modified.duration_since(now) {
        Ok(apart) => (apart, "after"),
        Err(before) => (before.duration(), "before"),
    };
    let found = || format!("files written here bear a time {:.1} s {which} this machine's clock", apart.as_secs_f64());
    (apart > APART).then(|| Check::note("its clock", found(), "set the clocks of this machine and of the file server"))
}

#[cfg(test)]
mod tests {
    use super::super::State;
    use super::*;

    #[test]
    fn a_clock_set_back_is_noted() {
        let now = SystemTime::now();
        assert_eq!(after(now - Duration::from_secs(1000), now).state, State::Good);
        assert_eq!(after(now + Duration::from_secs(3), now).state, State::Good);
        let back = after(now + Duration::from_secs(1000), now);
        assert_eq!(back.state, State::Note);
        assert!(back.found.starts_with("1000 s before"), "{}", back.found);
    }

    #[test]
    fn a_server_s_clock_that_is_apart_is_noted() {
        let now = SystemTime::now();
        assert_eq!(of_folder(now, now), None);
        assert!(of_folder(now + Duration::from_secs(60), now).unwrap().found.contains("60.0 s after"));
        assert!(of_folder(now - Duration::from_secs(60), now).unwrap().found.contains("60.0 s before"));
    }
}
