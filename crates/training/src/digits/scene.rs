//! Characters as a camera sees them, with what they are: digits, and what must not be taken for one.

use lunula::clock::{Levels, Patch};
use lunula::video::Plane;
use nalgebra::Matrix3;
use rand::{Rng, RngExt};

use super::faces::{Face, Faces};
use super::flaws::{Canvas, bell};
use super::mask::{Mask, Sheet, tight};
use super::segments::{Display, is_a_digit};

/// What is no digit.
pub const OTHER: usize = 10;

/// How hard the scenes are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    /// All that training looks at.
    Any,
    /// Whole digits under any conditions.
    Digits,
    /// Whole digits in good light, a little noise, boxes that fit.
    Clean,
    /// What is no digit, under any conditions.
    Others,
}

/// A patch and what it shows.
pub struct Sample {
    /// Cut out as the library cuts.
    pub patch: Patch,
    /// The digit, or [`OTHER`].
    pub label: usize,
}

/// One inked piece: how much, and how far right.
struct Piece<'a> {
    mask: &'a Mask,
    share: f32,
    x: f32,
    /// Of the character in question.
    own: bool,
}

/// A character to draw.
#[derive(Clone, Copy)]
enum Style<'a> {
    Face(&'a Face),
    Display(&'a Display, f32),
}

impl<'a> Style<'a> {
    /// A digit's pieces, `share` of it shown; how far it advances.
    fn digit(&self, digit: usize, share: f32, x: f32, own: bool, pieces: &mut Vec<Piece<'a>>) -> f32 {
        match *self {
            Style::Face(face) => {
                let (mask, advance) = &face.digits[digit];
                pieces.push(Piece { mask, share, x, own });
                *advance
            }
            Style::Display(display, ghost) => {
                for (mask, lit) in display.segments.iter().zip(display.lit(digit)) {
                    let share = share * if lit { 1.0 } else { ghost };
                    if share > 0.0 {
                        pieces.push(Piece { mask, share, x, own });
                    }
                }
                display.advance
            }
        }
    }

    fn mark(&self, which: usize, x: f32, own: bool, pieces: &mut Vec<Piece<'a>>) -> f32 {
        match *self {
            Style::Face(face) => {
                let (mask, advance) = &face.others[which % face.others.len()];
                pieces.push(Piece { mask, share: 1.0, x, own });
                *advance
            }
            Style::Display(display, _) => {
                let two = which.is_multiple_of(2);
                display
                    .dots
                    .iter()
                    .skip(usize::from(two))
                    .for_each(|mask| pieces.push(Piece { mask, share: 1.0, x, own }));
                0.35
            }
        }
    }

    /// The box that holds any digit: left, top, right, bottom, units.
    fn cell(&self) -> [f32; 4] {
        match self {
            Style::Face(face) => face.cell,
            Style::Display(display, _) => display.cell,
        }
    }
}

/// What is drawn, what it is, and what is asked of it.
struct Content<'a> {
    pieces: Vec<Piece<'a>>,
    label: usize,
    /// Boxes at the cell, not at the ink.
    cell: bool,
    /// Covered from here on: a point and a direction in shares of the digit, and how bright (0 background, 1 ink).
    cover: Option<([f32; 2], f32, f32)>,
    /// Moves the box by shares of its size, and scales it.
    astray: Option<[f32; 3]>,
}

/// Draws a character and cuts it out so many times; the same `rng` gives the same ones.
pub fn samples(faces: &Faces, kind: Kind, cuts: usize, rng: &mut impl Rng) -> Vec<Sample> {
    let style = if faces.families.is_empty() || !faces.displays.is_empty() && rng.random_bool(0.42) {
        let ghost = if rng.random_bool(0.5) { 0.0 } else { rng.random_range(0.0f32..0.1) };
        Style::Display(faces.display(rng), ghost)
    } else {
        Style::Face(faces.face(rng))
    };
    let plain = match kind {
        Kind::Any => rng.random_bool(0.72),
        Kind::Digits | Kind::Clean => true,
        Kind::Others => false,
    };
    loop {
        let mut content = if plain { digit(style, rng) } else { other(style, rng) };
        if kind == Kind::Clean {
            content.cell = false;
        }
        neighbours(style, kind == Kind::Clean, &mut content, rng);
        if let Some(patches) = look(style, &content, kind == Kind::Clean, cuts, rng) {
            return patches.into_iter().map(|patch| Sample { patch, label: content.label }).collect();
        }
    }
}

fn digit<'a>(style: Style<'a>, rng: &mut impl Rng) -> Content<'a> {
    let label = rng.random_range(0..10);
    let mut pieces = Vec::new();
    style.digit(label, 1.0, 0.0, true, &mut pieces);
    // A trace of the digit before, and segments that are not equally dark.
    if rng.random_bool(0.15) {
        let trace = rng.random_range(0.0f32..0.06);
        pieces.iter_mut().for_each(|p| p.share *= 1.0 - trace);
        style.digit((label + 9) % 10, trace, 0.0, false, &mut pieces);
    }
    if let Style::Display(..) = style
        && rng.random_bool(0.4)
    {
        let least = rng.random_range(0.72f32..1.0);
        pieces.iter_mut().filter(|p| p.share > 0.5).for_each(|p| p.share *= rng.random_range(least..1.01));
    }
    Content { pieces, label, cell: rng.random_bool(0.3), cover: None, astray: None }
}

fn other<'a>(style: Style<'a>, rng: &mut impl Rng) -> Content<'a> {
    let mut pieces = Vec::new();
    let mut content = Content { pieces: vec![], label: OTHER, cell: rng.random_bool(0.3), cover: None, astray: None };
    let any = rng.random_range(0..10);
    match rng.random_range(0..100) {
        // Two digits, mostly one after the other, or more.
        0..36 => {
            let next = if rng.random_bool(0.7) { (any + 1) % 10 } else { (any + rng.random_range(1..10)) % 10 };
            let share = rng.random_range(0.22f32..0.78);
            style.digit(any, share, 0.0, true, &mut pieces);
            if rng.random_bool(0.12) {
                let third = (next + 1) % 10;
                let rest = 1.0 - share;
                style.digit(next, 0.5 * rest, 0.0, true, &mut pieces);
                style.digit(third, 0.5 * rest, 0.0, true, &mut pieces);
            } else {
                style.digit(next, 1.0 - share, 0.0, true, &mut pieces);
            }
        }
        // Nothing, or what is not lit.
        36..46 => {
            if let Style::Display(display, ghost) = style {
                let mut add = |mask| pieces.push(Piece { mask, share: ghost, x: 0.0, own: true });
                display.segments.iter().for_each(&mut add);
            }
            content.cell = true;
        }
        // Marks and letters.
        46..60 => {
            style.mark(rng.random_range(0..1000), 0.0, true, &mut pieces);
        }
        // Covered.
        60..74 => {
            style.digit(any, 1.0, 0.0, true, &mut pieces);
            let place = [rng.random_range(0.15f32..0.85), rng.random_range(0.15f32..0.85)];
            let level = [0.0, 0.0, 1.0, rng.random_range(-0.3f32..1.3)][rng.random_range(0..4)];
            content.cover = Some((place, rng.random_range(0.0f32..std::f32::consts::TAU), level));
        }
        // The box elsewhere: between two digits, or a part of one.
        74..82 => {
            style.digit(any, 1.0, 0.0, true, &mut pieces);
            let side = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
            content.astray = Some(match rng.random_range(0..3) {
                0 => [side * rng.random_range(0.4f32..0.7), rng.random_range(-0.1f32..0.1), 1.0],
                1 => [rng.random_range(-0.1f32..0.1), side * rng.random_range(0.35f32..0.6), 1.0],
                _ => [0.0, side * rng.random_range(0.2f32..0.3), rng.random_range(0.45f32..0.6)],
            });
        }
        // A segment that is neither lit nor dark, or segments that are no digit.
        _ => match style {
            Style::Display(display, ghost) => {
                let mut lit = display.lit(any).map(|on| if on { 1.0 } else { ghost });
                if rng.random_bool(0.7) {
                    let k = rng.random_range(0..7);
                    lit[k] = rng.random_range(0.25f32..0.55);
                } else {
                    let k = rng.random_range(1..127);
                    let on = std::array::from_fn(|i| k >> i & 1 == 1);
                    lit = if is_a_digit(on) { [1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0] } else { on.map(f32::from) };
                }
                for (mask, share) in display.segments.iter().zip(lit) {
                    pieces.push(Piece { mask, share, x: 0.0, own: true });
                }
            }
            Style::Face(_) => {
                let share = rng.random_range(0.3f32..0.7);
                style.digit(any, share, 0.0, true, &mut pieces);
                style.digit(8, 1.0 - share, 0.0, true, &mut pieces);
                if any == 8 {
                    style.digit(3, share, 0.0, true, &mut pieces);
                    pieces.remove(0);
                }
            }
        },
    }
    content.pieces = pieces;
    content
}

/// Where a projective map takes a point.
fn to(m: &Matrix3<f32>, x: f32, y: f32) -> [f32; 2] {
    let row = |k: usize| m[(k, 0)] * x + m[(k, 1)] * y + m[(k, 2)];
    let z = 1.0 / row(2);
    [row(0) * z, row(1) * z]
}

/// What stands left and right of it.
fn neighbours<'a>(style: Style<'a>, clean: bool, content: &mut Content<'a>, rng: &mut impl Rng) {
    let advance = match style {
        Style::Display(display, _) => display.advance,
        Style::Face(face) => face.digits[0].1,
    };
    for side in [-1.0f32, 1.0] {
        if !rng.random_bool(0.7) {
            continue;
        }
        let near = if clean { 0.0 } else { rng.random_range(-0.06f32..0.25) };
        let mut pieces = Vec::new();
        let own = if rng.random_bool(0.75) {
            style.digit(rng.random_range(0..10), 1.0, 0.0, false, &mut pieces)
        } else {
            style.mark(rng.random_range(0..2), 0.0, false, &mut pieces)
        };
        let x = if side > 0.0 { advance + near } else { -own - near };
        pieces.iter_mut().for_each(|p| p.x = x);
        content.pieces.append(&mut pieces);
    }
}

/// Takes the picture and cuts the patch out of it; none where a cover hides too little or too much to say what it
/// leaves.
fn look(style: Style<'_>, content: &Content<'_>, clean: bool, cuts: usize, rng: &mut impl Rng) -> Option<Vec<Patch>> {
    let ease = if clean { 0.25 } else { 1.0 };
    let tall_px = if clean { rng.random_range(14.0f32..50.0) } else { 8.0 * rng.random_range(0.0f32..1.8).exp() };
    let box_units = if content.cell || content.pieces.iter().all(|p| !p.own) {
        style.cell()
    } else {
        tight(
            content
                .pieces
                .iter()
                .filter(|p| p.own && p.share > 0.15)
                .flat_map(|p| p.mask.edge.iter().map(|q| [q[0] + p.x, q[1]])),
        )
    };
    let box_units = if box_units[0] > box_units[2] { style.cell() } else { box_units };

    // Units to samples: stretched, slanted, turned, tilted.
    let slanted = matches!(style, Style::Display(..)) && rng.random_bool(0.6);
    let slant = if slanted { rng.random_range(0.0f32..0.22) } else { 0.04 * ease * bell(rng) };
    let turn = 0.035 * ease * bell(rng);
    let stretch = rng.random_range(-0.18f32..0.25).exp();
    let tilt = [0.06 * ease * bell(rng), 0.06 * ease * bell(rng)];
    let (sin, cos) = turn.sin_cos();
    let middle = [0.5 * (box_units[0] + box_units[2]), 0.5];
    let shift = Matrix3::new(1.0, 0.0, -middle[0], 0.0, 1.0, -middle[1], 0.0, 0.0, 1.0);
    let shear = Matrix3::new(stretch, -slant, 0.0, 0.0, 1.0, 0.0, tilt[0], tilt[1], 1.0);
    let scale = Matrix3::new(tall_px * cos, -tall_px * sin, 0.0, tall_px * sin, tall_px * cos, 0.0, 0.0, 0.0, 1.0);
    let picture_from_units = scale * shear * shift;
    let ink_box = if content.cell || content.pieces.iter().all(|p| !p.own) {
        let [l, t, r, b] = box_units;
        tight([[l, t], [r, t], [l, b], [r, b]].into_iter().map(|[x, y]| to(&picture_from_units, x, y)))
    } else {
        let own = content.pieces.iter().filter(|p| p.own && p.share > 0.15);
        tight(own.flat_map(|p| p.mask.edge.iter().map(|q| to(&picture_from_units, q[0] + p.x, q[1]))))
    };
    let (wide, tall) = (ink_box[2] - ink_box[0], ink_box[3] - ink_box[1]);
    if !(wide > 0.0 && tall > 0.0) {
        return None;
    }
    let room = 0.25 * tall_px + 2.0;
    let side = room + (0.4 * tall_px - 0.5 * wide).max(0.0);
    let origin = [ink_box[0] - side - rng.random_range(0.0f32..1.0), ink_box[1] - room - rng.random_range(0.0f32..1.0)];
    let width = (ink_box[2] + side - origin[0]).ceil() as usize;
    let height = (ink_box[3] + room - origin[1]).ceil() as usize;

    // Ink of each sample.
    let units_from_picture = picture_from_units.try_inverse()?;
    let looks = ((36.0 / tall_px).ceil() as usize).clamp(1, 4);
    let uneven = if rng.random_bool(0.3) { [0.2 * bell(rng), 0.2 * bell(rng)] } else { [0.0; 2] };
    let [l, t, r, b] = style.cell();
    let aside = 0.9 * (b - t);
    let mut sheet = Sheet::new([l - aside, t - 0.4, r + aside, b + 0.4]);
    content.pieces.iter().for_each(|p| sheet.add(p.mask, p.x, p.share));
    let ink_at = |x: f32, y: f32| {
        let [u, v] = to(&units_from_picture, x, y);
        sheet.at(u, v) * (1.0 + uneven[0] * (u - middle[0]) + uneven[1] * (v - 0.5))
    };
    let mut ink = vec![0.0f32; width * height];
    for (k, value) in ink.iter_mut().enumerate() {
        for i in 0..looks * looks {
            let (dx, dy) = ((i % looks) as f32, (i / looks) as f32);
            let at = |from: f32, k: usize, d: f32| from + k as f32 - 0.5 + (d + 0.5) / looks as f32;
            *value += ink_at(at(origin[0], k % width, dx), at(origin[1], k / width, dy));
        }
        *value /= (looks * looks) as f32;
    }
    if let Some((place, direction, level)) = content.cover {
        let (sin, cos) = direction.sin_cos();
        let at = [ink_box[0] + place[0] * wide, ink_box[1] + place[1] * tall];
        let (mut hidden, mut all) = (0.0, 0.0);
        for (k, value) in ink.iter_mut().enumerate() {
            let (x, y) = (origin[0] + (k % width) as f32, origin[1] + (k / width) as f32);
            let inside = (x - at[0]) * cos + (y - at[1]) * sin;
            let covered = (inside + 0.5).clamp(0.0, 1.0);
            if x > ink_box[0] && x < ink_box[2] {
                hidden += covered * *value;
                all += *value;
            }
            *value += covered * (level - *value);
        }
        if !(0.2 * all..0.85 * all).contains(&hidden) {
            return None;
        }
    }

    // A frame's line or shadow beside the character.
    if !clean && rng.random_bool(0.25) {
        for side in [[0.0f32, -1.0], [0.0, 1.0], [-1.0, 0.0], [1.0, 0.0]] {
            if rng.random_bool(0.6) {
                continue;
            }
            let near = tall_px * rng.random_range(0.02f32..0.25);
            let broad = tall_px * if rng.random_bool(0.5) { 1.0 } else { rng.random_range(0.02f32..0.1) };
            let level = rng.random_range(-0.4f32..1.2);
            let (from, lean) = (0.5 * if side[0] == 0.0 { tall } else { wide } + near, 0.04 * bell(rng));
            let middle = [0.5 * (ink_box[0] + ink_box[2]), 0.5 * (ink_box[1] + ink_box[3])];
            for (k, value) in ink.iter_mut().enumerate() {
                let x = origin[0] + (k % width) as f32 - middle[0];
                let y = origin[1] + (k / width) as f32 - middle[1];
                let out = x * side[0] + y * side[1] + lean * (x * side[1] + y * side[0]) - from;
                let covered = (out + 0.5).clamp(0.0, 1.0).min((broad - out + 0.5).clamp(0.0, 1.0));
                *value += covered * (level - *value);
            }
        }
    }

    // Light, lens, sensor, codec.
    let contrast = if clean { rng.random_range(90.0f32..220.0) } else { 18.0 * rng.random_range(0.0f32..2.5).exp() };
    let low = rng.random_range(0.0f32..(255.0 - contrast));
    let (background, full) = if rng.random_bool(0.5) { (low, low + contrast) } else { (low + contrast, low) };
    let slope: [f32; 2] = std::array::from_fn(|_| 0.12 * ease * bell(rng) * contrast / tall_px);
    let edge = (!clean && rng.random_bool(0.06)).then(|| {
        (rng.random_range(0.0f32..std::f32::consts::TAU), rng.random_range(-0.7f32..0.7), 0.4 * contrast * bell(rng))
    });
    let samples = (0..width * height)
        .map(|k| {
            let (x, y) = ((k % width) as f32 - 0.5 * width as f32, (k / width) as f32 - 0.5 * height as f32);
            let mut value = background + ink[k] * (full - background) + slope[0] * x + slope[1] * y;
            if let Some((direction, at, step)) = edge {
                let (sin, cos) = direction.sin_cos();
                value += step * ((x * cos + y * sin - at * tall_px) / (0.05 * tall_px) + 0.5).clamp(0.0, 1.0);
            }
            value
        })
        .collect();
    let mut canvas = Canvas { width, height, samples };
    let soft = rng.random_range(0.2f32..0.6) + ease * tall_px * 0.045 * rng.random_range(0.0f32..1.0).powi(2);
    let moved = if rng.random_bool(0.15) { ease * 0.05 * tall_px * rng.random_range(0.0f32..1.0) } else { 0.0 };
    canvas.blur(if rng.random_bool(0.5) { [soft + moved, soft] } else { [soft, soft + moved] });
    canvas.noise(ease * (rng.random_range(0.0f32..3.0) + contrast * 0.12 * rng.random_range(0.0f32..1.0).powi(2)), rng);
    if rng.random_bool(0.5) {
        let step = 1.0 + ease * contrast * 0.22 * rng.random_range(0.0f32..1.0).powi(2);
        canvas.code(step, [rng.random_range(0..8), rng.random_range(0..8)]);
    }
    let data = canvas.bytes();

    // Where the box is thought to be, and how dark the ink.
    let loose = if clean { 0.02 } else { 0.045 };
    let guess = if clean { 0.03 } else { 0.06 };
    let plane = Plane { width, height, stride: width, depth: 8, data: &data };
    let one = |_| {
        let mut cut = [0, 1, 2, 3].map(|i| {
            let size = if i % 2 == 0 { wide.max(0.35 * tall) } else { tall };
            ink_box[i] - origin[i % 2] + (loose * size * bell(rng)).clamp(-0.1 * size, 0.1 * size)
        });
        if let Some([right, down, scale]) = content.astray {
            let (w, h) = (cut[2] - cut[0], cut[3] - cut[1]);
            let m = [0.5 * (cut[0] + cut[2]) + right * w.max(0.4 * h), 0.5 * (cut[1] + cut[3]) + down * h];
            cut = [m[0] - 0.5 * w, m[1] - 0.5 * scale * h, m[0] + 0.5 * w, m[1] + 0.5 * scale * h];
        }
        let levels = Levels {
            background: background + guess * contrast * bell(rng),
            ink: full + (full - background) * guess * (bell(rng) - 0.8),
        };
        Patch::cut(&plane, cut.map(f64::from), levels)
    };
    Some((0..cuts).map(one).collect())
}
