//! The photos job's files: normalized pictures, maps, figures and `nails.csv`, all by way of a [`Staging`].

use std::io::{BufWriter, Write};

use image::{DynamicImage, GrayAlphaImage, ImageBuffer, Luma, LumaA, imageops};
use ndarray::Array2;
use ndarray_npy::WriteNpyExt;
use rayon::prelude::*;

use super::maps::Maps;
use super::members::{Member, Members};
use super::nail_row::NailRow;
use super::normalize::Normalized;
use super::partial::{self, Partials};
use super::read::Depth;
use super::set::PhotoSet;
use crate::figure::{self, Scale, Sheet, Stretch, Tile, grey_map};
use crate::files::{Staging, WriteError};
use crate::stages::Stages;

/// One kind of figure: its file name, how it is stretched, what its scale says.
struct Kind {
    name: &'static str,
    title: &'static str,
    stretch: Stretch,
    label: &'static str,
    of_sd: bool,
}

const KINDS: [Kind; 4] = [
    Kind {
        name: "mean",
        title: "Average coloration (Fig. 53)",
        stretch: Stretch::Linear { low: 0.0, high: 1.0 },
        label: "mean, % of full scale",
        of_sd: false,
    },
    Kind {
        name: "contrast",
        title: "Average coloration, 30-50 % stretched to the full range (Fig. 54)",
        stretch: Stretch::Linear { low: 0.3, high: 0.5 },
        label: "mean, % of full scale",
        of_sd: false,
    },
    Kind {
        name: "threshold",
        title: "Average coloration above 105/255 (Fig. 55)",
        stretch: Stretch::Above(105.0 / 255.0),
        label: "mean, % of full scale; white above 105/255",
        of_sd: false,
    },
    Kind {
        name: "sd",
        title: "Standard deviation over subjects, 0-20 % stretched to the full range (Fig. 56)",
        stretch: Stretch::Linear { low: 0.0, high: 0.2 },
        label: "SD (n - 1), % of full scale",
        of_sd: true,
    },
];

/// As deep as its source; with an alpha channel, 0 where the photograph does not show the place, only if there is such
/// a place.
pub(super) fn write_normalized(
    picture: &Normalized,
    depth: Depth,
    staging: &Staging,
    name: &str,
) -> Result<(), WriteError> {
    let size = picture.size as u32;
    let levels = picture.levels.iter().copied();
    let eight = |level: u16| ((u32::from(level) * 255 + 32767) / 65535) as u8;
    let drawn = match (depth, &picture.seen) {
        (Depth::Eight, None) => picture_of::<Luma<u8>>(size, levels.map(eight).collect()),
        (Depth::Sixteen, None) => picture_of::<Luma<u16>>(size, picture.levels.clone()),
        (Depth::Eight, Some(seen)) => {
            let pixels = levels.zip(seen).flat_map(|(level, &seen)| [eight(level), if seen { 255 } else { 0 }]);
            picture_of::<LumaA<u8>>(size, pixels.collect())
        }
        (Depth::Sixteen, Some(seen)) => {
            let pixels = levels.zip(seen).flat_map(|(level, &seen)| [level, if seen { 65535 } else { 0 }]);
            picture_of::<LumaA<u16>>(size, pixels.collect())
        }
    };
    write_png(&drawn, staging, name)
}

fn picture_of<P: image::Pixel>(size: u32, samples: Vec<P::Subpixel>) -> DynamicImage
where
    DynamicImage: From<ImageBuffer<P, Vec<P::Subpixel>>>,
{
    ImageBuffer::<P, _>::from_raw(size, size, samples).expect("one sample a pixel and channel").into()
}

fn write_png(picture: &DynamicImage, staging: &Staging, name: &str) -> Result<(), WriteError> {
    staging.write(name, &figure::png(picture).map_err(|why| staging.refused(name, why))?)
}

/// A small version for a sheet of all nails: means of whole blocks, at most `longest` pixels a side.
pub(super) fn thumbnail(picture: &Normalized, longest: usize) -> GrayAlphaImage {
    let block = picture.size.div_ceil(longest);
    let side = picture.size / block;
    let scale = (block * block) as u32 * 257;
    let mut small = GrayAlphaImage::new(side as u32, side as u32);
    let mut sums = vec![0_u32; side];
    for (row, pixels) in small.chunks_exact_mut(2 * side).enumerate() {
        sums.fill(0);
        for line in picture.levels[row * block * picture.size..].chunks(picture.size).take(block) {
            for (sum, levels) in sums.iter_mut().zip(line.chunks_exact(block)) {
                *sum += levels.iter().map(|&l| u32::from(l)).sum::<u32>();
            }
        }
        for (column, (pixel, sum)) in pixels.chunks_exact_mut(2).zip(&sums).enumerate() {
            let ends = |k: usize| [k * block, (k + 1) * block - 1];
            let mut corners = ends(row).into_iter().flat_map(|r| ends(column).map(|c| r * picture.size + c));
            let seen = corners.all(|at| picture.level(at).is_some());
            pixel.copy_from_slice(&[(sum / scale) as u8, if seen { 255 } else { 0 }]);
        }
    }
    small
}

/// Sums of every pose and the list of them, for [`gather`](fn@super::gather).
pub(super) fn write_parts(partials: &Partials, staging: &Staging, stages: &Stages) -> Result<(), WriteError> {
    stages.time("write sums", || {
        let mut members = Members::new(partials.normalization);
        for (pose, sums) in &partials.poses {
            let name = partial::part_name(pose);
            partial::write_part(&staging.place(&name)?, pose, sums, &partials.normalization)
                .map_err(|why| staging.refused(&name, why))?;
            members.add(pose, Member::of(sums, &staging.read(&name)?));
        }
        members.write(staging)
    })
}

/// Maps and partial sums of every pose, and where they are wanted figures and the sheets over all poses.
pub(super) fn write_maps(
    partials: &Partials,
    figures: bool,
    staging: &Staging,
    stages: &Stages,
) -> Result<(), WriteError> {
    let drawn: Vec<Option<[Tile; 4]>> = partials
        .poses
        .par_iter()
        .map(|(pose, sums)| {
            let maps = stages.time("maps", || sums.maps());
            stages.time("write maps", || {
                write_npy(&maps.mean, staging, &format!("maps/{pose}-mean.npy"))?;
                write_npy(&maps.sd, staging, &format!("maps/{pose}-sd.npy"))?;
                write_npy(&maps.count, staging, &format!("maps/{pose}-count.npy"))?;
                let name = format!("maps/{pose}.partial.npz");
                let path = staging.place(&name)?;
                partial::write(&path, pose, sums, &partials.normalization).map_err(|why| staging.refused(&name, why))
            })?;
            let draw = || draw_pose(pose, sums.subjects().len(), &maps, staging);
            figures.then(|| stages.time("figures", draw)).transpose()
        })
        .collect::<Result<_, WriteError>>()?;
    let drawn: Vec<[Tile; 4]> = drawn.into_iter().flatten().collect();
    if !figures {
        return Ok(());
    }
    stages.time("sheets", || {
        (0..KINDS.len()).into_par_iter().try_for_each(|kind| {
            let small = drawn.len() > LARGE_TILES;
            let tiles =
                drawn.iter().map(|tiles| if small { tiles[kind].small() } else { tiles[kind].clone() }).collect();
            let Kind { name, title, stretch, label, .. } = &KINDS[kind];
            let scale = Some(Scale { stretch: *stretch, label: (*label).to_owned() });
            write_sheet(&Sheet { title: (*title).to_owned(), tiles, columns: 4, scale }, staging, name)
        })
    })
}

fn write_sheet(sheet: &Sheet, staging: &Staging, name: &str) -> Result<(), WriteError> {
    let (png, svg) = (format!("figures/{name}.png"), format!("figures/{name}.svg"));
    staging.write(&png, &sheet.png().map_err(|why| staging.refused(&png, why))?)?;
    staging.write(&svg, sheet.svg().map_err(|why| staging.refused(&svg, why))?.as_bytes())
}

/// Poses beyond which a sheet shows small tiles.
const LARGE_TILES: usize = 16;
const SMALL_TILE_PX: u32 = 160;

impl Tile {
    fn small(&self) -> Self {
        let [width, height] = [self.picture.width(), self.picture.height()].map(|side| side.min(SMALL_TILE_PX));
        Self { caption: self.caption.clone(), picture: imageops::thumbnail(&self.picture, width, height), png: None }
    }
}

fn draw_pose(pose: &str, subjects: usize, maps: &Maps, staging: &Staging) -> Result<[Tile; 4], WriteError> {
    let tile = |kind: &Kind| {
        let picture = grey_map(if kind.of_sd { &maps.sd } else { &maps.mean }, kind.stretch);
        let opaque = picture.pixels().all(|p| p.0[1] == 255);
        let flat: DynamicImage =
            if opaque { DynamicImage::from(picture.clone()).to_luma8().into() } else { picture.clone().into() };
        let name = format!("figures/{pose}-{}.png", kind.name);
        let png = figure::png(&flat).map_err(|why| staging.refused(&name, why))?;
        staging.write(&name, &png)?;
        Ok(Tile { caption: format!("{pose} (n = {subjects})"), picture, png: Some(png) })
    };
    Ok([tile(&KINDS[0])?, tile(&KINDS[1])?, tile(&KINDS[2])?, tile(&KINDS[3])?])
}

fn write_npy<T: ndarray_npy::WritableElement>(
    array: &Array2<T>,
    staging: &Staging,
    name: &str,
) -> Result<(), WriteError> {
    let file = std::fs::File::create(staging.place(name)?).map_err(|why| staging.refused(name, why))?;
    let mut file = BufWriter::new(file);
    array.write_npy(&mut file).map_err(|why| staging.refused(name, why))?;
    file.flush().map_err(|why| staging.refused(name, why))
}

/// The header of `nails.csv`.
pub const NAIL_COLUMNS: [&str; 13] = [
    "file",
    "nail",
    "subject",
    "pose",
    "outline",
    "confidence",
    "center_x_px",
    "center_y_px",
    "length_px",
    "width_px",
    "axis_deg",
    "used",
    "reason",
];

/// A row of `nails.csv`: an empty cell where nothing is known.
pub fn nail_cells(row: &NailRow, set: &PhotoSet) -> [String; 13] {
    let photo = &set.photos[row.photo];
    let number = |value: Option<f64>, digits: usize| value.map_or_else(String::new, |v| format!("{v:.digits$}"));
    [
        photo.file.clone(),
        row.number.to_string(),
        photo.subject.clone(),
        photo.pose.clone(),
        row.source.name().to_owned(),
        number(row.confidence, 3),
        number(row.frame.map(|f| f.center_px[0]), 3),
        number(row.frame.map(|f| f.center_px[1]), 3),
        number(row.frame.map(|f| f.length_px), 3),
        number(row.frame.map(|f| f.width_px), 3),
        number(row.axis.map(|a| a.clockwise_deg()), 3),
        row.normalized.is_some().to_string(),
        row.reason.clone(),
    ]
}

/// Writes `nails.csv`: every nail, used or not.
///
/// # Errors
/// [`WriteError`].
pub fn write_nails(rows: &[Vec<String>], staging: &Staging) -> Result<(), WriteError> {
    let mut table = csv::Writer::from_writer(Vec::new());
    let refused = |why: String| staging.refused("nails.csv", why);
    table.write_record(NAIL_COLUMNS).map_err(|e| refused(e.to_string()))?;
    for row in rows {
        table.write_record(row).map_err(|e| refused(e.to_string()))?;
    }
    staging.write("nails.csv", &table.into_inner().map_err(|e| refused(e.to_string()))?)
}

/// The sheets' kinds, in the order of a report.
pub(super) fn sheet_names() -> impl Iterator<Item = (&'static str, &'static str)> {
    KINDS.iter().map(|kind| (kind.name, kind.title))
}
