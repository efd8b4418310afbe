//! Where events go: lines of JSON to any writer, and a mouse of the kernel's.

mod json;
mod state;
#[cfg(target_os = "linux")]
mod uinput;

pub use json::JsonLines;
pub use state::{UinputState, uinput_state};
#[cfg(target_os = "linux")]
pub use uinput::{Uinput, UinputFault};
