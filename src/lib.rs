//! lunula: ground truth for fingernail sensing.
//!
//! Photographs of nails become average coloration maps with a standard deviation per pixel ([`photo`]), as in section 4.2.2
//! of S. Mascaro's thesis on fingernail sensors; [`phantom`] draws such photographs with exact truth; [`tradeoff`] measures
//! error against run time. [`figure`], [`files`], [`labelme`] and [`stages`] are the ground floor that these stand on.
//!
//! Everywhere: the centre of a picture's top-left pixel is (0, 0), x to the right, y down; units are part of a name
//! (`length_px`, `run_s`); what is not known is missing (`None`, NaN, an empty cell), never zero.

pub mod figure;
pub mod files;
pub mod labelme;
pub mod phantom;
pub mod photo;
pub mod stages;
pub mod tradeoff;
