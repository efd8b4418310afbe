//! Outlines from masks: extents, sub-pixel places, borders, depths, and what is no mask.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use image::{DynamicImage, GrayImage, ImageBuffer, Luma, LumaA, Rgb, RgbImage, Rgba};
use lunula::photo::outline::{MaskFault, Moments, Outline, outlines_from_mask};

fn extent(outline: &Outline) -> [[f64; 2]; 2] {
    let points = outline.points();
    [0, 1].map(|k| {
        let all = points.iter().map(|p| p[k]);
        [all.clone().fold(f64::MAX, f64::min), all.fold(f64::MIN, f64::max)]
    })
}

/// White where `inside`.
fn drawn(width: u32, height: u32, inside: impl Fn(u32, u32) -> bool) -> GrayImage {
    GrayImage::from_fn(width, height, |x, y| Luma([if inside(x, y) { 255 } else { 0 }]))
}

fn in_box(x: u32, y: u32, [x0, x1]: [u32; 2], [y0, y1]: [u32; 2]) -> bool {
    (x0..=x1).contains(&x) && (y0..=y1).contains(&y)
}

fn only(mask: &DynamicImage) -> Outline {
    let found = outlines_from_mask(mask).unwrap();
    assert_eq!((found.nails.len(), found.dropped.len()), (1, 0));
    found.nails[0].clone()
}

/// Marching squares cuts a pixel rectangle's four corners, an eighth of a pixel each.
const CORNERS_PX2: f64 = 0.5;

#[test]
fn a_rectangle_is_as_wide_as_its_pixels() {
    let outline = only(&drawn(60, 50, |x, y| in_box(x, y, [10, 29], [7, 40])).into());
    assert_eq!(extent(&outline), [[9.5, 29.5], [6.5, 40.5]]);
    assert!((outline.area_px2() - (20.0 * 34.0 - CORNERS_PX2)).abs() <= 1e-9);
    assert!(Moments::of(&outline).centroid_px.iter().zip([19.5, 23.5]).all(|(a, b)| (a - b).abs() <= 1e-9));
}

#[test]
fn a_region_at_the_border_ends_at_the_pixel_edges() {
    for (xs, ys) in [([0, 19], [0, 9]), ([40, 59], [30, 49]), ([0, 59], [0, 49])] {
        let outline = only(&drawn(60, 50, |x, y| in_box(x, y, xs, ys)).into());
        let edges = [xs, ys].map(|[a, b]| [f64::from(a) - 0.5, f64::from(b) + 0.5]);
        assert_eq!(extent(&outline), edges);
    }
    // Grey at the border: the region goes on outside, its level line does not bend back.
    let grey = GrayImage::from_pixel(20, 20, Luma([200]));
    assert_eq!(extent(&only(&grey.into())), [[-0.5, 19.5], [-0.5, 19.5]]);
}

#[test]
fn an_antialiased_disc_keeps_its_place() {
    let (centre, radius) = ([30.3, 24.8], 15.2);
    let covered = |x: u32, y: u32| {
        let inside = (0..256).filter(|k| {
            let (i, j) = (f64::from(k % 16), f64::from(k / 16));
            let (px, py) = (f64::from(x) + (i + 0.5) / 16.0 - 0.5, f64::from(y) + (j + 0.5) / 16.0 - 0.5);
            (px - centre[0]).hypot(py - centre[1]) < radius
        });
        inside.count() as f64 / 256.0
    };
    let mask = GrayImage::from_fn(64, 56, |x, y| Luma([(255.0 * covered(x, y)).round() as u8]));
    let outline = only(&mask.into());
    // Measured: 0.017 px, 0.16 % of the area (straight pieces inside the arc).
    let place = Moments::of(&outline).centroid_px;
    assert!((place[0] - centre[0]).hypot(place[1] - centre[1]) <= 0.03);
    assert!((outline.area_px2() / (std::f64::consts::PI * radius * radius) - 1.0).abs() <= 0.005);
    // Every corner lies on the circle; measured: within 0.097 px.
    let corners = outline.points();
    let off = corners.iter().map(|p| ((p[0] - centre[0]).hypot(p[1] - centre[1]) - radius).abs());
    assert!(off.fold(0.0, f64::max) <= 0.12);
}

#[test]
fn every_depth_and_colour_gives_the_same() {
    let inside = |x, y| in_box(x, y, [5, 24], [6, 35]);
    let expected = only(&drawn(40, 44, inside).into());
    let masks: [DynamicImage; 6] = [
        ImageBuffer::from_fn(40, 44, |x, y| Luma([if inside(x, y) { u16::MAX } else { 0 }])).into(),
        RgbImage::from_fn(40, 44, |x, y| Rgb(if inside(x, y) { [255, 0, 0] } else { [0; 3] })).into(),
        ImageBuffer::from_fn(40, 44, |x, y| Rgba([255, 255, 255, if inside(x, y) { 255u8 } else { 0 }])).into(),
        ImageBuffer::from_fn(40, 44, |x, y| Rgb([if inside(x, y) { u16::MAX } else { 0 }; 3])).into(),
        ImageBuffer::from_fn(40, 44, |x, y| LumaA([if inside(x, y) { 255u8 } else { 0 }, 255])).into(),
        ImageBuffer::from_fn(40, 44, |x, y| Rgb([if inside(x, y) { 1.0f32 } else { 0.0 }; 3])).into(),
    ];
    for mask in masks {
        assert_eq!(only(&mask), expected, "{:?}", mask.color());
    }
}

#[test]
fn holes_are_filled_and_specks_dropped() {
    let mask = drawn(100, 80, |x, y| {
        let nail = in_box(x, y, [20, 59], [20, 69]) && !in_box(x, y, [30, 40], [30, 40]);
        nail || in_box(x, y, [80, 83], [10, 13]) || (x, y) == (5, 5)
    });
    let found = outlines_from_mask(&mask.into()).unwrap();
    assert_eq!(found.nails.len(), 1);
    assert!((found.nails[0].area_px2() - (40.0 * 50.0 - CORNERS_PX2)).abs() <= 1e-9);
    let mut dropped: Vec<_> = found.dropped.iter().map(|d| (d.center_px, d.extent_px)).collect();
    dropped.sort_by(|a, b| a.0[0].total_cmp(&b.0[0]));
    assert_eq!(dropped, [([5.0, 5.0], [1.0, 1.0]), ([81.5, 11.5], [4.0, 4.0])]);
}

#[test]
fn nails_come_from_top_to_bottom_and_left_to_right() {
    let places = [[70, 10], [10, 10], [40, 40], [10, 70]];
    let mask = drawn(100, 100, |x, y| places.iter().any(|&[a, b]| in_box(x, y, [a, a + 9], [b, b + 14])));
    let found = outlines_from_mask(&mask.into()).unwrap();
    let centres: Vec<[f64; 2]> =
        found.nails.iter().map(|nail| Moments::of(nail).centroid_px.map(|c| c.round())).collect();
    // Two at the same height: left first.
    assert_eq!(centres, [[15.0, 17.0], [75.0, 17.0], [45.0, 47.0], [15.0, 77.0]]);
}

#[test]
fn numbers_of_instances_are_nails_though_they_touch() {
    let mask = GrayImage::from_fn(60, 40, |x, y| {
        Luma([if in_box(x, y, [5, 24], [5, 34]) {
            1
        } else if in_box(x, y, [25, 44], [5, 34]) {
            7
        } else {
            0
        }])
    });
    let found = outlines_from_mask(&mask.into()).unwrap();
    assert_eq!(
        found.nails.iter().map(extent).collect::<Vec<_>>(),
        [[[4.5, 24.5], [4.5, 34.5]], [[24.5, 44.5], [4.5, 34.5]]]
    );
}

#[test]
fn black_is_empty_and_grey_is_refused() {
    assert_eq!(outlines_from_mask(&GrayImage::new(30, 20).into()), Ok(Default::default()));
    let faint = drawn(40, 40, |x, y| in_box(x, y, [5, 24], [5, 34]));
    let faint = GrayImage::from_fn(40, 40, |x, y| Luma([faint.get_pixel(x, y).0[0] / 3]));
    let Err(MaskFault::Range { largest, full }) = outlines_from_mask(&faint.into()) else { panic!("not refused") };
    assert_eq!((largest, full), (85.0, 255.0));
    // Eight-bit levels stored in sixteen bits.
    let stored = ImageBuffer::from_fn(40, 40, |x, y| Luma([if in_box(x, y, [5, 24], [5, 34]) { 255u16 } else { 0 }]));
    assert!(matches!(outlines_from_mask(&stored.into()), Err(MaskFault::Range { .. })));
    // The noise of a black picture is no list of nails.
    let noisy = GrayImage::from_fn(90, 90, |x, y| Luma([u8::from(x % 3 == 0 && y % 3 == 0) * 2]));
    assert!(matches!(outlines_from_mask(&noisy.into()), Err(MaskFault::Noise { .. })));
}

#[test]
fn touching_corners_make_one_region_without_a_fault() {
    // Two squares that share a corner only: whatever is found must be valid and lose no area.
    let mask = drawn(50, 50, |x, y| in_box(x, y, [5, 19], [5, 19]) || in_box(x, y, [20, 34], [20, 34]));
    let found = outlines_from_mask(&mask.into()).unwrap();
    assert!(found.dropped.is_empty());
    let area: f64 = found.nails.iter().map(Outline::area_px2).sum();
    assert!((area - 450.0).abs() <= 2.0 * CORNERS_PX2);
}
