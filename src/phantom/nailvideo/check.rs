//! Whether a video of a nail can be made as requested; all faults are reported together, by the command line's names.

use super::{Faults, NailVideoOptions};
use crate::phantom::sensor::person;

/// More frames than anybody reads.
const MOST_FRAMES: f64 = 200_000.0;
/// The light above which a light skin would come near full scale.
const MOST_LEVEL: f64 = 1.4;

impl NailVideoOptions {
    /// Can this video be made?
    pub fn check(&self) -> Result<(), Faults> {
        let mut faults = Faults::default();
        let (width, height) = self.size;
        let even = [width, height].iter().all(|side| (64..=4096).contains(side) && side.is_multiple_of(2));
        faults.need(even, || format!("--size {width}x{height}: choose even sides from 64 to 4096 pixels"));
        faults.range("--fps", self.fps, 1.0, 1000.0, " frames a second");
        faults.range("--seconds", self.seconds(), 0.0, 36000.0, " s");
        faults.range("--press", self.press_n, 0.0, 20.0, " N");
        faults.range("--held", self.held_s, 0.2, 3600.0, " s");
        faults.range("--pause", self.pause_s, 0.1, 3600.0, " s");
        faults.range("--nail-px", self.nail_px, 12.0, 2000.0, " px");
        faults.range("--drift", self.drift_px, 0.0, 0.25 * f64::from(width.min(height)), " px");
        faults.range("--turn", self.turn_deg, 0.0, 45.0, " degrees");
        faults.range("--scale", self.scale_percent, 0.0, 20.0, " %");
        faults.range("--tilt", self.tilt_percent, 0.0, 20.0, " %");
        faults.range("--jerk", self.jerk_px, 0.0, 0.1 * f64::from(width.min(height)), " px a frame");
        faults.range("--level", self.level, 0.1, MOST_LEVEL, " times the chamber's light");
        faults.range("--gradient", self.gradient_percent, 0.0, 60.0, " %");
        faults.range("--light-drift", self.light_drift_percent, 0.0, 60.0, " %");
        faults.range("--flicker", self.flicker_percent, 0.0, 60.0, " %");
        faults.range("--flicker-hz", self.flicker_hz, 0.0, 1e5, " Hz");
        faults.range("--colour-drift", self.colour_drift_percent, 0.0, 60.0, " %");
        faults.range("--glare", self.glare_percent, 0.0, 100.0, " %");
        faults.range("--blur", self.blur, 0.0, 1.0, " of the frame interval");
        faults.range("--noise", self.noise, 0.0, 100.0, " 255ths");
        faults.need(self.normalized_every != Some(0), || "--normalized 0: choose 1 or more frames".to_owned());
        faults.need(self.crf <= 51, || format!("--crf {}: choose 0 to 51", self.crf));
        faults.need(self.seconds() * self.fps <= MOST_FRAMES, || {
            format!("--seconds {}: more than {MOST_FRAMES} frames; choose fewer", self.seconds())
        });
        let aspect = person(self.subject).nail.aspect;
        let fits = self.nail_px <= 0.9 * f64::from(width) && self.nail_px * aspect <= 0.9 * f64::from(height);
        faults.need(fits, || {
            format!(
                "--nail-px {}: this person's nail is {:.2} times as long as wide and would fill more than nine \
                 tenths of {width}x{height}; choose less",
                self.nail_px, aspect
            )
        });
        let frames = self.frames();
        let named = [("--rod", &self.rod), ("--finger", &self.finger), ("--cut", &self.cut)];
        let spans = named.into_iter().flat_map(|(option, spans)| spans.iter().map(move |span| (option, span)));
        for (option, [frame, count]) in spans.chain(self.leave.iter().map(|span| ("--leave", span))) {
            faults.need(*count > 0 && *frame < frames, || {
                format!("{option} {frame}+{count}: the video has frames 0 to {}", frames - 1)
            });
        }
        faults.need(self.cut.iter().chain(&self.leave).all(|[frame, _]| *frame > 0), || {
            "--cut, --leave: the nail is in frame 0, where its outline is; begin later".to_owned()
        });
        if faults.0.is_empty()
            && let Err(log) = self.log().check()
        {
            faults.0.extend(log.0);
        }
        faults.none()
    }
}
