//! Whether a trajectory can be made as requested; all faults are reported at once, by the command line's names.

use super::{Kind, TrajectoryOptions};

/// More rows than anybody plays.
const MOST_ROWS: f64 = 2e7;

/// All that is wrong; nothing where it can be made.
pub(super) fn faults(options: &TrajectoryOptions) -> Vec<String> {
    let mut faults = Vec::new();
    let mut ranged = |option: &str, value: f64, low: f64, high: f64, unit: &str| {
        if !(low..=high).contains(&value) {
            faults.push(format!("{option} {value}: choose {low} to {high}{unit}"));
        }
    };
    ranged("--seconds", options.seconds, 1.0, 1e6, " s");
    ranged("--lead", options.lead_s, 0.0, 1e6, " s");
    ranged("--trail", options.trail_s, 0.0, 1e6, " s");
    if options.is_force() {
        ranged("--fz-max", options.fz_max_n, 0.01, 100.0, " N");
        ranged("--mu", options.mu, 0.01, 10.0, "");
        ranged("--error", 100.0 * options.error, 0.1, 1000.0, " %");
    }
    ranged("--tau", options.tau_s, 0.001, 1000.0, " s");
    match options.kind {
        Kind::Force { fs_per_n, fc_hz } => {
            ranged("--fs", fs_per_n, 0.01, 100.0, " cycles a newton");
            ranged("--fc", fc_hz, 0.001, 10.0, " Hz");
        }
        Kind::Random { hz, .. } | Kind::Posture { hz, .. } => ranged("--hz", hz, 0.001, 10.0, " Hz"),
    }
    ranged("--soft-start", options.soft_s, 0.0, 1e6, " s");
    if options.soft_s > options.seconds && options.soft_s <= 1e6 {
        faults.push(format!("--soft-start {}: longer than the {} s of --seconds", options.soft_s, options.seconds));
    }
    let whole_s = options.whole_s();
    if !(options.every_s > 0.0 && options.every_s.is_finite()) {
        faults.push(format!("--every {}: choose more than 0 s, as 0.04", options.every_s));
    } else if options.every_s > options.seconds {
        faults.push(format!("--every {}: longer than the {} s of --seconds", options.every_s, options.seconds));
    } else if whole_s.is_finite() && options.rows() > MOST_ROWS {
        faults.push(format!(
            "--every {}: {:.3e} rows; choose {:.1e} s or more, which makes {MOST_ROWS:.0e} rows at most",
            options.every_s,
            options.rows(),
            // Rounded up in its second digit.
            1.05 * whole_s / MOST_ROWS
        ));
    }
    faults
}
