//! A finger in side view: where its bones and markers lie on the picture (section 3.2.3).
//!
//! In: joint angles. Out: the [`Posture`] of a [`Finger`]: its bones' ends and its markers' centres.
//!
//! Conventions: picture coordinates are x right, y down, pixels; a segment's direction grows clockwise on the picture; joint
//! angles are radians, positive in flexion, J1 MP, J2 PIP, J3 DIP.

use serde::Serialize;

use crate::flexion::Flexion;

/// The segments' names, proximal first.
pub const SEGMENTS: [&str; 4] = ["hand", "proximal", "middle", "distal"];
/// The joints' names, proximal first; joint k lies between segments k and k + 1.
pub const JOINTS: [&str; 3] = ["J1", "J2", "J3"];

/// Where the markers are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum MarkerLayout {
    /// Two on each segment, near its joints.
    Pairs,
    /// One on each joint and at both ends; neighbouring segments share it.
    Joints,
}

impl MarkerLayout {
    /// The markers' names, proximal first.
    #[must_use]
    pub fn names(self) -> Vec<String> {
        match self {
            Self::Pairs => SEGMENTS.iter().flat_map(|s| [format!("{s}_prox"), format!("{s}_dist")]).collect(),
            Self::Joints => ["hand", "mp", "pip", "dip", "tip"].map(str::to_owned).to_vec(),
        }
    }

    /// Which two markers, proximal first, lie on segment `segment`.
    #[must_use]
    pub fn ends(self, segment: usize) -> [usize; 2] {
        match self {
            Self::Pairs => [2 * segment, 2 * segment + 1],
            Self::Joints => [segment, segment + 1],
        }
    }
}

/// A finger's shape and where it is held.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Finger {
    /// From marker to marker of each segment.
    pub lengths_px: [f64; 4],
    /// From a joint to the markers next to it; no matter for [`MarkerLayout::Joints`].
    pub gap_px: f64,
    /// From the last marker to the middle of the fingertip's round end.
    pub tip_px: f64,
    /// Half the limb's width at the wrist, J1, J2, J3 and the tip.
    pub half_widths_px: [f64; 5],
    /// Radius of a marker.
    pub marker_px: f64,
    /// Where J1 lies.
    pub knuckle_px: [f64; 2],
    /// The hand's direction.
    pub hand_rad: f64,
    /// How flexion turns.
    pub flexion: Flexion,
    /// Where the markers are.
    pub layout: MarkerLayout,
}

/// Where a finger's parts lie at one moment.
#[derive(Debug, Clone, PartialEq)]
pub struct Posture {
    /// The wrist, J1, J2, J3 and the middle of the fingertip's round end.
    pub bones_px: [[f64; 2]; 5],
    /// The markers' centres in the order of [`MarkerLayout::names`].
    pub markers_px: Vec<[f64; 2]>,
}

impl Finger {
    /// The finger of the prototype's scenes, for a picture of this size: lengths of 100, 122, 87, 61 pixels and markers of
    /// 10.5 pixels' radius where it is 1280 wide.
    #[must_use]
    pub fn new(width: usize, height: usize, flexion: Flexion, layout: MarkerLayout) -> Self {
        let scale = width as f64 / 1280.0;
        let down = if flexion == Flexion::Clockwise { 0.37 } else { 0.63 };
        Self {
            lengths_px: [100.0, 122.0, 87.0, 61.0].map(|length| length * scale),
            gap_px: 22.0 * scale,
            tip_px: 20.0 * scale,
            half_widths_px: [50.0, 41.0, 33.0, 28.0, 23.0].map(|half| half * scale),
            marker_px: 10.5 * scale,
            knuckle_px: [0.36 * width as f64, down * height as f64],
            hand_rad: -8f64.to_radians() * flexion.sign(),
            flexion,
            layout,
        }
    }

    /// The directions of the segments for joint angles, radians.
    #[must_use]
    pub fn directions_rad(&self, angles_rad: [f64; 3]) -> [f64; 4] {
        let mut directions = [self.hand_rad; 4];
        for (k, angle) in angles_rad.into_iter().enumerate() {
            directions[k + 1] = directions[k] + self.flexion.sign() * angle;
        }
        directions
    }

    /// The finger with these joint angles, moved by `shift_px`.
    #[must_use]
    pub fn posture(&self, angles_rad: [f64; 3], shift_px: [f64; 2]) -> Posture {
        let units = self.directions_rad(angles_rad).map(|direction| [direction.cos(), direction.sin()]);
        let along = |from: [f64; 2], segment: usize, px: f64| {
            [from[0] + px * units[segment][0], from[1] + px * units[segment][1]]
        };
        let gap = if self.layout == MarkerLayout::Pairs { self.gap_px } else { 0.0 };
        let mut bones = [[self.knuckle_px[0] + shift_px[0], self.knuckle_px[1] + shift_px[1]]; 5];
        let mut markers = Vec::with_capacity(8);
        markers.push(along(bones[1], 0, -gap - self.lengths_px[0]));
        if self.layout == MarkerLayout::Pairs {
            markers.push(along(bones[1], 0, -gap));
        }
        // The wrist lies far outside of the picture: the hand goes on.
        bones[0] = along(bones[1], 0, -20.0 * self.lengths_px[0]);
        for segment in 1..4 {
            let joint = bones[segment];
            let first = along(joint, segment, gap);
            let last = along(first, segment, self.lengths_px[segment]);
            markers.push(first);
            if self.layout == MarkerLayout::Pairs {
                markers.push(last);
            }
            bones[segment + 1] = along(last, segment, if segment == 3 { self.tip_px } else { gap });
            if self.layout == MarkerLayout::Joints && segment == 3 {
                markers.push(last);
            }
        }
        Posture { bones_px: bones, markers_px: markers }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markers_lie_a_length_apart_and_their_directions_differ_by_the_angles() {
        for (layout, flexion) in
            [(MarkerLayout::Pairs, Flexion::Clockwise), (MarkerLayout::Joints, Flexion::Counterclockwise)]
        {
            let finger = Finger::new(1280, 720, flexion, layout);
            let angles = [0.3, 1.1, 0.7];
            let markers = finger.posture(angles, [3.0, -2.0]).markers_px;
            assert_eq!(markers.len(), layout.names().len());
            let directions: Vec<f64> = (0..4)
                .map(|segment| {
                    let [a, b] = layout.ends(segment).map(|marker| markers[marker]);
                    assert!(((b[0] - a[0]).hypot(b[1] - a[1]) - finger.lengths_px[segment]).abs() < 1e-9);
                    (b[1] - a[1]).atan2(b[0] - a[0])
                })
                .collect();
            for (joint, angle) in angles.into_iter().enumerate() {
                assert!((flexion.sign() * (directions[joint + 1] - directions[joint]) - angle).abs() < 1e-9);
            }
        }
    }
}
