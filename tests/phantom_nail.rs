//! What is stated of a scene is true of its photograph.

use lunula::phantom::nail::{Camera, Depth, Light, NailScene, Pose, RenderOptions, SceneFault, Subject};
use lunula::phantom::photos::{LightKind, PhotoOptions};
use ndarray::Array2;

const NOISELESS: RenderOptions = RenderOptions { depth: Depth::Sixteen, grey: false, noise_sd: 0.0, noise_seed: 0 };

fn set(light: LightKind) -> PhotoOptions {
    PhotoOptions { seed: 11, light, ..PhotoOptions::default() }
}

fn photograph(scene: &NailScene) -> Array2<f64> {
    let picture = scene.render(&NOISELESS).expect("the scene can be drawn").into_rgb16();
    let (width, height) = picture.dimensions();
    Array2::from_shape_fn((height as usize, width as usize), |(y, x)| {
        f64::from(picture.get_pixel(x as u32, y as u32).0[1]) / 65535.0
    })
}

/// Catmull-Rom over the 4 x 4 pixels around (x, y); `None` where one is missing.
fn cubic(picture: &Array2<f64>, x: f64, y: f64) -> Option<f64> {
    let weights = |t: f64| {
        [
            0.5 * t * ((2.0 - t) * t - 1.0),
            0.5 * (t * t * (3.0 * t - 5.0) + 2.0),
            0.5 * t * ((4.0 - 3.0 * t) * t + 1.0),
            0.5 * t * t * (t - 1.0),
        ]
    };
    let (x0, y0) = (x.floor() - 1.0, y.floor() - 1.0);
    if x0 < 0.0 || y0 < 0.0 {
        return None;
    }
    let (wx, wy) = (weights(x.fract()), weights(y.fract()));
    let mut sum = 0.0;
    for (i, wy) in wy.iter().enumerate() {
        for (j, wx) in wx.iter().enumerate() {
            sum += wx * wy * picture.get([y0 as usize + i, x0 as usize + j])?;
        }
    }
    Some(sum)
}

/// RMS of the truth against the photograph, resampled, in 255ths, within the nail.
fn gap_to_photograph(scene: &NailScene) -> f64 {
    let (size, margin) = (400, 1.25);
    let picture = photograph(scene);
    let truth = scene.normalized(size, margin);
    let inside = scene.inside(size, margin);
    let (mut sum, mut n) = (0.0, 0);
    for ((i, j), &value) in truth.indexed_iter() {
        let u = (j as f64 + 0.5 - 200.0) / 160.0;
        let v = -(i as f64 + 0.5 - 200.0) / 160.0;
        let [x, y] = scene.picture_from_nail(u, v);
        if inside[[i, j]]
            && let Some(seen) = cubic(&picture, x, y)
        {
            sum += (f64::from(value) - seen).powi(2);
            n += 1;
        }
    }
    assert!(n > 50_000, "only {n} pixels compared");
    (sum / f64::from(n)).sqrt() * 255.0
}

#[test]
fn truth_is_the_photograph_between_its_pixels() {
    /// 255ths of full scale, RMS; measured 0.083 at most (interpolation of glare and of the finest striations).
    const TOLERANCE: f64 = 0.12;
    let mut options = set(LightKind::Varied);
    for subject in 0..16 {
        let pose = Pose::ALL[subject as usize % 8];
        let gap = gap_to_photograph(&options.scene(subject, pose));
        assert!(gap <= TOLERANCE, "subject {subject}: {gap}");
    }
    options.light = LightKind::Chamber;
    let gap = gap_to_photograph(&options.scene(3, Pose::Normal));
    assert!(gap <= TOLERANCE, "{gap}");
}

#[test]
fn truth_of_a_large_nail_is_the_mean_over_the_pixel() {
    /// 255ths of full scale, greatest gap to 12 x 12 samples a pixel; measured 0.0036.
    const TOLERANCE: f64 = 0.01;
    let mut scene = set(LightKind::Varied).scene(5, Pose::Extension);
    scene.camera =
        Camera { width: 1600, height: 1200, centre_px: [800.0, 600.0], nail_width_px: 500.0, ..scene.camera };
    let (size, margin) = (100, 1.25);
    let truth = scene.normalized(size, margin);
    let field = scene.field();
    let mut compared = 0;
    for i in (0..size).step_by(7) {
        for j in (0..size).step_by(7) {
            let mut sum = 0.0;
            for k in 0..144 {
                let di = (f64::from(k / 12) + 0.5) / 12.0;
                let dj = (f64::from(k % 12) + 0.5) / 12.0;
                let [x, y] = scene.picture_from_nail((j as f64 + dj - 50.0) / 40.0, -(i as f64 + di - 50.0) / 40.0);
                sum += field.colour(x, y)[1];
            }
            let value = truth[[i, j]];
            if !value.is_nan() {
                let gap = (f64::from(value) - sum / 144.0).abs() * 255.0;
                assert!(gap <= TOLERANCE, "({i}, {j}): {gap}");
                compared += 1;
            }
        }
    }
    assert!(compared > 150, "{compared}");
}

#[test]
fn outline_is_where_the_colour_changes() {
    /// Pixels; measured 0.20 at most: the distal band and the shade on either side of the border shift the middle of
    /// the step.
    const TOLERANCE: f64 = 0.25;
    let mut compared = 0;
    for index in 0..8 {
        let mut subject = Subject::random(3, index);
        subject.tone = lunula::phantom::nail::Tone::new(1.0);
        for value in [
            &mut subject.crease,
            &mut subject.ridge,
            &mut subject.cuticle,
            &mut subject.free_edge,
            &mut subject.lunula,
            &mut subject.gloss,
        ] {
            *value = 0.0;
        }
        let camera = Camera { nail_width_px: 300.0, ..set(LightKind::Chamber).scene(index, Pose::Nominal).camera };
        let scene = NailScene { subject, pose: Pose::Nominal, light: Light::chamber(), camera };
        let corners = scene.outline().unwrap().points();
        let field = scene.field();
        for k in (0..corners.len()).step_by(5) {
            let (before, here) = (corners[(k + corners.len() - 1) % corners.len()], corners[k]);
            let after = corners[(k + 1) % corners.len()];
            let along = [after[0] - before[0], after[1] - before[1]];
            let length = along[0].hypot(along[1]);
            let normal = [along[1] / length, -along[0] / length];
            let green = |d: f64| field.colour(here[0] + d * normal[0], here[1] + d * normal[1])[1];
            // Far enough to be past the step, near enough for the shading to be even.
            let (one, other) = (green(-4.0), green(4.0));
            if (one - other).abs() < 0.1 {
                continue;
            }
            let middle = 0.5 * (one + other);
            let (mut low, mut high) = (-4.0, 4.0);
            for _ in 0..40 {
                let d = 0.5 * (low + high);
                if (green(d) > middle) == (one > middle) { low = d } else { high = d }
            }
            assert!(low.abs() <= TOLERANCE, "subject {index}, corner {k}: {low} px");
            compared += 1;
        }
    }
    assert!(compared > 400, "{compared}");
}

#[test]
fn extents_are_the_stated_length_and_width() {
    /// Pixels, rounding only.
    const TOLERANCE: f64 = 1e-9;
    for subject in 0..32 {
        let scene = set(LightKind::Varied).scene(subject, Pose::Flexion);
        let outline = scene.outline().unwrap();
        assert!(outline.points().len() >= 180);
        let centre = scene.camera.centre_px;
        let sides = [(scene.axis().right(), scene.width_px()), (scene.axis().distal(), scene.length_px())];
        for (direction, extent) in sides {
            let places: Vec<f64> = outline
                .points()
                .iter()
                .map(|p| (p[0] - centre[0]) * direction[0] + (p[1] - centre[1]) * direction[1])
                .collect();
            let (low, high) = places.iter().fold((0.0_f64, 0.0_f64), |(a, b), &p| (a.min(p), b.max(p)));
            assert!((high - 0.5 * extent).abs() <= TOLERANCE && (low + 0.5 * extent).abs() <= TOLERANCE);
        }
        let aspect = scene.length_px() / scene.width_px();
        assert!((0.9..=1.6).contains(&aspect));
    }
}

#[test]
fn inside_agrees_with_the_outline() {
    /// Relative; the counted pixels against the polygon's area.
    const TOLERANCE: f64 = 1e-3;
    for subject in 0..8 {
        let scene = set(LightKind::Varied).scene(subject, Pose::Normal);
        let counted = scene.inside(400, 1.25).iter().filter(|&&inside| inside).count() as f64;
        let pixel = scene.length_px() * scene.width_px() / (320.0 * 320.0);
        let ratio = counted * pixel / scene.outline().unwrap().area_px2();
        assert!((ratio - 1.0).abs() <= TOLERANCE, "{ratio}");
    }
}

fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len() as f64;
    let (ma, mb) = (mean(a), mean(b));
    let product =
        |x: &[f64], mx: f64, y: &[f64], my: f64| -> f64 { x.iter().zip(y).map(|(x, y)| (x - mx) * (y - my)).sum() };
    product(a, ma, b, mb) / (product(a, ma, a, ma) * product(b, mb, b, mb)).sqrt()
}

/// Places `[u, v]` on a grid over the nail, those within the outline.
fn grid(scene: &NailScene, n: usize) -> Vec<[f64; 2]> {
    let at = |k: usize| (2.0 * k as f64 + 1.0) / n as f64 - 1.0;
    let inside = scene.inside(n, 1.0);
    inside.indexed_iter().filter(|&(_, &inside)| inside).map(|((i, j), _)| [at(j), -at(i)]).collect()
}

fn green(scene: &NailScene, [u, v]: [f64; 2]) -> f64 {
    let [x, y] = scene.picture_from_nail(u, v);
    scene.field().colour(x, y)[1]
}

/// Green of a pose less green of the nominal one within the nail, read from left to right and from right to left.
fn change(pose: Pose) -> [Vec<f64>; 2] {
    let mut posed = set(LightKind::Chamber).scene(2, pose);
    posed.subject.nail.middle_u = 0.0;
    posed.subject.nail.skew = 0.0;
    let nominal = NailScene { pose: Pose::Nominal, ..posed.clone() };
    let places = grid(&posed, 80);
    [1.0, -1.0].map(|side| {
        places.iter().map(|&[u, v]| green(&posed, [side * u, v]) - green(&nominal, [side * u, v])).collect()
    })
}

#[test]
fn lateral_poses_almost_mirror_each_other() {
    let ([negative, _], [positive, mirrored]) = (change(Pose::LateralNegative), change(Pose::LateralPositive));
    let (as_is, turned) = (correlation(&negative, &positive), correlation(&negative, &mirrored));
    assert!(turned >= 0.9, "{turned}");
    assert!(as_is <= 0.3, "{as_is}");
    assert!(turned < 0.999, "almost, not quite: {turned}");
}

#[test]
fn poses_are_different_patterns() {
    let changes: Vec<_> = Pose::ALL[1..].iter().map(|&pose| (pose, change(pose))).collect();
    for (k, (one, [a, _])) in changes.iter().enumerate() {
        for (other, [b, _]) in &changes[..k] {
            let alike = correlation(a, b);
            // Negative longitudinal shear is "not significantly different from normal force alone" (4.2.6).
            let similar = [Pose::Normal, Pose::LongitudinalNegative];
            let bound = if similar.contains(one) && similar.contains(other) { 0.995 } else { 0.9 };
            assert!(alike <= bound, "{one} and {other}: {alike}");
        }
    }
}

#[test]
fn red_and_white_differ_mainly_in_green() {
    let mut scene = set(LightKind::Chamber).scene(4, Pose::Flexion);
    let middle = scene.picture_from_nail(0.0, 0.1);
    let red = scene.field().colour(middle[0], middle[1]);
    scene.pose = Pose::Nominal;
    let white = scene.field().colour(middle[0], middle[1]);
    let change: Vec<f64> = red.iter().zip(white).map(|(r, w)| w - r).collect();
    assert!(change[1] > 0.03, "{change:?}");
    assert!(change[0].abs() <= 0.5 * change[1] && change[2].abs() <= 0.5 * change[1], "{change:?}");
}

#[test]
fn sixteen_subjects_cover_all_tones() {
    let mut tones: Vec<f64> = (0..16).map(|index| Subject::random(5, index).tone.darkness()).collect();
    tones.sort_by(f64::total_cmp);
    for (k, tone) in tones.iter().enumerate() {
        assert!((k as f64 / 16.0..=(k + 1) as f64 / 16.0).contains(tone), "{tones:?}");
    }
    let green = |darkness: f64| lunula::phantom::nail::Tone::new(darkness).skin()[1];
    assert!(green(0.0) > 0.75 && green(1.0) < 0.3);
    let bed = |darkness: f64| lunula::phantom::nail::Tone::new(darkness).bed()[1];
    assert!(bed(0.0) - bed(1.0) < 0.3 * (green(0.0) - green(1.0)), "the bed changes far less than the skin");
}

#[test]
fn chamber_puts_the_bed_within_the_contrast_maps_range() {
    let options = set(LightKind::Chamber);
    for pose in Pose::ALL {
        let (mut sum, mut n) = (0.0, 0);
        for subject in 0..16 {
            let scene = options.scene(subject, pose);
            for place in grid(&scene, 24) {
                sum += green(&scene, place);
                n += 1;
            }
        }
        let mean = sum / f64::from(n);
        assert!((0.30..=0.50).contains(&mean), "{pose}: {mean}");
    }
}

#[test]
fn a_grey_photograph_is_the_green_channel() {
    let scene = set(LightKind::Varied).scene(1, Pose::Normal);
    for depth in [Depth::Eight, Depth::Sixteen] {
        let options = RenderOptions { depth, ..NOISELESS };
        let colour = scene.render(&options).unwrap();
        let grey = scene.render(&RenderOptions { grey: true, ..options }).unwrap();
        assert!(!grey.color().has_color());
        assert_eq!(grey.color().bytes_per_pixel(), if depth == Depth::Eight { 1 } else { 2 });
        let green: Vec<u16> = colour.to_rgb16().pixels().map(|p| p.0[1]).collect();
        assert_eq!(grey.to_luma16().into_raw(), green);
    }
}

#[test]
fn noise_has_the_stated_deviation() {
    let scene = set(LightKind::Chamber).scene(1, Pose::Normal);
    let clean = photograph(&scene);
    let noisy = scene.render(&RenderOptions { noise_sd: 3.0, noise_seed: 9, ..NOISELESS }).unwrap().into_rgb16();
    let sum: f64 = clean
        .indexed_iter()
        .map(|((y, x), value)| (f64::from(noisy.get_pixel(x as u32, y as u32).0[1]) / 65535.0 - value).powi(2))
        .sum();
    let sd = (sum / clean.len() as f64).sqrt() * 255.0;
    assert!((sd - 3.0).abs() <= 0.02, "{sd}");
}

#[test]
fn a_nail_larger_than_the_picture_is_nan_outside() {
    let mut scene = set(LightKind::Chamber).scene(0, Pose::Normal);
    scene.camera.nail_width_px = 900.0;
    let truth = scene.normalized(101, 1.25);
    let missing = truth.iter().filter(|v| v.is_nan()).count();
    assert!(missing > 1000 && missing < truth.len() - 1000, "{missing}");
    assert!(!truth[[50, 50]].is_nan() && truth[[0, 0]].is_nan());
    assert!(scene.render(&NOISELESS).is_ok());
}

#[test]
fn what_cannot_be_drawn_is_refused() {
    let good = set(LightKind::Chamber).scene(0, Pose::Normal);
    let with = |change: &dyn Fn(&mut Camera)| {
        let mut scene = good.clone();
        change(&mut scene.camera);
        scene.render(&NOISELESS).err()
    };
    let tiny = with(&|c| (c.width, c.height) = (1, 1));
    assert_eq!(tiny, Some(SceneFault::PictureTooSmall { width: 1, height: 1 }));
    assert!(matches!(with(&|c| c.nail_width_px = f64::NAN), Some(SceneFault::NailTooSmall(_))));
    assert_eq!(with(&|c| c.nail_width_px = 1.0), Some(SceneFault::NailTooSmall(1.0)));
    assert!(matches!(with(&|c| c.centre_px[0] = f64::INFINITY), Some(SceneFault::BadNumber(_))));
    assert_eq!(with(&|c| (c.width, c.height) = (9, 31)), None);
}

#[test]
fn pose_names_are_read_back() {
    for pose in Pose::ALL {
        assert_eq!(pose.name().parse(), Ok(pose));
    }
    assert!("sideways".parse::<Pose>().unwrap_err().to_string().contains("lateral_negative"));
}
