//! The wearable mouse (thesis 6.2): shear moves, pressing harder or a tap clicks, bending scrolls.
//!
//! In: a [`Config`] (`mouse.toml`) and the predicted forces and posture of one sample after another. Out: [`Event`]s in
//! whole counts, for a file ([`Event::write_json`]) or a mouse of the kernel's (`Uinput`). What a simulated person
//! achieves with it is measured by tests (docs/src/jobs/mouse.md). The thesis built no mouse and names no figure; the
//! design is ours.
//!
//! Physics: shear exists only within the cone |F_r| <= mu N. So nothing moves but while the finger presses: *pressing
//! lightly* is to move and *pressing harder* to click, and the two interfere. Whoever presses to click also changes the
//! shear, by up to mu times the rise. The pointer is therefore frozen from the onset of the rise until the press is
//! over, and the last 60 ms of motion before it are taken back. For the same reason a finger in the air has no shear,
//! which is when the zero of the shear is set, and only then.
//!
//! Conventions: seconds of the stream's clock; newtons of the finger on the surface, `Fx_N` to the right, `Fy_N` away
//! from the person (*assumed*, where the sensor's axes are the desk's; `turn_deg` and `mirror_x` say otherwise);
//! pressing is -`Fz_N`; counts to the right and *down*, as screens count; lines of scrolling *up*, as the kernel
//! counts.

mod config;
mod decide;
mod event;
mod sink;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod user;

pub use config::{Click, Config, ConfigFault, Mode};
pub use decide::Pointer;
pub use event::{Button, Event, Reason, What};
#[cfg(target_os = "linux")]
pub use sink::{Uinput, UinputFault};
pub use sink::{UinputState, uinput_state};
