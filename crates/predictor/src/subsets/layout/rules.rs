//! What places may be chosen together, as units of one place or of a place and its mirror image.

use super::problem::LayoutProblem;

/// Places are each other's mirror image, or on the axis, when they are off by no more than this, millimetres (assumed:
/// the rounding of files of places).
const SAME_MM: f64 = 1e-6;

/// What is asked of a layout.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Rules {
    /// No two places are nearer to each other than this, millimetres; kept places aside.
    pub apart_mm: f64,
    /// Places that every layout has, by the caller's numbers.
    pub keep: Vec<usize>,
    /// Whether left and right are alike: with every place its mirror image. A place without one is not chosen.
    pub mirror: bool,
}

/// The units of a problem under rules.
#[derive(Debug, Clone)]
pub(super) struct Units {
    /// Places that every layout has.
    pub(super) kept: Vec<usize>,
    /// Others, one or two places each.
    pub(super) units: Vec<Vec<usize>>,
    /// Units x units: which are too near to each other.
    near: Vec<bool>,
}

impl Units {
    pub(super) fn new(problem: &LayoutProblem, rules: &Rules) -> Self {
        let places = &problem.candidates;
        let same = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).abs() <= SAME_MM && (a[1] - b[1]).abs() <= SAME_MM;
        let at = |k: usize| [places[k].across_mm, places[k].along_mm];
        let too_near = |i: usize, j: usize| {
            let ([x, y], [u, v]) = (at(i), at(j));
            (x - u) * (x - u) + (y - v) * (y - v) < rules.apart_mm * rules.apart_mm * (1.0 - 1e-9)
        };
        let mirror = |k: usize| {
            let [across, along] = at(k);
            let image = [-across, along];
            if same(at(k), image) { Some(k) } else { (0..places.len()).find(|&other| same(at(other), image)) }
        };
        let mut kept: Vec<usize> = Vec::new();
        for &place in &rules.keep {
            let own = problem.own(place);
            kept.push(own);
            kept.extend(mirror(own).filter(|_| rules.mirror));
        }
        kept.sort_unstable();
        kept.dedup();
        let mut units: Vec<Vec<usize>> = Vec::new();
        for k in 0..places.len() {
            match mirror(k).filter(|_| rules.mirror) {
                Some(image) if image > k => units.push(vec![k, image]),
                Some(image) if image < k => {}
                None if rules.mirror => {}
                _ => units.push(vec![k]),
            }
        }
        units.retain(|unit| {
            let free = |place: &usize| !kept.contains(place) && !kept.iter().any(|&other| too_near(*place, other));
            unit.iter().all(free) && !(unit.len() == 2 && too_near(unit[0], unit[1]))
        });
        let pairs = |one: &[usize], other: &[usize]| one.iter().any(|&i| other.iter().any(|&j| too_near(i, j)));
        let near = units.iter().flat_map(|one| units.iter().map(|other| pairs(one, other))).collect();
        Self { kept, units, near }
    }

    /// Whether two units may not be chosen together.
    pub(super) fn near(&self, one: usize, other: usize) -> bool {
        one == other || self.near[one * self.units.len() + other]
    }

    /// How many units of two and of one places make `k` places together with those kept: every way there is.
    pub(super) fn compositions(&self, k: usize) -> Vec<[usize; 2]> {
        let Some(left) = k.checked_sub(self.kept.len()) else { return Vec::new() };
        let pairs = self.units.iter().filter(|unit| unit.len() == 2).count();
        let singles = self.units.len() - pairs;
        let all = (0..=left / 2).map(|two| [two, left - 2 * two]);
        all.filter(|&[two, one]| two <= pairs && one <= singles).collect()
    }
}
