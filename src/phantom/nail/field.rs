//! The scene's colour at any place of the picture.
//!
//! In: picture coordinates in pixels, anywhere. Out: encoded red, green, blue, 0 to 1. Every edge and line is as soft as the optics
//! and the anatomy together, so the photograph is this function at the pixel centres.

use super::{
    NailScene,
    coloration::zones,
    finger::FingerPlace,
    light::CHAMBER,
    shape::NailPlace,
    smooth::{bell, covered, line, noise1, noise2, resolved, step},
};

/// A scene made ready to be evaluated.
#[derive(Debug, Clone)]
pub struct Field<'a> {
    scene: &'a NailScene,
    right: [f64; 2],
    distal: [f64; 2],
    /// Half nail widths per pixel.
    per_px: f64,
    /// The optics' blur in half nail widths.
    blur: f64,
    /// Length of the distal part with its free edge over that without.
    stretch: f64,
    skin: [f64; 3],
    bed: [f64; 3],
    /// What the camera resolves of texture with the spacings of [`SPACING`].
    seen: [f64; 4],
    exposure: [f64; 3],
}

/// Feature sizes of the textures in half nail widths: blotches, skin relief, fine lines, striations.
const SPACING: [f64; 4] = [0.45, 0.10, 0.035, 0.055];

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
        let redness = [1.0 + 0.3 * subject.redness, 1.0 - subject.redness, 1.0 - subject.redness];
        let (skin, bed) = (subject.tone.skin(), subject.tone.bed());
        Self {
            scene,
            right: camera.axis.right(),
            distal: camera.axis.distal(),
            per_px: 1.0 / half_px,
            blur: camera.blur_px / half_px,
            stretch: 1.0 + 2.0 * subject.free_edge / (1.0 - subject.nail.widest_v),
            skin: std::array::from_fn(|c| skin[c] * redness[c]),
            bed: bed.map(|c| c * subject.bed),
            seen: SPACING.map(|s| resolved(s * half_px)),
            exposure: scene.light.tint.map(|c| c * scene.light.brightness * CHAMBER),
        }
    }

    /// Place of the picture in half nail widths from the nail's middle: across to the right, along to the distal end.
    fn finger_from_picture(&self, x_px: f64, y_px: f64) -> [f64; 2] {
        let camera = &self.scene.camera;
        let d = [(x_px - camera.centre_px[0]) * self.per_px, (y_px - camera.centre_px[1]) * self.per_px];
        [d[0] * self.right[0] + d[1] * self.right[1], d[0] * self.distal[0] + d[1] * self.distal[1]]
    }

    /// Encoded red, green and blue at (`x_px`, `y_px`), 0 to 1.
    pub fn colour(&self, x_px: f64, y_px: f64) -> [f64; 3] {
        let [across, along] = self.finger_from_picture(x_px, y_px);
        let aspect = self.scene.subject.nail.aspect;
        let finger = self.scene.subject.finger.place(across, along, aspect);
        let soft = self.blur.hypot(0.012);
        let on_finger = covered(finger.edge, soft);
        let mut colour = if on_finger < 1.0 { self.background(across, along, finger.edge) } else { [0.0; 3] };
        let mut mirrored = 0.0;
        if on_finger > 0.0 {
            let (u, v) = (across, along / aspect);
            let place = Place { across, along, u, v, nail: self.scene.subject.nail.place(u, v, self.stretch), finger };
            let on_bed = covered(place.nail.outline, self.blur.hypot(0.008));
            let mut front = if on_bed < 1.0 { self.skin_and_free_edge(&place) } else { [0.0; 3] };
            if on_bed > 0.0 {
                front = mix(front, self.plate(&place), on_bed);
            }
            let on_plate = covered(place.nail.plate, self.blur.hypot(0.01));
            if on_plate > 0.0 {
                mirrored = on_plate * self.scene.light.mirrored(u, v);
            }
            colour = mix(colour, front, on_finger);
        }
        self.lit(colour, mirrored, x_px, y_px)
    }

    fn lit(&self, colour: [f64; 3], mirrored: f64, x_px: f64, y_px: f64) -> [f64; 3] {
        let camera = &self.scene.camera;
        let [gx, gy] = self.scene.light.gradient;
        let x = 2.0 * x_px / f64::from(camera.width) - 1.0;
        let y = 2.0 * y_px / f64::from(camera.height) - 1.0;
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
        let grain = 0.6 * noise2(seed, across * 2.0, along * 2.0)
            + 0.4 * self.seen[1] * noise2(seed ^ 1, across / SPACING[1], along / SPACING[1]);
        let shade = (1.0 + ground.grain * grain) * (1.0 - ground.shadow * bell((edge / 0.22).powi(2)));
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
        let blotch = noise2(seed, across / SPACING[0], along / SPACING[0]);
        let relief = noise2(seed ^ 2, across / (1.6 * SPACING[1]), along / SPACING[1]);
        let bent = along + 0.10 * across * across;
        let fine = noise2(seed ^ 3, across / (4.0 * SPACING[2]), bent / SPACING[2]);
        let mut shade = self.roundness(&place.finger);
        shade *= 1.0 + subject.texture * (0.6 * self.seen[1] * relief + 0.5 * self.seen[2] * fine);
        shade *= self.wrinkles(across, bent);
        // The folds' ridge around the nail.
        shade *= 1.0 + subject.ridge * (1.0 - 0.6 * distal) * bell(((nail.outline - 0.17) / 0.09).powi(2));
        let warm = subject.texture * blotch + 0.05 * distal * (1.0 - subject.tone.darkness());
        let mut colour = [self.skin[0] * (1.0 + 0.2 * warm), self.skin[1] * (1.0 - warm), self.skin[2] * (1.0 - warm)];

        // The cuticle: a thin, pale, dry band at the end of the proximal fold.
        let cuticle = subject.cuticle * proximal * line(nail.outline - 0.045, 0.022, self.blur);
        colour = colour.map(|c| c * shade + cuticle);
        // The crease where the skin meets the plate; weaker at the fingertip.
        let crease = subject.crease * (1.0 - 0.75 * distal) * (0.8 + 0.2 * noise2(seed ^ 4, across * 6.0, along * 6.0));
        let dark = crease * line(nail.outline - 0.4 * subject.crease_width, subject.crease_width, self.blur);
        let broad = 0.35 * crease * bell((nail.outline / 0.10).powi(2));
        let shadow = (0.10 + 0.5 * subject.crease) * distal * line(nail.plate - 0.03, 0.035, self.blur);
        let dark = dark + broad + shadow;
        colour = [colour[0] * (1.0 - 0.8 * dark), colour[1] * (1.0 - dark), colour[2] * (1.0 - 1.05 * dark)];

        if subject.free_edge > 0.0 {
            let on = covered(nail.plate, self.blur.hypot(0.010));
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
        1.0 - amount * self.seen[1] * bell((wave / 0.22).powi(2))
    }

    fn plate(&self, place: &Place) -> [f64; 3] {
        let subject = &self.scene.subject;
        let Place { u, v, nail, .. } = *place;
        let seed = subject.seed;
        let distal = step(0.2, 0.8, nail.y);
        let lateral = u * u;

        let zone = subject.habit.amplitude / CHAMBER * zones(self.scene.pose, &subject.habit, u, v);
        // White and red differ mainly in green (4.2.2).
        let mut colour = [self.bed[0] + 0.06 * zone, self.bed[1] + zone, self.bed[2] + 0.18 * zone];

        // Lunula, yellow line and onychodermal band.
        if subject.lunula > 0.0 {
            let reach = (u / 0.62).hypot((v + 1.0) / (2.0 * subject.lunula_height));
            let pale = subject.lunula * (1.0 - step(0.85, 1.1, reach));
            colour = [colour[0] + 0.5 * pale, colour[1] + pale, colour[2] + pale];
        }
        let band = distal * line(nail.outline + 0.045, 0.035, self.blur);
        let red_line = distal * line(nail.outline + 0.125, 0.03, self.blur);
        colour = [
            colour[0] + 0.05 * band - 0.01 * red_line,
            colour[1] + 0.07 * band - 0.03 * red_line,
            colour[2] + 0.04 * band - 0.03 * red_line,
        ];

        // The plate: a cylinder of its own, gloss, striations, and the folds' shade along its border.
        let striation = noise1(seed ^ 6, u / SPACING[3]) + 0.5 * noise1(seed ^ 7, u / (3.0 * SPACING[3]));
        let mut shade = 1.0 + 0.12 * self.scene.light.side * u - 0.08 * lateral - 0.10 * lateral * lateral * lateral;
        shade *= 1.0 + subject.striation * self.seen[3] * striation;
        shade *= 1.0 + subject.gloss * bell(((u - 0.3 * self.scene.light.side) / 0.30).powi(2));
        shade *= 1.0 - 0.05 * step(0.2, 1.2, v) + 0.01 * noise2(seed ^ 8, u * 2.5, v * 2.0);
        let fold = 1.0 - 0.85 * distal;
        shade *= 1.0 - 0.30 * subject.crease * fold * line(nail.outline, 0.05, self.blur);
        colour.map(|c| c * shade)
    }
}
