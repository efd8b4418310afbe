//! `lunula phantom`: synthetic scenes with exact truth.

mod study;

use std::fmt::Debug;
use std::path::PathBuf;

use anyhow::Context as _;
use clap::{Arg, Args, Subcommand};
use lunula::job::{Said, Watch};
use lunula::phantom::board::BoardOptions;
use lunula::phantom::nailvideo::NailVideoRequest;
use lunula::phantom::request::{LogRequest, PhotosRequest, VideoRequest};
use lunula::phantom::{Generated, Written};

use crate::{Common, Outcome};

/// Write synthetic scenes with exact truth: inputs as the jobs read them, and truth/ beside them
#[derive(Debug, Args)]
pub(crate) struct PhantomArgs {
    #[command(subcommand)]
    kind: Kind,
}

#[derive(Debug, Subcommand)]
enum Kind {
    /// Photographs of a chessboard through a known lens, with the exact lens, corners and poses
    ///
    /// Writes OUT/views/01.png .., which `lunula camera OUT/views` reads, with --plane OUT/plane.png, and OUT/truth/:
    /// camera.toml, corners.csv, views.csv, board.json.
    #[command(mut_arg("out", |out| folder(out, "views/ and truth/")))]
    Board(Box<Scene<BoardOptions>>),
    /// A log of eight photodiodes and three forces, with exact truth (3.1.2c, 3.3, 5.2.3)
    ///
    /// Writes OUT/log.csv, which `lunula align` reads as it is, and OUT/truth/: log.csv, angles.csv, log.json, and of
    /// --force contacts contacts.csv (--protocol contacts or rest: hours of a worn sensor, for switches). It belongs to
    /// the video that `lunula phantom video` writes from the same seed, trajectory and --bend-hz; both may be written
    /// to the same OUT. truth/angles.csv has the exact joint angles in the format of `lunula posture`, 30 a second,
    /// clock_s on the log's clock:
    /// `lunula align --joints OUT/truth/angles.csv --log OUT/log.csv --out training.csv --subject 1 --session 1` makes
    /// a posture training set without a video.
    #[command(mut_arg("out", |out| folder(out, "the log and truth/")))]
    Log(Box<Scene<LogRequest>>),
    /// A video of a fingernail that is pressed, sheared and bent, with exact motion, colour and hidden photodiodes
    /// (4.2, 4.3)
    ///
    /// Writes OUT/video.mp4, which `lunula nailvideo` reads, OUT/outline.json (the nail in the first frame, LabelMe),
    /// OUT/positions.toml (the photodiodes), OUT/log.csv (what a force transducer and a sensor that the same person
    /// wears log, on the video's clock), and OUT/truth/: frames.csv, presses.csv, log.csv, nailvideo.json.
    #[command(name = "nailvideo", mut_arg("out", |out| folder(out, "the video, what goes with it, and truth/")))]
    NailVideo(Box<Scene<NailVideoRequest>>),
    /// Photographs of nails of many shapes, sizes, skin tones and lights, in the eight poses of the thesis
    /// (4.2.3-4.2.6)
    ///
    /// Writes OUT/photos/<pose>/<subject>.png with a LabelMe file beside each, which `lunula photos OUT/photos` reads,
    /// and OUT/truth/: nails.csv, outlines/, normalized/*.npy and maps/*.npy, exact.
    #[command(mut_arg("out", |out| folder(out, "photos/ and truth/")))]
    Photos(Box<Scene<PhotosRequest>>),
    Study(Box<study::StudyArgs>),
    /// A video of a finger with coloured markers, with exact joint angles and marker centres (3.2.3, 3.3.5)
    ///
    /// Writes OUT/video.mp4 and OUT/markers.toml, which `lunula posture` reads as they are, and OUT/truth/: joints.csv,
    /// tracks.csv, clock.csv, scene.json. A scene sets all that follows; each option changes one thing of it.
    #[command(mut_arg("out", |out| folder(out, "the video, the marker file and truth/")))]
    Video(Box<Scene<VideoRequest>>),
}

/// One scene.
#[derive(Debug, Args)]
struct Scene<R: Args + Debug> {
    #[arg(long)]
    out: PathBuf,
    #[command(flatten)]
    request: R,
    #[command(flatten)]
    common: Common,
}

fn folder(out: Arg, what: &str) -> Arg {
    out.help(format!("Folder for {what}"))
}

pub(crate) fn run(args: &PhantomArgs) -> anyhow::Result<Outcome> {
    match &args.kind {
        Kind::Board(args) => args.run(|board| Ok(board.clone()), ["board", "board", "views", ""]),
        Kind::Log(args) => args.run(LogRequest::options, ["log", "log", "rows", "log.csv"]),
        Kind::NailVideo(args) => {
            args.run(NailVideoRequest::options, ["nailvideo", "nail video", "frames", "video.mp4"])
        }
        Kind::Photos(args) => args.run(|set| Ok(set.options()), ["photos", "photographs", "photographs", "photos"]),
        Kind::Study(args) => study::run(args),
        Kind::Video(args) => args.run(VideoRequest::options, ["video", "video", "frames", "video.mp4"]),
    }
}

impl<R: Args + Debug> Scene<R> {
    /// Writes what `make` makes of the request; words: the command, what is not there where it fails, what is counted,
    /// and the file or folder below `out` that has it.
    fn run<G: Generated>(
        &self,
        make: impl FnOnce(&R) -> anyhow::Result<G>,
        [command, what, unit, place]: [&'static str; 4],
    ) -> anyhow::Result<Outcome> {
        let none = format!("no synthetic {what}");
        let scene = make(&self.request).context(none.clone())?;
        // A lens is worked out side by side: threads are counted first.
        let Written { count, mut figures, total_s, warnings } =
            watched(&self.common, unit, none, |watch| scene.write_watched(&self.out, watch))?;
        self.common.warn(&warnings);
        figures["job"] = format!("phantom {command}").into();
        figures["version"] = env!("CARGO_PKG_VERSION").into();
        figures["warnings"] = warnings.into();
        self.common.print_json(&figures)?;
        let at = if place.is_empty() { self.out.clone() } else { self.out.join(place) };
        let truth = self.out.join("truth");
        self.common.say(&format!("{count} {unit} in {}, truth in {}; {total_s:.2} s", at.display(), truth.display()));
        Ok(Outcome::Done)
    }
}

/// Runs `work` with a bar that counts what it makes; where it fails, there is `none`: `no synthetic video`.
fn watched<T, E: Into<anyhow::Error>>(
    common: &Common,
    unit: &str,
    none: String,
    work: impl FnOnce(&Watch<'_>) -> Result<T, E>,
) -> anyhow::Result<T> {
    let stop = common.start()?;
    let bar = common.progress(0, unit);
    let tick = |done: u64, all: Option<u64>| {
        bar.set_length(all.unwrap_or(done));
        bar.set_position(done);
    };
    let made = work(&Watch { said: &Said::default(), stop: &stop, tick: &tick });
    bar.finish_and_clear();
    made.map_err(Into::into).context(none)
}
