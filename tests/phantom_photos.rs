//! A set of synthetic photographs on disk: what it holds, and that it can be made again.

use std::{collections::BTreeMap, fs, path::Path, sync::atomic::AtomicBool};

use lunula::{
    job::Watch,
    labelme::{LabelMe, from_labelme},
    phantom::{
        Error, Generated as _,
        nail::Pose,
        photos::{FileFormat, PhotoOptions},
    },
};
use ndarray::Array2;

use crate::util::bytes_below as files;

fn small() -> PhotoOptions {
    PhotoOptions {
        seed: 4,
        subjects: 5,
        poses: vec![Pose::Nominal, Pose::LateralPositive],
        width: 160,
        height: 120,
        size: 80,
        ..PhotoOptions::default()
    }
}

fn written(options: &PhotoOptions, threads: usize) -> BTreeMap<String, Vec<u8>> {
    let out = tempfile::tempdir().expect("a folder");
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    pool.install(|| options.write(out.path())).expect("a set");
    files(out.path())
}

#[test]
fn same_seed_same_bytes_whatever_the_threads() {
    let one = written(&small(), 1);
    assert_eq!(one.len(), 10 + 10 + 10 + 10 + 6 + 2);
    assert!(one == written(&small(), 3), "3 threads gave other bytes");
    let other = written(&PhotoOptions { seed: 5, ..small() }, 2);
    let photograph = "photos/nominal/s01.png";
    assert!(one.contains_key(photograph) && one[photograph] != other[photograph]);
}

#[test]
fn a_photograph_does_not_depend_on_the_rest_of_the_set() {
    let all = written(&small(), 2);
    let few = written(&PhotoOptions { subjects: 2, poses: vec![Pose::LateralPositive], ..small() }, 2);
    let photograph = "photos/lateral_positive/s02.png";
    assert_eq!(all[photograph], few[photograph]);
}

#[test]
fn maps_are_mean_and_sd_of_the_normalized_pictures() {
    /// Rounding to float32.
    const TOLERANCE: f64 = 1e-7;
    let out = tempfile::tempdir().unwrap();
    let options = small();
    options.write(out.path()).unwrap();
    let truth = out.path().join("truth");
    let pictures: Vec<Array2<f32>> =
        (1..=5).map(|k| ndarray_npy::read_npy(truth.join(format!("normalized/nominal/s0{k}.npy"))).unwrap()).collect();
    let mean: Array2<f32> = ndarray_npy::read_npy(truth.join("maps/nominal-mean.npy")).unwrap();
    let sd: Array2<f32> = ndarray_npy::read_npy(truth.join("maps/nominal-sd.npy")).unwrap();
    let count: Array2<u32> = ndarray_npy::read_npy(truth.join("maps/nominal-count.npy")).unwrap();
    assert_eq!(mean.dim(), (80, 80));
    for ((i, j), &n) in count.indexed_iter() {
        let seen: Vec<f64> = pictures.iter().map(|p| f64::from(p[[i, j]])).filter(|v| !v.is_nan()).collect();
        assert_eq!(n as usize, seen.len());
        let m = seen.iter().sum::<f64>() / n as f64;
        let s = (seen.iter().map(|v| (v - m).powi(2)).sum::<f64>() / (n as f64 - 1.0)).sqrt();
        assert!(n == 0 && mean[[i, j]].is_nan() || (f64::from(mean[[i, j]]) - m).abs() <= TOLERANCE);
        assert!(n < 2 && sd[[i, j]].is_nan() || (f64::from(sd[[i, j]]) - s).abs() <= TOLERANCE);
    }
    assert!(count.iter().all(|&n| n <= 5) && count[[40, 40]] == 5);
}

#[test]
fn annotations_are_the_scenes_in_labelmes_pixels() {
    let out = tempfile::tempdir().unwrap();
    let options = small();
    assert_eq!(options.write(out.path()).unwrap().count, 10);
    let scene = options.scene(3, Pose::LateralPositive);
    let beside = LabelMe::read(&out.path().join("photos/lateral_positive/s04.json")).unwrap();
    assert_eq!(beside.image_path, "s04.png");
    assert_eq!((beside.image_width, beside.image_height), (Some(160), Some(120)));
    let apart_path = out.path().join("truth/outlines/lateral_positive/s04.json");
    let apart = LabelMe::read(&apart_path).unwrap();
    assert_eq!(apart.shapes, beside.shapes);
    assert!(apart_path.parent().unwrap().join(&apart.image_path).is_file());
    assert_eq!((beside.shapes[0].label.as_str(), beside.shapes[0].shape_type.as_str()), ("nail", "polygon"));
    assert_eq!((beside.shapes[1].label.as_str(), beside.shapes[1].shape_type.as_str()), ("axis", "line"));
    let expected = scene.outline().unwrap().points();
    assert_eq!(beside.shapes[0].points.len(), expected.len());
    for (point, expected) in beside.shapes[0].points.iter().zip(expected) {
        let point = from_labelme(*point);
        assert!((point[0] - expected[0]).hypot(point[1] - expected[1]) <= 1e-12 * 160.0);
    }
    let [proximal, distal] = scene.axis_ends_px();
    assert!((beside.shapes[1].points[0][0] - 0.5 - proximal[0]).abs() <= 1e-9);
    assert!((beside.shapes[1].points[1][1] - 0.5 - distal[1]).abs() <= 1e-9);
    let table = fs::read_to_string(out.path().join("truth/nails.csv")).unwrap();
    let row: Vec<&str> = table.lines().nth(9).unwrap().split(',').collect();
    assert_eq!((row[0], row[3]), ("lateral_positive/s04.png", "lateral_positive"));
    assert_eq!(row[6].parse(), Ok(scene.length_px()));
    let head =
        "file,nail,subject,pose,center_x_px,center_y_px,length_px,width_px,axis_deg\nnominal/s01.png,1,s01,nominal,";
    assert!(table.starts_with(head), "{table}");
}

#[test]
fn formats_and_depths_are_read_back() {
    let cases = [
        (FileFormat::Png, 8, false),
        (FileFormat::Png, 16, true),
        (FileFormat::Tif, 16, false),
        (FileFormat::Tif, 8, true),
        (FileFormat::Bmp, 8, false),
        (FileFormat::Jpg, 8, true),
        (FileFormat::Jpg, 8, false),
    ];
    let mut read = 0;
    for (format, depth, grey) in cases {
        let options = PhotoOptions {
            format,
            depth,
            grey,
            subjects: 1,
            annotate: false,
            truth_normalized: false,
            poses: vec![Pose::Normal],
            ..small()
        };
        let out = tempfile::tempdir().unwrap();
        options.write(out.path()).unwrap();
        let picture = image::open(out.path().join(format!("photos/normal/s01.{}", format.extension()))).unwrap();
        assert_eq!((picture.width(), picture.height()), (160, 120));
        assert_eq!(picture.color().has_color(), !grey, "{format:?}");
        let bits = 8 * u32::from(picture.color().bytes_per_pixel() / picture.color().channel_count());
        assert_eq!(bits, depth, "{format:?}");
        assert!(!out.path().join("photos/normal/s01.json").exists());
        assert!(!out.path().join("truth/normalized").exists());
        let sd: Array2<f32> = ndarray_npy::read_npy(out.path().join("truth/maps/normal-sd.npy")).unwrap();
        assert!(sd.iter().all(|v| v.is_nan()), "one subject has no SD");
        read += 1;
    }
    assert_eq!(read, 7);
}

#[test]
fn what_cannot_be_made_is_refused_before_anything_is_written() {
    let faults = [
        (PhotoOptions { subjects: 0, ..small() }, "at least one subject"),
        (PhotoOptions { poses: vec![], ..small() }, "at least one pose"),
        (PhotoOptions { poses: vec![Pose::Normal; 2], ..small() }, "the pose normal is wanted twice"),
        (PhotoOptions { depth: 12, ..small() }, "12 bits a channel"),
        (PhotoOptions { depth: 16, format: FileFormat::Jpg, ..small() }, "jpg files hold 8 bits a channel"),
        (PhotoOptions { noise_sd: -1.0, ..small() }, "standard deviation -1 "),
        (PhotoOptions { size: 0, ..small() }, "at least one pixel a side"),
        (PhotoOptions { margin: 0.5, ..small() }, "a margin of 0.5 "),
    ];
    let out = tempfile::tempdir().unwrap();
    let place = out.path().join("new");
    for (options, expected) in faults {
        match options.write(&place) {
            Err(Error::Options(fault)) => assert!(fault.to_string().contains(expected), "{fault}"),
            other => panic!("{expected:?} expected, not {other:?}"),
        }
    }
    let tiny = PhotoOptions { width: 1, height: 1, ..small() }.write(&place).unwrap_err();
    assert!(tiny.to_string().contains("1 x 1"), "{tiny}");
    assert!(!place.exists());
}

#[test]
fn a_set_is_replaced_whole_and_nothing_else_is_touched() {
    let out = tempfile::tempdir().unwrap();
    let options = PhotoOptions { truth_normalized: false, ..small() };
    options.write(out.path()).unwrap();
    let first = files(out.path());
    // Interrupted: as before.
    let other = PhotoOptions { seed: 9, ..options.clone() };
    let stopped = other.write_watched(out.path(), &Watch::stopped_by(&AtomicBool::new(true)));
    assert!(matches!(stopped, Err(Error::Interrupted(_))));
    assert!(files(out.path()) == first);
    // A smaller set: no photograph of the larger is left.
    PhotoOptions { subjects: 1, ..options.clone() }.write(out.path()).unwrap();
    assert!(!out.path().join("photos/nominal/s02.png").exists());
    // Somebody's own photographs: left alone.
    let own = tempfile::tempdir().unwrap();
    fs::create_dir(own.path().join("photos")).unwrap();
    fs::write(own.path().join("photos/mine.png"), "x").unwrap();
    assert!(matches!(options.write(own.path()), Err(Error::InTheWay { .. })));
    assert_eq!(files(own.path()).len(), 1);
}

#[test]
fn a_set_with_somebody_s_own_files_in_it_is_not_replaced() {
    let out = tempfile::tempdir().unwrap();
    let options = PhotoOptions { truth_normalized: false, ..small() };
    let other = PhotoOptions { seed: 9, subjects: 2, format: FileFormat::Bmp, ..options.clone() };
    options.write(out.path()).unwrap();
    let first = files(out.path());
    #[track_caller]
    fn refused(wanted: &PhotoOptions, out: &Path, name: &str) {
        let before = files(out);
        match wanted.write(out) {
            Err(Error::InTheWay { place, .. }) => assert_eq!(place, out.join(name)),
            other => panic!("{name} is in the way, not {other:?}"),
        }
        assert!(files(out) == before, "{name}");
    }
    for name in ["photos/notes.txt", "photos/nominal/s06.png", "photos/normal/s01.json", "truth/mine.csv"] {
        let place = out.path().join(name);
        fs::create_dir_all(place.parent().unwrap()).unwrap();
        fs::write(&place, "mine").unwrap();
        refused(&options, out.path(), name);
        refused(&PhotoOptions { subjects: 6, ..options.clone() }, out.path(), name);
        fs::remove_file(&place).unwrap();
    }
    // An outline that was corrected by hand.
    let name = "photos/nominal/s02.json";
    let mut outline = LabelMe::read(&out.path().join(name)).unwrap();
    outline.shapes[0].points[0][0] += 0.5;
    outline.write(&out.path().join(name)).unwrap();
    refused(&options, out.path(), name);
    refused(&other, out.path(), name);
    fs::write(out.path().join(name), &first[name]).unwrap();
    // As a run that was killed leaves it: its photographs beside the truth of the set before.
    let next = tempfile::tempdir().unwrap();
    other.write(next.path()).unwrap();
    fs::remove_dir_all(out.path().join("photos")).unwrap();
    fs::create_dir(out.path().join("photos")).unwrap();
    for (name, bytes) in files(&next.path().join("photos")) {
        let place = out.path().join("photos").join(name);
        fs::create_dir_all(place.parent().unwrap()).unwrap();
        fs::write(place, bytes).unwrap();
    }
    other.write(out.path()).unwrap();
    assert!(files(out.path()) == files(next.path()));
    options.write(out.path()).unwrap();
    assert!(files(out.path()) == first);
}
