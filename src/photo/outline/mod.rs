//! Outlines of nails ([`Outline`]) and their axes ([`Axis`]): drawn, from masks, or found.

mod annotated;
mod axis;
mod detect;
mod keep;
mod mask;
mod moments;
mod refused;
mod source;

pub use crate::nail::{Axis, Outline, OutlineFault};
pub use annotated::{
    AXIS, Annotated, AnnotationFault, DOUBTFUL, Drawn, DrawnNails, NAIL, NOT_A_NAIL, ShapeFault, ToDraw,
    read as read_annotated,
};
pub(crate) use annotated::{EXPORT, Labelled, has_nails, labelled, other_photograph, other_program, to_file};
pub use axis::{AxisDoubt, AxisUnknown, FoundAxis, LEAST_CONFIDENCE, Side, axis_towards, find_axes, find_axes_towards};
#[doc(hidden)]
pub use detect::training;
pub use detect::{DetectOptions, Detected, Detections, Detector, NothingFound, Unlike, detect, snap, template, unlike};
pub use keep::SavedOutlines;
pub(super) use keep::{DetectedOutline, keep_outlines};
pub(crate) use keep::{relative, to_draw};
pub use mask::{DroppedRegion, MaskFault, MaskOutlines, MaskValues, TooLarge, outlines_from_mask, outlines_of_values};
pub use moments::Moments;
pub use refused::{Refusal, Refused};
pub(crate) use source::hundredths;
pub use source::{Listed, Nail, OutlineOptions, OutlinePlace, Source, SourceFault, Sources};
