//! Finds the outlines of nails in photographs that nobody has annotated.
//!
//! In: a photograph (upright). Out: outlines with their axis and a confidence. What is not confident is *doubtful*: a
//! person may correct it, no result uses it. There are two detectors.
//!
//! - [`Detector::Net`], for any photograph: a small segmentation network by OpenCV's `dnn` ([`segment`]) finds nails,
//!   [`find_axes`] their distal ends, and the outline is refined in the nail's own frame. The refined one is taken
//!   where the judges below believe it. The confidence is about the probability that a nail lies there whose IoU is
//!   at least 0.5. On 26 real photographs, each seen by a network trained without its session (`nails folds`), 85 % of
//!   127 nails are found with confidence, and 1 of 109 finds is wrong.
//! - [`Detector::CloseUp`], for one finger seen from above: templates. The confidence is about the probability of an
//!   IoU of at least 0.8. The way down, a file each: [`picture`] channels that do not depend on the light's brightness;
//!   [`hand`] masks that may be fingers and their ends; [`patch`] the picture in a finger's or nail's own frame;
//!   [`shape`] the template and [`evidence`] how well it fits there; [`search`] where it fits best, on a finger's end
//!   or anywhere on a close-up; [`refine`] the outline by dynamic programming around the template; [`candidate`] all of
//!   it for one place, with the figures that the confidence is made from. Five small networks ([`net`]: border, scorer,
//!   three judges) weigh the evidence.
//!
//! `crates/training` makes all weights. What neither does: nails that are seen as a sliver from the side, and painted
//! nails with a pattern, are mostly not found. The outline ends at the hyponychium where the free edge can be
//! distinguished from the bed.

mod candidate;
mod evidence;
mod hand;
mod net;
mod patch;
mod picture;
mod refine;
mod search;
mod segment;
mod shape;

use image::DynamicImage;
use thiserror::Error;

use super::{Axis, AxisUnknown, FoundAxis, Moments, Outline, Refusal, Refused, find_axes};
use crate::job;
use crate::photo::normalize::NailFrame;
use crate::photograph::is_grey;
use crate::vision::VisionError;
use candidate::{Lead, Origin, follow_all, own_frame};
use patch::{Frame, Patch};
use picture::Levels;
pub use segment::Unlike;
use segment::{NailNet, Segment, one_each};
use shape::{OutlineShape, TAPER};

/// The steps of detection, for `crates/training`, whose networks have to see what detection sees: no promise of the
/// library.
#[doc(hidden)]
pub mod training {
    pub use super::candidate::{Candidate, FEATURES, Features, Lead, follow_all, own_frame};
    pub use super::evidence::{INPUTS, inputs, score};
    pub use super::net::{Net, softsign};
    pub use super::patch::{Extent, Frame, Patch};
    pub use super::picture::Levels;
    pub use super::refine::{Band, RAYS, SIDE, STEP};
    pub use super::search::{FINGER, NAIL, Scored, anywhere, on_finger, polish};
    pub use super::segment::{NailNet, Segment};
    pub use super::shape::OutlineShape;
    pub use super::{detect_by, ends, leads};
}

/// Who looks for nails.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Detector {
    /// A small network: any number of nails, in any direction
    #[default]
    Net,
    /// Templates: one finger, seen from above, about upright
    CloseUp,
}

/// How nails are looked for.
#[derive(Debug, Clone, PartialEq, clap::Args)]
pub struct DetectOptions {
    /// Who looks for nails
    #[arg(long, value_enum, default_value_t)]
    pub detector: Detector,
    /// Longest side, in pixels, of the picture that detection searches
    #[arg(
        long = "detect-size",
        value_name = "PX",
        default_value_t = 1100,
        value_parser = clap::value_parser!(u32).range(64..=4096)
    )]
    pub working_size_px: u32,
    /// Least confidence, 0 to 1, of a nail that results may use; none: the detector's own, at which about 95 of 100
    /// finds were right.
    #[arg(skip)]
    pub min_confidence: Option<f64>,
    /// Least confidence, 0 to 1, of a doubtful one that is shown to a person; none: the detector's own.
    #[arg(skip)]
    pub min_doubtful: Option<f64>,
    /// Most places whose outline is refined.
    #[arg(skip = 16_usize)]
    pub most_places: usize,
}

impl Default for DetectOptions {
    fn default() -> Self {
        job::defaults()
    }
}

/// One nail found.
#[derive(Debug, Clone, PartialEq)]
pub struct Detected {
    /// Its outline.
    pub outline: Outline,
    /// From its proximal to its distal end.
    pub axis: Axis,
    /// 0 to 1: about the probability that the find is right; what that means depends on the [`Detector`].
    pub confidence: f64,
}

/// Why no nail was found with confidence.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum NothingFound {
    #[error("the picture is too small to find a nail on; it needs at least {least} x {least} pixels", least = LEAST_PX)]
    TooSmall,
    #[error("nothing on the picture looks like a nail")]
    NoPlace,
    /// Something does, but not surely enough.
    #[error("what looks most like a nail is doubtful (confidence {best:.2}, {needed:.2} is needed)")]
    Doubtful { best: f64, needed: f64 },
}

/// What was found on one photograph, none overlapping another, the surest first.
#[derive(Debug, Clone, PartialEq)]
pub struct Detections {
    /// Nails found with confidence.
    pub nails: Vec<Detected>,
    /// Finds too unsure for results, for a person to correct.
    pub doubtful: Vec<Detected>,
    /// Places that were looked at and refused, where a person may like to see them.
    pub refused: Vec<Refused>,
    /// The least confidence of `nails`.
    pub needed: f64,
    /// Why `nails` is empty, where it is.
    pub note: Option<NothingFound>,
}

/// Confidence from which a close-up's nails are used, and from which they are shown.
const CLOSE_UP_NEEDS: f64 = 0.8;
const CLOSE_UP_SHOWS: f64 = 0.1;
/// Confidence from which the network's finds are shown: it missed fewer of real nails than a person likes to draw.
const NET_SHOWS: f64 = 0.03;
/// Smallest side of a picture that is looked at.
const LEAST_PX: u32 = 24;
/// Longest side of the picture that silhouettes are looked for on.
const SEARCH_PX: usize = 560;
/// Ends of fingers that are looked at.
const ENDS: usize = 40;
/// Lowest score in a coarse look that is looked at again.
const HOPE: f32 = 0.25;
/// Places on a close-up that are looked at again.
const PLACES: usize = 5;
/// Shared part of the smaller of two outlines from which they contradict each other.
const SHARED: f64 = 0.25;

/// Finds the nails on an upright photograph. The same photograph and options give the same result, always.
pub fn detect(image: &DynamicImage, options: &DetectOptions) -> Result<Detections, VisionError> {
    if image.width().min(image.height()) < LEAST_PX {
        let note = Some(NothingFound::TooSmall);
        return Ok(Detections { nails: vec![], doubtful: vec![], refused: vec![], needed: CLOSE_UP_NEEDS, note });
    }
    match options.detector {
        Detector::Net => detect_by(NailNet::committed()?, image, options),
        Detector::CloseUp => {
            let needed = options.min_confidence.unwrap_or(CLOSE_UP_NEEDS);
            let shown = options.min_doubtful.unwrap_or(CLOSE_UP_SHOWS);
            Ok(sorted_out(by_template(image, needed, options), [needed, shown]))
        }
    }
}

/// What the network surely sees instead of each outline that a person drew on an upright photograph, where there is one
/// and it does.
pub fn unlike(image: &DynamicImage, outlines: &[Option<&Outline>]) -> Result<Vec<Option<Unlike>>, VisionError> {
    match outlines.iter().all(Option::is_none) {
        true => Ok(vec![None; outlines.len()]),
        false => NailNet::committed()?.unlike(image, outlines),
    }
}

/// By this network.
#[doc(hidden)]
pub fn detect_by(net: &NailNet, image: &DynamicImage, options: &DetectOptions) -> Result<Detections, VisionError> {
    let needed = options.min_confidence.unwrap_or(net.confident.max(DOUBTED));
    let shown = options.min_doubtful.unwrap_or(NET_SHOWS);
    Ok(sorted_out(by_net(net, image, shown, options)?, [needed, shown]))
}

/// What was found, confident or doubtful.
fn sorted_out((mut found, mut refused): (Vec<Detected>, Vec<Refused>), [needed, shown]: [f64; 2]) -> Detections {
    found.sort_by(|a, b| b.confidence.total_cmp(&a.confidence));
    let best = found.first().map(|d| d.confidence);
    let (nails, doubtful): (Vec<_>, Vec<_>) = found.into_iter().partition(|d| d.confidence >= needed);
    let (doubtful, unsure): (Vec<_>, Vec<_>) = doubtful.into_iter().partition(|d| d.confidence >= shown);
    refused.extend(unsure.into_iter().map(|d| Refused { outline: d.outline, why: Refusal::Unsure(d.confidence) }));
    refused.retain(|one| one.is_shown(shown, nails.iter().chain(&doubtful).map(|kept| &kept.outline)));
    let note = nails.is_empty().then_some(match best {
        Some(best) if !doubtful.is_empty() => NothingFound::Doubtful { best, needed },
        _ => NothingFound::NoPlace,
    });
    Detections { nails, doubtful, refused, needed, note }
}

/// By templates of a single finger seen from above.
fn by_template(image: &DynamicImage, needed: f64, options: &DetectOptions) -> (Vec<Detected>, Vec<Refused>) {
    let levels = Levels::of(image, options.working_size_px.max(4 * LEAST_PX));
    let all = follow_all(&levels, leads(&levels), options.most_places).into_iter();
    let all = all.map(|c| Detected { confidence: c.confidence(), outline: c.outline, axis: c.axis }).collect();
    let (mut found, overlapped) = one_each(all, SHARED, |d: &Detected| d.confidence, |d| &d.outline);
    second_opinion(image, &mut found, needed);
    let refused = |d: Detected| Refused { outline: d.outline, why: Refusal::Overlapped(d.confidence) };
    (found, overlapped.into_iter().map(refused).collect())
}

/// What is left of a confidence where something speaks against the find; what is left is never confident.
const DOUBTED: f64 = 0.4;
/// Side of the square of a nail's area, over the photograph's longest side, from which it is a close-up. The judges of
/// refined outlines know close-ups: there a find is confident only where they believe it.
const CLOSE_UP: f64 = 0.2;
/// What the judges must believe of a close-up's outline: of 200 phantoms (`nails folds`) 98 % in colour pass.
const BELIEVED: f64 = 0.5;
/// .. and of another's for it to take the place of the network's own. On 26 real photographs the network's outlines
/// have an IoU of 0.87 in median, refined ones of 0.81, those so believed of 0.91; on phantoms 0.91 and 0.99.
const BELIEVED_ANYWHERE: f64 = 0.8;
/// Axes this far apart are of fingers that point elsewhere, degrees.
const ELSEWHERE_DEG: f64 = 45.0;
/// Overlap with the network's outline below which a refined one is another thing's; on close-ups, where the network
/// errs less, all of 5 refined ones below the second of these were wrong (`nails table`, seeds 3000 and 7000).
const REFINED_AGREES: [f64; 2] = [0.6, 0.8];
/// A rival's odds times this are less than those of an outline that is believed although the axis is a guess.
const CLEARLY: f64 = 5.0;
/// A close-up that the judges don't believe, most of them in grey, is confident where the network is this sure, the
/// axis is known, and an outline refined along it, within so many degrees, overlaps the network's so far: of 160
/// phantoms in grey this takes 30, all right, and of 400 pictures without nails none (`nails table`).
const SURE: f64 = 0.97;
const NEAR_DEG: f64 = 20.0;
const CONFIRMS: f64 = 0.85;
/// In colour it is confident where the network is certain and the axis known: of the largest nails of 26 real
/// photographs, enlarged to 190 px on 640 x 480, the judges believe 11 and this takes 11 more; a knuckle has 0.973, the
/// most on 208 parts of these photographs without a nail. In grey it would take 20 of 330 phantoms, two of them at an
/// IoU of 0.79.
const CERTAIN: f64 = 0.99;
/// Side of the square of a nail's area, pixels, below which a find is doubtful. Measured with the committed network on
/// hand-free pictures, photographs and a video of brown hands: all five confident finds below it were spots in the
/// background (10.3 px and less). The smallest nail of 127 drawn by hand has 13.8 px.
const SMALL_PX: f64 = 12.0;
/// The part of the photograph around a nail that its outline is refined on, nail lengths on each side.
const AROUND: f64 = 1.3;

/// By the network; each outline is refined at full resolution in the nail's own frame.
fn by_net(
    net: &NailNet,
    image: &DynamicImage,
    shown: f64,
    options: &DetectOptions,
) -> Result<(Vec<Detected>, Vec<Refused>), VisionError> {
    let (segments, mut refused) = net.segments(image)?;
    let (segments, unsure): (Vec<_>, Vec<_>) = segments.into_iter().partition(|s| s.confidence >= shown);
    refused.extend(unsure.into_iter().map(|s| Refused { outline: s.outline, why: Refusal::Unsure(s.confidence) }));
    let outlines: Vec<Outline> = segments.iter().map(|segment| segment.outline.clone()).collect();
    let axes = find_axes(image, &outlines);
    let found = segments.into_iter().zip(axes).map(|(segment, axis)| judged(image, segment, axis, options));
    Ok((found.collect(), refused))
}

/// What the network found, with its axis and the better of two outlines; doubted where it is small.
fn judged(
    image: &DynamicImage,
    segment: Segment,
    axis: Result<FoundAxis, AxisUnknown>,
    options: &DetectOptions,
) -> Detected {
    let found = with_better_outline(image, segment, axis, options);
    let is_small = found.outline.area_px2().sqrt() < SMALL_PX;
    Detected { confidence: if is_small { DOUBTED } else { 1.0 } * found.confidence, ..found }
}

fn with_better_outline(
    image: &DynamicImage,
    Segment { outline, confidence }: Segment,
    axis: Result<FoundAxis, AxisUnknown>,
    options: &DetectOptions,
) -> Detected {
    let known = axis.as_ref().ok().map(|found| found.axis);
    let guess = known.or_else(|| axis.as_ref().err()?.best_guess.map(|guess| guess.axis));
    let is_close_up = outline.area_px2().sqrt() >= CLOSE_UP * f64::from(image.width().max(image.height()));
    let mut tried = Vec::from_iter(guess);
    if is_close_up || known.is_none() {
        let major = Moments::of(&outline).major;
        tried.extend([0.0, 1.0, 2.0, 3.0].map(|k| major.turned(k * std::f64::consts::FRAC_PI_2)));
    }
    let likeliest = tried[0];
    let better: Vec<Detected> = tried
        .into_iter()
        .filter_map(|axis| refined(image, &outline, axis, options))
        .filter(|better| better.outline.iou(&outline) >= REFINED_AGREES[usize::from(is_close_up)])
        .collect();
    let best = better.iter().max_by(|a, b| a.confidence.total_cmp(&b.confidence));
    // Believed, and nothing says that the finger points elsewhere.
    let believed = best.filter(|best| {
        let elsewhere = |axis: Axis| axis.apart_deg(best.axis) > ELSEWHERE_DEG;
        let rivals = better.iter().filter(|other| elsewhere(other.axis)).map(|other| other.confidence);
        let rival = rivals.fold(0.0, f64::max);
        match known {
            Some(axis) => best.confidence >= if is_close_up { BELIEVED } else { BELIEVED_ANYWHERE } && !elsewhere(axis),
            None if elsewhere(likeliest) => best.confidence >= BELIEVED_ANYWHERE && rival < BELIEVED,
            None => {
                best.confidence >= BELIEVED_ANYWHERE
                    && (rival < BELIEVED || odds(best.confidence) >= CLEARLY * odds(rival))
            }
        }
    });
    let confirmed = |better: &Detected| {
        better.outline.iou(&outline) >= CONFIRMS && known.is_some_and(|axis| axis.apart_deg(better.axis) <= NEAR_DEG)
    };
    match believed {
        Some(best) => {
            let axis = known.filter(|axis| axis.apart_deg(best.axis) > AGREE_DEG).unwrap_or(best.axis);
            Detected { axis, confidence, outline: best.outline.clone() }
        }
        None if is_close_up && confidence >= SURE && better.iter().any(confirmed) => {
            Detected { outline, axis: likeliest, confidence }
        }
        None if is_close_up && confidence >= CERTAIN && known.is_some() && !is_grey(image) => {
            Detected { outline, axis: likeliest, confidence }
        }
        None if is_close_up || known.is_none() => {
            Detected { outline, axis: likeliest, confidence: DOUBTED * confidence }
        }
        None => Detected { outline, axis: likeliest, confidence },
    }
}

fn odds(probability: f64) -> f64 {
    probability / (1.0 - probability).max(1e-9)
}

/// Corners of a nail of which nothing else is known: a template in a person's place, to be moved and snapped.
#[must_use]
pub fn template(centre_px: [f64; 2], axis: Axis, [length, width]: [f64; 2]) -> Vec<[f64; 2]> {
    let frame = Frame { origin: centre_px, up: axis.distal(), unit_px: 1.0 };
    let shape = OutlineShape { x: 0.0, y: 0.0, length, width, turn: 0.0, taper: TAPER };
    let rim = (0..refine::RAYS).map(|k| shape.rim(k as f64 / refine::RAYS as f64 * std::f64::consts::TAU));
    rim.map(|[u, v]| frame.to_source(shape.point(u, v))).collect()
}

/// The outline of the nail that lies about where `rough` does, along about `axis`: its border is looked for from there.
/// `None` where there is none.
#[must_use]
pub fn snap(image: &DynamicImage, rough: &Outline, axis: Axis) -> Option<Detected> {
    (image.width().min(image.height()) >= LEAST_PX)
        .then(|| refined(image, rough, axis, &DetectOptions::default()))
        .flatten()
}

/// The outline of a nail whose place, size and axis are about known, and what the judges of close-ups think of it.
fn refined(image: &DynamicImage, rough: &Outline, axis: Axis, options: &DetectOptions) -> Option<Detected> {
    let NailFrame { center_px: centre, length_px: length, width_px: width, .. } =
        NailFrame::around(&rough.points(), axis);
    let reach = (0.5 + AROUND) * length.max(width);
    let size = [f64::from(image.width()), f64::from(image.height())];
    let low = [0, 1].map(|k| (centre[k] - reach).floor().clamp(0.0, size[k] - 1.0));
    let high = [0, 1].map(|k| (centre[k] + reach).ceil().clamp(low[k] + 1.0, size[k]));
    let part = [low, [high[0] - low[0], high[1] - low[1]]].map(|sides| sides.map(|n| n as u32));
    let levels = Levels::of_part(image, part, options.working_size_px.max(4 * LEAST_PX));

    let nail = Frame { origin: [0, 1].map(|k| centre[k] - low[k]), up: axis.distal(), unit_px: length };
    let template = OutlineShape { x: 0.0, y: 0.0, length: 1.0, width: width / length, turn: 0.0, taper: TAPER };
    let found = follow_all(&levels, vec![lead_anywhere(&levels, nail, template)], 1).pop()?;
    let moved: Vec<[f64; 2]> = found.outline.points().iter().map(|p| [p[0] + low[0], p[1] + low[1]]).collect();
    Some(Detected { outline: Outline::new(&moved).ok()?, axis: found.axis, confidence: found.confidence() })
}

/// Axes that differ by less than this agree, degrees; the template's own is kept.
const AGREE_DEG: f64 = 8.0;
/// Axes that differ by more contradict each other, degrees.
const CONTRADICT_DEG: f64 = 75.0;

/// Asks the picture around each confident find for its axis ([`find_axes`] knows nothing of templates): a nail about as
/// wide as long fits its template on the diagonal too. Where the two contradict each other, the find is halved in
/// confidence.
fn second_opinion(image: &DynamicImage, found: &mut [Detected], min_confidence: f64) {
    for one in found.iter_mut().filter(|d| d.confidence >= min_confidence) {
        let Ok(other) = find_axes(image, std::slice::from_ref(&one.outline)).swap_remove(0) else { continue };
        let apart_deg = other.axis.apart_deg(one.axis);
        if apart_deg > CONTRADICT_DEG {
            one.confidence *= 0.5;
        } else if apart_deg > AGREE_DEG {
            one.axis = other.axis;
        }
    }
    found.sort_by(|a, b| b.confidence.total_cmp(&a.confidence));
}

/// Finger ends: frames of a finger's width with their fit.
#[doc(hidden)]
pub fn ends(levels: &Levels, most: usize) -> Vec<(Frame, f64)> {
    let picture = levels.within(SEARCH_PX);
    let found = hand::silhouettes(picture).iter().flat_map(hand::tips).collect();
    hand::strongest(found, most)
        .into_iter()
        .map(|t| (Frame { origin: picture.to_source(t.apex), up: t.out, unit_px: t.width * picture.step }, t.fit))
        .collect()
}

/// A template that no finger end led to, polished.
fn lead_anywhere(levels: &Levels, nail: Frame, template: OutlineShape) -> Lead {
    let patch = Patch::cut(levels, nail, search::NAIL);
    let first = evidence::score(&patch, &template, false);
    let (shape, score) = search::polish(&patch, (template, first), false);
    let (nail, template) = own_frame(nail, &shape);
    Lead { nail, template, origin: Origin::Anywhere, score }
}

/// Every template worth refining.
#[doc(hidden)]
pub fn leads(levels: &Levels) -> Vec<Lead> {
    let mut leads = Vec::new();
    for (frame, fit) in ends(levels, ENDS) {
        let patch = Patch::cut(levels, frame, search::FINGER);
        let coarse = search::on_finger(&patch, 2).into_iter().filter(|s| s.1 > HOPE);
        let best = coarse.map(|s| search::polish(&patch, s, true)).max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((shape, score)) = best {
            let (nail, template) = own_frame(frame, &shape);
            leads.push(Lead { nail, template, origin: Origin::Tip { fit, score }, score });
        }
    }
    let (patch, places) = search::anywhere(levels, PLACES);
    for (shape, _) in places.into_iter().filter(|s| s.1 > HOPE) {
        let (nail, template) = own_frame(patch.frame, &shape);
        leads.push(lead_anywhere(levels, nail, template));
    }
    leads
}
