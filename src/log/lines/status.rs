//! What align writes into `sensor_status`: `ok`, `saturated: P1, P3`, `no ambient: P2`, `no ambient` (of all), several
//! joined by `; `; and into `label_status`: `ok`, `before the video`, `after the video`, `gap: J1 J3`.

use std::collections::HashSet;

/// What a status means for the photodiodes in use.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// Nothing is wrong with any in use.
    Sound,
    /// One in use is saturated or without ambient light.
    Fault,
    /// It says something else.
    Unknown,
}

/// Reads statuses; neighbouring rows mostly have the same one, which is read once.
#[derive(Debug)]
pub(crate) struct Statuses {
    inputs: HashSet<String>,
    last: (Vec<u8>, Verdict),
}

impl Statuses {
    /// For the photodiodes in use.
    pub(crate) fn new(inputs: &[String]) -> Self {
        Self { inputs: inputs.iter().cloned().collect(), last: (Vec::new(), Verdict::Sound) }
    }

    /// What a status means.
    pub(crate) fn read(&mut self, status: &str) -> Verdict {
        self.read_bytes(status.as_bytes())
    }

    /// The same of text as it came.
    pub(crate) fn read_bytes(&mut self, status: &[u8]) -> Verdict {
        if self.last.0 != status {
            self.last.0.clear();
            self.last.0.extend_from_slice(status);
            self.last.1 = self.verdict(&String::from_utf8_lossy(status));
        }
        self.last.1
    }

    fn verdict(&self, status: &str) -> Verdict {
        let mut all = Verdict::Sound;
        for part in status.split(';').map(str::trim).filter(|part| !part.is_empty() && *part != "ok") {
            let (what, whose) = part.split_once(':').map_or((part, None), |(what, whose)| (what.trim(), Some(whose)));
            if !matches!(what, "saturated" | "no ambient") {
                all = if all == Verdict::Fault { all } else { Verdict::Unknown };
            } else if whose.is_none_or(|whose| whose.split(',').any(|p| self.inputs.contains(p.trim()))) {
                all = Verdict::Fault;
            }
        }
        all
    }
}

/// Rows whose status says something else.
#[derive(Debug, Default)]
pub(crate) struct Unknown {
    rows: usize,
    first: String,
}

impl Unknown {
    pub(crate) fn add(&mut self, status: &str) {
        if self.rows == 0 {
            status.clone_into(&mut self.first);
        }
        self.rows += 1;
    }

    /// What whoever uses the rows should know.
    pub(crate) fn warning(&self) -> Option<String> {
        let Self { rows, first } = self;
        (*rows > 0).then(|| {
            format!(
                "`sensor_status` says something that lunula does not know in {rows} rows, first `{first}`; they are \
                 used"
            )
        })
    }
}

/// Takes photodiodes' values away in the rows whose status, of which `each` says row and text, warns of them; in how
/// many rows of each.
pub(crate) fn without_faults<E>(
    photodiodes: Vec<(&str, &mut [f64])>,
    each: impl FnOnce(&mut dyn FnMut(usize, &str)) -> Result<(), E>,
) -> Result<(Vec<usize>, Unknown), E> {
    let mut unknown = Unknown::default();
    let of = |(name, values)| (Statuses::new(&[str::to_owned(name)]), values, 0);
    let mut all: Vec<(Statuses, &mut [f64], usize)> = photodiodes.into_iter().map(of).collect();
    each(&mut |row, status| {
        let mut is_known = true;
        for (statuses, values, faults) in &mut all {
            let verdict = statuses.read(status);
            is_known &= verdict != Verdict::Unknown;
            if verdict == Verdict::Fault {
                values[row] = f64::NAN;
                *faults += 1;
            }
        }
        if !is_known {
            unknown.add(status);
        }
    })?;
    Ok((all.into_iter().map(|(.., faults)| faults).collect(), unknown))
}

/// Whether a `label_status` says that the row lies within the video.
pub(crate) fn is_filmed(status: &str) -> bool {
    !matches!(status, "before the video" | "after the video")
}

/// Whether a `label_status` says that the row has no angle of a joint.
pub(crate) fn lacks_label(status: &str, joint: &str) -> bool {
    let in_gap = || status.strip_prefix("gap:").is_some_and(|joints| joints.split_whitespace().any(|one| one == joint));
    !is_filmed(status) || in_gap()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_label_status_names_the_joints_that_have_no_angle() {
        for status in ["before the video", "after the video", "gap: J1 J2", "gap: J2"] {
            assert!(lacks_label(status, "J2"), "{status}");
        }
        for status in ["ok", "", "gap: J1 J3", "gap:", "J2 is there"] {
            assert!(!lacks_label(status, "J2"), "{status}");
        }
    }

    #[test]
    fn a_status_counts_for_the_photodiodes_in_use() {
        let inputs = ["P1", "P12"].map(str::to_owned);
        let mut statuses = Statuses::new(&inputs);
        for (status, verdict) in [
            ("ok", Verdict::Sound),
            ("", Verdict::Sound),
            ("saturated: P2", Verdict::Sound),
            ("saturated: P2, P12", Verdict::Fault),
            ("saturated: P2; no ambient: P1", Verdict::Fault),
            ("no ambient", Verdict::Fault),
            ("no ambient", Verdict::Fault),
            ("loose", Verdict::Unknown),
            ("loose; saturated: P1", Verdict::Fault),
            ("saturated: P1; loose", Verdict::Fault),
        ] {
            assert_eq!(statuses.read(status), verdict, "{status}");
        }
    }
}
