//! Values of virtual photodiodes and cells in a frame whose motion is known.
//!
//! In: a frame, and where the nail is in it. Out: for each region its value in the unit of [`Light`], or why there is
//! none. What lies over the nail is known by its colour: blood moves the colours of nail and skin along one line in
//! (ln green/red, ln blue/red) and leaves red nearly alone; a rod, another finger or glare does not.

mod colour;
mod region;
#[cfg(test)]
mod tests;

pub(in crate::nailvideo) use colour::Colours;
pub(in crate::nailvideo) use region::{Group, MARGIN, Region, cell_name, cells, discs};

use region::{light_cells, skin};

use super::affine::Affine;
use super::options::Light;

/// Where a group's colour may go from that of the first good frame, natural logarithms, less what the light changed: of
/// green over red (measured on real presses: -0.1 to 0.22; the rest is room for other people), ..
const GREEN: std::ops::RangeInclusive<f64> = -0.30..=0.45;
/// .. of blue over red from the line of blood, ..
const BLUE_OF_GREEN: f64 = 0.45;
const MOST_BLUE: f64 = 0.20;
/// .. of red, or of a grey video's luma (assumed: light differs by up to 12 % over the nail, blood by up to 5 % in red
/// and 26 % in luma).
const MOST_RED: f64 = 0.25;
const MOST_GREY: f64 = 0.40;
/// A region is hidden where more than this share of its points is (section 2.4 of the design).
const MOST_HIDDEN: f64 = 0.25;
/// Nothing is known of the light where fewer of its cells are seen.
const LEAST_SEEN: f64 = 0.4;
/// Samples from here on are clipped, and below here dark: no logarithm means anything (assumed).
const CLIPPED: f64 = 0.985;
const DARK: f64 = 0.02;
/// SD of a disc's mean chroma as decoded, of 255 levels (measured on the phantom at a rate factor of 18: encoders keep
/// a flat place's mean to a step or so; a uniform error of a step is 0.29).
const CHROMA_SD: f64 = 0.2;
/// A slope is measured over so many pixels to each side.
const SLOPE_PX: f64 = 1.5;

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
    /// How much it changes when the region is off by a pixel, across and down the picture.
    pub(in crate::nailvideo) slope_per_px: f64,
    /// Its error by the encoder's steps of chroma, SD: they last over frames, so that these do not show it.
    pub(in crate::nailvideo) chroma_sd: f64,
}

/// What is measured of each frame.
#[derive(Debug)]
pub(in crate::nailvideo) struct Sampler {
    light: Light,
    grey: bool,
    regions: Vec<Watched>,
    cells: Vec<Option<[f64; 3]>>,
    groups: Vec<Group>,
    skin: Group,
    /// For medians.
    sorted: Vec<f64>,
}

/// A region, with its groups' colours in the first good frame.
#[derive(Debug)]
struct Watched {
    region: Region,
    first: Vec<[f64; 3]>,
    slope_per_px: f64,
    chroma_sd: f64,
}

/// Logarithms of a colour: of red, of green over red, of blue over red; `None` where a part is not positive.
fn logs([red, green, blue]: [f64; 3]) -> Option<[f64; 3]> {
    let logs = [red.ln(), (green / red).ln(), (blue / red).ln()];
    logs.iter().all(|part| part.is_finite()).then_some(logs)
}

impl Sampler {
    /// Of regions on the nail of the first good frame.
    pub(in crate::nailvideo) fn new(
        regions: Vec<Region>,
        light: Light,
        grey: bool,
        first: &Colours,
        frame_from_nail: &Affine,
    ) -> Self {
        let groups = light_cells();
        let cells = groups.iter().map(|group| logs(first.mean(group, frame_from_nail))).collect();
        let skin = skin();
        let skin_green = first.mean(&skin, frame_from_nail)[1];
        let slope = |region: &Region| {
            let at = |dx: f64, dy: f64| {
                let [a, b, c, d, e, f] = frame_from_nail.0;
                let moved = Affine([a, b, c + dx, d, e, f + dy]);
                let rgb = mean_of(region.groups.iter().map(|group| (group, first.mean(group, &moved))));
                value_of(light, rgb, skin_green)
            };
            let along = |x: f64, y: f64| (at(SLOPE_PX * x, SLOPE_PX * y) - at(-SLOPE_PX * x, -SLOPE_PX * y)).abs();
            along(1.0, 0.0).hypot(along(0.0, 1.0)) / (2.0 * SLOPE_PX)
        };
        let levels = first.of_chroma_levels();
        let chroma = |region: &Region| {
            let rgb = mean_of(region.groups.iter().map(|group| (group, first.mean(group, frame_from_nail))));
            let value = value_of(light, rgb, skin_green);
            let by = levels.map(|level| value_of(light, [0, 1, 2].map(|c| rgb[c] + level[c]), skin_green) - value);
            CHROMA_SD * by[0].hypot(by[1])
        };
        let watched = |region: Region| {
            let (slope_per_px, chroma_sd) = (slope(&region), chroma(&region));
            let first = region.groups.iter().map(|group| first.mean(group, frame_from_nail)).collect();
            Watched { region, first, slope_per_px, chroma_sd }
        };
        let regions = regions.into_iter().map(watched).collect();
        Self { light, grey, regions, cells, groups, skin, sorted: Vec::new() }
    }

    /// The values of all regions where the nail is at `frame_from_nail`.
    pub(in crate::nailvideo) fn sample(
        &mut self,
        colours: &Colours,
        frame_from_nail: &Affine,
        into: &mut Vec<Result<Sampled, Absent>>,
    ) {
        let light = self.light_change(colours, frame_from_nail);
        let skin = match self.light {
            Light::Skin => colours.mean(&self.skin, frame_from_nail)[1],
            _ => f64::NAN,
        };
        into.clear();
        for watched in &self.regions {
            into.push(self.one(watched, colours, frame_from_nail, light, skin));
        }
    }

    /// The skin's own colour about the nail, in the unit of the values: what of a change is the light's.
    pub(in crate::nailvideo) fn skin(&self, colours: &Colours, frame_from_nail: &Affine) -> f64 {
        let rgb = colours.mean(&self.skin, frame_from_nail);
        value_of(if self.light == Light::Skin { Light::Red } else { self.light }, rgb, f64::NAN)
    }

    fn one(
        &self,
        watched: &Watched,
        colours: &Colours,
        frame_from_nail: &Affine,
        light: Option<[f64; 3]>,
        skin: f64,
    ) -> Result<Sampled, Absent> {
        let (mut all, mut hidden) = (0, 0);
        let means = watched.region.groups.iter().zip(&watched.first).map(|(group, first)| {
            let rgb = colours.mean(group, frame_from_nail);
            all += group.points.len();
            if light.is_none_or(|light| self.is_strange(rgb, *first, light)) {
                hidden += group.points.len();
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
        let value = value_of(self.light, rgb, skin);
        let &Watched { slope_per_px, chroma_sd, .. } = watched;
        if value.is_finite() { Ok(Sampled { value, slope_per_px, chroma_sd }) } else { Err(Absent::NoSkin) }
    }

    /// Whether a colour can't be that of the same place with other blood in other light.
    fn is_strange(&self, now: [f64; 3], first: [f64; 3], light: [f64; 3]) -> bool {
        let (Some(now), Some(first)) = (logs(now), logs(first)) else { return true };
        let [red, green, blue] = std::array::from_fn(|k| now[k] - first[k] - light[k]);
        if self.grey {
            return red.abs() > MOST_GREY;
        }
        red.abs() > MOST_RED || !GREEN.contains(&green) || (blue - BLUE_OF_GREEN * green).abs() > MOST_BLUE
    }

    /// What the light changed: medians over the nail of the logarithms of colours; `None` where too little is seen.
    fn light_change(&mut self, colours: &Colours, frame_from_nail: &Affine) -> Option<[f64; 3]> {
        let changes: Vec<[f64; 3]> = self
            .groups
            .iter()
            .zip(&self.cells)
            .filter_map(|(group, first)| {
                let (now, first) = (logs(colours.mean(group, frame_from_nail))?, (*first)?);
                Some(std::array::from_fn(|k| now[k] - first[k]))
            })
            .collect();
        if (changes.len() as f64) < LEAST_SEEN * self.groups.len() as f64 {
            return None;
        }
        Some(std::array::from_fn(|k| {
            self.sorted.clear();
            self.sorted.extend(changes.iter().map(|change| change[k]));
            let middle = self.sorted.len() / 2;
            *self.sorted.select_nth_unstable_by(middle, f64::total_cmp).1
        }))
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

fn value_of(light: Light, [red, green, _]: [f64; 3], skin: f64) -> f64 {
    match light {
        Light::Red => 100.0 * (green / red).ln(),
        Light::Skin => 100.0 * (green / skin).ln(),
        Light::None => green,
    }
}
