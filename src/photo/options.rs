//! What is done with a set of photographs, where results go.

use std::path::PathBuf;

use super::normalize::Normalization;
use super::outline::OutlineOptions;

/// How photographs become normalized pictures: the options of `lunula photos` and of a pipeline's stage.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct PhotosOptions {
    /// Where outlines come from.
    #[command(flatten)]
    pub outlines: OutlineOptions,
    /// How normalized pictures are made.
    #[command(flatten)]
    pub normalization: Normalization,
    /// Refuse photographs of more megapixels, before memory is taken for them [default: 250]
    #[arg(long, value_name = "MP", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub max_megapixels: Option<u32>,
    /// Compare the channels as well: how much white and red zones differ in red, green and blue, for each pose and,
    /// where photos.csv has a column `tone`, each skin tone; needs colour photographs
    #[arg(long)]
    pub channels: bool,
    /// Look at drawn outlines with the network that finds nails, and warn of those where it sees the nail elsewhere
    #[arg(long)]
    pub check_outlines: bool,
}

/// Where results go, and which are written.
#[derive(Debug, Clone)]
pub struct Outputs {
    /// Folder for the results.
    pub folder: PathBuf,
    /// Maps, or the sums that maps are made of.
    pub results: Results,
    /// Where detected outlines are saved for a person to correct; `None`: they are not.
    pub outlines: Option<OutlineHome>,
}

impl Outputs {
    /// Maps, figures and report in `folder`, and no outlines saved.
    pub fn maps(folder: impl Into<PathBuf>) -> Self {
        Self { folder: folder.into(), results: Results::Maps, outlines: None }
    }

    /// Whether channels are compared: by whoever has all subjects at once.
    pub(super) fn compares_channels(&self, options: &PhotosOptions) -> bool {
        options.channels && self.results == Results::Maps
    }

    /// Whether the normalized pictures are written.
    pub(super) fn has_pictures(&self) -> bool {
        self.results != Results::Sums { pictures: false }
    }
}

/// Which results are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Results {
    /// Maps, figures, the normalized pictures, `nails.csv` and the report.
    Maps,
    /// Sums (`partials/`) and `nails.csv`: one part of many, which [`gather`](fn@super::gather) joins to maps.
    Sums {
        /// Whether the normalized pictures are written too.
        pictures: bool,
    },
}

/// Where detected outlines are saved.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum OutlineHome {
    /// `<stem>.json` beside each photograph.
    BesidePhotographs,
    /// In a folder, with a `photos.csv` that refers to the photographs.
    Folder(PathBuf),
}
