use std::path::Path;

use super::*;
use crate::flexion::Flexion;
use crate::phantom::finger::MarkerLayout;
use crate::phantom::trajectory::Trajectory;
use crate::phantom::video::{Colours, Scene, VideoOptions};
use crate::posture::layout::Layout;
use crate::posture::stage::{PAINT, PINK, SKIN, Stage, WALL};
use crate::posture::survey::Surveyor;
use crate::posture::track::scenes;

const NAIL: [u8; 3] = [0xc9, 0x83, 0x78];

/// A start is this near to its marker; measured up to 1 px.
const START_TOLERANCE_PX: f64 = 2.0;

/// Few frames of a scene that bends, far apart in time.
fn scene(layout: MarkerLayout, colours: Colours) -> Scene {
    let mut options = VideoOptions::sized(640, 360);
    options.noise_sd = 2.0;
    options.colours = colours;
    options.finger.layout = layout;
    options.seconds = 1.5;
    options.trajectory = Trajectory::Eq27 { hz: 0.4 };
    Scene::new(options).unwrap()
}

#[test]
fn the_file_names_the_markers_of_a_finger_and_runs() {
    for layout in [MarkerLayout::Pairs, MarkerLayout::Joints] {
        for colours in [Colours::Pairs, Colours::Distinct, Colours::Red] {
            let scene = scene(layout, colours);
            let info = scenes::info(scene.options());
            let mut suggester = Suggester::new(&info);
            for k in (0..scene.frames()).step_by(FIRST_STRIDE as usize) {
                suggester.look(&scene.picture(k).frame(k as u64, scene.time_s(k)));
            }
            let text = suggester.finish().unwrap();
            let suggested = Layout::parse(&text, Path::new("m.toml")).unwrap_or_else(|e| panic!("{e}\n{text}"));
            assert_eq!(suggested.flexion, Flexion::Clockwise, "{text}");
            assert_eq!(suggested.joints.len(), 3, "{layout:?} {colours:?}\n{text}");
            let truth = scene.truth(0);
            assert_eq!(suggested.markers.len(), truth.markers.len(), "{text}");
            for (start, real) in suggested.start.iter().zip(&truth.markers) {
                let start = start.expect("a place in the first frame");
                let off = (start[0] - real.at_px[0]).hypot(start[1] - real.at_px[1]);
                assert!(off <= START_TOLERANCE_PX, "{layout:?} {colours:?}: {off} px off\n{text}");
            }
            let mut surveyor = Surveyor::new(&suggested, &info);
            for k in 0..3 {
                surveyor.look(&scene.picture(k).frame(k as u64, scene.time_s(k)));
            }
            assert!(surveyor.finish().is_ok_and(|survey| survey.unseen.is_empty()), "{text}");
        }
    }
}

#[test]
fn nothing_that_looks_like_a_marker_is_said() {
    let mut stage = Stage::new(320, 200, WALL);
    stage.disc([160.0, 100.0], 90.0, SKIN);
    assert_eq!(suggested(&[stage]), Err(SuggestError::Nothing { frames: 1 }));
}

#[test]
fn one_marker_is_a_file_without_segments() {
    let mut stage = Stage::new(320, 200, WALL);
    stage.disc([160.0, 100.0], 12.0, PINK);
    let text = suggested(&[stage]).unwrap();
    let layout = Layout::parse(&text, Path::new("m.toml")).unwrap();
    assert_eq!(layout.markers.len(), 1);
    assert!(layout.segments.is_empty());
    assert!(layout.markers[0].name.starts_with("pink"), "{text}");
}

fn suggested(stages: &[Stage]) -> Result<String, SuggestError> {
    let info = stages[0].info();
    let mut suggester = Suggester::new(&info);
    for (k, stage) in stages.iter().enumerate() {
        suggester.look(&stage.picture(k as u64).frame(k as u64 * FIRST_STRIDE, 0.0));
    }
    suggester.finish()
}

/// Places of marks on a finger that bends, in frame `k`.
fn places(k: usize) -> [[f64; 2]; 4] {
    let (sin, cos) = (0.2 * k as f64).sin_cos();
    [[60.0, 60.0], [130.0, 62.0], [190.0, 70.0], [190.0 + 50.0 * cos, 70.0 + 50.0 * sin]]
}

#[test]
fn skin_is_no_marker() {
    let with = |ground: [u8; 3], colour: [u8; 3]| -> Vec<Stage> {
        let stage = |k: usize| {
            let mut stage = Stage::new(320, 200, ground);
            for at in places(k) {
                stage.disc(at, 8.0, colour);
            }
            stage
        };
        (0..6).map(stage).collect()
    };
    // Fingertips before a wall, and nails on a hand.
    for (ground, colour) in [(WALL, SKIN), (SKIN, NAIL)] {
        assert_eq!(suggested(&with(ground, colour)), Err(SuggestError::Nothing { frames: 6 }));
    }
    assert!(suggested(&with(WALL, PINK)).is_ok(), "stickers that move are markers wherever they are");
}

#[test]
fn dots_of_one_dark_paint_get_their_places() {
    let stage = |k: usize| {
        let mut stage = Stage::new(320, 200, SKIN);
        // Sizes of dots differ, and a nail lies between them.
        for (at, radius) in places(k).into_iter().zip([7.0, 9.0, 5.5, 6.0]) {
            stage.disc(at, radius, PAINT);
        }
        stage.disc([100.0, 140.0], 8.0, NAIL);
        stage
    };
    let stages: Vec<Stage> = (0..6).map(stage).collect();
    let text = suggested(&stages).unwrap();
    let layout = Layout::parse(&text, Path::new("m.toml")).unwrap();
    assert_eq!(layout.markers.len(), 4, "{text}");
    let starts =
        layout.start.iter().flatten().filter(|start| {
            places(0).iter().any(|at| (at[0] - start[0]).hypot(at[1] - start[1]) <= START_TOLERANCE_PX)
        });
    assert_eq!(starts.count(), 4, "{text}");
}
