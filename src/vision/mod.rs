//! What lunula uses of OpenCV, behind safe functions on our own buffers.
//!
//! In: slices that the caller owns; OpenCV sees them as views (`view`, `Grey`), nothing is copied. Out: plain
//! numbers. An empty "success" of OpenCV is an error here ([`VisionError`]). OpenCV's own threads are off
//! (`ready`): the jobs share the machine's cores themselves, and their results don't depend on how many there are.
//! No type of OpenCV leaves this room.
//!
//! Everywhere: the centre of a picture's top-left pixel is (0, 0), x to the right, y down, as OpenCV has it too.

mod board;
mod cells;
mod image;
mod lens;
mod masks;
mod net;
mod parts;
#[cfg(test)]
pub(crate) mod peers;
mod plane;
mod strokes;

use std::sync::Once;

use opencv::boxed_ref::{BoxedRef, BoxedRefMut};
use opencv::core::{self, Mat};
use opencv::prelude::*;
use thiserror::Error;

pub(crate) use board::{Corners, Sought, find_board, shows_another};
pub(crate) use cells::{Cell, blurred, matched, reduced, smoothed};
pub(crate) use image::{closed_line, part_resized, resized};
pub(crate) use lens::{Calibration, Intrinsics, PARAMETERS, Pose, calibrate, project, undistorted};
#[cfg(test)]
pub(crate) use lens::{opencvs_sd, undistorted_by_default};
pub(crate) use masks::{borders, filled, opened, otsu_level};
pub(crate) use net::{Network, Planes};
pub(crate) use parts::{Neighbours, Part, Parts, parts, steps_out};
pub(crate) use plane::Samples;
pub(crate) use strokes::Stroke;

/// A call of OpenCV that gave nothing.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("OpenCV's {call}: {why}")]
pub struct VisionError {
    /// OpenCV's name of the function.
    pub call: &'static str,
    /// OpenCV's words, or what lacks in its answer.
    pub why: String,
}

impl VisionError {
    /// To give an error of OpenCV the name of its function.
    fn of(call: &'static str) -> impl FnOnce(opencv::Error) -> Self {
        move |why| Self { call, why: why.message }
    }

    /// Of an answer that lacks something.
    pub(crate) fn lacking(call: &'static str, why: impl Into<String>) -> Self {
        Self { call, why: why.into() }
    }
}

/// The answer of a call that fails only as an allocation does, or where a slice is not of the size that comes with it.
///
/// # Panics
/// Then, as an allocation or an index does.
fn answered<T>(answer: Result<T, VisionError>) -> T {
    answer.unwrap_or_else(|error| panic!("{error}"))
}

/// A grey picture of 8 bits, rows without gaps.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Grey<'a> {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) data: &'a [u8],
}

impl Grey<'_> {
    /// The picture as OpenCV takes it.
    fn mat(&self) -> Result<BoxedRef<'_, Mat>, VisionError> {
        view(self.height, self.width, self.data)
    }
}

/// `data` as OpenCV's matrix of so many rows and columns.
fn view<T: DataType>(rows: usize, columns: usize, data: &[T]) -> Result<BoxedRef<'_, Mat>, VisionError> {
    ready()?;
    Mat::new_rows_cols_with_data(size(rows)?, size(columns)?, data).map_err(VisionError::of("Mat"))
}

/// As [`view`], to be written.
fn view_mut<T: DataType>(rows: usize, columns: usize, data: &mut [T]) -> Result<BoxedRefMut<'_, Mat>, VisionError> {
    ready()?;
    Mat::new_rows_cols_with_data_mut(size(rows)?, size(columns)?, data).map_err(VisionError::of("Mat"))
}

/// Bytes of pixels `P` as OpenCV's matrix.
fn pixels<P: DataType>(rows: usize, columns: usize, bytes: &[u8]) -> Result<BoxedRef<'_, Mat>, VisionError> {
    ready()?;
    Mat::new_rows_cols_with_bytes::<P>(size(rows)?, size(columns)?, bytes).map_err(VisionError::of("Mat"))
}

/// As [`pixels`], to be written.
fn pixels_mut<P: DataType>(rows: usize, columns: usize, bytes: &mut [u8]) -> Result<BoxedRefMut<'_, Mat>, VisionError> {
    ready()?;
    Mat::new_rows_cols_with_bytes_mut::<P>(size(rows)?, size(columns)?, bytes).map_err(VisionError::of("Mat"))
}

fn size(length: usize) -> Result<i32, VisionError> {
    i32::try_from(length).map_err(|why| VisionError::lacking("Mat", why.to_string()))
}

/// Turns OpenCV's own threads off, once; every use of OpenCV begins here.
fn ready() -> Result<(), VisionError> {
    static ONCE: Once = Once::new();
    let mut set = Ok(());
    ONCE.call_once(|| set = core::set_num_threads(1));
    set.map_err(VisionError::of("setNumThreads"))
}
