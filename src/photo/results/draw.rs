//! Pictures: the normalized ones, the four figures of each pose, and sheets of all.
//!
//! Each is drawn once: its bytes go to its file, and are handed on to the report's page.

use image::{ExtendedColorType, GrayAlphaImage, imageops};
use rayon::prelude::*;

use crate::figure::{self, Scale, Sheet, Stretch, Tile, TilePicture, grey_map};
use crate::files::{Staging, WriteError};
use crate::photo::normalize::Normalized;
use crate::photo::pose::sort_by_pose;
use crate::photo::sums::Maps;
use crate::photograph::Depth;

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

/// A sheet as it was written.
pub(in crate::photo) struct DrawnSheet {
    /// What it shows.
    pub(in crate::photo) title: String,
    /// Its PNG file.
    pub(in crate::photo) png: Vec<u8>,
}

impl DrawnSheet {
    pub(super) fn new(sheet: &Sheet, name: &str, staging: &Staging) -> Result<Self, WriteError> {
        let png = sheet.png().map_err(|why| staging.refused(name, why))?;
        staging.write(name, &png)?;
        Ok(Self { title: sheet.title.clone(), png })
    }
}

/// Memory for the pictures of a thread, kept from one photograph to the next.
#[derive(Default)]
pub(crate) struct Scratch {
    samples: Vec<u8>,
    png: Vec<u8>,
}

impl Scratch {
    /// A normalized picture as a PNG, as deep as its source; with an alpha channel, 0 where the photograph does not
    /// show the place, only if there is such a place.
    pub(crate) fn png_of(&mut self, picture: &Normalized, depth: Depth) -> Result<&[u8], image::ImageError> {
        let eight = |level: u16| ((u32::from(level) * 255 + 32767) / 65535) as u8;
        let Self { samples, png } = self;
        samples.clear();
        let levels = picture.levels.iter().copied();
        let opacity = |&seen: &bool| if seen { 255 } else { 0 };
        let colour = match (depth, &picture.seen) {
            (Depth::Eight, None) => {
                samples.extend(levels.map(eight));
                ExtendedColorType::L8
            }
            (Depth::Sixteen, None) => {
                samples.extend(levels.flat_map(u16::to_ne_bytes));
                ExtendedColorType::L16
            }
            (Depth::Eight, Some(seen)) => {
                samples.extend(levels.zip(seen).flat_map(|(level, seen)| [eight(level), opacity(seen)]));
                ExtendedColorType::La8
            }
            (Depth::Sixteen, Some(seen)) => {
                samples.extend(levels.zip(seen).flat_map(|(level, seen)| {
                    let ([a, b], opacity) = (level.to_ne_bytes(), opacity(seen));
                    [a, b, opacity, opacity]
                }));
                ExtendedColorType::La16
            }
        };
        png.clear();
        let size = picture.size as u32;
        figure::encode_png(samples, [size, size], colour, png)?;
        Ok(png)
    }
}

/// Writes a normalized picture.
pub(in crate::photo) fn write_normalized(
    picture: &Normalized,
    depth: Depth,
    scratch: &mut Scratch,
    staging: &Staging,
    name: &str,
) -> Result<(), WriteError> {
    staging.write(name, scratch.png_of(picture, depth).map_err(|why| staging.refused(name, why))?)
}

/// A small version for a sheet of all nails: means of whole blocks, at most `longest` pixels a side.
pub(in crate::photo) fn thumbnail(picture: &Normalized, longest: usize) -> GrayAlphaImage {
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
            let seen = picture.seen.is_none() || corners.all(|at| picture.level(at).is_some());
            pixel.copy_from_slice(&[(sum / scale) as u8, if seen { 255 } else { 0 }]);
        }
    }
    small
}

/// A pose's four figures, as sheets show them.
pub(in crate::photo) struct DrawnPose {
    pose: String,
    tiles: [Tile; KINDS.len()],
}

/// Draws a pose's four figures and writes them.
pub(super) fn draw_pose(pose: &str, subjects: usize, maps: &Maps, staging: &Staging) -> Result<DrawnPose, WriteError> {
    let tile = |kind: &Kind| {
        let picture = grey_map(if kind.of_sd { &maps.sd } else { &maps.mean }, kind.stretch);
        let name = format!("figures/{pose}-{}.png", kind.name);
        let png = figure::png_of_grey(&picture).map_err(|why| staging.refused(&name, why))?;
        staging.write(&name, &png)?;
        let picture = TilePicture::Grey(picture);
        Ok(Tile { caption: format!("{pose} (n = {subjects})"), picture, png: Some(png) })
    };
    let tiles = [tile(&KINDS[0])?, tile(&KINDS[1])?, tile(&KINDS[2])?, tile(&KINDS[3])?];
    Ok(DrawnPose { pose: pose.to_owned(), tiles })
}

/// Draws the sheets over all poses and writes them; none where there are no poses.
pub(in crate::photo) fn draw_sheets(
    mut poses: Vec<DrawnPose>,
    staging: &Staging,
) -> Result<Vec<DrawnSheet>, WriteError> {
    if poses.is_empty() {
        return Ok(Vec::new());
    }
    sort_by_pose(&mut poses, |drawn| &drawn.pose);
    let many = poses.len() > LARGE_TILES;
    let mut tiles: [Vec<Tile>; KINDS.len()] = Default::default();
    for pose in poses {
        for (tiles, tile) in tiles.iter_mut().zip(pose.tiles) {
            tiles.push(if many { small(tile) } else { tile });
        }
    }
    let draw = |(kind, tiles): (&Kind, Vec<Tile>)| {
        let scale = Some(Scale { stretch: kind.stretch, label: kind.label.to_owned() });
        let sheet = Sheet { title: kind.title.to_owned(), tiles, columns: 4, scale };
        let (png_name, svg_name) = (format!("figures/{}.png", kind.name), format!("figures/{}.svg", kind.name));
        let drawn = DrawnSheet::new(&sheet, &png_name, staging)?;
        staging.write(&svg_name, sheet.svg().map_err(|why| staging.refused(&svg_name, why))?.as_bytes())?;
        Ok(drawn)
    };
    KINDS.par_iter().zip(tiles).map(draw).collect()
}

/// Poses beyond which a sheet shows small tiles.
const LARGE_TILES: usize = 16;
const SMALL_TILE_PX: u32 = 160;

fn small(tile: Tile) -> Tile {
    let TilePicture::Grey(picture) = &tile.picture else { return tile };
    let [width, height] = [picture.width(), picture.height()].map(|side| side.min(SMALL_TILE_PX));
    let picture = TilePicture::Grey(imageops::thumbnail(picture, width, height));
    Tile { caption: tile.caption, picture, png: None }
}
