//! What outlines are corrected with: the options of `lunula photos` that decide what comes out of them.

use crate::photo::Normalization;
use crate::photo::outline::OutlineOptions;

/// Options of `lunula edit`.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct EditOptions {
    /// Where outlines come from.
    #[command(flatten)]
    pub outlines: OutlineOptions,
    /// How normalized pictures are made.
    #[command(flatten)]
    pub normalization: Normalization,
    /// Refuse photographs of more megapixels, before memory is taken for them [default: 250]
    #[arg(long, value_name = "MP", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub max_megapixels: Option<u32>,
}
