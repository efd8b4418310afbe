//! Contrasts of subjects to rows: by pose, tone and channel.

use std::collections::{BTreeMap, BTreeSet};

use rayon::prelude::*;
use serde::Serialize;

use super::cells::{CHANNELS, Cells};
use super::interval::Estimate;
use super::zones::{Neutral, Zones};
use crate::photo::normalize::{AT_FULL_SCALE, Channel, FULL_SCALE, MOST_AT_FULL_SCALE, linear_from_srgb};
use crate::photo::set::Photo;

/// Share of a zone that a photograph has to show (assumed).
const LEAST_SEEN: f64 = 0.5;
const PAIRS: [[usize; 2]; 3] = [[1, 0], [1, 2], [0, 2]];

/// A colour photograph with at least one nail that is used.
pub(in crate::photo) struct Sample<'a> {
    /// Whose, and in what pose.
    pub(in crate::photo) photo: &'a Photo,
    /// Its nails.
    pub(in crate::photo) cells: Cells,
}

/// Whose picture the zones are taken from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ZonesOf {
    /// For each subject, the other subjects of the pose.
    Others,
    /// The subject itself, the pose's only one: its noise counts as contrast.
    Own,
}

/// White and red zones in one channel: of all the subjects of a pose, or of those of one skin tone.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChannelRow {
    /// The pose.
    pub pose: String,
    /// The skin tone as the manifest names it; none: all subjects.
    pub tone: Option<String>,
    /// The channel.
    pub channel: Channel,
    /// Subjects whose contrast was measured.
    pub subjects: usize,
    /// Whose zones they are.
    pub zones: ZonesOf,
    /// Mean over white zones and subjects, fraction of full scale.
    pub white: Option<f64>,
    /// Mean over red zones and subjects, fraction of full scale.
    pub red: Option<f64>,
    /// White less red, over subjects, fraction of full scale.
    pub contrast: Option<Estimate>,
    /// The contrast of light, sRGB's curve undone, divided by the mean of both zones' light, over subjects; the same in
    /// all channels where a zone is darker by shade alone. As encoded it isn't: 10.8 % in red, 11.4 % in blue where
    /// light falls off over a nail of one colour.
    pub relative: Option<Estimate>,
    /// Share of the zones' cells that are at full scale: contrast is lost there.
    pub at_full_scale: Option<f64>,
}

/// By how much more two zones differ in one channel than in another, subject by subject.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChannelDifference {
    /// The pose.
    pub pose: String,
    /// The skin tone as the manifest names it; none: all subjects.
    pub tone: Option<String>,
    /// The channel whose contrast is the minuend.
    pub of: Channel,
    /// The channel whose contrast is subtracted.
    pub less: Channel,
    /// Of the contrasts, over subjects, fraction of full scale.
    pub difference: Option<Estimate>,
}

/// The figures of the channels compared.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChannelFigures {
    /// Colour photographs that were compared.
    pub photographs: usize,
    /// By pose in the thesis' order; in each all subjects, then tones by name; in each red, green, blue.
    pub rows: Vec<ChannelRow>,
    /// In the same order; in each green less red, green less blue, red less blue.
    pub differences: Vec<ChannelDifference>,
    /// The chart, a PNG file.
    #[serde(skip)]
    pub chart: Vec<u8>,
}

/// What came of comparing.
pub(in crate::photo) struct Compared {
    pub(in crate::photo) figures: ChannelFigures,
    pub(in crate::photo) notes: Vec<String>,
    pub(in crate::photo) warnings: Vec<String>,
}

/// Values of one subject's zones, by channel, fractions of full scale.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Measured {
    white: [f64; 3],
    red: [f64; 3],
    /// Light of the white zone and of the red one, of full scale's.
    light: [[f64; 2]; 3],
    at_full_scale: [f64; 3],
}

/// Compares the channels of `samples`, which are sorted by pose; `is_linear` says that their levels are light.
pub(in crate::photo) fn compare(samples: &[Sample<'_>], is_linear: bool) -> Compared {
    let mut figures =
        ChannelFigures { photographs: samples.len(), rows: Vec::new(), differences: Vec::new(), chart: Vec::new() };
    let mut notes = Vec::new();
    for of_pose in samples.chunk_by(|a, b| a.photo.pose == b.photo.pose) {
        let pose = &of_pose[0].photo.pose;
        let measured = measure(of_pose, is_linear);
        let lacking: Vec<&str> =
            of_pose.iter().zip(&measured).filter(|(_, m)| m.is_none()).map(|(s, _)| s.photo.subject.as_str()).collect();
        if let [first, others @ ..] = &lacking[..] {
            let also = if others.is_empty() { String::new() } else { format!(" and {} more", others.len()) };
            notes.push(format!(
                "channels of pose `{pose}`: `{first}`{also} left out, as there are no zones or less than half of one \
                 is seen"
            ));
        }
        if of_pose.len() == 1 {
            notes.push(format!(
                "channels of pose `{pose}`: one subject, so the zones are its own (its noise counts as contrast) and \
                 there is no interval"
            ));
        }
        let zones = if of_pose.len() == 1 { ZonesOf::Own } else { ZonesOf::Others };
        let with = |wanted: Option<&str>| -> Vec<Measured> {
            let of_tone = |tone: Option<&str>| wanted.is_none() || wanted == tone;
            let theirs = of_pose.iter().zip(&measured).filter(|(sample, _)| of_tone(sample.photo.tone.as_deref()));
            theirs.filter_map(|(_, measured)| *measured).collect()
        };
        let tones: BTreeSet<&str> = of_pose.iter().filter_map(|sample| sample.photo.tone.as_deref()).collect();
        for tone in std::iter::once(None).chain(tones.into_iter().map(Some)) {
            add_rows(&mut figures, (pose, tone, zones), &with(tone));
        }
    }
    let warnings = several_tones(samples).into_iter().chain(bright(&figures)).collect();
    Compared { figures, notes, warnings }
}

/// The zones of each subject are those of the others, and its values there; none where they are not seen.
fn measure(subjects: &[Sample<'_>], is_linear: bool) -> Vec<Option<Measured>> {
    let all = Neutral::of(subjects.iter().map(|sample| &sample.cells));
    let one = |sample: &Sample<'_>| {
        let zones = if subjects.len() == 1 { all.zones() } else { all.without(&sample.cells).zones() };
        Measured::of(&sample.cells, &zones?, is_linear)
    };
    subjects.par_iter().map(one).collect()
}

impl Measured {
    fn of(cells: &Cells, zones: &Zones, is_linear: bool) -> Option<Self> {
        let seen = |zone: &[usize]| -> Option<Vec<usize>> {
            let seen: Vec<usize> = zone.iter().copied().filter(|&at| cells.seen[at]).collect();
            (seen.len() as f64 >= LEAST_SEEN * zone.len() as f64).then_some(seen)
        };
        let (white, red) = (seen(&zones.white)?, seen(&zones.red)?);
        let mean = |zone: &[usize]| {
            cells.levels.each_ref().map(|levels| {
                let sum: u64 = zone.iter().map(|&at| u64::from(levels[at])).sum();
                sum as f64 / zone.len() as f64 / f64::from(FULL_SCALE)
            })
        };
        let light = cells.levels.each_ref().map(|levels| {
            let of = |at: &usize| {
                let value = f32::from(levels[*at]) / f32::from(FULL_SCALE);
                f64::from(if is_linear { value } else { linear_from_srgb(value) })
            };
            [&white, &red].map(|zone| zone.iter().map(of).sum::<f64>() / zone.len() as f64)
        });
        let at_full_scale = cells.levels.each_ref().map(|levels| {
            let both = || white.iter().chain(&red);
            both().filter(|&&at| levels[at] >= AT_FULL_SCALE).count() as f64 / both().count() as f64
        });
        Some(Self { white: mean(&white), red: mean(&red), light, at_full_scale })
    }

    fn contrast(&self, channel: usize) -> f64 {
        self.white[channel] - self.red[channel]
    }

    /// None where the channel is black.
    fn relative(&self, channel: usize) -> Option<f64> {
        let [white, red] = self.light[channel];
        (white + red > 0.0).then(|| 2.0 * (white - red) / (white + red))
    }
}

fn add_rows(figures: &mut ChannelFigures, (pose, tone, zones): (&str, Option<&str>, ZonesOf), of: &[Measured]) {
    let over = |value: &dyn Fn(&Measured) -> f64| Estimate::of(of.iter().map(value));
    let (pose, tone) = (pose.to_owned(), tone.map(str::to_owned));
    for (k, channel) in CHANNELS.into_iter().enumerate() {
        let mean = |value: &dyn Fn(&Measured) -> f64| over(value).map(|estimate| estimate.mean);
        figures.rows.push(ChannelRow {
            pose: pose.clone(),
            tone: tone.clone(),
            channel,
            subjects: of.len(),
            zones,
            white: mean(&|m| m.white[k]),
            red: mean(&|m| m.red[k]),
            contrast: over(&|m| m.contrast(k)),
            relative: Estimate::of(of.iter().filter_map(|m| m.relative(k))),
            at_full_scale: mean(&|m| m.at_full_scale[k]),
        });
    }
    for [a, b] in PAIRS {
        figures.differences.push(ChannelDifference {
            pose: pose.clone(),
            tone: tone.clone(),
            of: CHANNELS[a],
            less: CHANNELS[b],
            difference: over(&|m| m.contrast(a) - m.contrast(b)),
        });
    }
}

/// Subjects that the manifest gives more than one skin tone.
fn several_tones(samples: &[Sample<'_>]) -> Vec<String> {
    let mut tones: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for photo in samples.iter().map(|sample| sample.photo) {
        tones.entry(&photo.subject).or_default().extend(photo.tone.as_deref());
    }
    let several = tones.into_iter().filter(|(_, tones)| tones.len() > 1);
    let list = |tones: BTreeSet<&str>| tones.into_iter().map(|tone| format!("`{tone}`")).collect::<Vec<_>>().join(", ");
    several
        .map(|(subject, tones)| format!("photos.csv: subject `{subject}` has more than one tone: {}", list(tones)))
        .collect()
}

/// Poses and channels that are too bright to show their contrast.
fn bright(figures: &ChannelFigures) -> Vec<String> {
    let too_bright = figures.rows.iter().filter(|row| row.tone.is_none());
    let too_bright = too_bright.filter_map(|row| Some((row, row.at_full_scale.filter(|&s| s > MOST_AT_FULL_SCALE)?)));
    too_bright
        .map(|(row, share)| {
            format!(
                "channels of pose `{}`: {:.0} % of the zones in {} are at full scale, so that its contrast is larger \
                 than measured; photograph with less exposure",
                row.pose,
                100.0 * share,
                row.channel.name()
            )
        })
        .collect()
}

#[cfg(test)]
mod tests;
