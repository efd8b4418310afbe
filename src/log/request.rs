//! What the user says about a log: the options of every command and of every stage that reads logs.

use std::num::NonZeroUsize;

use clap::{ArgMatches, Args, Command, FromArgMatches};

use super::{AmbientOptions, AmbientRule, Columns, LogReading, TimeUnit};
use crate::job::one_of;

#[derive(Debug, Clone, Args)]
struct LogOptions {
    /// What the log's columns are called, as time_s=stamp,led=lamp,P1=ch_3,Fz_N=fz
    #[arg(long, help_heading = "Logs", value_name = "OURS=THEIRS,..", value_parser = Columns::parse)]
    columns: Option<Columns>,
    /// The unit of the log's time where it is a number: s, ms, us or ns [default: as its column's name says, else
    /// seconds]
    #[arg(long, help_heading = "Logs", value_name = "UNIT", value_parser = str::parse::<TimeUnit>)]
    time_unit: Option<TimeUnit>,
    /// The lowest and the highest voltage that can be recorded, as 0,10 [default: found where samples pile up at an
    /// extreme]
    #[arg(
        long,
        help_heading = "Logs",
        value_name = "LOW,HIGH",
        value_parser = AmbientOptions::parse_full_scale,
        allow_hyphen_values = true
    )]
    full_scale: Option<[f64; 2]>,
    /// Which unlit light is taken away from a lit row: interpolated (at its own time, between the unlit rows around) or
    /// preceding (the unlit row before it, as a live sensor is always read) [default: interpolated]
    #[arg(long, help_heading = "Logs", value_name = "RULE", value_parser = one_of::<AmbientRule>())]
    ambient: Option<AmbientRule>,
    /// Of a log whose clock was reset, which stretch to take, from 1
    #[arg(long, help_heading = "Logs", value_name = "N")]
    piece: Option<NonZeroUsize>,
    /// Of an XDF recording, the stream to take
    #[arg(long, help_heading = "Logs", value_name = "NAME")]
    stream: Option<String>,
}

impl From<LogOptions> for LogReading {
    fn from(said: LogOptions) -> Self {
        let mut columns = said.columns.unwrap_or_default();
        columns.time_unit = said.time_unit;
        columns.piece = said.piece;
        columns.stream = said.stream;
        Self {
            columns,
            ambient: AmbientOptions { full_scale_v: said.full_scale, rule: said.ambient.unwrap_or_default() },
        }
    }
}

impl FromArgMatches for LogReading {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        LogOptions::from_arg_matches(matches).map(Self::from)
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

impl Args for LogReading {
    fn augment_args(command: Command) -> Command {
        LogOptions::augment_args(command)
    }

    fn augment_args_for_update(command: Command) -> Command {
        LogOptions::augment_args_for_update(command)
    }
}
