//! Smooth building blocks of a scene: steps, bumps and seeded noise, all with continuous second derivatives and cheap
//! enough to be evaluated a dozen times a pixel.

/// 0 below 0, 1 above 1, between them the quintic with vanishing first and second derivatives at both ends.
#[inline(always)]
pub(super) fn step01(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

/// A step from 0 to 1 as `x` goes from `low` to `high`.
#[inline(always)]
pub(super) fn step(low: f64, high: f64, x: f64) -> f64 {
    // Written as a product so that constant borders leave no division.
    step01((x - low) * (1.0 / (high - low)))
}

/// A bell close to exp(-t2 / 2) that ends at t2 = 8; `t2` is a squared number of standard deviations.
#[inline(always)]
pub(super) fn bell(t2: f64) -> f64 {
    let t = (1.0 - t2 * 0.125).max(0.0);
    let t = t * t;
    t * t
}

/// A line of some anatomical width seen through the optics: wider and lower than it is.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line {
    height: f64,
    per_variance: f64,
}

impl Line {
    /// A line of standard deviation `width` and height 1 through optics of standard deviation `optics` (same unit).
    pub(super) fn new(width: f64, optics: f64) -> Self {
        let variance = width * width + optics * optics;
        Self { height: width / variance.sqrt(), per_variance: 1.0 / variance }
    }

    /// Its height at the distance `x` from its middle.
    #[inline(always)]
    pub(super) fn at(self, x: f64) -> f64 {
        self.height * bell(x * x * self.per_variance)
    }
}

/// An edge of some anatomical softness seen through the optics.
#[derive(Debug, Clone, Copy)]
pub(super) struct Edge {
    per_width: f64,
}

impl Edge {
    /// An edge of standard deviation `softness` through optics of standard deviation `optics` (same unit).
    pub(super) fn new(softness: f64, optics: f64) -> Self {
        // The derivative of the quintic over a half width h is a bell with a standard deviation of h / sqrt(7).
        Self { per_width: 0.5 / (7.0_f64.sqrt() * softness.hypot(optics)) }
    }

    /// How much of the inside is seen at the signed distance `d` (negative inside), 0 to 1.
    #[inline(always)]
    pub(super) fn covered(self, d: f64) -> f64 {
        step01(0.5 - d * self.per_width)
    }
}

/// How much of a pattern with features of `spacing_px` a camera still resolves: 0 under 1.5 px, all from 4 px.
pub(super) fn resolved(spacing_px: f64) -> f64 {
    step(1.5, 4.0, spacing_px)
}

/// The whole number below `x` and what is left, 0 to 1 (no call of `floor`, which the oldest processors of x86-64
/// lack).
fn split(x: f64) -> (i32, f64) {
    let toward_zero = x as i32;
    let below = toward_zero.wrapping_sub(i32::from(f64::from(toward_zero) > x));
    (below, x - f64::from(below))
}

/// Entries of the noise's table, a power of two.
const ENTRIES: usize = 4096;

/// Distance of neighbouring rows in the table. Near ENTRIES over the golden ratio: the same entry comes back only some
/// 60 features away.
const ROW: u32 = 2531;

/// Numbers within -1..=1 without order; reading four of them is cheaper than hashing four places.
static TABLE: [f32; ENTRIES] = {
    let mut table = [0.0; ENTRIES];
    let mut k = 0;
    while k < ENTRIES {
        let mut h = (k as u32 + 1).wrapping_mul(0x9E37_79B1);
        h = (h ^ (h >> 15)).wrapping_mul(0x2C1B_3C6D);
        h = (h ^ (h >> 12)).wrapping_mul(0x297A_2D39);
        table[k] = ((h ^ (h >> 15)) as i32) as f32 / 2_147_483_648.0;
        k += 1;
    }
    table
};

fn entry(place: u32) -> f64 {
    f64::from(TABLE[place as usize % ENTRIES])
}

/// Where the numbers of `seed` begin in the table.
fn start(seed: u32) -> u32 {
    seed.wrapping_mul(0x9E37_79B1) >> 16
}

/// Seeded noise over the plane within -1..1, with features about 1 wide.
#[inline]
pub(super) fn noise2(seed: u32, x: f64, y: f64) -> f64 {
    let ((ix, fx), (iy, fy)) = (split(x), split(y));
    let (tx, ty) = (step01(fx), step01(fy));
    let along = |first: u32| {
        let left = entry(first);
        left + (entry(first.wrapping_add(1)) - left) * tx
    };
    let first = start(seed).wrapping_add(ix as u32).wrapping_add((iy as u32).wrapping_mul(ROW));
    let low = along(first);
    low + (along(first.wrapping_add(ROW)) - low) * ty
}

/// Seeded noise over a line within -1..1, with features about 1 wide.
#[inline]
pub(super) fn noise1(seed: u32, x: f64) -> f64 {
    let (ix, fx) = split(x);
    let first = start(seed).wrapping_add(ix as u32);
    let left = entry(first);
    left + (entry(first.wrapping_add(1)) - left) * step01(fx)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_edge_is_as_soft_as_it_says() {
        // The blurred edge's derivative is a bell; its second moment is the square of the softness.
        let (sigma, n) = (0.8, 4000);
        let edge = Edge::new(0.0, sigma);
        let at = |k: usize| -4.0 + 8.0 * k as f64 / n as f64;
        let variance: f64 = (0..n)
            .map(|k| {
                let middle = 0.5 * (at(k) + at(k + 1));
                (edge.covered(at(k)) - edge.covered(at(k + 1))) * middle * middle
            })
            .sum();
        assert!((variance.sqrt() - sigma).abs() <= 1e-5, "{}", variance.sqrt());
        assert_eq!(edge.covered(0.0), 0.5);
    }

    #[test]
    fn noise_has_no_jump_and_fills_its_range() {
        let step = 1e-4;
        let (mut low, mut high, mut jump) = (f64::MAX, f64::MIN, 0.0_f64);
        for k in 0..200_000 {
            let x = -10.0 + step * f64::from(k);
            let here = noise2(7, x, 0.3 * x);
            jump = jump.max((here - noise2(7, x + step, 0.3 * (x + step))).abs());
            (low, high) = (low.min(here), high.max(here));
        }
        // The quintic's steepest slope is 15/8 a unit, of at most 2 between neighbours, along each axis.
        assert!(jump <= 15.0 / 8.0 * 2.0 * 1.3 * step, "{jump}");
        assert!(low >= -1.0 && high <= 1.0 && low <= -0.6 && high >= 0.6, "{low} {high}");
    }

    #[test]
    fn below_zero_is_split_like_above() {
        assert_eq!(split(-0.25), (-1, 0.75));
        assert_eq!(split(-2.0), (-2, 0.0));
        assert_eq!(split(3.5), (3, 0.5));
    }
}
