//! From the marker file's tables to a layout, or to all of its faults.

use std::collections::BTreeMap;
use std::path::Path;

use super::raw::pair;
use super::{Camera, Joint, Layout, Marker, MarkerShape, Segment};

use crate::clock::{Clock, ClockFormat, ClockRoi};
use crate::flexion::Flexion;
use crate::toml_file::{Entry, Fault, Findings, entries, number};
use crate::words::instead;

const TABLES: [&str; 10] =
    ["flexion", "shape", "readout_ms", "markers", "segments", "joints", "start", "clock", "camera", "zero"];
/// No camera takes longer for the rows of a picture, milliseconds (assumed; 5 to 35 are usual of phones and webcams).
const LONGEST_READOUT_MS: f64 = 100.0;
/// The number of coefficients of OpenCV's lens models that are known here; those left out are zero.
const DISTORTIONS: [usize; 5] = [0, 4, 5, 8, 12];

pub(super) fn check(text: &str, path: &Path) -> Result<Layout, Vec<Fault>> {
    let mut findings = Findings::new(text);
    let Some(document) = findings.parse() else {
        return Err(findings.finish().err().unwrap_or_default());
    };
    let top = entries(document.get_ref());
    findings.unknown_keys(&top, &TABLES, "key");
    let mut notes = Vec::new();
    let flexion = flexion(&mut findings, &top, &mut notes, path);
    let shape = shape(&mut findings, &top);
    let readout_s = readout_s(&mut findings, &top);

    let marker_entries = findings.table(&top, "markers").unwrap_or_default();
    let markers = markers(&mut findings, &top, &marker_entries);
    let marker_names: Vec<&str> = marker_entries.iter().map(|e| e.key).collect();

    let segment_entries = findings.table(&top, "segments").unwrap_or_default();
    let segments = named(&mut findings, &segment_entries, "marker", &marker_names);
    let segment_names: Vec<&str> = segment_entries.iter().map(|e| e.key).collect();

    let joint_entries = findings.table(&top, "joints").unwrap_or_default();
    let joints = named(&mut findings, &joint_entries, "segment", &segment_names);
    column_clashes(&mut findings, &joint_entries);

    let zeros = zeros(&mut findings, &top, &joint_entries);
    let start = start(&mut findings, &top, &marker_names);
    let clock = clock(&mut findings, &top);
    let camera = camera(&mut findings, &top);

    for (k, entry) in marker_entries.iter().enumerate() {
        if !segment_entries.is_empty() && !segments.iter().any(|(_, pair)| pair.contains(&k)) {
            let line = findings.line(entry.key_at);
            notes.push(format!("{}:{line}: no segment uses the marker `{}`", path.display(), entry.key));
        }
    }
    if !findings.is_empty() {
        return Err(findings.finish().err().unwrap_or_default());
    }
    let mut warnings = Vec::new();
    for (name, what) in odd_joints(&joints, &segments) {
        let at = joint_entries.iter().find(|entry| entry.key == name).map_or(0, |entry| entry.key_at);
        warnings.push(format!("{}:{}: {what}", path.display(), findings.line(at)));
    }
    let before = |segment: usize| joints.iter().find(|(_, pair)| pair[1] == segment).map(|(_, pair)| pair[0]);
    Ok(Layout {
        hung_on: (0..segments.len()).map(before).collect(),
        flexion,
        shape,
        markers,
        segments: segments.into_iter().map(|(name, markers)| Segment { name, markers }).collect(),
        joints: joints
            .into_iter()
            .map(|(name, segments)| Joint { zero_rad: zeros.get(&name).copied().unwrap_or(0.0), name, segments })
            .collect(),
        start,
        clock,
        camera,
        readout_s,
        warnings,
        notes,
    })
}

/// Joints that are hardly meant so: numbered against the finger's order, of two segments that begin at one marker, or
/// of a segment that an earlier joint has on the same side. Each with its name.
fn odd_joints<'a>(
    joints: &'a [(String, [usize; 2])],
    segments: &'a [(String, [usize; 2])],
) -> impl Iterator<Item = (&'a str, String)> {
    let number = |name: &str| name.strip_prefix('J').and_then(|number| number.parse::<u32>().ok());
    let is_after = move |one: &(String, [usize; 2]), other: &&(String, [usize; 2])| {
        other.1[0] == one.1[1] && number(&one.0).zip(number(&other.0)).is_some_and(|(one, other)| one > other)
    };
    joints.iter().flat_map(move |joint| {
        let (name, [proximal, distal]) = joint;
        let exchanged = joints.iter().find(|other| is_after(joint, other)).map(|(other, _)| {
            format!(
                "{name} lies before {other} on the finger, as its distal segment is the proximal one of {other}; J1, \
                 J2 and J3 are the MP, PIP and DIP joint: are the two exchanged?"
            )
        });
        let overlap = (segments[*proximal].1[0] == segments[*distal].1[0]).then(|| {
            format!(
                "both segments of {name}, `{}` and `{}`, begin at the same marker, so that one lies over the other; a \
                 finger's distal segment begins where the proximal one ends",
                segments[*proximal].0, segments[*distal].0
            )
        });
        // What is called otherwise may well reach over several joints.
        let earlier = joints.iter().take_while(|other| *other != joint).filter(|other| number(&other.0).is_some());
        let again = earlier.filter(|_| number(name).is_some()).find_map(|(other, pair)| {
            let side = (0..2).find(|&side| pair[side] == joint.1[side])?;
            let both =
                if *pair == joint.1 { "both segments" } else { ["the proximal segment", "the distal segment"][side] };
            Some(format!(
                "{other} and {name} have {both} in common, and joints of a finger follow each other, each between two \
                 segments of its own: was a line copied, or a segment left out?"
            ))
        });
        exchanged.into_iter().chain(overlap).chain(again).map(move |what| (name.as_str(), what))
    })
}

fn flexion(findings: &mut Findings<'_>, top: &[Entry<'_>], notes: &mut Vec<String>, path: &Path) -> Flexion {
    let Some(entry) = top.iter().find(|e| e.key == "flexion") else {
        if top.iter().any(|e| e.key == "joints") {
            notes.push(format!("{}:1: `flexion` is not given; clockwise is taken", path.display()));
        }
        return Flexion::Clockwise;
    };
    match entry.value.as_str() {
        Some("clockwise") => Flexion::Clockwise,
        Some("counterclockwise") => Flexion::Counterclockwise,
        _ => {
            findings.fault(entry.at, "`flexion` has to be \"clockwise\" or \"counterclockwise\"");
            Flexion::Clockwise
        }
    }
}

fn shape(findings: &mut Findings<'_>, top: &[Entry<'_>]) -> Option<MarkerShape> {
    let entry = top.iter().find(|e| e.key == "shape")?;
    let shape =
        [MarkerShape::Disc, MarkerShape::Blot].into_iter().find(|shape| entry.value.as_str() == Some(shape.name()));
    if shape.is_none() {
        findings.fault(
            entry.at,
            "`shape` has to be \"disc\" (stickers) or \"blot\" (paint); leave it out to have each marker decided by \
             how it looks",
        );
    }
    shape
}

fn markers(findings: &mut Findings<'_>, top: &[Entry<'_>], entries: &[Entry<'_>]) -> Vec<Marker> {
    if entries.is_empty() && !top.iter().any(|e| e.key == "markers" && !e.value.is_table()) {
        let at = top.iter().find(|e| e.key == "markers").map_or(0, |e| e.key_at);
        findings.fault(at, "no markers; list them under [markers], such as tip = \"#e91e63\"");
    }
    let mut markers = Vec::new();
    for entry in entries {
        check_name(findings, *entry, "marker");
        if entry.key.contains(char::is_whitespace) {
            // `status` lists markers with spaces between.
            findings
                .fault(entry.key_at, format!("the marker name `{}` has a space; write `_`", entry.key.escape_debug()));
        }
        let Some(colour) = entry.value.as_str().and_then(colour) else {
            findings.fault(
                entry.at,
                format!("the colour of `{}` can't be read; write it as red, green, blue: \"#e91e63\"", entry.key),
            );
            continue;
        };
        markers.push(Marker { name: entry.key.to_owned(), colour });
    }
    markers
}

/// `#rrggbb` or `#rgb`.
fn colour(text: &str) -> Option<[u8; 3]> {
    let digits = text.trim().strip_prefix('#')?;
    let digits: Vec<u8> = digits.chars().map(|c| c.to_digit(16).map(|d| d as u8)).collect::<Option<_>>()?;
    match digits[..] {
        [r, g, b] => Some([17 * r, 17 * g, 17 * b]),
        [r1, r0, g1, g0, b1, b0] => Some([16 * r1 + r0, 16 * g1 + g0, 16 * b1 + b0]),
        _ => None,
    }
}

/// Names become columns of tables.
fn check_name(findings: &mut Findings<'_>, entry: Entry<'_>, kind: &str) {
    let name = entry.key;
    if name.is_empty() || name.trim() != name {
        findings.fault(
            entry.key_at,
            format!("the {kind} name \"{name}\" is empty or begins or ends with a space; rename it"),
        );
    } else if name.contains([',', ';', '"']) || name.contains(char::is_control) {
        let shown = name.escape_debug();
        findings.fault(
            entry.key_at,
            format!("the {kind} name \"{shown}\" can't head a column of a table; use letters, digits, `_` and `-`"),
        );
    }
}

/// Segments (of markers) or joints (of segments): a name and two indices each.
fn named(findings: &mut Findings<'_>, entries: &[Entry<'_>], of: &str, known: &[&str]) -> Vec<(String, [usize; 2])> {
    let kind = if of == "marker" { "segment" } else { "joint" };
    let mut found = Vec::new();
    for entry in entries {
        check_name(findings, *entry, kind);
        if let Some(pair) = pair(findings, *entry, of, known) {
            found.push((entry.key.to_owned(), pair));
        }
    }
    found
}

/// Joint `J2` has the columns `J2_deg` and `J2_sd_deg`; the latter would be a joint `J2_sd`'s first too.
fn column_clashes(findings: &mut Findings<'_>, joints: &[Entry<'_>]) {
    for entry in joints {
        let of = entry.key.strip_suffix("_sd");
        if let Some(other) = joints.iter().find(|j| Some(j.key) == of) {
            let what = format!(
                "joint `{}` has the same column as the standard error of `{}`; rename it",
                entry.key, other.key
            );
            findings.fault(entry.key_at, what);
        }
    }
}

/// Radians by the joint's name.
fn zeros(findings: &mut Findings<'_>, top: &[Entry<'_>], joints: &[Entry<'_>]) -> BTreeMap<String, f64> {
    let known: Vec<String> = joints.iter().map(|j| format!("{}_deg", j.key)).collect();
    let known: Vec<&str> = known.iter().map(String::as_str).collect();
    let mut zeros = BTreeMap::new();
    for entry in findings.table(top, "zero").unwrap_or_default() {
        match entry.key.strip_suffix("_deg") {
            Some(joint) if joints.iter().any(|j| j.key == joint) => {
                if let Some(degrees) = findings.number(entry) {
                    zeros.insert(joint.to_owned(), degrees.to_radians());
                }
            }
            Some(joint) => {
                let what = format!("[zero] names the unknown joint `{joint}`; {}", instead(entry.key, &known));
                findings.fault(entry.key_at, what);
            }
            None => {
                let what = format!("`{0}` in [zero] lacks its unit; write {0}_deg, in degrees", entry.key);
                findings.fault(entry.key_at, what);
            }
        }
    }
    zeros
}

fn start(findings: &mut Findings<'_>, top: &[Entry<'_>], markers: &[&str]) -> Vec<Option<[f64; 2]>> {
    let mut start = vec![None; markers.len()];
    for entry in findings.table(top, "start").unwrap_or_default() {
        let Some(marker) = markers.iter().position(|&m| m == entry.key) else {
            let what = format!("[start] names the unknown marker `{}`; {}", entry.key, instead(entry.key, markers));
            findings.fault(entry.key_at, what);
            continue;
        };
        let shape = format!("{} = [x, y], pixels of the first frame", entry.key);
        if let Some(numbers) = findings.numbers(entry, &shape) {
            match numbers[..] {
                [x, y] => start[marker] = Some([x, y]),
                _ => {
                    findings.fault(entry.at, format!("`{}` has {} number(s); write {shape}", entry.key, numbers.len()))
                }
            }
        }
    }
    start
}

fn readout_s(findings: &mut Findings<'_>, top: &[Entry<'_>]) -> f64 {
    let Some(entry) = top.iter().find(|e| e.key == "readout_ms") else { return 0.0 };
    let readout_ms = number(entry.value).filter(|ms| (0.0..=LONGEST_READOUT_MS).contains(ms));
    if readout_ms.is_none() {
        findings.fault(
            entry.at,
            format!(
                "`readout_ms` is how long the camera takes from a picture's first row to its last: milliseconds, \
                 from 0 (all at once) to {LONGEST_READOUT_MS}"
            ),
        );
    }
    1e-3 * readout_ms.unwrap_or_default()
}

fn clock(findings: &mut Findings<'_>, top: &[Entry<'_>]) -> Option<Clock> {
    let table = findings.table(top, "clock")?;
    let at = top.iter().find(|e| e.key == "clock").map_or(0, |e| e.key_at);
    findings.unknown_keys(&table, &["roi", "format", "refresh_hz", "delay_ms"], "key of [clock]");
    let roi = match table.iter().find(|e| e.key == "roi") {
        None => {
            findings.fault(at, "[clock] lacks `roi`; write roi = [x, y, width, height] or roi = \"auto\"");
            None
        }
        Some(entry) => roi(findings, *entry),
    };
    let format = match table.iter().find(|e| e.key == "format") {
        None => {
            findings.fault(at, "[clock] lacks `format`; write what its digits mean, such as format = \"mm:ss.t\"");
            None
        }
        Some(entry) => match entry.value.as_str().map(ClockFormat::parse) {
            Some(Ok(format)) => Some(format),
            Some(Err(what)) => {
                findings.fault(entry.at, what);
                None
            }
            None => {
                findings.fault(entry.at, "`format` has to be text, such as \"mm:ss.t\"");
                None
            }
        },
    };
    let refresh_hz = table.iter().find(|e| e.key == "refresh_hz").and_then(|entry| {
        let hertz = number(entry.value).filter(|&hertz| hertz > 0.0);
        if hertz.is_none() {
            findings.fault(
                entry.at,
                "`refresh_hz` is how often the clock's screen changes a second: a number above 0, or inf for a display \
                 that changes at once; leave it out where it is not known",
            );
        }
        hertz
    });
    let delay_s = table.iter().find(|e| e.key == "delay_ms").map_or(Some([0.0; 2]), |entry| delay_s(findings, entry));
    Some(Clock { roi: roi?, format: format?, refresh_hz, delay_s: delay_s? })
}

/// A display is no later than this, milliseconds (assumed: televisions that work on their pictures take 0.1 to 0.2 s).
const LONGEST_DELAY_MS: f64 = 1000.0;

/// The least and the longest delay, of one number or two.
fn delay_s(findings: &mut Findings<'_>, entry: &Entry<'_>) -> Option<[f64; 2]> {
    let ends = match entry.value.as_array() {
        None => number(entry.value).map(|ms| [ms; 2]),
        Some(_) => findings.numbers(*entry, "delay_ms = [least, most]")?.try_into().ok(),
    };
    let ends = ends.filter(|[least, most]| 0.0 <= *least && least <= most && *most <= LONGEST_DELAY_MS);
    if ends.is_none() {
        findings.fault(
            entry.at,
            format!(
                "`delay_ms` is how late the display shows what the program counts: milliseconds from 0 to \
                 {LONGEST_DELAY_MS}, or two numbers that it lies between, as [20, 40]"
            ),
        );
    }
    ends.map(|ends| ends.map(|ms| 1e-3 * ms))
}

fn roi(findings: &mut Findings<'_>, entry: Entry<'_>) -> Option<ClockRoi> {
    const SHAPE: &str = "roi = [x, y, width, height] in pixels, or roi = \"auto\"";
    if entry.value.as_str() == Some("auto") {
        return Some(ClockRoi::Auto);
    }
    let numbers = findings.numbers(entry, SHAPE)?;
    match numbers[..] {
        [x, y, width, height] if width >= 1.0 && height >= 1.0 && x >= -0.5 && y >= -0.5 => {
            Some(ClockRoi::Box([x, y, width, height]))
        }
        [_, _, _, _] => {
            findings.fault(entry.at, format!("`roi` is outside of the picture or empty; write {SHAPE}"));
            None
        }
        _ => {
            findings.fault(entry.at, format!("`roi` has {} number(s) and needs four; write {SHAPE}", numbers.len()));
            None
        }
    }
}

fn camera(findings: &mut Findings<'_>, top: &[Entry<'_>]) -> Option<Camera> {
    let table = findings.table(top, "camera")?;
    let at = top.iter().find(|e| e.key == "camera").map_or(0, |e| e.key_at);
    findings.unknown_keys(&table, &["size", "fx", "fy", "cx", "cy", "distortion", "plane"], "key of [camera]");
    let mut lengths = ["fx", "fy", "cx", "cy"].map(|key| {
        let entry = *table.iter().find(|e| e.key == key)?;
        let number = findings.number(entry)?;
        if key.starts_with('f') && number <= 0.0 {
            findings.fault(entry.at, format!("`{key}` is a focal length in pixels and has to be above 0"));
            return None;
        }
        Some(number)
    });
    if !table.iter().any(|e| e.key == "fx") {
        findings.fault(at, "[camera] lacks `fx`; give OpenCV's calibration: fx (and fy, cx, cy), distortion");
    }
    let size_px = table.iter().find(|e| e.key == "size").and_then(|&entry| size(findings, entry));
    let mut distortion = [0.0; 12];
    if let Some(&entry) = table.iter().find(|e| e.key == "distortion") {
        let numbers = findings.numbers(entry, "[k1, k2, p1, p2, k3]")?;
        // The tilted sensor of the 14 is left out where it is not tilted.
        let model = if numbers.len() == 14 && numbers[12..] == [0.0, 0.0] { &numbers[..12] } else { &numbers[..] };
        if DISTORTIONS.contains(&model.len()) {
            distortion[..model.len()].copy_from_slice(model);
        } else if numbers.len() == 14 {
            findings.fault(
                entry.at,
                "`distortion` has a tilted sensor (tau), which is not known here; calibrate without it",
            );
        } else {
            let what = format!("`distortion` has {} number(s); OpenCV's models have 4, 5, 8 or 12", numbers.len());
            findings.fault(entry.at, what);
        }
    }
    let plane = plane(findings, &table);
    let [fx_px, fy_px, cx_px, cy_px] = lengths.each_mut().map(Option::take);
    Some(Camera { size_px, fx_px: fx_px?, fy_px, cx_px, cy_px, distortion, plane })
}

/// Columns and rows of a picture.
fn size(findings: &mut Findings<'_>, entry: Entry<'_>) -> Option<[usize; 2]> {
    const SHAPE: &str = "size = [width, height] of the pictures that the lens was measured on, pixels";
    let numbers = findings.numbers(entry, SHAPE)?;
    let size: Option<[f64; 2]> = numbers.as_slice().try_into().ok();
    let size = size.filter(|size| size.iter().all(|side| (1.0..=65_535.0).contains(side) && side.fract() == 0.0));
    if size.is_none() {
        findings.fault(entry.at, format!("`size` is no picture's; write {SHAPE}"));
    }
    size.map(|size| size.map(|side| side as usize))
}

/// A plane that is turned further from the picture is hardly seen: the least of its normal along the optical axis
/// (assumed; 80 degrees).
const LEAST_FACING: f64 = 0.17;

/// The normal of `[camera.plane]`, of length 1.
fn plane(findings: &mut Findings<'_>, camera: &[Entry<'_>]) -> Option<[f64; 3]> {
    const SHAPE: &str = "normal = [right, down, forwards], towards the camera, as [0.0, -0.5, -0.87]";
    let table = findings.table(camera, "plane")?;
    let at = camera.iter().find(|e| e.key == "plane").map_or(0, |e| e.key_at);
    findings.unknown_keys(&table, &["normal"], "key of [camera.plane]");
    let Some(&entry) = table.iter().find(|e| e.key == "normal") else {
        findings
            .fault(at, format!("[camera.plane] lacks `normal`; write {SHAPE}, or have lunula camera --plane do it"));
        return None;
    };
    let numbers = findings.numbers(entry, SHAPE)?;
    let normal: Option<[f64; 3]> = numbers.as_slice().try_into().ok();
    let unit = normal.and_then(|normal| {
        let length = normal.iter().map(|part| part * part).sum::<f64>().sqrt();
        let unit = normal.map(|part| part / length);
        (length.is_finite() && -unit[2] >= LEAST_FACING).then_some(unit)
    });
    if unit.is_none() {
        let what = format!("`normal` is no direction towards the camera (its third number below 0); write {SHAPE}");
        findings.fault(entry.at, what);
    }
    unit
}
