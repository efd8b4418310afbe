//! What the user says about a log, the same for every command and every kind of stage that reads logs.

use std::num::NonZeroUsize;

use super::{AmbientOptions, Columns, LogReading, TimeUnit};
use clap::Args;

/// How a log is read.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Logs")]
pub struct LogRequest {
    /// What the log's columns are called, as time_s=stamp,led=lamp,P1=ch_3,Fz_N=fz
    #[arg(long, value_name = "OURS=THEIRS,..", value_parser = Columns::parse)]
    columns: Option<Columns>,
    /// The unit of the log's time where it is a number: s, ms, us or ns [default: as its column's name says, else
    /// seconds]
    #[arg(long, value_name = "UNIT", value_parser = str::parse::<TimeUnit>)]
    time_unit: Option<TimeUnit>,
    /// The lowest and the highest voltage that can be recorded, as 0,10 [default: found where samples pile up at an
    /// extreme]
    #[arg(long, value_name = "LOW,HIGH", value_parser = AmbientOptions::parse_full_scale, allow_hyphen_values = true)]
    full_scale: Option<[f64; 2]>,
    /// Of a log whose clock was reset, which stretch to take, from 1
    #[arg(long, value_name = "N")]
    piece: Option<NonZeroUsize>,
    /// Of an XDF recording, the stream to take
    #[arg(long, value_name = "NAME")]
    stream: Option<String>,
}

impl LogRequest {
    /// As jobs take it.
    #[must_use]
    pub fn reading(&self) -> LogReading {
        let mut columns = self.columns.clone().unwrap_or_default();
        columns.time_unit = self.time_unit;
        columns.piece = self.piece;
        columns.stream.clone_from(&self.stream);
        LogReading { columns, ambient: AmbientOptions { full_scale_v: self.full_scale } }
    }
}
