//! Joint angles as BIDS Motion (doi:10.1038/s41597-024-03559-8; specification 1.9 and later).
//!
//! `sub-<subject>/[ses-<session>/]motion/` gets `_motion.tsv` (no line of names, `n/a` where there is no angle),
//! `_channels.tsv` and `_motion.json`. Channels: `LATENCY`, each frame's time from the first frame, seconds; as `MISC`
//! the same on the log's clock; for each joint `JNTANG`, degrees, positive in flexion, and, where the table has it, its
//! standard error as `MISC`. Another recording of these names is not replaced: it takes a number of its own. In a new
//! folder `dataset_description.json`, `README` and `participants.tsv` are written too. In a dataset that stands they
//! are left as they are, but for a participant who is new: a row is added.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use serde_json::json;

use super::{ANGLE_DECIMALS, ExportError, TIME_DECIMALS, fixed};
use crate::align::{Posture, Tie};
use crate::files::{Places, json_text};
use crate::input;
use crate::median::median_of;

/// The names that BIDS files of a recording are made of, checked.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct BidsNames {
    subject: String,
    session: Option<String>,
    task: String,
    tracksys: String,
    run: Option<u32>,
}

impl BidsNames {
    /// Checks the names: letters and digits of ASCII; a subject is needed. `run` is the recording's number among those
    /// of the same names.
    pub(crate) fn new(
        subject: Option<&str>,
        session: Option<&str>,
        task: &str,
        tracksys: &str,
        run: Option<u32>,
    ) -> Result<Self, ExportError> {
        let checked = |entity, label: Option<&str>| match label {
            Some(label) if !label.is_empty() && label.bytes().all(|b| b.is_ascii_alphanumeric()) => {
                Ok(label.to_owned())
            }
            _ => Err(ExportError::Label { entity, label: label.map(str::to_owned) }),
        };
        Ok(Self {
            subject: checked("subject", subject)?,
            session: session.map(|label| checked("session", Some(label))).transpose()?,
            task: checked("task", Some(task))?,
            tracksys: checked("tracksys", Some(tracksys))?,
            run,
        })
    }

    /// The folder of the recording's files within the dataset.
    fn folder(&self) -> PathBuf {
        let mut folder = PathBuf::from(format!("sub-{}", self.subject));
        if let Some(session) = &self.session {
            folder.push(format!("ses-{session}"));
        }
        folder.join("motion")
    }

    /// What the names of the recording's files begin with.
    fn stem(&self) -> String {
        let session = self.session.as_ref().map_or(String::new(), |session| format!("_ses-{session}"));
        let run = self.run.map_or(String::new(), |run| format!("_run-{run}"));
        format!("sub-{}{session}_task-{}_tracksys-{}{run}", self.subject, self.task, self.tracksys)
    }
}

/// Writes the angles into the dataset that stands, or is to stand, in the folder `root`; returns the files' places.
///
/// # Errors
/// Fewer than two frames, which have no sampling frequency; another recording of these names; a `participants.tsv`
/// without `participant_id`; a file that can't be written.
pub(crate) fn bids(
    places: &mut Places,
    root: &Path,
    names: &BidsNames,
    posture: &Posture,
    tie: &Tie,
) -> Result<Vec<PathBuf>, ExportError> {
    let times_s: Vec<f64> = posture.time_s.iter().map(|&t| tie.timebase.other_s(t)).collect();
    let channels = Channels::of(posture);
    let mut files = Vec::new();
    // In a dataset that stands nothing may be written at its root.
    places.look_after(root);
    let stands = |name: &str| std::fs::symlink_metadata(root.join(name)).is_ok();
    if !stands("dataset_description.json") {
        files.push((root.join("dataset_description.json"), json_text(&description())));
    }
    if !["README", "README.md", "README.rst", "README.txt"].iter().any(|name| stands(name)) {
        files.push((root.join("README"), README.to_owned()));
    }
    if let Some(text) = participants(&root.join("participants.tsv"), &names.subject)? {
        files.push((root.join("participants.tsv"), text));
    }
    let file = |ending: &str| root.join(names.folder()).join(format!("{}_{ending}", names.stem()));
    let sidecar = sidecar(&file("motion.json"), names, &times_s, &channels)?;
    let (motion, rows) = (file("motion.tsv"), channels.rows(posture, &times_s));
    if input::read_text(&motion).is_ok_and(|standing| is_of_other_frames(&standing, &times_s)) {
        let what = "is of other frames: is it another recording of this subject, session and task? Then say --run 2 \
                    (or the next number); remove it where it is an older result of this one"
            .to_owned();
        return Err(ExportError::Unfit { path: motion, what });
    }
    files.push((file("motion.json"), json_text(&sidecar)));
    files.push((file("channels.tsv"), channels.table(posture)));
    files.push((motion, rows));
    for (path, text) in &files {
        places.write(path, text)?;
    }
    Ok(files.into_iter().map(|(path, _)| path).collect())
}

/// Whether a `motion.tsv` is of frames at other times, which may drift as clocks do: then it is another recording's.
fn is_of_other_frames(standing: &str, times_s: &[f64]) -> bool {
    let time = |line: &str| line.split('\t').next()?.parse().ok();
    let own: Vec<f64> = standing.lines().map(|line| time(line).unwrap_or(f64::NAN)).collect();
    let is_other = |(own_s, time_s): (&f64, &f64)| {
        let [own_s, time_s] = [own_s - own[0], time_s - times_s[0]];
        let off_s = (own_s - time_s).abs();
        off_s.is_nan() || off_s > 1e-3 + 2e-3 * time_s
    };
    own.len() != times_s.len() || own.iter().zip(times_s).any(is_other)
}

/// Which columns there are after the time: of each joint, whether its errors are known.
struct Channels {
    with_error: Vec<bool>,
}

impl Channels {
    fn of(posture: &Posture) -> Self {
        Self { with_error: posture.sds_deg.iter().map(|sds| sds.iter().any(|sd| sd.is_finite())).collect() }
    }

    fn errors(&self) -> usize {
        self.with_error.iter().filter(|&&with| with).count()
    }

    /// `channels.tsv`.
    fn table(&self, posture: &Posture) -> String {
        let mut text = "name\tcomponent\ttype\ttracked_point\tunits\tdescription\n\
                        time\tn/a\tLATENCY\tn/a\ts\tthe frame's time from the first frame\n\
                        log_time\tn/a\tMISC\tn/a\ts\tthe frame's time on the log's clock\n"
            .to_owned();
        for (joint, &with_error) in posture.joints.iter().map(|joint| plain(joint)).zip(&self.with_error) {
            // A String takes all that is written.
            let _ = writeln!(text, "{joint}\tn/a\tJNTANG\t{joint}\tdeg\tjoint angle, positive in flexion");
            if with_error {
                let _ = writeln!(text, "{joint}_sd\tn/a\tMISC\t{joint}\tdeg\tstandard error of the joint angle");
            }
        }
        text
    }

    /// `motion.tsv`.
    fn rows(&self, posture: &Posture, times_s: &[f64]) -> String {
        let mut text = String::new();
        for (frame, &time_s) in times_s.iter().enumerate() {
            text.push_str(&fixed(time_s - times_s[0], TIME_DECIMALS, "n/a"));
            text.push('\t');
            text.push_str(&fixed(time_s, TIME_DECIMALS, "n/a"));
            for (joint, &with_error) in self.with_error.iter().enumerate() {
                let error = with_error.then_some(posture.sds_deg[joint][frame]);
                for degrees in std::iter::once(posture.angles_deg[joint][frame]).chain(error) {
                    text.push('\t');
                    text.push_str(&fixed(degrees, ANGLE_DECIMALS, "n/a"));
                }
            }
            text.push('\n');
        }
        text
    }
}

/// A joint's name as a cell: tabs and line ends are spaces.
fn plain(name: &str) -> String {
    name.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// `motion.json`.
fn sidecar(
    path: &Path,
    names: &BidsNames,
    times_s: &[f64],
    channels: &Channels,
) -> Result<serde_json::Value, ExportError> {
    let median_s = median_of(times_s.windows(2).map(|pair| pair[1] - pair[0]));
    let (Some(&first_s), Some(&last_s), Some(median_s)) = (times_s.first(), times_s.last(), median_s) else {
        let what = "BIDS asks for a sampling frequency, and fewer than two frames have none; leave this export out";
        return Err(ExportError::Unfit { path: path.to_owned(), what: what.to_owned() });
    };
    let (joints, errors) = (channels.with_error.len(), channels.errors());
    // A thousandth of a hertz and a microsecond are enough.
    let rounded = |value: f64, of: f64| (value * of).round() / of;
    Ok(json!({
        "TaskName": names.task,
        "TrackingSystemName": "video of coloured markers",
        "SamplingFrequency": rounded(1.0 / median_s, 1e3),
        "SamplingFrequencyEffective": rounded((times_s.len() - 1) as f64 / (last_s - first_s), 1e3),
        "RecordingDuration": rounded(last_s - first_s, 1e6),
        "RecordingType": "continuous",
        "MissingValues": "n/a",
        "MotionChannelCount": 2 + joints + errors,
        "JNTANGChannelCount": joints,
        "LATENCYChannelCount": 1,
        "MISCChannelCount": 1 + errors,
        "ACCELChannelCount": 0,
        "ANGACCELChannelCount": 0,
        "GYROChannelCount": 0,
        "MAGNChannelCount": 0,
        "ORNTChannelCount": 0,
        "POSChannelCount": 0,
        "VELChannelCount": 0,
        "TrackedPointsCount": joints,
        "SoftwareVersions": format!("lunula {}", env!("CARGO_PKG_VERSION")),
    }))
}

/// `dataset_description.json` of a new dataset.
fn description() -> serde_json::Value {
    json!({
        "Name": "Joint angles of a filmed finger",
        "BIDSVersion": "1.11.1",
        "DatasetType": "raw",
        "GeneratedBy": [{ "Name": "lunula", "Version": env!("CARGO_PKG_VERSION") }],
    })
}

/// `README` of a new dataset.
const README: &str = "Joint angles of a finger, measured in videos of coloured markers by lunula.\n\
    \n\
    Each row of a *_motion.tsv is a frame of the video. The channel `time` is the frame's time from the first one, \
    `log_time` that \n\
    on the clock of the log that was recorded along with the video (photodiodes, forces), in seconds. Angles are in \
    degrees, \n\
    positive in flexion; n/a where a marker was not seen. Nothing is interpolated.\n";

/// `participants.tsv` with this subject; none where it stands so.
fn participants(path: &Path, subject: &str) -> Result<Option<String>, ExportError> {
    let unfit = |what: String| ExportError::Unfit { path: path.to_owned(), what };
    let own = format!("sub-{subject}");
    let standing = match input::read_text(path) {
        Ok(text) => text,
        Err(why) if why.kind() == std::io::ErrorKind::NotFound => {
            return Ok(Some(format!("participant_id\n{own}\n")));
        }
        Err(why) => return Err(unfit(format!("cannot be read ({why}); correct it or export to another folder"))),
    };
    let mut lines = standing.lines();
    let names: Vec<&str> = lines.next().unwrap_or_default().trim_start_matches('\u{feff}').split('\t').collect();
    let Some(column) = names.iter().position(|&name| name == "participant_id") else {
        return Err(unfit("has no column `participant_id`; add it or export to another folder".to_owned()));
    };
    if lines.any(|line| line.split('\t').nth(column) == Some(&own)) {
        return Ok(None);
    }
    let row: Vec<&str> = (0..names.len()).map(|k| if k == column { own.as_str() } else { "n/a" }).collect();
    let end = if standing.ends_with('\n') { "" } else { "\n" };
    Ok(Some(format!("{standing}{end}{}\n", row.join("\t"))))
}
