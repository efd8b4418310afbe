//! What survey and tracker make of scenes whose truth is known: phantom's, and films of discs.

use std::path::Path;

use crate::phantom::video::{MarkerStatus, Scene, VideoOptions};
use crate::posture::layout::Layout;
use crate::posture::marker::method::Method;
use crate::posture::marker::sight::Sight;
use crate::posture::stage::{Disc, SKIN, Stage};
use crate::posture::survey::{Progress, SurveyError, Surveyor};
use crate::posture::track::{Effort, Tracker};
use crate::video::{Info, Picture};

/// A centre is a marker's if it is nearer than this share of its radius, or this much.
const HIT_RADII: f64 = 0.6;
const HIT_PX: f64 = 1.5;

/// Sights counted against the truth.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(in crate::posture) struct Tally {
    /// At the marker, wholly in view.
    pub(in crate::posture) right: usize,
    /// Elsewhere, whatever the marker did.
    pub(in crate::posture) wrong: usize,
    /// Lost though wholly in view.
    pub(in crate::posture) missed: usize,
    /// A centre of a marker of which nothing is in view.
    pub(in crate::posture) unseen: usize,
    /// A centre of a marker seen in part.
    pub(in crate::posture) partial: usize,
    /// Frames that the survey took.
    pub(in crate::posture) surveyed: usize,
    pub(in crate::posture) effort: Effort,
}

/// Where a marker really is.
#[derive(Debug, Clone, Copy)]
pub(in crate::posture) struct Real {
    pub(in crate::posture) at_px: [f64; 2],
    pub(in crate::posture) radius_px: f64,
    /// The share of it that is in view.
    pub(in crate::posture) in_view: f64,
}

/// What is seen of a video.
pub(in crate::posture) struct Film<'a> {
    pub(in crate::posture) layout: &'a Layout,
    pub(in crate::posture) info: Info,
    pub(in crate::posture) pictures: Vec<Picture>,
    /// For each frame and marker of the layout.
    pub(in crate::posture) truth: Vec<Vec<Real>>,
}

impl Film<'_> {
    pub(in crate::posture) fn run(&self) -> Result<Tally, SurveyError> {
        let mut surveyor = Surveyor::new(self.layout, &self.info);
        for (k, picture) in self.pictures.iter().enumerate() {
            if surveyor.look(&picture.frame(k as u64, 0.0)) == Progress::Enough {
                break;
            }
        }
        let survey = surveyor.finish()?;
        let mut tally = Tally { surveyed: survey.frames, ..Tally::default() };
        let mut tracker = Tracker::new(self.layout, &survey, &self.info, Method::default());
        let needed = self.layout.needed();
        for (k, picture) in self.pictures.iter().enumerate() {
            let sights = tracker.step(&picture.frame(k as u64, 0.0));
            for (marker, sight) in sights.iter().enumerate() {
                if needed[marker] {
                    tally.count(sight, &self.truth[k][marker]);
                } else {
                    assert!(matches!(sight, Sight::Lost(_)), "a marker that no joint needs is not looked for");
                }
            }
        }
        tally.effort = tracker.effort();
        Ok(tally)
    }
}

impl Tally {
    fn count(&mut self, sight: &Sight, real: &Real) {
        let whole = real.in_view >= 0.999;
        match sight {
            Sight::Seen(centre) => {
                let off = (centre.at_px[0] - real.at_px[0]).hypot(centre.at_px[1] - real.at_px[1]);
                if off > (HIT_RADII * real.radius_px).max(HIT_PX) {
                    self.wrong += 1;
                } else if whole {
                    self.right += 1;
                } else if real.in_view > 0.0 {
                    self.partial += 1;
                } else {
                    self.unseen += 1;
                }
            }
            Sight::Lost(_) => self.missed += usize::from(whole),
        }
    }
}

/// The header of a phantom scene's video.
pub(in crate::posture) fn info(options: &VideoOptions) -> Info {
    let format = options.format();
    Info { matrix: options.matrix, format, grey: format.subsampling.is_none(), ..Stage::new(2, 2, SKIN).info() }
}

/// The marker file of a phantom scene.
pub(in crate::posture) fn layout_of(scene: &Scene) -> Layout {
    Layout::parse(&scene.markers_toml(), Path::new("markers.toml")).expect("a sound marker file")
}

/// A phantom scene as a film; `pictures` are its own, or those from a file.
pub(in crate::posture) fn film<'a>(scene: &Scene, layout: &'a Layout, pictures: Vec<Picture>) -> Film<'a> {
    let radius_px = scene.options().finger.marker_px;
    let truth = (0..pictures.len())
        .map(|frame| {
            let truth = scene.truth(frame);
            (layout.markers.iter())
                .map(|marker| {
                    let place = scene.markers().iter().position(|known| known.name == marker.name);
                    let real = truth.markers[place.expect("the scene's own marker file")];
                    let in_view = if real.status == MarkerStatus::Ok { 1.0 } else { real.in_view.min(0.99) };
                    Real { at_px: real.at_px, radius_px, in_view }
                })
                .collect()
        })
        .collect();
    Film { layout, info: info(scene.options()), pictures, truth }
}

/// A film of discs, one for each marker of the layout at `places(frame)[marker]`, over `stage`; `cover` draws over
/// them.
pub(in crate::posture) fn discs<'a>(
    layout: &'a Layout,
    stage: &Stage,
    radius: f64,
    frames: usize,
    places: impl Fn(usize) -> Vec<[f64; 2]>,
    cover: impl Fn(usize) -> Vec<Disc>,
) -> Film<'a> {
    let (width, height) = (stage.format.width as f64, stage.format.height as f64);
    let (mut pictures, mut truth) = (Vec::new(), Vec::new());
    for frame in 0..frames {
        let mut stage = stage.clone();
        let places = places(frame);
        for (&at, marker) in places.iter().zip(&layout.markers) {
            stage.disc(at, radius, marker.colour);
        }
        let cover = cover(frame);
        stage.discs.extend(&cover);
        let real = |at: &[f64; 2]| {
            let gap = |disc: &Disc| (disc.at[0] - at[0]).hypot(disc.at[1] - at[1]) - disc.radius;
            let covered = cover.iter().map(gap).fold(f64::INFINITY, f64::min);
            let edge = at[0].min(at[1]).min(width - 1.0 - at[0]).min(height - 1.0 - at[1]);
            let nearest = covered.min(edge);
            Real { at_px: *at, radius_px: radius, in_view: (0.5 + 0.5 * nearest / radius).clamp(0.0, 1.0) }
        };
        truth.push(places.iter().map(real).collect());
        pictures.push(stage.picture(frame as u64));
    }
    Film { layout, info: stage.info(), pictures, truth }
}
