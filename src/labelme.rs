//! LabelMe files: the polygons, lines and points that a person drew on one picture.
//!
//! In and out: one JSON file per picture, as LabelMe 5 reads and writes it. Reading is tolerant (everything that a
//! hand-written file leaves out has a default) and keeps what it does not know in `other`, so that a file read and
//! written again loses nothing.
//!
//! Conventions: LabelMe's points have their origin at the picture's corner, so the centre of the top-left pixel is at
//! (0.5, 0.5); [`to_labelme`] and [`from_labelme`] go between them and this project's pixels (whose centres are whole
//! numbers). Width and height are those of the picture that the person saw, in pixels; whether that was the upright one
//! is for the caller to find out.
//!
//! Source: LabelMe 5.5.0, `labelme/label_file.py`.

use std::{
    io::{self, Read as _},
    path::{Path, PathBuf},
};

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use thiserror::Error;

/// The version written into new files.
pub const VERSION: &str = "5.5.0";

/// Bytes of a file that are read: a photograph of 50 megapixels as PNG within it, and many outlines (assumed).
const MOST_BYTES: u64 = 128 << 20;

/// Why a LabelMe file could not be read or written.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum Error {
    #[error("{}: {source}", path.display())]
    Read { path: PathBuf, source: io::Error },
    #[error("{}: cannot be written: {source}", path.display())]
    Write { path: PathBuf, source: io::Error },
    /// The file is longer than any annotation.
    #[error(
        "{}: has over {} MiB, more than is read of an annotation; save it without the picture in it (imageData null)",
        path.display(), MOST_BYTES >> 20
    )]
    TooLong { path: PathBuf },
    #[error("{}: not a LabelMe file: {source}; open it in LabelMe and save it again", path.display())]
    Parse {
        path: PathBuf,
        /// Where in the file, and what is wrong.
        source: serde_json::Error,
    },
}

/// One LabelMe file.
///
/// ```
/// use std::path::Path;
///
/// use lunula::labelme::LabelMe;
///
/// let file = LabelMe::read(Path::new("fixtures/photos/extension/s01.json"))?;
/// let labels: Vec<&str> = file.shapes.iter().map(|shape| shape.label.as_str()).collect();
/// assert_eq!(labels, ["nail", "axis"]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct LabelMe {
    /// LabelMe's version that wrote the file.
    #[serde(default)]
    pub version: String,
    /// Flags of the whole picture.
    #[serde(default)]
    pub flags: Map<String, Value>,
    /// What was drawn.
    #[serde(default)]
    pub shapes: Vec<Shape>,
    /// The picture's path, relative to the JSON file.
    #[serde(default)]
    pub image_path: String,
    /// The picture itself, base64, or null.
    #[serde(default)]
    pub image_data: Option<String>,
    /// The picture's height in pixels.
    #[serde(default)]
    pub image_height: Option<u32>,
    /// The picture's width in pixels.
    #[serde(default)]
    pub image_width: Option<u32>,
    /// Whatever else the file holds.
    #[serde(flatten)]
    pub other: Map<String, Value>,
}

/// One thing drawn on the picture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Shape {
    /// What it is, in the person's own word.
    #[serde(default)]
    pub label: String,
    /// Its points `[x, y]` in pixels from the picture's corner.
    #[serde(default)]
    pub points: Vec<[f64; 2]>,
    /// A number shared by the shapes that belong together.
    #[serde(default)]
    pub group_id: Option<i64>,
    /// A remark.
    #[serde(default)]
    pub description: Option<String>,
    /// `polygon`, `line`, `rectangle`, ... (`polygon` where the file is silent, as in LabelMe).
    #[serde(default = "polygon")]
    pub shape_type: String,
    /// Flags of this shape.
    #[serde(default)]
    pub flags: Option<Map<String, Value>>,
    /// Whatever else the shape holds.
    #[serde(flatten)]
    pub other: Map<String, Value>,
}

fn polygon() -> String {
    "polygon".to_owned()
}

impl Shape {
    /// A shape of type `shape_type` without group, remark or flags.
    pub fn new(label: &str, shape_type: &str, points: Vec<[f64; 2]>) -> Self {
        Self {
            label: label.to_owned(),
            points,
            group_id: None,
            description: Some(String::new()),
            shape_type: shape_type.to_owned(),
            flags: Some(Map::new()),
            other: Map::new(),
        }
    }
}

impl LabelMe {
    /// A file for the picture `image_path` (relative to the file) of the size given in pixels.
    pub fn new(image_path: &str, width: u32, height: u32, shapes: Vec<Shape>) -> Self {
        Self {
            version: VERSION.to_owned(),
            flags: Map::new(),
            shapes,
            image_path: image_path.to_owned(),
            image_data: None,
            image_height: Some(height),
            image_width: Some(width),
            other: Map::new(),
        }
    }

    /// Width and height of the picture that it was drawn on, pixels, where the file says so.
    #[must_use]
    pub fn size(&self) -> Option<[u32; 2]> {
        self.image_width.zip(self.image_height).map(|(width, height)| [width, height])
    }

    /// The program whose annotations these are, where they are those of another one that is known.
    #[must_use]
    pub fn other_program(&self) -> Option<&'static str> {
        let has = |key: &str| self.other.contains_key(key);
        // Of several pictures a file of VIA has an entry each.
        let mut entries = self.other.values().chain(self.other.get("_via_img_metadata")).filter_map(Value::as_object);
        match () {
            () if !self.shapes.is_empty() => None,
            () if has("images") && has("annotations") => Some("COCO"),
            () if has("regions") || has("_via_img_metadata") || entries.any(|one| one.contains_key("regions")) => {
                Some("VIA")
            }
            () if has("objects") && has("size") => Some("Supervisely"),
            () => None,
        }
    }

    /// Reads one file.
    ///
    /// # Errors
    /// [`Error::Read`], [`Error::TooLong`] and [`Error::Parse`].
    pub fn read(path: &Path) -> Result<Self, Error> {
        Self::parse(path, &Self::bytes(path)?)
    }

    /// The bytes of one file.
    pub(crate) fn bytes(path: &Path) -> Result<Vec<u8>, Error> {
        let refused = |source: io::Error| Error::Read { path: path.to_owned(), source };
        let mut bytes = Vec::new();
        crate::input::open(path).map_err(refused)?.take(MOST_BYTES + 1).read_to_end(&mut bytes).map_err(refused)?;
        if bytes.len() as u64 > MOST_BYTES {
            return Err(Error::TooLong { path: path.to_owned() });
        }
        Ok(bytes)
    }

    /// What the bytes of the file at `path` say.
    pub(crate) fn parse(path: &Path, bytes: &[u8]) -> Result<Self, Error> {
        let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        serde_json::from_slice(text).map_err(|source| Error::Parse { path: path.to_owned(), source })
    }

    /// Writes one file.
    ///
    /// # Errors
    /// [`Error::Write`].
    pub fn write(&self, path: &Path) -> Result<(), Error> {
        let refused = |source: io::Error| Error::Write { path: path.to_owned(), source };
        std::fs::write(path, self.to_text().map_err(|e| refused(e.into()))?).map_err(refused)
    }

    /// The file's text.
    ///
    /// # Errors
    /// Where it can't be said in JSON.
    pub fn to_text(&self) -> serde_json::Result<Vec<u8>> {
        let mut text = serde_json::to_vec_pretty(self)?;
        text.push(b'\n');
        Ok(text)
    }
}

/// A point in pixels (centre of the top-left pixel at 0, 0) to LabelMe's (that centre at 0.5, 0.5).
pub fn to_labelme(point: [f64; 2]) -> [f64; 2] {
    point.map(|v| v + 0.5)
}

/// A LabelMe point (centre of the top-left pixel at 0.5, 0.5) to pixels (that centre at 0, 0).
pub fn from_labelme(point: [f64; 2]) -> [f64; 2] {
    point.map(|v| v - 0.5)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn read_and_written_again_loses_nothing() {
        let text = r#"{"version":"5.4.1","flags":{"good":true},"shapes":[{"label":"nail",
            "points":[[1.5,2.25],[3.0,4.0],[5.0,2.0]],
            "group_id":3,"description":"left","shape_type":"polygon","flags":{},"mask":null}],
            "imagePath":"s01.png","imageData":null,"imageHeight":480,"imageWidth":640,"lineColor":[0,255,0,128]}"#;
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("s01.json");
        std::fs::write(&path, text).unwrap();
        let read = LabelMe::read(&path).unwrap();
        assert_eq!(read.shapes[0].group_id, Some(3));
        assert_eq!((read.image_width, read.image_height), (Some(640), Some(480)));
        read.write(&path).unwrap();
        let written: Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
        assert_eq!(written, serde_json::from_str::<Value>(text).unwrap());
    }

    #[test]
    fn annotations_of_other_programs_are_known() {
        let of = |text: &str| LabelMe::parse(Path::new("a.json"), text.as_bytes()).unwrap().other_program();
        assert_eq!(of(r#"{"images":[{"id":1,"file_name":"s01.png"}],"annotations":[],"categories":[]}"#), Some("COCO"));
        let via = r#"{"filename":"s01.png","size":9,"regions":[]}"#;
        assert_eq!([of(via), of(&format!(r#"{{"s01.png9":{via}}}"#))], [Some("VIA"); 2]);
        assert_eq!(of(&format!(r#"{{"_via_settings":{{}},"_via_img_metadata":{{"s01.png9":{via}}}}}"#)), Some("VIA"));
        assert_eq!(of(r#"{"size":{"height":9,"width":9},"objects":[]}"#), Some("Supervisely"));
        assert_eq!([of("{}"), of(r#"{"shapes":[],"images":3}"#), of(r#"{"a":{"b":1}}"#)], [None; 3]);
        assert_eq!(of(r#"{"shapes":[{"label":"nail"}],"images":[],"annotations":[]}"#), None);
    }

    #[test]
    fn what_is_left_out_has_a_default() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.json");
        std::fs::write(&path, "\u{feff}{\"shapes\":[{\"label\":\"nail\",\"points\":[[0,0],[1,0],[0,1]]}]}").unwrap();
        let read = LabelMe::read(&path).unwrap();
        assert_eq!(read.shapes[0].shape_type, "polygon");
        assert_eq!(read.image_width, None);
        assert_eq!(read.image_data, None);
    }

    #[test]
    fn a_file_longer_than_any_annotation_is_not_read() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("long.json");
        std::fs::File::create(&path).unwrap().set_len(20 << 30).unwrap();
        let error = LabelMe::read(&path).unwrap_err().to_string();
        assert!(error.contains("long.json") && error.contains("128 MiB"), "{error}");
        if cfg!(target_os = "linux") {
            assert!(matches!(LabelMe::read(Path::new("/dev/zero")), Err(Error::Read { .. })));
        }
    }

    #[test]
    fn a_broken_file_is_named() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("broken.json");
        std::fs::write(&path, "{\"shapes\":[").unwrap();
        let error = LabelMe::read(&path).unwrap_err().to_string();
        assert!(error.contains("broken.json") && error.contains("line 1"), "{error}");
    }

    #[test]
    fn labelme_points_lie_half_a_pixel_further() {
        assert_eq!(to_labelme([0.0, 0.0]), [0.5, 0.5]);
        assert_eq!(from_labelme(to_labelme([2.25, -1.0])), [2.25, -1.0]);
    }
}
