//! The prompter's clock, as a browser draws it, filmed beside a finger: `lunula posture` reads it.

use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

use image::GrayImage;
use lunula::phantom::screen::Clock;
use lunula::prompt::CLOCK;
use lunula::video::{Encoder, Encoding, Format, Frame, Item, Picture, Video};

use crate::util::{Dir, Json, repository};

/// The panel on the picture: left, top, width, height; it covers the clock that the fixture has.
const PANEL: [usize; 4] = [440, 12, 180, 50];
/// What the page's clock says at the video's beginning, seconds: its tenths change between two frames.
const BEGINS_S: f64 = 83.456;

/// What the page shows of a clock at these times, one below the other, as a browser draws the page's own styles.
fn sheet(dir: &Dir, times_s: &[f64]) -> GrayImage {
    let pages = repository().join("crates/ui/src/pages");
    let styles =
        ["style.css", "prompt/prompt.css"].map(|name| std::fs::read_to_string(pages.join(name)).expect("a style"));
    let height = PANEL[3];
    let mut page = format!("<!DOCTYPE html><style>{} div {{ position: absolute; left: 0 }}</style>", styles.join(" "));
    let clock = Clock { offset_s: 0.0, ..Clock::default() };
    for (k, time_s) in times_s.iter().enumerate() {
        let _ = write!(page, "<div style=\"top:{}px\"><p id=clock>{}</p></div>", k * height, clock.shown(*time_s).0);
    }
    dir.write("sheet.html", page);
    let run = Command::new("chromium")
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars"])
        .arg(format!("--user-data-dir={}", dir.path("profile").display()))
        .arg(format!("--screenshot={}", dir.path("sheet.png").display()))
        .arg(format!("--window-size=600,{}", height * times_s.len()))
        .arg(format!("file://{}", dir.path("sheet.html").display()))
        .output()
        .expect("chromium is installed");
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    image::open(dir.path("sheet.png")).expect("a picture").to_luma8()
}

fn with_panel(frame: &Frame<'_>, sheet: &GrayImage, k: usize) -> Picture {
    let (width, height) = (frame.luma.width, frame.luma.height);
    let mut picture = Picture::new(Format { width, height, subsampling: Some((2, 2)), depth: 8 });
    let [left, top, wide, high] = PANEL;
    let within = |x: usize, y: usize| (left..left + wide).contains(&x) && (top..top + high).contains(&y);
    for (at, value) in picture.planes[0].iter_mut().enumerate() {
        let (x, y) = (at % width, at / width);
        *value = if within(x, y) {
            let grey = sheet.get_pixel((x - left) as u32, (y - top + k * high) as u32).0[0];
            (16.0 + 219.0 * f64::from(grey) / 255.0).round() as u8
        } else {
            frame.luma.sample(x, y) as u8
        };
    }
    for (plane, chroma) in frame.chroma.as_ref().expect("colour").iter().enumerate() {
        for (at, value) in picture.planes[plane + 1].iter_mut().enumerate() {
            let (x, y) = (at % chroma.width, at / chroma.width);
            *value = if within(2 * x, 2 * y) { 128 } else { chroma.sample(x, y) as u8 };
        }
    }
    picture
}

fn film(from: &Path, to: &Path, sheet: &GrayImage) {
    let mut video = Video::open(from, 1).expect("a video");
    let mut encoder: Option<(Encoder, f64)> = None;
    let mut k = 0;
    while let Some(item) = video.next_item().expect("a frame") {
        let Item::Frame(frame) = item else { panic!("a frame is damaged") };
        let picture = with_panel(&frame, sheet, k);
        let (encoder, ticks_per_s) = encoder.get_or_insert_with(|| {
            let encoding = Encoding::new(picture.format);
            (Encoder::create(to, &encoding).expect("an encoder"), f64::from(encoding.ticks_per_s))
        });
        encoder.push(&picture, (frame.time_s * *ticks_per_s).round() as i64).expect("a frame");
        k += 1;
    }
    encoder.expect("frames").0.finish().expect("a video");
}

#[test]
#[ignore = "needs Chromium: `make test` runs it where that is installed"]
fn in_browser_the_pages_clock_is_read_from_a_video_by_the_snippet() {
    let dir = Dir::new();
    let fixture = repository().join("fixtures/finger");
    let [video, markers] = ["video.mp4", "markers.toml"].map(|name| fixture.join(name).display().to_string());
    dir.lunula(&["posture", &video, "--markers", &markers, "--out", "truth.csv", "-q"]).expect(0);
    let times_s: Vec<f64> =
        dir.table("truth.csv").iter().map(|row| BEGINS_S + row["time_s"].parse::<f64>().expect("a time")).collect();
    let sheet = sheet(&dir, &times_s);
    film(&fixture.join("video.mp4"), &dir.path("filmed.mp4"), &sheet);
    let markers = std::fs::read_to_string(fixture.join("markers.toml")).expect("a marker file");
    let without = markers.split("[clock]").next().expect("markers");
    // The page's screen changes at once here; where it is is given, as two seconds are short to search in.
    let [left, top, wide, high] = PANEL;
    let snippet = CLOCK.replace("\"auto\"", &format!("[{left}, {top}, {wide}, {high}]"));
    dir.write("m.toml", format!("{without}{}", snippet.replace("60.0", "inf")));
    let filmed = ["posture", "filmed.mp4", "--markers", "m.toml", "--out", "j.csv", "--json"];
    let report = dir.lunula(&filmed).expect(0).json();
    let clock = &report["clock"];
    assert_eq!(
        (clock["frames_read"].number() as usize, clock["frames_refused"].number()),
        (times_s.len(), 0.0),
        "{clock}"
    );
    let interval = clock["tie"]["offset_interval_s"].list();
    let [low, high] = [interval[0].number(), interval[1].number()];
    assert!(low <= BEGINS_S && BEGINS_S <= high && high - low <= 0.1, "{BEGINS_S} is not in {low} to {high}");
    for (row, time_s) in dir.table("j.csv").iter().zip(&times_s) {
        let read_s: f64 = row["clock_s"].parse().expect("a time");
        assert!((read_s - time_s).abs() <= 0.05, "{read_s} for {time_s}");
    }
}
