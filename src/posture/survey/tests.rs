use super::*;
use crate::phantom::video::{Scene, Siting as Drawn, VideoOptions};
use crate::posture::stage::{SKIN, Stage};
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

#[test]
fn a_disc_that_no_outline_parts_from_its_ground_is_in_doubt() {
    const RED: [u8; 3] = [0xc0, 0x60, 0x48];
    const BETWEEN: [u8; 3] = [0xc6, 0x78, 0x5c];
    let text = "flexion = 'clockwise'\nmarkers = { a = '#c06048', b = '#c06048', c = '#c06048', d = '#c06048' }\n\
                segments = { one = ['a', 'b'], two = ['c', 'd'] }\njoints = { J2 = ['one', 'two'] }\n\
                start = { a = [40, 60], b = [90, 60], c = [150, 60], d = [200, 70] }\n";
    let layout = Layout::parse(text, std::path::Path::new("m.toml")).unwrap();
    let survey = |fold: bool| {
        let mut stage = Stage::new(240, 130, SKIN);
        if fold {
            (50..131).for_each(|x| {
                stage.disc([f64::from(x), 60.0], 3.5, BETWEEN);
            });
        }
        for at in [[40.0, 60.0], [90.0, 60.0], [150.0, 60.0], [200.0, 70.0]] {
            stage.disc(at, 10.0, RED);
        }
        let info = stage.info();
        let mut surveyor = Surveyor::new(&layout, &info);
        (0..8).for_each(|k| {
            surveyor.look(&stage.picture(k).frame(k, 0.0));
        });
        surveyor.finish().unwrap()
    };
    let sd_px = |survey: &Survey, marker: usize| survey.starts[marker].as_ref().unwrap().look.apart_px2.sqrt();
    let clear = survey(false);
    assert_eq!(clear.doubts, Vec::<String>::new());
    assert!(sd_px(&clear, 1) < 0.5, "{}", sd_px(&clear, 1));
    let unclear = survey(true);
    assert!(
        unclear.doubts.iter().any(|doubt| doubt.contains("parts a, b from what is around")),
        "{:?}",
        unclear.doubts
    );
    assert!(sd_px(&unclear, 1) > 2.0 && sd_px(&unclear, 3) < 0.5, "{}", sd_px(&unclear, 1));
}
