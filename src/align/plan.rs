//! What a run would do and leave out, told from the table of angles and the log.

use super::job::{AlignError, AlignInputs, AlignOptions, AlignOutputs, Sync};
use super::posture::Posture;
use crate::log::Log;
use crate::stages::Step;

/// Plans a run; `outputs` may be open yet.
///
/// # Errors
/// [`AlignError`] where the table of angles or the log can't be read.
pub fn plan(
    inputs: &AlignInputs,
    options: &AlignOptions,
    outputs: Option<&AlignOutputs>,
) -> Result<Vec<Step>, AlignError> {
    let posture = Posture::read(&inputs.joints)?;
    let log = Log::read(&inputs.log, &options.columns)?;
    Ok(steps(&posture, &log, options, outputs))
}

pub(super) fn steps(posture: &Posture, log: &Log, options: &AlignOptions, outputs: Option<&AlignOutputs>) -> Vec<Step> {
    let sync = options.sync.or_else(|| posture.has_clock().then_some(Sync::Clock));
    let frames = posture.time_s.len();
    let lit = log.led.as_ref().map(|led| led.iter().filter(|on| **on).count());
    let asked = |wanted: Option<bool>, option: &str| match wanted {
        Some(true) => (true, option.to_owned()),
        _ => (false, "not asked for".to_owned()),
    };
    let (mot, mot_why) = asked(outputs.map(|o| o.mot.is_some()), "--mot");
    let (bids, bids_why) = asked(outputs.map(|o| o.bids.is_some()), "--bids");
    let (dlc, dlc_why) = asked(outputs.map(|o| o.dlc.is_some()), "--dlc");
    vec![
        Step::new("labels of joints", true, format!("{} from {frames} frames", posture.joints.join(", "))),
        Step::new(
            "ambient light taken away",
            lit.is_some(),
            match lit {
                Some(lit) => format!("{lit} of {} rows are lit", log.time_s.len()),
                None => "the log has no column `led`; all rows are lit".to_owned(),
            },
        ),
        Step::new(
            "clock in the picture",
            sync == Some(Sync::Clock),
            match sync {
                Some(Sync::Clock) => "clock_s ties the clocks".to_owned(),
                None => "the table of angles has none; name --sync offset=SECONDS or correlate".to_owned(),
                Some(_) => "--sync names another tie".to_owned(),
            },
        ),
        Step::new(
            "search for the lag",
            sync == Some(Sync::Correlate),
            if sync == Some(Sync::Correlate) {
                format!("{} photodiodes against the angles", log.photodiodes.len())
            } else {
                "only --sync correlate needs it".to_owned()
            },
        ),
        Step::new("OpenSim motion file", mot, mot_why),
        Step::new("BIDS Motion folder", bids, bids_why),
        Step::new("DeepLabCut table", dlc, dlc_why),
        Step::new("figures", outputs.is_none_or(|o| o.figures), "of the tie and of the labels".to_owned()),
    ]
}
