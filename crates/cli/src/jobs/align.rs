//! `lunula align`: joint angles on photodiode samples.

use std::path::PathBuf;

use anyhow::ensure;
use clap::Args;
use lunula::align::{self, AlignInputs, AlignOptions, AlignOutputs, AlignReport};
use lunula::job::Given;
use lunula::words::fixed;

use crate::jobs::{self, ResultArgs};
use crate::{Common, Outcome};

/// Label a photodiode log with joint angles: two clocks tied together, with a certificate of how well
///
/// log time = offset + (1 + drift) * video time. The clock in the picture ties the two (clock_s in the table of
/// angles); so does an offset that you know; or, without either, the lag at which the photodiodes best explain the
/// angles. Each row of the log (each lit one, less the unlit light at its time, where there is a column `led`) gets the
/// angles at its time, between frames that were really seen, with their standard error; rows without a label stay
/// empty, and label_status gives the reason. Results: the set, and beside it <training>.sync.json, the certificate
/// (offset, drift, their errors, residuals, what was left unlabelled), <training>.run.json and pictures of the tie and
/// of the labels over the photodiodes.
#[derive(Debug, Args)]
#[command(mut_arg("out", |out| out
    .value_name("TRAINING.csv")
    .help("The labelled set: time_s, P1.., forces, <joint>_deg, <joint>_sd_deg, label_status, subject, session, \
           sensor_status (.csv or .parquet)")
))]
pub(crate) struct AlignArgs {
    /// The table of joint angles of `lunula posture`: time_s, clock_s, <joint>_deg, <joint>_sd_deg
    #[arg(long, value_name = "JOINTS.csv")]
    joints: PathBuf,
    /// The log: time_s, led (1 on, 0 off; may be absent), P1.., Fx_N, Fy_N, Fz_N (.csv, .csv.gz, .parquet; .xdf where
    /// built in)
    #[arg(long, value_name = "LOG.csv")]
    log: PathBuf,
    #[command(flatten)]
    given: Given<AlignOptions>,
    /// The angles on the log's clock as an OpenSim motion file as well
    #[arg(long, value_name = "FILE.mot")]
    mot: Option<PathBuf>,
    /// The angles on the log's clock as a BIDS Motion dataset as well (--subject and --session name its folders)
    #[arg(long, value_name = "FOLDER")]
    bids: Option<PathBuf>,
    /// The markers as a DeepLabCut table as well
    #[arg(long, value_name = "FILE.csv", requires = "tracks")]
    dlc: Option<PathBuf>,
    /// The table of markers of `lunula posture`, for --dlc
    #[arg(long, value_name = "TRACKS.csv", requires = "dlc")]
    tracks: Option<PathBuf>,
    #[command(flatten)]
    results: ResultArgs,
}

impl AlignArgs {
    fn inputs(&self) -> anyhow::Result<AlignInputs> {
        let (task, bids) = (&self.given.options.task, &self.bids);
        ensure!(task.is_none() || bids.is_some(), "--task names the files of a BIDS dataset: give --bids too");
        Ok(AlignInputs { joints: self.joints.clone(), log: self.log.clone(), tracks: self.tracks.clone() })
    }

    fn outputs(&self) -> AlignOutputs {
        AlignOutputs {
            training: self.results.place(),
            mot: self.mot.clone(),
            bids: self.bids.clone(),
            dlc: self.dlc.clone(),
            figures: !self.results.no_figures,
            report: true,
        }
    }
}

pub(crate) fn run(args: &AlignArgs) -> anyhow::Result<Outcome> {
    let options = &args.given.options;
    jobs::run(
        &args.results.request("align", "steps", &args.given.said),
        || Ok(align::plan(&args.inputs()?, options, &args.outputs())?),
        |watch| Ok(align::run(&args.inputs()?, options, &args.outputs(), watch)?),
        say,
    )
}

fn say(common: &Common, report: &AlignReport) {
    let (tie, rows) = (&report.certificate, &report.certificate.rows);
    let plus_minus = |sd: Option<f64>, digits: usize| sd.map_or(String::new(), |sd| format!(" ± {sd:.digits$}"));
    common.say(&format!(
        "offset {}{} s, drift {}{} ppm ({:?}); {} frames read, {} not",
        fixed(tie.offset_s, 4),
        plus_minus(tie.offset_sd_s, 4),
        fixed(tie.drift_ppm, 1),
        plus_minus(tie.drift_sd_ppm, 1),
        tie.method,
        tie.frames_read,
        tie.frames_abstained
    ));
    common.say(&format!(
        "{} of {} rows labelled; {} with a fault of the sensor",
        rows.rows_labelled, report.rows, report.rows_with_faults
    ));
    common.say(&format!(
        "without: {} before the video, {} after it, {} in gaps",
        rows.before_the_video, rows.after_the_video, rows.in_gaps
    ));
}
