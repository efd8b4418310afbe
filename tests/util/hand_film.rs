//! Films of a finger whose skin is that of a real photograph, with joints of known angles.
//!
//! A strip of skin is cut out of a photograph of a hand and laid over four links, which turn about three joints;
//! discs and blots of paint lie on it, in linear light, shaded as the skin is; another photograph is behind and drifts.
//! Real are skin, its folds, its light and what is behind; motion, paint and camera are not.

use std::f64::consts::TAU;

use image::RgbImage;
use lunula::video::{Encoder, Encoding, Format, Matrix, Picture};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::Dir;
use super::real_data::real_data;

const SIZE: [usize; 2] = [640, 480];
pub(crate) const FRAMES: usize = 60;
const NOISE: usize = 1_000_003;
const LINKS: [(&str, f64, f64); 4] =
    [("hand", 125.0, 38.0), ("proximal", 120.0, 35.0), ("middle", 85.0, 31.0), ("distal", 75.0, 27.0)];
pub(crate) const JOINTS: [&str; 3] = ["J1", "J2", "J3"];
/// Half the width of the strip, pixels of the film.
const HALF: f64 = 40.0;
/// Paints: all that skin has not, and of about its hue.
const OTHER: [u32; 9] = [0x1e6fd9, 0x2e9e4f, 0xe91e63, 0xfdd835, 0x8e24aa, 0x26c6da, 0x2b4b10, 0x161616, 0xf4f4f4];
const OF_SKIN: [u32; 5] = [0x7a4a30, 0xb5583c, 0xe07b39, 0xc4705a, 0xa33a2c];

/// A picture in linear light.
struct Light(Vec<[f32; 3]>, [usize; 2]);

impl Light {
    fn of(picture: &RgbImage) -> Self {
        let pixels = picture.pixels().map(|p| p.0.map(|part| (f32::from(part) / 255.0).powf(2.2)));
        Self(pixels.collect(), [picture.width() as usize, picture.height() as usize])
    }

    /// Bilinear; beyond the border as at it.
    fn at(&self, x: f64, y: f64) -> [f64; 3] {
        let [x, y] = [(x, 0), (y, 1)].map(|(v, axis)| v.clamp(0.0, self.1[axis] as f64 - 1.001));
        let (i, j) = (x as usize, y as usize);
        let (u, v) = (x - i as f64, y - j as f64);
        let p = |i: usize, j: usize, c: usize| f64::from(self.0[j * self.1[0] + i][c]);
        let row = |j: usize, c: usize| (1.0 - u) * p(i, j, c) + u * p(i + 1, j, c);
        [0, 1, 2].map(|c| (1.0 - v) * row(j, c) + v * row(j + 1, c))
    }
}

fn luminance([r, g, b]: [f64; 3]) -> f64 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

fn is_skin(light: [f64; 3]) -> bool {
    let [luma, cb, cr] = Matrix::BT601.from_rgb(light.map(|part| part.powf(1.0 / 2.2)));
    luma > 45.0 && cb < 124.0 && cr > 134.0
}

/// Where a strip of skin lies in a photograph: its middle at the near end, its way, pixels there for one of the film.
struct Strip {
    at: [f64; 2],
    way: [f64; 2],
    scale: f64,
}

impl Strip {
    fn place(&self, along: f64, across: f64) -> [f64; 2] {
        let [x, y] = self.way.map(|part| part * self.scale);
        [self.at[0] + along * x - across * y, self.at[1] + along * y + across * x]
    }

    /// The largest that lies on skin, of those that the numbers try.
    fn find(photo: &Light, whole: [f64; 4], random: &mut ChaCha8Rng) -> Option<Self> {
        let length: f64 = LINKS.iter().map(|link| link.1).sum();
        let [left, top, right, bottom] = whole;
        let mut best: Option<(f64, Self)> = None;
        for _ in 0..60_000 {
            let turn = random.random_range(0.0..TAU);
            let at = [random.random_range(left..right), random.random_range(top..bottom)];
            let strip = Self { at, way: [turn.cos(), turn.sin()], scale: random.random_range(0.35..1.1) };
            if best.as_ref().is_some_and(|best| best.0 >= strip.scale) {
                continue;
            }
            // Those first that soon say no.
            let places = (0..175).map(|k| k * 64 % 175).map(|k| (k / 5, k % 5));
            let outside = places.filter(|&(along, across)| {
                let [x, y] = strip.place(f64::from(along) / 34.0 * length, (f64::from(across) / 2.5 - 0.8) * HALF);
                x < left || y < top || x >= right || y >= bottom || !is_skin(photo.at(x, y))
            });
            if outside.take(6).count() < 6 {
                best = Some((strip.scale, strip));
            }
        }
        best.map(|best| best.1)
    }
}

/// A mark, on the skin of its link.
struct Mark {
    at: [f64; 2],
    radius: f64,
    /// Amplitude and phase of waves about the outline; none on a disc.
    waves: Vec<(f64, f64)>,
    stretch: f64,
    paint: [f64; 3],
    /// The way in which it gets thinner, and how much of it covers there; strokes.
    thin: ([f64; 2], f64),
    stroke: ([f64; 2], f64),
}

impl Mark {
    fn edge(&self, direction: f64) -> f64 {
        let waves =
            self.waves.iter().zip(2..).map(|((size, phase), k)| size * (f64::from(k) * direction + phase).cos());
        1.0 + waves.sum::<f64>()
    }

    /// Of the outline, from the middle it was drawn about.
    fn centroid(&self) -> [f64; 2] {
        let directions = (0..720).map(|k| TAU * f64::from(k) / 720.0);
        let (mut area, mut sum) = (0.0, [0.0; 2]);
        for direction in directions {
            let edge = self.edge(direction);
            area += 0.5 * edge.powi(2);
            sum[0] += edge.powi(3) * direction.cos() / 3.0;
            sum[1] += edge.powi(3) * direction.sin() / 3.0;
        }
        [sum[0] / area * self.radius * self.stretch, sum[1] / area * self.radius]
    }

    /// How much of a place on its link it covers, and how bright its paint is there.
    fn cover(&self, along: f64, across: f64) -> [f64; 2] {
        let [x, y] = [(along - self.at[0]) / self.stretch, across - self.at[1]];
        if x.hypot(y) > 1.5 * self.radius {
            return [0.0; 2];
        }
        let inside = self.radius * self.edge(y.atan2(x)) - x.hypot(y);
        let ([a, b], least) = self.thin;
        let side = (0.5 + 0.5 * (a * x + b * y) / self.radius).clamp(0.0, 1.0);
        let ([p, q], depth) = self.stroke;
        [
            (inside / 0.8 + 0.5).clamp(0.0, 1.0) * (1.0 - side * (1.0 - least)),
            1.0 + depth * (0.6 * (p * x + q * y)).sin(),
        ]
    }
}

fn linear(hex: u32) -> [f64; 3] {
    [16, 8, 0].map(|shift| (f64::from(hex >> shift & 255) / 255.0).powf(2.2))
}

/// Along and across a link that begins somewhere and goes some way.
fn on_link([at, [cos, sin]]: &[[f64; 2]; 2], [x, y]: [f64; 2]) -> [f64; 2] {
    [cos * (x - at[0]) + sin * (y - at[1]), cos * (y - at[1]) - sin * (x - at[0])]
}

/// A film and what is known of it.
pub(crate) struct Film {
    skin: Light,
    strip: Strip,
    behind: Light,
    marks: Vec<Mark>,
    /// Colours in words, for the table.
    pub(crate) paint: String,
    /// How dark the finger's far side is, how much noise there is.
    shade: f64,
    noise: f64,
    bend: [[f64; 2]; 3],
    light: f64,
    pub(crate) seed: u64,
}

impl Film {
    pub(crate) fn new(seed: u64, of_skin: bool) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let (folder, other) = (real_data("nail/vpapenko_cc0/images"), real_data("nail/ti1k"));
        let open = |path: std::path::PathBuf| Light::of(&image::open(path).expect("a photograph").to_rgb8());
        let mut hands: Vec<_> = std::fs::read_dir(folder).expect("hands").map(|e| e.expect("a hand").path()).collect();
        hands.sort();
        let labels = std::fs::read_to_string(other.join("labels.txt")).expect("labels");
        let scenes: Vec<Vec<&str>> = labels.lines().map(|line| line.split_whitespace().collect()).collect();
        let (skin, strip) = loop {
            // A third is brown skin, out of the hand's box.
            let (photo, part) = if random.random_range(0..3) == 0 {
                let cells = &scenes[random.random_range(0..scenes.len())];
                let part = [1, 2, 3, 4].map(|k| cells[k].parse::<f64>().expect("a share") * [480.0, 640.0][k % 2]);
                (open(other.join(cells[0])), part)
            } else {
                let photo = open(hands[random.random_range(0..hands.len())].clone());
                let [width, height] = photo.1.map(|size| size as f64);
                (photo, [0.0, 0.0, width, height])
            };
            if let Some(strip) = Strip::find(&photo, part, &mut random) {
                break (photo, strip);
            }
        };
        let behind = open(other.join(scenes[random.random_range(0..scenes.len())][0]));
        let length: f64 = LINKS.iter().map(|link| link.1).sum();
        let mean = (0..100).map(|k| {
            let [x, y] = strip.place(f64::from(k) / 100.0 * length, 0.0);
            luminance(skin.at(x, y)) / 100.0
        });
        // Skin sends back a third of the light.
        let light = (mean.sum::<f64>() / 0.33).min(1.2);
        let paints = if of_skin { &OF_SKIN[..] } else { &OTHER[..] };
        let (discs, pairs, uneven) = (random.random_bool(0.4), random.random_bool(0.5), random.random_bool(0.35));
        let first = random.random_range(0..paints.len());
        let mut marks = Vec::new();
        for (link, (_, length, half)) in LINKS.iter().enumerate() {
            let paint = linear(paints[(first + if pairs { link } else { 0 }) % paints.len()]);
            for share in [0.22, 0.78] {
                let mut range = |a: f64, b: f64| random.random_range(a..b);
                let (way, lie) = (range(0.0, TAU), range(0.0, TAU));
                marks.push(Mark {
                    at: [share * length + range(-4.0, 4.0), half * range(-0.3, 0.3)],
                    radius: range(8.0, 11.5),
                    waves: if discs {
                        Vec::new()
                    } else {
                        (0..4).map(|_| (range(0.0, 0.09), range(0.0, TAU))).collect()
                    },
                    stretch: if discs { 1.0 } else { range(0.8, 1.6) },
                    paint,
                    thin: ([way.cos(), way.sin()], if uneven && !discs { range(0.3, 0.8) } else { 0.97 }),
                    stroke: ([lie.cos(), lie.sin()], if discs { 0.0 } else { range(0.05, 0.3) }),
                });
            }
        }
        let paint = format!(
            "{}{}{:06x}",
            if discs { "discs" } else { "blots" },
            if uneven { " uneven " } else { " " },
            paints[first]
        ) + if pairs { "..." } else { "" };
        let shade =
            if random.random_bool(0.35) { random.random_range(0.5..0.8) } else { random.random_range(0.0..0.25) };
        let bend = [[5.0, 45.0], [10.0, 70.0], [5.0, 45.0]]
            .map(|[least, more]: [f64; 2]| [least, more * random.random_range(0.6..1.0)].map(f64::to_radians));
        let noise = random.random_range(1.0..4.0);
        Self { skin, strip, behind, marks, paint, shade, noise, bend, light, seed }
    }

    /// Where each link begins and its way, of a moment in frames.
    fn pose(&self, moment: f64) -> Vec<[[f64; 2]; 2]> {
        let phase = 0.5 - 0.5 * (TAU * moment / 60.0).cos();
        let (mut at, mut turn) =
            ([80.0 + 6.0 * (0.05 * moment).sin(), 170.0 + 0.2 * moment], 0.05 * (0.07 * moment).sin());
        let mut links = Vec::new();
        for (link, (_, length, _)) in LINKS.iter().enumerate() {
            if link > 0 {
                turn += self.bend[link - 1][0] + self.bend[link - 1][1] * phase;
            }
            let way = [turn.cos(), turn.sin()];
            links.push([at, way]);
            at = [0, 1].map(|axis| at[axis] + length * way[axis]);
        }
        links
    }

    fn centre(&self, mark: usize, moment: f64) -> [f64; 2] {
        let (mark, [at, [cos, sin]]) = (&self.marks[mark], self.pose(moment)[mark / 2]);
        let centroid = mark.centroid();
        let [x, y] = [mark.at[0] + centroid[0], mark.at[1] + centroid[1]];
        [at[0] + x * cos - y * sin, at[1] + x * sin + y * cos]
    }

    pub(crate) fn truth_deg(&self, joint: usize, frame: usize) -> f64 {
        let way = |link: usize| {
            let [a, b] = [0, 1].map(|end| self.centre(2 * link + end, frame as f64));
            (b[1] - a[1]).atan2(b[0] - a[0])
        };
        let turn = way(joint + 1) - way(joint);
        turn.sin().atan2(turn.cos()).to_degrees()
    }

    /// The link that a place is on, how far along, across and outside of it, and how much skin lies before it.
    fn on_finger(pose: &[[[f64; 2]; 2]], place: [f64; 2]) -> (usize, [f64; 3], f64) {
        let (mut best, mut before) = ((0, [0.0, 0.0, f64::INFINITY], 0.0), 0.0);
        for (link, one) in pose.iter().enumerate() {
            let (_, length, half) = LINKS[link];
            let [along, across] = on_link(one, place);
            let outside = across.hypot(along - along.clamp(0.0, length)) - half;
            if outside < best.1[2] {
                best = (link, [along, across, outside], before);
            }
            before += length;
        }
        best
    }

    /// The light at a place.
    fn look(&self, pose: &[[[f64; 2]; 2]], moment: f64, at: [f64; 2]) -> [f64; 3] {
        let (link, [along, across, outside], before) = Self::on_finger(pose, at);
        if outside > 0.0 {
            return self.behind.at(at[0] + 15.0 * (0.03 * moment).sin(), at[1] + 0.1 * moment);
        }
        let [u, v] = self.strip.place(before + along, across);
        let skin = self.skin.at(u, v);
        let share = across / LINKS[link].2;
        let dark = 1.0 - self.shade * (0.5 + 0.5 * share).clamp(0.0, 1.0).powf(1.5);
        let shine = 0.05 * self.light * (-((share + 0.45) / 0.12).powi(2)).exp();
        let own = (luminance(skin) / (0.33 * self.light)).clamp(0.1, 2.0).sqrt();
        let mut light = skin.map(|part| part * dark);
        // A mark lies over a joint's crease in one piece.
        for (k, mark) in self.marks.iter().enumerate() {
            let [along, across] = on_link(&pose[k / 2], at);
            let [cover, bright] = mark.cover(along, across);
            // Paint shows what skin has below, a sticker does not.
            let own = if mark.waves.is_empty() { 1.0 } else { own };
            for (part, paint) in light.iter_mut().zip(mark.paint) {
                *part += cover * (paint * bright * self.light * own * dark + shine - *part);
            }
        }
        light
    }

    fn picture(&self, frame: usize, [encoded, noise]: [&[f64]; 2], random: &mut ChaCha8Rng) -> Picture {
        const SUBS: [[f64; 2]; 4] = [[-0.25, -0.25], [0.25, -0.25], [0.25, 0.25], [-0.25, 0.25]];
        let [width, height] = SIZE;
        let moments = [-0.18, 0.06, 0.18, -0.06].map(|late| frame as f64 + late);
        let poses = moments.map(|moment| self.pose(moment));
        let flicker = 1.0 + 0.03 * (1.3 * frame as f64).sin();
        let mut full = vec![[0.0; 3]; width * height];
        let first = random.random_range(0..NOISE);
        for (k, pixel) in full.iter_mut().enumerate() {
            let place = [(k % width) as f64, (k / width) as f64];
            let near = Self::on_finger(&poses[1], place).1[2] < 3.0;
            let subs = if near { &SUBS[..] } else { &SUBS[..1] };
            let mut light = [0.0; 3];
            for (sub, [dx, dy]) in subs.iter().enumerate() {
                let one = self.look(&poses[sub], moments[sub], [place[0] + dx, place[1] + dy]);
                (0..3).for_each(|c| light[c] += one[c] / subs.len() as f64);
            }
            let noisy = [0, 1, 2].map(|c| {
                let root = ((light[c] * flicker).min(1.0).sqrt() * 4095.0) as usize;
                (encoded[root] + noise[(first + 3 * k + c) % NOISE]).clamp(0.0, 1.0)
            });
            *pixel = Matrix::BT709.from_rgb(noisy);
        }
        let mut picture = Picture::new(FORMAT);
        let byte = |value: f64| value.round().clamp(0.0, 255.0) as u8;
        picture.planes[0] = full.iter().map(|pixel| byte(pixel[0])).collect();
        for (plane, samples) in picture.planes.iter_mut().enumerate().skip(1) {
            let at = |x: usize, y: usize| full[y * width + x.min(width - 1)][plane];
            let column = |x: usize, y: usize| 0.5 * (at(x, y) + at(x, y + 1));
            *samples = (0..width * height / 4)
                .map(|k| (2 * (k % (width / 2)), 2 * (k / (width / 2))))
                .map(|(x, y)| byte(0.5 * column(x, y) + 0.25 * (column(x.saturating_sub(1), y) + column(x + 1, y))))
                .collect();
        }
        picture
    }

    pub(crate) fn write(&self, dir: &Dir) {
        let mut random = ChaCha8Rng::seed_from_u64(self.seed + 1_000_000);
        let encoding = Encoding { crf: 23, preset: "veryfast", ..Encoding::new(FORMAT) };
        let mut encoder = Encoder::create(&dir.place("film.mp4"), &encoding).expect("a film");
        // By the root of light; and the noise of a frame, from any number on.
        let encoded: Vec<f64> = (0..4096).map(|k| (f64::from(k) / 4095.0).powf(2.0 / 2.2)).collect();
        let normal = |_| (0..3).map(|_| random.random_range(-1.0..1.0)).sum::<f64>() * self.noise / 255.0;
        let noise: Vec<f64> = (0..NOISE).map(normal).collect();
        for k in 0..FRAMES {
            let picture = self.picture(k, [&encoded, &noise], &mut random);
            encoder.push(&picture, 33 * k as i64).expect("a picture");
        }
        encoder.finish().expect("a film");
        let mut lines =
            ["flexion = \"clockwise\"\n[markers]\n", "[start]\n", "[segments]\n", "[joints]\n"].map(String::from);
        for (k, mark) in self.marks.iter().enumerate() {
            let name = format!("{}_{}", LINKS[k / 2].0, ["prox", "dist"][k % 2]);
            // As a person picks it.
            let [x, y] = self.centre(k, 0.0).map(|part| part + random.random_range(-4.0..4.0));
            let seen = mark.paint.map(|part| (255.0 * (part * self.light).min(1.0).powf(1.0 / 2.2)) as u8);
            lines[0] += &format!("{name} = \"#{:02x}{:02x}{:02x}\"\n", seen[0], seen[1], seen[2]);
            lines[1] += &format!("{name} = [{x:.1}, {y:.1}]\n");
        }
        for (k, (name, ..)) in LINKS.iter().enumerate() {
            lines[2] += &format!("{name} = [\"{name}_prox\", \"{name}_dist\"]\n");
            if k > 0 {
                lines[3] += &format!("{} = [\"{}\", \"{name}\"]\n", JOINTS[k - 1], LINKS[k - 1].0);
            }
        }
        dir.write("markers.toml", lines.concat());
    }
}

const FORMAT: Format = Format { width: SIZE[0], height: SIZE[1], subsampling: Some((2, 2)), depth: 8 };
