//! The marker file: which markers, segments and joints, and what is known of the camera.
//!
//! In: a TOML file; out: a [`Layout`], in which every name has become an index and every fault of the file has been
//! reported at once, each with its line. Order is the file's: joints make columns in the order of `[joints]`.
//!
//! `[start]`, `[clock]` and `[camera]` speak of the *shown* (upright) picture, as a person or OpenCV sees it. Flexion
//! is clockwise where the file does not say; the layout's notes tell.
//!
//! Source: thesis section 3.2.3, two markers on each segment of the finger.

mod check;
mod raw;

use std::path::{Path, PathBuf};

use crate::clock::Clock;
use crate::flexion::Flexion;
use crate::toml_file::{self, Fault};

/// A sticker or a dot of paint.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Marker {
    /// Its name.
    pub name: String,
    /// Its colour, sRGB.
    pub colour: [u8; 3],
}

/// What markers are taken for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MarkerShape {
    /// Discs, whose centre a fit finds.
    Disc,
    /// Blots of any outline, whose centre is their outline's centroid.
    Blot,
}

impl MarkerShape {
    /// Its name in marker files and reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Disc => "disc",
            Self::Blot => "blot",
        }
    }
}

/// Two markers on one part of the finger.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Segment {
    /// Its name.
    pub name: String,
    /// Which markers, proximal first.
    pub markers: [usize; 2],
}

/// The angle between two segments.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Its name, such as `J2`.
    pub name: String,
    /// Which segments, proximal first.
    pub segments: [usize; 2],
    /// The angle read when the finger is straight, which is subtracted.
    pub zero_rad: f64,
}

/// The lens, in OpenCV's parameters, for the shown picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Camera {
    /// Columns and rows of the pictures that it was measured on; any where that is not given.
    pub size_px: Option<[usize; 2]>,
    /// Focal length in widths of a pixel.
    pub fx_px: f64,
    /// Focal length in heights of a pixel; the same length as `fx_px` where it is not given.
    pub fy_px: Option<f64>,
    /// Column of the optical axis; the picture's middle where it is not given.
    pub cx_px: Option<f64>,
    /// Row of the optical axis; the picture's middle where it is not given.
    pub cy_px: Option<f64>,
    /// k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4; zero where they are not given.
    pub distortion: [f64; 12],
    /// The normal of the plane in which the finger moves, of length 1, towards the camera (right, down, forwards); the
    /// camera looks at it straight where it is not given.
    pub plane: Option<[f64; 3]>,
}

#[cfg(test)]
impl Camera {
    /// One of this focal length that looks straight through the picture's middle.
    pub(in crate::posture) fn of(fx_px: f64, distortion: &[f64]) -> Self {
        let mut all = [0.0; 12];
        all[..distortion.len()].copy_from_slice(distortion);
        Self { size_px: None, fx_px, fy_px: None, cx_px: None, cy_px: None, distortion: all, plane: None }
    }
}

/// A marker file, checked.
///
/// ```
/// use std::path::Path;
///
/// use lunula::posture::Layout;
///
/// let layout = Layout::read(Path::new("fixtures/finger/markers.toml"))?;
/// let joints: Vec<&str> = layout.joints.iter().map(|joint| joint.name.as_str()).collect();
/// assert_eq!(joints, ["J1", "J2", "J3"]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Layout {
    /// Which way flexion turns.
    pub flexion: Flexion,
    /// What all markers are; where the file does not say, each is a disc where a disc fits and a blot otherwise.
    pub shape: Option<MarkerShape>,
    /// All markers, in the file's order.
    pub markers: Vec<Marker>,
    /// All segments, in the file's order.
    pub segments: Vec<Segment>,
    /// The wanted joints, in the file's order.
    pub joints: Vec<Joint>,
    /// For each segment the one before it on the finger, by the file's joints, wanted or not.
    pub hung_on: Vec<Option<usize>>,
    /// For each marker, where it is in the first frame, on the shown picture, where the file says.
    pub start: Vec<Option<[f64; 2]>>,
    /// The clock in the picture.
    pub clock: Option<Clock>,
    /// The lens.
    pub camera: Option<Camera>,
    /// How long after a picture's first row its last is taken, seconds; 0 where all are taken at once.
    pub readout_s: f64,
    /// What is hardly meant so, each with its place.
    pub warnings: Vec<String>,
    /// What is no fault but worth saying, each with its place.
    pub notes: Vec<String>,
}

/// Why there is no layout.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum LayoutError {
    #[error(
        "{}: {why} (a marker file is TOML; `lunula posture VIDEO --suggest` writes one to start from)",
        path.display()
    )]
    Unreadable { path: PathBuf, why: std::io::Error },
    #[error(
        "{}",
        faults.iter().map(|f| format!("{}:{}: {}", path.display(), f.line, f.what)).collect::<Vec<_>>().join("\n")
    )]
    Faults {
        path: PathBuf,
        /// In the order of lines, at least one.
        faults: Vec<Fault>,
    },
    /// Joints were asked for that the file does not have.
    #[error("{what}")]
    NoSuchJoint { what: String },
}

impl Layout {
    /// Reads a marker file.
    ///
    /// # Errors
    /// Where it can't be read, or with all its faults.
    pub fn read(path: &Path) -> Result<Self, LayoutError> {
        let unreadable = |why| LayoutError::Unreadable { path: path.to_owned(), why };
        let text = toml_file::text(crate::input::read(path).map_err(unreadable)?);
        let faulty = |fault| LayoutError::Faults { path: path.to_owned(), faults: vec![fault] };
        Self::parse(&text.map_err(faulty)?, path)
    }

    /// Checks the text of a marker file; `path` is for the messages.
    ///
    /// # Errors
    /// With all its faults.
    pub fn parse(text: &str, path: &Path) -> Result<Self, LayoutError> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        check::check(text, path).map_err(|faults| LayoutError::Faults { path: path.to_owned(), faults })
    }

    /// Keeps only the joints that are named, in the file's order; all for an empty list.
    ///
    /// # Errors
    /// [`LayoutError::NoSuchJoint`].
    pub fn wanting(&self, joints: &[String]) -> Result<Self, LayoutError> {
        let known: Vec<&str> = self.joints.iter().map(|j| j.name.as_str()).collect();
        if let Some(name) = joints.iter().find(|name| !known.contains(&name.as_str())) {
            let what = if known.is_empty() {
                format!("joint `{name}` is asked for, but the marker file has no [joints]; add it there")
            } else {
                format!("no joint `{name}` in the marker file; {}", crate::words::instead(name, &known))
            };
            return Err(LayoutError::NoSuchJoint { what });
        }
        let mut kept = self.clone();
        kept.joints.retain(|j| joints.is_empty() || joints.contains(&j.name));
        Ok(kept)
    }

    /// For each marker, whether a wanted joint uses it; all are needed where there are no joints.
    #[must_use]
    pub fn needed(&self) -> Vec<bool> {
        let mut needed = vec![self.joints.is_empty(); self.markers.len()];
        for marker in self.joints.iter().flat_map(|j| self.markers_of(j)) {
            needed[marker] = true;
        }
        needed
    }

    /// The four markers of a joint (three differ where its segments share one): the proximal segment's, then the distal
    /// one's.
    #[must_use]
    pub fn markers_of(&self, joint: &Joint) -> [usize; 4] {
        let [a, b] = joint.segments.map(|s| self.segments[s].markers);
        [a[0], a[1], b[0], b[1]]
    }
}

#[cfg(test)]
mod tests;
