//! What is installed, what is missing and how to get it.
//!
//! In: the folder that results are to go to, which need not exist. Out: a [`Check`] for each thing that a job may need,
//! with what was found and what to do about it. Nothing on the machine is changed: what is written to try a folder is
//! removed again.

use lunula_live::pointer::{UinputState, uinput_state};
use std::fs::{self, File, TryLockError};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::SystemTime;

use ffmpeg_next as ffmpeg;
use serde::Serialize;

use crate::video::Codec;

/// Less memory or room on a disk is noted, bytes (assumed: a video's run takes 0.1 GB, a study's results 0.5 GB).
const LITTLE: u64 = 1 << 30;
/// Clocks of two machines may be so far apart, s (assumed).
const APART_S: f64 = 5.0;
/// Decoders of what cameras and telephones write, by FFmpeg's names.
const DECODERS: [&str; 8] = ["h264", "hevc", "mjpeg", "mpeg4", "prores", "vp9", "ffv1", "rawvideo"];
/// What can't be done without the encoder of each codec that lunula writes.
const CODECS: [(Codec, &str); 2] = [
    (Codec::H264, "no overlay and no generated video can be written"),
    (Codec::Hevc, "no video can be generated with --codec hevc"),
];
/// Programs that lunula works with, none of which it needs: name, what it is for, how to get it.
const OTHERS: [(&str, &str, &str); 3] = [
    ("labelme", "corrects outlines by hand", "pip install labelme"),
    ("snakemake", "runs pipelines in parts on a cluster", "pip install snakemake snakemake-executor-plugin-slurm"),
    ("sbatch", "hands parts of pipelines to Slurm", "apt-get install slurm-wlm, or ask those who run your cluster"),
];

/// How well something is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum State {
    /// As it should be.
    Good,
    /// Missing or weak, which matters to some jobs only.
    Note,
    /// Jobs will fail, or their results can't be trusted.
    Bad,
}

/// One thing that was examined.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Check {
    /// In a few words, as the report shows it.
    pub what: String,
    /// How well it is.
    pub state: State,
    /// What was found.
    pub found: String,
    /// What to do; empty where nothing has to be done.
    pub remedy: String,
}

/// Checks that belong together.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Group {
    /// What they are about.
    pub about: String,
    /// In the order in which they are shown.
    pub checks: Vec<Check>,
}

/// Examines everything; `out` is the folder that results are to go to; `is_slow`: the program was built for debugging.
#[must_use]
pub fn examine(out: &Path, is_slow: bool) -> Vec<Group> {
    let group = |about: &str, checks: Vec<Check>| Group { about: about.to_owned(), checks };
    vec![
        group("this program", program(is_slow)),
        group("this machine", vec![threads(), memory(free_memory()), mouse()]),
        group("places to write to", [folder(out), vec![temporary()]].concat()),
        group("programs beside lunula", OTHERS.map(other).to_vec()),
    ]
}

fn good(what: &str, found: impl Into<String>) -> Check {
    Check { what: what.to_owned(), state: State::Good, found: found.into(), remedy: String::new() }
}

fn note(what: &str, found: impl Into<String>, remedy: impl Into<String>) -> Check {
    Check { what: what.to_owned(), state: State::Note, found: found.into(), remedy: remedy.into() }
}

fn bad(what: &str, found: impl Into<String>, remedy: impl Into<String>) -> Check {
    Check { state: State::Bad, ..note(what, found, remedy) }
}

fn program(is_slow: bool) -> Vec<Check> {
    let _ = ffmpeg::init();
    let path = std::env::current_exe().map_or_else(|why| why.to_string(), |path| path.display().to_string());
    let version = |name: &str, packed: u32| format!("{name} {}.{}.{}", packed >> 16, (packed >> 8) & 255, packed & 255);
    let libraries = [
        version("libavformat", ffmpeg::format::version()),
        version("libavcodec", ffmpeg::codec::version()),
        version("libswscale", ffmpeg::software::scaling::version()),
        version("libavutil", ffmpeg::util::version()),
    ];
    let missing: Vec<&str> =
        DECODERS.into_iter().filter(|name| ffmpeg::decoder::find_by_name(name).is_none()).collect();
    let no_encoder = CODECS.into_iter().filter(|(codec, _)| ffmpeg::encoder::find_by_name(codec.encoder()).is_none());
    vec![
        good("lunula", format!("{}, {path}", env!("CARGO_PKG_VERSION"))),
        if is_slow {
            note("build", "for debugging: slow", "build with --release to measure or to do much")
        } else {
            good("build", format!("optimized, for {}", std::env::consts::ARCH))
        },
        if cfg!(feature = "xdf") {
            good("logs in XDF", "built in")
        } else {
            let again = "build with --features xdf if you have such logs: `cargo install --locked --path crates/cli \
                         --features xdf`";
            note("logs in XDF", "left out when this was built", again)
        },
        good("FFmpeg", libraries.join(", ")),
        good("OpenCV", opencv::core::get_version_string().unwrap_or_else(|why| format!("unknown ({why})"))),
        codecs(&missing, no_encoder),
    ]
}

fn codecs(no_decoder: &[&str], no_encoder: impl Iterator<Item = (Codec, &'static str)>) -> Check {
    let decoders = (!no_decoder.is_empty()).then(|| format!("no decoder of {}", no_decoder.join(", ")));
    let encoders = no_encoder.map(|(codec, without)| format!("no {}: {without}", codec.encoder()));
    let missing: Vec<String> = decoders.into_iter().chain(encoders).collect();
    if missing.is_empty() {
        return good("codecs", "all that cameras commonly write");
    }
    let remedy = "install Debian's own libavcodec, and see that no other precedes it on LD_LIBRARY_PATH";
    note("codecs", missing.join("; "), remedy)
}

fn threads() -> Check {
    match std::thread::available_parallelism() {
        Ok(threads) => good("threads", format!("{threads}; --threads N takes fewer")),
        Err(why) => note("threads", format!("not known ({why})"), "give their number with --threads"),
    }
}

/// Whether a sensor can move this computer's pointer.
fn mouse() -> Check {
    let state = uinput_state();
    match state {
        UinputState::Ready => good("uinput", state.found()),
        _ => {
            note("uinput", format!("{}: `lunula mouse --uinput` can't move the pointer", state.found()), state.remedy())
        }
    }
}

/// Bytes that are free: of the machine, or of the group of processes (a container, a batch job) that this one was put
/// into, whichever is less; none where the system doesn't say.
#[must_use]
pub fn free_memory() -> Option<u64> {
    let read = |path: &str| fs::read_to_string(path).unwrap_or_default();
    least(&read("/proc/meminfo"), &read("/sys/fs/cgroup/memory.max"), &read("/sys/fs/cgroup/memory.current"))
}

fn least(meminfo: &str, most: &str, used: &str) -> Option<u64> {
    let line = meminfo.lines().find_map(|line| line.strip_prefix("MemAvailable:"));
    let machine = line.and_then(|line| line.split_whitespace().next()?.parse::<u64>().ok()).map(|kib| kib * 1024);
    let group = most.trim().parse::<u64>().ok().map(|most| most.saturating_sub(used.trim().parse().unwrap_or(0)));
    machine.into_iter().chain(group).min()
}

fn memory(bytes: Option<u64>) -> Check {
    match bytes {
        None => note("memory", "not known", "limit what `lunula run` may use with --memory"),
        Some(bytes) => free("memory", bytes, "end other programs, or use fewer --threads"),
    }
}

fn free(what: &str, bytes: u64, remedy: &str) -> Check {
    let found = format!("{:.1} GiB free", bytes as f64 / (1u64 << 30) as f64);
    if bytes < LITTLE { note(what, found, remedy) } else { good(what, found) }
}

/// The folder for results, or the one that it would be made in: files written, renamed over others and locked; its room
/// and its clock.
fn folder(out: &Path) -> Vec<Check> {
    let whole = std::path::absolute(out).unwrap_or_else(|_| out.to_owned());
    let at = whole.ancestors().find(|folder| folder.exists()).map_or_else(|| PathBuf::from("/"), Path::to_owned);
    let shown = at.display();
    let trial = tempfile::Builder::new().prefix(".lunula-").tempdir_in(&at);
    let (trial, written) = match trial.and_then(|trial| replace(trial.path()).map(|written| (trial, written))) {
        Ok(done) => done,
        Err(why) => {
            return vec![bad(
                "results",
                format!("{shown}: {why}"),
                "choose another --out, or make room and permission for it",
            )];
        }
    };
    let remedy = "never run two pipelines into this folder at once, or choose one on a local disk";
    let locks = match lock(trial.path()) {
        Ok(true) => good("locks", "keep two runs apart"),
        Ok(false) => bad("locks", format!("{shown}: a lock that is held was given a second time"), remedy),
        Err(why) => bad("locks", format!("{shown}: {why}"), remedy),
    };
    let make_room = "make room, or choose another --out";
    let room = match rustix::fs::statvfs(&at).map(|disk| disk.f_bavail.saturating_mul(disk.f_frsize)) {
        Err(why) => note("room", format!("not known ({why})"), make_room),
        Ok(bytes) => free("room", bytes, make_room),
    };
    vec![good("results", format!("{shown} can be written to")), locks, room, clock(written, SystemTime::now())]
}

/// Writes a file and renames it over another, as results are; its time.
fn replace(folder: &Path) -> io::Result<SystemTime> {
    let (place, beside) = (folder.join("result"), folder.join("beside"));
    fs::write(&place, "before")?;
    let mut file = File::create(&beside)?;
    file.write_all(b"after")?;
    file.sync_all()?;
    fs::rename(&beside, &place)?;
    if fs::read(&place)? != b"after" {
        return Err(io::Error::other("a renamed file does not hold what was written"));
    }
    fs::metadata(&place)?.modified()
}

/// Whether a lock keeps another out, and lets it in when it is released.
fn lock(folder: &Path) -> io::Result<bool> {
    let path = folder.join("lock");
    let (first, second) = (File::create(&path)?, File::create(&path)?);
    first.lock()?;
    match second.try_lock() {
        Ok(()) => return Ok(false),
        Err(TryLockError::WouldBlock) => {}
        Err(TryLockError::Error(why)) => return Err(why),
    }
    first.unlock()?;
    second.lock()?;
    Ok(true)
}

/// Whether a file written `now` has that time: a file server's clock may differ.
fn clock(written: SystemTime, now: SystemTime) -> Check {
    let apart_s = written.duration_since(now).unwrap_or_else(|before| before.duration()).as_secs_f64();
    if apart_s <= APART_S {
        return good("clock", "agrees with the times of files");
    }
    let found = format!("files written here have a time {apart_s:.1} s from this machine's clock");
    note("clock", found, "set the clocks of this machine and of the file server (`timedatectl set-ntp true`)")
}

fn temporary() -> Check {
    let at = std::env::temp_dir();
    match tempfile::tempdir_in(&at).and_then(|trial| replace(trial.path())) {
        Ok(_) => good("temporary files", format!("{} can be written to", at.display())),
        Err(why) => {
            bad("temporary files", format!("{}: {why}", at.display()), "set TMPDIR to a folder that can be written to")
        }
    }
}

fn other((name, purpose, get): (&str, &str, &str)) -> Check {
    match answer(Command::new(name).arg("--version")) {
        Ok(version) => good(name, version.lines().next().unwrap_or_default()),
        Err(why) => note(name, format!("{why}; it {purpose}"), get),
    }
}

/// What a program prints, or why it doesn't.
fn answer(command: &mut Command) -> Result<String, String> {
    let output = command.stdin(std::process::Stdio::null()).output().map_err(|why| match why.kind() {
        io::ErrorKind::NotFound => "not installed".to_owned(),
        _ => format!("can't be run ({why})"),
    })?;
    if output.status.success() {
        return Ok(String::from_utf8_lossy(&output.stdout).trim().to_owned());
    }
    let why = String::from_utf8_lossy(&output.stderr);
    Err(format!("fails ({}): {}", output.status, why.lines().next().unwrap_or_default()))
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn a_folder_is_left_as_it_was_and_a_file_in_its_place_is_bad() {
        let dir = tempfile::tempdir().unwrap();
        let checks = folder(&dir.path().join("not/yet/there"));
        let of = |what: &str| checks.iter().find(|check| check.what == what).map(|check| check.state);
        assert_eq!(
            (of("results"), of("locks"), of("clock")),
            (Some(State::Good), Some(State::Good), Some(State::Good))
        );
        assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 0);
        let file = dir.path().join("file");
        fs::write(&file, "").unwrap();
        let checks = folder(&file.join("out"));
        assert!(checks.len() == 1 && checks[0].state == State::Bad && checks[0].found.contains("file"), "{checks:?}");
    }

    #[test]
    fn what_is_weak_is_noted() {
        let now = SystemTime::now();
        assert_eq!(clock(now + Duration::from_secs(3), now).state, State::Good);
        for written in [now + Duration::from_secs(60), now - Duration::from_secs(60)] {
            assert!(clock(written, now).found.contains("60.0 s from"));
        }
        assert_eq!(
            [Some(4 << 30), Some(1 << 20), None].map(|bytes| memory(bytes).state),
            [State::Good, State::Note, State::Note]
        );
        assert_eq!(least("MemAvailable:    4194304 kB\n", "max\n", "17\n"), Some(4 << 30));
        assert_eq!(least("MemAvailable:    4194304 kB\n", "1073741824\n", "1073741800\n"), Some(24));
        assert_eq!((least("", "10\n", "17\n"), least("", "", "")), (Some(0), None));
        let poor = codecs(&["hevc"], CODECS.into_iter());
        assert!(poor.state == State::Note && poor.found.contains("of hevc"), "{poor:?}");
        assert!(CODECS.iter().all(|(codec, _)| poor.found.contains(codec.encoder())), "{poor:?}");
        let sh = |text: &str| answer(Command::new("sh").args(["-c", text]));
        assert_eq!(sh("echo 1.2").unwrap(), "1.2");
        assert!(sh("echo why >&2; exit 3").unwrap_err().ends_with("3): why"));
        assert_eq!(answer(&mut Command::new("no-such-program-of-lunula")).unwrap_err(), "not installed");
    }
}
