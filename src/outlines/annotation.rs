//! The LabelMe file of one photograph while its nails are corrected: read, changed shape by shape, saved whole.
//!
//! What is not a nail that was decided on stays as it was read: other shapes, other keys, the picture in it, the frame
//! that it was drawn in (upright or stored). A file that somebody else has changed since it was read is not written
//! over: from then on this photograph's outlines go into a file beside it, and both are kept.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use image::metadata::Orientation;
use sha2::{Digest as _, Sha256};

use super::shape::NailShape;
use crate::files::{WriteError, write_whole};
use crate::labelme::{LabelMe, Shape, to_labelme};
use crate::photo::Photograph;
use crate::photo::outline::{AXIS, NAIL, NOT_A_NAIL};
use crate::photograph::stored_from_upright;

/// The description of a shape that a person corrected here.
const CORRECTED: &str = "corrected with lunula edit";
/// How the descriptions of detected ones begin.
const DETECTED: &str = "detected by lunula";

/// The shapes of one nail in a file.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Shapes {
    pub(super) polygon: Option<usize>,
    pub(super) line: Option<usize>,
}

/// What a file is to say of a nail.
#[derive(Debug, Clone, Copy)]
pub(super) enum Says<'a> {
    /// That it is one: so, or with the corners that it has.
    Nail(&'a NailShape, bool),
    /// That it is none.
    NotANail,
    /// What it said when it was read.
    AsItWas,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Saved {
    pub(super) path: PathBuf,
    /// The file that somebody else has changed, and that stays as it is.
    pub(super) kept: Option<PathBuf>,
}

/// The file of one photograph.
#[derive(Debug)]
pub(super) struct Annotation {
    home: PathBuf,
    /// Of the bytes that are there, as far as is known; `None`: there is no file.
    known: Option<[u8; 32]>,
    /// There was none when the photograph was opened.
    is_new: bool,
    /// All but its shapes.
    file: LabelMe,
    /// A place is never another shape's.
    shapes: Vec<Option<Shape>>,
    read: Vec<Shape>,
    /// Polygons that a person has decided on.
    decided: BTreeSet<usize>,
    drawn: DrawnOn,
}

/// The picture that corners are told on.
#[derive(Debug, Clone, Copy)]
struct DrawnOn {
    stored: bool,
    orientation: Orientation,
    stored_size: [u32; 2],
}

impl DrawnOn {
    fn in_file(&self, point: [f64; 2]) -> [f64; 2] {
        let point = to_labelme(point);
        let point = if self.stored { stored_from_upright(self.orientation, self.stored_size, point) } else { point };
        point.map(|v| (100.0 * v).round() / 100.0)
    }
}

impl Annotation {
    /// What the file at `home` says, or is to say at first where there is none.
    pub(super) fn new(
        home: &Path,
        bytes: Option<&[u8]>,
        mut file: LabelMe,
        picture: &Photograph,
        stored: bool,
    ) -> Self {
        let read = std::mem::take(&mut file.shapes);
        let (orientation, stored_size) = (picture.orientation, picture.stored_size());
        Self {
            // A link stays one.
            home: home.canonicalize().unwrap_or_else(|_| home.to_owned()),
            known: bytes.map(digest),
            is_new: bytes.is_none(),
            file,
            shapes: read.iter().cloned().map(Some).collect(),
            read,
            decided: BTreeSet::new(),
            drawn: DrawnOn { stored, orientation, stored_size },
        }
    }

    /// Says something else of a nail, and saves the file.
    ///
    /// # Errors
    /// The file can't be written; then it, and what is known of it, are as before.
    pub(super) fn save(&mut self, shapes: &mut Shapes, says: Says<'_>) -> Result<Saved, WriteError> {
        let before = (self.shapes.clone(), self.decided.clone(), *shapes);
        self.say(shapes, says);
        let saved = self.write();
        if saved.is_err() {
            (self.shapes, self.decided, *shapes) = before;
        }
        saved
    }

    fn say(&mut self, shapes: &mut Shapes, says: Says<'_>) {
        match says {
            Says::AsItWas => {
                self.decided.retain(|at| Some(*at) != shapes.polygon);
                for at in [shapes.polygon, shapes.line].into_iter().flatten() {
                    self.shapes[at] = self.read.get(at).cloned();
                }
            }
            Says::NotANail => {
                // Whatever else was done to it: what a person did not accept is not kept.
                self.say(shapes, Says::AsItWas);
                self.decided.extend(shapes.polygon);
                if let Some(polygon) = shapes.polygon.and_then(|at| self.shapes[at].as_mut()) {
                    NOT_A_NAIL.clone_into(&mut polygon.label);
                }
                // Another nail's axis it is not.
                if let Some(at) = shapes.line {
                    self.shapes[at] = None;
                }
            }
            Says::Nail(shape, same) => self.say_nail(shapes, shape, same),
        }
    }

    fn say_nail(&mut self, shapes: &mut Shapes, shape: &NailShape, same: bool) {
        let corners = || shape.points.iter().map(|point| self.drawn.in_file(*point)).collect::<Vec<_>>();
        let read = |at: Option<usize>| at.and_then(|at| self.read.get(at)).cloned();
        let mut polygon = read(shapes.polygon).unwrap_or_else(|| Shape::new(NAIL, "polygon", corners()));
        NAIL.clone_into(&mut polygon.label);
        if !same {
            (polygon.points, polygon.shape_type) = (corners(), "polygon".to_owned());
        }
        let remark = polygon.description.as_deref().unwrap_or_default();
        if remark.is_empty() || remark.starts_with(DETECTED) && !same {
            polygon.description = Some(CORRECTED.to_owned());
        }
        let mut line = read(shapes.line).unwrap_or_else(|| Shape::new(AXIS, "line", Vec::new()));
        if !same || line.points.len() != 2 {
            let frame = shape.frame();
            line.points = [-0.5, 0.5].map(|along| self.drawn.in_file(frame.photo_from_nail(0.0, along))).to_vec();
        }
        let group = polygon.group_id.or(line.group_id).unwrap_or_else(|| self.free_group());
        (polygon.group_id, line.group_id) = (Some(group), Some(group));
        for (place, shape) in [(&mut shapes.polygon, polygon), (&mut shapes.line, line)] {
            let at = *place.get_or_insert_with(|| {
                self.shapes.push(None);
                self.shapes.len() - 1
            });
            self.shapes[at] = Some(shape);
        }
        self.decided.extend(shapes.polygon);
    }

    fn free_group(&self) -> i64 {
        let all = self.shapes.iter().flatten().chain(&self.read);
        all.filter_map(|shape| shape.group_id).max().map_or(1, |most| most.saturating_add(1))
    }

    fn write(&mut self) -> Result<Saved, WriteError> {
        let there = self.there()?;
        let changed = there.is_some() && there != self.known;
        let kept = changed.then(|| self.home.clone());
        let home = if changed { free_beside(&self.home) } else { self.home.clone() };
        let shapes: Vec<Shape> = self.shapes.iter().flatten().cloned().collect();
        if (shapes.is_empty() || self.decided.is_empty()) && self.is_new && !changed {
            // Nothing is left of what was drawn and decided here: as if nobody had. What is only detected is no
            // person's.
            if there.is_some() {
                std::fs::remove_file(&home).map_err(|why| refused(&home, why))?;
            }
            self.known = None;
            return Ok(Saved { path: home, kept });
        }
        let file = LabelMe { shapes, ..self.file.clone() };
        let text = file.to_text().map_err(|why| refused(&home, why))?;
        write_whole(&home, &text)?;
        (self.home, self.known) = (home.clone(), Some(digest(&text)));
        self.is_new |= changed;
        Ok(Saved { path: home, kept })
    }

    /// What is there now.
    fn there(&self) -> Result<Option<[u8; 32]>, WriteError> {
        match LabelMe::bytes(&self.home) {
            Ok(bytes) => Ok(Some(digest(&bytes))),
            Err(crate::labelme::Error::Read { source, .. }) if source.kind() == std::io::ErrorKind::NotFound => {
                Ok(None)
            }
            Err(why) => Err(refused(&self.home, why)),
        }
    }
}

fn refused(path: &Path, why: impl ToString) -> WriteError {
    WriteError::File { path: path.to_owned(), why: why.to_string() }
}

fn digest(bytes: &[u8]) -> [u8; 32] {
    Sha256::digest(bytes).into()
}

/// A name that is free: `s01.edited.json`, `s01.edited-2.json`, ..
fn free_beside(home: &Path) -> PathBuf {
    let stem = home.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let named = |k: u32| {
        home.with_file_name(if k < 2 { format!("{stem}.edited.json") } else { format!("{stem}.edited-{k}.json") })
    };
    (1..).map(named).find(|path| !path.exists()).unwrap_or_else(|| named(u32::MAX))
}
