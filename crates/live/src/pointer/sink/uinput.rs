//! A mouse of the kernel's, for X11 and Wayland alike: relative axes, a wheel and the left button.
//!
//! The desktop may accelerate its counts (libinput's profile `adaptive`): choose `flat` for them to be pixels. When the
//! program ends, however it ends, the kernel takes the mouse away and its button goes up.

use std::io;

use evdev::uinput::VirtualDevice;
use evdev::{AttributeSet, EventType, InputEvent, KeyCode, RelativeAxisCode};

use super::super::event::{Event, What};
use super::state::UinputState;

/// The mouse's name, as the desktop's settings show it.
const NAME: &str = "lunula fingernail mouse";

/// Why there is no mouse, or why it stopped.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum UinputFault {
    #[error("{}; {}", .0.found(), .0.remedy())]
    Unavailable(UinputState),
    #[error("the kernel's mouse: {0}")]
    Kernel(#[from] io::Error),
}

/// The mouse; it goes with this value.
#[derive(Debug)]
pub struct Uinput {
    device: VirtualDevice,
}

impl Uinput {
    /// Makes the mouse. A desktop takes a moment to see it.
    ///
    /// # Errors
    /// `/dev/uinput` is missing or not permitted, with what to do about it; the kernel refuses.
    pub fn open() -> Result<Self, UinputFault> {
        let builder = VirtualDevice::builder().map_err(|why| UinputFault::Unavailable(UinputState::of_error(&why)))?;
        let axes = [RelativeAxisCode::REL_X, RelativeAxisCode::REL_Y, RelativeAxisCode::REL_WHEEL];
        let axes: AttributeSet<RelativeAxisCode> = axes.into_iter().collect();
        let keys: AttributeSet<KeyCode> = [KeyCode::BTN_LEFT].into_iter().collect();
        let device = builder.name(NAME).with_relative_axes(&axes)?.with_keys(&keys)?.build()?;
        Ok(Self { device })
    }

    /// Hands an event to the kernel; one that is no move, button or scrolling is passed over.
    pub fn write(&mut self, event: &Event) -> Result<(), UinputFault> {
        let (events, count) = kernel_events(event);
        if count > 0 {
            self.device.emit(&events[..count])?;
        }
        Ok(())
    }
}

/// The kernel's events, and how many of them there are.
fn kernel_events(event: &Event) -> ([InputEvent; 2], usize) {
    let relative = |axis: RelativeAxisCode, value: i32| InputEvent::new(EventType::RELATIVE.0, axis.0, value);
    let none = relative(RelativeAxisCode::REL_X, 0);
    match event.what {
        What::Move { dx, dy } => ([relative(RelativeAxisCode::REL_X, dx), relative(RelativeAxisCode::REL_Y, dy)], 2),
        What::Scroll { lines } => ([relative(RelativeAxisCode::REL_WHEEL, lines), none], 1),
        What::Button { down, .. } => {
            ([InputEvent::new(EventType::KEY.0, KeyCode::BTN_LEFT.0, i32::from(down)), none], 1)
        }
        What::Zero { .. } | What::Drag { .. } | What::Ready | What::Lost { .. } => ([none, none], 0),
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::event::{Button, Reason};
    use super::super::state::uinput_state;
    use super::*;

    #[test]
    fn where_it_can_be_opened_it_takes_every_event_and_elsewhere_it_says_what_to_do() {
        match (uinput_state(), Uinput::open()) {
            (UinputState::Ready, mouse) => {
                let mut mouse = mouse.unwrap();
                mouse.write(&Event { t_s: 0.0, what: What::Move { dx: 3, dy: -2 } }).unwrap();
                mouse.write(&Event { t_s: 0.0, what: What::Move { dx: -3, dy: 2 } }).unwrap();
                mouse.write(&Event { t_s: 0.0, what: What::Ready }).unwrap();
            }
            (state, Err(why @ UinputFault::Unavailable(_))) => {
                let text = why.to_string();
                assert!(text.contains(&state.found()) && text.contains(&state.remedy()), "{text}");
                assert!(text.contains("modprobe") || text.contains("KERNEL==") || text.contains("dmesg"), "{text}");
            }
            (state, other) => panic!("{state:?}, but {other:?}"),
        }
    }

    #[test]
    fn counts_keys_and_lines_are_the_kernels() {
        let of = |event: Event| {
            let (events, count) = kernel_events(&event);
            events[..count].iter().map(|event| (event.event_type().0, event.code(), event.value())).collect::<Vec<_>>()
        };
        // linux/input-event-codes.h: EV_KEY 1, EV_REL 2, REL_X 0, REL_Y 1, REL_WHEEL 8, BTN_LEFT 0x110.
        assert_eq!(of(Event { t_s: 0.0, what: What::Move { dx: 5, dy: -7 } }), [(2, 0, 5), (2, 1, -7)]);
        assert_eq!(of(Event { t_s: 0.0, what: What::Scroll { lines: -2 } }), [(2, 8, -2)]);
        assert_eq!(of(Event { t_s: 0.0, what: What::Button { button: Button::Left, down: true } }), [(1, 0x110, 1)]);
        assert_eq!(of(Event { t_s: 0.0, what: What::Lost { reason: Reason::Lost } }), []);
    }
}
