//! Outlines from a mask picture: each connected region is a nail.
//!
//! In: a mask of 8 or 16 bit, grey or colour (a pixel's value is its largest channel, times its opacity), upright like
//! its photograph; whether the sizes agree is the caller's question. Out: one [`Outline`] a region, sorted by centroid
//! from top to bottom, then left to right, and what was too small to be a nail.
//!
//! - A mask whose values reach above half of full scale is read as a grey level: the outline is the level line at half
//!   (127.5 of 255) by marching squares, so that an anti-aliased edge, or a JPEG's, keeps its sub-pixel place. A
//!   filled rectangle of pixels x0..=x1 is exactly x1 - x0 + 1 wide. Regions that touch the border end at its pixel
//!   edges.
//! - A mask whose largest value is 1 to 32 is read as instance numbers: each number a nail, though they touch.
//! - A picture in grey is not a mask: a mask has two values, and between them the grey of its edges only.
//!   [`MaskValues`] say which values are nail where a picture has more; outlines then run along pixel edges.
//! - Anything between is refused: half of full scale would silently lose every nail.
//!
//! Holes are filled: a nail has none.

use contour::contour_rings;
use geo::{Area, BoundingRect, LineString, Polygon, Simplify};
use image::{DynamicImage, ImageBuffer, Luma, Pixel, Primitive};
use thiserror::Error;

use super::{Moments, Outline, OutlineFault};
use crate::median::median_of;
use crate::vision::{Neighbours, Part, parts};

/// The largest value of a mask that is still read as instance numbers.
const LARGEST_ID: f32 = 32.0;
/// Regions below this area are no nails, square pixels.
const LEAST_AREA_PX2: f64 = 36.0;
/// Regions below this extent in x and y are no nails, pixels.
const LEAST_EXTENT_PX: f64 = 5.0;
/// Regions below this part of the largest one's area are specks: no nail is ten times shorter than its neighbour.
const LEAST_SHARE: f64 = 0.01;
/// A level line has a corner or two a pixel; those within this part of the nail's extent, or this many pixels, of the
/// line without them go (Douglas and Peucker).
const TOLERANCE: f64 = 2e-4;
const LEAST_TOLERANCE_PX: f64 = 0.03;
/// More regions than this of instance numbers are a noisy picture.
const MOST_ID_REGIONS: usize = 64;

/// Values this part of the largest one from it or from black are neither. ..
const NEAR_END: f32 = 0.2;
/// .. They lie on edges, where a neighbour differs by more than this part of full scale; ..
const FLAT: f32 = 0.1;
/// .. of those that do not there may be this many for each white one. Measured: none in 26 masks drawn by hand and kept
/// as JPEG; 0.68 to 3.3 in the photographs they belong to, in grey, 0.71 and more with their nails white and all but
/// skin black.
const MOST_GREY: f64 = 0.1;
/// A region above this share of the picture is not a nail: in the thesis' close-ups a nail takes up to a third
/// (assumed).
const LARGEST_SHARE: f64 = 0.6;
/// A region this many times as long as the median of a mask's others is not a nail; measured on 26 hands: at most 2.4.
const LONGEST: f64 = 3.0;

/// Which values of a mask are nail, both ends among them, as they are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MaskValues {
    low: u16,
    high: u16,
}

impl std::str::FromStr for MaskValues {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let ends = text.split_once("..").map_or((text, text), |(low, high)| (low, high.trim_start_matches('=')));
        let number = |text: &str| text.trim().parse::<u16>().ok();
        match number(ends.0).zip(number(ends.1)) {
            Some((low, high)) if low <= high => Ok(Self { low, high }),
            _ => Err("write a value or a range, as 255 or 250..255 (both among them, at most 65535)".to_owned()),
        }
    }
}

impl std::fmt::Display for MaskValues {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}..{}", self.low, self.high)
    }
}

impl serde::Serialize for MaskValues {
    fn serialize<S: serde::Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.collect_str(self)
    }
}

/// Why a picture is not a mask.
#[derive(Debug, Clone, PartialEq, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum MaskFault {
    #[error(
        "the mask's largest value is {largest} of {full}: neither white nails (above half) nor nail numbers (1 to 32); \
         make the nails white"
    )]
    Range { largest: f32, full: f32 },
    #[error(
        "a grey picture rather than a mask: for every 100 white pixels it has {:.0} that are neither white nor black, \
         edges \
         apart; paint the nails white on black, or say which values are nail, as --mask-value 250..255", 100.0 * .grey
    )]
    Grey {
        /// Grey pixels away from edges, for each white one.
        grey: f64,
    },
    #[error("no pixel of the mask has a value of {values}; its values are {least} to {largest}")]
    NoSuchValue { values: MaskValues, least: f32, largest: f32 },
    #[error("the mask's values 1 to 32 form {regions} regions: a noisy black picture rather than nail numbers")]
    Noise { regions: usize },
}

/// A region of a mask that is not a nail.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DroppedRegion {
    /// Centre of its box, `[x_px, y_px]`.
    pub center_px: [f64; 2],
    /// Extent of its box in x and y, pixels.
    pub extent_px: [f64; 2],
    /// Its area, square pixels.
    pub area_px2: f64,
}

impl std::fmt::Display for DroppedRegion {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let ([x, y], [width, height]) = (self.center_px, self.extent_px);
        write!(f, "a region of {width:.0} x {height:.0} px at ({x:.0}, {y:.0}) of the mask is too small to be a nail")
    }
}

/// A region that is too large to be a nail.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum TooLarge {
    #[error(
        "the region covers {:.0} % of the mask, more than any nail ({:.0} %); is the mask inverted, or a finger's?",
        100.0 * .0, 100.0 * LARGEST_SHARE
    )]
    Picture(f64),
    #[error(
        "the region is {0:.1} times as long as the mask's others in median, and no nail is {LONGEST:.0} times as long \
         as its neighbours; is it a finger's?"
    )]
    Others(f64),
    #[error(
        "of the mask's two regions one is {0:.1} times as long as the other, and no nail is {LONGEST:.0} times as long \
         as its neighbours; one of them is none, and it isn't known which."
    )]
    Two(f64),
}

/// The nails of a mask.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MaskOutlines {
    /// Outlines, top to bottom, left to right.
    pub nails: Vec<Outline>,
    /// Regions too small to be nails.
    pub dropped: Vec<DroppedRegion>,
}

/// The outlines of the regions of `mask`; none for an all-black one.
///
/// # Errors
/// [`MaskFault`] where the values make no mask.
pub fn outlines_from_mask(mask: &DynamicImage) -> Result<MaskOutlines, MaskFault> {
    outlines_of(levels(mask))
}

/// The outlines of the regions of `mask` that have one of `values`, along pixel edges.
///
/// # Errors
/// [`MaskFault::NoSuchValue`].
pub fn outlines_of_values(mask: &DynamicImage, values: MaskValues) -> Result<MaskOutlines, MaskFault> {
    let (mut levels, full) = levels(mask);
    let (least, largest) = levels.iter().fold((f32::MAX, 0.0), |(l, m), v| (v.min(l), v.max(m)));
    // A picture with opacity has values between the stored ones.
    let nail = f32::from(values.low) - 0.5..f32::from(values.high) + 0.5;
    levels.iter_mut().for_each(|level| *level = if nail.contains(level) { full } else { 0.0 });
    if levels.iter().all(|level| *level == 0.0) {
        return Err(MaskFault::NoSuchValue { values, least, largest });
    }
    outlines_of((levels, full))
}

fn outlines_of((values, full): (ImageBuffer<Luma<f32>, Vec<f32>>, f32)) -> Result<MaskOutlines, MaskFault> {
    let largest = values.iter().copied().fold(0.0, f32::max);
    if largest <= 0.0 {
        return Ok(MaskOutlines::default());
    }
    let white = 2.0 * largest > full;
    if !white && largest > LARGEST_ID {
        return Err(MaskFault::Range { largest, full });
    }
    let grey = if white { greyness(&values, largest, full) } else { 0.0 };
    if grey > MOST_GREY {
        return Err(MaskFault::Grey { grey });
    }
    let size = [values.width(), values.height()];
    let (regions, labels) = if white {
        labelled(size, values.iter().map(|value| u8::from(2.0 * value >= full)).collect(), 1)
    } else {
        labelled(size, values.iter().map(|value| *value as u8).collect(), largest as u8)
    };
    if !white && regions.len() > MOST_ID_REGIONS {
        return Err(MaskFault::Noise { regions: regions.len() });
    }

    let mut polygons: Vec<Polygon<f64>> = Vec::new();
    for (label, region) in (1_u32..).zip(&regions) {
        polygons.extend(region.rings(|x, y| match labels[(y * size[0] + x) as usize] {
            own if white && (own == label || own == 0) => f64::from(values.get_pixel(x, y).0[0] / full),
            own if own == label => 1.0,
            _ => 0.0,
        }));
    }
    Ok(sorted_out(polygons))
}

/// The regions of pixels of one kind, from 1 to `last`, and for each pixel 0 or the number of its region, from 1 on.
fn labelled(size: [u32; 2], kinds: Vec<u8>, last: u8) -> (Vec<Region>, Vec<u32>) {
    let (mut regions, mut labels) = (Vec::new(), vec![0; kinds.len()]);
    for kind in 1..=last {
        let own: Vec<u8> = kinds.iter().map(|&other| u8::from(other == kind)).collect();
        let found = parts(&own, size.map(|n| n as usize), Neighbours::Eight);
        let before = regions.len() as u32;
        for (label, own) in labels.iter_mut().zip(found.labels).filter(|(_, own)| *own > 0) {
            *label = before + own.cast_unsigned();
        }
        let ends = |from: usize, to: usize| [from as u32, to as u32];
        let region = |part: &Part| Region { x: ends(part.left, part.right), y: ends(part.top, part.bottom), size };
        regions.extend(found.all.iter().map(region));
    }
    (regions, labels)
}

/// Pixels neither black nor white and not on an edge, for each white one.
fn greyness(values: &ImageBuffer<Luma<f32>, Vec<f32>>, largest: f32, full: f32) -> f64 {
    let width = values.width() as usize;
    let neither = NEAR_END * largest..(1.0 - NEAR_END) * largest;
    let like = |a: &f32, b: Option<&f32>| b.is_none_or(|b| (a - b).abs() <= FLAT * full);
    let (mut flat, mut white) = (0_u64, 0_u64);
    let raw = values.as_raw();
    for (row, line) in raw.chunks_exact(width).enumerate() {
        let above = row.checked_sub(1).map(|row| &raw[row * width..][..width]);
        let below = raw.get((row + 1) * width..(row + 2) * width);
        for (x, value) in line.iter().enumerate() {
            white += u64::from(2.0 * value >= full);
            if neither.contains(value) {
                let beside = like(value, x.checked_sub(1).map(|x| &line[x])) && like(value, line.get(x + 1));
                let along = like(value, above.map(|line| &line[x])) && like(value, below.map(|line| &line[x]));
                flat += u64::from(beside && along);
            }
        }
    }
    flat as f64 / white.max(1) as f64
}

impl MaskOutlines {
    /// Which of the nails are too large to be any, in their order.
    pub(super) fn too_large(&self, mask_px: f64) -> Vec<Option<TooLarge>> {
        let lengths: Vec<f64> = self.nails.iter().map(|nail| Moments::of(nail).major_px).collect();
        let doubt = |(at, nail): (usize, &Outline)| {
            let share = nail.area_px2() / mask_px;
            let others = lengths.iter().enumerate().filter(|(k, _)| *k != at).map(|(_, length)| *length);
            let times = median_of(others).map_or(1.0, |median| lengths[at] / median);
            match lengths.len() {
                _ if share > LARGEST_SHARE => Some(TooLarge::Picture(share)),
                // A slip of the brush is the smaller one.
                2 => Some(times.max(times.recip())).filter(|times| *times > LONGEST).map(TooLarge::Two),
                _ => (times > LONGEST).then_some(TooLarge::Others(times)),
            }
        };
        self.nails.iter().enumerate().map(doubt).collect()
    }
}

fn outline_of(polygon: &Polygon<f64>) -> Result<Outline, OutlineFault> {
    let points: Vec<[f64; 2]> = polygon.exterior().coords().map(|c| [c.x, c.y]).collect();
    Outline::new(&points)
}

/// The largest of these rings, its corners moved by `place`; `None` where it is no outline.
pub(super) fn largest_outline(rings: Vec<Polygon<f64>>, place: impl Fn([f64; 2]) -> [f64; 2]) -> Option<Outline> {
    let largest = rings.into_iter().max_by(|a, b| a.unsigned_area().total_cmp(&b.unsigned_area()))?;
    let points: Vec<[f64; 2]> = largest.exterior().coords().map(|c| place([c.x, c.y])).collect();
    Outline::new(&points).ok()
}

/// Nails and specks.
fn sorted_out(polygons: Vec<Polygon<f64>>) -> MaskOutlines {
    let most = polygons.iter().map(Area::unsigned_area).fold(0.0, f64::max);
    let mut found = MaskOutlines::default();
    for polygon in polygons {
        let area_px2 = polygon.unsigned_area();
        let Some(bounds) = polygon.bounding_rect() else { continue };
        let (center, extent_px) = (bounds.center(), [bounds.width(), bounds.height()]);
        let least = LEAST_AREA_PX2.max(LEAST_SHARE * most);
        let large = area_px2 >= least && extent_px[0].max(extent_px[1]) >= LEAST_EXTENT_PX;
        let tolerance = LEAST_TOLERANCE_PX.max(TOLERANCE * extent_px[0].max(extent_px[1]));
        let outline = outline_of(&polygon.simplify(tolerance)).or_else(|_| outline_of(&polygon));
        match outline {
            Ok(outline) if large => found.nails.push(outline),
            _ => found.dropped.push(DroppedRegion { center_px: [center.x, center.y], extent_px, area_px2 }),
        }
    }
    found.nails.sort_by(|a, b| {
        let ([ax, ay], [bx, by]) = (Moments::of(a).centroid_px, Moments::of(b).centroid_px);
        ay.total_cmp(&by).then(ax.total_cmp(&bx))
    });
    found
}

/// The pixels of a region: `x0..=x1`, `y0..=y1`, and the mask's size.
#[derive(Debug, Clone, Copy)]
pub(super) struct Region {
    pub(super) x: [u32; 2],
    pub(super) y: [u32; 2],
    pub(super) size: [u32; 2],
}

impl Region {
    /// Outer level lines at half of `value` around the region, in pixels of the mask.
    pub(super) fn rings(&self, value: impl Fn(u32, u32) -> f64) -> Vec<Polygon<f64>> {
        // Two cells of margin: one for the edge's grey levels, one beyond the mask's border, where there is nothing.
        let (left, top) = (i64::from(self.x[0]) - 2, i64::from(self.y[0]) - 2);
        let width = (self.x[1] - self.x[0]) as usize + 5;
        let height = (self.y[1] - self.y[0]) as usize + 5;
        let mut grid = Vec::with_capacity(width * height);
        for y in (top..).take(height) {
            for x in (left..).take(width) {
                let on_mask = |p: i64, size: u32| u32::try_from(p).ok().filter(|p| *p < size);
                let at = on_mask(x, self.size[0]).zip(on_mask(y, self.size[1]));
                grid.push(at.map_or(0.0, |(x, y)| value(x, y)));
            }
        }
        let rings = contour_rings(&grid, 0.5, width, height).unwrap_or_default();
        let cell = |x: i64, y: i64| {
            let within = x >= 0 && y >= 0 && (x as usize) < width && (y as usize) < height;
            if within { grid[y as usize * width + x as usize] } else { 0.0 }
        };
        rings
            .into_iter()
            .map(|mut ring| {
                for point in &mut ring {
                    // The crate puts a cell's centre at +0.5 and every crossing half-way between two centres; the true
                    // one follows from the two values. At the border of the mask, beyond which there is nothing, the
                    // pixel's edge is half-way.
                    let (x, y) = (point.x - 0.5, point.y - 0.5);
                    let (x0, y0) = (x.floor() as i64, y.floor() as i64);
                    let (x1, y1) = (x.ceil() as i64, y.ceil() as i64);
                    let (a, b) = (cell(x0, y0), cell(x1, y1));
                    let on_border = |p0: i64, p1: i64, size: u32| {
                        p0 < 0 && p1 >= 0 || p0 < i64::from(size) && p1 >= i64::from(size)
                    };
                    let border =
                        on_border(left + x0, left + x1, self.size[0]) || on_border(top + y0, top + y1, self.size[1]);
                    let part = if border || (b - a).abs() < f64::EPSILON { 0.5 } else { (0.5 - a) / (b - a) };
                    point.x = left as f64 + x0 as f64 + part * (x1 - x0) as f64;
                    point.y = top as f64 + y0 as f64 + part * (y1 - y0) as f64;
                }
                Polygon::new(LineString::new(ring), vec![])
            })
            // Holes run the other way round.
            .filter(|polygon| polygon.signed_area() * OUTER > 0.0)
            .collect()
    }
}

/// Sign of the signed area of an outer ring as the contour crate winds it.
const OUTER: f64 = -1.0;

/// The mask's values as they are stored, and full scale.
fn levels(mask: &DynamicImage) -> (ImageBuffer<Luma<f32>, Vec<f32>>, f32) {
    fn typed<P: Pixel<Subpixel: Primitive + Into<f32>>>(
        pixels: &ImageBuffer<P, Vec<P::Subpixel>>,
    ) -> (ImageBuffer<Luma<f32>, Vec<f32>>, f32) {
        let full: f32 = P::Subpixel::DEFAULT_MAX_VALUE.into();
        let level = |pixel: &P| {
            let [r, g, b, opacity] = pixel.to_rgba().0.map(Into::into);
            r.max(g).max(b) * (opacity / full)
        };
        let levels = pixels.pixels().map(level).collect();
        (ImageBuffer::from_raw(pixels.width(), pixels.height(), levels).expect("a level a pixel"), full)
    }
    match mask {
        DynamicImage::ImageLuma8(pixels) => typed(pixels),
        DynamicImage::ImageLumaA8(pixels) => typed(pixels),
        DynamicImage::ImageRgb8(pixels) => typed(pixels),
        DynamicImage::ImageRgba8(pixels) => typed(pixels),
        DynamicImage::ImageLuma16(pixels) => typed(pixels),
        DynamicImage::ImageLumaA16(pixels) => typed(pixels),
        DynamicImage::ImageRgb16(pixels) => typed(pixels),
        DynamicImage::ImageRgba16(pixels) => typed(pixels),
        other => typed(&other.to_rgba32f()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vision::borders;

    /// Prints by how much the area of a disc of 40 pixels errs, drawn with soft edges at 50 places.
    #[test]
    fn pixel_borders_lose_what_a_level_line_keeps() {
        let (radius, size) = (20.0_f64, 64);
        let area = std::f64::consts::PI * radius * radius;
        let (mut ours, mut theirs) = (0.0_f64, 0.0_f64);
        for k in 0..50 {
            let centre = [31.0 + 0.02 * f64::from(k), 31.5 + 0.013 * f64::from(k)];
            let level = |x: u32, y: u32| {
                let off = (f64::from(x) - centre[0]).hypot(f64::from(y) - centre[1]) - radius;
                (255.0 * (0.5 - off).clamp(0.0, 1.0)).round() as u8
            };
            let mask = image::GrayImage::from_fn(size, size, |x, y| Luma([level(x, y)]));
            let set: Vec<u8> = mask.iter().map(|&value| u8::from(value >= 128)).collect();
            let border: Vec<[f64; 2]> = borders(&set, [size as usize; 2])[0].iter().map(|p| p.map(f64::from)).collect();
            let found = outlines_from_mask(&mask.into()).expect("a mask");
            ours = ours.max((found.nails[0].area_px2() / area - 1.0).abs());
            theirs = theirs.max((Outline::new(&border).expect("an outline").area_px2() / area - 1.0).abs());
        }
        println!("area: level line {:.3} %, border of pixels {:.2} %", 100.0 * ours, 100.0 * theirs);
        assert!(ours <= 2e-3 && theirs >= 0.04);
    }
}
