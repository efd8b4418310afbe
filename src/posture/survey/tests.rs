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
    options.seconds = 0.5;
    let scene = Scene::new(options).unwrap();
    let info = info(scene.options());
    let doubts = |exchanged: Option<[&str; 2]>, joint: &str| {
        let mut layout = layout_of(&scene);
        if let Some(names) = exchanged {
            let [a, b] = names.map(|name| layout.markers.iter().position(|marker| marker.name == name).unwrap());
            let colours = [a, b].map(|marker| layout.markers[marker].colour);
            (layout.markers[a].colour, layout.markers[b].colour) = (colours[1], colours[0]);
        }
        let layout = layout.wanting(&[joint.to_owned()]).unwrap();
        let mut surveyor = Surveyor::new(&layout, &info);
        for k in 0..10 {
            if surveyor.look(&scene.picture(k).frame(k as u64, 0.0)) == Progress::Enough {
                break;
            }
        }
        surveyor.finish().unwrap().doubts
    };
    for joint in ["J1", "J2", "J3"] {
        assert_eq!(doubts(None, joint), Vec::<String>::new(), "{joint}");
    }
    for (exchanged, joint, segment) in
        [(["middle_dist", "distal_dist"], "J2", "middle"), (["proximal_dist", "middle_dist"], "J1", "proximal")]
    {
        let doubts = doubts(Some(exchanged), joint);
        assert!(doubts.len() == 1 && doubts[0].contains(&format!("segment {segment} ")), "{exchanged:?}: {doubts:?}");
    }
}
