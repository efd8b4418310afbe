//! Views of a chessboard to a camera's lens, and to the plane in which a finger moves.
//!
//! In: photographs or videos of a flat chessboard, and where wanted one of the board lying in the finger's plane. Out:
//! the table `[camera]` of a marker file (focal lengths, the optical axis' place, distortion, all in pixels of the
//! upright picture and OpenCV's order), with the plane's normal in `[camera.plane]`, each with its standard error.
//!
//! Not determined: whether pictures are mirrored, as a chessboard is its own mirror image (the lens is then that of the
//! mirrored pictures, as it should be), and which of its corners is the first, which nothing depends on. Views that do
//! not determine the lens are refused.
//!
//! Source: Z. Zhang, "A flexible new technique for camera calibration", IEEE Trans. Pattern Anal. Mach. Intell. 22
//! (2000) 1330, doi:10.1109/34.888718, by OpenCV (the room `vision`); the standard errors are our own (`fit`).

mod board;
mod draw;
mod error;
mod fit;
mod judge;
mod options;
mod report;
mod run;
#[cfg(test)]
mod tests;
mod views;

pub use crate::vision::VisionError;
pub use board::{BoardSize, square_mm};
pub use error::CameraError;
pub use options::{CameraOptions, Inputs};
pub use report::{CameraFigures, CameraReport, LensFigures, PlaneFigures, ViewFigures};
pub use run::job::run;
pub use run::plan::plan;
