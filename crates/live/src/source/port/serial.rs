//! Serial ports: which there are, and how one is opened.

use std::path::{Path, PathBuf};

use rustix::fs::{FlockOperation, Mode, OFlags, flock, open};
use rustix::io::Errno;
use rustix::termios::{ControlModes, OptionalActions, ioctl_tiocexcl, isatty, tcgetattr, tcsetattr};

use super::Port;

/// Opens a serial port: 8 data bits, no parity, one stop bit, no flow control, nothing translated.
pub(in crate::source) fn open_serial(path: &Path, baud: u32) -> Result<Port, String> {
    let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::NONBLOCK | OFlags::CLOEXEC;
    let fd = open(path, flags, Mode::empty()).map_err(|why| words(why, Path::new("/dev")))?;
    if !isatty(&fd) {
        return Err("is no serial port; play a file back by its name alone".to_owned());
    }
    // Two readers would each get a part of the bytes.
    let own = flock(&fd, FlockOperation::NonBlockingLockExclusive).and_then(|()| ioctl_tiocexcl(&fd));
    own.map_err(|why| words(why, Path::new("/dev")))?;
    let set = || {
        let mut settings = tcgetattr(&fd)?;
        settings.make_raw();
        settings.control_modes |= ControlModes::CREAD | ControlModes::CLOCAL;
        settings.control_modes -= ControlModes::CRTSCTS | ControlModes::CSTOPB | ControlModes::PARENB;
        settings.set_speed(baud)?;
        tcsetattr(&fd, OptionalActions::Now, &settings)
    };
    match set() {
        Ok(()) => Ok(Port::Serial(fd)),
        Err(Errno::INVAL) => {
            Err(format!("can't do {baud} baud; write a rate that the device and its bridge both know"))
        }
        Err(why) => Err(format!("cannot be set up ({why}); unplug it and plug it in again")),
    }
}

/// Asks the USB bridge of a port to hand on bytes at once rather than after 16 ms, as FTDI's do; what to do where it
/// may not be asked.
pub(in crate::source) fn hurry(path: &Path, tty: &Path) -> Option<String> {
    let name = path.canonicalize().ok()?.file_name()?.to_owned();
    let timer = tty.join(name).join("device/latency_timer");
    let holds_ms: u32 = std::fs::read_to_string(&timer).ok()?.trim().parse().ok()?;
    if holds_ms <= 1 || std::fs::write(&timer, "1").is_ok() {
        return None;
    }
    Some(format!(
        "the port's USB bridge holds bytes for up to {holds_ms} ms and may not be asked to hurry; as root: echo 1 > {}",
        timer.display()
    ))
}

fn words(why: Errno, dev: &Path) -> String {
    const FORBIDDEN: &str = "is not permitted; add yourself to the group that owns it (`ls -l` shows it, often \
                             dialout: `sudo usermod -aG dialout $USER`, then log in again), or let a udev rule do \
                             it (TAG+=\"uaccess\")";
    const BUSY: &str = "is busy: another program reads it, such as a serial monitor; close that";
    match why {
        Errno::NOENT | Errno::NXIO | Errno::NODEV => format!("does not exist; {}", there_are(&ports(dev))),
        Errno::ACCESS | Errno::PERM => FORBIDDEN.to_owned(),
        Errno::BUSY | Errno::AGAIN => BUSY.to_owned(),
        why => format!("cannot be opened ({why})"),
    }
}

fn there_are(ports: &[PathBuf]) -> String {
    if ports.is_empty() {
        return "there is no serial port; plug the device in, with a cable that carries data".to_owned();
    }
    let names: Vec<String> = ports.iter().map(|port| port.display().to_string()).collect();
    format!("there are: {}", names.join(", "))
}

/// Serial ports of USB devices, by names that last where there are such.
fn ports(dev: &Path) -> Vec<PathBuf> {
    let listed = |folder: PathBuf, prefixes: &[&str]| {
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
        let named = |path: &PathBuf| {
            let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
            prefixes.iter().any(|prefix| name.starts_with(prefix))
        };
        let mut paths: Vec<PathBuf> = entries.map(|entry| entry.path()).filter(named).collect();
        paths.sort();
        paths
    };
    let lasting = listed(dev.join("serial/by-id"), &[""]);
    if lasting.is_empty() { listed(dev.to_owned(), &["ttyUSB", "ttyACM", "cu.usb"]) } else { lasting }
}

/// The only serial port that there is.
///
/// # Errors
/// There is none, or there are several.
pub(in crate::source) fn the_only_port(dev: &Path) -> Result<PathBuf, String> {
    let mut ports = ports(dev);
    match ports.len() {
        0 => Err(there_are(&[])),
        1 => Ok(ports.remove(0)),
        count => Err(format!("{count} ports could be it; {}; write one, as in `serial:PORT`", there_are(&ports))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_only_port_is_found_by_its_lasting_name() {
        let dev = tempfile::tempdir().unwrap();
        let said = the_only_port(dev.path()).unwrap_err();
        assert!(said.contains("plug the device in"), "{said}");
        for name in ["ttyACM0", "tty1", "null"] {
            std::fs::write(dev.path().join(name), "").unwrap();
        }
        assert_eq!(the_only_port(dev.path()).unwrap(), dev.path().join("ttyACM0"));
        std::fs::write(dev.path().join("ttyUSB0"), "").unwrap();
        let said = the_only_port(dev.path()).unwrap_err();
        assert!(said.contains("2 ports") && said.contains("ttyACM0") && said.contains("ttyUSB0"), "{said}");
        std::fs::create_dir_all(dev.path().join("serial/by-id")).unwrap();
        std::fs::write(dev.path().join("serial/by-id/usb-nail"), "").unwrap();
        assert_eq!(the_only_port(dev.path()).unwrap(), dev.path().join("serial/by-id/usb-nail"));
    }

    #[test]
    fn bridges_are_asked_to_hurry() {
        let folder = tempfile::tempdir().unwrap();
        let (port, tty) = (folder.path().join("ttyUSB0"), folder.path().join("tty"));
        std::fs::write(&port, "").unwrap();
        assert_eq!(hurry(&port, &tty), None, "no such bridge");
        let device = tty.join("ttyUSB0/device");
        std::fs::create_dir_all(&device).unwrap();
        std::fs::write(device.join("latency_timer"), "16\n").unwrap();
        assert_eq!(hurry(&port, &tty), None);
        assert_eq!(std::fs::read_to_string(device.join("latency_timer")).unwrap(), "1");
    }

    #[test]
    fn why_a_port_cannot_be_opened_is_said_with_what_to_do() {
        for (why, said) in [
            (Errno::ACCESS, "dialout"),
            (Errno::BUSY, "another program reads it"),
            (Errno::AGAIN, "another program reads it"),
            (Errno::NOENT, "does not exist; there is no serial port"),
            (Errno::IO, "cannot be opened"),
        ] {
            let words = words(why, Path::new("/nowhere"));
            assert!(words.contains(said), "{words}");
        }
        let file = tempfile::NamedTempFile::new().unwrap();
        let said = open_serial(file.path(), 9600).err().unwrap();
        assert!(said.contains("is no serial port"), "{said}");
    }
}
