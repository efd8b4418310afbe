//! What each photodiode sees of a nail: the mean of the nail's colour over a disc.
//!
//! In: a [`NailScene`] and [`Positions`]. Out: red, green and blue of each disc at any moment, encoded, fractions of
//! full scale, as the scene's light and camera show them, without noise. The colour is a sum of zones times weights, so
//! a disc's mean is one as well: the integrals over the discs are taken once, and any moment's mean is exact up to
//! them. They are Gauss' in the radius and even in the angle; measured against 126 000 points a disc they differ by
//! less than 2e-7 of full scale.
//!
//! A disc is round on the nail, and of the size that it has on a nail as wide as [`Positions::nail_width_mm`], whatever
//! the subject's.

use crate::nail::Positions;
use crate::phantom::nail::{ColourWeights, NailScene, PATTERNS};

/// Rings of a disc, and places on each.
const RINGS: usize = 24;
const PLACES: usize = 96;

/// One disc's integrals, of red, green and blue.
#[derive(Debug, Clone, PartialEq)]
struct Disc {
    /// Without any zone.
    pale: [f64; 3],
    /// What each zone adds, as proximal blood's weights have it, and how much more there is of distal ones.
    zones: [[f64; 3]; PATTERNS],
    distal: [[f64; 3]; PATTERNS],
}

/// What the photodiodes on one nail see.
#[derive(Debug, Clone, PartialEq)]
pub struct Discs(Vec<Disc>);

/// Where a disc's integral is sampled: offsets in radii of the disc, and each sample's share.
pub(in crate::phantom) fn disc_samples() -> Vec<([f64; 2], f64)> {
    let rings = gauss(RINGS);
    let mut samples = Vec::with_capacity(RINGS * PLACES);
    for (ring, &(radius, weight)) in rings.iter().enumerate() {
        for place in 0..PLACES {
            // Turned from ring to ring, so that no direction is seen better than others.
            let turn = std::f64::consts::TAU * (place as f64 + ring as f64 / RINGS as f64) / PLACES as f64;
            let (sin, cos) = turn.sin_cos();
            samples.push(([radius * cos, radius * sin], 2.0 * radius * weight / PLACES as f64));
        }
    }
    samples
}

/// Nodes and weights of Gauss and Legendre's rule on 0..1, by Newton's method.
fn gauss(count: usize) -> Vec<(f64, f64)> {
    let n = count as f64;
    (0..count)
        .map(|k| {
            let mut x = (std::f64::consts::PI * (k as f64 + 0.75) / (n + 0.5)).cos();
            let mut slope = 1.0;
            for _ in 0..20 {
                let (mut before, mut here) = (1.0, x);
                for order in 2..=count {
                    let m = order as f64;
                    (before, here) = (here, ((2.0 * m - 1.0) * x * here - (m - 1.0) * before) / m);
                }
                slope = n * (x * here - before) / (x * x - 1.0);
                x -= here / slope;
            }
            (0.5 * (1.0 + x), 1.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

impl Discs {
    /// The discs of `positions` on the scene's nail.
    #[must_use]
    pub fn new(scene: &NailScene, positions: &Positions) -> Self {
        let (pale, white) = (scene.field().whitened(0.0), scene.field().whitened(1.0));
        let radius = [2.0 * positions.radius_widths(), 2.0 * positions.radius_widths() / scene.subject.nail.aspect];
        let samples = disc_samples();
        let one = |[u, v]: [f64; 2]| {
            let mut disc = Disc { pale: [0.0; 3], zones: [[0.0; 3]; PATTERNS], distal: [[0.0; 3]; PATTERNS] };
            for (offset, share) in &samples {
                let [x, y] = scene.picture_from_nail(u + radius[0] * offset[0], v + radius[1] * offset[1]);
                let (colour, whitened) = (pale.colour(x, y), white.colour(x, y));
                let (zones, distal) = pale.patterns(x, y);
                for c in 0..3 {
                    disc.pale[c] += share * colour[c];
                    let gain = share * (whitened[c] - colour[c]);
                    for (k, zone) in zones.iter().enumerate() {
                        disc.zones[k][c] += gain * zone;
                        disc.distal[k][c] += gain * distal * zone;
                    }
                }
            }
            disc
        };
        Self(positions.photodiodes.iter().map(|place| one([place.u, place.v])).collect())
    }

    /// Red, green and blue of each disc at a moment.
    #[must_use]
    pub fn colours(&self, weights: &ColourWeights) -> Vec<[f64; 3]> {
        let one = |disc: &Disc| {
            std::array::from_fn(|c| {
                (0..PATTERNS).fold(disc.pale[c], |sum, k| {
                    let (distal, proximal) = (weights.distal[k], weights.proximal[k]);
                    sum + proximal * disc.zones[k][c] + (distal - proximal) * disc.distal[k][c]
                })
            })
        };
        self.0.iter().map(one).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nail::Axis;
    use crate::phantom::nail::{Camera, Light, Pose, Subject};

    #[test]
    fn a_discs_mean_is_the_fields_at_any_moment() {
        /// Measured: 1.8e-7.
        const NEAR: f64 = 4e-7;
        let subject = Subject::random(0, 3);
        let axis = Axis::from_clockwise_rad(0.2);
        let camera = Camera { axis, ..Camera::upright([640, 480], [311.0, 250.3], 190.0) };
        let scene = NailScene { subject, pose: Pose::Nominal, light: Light::chamber(), camera };
        let positions = Positions::thesis();
        let discs = Discs::new(&scene, &positions);
        let weights = ColourWeights::resting(&scene.subject, [0.7, -1.1, -2.2], [0.0, 0.1, 0.0]);
        let mut uneven = weights;
        uneven.distal = uneven.distal.map(|weight| 0.6 * weight + 0.05);
        for weights in [weights, uneven] {
            let field = scene.field().at_moment(&weights);
            let colours = discs.colours(&weights);
            let mut worst = 0.0f64;
            for (place, colour) in positions.photodiodes.iter().zip(colours) {
                let side = 400;
                let (mut sum, mut count) = ([0.0; 3], 0.0);
                for k in 0..side * side {
                    let at = |k: i32| (2.0 * f64::from(k) + 1.0) / f64::from(side) - 1.0;
                    let [a, b] = [at(k % side), at(k / side)];
                    if a * a + b * b <= 1.0 {
                        let r = 2.0 * positions.radius_widths();
                        let [x, y] =
                            scene.picture_from_nail(place.u + r * a, place.v + r / scene.subject.nail.aspect * b);
                        let seen = field.colour(x, y);
                        (0..3).for_each(|c| sum[c] += seen[c]);
                        count += 1.0;
                    }
                }
                (0..3).for_each(|c| worst = worst.max((sum[c] / count - colour[c]).abs()));
            }
            assert!(worst <= NEAR, "{worst}");
        }
    }

    #[test]
    fn the_samples_shares_are_those_of_a_disc() {
        let samples = disc_samples();
        let moment = |of: &dyn Fn([f64; 2]) -> f64| samples.iter().map(|(at, share)| share * of(*at)).sum::<f64>();
        assert!((moment(&|_| 1.0) - 1.0).abs() <= 1e-12);
        assert!((moment(&|[x, _]| x * x) - 0.25).abs() <= 1e-12 && moment(&|[_, y]| y).abs() <= 1e-12);
    }
}
