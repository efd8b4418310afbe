//! Blots of paint whose places are known.

use std::path::Path;

use super::*;
use crate::posture::angle::joints::Angles;
use crate::posture::layout::{Layout, MarkerShape};
use crate::posture::marker::looks::look::Look;
use crate::posture::marker::method::Method;
use crate::posture::marker::sight::{Centre, Sight};
use crate::posture::stage::{self, PAINT, SKIN, Stage};
use crate::posture::survey::{Progress, Surveyor};
use crate::posture::track::Tracker;

/// Four marks of one paint, all in a row.
const MARKS: &str = "flexion = \"clockwise\"
[markers]
hand = \"#2b4b10\"
near = \"#2b4b10\"
middle = \"#2b4b10\"
tip = \"#2b4b10\"
[segments]
first = [\"hand\", \"near\"]
second = [\"near\", \"middle\"]
third = [\"middle\", \"tip\"]
[joints]
J1 = [\"first\", \"second\"]
J2 = [\"second\", \"third\"]
[start]
hand = [60, 110]
near = [140, 104]
middle = [205, 100]
tip = [260, 97]
";

/// A finger that bends twice in 60 frames.
fn finger(frame: u64) -> Stage {
    let bend = 0.5 - 0.5 * (frame as f64 / 60.0 * 2.0 * std::f64::consts::TAU).cos();
    let mut stage = Stage::new(320, 240, SKIN);
    stage.light = 1.0 + 0.05 * (frame as f64 * 0.7).sin();
    let (mut at, mut turn_rad) = ([60.0, 110.0], -0.07);
    for (kind, (length, joint)) in [(80.0, 0.0), (65.0, 0.9), (55.0, 0.7), (0.0, 0.0)].into_iter().enumerate() {
        let stretch = [1.15 + 0.2 * bend, 0.85];
        stage.blots.push(stage::Blot {
            at,
            radius: 10.0 + kind as f64,
            colour: PAINT,
            kind: kind as u64,
            turn_rad,
            stretch,
        });
        turn_rad += joint * bend;
        at = [at[0] + length * turn_rad.cos(), at[1] + length * turn_rad.sin()];
    }
    stage
}

/// An angle's error and its standard errors, that of noise and outline and that of the outline alone.
#[derive(Debug, Clone, Copy)]
struct Miss {
    error_deg: f64,
    sd_deg: f64,
    lasting_sd_deg: f64,
}

/// What 60 frames show of both joints, each frame's first four blots being the marks; none where an angle is missing.
fn followed(text: &str, stage: impl Fn(u64) -> Stage) -> (Vec<[Option<Miss>; 2]>, Tracker) {
    let layout = Layout::parse(text, Path::new("markers.toml")).unwrap();
    let info = stage(0).info();
    let pictures: Vec<_> = (0..60).map(|frame| stage(frame).picture(frame)).collect();
    let mut surveyor = Surveyor::new(&layout, &info);
    for (k, picture) in pictures.iter().enumerate() {
        if surveyor.look(&picture.frame(k as u64, 0.0)) == Progress::Enough {
            break;
        }
    }
    let survey = surveyor.finish().unwrap();
    let mut tracker = Tracker::new(&layout, &survey, &info, Method::default());
    let (mut angles, mut real) = (Angles::new(&layout, &info), Angles::new(&layout, &info));
    let mut misses = Vec::new();
    for (k, picture) in pictures.iter().enumerate() {
        let seen = angles.step(tracker.step(&picture.frame(k as u64, 0.0)));
        let centres: Vec<Sight> = (stage(k as u64).blots[..4].iter())
            .map(|blot| {
                let at_px = blot.centroid();
                Sight::Seen(Centre { at_px, covariance_px2: [0.0; 3], lasting_px2: [0.0; 3], radius_px: 10.0 })
            })
            .collect();
        let real = real.step(&centres);
        misses.push([0, 1].map(|joint| {
            let seen = seen.angles[joint]?;
            Some(Miss {
                error_deg: (seen.rad - real.angles[joint].unwrap().rad).abs().to_degrees(),
                sd_deg: seen.sd_rad.to_degrees(),
                lasting_sd_deg: seen.lasting_sd_rad.to_degrees(),
            })
        }));
    }
    (misses, tracker)
}

#[test]
fn angles_between_blots_are_right_within_their_standard_errors() {
    for (text, shape) in [(MARKS.to_owned(), "left open"), (format!("shape = \"blot\"\n{MARKS}"), "said")] {
        let (misses, tracker) = followed(&text, finger);
        let seen: Vec<Miss> = misses.iter().flatten().flatten().copied().collect();
        let missing = 2 * misses.len() - seen.len();
        let within = seen.iter().filter(|miss| miss.error_deg <= miss.sd_deg).count();
        assert!(seen.iter().all(|miss| miss.lasting_sd_deg > 0.0 && miss.lasting_sd_deg < miss.sd_deg));
        let mut errors_deg: Vec<f64> = seen.iter().map(|miss| miss.error_deg).collect();
        errors_deg.sort_by(f64::total_cmp);
        let share = within as f64 / errors_deg.len() as f64;
        let median = errors_deg[errors_deg.len() / 2];
        println!(
            "shape {shape}: median error {median:.3} degrees, within one standard error {share:.2}, {missing} missing"
        );
        (0..4).for_each(|marker| assert_eq!(tracker.shape(marker), Some(MarkerShape::Blot)));
        assert!(missing <= 2, "{missing} missing");
        assert!(median <= 0.05, "{median} degrees");
        // No skin bends here, which the standard errors allow for.
        assert!(share >= 0.6, "{share}");
    }
}

#[test]
fn what_is_covered_slowly_has_a_larger_standard_error_and_then_no_centre() {
    let (misses, _) = followed(MARKS, |frame| {
        let mut stage = finger(frame);
        let [x, y] = stage.blots[1].at;
        let cover =
            stage::Blot { at: [x, y + 52.0 - 0.5 * frame as f64], radius: 40.0, colour: SKIN, ..stage.blots[1] };
        stage.blots.push(cover);
        stage
    });
    let first: Vec<Option<Miss>> = misses.iter().map(|joints| joints[0]).collect();
    let seen: Vec<Miss> = first.iter().flatten().copied().collect();
    let far = seen.iter().filter(|miss| miss.error_deg > 3.0 * miss.sd_deg).count();
    let most = seen.iter().map(|miss| miss.error_deg).fold(0.0, f64::max);
    println!("{} seen, {far} beyond three standard errors, at most {most:.2} degrees off", seen.len());
    assert!(most > 1.0, "it is not covered by much: {most} degrees");
    assert!(20 * far <= seen.len(), "{far} of {}", seen.len());
    assert!(first[55..].iter().all(Option::is_none), "{:?}", &first[55..]);
}

#[test]
fn what_is_hidden_in_part_has_no_centre() {
    let mut stage = finger(0);
    let picture = stage.picture(1);
    let siting = Siting { dx_px: 0.5, dy_px: 0.5 };
    let (blot, whole) = Blot::learn(&picture.frame(0, 0.0), siting, [141.0, 103.0], 11.0).unwrap();
    let real = stage.blots[1].centroid();
    assert!((whole.at_px[0] - real[0]).hypot(whole.at_px[1] - real[1]) < 0.2);
    // Another finger comes over it.
    stage.blots.push(stage::Blot { at: [170.0, 104.0], radius: 24.0, colour: SKIN, ..stage.blots[1] });
    let picture = stage.picture(2);
    let seen = blot.outline(&picture.frame(1, 0.0), siting, [141.0, 103.0]);
    assert_eq!(seen, Err(Loss::Hidden));
}

#[test]
fn a_disc_is_no_blot() {
    let mut stage = Stage::new(120, 100, SKIN);
    stage.disc([60.2, 49.7], 10.0, PAINT);
    let picture = stage.picture(3);
    let siting = Siting { dx_px: 0.5, dy_px: 0.5 };
    let look = Look::learn(&picture.frame(0, 0.0), siting, [60.0, 50.0], 10.0, &mut Default::default());
    assert!(look.is_some_and(|look| look.blot.is_none()));
}

#[test]
fn paint_that_is_thin_on_one_side_has_a_larger_standard_error() {
    let siting = Siting { dx_px: 0.5, dy_px: 0.5 };
    let seen = |thin: f64| {
        let mut stage = finger(0);
        let mark = stage.blots[1];
        // Paint of which a share lies on the skin, and on half of it all of it.
        let colour =
            std::array::from_fn(|k| (thin * f64::from(PAINT[k]) + (1.0 - thin) * f64::from(SKIN[k])).round() as u8);
        stage.blots[1] = stage::Blot { colour, ..mark };
        let [x, y] = mark.at;
        stage.blots.push(stage::Blot { at: [x - 5.0, y], radius: 0.6 * mark.radius, ..mark });
        let (_, outline) = Blot::learn(&stage.picture(1).frame(0, 0.0), siting, [x - 3.0, y], 8.0).unwrap();
        let real = mark.centroid();
        let off_px = (outline.at_px[0] - real[0]).hypot(outline.at_px[1] - real[1]);
        (off_px, (outline.lasting_px2[0] + outline.lasting_px2[2]).sqrt())
    };
    let [(whole_off_px, whole_sd_px), (off_px, sd_px)] = [seen(1.0), seen(0.35)];
    println!("whole: {whole_off_px:.2} px off of {whole_sd_px:.2}, thin: {off_px:.2} of {sd_px:.2}");
    assert!(whole_off_px < 0.3 && whole_sd_px < 0.3, "{whole_off_px} {whole_sd_px}");
    assert!(off_px > 1.0 && off_px < 2.0 * sd_px, "{off_px} {sd_px}");
}
