//! What `lunula phantom video` takes in words: choices, spans of frames, colours, panels.

use clap::ValueEnum;
use lunula::phantom::video::{Hide, Leave, Preset, Siting};

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(in crate::cli) enum SceneArg {
    Clean,
    Hard,
    Small,
    Fast,
    Uhd,
}

impl SceneArg {
    pub(in crate::cli) fn preset(self) -> Preset {
        match self {
            Self::Clean => Preset::Clean,
            Self::Hard => Preset::Hard,
            Self::Small => Preset::Small,
            Self::Fast => Preset::Fast,
            Self::Uhd => Preset::Uhd,
        }
    }
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(super) enum FlexionArg {
    Clockwise,
    Counterclockwise,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(super) enum LayoutArg {
    Pairs,
    Joints,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(super) enum ColoursArg {
    Pairs,
    Distinct,
    Red,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(super) enum FontArg {
    Mono,
    Proportional,
    Segments,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(super) enum MatrixArg {
    #[value(name = "601")]
    Bt601,
    #[value(name = "709")]
    Bt709,
    #[value(name = "2020")]
    Bt2020,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(super) enum SitingArg {
    Left,
    Centre,
}

impl SitingArg {
    pub(super) fn siting(self) -> Siting {
        match self {
            Self::Left => Siting::Left,
            Self::Centre => Siting::Centre,
        }
    }
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(super) enum RotateArg {
    #[value(name = "0")]
    None,
    #[value(name = "90")]
    Quarter,
    #[value(name = "180")]
    Half,
    #[value(name = "270")]
    ThreeQuarters,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(super) enum FormatArg {
    #[value(name = "420")]
    Quarter,
    #[value(name = "422")]
    Half,
    #[value(name = "444")]
    Full,
    Grey,
}

fn parse_span(text: &str) -> Option<(usize, usize)> {
    let (frame, frames) = text.split_once('+')?;
    Some((frame.parse().ok()?, frames.parse().ok()?))
}

pub(super) fn parse_hide(text: &str) -> Result<Hide, String> {
    let parts = text.split_once('@').and_then(|(name, span)| Some((name, parse_span(span)?)));
    let (marker, (frame, frames)) =
        parts.ok_or_else(|| format!("`{text}` is not NAME@FRAME+N, as middle_dist@120+12"))?;
    Ok(Hide { marker: marker.to_owned(), frame, frames })
}

pub(super) fn parse_leave(text: &str) -> Result<Leave, String> {
    let (frame, frames) = parse_span(text).ok_or_else(|| format!("`{text}` is not FRAME+N, as 60+20"))?;
    Ok(Leave { frame, frames })
}

pub(super) fn parse_colour(text: &str) -> Result<u32, String> {
    let digits = text.strip_prefix('#').filter(|digits| digits.len() == 6);
    digits
        .and_then(|digits| u32::from_str_radix(digits, 16).ok())
        .ok_or_else(|| format!("`{text}` is not a colour as #8a9299"))
}

pub(super) fn parse_roi(text: &str) -> Result<[usize; 4], String> {
    let sides: Option<Vec<usize>> = text.split(',').map(|side| side.trim().parse().ok()).collect();
    sides
        .and_then(|sides| sides.try_into().ok())
        .ok_or_else(|| format!("`{text}` is not X,Y,WIDTH,HEIGHT, as 900,40,300,70"))
}
