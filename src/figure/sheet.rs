//! Sheets: many small pictures in a grid, each with its caption, a title above and a scale below. PNG and SVG.

use base64::Engine;
use image::{DynamicImage, GrayAlphaImage, GrayImage, Rgb, RgbImage};
use imageproc::drawing::draw_hollow_rect_mut;
use imageproc::rect::Rect;

use super::Stretch;
use super::html::escape;
use super::text::{INK, centred, left};

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

    /// Row `y` as colours on a sheet.
    fn draw_row(&self, y: u32, to: &mut [[u8; 3]]) {
        match self {
            Self::Grey(picture) => {
                let width = picture.width() as usize;
                let row = &picture.as_raw()[2 * width * y as usize..];
                for (to, from) in to.iter_mut().zip(row.chunks_exact(2)).take(width) {
                    *to = if from[1] == 0 { UNKNOWN.0 } else { [from[0]; 3] };
                }
            }
            Self::Colour(picture) => {
                let width = picture.width() as usize;
                let row = &picture.as_raw()[3 * width * y as usize..];
                to[..width].copy_from_slice(&row.as_chunks::<3>().0[..width]);
            }
        }
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
const PAPER: Rgb<u8> = Rgb([255, 255, 255]);
/// Behind unknown pixels: a colour, so that it can't be taken for a grey level.
const UNKNOWN: Rgb<u8> = Rgb([205, 216, 240]);

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

    /// Draws the sheet.
    pub fn draw(&self) -> RgbImage {
        let layout = self.layout();
        let mut sheet = RgbImage::from_pixel(layout.size[0], layout.size[1], PAPER);
        left(&mut sheet, &self.title, GAP as i32, 14, 22.0);
        for (at, tile) in self.tiles.iter().enumerate() {
            let [x0, y0] = layout.corner(at);
            let [width, height] = tile.picture.size();
            let left = x0 + (layout.tile[0] - width) / 2;
            for y in 0..height {
                let start = 3 * ((y0 + y) * layout.size[0] + left) as usize;
                let samples: &mut [u8] = &mut sheet;
                tile.picture.draw_row(y, samples[start..].as_chunks_mut::<3>().0);
            }
            let middle = (x0 + layout.tile[0] / 2) as i32;
            centred(&mut sheet, &tile.caption, middle, (y0 + layout.tile[1] + 4) as i32, 17.0, layout.tile[0]);
        }
        if let Some(scale) = &self.scale {
            let y = layout.size[1] - SCALE + 6;
            let frame = Rect::at(GAP as i32 + 9, y as i32 - 1).of_size(BAR[0] + 2, BAR[1] + 2);
            draw_hollow_rect_mut(&mut sheet, frame, INK);
            for (x, level) in scale.levels().enumerate() {
                for dy in 0..BAR[1] {
                    sheet.put_pixel(GAP + 10 + x as u32, y + dy, Rgb([level; 3]));
                }
            }
            for (position, text) in scale.ticks() {
                centred(&mut sheet, &text, (GAP + 10 + position) as i32, (y + BAR[1] + 4) as i32, 15.0, 60);
            }
            left(&mut sheet, &scale.label, (GAP + BAR[0] + 34) as i32, y as i32, 17.0);
        }
        sheet
    }

    /// The sheet as a PNG file, of one channel where nothing on it is unknown.
    ///
    /// # Errors
    /// Where it can't be encoded.
    pub fn png(&self) -> Result<Vec<u8>, image::ImageError> {
        let drawn = self.draw();
        let grey = drawn.pixels().all(|p| p.0[0] == p.0[1] && p.0[1] == p.0[2]);
        let levels = || drawn.chunks_exact(3).map(|p| p[0]).collect();
        let flat = if grey {
            GrayImage::from_raw(drawn.width(), drawn.height(), levels()).map(DynamicImage::from)
        } else {
            None
        };
        super::png(&flat.unwrap_or_else(|| drawn.into()))
    }

    /// The sheet as SVG: pictures embedded, words as words.
    ///
    /// # Errors
    /// Where a picture can't be encoded.
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
