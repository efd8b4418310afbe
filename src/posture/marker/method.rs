//! How much looking a centre is worth: the settings that the trade-off between error and run time is made with.

/// The planes that centres are fitted to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Planes {
    /// Luma and chroma together.
    #[default]
    All,
    /// Luma alone; finding and naming still go by chroma.
    Luma,
    /// Chroma alone.
    Chroma,
}

impl Planes {
    /// Whether plane `index` of Y', Cb, Cr is used; grey video has but the first, and uses it.
    pub(super) fn uses(self, index: usize, planes: usize) -> bool {
        match self {
            Self::All => true,
            Self::Luma => index == 0,
            Self::Chroma => index > 0 || planes == 1,
        }
    }
}

/// Where a marker that was seen in the last frame is looked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Search {
    /// About the place where it should be.
    #[default]
    Near,
    /// In the whole frame, every frame.
    Whole,
}

/// How centres are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Method {
    /// The planes that centres are fitted to.
    pub planes: Planes,
    /// Rounds of the fit at most; with none, the centroid of what is nearer to the marker's colour is the centre.
    pub rounds: usize,
    /// Where markers are looked for.
    pub search: Search,
}

impl Method {
    /// The usual number of rounds at most; three or four are enough in most frames.
    pub const ROUNDS: usize = 6;
}

impl Default for Method {
    fn default() -> Self {
        Self { planes: Planes::All, rounds: Self::ROUNDS, search: Search::Near }
    }
}
