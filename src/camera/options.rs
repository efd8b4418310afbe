//! How a lens is measured: the options of `lunula camera` and of a pipeline's stage; and where results go.

use std::path::PathBuf;

use clap::Args;

use super::board::{BoardSize, square_mm};
use crate::job::number;

/// How to work.
#[derive(Debug, Clone, Args)]
pub struct CameraOptions {
    /// Inner corners of the chessboard, across and down: 9x6 of a board of 10 x 7 squares
    #[arg(long, value_name = "COLUMNSxROWS")]
    pub board: BoardSize,
    /// Side of a square
    #[arg(long, value_name = "MM", value_parser = square_mm)]
    pub square_mm: f64,
    /// Of a video, one frame is looked at every so many seconds
    #[arg(long, value_name = "SECONDS", default_value = "0.5", value_parser = interval)]
    pub every: f64,
    /// Coefficients of the lens' distortion: 5 (k1, k2, p1, p2, k3), 4 (without k3, for few views of a usual lens) or 0
    #[arg(long, value_name = "5|4|0", default_value = "5", value_parser = coefficients)]
    pub coefficients: usize,
    /// Threads that decode (0: all cores).
    #[arg(skip)]
    pub threads: usize,
}

fn interval(text: &str) -> Result<f64, String> {
    number(text).ok().filter(|s| *s >= 0.0).ok_or_else(|| "write seconds, as 0.5; 0 looks at every frame".to_owned())
}

fn coefficients(text: &str) -> Result<usize, String> {
    let count = text.parse().ok().filter(|count| [0, 4, 5].contains(count));
    count.ok_or_else(|| "choose 5, 4 or 0".to_owned())
}

/// What is looked at.
#[derive(Debug, Clone, PartialEq, Eq, Args)]
pub struct Inputs {
    /// A folder of photographs (png, jpg, tif, bmp), single photographs, or videos
    #[arg(required = true)]
    pub views: Vec<PathBuf>,
    /// A photograph or video of the board lying in the plane in which the finger moves, filmed as the videos are: the
    /// plane goes into [camera.plane], and angles seen obliquely are measured right
    #[arg(long, value_name = "FILE")]
    pub plane: Option<PathBuf>,
}
