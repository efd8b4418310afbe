//! A video's plane as it is shown: turned, averaged over blocks.
//!
//! In: samples of 8 to 16 bits. Out: values on the scale of 8 bits.

use opencv::boxed_ref::BoxedRef;
use opencv::core::{
    self, BORDER_REPLICATE, CV_8U, CV_32F, Mat, ROTATE_90_CLOCKWISE, ROTATE_90_COUNTERCLOCKWISE, ROTATE_180, Rect,
    Scalar, Size, ToOutputArray,
};
use opencv::imgproc::{self, INTER_AREA};
use opencv::prelude::*;

use super::{VisionError, answered, pixels, pixels_mut, size, view_mut};

/// A plane of samples, two bytes each (the low one first) over 8 bits.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Samples<'a> {
    pub(crate) width: usize,
    pub(crate) height: usize,
    /// Bytes from a row's first sample to the next row's.
    pub(crate) stride: usize,
    pub(crate) depth: u32,
    /// `height` x `stride` bytes.
    pub(crate) data: &'a [u8],
    /// How often it is turned by 90 degrees, clockwise, to be shown.
    pub(crate) quarters: usize,
}

impl Samples<'_> {
    /// Means over blocks of `step` x `step` samples of a part of what is shown: of its first column and row, and of so
    /// many blocks across and down.
    pub(crate) fn means(&self, from: [usize; 2], blocks: [usize; 2], step: usize) -> Vec<f32> {
        answered(self.try_means(from, blocks, step))
    }

    /// All of what is shown, as bytes of a picture of some width and height: means over blocks of so many samples
    /// across and down, the last column and row twice where some lack.
    pub(crate) fn shown(&self, block: [usize; 2], into: &mut [u8], size: [usize; 2]) {
        answered(self.try_shown(block, into, size));
    }

    fn try_means(&self, [x, y]: [usize; 2], [across, down]: [usize; 2], step: usize) -> Result<Vec<f32>, VisionError> {
        let mut means = vec![0.0; across * down];
        if means.is_empty() {
            return Ok(means);
        }
        let (wide, high) = (across * step, down * step);
        let [x, y, wide, high] = match self.quarters % 4 {
            0 => [x, y, wide, high],
            1 => [y, self.height - (x + wide), high, wide],
            2 => [self.width - (x + wide), self.height - (y + high), wide, high],
            _ => [self.width - (y + high), x, high, wide],
        };
        let rows = self.rows()?;
        let part = part(&rows, [x, y, wide, high])?;
        let mut target = view_mut(down, across, &mut means)?;
        let to_floats = VisionError::of("convertTo");
        if self.quarters.is_multiple_of(4) && step == 1 {
            part.convert_to(&mut target, CV_32F, self.scale(), 0.0).map_err(to_floats)?;
        } else {
            let mut values = Mat::default();
            part.convert_to(&mut values, CV_32F, self.scale(), 0.0).map_err(to_floats)?;
            averaged(&self.turned(values)?, &mut target, [across, down])?;
        }
        drop(target);
        Ok(means)
    }

    fn try_shown(&self, block: [usize; 2], into: &mut [u8], to: [usize; 2]) -> Result<(), VisionError> {
        let rows = self.rows()?;
        let stored = part(&rows, [0, 0, self.width, self.height])?;
        let mut target = pixels_mut::<u8>(to[1], to[0], into)?;
        let mut bytes = Mat::default();
        stored.convert_to(&mut bytes, CV_8U, self.scale(), 0.0).map_err(VisionError::of("convertTo"))?;
        let mut bytes = self.turned(bytes)?;
        let lacking = [size(to[0] * block[0])? - bytes.cols(), size(to[1] * block[1])? - bytes.rows()];
        if lacking != [0; 2] {
            let mut whole = Mat::default();
            let [right, bottom] = lacking;
            core::copy_make_border(&bytes, &mut whole, 0, bottom, 0, right, BORDER_REPLICATE, Scalar::default())
                .map_err(VisionError::of("copyMakeBorder"))?;
            bytes = whole;
        }
        averaged(&bytes, &mut target, to)
    }

    /// The stored samples, and beyond them what rows have before the next ones begin.
    fn rows(&self) -> Result<BoxedRef<'_, Mat>, VisionError> {
        let bytes = &self.data[..self.height * self.stride];
        if self.depth > 8 {
            pixels::<u16>(self.height, self.stride / 2, bytes)
        } else {
            pixels::<u8>(self.height, self.stride, bytes)
        }
    }

    fn scale(&self) -> f64 {
        1.0 / f64::from(1_u32 << self.depth.saturating_sub(8))
    }

    fn turned(&self, stored: Mat) -> Result<Mat, VisionError> {
        let how = match self.quarters % 4 {
            0 => return Ok(stored),
            1 => ROTATE_90_CLOCKWISE,
            2 => ROTATE_180,
            _ => ROTATE_90_COUNTERCLOCKWISE,
        };
        let mut turned = Mat::default();
        core::rotate(&stored, &mut turned, how).map_err(VisionError::of("rotate"))?;
        Ok(turned)
    }
}

fn part(rows: &impl MatTraitConst, part: [usize; 4]) -> Result<BoxedRef<'_, Mat>, VisionError> {
    let [x, y, width, height] = part.map(size);
    Mat::roi(rows, Rect::new(x?, y?, width?, height?)).map_err(VisionError::of("Mat"))
}

/// The means over as many samples as one of `target` covers.
fn averaged(mat: &Mat, target: &mut impl ToOutputArray, [width, height]: [usize; 2]) -> Result<(), VisionError> {
    let to = Size::new(size(width)?, size(height)?);
    imgproc::resize(mat, target, to, 0.0, 0.0, INTER_AREA).map_err(VisionError::of("resize"))
}
