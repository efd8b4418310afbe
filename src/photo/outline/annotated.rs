//! Outlines that a person drew in LabelMe, and back.
//!
//! In: a LabelMe file with polygons labelled `nail` and, optionally for each, a two-point line labelled `axis` from
//! proximal to distal; lines belong to the nail of their `group_id`, else to the nail that their middle lies in. Out:
//! outlines and axes in pixels of the *upright* photograph. Some tools draw on the upright picture, some on the stored
//! one: the file's width and height show which ([`Drawn`]), and where they can't the file is refused.

use std::io::Read as _;
use std::path::{Path, PathBuf};

use geo::{Contains, Point};
use thiserror::Error;

use super::{Axis, Outline, OutlineFault};
use crate::labelme::{LabelMe, Shape, from_labelme, to_labelme};
use crate::photo::normalize::NailFrame;
use crate::photograph::{Photograph, extension, is_picture, upright_from_stored};

/// What a nail's polygon is labelled.
pub const NAIL: &str = "nail";
/// A point of an outline may lie this many pictures' sides beyond the picture (assumed): a hand draws somewhat beyond
/// the border, never by pictures.
const FARTHEST: f64 = 4.0;
/// What a line from proximal to distal is labelled.
pub const AXIS: &str = "axis";
/// What a detected outline that is not trusted is labelled: a person corrects it and drops the question mark.
pub const DOUBTFUL: &str = "nail?";
/// What a shape is labelled that a person says is no nail: no run reads it.
pub const NOT_A_NAIL: &str = "not a nail";

/// Which picture an annotation or a mask was drawn on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Drawn {
    /// By width and height
    #[default]
    Auto,
    /// The upright one
    Upright,
    /// The stored one, before the EXIF orientation
    Stored,
}

/// Why a whole annotation can't be used.
#[derive(Debug, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum AnnotationFault {
    #[error(transparent)]
    File(#[from] crate::labelme::Error),
    #[error("{file}: was drawn on a picture of {drawn:?} px, but the photograph has {photo:?} px; {remedy}")]
    OtherSize {
        /// Annotation or mask.
        file: String,
        /// Width and height it states.
        drawn: [u32; 2],
        /// Width and height of the photograph, upright or as it is stored.
        photo: [u32; 2],
        /// What to do.
        remedy: &'static str,
    },
    #[error(
        "{0}: the photograph's EXIF orientation turns it without changing its size, so it is not known whether this \
         was drawn on the upright or on the stored picture; say --annotations upright or --annotations stored"
    )]
    Turned(String),
    #[error("{0}: no polygon labelled `nail` in it; label one, or remove the file to have the nail detected")]
    NoNail(String),
    #[error("{0}: holds annotations of {1}, which are not read; {EXPORT}")]
    OtherProgram(String, &'static str),
    #[error("{0}: whatever was found is rejected in it (`{NOT_A_NAIL}`), so nothing of the photograph is used")]
    Rejected(String),
}

/// What to do where another program's annotations are found.
pub(crate) const EXPORT: &str =
    "export them as LabelMe files, one a photograph and called as it, or as masks (--masks)";

/// What a LabelMe file says of one photograph.
#[derive(Debug, Clone)]
pub struct DrawnNails {
    /// Its nails, in its own order.
    pub nails: Vec<Annotated>,
    /// The picture that it says it was drawn on, relative to the file.
    pub image_path: String,
    /// Whether it says the size of that picture, so that it was compared with the photograph's.
    pub has_size: bool,
}

/// One nail of an annotation, or why its shape is none.
#[derive(Debug, Clone)]
pub struct Annotated {
    /// The outline, upright.
    pub outline: Result<Outline, ShapeFault>,
    /// The drawn axis, where there is one.
    pub axis: Option<Axis>,
}

/// Why one shape is not a nail.
#[derive(Debug, Clone, PartialEq, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum ShapeFault {
    #[error("shape {number} is a {kind} labelled nail; draw it as a polygon")]
    NotAPolygon {
        /// Counted from 1.
        number: usize,
        kind: String,
    },
    #[error(
        "shape {number}: its point ({x:e}, {y:e}) lies far outside of the photograph ({width} x {height} px); draw it \
         again"
    )]
    FarOff {
        /// Counted from 1.
        number: usize,
        /// Where the point is, pixels.
        x: f64,
        /// Down, pixels.
        y: f64,
        width: u32,
        height: u32,
    },
    #[error(
        "shape {number} is labelled {AXIS} and belongs to no nail; draw it as a line of two points whose middle lies \
         in the nail, or give both the same group_id"
    )]
    LooseAxis {
        /// Counted from 1.
        number: usize,
    },
    #[error("shape {number}: {fault}")]
    Outline {
        /// Counted from 1.
        number: usize,
        fault: OutlineFault,
    },
}

/// A key of files that are written here, where their size can't say that they were drawn on the upright picture.
const DRAWN_ON: &str = "lunulaDrawnOn";
const UPRIGHT: &str = "upright";

impl Drawn {
    /// As a file that was written here says, unless a person says something else.
    pub(crate) fn or_of(self, file: &LabelMe) -> Self {
        let is_upright = file.other.get(DRAWN_ON).is_some_and(|on| on == UPRIGHT);
        if self == Self::Auto && is_upright { Self::Upright } else { self }
    }

    /// Whether something drawn at `size` on `photo` was drawn on the stored picture (and has to be turned with it).
    ///
    /// # Errors
    /// [`AnnotationFault::OtherSize`] or [`AnnotationFault::Turned`].
    pub(crate) fn is_stored(
        self,
        size: Option<[u32; 2]>,
        photo: &Photograph,
        file: &str,
    ) -> Result<bool, AnnotationFault> {
        let upright = [photo.image.width(), photo.image.height()];
        let stored = photo.stored_size();
        let turned = photo.orientation != image::metadata::Orientation::NoTransforms;
        let fits = |expected: [u32; 2]| size.is_none_or(|s| s == expected);
        let (fits_upright, fits_stored) = (fits(upright), fits(stored));
        let is_stored = match self {
            Self::Upright => fits_upright.then_some(false),
            Self::Stored => fits_stored.then_some(true),
            Self::Auto if fits_upright && fits_stored && turned => {
                return Err(AnnotationFault::Turned(file.to_owned()));
            }
            Self::Auto => (fits_upright || fits_stored).then_some(!fits_upright),
        };
        is_stored.ok_or_else(|| AnnotationFault::OtherSize {
            file: file.to_owned(),
            drawn: size.unwrap_or_default(),
            photo: if self == Self::Stored { stored } else { upright },
            remedy: match self {
                Self::Stored if fits_upright => "it fits the upright picture: leave out --annotations stored",
                Self::Upright if fits_stored => "it fits the stored picture: say --annotations stored",
                _ => "draw it again, or scale it",
            },
        })
    }
}

/// Reads a LabelMe file onto the upright `photo`.
///
/// # Errors
/// [`AnnotationFault`] where nothing of the file can be used; a single bad shape is an [`Annotated`] with its fault.
pub fn read(path: &Path, photo: &Photograph, drawn: Drawn) -> Result<DrawnNails, AnnotationFault> {
    let file = LabelMe::read(path)?;
    let name = path.display().to_string();
    if let Some(program) = file.other_program() {
        return Err(AnnotationFault::OtherProgram(name, program));
    }
    let stored = drawn.or_of(&file).is_stored(file.size(), photo, &name)?;
    let mut found = labelled(&file, photo, stored, &[NAIL, DOUBTFUL]);
    for (line, nail) in loose_axes(&file, &found) {
        // What is wrong with an outline comes first.
        if found[nail].nail.outline.is_ok() {
            found[nail].nail.outline = Err(ShapeFault::LooseAxis { number: line + 1 });
        }
    }
    found.retain(|one| is(&file.shapes[one.polygon], NAIL));
    let nails: Vec<Annotated> = found.into_iter().map(|one| one.nail).collect();
    if nails.is_empty() {
        let rejected = file.shapes.iter().any(|shape| is(shape, NOT_A_NAIL));
        return Err(if rejected { AnnotationFault::Rejected(name) } else { AnnotationFault::NoNail(name) });
    }
    Ok(DrawnNails { nails, has_size: file.size().is_some(), image_path: file.image_path })
}

/// Whether a file is LabelMe's and has a nail.
pub(crate) fn has_nails(file: &Path) -> bool {
    LabelMe::read(file).is_ok_and(|file| file.shapes.iter().any(|shape| is(shape, NAIL)))
}

/// The program whose annotations a file holds, where it is another than LabelMe that is known.
pub(crate) fn other_program(file: &Path) -> Option<&'static str> {
    /// Of what stands in front of the root of an XML file.
    const HEAD: u64 = 4096;
    if extension(file).is_none_or(|ending| ending != "xml") {
        return LabelMe::read(file).ok()?.other_program();
    }
    let mut head = Vec::new();
    crate::input::open(file).ok()?.take(HEAD).read_to_end(&mut head).ok()?;
    String::from_utf8_lossy(&head).contains("<annotations>").then_some("CVAT")
}

/// The photograph that an annotation says it was drawn on, where that is there and is another than `photo`: files that
/// were renamed or converted keep the old name, and it means nothing.
pub(crate) fn other_photograph(file: &Path, image_path: &str, photo: &Path) -> Option<PathBuf> {
    let said = file.parent()?.join(image_path.replace('\\', "/"));
    let other = said.file_stem()? != photo.file_stem()? && is_picture(&said) && said.is_file();
    (other && said.canonicalize().ok()? != photo.canonicalize().ok()?).then_some(said)
}

/// A nail of an annotation, and where it is among the shapes.
#[derive(Debug, Clone)]
pub(crate) struct Labelled {
    /// The polygon's place.
    pub(crate) polygon: usize,
    /// The axis line's.
    pub(crate) line: Option<usize>,
    /// The polygon's corners, whatever they are.
    pub(crate) points: Vec<[f64; 2]>,
    pub(crate) nail: Annotated,
}

/// The shapes with one of `labels`, in the file's order, onto the upright `photo`; whether they were drawn on the
/// `stored` one, [`Drawn::is_stored`] knows.
pub(crate) fn labelled(file: &LabelMe, photo: &Photograph, stored: bool, labels: &[&str]) -> Vec<Labelled> {
    let upright = |point: &[f64; 2]| {
        let point = if stored { upright_from_stored(photo.orientation, photo.stored_size(), *point) } else { *point };
        from_labelme(point)
    };
    let line = |(place, shape): (usize, &'_ Shape)| {
        let ends = shape.points.iter().map(upright).collect::<Vec<_>>();
        Some(Line { place, group: shape.group_id, ends: <[[f64; 2]; 2]>::try_from(ends).ok()? })
    };
    let shapes = || file.shapes.iter().enumerate();
    let lines: Vec<Line> = shapes().filter(|(_, s)| is(s, AXIS)).filter_map(line).collect();
    let nails = shapes().filter(|(_, s)| labels.iter().any(|label| is(s, label)));
    nails
        .map(|(polygon, shape)| {
            let points: Vec<[f64; 2]> = shape.points.iter().map(upright).collect();
            let outline = outline_of(polygon + 1, shape, &points, [photo.image.width(), photo.image.height()]);
            let found = outline.as_ref().ok().and_then(|outline| axis_of(shape, outline, &lines));
            let (line, axis) = found.unzip();
            Labelled { polygon, line, points, nail: Annotated { outline, axis } }
        })
        .collect()
}

fn is(shape: &Shape, label: &str) -> bool {
    shape.label.trim().eq_ignore_ascii_case(label)
}

/// Shapes labelled `axis` that are no nail's, each with the nail that it is most likely meant for: the nearest without
/// an axis. Of one that shares its group with another thing nothing is said.
fn loose_axes(file: &LabelMe, found: &[Labelled]) -> Vec<(usize, usize)> {
    let middle = |place: usize| {
        let points = &file.shapes[place].points;
        [0, 1].map(|axis| points.iter().map(|point| point[axis]).sum::<f64>() / points.len() as f64)
    };
    let is_nails = |shape: &Shape| [AXIS, NAIL, DOUBTFUL].iter().any(|label| is(shape, label));
    let is_loose = |place: &usize| {
        let shape = &file.shapes[*place];
        let others = |other: &Shape| shape.group_id.is_some() && other.group_id == shape.group_id && !is_nails(other);
        is(shape, AXIS) && !found.iter().any(|one| one.line == Some(*place)) && !file.shapes.iter().any(others)
    };
    let nearest = |line: usize| {
        let [x, y] = middle(line);
        let away = |nail: &usize| {
            let [nail_x, nail_y] = middle(found[*nail].polygon);
            (nail_x - x).hypot(nail_y - y)
        };
        (0..found.len()).filter(|nail| found[*nail].line.is_none()).min_by(|a, b| away(a).total_cmp(&away(b)))
    };
    (0..file.shapes.len()).filter(is_loose).filter_map(|line| Some((line, nearest(line)?))).collect()
}

struct Line {
    place: usize,
    group: Option<i64>,
    ends: [[f64; 2]; 2],
}

fn outline_of(
    number: usize,
    shape: &Shape,
    points: &[[f64; 2]],
    [width, height]: [u32; 2],
) -> Result<Outline, ShapeFault> {
    if shape.shape_type != "polygon" {
        return Err(ShapeFault::NotAPolygon { number, kind: shape.shape_type.clone() });
    }
    let near = |at: f64, side: u32| (-FARTHEST..=1.0 + FARTHEST).contains(&(at / f64::from(side)));
    if let Some(&[x, y]) = points.iter().find(|[x, y]| !(near(*x, width) && near(*y, height))) {
        return Err(ShapeFault::FarOff { number, x, y, width, height });
    }
    Outline::new(points).map_err(|fault| ShapeFault::Outline { number, fault })
}

/// The line of a nail, by its place, and its direction.
fn axis_of(nail: &Shape, outline: &Outline, lines: &[Line]) -> Option<(usize, Axis)> {
    let grouped = lines.iter().find(|line| nail.group_id.is_some() && line.group == nail.group_id);
    let within = || {
        lines.iter().find(|line| {
            let [from, to] = line.ends;
            let middle = Point::new((from[0] + to[0]) / 2.0, (from[1] + to[1]) / 2.0);
            (line.group.is_none() || nail.group_id.is_none()) && outline.polygon().contains(&middle)
        })
    };
    let Line { place, ends: [proximal, distal], .. } = grouped.or_else(within)?;
    Some((*place, Axis::through(*proximal, *distal)?))
}

/// One nail to be written for a person to look at.
#[derive(Debug, Clone)]
pub struct ToDraw {
    /// Its outline on the upright photograph.
    pub outline: Outline,
    /// Its axis.
    pub axis: Axis,
    /// 0 to 1, kept in the shape's description.
    pub confidence: f64,
    /// Labelled `nail`, or `nail?`, which is not read as a nail until somebody corrects it.
    pub trusted: bool,
}

/// A LabelMe file of detected nails: polygons, each with its axis line through the box, tied by `group_id`.
///
/// `image_path` is the photograph's, relative to the file that will be written. The file says that it was drawn on the
/// upright one, where its size does not.
pub(crate) fn to_file(image_path: &str, photo: &Photograph, nails: &[ToDraw]) -> LabelMe {
    let mut shapes = Vec::new();
    for (group, nail) in (1..).zip(nails) {
        let points = nail.outline.points().iter().map(|p| to_labelme(p.map(|v| (v * 100.0).round() / 100.0))).collect();
        let mut polygon = Shape::new(if nail.trusted { NAIL } else { DOUBTFUL }, "polygon", points);
        polygon.description = Some(format!("detected by lunula, confidence {:.2}", nail.confidence));
        let line = NailFrame::new(&nail.outline, nail.axis)
            .map(|f| vec![to_labelme(f.photo_from_nail(0.0, -0.5)), to_labelme(f.photo_from_nail(0.0, 0.5))]);
        let axis = line.map(|points| Shape::new(AXIS, "line", points));
        for mut shape in std::iter::once(polygon).chain(axis) {
            shape.group_id = Some(group);
            shapes.push(shape);
        }
    }
    let mut file = LabelMe::new(image_path, photo.image.width(), photo.image.height(), shapes);
    if Drawn::Auto.is_stored(file.size(), photo, "").is_err() {
        file.other.insert(DRAWN_ON.to_owned(), UPRIGHT.into());
    }
    file
}
