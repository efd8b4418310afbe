//! Shear to speed or distance: a round dead zone, two gains and a cap.
//!
//! Velocity: with s the shear beyond the dead zone, v = g_low s up to the knee k, g_low k + g_high (s - k) beyond it,
//! no more than the cap; one slope for aim and one for way is the transfer of isometric pointing sticks (US 6 975 302,
//! expired). Both zone and cap are those of the magnitude: the direction of the shear is kept.

use super::super::config::{Config, Mode};

pub(super) fn velocity_px_per_s(config: &Config, shear_n: [f64; 2]) -> [f64; 2] {
    let (size_n, direction) = beyond(config.dead_zone_n, shear_n);
    direction.map(|part| part * speed_px_per_s(config, size_n))
}

/// The speed at so much shear beyond the dead zone.
fn speed_px_per_s(config: &Config, beyond_n: f64) -> f64 {
    let low_n = beyond_n.min(config.knee_n);
    let speed = config.gain_low_px_per_s_per_n * low_n + config.gain_high_px_per_s_per_n * (beyond_n - low_n);
    speed.min(config.cap_px_per_s)
}

/// The distance of a shear from where the pointer is without, px.
pub(super) fn place_px(config: &Config, shear_n: [f64; 2]) -> [f64; 2] {
    let (size_n, direction) = beyond(config.dead_zone_n, shear_n);
    direction.map(|part| part * config.gain_position_px_per_n * size_n)
}

/// The shear, newtons without its dead zone, for a speed of up to the cap: the inverse of the curve, which a person
/// learns.
#[cfg(test)]
pub(in super::super) fn shear_for_n(config: &Config, speed_px_per_s: f64) -> f64 {
    let speed = speed_px_per_s.clamp(0.0, config.cap_px_per_s);
    let at_knee = config.gain_low_px_per_s_per_n * config.knee_n;
    if speed <= at_knee {
        speed / config.gain_low_px_per_s_per_n
    } else {
        config.knee_n + (speed - at_knee) / config.gain_high_px_per_s_per_n
    }
}

/// Screen axes of a shear, x to the right and y down: mirrored, then turned.
pub(super) fn on_screen(config: &Config, [fx_n, fy_n]: [f64; 2]) -> [f64; 2] {
    let (sin, cos) = config.turn_deg.to_radians().sin_cos();
    let fx_n = if config.mirror_x { -fx_n } else { fx_n };
    [cos * fx_n - sin * fy_n, -(sin * fx_n + cos * fy_n)]
}

/// The sensor's axes of a shear that a person intends on the screen's: the inverse of [`on_screen`].
#[cfg(test)]
pub(in super::super) fn off_screen(config: &Config, [x_n, y_n]: [f64; 2]) -> [f64; 2] {
    let (sin, cos) = config.turn_deg.to_radians().sin_cos();
    let fx_n = cos * x_n - sin * y_n;
    [if config.mirror_x { -fx_n } else { fx_n }, -(sin * x_n + cos * y_n)]
}

/// A step of at most the cap in `dt_s`, px.
pub(super) fn capped_px(config: &Config, step_px: [f64; 2], dt_s: f64) -> [f64; 2] {
    debug_assert!(config.mode == Mode::Position);
    let (size_px, most_px) = (step_px[0].hypot(step_px[1]), config.cap_px_per_s * dt_s);
    if size_px <= most_px { step_px } else { step_px.map(|part| part / size_px * most_px) }
}

/// How far a shear is beyond the zone, newtons, and its direction.
fn beyond(zone_n: f64, shear_n: [f64; 2]) -> (f64, [f64; 2]) {
    let size_n = shear_n[0].hypot(shear_n[1]);
    if size_n <= zone_n { (0.0, [0.0; 2]) } else { (size_n - zone_n, shear_n.map(|part| part / size_n)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zone_knee_and_cap() {
        let config = Config {
            dead_zone_n: 0.5,
            gain_low_px_per_s_per_n: 100.0,
            gain_high_px_per_s_per_n: 1000.0,
            knee_n: 0.25,
            cap_px_per_s: 500.0,
            ..Config::default()
        };
        let speed = |shear: f64| velocity_px_per_s(&config, [shear, 0.0])[0];
        assert_eq!([0.0, 0.5, 0.75, 1.0, 5.0].map(speed), [0.0, 0.0, 25.0, 275.0, 500.0]);
        assert_eq!([-0.5, -0.75, -9.0].map(speed), [0.0, -25.0, -500.0]);
        let slant = velocity_px_per_s(&config, [0.6, 0.8]);
        assert!((slant[0] - 165.0).abs() <= 1e-9 && (slant[1] - 220.0).abs() <= 1e-9, "{slant:?}");
        for beyond_n in [0.0, 0.1, 0.25, 0.3, 0.4] {
            assert!((shear_for_n(&config, speed_px_per_s(&config, beyond_n)) - beyond_n).abs() <= 1e-12);
        }
    }

    #[test]
    fn screens_count_down_and_sensors_may_be_turned() {
        let config = Config::default();
        assert_eq!(on_screen(&config, [1.0, 2.0]), [1.0, -2.0]);
        assert_eq!(on_screen(&Config { mirror_x: true, ..config }, [1.0, 2.0]), [-1.0, -2.0]);
        let turned = on_screen(&Config { turn_deg: 90.0, ..config }, [1.0, 0.0]);
        assert!(turned[0].abs() <= 1e-15 && (turned[1] + 1.0).abs() <= 1e-15, "{turned:?}");
        for (turn_deg, mirror_x) in [(0.0, false), (30.0, true), (-120.0, false)] {
            let config = Config { turn_deg, mirror_x, ..config };
            let back = off_screen(&config, on_screen(&config, [0.3, -0.7]));
            assert!((back[0] - 0.3).abs() <= 1e-15 && (back[1] + 0.7).abs() <= 1e-15, "{back:?}");
        }
    }

    #[test]
    fn nothing_overflows() {
        let config = Config { gain_high_px_per_s_per_n: 1e6, ..Config::default() };
        for size in [1e3, 1e-300, 5e-324] {
            let speed = velocity_px_per_s(&config, [size, -size]);
            assert!(speed.iter().all(|part| part.abs() <= config.cap_px_per_s), "{speed:?}");
        }
    }
}
