//! What there is to correct on a photograph: its nails, who knows of them, and how much each is doubted.
//!
//! A photograph that nobody has annotated is searched as `lunula photos` does; an annotated one is not, but axes that
//! nobody drew are looked for and drawn ones asked of the picture, as there, and outlines of the network, as by
//! `--check-outlines`.

use std::path::{Path, PathBuf};

use super::annotation::{Annotation, Shapes};
use super::options::EditOptions;
use super::shape::NailShape;
use crate::labelme::LabelMe;
use crate::nail::{Axis, Outline};
use crate::photo::outline::{
    DOUBTFUL, Labelled, Listed, Moments, NAIL, Nail, OutlinePlace, SourceFault, Sources, ToDraw, hundredths, labelled,
    relative, template, to_draw, to_file, unlike,
};
use crate::photo::{NailFrame, Photo, PhotoSet, Photograph};
use crate::stages::Step;

/// How much of the photograph's shorter side a template's length is (assumed: a hand's nails are smaller, a close-up's
/// larger).
const TEMPLATE: f64 = 0.25;
/// A nail's width over its length (assumed).
const SLENDER: f64 = 0.75;

/// How soon a nail is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Rank {
    /// No run uses it as it is.
    Doubtful,
    /// Nothing was found: somebody has to draw it.
    Missing,
    /// Drawn by somebody, and used; the network sees the nail elsewhere.
    Elsewhere,
    /// Found by detection, and used.
    Detected,
    /// Drawn by somebody, and used.
    Drawn,
}

/// A nail to look at.
#[derive(Debug, Clone)]
pub(super) struct Find {
    pub(super) rank: Rank,
    pub(super) shapes: Shapes,
    pub(super) shape: NailShape,
    /// Why somebody should look, or who found it.
    pub(super) why: String,
}

/// Where the outlines of a photograph are saved, and how soon it is looked at; `Err` where that can't be.
pub(super) fn home(photo: &Photo, options: &EditOptions) -> Result<(PathBuf, Rank), String> {
    let beside = photo.path.with_extension("json");
    match options.outlines.locate(photo) {
        OutlinePlace::Mask(mask) => Err(format!(
            "its outline is the mask {}; correct the mask, or empty its cell `outline` in photos.csv",
            mask.display()
        )),
        OutlinePlace::LabelMe(file) => {
            let open = |file: &LabelMe| file.shapes.iter().any(|shape| shape.label.trim() == DOUBTFUL);
            let rank = if LabelMe::read(&file).is_ok_and(|file| open(&file)) { Rank::Doubtful } else { Rank::Drawn };
            Ok((file, rank))
        }
        OutlinePlace::Detection | OutlinePlace::Nowhere => Ok((beside, Rank::Detected)),
    }
}

/// The nails of an opened photograph.
pub(super) fn survey(
    photo: &Photo,
    picture: &Photograph,
    options: &EditOptions,
) -> Result<(Annotation, Vec<Find>), String> {
    let place = options.outlines.locate(photo);
    let (home, _) = home(photo, options)?;
    let mut found = match place {
        OutlinePlace::LabelMe(_) => of_file(&home, picture, options)?,
        _ => of_search(&place, &home, photo, picture, options)?,
    };
    if found.1.is_empty() {
        let why = "no nail is known on it: move the template, snap, or say that there is none".to_owned();
        let shape = blank(middle(picture), picture);
        found.1.push(Find { rank: Rank::Missing, shapes: Shapes::default(), shape, why });
    }
    Ok(found)
}

/// A nail of which nothing is known, around a place.
pub(super) fn blank(at_px: [f64; 2], picture: &Photograph) -> NailShape {
    let axis = Axis::from_clockwise_rad(0.0);
    let length = TEMPLATE * f64::from(picture.image.width().min(picture.image.height()));
    NailShape { points: template(at_px, axis, [length, SLENDER * length]), axis }
}

fn middle(picture: &Photograph) -> [f64; 2] {
    [picture.image.width(), picture.image.height()].map(|side| (f64::from(side) - 1.0) / 2.0)
}

fn of_file(home: &Path, picture: &Photograph, options: &EditOptions) -> Result<(Annotation, Vec<Find>), String> {
    let why = |why: crate::labelme::Error| why.to_string();
    let bytes = LabelMe::bytes(home).map_err(why)?;
    let file = LabelMe::parse(home, &bytes).map_err(why)?;
    let name = home.display().to_string();
    let stored =
        options.outlines.drawn.or_of(&file).is_stored(file.size(), picture, &name).map_err(|why| why.to_string())?;
    let found = labelled(&file, picture, stored, &[NAIL, DOUBTFUL]);
    let mut nails: Vec<Nail> = found.iter().map(|one| Nail::annotated(one.nail.clone(), "")).collect();
    options.outlines.complete_axes(picture, &mut nails);
    let is_doubtful = |one: &Labelled| file.shapes[one.polygon].label.trim().eq_ignore_ascii_case(DOUBTFUL);
    let drawn: Vec<Option<&Outline>> = nails.iter().map(|nail| nail.outline.as_ref()).collect();
    let unlike = unlike(&picture.image, &drawn).map_err(|why| why.to_string())?;
    let finds = found.iter().zip(nails).zip(unlike).map(|((one, nail), seen)| {
        let frame = || NailFrame::new(nail.outline.as_ref()?, nail.axis?).ok();
        let instead =
            seen.and_then(|seen| Some(format!("{}, by the network that finds nails", frame()?.instead(&seen))));
        let mut why = nail.reason;
        if is_doubtful(one) && why.is_empty() {
            let remark = file.shapes[one.polygon].description.clone().filter(|text| !text.is_empty());
            why = remark.unwrap_or_else(|| format!("is labelled `{DOUBTFUL}`"));
        }
        let (rank, why) = match instead {
            _ if !why.is_empty() => (Rank::Doubtful, why),
            Some(instead) => (Rank::Elsewhere, instead),
            None => (Rank::Drawn, why),
        };
        let shapes = Shapes { polygon: Some(one.polygon), line: one.line };
        Find { rank, shapes, shape: shape_of(one, nail.axis, picture), why }
    });
    let finds = finds.collect();
    Ok((Annotation::new(home, Some(&bytes), file, picture, stored), finds))
}

/// What is drawn, or, where that is no outline, a template over it.
fn shape_of(one: &Labelled, axis: Option<Axis>, picture: &Photograph) -> NailShape {
    match &one.nail.outline {
        Ok(outline) => {
            let axis = axis.unwrap_or_else(|| upright(Moments::of(outline).major));
            NailShape { points: outline.points(), axis }
        }
        Err(_) => {
            let up = Axis::from_clockwise_rad(0.0);
            let NailFrame { center_px, length_px, width_px, .. } = NailFrame::around(&one.points, up);
            let sides = [f64::from(picture.image.width()), f64::from(picture.image.height())];
            let is_on = (0..2).all(|k| (0.0..sides[k]).contains(&center_px[k]));
            if is_on && length_px >= 1.0 && width_px >= 1.0 {
                NailShape { points: template(center_px, up, [length_px, width_px]), axis: up }
            } else {
                blank(middle(picture), picture)
            }
        }
    }
}

/// Of the two directions of a line, the one that points up the picture.
fn upright(axis: Axis) -> Axis {
    let turned = axis.turned(std::f64::consts::PI);
    if axis.clockwise_rad().abs() <= turned.clockwise_rad().abs() { axis } else { turned }
}

fn of_search(
    place: &OutlinePlace,
    home: &Path,
    photo: &Photo,
    picture: &Photograph,
    options: &EditOptions,
) -> Result<(Annotation, Vec<Find>), String> {
    let nails = match options.outlines.nails(place, picture) {
        Ok(Listed { nails, .. }) => nails,
        Err(SourceFault::NotFound { .. } | SourceFault::NotAnnotated { .. }) => Vec::new(),
        Err(why) => return Err(why.to_string()),
    };
    let drawn = to_draw(&nails);
    let file = to_file(&relative(&photo.path, home.parent()), picture, &drawn);
    // Each polygon is one of them, in their order.
    let finds = labelled(&file, picture, false, &[NAIL, DOUBTFUL]).into_iter().zip(drawn);
    let finds = finds.map(|(one, nail)| {
        let doubt = if nail.trusted { "found by detection" } else { "found by detection, not trusted" };
        let why = format!("{doubt}: confidence {}", hundredths(nail.confidence));
        let ToDraw { outline, axis, trusted, .. } = nail;
        Find {
            rank: if trusted { Rank::Detected } else { Rank::Doubtful },
            shapes: Shapes { polygon: Some(one.polygon), line: one.line },
            shape: NailShape { points: Outline::points(&outline), axis },
            why,
        }
    });
    let finds = finds.collect();
    Ok((Annotation::new(home, None, file, picture, false), finds))
}

/// What is done before a person is asked, what is left out, and which photographs can't be corrected here.
#[must_use]
pub fn edit_steps(set: &PhotoSet, options: &EditOptions) -> (Vec<Step>, Vec<String>) {
    let mut failed: Vec<String> = set.faults.iter().map(ToString::to_string).collect();
    let mut counts = [0; 3];
    for photo in &set.photos {
        match home(photo, options) {
            Ok((_, Rank::Doubtful)) => counts[0] += 1,
            Ok((_, Rank::Drawn)) => counts[1] += 1,
            Ok(_) => counts[2] += 1,
            Err(why) => failed.push(format!("{}: {why}", photo.file)),
        }
    }
    let [doubtful, drawn, fresh] = counts;
    let searched = options.outlines.sources != Sources::Annotated;
    let why_not = match searched {
        false => "--outline annotated".to_owned(),
        true if fresh == 0 => "every photograph has its outlines".to_owned(),
        true => format!("{fresh} photographs without outlines"),
    };
    let steps = vec![
        Step::new(
            "read outlines",
            doubtful + drawn > 0,
            format!("{} files, {doubtful} with doubtful ones", doubtful + drawn),
        ),
        Step::new("detect", searched && fresh > 0, why_not),
        Step::new("page", true, "until it is interrupted".to_owned()),
    ];
    (steps, failed)
}
