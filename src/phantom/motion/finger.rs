//! A finger in side view: where its bones and markers lie on the picture (section 3.2.3).
//!
//! In: joint angles. Out: the [`Posture`] of a [`Finger`]: its bones' ends and its markers' centres.
//!
//! Conventions: picture coordinates are x right, y down, pixels; a segment's direction grows clockwise on the picture;
//! joint angles are radians, positive in flexion, J1 MP, J2 PIP, J3 DIP.

use serde::Serialize;

use crate::flexion::Flexion;

/// The joints' names, proximal first; joint k lies between segments k and k + 1.
pub const JOINTS: [&str; 3] = ["J1", "J2", "J3"];

/// The index finger's segments, proximal first, then the thumb's.
const SEGMENTS: [&str; 7] = ["hand", "proximal", "middle", "distal", "thumb_hand", "thumb_proximal", "thumb_distal"];
/// The index finger's joints, then the thumb's.
const ALL_JOINTS: [&str; 5] = ["J1", "J2", "J3", "T1", "T2"];
/// Which segments they lie between.
const JOINED: [[usize; 2]; 5] = [[0, 1], [1, 2], [2, 3], [4, 5], [5, 6]];
/// The marks of paint, and which two of them lie on each segment.
const MARKS: [&str; 8] =
    ["wrist", "index_mp", "index_pip", "index_dip", "index_tip", "thumb_mp", "thumb_ip", "thumb_tip"];
const MARKS_ON: [[usize; 2]; 7] = [[0, 1], [1, 2], [2, 3], [3, 4], [0, 5], [5, 6], [6, 7]];

/// Where the markers are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum MarkerLayout {
    /// Two on each segment, near its joints.
    Pairs,
    /// One on each joint and at both ends; neighbouring segments share it.
    Joints,
    /// Eight marks of paint on the joints of index finger and thumb, whose chains meet at the wrist's mark.
    Paint,
    /// Of these, the thumb's four.
    Thumb,
    /// Of these, four in a row on the index finger: two joints.
    Row,
    /// Of these, a single one: no segments and no joints.
    Mark,
}

impl MarkerLayout {
    /// Whether marks of paint are drawn, not discs.
    #[must_use]
    pub fn painted(self) -> bool {
        !matches!(self, Self::Pairs | Self::Joints)
    }

    /// Of a painted layout, which of [`MARKS`].
    fn marks(self) -> &'static [usize] {
        match self {
            Self::Pairs | Self::Joints => &[],
            Self::Paint => &[0, 1, 2, 3, 4, 5, 6, 7],
            Self::Thumb => &[0, 5, 6, 7],
            Self::Row => &[1, 2, 3, 4],
            Self::Mark => &[2],
        }
    }

    /// The markers' names, proximal first.
    #[must_use]
    pub fn names(self) -> Vec<String> {
        match self {
            Self::Pairs => SEGMENTS[..4].iter().flat_map(|s| [format!("{s}_prox"), format!("{s}_dist")]).collect(),
            Self::Joints => ["hand", "mp", "pip", "dip", "tip"].map(str::to_owned).to_vec(),
            _ => self.marks().iter().map(|&mark| MARKS[mark].to_owned()).collect(),
        }
    }

    /// The segments that have both of their markers: which of [`SEGMENTS`], and its two markers, proximal first.
    fn whole(self) -> Vec<(usize, [usize; 2])> {
        let ends = |segment: usize| match self {
            Self::Pairs => (segment < 4).then_some([2 * segment, 2 * segment + 1]),
            Self::Joints => (segment < 4).then_some([segment, segment + 1]),
            _ => {
                let [first, last] = MARKS_ON[segment].map(|mark| self.marks().iter().position(|&m| m == mark));
                first.zip(last).map(|(first, last)| [first, last])
            }
        };
        (0..SEGMENTS.len()).filter_map(|segment| Some((segment, ends(segment)?))).collect()
    }

    /// The segments' names and which two markers, proximal first, lie on each.
    #[must_use]
    pub fn segments(self) -> Vec<(&'static str, [usize; 2])> {
        self.whole().into_iter().map(|(segment, ends)| (SEGMENTS[segment], ends)).collect()
    }

    /// The joints' names and which two of the [segments](Self::segments), proximal first, each lies between.
    #[must_use]
    pub fn joints(self) -> Vec<(&'static str, [usize; 2])> {
        let whole = self.whole();
        let at = |segment: usize| whole.iter().position(|&(s, _)| s == segment);
        let both = |[a, b]: [usize; 2]| Some([at(a)?, at(b)?]);
        ALL_JOINTS.into_iter().zip(JOINED).filter_map(|(joint, joined)| Some((joint, both(joined)?))).collect()
    }

    /// The marker nearest to the fingertip (the thumb's, where there is no other).
    #[must_use]
    pub fn tip(self) -> usize {
        if self == Self::Paint { 4 } else { self.names().len() - 1 }
    }

    /// The limb's bones: which two of [`Posture::bones_px`] each lies between.
    #[must_use]
    pub fn bones(self) -> &'static [[usize; 2]] {
        const BONES: [[usize; 2]; 7] = [[0, 1], [1, 2], [2, 3], [3, 4], [5, 6], [6, 7], [7, 8]];
        if self.painted() { &BONES } else { &BONES[..4] }
    }
}

/// A finger's shape and where it is held.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Finger {
    /// From marker to marker of each segment; with paint, the thumb's last three as well.
    pub lengths_px: Vec<f64>,
    /// From a joint to the markers next to it; no matter but for [`MarkerLayout::Pairs`].
    pub gap_px: f64,
    /// From the last marker to the middle of the fingertip's round end.
    pub tip_px: f64,
    /// Half the limb's width at the wrist, J1, J2, J3 and the tip; with paint, at the thumb's root, T1, T2 and tip as
    /// well.
    pub half_widths_px: Vec<f64>,
    /// Radius of a marker; of marks of paint, one within which each lies.
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

/// How the skin lies around a marker, whose place is the origin of both coordinates.
///
/// Over a bent joint, skin that was straight lies along an arc through the marker's place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Skin {
    /// The direction of the finger there; over a joint, the mean of its two segments'.
    pub along_rad: f64,
    /// How fast that direction grows along the finger, radians a pixel.
    pub bend_per_px: f64,
}

impl Skin {
    /// Where a point of the straight skin (along the finger, across it clockwise) lies on the picture, relative to the
    /// marker, and how much larger the skin's area is there.
    #[must_use]
    pub fn shown(&self, [along, across]: [f64; 2]) -> ([f64; 2], f64) {
        let (sin, cos) = (self.bend_per_px * along).sin_cos();
        // By its series where the bend is too small to divide by.
        let flat = self.bend_per_px.abs() < 1e-9;
        let [x, y] = if flat { [along, 0.0] } else { [sin / self.bend_per_px, (1.0 - cos) / self.bend_per_px] };
        let [x, y] = [x - across * sin, y + across * cos];
        let (sin, cos) = self.along_rad.sin_cos();
        ([cos * x - sin * y, sin * x + cos * y], 1.0 - self.bend_per_px * across)
    }

    /// The point of the straight skin that lies there: [`Self::shown`] undone.
    #[must_use]
    pub fn material(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = self.along_rad.sin_cos();
        let [x, y] = [cos * x + sin * y, cos * y - sin * x];
        let [a, b] = [self.bend_per_px * x, 1.0 - self.bend_per_px * y];
        let along = if self.bend_per_px.abs() < 1e-9 { x } else { a.atan2(b) / self.bend_per_px };
        [along, (2.0 * y - self.bend_per_px * (x * x + y * y)) / (1.0 + a.hypot(b))]
    }
}

/// Where a finger's parts lie at one moment.
#[derive(Debug, Clone, PartialEq)]
pub struct Posture {
    /// The wrist, J1, J2, J3 and the middle of the fingertip's round end; with paint, then the thumb's root, T1, T2 and
    /// the middle of its end.
    pub bones_px: Vec<[f64; 2]>,
    /// The markers' centres in the order of [`MarkerLayout::names`].
    pub markers_px: Vec<[f64; 2]>,
    /// How the skin lies around each marker.
    pub skins: Vec<Skin>,
}

/// The thumb's direction from the wrist, from the hand's on.
const THUMB_RAD: f64 = 42.0 * std::f64::consts::PI / 180.0;
/// T1 and T2, radians, follow J2 and J3: at the straight finger, and by how much of them (assumed: a grip's).
const THUMB_FOLLOWS: [[f64; 2]; 2] = [[0.17, 0.30], [0.09, 0.50]];
/// The skin bends with a joint over so many half widths of the limb. Assumed.
const BENDING: f64 = 3.0;

impl Finger {
    /// The finger of the prototype's scenes, for a picture of this size: lengths of 100, 122, 87, 61 pixels and markers
    /// of 10.5 pixels' radius where it is 1280 wide; with paint, a hand of 150 pixels, and a thumb.
    #[must_use]
    pub fn new(width: usize, height: usize, flexion: Flexion, layout: MarkerLayout) -> Self {
        let scale = width as f64 / 1280.0;
        let down = if flexion == Flexion::Clockwise { 0.37 } else { 0.63 };
        let mut lengths_px = vec![100.0, 122.0, 87.0, 61.0];
        let mut half_widths_px = vec![50.0, 41.0, 33.0, 28.0, 23.0];
        if layout.painted() {
            lengths_px[0] = 150.0;
            lengths_px.extend([115.0, 86.0, 63.0]);
            half_widths_px.extend([44.0, 37.0, 31.0, 25.0]);
        }
        let scaled = |of: Vec<f64>| of.into_iter().map(|px| px * scale).collect();
        Self {
            lengths_px: scaled(lengths_px),
            gap_px: 22.0 * scale,
            tip_px: 20.0 * scale,
            half_widths_px: scaled(half_widths_px),
            marker_px: if layout.painted() { 22.0 } else { 10.5 } * scale,
            knuckle_px: [0.36 * width as f64, down * height as f64],
            hand_rad: -8f64.to_radians() * flexion.sign(),
            flexion,
            layout,
        }
    }

    /// The angles of the layout's [joints](MarkerLayout::joints), J1, J2 and J3 being these, radians.
    #[must_use]
    pub fn joints_rad(&self, angles_rad: [f64; 3]) -> Vec<f64> {
        let all = all_rad(angles_rad);
        let at = |joint: &str| ALL_JOINTS.iter().position(|known| *known == joint);
        self.layout.joints().into_iter().filter_map(|(joint, _)| at(joint).map(|k| all[k])).collect()
    }

    /// The directions of the index finger's segments, then of the thumb's, for joint angles, radians.
    fn directions_rad(&self, angles_rad: [f64; 3]) -> [f64; 7] {
        let mut directions = [self.hand_rad; 7];
        directions[4] += self.flexion.sign() * THUMB_RAD;
        for (angle, [from, to]) in all_rad(angles_rad).into_iter().zip(JOINED) {
            directions[to] = directions[from] + self.flexion.sign() * angle;
        }
        directions
    }

    /// The finger with these joint angles, moved by `shift_px`.
    #[must_use]
    pub fn posture(&self, angles_rad: [f64; 3], shift_px: [f64; 2]) -> Posture {
        let directions = self.directions_rad(angles_rad);
        let units = directions.map(|direction| [direction.cos(), direction.sin()]);
        let along = |from: [f64; 2], segment: usize, px: f64| {
            [from[0] + px * units[segment][0], from[1] + px * units[segment][1]]
        };
        let gap = if self.layout == MarkerLayout::Pairs { self.gap_px } else { 0.0 };
        let mut bones = vec![[self.knuckle_px[0] + shift_px[0], self.knuckle_px[1] + shift_px[1]]; 5];
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
            if self.layout != MarkerLayout::Pairs && segment == 3 {
                markers.push(last);
            }
        }
        if self.layout.painted() {
            bones.push(markers[0]);
            for segment in 4..7 {
                let from = if segment == 4 { markers[0] } else { bones[segment + 1] };
                let last = along(from, segment, self.lengths_px[segment]);
                bones.push(if segment == 6 { along(last, segment, self.tip_px) } else { last });
                markers.push(last);
            }
            markers = self.layout.marks().iter().map(|&mark| markers[mark]).collect();
        }
        let skins = (0..markers.len()).map(|marker| self.skin(marker, directions)).collect();
        Posture { bones_px: bones, markers_px: markers, skins }
    }

    /// How the skin lies around a marker: stickers are stiff.
    fn skin(&self, marker: usize, directions_rad: [f64; 7]) -> Skin {
        let Some(&mark) = self.layout.marks().get(marker) else {
            let segments = self.layout.whole();
            let on = segments.iter().find(|(_, ends)| ends.contains(&marker)).map_or(0, |&(segment, _)| segment);
            return Skin { along_rad: directions_rad[on], bend_per_px: 0.0 };
        };
        // From the segment that ends there to the one that starts there; the wrist's mark lies on the hand.
        let ends = |end: usize| MARKS_ON.iter().position(|marks| marks[end] == mark);
        let (from, to) = (ends(1), ends(0));
        let [from, to] = [from.or(to), to.or(from)].map(|segment| directions_rad[segment.unwrap_or(0)]);
        let bend_per_px = (to - from) / (BENDING * self.half_width_px(marker));
        Skin { along_rad: 0.5 * (from + to), bend_per_px }
    }

    /// Half the limb's width where a mark of paint lies.
    #[must_use]
    pub fn half_width_px(&self, marker: usize) -> f64 {
        // The widths' places: those of the wrist, and of the index finger's and the thumb's joints and tips.
        const WIDTHS: [usize; 8] = [0, 1, 2, 3, 4, 6, 7, 8];
        self.layout.marks().get(marker).map_or(0.0, |&mark| self.half_widths_px[WIDTHS[mark]])
    }
}

/// J1, J2, J3, T1, T2 for J1, J2, J3.
fn all_rad([j1, j2, j3]: [f64; 3]) -> [f64; 5] {
    let [t1, t2] = [(j2, 0), (j3, 1)].map(|(led, k)| THUMB_FOLLOWS[k][0] + THUMB_FOLLOWS[k][1] * led);
    [j1, j2, j3, t1, t2]
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
                    let [a, b] = layout.segments()[segment].1.map(|marker| markers[marker]);
                    assert!(((b[0] - a[0]).hypot(b[1] - a[1]) - finger.lengths_px[segment]).abs() < 1e-9);
                    (b[1] - a[1]).atan2(b[0] - a[0])
                })
                .collect();
            for (joint, angle) in angles.into_iter().enumerate() {
                assert!((flexion.sign() * (directions[joint + 1] - directions[joint]) - angle).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn skin_bends_and_is_bent_back() {
        for k in 0..40 {
            let skin = Skin { along_rad: 0.7 * f64::from(k), bend_per_px: 0.001 * f64::from(k - 20) };
            let point = [f64::from(k % 7) * 4.0 - 12.0, f64::from(k % 5) * 4.0 - 8.0];
            let (shown, area) = skin.shown(point);
            let back = skin.material(shown);
            assert!((back[0] - point[0]).hypot(back[1] - point[1]) <= 1e-9);
            // The area by differences.
            let [right, down] = [[1e-6, 0.0], [0.0, 1e-6]].map(|step| {
                let (moved, _) = skin.shown([point[0] + step[0], point[1] + step[1]]);
                [(moved[0] - shown[0]) / 1e-6, (moved[1] - shown[1]) / 1e-6]
            });
            assert!((right[0] * down[1] - right[1] * down[0] - area).abs() <= 1e-6);
        }
    }
}
