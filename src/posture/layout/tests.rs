use super::*;
use crate::clock::ClockRoi;
use crate::trial::Folder;

/// The contract's example, with the markers that it leaves out.
const WHOLE: &str = r##"
flexion = "clockwise"
[markers]
a = "#e91e63"
b = "#E91E63"
c = "#00f"
d = "#00c853"
spare = "#ffeb3b"
[segments]
proximal = ["a", "b"]
middle = ["b", "c"]
distal = ["c", "d"]
[joints]
J3 = ["middle", "distal"]
J2 = ["proximal", "middle"]
[start]
a = [384.0, 320]
[clock]
roi = [900, 40, 300, 70]
format = "mm:ss.t"
[camera]
fx = 1200.0
distortion = [0.1, 0.0, 0.0, 0.0, 0.02]
[zero]
J2_deg = 180
"##;

fn parse(text: &str) -> Result<Layout, LayoutError> {
    Layout::parse(text, Path::new("m.toml"))
}

/// `line: words` of each fault.
fn faults(text: &str) -> Vec<String> {
    match parse(text) {
        Err(LayoutError::Faults { faults, .. }) => faults.iter().map(|f| format!("{}: {}", f.line, f.what)).collect(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_whole_file_is_read_in_its_own_order() {
    let layout = parse(WHOLE).unwrap();
    assert_eq!(layout.flexion, Flexion::Clockwise);
    assert_eq!(layout.markers[1], Marker { name: "b".into(), colour: [0xe9, 0x1e, 0x63] });
    assert_eq!(layout.markers[2].colour, [0, 0, 255]);
    assert_eq!(layout.segments[1], Segment { name: "middle".into(), markers: [1, 2] });
    assert_eq!(layout.joints[0], Joint { name: "J3".into(), segments: [1, 2], zero_rad: 0.0 });
    assert_eq!(layout.joints[1], Joint { name: "J2".into(), segments: [0, 1], zero_rad: std::f64::consts::PI });
    assert_eq!(layout.start, [Some([384.0, 320.0]), None, None, None, None]);
    let clock = layout.clock.as_ref().unwrap();
    assert_eq!((clock.roi, clock.format.text()), (ClockRoi::Box([900.0, 40.0, 300.0, 70.0]), "mm:ss.t"));
    let camera = layout.camera.as_ref().unwrap();
    assert_eq!((camera.fx_px, camera.fy_px, camera.distortion[4]), (1200.0, None, 0.02));
    assert_eq!(layout.notes, ["m.toml:8: no segment uses the marker `spare`"]);
}

#[test]
fn joints_that_are_hardly_meant_so_are_warned_of() {
    let warnings = |segments: &str, joints: &str| {
        let markers = "[markers]\na = \"#f00\"\nb = \"#0f0\"\nc = \"#00f\"\nd = \"#ff0\"\n";
        parse(&format!("{markers}[segments]\n{segments}\n[joints]\n{joints}\n")).unwrap().warnings
    };
    let chain = "p = [\"a\", \"b\"]\nm = [\"b\", \"c\"]\nd = [\"c\", \"d\"]";
    assert_eq!(warnings(chain, "J2 = [\"p\", \"m\"]\nJ3 = [\"m\", \"d\"]"), [""; 0]);
    assert_eq!(warnings(chain, "wrist = [\"m\", \"d\"]\nJ1 = [\"p\", \"m\"]"), [""; 0]);
    let exchanged = warnings(chain, "J2 = [\"m\", \"d\"]\nJ3 = [\"p\", \"m\"]");
    assert!(exchanged.len() == 1 && exchanged[0].starts_with("m.toml:12: J3 lies before J2"), "{exchanged:?}");
    let over = warnings(&chain.replace("[\"c\", \"d\"]", "[\"b\", \"d\"]"), "J3 = [\"m\", \"d\"]");
    assert!(over.len() == 1 && over[0].contains("both segments of J3, `m` and `d`, begin at"), "{over:?}");
    let copied = warnings(chain, "J1 = [\"p\", \"m\"]\nJ2 = [\"p\", \"m\"]");
    assert!(copied.len() == 1 && copied[0].contains("12: J1 and J2 have both segments in common"), "{copied:?}");
    let skipped = warnings(chain, "J1 = [\"p\", \"m\"]\nJ2 = [\"p\", \"d\"]");
    assert!(skipped.len() == 1 && skipped[0].contains("have the proximal segment in common"), "{skipped:?}");
    assert_eq!(warnings(chain, "J1 = [\"p\", \"m\"]\nwhole = [\"p\", \"d\"]"), [""; 0]);
}

#[test]
fn only_what_wanted_joints_use_is_needed() {
    let layout = parse(WHOLE).unwrap();
    assert_eq!(layout.needed(), [true, true, true, true, false]);
    let one = layout.wanting(&["J3".into()]).unwrap();
    assert_eq!(one.needed(), [false, true, true, true, false]);
    assert_eq!(one.hung_on, [None, Some(0), Some(1)], "which segment follows which is known all the same");
    assert_eq!(layout.wanting(&[]).unwrap(), layout);
    let unknown = layout.wanting(&["j2".into()]).unwrap_err().to_string();
    assert!(unknown.contains("`j2`") && unknown.contains("did you mean `J2`"), "{unknown}");
}

#[test]
fn without_joints_all_markers_are_needed() {
    let layout = parse("[markers]\nb = \"#00f\"\na = \"#0f0\"\n").unwrap();
    assert_eq!(layout.needed(), [true, true]);
    assert!(layout.notes.is_empty(), "no joint, no sign to speak of");
    assert!(layout.wanting(&["J2".into()]).unwrap_err().to_string().contains("no [joints]"));
}

#[test]
fn all_faults_are_told_at_once_with_their_lines() {
    let text = r##"flexion = "clock"
[marker]
x = 1
[markers]
tip = "e91e63"
base = "#e91e6"
"a,b" = "#fff"
"" = "#fff"
two = 3
"two words" = "#123456"
[segments]
one = ["tip", "tip"]
three = ["tip", "base", "two"]
lone = ["tip"]
odd = ["tip", "bese"]
typo = "tip"
good = ["tip", "base"]
[joints]
J1 = ["good", "good"]
J2 = ["good", "one"]
J3 = ["good", "lost"]
J2_sd = ["good", "one"]
[start]
tap = [1, 2]
tip = [1, nan]
base = [1, 2, 3]
[clock]
roi = [1, 2, 0, 4]
format = "mm:ss.f"
rio = 3
[camera]
fy = -1.0
distortion = [1, 2, 3]
[zero]
J1 = 2
J9_deg = 2
J2_deg = inf
"##;
    let messages = faults(text);
    let mut expected = vec![
        "1: `flexion`",
        "2: unknown key `marker`; did you mean `markers`?",
        "5: the colour of `tip`",
        "6: the colour of `base`",
        "7: the marker name \"a,b\"",
        "8: the marker name \"\"",
        "9: the colour of `two`",
        "10: the marker name `two words`",
        "12: `one` names the marker `tip` twice",
        "13: `three` has 3",
        "14: `lone` has 1",
        "15: `odd` names the unknown marker `bese`; did you mean `base`?",
        "16: `typo` is no list",
        "19: `J1` names the segment `good` twice",
        "21: `J3` names the unknown segment `lost`",
        "22: joint `J2_sd`",
        "24: [start] names the unknown marker `tap`; did you mean `tip`?",
        "25: `tip` has to be finite",
        "26: `base` has 3",
        "28: `roi` is outside",
        "29: `f` is no digit",
        "30: unknown key of [clock] `rio`; did you mean `roi`?",
        "31: [camera] lacks `fx`",
        "32: `fy` is a focal length",
        "33: `distortion` has 3",
        "35: `J1` in [zero] lacks its unit",
        "36: [zero] names the unknown joint `J9`",
        "37: `J2_deg` has to be a finite",
    ];
    for fault in &messages {
        let found = expected.iter().position(|e| fault.starts_with(e));
        expected.remove(found.unwrap_or_else(|| panic!("not expected: {fault}")));
    }
    assert!(expected.is_empty(), "not messages: {expected:?}");
    let lines: Vec<usize> = messages.iter().map(|t| t.split(':').next().unwrap().parse().unwrap()).collect();
    assert!(lines.is_sorted());
    let message = parse(text).unwrap_err().to_string();
    assert!(message.lines().all(|l| l.starts_with("m.toml:")) && message.lines().count() == messages.len());
}

#[test]
fn broken_toml_is_told_with_its_line() {
    for (text, line) in
        [("[markers]\na = \n", 2), ("[markers\na='#fff'", 1), ("[markers]\na='#fff'\n\nb = '#ff", 4), ("x = = 2", 1)]
    {
        let messages = faults(text);
        assert!(messages.iter().any(|t| t.starts_with(&format!("{line}: not TOML: "))), "{text}: {messages:?}");
        assert!(messages.iter().all(|t| t.contains("not TOML")), "guesses beside the broken line: {messages:?}");
    }
}

#[test]
fn of_another_kind_of_file_a_few_lines_are_named() {
    let messages = faults(&"name,x_px,y_px\n".repeat(120));
    assert_eq!(messages.len(), 4, "{messages:?}");
    assert!(messages[3].contains("117 more faults are not named"), "{messages:?}");
}

#[test]
fn a_doubled_name_is_told_along_with_the_rest() {
    let messages = faults("[markers]\na = '#fff'\na = '#000'\nb = 'red'\n");
    assert_eq!(messages.len(), 2, "{messages:?}");
    assert!(
        messages[0].starts_with("3: `a` stands here a second time") && messages[1].starts_with("4: the colour of `b`")
    );
}

#[test]
fn a_file_without_markers_is_refused() {
    assert!(faults("")[0].starts_with("1: no markers"));
    assert!(faults("flexion = 'clockwise'\n[markers]\n")[0].starts_with("2: no markers"));
    assert_eq!(faults("markers = 3"), ["1: `markers` is no table but integer; write [markers] and its lines below"]);
}

#[test]
fn lens_models_of_known_sizes_are_taken() {
    let with = |list: &str| parse(&format!("[markers]\na='#fff'\n[camera]\nfx=100\ndistortion={list}"));
    for count in 0..=15 {
        let list = format!("[{}]", vec!["0.1"; count].join(","));
        assert_eq!(with(&list).is_ok(), [0, 4, 5, 8, 12].contains(&count), "{count} coefficients");
    }
    assert!(with("[1,2,3,4,5,6,7,8,9,10,11,12,0,0.0]").is_ok(), "a sensor that is not tilted");
}

#[test]
fn a_clock_may_be_looked_for_and_windows_files_are_read() {
    let layout = parse("\u{feff}[markers]\r\na = '#fff'\r\n[clock]\r\nroi = 'auto'\r\nformat = 'h:mm:ss'\r\n").unwrap();
    assert_eq!(layout.clock.unwrap().roi, ClockRoi::Auto);
}

#[test]
fn a_file_that_is_missing_or_no_text_is_named() {
    let folder = Folder::new();
    let missing = Layout::read(&folder.path("m.toml")).unwrap_err().to_string();
    assert!(missing.contains("m.toml: ") && missing.contains("--suggest"), "{missing}");
    let path = folder.file("m.toml", b"[markers]\na = '\xff'");
    assert!(Layout::read(&path).unwrap_err().to_string().contains("m.toml:2: not UTF-8"));
}

#[test]
fn a_clocks_screen_changes_so_often_or_at_once() {
    let of = |hertz: &str| parse(&format!("[markers]\na = '#fff'\n[clock]\nroi = 'auto'\nformat = 'ss'\n{hertz}\n"));
    assert_eq!(of("").unwrap().clock.unwrap().refresh_hz, None);
    assert_eq!(of("refresh_hz = 60").unwrap().clock.unwrap().refresh_hz, Some(60.0));
    assert_eq!(of("refresh_hz = inf").unwrap().clock.unwrap().refresh_hz, Some(f64::INFINITY));
    for bad in ["0", "-60.0", "nan", "'60'"] {
        let fault = of(&format!("refresh_hz = {bad}")).unwrap_err().to_string();
        assert!(fault.contains(":6: `refresh_hz` is how often"), "{bad}: {fault}");
    }
}

#[test]
fn a_display_is_so_late_or_between_two_numbers() {
    let of = |delay: &str| parse(&format!("[markers]\na = '#fff'\n[clock]\nroi = 'auto'\nformat = 'ss'\n{delay}\n"));
    let ms = |delay: &str| of(delay).unwrap().clock.unwrap().delay_s.map(|delay_s| (1e3 * delay_s).round());
    assert_eq!([ms(""), ms("delay_ms = 25"), ms("delay_ms = [20, 45.0]")], [[0.0; 2], [25.0; 2], [20.0, 45.0]]);
    for bad in ["-1", "nan", "inf", "1001", "'25'", "[20]", "[45, 20]", "[1, 2, 3]"] {
        let fault = of(&format!("delay_ms = {bad}")).unwrap_err().to_string();
        assert!(fault.contains(":6: `delay_ms` is how late"), "{bad}: {fault}");
    }
}

#[test]
fn a_shutter_rolls_for_so_long() {
    let of = |readout: &str| parse(&format!("{readout}\n[markers]\na = '#fff'\n"));
    assert_eq!((of("").unwrap().readout_s, of("readout_ms = 16").unwrap().readout_s), (0.0, 0.016));
    for bad in ["-1", "nan", "101", "'16'", "[16]"] {
        let fault = of(&format!("readout_ms = {bad}")).unwrap_err().to_string();
        assert!(fault.contains(":1: `readout_ms` is how long"), "{bad}: {fault}");
    }
}

#[test]
fn markers_are_discs_or_blots_where_the_file_says_so() {
    let markers = "[markers]\na = \"#2b4b10\"\n";
    assert_eq!(parse(markers).unwrap().shape, None);
    for shape in [MarkerShape::Disc, MarkerShape::Blot] {
        assert_eq!(parse(&format!("shape = \"{}\"\n{markers}", shape.name())).unwrap().shape, Some(shape));
    }
    let fault = parse(&format!("shape = \"round\"\n{markers}")).unwrap_err().to_string();
    assert!(fault.contains(":1: `shape` has to be"), "{fault}");
}
