//! A photograph's nails in red, green and blue, as means over a coarse grid on the nail's box.

use image::DynamicImage;

use crate::photo::normalize::{Channel, NailFrame, Normalization, Normalizer, Resample};
use crate::photo::sums::mean_of_nails;

/// Cells along each side of the nail's box (assumed): zones are a quarter of a nail or more across, a cell is a
/// fortieth.
pub(super) const GRID: usize = 40;

/// The channels in the order of results.
pub(super) const CHANNELS: [Channel; 3] = [Channel::Red, Channel::Green, Channel::Blue];

/// One subject's picture in every channel, [`GRID`] x [`GRID`] cells, row by row from the distal end.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::photo) struct Cells {
    /// By channel of [`CHANNELS`]; of 65535, 0 where not seen.
    pub(super) levels: [Vec<u16>; 3],
    /// Which cells the photograph shows in full.
    pub(super) seen: Vec<bool>,
}

impl Cells {
    /// The mean of the nails with these frames, where the photograph shows them.
    pub(in crate::photo) fn of(
        image: &DynamicImage,
        frames: &[NailFrame],
        with: &Normalization,
        normalizer: &mut Normalizer,
    ) -> Self {
        let mut seen = Vec::new();
        let levels = CHANNELS.map(|channel| {
            // The cells cover the box itself; nothing between them is left out, as it would be with nearest pixels.
            let with = Normalization { size: GRID, margin: 1.0, channel, resample: Resample::Cubic, ..*with };
            let nails: Vec<_> = frames.iter().map(|frame| normalizer.normalize(image, frame, &with)).collect();
            let cells: Vec<Option<u64>> = (0..GRID * GRID).map(|at| mean_of_nails(&nails, at)).collect();
            nails.into_iter().for_each(|nail| normalizer.take_back(nail));
            // Transparency and the photograph's border are the same in every channel.
            seen = cells.iter().map(Option::is_some).collect();
            cells.into_iter().map(|level| level.map_or(0, |level| level as u16)).collect()
        });
        Self { levels, seen }
    }
}
