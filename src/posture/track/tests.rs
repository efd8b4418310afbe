use std::path::Path;

use super::scenes::{Film, Tally, discs};
use super::*;
use crate::posture::layout::Marker;
use crate::posture::stage::{BLACK, BLUE, Disc, GREEN, PAINT, PINK, RED, SKIN, Stage, WALL};
use crate::posture::survey::{Progress, SurveyError, Surveyor};
use crate::video::{Format, Picture};

const RADIUS: f64 = 7.0;

fn hex([red, green, blue]: [u8; 3]) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// Three segments in a row, two markers each, with two joints; or only the joints given.
fn pairs(colours: [[u8; 3]; 6], joints: &str, more: &str) -> Layout {
    let mut text = String::from("flexion = 'clockwise'\n[markers]\n");
    for (k, colour) in colours.iter().enumerate() {
        text += &format!("m{k} = '{}'\n", hex(*colour));
    }
    text += "[segments]\nproximal = ['m0', 'm1']\nmiddle = ['m2', 'm3']\ndistal = ['m4', 'm5']\n";
    text += &format!("[joints]\n{joints}\n{more}");
    Layout::parse(&text, Path::new("m.toml")).unwrap()
}

const BOTH: &str = "J2 = ['proximal', 'middle']\nJ3 = ['middle', 'distal']";

/// A chain of marks from `base` on, each link turned by an angle (degrees, clockwise) from the one before.
fn chain(base: [f64; 2], links: &[(f64, f64)]) -> Vec<[f64; 2]> {
    let (mut at, mut direction) = (base, 0.0f64);
    let mut places = vec![base];
    for &(length, turn) in links {
        direction += turn.to_radians();
        at = [at[0] + length * direction.cos(), at[1] + length * direction.sin()];
        places.push(at);
    }
    places
}

/// The six marks of [`pairs`] with the joints bent by these angles.
fn finger(base: [f64; 2], j2: f64, j3: f64) -> Vec<[f64; 2]> {
    let links = [(60.0, 10.0), (26.0, 0.5 * j2), (48.0, 0.5 * j2), (26.0, 0.5 * j3), (38.0, 0.5 * j3)];
    chain(base, &links)
}

/// A bend between 10 and 70 degrees.
fn bend(frame: usize) -> f64 {
    40.0 - 30.0 * (frame as f64 / 12.0).cos()
}

fn moving(frame: usize) -> Vec<[f64; 2]> {
    finger([60.0, 70.0 + 10.0 * (frame as f64 / 9.0).sin()], bend(frame), 0.7 * bend(frame))
}

fn none(_: usize) -> Vec<Disc> {
    Vec::new()
}

fn stage() -> Stage {
    Stage::new(400, 260, SKIN)
}

/// All markers seen in all frames, under their own names.
fn assert_all(film: &Film<'_>, markers: usize) {
    let tally = film.run().unwrap();
    let expected = Tally {
        right: markers * film.pictures.len(),
        surveyed: tally.surveyed,
        effort: tally.effort,
        ..Tally::default()
    };
    assert_eq!(tally, expected, "{:?} {:?}", film.info.format, film.layout.markers);
}

/// The needed markers are seen wherever they are in view but for `missed` times; never elsewhere.
fn assert_right(film: &Film<'_>, missed: usize) -> Tally {
    let tally = film.run().unwrap();
    assert_eq!((tally.wrong, tally.unseen), (0, 0), "{tally:?}");
    assert!(tally.missed <= missed, "{tally:?}");
    assert!(tally.right > 0, "{tally:?}");
    tally
}

const CYAN: [u8; 3] = [0x00, 0xac, 0xc1];
const IN_PAIRS: [[u8; 3]; 6] = [PINK, PINK, BLUE, BLUE, GREEN, GREEN];

#[test]
fn names_are_kept_whatever_the_colours_the_ground_and_the_format() {
    let wall = Stage::new(400, 260, WALL);
    let mut of_their_colour = Stage::new(400, 260, [0x60, 0x96, 0xc8]);
    of_their_colour.disc([150.0, 110.0], 95.0, SKIN);
    let of_format = |subsampling: (usize, usize), depth: u32| {
        let mut stage = Stage::new(399, 261, SKIN);
        (stage.format.subsampling, stage.format.depth) = (Some(subsampling), depth);
        stage
    };
    for (colours, stage, frames) in [
        ([PINK, BLUE, GREEN, [0x7b, 0x1f, 0xa2], CYAN, [0xf5, 0x7c, 0x00]], &wall, 50),
        (IN_PAIRS, &wall, 50),
        ([RED; 6], &wall, 50),
        ([BLUE; 6], &wall, 50),
        ([PINK, PINK, BLUE, BLUE, BLUE, GREEN], &of_their_colour, 40),
        (IN_PAIRS, &of_format((1, 1), 8), 12),
        (IN_PAIRS, &of_format((2, 2), 10), 12),
        (IN_PAIRS, &of_format((2, 1), 8), 12),
        (IN_PAIRS, &stage(), 1),
    ] {
        assert_all(&discs(&pairs(colours, BOTH, ""), stage, RADIUS, frames, moving, none), 6);
    }
}

#[test]
fn a_mark_on_each_joint() {
    let text = format!(
        "[markers]\na = '{red}'\nb = '{red}'\nc = '{red}'\nd = '{red}'\n[segments]\np = ['a', 'b']\nm = ['b', 'c']\nd \
         = ['c', 'd']\n\
        [joints]\nJ2 = ['p', 'm']\nJ3 = ['m', 'd']\n",
        red = hex(RED)
    );
    let layout = Layout::parse(&text, Path::new("m.toml")).unwrap();
    let places = |frame: usize| chain([80.0, 70.0], &[(80.0, 5.0), (60.0, bend(frame)), (45.0, 0.7 * bend(frame))]);
    assert_all(&discs(&layout, &stage(), RADIUS, 50, places, none), 4);
}

/// Index finger (from `wrist` on, J1 to J3) and thumb (T1, T2) from one mark, in these colours.
fn hand(index: [u8; 3], thumb: [u8; 3], more: &str) -> Layout {
    let names = [("wrist", index), ("mcp", index), ("pip", index), ("dip", index), ("tip", index)];
    let thumbs = [("cmc", thumb), ("ip", thumb), ("end", thumb)];
    let colours: String =
        names.iter().chain(&thumbs).map(|(name, colour)| format!("{name} = '{}'\n", hex(*colour))).collect();
    let text = format!(
        "flexion = 'clockwise'\n[markers]\n{colours}[segments]\nhand = ['wrist', 'mcp']\nproximal = ['mcp', 'pip']\n\
        middle = ['pip', 'dip']\ndistal = ['dip', 'tip']\nbase = ['wrist', 'cmc']\nthumb = ['cmc', 'ip']\nnail = \
        ['ip', 'end']\n\
        [joints]\nJ1 = ['hand', 'proximal']\nJ2 = ['proximal', 'middle']\nJ3 = ['middle', 'distal']\n\
        T1 = ['base', 'thumb']\nT2 = ['thumb', 'nail']\n{more}"
    );
    Layout::parse(&text, Path::new("m.toml")).unwrap()
}

/// The eight marks of [`hand`], pinching: the thumb bends the other way.
fn pinching(frame: usize) -> Vec<[f64; 2]> {
    let wrist = [60.0, 120.0 + 6.0 * (frame as f64 / 9.0).sin()];
    let bend = bend(frame);
    let mut places = chain(wrist, &[(110.0, -25.0), (64.0, 0.5 * bend), (42.0, bend), (30.0, 0.6 * bend)]);
    places.extend(&chain(wrist, &[(70.0, 45.0), (48.0, -0.4 * bend), (34.0, -0.5 * bend)])[1..]);
    places
}

fn starts(layout: &Layout, places: &[[f64; 2]], off: f64) -> String {
    let line = |(k, (marker, at)): (usize, (&Marker, &[f64; 2]))| {
        let (sin, cos) = (2.4 * k as f64).sin_cos();
        format!("{} = [{:.1}, {:.1}]\n", marker.name, at[0] + off * cos, at[1] + off * sin)
    };
    format!("[start]\n{}", layout.markers.iter().zip(places).enumerate().map(line).collect::<String>())
}

#[test]
fn thumb_and_index_of_one_colour_keep_the_names_of_their_starts() {
    for off in [0.0, 0.9 * RADIUS] {
        let more = starts(&hand(PAINT, PAINT, ""), &pinching(0), off);
        let layout = hand(PAINT, PAINT, &more);
        assert_all(&discs(&layout, &stage(), RADIUS, 60, pinching, none), 8);
    }
}

#[test]
fn starts_go_before_the_order_along_the_finger() {
    // No finger: neighbours far apart, links that cross, one bent backwards.
    let places = |frame: usize| {
        let sway = 8.0 * (frame as f64 / 9.0).sin();
        [[60.0, 60.0], [330.0, 200.0], [60.0, 200.0], [330.0, 60.0], [120.0, 130.0], [200.0, 130.0]]
            .map(|[x, y]| [x + sway, y - sway])
            .to_vec()
    };
    let more = starts(&pairs([PAINT; 6], BOTH, ""), &places(0), 3.0);
    let layout = pairs([PAINT; 6], BOTH, &more);
    let tally = discs(&layout, &stage(), RADIUS, 30, places, none).run().unwrap();
    assert_eq!((tally.right, tally.surveyed), (6 * 30, 3), "{tally:?}");
}

#[test]
fn some_starts_help_as_far_as_they_go() {
    let starts = starts(&hand(PAINT, PAINT, ""), &pinching(0), 2.0);
    let of = |names: &[&str]| {
        let lines = starts.lines().filter(|line| names.iter().any(|name| line.starts_with(&format!("{name} "))));
        hand(PAINT, PAINT, &format!("[start]\n{}", lines.map(|line| format!("{line}\n")).collect::<String>()))
    };
    let layout = of(&["wrist", "tip", "end"]);
    assert_all(&discs(&layout, &stage(), RADIUS, 60, pinching, none), 8);
}

#[test]
fn fingers_of_one_colour_need_a_start_and_are_named_where_colours_differ() {
    let layout = hand(PAINT, PAINT, "");
    let error = discs(&layout, &stage(), RADIUS, 6, pinching, none).run().unwrap_err();
    let message = error.to_string();
    assert!(matches!(error, SurveyError::Branches { .. }), "{message}");
    assert!(message.contains("end") && message.contains("[start]") && !message.contains("wrist"), "{message}");
    let layout = hand(GREEN, BLUE, "");
    assert_all(&discs(&layout, &stage(), RADIUS, 60, pinching, none), 8);
}

#[test]
fn paler_or_darker_marks_than_the_file_says_are_found_at_their_starts() {
    // Drawn dark green; the marker file says a bright one.
    let drawn = pairs([PAINT; 6], BOTH, "");
    let more = starts(&drawn, &moving(0), 3.0);
    let named = pairs([[0x30, 0xd0, 0x20]; 6], BOTH, &more);
    let film = discs(&drawn, &stage(), RADIUS, 30, moving, none);
    assert_all(&Film { layout: &named, ..film }, 6);
}

#[test]
fn a_start_beside_every_mark_names_what_is_there() {
    let more = "[start]\nm0 = [350.0, 20.0]\n";
    let layout = pairs([BLUE; 6], BOTH, more);
    let message = discs(&layout, &stage(), RADIUS, 3, moving, none).run().unwrap_err().to_string();
    assert!(message.contains("m0 at (350, 20)") && message.contains(&hex(BLUE)), "{message}");
    // What is there is the stage's skin, but for noise and rounding.
    let skin = message.split("first frame has ").nth(1).and_then(|rest| rest.get(1..7)).expect("a colour");
    let parts = [0, 2, 4].map(|k| i32::from_str_radix(&skin[k..k + 2], 16).expect("two digits"));
    assert!(parts.iter().zip(SKIN).all(|(part, skin)| (part - i32::from(skin)).abs() < 12), "{message}");
    // A mark of another colour is named as such.
    let [x, y] = moving(0)[0];
    let layout = pairs([PINK, BLUE, BLUE, BLUE, BLUE, BLUE], BOTH, &format!("[start]\nm1 = [{x:.1}, {y:.1}]\n"));
    let message = discs(&layout, &stage(), RADIUS, 3, moving, none).run().unwrap_err().to_string();
    assert!(message.contains("has a mark of #"), "{message}");
}

#[test]
fn a_straight_finger_is_named_back_to_the_first_frame_once_it_bends() {
    let layout = pairs([RED; 6], BOTH, "");
    let places = |frame: usize| {
        finger([60.0, 90.0], 3.0 * frame.saturating_sub(15) as f64 - 4.0, 2.0 * frame.saturating_sub(15) as f64)
    };
    let film = discs(&layout, &stage(), RADIUS, 35, places, none);
    assert_all(&film, 6);
    assert!(film.run().unwrap().surveyed > 20);
}

#[test]
fn what_no_joint_needs_is_not_followed_but_helps_to_tell_names() {
    let layout = pairs([RED; 6], "J2 = ['proximal', 'middle']", "");
    assert_all(&discs(&layout, &stage(), RADIUS, 50, moving, none), 4);
    // Distinct colours: the others are not even looked for.
    let layout = pairs([PINK, PINK, BLUE, BLUE, GREEN, CYAN], "J2 = ['proximal', 'middle']", "");
    assert_all(&discs(&layout, &stage(), RADIUS, 50, moving, none), 4);
}

#[test]
fn distractors_are_not_taken() {
    let mut stage = stage();
    // Bigger, smaller, of the same size, and one that passes by.
    stage.disc([340.0, 40.0], 16.0, PINK).disc([30.0, 220.0], 3.0, BLUE).disc([350.0, 230.0], RADIUS, GREEN);
    let passing = |frame: usize| vec![Disc { at: [390.0 - 7.0 * frame as f64, 235.0], radius: RADIUS, colour: BLUE }];
    for colours in [IN_PAIRS, [BLUE; 6]] {
        let layout = pairs(colours, BOTH, "");
        let film = discs(&layout, &stage, RADIUS, 50, moving, passing);
        assert_right(&film, 0);
    }
}

#[test]
fn a_hidden_marker_is_lost_and_taken_back_and_nothing_else_for_it() {
    // A distractor of its colour and size lies not far from where it is hidden.
    let mut stage = stage();
    stage.disc([105.0, 150.0], RADIUS, BLUE);
    let layout = pairs(IN_PAIRS, BOTH, "");
    let hand = |frame: usize| {
        let at = moving(frame)[3];
        let hidden = (15..30).contains(&frame);
        if hidden { vec![Disc { at, radius: 14.0, colour: WALL }] } else { Vec::new() }
    };
    let tally = assert_right(&discs(&layout, &stage, RADIUS, 50, moving, hand), 1);
    assert!(tally.right >= 6 * 50 - 16, "{tally:?}");
    // All of one colour: neighbours are no substitutes.
    let layout = pairs([RED; 6], BOTH, "");
    assert_right(&discs(&layout, &stage, RADIUS, 50, moving, hand), 2);
}

#[test]
fn markers_leave_the_picture_and_come_back() {
    let layout = pairs(IN_PAIRS, BOTH, "");
    let places = |frame: usize| {
        let x = 120.0 + 170.0 * (frame as f64 / 11.0).sin().max(0.0);
        finger([x, 60.0], 20.0, 15.0)
    };
    let film = discs(&layout, &stage(), RADIUS, 60, places, none);
    let tally = assert_right(&film, 6);
    let in_view = film.truth.iter().flatten().filter(|real| real.in_view >= 0.999).count();
    assert!(in_view < 6 * 60 - 20, "some are outside for a while");
    assert_eq!(tally.right + tally.missed, in_view);
}

#[test]
fn all_lost_at_a_cut_and_found_elsewhere() {
    for colours in [IN_PAIRS, [RED; 6]] {
        let layout = pairs(colours, BOTH, "");
        let places = |frame: usize| finger(if frame < 20 { [40.0, 60.0] } else { [140.0, 85.0] }, 50.0, 30.0);
        assert_right(&discs(&layout, &stage(), RADIUS, 40, places, none), 6 * 3);
    }
}

#[test]
fn markers_of_one_colour_that_cross_never_swap() {
    let layout = pairs([RED; 6], BOTH, "");
    // The fingertip passes over the proximal segment and back.
    let places = |frame: usize| {
        let turn = 90.0 - 60.0 * (frame as f64 / 20.0).cos();
        finger([90.0, 60.0], turn, 0.9 * turn)
    };
    let film = discs(&layout, &stage(), RADIUS, 80, places, none);
    let tally = film.run().unwrap();
    assert_eq!(tally.wrong, 0, "{tally:?}");
    assert!(tally.right > 6 * 50, "{tally:?}");
}

#[test]
fn coinciding_markers_are_lost_not_guessed() {
    let layout = pairs([PINK, BLUE, RED, RED, GREEN, GREEN], "J2 = ['proximal', 'middle']", "");
    let places = |frame: usize| {
        let mut places = moving(0);
        let apart = (30.0 - 2.0 * frame as f64).abs().min(30.0);
        places[3] = [places[2][0] + apart, places[2][1] + 2.0];
        places
    };
    let film = discs(&layout, &stage(), RADIUS, 40, places, none);
    let tally = film.run().unwrap();
    assert_eq!(tally.wrong, 0, "{tally:?}");
}

#[test]
fn grey_video_with_dark_markers() {
    let mut stage = Stage::new(400, 260, SKIN);
    stage.format.subsampling = None;
    let layout = pairs([BLACK; 6], BOTH, "");
    assert_all(&discs(&layout, &stage, RADIUS, 50, moving, none), 6);
    // Grey, but stored with chroma planes that say nothing; colours are then dark or bright.
    let layout = pairs([[0x10, 0x18, 0x90]; 6], BOTH, "");
    let mut film = discs(&layout, &stage, RADIUS, 50, moving, none);
    film.info.grey = true;
    for picture in &mut film.pictures {
        let luma = std::mem::take(&mut picture.planes[0]);
        *picture = Picture::new(Format { subsampling: Some((2, 2)), ..picture.format });
        picture.planes[0] = luma;
        picture.planes[1..].iter_mut().for_each(|plane| plane.fill(128));
    }
    film.info.format = film.pictures[0].format;
    assert_all(&film, 6);
}

#[test]
fn light_that_changes_is_followed() {
    let layout = pairs(IN_PAIRS, BOTH, "");
    let mut film = discs(&layout, &stage(), RADIUS, 40, moving, none);
    for (frame, picture) in film.pictures.iter_mut().enumerate() {
        let mut dim = stage();
        dim.light = 1.0 - 0.7 * (frame as f64 / 40.0);
        for (&at, marker) in moving(frame).iter().zip(&layout.markers) {
            dim.disc(at, RADIUS, marker.colour);
        }
        *picture = dim.picture(frame as u64);
    }
    assert_all(&film, 6);
}

#[test]
fn a_single_marker_needs_no_segments() {
    let text = format!("[markers]\nball = '{}'\n", hex(GREEN));
    let layout = Layout::parse(&text, Path::new("m.toml")).unwrap();
    // Thrown: it comes in after a while, fast, and leaves again.
    let places = |frame: usize| {
        let t = frame as f64 - 8.0;
        vec![[40.0 + 9.0 * t, 300.0 - 26.0 * t + 0.9 * t * t]]
    };
    assert_right(&discs(&layout, &Stage::new(400, 260, WALL), 10.0, 40, places, none), 2);
}

#[test]
fn frames_that_could_not_be_decoded_are_bridged() {
    let layout = pairs(IN_PAIRS, BOTH, "");
    let film = discs(&layout, &stage(), RADIUS, 40, moving, none);
    let mut surveyor = Surveyor::new(&layout, &film.info);
    film.pictures.iter().enumerate().for_each(|(k, picture)| _ = surveyor.look(&picture.frame(k as u64, 0.0)));
    let survey = surveyor.finish().unwrap();
    let mut tracker = Tracker::new(&layout, &survey, &film.info, Method::default());
    for (k, picture) in film.pictures.iter().enumerate() {
        if (10..16).contains(&k) {
            assert!(tracker.skip().iter().all(|sight| *sight == Sight::Lost(Loss::Undecoded)));
            continue;
        }
        let sights = tracker.step(&picture.frame(k as u64, 0.0));
        for (sight, real) in sights.iter().zip(&film.truth[k]) {
            let Sight::Seen(centre) = sight else { panic!("lost in frame {k}") };
            assert!(distance(centre.at_px, real.at_px) < 2.0);
        }
    }
    assert_eq!((tracker.effort().undecoded, tracker.effort().frames), (6, 34));
}

#[test]
fn what_can_t_be_told_is_an_error_that_names_the_markers() {
    // Straight all the time, and all of one colour: from either end alike.
    let layout = pairs([RED; 6], BOTH, "");
    let straight = |_| chain([60.0, 90.0], &[(45.0, 0.0), (30.0, 0.0), (45.0, 0.0), (30.0, 0.0), (45.0, 0.0)]);
    let error = discs(&layout, &stage(), RADIUS, 10, straight, none).run().unwrap_err();
    assert!(matches!(&error, SurveyError::Ambiguous { markers, .. } if markers.len() == 6), "{error}");
    assert!(error.to_string().contains("[start]"));
    // [start] decides, from either end.
    for order in [[0usize, 1, 2, 3, 4, 5], [5, 4, 3, 2, 1, 0]] {
        let mut more = String::from("[start]\n");
        let places = straight(0);
        for (k, &place) in order.iter().enumerate() {
            more += &format!("m{k} = [{:.1}, {:.1}]\n", places[place][0] + 3.0, places[place][1] - 4.0);
        }
        let layout = pairs([RED; 6], BOTH, &more);
        let turned = |frame| {
            let places = straight(frame);
            order.map(|place| places[place]).to_vec()
        };
        assert_all(&discs(&layout, &stage(), RADIUS, 10, turned, none), 6);
    }
    // Two are enough.
    let more = format!("[start]\nm0 = [{}, {}]\nm5 = [{}, {}]\n", 60.0, 90.0, 255.0, 90.0);
    let layout = pairs([RED; 6], BOTH, &more);
    assert_all(&discs(&layout, &stage(), RADIUS, 10, straight, none), 6);
}

#[test]
fn a_start_where_nothing_is_and_colours_never_seen_are_told() {
    let layout = pairs([RED; 6], BOTH, "[start]\nm0 = [300.0, 200.0]\n");
    let error = discs(&layout, &stage(), RADIUS, 5, moving, none).run().unwrap_err();
    assert!(matches!(&error, SurveyError::WrongStart { marker, nearest_px: Some(_), .. } if marker == "m0"), "{error}");
    // Brown, which differs from skin in luma alone.
    let [x, y] = moving(0)[0];
    let layout = pairs([[0x77, 0x3f, 0x22]; 6], BOTH, &format!("[start]\nm0 = [{x}, {y}]\n"));
    let error = discs(&layout, &stage(), RADIUS, 5, moving, none).run().unwrap_err().to_string();
    assert!(error.contains("m0 at (60, 70)") && error.ends_with("use paint of another hue"), "{error}");
    let layout = pairs(IN_PAIRS, BOTH, "");
    let empty = Film {
        pictures: (0..5).map(|k| stage().picture(k)).collect(),
        ..discs(&layout, &stage(), RADIUS, 5, moving, none)
    };
    let error = empty.run().unwrap_err();
    assert!(matches!(&error, SurveyError::NoneSeen { markers, .. } if markers.len() == 6), "{error}");
}

#[test]
fn a_marker_never_seen_spares_the_others() {
    let layout = pairs([PINK, PINK, BLUE, BLUE, GREEN, CYAN], BOTH, "");
    let places = |frame: usize| {
        let mut places = moving(frame);
        places[5] = [-100.0, -100.0];
        places
    };
    let film = discs(&layout, &stage(), RADIUS, 20, places, none);
    let tally = film.run().unwrap();
    assert_eq!((tally.right, tally.wrong, tally.missed, tally.unseen), (5 * 20, 0, 0, 0));
}

/// `SEEDS=1,2,3 cargo test --release --lib table_of_phantom_scenes -- --ignored --nocapture`
#[test]
#[ignore = "minutes: every preset of the phantom; SEEDS, PRESETS and SECONDS_EACH choose"]
fn table_of_phantom_scenes() {
    use super::scenes::{film, layout_of};
    use crate::phantom::finger::MarkerLayout;
    use crate::phantom::video::{Colours, Preset, Scene, VideoOptions};
    use rayon::prelude::*;

    let setting = |name: &str, usual: &str| std::env::var(name).unwrap_or_else(|_| usual.into());
    let seconds: f64 = setting("SECONDS_EACH", "5").parse().unwrap();
    let presets = [Preset::Clean, Preset::Hard, Preset::Small, Preset::Fast, Preset::Uhd];
    let wanted = setting("PRESETS", "clean,hard,small,fast");
    let mut wrong = 0;
    for preset in presets.into_iter().filter(|preset| wanted.contains(&format!("{preset:?}").to_lowercase())) {
        for layout in [MarkerLayout::Pairs, MarkerLayout::Joints] {
            for colours in [Colours::Pairs, Colours::Distinct, Colours::Red] {
                for seed in setting("SEEDS", "1").split(',') {
                    let mut options = VideoOptions::new(preset);
                    (options.seed, options.seconds, options.colours) = (seed.parse().unwrap(), seconds, colours);
                    options.finger.layout = layout;
                    for hide in &mut options.hide {
                        hide.frame = 60;
                        if layout == MarkerLayout::Joints {
                            hide.marker = "pip".into();
                        }
                    }
                    let scene = Scene::new(options).unwrap();
                    let frames: Vec<usize> = (0..scene.frames()).collect();
                    let pictures = frames.par_iter().map(|&frame| scene.picture(frame)).collect();
                    let layout_read = layout_of(&scene);
                    match film(&scene, &layout_read, pictures).run() {
                        Ok(tally) => {
                            eprintln!("{preset:?} {layout:?} {colours:?} {seed}: {tally:?}");
                            wrong += tally.wrong + tally.unseen;
                        }
                        Err(error) => eprintln!("{preset:?} {layout:?} {colours:?} {seed}: {error}"),
                    }
                }
            }
        }
    }
    assert_eq!(wrong, 0);
}

#[test]
fn what_is_much_smaller_or_larger_than_marks_is_no_mark_passed_over() {
    let layout = pairs(IN_PAIRS, BOTH, "");
    let is_passed_over = |radius: f64| {
        // Between the first two marks, as a fold of the skin may be.
        let between = |frame: usize| {
            let [a, b] = [moving(frame)[0], moving(frame)[1]];
            vec![Disc { at: [0, 1].map(|axis| 0.5 * (a[axis] + b[axis])), radius, colour: GREEN }]
        };
        let film = discs(&layout, &stage(), RADIUS, 12, moving, between);
        let mut surveyor = Surveyor::new(&layout, &film.info);
        for (k, picture) in film.pictures.iter().enumerate() {
            if surveyor.look(&picture.frame(k as u64, k as f64 / 30.0)) == Progress::Enough {
                break;
            }
        }
        let doubts = surveyor.finish().expect("six marks").doubts;
        doubts.iter().any(|doubt| doubt.contains("lies a mark of the colour of m"))
    };
    // 3 and 16 were until sizes were compared.
    assert_eq!([3.0, RADIUS, 16.0].map(is_passed_over), [false, true, false]);
}
