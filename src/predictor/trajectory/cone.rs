//! The cone of forces that friction allows, seen from aside, and a trajectory within (Fig. 89 and 90).
//!
//! In: the options and the forces over time. Out: a picture in oblique projection: Fx to the right, pressing upwards,
//! Fy into the depth.

use super::TrajectoryOptions;
use super::figures::{is_near, line, moments};
use super::motion::ForceMotion;
use crate::figure::{Chart, Item};

const HEIGHT: u32 = 700;
/// How much of Fy goes right and up.
const DEPTH: [f64; 2] = [0.45, 0.3];
/// Circles of the cone, evenly along the pressing.
const CIRCLES: u32 = 3;

/// Where a force is in the picture.
fn seen([fx_n, fy_n, fz_n]: [f64; 3]) -> [f64; 2] {
    [fx_n + DEPTH[0] * fy_n, -fz_n + DEPTH[1] * fy_n]
}

/// The circle of the shear that friction allows at most at a pressing.
fn circle(pressing_n: f64, mu: f64) -> Vec<[f64; 2]> {
    let turn = |k: u32| f64::from(k).to_radians();
    (0..=360)
        .map(turn)
        .map(|turn| [turn.cos(), turn.sin()].map(|x| mu * pressing_n * x))
        .map(|[fx_n, fy_n]| seen([fx_n, fy_n, -pressing_n]))
        .collect()
}

/// The lines from the tip that touch the outermost circle on both sides.
fn sides(rim: &[[f64; 2]]) -> Vec<Vec<[f64; 2]>> {
    let steep = |point: &&[f64; 2]| point[0].atan2(point[1]);
    let by = |a: &&[f64; 2], b: &&[f64; 2]| steep(a).total_cmp(&steep(b));
    let ends = [rim.iter().min_by(by), rim.iter().max_by(by)];
    ends.into_iter().flatten().map(|end| vec![[0.0, 0.0], *end]).collect()
}

pub(super) fn cone_chart(options: &TrajectoryOptions, motion: &ForceMotion) -> Chart {
    let size = [2.0 * options.mu * options.fz_max_n, options.fz_max_n];
    let mut path: Vec<[f64; 2]> = moments(options).map(|time_s| seen(motion.at(time_s))).collect();
    path.dedup_by(|next, kept| is_near(*next, *kept, size));
    let share = |k: u32| options.fz_max_n * f64::from(k) / f64::from(CIRCLES);
    let circles: Vec<Vec<[f64; 2]>> = (1..=CIRCLES).map(|k| circle(share(k), options.mu)).collect();
    let sides = circles.last().map(|rim| sides(rim)).unwrap_or_default();
    let name = Some(format!("most that friction holds, mu {}", options.mu));
    let items = vec![
        line(Some("trajectory"), path, 0, 1),
        Item::Line { name, runs: circles.into_iter().chain(sides).collect(), colour: 1, width: 2 },
    ];
    let x = "Fx, N (Fy goes into the depth)";
    Chart::new("The cone of friction, and the trajectory within", x, "pressing, N", items, HEIGHT)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_circle_is_as_wide_as_the_shear_allowed_and_the_sides_touch_it() {
        let rim = circle(3.0, 0.5);
        assert_eq!(rim.len(), 361);
        assert!((rim[0][0] - 1.5).abs() < 1e-12 && (rim[0][1] - 3.0).abs() < 1e-12, "{:?}", rim[0]);
        let sides = sides(&rim);
        assert_eq!(sides.len(), 2);
        // No point of the circle lies outside of the sides.
        let turn = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
        assert!(rim.iter().all(|point| turn(sides[0][1], *point) <= 1e-12 && turn(sides[1][1], *point) >= -1e-12));
    }
}
