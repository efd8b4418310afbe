//! Video to joint angles (thesis sections 3.2.3 and 3.3.5).
//!
//! A video of a finger with coloured markers and a marker file go in; the angle of each joint in each frame, with its
//! standard error, comes out. [`Layout`] is the marker file, checked; a survey of the first frames finds the markers
//! and gives them their names; a tracker follows them, each centre by a fit of a blurred disc to luma and chroma about
//! where it is expected; `angle::view` brings centres to the shown, undistorted picture; `angle::joints` makes angles
//! of them; `angle::smooth` smooths them where asked; `draw` draws them. [`run`] is the one entry.
//!
//! Inside, coordinates are those of the *stored* picture ([`crate::video`]): the centre of its top-left luma sample is
//! (0, 0), x to the right, y down. Angles are in radians, positive in flexion.

mod angle;
mod draw;
mod error;
mod layout;
mod marker;
mod options;
mod run;
#[cfg(test)]
mod stage;
mod suggest;
mod survey;
mod track;

pub(crate) use angle::joints::Angle;
pub use angle::lens::Lens;
pub use draw::figures::{AngleFigures, CouplingLine};
pub use error::PostureError;
pub use layout::{Camera, Joint, Layout, LayoutError, Marker, MarkerShape, Segment};
pub(crate) use marker::method::{Method, Planes, Search};
pub(crate) use marker::sight::{Centre, Sight};
pub use options::{Outputs, PostureOptions};
pub use run::filmed_clock::{ClockReport, ClockTieReport};
pub use run::job::{run, suggest};
pub(crate) use run::kind::PostureJob;
pub use run::plan::plan;
pub use run::report::{
    CouplingReport, FrameCounts, JointReport, MarkerReport, PostureFigures, PostureReport, SearchReport, VideoReport,
};
