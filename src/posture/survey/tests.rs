use super::*;
use crate::phantom::video::{Scene, Siting as Drawn, VideoOptions};
use crate::posture::track::scenes::{info, layout_of};

#[test]
fn where_chroma_lies_is_seen_from_the_markers() {
    for (drawn, expected) in [(Drawn::Left, (0.0, 0.5)), (Drawn::Centre, (0.5, 0.5))] {
        let mut options = VideoOptions::sized(640, 360);
        options.siting = drawn;
        options.seconds = 0.5;
        let scene = Scene::new(options).unwrap();
        let (layout, info) = (layout_of(&scene), info(scene.options()));
        let mut surveyor = Surveyor::new(&layout, &info);
        for k in 0..3 {
            surveyor.look(&scene.picture(k).frame(k as u64, 0.0));
        }
        let siting = surveyor.finish().unwrap().siting;
        assert_eq!((siting.dx_px, siting.dy_px), expected, "{drawn:?}");
    }
}

#[test]
fn colours_that_are_exchanged_leave_a_mark_without_a_name() {
    let mut options = VideoOptions::sized(640, 360);
    options.seconds = 1.0;
    let scene = Scene::new(options).unwrap();
    let info = info(scene.options());
    let doubts = |layout: Layout, joint: &str| {
        let layout = layout.wanting(&[joint.to_owned()]).unwrap();
        let mut surveyor = Surveyor::new(&layout, &info);
        for k in 0..scene.frames() {
            if surveyor.look(&scene.picture(k).frame(k as u64, 0.0)) == Progress::Enough {
                break;
            }
        }
        surveyor.finish().unwrap().doubts
    };
    for joint in ["J1", "J2", "J3"] {
        assert_eq!(doubts(layout_of(&scene), joint), Vec::<String>::new(), "{joint}");
    }
    let mut exchanged = layout_of(&scene);
    let [a, b] = ["middle_dist", "distal_dist"]
        .map(|name| exchanged.markers.iter().position(|marker| marker.name == name).unwrap());
    (exchanged.markers[a].colour, exchanged.markers[b].colour) =
        (exchanged.markers[b].colour, exchanged.markers[a].colour);
    let doubts = doubts(exchanged, "J2");
    assert!(doubts.len() == 1 && doubts[0].contains("middle_dist of segment middle lies a mark"), "{doubts:?}");
}
