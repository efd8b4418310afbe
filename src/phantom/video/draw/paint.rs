//! Drawing a frame row by row in R'G'B', before the sensor.
//!
//! From below to above: desk, another hand, distractors, the clock's screen, limb, markers, sticks. Blobs are averaged
//! over the sub-exposures. Of the limb only its edge is: its shading changes little within an exposure and is that of
//! mid-exposure.

use std::f64::consts::TAU;

use crate::phantom::video::draw::edge::{EDGE, columns, soft};
use crate::phantom::video::draw::limb::{Bone, Limb};
use crate::phantom::video::draw::panel::Screen;
use crate::phantom::video::draw::row::Row;
use crate::phantom::video::scene::{Moment, Scene};

fn colour_of(hex: u32) -> [f32; 3] {
    [16, 8, 0].map(|shift| (hex >> shift & 255) as f32 / 255.0)
}

/// Sub-exposures are no further apart than this.
const SUB_STEP_PX: f64 = 0.7;
const MOST_SUBS: f64 = 128.0;
const SKIN: u32 = 0xd6a88c;
/// Of scenes with paint: luma 53-127 and Cr 132-150 in the recording that they follow.
const PAINTED_SKIN: u32 = 0x8f6552;
const STICK: u32 = 0x3b3f46;
/// Where the light comes from: right, down, towards the camera.
const LIGHT: [f64; 3] = [-0.33, -0.72, 0.61];

/// A thing of one colour, at its places in the sub-exposures.
struct Blob<'a> {
    colour: [f32; 3],
    places: Vec<[f64; 2]>,
    /// The middle one of the places, and how far the others are from it.
    middle: [f64; 2],
    spread_px: f64,
    /// All of it lies within `reach_px` of the line from its place to this far beyond.
    spine: [f64; 2],
    reach_px: f64,
    distance: Box<dyn Fn([f64; 2]) -> f64 + Sync + 'a>,
    /// What its colour is multiplied by, and what is added, at a place.
    shade: Option<Shade<'a>>,
}

/// A factor and a summand of a colour, by place.
type Shade<'a> = Box<dyn Fn([f64; 2]) -> [f32; 2] + Sync + 'a>;

/// A frame to be drawn.
pub(in crate::phantom::video) struct Exposure<'a> {
    scene: &'a Scene,
    limbs: Vec<Limb>,
    middle: Limb,
    /// How far a bone's end moves within the exposure.
    motion_px: f64,
    below: Vec<Blob<'a>>,
    above: Vec<Blob<'a>>,
    brightness: f64,
    screen: Option<Screen>,
}

impl<'a> Exposure<'a> {
    /// Rows of a frame that are taken `late_s` after its first.
    pub(in crate::phantom::video) fn new(scene: &'a Scene, frame: usize, late_s: f64) -> Self {
        let options = &scene.options;
        let time_s = scene.time_s(frame) + late_s;
        let exposure_s = options.blur / options.fps;
        let middle = scene.moment(time_s);
        let ends = [scene.moment(time_s - 0.5 * exposure_s), scene.moment(time_s + 0.5 * exposure_s)];
        let far = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
        let travelled = |places: &dyn Fn(&Moment) -> Vec<[f64; 2]>| {
            let (from, over, to) = (places(&ends[0]), places(&middle), places(&ends[1]));
            (0..over.len()).map(|k| far(from[k], over[k]) + far(over[k], to[k])).fold(0.0, f64::max)
        };
        // The wrist is far out of the picture, and how far it moves is of no account.
        let motion_px = travelled(&|m| m.bones_px[1..].to_vec());
        let all = travelled(&|m| [&m.bones_px[1..], &m.markers_px, &m.distractors_px].concat());
        let subs = (all / SUB_STEP_PX).ceil().clamp(1.0, MOST_SUBS) as usize;
        let moments: Vec<Moment> =
            (0..subs).map(|k| scene.moment(time_s + exposure_s * ((k as f64 + 0.5) / subs as f64 - 0.5))).collect();
        let bones = options.finger.layout.bones();
        let limb = |m: &Moment| Limb::new(&m.bones_px, &options.finger.half_widths_px, bones);
        let places = |of: &dyn Fn(&Moment) -> [f64; 2]| moments.iter().map(of).collect::<Vec<_>>();
        let below = scene.distractors.iter().enumerate().map(|(k, one)| {
            let distance = move |from| one.distance(from);
            Blob::new(
                scene,
                one.colour,
                places(&|m| m.distractors_px[k]),
                ([0.0; 2], one.reach_px()),
                Box::new(distance),
            )
        });
        let radius = options.finger.marker_px;
        let markers = scene.markers.iter().enumerate().map(|(k, marker)| {
            let places = places(&|m| m.markers_px[k]);
            let Some(blot) = scene.blots.get(k) else {
                let distance = move |[x, y]: [f64; 2]| (x * x + y * y).sqrt() - radius;
                return Blob::new(scene, marker.colour, places, ([0.0; 2], radius), Box::new(distance));
            };
            let skin = middle.skins[k];
            let distance = Box::new(move |from| blot.distance(&skin, from));
            let blob = Blob::new(scene, marker.colour, places, ([0.0; 2], blot.reach_px()), distance);
            Blob { shade: Some(Box::new(move |from| blot.shade(&skin, from))), ..blob }
        });
        let sticks = scene.sticks.iter().enumerate().map(|(k, stick)| {
            // A stick is as long as it has to be.
            let long = 2.0 * (options.width + options.height) as f64;
            let extent = (stick.along.map(|part| long * part), stick.radius_px);
            Blob::new(scene, STICK, places(&|m| m.sticks_px[k]), extent, Box::new(move |from| stick.distance(from)))
        });
        Self {
            scene,
            limbs: moments.iter().map(limb).collect(),
            middle: limb(&middle),
            motion_px,
            below: below.collect(),
            above: markers.chain(sticks).collect(),
            brightness: 1.0 + options.flicker * (TAU * options.flicker_hz * time_s + 0.8).sin(),
            screen: Screen::new(scene, frame, time_s, exposure_s),
        }
    }

    pub(in crate::phantom::video) fn draw(&self, y: usize, row: &mut Row) {
        self.desk(y, row);
        if let Some(other) = &self.scene.other_hand {
            self.limb((other, &[]), 0.0, y, row);
        }
        for blob in &self.below {
            self.blob(blob, y, row);
        }
        if let Some(screen) = &self.screen {
            screen.draw(y, row);
        }
        self.limb((&self.middle, &self.limbs), self.motion_px, y, row);
        for blob in &self.above {
            self.blob(blob, y, row);
        }
    }

    /// A pixel's place as a lens without distortion would show it.
    fn place(&self, x: usize, y: usize) -> [f64; 2] {
        let at = [x as f64, y as f64];
        self.scene.straighten.as_ref().map_or(at, |moves| {
            let [dx, dy] = moves[y * self.scene.options.width + x];
            [at[0] + f64::from(dx), at[1] + f64::from(dy)]
        })
    }

    fn desk(&self, y: usize, row: &mut Row) {
        let options = &self.scene.options;
        let colour = colour_of(options.desk);
        // The gradient goes from 1 at the top left corner to -1 at the bottom right one.
        let down = y as f64 / options.height as f64;
        let left = (self.brightness * (1.0 + options.gradient * (1.0 - down))) as f32;
        let step = (self.brightness * options.gradient / options.width as f64) as f32;
        row.light.iter_mut().enumerate().for_each(|(x, light)| *light = left - step * x as f32);
        for (channel, value) in row.rgb.iter_mut().zip(colour) {
            channel.iter_mut().zip(&row.light).for_each(|(pixel, light)| *pixel = light * value);
        }
    }

    fn blob(&self, blob: &Blob<'_>, y: usize, row: &mut Row) {
        let [mx, my] = blob.middle;
        let end = [mx + blob.spine[0], my + blob.spine[1]];
        let Some([first, last]) = self.columns((blob.middle, end, blob.reach_px), y) else { return };
        let sharp = 1.0 / self.scene.options.focus_px;
        let each = 1.0 / blob.places.len() as f32;
        for x in first..=last {
            let [px, py] = self.place(x, y);
            let from_middle = (blob.distance)([px - mx, py - my]);
            let share = if from_middle > blob.spread_px {
                continue;
            } else if from_middle < -blob.spread_px {
                1.0
            } else {
                let shares = blob.places.iter().map(|at| soft((blob.distance)([px - at[0], py - at[1]]) * sharp));
                shares.sum::<f32>() * each
            };
            let colour = blob.shade.as_ref().map_or(blob.colour, |shade| {
                let [times, more] = shade([px - mx, py - my]);
                blob.colour.map(|value| times * value + more)
            });
            row.mix(x, colour, share);
        }
    }

    /// A limb at mid-exposure and, where it moves, at the sub-exposures; its bones move so far within the exposure.
    fn limb(&self, (middle, limbs): (&Limb, &[Limb]), motion_px: f64, y: usize, row: &mut Row) {
        let options = &self.scene.options;
        let sharp = 1.0 / options.focus_px;
        let skin = colour_of(if options.finger.layout.painted() { PAINTED_SKIN } else { SKIN });
        let shadow_px = 0.3 * options.finger.half_widths_px[1];
        let margin = motion_px + EDGE * options.focus_px;
        let around = margin.max(3.0 * shadow_px);
        // A bone out of whose reach a pixel lies is of no account to it.
        let span = |bone: &Bone| {
            let reach = bone.half_widths[0].max(bone.half_widths[1]) + around;
            self.columns((bone.ends[0], bone.ends[1], reach), y)
        };
        let spans: Vec<Option<[usize; 2]>> = middle.bones.iter().map(span).collect();
        let mut within = vec![false; spans.len()];
        let first = spans.iter().flatten().map(|span| span[0]).min();
        let last = spans.iter().flatten().map(|span| span[1]).max();
        let (Some(first), Some(last)) = (first, last) else { return };
        for x in first..=last {
            for (within, span) in within.iter_mut().zip(&spans) {
                *within = span.is_some_and(|[first, last]| (first..=last).contains(&x));
            }
            let place = self.place(x, y);
            let (distance, [right, down]) = middle.nearest(&within, place);
            let share = if distance < -margin {
                1.0
            } else if distance > margin {
                0.0
            } else if limbs.is_empty() {
                soft(distance * sharp)
            } else {
                let sum: f32 = limbs.iter().map(|limb| soft(limb.nearest(&within, place).0 * sharp)).sum();
                sum / limbs.len() as f32
            };
            if share < 1.0 && distance < 3.0 * shadow_px {
                let dark = 0.3 * (-(distance.max(0.0) / shadow_px).powi(2)).exp() as f32;
                row.mix(x, [0.0; 3], dark);
            }
            if share > 0.0 {
                let out = (right * right + down * down).min(1.0);
                let lit = LIGHT[0] * right + LIGHT[1] * down + LIGHT[2] * (1.0 - out).sqrt();
                let shade = (0.68 + 0.38 * lit.max(0.0)) as f32;
                row.mix(x, skin.map(|value| shade * value), share);
            }
        }
    }

    /// The columns of row `y`, first and last, within reach of this line: from, to, reach.
    fn columns(&self, line: ([f64; 2], [f64; 2], f64), y: usize) -> Option<[usize; 2]> {
        let moves = self.scene.row_moves.as_ref().map_or([[0.0; 2]; 2], |moves| moves[y]);
        columns(line, y, self.scene.options.width, moves)
    }
}

impl<'a> Blob<'a> {
    fn new(
        scene: &Scene,
        colour: u32,
        places: Vec<[f64; 2]>,
        (spine, reach_px): ([f64; 2], f64),
        distance: Box<dyn Fn([f64; 2]) -> f64 + Sync + 'a>,
    ) -> Self {
        let middle = places[places.len() / 2];
        let far = |place: &[f64; 2]| (place[0] - middle[0]).hypot(place[1] - middle[1]);
        let spread_px = places.iter().map(far).fold(0.0, f64::max) + EDGE * scene.options.focus_px;
        let reach_px = reach_px + spread_px;
        Self { colour: colour_of(colour), middle, spread_px, spine, reach_px, places, distance, shade: None }
    }
}
