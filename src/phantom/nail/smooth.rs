//! Smooth building blocks of a scene: steps, bumps and seeded noise, all with continuous second derivatives and cheap enough to be
//! evaluated a dozen times a pixel.

/// 0 below 0, 1 above 1, between them the quintic with vanishing first and second derivatives at both ends.
pub(super) fn step01(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

/// A step from 0 to 1 as `x` goes from `low` to `high`.
pub(super) fn step(low: f64, high: f64, x: f64) -> f64 {
    step01((x - low) / (high - low))
}

/// Coverage of the inside of an edge blurred with standard deviation `sigma`, at the signed distance `d` (negative inside).
pub(super) fn covered(d: f64, sigma: f64) -> f64 {
    // The derivative of the quintic over a half width h is a bell with a standard deviation of h / sqrt(7).
    let half = 2.645_751_311_064_591 * sigma;
    step01(0.5 - 0.5 * d / half)
}

/// A bell close to exp(-t2 / 2) that ends at t2 = 8; `t2` is a squared number of standard deviations.
pub(super) fn bell(t2: f64) -> f64 {
    let t = (1.0 - t2 / 8.0).max(0.0);
    let t = t * t;
    t * t
}

/// A bell of anatomical width `width` seen through optics of standard deviation `optics` (same unit): wider and lower.
pub(super) fn line(x: f64, width: f64, optics: f64) -> f64 {
    let seen2 = width * width + optics * optics;
    width / seen2.sqrt() * bell(x * x / seen2)
}

/// How much of a pattern with features of `spacing_px` a camera still resolves: 0 under 1.5 px, all from 4 px.
pub(super) fn resolved(spacing_px: f64) -> f64 {
    step(1.5, 4.0, spacing_px)
}

/// The whole number below `x` and what is left, 0 to 1 (no call of `floor`, which the oldest processors of x86-64 lack).
fn split(x: f64) -> (i32, f64) {
    let toward_zero = x as i32;
    let below = toward_zero.wrapping_sub(i32::from(f64::from(toward_zero) > x));
    (below, x - f64::from(below))
}

/// A number within -1..=1 for each whole `x` in the row `row`, from [`row`].
fn lattice(row: u32, x: i32) -> f64 {
    let mut h = row ^ (x as u32).wrapping_mul(0x9E37_79B1);
    h = (h ^ (h >> 15)).wrapping_mul(0x2C1B_3C6D);
    h = (h ^ (h >> 12)).wrapping_mul(0x297A_2D39);
    f64::from((h ^ (h >> 15)) as i32) * (1.0 / 2_147_483_648.0)
}

fn row(seed: u32, y: i32) -> u32 {
    seed ^ (y as u32).wrapping_mul(0x85EB_CA77)
}

/// Seeded noise over the plane within -1..1, with features about 1 wide.
#[inline]
pub(super) fn noise2(seed: u32, x: f64, y: f64) -> f64 {
    let ((ix, fx), (iy, fy)) = (split(x), split(y));
    let (tx, ty) = (step01(fx), step01(fy));
    let right = ix.wrapping_add(1);
    let along = |row: u32| {
        let left = lattice(row, ix);
        left + (lattice(row, right) - left) * tx
    };
    let low = along(row(seed, iy));
    low + (along(row(seed, iy.wrapping_add(1))) - low) * ty
}

/// Seeded noise over a line within -1..1, with features about 1 wide.
#[inline]
pub(super) fn noise1(seed: u32, x: f64) -> f64 {
    let (ix, fx) = split(x);
    let left = lattice(seed, ix);
    left + (lattice(seed, ix.wrapping_add(1)) - left) * step01(fx)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_edge_is_as_soft_as_it_says() {
        // The blurred edge's derivative is a bell; its second moment is the square of the softness.
        let (sigma, n) = (0.8, 4000);
        let at = |k: usize| -4.0 + 8.0 * k as f64 / n as f64;
        let variance: f64 = (0..n)
            .map(|k| {
                let middle = 0.5 * (at(k) + at(k + 1));
                (covered(at(k), sigma) - covered(at(k + 1), sigma)) * middle * middle
            })
            .sum();
        assert!((variance.sqrt() - sigma).abs() <= 1e-5, "{}", variance.sqrt());
        assert_eq!(covered(0.0, sigma), 0.5);
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
