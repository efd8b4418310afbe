//! Logs of photodiodes and forces, exactly as `lunula align` reads them, with exact truth (3.1.2c, 3.2.3, 5.2.3).
//!
//! In: [`LogOptions`]. Out, under one folder, beside a video of the same seed where one stands there:
//! - `log.csv`: `time_s` (the log's own clock; `time` where stamps are dates), `led` (1 on, 0 off, in turn), `P1`..`P8`
//!   volts, `Fx_N,Fy_N,Fz_N`;
//! - `truth/log.csv`, for the same rows: `sample` (which one, the lost ones counted), `time_s` (the video's time),
//!   `log_s` (the log's clock, without jitter, coarse stamps and jumps), `led`; the exact
//!   `J1_deg,J2_deg,J3_deg,Fx_N,Fy_N,Fz_N`; `P1`.. what the LED adds at that time when it is on, whether it is or not,
//!   with lag, hysteresis and drift; `P1_static`.. the static map alone, without these; `P1_unlit`.. ambient light and
//!   darkness: a lit sample reads `P1 + P1_unlit`, an unlit one `P1_unlit`, then noise, 16 bits over 0 to 10 V, and a
//!   reading in the log;
//! - `truth/angles.csv`: the exact angles as a table of `lunula posture`, 30 frames a second of the video's time,
//!   `clock_s` the log's clock: `lunula align` labels the log with them where no video was made;
//! - `truth/contacts.csv`, where the finger makes contacts of its own accord ([`contacts`](crate::phantom::contacts)):
//!   one row for each contact or near miss: `kind`, `start_s,end_s` (the video's time), `log_start_s,log_end_s` (the
//!   log's clock, without jumps), all exact, `peak_N`; a near miss that touches nothing is there from when the finger
//!   begins to bend until it is back. There, `truth/log.csv` has a column `contact`: 1 where the exact pressing is
//!   above 0 in a contact other than a near miss;
//! - `truth/log.json`: every parameter.
//!
//! With [`SensorModel::Nail`] the volts are those of the nail's own colour, as its pictures and videos show it, at
//! places that a file gives; the columns then have the places' names.
//!
//! The computer's clock decides when samples are taken: evenly on it, so that its drift is theirs. log time = offset +
//! (1 + drift) * video time. The finger moves as in the video of the same seed; person and session are the same
//! whatever the seed. Forces are those of the finger on the surface: pressing is a negative `Fz_N`. A [`Protocol`] is
//! an experiment of the thesis, whose finger follows as people do. Forces are read with the resolution of the
//! transducer of 3.2.3. [`LiveLog`] sends the same rows one after the other, without end where that is wanted.

mod angles;
mod check;
mod doing;
mod lines;
mod live;
mod options;
mod protocol;
mod record;
mod samples;
mod truth;
mod write;

pub use crate::phantom::scene::faults::Faults;
pub(in crate::phantom) use doing::Doing;
pub use doing::Prompting;
pub use live::{LiveLog, LiveRow};
pub use options::{LogOptions, SensorModel, Stamps};
pub use protocol::Protocol;
pub use record::LogScene;
pub(in crate::phantom) use samples::BEFORE_S;
pub use samples::Row;
pub(super) use write::{S_PER_MS, write_rows};
