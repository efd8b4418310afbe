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

fn lattice(seed: u32, x: i32, y: i32) -> f64 {
    let mut h = seed ^ (x as u32).wrapping_mul(0x9E37_79B1) ^ (y as u32).wrapping_mul(0x85EB_CA77);
    h = (h ^ (h >> 15)).wrapping_mul(0x2C1B_3C6D);
    h = (h ^ (h >> 12)).wrapping_mul(0x297A_2D39);
    h ^= h >> 15;
    f64::from(h) * (2.0 / 4_294_967_295.0) - 1.0
}

/// Seeded noise over the plane within -1..1, with features about 1 wide.
pub(super) fn noise2(seed: u32, x: f64, y: f64) -> f64 {
    let (fx, fy) = (x.floor(), y.floor());
    let (ix, iy) = (fx as i32, fy as i32);
    let (tx, ty) = (step01(x - fx), step01(y - fy));
    let low = lattice(seed, ix, iy) * (1.0 - tx) + lattice(seed, ix.wrapping_add(1), iy) * tx;
    let iy = iy.wrapping_add(1);
    let high = lattice(seed, ix, iy) * (1.0 - tx) + lattice(seed, ix.wrapping_add(1), iy) * tx;
    low * (1.0 - ty) + high * ty
}

/// Seeded noise over a line within -1..1, with features about 1 wide.
pub(super) fn noise1(seed: u32, x: f64) -> f64 {
    let fx = x.floor();
    let ix = fx as i32;
    let t = step01(x - fx);
    lattice(seed, ix, 0) * (1.0 - t) + lattice(seed, ix.wrapping_add(1), 0) * t
}
