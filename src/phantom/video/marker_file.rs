//! The marker file of a scene, as `lunula posture` reads it.

use super::Scene;

/// Seconds in milliseconds, without what rounding leaves.
fn in_ms(seconds: f64) -> f64 {
    (1e9 * seconds).round() / 1e6
}

impl Scene {
    /// The marker file of this scene.
    #[must_use]
    pub fn markers_toml(&self) -> String {
        let options = &self.options;
        let finger = &options.finger;
        let mut text = format!("flexion = \"{}\"\n", finger.flexion.name());
        if options.readout_s > 0.0 {
            text += &format!("readout_ms = {:?}\n", in_ms(options.readout_s));
        }
        text += "\n[markers]\n";
        for marker in &self.markers {
            text += &format!("{} = \"#{:06x}\"\n", marker.name, marker.colour);
        }
        let segments = finger.layout.segments();
        if !segments.is_empty() {
            text += "\n[segments]\n";
        }
        for (name, ends) in &segments {
            let [first, last] = ends.map(|marker| &self.markers[marker].name);
            text += &format!("{name} = [\"{first}\", \"{last}\"]\n");
        }
        let mut joints = finger.layout.joints();
        joints.retain(|(joint, _)| options.joints.iter().any(|wanted| wanted == joint));
        if !joints.is_empty() {
            text += "\n[joints]\n";
        }
        for (joint, between) in joints {
            let [first, last] = between.map(|segment| segments[segment].0);
            text += &format!("{joint} = [\"{first}\", \"{last}\"]\n");
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
            if clock.delay_s > 0.0 {
                text += &format!("delay_ms = {:?}\n", in_ms(clock.delay_s));
            }
        }
        if let Some(mapping) = &self.mapping {
            let mut distortion = options.lens.as_ref().map_or(Vec::new(), |lens| lens.distortion.clone());
            // OpenCV's models have 4, 5 or 8 coefficients; those that weren't given are 0.
            let count = distortion.len();
            distortion.resize([0, 4, 5, 8].into_iter().find(|&model| model >= count).unwrap_or(count), 0.0);
            text += &format!("\n[camera]\nfx = {:?}\ndistortion = {distortion:?}\n", mapping.fx_px());
        }
        if let Some(plane) = options.plane {
            text += &format!("\n[camera.plane]\nnormal = {:?}\n", plane.normal());
        }
        text
    }
}
