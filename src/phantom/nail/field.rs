//! The scene's colour at any place of the picture.
//!
//! In: picture coordinates in pixels, anywhere. Out: encoded red, green, blue, 0 to 1. Every edge and line is as soft
//! as the optics and the anatomy together, so the photograph is this function at the pixel centres.

use super::{
    NailScene, Pose,
    coloration::{ColourWeights, DEPTH, PATTERNS, distal_share, patterns, whitening, zones},
    finger::FingerPlace,
    shape::NailPlace,
    smooth::{Edge, Line, bell, noise1, noise2, resolved, step},
};
use crate::phantom::nail::chamber::light::CHAMBER;

/// A scene made ready to be evaluated.
#[derive(Debug, Clone)]
pub struct Field<'a> {
    scene: &'a NailScene,
    right: [f64; 2],
    distal: [f64; 2],
    /// Half nail widths per pixel.
    per_px: f64,
    /// Half pictures per pixel.
    per_half: [f64; 2],
    /// The free edge, as `NailShape::free_edge` puts it.
    shrink: f64,
    edges: Edges,
    lines: Lines,
    skin: [f64; 3],
    bed: [f64; 3],
    /// What the camera resolves of texture with the spacings of [`SPACING`].
    seen: [f64; 5],
    exposure: [f64; 3],
    zones: Zones,
    specks: Vec<SeenSpeck>,
}

/// A speck through the optics.
#[derive(Debug, Clone)]
struct SeenSpeck {
    at: [f64; 2],
    height: f64,
    per_variance: f64,
}

/// Where the bed whitens and reddens.
#[derive(Debug, Clone, Copy)]
enum Zones {
    Pose(Pose),
    Moment(ColourWeights),
    /// All over the same.
    Even(f64),
}

/// Change of red, green and blue with a photograph's zones: white and red differ mainly in green (4.2.2).
const PHOTOGRAPHED: [f64; 3] = [0.10, 1.0, 0.35];

/// Borders between parts, in half nail widths.
#[derive(Debug, Clone)]
struct Edges {
    bed: Edge,
    plate: Edge,
    finger: Edge,
}

/// Lines along borders, in half nail widths.
#[derive(Debug, Clone)]
struct Lines {
    cuticle: Line,
    crease: Line,
    under_edge: Line,
    band: Line,
    red: Line,
    fold: Line,
}

/// Feature sizes of the textures in half nail widths: blotches, skin relief, fine lines, striations, pores.
const SPACING: [f64; 5] = [0.45, 0.10, 0.035, 0.055, 0.012];

/// Features per half nail width.
const PER: [f64; 5] = [1.0 / SPACING[0], 1.0 / SPACING[1], 1.0 / SPACING[2], 1.0 / SPACING[3], 1.0 / SPACING[4]];

/// A place, in all the coordinates that matter.
struct Place {
    across: f64,
    along: f64,
    u: f64,
    v: f64,
    nail: NailPlace,
    finger: FingerPlace,
}

fn mix(a: [f64; 3], b: [f64; 3], t: f64) -> [f64; 3] {
    std::array::from_fn(|c| a[c] + (b[c] - a[c]) * t)
}

impl<'a> Field<'a> {
    pub(super) fn new(scene: &'a NailScene) -> Self {
        let camera = &scene.camera;
        let subject = &scene.subject;
        let half_px = 0.5 * camera.nail_width_px;
        let blur = camera.blur_px / half_px;
        let redness = [1.0 + 0.3 * subject.redness, 1.0 - subject.redness, 1.0 - subject.redness];
        let (skin, bed) = (subject.tone.skin(), subject.tone.bed());
        Self {
            scene,
            right: camera.axis.right(),
            distal: camera.axis.distal(),
            per_px: 1.0 / half_px,
            per_half: [camera.width, camera.height].map(|side| 2.0 / f64::from(side)),
            shrink: subject.nail.free_edge(subject.free_edge),
            edges: Edges { bed: Edge::new(0.008, blur), plate: Edge::new(0.010, blur), finger: Edge::new(0.012, blur) },
            lines: Lines {
                cuticle: Line::new(0.022, blur),
                crease: Line::new(subject.crease_width, blur),
                under_edge: Line::new(0.035, blur),
                band: Line::new(0.035, blur),
                red: Line::new(0.03, blur),
                fold: Line::new(0.05, blur),
            },
            skin: std::array::from_fn(|c| skin[c] * redness[c]),
            bed: bed.map(|c| c * subject.bed),
            seen: SPACING.map(|s| resolved(s * half_px)),
            exposure: scene.light.tint.map(|c| c * scene.light.brightness * CHAMBER),
            zones: Zones::Pose(scene.pose),
            specks: subject
                .specks
                .iter()
                .map(|speck| {
                    let own = speck.size * speck.size;
                    let variance = own + blur * blur;
                    SeenSpeck { at: speck.at, height: speck.contrast * own / variance, per_variance: 1.0 / variance }
                })
                .collect(),
        }
    }

    /// The same nail with the colour of a moment in place of its pose's.
    #[must_use]
    pub fn at_moment(self, weights: &ColourWeights) -> Self {
        Self { zones: Zones::Moment(*weights), ..self }
    }

    /// The same nail with a bed that is whitened all over alike, as a moment's zones whiten it.
    #[must_use]
    pub(in crate::phantom) fn whitened(self, whitening: f64) -> Self {
        Self { zones: Zones::Even(whitening), ..self }
    }

    /// Each zone's whitening at (`x_px`, `y_px`), and the share of the distal blood there: with
    /// [`whitened`](Self::whitened), a moment's colour is the colour of 0 and the sum of weighted zones times what 1
    /// adds, as long as nothing comes near full scale.
    #[must_use]
    pub(in crate::phantom) fn patterns(&self, x_px: f64, y_px: f64) -> ([f64; PATTERNS], f64) {
        let [across, along] = self.finger_from_picture(x_px, y_px);
        let v = along / self.scene.subject.nail.aspect;
        (patterns(&self.scene.subject.habit, across, v), distal_share(v))
    }

    /// How much the bed's red, green and blue change at (`u`, `v`), encoded, in full light.
    fn zone(&self, u: f64, v: f64) -> [f64; 3] {
        let habit = &self.scene.subject.habit;
        let unit = habit.amplitude / CHAMBER;
        match &self.zones {
            Zones::Pose(pose) => {
                let zone = unit * zones(*pose, habit, u, v);
                PHOTOGRAPHED.map(|share| share * zone)
            }
            Zones::Moment(weights) => {
                let zone = unit * whitening(weights, habit, u, v);
                DEPTH.map(|share| share * zone)
            }
            Zones::Even(whitening) => DEPTH.map(|share| share * unit * whitening),
        }
    }

    /// Place of the picture in half nail widths from the nail's middle: across to the right, along to the distal end.
    fn finger_from_picture(&self, x_px: f64, y_px: f64) -> [f64; 2] {
        let camera = &self.scene.camera;
        let d = [(x_px - camera.centre_px[0]) * self.per_px, (y_px - camera.centre_px[1]) * self.per_px];
        [d[0] * self.right[0] + d[1] * self.right[1], d[0] * self.distal[0] + d[1] * self.distal[1]]
    }

    /// How much of the finger, not of what is behind it, is seen at (`x_px`, `y_px`), 0 to 1.
    #[must_use]
    pub(in crate::phantom) fn on_finger(&self, x_px: f64, y_px: f64) -> f64 {
        let [across, along] = self.finger_from_picture(x_px, y_px);
        let subject = &self.scene.subject;
        self.edges.finger.covered(subject.finger.place(across, along, subject.nail.aspect).edge)
    }

    /// Encoded red, green and blue at (`x_px`, `y_px`), 0 to 1.
    pub fn colour(&self, x_px: f64, y_px: f64) -> [f64; 3] {
        let [across, along] = self.finger_from_picture(x_px, y_px);
        let aspect = self.scene.subject.nail.aspect;
        let finger = self.scene.subject.finger.place(across, along, aspect);
        let on_finger = self.edges.finger.covered(finger.edge);
        let mut colour = if on_finger < 1.0 { self.background(across, along, finger.edge) } else { [0.0; 3] };
        let mut mirrored = 0.0;
        if on_finger > 0.0 {
            let (u, v) = (across, along / aspect);
            let place = Place { across, along, u, v, nail: self.scene.subject.nail.place(u, v, self.shrink), finger };
            let on_bed = self.edges.bed.covered(place.nail.outline);
            let mut front = if on_bed < 1.0 { self.skin_and_free_edge(&place) } else { [0.0; 3] };
            if on_bed > 0.0 {
                front = mix(front, self.plate(&place), on_bed);
            }
            let on_plate = self.edges.plate.covered(place.nail.plate);
            if on_plate > 0.0 {
                mirrored = on_plate * self.scene.light.mirrored(u, v);
            }
            colour = mix(colour, front, on_finger);
        }
        self.lit(colour, mirrored, x_px, y_px)
    }

    fn lit(&self, colour: [f64; 3], mirrored: f64, x_px: f64, y_px: f64) -> [f64; 3] {
        let [gx, gy] = self.scene.light.gradient;
        let [x, y] = [x_px * self.per_half[0] - 1.0, y_px * self.per_half[1] - 1.0];
        let gradient = 1.0 + gx * x + gy * y;
        std::array::from_fn(|c| {
            let value = (colour[c] * self.exposure[c] * gradient).max(0.0);
            // A camera's shoulder: what would exceed full scale bends towards it from 90 % on.
            let value = if value <= 0.9 { value } else { 1.0 - 0.01 / (value - 0.8) };
            value + (1.0 - value) * mirrored
        })
    }

    fn background(&self, across: f64, along: f64, edge: f64) -> [f64; 3] {
        let ground = &self.scene.camera.background;
        let seed = self.scene.subject.seed ^ 0x51ed;
        // Lattices turned against each other and against the picture, so that no squares show.
        let (x, y) = (across + 0.55 * along, along - 0.55 * across);
        let fine = self.seen[1] * noise2(seed ^ 1, x * PER[1], y * PER[1])
            + self.seen[2] * noise2(seed ^ 2, (y - 0.9 * x) * (0.45 * PER[2]), (x + 0.9 * y) * (0.45 * PER[2]));
        let grain = 0.5 * noise2(seed, x * 1.3, y * 1.3) + 0.3 * fine;
        let shade = (1.0 + ground.grain * grain) * (1.0 - ground.shadow * bell((edge * (1.0 / 0.22)).powi(2)));
        ground.colour.map(|c| c * shade)
    }

    /// Shading of the round finger: lightest on its ridge, dark at its silhouette.
    fn roundness(&self, finger: &FingerPlace) -> f64 {
        let slope = finger.slope.min(1.3);
        let s2 = slope * slope;
        1.0 + 0.18 * self.scene.light.side * finger.x - 0.14 * slope - 0.16 * s2 * s2
    }

    fn skin_and_free_edge(&self, place: &Place) -> [f64; 3] {
        let subject = &self.scene.subject;
        let Place { across, along, nail, .. } = *place;
        let seed = subject.seed;
        let distal = step(0.15, 0.75, nail.y);
        let proximal = step(-0.35, -0.9, nail.y);

        // Texture: blotches, relief, and fine lines that run across the finger behind the nail.
        let blotch = noise2(seed, across * PER[0], along * PER[0]);
        let relief = noise2(seed ^ 2, across * (PER[1] / 1.6), along * PER[1]);
        let bent = along + 0.10 * across * across;
        let fine = noise2(seed ^ 3, across * (0.25 * PER[2]), bent * PER[2]);
        let mut shade = self.roundness(&place.finger);
        shade *= 1.0 + subject.texture * (0.6 * self.seen[1] * relief + 0.5 * self.seen[2] * fine);
        if self.seen[4] > 0.0 {
            let pores = noise2(seed ^ 9, (across + 0.4 * along) * PER[4], (along - 0.4 * across) * PER[4]);
            shade *= 1.0 + 0.5 * subject.texture * self.seen[4] * pores;
        }
        shade *= self.wrinkles(across, bent);
        // The folds' ridge around the nail.
        shade *= 1.0 + subject.ridge * (1.0 - 0.6 * distal) * bell(((nail.outline - 0.17) * (1.0 / 0.09)).powi(2));
        let warm = subject.texture * blotch + 0.05 * distal * (1.0 - subject.tone.darkness());
        let mut colour = [self.skin[0] * (1.0 + 0.2 * warm), self.skin[1] * (1.0 - warm), self.skin[2] * (1.0 - warm)];

        // The cuticle: a thin, pale, dry band at the end of the proximal fold.
        let cuticle =
            subject.cuticle * (0.3 + 0.7 * proximal) * (1.0 - distal) * self.lines.cuticle.at(nail.outline - 0.045);
        colour = colour.map(|c| c * shade + cuticle);
        // The crease where the skin meets the plate; weaker at the fingertip.
        let uneven = if nail.outline < 0.3 { noise2(seed ^ 4, across * 2.2, along * 2.2) } else { 0.0 };
        let crease = subject.crease * (1.0 - 0.75 * distal) * (0.65 + 0.55 * uneven);
        let dark = crease * self.lines.crease.at(nail.outline - 0.4 * subject.crease_width);
        let broad = 0.35 * crease * bell((nail.outline * 10.0).powi(2));
        let shadow = (0.10 + 0.5 * subject.crease) * distal * self.lines.under_edge.at(nail.plate - 0.03);
        let dark = dark + broad + shadow;
        colour = [colour[0] * (1.0 - 0.8 * dark), colour[1] * (1.0 - dark), colour[2] * (1.0 - 1.05 * dark)];

        if subject.free_edge > 0.0 {
            let on = self.edges.plate.covered(nail.plate);
            if on > 0.0 {
                let white = mix(colour, [0.93, 0.91, 0.84].map(|c| c * shade), 0.35 + 0.6 * subject.free_edge_white);
                colour = mix(colour, white, on);
            }
        }
        colour
    }

    /// Wrinkles over the last joint, well behind the nail.
    fn wrinkles(&self, across: f64, bent: f64) -> f64 {
        let subject = &self.scene.subject;
        let behind = -(bent + subject.nail.aspect);
        let amount = subject.wrinkle * step(0.5, 1.3, behind);
        if amount <= 0.0 {
            return 1.0;
        }
        let seed = subject.seed ^ 5;
        let wave = noise2(seed, across * 0.9, behind * 7.0 + 0.5 * noise2(seed ^ 1, across * 2.5, behind * 2.0));
        1.0 - amount * self.seen[1] * bell((wave * (1.0 / 0.22)).powi(2))
    }

    fn plate(&self, place: &Place) -> [f64; 3] {
        let subject = &self.scene.subject;
        let Place { u, v, nail, .. } = *place;
        let seed = subject.seed;
        let distal = step(0.2, 0.8, nail.y);
        let lateral = u * u;

        let zone = self.zone(u, v);
        let mut colour = std::array::from_fn(|c| self.bed[c] + zone[c]);

        // Lunula, yellow line and onychodermal band.
        if subject.lunula > 0.0 {
            let reach = (u / 0.66).hypot((v + 1.0) / (2.0 * subject.lunula_height));
            let pale = subject.lunula * (1.0 - step(0.78, 1.15, reach));
            colour = [colour[0] + 0.5 * pale, colour[1] + pale, colour[2] + pale];
        }
        let band = distal * self.lines.band.at(nail.outline + 0.045);
        let red_line = distal * self.lines.red.at(nail.outline + 0.125);
        colour = [
            colour[0] + 0.05 * band - 0.01 * red_line,
            colour[1] + 0.07 * band - 0.03 * red_line,
            colour[2] + 0.04 * band - 0.03 * red_line,
        ];

        // The plate: a cylinder of its own, gloss, striations, and the folds' shade along its border.
        let striation = noise1(seed ^ 6, u * PER[3]) + 0.5 * noise1(seed ^ 7, u * (PER[3] / 3.0));
        let mut shade = 1.0 + 0.12 * self.scene.light.side * u - 0.08 * lateral - 0.10 * lateral * lateral * lateral;
        shade *= 1.0 + subject.striation * self.seen[3] * striation;
        shade *= 1.0 + subject.gloss * bell(((u - 0.3 * self.scene.light.side) * (1.0 / 0.30)).powi(2));
        shade *= 1.0 - 0.05 * step(0.2, 1.2, v) + 0.01 * noise2(seed ^ 8, u * 2.5, v * 2.0);
        let fold = 1.0 - 0.85 * distal;
        for speck in &self.specks {
            let [across, along] = [u - speck.at[0], (v - speck.at[1]) * subject.nail.aspect];
            shade *= 1.0 + speck.height * bell((across * across + along * along) * speck.per_variance);
        }
        shade *= 1.0 - 0.30 * subject.crease * fold * self.lines.fold.at(nail.outline);
        colour.map(|c| c * shade)
    }
}
