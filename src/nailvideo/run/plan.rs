//! What a run would do and leave out.

use crate::nailvideo::options::{Inputs, Light, NailVideoOptions, Outputs};
use crate::stages::Step;
use crate::video::{Info, Video, VideoError};

/// Plans a run; `outputs` may have no place yet.
pub fn plan(inputs: &Inputs, options: &NailVideoOptions, outputs: &Outputs) -> Result<Vec<Step>, VideoError> {
    let video = Video::open(&inputs.video, options.threads)?;
    Ok(steps(Some(video.info()), inputs.outline.is_some(), options, outputs))
}

/// The light that is taken off in a video.
pub(in crate::nailvideo) fn light_of(grey: bool, options: &NailVideoOptions) -> Light {
    options.light.unwrap_or(if grey { Light::None } else { Light::Red })
}

/// The one table of steps: the plan shows them, a run's report lists those that are left out.
pub(in crate::nailvideo) fn steps(
    info: Option<&Info>,
    outlined: bool,
    options: &NailVideoOptions,
    outputs: &Outputs,
) -> Vec<Step> {
    let decoding = info.map_or("all frames".to_owned(), Info::in_words);
    let light = light_of(info.is_some_and(|info| info.grey), options);
    let asked = |runs: bool, option: &str| if runs { "asked for".to_owned() } else { format!("no {option}") };
    let frames = outputs.frames;
    let figures = outputs.figures;
    vec![
        Step::new("decode", true, decoding),
        Step::new(
            "detect the nail",
            !outlined,
            if outlined { "an outline is given" } else { "no --outline" }.to_owned(),
        ),
        Step::new(
            "check the outline",
            outlined,
            if outlined { "by the network that finds nails, once" } else { "it is detected" }.to_owned(),
        ),
        Step::new("follow", true, "by the nail's affine motion from the first good frame".to_owned()),
        Step::new(
            "take light off",
            light != Light::None,
            match light {
                Light::Red => "by the red of the same place".to_owned(),
                Light::Skin => "by the green of the skin about the nail".to_owned(),
                Light::None => "grey video, or --light none".to_owned(),
            },
        ),
        Step::new("cells", options.cells.is_some(), asked(options.cells.is_some(), "--cells")),
        Step::new("normalized frames", frames, asked(frames, "--frames")),
        Step::new("maps", !options.maps.is_empty(), asked(!options.maps.is_empty(), "--maps")),
        Step::new("presses", true, "of all photodiodes, and of both ends of the nail".to_owned()),
        Step::new("pulse", false, "not measured from video".to_owned()),
        Step::figures(figures, "traces, sheet"),
    ]
}
