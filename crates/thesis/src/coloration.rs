//! The maps of photographs (4.2.2 to 4.2.6): one subject's coloration in all poses (Fig. 51 and 52), and numbers of the
//! average maps.
//!
//! In: a folder as `lunula photos` writes it, its poses named as the thesis' eight. Out: sheets of one subject's
//! normalized pictures, and [`Numbers`].
//!
//! Places on the nail: `u` across, from -1 at the left edge of its box to 1 at the right, `v` along, from -1 proximal
//! to 1 distal; the thesis shows pictures and no numbers, so the regions are read off its words ([`REGIONS`]). A change
//! is a region's mean less that of the nominal pose. `<pose>.P1` and on are means over the photodiodes' discs, at the
//! thesis' places. Values are shares of full scale.

use std::path::Path;

use anyhow::{Context, bail};
use image::GrayAlphaImage;
use ndarray::{Array2, Axis, Slice};

use super::Numbers;
use lunula::figure::{Scale, Sheet, Stretch, Tile, TilePicture, grey_map};
use lunula::files::Staging;
use lunula::nail::{Position, Positions};
use lunula::npy;
use lunula::phantom::nail::Pose;

/// The box's share of the normalized picture: 320 of 400 pixels (4.2.2).
const BOX: f64 = 0.8;
/// The threshold of Fig. 55.
const THRESHOLD: f32 = 105.0 / 255.0;
/// The stretch of Fig. 52 and 54.
const CONTRAST: [f32; 2] = [0.3, 0.5];

/// Whether a place belongs to a region.
type Within = fn(f64, f64) -> bool;

/// Regions by name: over the bone and its two sides, the tip beyond the bone, the sides of the nail, the bed, the
/// nail's perimeter.
pub(crate) const REGIONS: [(&str, Within); 8] = [
    ("bone", |u, v| u.abs() < 0.35 && (-0.6..0.05).contains(&v)),
    ("bone_left", |u, v| (-0.5..-0.1).contains(&u) && (-0.5..0.2).contains(&v)),
    ("bone_right", |u, v| (0.1..0.5).contains(&u) && (-0.5..0.2).contains(&v)),
    ("tip", |u, v| u.abs() < 0.5 && (0.5..0.8).contains(&v)),
    ("left", |u, v| (-0.85..-0.62).contains(&u) && (-0.2..0.4).contains(&v)),
    ("right", |u, v| (0.62..0.85).contains(&u) && (-0.2..0.4).contains(&v)),
    ("bed", |u, v| u.hypot(v) < 0.75),
    ("perimeter", |u, v| (0.9..1.12).contains(&u.hypot(v))),
];

/// A map and how it is asked.
struct Map(Array2<f32>);

impl Map {
    fn read(path: &Path) -> anyhow::Result<Self> {
        Ok(Self(npy::read(path).map_err(|why| anyhow::anyhow!("{}: {why}", path.display()))?))
    }

    /// Known values of a region.
    fn of(&self, within: impl Fn(f64, f64) -> bool) -> Vec<f64> {
        let size = self.0.nrows() as f64;
        let half = 0.5 * BOX * size;
        let inside = self.0.indexed_iter().filter(|((row, column), value)| {
            let (u, v) = ((*column as f64 + 0.5 - 0.5 * size) / half, (0.5 * size - *row as f64 - 0.5) / half);
            within(u, v) && value.is_finite()
        });
        inside.map(|(_, value)| f64::from(*value)).collect()
    }

    fn mean(&self, within: impl Fn(f64, f64) -> bool) -> Option<f64> {
        mean(&self.of(within))
    }

    fn mirrored(&self) -> Self {
        Self(self.0.slice_axis(Axis(1), Slice::new(0, None, -1)).to_owned())
    }
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

fn sd(values: &[f64]) -> Option<f64> {
    let mean = mean(values)?;
    Some((values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt())
}

fn correlation(a: &[f64], b: &[f64]) -> Option<f64> {
    let (mean_a, mean_b) = (mean(a)?, mean(b)?);
    let product = a.iter().zip(b).map(|(a, b)| (a - mean_a) * (b - mean_b)).sum::<f64>() / a.len() as f64;
    let spread = sd(a)? * sd(b)?;
    (a.len() == b.len() && spread > 0.0).then(|| product / spread)
}

fn region(name: &str) -> Within {
    REGIONS.iter().find(|(own, _)| *own == name).map_or(|_, _| false, |(_, within)| *within)
}

pub(crate) fn region_mean(picture: &Array2<f32>, name: &str) -> Option<f64> {
    Map(picture.clone()).mean(region(name))
}

/// Numbers of the average maps in a folder of `lunula photos`; what is missing is not reported.
pub(crate) fn coloration_numbers(photos: &Path) -> anyhow::Result<Numbers> {
    let mut numbers = Numbers::default();
    let map = |pose: Pose, what: &str| -> anyhow::Result<Option<Map>> {
        let path = photos.join(format!("maps/{pose}-{what}.npy"));
        if path.is_file() { Map::read(&path).map(Some) } else { Ok(None) }
    };
    let mut means: Vec<(Pose, Map)> = Vec::new();
    let mut spreads: Vec<Map> = Vec::new();
    let mut counts: Vec<f64> = Vec::new();
    for pose in Pose::ALL {
        let Some(found) = map(pose, "mean")? else { continue };
        means.push((pose, found));
        spreads.extend(map(pose, "sd")?);
        let path = photos.join(format!("maps/{pose}-count.npy"));
        if path.exists() {
            let count = npy::read::<u32>(&path).map_err(|why| anyhow::anyhow!("{}: {why}", path.display()))?;
            counts.extend(count.iter().max().map(|most| f64::from(*most)));
        }
    }
    numbers.set("poses", (!means.is_empty()).then_some(means.len() as f64));
    let most = counts.iter().copied().reduce(f64::max);
    numbers.set("subjects", most);
    numbers.set("subjects_lacking", most.map(|most| counts.iter().map(|count| most - count).sum::<f64>()));
    numbers.set("size_px", means.first().map(|(_, map)| map.0.nrows() as f64));
    let of = |pose: Pose| means.iter().find(|(own, _)| *own == pose).map(|(_, map)| map);
    let bed = region("bed");
    let nominal = of(Pose::Nominal);
    let sensor = Positions::thesis();
    for (pose, map) in &means {
        for (name, within) in REGIONS {
            let value = map.mean(within);
            numbers.set(format!("{pose}.{name}"), value);
            let rest = nominal.and_then(|nominal| nominal.mean(within));
            numbers.set(format!("{pose}.{name}_change"), value.zip(rest).map(|(value, rest)| value - rest));
        }
        for Position { name, u, v } in &sensor.photodiodes {
            let disc = |x: f64, y: f64| (x - u).hypot(y - v) <= 2.0 * sensor.radius_widths();
            numbers.set(format!("{pose}.{name}"), map.mean(disc));
        }
        let values = map.of(bed);
        let white = values.iter().filter(|value| **value > f64::from(THRESHOLD)).count() as f64;
        numbers.set(format!("{pose}.white_share"), white / values.len() as f64);
    }
    let beds: Vec<f64> = means.iter().flat_map(|(_, map)| map.of(bed)).collect();
    let share =
        |holds: &dyn Fn(f64) -> bool| beds.iter().filter(|value| holds(**value)).count() as f64 / beds.len() as f64;
    let [low, high] = CONTRAST.map(f64::from);
    numbers.set("share_30_to_50", share(&|value| (low..=high).contains(&value)));
    numbers.set("share_above_105", share(&|value| value > f64::from(THRESHOLD)));
    alike(&mut numbers, &means);
    let spread = |within: Within| mean(&spreads.iter().filter_map(|map| map.mean(within)).collect::<Vec<_>>());
    numbers.set("sd_bed", spread(bed));
    numbers.set("sd_perimeter", spread(region("perimeter")));
    let uneven: Vec<f64> = spreads.iter().filter_map(|map| Some(sd(&map.of(bed))? / map.mean(bed)?)).collect();
    numbers.set("sd_bed_unevenness", mean(&uneven));
    numbers.set("mean_error", spread(bed).zip(most).map(|(sd, n)| sd / n.sqrt()));
    Ok(numbers)
}

/// How much the poses' patterns are like each other: of what they change against the nominal pose, over the bed.
fn alike(numbers: &mut Numbers, means: &[(Pose, Map)]) {
    let bed = region("bed");
    let of = |pose: Pose| means.iter().find(|(own, _)| *own == pose).map(|(_, map)| map);
    let pattern = |pose: Pose| of(pose).map(|map| map.of(bed));
    let both = |a: Option<Vec<f64>>, b: Option<Vec<f64>>| correlation(&a?, &b?);
    let mirrored = of(Pose::LateralPositive).map(|map| map.mirrored().of(bed));
    numbers.set("lateral_mirrored", both(pattern(Pose::LateralNegative), mirrored));
    let like = |a, b| both(pattern(a), pattern(b));
    numbers.set("longitudinal_negative_like_normal", like(Pose::LongitudinalNegative, Pose::Normal));
    numbers.set("longitudinal_positive_like_extension", like(Pose::LongitudinalPositive, Pose::Extension));
    let pairs = (0..means.len()).flat_map(|a| (a + 1..means.len()).map(move |b| (a, b)));
    let apart = pairs.filter_map(|(a, b)| {
        let apart = Map(&means[a].1.0 - &means[b].1.0);
        let squares: Vec<f64> = apart.of(bed).iter().map(|value| value * value).collect();
        mean(&squares).map(f64::sqrt)
    });
    numbers.set("least_difference", apart.reduce(f64::min));
}

/// A normalized picture; NaN where it is transparent.
pub(crate) fn grey_picture(path: &Path) -> anyhow::Result<Array2<f32>> {
    let picture = image::open(path).with_context(|| path.display().to_string())?.to_luma_alpha16();
    let size = (picture.height() as usize, picture.width() as usize);
    let level = |pixel: &image::LumaA<u16>| if pixel.0[1] == 0 { f32::NAN } else { f32::from(pixel.0[0]) / 65535.0 };
    Ok(Array2::from_shape_vec(size, picture.pixels().map(level).collect())?)
}

/// One subject's normalized pictures, `<pose>/<subject>.png` in a folder: as they are (Fig. 51) and with 30 to 50 %
/// stretched (Fig. 52). Tells which subject's.
///
/// # Errors
/// No subject has a picture of every pose there is, a picture that can't be read, a folder that can't be written to.
pub(crate) fn coloration_sheets(pictures: &Path, subject: Option<&str>, out: &Path) -> anyhow::Result<String> {
    let poses: Vec<Pose> = Pose::ALL.into_iter().filter(|pose| pictures.join(pose.name()).is_dir()).collect();
    let Some(first) = poses.first() else {
        bail!("there are no pictures of the thesis' poses; name poses {}", Pose::ALL.map(Pose::name).join(", "))
    };
    let place = |pose: Pose, subject: &str| pictures.join(pose.name()).join(format!("{subject}.png"));
    let mut subjects: Vec<String> = std::fs::read_dir(pictures.join(first.name()))?
        .filter_map(|entry| Some(entry.ok()?.file_name().to_string_lossy().strip_suffix(".png")?.to_owned()))
        .collect();
    subjects.sort();
    let whole = |subject: &String| poses.iter().all(|pose| place(*pose, subject).is_file());
    let chosen = match subject {
        Some(subject) => subjects.iter().find(|own| *own == subject),
        None => subjects.iter().find(|subject| whole(subject)),
    };
    let Some(subject) = chosen else { bail!("no subject has a picture of every pose; choose one with `subject`") };
    let maps = poses.iter().map(|pose| grey_picture(&place(*pose, subject))).collect::<anyhow::Result<Vec<_>>>()?;
    let staging = Staging::new(out)?;
    let [low, high] = CONTRAST;
    for (name, title, stretch) in [
        ("typical", "as normalized", Stretch::Linear { low: 0.0, high: 1.0 }),
        ("typical-contrast", "30-50 % stretched to the full range", Stretch::Linear { low, high }),
    ] {
        let drawn: Vec<GrayAlphaImage> = maps.iter().map(|map| grey_map(map, stretch)).collect();
        let tiles = poses.iter().zip(drawn).map(|(pose, picture)| Tile {
            caption: pose.name().replace('_', " "),
            picture: TilePicture::Grey(picture),
            png: None,
        });
        let sheet = Sheet {
            title: format!("Subject {subject}, {title}"),
            tiles: tiles.collect(),
            columns: 4,
            scale: Some(Scale { stretch, label: "intensity, % of full scale".to_owned() }),
        };
        let (png, svg) = (format!("{name}.png"), format!("{name}.svg"));
        staging.write(&png, &sheet.png()?)?;
        staging.write(&svg, sheet.svg()?.as_bytes())?;
    }
    staging.commit()?;
    Ok(subject.clone())
}

#[cfg(test)]
mod tests {
    use std::fs::File;

    use ndarray_npy::WriteNpyExt;

    use super::*;

    /// A map whose value depends on the place.
    fn write(folder: &Path, name: &str, value: impl Fn(f64, f64) -> f64) {
        std::fs::create_dir_all(folder.join("maps")).unwrap();
        let map = Array2::from_shape_fn((100, 100), |(row, column)| {
            value((column as f64 + 0.5 - 50.0) / 40.0, (50.0 - row as f64 - 0.5) / 40.0) as f32
        });
        map.write_npy(File::create(folder.join("maps").join(name)).unwrap()).unwrap();
    }

    #[test]
    fn regions_and_patterns_are_distinguished() {
        let folder = tempfile::tempdir().unwrap();
        let at = folder.path();
        write(at, "nominal-mean.npy", |_, _| 0.4);
        write(at, "normal-mean.npy", |_, v| if v > 0.3 { 0.45 } else { 0.35 });
        write(at, "lateral_negative-mean.npy", |u, _| 0.4 + 0.05 * u);
        write(at, "lateral_positive-mean.npy", |u, _| 0.4 - 0.05 * u);
        write(at, "nominal-sd.npy", |u, v| if u.hypot(v) < 0.8 { 0.01 } else { 0.05 });
        let found = coloration_numbers(at).unwrap();
        let near = |name: &str, value: f64| {
            let own = found.get(name).unwrap();
            assert!((own - value).abs() < 1e-3, "{name}: {own}");
        };
        near("normal.tip_change", 0.05);
        near("normal.bone_change", -0.05);
        near("lateral_mirrored", 1.0);
        near("sd_bed", 0.01);
        near("sd_perimeter", 0.05);
        near("sd_bed_unevenness", 0.0);
        near("poses", 4.0);
        assert!(found.get("lateral_negative.right_change").unwrap() > 0.02);
        assert!(found.get("least_difference").unwrap() > 0.01);
        assert_eq!(found.get("longitudinal_positive_like_extension"), None);
        assert_eq!(found.get("subjects"), None);
    }

    #[test]
    fn a_folder_without_maps_has_no_numbers() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(coloration_numbers(folder.path()).unwrap(), Numbers::default());
        assert!(coloration_sheets(folder.path(), None, &folder.path().join("out")).is_err());
    }

    #[test]
    fn sheets_show_a_subject_that_has_every_pose() {
        let folder = tempfile::tempdir().unwrap();
        for (pose, subjects) in [("nominal", &["S1", "S2"][..]), ("normal", &["S2"])] {
            let at = folder.path().join(pose);
            std::fs::create_dir_all(&at).unwrap();
            for subject in subjects {
                image::GrayImage::from_pixel(40, 40, image::Luma([100]))
                    .save(at.join(format!("{subject}.png")))
                    .unwrap();
            }
        }
        let out = folder.path().join("out");
        assert_eq!(coloration_sheets(folder.path(), None, &out).unwrap(), "S2");
        assert!(out.join("typical.png").is_file() && out.join("typical-contrast.svg").is_file());
    }
}
