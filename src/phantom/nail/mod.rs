//! Photographs of one fingertip as in the thesis' chamber (section 4.2.2, Fig. 49-56), drawn from shape, colour and
//! light.
//!
//! In: a [`Subject`] (shape, skin, nail), a [`Pose`] (which zones of the nail bed redden or whiten, 4.2.3-4.2.6) or the
//! [`ColourWeights`] of a moment between poses ([`Field::at_moment`]), a [`Light`] and a [`Camera`]. Out: the
//! photograph, and what is true of it: outline, axis, and the normalized picture.
//!
//! Conventions:
//! - *picture*: pixels of the upright photograph, centre of the top-left pixel at (0, 0), x right, y down;
//! - *finger*: half nail widths from the middle of the nail's box, `across` to the right with the distal end up,
//!   `along` to the distal end;
//! - *nail*: `u` across, `v` along, the nail's box being -1..1 in both.
//!
//! Colours are fractions of full scale as a camera encodes them (sRGB's curve), composed in that space. What is not
//! modelled: depth of field, the finger's third dimension other than by shading, interreflection.

mod chamber;
mod coloration;
mod field;
mod finger;
mod pose;
mod render;
mod scene;
mod shape;
mod skin;
mod smooth;
mod subject;

pub use chamber::camera::{Background, Camera};
pub use chamber::light::{Glare, Light};
pub use coloration::{Blood, ColourWeights, PATTERNS};
pub use field::Field;
pub use finger::FingerShape;
pub use pose::{Pose, UnknownPose};
pub use render::{Depth, RenderOptions};
pub use scene::{NailScene, SceneFault};
pub use shape::NailShape;
pub use skin::Tone;
pub use subject::{Speck, Subject, numbers};
