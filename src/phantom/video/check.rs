//! Whether a video can be made as requested; all faults are reported together, by the command line's names.

use super::{Coding, Faults, Oblique, VideoOptions};
use crate::phantom::motion::finger::Finger;
use crate::phantom::scene::lens::{MOST_TILT_DEG, Mapping};

impl VideoOptions {
    /// Can this video be made?
    pub fn check(&self) -> Result<(), Faults> {
        let mut faults = Faults::default();
        let size = format!("{}x{}", self.width, self.height);
        let sides = [self.width, self.height];
        faults.need(sides.iter().all(|side| (32..=8192).contains(side)), || {
            format!("--size {size}: sides from 32 to 8192 pixels can be drawn")
        });
        let stored = self.format();
        let (across, down) = stored.subsampling.unwrap_or((1, 1));
        faults.need(stored.width.is_multiple_of(across) && stored.height.is_multiple_of(down), || {
            format!("--size {size}: this chroma needs even sides; choose them or --format 444")
        });
        faults.range("--fps", self.fps, 1.0, 1000.0, " frames a second");
        faults.range("--seconds", self.seconds, 0.0, 36000.0, " s");
        faults.range("--vfr", self.jitter, 0.0, 0.9, " of an interval");
        faults.range("--sway", self.sway_px, 0.0, 0.25 * self.width as f64, " px");
        faults.range("--blur", self.blur, 0.0, 1.0, " of the frame interval");
        let interval_ms = 1e3 * (1.0 - self.jitter) / self.fps;
        faults.range("--readout", 1e3 * self.readout_s, 0.0, interval_ms, " ms, the least interval between frames");
        faults.range("--flicker", 100.0 * self.flicker, 0.0, 90.0, " %");
        faults.range("--flicker-hz", self.flicker_hz, 0.0, 1e5, " Hz");
        faults.range("--gradient", 100.0 * self.gradient, 0.0, 90.0, " %");
        faults.range("--focus", self.focus_px, 0.3, 20.0, " px");
        faults.range("--noise", self.noise_sd, 0.0, 128.0, " of 255");
        faults.range("--crf", f64::from(self.crf), 0.0, 51.0, "");
        faults.0.extend(self.trajectory.fault());
        faults.need(self.frames() > 0, || format!("--seconds {}: less than a frame", self.seconds));
        faults.need([8, 10].contains(&self.depth), || format!("--depth {}: choose 8 or 10", self.depth));
        faults.need(Coding::PRESETS.contains(&self.preset), || {
            format!("--x264 {}: choose one of {}", self.preset, Coding::PRESETS.join(", "))
        });
        let (parts, finger) =
            (Finger::new(self.width, self.height, self.finger.flexion, self.finger.layout), &self.finger);
        let whole = finger.lengths_px.len() >= parts.lengths_px.len()
            && finger.half_widths_px.len() >= parts.half_widths_px.len();
        faults.need(whole, || "--layout: this finger has no thumb; start from one of this layout".to_owned());
        let names = self.finger.layout.names();
        let frames = self.frames();
        let beyond = |text: &str| match frames.checked_sub(1) {
            Some(last) => format!("{text}: the video has frames 0 to {last}"),
            None => format!("{text}: the video has no frames"),
        };
        for hide in &self.hide {
            let text = format!("--hide {}@{}+{}", hide.marker, hide.frame, hide.frames);
            faults.need(names.contains(&hide.marker), || {
                format!("{text}: no marker of this name; there are {}", names.join(", "))
            });
            faults.need(hide.frames > 0 && hide.frame < frames, || beyond(&text));
        }
        if let Some(leave) = self.leave {
            let text = format!("--leave {}+{}", leave.frame, leave.frames);
            faults.need(leave.frames > 0 && leave.frame < frames, || beyond(&text));
        }
        let known: Vec<&str> = self.finger.layout.joints().into_iter().map(|(joint, _)| joint).collect();
        for joint in &self.joints {
            faults.need(known.contains(&joint.as_str()), || match &known[..] {
                [] => format!("--joints {joint}: a single mark has no joints"),
                known => format!("--joints {joint}: there are {}", known.join(", ")),
            });
        }
        faults.need(!self.joints.is_empty() || known.is_empty(), || "--joints: name at least one".to_owned());
        if let Some(clock) = &self.clock {
            faults.0.extend(clock.fault().map(|fault| format!("--clock {}: {fault}", clock.format)));
            faults.range("--clock-delay", 1e3 * clock.delay_s, 0.0, 1000.0, " ms");
            if let Some(hz) = clock.refresh_hz {
                faults.need(hz.is_finite() && hz > 0.0, || format!("--clock-refresh {hz}: choose more than 0 Hz"));
            }
            let hidden = self
                .screen
                .hide
                .iter()
                .map(|&[frame, count]| (format!("--clock-hide {frame}+{count}"), count > 0 && frame < frames));
            let stops = self.screen.stop.iter().map(|&frame| (format!("--clock-stop {frame}"), frame < frames));
            let jumps =
                self.screen.jump.iter().map(|&(frame, by_s)| {
                    (format!("--clock-jump {frame}{by_s:+}"), frame < frames && by_s.abs() < 1e9)
                });
            for (text, holds) in hidden.chain(stops).chain(jumps) {
                faults.need(holds, || beyond(&text));
            }
            faults.need(clock.offset_s.is_finite() && clock.offset_s.abs() < 1e9, || {
                format!("--clock-offset {}: choose seconds within a thousand million", clock.offset_s)
            });
            faults.need(clock.drift_ppm.abs() < 1e6, || format!("--clock-drift-ppm {}: choose less", clock.drift_ppm));
            let [x, y, w, h] = self.clock_roi_px(clock);
            faults.need(w >= 8 && h >= 8 && x + w <= self.width && y + h <= self.height, || {
                format!("--clock-roi {x},{y},{w},{h}: not within {size}, or smaller than 8 pixels")
            });
        }
        if let Some(lens) = &self.lens {
            faults.need(lens.distortion.len() <= 8 && lens.distortion.iter().all(|k| k.is_finite()), || {
                "--distortion: up to eight numbers k1,k2,p1,p2,k3,k4,k5,k6".to_owned()
            });
            faults.need(lens.fx_px.is_none_or(|fx| fx.is_finite() && fx > 0.0), || {
                "--fx: choose more than 0 px".to_owned()
            });
            let mapping = Mapping::new(lens, self.width, self.height);
            let corners = [[0, 0], [sides[0], 0], [0, sides[1]], sides].map(|c| c.map(|v| v as f64));
            faults.need(corners.into_iter().all(|corner| mapping.straight(corner).is_some()), || {
                format!("--distortion {:?}: so strong that the picture folds over; choose less", lens.distortion)
            });
        }
        if let Some(plane) = self.plane {
            let known = (0.0..=MOST_TILT_DEG).contains(&plane.tilt_deg) && plane.towards_deg.abs() <= 360.0;
            faults.need(known, || {
                let Oblique { tilt_deg, towards_deg } = plane;
                format!("--plane {tilt_deg},{towards_deg}: choose a tilt of 0 to {MOST_TILT_DEG}, towards -360 to 360")
            });
        }
        faults.none()
    }
}
