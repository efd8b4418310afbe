use super::*;
use crate::photo::outline::Axis;
use image::{GrayImage, Luma};
use proptest::prelude::*;

fn values(image: &DynamicImage, frame: &NailFrame, with: &Normalization) -> Option<Vec<f32>> {
    let mut buffers = Buffers::default();
    super::values(image, frame, with, &mut buffers).then_some(buffers.values)
}

fn frame(center_px: [f64; 2], length_px: f64, width_px: f64, degrees: f64) -> NailFrame {
    NailFrame { center_px, length_px, width_px, axis: Axis::from_clockwise_rad(degrees.to_radians()) }
}

fn sized(size: usize, resample: Resample) -> Normalization {
    Normalization { size, resample, ..Normalization::default() }
}

const KINDS: [Resample; 3] = [Resample::Nearest, Resample::Linear, Resample::Cubic];

#[test]
fn a_picture_of_the_frame_s_own_pixels_is_taken_as_it_is() {
    // 80 px of nail for 80 px of result: every output centre is a pixel's centre.
    let image = GrayImage::from_fn(120, 120, |x, y| Luma([(x * 7 + y * 13) as u8]));
    let upright = frame([59.5, 59.5], 80.0, 80.0, 0.0);
    for kind in KINDS {
        let values = values(&image.clone().into(), &upright, &sized(100, kind)).expect("shown");
        for (at, value) in values.iter().enumerate() {
            let pixel = image.get_pixel(10 + at as u32 % 100, 10 + at as u32 / 100).0[0];
            assert_eq!(*value, f32::from(pixel) / 255.0, "{kind:?} at {at}");
        }
    }
}

#[test]
fn distal_is_up_whichever_way_the_nail_points() {
    // Brightness grows to the right, and the nail points there.
    let image = GrayImage::from_fn(100, 100, |x, _| Luma([2 * x as u8]));
    let right = frame([50.0, 50.0], 40.0, 40.0, 90.0);
    let shown = values(&image.into(), &right, &sized(50, Resample::Cubic)).expect("shown");
    assert!(shown[0] > 0.5 && shown[49 * 50] < 0.25);
    // Not mirrored: seen with its tip up, what was below the nail lies to its right.
    let image = GrayImage::from_fn(100, 100, |_, y| Luma([2 * y as u8]));
    let shown = values(&image.into(), &right, &sized(50, Resample::Cubic)).expect("shown");
    assert!(shown[49] > 0.5 && shown[0] < 0.25);
}

#[test]
fn an_edge_does_not_ring() {
    // A nail of 20 px enlarged twenty times.
    let image = GrayImage::from_fn(40, 40, |x, _| Luma([if x < 20 { 60 } else { 180 }]));
    for (kind, degrees) in [(Resample::Linear, 17.0), (Resample::Cubic, 17.0), (Resample::Cubic, 50.0)] {
        let values =
            values(&image.clone().into(), &frame([19.5, 19.5], 20.0, 18.0, degrees), &sized(400, kind)).expect("shown");
        let (low, high) = values.iter().fold((1.0_f32, 0.0_f32), |(l, h), &v| (l.min(v), h.max(v)));
        assert!(low >= 60.0 / 255.0 && high <= 180.0 / 255.0, "{kind:?}: {low}..{high}");
    }
}

#[test]
fn fine_stripes_do_not_alias() {
    // One pixel white, one black, a nail of 2000 px: every output pixel covers 6.25 of them.
    let image = GrayImage::from_fn(2600, 2600, |x, _| Luma([if x % 2 == 0 { 0 } else { 255 }]));
    let deviation = |kind: Resample| {
        let upright = frame([1300.0, 1300.0], 2000.0, 2000.0, 0.0);
        let values = values(&image.clone().into(), &upright, &sized(400, kind)).expect("shown");
        values.iter().map(|v| (v - 0.5).abs()).fold(0.0, f32::max)
    };
    // Measured: 0.017. A half-covered stripe at the footprint's ends is 0.5 / 6.25 = 0.08 of its mean at the worst.
    assert!(deviation(Resample::Cubic) <= 0.04, "{}", deviation(Resample::Cubic));
    assert!(deviation(Resample::Linear) <= 0.04, "{}", deviation(Resample::Linear));
    assert!(deviation(Resample::Nearest) >= 0.49);
}

#[test]
fn a_ramp_s_mean_is_its_middle_at_any_reduction() {
    // Linear pictures are reproduced exactly by every kernel, so a wrong centre of a block would show.
    let image = image::ImageBuffer::from_fn(2000, 1500, |x, y| Luma([(20 * x + 7 * y) as u16]));
    for length in [300.0, 640.0, 900.0] {
        let tilted = frame([1000.0, 750.0], length, 0.9 * length, 21.0);
        for kind in [Resample::Linear, Resample::Cubic] {
            let with = sized(80, kind);
            let values = values(&image.clone().into(), &tilted, &with).expect("shown");
            for (at, value) in values.iter().enumerate() {
                let [x, y] = tilted.photo_from_nail(
                    (at % 80) as f64 / 64.0 + 0.5 / 64.0 - 0.625,
                    0.625 - 0.5 / 64.0 - (at / 80) as f64 / 64.0,
                );
                let exact = (20.0 * x + 7.0 * y) / 65535.0;
                // Measured: 3e-7, the rounding of f32.
                assert!((f64::from(*value) - exact).abs() <= 2e-6, "{length} {kind:?} at {at}: {value} for {exact}");
            }
        }
    }
}

#[test]
fn what_lies_outside_is_not_known() {
    let white = || DynamicImage::from(GrayImage::from_pixel(60, 60, Luma([255])));
    for kind in KINDS {
        for (center, degrees) in [([0.0, 30.0], 0.0), ([59.0, 59.0], 33.0), ([30.0, 30.0], 45.0)] {
            let cut = frame(center, 70.0, 70.0, degrees);
            let values = values(&white(), &cut, &sized(100, kind)).expect("part of it");
            for (at, value) in values.iter().enumerate() {
                let [x, y] = cut.photo_from_nail(((at % 100) as f64 - 49.5) / 80.0, (49.5 - (at / 100) as f64) / 80.0);
                let shown = [x, y].iter().all(|c| (-0.5..=59.5).contains(c));
                assert!(if shown { *value == 1.0 } else { value.is_nan() }, "{kind:?} {degrees} at {at}: {value}");
            }
        }
        // An outline a picture's length away, and one that is mostly there.
        assert!(values(&white(), &frame([500.0, 30.0], 70.0, 70.0, 0.0), &sized(100, kind)).is_none());
        assert!(values(&white(), &frame([30.0, 30.0], 9000.0, 9000.0, 10.0), &sized(100, kind)).is_some());
    }
}

#[test]
fn a_single_pixel_is_a_photograph() {
    for kind in KINDS {
        let values = values(
            &GrayImage::from_pixel(1, 1, Luma([51])).into(),
            &frame([0.0, 0.0], 4.0, 4.0, 5.0),
            &sized(80, kind),
        )
        .expect("part of it");
        let shown: Vec<f32> = values.into_iter().filter(|v| !v.is_nan()).collect();
        assert!(!shown.is_empty() && shown.iter().all(|&v| v == 0.2), "{kind:?}");
    }
}

/// Largest and root mean square difference between the fast way and its plain twin on white noise of full range seen
/// with an optical spread of 1 px, the harshest picture that a camera makes. Measured over 300 cases: 3.4 and 0.46 of
/// 255.
const TWINS_DIFFER_OF_255: [f64; 2] = [5.0, 0.6];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn two_passes_give_what_one_gives(
        degrees in -30.0_f64..30.0,
        flip in any::<bool>(),
        length in 60.0_f64..115.0,
        seed in any::<u64>(),
    ) {
        let noise = GrayImage::from_fn(200, 200, |x, y| {
            let mixed = (u64::from(x) << 32 | u64::from(y)).wrapping_add(seed).wrapping_mul(0x9E37_79B9_7F4A_7C15);
            Luma([(mixed >> 56) as u8])
        });
        let image = DynamicImage::from(imageproc::filter::gaussian_blur_f32(&noise, 1.0));
        let turned = frame([100.0, 100.0], length, 0.8 * length, degrees + if flip { 180.0 } else { 0.0 });
        // Columns are left over of those that are filled side by side.
        let with = sized(123, Resample::Cubic);
        let grid = Grid::new(&turned, &with);
        let source = Source::new(&image, &grid, &with, Vec::new()).expect("shown");
        prop_assert!(grid.is_nearly_upright() && source.samples == [1, 1]);
        let (mut one, mut two) = (Vec::new(), Vec::new());
        source.points(&grid, &mut one);
        source.points_in_two_passes(&grid, &mut two, &mut Vec::new());
        let differences: Vec<f64> = one
            .iter()
            .zip(&two)
            .map(|(one, two)| 255.0 * f64::from((one - two).abs()))
            .collect();
        let largest = differences.iter().copied().fold(0.0, f64::max);
        let rms = (differences.iter().map(|d| d * d).sum::<f64>() / differences.len() as f64).sqrt();
        prop_assert!(largest <= TWINS_DIFFER_OF_255[0] && rms <= TWINS_DIFFER_OF_255[1], "{largest} {rms}");
    }

    #[test]
    fn four_lines_at_once_are_each_alone_to_the_bit(
        values in prop::collection::vec(prop_oneof![9 => 0.0_f32..1.0, 1 => Just(f32::NAN)], 24),
        // The nearest phase of a later place lies between values that a line of six does not have.
        places in prop::array::uniform4(1_i64 << 32..(4 << 32) - HALF_PHASE),
    ) {
        let lines: [&[f32]; LANES] = std::array::from_fn(|k| &values[6 * k..][..6]);
        let alone: [f32; LANES] = std::array::from_fn(|k| between(lines[k], places[k], &PHASE_WEIGHTS));
        let each = between_each(lines, places, &PHASE_WEIGHTS);
        // NaN has many bits, and any of them is missing.
        let bits = |values: [f32; LANES]| values.map(|v| if v.is_nan() { None } else { Some(v.to_bits()) });
        prop_assert_eq!(bits(each), bits(alone));
    }
}
