//! The working picture: reduced channels that do not depend on how bright the light is.
//!
//! In: a photograph of any sample type. Out: `TONE`, the logarithm of the green value (so that a step is a *relative*
//! contrast, the same in dim light), and for colour `RED`, ln(R/G), and `YELLOW`, ln(G/B), both unmoved by shading.
//! [`Levels`] holds the photograph at its working size and halved again and again.

use image::DynamicImage;

use crate::vision::{Cell, reduced};

/// ln(green + floor).
pub(super) const TONE: usize = 0;
/// ln(red / green); 0 on a grey photograph.
pub(super) const RED: usize = 1;
/// ln(green / blue); 0 on a grey photograph.
pub(super) const YELLOW: usize = 2;

/// Darkest value that counts, as a fraction of full scale: keeps logarithms finite and noise in the dark small.
const FLOOR: f32 = 0.02;
/// Mean |ln(R/G)| and |ln(G/B)| under which a picture counts as grey.
const GREY: f32 = 0.01;

/// A photograph at reduced size.
#[derive(Debug, Clone)]
pub struct Picture {
    /// Columns and rows.
    pub(super) size: [usize; 2],
    /// Row by row.
    pub(super) cells: Vec<Cell>,
    /// Whether there is more than tone.
    pub(super) colour: bool,
    /// Source pixels a working pixel.
    pub(super) step: f64,
}

/// A photograph at working size and smaller.
#[derive(Debug, Clone)]
pub struct Levels {
    /// Columns and rows of the photograph.
    pub(super) source_px: [f64; 2],
    /// Largest first, each half of the one before.
    pub(super) pictures: Vec<Picture>,
}

impl Levels {
    /// Smallest level's longest side is at least this.
    const LEAST: usize = 60;

    /// All levels of a photograph, the first with its longest side reduced by a whole factor to at most `longest_px`.
    pub fn of(image: &DynamicImage, longest_px: u32) -> Self {
        Self::of_part(image, [[0; 2], [image.width(), image.height()]], longest_px)
    }

    /// As [`Levels::of`], of a part of the photograph, its corner and size: places are counted from that corner.
    pub(super) fn of_part(image: &DynamicImage, part: [[u32; 2]; 2], longest_px: u32) -> Self {
        let [width, height] = part[1];
        let step = width.max(height).div_ceil(longest_px.max(1)).max(1) as usize;
        let mut pictures = vec![Picture::new(image, part.map(|sides| sides.map(|n| n as usize)), step)];
        while let Some(last) = pictures.last()
            && last.size[0].max(last.size[1]) >= 2 * Self::LEAST
            && last.size[0].min(last.size[1]) >= 2
        {
            pictures.push(last.halved());
        }
        Self { source_px: part[1].map(f64::from), pictures }
    }

    /// The largest level whose longest side is at most `longest_px` (or the smallest there is).
    pub(super) fn within(&self, longest_px: usize) -> &Picture {
        let fits = |p: &&Picture| p.size[0].max(p.size[1]) <= longest_px;
        self.pictures.iter().find(fits).unwrap_or(&self.pictures[self.pictures.len() - 1])
    }

    /// The coarsest level whose pixels are at most `px` source pixels (or the finest there is).
    pub(super) fn resolving(&self, px: f64) -> &Picture {
        self.pictures.iter().rev().find(|p| p.step <= px).unwrap_or(&self.pictures[0])
    }
}

impl Picture {
    fn new(image: &DynamicImage, part: [[usize; 2]; 2], step: usize) -> Self {
        let width = image.width() as usize;
        match image {
            DynamicImage::ImageLuma8(p) => Self::reduce::<_, 1>(p.as_raw(), width, part, step, 255.0),
            DynamicImage::ImageLumaA8(p) => Self::reduce::<_, 2>(p.as_raw(), width, part, step, 255.0),
            DynamicImage::ImageLuma16(p) => Self::reduce::<_, 1>(p.as_raw(), width, part, step, 65535.0),
            DynamicImage::ImageLumaA16(p) => Self::reduce::<_, 2>(p.as_raw(), width, part, step, 65535.0),
            DynamicImage::ImageRgb8(p) => Self::reduce::<_, 3>(p.as_raw(), width, part, step, 255.0),
            DynamicImage::ImageRgba8(p) => Self::reduce::<_, 4>(p.as_raw(), width, part, step, 255.0),
            DynamicImage::ImageRgb16(p) => Self::reduce::<_, 3>(p.as_raw(), width, part, step, 65535.0),
            DynamicImage::ImageRgba16(p) => Self::reduce::<_, 4>(p.as_raw(), width, part, step, 65535.0),
            other => Self::reduce::<_, 3>(other.to_rgb16().as_raw(), width, part, step, 65535.0),
        }
    }

    /// Logarithms of the means over `step x step` pixels of `SAMPLES` each, of a part: its corner and size.
    fn reduce<T: Copy + Into<f32>, const SAMPLES: usize>(
        raw: &[T],
        width: usize,
        [corner, part]: [[usize; 2]; 2],
        step: usize,
        full: f32,
    ) -> Self {
        let step = step.min(part[0]).min(part[1]).max(1);
        let size = part.map(|n| n / step);
        let scale = 1.0 / (full * (step * step) as f32);
        let log = |sum: f32| (sum * scale + FLOOR).ln();
        let table: Vec<f32> = (0..256u16).map(|v| log(f32::from(v))).collect();
        let is_in_table = step == 1 && full == 255.0;
        let pixels = raw.as_chunks::<SAMPLES>().0;
        let mut cells: Vec<Cell> = Vec::with_capacity(size[0] * size[1]);
        let mut sums = vec![[0.0f32; 3]; size[0]];
        for y in 0..size[1] {
            sums.fill([0.0; 3]);
            for sub in 0..step {
                let first = (corner[1] + y * step + sub) * width + corner[0];
                let line = &pixels[first..][..size[0] * step];
                for (cell, block) in sums.iter_mut().zip(line.chunks_exact(step)) {
                    for pixel in block {
                        for (sum, value) in cell.iter_mut().zip(pixel) {
                            *sum += (*value).into();
                        }
                    }
                }
            }
            let sums = sums.iter();
            if SAMPLES < 3 {
                cells.extend(sums.map(|s| [log(s[0]), 0.0, 0.0]));
            } else if is_in_table {
                cells.extend(sums.map(|s| ratios(s.map(|v| table[v as usize]))));
            } else {
                cells.extend(sums.map(|s| ratios(s.map(log))));
            }
        }
        let mean = |c: usize| cells.iter().map(|p| p[c].abs()).sum::<f32>() / cells.len().max(1) as f32;
        let colour = SAMPLES >= 3 && (mean(RED) > GREY || mean(YELLOW) > GREY);
        if !colour {
            cells.iter_mut().for_each(|p| *p = [p[TONE], 0.0, 0.0]);
        }
        Self { size, cells, colour, step: step as f64 }
    }

    fn halved(&self) -> Self {
        let (cells, size) = reduced(&self.cells, self.size, 2);
        Self { size, cells, colour: self.colour, step: 2.0 * self.step }
    }

    /// Working to source pixels.
    pub(super) fn to_source(&self, p: [f64; 2]) -> [f64; 2] {
        p.map(|v| (v + 0.5) * self.step - 0.5)
    }

    /// Source to working pixels.
    pub(super) fn source_to_own(&self, p: [f64; 2]) -> [f64; 2] {
        p.map(|v| (v + 0.5) / self.step - 0.5)
    }

    /// Channels at a source pixel, linearly between the working ones; beyond the border the border's.
    pub(super) fn sample(&self, source: [f64; 2]) -> Cell {
        let scale = 1.0 / self.step as f32;
        between(&self.cells, self.size, source.map(|v| (v as f32 + 0.5) * scale - 0.5))
    }
}

fn ratios([red, green, blue]: [f32; 3]) -> Cell {
    [green, red - green, green - blue]
}

/// Linear interpolation in a grid, held at its border.
pub(super) fn between(cells: &[Cell], size: [usize; 2], at: [f32; 2]) -> Cell {
    let x = at[0].clamp(0.0, (size[0] - 1) as f32);
    let y = at[1].clamp(0.0, (size[1] - 1) as f32);
    let (i, j) = (x as usize, y as usize);
    let (fx, fy) = (x - i as f32, y - j as f32);
    let (right, below) = (usize::from(i + 1 < size[0]), if j + 1 < size[1] { size[0] } else { 0 });
    let base = j * size[0] + i;
    let (a, b) = (cells[base], cells[base + right]);
    let (c, d) = (cells[base + below], cells[base + below + right]);
    let (wa, wb, wc, wd) = ((1.0 - fx) * (1.0 - fy), fx * (1.0 - fy), (1.0 - fx) * fy, fx * fy);
    [0, 1, 2].map(|k| a[k] * wa + b[k] * wb + c[k] * wc + d[k] * wd)
}
