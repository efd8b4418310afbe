//! How many keys `lunula edit` takes to correct an outline, and how long a key takes to be seen.
//!
//! `cargo bench -p lunula-cli --bench edit -- [PHOTOGRAPHS MASKS IOU]`. A simulated person knows each nail's exact
//! outline and presses, time after time, the key that gains most per key pressed, until the two overlap to an IoU of
//! 0.97; a person sees what is wrong in about the same way, but neither knows the numbers nor never errs.
//!
//! Without arguments the nails are phantoms, whose outlines are exact: as detection finds them, drawn off by a seeded
//! tenth, and not known at all. With arguments they are those that detection finds on PHOTOGRAPHS (a folder of
//! pictures) of which MASKS has a mask of the same name; a hand drew those, and five numbers come no nearer to them
//! than an IoU of 0.93 in median, so IOU says when one is right.

#[path = "../tests/util/desk.rs"]
mod desk;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use desk::Desk;
use lunula::labelme::{LabelMe, Shape, to_labelme};
use lunula::nail::Outline;
use lunula::outlines::Pressed;
use lunula::phantom::Generated as _;
use lunula::phantom::photos::{LightKind, PhotoOptions};
use lunula::photo::outline::{Drawn, outlines_from_mask, read_annotated};
use lunula::photo::{PhotoSet, Photograph};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::{Value, json};

/// When an outline is right, where it is exact.
const RIGHT: f64 = 0.97;
/// How far an outline is drawn off at most: of its length and width, radians.
const OFF: f64 = 0.1;
const OFF_RAD: f64 = 0.2;
/// Less is another thing.
const SAME: f64 = 0.2;
/// More keys are given up.
const MOST_KEYS: usize = 80;
/// Tabs to a corner that are still worth a thought.
const MOST_TABS: usize = 8;

type Truth = BTreeMap<String, Vec<Outline>>;

fn main() {
    let folders: Vec<PathBuf> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).map(PathBuf::from).collect();
    if let [photographs, masks, iou] = &folders[..] {
        let (home, truth) = real(photographs, masks);
        return keys("found", home.path(), &truth, iou.to_string_lossy().parse().expect("an IoU"));
    }
    let (home, truth) = phantoms(LightKind::Varied, [640, 480], 16);
    keys("found", home.path(), &truth, RIGHT);
    let (home, truth) = phantoms(LightKind::Varied, [640, 480], 6);
    draw(home.path(), &truth, |outline, rng| off(&outline.points(), rng));
    keys("drawn off", home.path(), &truth, RIGHT);
    draw(home.path(), &truth, |_, _| Vec::new());
    keys("not known", home.path(), &truth, RIGHT);
    let (home, _) = phantoms(LightKind::Chamber, [4000, 3000], 2);
    times(home.path());
}

/// Phantoms without their outlines, and the outlines.
fn phantoms(light: LightKind, [width, height]: [u32; 2], subjects: u32) -> (tempfile::TempDir, Truth) {
    let home = tempfile::tempdir().expect("a temporary folder");
    let options = PhotoOptions { light, subjects, width, height, truth_normalized: false, ..PhotoOptions::default() };
    options.write(home.path()).expect("synthetic photographs");
    let set = PhotoSet::open(&home.path().join("photos"), &[]).expect("photographs");
    let mut truth = Truth::new();
    for photo in &set.photos {
        let (file, picture) = (photo.path.with_extension("json"), Photograph::read(&photo.path).expect("a picture"));
        let drawn = read_annotated(&file, &picture, Drawn::Auto).expect("its outline").nails;
        truth.insert(photo.file.clone(), drawn.into_iter().filter_map(|nail| nail.outline.ok()).collect());
        std::fs::remove_file(file).expect("it can be removed");
    }
    (home, truth)
}

/// Copies of photographs, and the outlines of their masks.
/// A LabelMe file beside each photograph, with what `shape` makes of its nail's outline.
fn draw(home: &Path, truth: &Truth, shape: impl Fn(&Outline, &mut ChaCha8Rng) -> Vec<[f64; 2]>) {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    for (file, outlines) in truth {
        let path = home.join("photos").join(file);
        let points = outlines.iter().map(|outline| shape(outline, &mut rng)).filter(|points| !points.is_empty());
        let shapes = points.map(|all| Shape::new("nail?", "polygon", all.into_iter().map(to_labelme).collect()));
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        LabelMe::new(&name, 640, 480, shapes.collect()).write(&path.with_extension("json")).expect("written");
    }
}

/// Moved, turned, longer or shorter, wider or narrower.
fn off(points: &[[f64; 2]], rng: &mut ChaCha8Rng) -> Vec<[f64; 2]> {
    let count = points.len() as f64;
    let centre = [0, 1].map(|k| points.iter().map(|point| point[k]).sum::<f64>() / count);
    let reach = points.iter().map(|p| (p[0] - centre[0]).hypot(p[1] - centre[1])).fold(0.0, f64::max);
    let mut up_to = |most: f64| rng.random_range(-most..=most);
    let [dx, dy] = [0; 2].map(|_| 2.0 * reach * up_to(OFF));
    let ([sx, sy], turn) = ([0; 2].map(|_| 1.0 + 2.0 * up_to(OFF)), up_to(OFF_RAD));
    let (sin, cos) = turn.sin_cos();
    let moved = |point: &[f64; 2]| {
        let [x, y] = [sx * (point[0] - centre[0]), sy * (point[1] - centre[1])];
        [centre[0] + dx + x * cos - y * sin, centre[1] + dy + x * sin + y * cos]
    };
    points.iter().map(moved).collect()
}

fn real(photographs: &Path, masks: &Path) -> (tempfile::TempDir, Truth) {
    let home = tempfile::tempdir().expect("a temporary folder");
    let folder = home.path().join("photos");
    std::fs::create_dir(&folder).expect("a folder");
    let mut truth = Truth::new();
    for entry in std::fs::read_dir(photographs).expect("a folder of photographs") {
        let path = entry.expect("an entry").path();
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        let Ok(mask) = Photograph::read(&masks.join(&name)) else { continue };
        let outlines = outlines_from_mask(&mask.image).expect("a mask");
        truth.insert(name.clone(), outlines.nails);
        std::fs::copy(&path, folder.join(name)).expect("a copy");
    }
    (home, truth)
}

impl Desk {
    fn press(&self, key: &Value) {
        assert_eq!(self.editor.key(key.to_string().as_bytes()), Pressed::Done, "{key}");
    }

    /// What is shown, as an outline.
    fn outline(&self) -> Option<Outline> {
        let points: Vec<[f64; 2]> = serde_json::from_value(self.sees()["nail"]["points"].clone()).ok()?;
        Outline::new(&points).ok()
    }

    fn overlap(&self, truth: &Outline) -> f64 {
        self.outline().map_or(0.0, |outline| outline.iou(truth))
    }

    /// The keys that were pressed until the outline was right; `Err` where it never was: with the best overlap.
    fn corrects(&self, truth: &Outline, right: f64) -> Result<usize, f64> {
        let mut pressed = 0;
        let mut overlap = self.overlap(truth);
        while overlap < right {
            let mut best: Option<(f64, f64, Vec<Value>)> = None;
            let before = self.sees()["nail"].clone();
            for keys in candidates(!before["corner"].is_null()) {
                keys.iter().for_each(|key| self.press(key));
                let after = self.overlap(truth);
                // The last key is all that is undone, and corners are no part of that.
                let tried = &self.sees()["nail"];
                if ["points", "axis"].iter().any(|what| tried[what] != before[what]) {
                    self.press(&json!({"key": "undo"}));
                }
                self.press(&json!({"key": "choose", "corner": before["corner"]}));
                // An end that is reached needs no more keys.
                let gain = (after.min(right) - overlap) / keys.len() as f64;
                if gain > 0.0 && best.as_ref().is_none_or(|(most, ..)| gain > *most) {
                    best = Some((gain, after, keys));
                }
            }
            let Some((_, after, keys)) = best else { return Err(overlap) };
            pressed += keys.len();
            if pressed > MOST_KEYS {
                return Err(overlap);
            }
            keys.iter().for_each(|key| self.press(key));
            assert!((self.overlap(truth) - after).abs() <= 1e-3, "the same keys do the same");
            overlap = after;
        }
        Ok(pressed)
    }
}

/// What a person thinks of: any key for the whole outline (Esc first, where a corner is chosen), and going to a corner
/// and moving it. The last key of each is the one that changes the outline.
fn candidates(chosen: bool) -> Vec<Vec<Value>> {
    let to_all = if chosen { vec![json!({"key": "choose", "corner": null})] } else { vec![] };
    let mut all: Vec<Vec<Value>> = whole().into_iter().map(|key| [&to_all[..], &[key]].concat()).collect();
    for tabs in usize::from(!chosen)..=MOST_TABS {
        for forwards in [true, false] {
            let to = vec![json!({"key": "corner", "forwards": forwards}); tabs];
            all.extend(of_corner().into_iter().map(|key| [&to[..], &[key]].concat()));
        }
    }
    all
}

const STRIDES: [&str; 3] = ["fine", "usual", "coarse"];
const WAYS: [[f64; 2]; 4] = [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]];

/// Keys for the whole outline.
fn whole() -> Vec<Value> {
    let mut all = vec![json!({"key": "snap"}), json!({"key": "flip"})];
    for stride in STRIDES {
        all.extend(WAYS.map(|by| json!({"key": "move", "by": by, "stride": stride})));
        for sign in [-1.0, 1.0] {
            let sizes = [[1.0, 1.0], [1.0, 0.0], [0.0, 1.0]].map(|by| by.map(|steps| sign * steps));
            all.extend(sizes.map(|by| json!({"key": "grow", "by": by, "stride": stride})));
            all.push(json!({"key": "turn", "by": sign, "stride": stride}));
        }
    }
    all
}

/// Keys for the corner that is chosen: out and in.
fn of_corner() -> Vec<Value> {
    let of = |stride| [1.0, -1.0].map(|sign| json!({"key": "grow", "by": [sign, sign], "stride": stride}));
    STRIDES.into_iter().flat_map(of).collect()
}

fn keys(what: &str, home: &Path, truth: &Truth, iou: f64) {
    let person = Desk::at(&home.join("photos"));
    let (mut counts, mut given_up, mut right, mut none) = (Vec::new(), Vec::new(), 0, 0);
    let mut before = Vec::new();
    loop {
        let state = person.sees();
        let nail = &state["nail"];
        if nail.is_null() {
            break;
        }
        let file = nail["photo"].as_str().expect("a name");
        let known = truth.get(file).or_else(|| truth.get(file.rsplit('/').next().unwrap_or(file)));
        let nearest = known.into_iter().flatten().max_by(|a, b| person.overlap(a).total_cmp(&person.overlap(b)));
        // Of a photograph's only nail there is no doubt which it is.
        let is_only = known.is_some_and(|all| all.len() == 1);
        match nearest.filter(|outline| is_only || person.overlap(outline) >= SAME) {
            None => {
                none += 1;
                person.press(&json!({"key": "reject"}));
            }
            Some(outline) => {
                before.push(person.overlap(outline));
                match person.corrects(outline, iou) {
                    Ok(0) => right += 1,
                    // And Enter.
                    Ok(count) => counts.push(count + 1),
                    Err(overlap) => given_up.push(overlap),
                }
                person.press(&json!({"key": "accept"}));
            }
        }
    }
    before.sort_by(f64::total_cmp);
    let all = before.len();
    println!(
        "{all} outlines {what}, IoU {:.3} in median before; {right} right as they were; {none} no nails",
        middle(&before)
    );
    let mut all: Vec<f64> = counts.iter().map(|count| *count as f64).collect();
    all.extend(given_up.iter().map(|_| f64::INFINITY));
    all.sort_by(f64::total_cmp);
    println!(
        "{} corrected to an IoU of {iou}: {} keys in median, {} at the 90th percentile, Enter included; {} given up \
         at IoU {:.3?}",
        counts.len(),
        middle(&all),
        at(&all, 0.9),
        given_up.len(),
        given_up
    );
}

/// From a key to the pictures of what it did, and from Enter to those of the next photograph, of 12 megapixels.
fn times(home: &Path) {
    let person = Desk::at(&home.join("photos"));
    let seen = |start: Instant| {
        person.editor.normalized(true).expect("a nail");
        start.elapsed()
    };
    let (mut keys, mut next) = (Vec::new(), Vec::new());
    while person.sees()["nail"].is_object() {
        for key in whole().into_iter().filter(|key| key["key"] == "move" || key["key"] == "grow").take(20) {
            let start = Instant::now();
            person.press(&key);
            keys.push(seen(start));
        }
        (0..20).for_each(|_| person.press(&json!({"key": "undo"})));
        // A person looks before the next.
        std::thread::sleep(Duration::from_millis(1500));
        let start = Instant::now();
        person.press(&json!({"key": "next"}));
        if person.sees()["nail"].is_object() {
            person.editor.photo().expect("a part of the photograph");
            next.push(seen(start));
        }
    }
    let ms = |mut all: Vec<Duration>| {
        all.sort();
        let all: Vec<f64> = all.into_iter().map(|time| 1e3 * time.as_secs_f64()).collect();
        (middle(&all), at(&all, 0.95), all.len())
    };
    let ((key, key_95, keys), (photo, photo_95, photos)) = (ms(keys), ms(next));
    println!(
        "12 megapixels: key to normalized picture {key:.1} ms in median, {key_95:.1} at the 95th percentile of {keys}"
    );
    println!(
        "Next photograph to both pictures {photo:.1} ms in median, {photo_95:.1} at the 95th percentile of {photos}"
    );
}

fn middle(sorted: &[f64]) -> f64 {
    at(sorted, 0.5)
}

fn at(sorted: &[f64], share: f64) -> f64 {
    let last = sorted.len().saturating_sub(1);
    sorted.get((share * last as f64).round() as usize).copied().unwrap_or(f64::NAN)
}
