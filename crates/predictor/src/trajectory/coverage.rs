//! How evenly forces cover the cone that can be (5.2.3): planned or recorded.
//!
//! Rows are counted in K cells of equal measure, in cylindrical and in Cartesian density ([`ForceSpace::place`]); with
//! p_k the share of the rows in cell k:
//!
//! - visited: the share of the cells with a row;
//! - entropy: -sum p_k ln p_k / ln K, 1 where all cells hold as many (Shannon 1948; Pielou's evenness,
//!   doi:10.1016/0022-5193(66)90013-0). Of n rows drawn at random from the even density it is about 1 - (K - 1) / (2 n
//!   ln K) (Miller 1955); of fewer rows than cells at most ln n / ln K;
//! - the same entropy of each coordinate alone (pressing, shear, direction), which shows in what the rows are uneven.
//!
//! The largest hole is the greatest distance, in newtons, from a force of the cone to its nearest row: the covering
//! radius, or dispersion (Niederreiter 1992, chapter 6). No force that can be is farther from what was shown. It is
//! sought on a lattice over the cone and refined from the best places, so it is a lower bound; where the answer is
//! known it is right to a thousandth.

use serde::Serialize;

use super::{Density, ForceSpace};

/// Cells along pressing, shear and direction.
pub const CONE_CELLS: [usize; 3] = [6, 4, 8];
/// The lattice on which a hole is looked for: along pressing, shear and direction.
const LATTICE: [usize; 3] = [24, 10, 32];
/// How many of its best places are refined.
const REFINED: usize = 24;

/// How evenly forces cover the cone.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ConeCoverage {
    /// Rows in the cone that press, which all that follows is about.
    pub rows: usize,
    /// Rows that press no more than [`rest_n`](cone_coverage): the finger is in the air.
    pub at_rest: usize,
    /// Rows outside of the cone: pressed harder, or sheared more than friction is said to hold.
    pub outside: usize,
    /// Rows that are not finite.
    pub not_finite: usize,
    /// In cylindrical density.
    pub cylindrical: Evenness,
    /// In Cartesian density.
    pub cartesian: Evenness,
    /// The largest hole; `None` without rows.
    pub hole: Option<Hole>,
}

/// Counts in cells of equal measure.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Evenness {
    /// How many cells there are.
    pub cells: usize,
    /// The share of them with a row.
    pub visited: f64,
    /// The entropy of the counts, 1: even; `None` without rows.
    pub entropy: Option<f64>,
    /// The entropy of pressing, shear and direction alone.
    pub of_each: Option<[f64; 3]>,
}

/// A ball about a force of the cone without a row in it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Hole {
    /// Its radius, newtons.
    pub radius_n: f64,
    /// Its middle, `[Fx, Fy, Fz]`, newtons.
    pub middle_n: [f64; 3],
}

/// How evenly rows of `[Fx, Fy, Fz]`, newtons, cover `space`. Rows with a pressing and a shear of at most `rest_n` are
/// the finger in the air (of a recorded set: bending, with the transducer's noise) and are only counted.
pub fn cone_coverage(forces: impl IntoIterator<Item = [f64; 3]>, space: &ForceSpace, rest_n: f64) -> ConeCoverage {
    let (mut at_rest, mut outside, mut not_finite) = (0, 0, 0);
    let mut kept: Vec<[f64; 3]> = Vec::new();
    let mut counts = [(); 2].map(|()| Counts::new(CONE_CELLS));
    for force in forces {
        let [fx_n, fy_n, fz_n] = force;
        if !force.iter().all(|force| force.is_finite()) {
            not_finite += 1;
        } else if fz_n.abs() <= rest_n && fx_n.hypot(fy_n) <= rest_n {
            at_rest += 1;
        } else {
            let places = [Density::Cylindrical, Density::Cartesian].map(|density| space.place(density, force));
            if let [Some(cylindrical), Some(cartesian)] = places {
                counts[0].add(cylindrical);
                counts[1].add(cartesian);
                kept.push(force);
            } else {
                outside += 1;
            }
        }
    }
    let [cylindrical, cartesian] = counts.map(|counts| counts.evenness());
    let rows = kept.len();
    let hole = hole(kept, space);
    ConeCoverage { rows, at_rest, outside, not_finite, cylindrical, cartesian, hole }
}

/// The cell of a force of the cone, of [`CONE_CELLS`] in cylindrical density, counted as directions, then shear, then
/// pressing; `None` outside of the cone.
#[must_use]
pub fn cone_cell(space: &ForceSpace, force_n: [f64; 3]) -> Option<usize> {
    space.place(Density::Cylindrical, force_n).map(|place| cell(CONE_CELLS, place))
}

/// The force, newtons, in the middle of a cell of [`cone_cell`].
#[must_use]
pub fn cell_middle_n(space: &ForceSpace, cell: usize) -> [f64; 3] {
    let [ups, outs, turns] = CONE_CELLS;
    let at = [cell / (outs * turns), cell / turns % outs, cell % turns];
    space.force(Density::Cylindrical, std::array::from_fn(|k| (at[k] as f64 + 0.5) / [ups, outs, turns][k] as f64))
}

fn cell(cells: [usize; 3], place: [f64; 3]) -> usize {
    let at: [usize; 3] = std::array::from_fn(|k| ((place[k] * cells[k] as f64) as usize).min(cells[k] - 1));
    (at[0] * cells[1] + at[1]) * cells[2] + at[2]
}

/// Rows in each cell.
struct Counts {
    cells: [usize; 3],
    all: Vec<u64>,
}

impl Counts {
    fn new(cells: [usize; 3]) -> Self {
        Self { cells, all: vec![0; cells.iter().product()] }
    }

    fn add(&mut self, place: [f64; 3]) {
        self.all[cell(self.cells, place)] += 1;
    }

    fn evenness(&self) -> Evenness {
        let visited = self.all.iter().filter(|count| **count > 0).count() as f64 / self.all.len() as f64;
        let [_, outs, turns] = self.cells;
        let along = |coordinate: usize| {
            let mut counts = vec![0; self.cells[coordinate]];
            for (cell, count) in self.all.iter().enumerate() {
                counts[[cell / (outs * turns), cell / turns % outs, cell % turns][coordinate]] += count;
            }
            entropy(&counts)
        };
        let of_each = [along(0), along(1), along(2)];
        let of_each = if let [Some(up), Some(out), Some(turn)] = of_each { Some([up, out, turn]) } else { None };
        Evenness { cells: self.all.len(), visited, entropy: entropy(&self.all), of_each }
    }
}

/// The entropy of counts over that of even ones.
fn entropy(counts: &[u64]) -> Option<f64> {
    let all: u64 = counts.iter().sum();
    let share = |count: &u64| *count as f64 / all as f64;
    let terms = counts.iter().filter(|count| **count > 0).map(|count| -share(count) * share(count).ln());
    (all > 0).then(|| (terms.sum::<f64>() / (counts.len() as f64).ln()).clamp(0.0, 1.0))
}

/// The force of the cone that is farthest from all rows.
fn hole(mut rows: Vec<[f64; 3]>, space: &ForceSpace) -> Option<Hole> {
    // Squares of the cone's own size neither overflow nor vanish.
    let size_n = space.fz_max_n() * space.mu().max(1.0);
    rows.iter_mut().flatten().for_each(|force| *force /= size_n);
    rows.sort_by(|a, b| a[2].total_cmp(&b[2]).then(a[1].total_cmp(&b[1])).then(a[0].total_cmp(&b[0])));
    rows.dedup();
    if rows.is_empty() {
        return None;
    }
    let force = |place: [f64; 3]| space.force(Density::Cylindrical, place);
    let measured = |place: [f64; 3]| (nearest(&rows, force(place).map(|force| force / size_n)), place);
    let mut best: Vec<(f64, [f64; 3])> = Vec::new();
    let [ups, outs, turns] = LATTICE;
    for up in 0..=ups {
        for out in 0..=outs {
            for turn in 0..turns {
                // Even steps of pressing.
                let height = (up as f64 / ups as f64).powi(2);
                let found = measured([height, out as f64 / outs as f64, turn as f64 / turns as f64]);
                let at = best.partition_point(|other| other.0 >= found.0);
                if at < REFINED {
                    best.insert(at, found);
                    best.truncate(REFINED);
                }
            }
        }
    }
    let refined = best.into_iter().map(|start| climb(&measured, start));
    let (radius, place) = refined.fold((0.0, [0.0; 3]), |best, next| if next.0 > best.0 { next } else { best });
    Some(Hole { radius_n: size_n * radius, middle_n: force(place) })
}

/// Goes uphill in steps that halve.
fn climb(measured: &dyn Fn([f64; 3]) -> (f64, [f64; 3]), start: (f64, [f64; 3])) -> (f64, [f64; 3]) {
    let mut best = start;
    let mut steps = LATTICE.map(|places| 1.0 / places as f64);
    for _ in 0..10 {
        let mut moved = true;
        let mut left = 20;
        while moved && left > 0 {
            moved = false;
            left -= 1;
            for k in 0..27 {
                let to: [f64; 3] = std::array::from_fn(|c| {
                    let by = f64::from(k / 3_i32.pow(c as u32) % 3 - 1) * steps[c];
                    let to = best.1[c] + by;
                    // Directions go around, the others end.
                    if c == 2 { to.rem_euclid(1.0) } else { to.clamp(0.0, 1.0) }
                });
                let found = measured(to);
                if found.0 > best.0 {
                    (best, moved) = (found, true);
                }
            }
        }
        steps = steps.map(|step| 0.5 * step);
    }
    best
}

/// The distance from `force` to the nearest of `rows`, which ascend in Fz.
fn nearest(rows: &[[f64; 3]], force: [f64; 3]) -> f64 {
    let square = |row: &[f64; 3]| (0..3).map(|k| (row[k] - force[k]).powi(2)).sum::<f64>();
    let from = rows.partition_point(|row| row[2] < force[2]);
    let (mut below, mut above) = (rows[..from].iter().rev(), rows[from..].iter());
    let (mut best, mut some) = (f64::INFINITY, true);
    while some {
        some = false;
        for next in [below.next(), above.next()].into_iter().flatten() {
            // Farther in Fz alone than the best: so are all that follow on this side.
            if (next[2] - force[2]).powi(2) < best {
                best = best.min(square(next));
                some = true;
            }
        }
    }
    best.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trajectory::{RandomForce, Spiral};
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    const SPACE: fn() -> ForceSpace = ForceSpace::default;

    fn uniform(density: Density, rows: usize, seed: u64) -> Vec<[f64; 3]> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut place = || std::array::from_fn(|_| rng.random_range(0.0..1.0));
        (0..rows).map(|_| SPACE().force(density, place())).collect()
    }

    #[test]
    fn an_even_sample_is_close_to_the_best_in_its_own_density() {
        let rows = 4500;
        for seed in 0..5 {
            let cylindrical = cone_coverage(uniform(Density::Cylindrical, rows, seed), &SPACE(), 1e-3);
            let cartesian = cone_coverage(uniform(Density::Cartesian, rows, seed), &SPACE(), 1e-3);
            // Miller's figure for 192 cells; its own spread is 0.0004.
            let best = 1.0 - 191.0 / (2.0 * rows as f64 * 192f64.ln());
            for own in [&cylindrical.cylindrical, &cartesian.cartesian] {
                assert_eq!((own.cells, own.visited), (192, 1.0));
                assert!((own.entropy.unwrap() - best).abs() <= 0.002, "{own:?} {best}");
                assert!(own.of_each.unwrap().iter().all(|entropy| *entropy >= 0.999), "{own:?}");
            }
            // Evenness in one density is not evenness in the other; measured 0.948 to 0.956.
            assert!(cylindrical.cartesian.entropy.unwrap() < 0.97 && cartesian.cylindrical.entropy.unwrap() < 0.97);
            // 4500 in 15.9 N^3: a ball of the mean volume has 0.09 N; the emptiest is some times that; measured 0.27 to
            // 0.35.
            let hole = cartesian.hole.unwrap();
            assert!((0.2..=0.6).contains(&hole.radius_n), "{hole:?}");
        }
    }

    #[test]
    fn a_line_covers_little() {
        let line = (1..=4500).map(|k| [0.0, 0.0, -3.0 * f64::from(k) / 4500.0]);
        let found = cone_coverage(line, &SPACE(), 1e-6);
        assert_eq!((found.rows, found.cylindrical.visited), (4500, 6.0 / 192.0));
        assert!(found.cylindrical.entropy.unwrap() < 0.35, "{found:?}");
        let [up, out, turn] = found.cylindrical.of_each.unwrap();
        assert!(up > 0.7 && out == 0.0 && turn == 0.0);
        // The farthest forces are the rim's, by mu N_max.
        let hole = found.hole.unwrap();
        assert!((hole.radius_n - 2.25).abs() <= 1e-3 && (hole.middle_n[2] + 3.0).abs() <= 1e-6, "{hole:?}");
    }

    #[test]
    fn a_hole_whose_size_is_known_is_found() {
        // A fine lattice of forces with a ball of 0.6 N taken out.
        let middle: [f64; 3] = [0.4, -0.5, -2.0];
        let mut rows = Vec::new();
        for x in -46..=46 {
            for y in -46..=46 {
                for z in 0..=60 {
                    let force = [0.05 * f64::from(x), 0.05 * f64::from(y), -0.05 * f64::from(z)];
                    let off: f64 = (0..3).map(|k| (force[k] - middle[k]).powi(2)).sum();
                    if SPACE().place(Density::Cartesian, force).is_some() && off.sqrt() >= 0.6 {
                        rows.push(force);
                    }
                }
            }
        }
        let hole = cone_coverage(rows, &SPACE(), 1e-3).hole.unwrap();
        // Rows of the lattice stand up to 0.05 N off the ball; measured 0.59985.
        assert!((0.595..=0.65).contains(&hole.radius_n), "{hole:?}");
        assert!((0..3).all(|k| (hole.middle_n[k] - middle[k]).abs() <= 0.01), "{hole:?}");
    }

    #[test]
    fn the_fast_search_finds_what_trying_all_rows_finds() {
        let mut rows = uniform(Density::Cartesian, 300, 9);
        let asked = uniform(Density::Cylindrical, 200, 10);
        rows.sort_by(|a, b| a[2].total_cmp(&b[2]));
        for force in asked {
            let square = |row: &[f64; 3]| (0..3).map(|k| (row[k] - force[k]).powi(2)).sum::<f64>();
            let naive = rows.iter().map(square).fold(f64::INFINITY, f64::min).sqrt();
            assert_eq!(nearest(&rows, force), naive);
        }
    }

    #[test]
    fn the_spiral_is_even_in_direction_and_pressing_and_the_random_motion_is_not() {
        let at = |k: i32| f64::from(k) * 0.04;
        let spiral = Spiral::default();
        let even = cone_coverage((0..=4500).map(|k| spiral.forces_n(at(k))), &SPACE(), 1e-6);
        assert_eq!((even.at_rest, even.outside), (1, 0));
        let [up, _, turn] = even.cylindrical.of_each.unwrap();
        assert!(up > 0.999 && turn > 0.98, "{even:?}");
        let random = RandomForce::new(SPACE(), 0.1, 1);
        let uneven = cone_coverage((0..=4500).map(|k| random.forces_n(at(k))), &SPACE(), 1e-6);
        assert!(uneven.cylindrical.entropy.unwrap() < even.cylindrical.entropy.unwrap(), "{uneven:?} {even:?}");
    }

    #[test]
    fn the_middle_of_a_cell_is_in_it() {
        let space = ForceSpace::new(2.0, 0.5).unwrap();
        for cell in 0..CONE_CELLS.iter().product() {
            assert_eq!(cone_cell(&space, cell_middle_n(&space, cell)), Some(cell));
        }
        assert_eq!(cone_cell(&space, [0.0, 0.0, 1.0]), None);
    }

    #[test]
    fn the_size_of_the_cone_does_not_matter() {
        let rows = uniform(Density::Cartesian, 500, 2);
        let usual = cone_coverage(rows.clone(), &SPACE(), 0.0);
        for (fz_max_n, mu) in [(3e300, 0.75), (3e-300, 0.75), (3.0, 7.5e-200), (3.0, 7.5e200)] {
            let space = ForceSpace::new(fz_max_n, mu).unwrap();
            let grown = rows
                .iter()
                .map(|[x, y, z]| [fz_max_n / 3.0 * mu / 0.75 * x, fz_max_n / 3.0 * mu / 0.75 * y, fz_max_n / 3.0 * z]);
            let found = cone_coverage(grown, &space, 0.0);
            assert_eq!((found.rows, found.cylindrical), (500, usual.cylindrical), "{fz_max_n} {mu}");
            let radius_n = found.hole.unwrap().radius_n;
            assert!(radius_n > 0.0 && radius_n.is_finite(), "{fz_max_n} {mu}: {radius_n}");
            if mu == 0.75 {
                assert!((radius_n / fz_max_n / (usual.hole.unwrap().radius_n / 3.0) - 1.0).abs() <= 1e-9, "{radius_n}");
            }
        }
    }

    #[test]
    fn rows_that_cannot_count_are_counted_apart() {
        let rows = [[0.001, 0.0, 0.002], [0.0, 0.0, 0.5], [2.0, 0.0, -1.0], [f64::NAN, 0.0, -1.0], [0.1, 0.1, -1.0]];
        let found = cone_coverage(rows, &SPACE(), 0.01);
        assert_eq!((found.rows, found.at_rest, found.outside, found.not_finite), (1, 1, 2, 1));
        assert_eq!(found.cylindrical.entropy, Some(0.0));
        let none = cone_coverage([], &SPACE(), 0.01);
        assert_eq!((none.rows, none.hole, none.cartesian.entropy, none.cartesian.of_each), (0, None, None, None));
        assert_eq!(none.cartesian.visited, 0.0);
    }
}
