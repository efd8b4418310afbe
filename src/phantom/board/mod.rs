//! Photographs of a chessboard through a known lens, exactly as `lunula camera` reads them, with exact truth.
//!
//! In: [`BoardOptions`]. Out, under one folder:
//! - `views/01.png` ..: grey photographs; the board lies wholly in each, turned at random;
//! - `plane.png`, with `plane`: the board in the plane in which `lunula phantom video --plane` moves its finger;
//! - `truth/camera.toml`: the lens, `[camera]` and with `plane` `[camera.plane]`, as marker files have them;
//! - `truth/corners.csv`: `view,corner,x_px,y_px`, the inner corners row after row as the lens shows them;
//! - `truth/views.csv`: `view,tilt_deg,rx_rad,ry_rad,rz_rad,tx_mm,ty_mm,tz_mm`: the angle between board and picture,
//!   and the board's pose, x of the camera = R x of the board + t;
//! - `truth/board.json`: the options.
//!
//! How it is drawn: a pixel's value is the mean of the board's pattern over the pixel, seen through a Gaussian, each
//! sample through the lens to the board. Then comes the sensor's noise. What is not modelled: depth of field, motion,
//! light that is not even, a board that is not flat. The same options give the same bytes whatever the number of
//! threads.

mod options;
mod place;
mod render;
mod write;

pub use options::BoardOptions;
pub use place::View;
pub use render::{Picture, Scene};
