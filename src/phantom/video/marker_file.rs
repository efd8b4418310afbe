//! The marker file of a scene, as `lunula posture` reads it.

use super::Scene;
use crate::phantom::finger::{JOINTS, SEGMENTS};

impl Scene {
    /// The marker file of this scene.
    #[must_use]
    pub fn markers_toml(&self) -> String {
        let options = &self.options;
        let finger = &options.finger;
        let mut text = format!("flexion = \"{}\"\n\n[markers]\n", finger.flexion.name());
        for marker in &self.markers {
            text += &format!("{} = \"#{:06x}\"\n", marker.name, marker.colour);
        }
        text += "\n[segments]\n";
        for (segment, name) in SEGMENTS.iter().enumerate() {
            let [first, last] = finger.layout.ends(segment).map(|marker| &self.markers[marker].name);
            text += &format!("{name} = [\"{first}\", \"{last}\"]\n");
        }
        text += "\n[joints]\n";
        for (k, joint) in JOINTS.iter().enumerate().filter(|(_, joint)| options.joints.iter().any(|j| j == *joint)) {
            text += &format!("{joint} = [\"{}\", \"{}\"]\n", SEGMENTS[k], SEGMENTS[k + 1]);
        }
        if options.start {
            text += "\n[start]\n";
            for (marker, truth) in self.markers.iter().zip(self.truth(0).markers) {
                text += &format!("{} = [{:.1}, {:.1}]\n", marker.name, truth.at_px[0], truth.at_px[1]);
            }
        }
        if let Some(clock) = &options.clock {
            let roi = format!("{:?}", options.clock_roi_px(clock));
            let roi = if options.clock_roi_auto { "\"auto\"".to_owned() } else { roi };
            text += &format!("\n[clock]\nroi = {roi}\nformat = \"{}\"\n", clock.format);
            // TOML knows infinity: a screen that changes at once.
            text += &format!("refresh_hz = {:?}\n", clock.refresh_hz.unwrap_or(f64::INFINITY));
        }
        if let (Some(lens), Some(mapping)) = (&options.lens, &self.mapping) {
            text += &format!("\n[camera]\nfx = {:?}\ndistortion = {:?}\n", mapping.fx_px, lens.distortion);
        }
        text
    }
}
