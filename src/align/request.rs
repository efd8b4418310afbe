//! How recordings are aligned, as the command line's options and a pipeline stage's keys say it.

use clap::Args;

use super::options::{AlignOptions, Sync};
use super::tie::{LagSearch, LagTie};
use crate::job::{not_negative, number};
use crate::log::{LogReading, LogRequest};

/// What `lunula align` takes besides files.
#[derive(Debug, Clone, Args)]
pub struct AlignRequest {
    /// How the clocks are tied: clock (in the picture), offset=SECONDS (the log's time at the video's first frame; with
    /// its standard error offset=SECONDS+-ERROR, without which labels have no standard errors), correlate
    /// [default: clock, where the table of angles has it]
    #[arg(long, value_name = "clock|offset=SECONDS|correlate", value_parser = Sync::parse, allow_hyphen_values = true)]
    sync: Option<Sync>,
    /// The log's time when the clock in the picture shows zero [default: the log's zero, hour or midnight that makes
    /// the two overlap]
    #[arg(long, value_name = "SECONDS", value_parser = number, allow_negative_numbers = true)]
    clock_zero: Option<f64>,
    /// With correlate: the offset about which to look [default: that at which log and video begin together]
    #[arg(long, value_name = "SECONDS", value_parser = number, allow_negative_numbers = true)]
    lag_about: Option<f64>,
    /// With correlate: how far from there to look [default: as far as half of the shorter recording overlaps]
    #[arg(long, value_name = "SECONDS", value_parser = not_negative)]
    max_lag: Option<f64>,
    /// With correlate: how much later than the finger the photodiodes answer, which is taken off the lag found
    #[arg(long, value_name = "SECONDS", value_parser = number, allow_negative_numbers = true)]
    sensor_lag: Option<f64>,
    /// Labels are interpolated over no longer time between two frames that were seen [default: two frames]
    #[arg(long, value_name = "SECONDS", value_parser = not_negative)]
    max_gap: Option<f64>,
    #[command(flatten)]
    log: LogRequest,
    /// Written into the set's column `subject`
    #[arg(long)]
    subject: Option<String>,
    /// Written into the set's column `session`
    #[arg(long)]
    session: Option<String>,
    /// What the finger does, for the names of the BIDS dataset [default: bending]
    #[arg(long)]
    task: Option<String>,
}

impl AlignRequest {
    /// As the job takes it.
    #[must_use]
    pub fn options(&self) -> AlignOptions {
        let LogReading { columns, ambient } = self.log.reading();
        AlignOptions {
            sync: self.sync,
            columns,
            ambient,
            max_gap_s: self.max_gap,
            clock_zero_s: self.clock_zero,
            lag: LagTie {
                search: LagSearch { about_s: self.lag_about, most_s: self.max_lag, ..LagSearch::default() },
                sensor_lag_s: self.sensor_lag,
            },
            subject: self.subject.clone(),
            session: self.session.clone(),
            task: self.task.clone(),
        }
    }
}
