//! A set of synthetic nail photographs, exactly as `lunula photos` reads it, with its truth (4.2.2, Fig. 49-56).
//!
//! In: [`PhotoOptions`]. Out, under one folder:
//! - `photos/<pose>/<subject>.png`, and with `annotate` beside each its LabelMe file: polygon `nail`, two-point line
//!   `axis`;
//! - `truth/nails.csv`: `file,nail,subject,pose,center_x_px,center_y_px,length_px,width_px,axis_deg` (`file` relative
//!   to `photos/`, `axis_deg` clockwise from up);
//! - `truth/outlines/<pose>/<subject>.json`: the same LabelMe files, whether or not `annotate`;
//! - `truth/normalized/<pose>/<subject>.npy`: float32, green as a fraction of full scale, NaN outside of the
//!   photograph;
//! - `truth/maps/<pose>-{mean,sd,count}.npy`: over the subjects' exact normalized pictures (float32, float32 with n -
//!   1, uint32);
//! - `truth/phantom.json`: the options.
//!
//! A subject has the same fingertip in all poses; where it lies, how it is turned and lit differs from photograph to
//! photograph. The set is written beside and put in its place when it is whole. The same options give the same bytes
//! whatever the number of threads.

mod files;
mod maps;
mod options;
mod write;

pub(in crate::phantom) use files::annotation;
pub use options::{FileFormat, LightKind, PhotoOptions};
pub(in crate::phantom) use write::write_npy;
