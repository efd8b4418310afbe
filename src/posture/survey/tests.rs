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
