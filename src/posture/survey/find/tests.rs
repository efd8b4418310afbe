use super::*;
use crate::posture::stage::{BLACK, BLUE, GREEN, PINK, RED, SKIN, Stage, WALL, YELLOW};
use crate::video::Matrix;

/// Places are good to this; measured up to 0.6 px (a grid sample is 2 px).
const PLACE_TOLERANCE_PX: f64 = 1.2;

fn blobs(stage: &Stage, colour: [u8; 3]) -> Vec<Blob> {
    let picture = stage.picture(7);
    let frame = picture.frame(0, 0.0);
    let paint = Paint::new(colour, &Matrix::BT709, frame.chroma.is_none());
    let (mut finder, mut blobs) = (Finder::default(), Vec::new());
    finder.load(&frame, None);
    finder.find(&frame, &paint, &mut blobs);
    blobs
}

/// The first blob lies at the place and has about the radius.
fn assert_first(blobs: &[Blob], at: [f64; 2], radius: f64) {
    let blob = blobs.first().expect("a blob");
    let off = (blob.at_px[0] - at[0]).hypot(blob.at_px[1] - at[1]);
    assert!(off <= PLACE_TOLERANCE_PX, "{off} px off");
    assert!((blob.radius_px() / radius - 1.0).abs() <= 0.25, "radius {} not {radius}", blob.radius_px());
}

#[test]
fn every_colour_is_found_on_skin_and_on_a_wall() {
    for ground in [SKIN, WALL] {
        for colour in [PINK, BLUE, GREEN, YELLOW, RED] {
            for radius in [3.5, 10.5, 24.0] {
                let mut stage = Stage::new(320, 200, ground);
                let at = [101.3, 88.6];
                stage.disc(at, radius, colour);
                let found = blobs(&stage, colour);
                eprintln!("{colour:?} {ground:?} {radius}: {:?}", found.first().map(|b| (b.radius_px(), b.contrast)));
                assert_first(&found, at, radius);
                assert!(found.len() < 2 || found[1].contrast < 0.5 * found[0].contrast, "{colour:?}: {found:?}");
            }
        }
    }
}

#[test]
fn light_scales_a_colour_and_does_not_hide_it() {
    for light in [0.3, 0.6, 2.0] {
        for colour in [PINK, BLUE, GREEN, YELLOW, RED] {
            let mut stage = Stage::new(320, 200, SKIN);
            stage.light = light;
            stage.disc([150.0, 90.0], 10.0, colour);
            assert_first(&blobs(&stage, colour), [150.0, 90.0], 10.0);
        }
    }
}

#[test]
fn a_ground_of_a_colour_is_no_blob_and_hides_none() {
    // A desk of a paler blue under the right half, and a hand-sized patch of red cloth.
    let mut stage = Stage::new(640, 400, WALL);
    stage.disc([500.0, 200.0], 140.0, [0x50, 0x90, 0xd0]);
    stage.disc([490.0, 210.0], 10.0, BLUE);
    stage.disc([100.0, 100.0], 70.0, RED);
    stage.disc([100.0, 300.0], 10.0, RED);
    assert_first(&blobs(&stage, BLUE), [490.0, 210.0], 10.0);
    let red = blobs(&stage, RED);
    assert_first(&red, [100.0, 300.0], 10.0);
    assert!(red.iter().all(|blob| blob.radius_px() < 40.0), "{red:?}");
}

#[test]
fn dark_markers_in_grey_video() {
    let mut stage = Stage::new(320, 200, SKIN);
    stage.format.subsampling = None;
    stage.disc([80.0, 60.0], 8.0, BLACK).disc([200.0, 140.0], 8.0, BLACK);
    let found = blobs(&stage, BLACK);
    assert_eq!(found.iter().filter(|blob| blob.contrast > 0.3).count(), 2, "{found:?}");
    // A blue marker is dark in grey video.
    assert_eq!(blobs(&stage, [0x10, 0x20, 0xa0]).iter().filter(|blob| blob.contrast > 0.3).count(), 2);
}

#[test]
fn chroma_of_every_layout_and_odd_sizes() {
    for (subsampling, depth) in [(Some((1, 1)), 8), (Some((2, 1)), 8), (Some((2, 2)), 10), (Some((1, 1)), 10)] {
        let mut stage = Stage::new(321, 203, SKIN);
        stage.format.subsampling = subsampling;
        stage.format.depth = depth;
        stage.disc([300.0, 190.0], 7.0, GREEN).disc([100.0, 100.0], 8.0, BLACK);
        assert_first(&blobs(&stage, GREEN), [300.0, 190.0], 7.0);
        assert_first(&blobs(&stage, BLACK), [100.0, 100.0], 8.0);
    }
}

#[test]
fn part_of_a_frame_gives_the_same_blob() {
    let mut stage = Stage::new(320, 200, SKIN);
    stage.disc([101.0, 88.0], 9.0, PINK);
    let picture = stage.picture(1);
    let frame = picture.frame(0, 0.0);
    let paint = Paint::new(PINK, &Matrix::BT709, false);
    let (mut finder, mut part) = (Finder::default(), Vec::new());
    finder.load(&frame, Some(Area::about([95.0, 95.0], 40.0)));
    finder.find(&frame, &paint, &mut part);
    assert_first(&part, [101.0, 88.0], 9.0);
    assert!(!part[0].at_the_border);
    finder.load(&frame, Some(Area::about([-500.0, 95.0], 40.0)));
    finder.find(&frame, &paint, &mut part);
    assert!(part.is_empty());
}

#[test]
fn the_picture_s_border_is_told() {
    let mut stage = Stage::new(320, 200, SKIN);
    stage.disc([2.0, 88.0], 9.0, PINK);
    let found = blobs(&stage, PINK);
    assert!(found[0].at_the_border);
}

#[test]
fn markers_near_one_another_are_two_blobs() {
    let mut stage = Stage::new(320, 200, SKIN);
    stage.disc([100.0, 88.0], 8.0, RED).disc([119.0, 88.0], 8.0, RED);
    let found = blobs(&stage, RED);
    assert!(found.len() >= 2 && found[1].contrast > 0.3, "{found:?}");
}
