//! The program itself: how it was built, and the one beside it that reads video.

use std::path::PathBuf;

use super::{Check, Linked, State};

/// How the command line was built, and where it stands.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Program {
    /// The file that runs.
    pub path: PathBuf,
    /// The file that has FFmpeg's libraries, beside it.
    pub with_video: PathBuf,
}

/// What building lunula needs, and so, libraries among it, what running it does.
const SYSTEM_PACKAGES: &str = include_str!("../../system-packages.txt");

impl Program {
    pub(super) fn examine(&self, linked: &Linked) -> Vec<Check> {
        let mut checks = vec![
            Check::good("lunula", format!("{}, {}", env!("CARGO_PKG_VERSION"), self.path.display())),
            build(),
            xdf(),
            Check::good("typefaces", "built in"),
        ];
        match linked {
            Linked::Runs(libraries) if libraries.lunula != env!("CARGO_PKG_VERSION") => checks.push(Check::bad(
                "lunula-video",
                format!("{} is of version {}", self.with_video.display(), libraries.lunula),
                "install both programs anew, from the same sources: `cargo install --locked --path .`",
            )),
            Linked::Runs(libraries) => {
                checks.push(Check::good("lunula-video", self.with_video.display().to_string()));
                checks.push(Check::good("FFmpeg", libraries.ffmpeg.join(", ")));
                checks.push(Check::good("OpenCV", &libraries.opencv));
                checks.extend(codecs(&libraries.no_decoder, libraries.no_encoder.as_deref()));
            }
            Linked::Fails(why) => checks.push(Check::bad(
                "lunula-video",
                format!("{} does not run: {why}; it does what needs video", self.with_video.display()),
                format!("install it beside lunula, and the system's packages: apt-get install {}", packages()),
            )),
        }
        checks
    }
}

/// The packages of the list, in one line.
fn packages() -> String {
    let names: Vec<&str> = SYSTEM_PACKAGES.lines().filter(|line| !line.starts_with('#')).collect();
    names.join(" ")
}

fn build() -> Check {
    if cfg!(debug_assertions) {
        return Check::note("build", "for debugging: slow", "build with --release to measure or to do much");
    }
    Check::good("build", format!("optimized, for {}", std::env::consts::ARCH))
}

fn xdf() -> Check {
    if cfg!(feature = "xdf") {
        return Check::good("logs in XDF", "built in");
    }
    let again = "build with --features xdf if you have such logs: `cargo install --locked --path . --features xdf`";
    Check::note("logs in XDF", "left out when this was built", again)
}

/// What FFmpeg can't decode or encode here.
fn codecs(no_decoder: &[String], no_encoder: Option<&str>) -> Vec<Check> {
    const REMEDY: &str =
        "install Debian's own libavcodec, and take care that no other stands before it on LD_LIBRARY_PATH";
    let mut checks = Vec::new();
    if no_decoder.is_empty() {
        checks.push(Check::good("codecs", "all that cameras commonly write"));
    } else {
        checks.push(Check::note("codecs", format!("no decoder of {}", no_decoder.join(", ")), REMEDY));
    }
    if let Some(encoder) = no_encoder {
        let found = format!("{encoder} is not there: no overlay and no generated video can be written");
        checks.push(Check { what: "H.264".to_owned(), state: State::Note, found, remedy: REMEDY.to_owned() });
    }
    checks
}

#[cfg(test)]
mod tests {
    use super::super::Libraries;
    use super::*;

    fn libraries() -> Libraries {
        Libraries {
            lunula: env!("CARGO_PKG_VERSION").to_owned(),
            ffmpeg: vec!["libavcodec 1.2.3".to_owned()],
            opencv: "4.0".to_owned(),
            no_decoder: Vec::new(),
            no_encoder: None,
        }
    }

    fn of(linked: Linked) -> Vec<Check> {
        Program { path: "lunula".into(), with_video: "lunula-video".into() }.examine(&linked)
    }

    #[test]
    fn one_that_is_of_another_version_or_does_not_run_is_bad() {
        assert!(of(Linked::Runs(libraries())).iter().all(|check| check.state != State::Bad));
        let other = Libraries { lunula: "0.0.1".to_owned(), ..libraries() };
        for linked in [Linked::Runs(other), Linked::Fails("no such file".to_owned())] {
            let bad: Vec<Check> = of(linked).into_iter().filter(|check| check.state == State::Bad).collect();
            assert_eq!(bad.len(), 1);
            assert_eq!(bad[0].what, "lunula-video");
            assert!(!bad[0].remedy.is_empty());
        }
    }

    #[test]
    fn what_can_t_be_decoded_or_encoded_is_named() {
        let poor =
            Libraries { no_decoder: vec!["hevc".to_owned()], no_encoder: Some("libx264".to_owned()), ..libraries() };
        let notes: Vec<Check> =
            of(Linked::Runs(poor)).into_iter().filter(|check| check.remedy.contains("libavcodec")).collect();
        assert_eq!(notes.len(), 2, "{notes:?}");
        assert!(notes[0].found.contains("hevc") && notes[1].found.contains("libx264"));
    }

    #[test]
    fn the_packages_are_those_of_the_list() {
        assert!(packages().contains("libavcodec-dev") && !packages().contains('#') && !packages().contains("  "));
    }
}
