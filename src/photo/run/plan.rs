//! Which steps a run takes and leaves out, and why: one table, which a plan asks with what names and headers show, and
//! a run with what it found.

use std::collections::BTreeMap;

use crate::photo::options::{Outputs, PhotosOptions, Results};
use crate::photo::outline::{Detector, OutlinePlace};
use crate::photo::set::{Photo, PhotoSet};
use crate::photograph::header_is_grey;
use crate::stages::{self, Step};

/// The step that compares red, green and blue.
const COMPARED: &str = "channels compared";

/// What is known of a photograph: before it is opened, or after it was worked on.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::photo) struct Foreknown {
    /// Its pose.
    pub pose: String,
    /// It has no colours; none: not known.
    pub grey: Option<bool>,
    /// Where its outlines come from.
    pub outlines: OutlinePlace,
}

impl Foreknown {
    /// Looks at a photograph's header and at the files beside it; no pixel is decoded.
    #[must_use]
    pub(in crate::photo) fn of(photo: &Photo, options: &PhotosOptions) -> Self {
        let (pose, outlines) = (photo.pose.clone(), options.outlines.locate(photo));
        Self { pose, grey: header_is_grey(&photo.path).ok(), outlines }
    }
}

/// Plans a run of `photos`.
pub fn plan(set: &PhotoSet, options: &PhotosOptions, outputs: &Outputs) -> Vec<Step> {
    let photos: Vec<Foreknown> = set.photos.iter().map(|photo| Foreknown::of(photo, options)).collect();
    plan_foreknown(&photos, options, outputs)
}

/// What a run left out: whole steps, and those that some photographs did not need.
pub(in crate::photo) fn left_out(photos: &[Foreknown], options: &PhotosOptions, outputs: &Outputs) -> Vec<String> {
    let counts = Counts::of(photos);
    let mut left_out = Vec::new();
    if counts.grey > 0 {
        left_out.push(format!("channel: not taken from {} grey photograph(s)", counts.grey));
    }
    if counts.grey > 0 && counts.grey < photos.len() && outputs.compares_channels(options) {
        left_out.push(format!("{COMPARED}: {} grey photograph(s) have none", counts.grey));
    }
    let drawn = counts.labelme + counts.masks;
    if drawn > 0 {
        left_out.push(format!("detection: not run on {drawn} photograph(s) whose outlines are known"));
    }
    let counted = ["channel", "detection"];
    let steps = plan_foreknown(photos, options, outputs);
    left_out.extend(stages::left_out(steps.into_iter().filter(|step| !counted.contains(&step.stage))));
    if counts.poses.len() == 1 && outputs.results == Results::Maps {
        left_out.push("comparison between poses: there is one".into());
    }
    left_out
}

/// Photographs by what they need.
struct Counts<'a> {
    labelme: usize,
    masks: usize,
    detected: usize,
    grey: usize,
    /// Photographs by pose, a subject each.
    poses: BTreeMap<&'a str, usize>,
}

impl<'a> Counts<'a> {
    fn of(photos: &'a [Foreknown]) -> Self {
        let count = |is: fn(&OutlinePlace) -> bool| photos.iter().filter(|p| is(&p.outlines)).count();
        let mut poses = BTreeMap::new();
        for photo in photos {
            *poses.entry(photo.pose.as_str()).or_default() += 1;
        }
        Self {
            labelme: count(|place| matches!(place, OutlinePlace::LabelMe(_))),
            masks: count(|place| matches!(place, OutlinePlace::Mask(_))),
            detected: count(|place| matches!(place, OutlinePlace::Detection)),
            grey: photos.iter().filter(|p| p.grey == Some(true)).count(),
            poses,
        }
    }
}

/// The table of steps.
pub(in crate::photo) fn plan_foreknown(photos: &[Foreknown], options: &PhotosOptions, outputs: &Outputs) -> Vec<Step> {
    let Counts { labelme, masks, detected, grey, poses } = Counts::of(photos);
    let colour = photos.len() - grey;
    let most = poses.values().copied().max().unwrap_or(0);
    let none_drawn = "nobody drew any";
    let maps = if outputs.results != Results::Maps {
        let sums = Step::new("sums", true, format!("{} pose(s)", poses.len()));
        [sums, Step::new("maps", false, "they are made of all subjects' sums".into())]
    } else {
        let spread =
            if most > 1 { format!("up to {most} subjects per pose") } else { "it needs two subjects in a pose".into() };
        let mean = Step::new("mean", true, format!("{} pose(s)", poses.len()));
        [mean, Step::new("standard deviation", most > 1, spread)]
    };
    let [sums, spread] = maps;
    let pictures = outputs.has_pictures();
    let mut steps = vec![
        Step::new("read", true, format!("{} photograph(s) of {} pose(s)", photos.len(), poses.len())),
        Step::new("outlines from LabelMe", labelme > 0, said(labelme, none_drawn)),
        Step::new("outlines from masks", masks > 0, said(masks, none_drawn)),
        Step::new("detection", detected > 0, detection(detected, options)),
        Step::new(
            "axis from the picture",
            (labelme > 0 || masks > 0) && options.outlines.distal.is_none(),
            match options.outlines.distal {
                Some(_) => "--distal settles it where the picture does not contradict".into(),
                None if labelme + masks > 0 => "of known outlines without an axis line; drawn ones are checked".into(),
                None => "detection finds its own".into(),
            },
        ),
        Step::new(
            "check outlines",
            options.check_outlines && labelme + masks > 0,
            match (options.check_outlines, labelme + masks) {
                (true, drawn) => said(drawn, none_drawn),
                (false, 0) => none_drawn.into(),
                (false, _) => "--check-outlines looks at them with the network that finds nails".into(),
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
            if pictures { "the normalized ones".into() } else { "not requested".into() },
        ),
    ];
    steps.extend(outputs.compares_channels(options).then(|| {
        let what = match (colour, grey) {
            (0, _) => "every photograph is grey and has none".into(),
            (_, 0) => format!("{colour} colour photograph(s)"),
            _ => format!("{colour} colour photograph(s); {grey} grey one(s) have none and are left out"),
        };
        Step::new(COMPARED, colour > 0, what)
    }));
    // Sums are a pipeline's, which has no such option.
    let saved = outputs.outlines.is_some();
    let why = if saved { "--write-outlines" } else { "not requested" };
    let labelme = Step::new("LabelMe files of what is detected", saved, why.into());
    steps.extend((outputs.results == Results::Maps).then_some(labelme));
    steps
}

/// How many photographs are searched, and who searches them.
fn detection(count: usize, options: &PhotosOptions) -> String {
    let by = match options.outlines.detect.detector {
        Detector::Net => "a network, whose outlines are refined where templates of close-ups fit them",
        Detector::CloseUp => "templates of one finger; --detector net finds any number, in any direction",
    };
    if count > 0 { format!("{count} photograph(s), by {by}") } else { said(0, NO_DETECTION) }
}

const NO_DETECTION: &str = "every outline is known, or detection is turned off; no network is loaded";

fn said(count: usize, otherwise: &str) -> String {
    if count > 0 { format!("{count} photograph(s)") } else { otherwise.to_owned() }
}
