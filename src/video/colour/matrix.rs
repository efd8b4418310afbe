//! Between R'G'B' and Y'CbCr: the matrices of ITU-R BT.601, BT.709, BT.2020 and BT.2100, both ranges.

use super::transfer::Transfer;

/// The matrix between R'G'B' and Y'CbCr, the range of the samples, and how R'G'B' stand for light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Matrix {
    /// Red's share of luma.
    pub k_red: f64,
    /// Blue's share of luma.
    pub k_blue: f64,
    /// Samples use all values; if not, luma runs from 16 to 235 and chroma from 16 to 240.
    pub full_range: bool,
    /// Not a power of light in HDR video, whose primaries are BT.2020's where its matrix is.
    pub transfer: Transfer,
}

impl Matrix {
    /// ITU-R BT.601.
    pub const BT601: Self = Self::ordinary(0.299, 0.114);
    /// ITU-R BT.709.
    pub const BT709: Self = Self::ordinary(0.2126, 0.0722);
    /// ITU-R BT.2020, non-constant luminance.
    pub const BT2020: Self = Self::ordinary(0.2627, 0.0593);
    /// ITU-R BT.2100, hybrid log-gamma.
    pub const HLG: Self = Self { transfer: Transfer::HybridLogGamma, ..Self::BT2020 };
    /// ITU-R BT.2100, the perceptual quantizer.
    pub const PQ: Self = Self { transfer: Transfer::PerceptualQuantizer, ..Self::BT2020 };

    /// A matrix of limited range, not of HDR.
    pub(in crate::video) const fn ordinary(k_red: f64, k_blue: f64) -> Self {
        Self { k_red, k_blue, full_range: false, transfer: Transfer::Power }
    }

    /// Y'CbCr on the scale of 8 bits (0 to 255, grey has Cb = Cr = 128) of R'G'B' as ordinary video has them, 0 to 1.
    #[must_use]
    pub fn from_rgb(&self, rgb: [f64; 3]) -> [f64; 3] {
        self.from_own_rgb(self.own_rgb(rgb))
    }

    /// A video's own R'G'B' of ordinary ones: the same but in HDR.
    #[must_use]
    pub fn own_rgb(&self, rgb: [f64; 3]) -> [f64; 3] {
        self.transfer.own(rgb, self.is_wide())
    }

    /// Y'CbCr of a video's own R'G'B': linear.
    #[must_use]
    pub fn from_own_rgb(&self, [red, green, blue]: [f64; 3]) -> [f64; 3] {
        let luma = self.k_red * red + self.k_blue * blue + (1.0 - self.k_red - self.k_blue) * green;
        let cb = (blue - luma) / (2.0 * (1.0 - self.k_blue));
        let cr = (red - luma) / (2.0 * (1.0 - self.k_red));
        let (base, luma_span, chroma_span) = self.spans();
        [base + luma_span * luma, 128.0 + chroma_span * cb, 128.0 + chroma_span * cr]
    }

    /// A video's own R'G'B', 0 to 1 (not clipped), of Y'CbCr on the scale of 8 bits: linear. Frames that are read have
    /// ordinary ones, as HDR is made so first.
    #[must_use]
    pub fn to_own_rgb(&self, [luma, cb, cr]: [f64; 3]) -> [f64; 3] {
        let (base, luma_span, chroma_span) = self.spans();
        let luma = (luma - base) / luma_span;
        let red = luma + 2.0 * (1.0 - self.k_red) * (cr - 128.0) / chroma_span;
        let blue = luma + 2.0 * (1.0 - self.k_blue) * (cb - 128.0) / chroma_span;
        let green = (luma - self.k_red * red - self.k_blue * blue) / (1.0 - self.k_red - self.k_blue);
        [red, green, blue]
    }

    pub(super) fn is_wide(&self) -> bool {
        self.k_red == Self::BT2020.k_red
    }

    fn spans(&self) -> (f64, f64, f64) {
        if self.full_range { (0.0, 255.0, 255.0) } else { (16.0, 219.0, 224.0) }
    }
}
