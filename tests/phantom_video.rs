//! Synthetic videos: truth and picture agree, files hold what they should, bad options are refused.

use crate::util::Dir;
use lunula::flexion::Flexion;
use lunula::phantom::Generated as _;
use lunula::phantom::finger::MarkerLayout;
use lunula::phantom::screen::Clock;
use lunula::phantom::trajectory::Trajectory;
use lunula::phantom::video::{Chroma, Colours, Hide, Leave, Lens, MarkerStatus, Preset, Scene, Siting, VideoOptions};
use lunula::video::{Item, Matrix, Picture, Turn, Video};

/// Without noise, 10 bit, chroma for each pixel.
fn exact(width: usize, height: usize) -> VideoOptions {
    VideoOptions { noise_sd: 0.0, depth: 10, chroma: Chroma::Full, ..VideoOptions::sized(width, height) }
}

fn small() -> VideoOptions {
    VideoOptions { seconds: 0.4, preset: "veryfast", ..VideoOptions::sized(320, 180) }
}

/// How far the centroids of the markers in a frame lie from the truth: where the same scene with markers of other
/// colours differs, nothing but the markers does, by their share of each pixel. Each marker is measured in that chroma
/// plane where it differs most; `luma_px` gives the place of a sample in luma pixels.
fn misses(options: &VideoOptions, frame: usize, luma_px: &dyn Fn(f64, f64) -> [f64; 2]) -> Vec<[f64; 2]> {
    let one = Scene::new(options.clone()).expect("a scene with chroma");
    let other =
        Scene::new(VideoOptions { colours: Colours::Distinct, ..options.clone() }).expect("a scene with chroma");
    let radius = options.finger.marker_px + 4.0;
    let pictures = [one.picture(frame), other.picture(frame)];
    let [width, _] =
        pictures[0].format.chroma_size().map(|(width, height)| [width, height]).expect("a scene with chroma");
    let differences: Vec<Vec<f32>> = [1, 2]
        .into_iter()
        .map(|plane| {
            let [a, b] = [&pictures[0], &pictures[1]].map(|picture| plane_of(picture, plane));
            a.iter().zip(&b).map(|(a, b)| a - b).collect()
        })
        .collect();
    let truth = one.truth(frame);
    (0..truth.markers.len())
        .filter(|&k| one.markers()[k].colour != other.markers()[k].colour)
        .map(|k| {
            let near = truth.markers[k].at_px;
            let measured = differences.iter().map(|difference| {
                let (mut sum, mut weight) = ([0.0; 2], 0.0);
                for (at, share) in difference.iter().enumerate() {
                    let [x, y] = luma_px((at % width) as f64, (at / width) as f64);
                    if (x - near[0]).hypot(y - near[1]) <= radius {
                        weight += f64::from(*share);
                        sum[0] += f64::from(*share) * (x - near[0]);
                        sum[1] += f64::from(*share) * (y - near[1]);
                    }
                }
                (weight.abs(), [sum[0] / weight, sum[1] / weight])
            });
            measured.max_by(|a, b| a.0.total_cmp(&b.0)).expect("a scene with chroma").1
        })
        .collect()
}

fn plane_of(picture: &Picture, plane: usize) -> Vec<f32> {
    let frame = picture.frame(0, 0.0);
    let from = if plane == 0 { frame.luma } else { frame.chroma.expect("chroma")[plane - 1] };
    (0..from.height).flat_map(|y| (0..from.width).map(move |x| from.sample(x, y))).collect()
}

/// The furthest that a centroid lies from the truth.
fn worst(misses: &[[f64; 2]]) -> f64 {
    assert!(misses.len() >= 4);
    misses.iter().map(|miss| miss[0].hypot(miss[1])).fold(0.0, |worst, miss| if miss <= worst { worst } else { miss })
}

#[test]
fn a_markers_centroid_is_where_the_truth_says() {
    // Measured: 0.0020 and 0.0031, which is the rounding to 10 bits where two colours differ little; drawn without,
    // 0.0007.
    for (options, near_px) in [(exact(1280, 720), 0.003), (exact(480, 270), 0.005)] {
        let all: Vec<_> = [0, 77].iter().flat_map(|&f| misses(&options, f, &|x, y| [x, y])).collect();
        let miss = worst(&all);
        assert!(miss <= near_px, "{miss}");
    }
}

#[test]
fn motion_blur_is_about_mid_exposure() {
    // The mean of an accelerated path differs from its middle: by 0.02 px at 1 Hz, 60 frames a second, half of the
    // interval.
    const NEAR_PX: f64 = 0.025;
    let fast = VideoOptions::new(Preset::Fast);
    let options = VideoOptions { fps: fast.fps, trajectory: fast.trajectory, blur: fast.blur, ..exact(1280, 720) };
    let all: Vec<_> = [3, 15, 31].iter().flat_map(|&f| misses(&options, f, &|x, y| [x, y])).collect();
    let miss = worst(&all);
    assert!(miss <= NEAR_PX, "{miss}");
}

#[test]
fn a_lens_shows_the_markers_where_the_truth_says() {
    // A disc seen through a lens is no disc: its centroid is a little off its centre's image. Measured: 0.014.
    const NEAR_PX: f64 = 0.02;
    let lens = Lens { fx_px: None, distortion: vec![-0.25, 0.08, 0.001, -0.002, 0.0] };
    let options = VideoOptions { lens: Some(lens), ..exact(1280, 720) };
    let miss = worst(&misses(&options, 40, &|x, y| [x, y]));
    assert!(miss <= NEAR_PX, "{miss}");
    let straight = Scene::new(exact(1280, 720)).unwrap().truth(40).markers[0].at_px;
    let bent = Scene::new(options).unwrap().truth(40).markers[0].at_px;
    assert!((straight[0] - bent[0]).hypot(straight[1] - bent[1]) > 2.0);
}

#[test]
fn chroma_is_sited_as_asked() {
    // Half as many samples each way of a softened disc: measured 0.005.
    const NEAR_PX: f64 = 0.01;
    for siting in [Siting::Left, Siting::Centre] {
        let options = VideoOptions { chroma: Chroma::Quarter, siting, ..exact(1280, 720) };
        let (right, down) = siting.place();
        let miss = worst(&misses(&options, 40, &|x, y| [2.0 * x + right, 2.0 * y + down]));
        assert!(miss <= NEAR_PX, "{siting:?} {miss}");
    }
}

#[test]
fn angles_are_those_of_the_markers() {
    for (layout, flexion) in [
        (MarkerLayout::Pairs, Flexion::Clockwise),
        (MarkerLayout::Joints, Flexion::Counterclockwise),
        (MarkerLayout::Paint, Flexion::Counterclockwise),
        (MarkerLayout::Thumb, Flexion::Clockwise),
        (MarkerLayout::Row, Flexion::Clockwise),
    ] {
        let mut options = exact(640, 360);
        options.finger = lunula::phantom::finger::Finger::new(640, 360, flexion, layout);
        options.joints = layout.joints().into_iter().map(|(joint, _)| joint.to_owned()).collect();
        options.trajectory = Trajectory::Random { hz: 0.3, seed: 5 };
        let scene = Scene::new(options).unwrap();
        for frame in [0, 50, 299] {
            let truth = scene.truth(frame);
            let direction = |segment: usize| {
                let [a, b] = layout.segments()[segment].1.map(|marker| truth.markers[marker].at_px);
                (b[1] - a[1]).atan2(b[0] - a[0])
            };
            let joints = layout.joints();
            assert_eq!(joints.len(), truth.angles_rad.len());
            for ((_, [from, to]), truth_rad) in joints.into_iter().zip(truth.angles_rad.iter()) {
                let angle = flexion.sign() * (direction(to) - direction(from));
                let miss = (angle - truth_rad).rem_euclid(std::f64::consts::TAU);
                assert!(miss.min(std::f64::consts::TAU - miss) <= 1e-9);
            }
        }
    }
}

fn painted(layout: MarkerLayout, seed: u64) -> VideoOptions {
    VideoOptions { seed, ..VideoOptions::sized(1280, 720).painted(layout) }
}

/// Size along and across its long axis, mean and standard deviation of luma, means of Cb and Cr of the paint; means of
/// luma, Cb and Cr of the skin around it; how far its centroid is from the truth's.
struct Measured {
    size_px: [f64; 2],
    luma: [f64; 2],
    chroma: [f64; 2],
    skin_luma: f64,
    skin_chroma: [f64; 2],
    miss_px: f64,
}

fn measured(picture: &Picture, seen_px: [f64; 2], radius: f64) -> Measured {
    let [luma, cb, cr] = [0, 1, 2].map(|plane| plane_of(picture, plane));
    let width = picture.format.width;
    let (mut paint, mut skin) = (Vec::new(), Vec::new());
    for y in (seen_px[1] - radius) as usize..=(seen_px[1] + radius) as usize {
        for x in (seen_px[0] - radius) as usize..=(seen_px[0] + radius) as usize {
            let [dx, dy] = [x as f64 - seen_px[0], y as f64 - seen_px[1]];
            let [luma, cb, cr] = [&luma, &cb, &cr].map(|plane| f64::from(plane[y * width + x]));
            match cr {
                _ if dx.hypot(dy) > radius => {}
                // Between the paint's and the skin's.
                _ if cr < 128.0 => paint.push([dx, dy, luma, cb, cr]),
                _ if cr > 138.0 => skin.push([dx, dy, luma, cb, cr]),
                _ => {}
            }
        }
    }
    let mean = |of: &[[f64; 5]], k: usize| of.iter().map(|one| one[k]).sum::<f64>() / of.len() as f64;
    let product = |j: usize, k: usize| {
        let (a, b) = (mean(&paint, j), mean(&paint, k));
        paint.iter().map(|one| (one[j] - a) * (one[k] - b)).sum::<f64>() / paint.len() as f64
    };
    let (half, apart) =
        (0.5 * (product(0, 0) + product(1, 1)), (0.5 * (product(0, 0) - product(1, 1))).hypot(product(0, 1)));
    Measured {
        size_px: [half + apart, half - apart].map(|variance| 4.0 * variance.sqrt()),
        luma: [mean(&paint, 2), product(2, 2).sqrt()],
        chroma: [3, 4].map(|k| mean(&paint, k)),
        skin_luma: mean(&skin, 2),
        skin_chroma: [3, 4].map(|k| mean(&skin, k)),
        miss_px: mean(&paint, 0).hypot(mean(&paint, 1)),
    }
}

#[test]
fn marks_of_paint_are_as_in_a_real_recording() {
    let (mut sizes, mut spreads, mut misses) = ([Vec::new(), Vec::new()], Vec::new(), Vec::new());
    for (seed, frame) in [(1, 0), (2, 60), (3, 120)] {
        let options = VideoOptions { chroma: Chroma::Full, ..painted(MarkerLayout::Paint, seed) };
        let scene = Scene::new(options).unwrap();
        let (picture, truth) = (scene.picture(frame), scene.truth(frame));
        for (_, [a, b]) in MarkerLayout::Paint.segments() {
            let [a, b] = [a, b].map(|marker| truth.markers[marker].at_px);
            assert!((60.0..=160.0).contains(&(a[0] - b[0]).hypot(a[1] - b[1])));
        }
        for mark in &truth.markers {
            let one = measured(&picture, mark.seen_px.unwrap(), 26.0);
            let within =
                |value: f64, low: f64, high: f64| assert!((low..=high).contains(&value), "{value} {low} {high}");
            // Edges are mixed with skin: 3 more than in the recording.
            within(one.luma[0], 30.0, 70.0);
            within(one.skin_luma, 53.0, 127.0);
            within(one.chroma[1], 111.0, 125.0);
            within(one.skin_chroma[1], 132.0, 150.0);
            // About the skin's own.
            within(one.chroma[0] - one.skin_chroma[0], -12.0, 12.0);
            within(one.size_px[0], 17.0, 42.0);
            within(one.size_px[1], 7.0, 30.0);
            (0..2).for_each(|axis| sizes[axis].push(one.size_px[axis]));
            spreads.push(one.luma[1]);
            misses.push(one.miss_px);
        }
    }
    let median = |values: &mut Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    let [long, wide] = &mut sizes;
    let medians = [median(long), median(wide), median(&mut spreads)];
    assert!((medians[0] - 27.0).abs() <= 4.0 && (medians[1] - 20.0).abs() <= 4.0, "{medians:?}");
    assert!((8.0..=22.0).contains(&medians[2]), "{medians:?}");
    // Plain thresholds of noisy samples: measured 0.19 at most.
    assert!(misses.iter().all(|miss| *miss <= 0.4), "{misses:?}");
}

#[test]
fn paint_stretches_with_the_skin() {
    let scene = Scene::new(painted(MarkerLayout::Paint, 1)).unwrap();
    // Straight but for J1, and flexed.
    let away = |frame: usize| {
        let truth = scene.truth(frame);
        let off = |mark: usize| {
            let (at, seen) = (truth.markers[mark].at_px, truth.markers[mark].seen_px.unwrap());
            (at[0] - seen[0]).hypot(at[1] - seen[1])
        };
        [0, 2, 4].map(off)
    };
    let (straight, flexed) = (away(0), away(120));
    assert!(straight.iter().chain(&[flexed[0], flexed[2]]).all(|off| *off <= 0.05), "{straight:?} {flexed:?}");
    assert!((0.1..=1.0).contains(&flexed[1]), "{flexed:?}");
}

#[test]
fn a_painted_layouts_marker_file_has_what_it_needs() {
    for (layout, counts) in [
        (MarkerLayout::Paint, [8, 7, 5]),
        (MarkerLayout::Thumb, [4, 3, 2]),
        (MarkerLayout::Row, [4, 3, 2]),
        (MarkerLayout::Mark, [1, 0, 0]),
    ] {
        for start in [true, false] {
            let scene = Scene::new(VideoOptions { start, ..painted(layout, 1) }).unwrap();
            let file: toml::Table = scene.markers_toml().parse().expect("TOML");
            let count = |table: &str| file.get(table).map_or(0, |table| table.as_table().map_or(0, toml::Table::len));
            assert_eq!(["markers", "segments", "joints"].map(count), counts, "{layout:?}");
            assert_eq!(count("start"), if start { counts[0] } else { 0 });
            assert!(file["markers"].as_table().unwrap().values().all(|colour| colour.as_str() == Some("#1c4a10")));
        }
    }
}

#[test]
fn the_command_line_paints() {
    let dir = Dir::new();
    let run = |more: &str| {
        let line = format!("phantom video --size 320x180 --seconds 0.2 --x264 ultrafast {more} --out out");
        dir.words(&line).expect(0);
        let markers = dir.text("out/markers.toml");
        (markers, dir.table("out/truth/tracks.csv"), dir.table("out/truth/joints.csv"))
    };
    let (markers, tracks, joints) = run("--layout paint");
    assert!(markers.contains("[start]") && markers.contains("T2 = [\"thumb_proximal\", \"thumb_distal\"]"));
    // 24 frames a second.
    assert_eq!((tracks.len(), joints.len()), (5 * 8, 5));
    assert!(tracks.iter().all(|row| row["seen_x_px"].parse::<f64>().is_ok()) && joints[0].contains_key("T1_deg"));
    let (markers, ..) = run("--layout thumb --colours pale --no-start");
    assert!(!markers.contains("[start]") && markers.contains("thumb_ip = \"#cdd6b2\""));
    assert!(!run("--layout paint --colours distinct").0.contains("[start]"));
    let (markers, tracks, _) = run("--layout mark --hide index_pip@0+2");
    assert!(!markers.contains("[segments]") && !markers.contains("[joints]"));
    assert_eq!((tracks[0]["status"].as_str(), tracks[0]["seen_x_px"].as_str()), ("hidden", ""));
    dir.words("phantom video --layout row --joints J1 --out bad").expect(2).says("--joints J1: there are J2, J3");
}

#[test]
fn a_hidden_marker_is_hidden_for_as_long_as_asked() {
    let mut options = exact(640, 360);
    options.blur = 0.5;
    options.hide = vec![Hide { marker: "middle_dist".into(), frame: 40, frames: 12 }];
    let scene = Scene::new(options.clone()).unwrap();
    let marker = scene.markers().iter().position(|marker| marker.name == "middle_dist").unwrap();
    let status = |frame: usize| scene.truth(frame).markers[marker].status;
    for frame in 40..52 {
        assert_eq!(status(frame), MarkerStatus::Hidden, "{frame}");
        assert_eq!(scene.truth(frame).markers[marker].in_view, 0.0);
    }
    assert_eq!((status(20), status(72)), (MarkerStatus::Ok, MarkerStatus::Ok));
    assert_eq!((status(39), status(52)), (MarkerStatus::Partial, MarkerStatus::Partial));
    assert!((0..72).all(|frame| scene.truth(frame).markers[0].status == MarkerStatus::Ok));
    // Of 255; where the soft edges of both end, a quarter is left.
    const SEEN: f32 = 0.3;
    // Nothing of its colour is seen either: the picture is that of a marker of another colour.
    let other = Scene::new(VideoOptions { colours: Colours::Red, ..options }).unwrap();
    for frame in [40, 51] {
        let [x, y] = scene.truth(frame).markers[marker].at_px.map(|v| v.round() as usize);
        let [a, b] = [scene.picture(frame), other.picture(frame)];
        for (y, x) in (y - 6..=y + 6).flat_map(|y| (x - 6..=x + 6).map(move |x| (y, x))) {
            let (a, b) = (a.frame(0, 0.0).luma.sample(x, y), b.frame(0, 0.0).luma.sample(x, y));
            assert!((a - b).abs() <= SEEN, "{a} {b}");
        }
    }
}

#[test]
fn a_fingertip_leaves_the_picture_and_comes_back() {
    let options = VideoOptions { leave: Some(Leave { frame: 60, frames: 10 }), ..exact(640, 360) };
    let scene = Scene::new(options).unwrap();
    let last = |frame: usize| *scene.truth(frame).markers.last().unwrap();
    for frame in 60..70 {
        assert_eq!(last(frame).status, MarkerStatus::Outside);
        assert!(last(frame).at_px[0] > 640.0);
    }
    assert_eq!((last(30).status, last(100).status), (MarkerStatus::Ok, MarkerStatus::Ok));
    assert!((44..60).chain(70..86).any(|frame| last(frame).status == MarkerStatus::Partial));
}

#[test]
fn the_hard_scene_has_its_distractors_away_from_the_finger() {
    let dir = Dir::new();
    let options =
        VideoOptions { seconds: 0.1, hide: Vec::new(), preset: "ultrafast", ..VideoOptions::new(Preset::Hard) };
    assert!(options.distractors == 6 && options.write(&dir.path("out")).unwrap().warnings.is_empty());
}

#[test]
fn a_turned_picture_is_the_same_picture_turned() {
    let upright = VideoOptions { turn: Turn::None, ..exact(320, 180) };
    for turn in [Turn::Quarter, Turn::Half, Turn::ThreeQuarters] {
        let stored = Scene::new(VideoOptions { turn, ..upright.clone() }).unwrap().picture(30);
        let shown = Scene::new(upright.clone()).unwrap().picture(30);
        let size = (stored.format.width, stored.format.height);
        for (x, y) in (0..size.0).flat_map(|x| (0..size.1).map(move |y| (x, y))) {
            let [u, v] = turn.shown_from_stored([x as f64, y as f64], size);
            let sample = shown.frame(0, 0.0).luma.sample(u as usize, v as usize);
            assert_eq!(stored.frame(0, 0.0).luma.sample(x, y), sample, "{turn:?} {x} {y}");
        }
    }
}

#[test]
fn the_files_hold_the_frames_at_their_times() {
    let dir = Dir::new();
    let clock = Clock { offset_s: 754.0, ..Clock::default() };
    let options = VideoOptions { seconds: 2.0, jitter: 0.4, blur: 0.5, clock: Some(clock.clone()), ..small() };
    options.write(&dir.path("out")).unwrap();
    let scene = Scene::new(options).unwrap();

    let mut video = Video::open(&dir.path("out/video.mp4"), 2).unwrap();
    let joints = dir.table("out/truth/joints.csv");
    let clocks = dir.table("out/truth/clock.csv");
    assert_eq!((joints.len(), clocks.len()), (60, 60));
    let (mut count, mut intervals) = (0, Vec::new());
    while let Some(item) = video.next_item().unwrap() {
        let Item::Frame(frame) = item else { panic!("all are there") };
        let row = &joints[count];
        let time_s: f64 = row["time_s"].parse().unwrap();
        assert!((frame.time_s - time_s).abs() <= 1e-9);
        assert_eq!(row["frame"], count.to_string());
        assert!((row["clock_s"].parse::<f64>().unwrap() - 754.0 - time_s).abs() <= 1e-9);
        let shown_s: f64 = clocks[count]["shown_s"].parse().unwrap();
        // Tenths are cut off.
        assert!((-1e-6..=0.1).contains(&(754.0 + time_s - shown_s)));
        assert_eq!(clocks[count]["shown"], clock.shown(time_s).0);
        intervals.push(time_s);
        count += 1;
    }
    assert_eq!(count, 60);
    let gaps: Vec<f64> = intervals.windows(2).map(|pair| pair[1] - pair[0]).collect();
    assert!(gaps.iter().any(|gap| *gap > 0.04) && gaps.iter().any(|gap| *gap < 0.027));

    let tracks = dir.table("out/truth/tracks.csv");
    assert_eq!(tracks.len(), 60 * 8);
    let (row, truth) = (&tracks[8 * 7 + 3], scene.truth(7));
    assert_eq!((row["marker"].as_str(), row["status"].as_str()), ("proximal_dist", "ok"));
    assert!((row["x_px"].parse::<f64>().unwrap() - truth.markers[3].at_px[0]).abs() <= 1e-9);
    assert!(dir.path("out/truth/scene.json").is_file());
}

#[test]
fn the_marker_file_names_all_that_the_scene_has() {
    let mut options = small();
    options.clock = Some(Clock::default());
    options.lens = Some(Lens { fx_px: Some(300.0), distortion: vec![-0.1, 0.01] });
    options.start = true;
    options.joints = vec!["J2".into()];
    let scene = Scene::new(options).unwrap();
    let file: toml::Table = scene.markers_toml().parse().expect("TOML");
    assert_eq!(file["flexion"].as_str(), Some("clockwise"));
    assert_eq!(file["markers"].as_table().map(toml::Table::len), Some(8));
    assert_eq!(file["segments"]["middle"][1].as_str(), Some("middle_dist"));
    assert_eq!(file["joints"].as_table().map(toml::Table::len), Some(1));
    assert_eq!(file["joints"]["J2"][0].as_str(), Some("proximal"));
    assert_eq!(file["clock"]["roi"][2].as_integer(), Some(75));
    assert_eq!(file["camera"]["fx"].as_float(), Some(300.0));
    let x = file["start"]["hand_prox"][0].as_float().unwrap();
    assert!((x - scene.truth(0).markers[0].at_px[0]).abs() <= 0.05);
}

#[test]
fn the_marker_file_describes_the_clock_as_far_as_requested() {
    let clock = Clock { refresh_hz: Some(60.0), ..Clock::default() };
    let options = VideoOptions { clock: Some(clock), clock_roi_auto: true, ..small() };
    let file: toml::Table = Scene::new(options).unwrap().markers_toml().parse().expect("TOML");
    assert_eq!(file["clock"]["roi"].as_str(), Some("auto"));
    assert_eq!(file["clock"]["refresh_hz"].as_float(), Some(60.0));
    let plain = VideoOptions { clock: Some(Clock::default()), ..small() };
    let file: toml::Table = Scene::new(plain).unwrap().markers_toml().parse().expect("TOML");
    assert_eq!(file["clock"]["refresh_hz"].as_float(), Some(f64::INFINITY), "it changes at once");
}

#[test]
fn the_clocks_screen_is_covered_stops_and_jumps_in_the_frames_asked_for() {
    let dir = Dir::new();
    let options = "--size 320x180 --seconds 1 --noise 0 --crf 0 --x264 ultrafast --clock ss.tt --clock-offset 7 \
                   --clock-hide 4+3 --clock-jump 10-2.5 --clock-stop 20 --out out";
    dir.words(&format!("phantom video {options}")).expect(0);
    let rows = dir.table("out/truth/clock.csv");
    let number = |row: usize, column: &str| rows[row][column].parse::<f64>().unwrap();
    let expected = |row| match row {
        4..7 => "hidden",
        20.. => "stopped",
        10.. => "jumped",
        _ => "ok",
    };
    for (row, cells) in rows.iter().enumerate() {
        assert_eq!(cells["status"], expected(row), "{row}");
        assert!((number(row, "clock_s") - 7.0 - number(row, "time_s")).abs() <= 1e-9, "the clock counts on");
    }
    assert_eq!((rows[9]["shown"].as_str(), rows[10]["shown"].as_str()), ("07.30", "04.83"));
    assert!(rows[20..].iter().all(|row| row["shown"] == rows[20]["shown"]));
    let mut video = Video::open(&dir.path("out/video.mp4"), 1).unwrap();
    let (mut frames, mut spread) = (0, Vec::new());
    while let Some(item) = video.next_item().unwrap() {
        let Item::Frame(frame) = item else { panic!("all are there") };
        // Within the panel, which is 225,10,75,18.
        let samples = (12..26).flat_map(|y| (228..297).map(move |x| (x, y)));
        let samples: Vec<f32> = samples.map(|(x, y)| frame.luma.sample(x, y)).collect();
        let (low, high) = samples.iter().fold((255.0f32, 0.0f32), |(low, high), &v| (low.min(v), high.max(v)));
        spread.push(high - low);
        frames += 1;
    }
    assert_eq!(frames, 30);
    // A lossless plain sheet is one value; digits on their panel differ by most of the range.
    assert!((0..30).all(|frame| if (4..7).contains(&frame) { spread[frame] <= 1.0 } else { spread[frame] >= 100.0 }));

    for (option, words) in [
        ("--clock-hide=99+1", "--clock-hide 99+1: the video has frames 0 to 29"),
        ("--clock-stop=30", "--clock-stop 30: the video has frames 0 to 29"),
        ("--clock-jump=31+5", "--clock-jump 31+5: the video has frames 0 to 29"),
        ("--clock-jump=soon", "`soon` is not FRAME+SECONDS"),
    ] {
        dir.lunula(&["phantom", "video", "--seconds", "1", "--clock", "ss.tt", option, "--out", "bad"])
            .expect(2)
            .says(words);
    }
}

#[test]
fn the_same_seed_gives_the_same_bytes_whatever_the_threads() {
    let dir = Dir::new();
    let mut options = VideoOptions { blur: 0.5, distractors: 3, jitter: 0.3, ..small() };
    options.trajectory = Trajectory::Random { hz: 0.5, seed: 9 };
    for (name, threads, seed) in [("one", 1, 9), ("three", 3, 9), ("other", 3, 10)] {
        let options = VideoOptions { seed, ..options.clone() };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| options.write(&dir.path(name)).unwrap());
    }
    let one = dir.bytes_of("one");
    assert_eq!(one.len(), 5);
    assert!(one == dir.bytes_of("three"));
    assert!(one["video.mp4"] != dir.bytes_of("other")["video.mp4"]);
}

/// x264's macroblock tree used memory that nothing was written to: what the heap held decided the bytes.
#[test]
fn what_the_heap_held_does_not_change_the_bytes() {
    let dir = Dir::new();
    for (codec, format) in [("h264", "420"), ("h264", "444"), ("hevc", "420")] {
        let [first, second] = ["0", "77"].map(|filling| {
            let out = format!("{codec}-{format}-{filling}");
            let coding = ["--codec", codec, "--x264", "medium", "--format", format];
            let small = [&["--size", "320x180", "--seconds", "1"], &coding[..]].concat();
            let arguments = [&["phantom", "video", "--seed", "1", "--out", &out], &small[..]].concat();
            dir.lunula_with(&[("MALLOC_PERTURB_", filling)], &arguments).expect(0);
            dir.bytes_of(&out)
        });
        assert!(first == second, "{codec} {format}");
    }
}

#[test]
fn what_is_not_ours_is_left_alone() {
    let dir = Dir::new();
    let video = VideoOptions { seconds: 0.1, ..small() };
    dir.write("out/video.mp4", "mine");
    assert!(matches!(video.write(&dir.path("out")), Err(lunula::phantom::Error::InTheWay { .. })));
    assert_eq!(dir.bytes_of("out").len(), 1);
    video.write(&dir.path("again")).unwrap();
    let first = dir.bytes_of("again");
    video.write(&dir.path("again")).unwrap();
    assert!(first == dir.bytes_of("again"));
}

#[test]
fn the_command_line_writes_each_kind_of_file() {
    let dir = Dir::new();
    let run = |more: &[&str]| {
        let mut arguments = vec!["phantom", "video", "--size", "160x96", "--seconds", "0.2", "--x264", "ultrafast"];
        arguments.extend(more);
        arguments.extend(["--out", "out", "--json"]);
        dir.lunula(&arguments).expect(0).json()
    };
    for (more, subsampling, depth) in [
        (&["--format", "420"][..], Some((2, 2)), 8),
        (&["--format", "422", "--depth", "10"], Some((2, 1)), 10),
        (&["--format", "444", "--matrix", "601", "--full-range"], Some((1, 1)), 8),
        (&["--codec", "hevc", "--format", "422", "--depth", "10"], Some((2, 1)), 10),
        // Decoded as 4:2:0 without colour.
        (&["--format", "grey"], Some((2, 2)), 8),
    ] {
        let answer = run(more);
        assert_eq!((&answer["job"], &answer["frames"]), (&"phantom video".into(), &6.into()));
        let video = Video::open(&dir.path("out/video.mp4"), 1).unwrap();
        assert_eq!((video.info().format.subsampling, video.info().format.depth), (subsampling, depth), "{more:?}");
    }
    let info = Video::open(&dir.path("out/video.mp4"), 1).unwrap().info().clone();
    assert_eq!((info.format.width, info.format.height), (160, 96));
    for codec in ["h264", "hevc"] {
        run(&["--codec", codec, "--rotate", "90", "--stated-siting", "centre", "--matrix", "601", "--full-range"]);
        let info = Video::open(&dir.path("out/video.mp4"), 1).unwrap().info().clone();
        assert_eq!((info.format.width, info.format.height, info.turn), (96, 160, Turn::Quarter), "{codec}");
        assert_eq!(info.chroma_site, Some((0.5, 0.5)), "{codec}");
        assert_eq!(info.matrix, Matrix { full_range: true, ..Matrix::BT601 }, "{codec}");
    }
}

#[test]
fn a_given_trajectory_is_followed() {
    let dir = Dir::new();
    dir.write("bend.csv", "J2_deg,time_s,J3_deg,J1_deg\n10,1.0,5,0\n40,1.5,-5,2\n");
    dir.words("phantom video --size 160x96 --trajectory bend.csv --fps 20 --out out").expect(0);
    let rows = dir.table("out/truth/joints.csv");
    assert_eq!(rows.len(), 10);
    let degrees = |row: usize, joint: &str| rows[row][joint].parse::<f64>().unwrap();
    assert!((degrees(0, "J2_deg") - 10.0).abs() <= 1e-9 && (degrees(5, "J2_deg") - 25.0).abs() <= 1e-9);
    assert!(degrees(5, "J3_deg").abs() <= 1e-9 && (degrees(5, "J1_deg") - 1.0).abs() <= 1e-9);

    for (table, words) in [
        ("time_s,J1_deg,J2_deg\n0,1,2\n", "has no column `J3_deg`"),
        ("time_s,J1_deg,J2_deg,J3_deg\n0,1,2,3\n1,1,,3\n", "bad.csv:3: column `J2_deg`: is empty"),
        ("time_s,J1_deg,J2_deg,J3_deg\n1,1,2,3\n1,1,2,3\n", "bad.csv:3: column `time_s`: does not ascend"),
        ("time_s,J1_deg,J2_deg,J3_deg\n", "has no rows"),
    ] {
        dir.write("bad.csv", table);
        dir.words("phantom video --trajectory bad.csv --out bad").expect(2).says(words).says("bad.csv");
    }
    assert!(!dir.path("bad").exists());
}

#[test]
fn bad_options_are_refused_all_at_once() {
    let dir = Dir::new();
    let run = |more: &[&str]| {
        let mut arguments = vec!["phantom", "video", "--out", "out"];
        arguments.extend(more);
        dir.lunula(&arguments).expect(2)
    };
    run(&["--size", "321x181", "--hide", "thumb@3+4", "--hide", "hand_prox@9999+4", "--noise", "500"])
        .says("even sides")
        .says("no marker of this name; there are hand_prox, hand_dist")
        .says("the video has frames 0 to 299")
        .says("--noise 500: choose 0 to 128");
    run(&["--seconds", "0.01", "--hide", "hand_prox@0+1"]).says("less than a frame").says("the video has no frames");
    run(&["--clock", "mm:xx"]).says("only h, m, s, t");
    run(&["--clock", "mm:ss", "--clock-roi", "1200,40,300,70"]).says("--clock-roi 1200,40,300,70: not within 1280x720");
    run(&["--distortion", "-2,1"]).says("folds over");
    run(&["--depth", "12"]).says("--depth 12: choose 8 or 10");
    run(&["--joints", "J4"]).says("--joints J4: there are J1, J2, J3");
    run(&["--hide", "middle_dist"]).says("is not NAME@FRAME+N");
    run(&["--trajectory", "nowhere.csv"]).says("--trajectory is eq27, free, random, even, rest, sway or a table");
    run(&["--blur", "nan"]).says("--blur NaN: choose 0 to 1");
    assert!(!dir.path("out").exists());
}
