//! Where events go beside a file: a mouse of the kernel's.

mod state;
#[cfg(target_os = "linux")]
mod uinput;

pub use state::{UinputState, uinput_state};
#[cfg(target_os = "linux")]
pub use uinput::{Uinput, UinputFault};
