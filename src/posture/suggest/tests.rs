use std::path::Path;

use super::*;
use crate::flexion::Flexion;
use crate::phantom::finger::MarkerLayout;
use crate::phantom::trajectory::Trajectory;
use crate::phantom::video::{Colours, Scene, VideoOptions};
use crate::posture::layout::Layout;
use crate::posture::stage::{PINK, SKIN, Stage, WALL};
use crate::posture::survey::Surveyor;
use crate::posture::track::scenes;

/// A start is this near to its marker; measured up to 1 px.
const START_TOLERANCE_PX: f64 = 2.0;

/// Few frames of a scene that bends, far apart in time.
fn scene(layout: MarkerLayout, colours: Colours) -> Scene {
    let mut options = VideoOptions::sized(640, 360);
    options.noise_sd = 2.0;
    options.colours = colours;
    options.finger.layout = layout;
    options.seconds = 3.0;
    options.trajectory = Trajectory::Eq27 { hz: 0.2 };
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
    let info = stage.info();
    let mut suggester = Suggester::new(&info);
    suggester.look(&stage.picture(1).frame(0, 0.0));
    assert_eq!(suggester.finish(), Err(SuggestError::Nothing { frames: 1 }));
}

#[test]
fn one_marker_is_a_file_without_segments() {
    let mut stage = Stage::new(320, 200, WALL);
    stage.disc([160.0, 100.0], 12.0, PINK);
    let info = stage.info();
    let mut suggester = Suggester::new(&info);
    suggester.look(&stage.picture(1).frame(0, 0.0));
    let text = suggester.finish().unwrap();
    let layout = Layout::parse(&text, Path::new("m.toml")).unwrap();
    assert_eq!(layout.markers.len(), 1);
    assert!(layout.segments.is_empty());
    assert!(layout.markers[0].name.starts_with("pink"), "{text}");
}
