//! Pictures of results: grey maps, sheets with captions and scales, plots, reports. It knows numbers and pictures, not
//! jobs.

mod grey;
mod html;
mod plot;
mod sheet;
mod text;

pub use grey::{Stretch, grey_map};
pub use html::{Page, escape};
pub use plot::{Axis, Plot, Point, Series, draw_log_log};
pub use sheet::{Scale, Sheet, Tile};
