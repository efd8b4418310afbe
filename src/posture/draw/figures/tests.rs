use super::*;
use crate::figure::drawn::Drawn;

/// J1, J2, J3 in the file's order J3, J1, J2.
fn layout() -> Layout {
    let text = "[markers]\na='#000'\nb='#111'\nc='#222'\nd='#333'\ne='#444'\n\
        [segments]\nm=['a','b']\np=['b','c']\ni=['c','d']\n\
                t=['d','e']\n[joints]\nJ3=['i','t']\nJ1=['m','p']\nJ2=['p','i']";
    Layout::parse(text, Path::new("m.toml")).unwrap()
}

fn angle(deg: f64) -> Option<Angle> {
    Some(Angle { rad: deg.to_radians(), sd_rad: (0.5 + 0.005 * deg.abs()).to_radians(), lasting_sd_rad: 0.0 })
}

/// Equation 27 in all joints, with gaps.
fn bending(rows: usize) -> AngleFigures {
    let mut figures = AngleFigures::new(&layout());
    for k in 0..rows {
        let t = k as f64 / 30.0;
        let j2 = 35.0 - 40.0 * (std::f64::consts::TAU * 0.1 * t).cos();
        let noise = ((k * 7919) % 101) as f64 / 50.0 - 1.0;
        let lost = (150..162).contains(&(k % 400));
        let j3 = if lost || k == 30 { None } else { angle(0.46 * j2 - 8.0 + noise) };
        figures.push(t, &[j3, angle(12.0 + noise), if lost { None } else { angle(j2 - noise) }]);
    }
    figures
}

/// Draws one of both pictures.
fn drawn(figures: &AngleFigures, name: &str, coupling: bool) -> Drawn {
    crate::figure::drawn::drawn(name, |png, svg| match coupling {
        true => assert!(figures.draw_coupling(png, svg).unwrap()),
        false => figures.draw_angles(png, svg).unwrap(),
    })
}

#[test]
fn the_coupled_joints_are_the_last_two_along_the_finger() {
    let layout = layout();
    assert_eq!(last_two(&layout), Some([2, 0]), "J2 and J3");
    let two = |joints: [&str; 2]| last_two(&layout.wanting(&joints.map(Into::into)).unwrap());
    assert_eq!(two(["J1", "J2"]), Some([0, 1]));
    assert_eq!(two(["J1", "J3"]), None, "they do not touch");
}

#[test]
fn gaps_are_gaps() {
    let figures = bending(600);
    let spans = figures.rows.lacking();
    assert_eq!(spans.len(), 3, "one row and two runs");
    assert!((spans[0][0] - 29.5 / 30.0).abs() < 1e-9 && (spans[1][1] - 161.5 / 30.0).abs() < 1e-9);
    assert_eq!(figures.rows.curve(0).len(), 4);
    assert_eq!(figures.rows.curve(1).len(), 1);
    let picture = drawn(&figures, "angles", false);
    assert_eq!(picture.picture.dimensions(), (1400, 840));
    let grey = picture.picture.pixels().filter(|p| p.0 == [226, 226, 226]).count();
    assert!(grey > 5000, "{grey} shaded pixels");
    assert!(picture.svg.contains("an angle is missing") && picture.svg.contains("time, s"));
}

#[test]
fn the_line_stands_beside_the_dots() {
    let figures = bending(600);
    let line = figures.coupling_line().unwrap();
    assert_eq!(figures.coupled_joints(), Some(["J2", "J3"]));
    assert!((line.slope - 0.46).abs() < 0.02 && line.correlation > 0.99 && line.count == 575, "{line:?}");
    let picture = drawn(&figures, "coupling", true);
    assert!(picture.svg.contains("J3 = 0.4") && picture.svg.contains("J2, degrees of flexion"), "{}", picture.svg);
}

#[test]
fn long_videos_make_small_files() {
    let figures = bending(100_000);
    assert!(figures.coupling.as_ref().unwrap().dots.len() <= MOST_DOTS);
    // Measured 0.25 MB and 0.29 MB.
    for (name, coupling) in [("long", false), ("long-coupling", true)] {
        let size = drawn(&figures, name, coupling).svg.len();
        assert!(size < 500_000, "{name}: {size} bytes");
    }
    assert_eq!(figures.coupling_line().unwrap().count, 96_999);
}

#[test]
fn single_constant_and_missing_angles_are_drawn() {
    let mut single = AngleFigures::new(&layout());
    single.push(0.0, &[angle(1.0), angle(2.0), angle(3.0)]);
    let mut constant = AngleFigures::new(&layout());
    let mut missing = AngleFigures::new(&layout());
    for k in 0..100 {
        constant.push(f64::from(k), &[angle(10.0), angle(20.0), angle(30.0)]);
        missing.push(f64::from(k), &[None, None, None]);
    }
    let empty = AngleFigures::new(&layout());
    for (name, figures) in [("single", &single), ("constant", &constant), ("missing", &missing), ("empty", &empty)] {
        drawn(figures, name, false);
        drawn(figures, &format!("{name}-coupling"), true);
        assert_eq!(figures.coupling_line(), None);
    }
    let one = AngleFigures::new(&layout().wanting(&["J2".into()]).unwrap());
    assert!(!one.draw_coupling(Path::new("no.png"), Path::new("no.svg")).unwrap());
}
