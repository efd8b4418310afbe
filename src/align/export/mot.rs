//! Joint angles as an OpenSim motion file (`.mot`): a coordinate a joint, degrees, a row a frame, on the log's clock.
//!
//! A frame in which an angle is missing is left out. OpenSim has two readers: its tables take `NaN` for missing, but
//! its older `Storage` (4.6, which motions are loaded with) stops at the first `NaN`, reads 0 for it and drops all
//! later rows without a word. OpenSim's labels have no spaces: one in a joint's name becomes `_`.

use std::fmt::Write as _;
use std::path::Path;

use super::{ANGLE_DECIMALS, ExportError, TIME_DECIMALS, fixed, write};
use crate::align::{Posture, Tie};

/// Writes the angles that are to stand at `path` into the file `at`; returns how many frames are left out.
///
/// # Errors
/// Two joints of one name once their spaces are gone, no frame with all angles, or a file that can't be written.
pub(crate) fn mot(at: &Path, path: &Path, posture: &Posture, tie: &Tie) -> Result<usize, ExportError> {
    let labels: Vec<String> =
        posture.joints.iter().map(|j| j.split_whitespace().collect::<Vec<_>>().join("_")).collect();
    if let Some((k, label)) = labels.iter().enumerate().find(|(k, label)| labels[..*k].contains(label)) {
        let what = format!("`{}` would be the second column named `{label}`; rename the joint", posture.joints[k]);
        return Err(ExportError::Unfit { path: path.to_owned(), what });
    }
    let whole = |frame: &usize| posture.angles_deg.iter().all(|angles| angles[*frame].is_finite());
    let frames: Vec<usize> = (0..posture.time_s.len()).filter(whole).collect();
    if frames.is_empty() {
        let what =
            "no frame has the angles of all joints, and OpenSim has no place for missing ones; leave this export out";
        return Err(ExportError::Unfit { path: path.to_owned(), what: what.to_owned() });
    }
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    let (rows, columns) = (frames.len(), labels.len() + 1);
    let mut text = format!("{name}\nversion=1\nnRows={rows}\nnColumns={columns}\ninDegrees=yes\n\nendheader\ntime");
    for label in &labels {
        text.push('\t');
        text.push_str(label);
    }
    text.push('\n');
    for &frame in &frames {
        text.push_str(&fixed(tie.timebase.other_s(posture.time_s[frame]), TIME_DECIMALS, ""));
        for angles in &posture.angles_deg {
            // A String takes all that is written.
            let _ = write!(text, "\t{}", fixed(angles[frame], ANGLE_DECIMALS, ""));
        }
        text.push('\n');
    }
    write(at, path, &text)?;
    Ok(posture.time_s.len() - frames.len())
}
