//! Pictures of a trajectory: its path and its shear (Fig. 90 to 93), its components over time, or J2 over time.

use lunula_predictor::Spiral;

use super::TrajectoryOptions;
use super::motion::{ForceMotion, Path};
use crate::figure::{Chart, Item};

/// Of pictures over time.
pub(super) const WIDTH: u32 = 1400;
const HEIGHT: u32 = 380;
/// Of pictures of forces over forces.
pub(super) const SPACE_WIDTH: u32 = 760;
/// Of the path's picture: a newton is as long across as upwards.
const PATH_HEIGHT: u32 = 804;
/// Points of a path that are nearer than this share of the picture are one.
const NEAR: f64 = 0.003;
const POINTS: u32 = 12_000;
/// How the colours of a chart are called.
const COLOURS: [&str; 3] = ["blue", "orange", "green"];

pub(super) fn moments(options: &TrajectoryOptions) -> impl Iterator<Item = f64> {
    let step_s = options.whole_s() / f64::from(POINTS);
    (0..=POINTS).map(move |k| f64::from(k) * step_s)
}

pub(super) fn line(name: Option<&str>, points: Vec<[f64; 2]>, colour: usize, width: u32) -> Item {
    Item::Line { name: name.map(str::to_owned), runs: vec![points], colour, width }
}

/// Whether two points fall together on a chart of this size.
pub(super) fn is_near(a: [f64; 2], b: [f64; 2], size: [f64; 2]) -> bool {
    (0..2).all(|k| (a[k] - b[k]).abs() < NEAR * size[k])
}

/// The shear's path as seen from above, in the colours of three thirds of the pressing, in the circle that friction
/// allows at most (Fig. 90, 93).
pub(super) fn path_chart(options: &TrajectoryOptions, motion: &ForceMotion) -> Chart {
    let third_n = options.fz_max_n / 3.0;
    let rim_n = options.fz_max_n * options.mu;
    let mut runs: [Vec<Vec<[f64; 2]>>; 3] = Default::default();
    let mut last: Option<(usize, [f64; 2])> = None;
    for time_s in moments(options) {
        let [fx_n, fy_n, fz_n] = motion.at(time_s);
        let third = ((-fz_n / third_n) as usize).min(2);
        let point = [fx_n, fy_n];
        if last.is_some_and(|(before, end)| before == third && is_near(end, point, [2.0 * rim_n; 2])) {
            continue;
        }
        if last.is_none_or(|(before, _)| before != third) {
            // A run begins where the one before ended.
            runs[third].push(last.map(|(_, end)| end).into_iter().collect());
        }
        if let Some(run) = runs[third].last_mut() {
            run.push(point);
        }
        last = Some((third, point));
    }
    let rim = (0..=360).map(|k| f64::from(k).to_radians()).map(|turn| [rim_n * turn.sin(), rim_n * turn.cos()]);
    let mut items = vec![line(None, rim.collect(), 3, 1)];
    items.extend(runs.into_iter().enumerate().map(|(colour, runs)| Item::Line { name: None, runs, colour, width: 2 }));
    let thirds = (0..3).map(|k| format!("{} to {:.3} N", COLOURS[k], third_n * (k + 1) as f64)).collect::<Vec<_>>();
    let title = format!("Shear; pressing {}", thirds.join(", ")).replace(".000", "");
    Chart::new(title, "Fx, N", "Fy, N", items, PATH_HEIGHT)
}

/// Components over time, and the shear over time and over the pressing with the limits of friction (Fig. 91, 92).
pub(super) fn force_charts(options: &TrajectoryOptions, motion: &ForceMotion) -> Vec<Chart> {
    let rows: Vec<(f64, [f64; 3])> = moments(options).map(|time_s| (time_s, motion.at(time_s))).collect();
    let component = |k: usize| rows.iter().map(|row| [row.0, row.1[k]]).collect();
    let most = |sign: f64| rows.iter().map(|row| [row.0, -sign * options.mu * row.1[2]]).collect();
    let radial: Vec<[f64; 2]> = rows.iter().map(|row| [row.0, motion.radial_n(row.0)]).collect();
    let mut over: Vec<[f64; 2]> = rows.iter().zip(&radial).map(|(row, radial)| [-row.1[2], radial[1]]).collect();
    over.dedup_by(|next, kept| is_near(*next, *kept, [options.fz_max_n, 2.0 * options.mu * options.fz_max_n]));
    let edge = |sign: f64| vec![[0.0, 0.0], [options.fz_max_n, sign * options.mu * options.fz_max_n]];
    let signed = motion.spiral.is_some();
    let limits = |points: &dyn Fn(f64) -> Vec<[f64; 2]>| {
        let mut limits = vec![line(Some("most that friction holds"), points(1.0), 1, 1)];
        if signed {
            limits.push(line(None, points(-1.0), 1, 1));
        }
        limits
    };
    let shear = if signed { "Fr, N" } else { "size of the shear, N" };
    let mut in_time = limits(&most);
    in_time.push(line(Some("shear"), radial, 0, 1));
    let mut in_space = limits(&edge);
    in_space.push(line(Some("shear"), over, 0, 1));
    let components = vec![
        line(Some("Fx"), component(0), 0, 1),
        line(Some("Fy"), component(1), 1, 1),
        line(Some("Fz, pressing is negative"), component(2), 2, 2),
    ];
    vec![
        Chart::new(title(options, motion.spiral.as_ref()), "time, s", "force, N", components, HEIGHT),
        Chart::new("Shear over time", "time, s", shear, in_time, HEIGHT),
        Chart::new("Shear over pressing", "pressing, N", shear, in_space, HEIGHT),
    ]
}

fn title(options: &TrajectoryOptions, spiral: Option<&Spiral>) -> String {
    match spiral {
        Some(spiral) => format!(
            "Spiral: {} N in {} s, fs {} cycles a newton, fc {} Hz, mu {}",
            spiral.fz_max_n, spiral.duration_s, spiral.fs_per_n, spiral.fc_hz, spiral.mu
        ),
        None => format!("Random forces: {} s, up to {} N, mu {}", options.seconds, options.fz_max_n, options.mu),
    }
}

/// The angle over time.
pub(super) fn posture_chart(options: &TrajectoryOptions, path: &Path) -> Chart {
    let points =
        moments(options).map(|time_s| [time_s, path.during(time_s, options.lead_s, options.seconds)]).collect();
    let title = match path {
        Path::Bending(bending) => format!("Bending (equation 27) at {} Hz", bending.hz),
        Path::Random(_) => "Random bending".to_owned(),
    };
    Chart::new(title, "time, s", "J2, degrees of flexion", vec![line(None, points, 0, 2)], 420)
}
