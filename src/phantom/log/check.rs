//! Whether a log can be made as requested; all faults are reported together, by the command line's names.

use super::angles::FPS;
use super::{Faults, LogOptions, SensorModel};
use crate::phantom::motion::force::ForceTrajectory;
use crate::phantom::motion::trajectory::Trajectory;
use crate::phantom::sensor::CHANNELS;
use crate::words::Words;

/// More rows than anybody reads.
const MOST_ROWS: f64 = 2e7;

impl LogOptions {
    /// Can this log be made?
    pub fn check(&self) -> Result<(), Faults> {
        let mut faults = Faults::default();
        faults.range("--seconds", self.seconds, 0.0, 1e6, " s");
        faults.range("--lead", self.lead_s, -1e6, 1e6, " s");
        faults.range("--trail", self.trail_s, -1e6, 1e6, " s");
        faults.range("--rate", self.rate_hz, 0.01, 1e5, " samples a second");
        faults.range("--clock-offset", self.clock_offset_s, -1e9, 1e9, " s");
        faults.range("--clock-drift-ppm", self.clock_drift_ppm, -5e5, 5e5, " millionths");
        faults.range("--jitter", self.jitter_s, 0.0, 1e3, " s");
        faults.range("--stamp-step", self.stamp_step_s, 0.0, 1e3, " s");
        faults.range("--drop", self.dropped, 0.0, 1.0, " of the rows");
        faults.range("--noise", self.noise_sd_v, 0.0, 10.0, " V");
        faults.range("--ambient", self.ambient_v, 0.0, 10.0, " V");
        faults.range("--ambient-swing", 100.0 * self.ambient_swing, 0.0, 100.0, " %");
        faults.range("--hum", self.hum_hz, 0.0, 1e5, " Hz");
        faults.range("--wander", self.wander_v, 0.0, 10.0, " V");
        let worn = self.disturbances;
        faults.range("--pulse", worn.pulse_v, 0.0, 1.0, " V");
        faults.range("--bumps", worn.bump_v, 0.0, 10.0, " V");
        faults.range("--bumps-per-hour", worn.bumps_per_hour, 0.0, 1800.0, ", a bump takes up to a second");
        faults.range("--elevation", worn.elevation_v, 0.0, 1.0, " V");
        faults.range("--drift", worn.drift_v, 0.0, 1.0, " V");
        faults.range("--lag", self.dynamics.lag, 0.0, 100.0, " of the usual");
        faults.range("--hysteresis", self.dynamics.hysteresis, 0.0, 10.0, " of the usual");
        faults.range("--follow", self.follow, 0.0, 0.4, ", the standard deviation as a share");
        faults.range("--posture-shift", self.posture_shift_rad.to_degrees(), 0.0, 30.0, " degrees");
        if let Some(from_s) = self.touch_from_s {
            faults.range("--touch-from", from_s, 0.0, 1e6, " s");
        }
        faults.0.extend(self.trajectory.fault());
        match &self.force {
            ForceTrajectory::None => {}
            ForceTrajectory::Presses(presses) => {
                let holds = presses.held_s >= 0.2 && presses.pause_s >= 0.1 && presses.peak_n >= 0.0;
                let finite = presses.held_s + presses.pause_s + presses.peak_n + presses.first_s;
                faults.need(holds && finite.is_finite(), || {
                    "presses: hold at least 0.2 s, pause at least 0.1 s, press with 0 N or more".to_owned()
                });
            }
            ForceTrajectory::Spiral(spiral) => {
                let seconds = spiral.duration_s;
                let holds = seconds.is_finite() && seconds > 0.0;
                faults.need(holds, || format!("--spiral-seconds {seconds}: choose more than 0 s"));
                faults.need(self.trajectory == Trajectory::Rest || self.touch_from_s.is_some(), || {
                    "--force spiral: the finger rests while it spirals; leave --trajectory out or choose rest, or say \
                     --touch-from"
                        .to_owned()
                });
            }
            ForceTrajectory::Contacts(contacts) => {
                let pause_s = contacts.pause_s;
                faults.need((0.1..=3600.0).contains(&pause_s), || format!("--pause {pause_s}: choose 0.1 to 3600 s"));
                let twice = (1..contacts.kinds.len()).find(|&k| contacts.kinds[..k].contains(&contacts.kinds[k]));
                let twice = twice.map(|k| contacts.kinds[k].word());
                faults.0.extend(twice.map(|kind| format!("--kinds: {kind} is named twice; name it once")));
                faults.need(self.follow == 0.0 && self.touch_from_s.is_none(), || {
                    "--follow, --touch-from: a finger that makes contacts of its own accord follows no prompt; leave \
                     them out"
                        .to_owned()
                });
            }
            ForceTrajectory::Random { hz, .. }
            | ForceTrajectory::Even { hz, .. }
            | ForceTrajectory::Cycles { hz, .. } => {
                faults.need((0.0..=100.0).contains(hz), || format!("--force-hz {hz}: choose 0 to 100 Hz"));
            }
        }
        faults.need(self.touch_from_s.is_none() || self.force != ForceTrajectory::None, || {
            "--touch-from: nothing is touched; choose --force spiral or random".to_owned()
        });
        let (begin_s, end_s) = (-self.lead_s, self.seconds + self.trail_s);
        if let Some(jump) = self.clock_jump {
            let named = || format!("--clock-jump {}{:+}", jump.at_s, jump.by_s);
            faults.need(jump.by_s.abs() <= 1e9, || format!("{}: choose seconds within a thousand million", named()));
            let within = jump.at_s > begin_s && jump.at_s <= end_s;
            faults.need(within, || format!("{}: the log is of {begin_s} to {end_s} s of the video's time", named()));
        }
        for &[from_s, length_s] in &self.gaps_s {
            let holds = from_s.is_finite() && length_s.is_finite() && length_s > 0.0;
            let named = || format!("--gap {from_s}+{length_s}");
            faults.need(holds, || format!("{}: choose a beginning and a length of more than 0 s", named()));
            let within = !holds || from_s <= end_s && from_s + length_s > begin_s;
            faults.need(within, || format!("{}: the log is of {begin_s} to {end_s} s of the video's time", named()));
        }
        for photodiode in &self.dead {
            let holds = (1..=self.channels()).contains(photodiode);
            faults.need(holds, || format!("--dead P{photodiode}: there are P1 to P{}", self.channels()));
        }
        if let Some(positions) = &self.positions {
            let count = positions.photodiodes.len();
            faults.need(self.sensor == SensorModel::Nail, || {
                "--positions: formulae have places of their own; choose --sensor nail".to_owned()
            });
            faults.need(count <= CHANNELS, || {
                format!("--positions: {count} photodiodes; a log has at most {CHANNELS}, leave some out")
            });
            let taken = |name: &str| ["time_s", "time", "led", "contact", "Fx_N", "Fy_N", "Fz_N"].contains(&name);
            for place in &positions.photodiodes {
                faults.need(!taken(&place.name), || {
                    format!("--positions: {} is another column of a log; choose another name", place.name)
                });
            }
            faults.need(count >= 3 || !self.saturate, || {
                "--saturate: amplifies the second and third photodiode, and there are fewer".to_owned()
            });
        }
        let span_s = self.lead_s + self.seconds + self.trail_s;
        faults.need(span_s > 0.0, || format!("--lead {}: the log ends before it begins", self.lead_s));
        faults.need(span_s * self.rate_hz <= MOST_ROWS, || {
            format!("--rate {}: more than {MOST_ROWS} samples; choose fewer", self.rate_hz)
        });
        faults.need(self.seconds * FPS <= MOST_ROWS, || {
            format!("--seconds {}: more than {MOST_ROWS} rows of angles, {FPS} a second; choose fewer", self.seconds)
        });
        faults.none()
    }
}
