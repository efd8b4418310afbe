//! The usual recipe with OpenCV, as its users write it: each whole frame to BGR, to HSV, a mask of a marker's range of
//! hue, the largest contours of the mask, the centroid of each. The peer of the posture job's tracker.
//!
//! In: a video, the markers' names and colours, and where they are at first, where colours do not tell. Out: for each
//! frame and marker a centroid in pixels or none, and the time that each step took. It knows no standard error, takes
//! the video's matrix for BT.601 as VideoCapture does, and gives the centroid of what is seen of a half-hidden marker.
//! No `Mat` leaves this file.

use std::path::Path;
use std::sync::Once;
use std::time::Instant;

use lunula::video::{Bgr, Item, Video};
use opencv::core::{self, Mat, Point, Scalar, Vec3b, Vector};
use opencv::imgproc;
use opencv::prelude::*;

/// Hue either side of the marker's own, of OpenCV's 180.
const HUE_TOLERANCE: f64 = 8.0;
/// Least saturation and value, of the marker's own.
const LEAST_SATURATION: f64 = 0.5;
/// Least value, of the marker's own.
const LEAST_VALUE: f64 = 0.4;
/// Least area of a blob, pixels.
const LEAST_AREA_PX2: f64 = 30.0;
/// OpenCV's greatest hue, saturation and value.
const GREATEST: [f64; 3] = [179.0, 255.0, 255.0];

/// A marker to look for.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Wanted {
    /// As the layout calls it.
    pub(crate) name: String,
    /// Its colour, sRGB.
    pub(crate) srgb: [u8; 3],
    /// Where it is in the first frame, in coordinates of the stored picture; markers of one colour without it are taken
    /// from left to right.
    pub(crate) start_px: Option<[f64; 2]>,
}

/// A frame's centroids.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct RecipeFrame {
    /// Its time from the first frame's.
    pub(crate) time_s: f64,
    /// For each marker, column and row in the stored picture.
    pub(crate) at_px: Vec<Option<[f64; 2]>>,
}

/// What the recipe gave.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Recipe {
    /// Every frame; none of a frame that could not be decoded is seen.
    pub(crate) frames: Vec<RecipeFrame>,
    /// Seconds of decoding.
    pub(crate) decode_s: f64,
    /// Seconds of converting to BGR, a part of VideoCapture's work.
    pub(crate) bgr_s: f64,
    /// Seconds of all that is done with OpenCV.
    pub(crate) opencv_s: f64,
}

/// Runs it, decoding with `threads` threads and the rest with one.
///
/// # Errors
/// A video that can't be read, or OpenCV's own.
pub(crate) fn run(video: &Path, threads: usize, markers: &[Wanted]) -> anyhow::Result<Recipe> {
    static ONE_THREAD: Once = Once::new();
    let mut set = Ok(());
    ONE_THREAD.call_once(|| set = core::set_num_threads(1));
    set?;
    let mut video = Video::open(video, threads)?;
    let (rows, columns) = (video.info().format.height as i32, video.info().format.width as i32);
    let colours = colours(markers)?;
    let mut last: Vec<Option<[f64; 2]>> = markers.iter().map(|marker| marker.start_px).collect();
    let mut recipe = Recipe { frames: Vec::new(), decode_s: 0.0, bgr_s: 0.0, opencv_s: 0.0 };
    let (mut bgr, mut work) = (Bgr::default(), Work::default());
    loop {
        let start = Instant::now();
        let item = video.next_item()?;
        let decoded = Instant::now();
        recipe.decode_s += (decoded - start).as_secs_f64();
        let time_s = match item {
            None => return Ok(recipe),
            Some(Item::Missing { time_s, .. }) => {
                recipe.frames.push(RecipeFrame { time_s, at_px: vec![None; markers.len()] });
                continue;
            }
            Some(Item::Frame(frame)) => frame.time_s,
        };
        let bytes = bgr.of_last(&video)?;
        let converted = Instant::now();
        recipe.bgr_s += (converted - decoded).as_secs_f64();
        let whole = Mat::new_rows_cols_with_bytes::<Vec3b>(rows, columns, bytes)?;
        imgproc::cvt_color_def(&whole, &mut work.hsv, imgproc::COLOR_BGR2HSV)?;
        let mut at_px = vec![None; markers.len()];
        for colour in &colours {
            let blobs = work.blobs(colour)?;
            assign(&colour.markers, blobs, &mut last, &mut at_px);
        }
        recipe.frames.push(RecipeFrame { time_s, at_px });
        recipe.opencv_s += converted.elapsed().as_secs_f64();
    }
}

/// Markers of one colour, and its ranges of HSV: two where they pass red.
struct Colour {
    ranges: Vec<[Scalar; 2]>,
    markers: Vec<usize>,
}

fn colours(markers: &[Wanted]) -> anyhow::Result<Vec<Colour>> {
    let mut known: Vec<([u8; 3], Colour)> = Vec::new();
    for (k, marker) in markers.iter().enumerate() {
        if let Some((_, colour)) = known.iter_mut().find(|(srgb, _)| *srgb == marker.srgb) {
            colour.markers.push(k);
        } else {
            known.push((marker.srgb, Colour { ranges: ranges(marker.srgb)?, markers: vec![k] }));
        }
    }
    Ok(known.into_iter().map(|(_, colour)| colour).collect())
}

fn ranges([red, green, blue]: [u8; 3]) -> anyhow::Result<Vec<[Scalar; 2]>> {
    let pixel = Mat::from_slice(&[Vec3b::from([blue, green, red])])?.try_clone()?;
    let mut hsv = Mat::default();
    imgproc::cvt_color_def(&pixel, &mut hsv, imgproc::COLOR_BGR2HSV)?;
    let [hue, saturation, value] = hsv.at::<Vec3b>(0)?.0.map(f64::from);
    let (low, high) = (hue - HUE_TOLERANCE, hue + HUE_TOLERANCE);
    let range = |low: f64, high: f64| {
        let least = Scalar::new(low, LEAST_SATURATION * saturation, LEAST_VALUE * value, 0.0);
        [least, Scalar::new(high, GREATEST[1], GREATEST[2], 0.0)]
    };
    let turn = GREATEST[0] + 1.0;
    Ok(if low < 0.0 {
        vec![range(0.0, high), range(low + turn, GREATEST[0])]
    } else if high > GREATEST[0] {
        vec![range(low, GREATEST[0]), range(0.0, high - turn)]
    } else {
        vec![range(low, high)]
    })
}

/// Pictures that are used again for each frame.
#[derive(Default)]
struct Work {
    hsv: Mat,
    mask: Mat,
    other: Mat,
    both: Mat,
}

impl Work {
    /// Centroids of a colour's largest blobs, at most as many as it has markers, the largest first.
    fn blobs(&mut self, colour: &Colour) -> anyhow::Result<Vec<[f64; 2]>> {
        let [low, high] = &colour.ranges[0];
        core::in_range(&self.hsv, low, high, &mut self.mask)?;
        let mut mask = &self.mask;
        if let Some([low, high]) = colour.ranges.get(1) {
            core::in_range(&self.hsv, low, high, &mut self.other)?;
            core::bitwise_or_def(&self.mask, &self.other, &mut self.both)?;
            mask = &self.both;
        }
        let mut contours = Vector::<Vector<Point>>::new();
        imgproc::find_contours_def(mask, &mut contours, imgproc::RETR_EXTERNAL, imgproc::CHAIN_APPROX_NONE)?;
        let mut blobs = Vec::new();
        for contour in &contours {
            let area = imgproc::contour_area_def(&contour)?;
            if area >= LEAST_AREA_PX2 {
                let moments = imgproc::moments_def(&contour)?;
                blobs.push((area, [moments.m10 / moments.m00, moments.m01 / moments.m00]));
            }
        }
        blobs.sort_by(|a, b| b.0.total_cmp(&a.0));
        blobs.truncate(colour.markers.len());
        Ok(blobs.into_iter().map(|(_, at)| at).collect())
    }
}

/// Blobs to the markers of their colour: each to the nearest last place, the nearest pair first; from left to right
/// among those that have none.
fn assign(markers: &[usize], mut blobs: Vec<[f64; 2]>, last: &mut [Option<[f64; 2]>], at_px: &mut [Option<[f64; 2]>]) {
    loop {
        let waiting = markers.iter().filter(|&&marker| at_px[marker].is_none());
        let pairs =
            waiting.filter_map(|&marker| last[marker].map(|place| (marker, place))).flat_map(|(marker, place)| {
                let away = |at: &[f64; 2]| (at[0] - place[0]).hypot(at[1] - place[1]);
                blobs.iter().enumerate().map(move |(blob, at)| (away(at), marker, blob)).collect::<Vec<_>>()
            });
        let Some((_, marker, blob)) = pairs.min_by(|a, b| a.0.total_cmp(&b.0)) else { break };
        at_px[marker] = Some(blobs.swap_remove(blob));
    }
    blobs.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let waiting: Vec<usize> = markers.iter().copied().filter(|&m| at_px[m].is_none() && last[m].is_none()).collect();
    for (marker, at) in waiting.into_iter().zip(blobs) {
        at_px[marker] = Some(at);
    }
    for &marker in markers {
        last[marker] = at_px[marker].or(last[marker]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lunula::video::{Encoder, Encoding, Format, Matrix, Picture};

    const SIZE: Format = Format { width: 320, height: 180, subsampling: Some((2, 2)), depth: 8 };

    /// Discs of given colours and places on grey, in BT.601, which the recipe takes every video for.
    fn write(path: &Path, frames: &[Vec<([u8; 3], [f64; 2])>]) {
        let matrix = Matrix::BT601;
        let mut encoder = Encoder::create(path, &Encoding { matrix, crf: 8, ..Encoding::new(SIZE) }).unwrap();
        let ycc = |srgb: [u8; 3]| matrix.from_rgb(srgb.map(|part| f64::from(part) / 255.0)).map(|v| v.round() as u8);
        for (k, discs) in frames.iter().enumerate() {
            let mut picture = Picture::new(SIZE);
            for y in 0..SIZE.height {
                for x in 0..SIZE.width {
                    let inside = |at: &[f64; 2]| (x as f64 - at[0]).hypot(y as f64 - at[1]) <= 9.0;
                    let colour = discs.iter().find(|(_, at)| inside(at)).map_or([120; 3], |(srgb, _)| *srgb);
                    let [luma, cb, cr] = ycc(colour);
                    picture.planes[0][y * SIZE.width + x] = luma;
                    picture.planes[1][y / 2 * (SIZE.width / 2) + x / 2] = cb;
                    picture.planes[2][y / 2 * (SIZE.width / 2) + x / 2] = cr;
                }
            }
            encoder.push(&picture, 33 * k as i64).unwrap();
        }
        encoder.finish().unwrap();
    }

    const RED: [u8; 3] = [230, 20, 40];
    const BLUE: [u8; 3] = [20, 60, 220];

    fn wanted(name: &str, srgb: [u8; 3]) -> Wanted {
        Wanted { name: name.into(), srgb, start_px: None }
    }

    #[test]
    fn discs_are_found_named_and_missed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.mp4");
        let frames: Vec<_> = (0..6)
            .map(|k| {
                let x = 60.0 + 8.0 * k as f64;
                let mut discs = vec![(RED, [x, 50.0]), (RED, [x + 70.0, 60.0])];
                if k != 3 {
                    discs.push((BLUE, [250.0 - x / 2.0, 130.0]));
                }
                discs
            })
            .collect();
        write(&path, &frames);
        let markers = [wanted("left", RED), wanted("blue", BLUE), wanted("right", RED)];
        let recipe = run(&path, 2, &markers).unwrap();
        assert_eq!(recipe.frames.len(), 6);
        // Whole pixels of a contour and halved chroma: 0.8 px measured.
        const NEAR_PX: f64 = 1.2;
        for (k, frame) in recipe.frames.iter().enumerate() {
            let x = 60.0 + 8.0 * k as f64;
            let expected = [Some([x, 50.0]), Some([250.0 - x / 2.0, 130.0]).filter(|_| k != 3), Some([x + 70.0, 60.0])];
            for (found, expected) in frame.at_px.iter().zip(expected) {
                assert_eq!(found.is_some(), expected.is_some(), "frame {k}");
                if let (Some(found), Some(expected)) = (found, expected) {
                    let away = (found[0] - expected[0]).hypot(found[1] - expected[1]);
                    assert!(away <= NEAR_PX, "frame {k}: {found:?} is not {expected:?}");
                }
            }
        }
    }

    #[test]
    fn red_takes_two_ranges() {
        assert_eq!(ranges([255, 0, 20]).unwrap().len(), 2);
        assert_eq!(ranges([255, 20, 0]).unwrap().len(), 2);
        assert_eq!(ranges(BLUE).unwrap().len(), 1);
    }
}
