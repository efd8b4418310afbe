//! What a run would do and leave out, told from names and headers: no pixel is decoded.

use std::collections::BTreeMap;

use super::job::PhotosOptions;
use super::outline::Found;
use super::read::header_is_grey;
use super::set::{Photo, PhotoSet};
use crate::stages::Step;

/// What is known of a photograph before it is opened.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Foreknown {
    /// Its pose.
    pub pose: String,
    /// It has no colours; none: not known.
    pub grey: Option<bool>,
    /// Where its outlines come from.
    pub outlines: Found,
}

impl Foreknown {
    /// Looks at a photograph's header and at what stands beside it.
    #[must_use]
    pub fn of(photo: &Photo, options: &PhotosOptions) -> Self {
        let (pose, outlines) = (photo.pose.clone(), options.outlines.locate(photo));
        Self { pose, grey: header_is_grey(&photo.path).ok(), outlines }
    }
}

/// Plans a run of `photos`.
pub fn plan(set: &PhotoSet, options: &PhotosOptions) -> Vec<Step> {
    let photos: Vec<Foreknown> = set.photos.iter().map(|photo| Foreknown::of(photo, options)).collect();
    plan_foreknown(&photos, options)
}

/// Plans a run on photographs of which not all need stand.
pub fn plan_foreknown(photos: &[Foreknown], options: &PhotosOptions) -> Vec<Step> {
    let count = |found: fn(&Found) -> bool| photos.iter().filter(|p| found(&p.outlines)).count();
    let labelme = count(|f| matches!(f, Found::LabelMe(_)));
    let masks = count(|f| matches!(f, Found::Mask(_)));
    let detected = count(|f| matches!(f, Found::Detection));
    let grey = photos.iter().filter(|p| p.grey == Some(true)).count();
    let colour = photos.len() - grey;
    let mut subjects: BTreeMap<&str, usize> = BTreeMap::new();
    for photo in photos {
        *subjects.entry(&photo.pose).or_default() += 1;
    }
    let most = subjects.values().copied().max().unwrap_or(0);
    let none_drawn = "nobody drew any";
    let maps = if options.parts.is_some() {
        let sums = Step::new("sums", true, format!("{} pose(s)", subjects.len()));
        [sums, Step::new("maps", false, "they are made of all subjects' sums".into())]
    } else {
        let spread =
            if most > 1 { format!("up to {most} subjects a pose") } else { "it needs two subjects in a pose".into() };
        let mean = Step::new("mean", true, format!("{} pose(s)", subjects.len()));
        [mean, Step::new("standard deviation", most > 1, spread)]
    };
    let [sums, spread] = maps;
    let pictures = options.parts.is_none_or(|parts| parts.pictures);
    vec![
        Step::new("read", true, format!("{} photograph(s) of {} pose(s)", photos.len(), subjects.len())),
        Step::new("outlines from LabelMe", labelme > 0, said(labelme, none_drawn)),
        Step::new("outlines from masks", masks > 0, said(masks, none_drawn)),
        Step::new("detection", detected > 0, said(detected, "every outline is known, or detection is not wanted")),
        Step::new(
            "axis from the picture",
            (labelme > 0 || masks > 0) && options.outlines.distal.is_none(),
            match options.outlines.distal {
                Some(_) => "--distal settles it, where the picture does not contradict".into(),
                None if labelme + masks > 0 => "of known outlines without an axis line; drawn ones are checked".into(),
                None => "detection finds its own".into(),
            },
        ),
        Step::new("channel", colour > 0, said(colour, "every photograph is grey")),
        Step::new(
            "sRGB curve undone",
            options.normalization.linear,
            if options.normalization.linear { "--linear".into() } else { "values are as the file encodes them".into() },
        ),
        Step::new(
            "white level",
            options.normalization.white.is_some(),
            match options.normalization.white {
                Some(white) => format!("--white {white} is full scale"),
                None => "the file's full scale".into(),
            },
        ),
        Step::new(
            "normalize",
            true,
            format!("{0} x {0} px of {1} nail boxes", options.normalization.size, options.normalization.margin),
        ),
        sums,
        spread,
        Step::new(
            "pictures written",
            pictures,
            if pictures { "the normalized ones".into() } else { "not asked for".into() },
        ),
        Step::new(
            "LabelMe files of what is detected",
            options.keep_detected,
            if options.keep_detected { "--write-outlines".into() } else { "not asked for".into() },
        ),
    ]
}

fn said(count: usize, otherwise: &str) -> String {
    if count > 0 { format!("{count} photograph(s)") } else { otherwise.to_owned() }
}
