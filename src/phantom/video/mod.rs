//! Videos of a finger with coloured markers, exactly as `lunula posture` reads them, with exact truth (3.2.3, 3.3.5).
//!
//! In: [`VideoOptions`] (a [`Preset`], then changed). Out, under one folder:
//! - `video.mp4`: H.264 or HEVC; a frame's exposure is centred on its presentation time;
//! - `markers.toml`: `[markers]`, `[segments]`, `[joints]`, flexion, and where wanted `[start]`, `[clock]`, `[camera]`;
//!   it runs as it stands;
//! - `truth/joints.csv`: `frame,time_s,clock_s`, then each joint's exact angle at mid-exposure, which is that between
//!   lines through the markers' places;
//! - `truth/tracks.csv`: `frame,time_s,marker,x_px,y_px,in_view,status`: centres at mid-exposure as the lens shows
//!   them; `in_view` is the share of the marker's disc in the picture that nothing covers, and `status` ok, partial,
//!   hidden or outside. Of marks of paint, `x_px,y_px` are where the material point is that was the blot's centroid on
//!   the straight finger; `seen_x_px,seen_y_px` follow: the centroid of what is seen of the blot at mid-exposure, empty
//!   where that is nothing. Skin stretches, so that the two differ: an error that no tracker of paint escapes;
//! - `truth/clock.csv`, with a clock: `frame,time_s,clock_s,shown,shown_s,changing,status`: what the clock counts; what
//!   its screen shows, or would show where it is covered; whether that changes within the exposure; and ok, hidden,
//!   stopped or jumped;
//! - `truth/scene.json`: every parameter.
//!
//! Coordinates are those of the picture as it is shown, where the stored one is turned.
//!
//! Or, without files: [`Scene::picture`] and [`Scene::truth`].
//!
//! How it is drawn: sums of colours are taken in R'G'B' (gamma-encoded). Every edge is a disc's or a line's seen
//! through a Gaussian point-spread function, so that a marker's centroid is exact: it errs by under 0.002 px. Motion
//! blur is the mean of sub-exposures no more than 0.7 px apart. Flicker and the light's gradient multiply all but the
//! clock's screen, which shines by itself. Then comes the sensor's noise, the colour matrix and the chroma's siting. A
//! blot of paint and its strokes turn and stretch from frame to frame, not within an exposure. What is not modelled:
//! demosaicing, rolling shutter, depth of field, sharpening.
//!
//! The same options give the same bytes whatever the number of threads.

mod check;
mod coding;
mod draw;
mod marker_file;
mod options;
mod scene;
mod settle;
mod truth;
mod write;

pub use crate::phantom::scene::faults::Faults;
pub use crate::phantom::scene::lens::{Lens, Oblique};
pub use coding::Coding;
pub(in crate::phantom) use draw::picture::encoded;
pub use draw::sensor::Siting;
pub(in crate::phantom) use draw::sensor::add_noise;
pub use options::{Chroma, Colours, Hide, Leave, Preset, ScreenEvents, VideoOptions};
pub use scene::{FrameTruth, MarkerStatus, MarkerTruth, Scene, SceneMarker};
