//! Values of virtual photodiodes and cells in a frame whose motion is known.
//!
//! In: a frame, and where the nail is in it. Out: for each region its value in the unit of [`Light`], or why there is
//! none. What lies over the nail is known by its colour: blood moves the colours of nail and skin along one line in
//! (ln green/red, ln blue/red) and leaves red nearly alone; a rod or glare does not. Another finger may, and is known
//! by its rim.
//!
//! Values are of light, as a photodiode's are: the film's curve is undone of a region's mean colour, so that a change
//! of brightness is a factor, which the ratio of two channels does not have. As encoded the ratio moved by 1.7 to 3.2
//! of 100 where the light fell by 30 %. Light that is averaged in place of colours differs by at most 0.11 of 100
//! (ratio, and green light; discs of four phantoms, at rest and pressed), where a standard error is 0.5. What lies over
//! the nail, what is clipped and what is dark are judged of colours as encoded.

mod colour;
mod cover;
mod noise;
mod region;
#[cfg(test)]
mod tests;

pub(in crate::nailvideo) use colour::{Channel, Colours, Planes};
pub(in crate::nailvideo) use region::{Group, MARGIN, Region, cell_name, cells, discs};

use cover::{box_cells, covered_by, points_covered};
use noise::Noise;
use region::{light_cells, skin, spread_discs};

use super::affine::Affine;
use super::follow::{Covered, Rim};
use super::options::Light;
use crate::median::median_of;
use crate::nail::Positions;

/// How far a colour may go from that of the first good frame, natural logarithms, less what the light changed.
#[derive(Debug, Clone, Copy)]
struct Limits {
    /// Of green over red.
    green: f64,
    /// Of blue over red from the line of blood.
    blue: f64,
    /// Of red, or of a grey video's luma.
    red: f64,
    grey: f64,
}

/// Change of blue over red with that of green over red, as blood has it.
const BLUE_OF_GREEN: f64 = 0.45;
/// A region is hidden where more than this share of its points is (section 2.4 of the design).
const MOST_HIDDEN: f64 = 0.25;
/// Nothing is known of the light where fewer of its cells are seen.
const LEAST_SEEN: f64 = 0.4;
/// Samples from here on are clipped, and below here dark: no logarithm means anything (assumed).
const CLIPPED: f64 = 0.985;
const DARK: f64 = 0.02;
/// SD of what encoders leave of a disc's mean chroma over a whole video, of 255 levels (measured on the phantom at a
/// rate factor of 18: they keep a flat place's mean to a step or so; a uniform error of a step is 0.29).
const CHROMA_SD: f64 = 0.12;
/// A change at a place is off by this many pixels over the place's diameter, SD, as chroma is coarser than luma and
/// encoders leave out what is small (measured on the phantom: green over red is off by 1 % of its change at 16 px, by
/// 7 % at 3.3 px; green, which is luma for the most part, by half as much).
const RATIO_CHANGE_PX: f64 = 0.22;
const GREEN_CHANGE_PX: f64 = 0.1;
/// Slopes and curvatures are measured over so many pixels to each side, and once in so many frames, as is how the discs
/// of [`noise`] change.
const SLOPE_PX: f64 = 1.5;
const EVERY: usize = 4;
/// Variance of what chroma is blurred by, pixels squared: a block's mean 0.25, interpolation between blocks 0.67.
const BLUR_PX2: f64 = 0.92;

/// Why a region has no value in a frame in which the nail is followed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::nailvideo) enum Absent {
    /// Beyond the picture's border.
    Outside,
    /// Something is over it.
    Hidden,
    /// Too bright for the camera.
    Clipped,
    /// Too dark.
    Dark,
    /// The skin that is compared with is not seen.
    NoSkin,
}

impl Absent {
    /// In tables.
    pub(in crate::nailvideo) fn name(self) -> &'static str {
        match self {
            Self::Outside => "outside",
            Self::Hidden => "hidden",
            Self::Clipped => "clipped",
            Self::Dark => "dark",
            Self::NoSkin => "no skin",
        }
    }
}

/// A region's value in a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::nailvideo) struct Sampled {
    /// In the unit of the light.
    pub(in crate::nailvideo) value: f64,
    /// The logarithm of red light, less what the light on the nail changed; NaN in a grey video.
    pub(in crate::nailvideo) red: f32,
    /// The logarithms of green and of blue light over red; NaN in a grey video.
    pub(in crate::nailvideo) ratios: [f32; 2],
    /// How much it changes when the region is off by a pixel, across and down the picture.
    pub(in crate::nailvideo) slope_per_px: f32,
    /// Its error by the encoder's steps of chroma, by the blur between samples and by what both take off a change, SD:
    /// they last, so that no difference between frames shows them.
    pub(in crate::nailvideo) steady_sd: f32,
}

/// What is measured of each frame.
#[derive(Debug)]
pub(in crate::nailvideo) struct Sampler {
    light: Light,
    grey: bool,
    regions: Vec<Watched>,
    /// Those that say how the light changed.
    cells: Cells,
    /// Those that may be covered.
    under: Cells,
    skin: Group,
    /// Discs as large as photodiodes, all over the nail.
    spread: Vec<Watched>,
    noise: Noise,
    /// What is covered in the frame that was sampled last, where something lies over the nail.
    pub(in crate::nailvideo) covered: Option<Covered>,
    frames: usize,
}

/// A region, with its groups' colours in the first good frame.
#[derive(Debug)]
struct Watched {
    region: Region,
    first: Vec<[f64; 3]>,
    /// Its value there.
    first_value: f64,
    /// SD of a change, of the change.
    change_sd: f64,
    shape: Shape,
}

/// Groups with what they show in the first good frame.
#[derive(Debug)]
struct Cells {
    groups: Vec<Group>,
    first: Vec<Option<Logs>>,
}

/// Logarithms of a place, or what they changed by.
#[derive(Debug, Clone, Copy)]
struct Logs {
    /// As encoded, as [`logs`].
    colour: [f64; 3],
    /// Of red light.
    red: f64,
}

impl Logs {
    fn of(colours: &Colours, rgb: [f64; 3]) -> Option<Self> {
        Some(Self { colour: logs(rgb)?, red: colours.light_of(rgb)[0].ln() })
    }

    fn since(self, first: Self) -> Self {
        Self { colour: std::array::from_fn(|k| self.colour[k] - first.colour[k]), red: self.red - first.red }
    }
}

impl Cells {
    fn new(groups: Vec<Group>, first: &Colours, frame_from_nail: &Affine) -> Self {
        let first = groups.iter().map(|group| Logs::of(first, first.mean(group, frame_from_nail))).collect();
        Self { groups, first }
    }

    fn changes(&self, colours: &Colours, frame_from_nail: &Affine) -> impl Iterator<Item = (&Group, Option<Logs>)> {
        self.groups.iter().zip(&self.first).map(|(group, first)| {
            let now = Logs::of(colours, colours.mean(group, frame_from_nail));
            (group, now.zip(*first).map(|(now, first)| now.since(first)))
        })
    }
}

/// How a region's value changes with its place, and with what encoders leave of its chroma.
#[derive(Debug, Clone, Copy)]
struct Shape {
    /// For a pixel, along the steepest way.
    slope_per_px: f64,
    /// What the blur between samples changes.
    blurred: f64,
    /// SD by the encoder's steps of chroma: the darker, the larger.
    chroma_sd: f64,
}

/// Logarithms of a colour or of its light: of red, of green over red, of blue over red; `None` where a part is not
/// positive.
fn logs([red, green, blue]: [f64; 3]) -> Option<[f64; 3]> {
    let logs = [red.ln(), (green / red).ln(), (blue / red).ln()];
    logs.iter().all(|part| part.is_finite()).then_some(logs)
}

impl Limits {
    /// Where nothing is known to lie over the nail (of green over red measured on real presses: -0.1 to 0.22, on the
    /// phantom's persons to -0.32; the rest is room for other people. Of red and luma assumed: light differs by up to
    /// 12 % over the nail, blood by up to 5 % in red and 26 % in luma).
    const USUAL: Self = Self { green: 0.45, blue: 0.20, red: 0.25, grey: 0.40 };

    /// Whether a change of [`logs`] can't be that of the same place with other blood in a light that changed so.
    fn is_strange(&self, change: [f64; 3], light: [f64; 3], is_grey: bool) -> bool {
        let [red, green, blue] = std::array::from_fn(|k| change[k] - light[k]);
        if is_grey {
            return red.abs() > self.grey;
        }
        red.abs() > self.red || green.abs() > self.green || (blue - BLUE_OF_GREEN * green).abs() > self.blue
    }
}

impl Sampler {
    /// Of regions on the nail of the first good frame; `extent_px` are its width and length.
    pub(in crate::nailvideo) fn new(
        regions: Vec<Region>,
        positions: &Positions,
        extent_px: [f64; 2],
        light: Light,
        grey: bool,
        first: &Colours,
        frame_from_nail: &Affine,
    ) -> Self {
        let [cells, under] = [light_cells(), box_cells()].map(|groups| Cells::new(groups, first, frame_from_nail));
        let skin = skin();
        let skin_green = first.light_of(first.mean(&skin, frame_from_nail))[1];
        let watched = |region: Region| {
            let shape = shape(light, &region, first, frame_from_nail, skin_green);
            let lit = first.light_of(region_mean(&region, first, frame_from_nail));
            let first_value = value_of(light, lit, skin_green);
            let change_px = if light == Light::None { GREEN_CHANGE_PX } else { RATIO_CHANGE_PX };
            let change_sd = change_px / (0.5 * extent_px[0] * region.width());
            let first = region.groups.iter().map(|group| first.mean(group, frame_from_nail)).collect();
            Watched { region, first, first_value, change_sd, shape }
        };
        let regions = regions.into_iter().map(watched).collect();
        let spread: Vec<Watched> = spread_discs(positions, extent_px).into_iter().map(watched).collect();
        let noise = Noise::new(spread.len());
        Self { light, grey, regions, cells, under, skin, spread, noise, covered: None, frames: 0 }
    }

    /// The values of all regions where the nail is at `frame_from_nail`; `rim` is that of what lies over it.
    pub(in crate::nailvideo) fn sample(
        &mut self,
        colours: &Colours,
        frame_from_nail: &Affine,
        rim: Option<&Rim>,
        into: &mut Vec<Result<Sampled, Absent>>,
    ) {
        self.covered = rim.map(|rim| covered_by(rim, self.under.changes(colours, frame_from_nail), self.grey));
        let light = self.light_change(colours, frame_from_nail);
        let skin = if self.light == Light::Skin { self.skin_light(colours, frame_from_nail)[1] } else { f64::NAN };
        if self.frames.is_multiple_of(EVERY) {
            for watched in &mut self.regions {
                watched.shape = shape(self.light, &watched.region, colours, frame_from_nail, skin);
            }
            let one = |watched| Some(self.one(watched, colours, frame_from_nail, light, skin).ok()?.value);
            let values: Option<Vec<f64>> = self.spread.iter().map(one).collect();
            values.iter().for_each(|values| self.noise.add(values));
        }
        self.frames += 1;
        into.clear();
        for watched in &self.regions {
            into.push(self.one(watched, colours, frame_from_nail, light, skin));
        }
    }

    /// SD of the noise of a photodiode, that which lasts over frames with it, as it is on average over nail and frames;
    /// `None` where too few frames show the whole nail.
    pub(in crate::nailvideo) fn noise_sd(&self) -> Option<f64> {
        self.noise.sd()
    }

    /// The skin's own colour about the nail, in the unit of the values: what of a change is the light's.
    pub(in crate::nailvideo) fn skin(&self, colours: &Colours, frame_from_nail: &Affine) -> f64 {
        let lit = self.skin_light(colours, frame_from_nail);
        value_of(if self.light == Light::Skin { Light::Red } else { self.light }, lit, f64::NAN)
    }

    /// NaN where too much of it is covered.
    fn skin_light(&self, colours: &Colours, frame_from_nail: &Affine) -> [f64; 3] {
        let covered = self.covered.as_ref().map_or(0, |covered| points_covered(covered, &self.skin));
        let is_seen = covered as f64 <= MOST_HIDDEN * self.skin.points.len() as f64;
        if is_seen { colours.light_of(colours.mean(&self.skin, frame_from_nail)) } else { [f64::NAN; 3] }
    }

    fn one(
        &self,
        watched: &Watched,
        colours: &Colours,
        frame_from_nail: &Affine,
        light: Option<Logs>,
        skin: f64,
    ) -> Result<Sampled, Absent> {
        let (mut all, mut hidden) = (0, 0);
        let means = watched.region.groups.iter().zip(&watched.first).map(|(group, first)| {
            let rgb = colours.mean(group, frame_from_nail);
            all += group.points.len();
            if light.is_none_or(|light| self.is_strange(rgb, *first, light.colour)) {
                hidden += group.points.len();
            } else if let Some(covered) = &self.covered {
                hidden += points_covered(covered, group);
            }
            (group, rgb)
        });
        let rgb = mean_of(means);
        if rgb.iter().any(|part| !part.is_finite()) {
            return Err(Absent::Outside);
        }
        if rgb[0].max(rgb[1]) >= CLIPPED {
            return Err(Absent::Clipped);
        }
        if hidden as f64 > MOST_HIDDEN * f64::from(all as u32) {
            return Err(Absent::Hidden);
        }
        if rgb[0].min(rgb[1]) <= DARK {
            return Err(Absent::Dark);
        }
        let lit = colours.light_of(rgb);
        let value = value_of(self.light, lit, skin);
        let Shape { slope_per_px, blurred, chroma_sd } = watched.shape;
        let [red, green, blue] = logs(lit).filter(|_| !self.grey).unwrap_or([f64::NAN; 3]);
        let of_light = light.filter(|_| !self.grey).map_or(f64::NAN, |light| light.red);
        let sampled = Sampled {
            value,
            red: (red - of_light) as f32,
            ratios: [green as f32, blue as f32],
            slope_per_px: slope_per_px as f32,
            steady_sd: chroma_sd.hypot(blurred).hypot(watched.change_sd * (value - watched.first_value)) as f32,
        };
        if value.is_finite() { Ok(sampled) } else { Err(Absent::NoSkin) }
    }

    /// Whether a colour can't be that of the same place with other blood in other light.
    fn is_strange(&self, now: [f64; 3], first: [f64; 3], light: [f64; 3]) -> bool {
        let (Some(now), Some(first)) = (logs(now), logs(first)) else { return true };
        Limits::USUAL.is_strange(std::array::from_fn(|k| now[k] - first[k]), light, self.grey)
    }

    /// What the light changed: medians over the nail of the logarithms of colours; `None` where too little is seen.
    fn light_change(&self, colours: &Colours, frame_from_nail: &Affine) -> Option<Logs> {
        let changes: Vec<Logs> = self
            .cells
            .changes(colours, frame_from_nail)
            .filter(|(group, _)| self.covered.as_ref().is_none_or(|covered| points_covered(covered, group) == 0))
            .filter_map(|(_, change)| change)
            .collect();
        if (changes.len() as f64) < LEAST_SEEN * self.cells.groups.len() as f64 {
            return None;
        }
        let middle = |of: &dyn Fn(&Logs) -> f64| median_of(changes.iter().map(of)).unwrap_or(f64::NAN);
        let colour = std::array::from_fn(|k| middle(&|change| change.colour[k]));
        Some(Logs { colour, red: middle(&|change| change.red) })
    }
}

fn region_mean(region: &Region, colours: &Colours, frame_from_nail: &Affine) -> [f64; 3] {
    mean_of(region.groups.iter().map(|group| (group, colours.mean(group, frame_from_nail))))
}

/// The shape of a region's value about where it is.
fn shape(light: Light, region: &Region, colours: &Colours, frame_from_nail: &Affine, skin: f64) -> Shape {
    let colour = |[dx, dy]: [f64; 2]| {
        let [a, b, c, d, e, f] = frame_from_nail.0;
        region_mean(region, colours, &Affine([a, b, c + dx, d, e, f + dy]))
    };
    let value = |rgb: [f64; 3]| value_of(light, colours.light_of(rgb), skin);
    let at = |offset: [f64; 2]| value(colour(offset));
    let [left, right, above, below] = [[-SLOPE_PX, 0.0], [SLOPE_PX, 0.0], [0.0, -SLOPE_PX], [0.0, SLOPE_PX]].map(at);
    let rgb = colour([0.0; 2]);
    let here = value(rgb);
    let curvature = (left + right + above + below - 4.0 * here) / (SLOPE_PX * SLOPE_PX);
    let [of_cb, of_cr] = colours.of_chroma_levels().map(|by| value([0, 1, 2].map(|c| rgb[c] + by[c])) - here);
    Shape {
        slope_per_px: (right - left).hypot(below - above) / (2.0 * SLOPE_PX),
        blurred: 0.5 * BLUR_PX2 * curvature.abs(),
        chroma_sd: CHROMA_SD * of_cb.hypot(of_cr),
    }
}

/// The mean over all points of groups.
fn mean_of<'a>(groups: impl Iterator<Item = (&'a Group, [f64; 3])>) -> [f64; 3] {
    let (mut sum, mut count) = ([0.0; 3], 0.0);
    for (group, rgb) in groups {
        let weight = group.points.len() as f64;
        count += weight;
        sum.iter_mut().zip(rgb).for_each(|(sum, part)| *sum += weight * part);
    }
    sum.map(|sum| sum / count)
}

/// Of light; `skin` is the skin's green.
fn value_of(light: Light, [red, green, _]: [f64; 3], skin: f64) -> f64 {
    match light {
        Light::Red => 100.0 * (green / red).ln(),
        Light::Skin => 100.0 * (green / skin).ln(),
        Light::None => green,
    }
}
