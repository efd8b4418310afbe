//! Whether this machine lets a program make a mouse.

use std::fs::OpenOptions;
use std::io;
use std::path::Path;

/// The kernel's file.
const UINPUT: &str = "/dev/uinput";
/// The line of a udev rule that lets the group `input` make devices.
const RULE: &str = r#"KERNEL=="uinput", GROUP="input", MODE="0660""#;

/// What `/dev/uinput` is like.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum UinputState {
    /// A mouse can be made.
    Ready,
    /// There is no such file.
    Missing,
    /// It may not be opened for writing.
    Forbidden,
    /// It can't be opened for another reason, in the system's words.
    Broken(String),
    /// Not a Linux system.
    OtherSystem,
}

impl UinputState {
    /// What was found, in words.
    #[must_use]
    pub fn found(&self) -> String {
        match self {
            Self::Ready => format!("{UINPUT} can be written to"),
            Self::Missing => format!("there is no {UINPUT}"),
            Self::Forbidden => format!("{UINPUT} may not be written to by this user"),
            Self::Broken(why) => format!("{UINPUT} can't be opened: {why}"),
            Self::OtherSystem => "only Linux has uinput".to_owned(),
        }
    }

    /// What to do about it; empty where nothing has to be done.
    #[must_use]
    pub fn remedy(&self) -> String {
        const TO_FILE: &str = "events go to a file without it";
        match self {
            Self::Ready => String::new(),
            Self::Missing => format!(
                "load the kernel's module: `modprobe uinput` as root, and a line `uinput` in \
                 /etc/modules-load.d/uinput.conf for the next start; a container has to be given the device; {TO_FILE}"
            ),
            Self::Forbidden => format!(
                "write the line {RULE} to /etc/udev/rules.d/60-uinput.rules, add the user to the group: `usermod -aG \
                 input USER` as root, then start again; {TO_FILE}"
            ),
            Self::Broken(_) => format!("see what the kernel says of it: `dmesg`; {TO_FILE}"),
            Self::OtherSystem => TO_FILE.to_owned(),
        }
    }

    /// The state behind an error of opening the file.
    pub(super) fn of_error(why: &io::Error) -> Self {
        match why.kind() {
            io::ErrorKind::NotFound => Self::Missing,
            io::ErrorKind::PermissionDenied => Self::Forbidden,
            // A file that was made without its driver: ENODEV, ENXIO.
            _ if matches!(why.raw_os_error(), Some(6 | 19)) => Self::Missing,
            _ => Self::Broken(why.to_string()),
        }
    }
}

/// Whether a mouse can be made here, as `lunula doctor` says it. Nothing is made.
#[must_use]
pub fn uinput_state() -> UinputState {
    if cfg!(target_os = "linux") { state_of(Path::new(UINPUT)) } else { UinputState::OtherSystem }
}

fn state_of(path: &Path) -> UinputState {
    match OpenOptions::new().read(true).write(true).open(path) {
        Ok(_) => UinputState::Ready,
        Err(why) => UinputState::of_error(&why),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_missing_is_named_with_its_remedy() {
        let state = state_of(Path::new("/dev/no/such/device"));
        assert_eq!(state, UinputState::Missing);
        assert!(state.found().contains("/dev/uinput") && state.remedy().contains("modprobe uinput"));
        let state = UinputState::of_error(&io::Error::from(io::ErrorKind::PermissionDenied));
        assert_eq!(state, UinputState::Forbidden);
        let remedy = state.remedy();
        assert!(remedy.contains(r#"KERNEL=="uinput", GROUP="input", MODE="0660""#) && remedy.contains("usermod -aG"));
        let UinputState::Broken(why) = state_of(Path::new("/")) else { panic!("a folder is not a device") };
        assert!(!why.is_empty());
        assert_eq!(UinputState::Ready.remedy(), "");
    }

    #[test]
    fn asking_agrees_with_the_file() {
        if cfg!(target_os = "linux") && !Path::new(UINPUT).exists() {
            assert_eq!(uinput_state(), UinputState::Missing);
        }
    }
}
