//! Videos of a fingernail that is pressed, sheared and bent, with exact truth of motion and colour (2.3, 4.2, 4.3).
//!
//! In: [`NailVideoOptions`]. Out, under one folder:
//! - `video.mp4`: H.264 or HEVC; a frame's exposure is centred on its presentation time;
//! - `outline.json`: the nail's outline and axis in the first frame (LabelMe); `positions.toml`: the photodiodes'
//!   places;
//! - `log.csv`: what a force transducer and a sensor that the same person wears log, on the video's clock: `time_s`,
//!   `P1`.. volts, `Fx_N,Fy_N,Fz_N`; `truth/log.csv`: what is true of its rows, as `lunula phantom log` writes it;
//! - `truth/frames.csv`: `frame,time_s`; `a,b,c,d,e,f`: what is at (x, y) in frame 0 is at (a x + b y + c, d x + e y +
//!   f) in this one, at mid-exposure; `Fx_N,Fy_N,Fz_N,J2_deg`; `P1`..: the green light of the normalized nail over
//!   each photodiode's disc, a fraction of full scale's, without noise, in the first light (no light that drifts,
//!   nothing over the nail): that of the disc's mean as encoded, by the curve that `nailvideo` reads the film with;
//!   `P1_hidden`..: which share of the disc is covered or out of the picture; `status`: `ok`, or `gone` where another
//!   nail or none of this one is in the picture; then the same discs' red and blue (`P1_red`.., `P1_blue`..) and by
//!   what each channel's light is multiplied at the nail's middle (`light_red,light_green,light_blue`). Of another nail
//!   no motion is known: its cells are empty;
//! - `truth/presses.csv`: `press,onset_s,release_s`: when the force begins to rise and to fall, and `peak_N`; without
//!   `--protocol press` it has no rows;
//! - `truth/normalized/<frame>.npy`, with `--normalized`: the exact normalized green in the first light, as of
//!   photographs;
//! - `truth/nailvideo.json`: every parameter.
//!
//! The nail is that of `lunula phantom photos`, its colour that of [`ColourWeights`](super::nail::ColourWeights) with
//! the blood's lags: the very colour that `lunula phantom log --sensor nail` reads. It is a person's: the same for each
//! seed. What moves, hand and background, moves as one plane: an affine map.
//!
//! How it is drawn: the scene without zones and each zone's share are evaluated once, on a canvas of two samples a
//! pixel; a frame is the canvas with that moment's weights, sampled by Catmull and Rom's cubic. Against the scene
//! evaluated at the frame's own pixels this errs by *measured* 0.001/255 RMS within the nail and 0.008/255 over the
//! picture. Then come rod and finger, light, glare, noise, colour matrix. Motion blur is the mean of exposures no
//! more than 0.7 px apart. What is not modelled: parallax of the finger's round form, shadows of rod and finger,
//! rolling shutter, sharpening.
//!
//! The same options give the same bytes whatever the number of threads.

mod canvas;
mod check;
mod cover;
mod draw;
mod light;
mod options;
mod scene;
mod track;
mod truth;
mod write;

pub use crate::phantom::scene::faults::Faults;
pub use options::{NailProtocol, NailVideoOptions, NailVideoRequest};
pub use scene::{FrameTruth, Scene};
pub use track::Affine;
