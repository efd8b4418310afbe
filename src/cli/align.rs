//! `lunula align`: joint angles on photodiode samples.

use std::path::PathBuf;

use anyhow::{Context, ensure};
use clap::Args;
use lunula::align::{AlignError, AlignInputs, AlignOutputs, AlignReport, AlignRequest, plan, run as run_align};

use super::{Common, Interrupted, Outcome};

/// Joint angles and a log of photodiodes, on two clocks, to a labelled training set with a certificate
///
/// log time = offset + (1 + drift) * video time. The clock in the picture ties the two (clock_s in the table of
/// angles); so does an offset that you know; or, without either, the lag at which the photodiodes best explain the
/// angles. Each row of the log (each lit one, less the unlit light at its time, where there is a column `led`) gets the
/// angles at its time, between frames that were really seen, with their standard error; what has none stays empty, and
/// label_status says why. Results: the set, and beside it <training>.sync.json, the certificate (offset, drift, their
/// errors, residuals, what was left unlabelled), <training>.run.json and pictures of the tie and of the labels over the
/// photodiodes.
#[derive(Debug, Args)]
pub(super) struct AlignArgs {
    /// The table of joint angles of `lunula posture`: time_s, clock_s, <joint>_deg, <joint>_sd_deg
    #[arg(long, value_name = "JOINTS.csv")]
    joints: PathBuf,
    /// The log: time_s, led (1 on, 0 off; may be absent), P1.., Fx_N, Fy_N, Fz_N (.csv, .csv.gz, .parquet; .xdf where
    /// built in)
    #[arg(long, value_name = "LOG.csv")]
    log: PathBuf,
    /// The labelled set: time_s, P1.., forces, <joint>_deg, <joint>_sd_deg, label_status, subject, session,
    /// sensor_status (.csv or .parquet)
    #[arg(long, value_name = "TRAINING.csv", required_unless_present = "plan")]
    out: Option<PathBuf>,
    #[command(flatten)]
    request: AlignRequest,
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
    /// Draw no pictures
    #[arg(long)]
    no_figures: bool,
    /// Say what would be done and left out, and do nothing
    #[arg(long)]
    plan: bool,
    #[command(flatten)]
    common: Common,
}

pub(super) fn run(args: &AlignArgs) -> anyhow::Result<Outcome> {
    let stop = args.common.start()?;
    let inputs = AlignInputs { joints: args.joints.clone(), log: args.log.clone(), tracks: args.tracks.clone() };
    let options = args.request.options();
    ensure!(options.task.is_none() || args.bids.is_some(), "--task names the files of a BIDS dataset: give --bids too");
    let outputs = args.out.as_ref().map(|training| AlignOutputs {
        training: training.clone(),
        mot: args.mot.clone(),
        bids: args.bids.clone(),
        dlc: args.dlc.clone(),
        figures: !args.no_figures,
    });
    if args.plan {
        let steps = plan(&inputs, &options, outputs.as_ref())?;
        return args.common.show_plan("align", &steps);
    }
    let outputs = outputs.context("--out is needed")?;
    match run_align(&inputs, &options, &outputs, &stop) {
        Err(AlignError::Interrupted) => Err(Interrupted.into()),
        Err(error) => Err(error.into()),
        Ok(report) => finish(&args.common, &report, &outputs),
    }
}

fn finish(common: &Common, report: &AlignReport, outputs: &AlignOutputs) -> anyhow::Result<Outcome> {
    if !common.quiet {
        for note in &report.warnings {
            eprintln!("note: {note}");
        }
    }
    common.print_json(report)?;
    let (tie, rows) = (&report.certificate, &report.certificate.rows);
    let plus_minus = |sd: Option<f64>, digits: usize| sd.map_or(String::new(), |sd| format!(" ± {sd:.digits$}"));
    common.say(&format!(
        "offset {:.4}{} s, drift {:.1}{} ppm ({:?}); {} frames read, {} not",
        tie.offset_s,
        plus_minus(tie.offset_sd_s, 4),
        tie.drift_ppm,
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
    let look = report.pictures.first().unwrap_or(&outputs.training);
    common.say_done(&report.stages, &report.left_out, report.wall_s, look);
    Ok(Outcome::Done)
}
