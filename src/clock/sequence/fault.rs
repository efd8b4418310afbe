//! Why a video's readings tie no clock.

/// Why a video's readings tie no clock. Times are the video's, seconds.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages say it")]
pub enum ClockFault {
    #[error(
        "the clock was read in {read} of {frames} frames, of which {agree} agree; at least {fewest} that agree are \
         needed: check the clock's place and format in the marker file, or film it larger and unhidden"
    )]
    TooFew { read: usize, agree: usize, frames: usize, fewest: usize },
    #[error(
        "the clock stands still: it shows {shown_s} s from {from_s:.3} s to {to_s:.3} s of the video; cut the video to \
         where the clock runs, use a clock that is not paused, or if it is not, let `roi` under [clock] hold all of \
         its digits"
    )]
    Stops { from_s: f64, to_s: f64, shown_s: f64 },
    #[error(
        "the clock jumps by {by_s:+.3} s at {at_s:.3} s of the video; cut the video there and align the parts one by \
         one"
    )]
    Jumps { at_s: f64, by_s: f64 },
    #[error(
        "the clock runs {rate:.4} times as fast as the video; the file's frame times must be those of the recording: \
         no slow motion, time lapse or countdown, no other frame rate than the camera's"
    )]
    Rate {
        /// Seconds of the clock a second of the video.
        rate: f64,
    },
    /// Nothing that most readings agree on.
    #[error(
        "the clock's readings contradict each other: no more than {agree} of {read} agree, the first that does not is \
         at {at_s:.3} s of the video; check the clock's place and format in the marker file"
    )]
    Contradictory { agree: usize, read: usize, at_s: f64 },
    #[error("the clock's resolution is {resolution_s} s; it must be a positive number of seconds")]
    Resolution { resolution_s: f64 },
}
