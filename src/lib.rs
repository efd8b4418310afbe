//! lunula: ground truth for fingernail sensing.
//!
//! Photographs of nails become average coloration maps with a standard deviation per pixel ([`photo`]), as in section
//! 4.2.2 of S. Mascaro's thesis on fingernail sensors; videos of a finger with coloured markers become joint angles
//! ([`posture`]), as in 3.2.3 and 3.3.5, with the time of a [`clock`] in the picture; [`camera`] measures the lens that
//! they are filmed through; [`nailvideo`] reads virtual photodiodes off a video of a nail; [`align`] brings the angles
//! onto the rows of photodiode and force logs; [`predictor`] makes of those models of force and posture, as in chapter
//! 5. [`hemodynamics`] is the blood under the nail that the photodiodes see, as in 4.3. [`layout`] says where
//! photodiodes would serve best. [`phantom`] makes such photographs, videos and logs with exact truth; [`tradeoff`]
//! measures error against run time; [`doctor`] looks at what is installed. [`video`], [`table`], [`figure`], [`files`],
//! [`flexion`], [`input`], [`labelme`], [`log`], [`stages`], [`timebase`] and [`words`] are the ground floor that these
//! stand on.
//!
//! Everywhere: the centre of a picture's top-left pixel is (0, 0), x to the right, y down; units are part of a name
//! (`length_px`, `run_s`); what is not known is missing (`None`, NaN, an empty cell), never zero.

pub mod align;
pub mod camera;
pub mod clock;
pub mod doctor;
pub mod figure;
pub mod files;
pub mod flexion;
pub mod hemodynamics;
pub mod input;
pub mod job;
pub mod labelme;
pub mod layout;
pub mod live;
pub mod log;
mod median;
pub mod nail;
pub mod nailvideo;
pub mod npy;
pub mod outlines;
pub mod phantom;
pub mod photo;
mod photograph;
pub mod pipeline;
pub mod posture;
pub mod predictor;
pub mod prompt;
#[cfg(test)]
#[path = "../tests/util/real_data.rs"]
mod real_data;
pub mod stages;
pub mod table;
pub mod timebase;
mod toml_file;
pub mod tradeoff;
#[cfg(test)]
mod trial;
pub mod video;
pub mod vision;
pub mod words;
