//! The channels compared: how much white and red zones of the nail differ in red, green and blue (section 4.2.2).
//!
//! In: the colour photographs of a pose, one per subject, with the frames of their nails. Out: for each pose and
//! channel the mean of white and of red zones, their contrast (white less red, a fraction of full scale) and the 95 %
//! confidence interval of its mean over subjects; the same for each skin tone that the manifest names; and the paired
//! differences between channels.
//!
//! **Zones** are the same places for all three channels, and no channel chooses them for itself. Taking the places
//! where green is high and low would count green's noise as contrast, and only green's. Instead
//! - a subject's zones come from the *other* subjects of the pose, so that its own noise has no say (cross-fitting);
//! - they come from a picture in which all channels have one vote: the mean over channels of the value as a fraction of
//!   that channel's mean on the bed. It does not change with exposure or white balance. Dividing by each channel's
//!   standard deviation instead was considered: it gives a channel that shows nothing but noise a full vote.
//!
//! White is the lightest quarter of the bed, red the darkest. A pose of one subject has nobody else's zones: they are
//! its own, which is said, and there is no interval.
//!
//! Photographs are worked on at a grid of 40 x 40 cells over the nail's box, means over a cell's area; they are kept
//! until all are there, 11 kB each whatever their size. Grey photographs have no channels and no part in this.
//!
//! Intervals take subjects to be independent. They are not quite, as they choose each other's zones: where nothing but
//! noise does, the mean's variance is twice what it seems, and 89 % of the intervals hold the truth (measured, see the
//! tests).
//!
//! Not determined: what of the contrast is blood. Shading and the lunula are light and dark in every channel.

mod cells;
mod compare;
mod interval;
mod results;
mod section;
mod zones;

pub(super) use cells::Cells;
pub use compare::{ChannelDifference, ChannelFigures, ChannelRow, ZonesOf};
pub(super) use compare::{Compared, Sample, compare};
pub use interval::Estimate;
pub(super) use results::write;
pub(super) use section::add_section;
