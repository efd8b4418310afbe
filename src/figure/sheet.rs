//! Sheets: many small pictures in a grid, each with its caption, a title above and a scale below. PNG and SVG.

use base64::Engine;
use image::{DynamicImage, GrayAlphaImage, ImageBuffer, Luma, Pixel, Rgb, RgbImage};
use imageproc::drawing::draw_hollow_rect_mut;
use imageproc::rect::Rect;

use super::Stretch;
use super::html::escape;
use super::text::{centred, left};

/// One picture of a sheet.
#[derive(Debug, Clone)]
pub struct Tile {
    /// Below the picture.
    pub caption: String,
    /// What it shows.
    pub picture: TilePicture,
    /// The same as a PNG file, where there is one already.
    pub png: Option<Vec<u8>>,
}

/// A tile's picture.
#[derive(Debug, Clone)]
pub enum TilePicture {
    /// Transparent where nothing is known.
    Grey(GrayAlphaImage),
    /// In colour.
    Colour(RgbImage),
}

impl TilePicture {
    fn size(&self) -> [u32; 2] {
        match self {
            Self::Grey(picture) => picture.dimensions().into(),
            Self::Colour(picture) => picture.dimensions().into(),
        }
    }

    fn draw_row<P: Tone>(&self, y: u32, to: &mut [u8]) {
        let width = self.size()[0] as usize;
        let to = to.chunks_exact_mut(P::CHANNEL_COUNT.into()).take(width);
        match self {
            Self::Grey(picture) => {
                let row = picture.as_raw()[2 * width * y as usize..].chunks_exact(2);
                for (to, from) in to.zip(row) {
                    let colour = if from[1] == 0 { UNKNOWN } else { [from[0]; 3] };
                    to.copy_from_slice(P::of(colour).channels());
                }
            }
            Self::Colour(picture) => {
                for (to, from) in to.zip(picture.as_raw()[3 * width * y as usize..].as_chunks().0) {
                    to.copy_from_slice(P::of(*from).channels());
                }
            }
        }
    }

    /// Whether what is known of it is grey.
    fn is_grey(&self) -> bool {
        match self {
            Self::Grey(_) => true,
            Self::Colour(picture) => picture.pixels().all(|pixel| pixel.0 == [pixel.0[0]; 3]),
        }
    }
}

/// A pixel of a sheet, in colour or, where all of it is grey, of one channel.
trait Tone: Pixel<Subpixel = u8> {
    fn of(colour: [u8; 3]) -> Self;
}

impl Tone for Rgb<u8> {
    fn of(colour: [u8; 3]) -> Self {
        Self(colour)
    }
}

/// Level 0 is [`UNKNOWN`]; black is the level after it.
impl Tone for Luma<u8> {
    fn of(colour: [u8; 3]) -> Self {
        Self([if colour == UNKNOWN { 0 } else { colour[0].max(1) }])
    }
}

impl From<&TilePicture> for DynamicImage {
    fn from(picture: &TilePicture) -> Self {
        match picture {
            TilePicture::Grey(picture) => picture.clone().into(),
            TilePicture::Colour(picture) => picture.clone().into(),
        }
    }
}

/// What the grey levels mean.
#[derive(Debug, Clone)]
pub struct Scale {
    /// From the values to the levels.
    pub stretch: Stretch,
    /// What the values are, with their unit.
    pub label: String,
}

/// A grid of pictures of one size.
#[derive(Debug, Clone)]
pub struct Sheet {
    /// Above the grid.
    pub title: String,
    /// Row by row.
    pub tiles: Vec<Tile>,
    /// How many stand side by side.
    pub columns: usize,
    /// Below the grid.
    pub scale: Option<Scale>,
}

const GAP: u32 = 12;
const TITLE: u32 = 40;
const CAPTION: u32 = 24;
const SCALE: u32 = 64;
const BAR: [u32; 2] = [320, 18];
const PAPER: [u8; 3] = [255; 3];
/// Captions.
const INK: [u8; 3] = [34; 3];
/// Behind unknown pixels: a colour, so that it can't be taken for a grey level.
const UNKNOWN: [u8; 3] = [205, 216, 240];

/// Where everything stands, pixels.
struct Layout {
    tile: [u32; 2],
    columns: u32,
    size: [u32; 2],
}

impl Layout {
    fn corner(&self, tile: usize) -> [u32; 2] {
        let (row, column) = (tile as u32 / self.columns, tile as u32 % self.columns);
        [GAP + column * (self.tile[0] + GAP), TITLE + GAP + row * (self.tile[1] + CAPTION + GAP)]
    }
}

impl Sheet {
    fn layout(&self) -> Layout {
        let sizes = self.tiles.iter().map(|t| t.picture.size());
        let tile = sizes.fold([1, 1], |[w, h], size| [w.max(size[0]), h.max(size[1])]);
        let columns = self.columns.clamp(1, self.tiles.len().max(1)) as u32;
        let rows = (self.tiles.len() as u32).div_ceil(columns);
        let scale = if self.scale.is_some() { SCALE } else { 0 };
        let width = (GAP + columns * (tile[0] + GAP)).max(BAR[0] + 2 * GAP + 60);
        Layout { tile, columns, size: [width, TITLE + GAP + rows * (tile[1] + CAPTION + GAP) + scale] }
    }

    fn draw<P: Tone>(&self) -> ImageBuffer<P, Vec<u8>> {
        let layout = self.layout();
        let ink = P::of(INK);
        let mut sheet = ImageBuffer::from_pixel(layout.size[0], layout.size[1], P::of(PAPER));
        left(&mut sheet, ink, &self.title, [GAP as i32, 14], 22.0);
        for (at, tile) in self.tiles.iter().enumerate() {
            let [x0, y0] = layout.corner(at);
            let [width, height] = tile.picture.size();
            let left = x0 + (layout.tile[0] - width) / 2;
            for y in 0..height {
                let start = usize::from(P::CHANNEL_COUNT) * ((y0 + y) * layout.size[0] + left) as usize;
                let samples: &mut [u8] = &mut sheet;
                tile.picture.draw_row::<P>(y, &mut samples[start..]);
            }
            let top = [x0 + layout.tile[0] / 2, y0 + layout.tile[1] + 4].map(|at| at as i32);
            centred(&mut sheet, ink, &tile.caption, top, 17.0, layout.tile[0]);
        }
        if let Some(scale) = &self.scale {
            let y = layout.size[1] - SCALE + 6;
            let frame = Rect::at(GAP as i32 + 9, y as i32 - 1).of_size(BAR[0] + 2, BAR[1] + 2);
            draw_hollow_rect_mut(&mut sheet, frame, ink);
            for (x, level) in scale.levels().enumerate() {
                for dy in 0..BAR[1] {
                    sheet.put_pixel(GAP + 10 + x as u32, y + dy, P::of([level; 3]));
                }
            }
            for (position, text) in scale.ticks() {
                centred(&mut sheet, ink, &text, [GAP + 10 + position, y + BAR[1] + 4].map(|at| at as i32), 15.0, 60);
            }
            left(&mut sheet, ink, &scale.label, [(GAP + BAR[0] + 34) as i32, y as i32], 17.0);
        }
        sheet
    }

    /// The sheet as a PNG file, of one channel with a palette unless something on it is in colour.
    pub fn png(&self) -> Result<Vec<u8>, image::ImageError> {
        let is_grey = self.tiles.iter().all(|tile| tile.picture.is_grey());
        if is_grey { super::png_of_levels(&self.draw(), UNKNOWN) } else { super::png(&self.draw::<Rgb<u8>>().into()) }
    }

    /// The sheet as SVG: pictures embedded, words as words.
    pub fn svg(&self) -> Result<String, image::ImageError> {
        let layout = self.layout();
        let [width, height] = layout.size;
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} \
             {height}\" \
             font-family=\"Ubuntu, sans-serif\" fill=\"#222\">\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n\
             <text x=\"{GAP}\" y=\"32\" font-size=\"20\">{}</text>\n",
            escape(&self.title)
        );
        for (at, tile) in self.tiles.iter().enumerate() {
            let [x, y] = layout.corner(at);
            let [tile_width, tile_height] = layout.tile;
            let encoded = match &tile.png {
                Some(_) => None,
                None => Some(super::png(&DynamicImage::from(&tile.picture))?),
            };
            let [picture_width, picture_height] = tile.picture.size();
            let png = tile.png.as_ref().or(encoded.as_ref()).map_or(&[][..], Vec::as_slice);
            svg += &format!(
                "<rect x=\"{x}\" y=\"{y}\" width=\"{tile_width}\" height=\"{tile_height}\" fill=\"#cdd8f0\"/>\n\
                 <image x=\"{}\" y=\"{y}\" width=\"{picture_width}\" height=\"{picture_height}\" \
                 href=\"data:image/png;base64,{}\"/>\n\
                 <text x=\"{}\" y=\"{}\" font-size=\"15\" text-anchor=\"middle\">{}</text>\n",
                x + (tile_width - picture_width) / 2,
                base64::engine::general_purpose::STANDARD.encode(png),
                x + tile_width / 2,
                y + tile_height + 18,
                escape(&tile.caption)
            );
        }
        if let Some(scale) = &self.scale {
            let y = height - SCALE + 6;
            svg += &format!(
                "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"#222\"/>\n",
                GAP + 9,
                y - 1,
                BAR[0] + 2,
                BAR[1] + 2
            );
            for (at, level) in scale.levels().enumerate().step_by(4) {
                svg += &format!(
                    "<rect x=\"{}\" y=\"{y}\" width=\"4.5\" height=\"{}\" fill=\"rgb({level},{level},{level})\"/>\n",
                    GAP as usize + 10 + at,
                    BAR[1]
                );
            }
            for (position, text) in scale.ticks() {
                svg += &format!(
                    "<text x=\"{}\" y=\"{}\" font-size=\"13\" text-anchor=\"middle\">{text}</text>\n",
                    GAP + 10 + position,
                    y + BAR[1] + 16
                );
            }
            svg += &format!(
                "<text x=\"{}\" y=\"{}\" font-size=\"15\">{}</text>\n",
                GAP + BAR[0] + 34,
                y + 14,
                escape(&scale.label)
            );
        }
        svg += "</svg>\n";
        Ok(svg)
    }
}

impl Scale {
    /// Values at both ends of the bar.
    fn ends(&self) -> [f32; 2] {
        match self.stretch {
            Stretch::Linear { low, high } => [low, high],
            Stretch::Above(_) => [0.0, 1.0],
        }
    }

    fn levels(&self) -> impl Iterator<Item = u8> + '_ {
        let [low, high] = self.ends();
        (0..BAR[0]).map(move |x| self.stretch.level(low + (high - low) * (x as f32 + 0.5) / BAR[0] as f32))
    }

    /// Position on the bar and the value there, in percent of full scale.
    fn ticks(&self) -> Vec<(u32, String)> {
        let [low, high] = self.ends();
        let at = |value: f32| ((value - low) / (high - low) * BAR[0] as f32).round() as u32;
        let values = match self.stretch {
            Stretch::Linear { .. } => vec![low, (low + high) / 2.0, high],
            Stretch::Above(limit) => vec![0.0, limit, 1.0],
        };
        values.into_iter().map(|v| (at(v), format!("{} %", (f64::from(v) * 1000.0).round() / 10.0))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sheet(tile: GrayAlphaImage) -> Sheet {
        let tile = Tile { caption: "pressed".to_owned(), picture: TilePicture::Grey(tile), png: None };
        let scale = Scale { stretch: Stretch::Linear { low: 0.0, high: 1.0 }, label: "mean, %".to_owned() };
        Sheet { title: "Average".to_owned(), tiles: vec![tile], columns: 1, scale: Some(scale) }
    }

    #[test]
    fn a_sheet_of_one_channel_is_that_in_colour_but_for_black() {
        let mut tile = GrayAlphaImage::from_fn(40, 30, |x, y| image::LumaA([(5 * x + y) as u8, 255]));
        tile.put_pixel(3, 4, image::LumaA([0, 0]));
        let sheet = sheet(tile);
        let read = image::load_from_memory(&sheet.png().unwrap()).unwrap().into_rgb8();
        let mut colour = sheet.draw::<Rgb<u8>>();
        assert_eq!(colour.pixels().filter(|pixel| pixel.0 == UNKNOWN).count(), 1);
        colour.pixels_mut().filter(|pixel| pixel.0 == [0; 3]).for_each(|pixel| pixel.0 = [1; 3]);
        assert_eq!(read, colour);
    }
}
