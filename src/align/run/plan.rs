//! What a run would do and leave out, by the table of angles and the log.

use crate::align::error::AlignError;
use crate::align::options::{AlignInputs, AlignOptions, AlignOutputs, Sync};
use crate::align::posture::Posture;
use crate::log::Log;
use crate::stages::Step;

/// Plans a run; `outputs` may have no place yet.
///
/// # Errors
/// [`AlignError`] where the table of angles or the log can't be read.
pub fn plan(inputs: &AlignInputs, options: &AlignOptions, outputs: &AlignOutputs) -> Result<Vec<Step>, AlignError> {
    let posture = Posture::read(&inputs.joints)?;
    let log = Log::read(&inputs.log, &options.log.columns)?;
    Ok(steps(&Foreknown::of(&posture, &log), options, outputs))
}

/// What is known of the recordings before they are opened; none: not known.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(in crate::align) struct Foreknown {
    pub(in crate::align) joints: Option<Vec<String>>,
    /// Frames with angles.
    pub(in crate::align) frames: Option<usize>,
    /// The angles carry the time of the clock in the picture.
    pub(in crate::align) clock: Option<bool>,
    /// The log says when the LED was on.
    pub(in crate::align) led: Option<bool>,
    /// Lit rows, and all.
    pub(in crate::align) lit_rows: Option<[usize; 2]>,
    pub(in crate::align) photodiodes: Option<usize>,
}

impl Foreknown {
    pub(in crate::align) fn of(posture: &Posture, log: &Log) -> Self {
        let lit = log.led.as_ref().map(|led| led.iter().filter(|on| **on).count());
        Self {
            joints: Some(posture.joints.clone()),
            frames: Some(posture.time_s.len()),
            clock: Some(posture.has_clock()),
            led: Some(lit.is_some()),
            lit_rows: lit.map(|lit| [lit, log.time_s.len()]),
            photodiodes: Some(log.photodiodes.len()),
        }
    }
}

/// The one table of steps: the plan shows them, a run's report lists those that are left out.
pub(in crate::align) fn steps(known: &Foreknown, options: &AlignOptions, outputs: &AlignOutputs) -> Vec<Step> {
    let sync = options.sync.or_else(|| (known.clock != Some(false)).then_some(Sync::Clock));
    let joints = known.joints.as_ref().map_or("all".to_owned(), |joints| joints.join(", "));
    let frames = known.frames.map_or("all frames".to_owned(), |frames| format!("{frames} frames"));
    let photodiodes = known.photodiodes.map_or("the".to_owned(), |photodiodes| photodiodes.to_string());
    let asked = |step: &'static str, wanted: Option<bool>, option: &str| match wanted {
        Some(true) => Step::new(step, true, option.to_owned()),
        _ => Step::new(step, false, "not asked for".to_owned()),
    };
    let figures = outputs.figures;
    vec![
        Step::new("labels of joints", true, format!("{joints} from {frames}")),
        Step::new(
            "ambient light subtracted",
            known.led != Some(false),
            match (known.led, known.lit_rows) {
                (Some(false), _) => "the log has no column `led`; all rows are lit".to_owned(),
                (_, Some([lit, rows])) => format!("{lit} of {rows} rows are lit"),
                (Some(true), None) => "the log has a column `led`".to_owned(),
                (None, None) => "where the log has a column `led`".to_owned(),
            },
        ),
        Step::new(
            "clock in the picture",
            sync == Some(Sync::Clock),
            match sync {
                Some(Sync::Clock) => "clock_s ties the clocks".to_owned(),
                None => "the table of angles has no clock; name --sync offset=SECONDS or correlate".to_owned(),
                Some(_) => "--sync names another tie".to_owned(),
            },
        ),
        Step::new(
            "search for the lag",
            sync == Some(Sync::Correlate),
            if sync == Some(Sync::Correlate) {
                format!("{photodiodes} photodiodes against the angles")
            } else {
                "only --sync correlate needs it".to_owned()
            },
        ),
        Step::new(
            "photodiodes compared with the tie",
            sync != Some(Sync::Correlate),
            if sync == Some(Sync::Correlate) { "they make it" } else { "do they follow the angles?" }.to_owned(),
        ),
        asked("OpenSim motion file", Some(outputs.mot.is_some()), "--mot"),
        asked("BIDS Motion folder", Some(outputs.bids.is_some()), "--bids"),
        asked("DeepLabCut table", Some(outputs.dlc.is_some()), "--dlc"),
        Step::figures(figures, "of the tie and of the labels"),
    ]
}
